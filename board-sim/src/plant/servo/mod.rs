//! A drive as it is: how an axis follows its targets through interpolation, three loops, friction and mass.
//!
//! The drive interpolates between the targets that SYNC has latched ([`Path`]), in [`STEPS`] inner steps a period. In
//! each step the position loop with its feed-forward wants a speed, the speed loop (PI) wants an acceleration, and the
//! current follows that within its limit. Friction, mass and the play of the screw come behind. The position loop sees the
//! encoder, which counts; the load is behind the play, and beside by the errors of the pitch; nobody on the bus sees it.
//!
//! It is all integers with one rounding shift a product, so a machine moves alike on every computer. Positions are
//! nanometres in 2⁻¹⁶, speeds nanometres a step in 2⁻³², accelerations nanometres a step² in 2⁻⁴⁰.
//!
//! This must not know frames, power states and parameters.

mod grid;
mod options;
mod path;
#[cfg(test)]
mod tests;

pub use options::{Following, Interpolation, Late, ScrewErrors, ServoOptions};

use self::options::Constants;
use self::path::Path;
use leadscrew_core::bus::Increments;

/// Binary logarithm of [`STEPS`].
const STEPS_LOG: u32 = 3;
/// Inner steps of a SYNC period.
const STEPS: i64 = 1 << STEPS_LOG;

/// Inner steps that are kept: the oldest age, and one more to go between.
const PAST: usize = STEPS as usize * ServoOptions::OLDEST as usize + 2;

/// The farthest position, in 2⁻¹⁶ nanometres: 2⁴² nanometres.
const FARTHEST: i64 = 1 << 58;

/// Emergency for a following error that is too large for too long.
const FOLLOWING: u16 = 0x8611;
/// Emergency for an RPDO that has not come in time, by CiA 301.
const RPDO_TIMEOUT: u16 = 0x8250;

/// A drive with its axis.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    constants: Constants,
    path: Path,
    /// Position of the motor, as that of the axis.
    z: i64,
    v: i64,
    a: i64,
    /// The integral part of the speed loop.
    integral: i64,
    /// Position of the tool, behind the play.
    load: i64,
    /// The motor after the last inner steps, the newest first: 6064h may be of some time ago.
    past: [i64; PAST],
    /// Where the interpolation was at the last step.
    wanted: i64,
    /// Microseconds for which the following error has been too large.
    beyond_us: u32,
    /// SYNCs in a row without a new target.
    missed: u8,
}

impl Servo {
    /// An axis at rest in the middle of its play. `None` where an option is out of its range, or the tick is.
    #[must_use]
    pub fn new(
        options: &ServoOptions,
        increments: (u32, u32),
        tick_us: u32,
        at: Increments,
    ) -> Option<Self> {
        let constants = Constants::new(options, increments, tick_us)?;
        let z = constants.scale.place(i64::from(at.get()));
        Some(Self {
            constants,
            path: Path::new(z, options.buffer, options.interpolation),
            z,
            v: 0,
            a: 0,
            integral: 0,
            load: z,
            past: [z; PAST],
            wanted: z,
            beyond_us: 0,
            missed: 0,
        })
    }

    /// Stops at the present position and forgets all targets that wait.
    pub fn stop(&mut self) {
        self.rest_at(self.z);
    }

    /// Is put to this count, at rest.
    pub fn stand_at(&mut self, count: i64) {
        self.rest_at(self.constants.scale.place(count));
    }

    fn rest_at(&mut self, z: i64) {
        self.path.stand(z);
        self.z = z;
        self.past = [z; PAST];
        self.wanted = z;
        (self.v, self.a, self.integral) = (0, 0, 0);
        (self.beyond_us, self.missed) = (0, 0);
        self.take_load_along();
    }

    /// The drive counts otherwise from now on; motor and load stay where they are.
    pub fn count_from(&mut self, count: i64) {
        let z = self.constants.scale.place(count);
        let play = self.load.saturating_sub(self.z);
        self.load = z.saturating_add(play);
        self.rest_at(z);
    }

    /// Latches a target. `fresh`: it has come since the last SYNC. Gives an emergency where the drive does not bear it.
    pub fn latch(&mut self, target: Increments, fresh: bool) -> Option<u16> {
        if fresh {
            self.missed = 0;
        } else {
            self.missed = self.missed.saturating_add(1);
        }
        match self.constants.late {
            Some(late) if self.missed >= late.fault => return Some(RPDO_TIMEOUT),
            Some(late) if self.missed > 0 && self.missed <= late.extrapolate => {
                self.path.extrapolate();
            }
            _ => {
                let place = self.constants.scale.place(i64::from(target.get()));
                self.path.push(place);
            }
        }
        None
    }

    /// Lets a SYNC period pass with torque. Gives an emergency where the following error is too large for too long.
    pub fn period(&mut self, following: Following) -> Option<u16> {
        for part in 1..=STEPS {
            let (place, speed) = self.path.at(part);
            self.step(place, speed);
        }
        let error = i64::from(self.following_error().get()).unsigned_abs();
        if following.window == Following::OFF || error <= u64::from(following.window) {
            self.beyond_us = 0;
            return None;
        }
        self.beyond_us = self.beyond_us.saturating_add(self.constants.tick_us);
        let patience = u32::from(following.timeout_ms).saturating_mul(1000);
        (self.beyond_us > patience).then_some(FOLLOWING)
    }

    /// An inner step: the interpolation is at this place and has this speed.
    fn step(&mut self, place: i64, speed: i128) {
        let c = &self.constants;
        self.wanted = place;
        let error = place.saturating_sub(c.encoder.seen(self.z));
        let by_position = product(c.kv, error, 16);
        let ahead = rounded(i128::from(c.feed_forward).saturating_mul(speed), 16);
        let wanted = within(by_position.saturating_add(ahead), c.speed_limit);
        let missing = wanted.saturating_sub(self.v);
        self.ask(missing);
        self.give_way();
        self.z = self
            .z
            .saturating_add(rounded(i128::from(self.v), 16) as i64)
            .clamp(FARTHEST.wrapping_neg(), FARTHEST);
        self.past.rotate_right(1);
        self.past[0] = self.z;
        self.take_load_along();
    }

    /// The speed loop wants an acceleration for the speed that is missing, and the current follows it.
    fn ask(&mut self, missing: i64) {
        let c = &self.constants;
        let limit = c.acceleration_limit;
        let direct = product(c.speed_gain, missing, 24);
        let asked = direct.saturating_add(i128::from(self.integral));
        let clamped = asked.unsigned_abs() > u128::from(limit.unsigned_abs());
        if !clamped || asked.signum() != i128::from(missing.signum()) {
            let more = product(c.integral_gain, missing, 24);
            self.integral = within(i128::from(self.integral).saturating_add(more), limit);
        }
        let asked = within(direct.saturating_add(i128::from(self.integral)), limit);
        let change = product(c.current, asked.saturating_sub(self.a), 32);
        self.a = self.a.saturating_add(change as i64);
    }

    /// Friction and mass.
    fn give_way(&mut self) {
        let c = &self.constants;
        if self.v == 0 && self.a.unsigned_abs() <= c.sticking.unsigned_abs() {
            return;
        }
        let way = if self.v == 0 { self.a } else { self.v }.signum();
        let net = i128::from(self.a)
            .saturating_sub(i128::from(c.sliding.saturating_mul(way)))
            .saturating_sub(product(c.viscous, self.v, 24));
        let next = self.v.saturating_add(rounded(net, 8) as i64);
        let rubs = c.sticking > 0 || c.sliding > 0;
        self.v = if rubs && next.signum() == way.wrapping_neg() {
            0
        } else {
            next
        };
    }

    fn take_load_along(&mut self) {
        let half = self.constants.half_play;
        self.load = self
            .load
            .clamp(self.z.saturating_sub(half), self.z.saturating_add(half));
    }

    /// 6064h: what the encoder says, or has said at its age.
    #[must_use]
    pub fn actual(&self) -> Increments {
        let age = self.constants.age;
        let back = usize::try_from(age >> 16).unwrap_or(0);
        let at = |back: usize| self.past.get(back).copied().unwrap_or(self.z);
        let (later, earlier) = (at(back), at(back.saturating_add(1)));
        let part = product(earlier.saturating_sub(later), age & 0xffff, 16) as i64;
        let seen = self.constants.encoder.seen(later.saturating_add(part));
        Increments::new(self.constants.scale.nearest(seen) as i32)
    }

    /// 60F4h: the interpolated target less the position; in some drives the newest target less the position.
    #[must_use]
    pub fn following_error(&self) -> Increments {
        let wanted = if self.constants.undelayed {
            self.path.newest()
        } else {
            self.wanted
        };
        let error = wanted.saturating_sub(self.z);
        let count = self.constants.scale.nearest(error);
        Increments::new(count.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
    }

    /// Where the tool is if the pitch of the screw has no errors, in 2⁻¹⁶ nanometres of the drive's count.
    #[must_use]
    pub const fn load(&self) -> i64 {
        self.load
    }

    /// How far the tool is beside this place for the errors of the screw's pitch, both in 2⁻¹⁶ nanometres.
    #[must_use]
    pub fn beside(&self, place: i64) -> i64 {
        self.constants.screw.at(place)
    }

    /// Nanometres in 2⁻¹⁶ of a number of increments.
    #[must_use]
    pub fn places(&self, increments: i64) -> i64 {
        self.constants.scale.place(increments)
    }
}

/// `a` · `b` without `places` binary places, half rounded up.
const fn product(a: i64, b: i64, places: u32) -> i128 {
    rounded((a as i128).wrapping_mul(b as i128), places)
}

const fn rounded(value: i128, places: u32) -> i128 {
    value.wrapping_add(1 << places.wrapping_sub(1)) >> places
}

/// `value` within ±`limit`.
fn within(value: i128, limit: i64) -> i64 {
    let limit = i128::from(limit);
    value.clamp(limit.wrapping_neg(), limit) as i64
}
