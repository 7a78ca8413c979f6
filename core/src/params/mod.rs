//! The parameter set: typed access to every number.

use crate::units::{Acceleration, Axis, Feed, Jerk, Length};

/// A complete parameter set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Params {}

impl Default for Params {
    fn default() -> Self {
        Self::slant_bed()
    }
}

macro_rules! stub {
    ($($name:ident($($arg:ident: $t:ty)?) -> $r:ty = $v:expr;)*) => {
        #[allow(missing_docs, unused_variables, clippy::must_use_candidate)]
        impl Params {
            /// The built-in machine.
            pub const fn slant_bed() -> Self { Self {} }
            $(pub fn $name(&self $(, $arg: $t)?) -> $r { $v })*
        }
    };
}

stub! {
    // cycles (980TD / 988)
    thread_chamfer() -> u8 = 5;                      // 019/5130, 0.1 lead
    thread_chamfer_angle() -> u8 = 45;               // 5131, degrees (0 = 45)
    groove_retract() -> Length = Length::from_nm(500_000); // 056/5139
    thread_finish_passes() -> u8 = 1;                // 057/5142
    thread_angle() -> u8 = 60;                       // 058/5143
    thread_min_step() -> Length = Length::from_nm(100_000); // 059/5140
    thread_allowance() -> Length = Length::from_nm(100_000); // 060/5141
    thread_cut_in() -> u8 = 0;                       // 5144
    thread_infeed() -> u8 = 1;                       // 5145
    runout_speed() -> Feed = Feed::from_nm_per_min(0); // 107
    pq_in_mm() -> bool = false;                      // 182.7
    thread_high_speed() -> bool = false;             // 5129
    // motion
    increment_is_c() -> bool = true;                 // 1004.1
    work_offset(index: u8) -> [Length; 2] = { let _ = index; [Length::ZERO; 2] }; // 1221..1226 (index 0..5 = G54..G59), [x radius, z]
    tool_offset(number: u8) -> [Length; 2] = [Length::ZERO; 2]; // 9101..9132 (number 1..32), [x radius, z]
    soft_limit_plus(axis: Axis) -> i64 = match axis { Axis::X => 300_000_000, Axis::Z => 1_000_000_000, Axis::C => i64::MAX }; // 1320, nm (radius) or µ°; i64::MAX: none
    soft_limit_minus(axis: Axis) -> i64 = match axis { Axis::X => -300_000_000, Axis::Z => -1_000_000_000, Axis::C => i64::MIN }; // 1321
    dry_run_feed() -> Feed = Feed::from_nm_per_min(3_000_000_000); // 1410
    rapid(axis: Axis) -> Feed = Feed::from_nm_per_min(match axis { Axis::X => 12_000_000_000, Axis::Z => 16_000_000_000, Axis::C => 432_000_000_000 }); // 1420 (C: µ°/min)
    max_feed(axis: Axis) -> Feed = Feed::from_nm_per_min(match axis { Axis::C => 432_000_000_000, _ => 8_000_000_000 }); // 1430
    acceleration(axis: Axis) -> Acceleration = Acceleration::from_nm_per_s2(match axis { Axis::X => 2_000_000_000, Axis::Z => 3_000_000_000, Axis::C => 20_000_000_000 }); // 1620
    jerk(axis: Axis) -> Jerk = Jerk::from_nm_per_s3(match axis { Axis::C => 400_000_000_000, _ => 60_000_000_000 }); // 1622
    following_error_limit(axis: Axis) -> i64 = 1_000_000; // 1828, nm or µ°
    encoder_counts() -> u32 = 4096;                  // 3720, after quadrature
    spindle_max_rpm() -> u32 = 3000;                 // 3772
    // own numbers
    tick_us() -> u32 = 1000;                         // 9000
    drive_numerator(axis: Axis) -> u32 = 1;          // 9001: drive increments per (denominator) nm or µ°
    drive_denominator(axis: Axis) -> u32 = 100;      // 9002
    latency_us(axis: Axis) -> u32 = 0;               // 9003: drive latency beyond the next SYNC
    spindle_ramp_ms() -> u32 = 500;                  // 9004: ms per 1000 rpm
    observer_bandwidth_hz() -> u32 = 35;             // 9005
    encoder_edge_time() -> bool = true;              // 9006.0: the hardware captures the time of the last edge
    spindle_tolerance_percent() -> u8 = 15;          // 9007: measured speed within this of the command counts as arrived
    thread_hold_retracts() -> bool = false;          // 9008.0: feed hold in a stroke retracts at once
    thread_clearance() -> Length = Length::from_nm(1_000_000); // 9009: beyond the crests, for 5129 and reset
    spindle_variation_percent() -> u8 = 15;          // 9010: spindle speed variation that join and brake of a thread leave room for
    drive_time_ms() -> u32 = 500;                    // 9011: time each CiA 402 state change may take
    following_error_ms() -> u32 = 10;                // 9012: time the following error may stay above its limit
}
