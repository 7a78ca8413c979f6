//! The tracker: a slow observer that learns how the spindle swings.
//!
//! A pass on the lead follows the spindle's angle, and an encoder of few counts tells that angle seldom or coarsely. A
//! slow observer smooths this, but lags where the speed swings: once or twice a turn (a chuck out of balance, a belt,
//! the cut), or at a frequency of the drive's own. So the tracker knows such swings as [`Wave`]s and learns their
//! size: the surprise of each look turns them a little towards what was seen. A swing that is learned is no surprise
//! any more, and costs no lag.
//!
//! The observer passes a swing of the frequency ω on as surprise by `(1 + i·p/ω)⁻³`. So what is learned from a surprise is
//! turned by `(1 + i·p/ω)³`: without this the slow swings would never settle.
//!
//! What is learned of a look is taken in over the ticks after it, one swing in each, so that no tick has all the work.
//! Looks that come meanwhile correct the observer, and teach nothing.
//!
//! The tracker looks where the counter moves (`looks`). It knows no axes and no limits; what it says moves in small
//! steps, and an axis goes after it by a [`Follower`](crate::Follower).

use fixed::types::{I16F48, I32F32};

use crate::looks;
use crate::wave::{Angle, Differences, Unit, Wave, learn};

/// Orders of the turn whose swings are learned, from 1 on.
const ORDERS: usize = 2;

/// Counts a turn that the swings of all orders need: four in each of their periods.
const COUNTS: u32 = 8;

/// Ticks that a swing needs in each of its periods.
const TICKS: u32 = 4;

/// Bandwidth of the tracker in Hz, where looks and turns come often.
const BANDWIDTH: u32 = 8;

/// The tracker is ready when the speed has been the same for this many of its windows.
const WINDOWS: u32 = 6;

/// A surprise of more than a sixteenth of a turn beside two counts says that the spindle is lost.
const LOST: i64 = 1 << 28;

/// What the encoder shows in a tick, and where the quick observer is.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// The lower boundary of the count, turns.
    pub lower: I32F32,
    /// The width of the count, turns.
    pub width: I32F32,
    /// Ticks since the last edge, 2⁻²⁴; `None` where edges are not timed.
    pub age: Option<i64>,
    /// The angle by the quick observer, turns.
    pub angle: I32F32,
    /// The speed by the quick observer, turns per tick.
    pub speed: I16F48,
}

/// Angle, speed and acceleration without the swings, and the swings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracker {
    counts: u32,
    /// The angle by which the poles turn in a tick at most, 2⁻³².
    pole: u32,
    /// Half a second, in ticks.
    half_second: u32,
    /// The edges have times.
    is_timed: bool,
    /// Ticks since the last look, and the boundary then.
    ticks: u32,
    lower: I32F32,
    angle: I32F32,
    speed: I16F48,
    acceleration: I16F48,
    /// The angle of a tick at the last look.
    step: Unit,
    orders: [Wave; ORDERS],
    free: Free,
    /// The orders, and the swing with a frequency of its own, that are part of what is predicted.
    is_told: [bool; ORDERS + 1],
    /// Ticks since the last look that taught something.
    untaught: u32,
    lesson: Option<Lesson>,
    window: Window,
}

/// What a look has taught and is not learned yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Lesson {
    next: Swing,
    /// The turn that each swing takes towards the surprise, turns in 2⁻⁴⁸.
    size: i64,
    /// Angles at the look, of the turn and of the swing with a frequency of its own.
    at: Angle,
    free_at: Angle,
    /// The angle by which the poles turn in a tick, 2⁻³².
    pole: u32,
}

/// The swings in the order in which they are learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Swing {
    First,
    Second,
    Free,
}

/// The spindle's angle at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Prediction {
    /// Turns, 2⁻³².
    pub angle: i64,
    /// The angle with its differences from tick to tick.
    pub learned: Differences,
}

impl Prediction {
    /// The angle a tick before, turns in 2⁻³².
    #[must_use]
    pub const fn before(&self) -> i64 {
        self.angle.wrapping_sub(self.learned.speed >> 16)
    }

    /// By how much the angle has grown in the last `ticks` (2⁻¹⁶, up to 64 ticks), turns in 2⁻³²: by the differences of the
    /// instant, which for a swing is right to a few thousandths of it.
    #[must_use]
    pub fn grown(&self, ticks: u32) -> i64 {
        let n = i64::from(ticks);
        // n·(n − 1)/2 and n·(n − 1)·(n − 2)/6, 2⁻¹⁶.
        let two = n.wrapping_mul(n.wrapping_sub(1 << 16)) >> 17;
        let three = (two.wrapping_mul(n.wrapping_sub(2 << 16)) >> 16).wrapping_mul(21_845) >> 16;
        let times = |difference: i64, by: i64| (difference >> 16).wrapping_mul(by);
        times(self.learned.speed, n)
            .wrapping_sub(times(self.learned.acceleration, two))
            .wrapping_add(times(self.learned.jerk, three))
            >> 16
    }
}

/// A swing with a frequency of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Free {
    wave: Wave,
    /// Where in its period it is, and its step in a tick: periods, 2⁻⁶⁴.
    angle: u64,
    step: u64,
    /// The step by the parameter; 0 without such a swing.
    given: u64,
    /// The angle of a tick.
    unit: Unit,
}

/// A stretch of time over which the mean speed is compared with that of the stretch before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    ticks: u32,
    length: u32,
    begin: I32F32,
    /// Turns per tick.
    mean: I32F32,
    /// Windows in a row with the same speed.
    alike: u32,
}

impl Window {
    const NEW: Self = Self {
        ticks: 0,
        length: 0,
        begin: I32F32::ZERO,
        mean: I32F32::ZERO,
        alike: 0,
    };
}

impl Tracker {
    /// A tracker of an encoder with `counts` a turn and ticks of `tick_us`, of a spindle whose drive swings with
    /// `swing_mhz` (thousandths of a hertz, known within 6 %; 0 for a drive that does not).
    #[must_use]
    #[inline(never)]
    pub const fn new(counts: u32, tick_us: u32, swing_mhz: u32) -> Self {
        // Periods per tick, 2⁻⁶⁴: mHz · µs · 10⁻⁹; 2⁶⁴ / 10⁹ = 18 446 744 073.7.
        let step = (swing_mhz as u64)
            .wrapping_mul(tick_us as u64)
            .wrapping_mul(18_446_744_074);
        Self {
            counts,
            pole: looks::pole(BANDWIDTH, tick_us),
            half_second: match 500_000_u32.checked_div(tick_us) {
                Some(ticks) => ticks,
                None => 0,
            },
            is_timed: false,
            ticks: 0,
            lower: I32F32::ZERO,
            angle: I32F32::ZERO,
            speed: I16F48::ZERO,
            acceleration: I16F48::ZERO,
            step: Unit::ZERO,
            orders: [Wave::NONE; ORDERS],
            free: Free {
                wave: Wave::NONE,
                angle: 0,
                step,
                given: step,
                unit: Unit::of((step >> 32) as u32),
            },
            is_told: [false; ORDERS + 1],
            untaught: 0,
            lesson: None,
            window: Window::NEW,
        }
    }

    /// True once the spindle has turned at one speed for so long that its swings are learned: six windows of half a second,
    /// three turns or forty looks, whichever is longest.
    #[must_use]
    pub const fn is_ready(&self) -> bool {
        self.window.alike >= WINDOWS
    }

    /// The spindle has been told another speed: whatever was ready is not, and the next window begins now. What was learned
    /// of its swings stays.
    pub const fn expect_other_speed(&mut self) {
        self.is_told = [false; ORDERS + 1];
        self.window.alike = 0;
        self.window.ticks = 0;
        self.window.begin = self.angle;
    }

    /// Ticks after which a spindle that keeps its speed is ready: three times as many as it needs at best.
    #[must_use]
    pub fn patience(&self) -> u32 {
        let length = match self.window.length {
            // It has just begun: no window has passed.
            0 => self.learning(),
            length => length,
        };
        length.saturating_mul(WINDOWS * 3)
    }

    /// The speed at an instant, turns per second in 2⁻³².
    #[must_use]
    pub fn speed_at(&self, instant: &Prediction) -> i64 {
        // In half a second, twice.
        let ticks = i64::from(self.half_second) << 1;
        (instant.learned.speed >> 16).wrapping_mul(ticks)
    }

    /// Takes what the tick shows. `anew`: the angle has got another zero.
    #[inline(never)]
    pub fn tick(&mut self, look: &Look, anew: bool) {
        if anew {
            self.begin(look);
            return;
        }
        self.is_timed = look.age.is_some();
        self.ticks = self.ticks.saturating_add(1).min(looks::LONGEST);
        let way = rounded(
            self.speed
                .wrapping_add(I16F48::from_bits(self.acceleration.to_bits() >> 1)),
        );
        self.angle = self.angle.wrapping_add(way);
        self.speed = self.speed.wrapping_add(self.acceleration);
        self.free.angle = self.free.angle.wrapping_add(self.free.step);
        self.untaught = self.untaught.saturating_add(1);
        self.watch();
        self.learn();
        if look.lower == self.lower {
            // Four counts should have come by now.
            let way = (self.speed.to_bits() >> 16).wrapping_mul(i64::from(self.ticks));
            if way.unsigned_abs() > (look.width.to_bits() as u64) << 2 {
                self.begin(look);
            }
            return;
        }
        self.lower = look.lower;
        let ticks = core::mem::take(&mut self.ticks);
        let [value, before] = self.swings_now();
        let rate = self
            .speed
            .to_bits()
            .wrapping_add(value)
            .wrapping_sub(before)
            >> 16;
        let predicted = self.angle.wrapping_add(I32F32::from_bits(value >> 16));
        let surprise = measured(look, rate).wrapping_sub(predicted);
        let lost = LOST.wrapping_add(look.width.to_bits() << 1);
        if surprise.to_bits().unsigned_abs() > lost as u64 {
            self.begin(look);
            return;
        }
        self.correct(surprise.to_bits(), ticks);
    }

    /// Goes on from where the quick observer is, and learns anew.
    #[cold]
    fn begin(&mut self, look: &Look) {
        (self.angle, self.speed) = (look.angle, look.speed);
        self.acceleration = I16F48::ZERO;
        self.lower = look.lower;
        self.ticks = 0;
        self.step = Unit::of((self.speed.to_bits() >> 16) as u32);
        self.orders = [Wave::NONE; ORDERS];
        self.free.wave = Wave::NONE;
        self.free.step = self.free.given;
        self.free.unit = Unit::of((self.free.given >> 32) as u32);
        self.is_told = [false; ORDERS + 1];
        self.untaught = 0;
        self.lesson = None;
        self.window = Window {
            begin: self.angle,
            ..Window::NEW
        };
    }

    /// Turns per tick, 2⁻³².
    const fn turn(&self) -> u32 {
        let turn = self.speed.unsigned_abs().to_bits() >> 16;
        if turn > u32::MAX as u64 {
            u32::MAX
        } else {
            turn as u32
        }
    }

    /// True where counts and ticks come often enough to tell the swing that returns `order` times a turn.
    fn sees(&self, order: u32) -> bool {
        let ticks = TICKS.wrapping_mul(order);
        self.counts >= COUNTS && self.turn().checked_mul(ticks).is_some()
    }

    /// True where each tick moves the counter by a count or more.
    fn has_looks_in_each_tick(&self) -> bool {
        u64::from(self.turn()).wrapping_mul(self.counts.into()) >= 1 << 32
    }

    /// The angle by which the poles turn in a tick, 2⁻³²: of 8 Hz, but of at most one and a half times the turns a second,
    /// and of a twelfth of the looks (a fortieth of those that are known to a tick).
    fn pole_now(&self) -> u32 {
        let angle = looks::TWO_PI.wrapping_mul(self.turn().into()) >> 28;
        let by_looks = angle.wrapping_mul(self.counts.into()).min(1 << 36);
        // 1/12 and 1/40, 2⁻³².
        let part = if self.is_timed || self.has_looks_in_each_tick() {
            357_913_941
        } else {
            107_374_182
        };
        let by_looks = (by_looks >> 4).wrapping_mul(part) >> 28;
        let by_turns = angle.wrapping_add(angle >> 1);
        u64::from(self.pole).min(by_turns).min(by_looks) as u32
    }

    /// The pole of an axis that follows, 2⁻³²: quick enough not to lag, slow enough to smooth the steps.
    #[must_use]
    pub fn pole_of_follower(&self) -> u32 {
        let pole = u64::from(self.pole_now());
        let halves = if self.is_timed {
            10
        } else if self.has_looks_in_each_tick() {
            7
        } else {
            5
        };
        let most = u64::from(self.pole).wrapping_mul(5).min(1 << 31);
        (pole.wrapping_mul(halves) >> 1).min(most) as u32
    }

    /// Ticks in which something new is learned: half a second, three turns or forty looks.
    fn learning(&self) -> u32 {
        let turn = u32::MAX.checked_div(self.turn()).unwrap_or(u32::MAX);
        let turns = turn.saturating_mul(3);
        let looks = turn
            .saturating_mul(40)
            .checked_div(self.counts)
            .unwrap_or(u32::MAX);
        self.half_second.max(turns).max(looks).max(40)
    }

    /// Compares the mean speed of each window with that of the window before.
    #[inline(never)]
    fn watch(&mut self) {
        let ticks = self.window.ticks.saturating_add(1);
        self.window.ticks = ticks;
        // The tick before, the end of a window, has its divisions.
        if ticks == 1 && self.is_ready() {
            self.tell();
        }
        let window = &mut self.window;
        let way = self.angle.wrapping_sub(window.begin).to_bits();
        let mean = window.mean.to_bits();
        let more = way.wrapping_sub(mean.wrapping_mul(ticks.into()));
        let length = window.length.max(ticks);
        // Within 4.7 %: a swing of 10 % at 2 Hz is still in the mean of half a second until it is learned.
        let whole = mean.wrapping_mul(length.into()).unsigned_abs();
        let is_alike = more.unsigned_abs() <= (whole >> 5).wrapping_add(whole >> 6);
        if ticks < length {
            if !is_alike {
                // It will not be by the end of the window, and a pass must not begin before that.
                window.alike = 0;
            }
            // A window that began while the spindle came up to speed would last as long as that first speed asks.
            if ticks.checked_rem(self.half_second) == Some(0) {
                self.window.length = self.window.length.min(self.learning());
            }
            return;
        }
        let part = i64::from(u32::MAX.checked_div(length).unwrap_or(u32::MAX));
        let more = (more >> 8).wrapping_mul(part) >> 24;
        window.mean = I32F32::from_bits(window.mean.to_bits().wrapping_add(more));
        window.alike = if is_alike && way != 0 {
            window.alike.saturating_add(1)
        } else {
            0
        };
        window.begin = self.angle;
        window.ticks = 0;
        self.window.length = self.learning();
    }

    /// Takes the swings that are sure into what is predicted, for as long as the spindle keeps its speed. One that grows
    /// during a pass comes in as a step of half a count or more, which the follower takes within its limits.
    ///
    /// An angle without the time of its edge is up to half a count wrong, or half the way of a tick where that is less. At
    /// some speeds this error returns with the turn, and is learned like a swing. An axis would need far more jerk than it
    /// has to follow it: at 1200 rpm, 152 counts and a tick of 2 ms, such a swing is at 40 Hz.
    fn tell(&mut self) {
        let count = u64::from(u32::MAX.checked_div(self.counts).unwrap_or(0)) << 16;
        let error = self.speed.unsigned_abs().to_bits().min(count) >> 1;
        let [first, second] = self.orders;
        let waves = [
            (first, self.sees(1)),
            (second, self.sees(2)),
            (self.free.wave, self.free.given != 0),
        ];
        for ((wave, is_seen), is_told) in waves.iter().zip(&mut self.is_told) {
            *is_told |= *is_seen && (self.is_timed || wave.size() > error);
        }
    }

    /// What the swings that are told are worth where the spindle is at `angle`, `ahead` (2⁻¹⁶ ticks) from now.
    #[inline(never)]
    fn swings(&self, angle: I32F32, ahead: u32) -> Differences {
        let at = Unit::of(angle.to_bits() as u32);
        // Without a branch around each: the worst tick has them all.
        let [is_first, is_second, is_free] = self.is_told;
        let [first, second] = &self.orders;
        let first = first.where_told(is_first);
        let second = second.where_told(is_second);
        let sum = first
            .differences(at, self.step)
            .plus(second.differences(at.doubled(), self.step.doubled()));
        if !is_free {
            return sum;
        }
        let on = (self.free.step >> 16).wrapping_mul(ahead.into());
        let at = Unit::of((self.free.angle.wrapping_add(on) >> 32) as u32);
        sum.plus(self.free.wave.differences(at, self.free.unit))
    }

    /// What the swings are worth now, and a tick before.
    #[inline(never)]
    fn swings_now(&self) -> [i64; 2] {
        let at = Unit::of(self.angle.to_bits() as u32);
        let [first, second] = &self.orders;
        let sum = |one: [i64; 2], other: [i64; 2]| {
            let ([a, b], [c, d]) = (one, other);
            [a.wrapping_add(c), b.wrapping_add(d)]
        };
        let orders = sum(
            first.pair(at, self.step),
            second.pair(at.doubled(), self.step.doubled()),
        );
        if self.free.given == 0 {
            return orders;
        }
        let at = Unit::of((self.free.angle >> 32) as u32);
        sum(orders, self.free.wave.pair(at, self.free.unit))
    }

    /// Corrects everything by the surprise (turns, 2⁻³²) of a look that came `ticks` after the one before.
    #[inline(never)]
    fn correct(&mut self, surprise: i64, ticks: u32) {
        let at = self.angle;
        let pole = self.pole_now();
        let gains = looks::gains(pole, ticks, self.is_timed);
        let by = |gain: I32F32, bits: u32| {
            let half = 1_i64 << (bits.wrapping_sub(1));
            gain.to_bits().wrapping_mul(surprise).wrapping_add(half) >> bits
        };
        self.angle = at.wrapping_add(I32F32::from_bits(by(gains.alpha, 32)));
        self.speed = self
            .speed
            .wrapping_add(I16F48::from_bits(by(gains.beta, 16)));
        let acceleration = gains.of_acceleration(I32F32::from_bits(surprise));
        self.acceleration = self.acceleration.wrapping_add(acceleration);
        if self.window.alike == 0 {
            // The speed changes, and would be taken for a swing.
            self.untaught = 0;
            return;
        }
        if self.lesson.is_some() {
            return;
        }
        // What was surprising is learned by this share, 2·n/τ.
        let untaught = core::mem::take(&mut self.untaught);
        let share = u64::from(self.per_tick())
            .wrapping_mul(u64::from(untaught) << 1)
            .min(1 << 31) as i64;
        self.lesson = Some(Lesson {
            next: Swing::First,
            // A surprise has at most 31 bits.
            size: surprise.wrapping_mul(share) >> 16,
            at: at.to_bits() as u32,
            free_at: (self.free.angle >> 32) as u32,
            pole,
        });
    }

    /// One through the ticks in which something new is learned, 2⁻³².
    fn per_tick(&self) -> u32 {
        u32::MAX.checked_div(self.learning()).unwrap_or(0)
    }

    /// Takes in what the last lesson says of one swing.
    #[inline(never)]
    fn learn(&mut self) {
        let Some(lesson) = &mut self.lesson else {
            return;
        };
        let now = *lesson;
        let after = match now.next {
            Swing::First => Some(Swing::Second),
            Swing::Second if self.free.given != 0 => Some(Swing::Free),
            Swing::Second | Swing::Free => None,
        };
        match after {
            Some(next) => lesson.next = next,
            None => self.lesson = None,
        }
        let order = match now.next {
            Swing::First => 1_u32,
            Swing::Second => 2,
            Swing::Free => {
                // Four looks in a period.
                let looks = u64::from(self.turn()).wrapping_mul(self.counts.into());
                if self.free.step >> 30 < looks {
                    let per_tick = self.per_tick();
                    self.free.learn(&now, per_tick);
                }
                return;
            }
        };
        if !self.sees(order) {
            return;
        }
        let turn = (looks::TWO_PI.wrapping_mul(self.turn().into()) >> 28) as i64;
        let turn = turn.wrapping_mul(self.speed.to_bits().signum());
        let unit = Unit::of(now.at.wrapping_mul(order));
        let [first, second] = &mut self.orders;
        let wave = if order == 1 { first } else { second };
        let omega = turn.wrapping_mul(order.into());
        learn(wave, unit, now.size, now.pole, omega);
        if order == 1 {
            self.step = Unit::of((self.speed.to_bits() >> 16) as u32);
        }
    }

    /// The angle at the time `ahead` (ticks, 2⁻¹⁶) after the last sample.
    #[must_use]
    #[inline(never)]
    pub fn predict(&self, ahead: u32) -> Prediction {
        let ticks = i64::from(ahead);
        let speed = self.speed.to_bits();
        let acceleration = self.acceleration.to_bits();
        let half_square = ticks.wrapping_mul(ticks >> 1) >> 16;
        let way = ((speed >> 16).wrapping_mul(ticks) >> 16)
            .wrapping_add((acceleration >> 16).wrapping_mul(half_square) >> 16);
        let angle = self.angle.wrapping_add(I32F32::from_bits(way));
        let mean = Differences {
            value: angle.to_bits() << 16,
            speed: speed
                .wrapping_add((acceleration >> 8).wrapping_mul(ticks) >> 8)
                .wrapping_sub(acceleration >> 1),
            acceleration,
            jerk: 0,
        };
        let swings = self.swings(angle, ahead);
        Prediction {
            angle: angle.to_bits().wrapping_add(swings.value >> 16),
            learned: mean.plus(swings),
        }
    }
}

impl Free {
    /// Learns from a look: size, phase and, by the phase that turns, the frequency. `per_tick` is 1/τ, 2⁻³².
    fn learn(&mut self, lesson: &Lesson, per_tick: u32) {
        let at = Unit::of(lesson.free_at);
        let omega = (looks::TWO_PI.wrapping_mul(self.step >> 32) >> 28) as i64;
        let before = self.wave;
        learn(&mut self.wave, at, lesson.size, lesson.pole, omega);
        let turned = before.turned(&self.wave);
        // Half of the phase by which it has turned, over τ: 2⁻⁶⁴ radians, then periods by 1/(4π).
        let radians = turned.wrapping_mul(per_tick.into()) >> 16;
        let periods = radians.wrapping_mul(341_782_638) >> 16;
        let room = self.given >> 4;
        self.step = self
            .step
            .wrapping_sub(periods as u64)
            .max(self.given.wrapping_sub(room))
            .min(self.given.wrapping_add(room));
        self.unit = Unit::of((self.step >> 32) as u32);
    }
}

/// The angle that a look shows, at `rate` turns per tick (2⁻³²). An edge without a time was in the middle of the tick.
fn measured(look: &Look, rate: i64) -> I32F32 {
    let way = match look.age {
        Some(age) => rate.wrapping_mul(age) >> 24,
        None => rate >> 1,
    };
    let most = match look.age {
        Some(_) => look.width.to_bits(),
        None => look.width.to_bits() >> 1,
    };
    let way = way.min(most).max(most.wrapping_neg());
    let within = if rate < 0 {
        look.width.to_bits().wrapping_add(way)
    } else {
        way
    };
    look.lower.wrapping_add(I32F32::from_bits(within))
}

/// Turns with 48 bits after the point, rounded to 32.
const fn rounded(value: I16F48) -> I32F32 {
    I32F32::from_bits(value.to_bits().wrapping_add(1 << 15) >> 16)
}
