//! How a drive homes by itself (CiA 402, mode 6): its switches, its index, its way, and what its statusword says meanwhile.
//!
//! This is written from the standard's pictures of the methods, on purpose not from the master's code. Places are those of
//! the axis itself, in increments; the drive's count is another number, which homing sets.

/// Steps of the motion in a SYNC period.
const STEPS: i64 = 8;

/// The switches of an axis, the index of its motor, and what is odd about its drive. Lengths in increments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomingOptions {
    /// The negative limit switch is on from here to the negative end.
    pub negative: i64,
    /// The positive limit switch is on from here to the positive end.
    pub positive: i64,
    /// The home switch is on from the first of these to the second.
    pub home: (i64, i64),
    /// A switch goes off so much farther than where it went on.
    pub hysteresis: i64,
    /// The index of the motor comes at each multiple of this, above zero.
    pub turn: i64,
    /// Where the index at zero is.
    pub index: i64,
    /// The axis stays where it came to rest past the mark; otherwise it goes back to the mark.
    pub ends_past: bool,
    /// At the mark it counts +607Ch; otherwise −607Ch.
    pub adds_offset: bool,
    /// SYNCs after the start for which bits 12 and 10 of an earlier homing stand.
    pub stale: u16,
    /// It starts, and never ends.
    pub never: bool,
    /// It starts, and reports an error.
    pub fails: bool,
    /// SYNCs that a change of its mode takes.
    pub slow: u16,
    /// After power-up it counts from zero.
    pub forgets: bool,
}

impl Default for HomingOptions {
    /// Switches far away, an index every 50 000 increments.
    fn default() -> Self {
        Self::FAR
    }
}

impl HomingOptions {
    /// Switches that no axis reaches, and a drive that homes as its sheet says.
    pub const FAR: Self = Self {
        negative: -2_000_000_000,
        positive: 2_000_000_000,
        home: (1_000_000_000, 1_000_200_000),
        hysteresis: 200,
        turn: 50_000,
        index: 12_500,
        ends_past: false,
        adds_offset: false,
        stale: 0,
        never: false,
        fails: false,
        slow: 0,
        forgets: false,
    };
}

impl HomingOptions {
    /// The method of 6098h that goes with [`Self::at_plus_end`]: slowly off the home switch, whose edge is the mark.
    pub const OFF_THE_PLUS_END: u8 = 19;

    /// An axis with its reference at the plus end: the home switch is on from behind the mark to the end of the way.
    #[must_use]
    pub fn at_plus_end(mark: i64) -> Self {
        let far = Self::default();
        Self {
            home: (mark.wrapping_add(far.hysteresis), far.positive),
            ..far
        }
    }
}

/// What a way waits for: the edge of a switch, or the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    Negative(bool),
    Positive(bool),
    Home(bool),
    Index,
}

/// A way in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Way {
    /// 1 or −1.
    sign: i64,
    fast: bool,
    until: Until,
}

const fn way(sign: i64, fast: bool, until: Until) -> Option<Way> {
    Some(Way { sign, fast, until })
}

/// The most ways of a method.
const WAYS: usize = 4;

/// The speeds of a homing, as the drive has them in its objects: increments per second, and per second squared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Speeds {
    pub(super) fast: u32,
    pub(super) slow: u32,
    pub(super) ramp: u32,
    pub(super) tick_us: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Not started, or aborted.
    Idle,
    /// On its ways.
    Running,
    /// The mark is behind it.
    Found,
    /// At rest behind it, or back at it.
    Done,
    Error,
}

/// A drive's homing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Homing {
    pub(super) options: HomingOptions,
    state: State,
    ways: [Option<Way>; WAYS],
    at: usize,
    /// Place in 2⁻¹⁶ increments.
    fine: i64,
    /// Speed in 2⁻¹⁶ increments a step.
    speed: i64,
    /// Negative limit, positive limit, home.
    switches: [bool; 3],
    /// Bit 4 of the last controlword.
    started: bool,
    halted: bool,
    mark: i64,
    /// The first way has turned around at a limit.
    turned: bool,
    /// SYNCs for which the bits of an earlier homing stand.
    stale: u16,
    /// Bits 13, 12 and 10 as they were at the start.
    before: u16,
}

/// The bits of a statusword.
const ERROR: u16 = 1 << 13;
const ATTAINED: u16 = 1 << 12;
const REACHED: u16 = 1 << 10;

impl Homing {
    pub(super) const fn new(options: HomingOptions) -> Self {
        Self {
            options,
            state: State::Idle,
            ways: [None; WAYS],
            at: 0,
            fine: 0,
            speed: 0,
            switches: [false; 3],
            started: false,
            halted: false,
            mark: 0,
            turned: false,
            stale: 0,
            before: 0,
        }
    }

    /// True for a method that this drive has.
    pub(super) const fn has(method: u8) -> bool {
        matches!(method, 1 | 2 | 7..=14 | 17..=30 | 33..=35 | 37)
    }

    /// 60FDh.
    pub(super) const fn inputs(&self) -> u32 {
        let [negative, positive, home] = self.switches;
        negative as u32 | (positive as u32) << 1 | (home as u32) << 2
    }

    /// Bits 13, 12 and 10 of the statusword in mode 6.
    pub(super) const fn bits(&self) -> u16 {
        if self.stale > 0 {
            return self.before;
        }
        self.own_bits()
    }

    const fn own_bits(&self) -> u16 {
        let rests = if self.speed == 0 { REACHED } else { 0 };
        match self.state {
            State::Idle => rests,
            State::Running if self.halted => rests,
            State::Running => 0,
            State::Found => ATTAINED,
            State::Done => ATTAINED | REACHED,
            State::Error => ERROR | rests,
        }
    }

    /// The axis is at this place: what its switches say.
    pub(super) fn pass(&mut self, place: i64) {
        let o = &self.options;
        let [negative, positive, home] = &mut self.switches;
        let off = o.hysteresis;
        let more = |on: bool| if on { off } else { 0 };
        *negative = place <= o.negative.wrapping_add(more(*negative));
        *positive = place >= o.positive.wrapping_sub(more(*positive));
        let more = more(*home);
        *home = place >= o.home.0.wrapping_sub(more) && place <= o.home.1.wrapping_add(more);
    }

    /// The drive has no torque, or another mode: whatever is under way is over.
    pub(super) const fn rest(&mut self) {
        self.speed = 0;
        self.started = false;
        if matches!(self.state, State::Running | State::Found) {
            self.state = State::Idle;
        }
    }

    /// The drive has been switched on.
    pub(super) const fn restart(&mut self) {
        *self = Self {
            switches: self.switches,
            ..Self::new(self.options)
        };
    }

    /// A SYNC period in mode 6 at this place. Gives the place at its end, and the place of the mark where it was passed.
    pub(super) fn advance(
        &mut self,
        place: i64,
        control: u16,
        method: u8,
        speeds: &Speeds,
    ) -> (i64, Option<i64>) {
        let start = control & 0x10 != 0;
        if self.speed == 0 && self.fine >> 16 != place {
            self.fine = place.wrapping_shl(16);
        }
        if start && !self.started {
            self.before = self.own_bits() | if self.options.stale > 0 { REACHED } else { 0 };
            self.stale = self.options.stale;
            self.begin(method);
        } else if !start && matches!(self.state, State::Running | State::Found) {
            self.state = State::Idle;
        }
        self.started = start;
        self.stale = self.stale.saturating_sub(1);
        self.halted = control & 0x100 != 0;
        let mut mark = None;
        for _ in 0..STEPS {
            if let Some(found) = self.step(speeds) {
                mark = Some(found);
            }
        }
        (self.place(), mark)
    }

    const fn place(&self) -> i64 {
        self.fine >> 16
    }

    /// The ways of a method from here.
    fn begin(&mut self, method: u8) {
        if self.options.fails {
            self.state = State::Error;
            return;
        }
        let [negative, positive, home] = self.switches;
        self.at = 0;
        self.turned = false;
        self.state = State::Running;
        self.mark = self.place();
        let index = method < 17 || method == 33 || method == 34;
        let same = match method {
            1..=16 => method,
            _ => method.wrapping_sub(16),
        };
        // Methods 11 to 14 are 7 to 10 in the mirror.
        let sign = if matches!(same, 7..=10) { 1_i64 } else { -1 };
        let back = sign.wrapping_neg();
        let find = |sign| {
            (!home).then_some(Way {
                sign,
                fast: true,
                until: Until::Home(true),
            })
        };
        let on = Until::Home(true);
        let off = Until::Home(false);
        let ways: [Option<Way>; 3] = match (method, same) {
            (33, _) => [way(-1, false, Until::Index), None, None],
            (34, _) => [way(1, false, Until::Index), None, None],
            (35 | 37, _) => [None; 3],
            // The switch is on to the positive end (19, 20), or to the negative end (21, 22).
            (19, _) => [find(1), way(-1, false, off), None],
            (20, _) => [find(1), way(-1, true, off), way(1, false, on)],
            (21, _) => [find(-1), way(1, false, off), None],
            (22, _) => [find(-1), way(1, true, off), way(-1, false, on)],
            (_, 1) => {
                let go = (!negative).then_some(Way {
                    sign: -1,
                    fast: true,
                    until: Until::Negative(true),
                });
                [go, way(1, false, Until::Negative(false)), None]
            }
            (_, 2) => {
                let go = (!positive).then_some(Way {
                    sign: 1,
                    fast: true,
                    until: Until::Positive(true),
                });
                [go, way(-1, false, Until::Positive(false)), None]
            }
            // The near edge, outside and inside; the far edge, inside and outside.
            (_, 7 | 11) => [find(sign), way(back, false, off), None],
            (_, 8 | 12) => [find(sign), way(back, true, off), way(sign, false, on)],
            (_, 9 | 13) => [find(sign), way(sign, true, off), way(back, false, on)],
            (_, 10 | 14) => [find(sign), way(sign, false, off), None],
            _ => {
                self.state = State::Error;
                return;
            }
        };
        let [first, second, third] = ways;
        let last = third.or(second).or(first);
        let to_index = match last {
            Some(last) if index && last.until != Until::Index => {
                way(last.sign, false, Until::Index)
            }
            _ => None,
        };
        let mut packed = [None; WAYS];
        let all = ways.into_iter().chain([to_index]).flatten();
        for (slot, next) in packed.iter_mut().zip(all) {
            *slot = Some(next);
        }
        self.ways = packed;
    }

    fn way(&self) -> Option<Way> {
        self.ways.get(self.at).copied().flatten()
    }

    /// A step of the motion. Gives the mark, where it is passed or reached.
    fn step(&mut self, speeds: &Speeds) -> Option<i64> {
        let per_step = |speed: u32| {
            let all = i64::from(speed)
                .wrapping_shl(16)
                .wrapping_mul(i64::from(speeds.tick_us));
            all / (1_000_000 * STEPS)
        };
        // Two divisions, because the product would be too large.
        let ramp = (per_step(speeds.ramp).wrapping_mul(i64::from(speeds.tick_us))
            / (1_000_000 * STEPS))
            .max(1);
        let runs = self.state == State::Running;
        let running = runs && !self.halted;
        let way = self.way();
        if running && way.is_none() && !self.options.never {
            // Here (35, 37), or every way is done.
            self.state = State::Found;
            return Some(self.mark);
        }
        let wanted = match way {
            Some(way) if running && !self.options.never => {
                let turns = self.speed.signum() == way.sign.wrapping_neg();
                let speed = per_step(if way.fast { speeds.fast } else { speeds.slow });
                if turns {
                    0
                } else {
                    speed.wrapping_mul(way.sign)
                }
            }
            _ => 0,
        };
        if self.state == State::Found && self.speed == 0 {
            return self.go_back(per_step(speeds.slow));
        }
        let change = wanted
            .wrapping_sub(self.speed)
            .clamp(ramp.wrapping_neg(), ramp);
        self.speed = self.speed.wrapping_add(change);
        let from = self.place();
        self.fine = self.fine.wrapping_add(self.speed);
        let to = self.place();
        let before = self.switches;
        self.pass(to);
        if runs && let Some(way) = way {
            self.meet(way, before, from, to);
        }
        None
    }

    /// After the mark: back to it, or not.
    fn go_back(&mut self, speed: i64) -> Option<i64> {
        let way = self.mark.wrapping_shl(16).wrapping_sub(self.fine);
        if self.options.ends_past || way == 0 {
            self.state = State::Done;
            return None;
        }
        let step = way.clamp(speed.wrapping_neg(), speed);
        self.fine = self.fine.wrapping_add(step);
        self.pass(self.place());
        None
    }

    /// Whether this step has met what the way waits for, or a switch that it must not.
    fn meet(&mut self, way: Way, before: [bool; 3], from: i64, to: i64) {
        let o = &self.options;
        let [negative, positive, home] = self.switches;
        let off = o.hysteresis;
        let edge = |was: bool, is: bool, wanted: bool| was != is && is == wanted;
        let [was_negative, was_positive, was_home] = before;
        let met = match way.until {
            Until::Negative(on) => edge(was_negative, negative, on)
                .then_some(o.negative.wrapping_add(if on { 0 } else { off })),
            Until::Positive(on) => edge(was_positive, positive, on)
                .then_some(o.positive.wrapping_sub(if on { 0 } else { off })),
            Until::Home(on) => {
                let low = o.home.0.wrapping_sub(if on { 0 } else { off });
                let high = o.home.1.wrapping_add(if on { 0 } else { off });
                // A switch that comes on is entered where the axis comes from; one that goes off is left where it goes.
                let at_low = (way.sign > 0) == on;
                edge(was_home, home, on).then_some(if at_low { low } else { high })
            }
            Until::Index => self.index_between(from, to),
        };
        if let Some(mark) = met.filter(|_| to.wrapping_sub(from).signum() == way.sign) {
            self.mark = mark;
            self.at = self.at.wrapping_add(1);
            return;
        }
        let into_limit = negative && way.sign < 0 || positive && way.sign > 0;
        let expected = matches!(way.until, Until::Negative(true) | Until::Positive(true));
        if !into_limit || expected {
            return;
        }
        match (way.until, self.ways.get_mut(self.at)) {
            // The first way turns around at a limit, once.
            (Until::Home(true), Some(slot)) if way.fast && self.at == 0 && !self.turned => {
                self.turned = true;
                *slot = Some(Way {
                    sign: way.sign.wrapping_neg(),
                    ..way
                });
            }
            _ => self.state = State::Error,
        }
    }

    /// The index that lies behind `from` and not behind `to`.
    fn index_between(&self, from: i64, to: i64) -> Option<i64> {
        let o = &self.options;
        if o.turn <= 0 || from == to {
            return None;
        }
        let turns = |place: i64| place.wrapping_sub(o.index).div_euclid(o.turn);
        let place = |turns: i64| turns.wrapping_mul(o.turn).wrapping_add(o.index);
        let (low, high) = (from.min(to), from.max(to));
        // Upwards: in (from, to]; downwards: in [to, from).
        let last = if to > from {
            turns(high)
        } else {
            turns(high.wrapping_sub(1))
        };
        let index = place(last);
        let inside = if to > from { index > low } else { index >= low };
        inside.then_some(index)
    }
}
