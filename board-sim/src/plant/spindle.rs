//! The spindle: inertia, ripple, and an exact angle.
//!
//! The speed follows the command along a ramp of so many milliseconds per 1000 rpm. The ripple is added to the ramped
//! speed, a sine of a percentage of it: `speed = ramped · (1 + ripple · sin φ)`, φ = 0 where the command leaves zero
//! and the spindle stands. Both have closed integrals, and this module uses them: however long the spindle runs, its
//! angle is that of the formula. Between two ticks a spindle passes through at most three [`Piece`]s of constant
//! acceleration, each in one direction. So an event at a certain angle (an encoder edge) has a certain time.
//!
//! Inner units. The speed counts in 1/`ramp` thousandths of a turn per minute (`ramp` in milliseconds per 1000 rpm).
//! Then the ramp is exactly one such unit per nanosecond, and twice the integral over nanoseconds is a whole number of
//! 1/(1.2·10¹⁴ · ramp) turns.

use super::sine::{PLACES, sin_cos};
use leadscrew_core::bus::MilliRpm;
use leadscrew_core::units::Turns;

/// A true spindle angle in 2⁻⁶⁴ turns, continuous, positive M03; the index is at every whole turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FineTurns(i128);

impl FineTurns {
    /// The angle in 2⁻⁶⁴ turns.
    #[must_use]
    pub const fn raw(self) -> i128 {
        self.0
    }

    /// An angle given in 2⁻³² turns.
    #[must_use]
    pub const fn from_turns(turns: Turns) -> Self {
        Self((turns.raw() as i128) << 32)
    }

    /// Rounded to 2⁻³² turns.
    #[must_use]
    pub const fn turns(self) -> Turns {
        Turns::from_raw((self.0.wrapping_add(1 << 31) >> 32) as i64)
    }

    /// The angle at `part` of `whole` on a straight line from this angle to `other`; `other` where `whole` is 0.
    #[must_use]
    pub const fn towards(self, other: Self, part: u32, whole: u32) -> Self {
        let way = other.0.wrapping_sub(self.0).wrapping_mul(part as i128);
        match way.checked_div(whole as i128) {
            Some(way) => Self(self.0.wrapping_add(way)),
            None => other,
        }
    }

    /// The angle of `raw` · 2⁻¹⁶ increments; a turn has `per_turn` increments.
    #[must_use]
    pub const fn of_fine_increments(raw: i64, per_turn: u32) -> Self {
        let scaled = (raw as i128) << 48;
        let half = (per_turn >> 1) as i128;
        match scaled
            .wrapping_add(half)
            .checked_div_euclid(per_turn as i128)
        {
            Some(angle) => Self(angle),
            None => Self(0),
        }
    }

    /// The nearest increment, not wrapped; a turn has `per_turn` increments.
    #[must_use]
    pub const fn increments(self, per_turn: u32) -> i64 {
        let scaled = self.0.wrapping_mul(per_turn as i128);
        (scaled.wrapping_add(1 << 63) >> 64) as i64
    }

    /// A drive counts its increments in 32 bits, so several angles look the same to it. This gives the one nearest to
    /// `told`.
    #[must_use]
    pub const fn near(self, told: Turns, per_turn: u32) -> Self {
        let own = Self::from_turns(told).increments(per_turn);
        let apart = self.increments(per_turn).wrapping_sub(own);
        let rounds = apart.wrapping_add(1 << 31) >> 32;
        let round = (rounds as i128)
            .wrapping_shl(96)
            .checked_div_euclid(per_turn as i128);
        match round {
            Some(round) => Self(self.0.wrapping_sub(round)),
            None => self,
        }
    }

    /// Rounded to millionths of a turn.
    #[must_use]
    pub const fn micro_turns(self) -> i64 {
        (self.0.wrapping_mul(1_000_000).wrapping_add(1 << 63) >> 64) as i64
    }
}

/// Ripple of the spindle speed: a sine whose amplitude is a part of the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ripple {
    milli_percent: u32,
    milli_hertz: u32,
}

impl Ripple {
    /// Amplitude in thousandths of a percent, up to 90 %, and frequency in thousandths of a hertz, 0.01 to 1000 Hz;
    /// `None` outside these limits.
    #[must_use]
    pub const fn new(milli_percent: u32, milli_hertz: u32) -> Option<Self> {
        match (milli_percent, milli_hertz) {
            (0..=90_000, 10..=1_000_000) => Some(Self {
                milli_percent,
                milli_hertz,
            }),
            _ => None,
        }
    }

    /// Its amplitude in thousandths of a percent.
    #[must_use]
    pub const fn milli_percent(self) -> u32 {
        self.milli_percent
    }

    /// How often the speed swings, in thousandths of a hertz; 0 where the amplitude is 0.
    #[must_use]
    pub const fn milli_hertz(self) -> u32 {
        if self.milli_percent == 0 {
            0
        } else {
            self.milli_hertz
        }
    }
}

/// The ripple's part of the angle, as factors of the speed and of the acceleration.
#[derive(Clone, Copy, Debug)]
struct Gain {
    /// Turns per speed unit, in 2⁻⁹⁶: amplitude / ω.
    speed: i128,
    /// Turns at the ramp's acceleration, in 2⁻⁶⁴: amplitude · acceleration / ω².
    acceleration: i128,
    milli_percent: u32,
    milli_hertz: u32,
}

impl Gain {
    const NONE: Self = Self {
        speed: 0,
        acceleration: 0,
        milli_percent: 0,
        milli_hertz: 0,
    };
    /// 2⁹⁶ / 2π.
    const RADIAN_96: i128 = 12_609_553_696_233_175_933_233_255_924;
    /// 2⁶⁰ / 2π.
    const RADIAN_60: i128 = 183_493_156_455_125_077;

    fn new(ripple: Ripple, ramp: i64) -> Self {
        let hertz = i128::from(ripple.milli_hertz);
        let divisor = hertz.wrapping_mul(i128::from(ramp).wrapping_mul(6_000_000));
        let speed = Self::RADIAN_96
            .wrapping_mul(i128::from(ripple.milli_percent))
            .checked_div(divisor)
            .unwrap_or(0);
        // The ramp is 10⁹ units a second and ω = 2π · hertz / 1000. The product is made in two halves to keep the
        // digits: this is below 2⁹².
        let turns = (speed >> 32)
            .wrapping_mul(1_000_000_000_000)
            .checked_div(hertz)
            .unwrap_or(0);
        let acceleration = ((turns >> 40).wrapping_mul(Self::RADIAN_60) >> 20)
            .wrapping_add((turns & 0xFF_FFFF_FFFF).wrapping_mul(Self::RADIAN_60) >> 60);
        Self {
            speed,
            acceleration,
            milli_percent: ripple.milli_percent,
            milli_hertz: ripple.milli_hertz,
        }
    }
}

/// A turn of the ripple's phase, in 10⁻¹² turns.
const PHASE_TURN: u64 = 1_000_000_000_000;

/// The ripple's phase (10⁻¹² turns) after `ns` nanoseconds, within a turn.
fn phase_after(phase: u64, milli_hertz: u32, ns: u64) -> u64 {
    // 10⁻³ Hz · 10⁻⁹ s is the unit of the phase.
    phase.wrapping_add(u64::from(milli_hertz).wrapping_mul(ns)) % PHASE_TURN
}

fn sin_cos_of(phase: u64) -> (i128, i128) {
    /// 2¹⁰³ / 10¹².
    const FACTOR: u128 = 10_141_204_801_825_835_212;
    let turns = (u128::from(phase).wrapping_mul(FACTOR) >> 39) as u64;
    let (sine, cosine) = sin_cos(turns);
    (i128::from(sine), i128::from(cosine))
}

/// A span of time with constant acceleration, in one direction of turning.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    duration: u64,
    /// Ramped angle at the start, in 1/`turn` turns.
    base: i128,
    turn: i128,
    /// Added to the ramped angle, in 2⁻⁶⁴ turns, without the ripple.
    offset: i128,
    speed: i64,
    /// −1, 0 or 1.
    slope: i64,
    gain: Gain,
    phase: u64,
}

impl Piece {
    /// The duration in nanoseconds.
    #[must_use]
    pub const fn duration(&self) -> u64 {
        self.duration
    }

    /// The angle `ns` nanoseconds after the start; `ns` is at most the duration.
    #[must_use]
    pub fn angle(&self, ns: u64) -> FineTurns {
        let base = self.base_after(ns);
        let whole = base.checked_div_euclid(self.turn).unwrap_or(0);
        let rest = base.wrapping_sub(whole.wrapping_mul(self.turn));
        // `turn` is below 2⁶³, and so is the remainder.
        let part = (rest << 64).checked_div(self.turn).unwrap_or(0);
        FineTurns(
            (whole << 64)
                .wrapping_add(part)
                .wrapping_add(self.offset)
                .wrapping_add(self.ripple(ns)),
        )
    }

    fn base_after(&self, ns: u64) -> i128 {
        let time = i128::from(ns);
        let twice_the_mean = i128::from(self.speed)
            .wrapping_mul(2)
            .wrapping_add(i128::from(self.slope).wrapping_mul(time));
        self.base.wrapping_add(twice_the_mean.wrapping_mul(time))
    }

    fn speed_after(&self, ns: u64) -> i64 {
        self.speed.wrapping_add(self.slope.wrapping_mul(ns as i64))
    }

    /// ∫ speed · ripple · sin φ, up to a constant: −speed·cos φ/ω + acceleration·sin φ/ω².
    fn ripple(&self, ns: u64) -> i128 {
        if self.gain.milli_percent == 0 {
            return 0;
        }
        let (sine, cosine) = sin_cos_of(phase_after(self.phase, self.gain.milli_hertz, ns));
        let by_speed = i128::from(self.speed_after(ns)).wrapping_mul(self.gain.speed) >> 32;
        let by_acceleration = i128::from(self.slope).wrapping_mul(self.gain.acceleration);
        (by_acceleration.wrapping_mul(sine) >> PLACES)
            .wrapping_sub(by_speed.wrapping_mul(cosine) >> PLACES)
    }
}

/// The spindle.
#[derive(Clone, Copy, Debug)]
pub struct Spindle {
    /// Milliseconds per 1000 rpm.
    ramp: i64,
    /// Units of `base` in a turn.
    turn: i128,
    base: i128,
    /// The initial angle and the ripple's constant of integration, in 2⁻⁶⁴ turns.
    offset: i128,
    commanded: MilliRpm,
    /// Ramped speed, in 1/ramp thousandths of a turn per minute.
    speed: i64,
    gain: Gain,
    phase: u64,
    load_percent: i16,
}

impl Spindle {
    /// The slowest ramp, in milliseconds per 1000 rpm.
    pub const SLOWEST_RAMP: u32 = 60_000;

    /// A spindle that stands at `angle`, with a ramp of `ramp_ms` milliseconds per 1000 rpm, 1 to
    /// [`Spindle::SLOWEST_RAMP`]; `None` outside these limits.
    #[must_use]
    pub fn new(ramp_ms: u32, ripple: Option<Ripple>, angle: Turns) -> Option<Self> {
        if ramp_ms == 0 || ramp_ms > Self::SLOWEST_RAMP {
            return None;
        }
        let ramp = i64::from(ramp_ms);
        Some(Self {
            ramp,
            turn: i128::from(ramp).wrapping_mul(120_000_000_000_000),
            base: 0,
            offset: FineTurns::from_turns(angle).raw(),
            commanded: MilliRpm::STOPPED,
            speed: 0,
            gain: ripple.map_or(Gain::NONE, |ripple| Gain::new(ripple, ramp)),
            phase: 0,
            load_percent: 100,
        })
    }

    /// Commands a speed.
    pub fn command(&mut self, speed: MilliRpm) {
        if self.commanded == MilliRpm::STOPPED && self.speed == 0 {
            // At speed zero the ripple is zero: the phase may jump without a jump of the angle.
            self.phase = 0;
        }
        self.commanded = speed;
    }

    /// Changes the spindle's speed to `percent` of the command, along the same ramp. 100: undisturbed; 0: stopped
    /// against the command; above 100: overspeed; below 0: dragged backwards.
    pub const fn disturb(&mut self, percent: i16) {
        self.load_percent = percent;
    }

    /// The angle now.
    #[must_use]
    pub fn angle(&self) -> FineTurns {
        self.piece(0, 0).angle(0)
    }

    /// The speed now, ripple included, in whole thousandths.
    #[must_use]
    pub fn speed(&self) -> MilliRpm {
        let (sine, _) = sin_cos_of(self.phase);
        let speed = i128::from(self.speed);
        let ripple = speed
            .wrapping_mul(i128::from(self.gain.milli_percent))
            .wrapping_mul(sine)
            .checked_div(100_000 << PLACES)
            .unwrap_or(0);
        let speed = speed
            .wrapping_add(ripple)
            .checked_div(i128::from(self.ramp))
            .unwrap_or(0);
        MilliRpm::new(speed.clamp(i128::from(i32::MIN), i128::from(i32::MAX)) as i32)
    }

    /// True while the spindle does not turn.
    #[must_use]
    pub const fn stands(&self) -> bool {
        self.speed == 0
    }

    /// Lets `ns` nanoseconds pass, and shows each piece of this time in order.
    pub fn advance(&mut self, ns: u64, mut show: impl FnMut(&Piece)) {
        let target = i64::from(self.commanded.get())
            .saturating_mul(i64::from(self.load_percent))
            .saturating_mul(self.ramp)
            / 100;
        let mut left = ns;
        // First down to a standstill, then up in the other direction, then constant.
        for _ in 0..3 {
            if left == 0 {
                break;
            }
            let reverses = self.speed.signum().wrapping_mul(target.signum()) < 0;
            let next = if reverses { 0 } else { target };
            let difference = next.wrapping_sub(self.speed);
            let duration = match difference {
                0 => left,
                _ => left.min(difference.unsigned_abs()),
            };
            let piece = self.piece(difference.signum(), duration);
            show(&piece);
            self.follow(&piece);
            left = left.wrapping_sub(duration);
        }
    }

    /// In position mode: turns to `angle` in `ns` nanoseconds, at one speed. The drive makes the angle exact. When it
    /// lets go, the spindle coasts on at the speed of this span.
    pub fn turn_to(&mut self, angle: FineTurns, ns: u64, show: impl FnOnce(&Piece)) {
        // From turns to units of the base, in two halves: a span is a few turns at most, and `turn` is below 2⁶³.
        let way = angle.raw().wrapping_sub(self.angle().raw());
        let units = (way >> 32).wrapping_mul(self.turn) >> 32;
        let twice = i128::from(ns).wrapping_mul(2);
        let speed = units.checked_div(twice).unwrap_or(0);
        self.commanded = MilliRpm::STOPPED;
        self.speed = speed as i64;
        self.phase = 0;
        let mut piece = self.piece(0, ns);
        piece.gain = Gain::NONE;
        piece.offset = 0;
        piece.offset = angle.raw().wrapping_sub(piece.angle(ns).raw());
        show(&piece);
        self.base = piece.base_after(ns);
        self.offset = piece.offset.wrapping_sub(self.steady_ripple());
    }

    fn piece(&self, slope: i64, duration: u64) -> Piece {
        let piece = Piece {
            duration,
            base: self.base,
            turn: self.turn,
            offset: self.offset,
            speed: self.speed,
            slope,
            gain: self.gain,
            phase: self.phase,
        };
        // The angle is continuous where the acceleration jumps, although the ripple's acceleration term jumps.
        let offset = self
            .offset
            .wrapping_add(self.steady_ripple())
            .wrapping_sub(piece.ripple(0));
        Piece { offset, ..piece }
    }

    fn follow(&mut self, piece: &Piece) {
        let duration = piece.duration;
        self.base = piece.base_after(duration);
        self.speed = piece.speed_after(duration);
        self.phase = phase_after(self.phase, self.gain.milli_hertz, duration);
        self.offset = piece
            .offset
            .wrapping_add(piece.ripple(duration))
            .wrapping_sub(self.steady_ripple());
    }

    /// The ripple's part of the angle at constant speed.
    fn steady_ripple(&self) -> i128 {
        Piece {
            duration: 0,
            base: 0,
            turn: self.turn,
            offset: 0,
            speed: self.speed,
            slope: 0,
            gain: self.gain,
            phase: self.phase,
        }
        .ripple(0)
    }
}
