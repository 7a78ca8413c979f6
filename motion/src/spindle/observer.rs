//! The spindle observer: a third-order tracker (angle, speed, acceleration) over a quantised encoder.
//!
//! An encoder count is coarse: one count of 4096 is 1.5 µm of a 6 mm lead. A setpoint takes effect one tick after the
//! sample. Therefore the observer filters the angle and predicts it. The tracker predicts with constant acceleration
//! and corrects with three gains. One design figure, the bandwidth, gives all three gains: all three poles lie at
//! `θ = exp(−2π·f·T)`. This is the discounted least-squares ("fading memory") fit of a parabola. The tracker follows
//! constant speed and constant acceleration without lag.
//!
//! What a sample tells about the angle: the counter stands at `c` while the angle is within `[c, c + 1)` counts. If the
//! hardware captures the time of the last edge, the angle at that edge is known exactly: the lower boundary of the
//! count if the count rose, the upper boundary if the count fell. The speed carries this angle to the instant of the
//! sample, but never beyond the other boundary of the count. Without the edge's time, the middle of the count is the
//! best guess.
//!
//! If the spindle is farther than a quarter turn from where the tracker expects it, the tracker starts again at the
//! angle that the sample shows [D185].
//!
//! If the counter moves as no spindle can, the cause is a disturbance on its wires. The observer does not follow such a
//! movement: the angle goes on as before for that tick, and the observer reports the counts that were lost or gained
//! [D128].
//!
//! An encoder of few counts that moves seldom tells less, and the observer's bandwidth is then smaller: see `looks`.
//!
//! A counter that has not moved for as long as a count takes at a quarter of a turn a minute says that the spindle stands
//! [D509]. Speed and acceleration are then zero: an old edge tells nothing of the speed, so the tracker would swing about
//! the count for ever.
//!
//! The tick is constant work on integers: no division of 64 bits, no loop. Angles have 32 bits after the point, speed and
//! acceleration have 48. With these units no rounding error grows until a lead could show it. Products are rounded to the
//! nearest; the operators of `fixed` round down, so the products are made of the bits.

use fixed::types::{I16F48, I32F32, U1F63, U8F56, U32F32, U48F16};

use leadscrew_spindle::{Gains, Look};

use super::looks;
use crate::units::{Ticks, TurnRate, Turns};

/// What the encoder hardware delivers once a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EncoderSample {
    /// The hardware counter at the sample. It counts all edges and wraps. The counter stands at `c` while the angle is
    /// within `[c, c + 1)` counts of the counter's zero.
    pub count: i32,
    /// Time from the last change of the counter to the sample, in nanoseconds. `None` if the hardware does not capture
    /// this time, or if nothing has moved yet.
    pub edge_age_ns: Option<u32>,
    /// The counter value that an index pulse has latched since the last sample: the count in which the pulse lies, in
    /// either direction of turning. The lower boundary of that count is the spindle's zero.
    pub index: Option<i32>,
}

/// What the observer noticed at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleEvent {
    /// The first index came: from here on angles are absolute.
    Indexed,
    /// Counts were lost or gained: an index came at a wrong place, or the counter moved as no spindle can [D128].
    Slipped {
        /// By how many counts the index came late (negative: early), or how many counts the counter moved too far.
        counts: i32,
    },
}

/// A spindle that takes more seconds for a turn counts as standing: a quarter of a turn a minute.
const LONGEST_TURN: u64 = 240;

/// The same as a speed, in 2⁻³² turns per second.
const STANDING: i64 = (1 << 32) / LONGEST_TURN as i64;

/// No spindle changes its speed faster than this, in turns per second squared. At this rate a spindle would stop from
/// 3000 rpm within one eightieth of a second, ten times faster than a crash stops it.
const HARDEST: u64 = 4_000;

/// The observer allows changes of speed this many times harder than the drive's own ramp.
const BEYOND_RAMP: u64 = 4;

/// Innovations are clipped to a quarter turn: more than any acceleration makes, little enough for every product. One that
/// is larger, and not by the width of the counts alone, says that the tracker has lost the spindle.
const LARGEST_SURPRISE: I32F32 = I32F32::from_bits(1 << 30);

/// No spindle turns faster than this, in turns per second: 120 000 rpm.
const FASTEST: u64 = 2_000;

/// An edge older than this many ticks is treated as this old. The speed is then far below one count a tick, and the
/// count's boundary limits the extrapolation anyway.
const OLDEST_EDGE_TICKS: u32 = 16;

/// The same for an encoder of few counts. Below 256, for the eight bits of a number of ticks before their point.
const OLDEST_EDGE_OF_FEW: u32 = 240;

/// A spindle that trembles over three counts to either side makes fewer movements one way than this behind another one.
const BEYOND_TREMBLE: u32 = 6;

/// 2π, rounded to the nearest.
const TWO_PI: U32F32 = U32F32::from_bits(26_986_075_409);

/// The gains of a tracker with this bandwidth (1…1000 Hz) and tick (250…10 000 µs).
pub(super) const fn steady(bandwidth: u32, tick_us: u32) -> Gains {
    Gains::of_theta(exp_of_minus(pole(bandwidth, tick_us)))
}

/// 2π·f·T, the angle by which the poles of a bandwidth turn in a tick: at most 63, and a million times as much is still
/// in range. The poles lie at θ = exp(−2π·f·T).
const fn pole(bandwidth: u32, tick_us: u32) -> U32F32 {
    let cycles = (bandwidth as u64).wrapping_mul(tick_us as u64);
    U32F32::from_bits(TWO_PI.wrapping_mul_int(cycles).to_bits() / 1_000_000)
}

/// What is below one, in 2⁻³²; the largest for what is not.
const fn short(value: U32F32) -> u32 {
    let bits = value.to_bits();
    if bits > u32::MAX as u64 {
        u32::MAX
    } else {
        bits as u32
    }
}

/// An encoder of few counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Few {
    /// The angle by which the poles turn in a tick where edges come often, 2⁻³²; one at most.
    pole: u32,
    /// Ticks from the last movement but one of the counter to the last.
    apart: u32,
}

/// Angle, speed and acceleration of the spindle, one sample a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Observer {
    // Properties of the encoder.
    counts: u32,
    tick_us: u32,
    /// Turns per count: an angle within a turn is one multiplication and a shift.
    scale: U1F63,
    /// Width of a count in turns.
    width: I32F32,
    ticks_per_ns: U8F56,
    oldest_edge_ns: u32,
    ticks_per_second: U48F16,
    gains: Gains,
    /// An encoder of few counts is looked at where it moves, and not in each tick.
    few: Option<Few>,
    /// Counts by which the movement of the counter may change from tick to tick.
    hardest: u32,
    /// The farthest way of a tick in turns.
    fastest: I32F32,
    /// A larger innovation, in turns, says that the spindle is lost.
    lost: U32F32,
    /// Whole ticks in which a count goes by at the speed of a spindle that stands; a second at most.
    longest: u32,
    /// A spindle whose counter has not moved for more ticks stands: as many, but no fewer than those for which an edge
    /// tells something of the speed.
    most: u32,
    /// Whole counts in a tick at that speed.
    least: u32,
    /// Movements behind another one until the counter goes on. Several where a count is so little that a spindle at rest
    /// trembles over some [D527].
    wanted: u32,
    // Where the counter is.
    last: Option<i32>,
    /// The counter's movement in the last tick that the observer believed. `None`: the observer believes the next
    /// movement, whatever it is.
    pace: Option<i32>,
    in_turn: u32,
    turn: i64,
    rising: Option<bool>,
    /// Ticks since the counter moved last.
    ticks: u32,
    /// The movements of the counter that are still missing until it goes on: one way, no smaller and no farther apart than
    /// those of a spindle that turns.
    missing: u32,
    zero: Option<i32>,
    // The state: turns, turns per tick, turns per tick².
    angle: I32F32,
    speed: I16F48,
    acceleration: I16F48,
}

impl Observer {
    /// An observer at rest for an encoder of `counts_per_turn` (after quadrature; 1…2²⁰). The bandwidth is in hertz
    /// (1…200 is sensible; it places the poles of the tracker), the tick in microseconds (250…10 000). A value outside
    /// its range is replaced by the nearest limit; the parameter table refuses such values earlier.
    #[must_use]
    pub const fn new(counts_per_turn: u32, bandwidth_hz: u32, tick_us: u32) -> Self {
        let counts = clamp(counts_per_turn, 1, 1 << 20);
        let bandwidth = clamp(bandwidth_hz, 1, 1000);
        let tick_us = clamp(tick_us, 250, 10_000);
        let tick_ns = tick_us.wrapping_mul(1000);
        let scale = divide(1 << 63, counts as u64);
        let longest = longest(counts, tick_us);
        let wanted = if longest > OLDEST_EDGE_TICKS {
            1
        } else {
            BEYOND_TREMBLE
        };

        Self {
            counts,
            tick_us,
            scale: U1F63::from_bits(scale),
            width: I32F32::from_bits((scale >> 31) as i64),
            ticks_per_ns: U8F56::from_bits(divide(1 << 56, tick_ns as u64)),
            oldest_edge_ns: tick_ns.wrapping_mul(if counts < looks::FEW {
                OLDEST_EDGE_OF_FEW
            } else {
                OLDEST_EDGE_TICKS
            }),
            ticks_per_second: U48F16::from_bits(divide(1_000_000 << 16, tick_us as u64)),
            gains: steady(bandwidth, tick_us),
            few: if counts < looks::FEW {
                Some(Few {
                    pole: short(pole(bandwidth, tick_us)),
                    apart: 0,
                })
            } else {
                None
            },
            hardest: hardest(counts, tick_us, HARDEST),
            fastest: I32F32::from_bits(
                ((FASTEST << 32) / 1_000_000).wrapping_mul(tick_us as u64) as i64
            ),
            // Two counts: that of the last tick and that of this one.
            lost: U32F32::from_bits((LARGEST_SURPRISE.to_bits() as u64).wrapping_add(scale >> 30)),
            longest,
            most: clamp(longest, OLDEST_EDGE_TICKS, u32::MAX),
            least: least(counts, tick_us),
            wanted,
            last: None,
            pace: None,
            in_turn: 0,
            turn: 0,
            rising: None,
            ticks: 0,
            missing: wanted,
            zero: None,
            angle: I32F32::ZERO,
            speed: I16F48::ZERO,
            acceleration: I16F48::ZERO,
        }
    }

    /// Prepares the observer for a spindle whose drive takes `ramp_ms` milliseconds for 1000 rpm (0 counts as 1). Such
    /// a spindle may change its speed faster than the general limit allows.
    #[must_use]
    pub const fn for_ramp(mut self, ramp_ms: u32) -> Self {
        // 1000 rpm in a millisecond are 16 667 turns per second squared.
        let ramp = 16_667 * BEYOND_RAMP;
        let ramp = match ramp.checked_div(ramp_ms as u64) {
            Some(ramp) => ramp,
            None => ramp,
        };
        if ramp > HARDEST {
            self.hardest = hardest(self.counts, self.tick_us, ramp);
        }
        self
    }

    /// Takes the sample of one tick. The state then holds for the instant of the sample.
    pub fn tick(&mut self, sample: EncoderSample) -> Option<SpindleEvent> {
        let before = self.last;
        let last = match before {
            Some(last) => last,
            None => {
                // Until the first index, the spindle's position at the first sample is called count zero.
                self.last = Some(sample.count);
                self.angle = self.boundary().wrapping_add(self.half_width());
                sample.count
            }
        };
        self.last = Some(sample.count);
        let rising = self.rising;
        let delta = sample.count.wrapping_sub(last);
        let (moved, event) = match self.pace {
            Some(pace)
                if self.zero.is_some()
                    && delta.wrapping_sub(pace).unsigned_abs() > self.hardest =>
            {
                // Never reject two ticks in a row: a movement that goes on is true, whatever it is.
                self.pace = None;
                self.advance(pace);
                let counts = delta.wrapping_sub(pace);
                (pace, Some(SpindleEvent::Slipped { counts }))
            }
            _ => {
                // The first sample does not tell how the counter moves.
                self.pace = before.map(|_| delta);
                self.advance(delta);
                let event = sample
                    .index
                    .and_then(|latched| self.index(latched, sample.count));
                (delta, event)
            }
        };

        self.ticks = self.ticks.saturating_add(1);
        let apart = self.ticks;
        if moved != 0 {
            self.ticks = 0;
            let goes_on = self.rising == rising
                && apart <= self.longest
                && moved.unsigned_abs() >= self.least;
            self.missing = if goes_on {
                self.missing.saturating_sub(1)
            } else {
                self.wanted
            };
        }
        let gains = match &mut self.few {
            None => self.gains,
            Some(few) => gains_of_few(few, apart, moved, sample.edge_age_ns.is_some()),
        };
        // Predict one tick, measure, correct.
        let predicted = self
            .angle
            .wrapping_add(nearest(self.speed.wrapping_add(half_of(self.acceleration))));
        let speed = self.speed.wrapping_add(self.acceleration);
        let measured = self.measured(sample.edge_age_ns, speed);
        let mut surprise = measured.wrapping_sub(predicted);
        if surprise.unsigned_abs() > LARGEST_SURPRISE.unsigned_abs() {
            if surprise.unsigned_abs() > self.lost {
                self.find(measured, moved);
                return event;
            }
            surprise = surprise.clamp(LARGEST_SURPRISE.wrapping_neg(), LARGEST_SURPRISE);
        }
        let by =
            |gain: I32F32, bits| rounded(gain.to_bits().wrapping_mul(surprise.to_bits()), bits);
        self.angle = predicted.wrapping_add(I32F32::from_bits(by(gains.alpha, 32)));
        self.speed = speed.wrapping_add(I16F48::from_bits(by(gains.beta, 16)));
        self.acceleration = self
            .acceleration
            .wrapping_add(gains.of_acceleration(surprise));
        if self.ticks > self.most {
            self.rest();
        } else if self.few.is_some() && moved == 0 {
            self.slow_down();
        }
        event
    }

    /// The counter stands, so the spindle has not made a whole count for some ticks: its speed is no higher than that.
    #[cold]
    #[inline(never)]
    fn slow_down(&mut self) {
        let width = u32::try_from(self.width.to_bits()).unwrap_or(u32::MAX);
        let most = width.checked_div(self.ticks).unwrap_or(u32::MAX);
        let most = I16F48::from_bits(i64::from(most) << 16);
        if self.speed.unsigned_abs() > most.unsigned_abs() {
            self.speed = self.speed.min(most).max(most.wrapping_neg());
            self.acceleration = I16F48::ZERO;
        }
    }

    /// The counter has stood for so long that the spindle stands.
    #[cold]
    #[inline(never)]
    const fn rest(&mut self) {
        self.missing = self.wanted;
        self.speed = I16F48::ZERO;
        self.acceleration = I16F48::ZERO;
    }

    /// Takes the angle from the sample, and the speed from the counter's movement in this tick. This is for a spindle
    /// that is far from where the tracker expects it. A third-order tracker that follows such a leap in clipped steps
    /// swings farther each time and never finds the spindle again [D185].
    #[cold]
    #[inline(never)]
    fn find(&mut self, measured: I32F32, moved: i32) {
        // At most 2³¹ counts of 2³² each; in 10 ms the fastest makes twenty turns.
        let way = self.width.wrapping_mul_int(moved.into());
        self.angle = measured;
        self.speed = way
            .min(self.fastest)
            .max(self.fastest.wrapping_neg())
            .wrapping_to_num();
        self.acceleration = I16F48::ZERO;
    }

    /// What the last sample has shown, with the age of the last edge there, for a tracker.
    #[must_use]
    pub fn look(&self, edge_age_ns: Option<u32>) -> Look {
        Look {
            lower: self.boundary(),
            width: self.width,
            age: edge_age_ns.map(|age| self.age_in_ticks(age)),
            angle: self.angle,
            speed: self.speed,
        }
    }

    /// The age of an edge in ticks, 2⁻²⁴: mostly at most 16 of them, 28 bits.
    fn age_in_ticks(&self, age_ns: u32) -> i64 {
        let age = age_ns.min(self.oldest_edge_ns);
        (self.ticks_per_ns.wrapping_mul_int(age.into()).to_bits() >> 32) as i64
    }

    /// The angle at the last sample.
    #[must_use]
    pub const fn angle(&self) -> Turns {
        Turns::from_raw(self.angle.to_bits())
    }

    /// The middle of the count in which the last sample stands, and half the width of that count. Of a spindle at rest
    /// nothing more is known; what the tracker says of it may still swing.
    #[must_use]
    pub const fn count_at_rest(&self) -> (Turns, Turns) {
        let half = self.half_width();
        let middle = self.boundary().wrapping_add(half);
        (
            Turns::from_raw(middle.to_bits()),
            Turns::from_raw(half.to_bits()),
        )
    }

    /// The angle at the time `ahead` after the last sample, at the present speed and acceleration. Good for a few tens
    /// of ticks.
    #[must_use]
    pub const fn predict(&self, ahead: Ticks) -> Turns {
        let ahead = ahead.raw() as i64;
        let by_speed = rounded((self.speed.to_bits() >> 16).wrapping_mul(ahead), 16);
        // ½·a·t²: t² ≤ 2⁴⁸ in 2⁻³², brought back to 2⁻¹⁶ before it meets the acceleration.
        let half_square = ahead.wrapping_mul(ahead >> 1) >> 16;
        let acceleration = self.acceleration.to_bits() >> 16;
        let by_acceleration = rounded(acceleration.wrapping_mul(half_square), 16);
        Turns::from_raw(
            self.angle
                .to_bits()
                .wrapping_add(by_speed)
                .wrapping_add(by_acceleration),
        )
    }

    /// The speed at the last sample.
    #[must_use]
    pub const fn speed(&self) -> TurnRate {
        // 2⁻³² turns per tick times 2⁻¹⁶ ticks per second.
        let per_tick = self.speed.to_bits() >> 16;
        TurnRate::from_raw(rounded(
            per_tick.wrapping_mul(self.ticks_per_second.to_bits() as i64),
            16,
        ))
    }

    /// True while the last index is no more than two turns away. Angle 0 and every whole turn are then at the index.
    /// False before the first index, and when index pulses fail to come.
    #[must_use]
    // A waiting stroke asks for this. If the compiler inlines it, the tick that begins the stroke copies more.
    #[inline(never)]
    pub const fn indexed(&self) -> bool {
        let (Some(zero), Some(last)) = (self.zero, self.last) else {
            return false;
        };
        // An index that comes one count late is still in time.
        last.wrapping_sub(zero).unsigned_abs() <= self.counts.wrapping_mul(2).wrapping_add(1)
    }

    /// For use after a slip: the next index then counts as the first one.
    pub const fn forget_index(&mut self) {
        self.zero = None;
    }

    /// True while the spindle turns faster than a quarter of a turn a minute, either way. Below 240 counts a turn, one that
    /// has not moved by a count in a second stands: nobody waits longer for an edge that does not come.
    ///
    /// Where edges are seldom, the estimated speed swings between them; then the time from edge to edge tells it.
    #[must_use]
    pub const fn is_turning(&self) -> bool {
        if self.missing == 0 {
            return true;
        }
        let count_a_second = self.width.to_bits();
        let speed = self.speed().abs().raw();
        speed > STANDING && speed > count_a_second
    }

    /// Lower boundary of the present count.
    const fn boundary(&self) -> I32F32 {
        let within = self.scale.wrapping_mul_int(self.in_turn as u64).to_bits() >> 31;
        I32F32::from_bits((self.turn << 32).wrapping_add(within as i64))
    }

    const fn half_width(&self) -> I32F32 {
        I32F32::from_bits(self.width.to_bits() >> 1)
    }

    /// Moves the counter by `delta` counts.
    fn advance(&mut self, delta: i32) {
        if delta == 0 {
            return;
        }
        self.rising = Some(delta > 0);
        let magnitude = delta.unsigned_abs();
        let turns = magnitude.checked_div(self.counts).unwrap_or(0);
        let rest = magnitude.wrapping_sub(turns.wrapping_mul(self.counts));
        if delta > 0 {
            self.turn = self.turn.wrapping_add(i64::from(turns));
            self.in_turn = self.in_turn.wrapping_add(rest);
            if self.in_turn >= self.counts {
                self.in_turn = self.in_turn.wrapping_sub(self.counts);
                self.turn = self.turn.wrapping_add(1);
            }
        } else {
            self.turn = self.turn.wrapping_sub(i64::from(turns));
            if self.in_turn < rest {
                self.in_turn = self.in_turn.wrapping_add(self.counts);
                self.turn = self.turn.wrapping_sub(1);
            }
            self.in_turn = self.in_turn.wrapping_sub(rest);
        }
    }

    /// Uses an index. The first index sets the zero; each later index must be whole turns from the last.
    fn index(&mut self, latched: i32, count: i32) -> Option<SpindleEvent> {
        let Some(zero) = self.zero else {
            self.zero = Some(latched);
            let before = self.boundary();
            self.in_turn = 0;
            self.turn = 0;
            let rising = self.rising;
            self.advance(count.wrapping_sub(latched));
            self.rising = rising;
            // Keep the nearest whole turn, so that the angle jumps by half a turn at most.
            let jump = before.wrapping_sub(self.boundary());
            self.turn = self.turn.wrapping_add(rounded(jump.to_bits(), 32));
            self.angle = self
                .angle
                .wrapping_add(self.boundary().wrapping_sub(before));
            return Some(SpindleEvent::Indexed);
        };
        let since = latched.wrapping_sub(zero);
        let magnitude = since.unsigned_abs();
        let half = self.counts >> 1;
        let turns = magnitude
            .wrapping_add(half)
            .checked_div(self.counts)
            .unwrap_or(0);
        let whole = turns.wrapping_mul(self.counts);
        let slip = magnitude.wrapping_sub(whole) as i32;
        let (slip, whole) = if since < 0 {
            (slip.wrapping_neg(), (whole as i32).wrapping_neg())
        } else {
            (slip, whole as i32)
        };
        self.zero = Some(zero.wrapping_add(whole));
        // An index pulse may sit on a boundary of its count, so a difference of one count either way is no slip.
        (slip.unsigned_abs() > 1).then_some(SpindleEvent::Slipped { counts: slip })
    }

    /// The angle that the sample shows.
    fn measured(&self, edge_age_ns: Option<u32>, speed: I16F48) -> I32F32 {
        let lower = self.boundary();
        let (Some(age), Some(rising)) = (edge_age_ns, self.rising) else {
            return lower.wrapping_add(self.half_width());
        };
        // The speed in 2⁻³² has as many bits as the age again. The older edges of few counts belong to slow spindles.
        let age = self.age_in_ticks(age);
        let way = I32F32::from_bits((speed.to_bits() >> 16).wrapping_mul(age) >> 24);
        let within = if rising {
            way
        } else {
            self.width.wrapping_add(way)
        };
        lower.wrapping_add(within.min(self.width).max(I32F32::ZERO))
    }
}

/// The gains of a tick, `apart` ticks after the counter's last movement, in which an encoder of few counts has moved by
/// `moved`.
#[cold]
#[inline(never)]
fn gains_of_few(few: &mut Few, apart: u32, moved: i32, is_timed: bool) -> Gains {
    if moved != 0 {
        few.apart = apart;
    }
    looks::gains(few.pole, few.apart.max(apart), is_timed)
}

/// Whole ticks in which a count goes by at the speed [`STANDING`], a second at most.
const fn longest(counts: u32, tick_us: u32) -> u32 {
    let second = divide(1_000_000, tick_us as u64);
    let longest = divide(second.wrapping_mul(LONGEST_TURN), counts as u64).wrapping_add(1);
    // At most 4000 ticks.
    if longest < second {
        longest as u32
    } else {
        second as u32
    }
}

/// Whole counts that go by in a tick at the speed [`STANDING`].
const fn least(counts: u32, tick_us: u32) -> u32 {
    divide(
        (counts as u64).wrapping_mul(tick_us as u64),
        LONGEST_TURN * 1_000_000,
    ) as u32
}

/// By how many counts the counter's movement may change in one tick at `acceleration` turns per second squared, plus a
/// margin because the counter reads whole counts.
const fn hardest(counts: u32, tick_us: u32, acceleration: u64) -> u32 {
    // At most 2²⁰ counts and 10⁴ µs: below 2⁶⁴ up to 10⁵ turns per second squared.
    let square = (tick_us as u64).wrapping_mul(tick_us as u64);
    let moved = acceleration
        .wrapping_mul(counts as u64)
        .wrapping_mul(square / 100)
        / 10_000_000_000;
    // More than a quarter of the counter's range is no movement at all.
    if moved < 1 << 30 {
        (moved as u32).wrapping_add(3)
    } else {
        1 << 30
    }
}

/// `value` / 2^`bits`, rounded to the nearest, halves up.
const fn rounded(value: i64, bits: u32) -> i64 {
    value
        .wrapping_add(1_i64.wrapping_shl(bits.wrapping_sub(1)))
        .wrapping_shr(bits)
}

/// An angle with 48 bits after the point, rounded to one with 32.
const fn nearest(value: I16F48) -> I32F32 {
    I32F32::from_bits(rounded(value.to_bits(), 16))
}

const fn half_of(value: I16F48) -> I16F48 {
    I16F48::from_bits(value.to_bits() >> 1)
}

const fn clamp(value: u32, low: u32, high: u32) -> u32 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

const fn divide(a: u64, b: u64) -> u64 {
    match a.checked_div(b) {
        Some(quotient) => quotient,
        None => 0,
    }
}

/// exp(−x) for x ≤ 64: the series of x/256, squared eight times.
const fn exp_of_minus(x: U32F32) -> U32F32 {
    const fn part(value: U32F32, of: u64) -> U32F32 {
        U32F32::from_bits(divide(value.to_bits(), of))
    }
    let one = U32F32::ONE;
    let y = part(x, 256);
    // 1 − y·(1 − y/2·(1 − y/3·(1 − y/4)))
    let mut sum = one.wrapping_sub(part(y, 4));
    sum = one.wrapping_sub(part(y.wrapping_mul(sum), 3));
    sum = one.wrapping_sub(part(y.wrapping_mul(sum), 2));
    sum = one.wrapping_sub(y.wrapping_mul(sum));
    let mut squarings = 0;
    while squarings < 8 {
        sum = sum.wrapping_mul(sum);
        squarings = 1_u32.wrapping_add(squarings);
    }
    sum
}
