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
//! The tick is constant work on integers: no division of 64 bits, no loop. Angles are in 2⁻³² turns, speed and
//! acceleration in 2⁻⁴⁸ turns per tick and per tick². With these units no rounding error grows until a lead could show
//! it.

use crate::units::{Ticks, TurnRate, Turns, product};

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

/// A spindle that turns slower than this counts as standing: a quarter of a turn a minute, in 2⁻³² turns per second.
const STANDING: i64 = (1 << 32) / 240;

/// No spindle changes its speed faster than this, in turns per second squared. At this rate a spindle would stop from
/// 3000 rpm within one eightieth of a second, ten times faster than a crash stops it.
const HARDEST: u64 = 4_000;

/// The observer allows changes of speed this many times harder than the drive's own ramp.
const BEYOND_RAMP: u64 = 4;

/// The observer clips each innovation (measured minus predicted angle) to a quarter turn. No acceleration makes a
/// larger innovation, and at this size no product overflows. If an innovation is larger, and not only by the width of
/// the counts, the tracker has lost the spindle.
const LARGEST_SURPRISE: i64 = 1 << 30;

/// No spindle turns faster than this, in turns per second: 120 000 rpm.
const FASTEST: u64 = 2_000;

/// An edge older than this many ticks is treated as this old. The speed is then far below one count a tick, and the
/// count's boundary limits the extrapolation anyway.
const OLDEST_EDGE_TICKS: u32 = 16;

/// 2π in 2⁻³².
const TWO_PI: u64 = 26_986_075_409;

/// Gains of the tracker, in 2⁻³²: the shares of the innovation that are added to angle, speed and acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gains {
    pub alpha: i64,
    pub beta: i64,
    pub gamma: i64,
}

impl Gains {
    /// The gains of a tracker with this bandwidth (1…1000 Hz) and tick (250…10 000 µs).
    pub const fn new(bandwidth: u32, tick_us: u32) -> Self {
        // θ = exp(−2π·f·T). The exponent is at most 63, so it fits easily in 2⁻³².
        let exponent =
            TWO_PI.wrapping_mul((bandwidth as u64).wrapping_mul(tick_us as u64)) / 1_000_000;
        let theta = exp_of_minus(exponent);
        let one = 1_u64 << 32;
        let rest = one.wrapping_sub(theta);
        let cube = mul(mul(theta, theta), theta);
        let beta = mul(mul(rest, rest), one.wrapping_add(theta));
        Self {
            alpha: one.wrapping_sub(cube) as i64,
            beta: beta.wrapping_add(beta >> 1) as i64,
            gamma: mul(mul(rest, rest), rest) as i64,
        }
    }
}

/// Angle, speed and acceleration of the spindle, one sample a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Observer {
    // Properties of the encoder.
    counts: u32,
    tick_us: u32,
    /// 2⁶³ / counts: an angle within a turn is one multiplication and a shift.
    scale: u64,
    /// Width of a count, 2⁻³² turns.
    width: i64,
    /// Ticks per nanosecond, 2⁻⁵⁶.
    ticks_per_ns: u64,
    oldest_edge_ns: u32,
    /// Ticks per second, 2⁻¹⁶.
    ticks_per_second: u64,
    // Gains, 2⁻³².
    alpha: i64,
    beta: i64,
    gamma: i64,
    /// The movement of the counter may change by this many counts from one tick to the next.
    hardest: u32,
    /// The largest movement in one tick, 2⁻³² turns.
    fastest: i64,
    /// The tracker has lost the spindle when an innovation is larger than this, 2⁻³² turns.
    lost: u64,
    // State of the counter.
    last: Option<i32>,
    /// The counter's movement in the last tick that the observer believed. `None`: the observer believes the next
    /// movement, whatever it is.
    pace: Option<i32>,
    in_turn: u32,
    turn: i64,
    rising: Option<bool>,
    zero: Option<i32>,
    // The state: 2⁻³² turns, 2⁻⁴⁸ turns per tick, 2⁻⁴⁸ turns per tick².
    angle: i64,
    speed: i64,
    acceleration: i64,
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

        let Gains { alpha, beta, gamma } = Gains::new(bandwidth, tick_us);

        Self {
            counts,
            tick_us,
            scale,
            width: (scale >> 31) as i64,
            ticks_per_ns: divide(1 << 56, tick_ns as u64),
            oldest_edge_ns: tick_ns.wrapping_mul(OLDEST_EDGE_TICKS),
            ticks_per_second: divide(1_000_000 << 16, tick_us as u64),
            alpha,
            beta,
            gamma,
            hardest: hardest(counts, tick_us, HARDEST),
            fastest: ((FASTEST << 32) / 1_000_000).wrapping_mul(tick_us as u64) as i64,
            // The width of two counts: the count of the last tick and the count of this tick.
            lost: (LARGEST_SURPRISE as u64).wrapping_add(scale >> 30),
            last: None,
            pace: None,
            in_turn: 0,
            turn: 0,
            rising: None,
            zero: None,
            angle: 0,
            speed: 0,
            acceleration: 0,
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
                self.angle = self.boundary().wrapping_add(self.width >> 1);
                sample.count
            }
        };
        self.last = Some(sample.count);
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

        // Predict one tick, measure, correct.
        let predicted = self
            .angle
            .wrapping_add(rounded(self.speed.wrapping_add(self.acceleration >> 1), 16));
        let speed = self.speed.wrapping_add(self.acceleration);
        let measured = self.measured(sample.edge_age_ns, speed);
        let surprise = measured.wrapping_sub(predicted);
        if surprise.unsigned_abs() > self.lost {
            self.find(measured, moved);
            return event;
        }
        let surprise = surprise.clamp(LARGEST_SURPRISE.wrapping_neg(), LARGEST_SURPRISE);
        self.angle = predicted.wrapping_add(rounded(self.alpha.wrapping_mul(surprise), 32));
        self.speed = speed.wrapping_add(rounded(self.beta.wrapping_mul(surprise), 16));
        self.acceleration = self
            .acceleration
            .wrapping_add(rounded(self.gamma.wrapping_mul(surprise), 16));
        event
    }

    /// Takes the angle from the sample, and the speed from the counter's movement in this tick. This is for a spindle
    /// that is far from where the tracker expects it. A third-order tracker that follows such a leap in clipped steps
    /// swings farther each time and never finds the spindle again [D185].
    #[cold]
    #[inline(never)]
    fn find(&mut self, measured: i64, moved: i32) {
        // At most 2³¹ counts of 2³² each. The fastest spindle makes twenty turns in 10 ms.
        let way = i64::from(moved).wrapping_mul(self.width);
        self.angle = measured;
        self.speed = way.min(self.fastest).max(self.fastest.wrapping_neg()) << 16;
        self.acceleration = 0;
    }

    /// The angle at the last sample.
    #[must_use]
    pub const fn angle(&self) -> Turns {
        Turns::from_raw(self.angle)
    }

    /// The angle at the time `ahead` after the last sample, at the present speed and acceleration. Good for a few tens
    /// of ticks.
    #[must_use]
    pub const fn predict(&self, ahead: Ticks) -> Turns {
        let ahead = ahead.raw() as i64;
        let by_speed = rounded((self.speed >> 16).wrapping_mul(ahead), 16);
        // ½·a·t²: t² ≤ 2⁴⁸ in 2⁻³². It is shifted to 2⁻¹⁶ before the multiplication by the acceleration.
        let half_square = ahead.wrapping_mul(ahead >> 1) >> 16;
        let by_acceleration = rounded((self.acceleration >> 16).wrapping_mul(half_square), 16);
        Turns::from_raw(
            self.angle
                .wrapping_add(by_speed)
                .wrapping_add(by_acceleration),
        )
    }

    /// The speed at the last sample.
    #[must_use]
    pub const fn speed(&self) -> TurnRate {
        // 2⁻³² turns per tick times 2⁻¹⁶ ticks per second.
        let per_tick = self.speed >> 16;
        TurnRate::from_raw(rounded(
            per_tick.wrapping_mul(self.ticks_per_second as i64),
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

    /// True while the spindle turns faster than a quarter of a turn a minute, either way.
    #[must_use]
    pub const fn is_turning(&self) -> bool {
        self.speed().abs().raw() > STANDING
    }

    /// Lower boundary of the present count.
    const fn boundary(&self) -> i64 {
        let within = (self.in_turn as u64).wrapping_mul(self.scale) >> 31;
        (self.turn << 32).wrapping_add(within as i64)
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
            self.turn = self.turn.wrapping_add(rounded(jump, 32));
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
    fn measured(&self, edge_age_ns: Option<u32>, speed: i64) -> i64 {
        let lower = self.boundary();
        let (Some(age), Some(rising)) = (edge_age_ns, self.rising) else {
            return lower.wrapping_add(self.width >> 1);
        };
        let age = age.min(self.oldest_edge_ns);
        // The age in ticks, in 2⁻²⁴: at most 16 ticks, which are 28 bits. The speed in 2⁻³² has as many bits.
        let age = (u64::from(age).wrapping_mul(self.ticks_per_ns) >> 32) as i64;
        let way = (speed >> 16).wrapping_mul(age) >> 24;
        let within = if rising {
            way
        } else {
            self.width.wrapping_add(way)
        };
        lower.wrapping_add(within.min(self.width).max(0))
    }
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

/// Product of two numbers in 2⁻³², neither above 2.
const fn mul(a: u64, b: u64) -> u64 {
    (product(a, b) >> 32) as u64
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

/// exp(−x), both in 2⁻³², x ≤ 64: the series for x/256, squared eight times.
const fn exp_of_minus(x: u64) -> u64 {
    let one = 1_u64 << 32;
    let y = x >> 8;
    // 1 − y·(1 − y/2·(1 − y/3·(1 − y/4)))
    let mut sum = one.wrapping_sub(y / 4);
    sum = one.wrapping_sub(mul(y, sum) / 3);
    sum = one.wrapping_sub(mul(y, sum) / 2);
    sum = one.wrapping_sub(mul(y, sum));
    let mut squarings = 0;
    while squarings < 8 {
        sum = mul(sum, sum);
        squarings = 1_u32.wrapping_add(squarings);
    }
    sum
}
