//! The spindle's encoder of a machine of the soak, and how far a thread may be beside its helix by it.

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Lead};

use super::script::Draws;
use crate::params::set;

/// What an encoder tells of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Many counts, or fewer with the times of their edges: the observer is followed.
    Fine,
    /// Few counts with the times of their edges: the angle is learned.
    FewTimed,
    /// Few counts without times: the angle is learned.
    Few,
}

impl Class {
    /// In the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Fine, Self::FewTimed, Self::Few];

    /// As a line of the report names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fine => "by an encoder that the observer follows",
            Self::FewTimed => "by few timed counts",
            Self::Few => "by few counts without times",
        }
    }

    /// The class of a machine's encoder.
    pub fn of(params: &Params) -> Self {
        let resolution = params.resolution();
        match (resolution.is_learned(), resolution.timed) {
            (false, _) => Self::Fine,
            (true, true) => Self::FewTimed,
            (true, false) => Self::Few,
        }
    }
}

/// How often the spindle swings, in thousandths of a hertz; 0 for one that does not.
pub fn swing_mhz(options: &PlantOptions) -> u32 {
    options.ripple.map_or(0, Ripple::milli_hertz)
}

/// A swing that the encoder cannot learn: it has few counts, and nobody has given the frequency.
pub fn is_unknown(params: &Params, swing_mhz: u32) -> bool {
    swing_mhz != 0 && params.learns_spindle() && params.spindle_swing() == 0
}

/// Another encoder than the built-in one, in half of the machines. [`swing_mhz`] is that of their spindle.
pub fn draw(r: &mut Draws, params: &mut Params, swing_mhz: u32) {
    let (low, high, timed) = match r.within(0, 9) {
        0 => (1_024, 100_000, 0),
        1 => (60, 100_000, 1),
        2 => (16, 59, 1),
        3 => (16, 1_023, 0),
        4 => (4, 100_000, r.within(0, 1)),
        _ => return,
    };
    // As many coarse ones as fine ones.
    let counts = r.within(0, 1_000) as f64 / 1_000.0;
    let counts = f64::from(low) * (f64::from(high) / f64::from(low)).powf(counts);
    let mut other = params.clone();
    set(&mut other, "3720", counts as i64);
    set(&mut other, "9006.0", timed);
    // What a maker has measured is known within one per cent.
    let known = r.chance(50);
    if known {
        let off = r.within(-10, 10);
        let swing = i64::from(swing_mhz);
        set(&mut other, "9034", swing + swing * off / 1_000);
    }
    if other.validate().is_ok() {
        *params = other;
    }
}

/// How far few counts may be off where nobody has told how the spindle swings, in nanometres.
pub const UNKNOWN_NM: i64 = 200_000;

/// The largest distance of a thread from its helix, in nanometres, for any lead, speed, tick and ripple of these machines.
pub fn beside(params: &Params, swing_mhz: u32) -> i64 {
    const FINE: i64 = 8_000;
    match Class::of(params) {
        Class::Fine => FINE,
        _ if is_unknown(params, swing_mhz) => UNKNOWN_NM,
        // The frequency is known within one per cent, and has to be learned. 9035 limits what the encoder does not tell
        // (4277) and, apart from that, how far an axis is from what is learned (4276): both seldom come together.
        _ if swing_mhz != 0 => params.encoder_error().nm() * 3 / 2,
        Class::FewTimed => FINE,
        // One and a half times the way in a tick.
        Class::Few => FASTEST_NM_PER_S * i64::from(params.tick_us()) * 3 / 2_000_000 + FINE,
    }
}

/// What reading whole counts adds to the acceleration of an axis that follows the observer, in nm/s².
pub fn noise(params: &Params, axis: Axis) -> f64 {
    let longest = Lead::new(4_000_000, 1).expect("a lead");
    let noise = match Class::of(params) {
        Class::Fine => params.count_noise(longest, axis),
        Class::FewTimed | Class::Few => None,
    };
    noise.map_or(0.0, |noise| noise.nm_per_s2() as f64)
}

/// The fastest threads: five metres a minute.
pub const FASTEST_NM_PER_S: i64 = 83_333_333;
