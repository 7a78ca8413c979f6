//! Cross-checks: a set may fail as a whole although each value is in its range. Every reason is a condition
//! with the figures and the parameters to change.

use super::pitch::{LARGEST_PITCH_ERROR, Unusable};
use super::{FunctionRow, Params};
use crate::alarm::{Alarm, Arg, Code};
use crate::bus::DataRates;
use crate::operating::Towards;
use crate::spindle::{Resolution, Tracker};
use crate::units::{Acceleration, Axis, Lead, Length, Rpm, Ticks, signed};

/// Ticks that the two ramps of a motion profile may have together.
pub const PROFILE_TICKS: i64 = 2048;

/// Counts a turn that an encoder needs whose edges are not timed.
const FEWEST_UNTIMED: u32 = 16;

/// Bandwidth times tick, in Hz·µs, that no observer reaches: half the sampling frequency.
const OBSERVER_LIMIT: u32 = 500_000;

/// The same up to which an observer smooths the steps of the encoder: half a radian in a tick (10⁶ / 4π).
const OBSERVER_SMOOTH: u32 = 79_577;

/// Nanometres (µ°) that a path goes in a tick at most: 2³² / 256.
const LONGEST_STEP: i64 = 1 << 24;

/// Increments to a nanometre (µ°) that a drive's scale does not reach.
const FINEST: i64 = 16;

/// Half a turn in a tick, in rpm·µs: from this speed on the direction of turning is ambiguous.
const HALF_TURN: u32 = 30_000_000;

/// The value of 9050 for an axis whose drive homes by itself.
pub const BY_DRIVE: u8 = 1;

/// The value of 9050 for an axis whose switch the board looks for. C has no such switch.
pub const BY_SWITCH: u8 = 2;

/// The lowest gain of a position loop, in tenths per second: below it an axis is a fifth of a second behind, and what
/// makes up for that is larger than a part.
const LOWEST_GAIN: u32 = 50;

// The ranges of the parameters keep every product here below 2⁶³.
impl Params {
    /// Reports everything that makes the set impossible (alarms) or doubtful (warnings).
    pub fn check(&self, report: impl FnMut(Alarm)) {
        self.look::<true>(report);
    }

    /// `ALL`: for the warnings too. Known beforehand, for a board asks for the
    /// reasons against a set alone, and has no code for the rest.
    fn look<const ALL: bool>(&self, report: impl FnMut(Alarm)) {
        let mut reasons = Reasons::<_, ALL>(report);
        for axis in Axis::ALL {
            self.check_axis(axis, &mut reasons);
        }
        self.check_ramps(&mut reasons);
        self.check_spindle(&mut reasons);
        self.check_tapping(&mut reasons);
        self.check_nodes(&mut reasons);
        self.check_fd(&mut reasons);
        self.check_functions(&mut reasons);
        self.check_zones(&mut reasons);
        self.check_lags(&mut reasons);
        self.check_targets(&mut reasons);
        self.check_pitch(&mut reasons);
    }

    /// The first reason why the set cannot work.
    ///
    /// # Errors
    /// That reason; warnings are none.
    pub fn validate(&self) -> Result<(), Alarm> {
        let mut first = Ok(());
        self.look::<false>(|alarm| {
            if first.is_ok() {
                first = Err(alarm);
            }
        });
        first
    }

    #[inline(never)]
    fn check_axis<const ALL: bool>(
        &self,
        axis: Axis,
        reasons: &mut Reasons<impl FnMut(Alarm), ALL>,
    ) {
        let (plus, minus) = (self.soft_limit_plus(axis), self.soft_limit_minus(axis));
        let mut blame = |bad: bool, code| {
            if bad {
                reasons.add(code, &[letter(axis)]);
            }
        };
        blame(minus >= plus, Code::SoftLimitsInverted);
        blame(self.max_feed(axis) > self.rapid(axis), Code::FeedAboveRapid);
        let numerator = i64::from(self.drive_numerator(axis));
        let denominator = i64::from(self.drive_denominator(axis));
        // An axis without a limit may turn for ever, and its target wraps.
        let most = denominator.wrapping_mul(i64::from(i32::MAX));
        let beside = if self.has_pitch_errors(axis) {
            LARGEST_PITCH_ERROR
        } else {
            0
        };
        let beyond = |limit: i64, none| {
            let far = limit.saturating_abs().saturating_add(beside);
            limit != none && far.saturating_mul(numerator) > most
        };
        blame(
            beyond(plus, i64::MAX)
                || beyond(minus, i64::MIN)
                || beyond(self.home_position(axis), i64::MAX),
            Code::TravelBeyondDrive,
        );
        let limit = self.following_error_limit(axis).wrapping_mul(numerator);
        blame(limit < denominator, Code::IncrementAboveLimit);
        let has_switch = self.home_input(axis).is_some_and(|input| input != 0);
        blame(
            self.home_method(axis) == BY_SWITCH && !has_switch,
            Code::HomeSwitchNone,
        );
        let ends = [Towards::Minus, Towards::Plus].map(|end| self.limit_switch(axis, end));
        blame(
            ends[0].is_some() && ends[0] == ends[1],
            Code::LimitSwitchShared,
        );
        blame(
            numerator >= denominator.wrapping_mul(FINEST),
            Code::IncrementTooFine,
        );
        // v/60 · T/10⁶ with T in µs.
        let tick = i64::from(self.tick_us());
        let way = self.rapid(axis).nm_per_min().wrapping_mul(tick);
        if way >= LONGEST_STEP.wrapping_mul(60_000_000) {
            reasons.add(Code::RapidBeyondTick, &[letter(axis), Arg::Int(tick)]);
        }
    }

    /// On a slanted path one axis may set the speed, another the acceleration, a third the jerk; the path's ramps are
    /// never longer than the longest of any axis, so those are what must fit.
    fn check_ramps<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let none = (Axis::X, 0);
        let (mut to_speed, mut to_acceleration) = (none, none);
        // What is wrong with the others is said of their targets.
        let usable = |axis: &Axis| self.unusable_target(*axis).is_none();
        for axis in Axis::ALL.into_iter().filter(usable) {
            let (speed, acceleration) = self.ramps(axis);
            if speed > to_speed.1 {
                to_speed = (axis, speed);
            }
            if acceleration > to_acceleration.1 {
                to_acceleration = (axis, acceleration);
            }
        }
        let ticks = to_speed.1.saturating_add(to_acceleration.1);
        if ticks > PROFILE_TICKS {
            let longest = if to_acceleration.1 > to_speed.1 {
                to_acceleration.0
            } else {
                to_speed.0
            };
            let figures = [letter(longest), Arg::Int(ticks), Arg::Int(PROFILE_TICKS)];
            reasons.add(Code::RampTooLong, &figures);
        }
    }

    /// Ticks to rapid speed at full acceleration, and to full acceleration at full jerk, each rounded up.
    fn ramps(&self, axis: Axis) -> (i64, i64) {
        let tick = i64::from(self.tick_us());
        let speed = self.rapid(axis).nm_per_min();
        let acceleration = self.motion_acceleration(axis).nm_per_s2();
        let jerk = self.motion_jerk(axis).nm_per_s3();
        // v/60 / (a·T/10⁶) = 50 000·v / (3·a·T) with T in µs.
        let to_speed = ceil(
            speed.wrapping_mul(50_000),
            acceleration.wrapping_mul(tick).wrapping_mul(3),
        );
        let to_acceleration = ceil(
            acceleration.wrapping_mul(1_000_000),
            jerk.wrapping_mul(tick),
        );
        (to_speed, to_acceleration)
    }

    fn check_spindle<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let tick = self.tick_us();
        let bandwidth = self.observer_bandwidth_hz();
        let product = bandwidth.saturating_mul(tick);
        let figures = |limit: u32| {
            let most = limit.checked_div(tick).unwrap_or(0);
            [count(bandwidth), count(tick), count(most)]
        };
        if product >= OBSERVER_LIMIT {
            reasons.add(Code::ObserverTooFast, &figures(OBSERVER_LIMIT));
        } else if product > OBSERVER_SMOOTH {
            reasons.add(Code::ObserverNoisy, &figures(OBSERVER_SMOOTH));
        }
        let rpm = self.spindle_max_rpm();
        if rpm.saturating_mul(tick) >= HALF_TURN {
            let most = HALF_TURN.saturating_sub(1).checked_div(tick).unwrap_or(0);
            let figures = [speed(rpm), count(tick), speed(most)];
            reasons.add(Code::SpindleTooFastForTick, &figures);
        }
        let resolution = self.resolution();
        if !resolution.timed && resolution.counts < FEWEST_UNTIMED {
            let figures = [count(resolution.counts), count(FEWEST_UNTIMED)];
            reasons.add(Code::EncoderCoarse, &figures);
        }
        let (arrived, room) = (
            self.spindle_tolerance_percent(),
            self.spindle_variation_percent(),
        );
        if arrived > room {
            let percent = |p: u8| Arg::Percent(i32::from(p));
            let figures = [percent(arrived), percent(room)];
            reasons.add(Code::ToleranceAboveVariation, &figures);
        }
    }

    /// The spindle's encoder, and the observer that follows it.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        Resolution {
            counts: self.encoder_counts(),
            timed: self.encoder_edge_time(),
            swing_known: self.spindle_swing() != 0,
            bandwidth_hz: self.observer_bandwidth_hz(),
            tick_us: self.tick_us(),
        }
    }

    /// True where a pass on the lead follows an angle that is learned.
    #[must_use]
    pub fn learns_spindle(&self) -> bool {
        self.resolution().is_learned()
    }

    /// The tracker that learns the spindle's angle, where one is needed.
    #[must_use]
    pub fn tracker(&self) -> Option<Tracker> {
        let resolution = self.resolution();
        resolution
            .is_learned()
            .then(|| Tracker::new(resolution.counts, resolution.tick_us, self.spindle_swing()))
    }

    /// The largest acceleration that reading whole counts can give `axis` on a lead; `None` where edges are timed.
    #[must_use]
    pub fn count_noise(&self, lead: Lead, axis: Axis) -> Option<Acceleration> {
        let ahead = Ticks::one_and(self.latency_us(axis), self.tick_us());
        let resolution = self.resolution();
        (!resolution.timed).then(|| resolution.noise(lead, ahead))
    }

    fn check_tapping<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let (tap, spindle) = (self.tap_max_rpm(), self.spindle_max_rpm());
        if tap > spindle {
            reasons.add(Code::TapSpeedAboveSpindle, &[speed(tap), speed(spindle)]);
        }
        // The flow, spindle, coolant, tapping spindle and subprogram codes.
        let code = self.tap_m_code();
        if matches!(code, 1..=5 | 8 | 9 | 24..=27 | 30 | 98 | 99) {
            reasons.add(Code::TapCodeTaken, &[Arg::Int(i64::from(code))]);
        }
        if self.tap_peck_return().nm() == 0 {
            reasons.add(Code::NoPeckReturn, &[]);
        }
        if self.tap_extract_by_j() && !self.tap_extract_override() {
            reasons.add(Code::ExtractionOverrideOff, &[]);
        }
    }

    /// Each value of the table is a row, of an M code that has no meaning of its own and no other row.
    fn check_functions<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        for value in self.function_values() {
            let row = FunctionRow::of(value);
            let means = row.is_some_and(|row| {
                !matches!(row.code, 1..=5 | 24..=27 | 29 | 30 | 98 | 99)
                    && self.function(row.code) == Some(row)
            });
            if value != 0 && !means {
                reasons.add(Code::FunctionUnusable, &[Arg::Int(value)]);
            }
        }
        if self.block_node() == 0
            && let Some(contact) = self.contact_of_block()
        {
            reasons.add(Code::BlockMissing, &[count(contact.into())]);
        }
        if !self.has_usable_turret() {
            reasons.add(Code::TurretUnusable, &[]);
        }
        if let Some(gear) = self.unusable_gear() {
            reasons.add(Code::GearUnusable, &[Arg::Int(gear.into())]);
        }
    }

    /// A zone that was meant and has no size would keep nothing away.
    fn check_zones<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let chuck = [self.chuck_length(), self.chuck_diameter()];
        let jaws = [self.jaws_length(), self.jaws_diameter()];
        for (sizes, numbers) in [(chuck, [9092, 9093]), (jaws, [9094, 9095])] {
            let [length, diameter] = numbers.map(count);
            match sizes.map(|size| size == Length::ZERO) {
                [true, false] => reasons.add(Code::ZoneHalf, &[length, diameter]),
                [false, true] => reasons.add(Code::ZoneHalf, &[diameter, length]),
                [true, true] | [false, false] => {}
            }
        }
    }

    /// A position loop has a gain that makes sense, where it is known.
    fn check_lags<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let axes = Axis::ALL.map(|axis| (9070, self.drive_gain(axis)));
        for (number, gain) in axes.into_iter().chain([(9073, self.spindle_drive_gain())]) {
            if (1..LOWEST_GAIN).contains(&gain) {
                reasons.add(Code::GainTooLow, &[count(number), count(gain)]);
            }
        }
    }

    /// What the drive of an axis takes of its targets leaves enough to move.
    fn check_targets<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        for axis in Axis::ALL {
            if let Some([jerk, acceleration]) = self.unusable_target(axis) {
                let share = |share: u64| Arg::Int(signed(share));
                let figures = [letter(axis), share(jerk), share(acceleration)];
                reasons.add(Code::TargetsTooSlow, &figures);
            }
        }
    }

    /// What is taken off for errors of the pitch is small, and within its part of the limits.
    fn check_pitch<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        let usable = |axis: &Axis| self.unusable_target(*axis).is_none();
        for axis in [Axis::X, Axis::Z].into_iter().filter(usable) {
            let tenths = |number: u64| Arg::Decimal(number as i64, 1);
            match self.unusable_pitch(axis) {
                Some(Unusable::Steep { point, slope }) => {
                    let figures = [letter(axis), count(point.into()), tenths(slope)];
                    reasons.add(Code::PitchErrorSteep, &figures);
                }
                Some(Unusable::Bent { point, share }) => {
                    let figures = [letter(axis), count(point.into()), tenths(share)];
                    reasons.add(Code::PitchErrorBent, &figures);
                }
                None => {}
            }
        }
    }

    /// Setpoints in one frame of CAN FD have a rate that its data can have.
    fn check_fd<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        if self.setpoint_frame() == 0 {
            return;
        }
        let (data, nominal) = (self.fd_kbit(), self.bus_kbit());
        if !DataRates::ALL.has(data) || data < nominal {
            reasons.add(Code::FdRate, &[count(data), count(nominal)]);
        }
    }

    /// Each drive has a number of its own; that none is the gateway's is said by their ranges.
    fn check_nodes<const ALL: bool>(&self, reasons: &mut Reasons<impl FnMut(Alarm), ALL>) {
        const PAIRS: [(Axis, Option<Axis>); 6] = [
            (Axis::X, Some(Axis::Z)),
            (Axis::X, Some(Axis::C)),
            (Axis::Z, Some(Axis::C)),
            // With any spindle.
            (Axis::X, None),
            (Axis::Z, None),
            (Axis::C, None),
        ];
        for (one, other) in PAIRS {
            let node = self.drive_node(one);
            let (from, drives) = match other {
                Some(axis) => (self.drive_node(axis), 1),
                None => (self.spindle_node(), self.tap_spindles()),
            };
            if node.wrapping_sub(from) < drives {
                let other = Arg::Letter(other.map_or(b'S', Axis::letter));
                let figures = [letter(one), other, count(node.into())];
                reasons.add(Code::DriveNodeTwice, &figures);
            }
        }
        let block = self.block_node();
        let taken = Axis::ALL.iter().any(|axis| self.drive_node(*axis) == block)
            || block.wrapping_sub(self.spindle_node()) < self.tap_spindles();
        if block != 0 && taken {
            reasons.add(Code::BlockNodeTaken, &[count(block.into())]);
        }
    }
}

/// Where the reasons go; all of them, or those that are no warnings.
struct Reasons<Report, const ALL: bool>(Report);

impl<Report: FnMut(Alarm), const ALL: bool> Reasons<Report, ALL> {
    // In place, where the code is known: so nothing is left of what nobody asks for.
    #[inline(always)]
    fn add(&mut self, code: Code, figures: &[Arg]) {
        if ALL || !code.is_warning() {
            self.put(code, figures);
        }
    }

    #[inline(never)]
    fn put(&mut self, code: Code, figures: &[Arg]) {
        (self.0)(Alarm::of(code, figures));
    }
}

/// In m/s², to a hundredth.
pub const fn metres(acceleration: Acceleration) -> Arg {
    Arg::Decimal(acceleration.nm_per_s2() / 10_000_000, 2)
}

const fn letter(axis: Axis) -> Arg {
    Arg::Letter(axis.letter())
}

fn count(number: u32) -> Arg {
    Arg::Int(i64::from(number))
}

fn speed(rpm: u32) -> Arg {
    Arg::Rpm(Rpm::new(i32::try_from(rpm).unwrap_or(i32::MAX)))
}

/// `n / d` rounded up, of a positive `d`.
fn ceil(n: i64, d: i64) -> i64 {
    let up = n.wrapping_add(d.wrapping_sub(1)) as u64;
    up.checked_div(d as u64)
        .map_or(i64::MAX, |ticks| ticks as i64)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::super::{Entry, Writing};
    use super::*;

    fn with(values: &[(&str, &str)]) -> Params {
        let mut params = Params::slant_bed();
        for (key, text) in values {
            let entry = Entry::find_text(key).unwrap();
            let raw = entry.parse(text, Writing::UnitOptional).unwrap();
            params.set(entry, raw).unwrap();
        }
        params
    }

    fn reasons(values: &[(&str, &str)]) -> Vec<(Code, [Arg; 4])> {
        let mut found = Vec::new();
        with(values).check(|alarm| found.push((alarm.code, alarm.args)));
        found
    }

    #[test]
    fn the_room_for_ramps_is_that_of_the_profile() {
        assert_eq!(PROFILE_TICKS, i64::from(crate::motion::CAPACITY));
    }

    #[test]
    fn the_built_in_machine_works() {
        assert_eq!(reasons(&[]), []);
        assert_eq!(Params::slant_bed().validate(), Ok(()));
    }

    #[test]
    fn every_reason_can_be_provoked_alone_and_ends_at_its_limit() {
        let x = Arg::Letter(b'X');
        let z = Arg::Letter(b'Z');
        let none = Arg::None;
        let rpm = |n| Arg::Rpm(Rpm::new(n));
        // What provokes it, the reason with its figures, and the nearest set that is still good.
        type Case<'a> = (
            &'a [(&'a str, &'a str)],
            Code,
            [Arg; 4],
            &'a [(&'a str, &'a str)],
        );
        let cases: &[Case] = &[
            (
                // 16 000 mm/min at 0.13 m/s²: 2052 ticks, and 50 ticks of C from its acceleration.
                &[("1620.Z", "0.13")],
                Code::RampTooLong,
                [z, Arg::Int(2102), Arg::Int(2048), none],
                // 1 998 ticks and the 50 of C: exactly what a profile holds.
                &[("1620.Z", "0.13347")],
            ),
            (
                // 20 000 °/s² at 5 000 °/s³ are 4 000 ticks, in addition to the 360 to its speed.
                &[("1622.C", "5000")],
                Code::RampTooLong,
                [Arg::Letter(b'C'), Arg::Int(4360), Arg::Int(2048), none],
                // 1 688 ticks and the 360.
                &[("1622.C", "11848.35")],
            ),
            (
                &[("1320.X", "-300")],
                Code::SoftLimitsInverted,
                [x, none, none, none],
                &[("1320.X", "-299.999")],
            ),
            (
                &[("1430.X", "12000.000001")],
                Code::FeedAboveRapid,
                [x, none, none, none],
                &[("1430.X", "12000")],
            ),
            (
                // At half of 10⁶ / 1000 Hz; below it the warning alone is left, which is another case.
                &[("9005", "500")],
                Code::ObserverTooFast,
                [Arg::Int(500), Arg::Int(1000), Arg::Int(500), none],
                &[("9005", "79")],
            ),
            (
                &[("9005", "80")],
                Code::ObserverNoisy,
                [Arg::Int(80), Arg::Int(1000), Arg::Int(79), none],
                &[("9005", "79")],
            ),
            (
                &[("3720", "15"), ("9006.0", "0")],
                Code::EncoderCoarse,
                [Arg::Int(15), Arg::Int(16), none, none],
                &[("3720", "16"), ("9006.0", "0")],
            ),
            (
                &[("9001.C", "1600")],
                Code::IncrementTooFine,
                [Arg::Letter(b'C'), none, none, none],
                &[("9001.C", "1599")],
            ),
            (
                // 2²⁴ µ° in a millisecond are 1 006 632.96 °/min.
                &[
                    ("1420.C", "1006632.96"),
                    ("1620.C", "1000000"),
                    ("1622.C", "100000000"),
                ],
                Code::RapidBeyondTick,
                [Arg::Letter(b'C'), Arg::Int(1000), none, none],
                &[
                    ("1420.C", "1006632.9"),
                    ("1620.C", "1000000"),
                    ("1622.C", "100000000"),
                ],
            ),
            (
                &[("3772", "30000")],
                Code::SpindleTooFastForTick,
                [rpm(30_000), Arg::Int(1000), rpm(29_999), none],
                &[("3772", "29999")],
            ),
            (
                &[("9001.Z", "215")],
                Code::TravelBeyondDrive,
                [z, none, none, none],
                &[("9001.Z", "214")],
            ),
            (
                &[("1828.X", "0.001"), ("9002.X", "1001")],
                Code::IncrementAboveLimit,
                [x, none, none, none],
                &[("1828.X", "0.001"), ("9002.X", "1000")],
            ),
            (
                &[("9015.C", "16")],
                Code::DriveNodeTwice,
                [x, Arg::Letter(b'C'), Arg::Int(16), none],
                &[("9015.C", "19")],
            ),
            (
                // The last of four spindles.
                &[("9015.Z", "35")],
                Code::DriveNodeTwice,
                [z, Arg::Letter(b'S'), Arg::Int(35), none],
                &[("9015.Z", "35"), ("9014", "3")],
            ),
            (
                &[("9016", "18")],
                Code::DriveNodeTwice,
                [Arg::Letter(b'C'), Arg::Letter(b'S'), Arg::Int(18), none],
                &[("9016", "19")],
            ),
            (
                &[("9007", "16")],
                Code::ToleranceAboveVariation,
                [Arg::Percent(16), Arg::Percent(15), none, none],
                &[("9007", "15")],
            ),
            (
                &[("9070.Z", "49")],
                Code::GainTooLow,
                [Arg::Int(9070), Arg::Int(49), none, none],
                &[("9070.Z", "50")],
            ),
            (
                &[("9073", "1")],
                Code::GainTooLow,
                [Arg::Int(9073), Arg::Int(1), none, none],
                &[("9073", "0")],
            ),
            (
                &[("9077.Z", "16000"), ("9070.Z", "150")],
                Code::TargetsTooSlow,
                [z, Arg::Int(0), Arg::Int(100), none],
                &[("9077.Z", "17000"), ("9070.Z", "150")],
            ),
            (
                // Without a lag to take off.
                &[("9077.X", "11999")],
                Code::TargetsTooSlow,
                [x, Arg::Int(0), Arg::Int(100), none],
                &[("9077.X", "12000")],
            ),
            (
                &[("9078.Z", "0.2")],
                Code::TargetsTooSlow,
                [z, Arg::Int(100), Arg::Int(6), none],
                &[("9078.Z", "0.3")],
            ),
            (
                // Its table is not judged by limits that are no limits.
                &[("9077.Z", "16000"), ("1874.Z", "10")],
                Code::TargetsTooSlow,
                [z, Arg::Int(0), Arg::Int(100), none],
                &[("9077.Z", "17000"), ("1874.Z", "10")],
            ),
            (
                // 100.1 µm in 20 mm.
                &[("1874.Z", "-100.1")],
                Code::PitchErrorSteep,
                [z, Arg::Int(3), Arg::Decimal(51, 1), none],
                &[("1874.Z", "-10")],
            ),
            (
                &[("1862.X", "2"), ("1880.X", "5")],
                Code::PitchErrorBent,
                [x, Arg::Int(9), Arg::Decimal(2380, 1), none],
                &[("1862.X", "20"), ("1880.X", "5")],
            ),
            (
                &[("3772", "2999")],
                Code::TapSpeedAboveSpindle,
                [rpm(3000), rpm(2999), none, none],
                &[("3772", "2999"), ("5241", "2999")],
            ),
            (
                &[("5210", "30")],
                Code::TapCodeTaken,
                [Arg::Int(30), none, none, none],
                &[("5210", "31")],
            ),
            (
                &[("5213", "0")],
                Code::NoPeckReturn,
                [none; 4],
                &[("5213", "0.001")],
            ),
            (
                &[("5201.4", "1")],
                Code::ExtractionOverrideOff,
                [none; 4],
                &[("5201.4", "1"), ("5200.4", "1")],
            ),
        ];
        for (bad, code, args, good) in cases {
            assert_eq!(reasons(bad), [(*code, *args)], "{bad:?}");
            assert_eq!(reasons(good), [], "{good:?}");
            let refused = with(bad).validate().map_err(|alarm| alarm.code);
            let expected = if code.is_warning() {
                Ok(())
            } else {
                Err(*code)
            };
            assert_eq!(refused, expected);
        }
    }

    #[test]
    fn just_below_the_limit_of_an_observer_it_is_only_doubtful() {
        let found = reasons(&[("9005", "499")]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, Code::ObserverNoisy);
    }

    #[test]
    fn one_frame_for_all_setpoints_is_for_boards_that_send_it_at_rates_there_are() {
        let asks = ("9031", "1");
        for (kbit, is_rate) in [
            ("1000", true),
            ("2000", true),
            ("4000", true),
            ("5000", true),
            ("8000", true),
            ("3000", false),
            ("7999", false),
        ] {
            let found = reasons(&[asks, ("9032", kbit)]);
            assert_eq!(found.is_empty(), is_rate, "{kbit}");
            // Nobody asks for the rate of what is not sent.
            assert_eq!(reasons(&[("9032", kbit)]), []);
        }
        let slow = reasons(&[asks, ("9032", "3000")]);
        assert_eq!((slow.len(), slow[0].0), (1, Code::FdRate));
    }

    #[test]
    fn an_axis_without_limits_may_have_any_increment() {
        let values = [("1320.C", "none"), ("1321.C", "none"), ("9001.C", "1000")];
        assert_eq!(reasons(&values), []);
    }

    #[test]
    fn the_edges_of_every_range_are_checked_without_harm() {
        for entry in Entry::all() {
            for raw in [entry.min(), entry.max()] {
                let mut params = Params::slant_bed();
                params.set(entry, raw).unwrap();
                params.check(|_| {});
            }
        }
        // All at once: the largest and the smallest ramps there are.
        for pick in [|e: &Entry| e.min(), |e: &Entry| e.max()] {
            let mut params = Params::slant_bed();
            for entry in Entry::all() {
                params.set(entry, pick(entry)).unwrap();
            }
            assert!(params.validate().is_err());
        }
    }
}
