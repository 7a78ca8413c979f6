//! Axes that are moved by hand: a press moves X, Z or both until it is over; a step moves one of them by a length; a
//! handwheel leads one of them along (`wheel`). A press may turn the spindle instead.
//!
//! ```text
//! press (which way, how fast, until when) ─► a profile for each axis ─► position
//! ```
//!
//! Each axis has a profile of its own: one may brake while the other begins. A motion begins with the whole way to the
//! limit of the travel, so it ends exactly there from any speed; a press that is over abandons the rest. An axis turns
//! round from rest only.
//!
//! A press is alive until its tick, which its renewals put off. A press that has ended is dead: no renewal moves anything.
//!
//! Must not know who presses, over which wire, or what the drives do.

use self::wheel::{Follower, Turned};
use super::limits::{Limits, Pace};
use super::profile::{Profile, Ramp};
use super::rate::{PathRate, Rate};
use super::shape;
use crate::alarm::Code;
use crate::call::Position;
use crate::operating::{PressState, Towards};
use crate::params::Params;
use crate::units::{Axis, Length, Rpm};
use crate::zones::Point;

mod wheel;
mod zones;

pub use self::wheel::Wheel;

/// The longest ramp of a motion by hand, in ticks.
const TICKS: usize = 1024;

/// How far an axis may go, in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisTravel {
    /// The smallest coordinate.
    pub low: Length,
    /// The greatest coordinate.
    pub high: Length,
}

impl AxisTravel {
    /// No limits: farther than any axis goes.
    pub const UNLIMITED: Self = Self {
        low: Length::from_nm(-100_000_000_000),
        high: Length::from_nm(100_000_000_000),
    };

    /// The travel of an axis: parameters 1320 and 1321.
    #[must_use]
    pub fn of(params: &Params, axis: Axis) -> Self {
        Self {
            low: Length::from_nm(params.soft_limit_minus(axis)),
            high: Length::from_nm(params.soft_limit_plus(axis)),
        }
    }

    /// How far it is from `at` to the end in this direction; below zero beyond it.
    #[must_use]
    pub fn left(&self, at: Length, towards: Towards) -> Length {
        match towards {
            Towards::Plus => self.high - at,
            Towards::Minus => at - self.low,
        }
    }

    /// The same, and zero beyond the end.
    fn free(&self, at: Length, towards: Towards) -> Length {
        self.left(at, towards).max(Length::ZERO)
    }
}

/// The motion of one axis that a press asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisPress {
    /// Which way.
    pub towards: Towards,
    /// The speed at an override of 100 %.
    pub speed: PathRate,
    /// The ramp: no override goes beyond its cap.
    pub ramp: Ramp,
}

impl AxisPress {
    /// A motion of an axis at `speed`, at most at `top`. `at_rapid`: the override goes to 100 %, else to 150 %. `None`
    /// where the limits of the axis allow no motion at all.
    #[inline(never)]
    #[must_use]
    pub fn new(
        (axis, towards): (Axis, Towards),
        (speed, top): (PathRate, PathRate),
        at_rapid: bool,
        limits: &Limits,
    ) -> Option<Self> {
        let speed = speed.min(top);
        let cap = if at_rapid {
            speed
        } else {
            Rate::percent(150).of(speed).min(top)
        };
        let limits = limits.of_axis(axis, Pace::Rapid);
        Some(Self {
            towards,
            speed,
            ramp: shape::ramp_within(cap, &limits, TICKS as u16)?,
        })
    }
}

impl AxisPress {
    /// An axis that a handwheel leads, at most at `top`. Its way may turn round at any time, for which the ramp is longer
    /// than that of a press. `None` where the limits of the axis allow no motion at all.
    #[inline(never)]
    #[must_use]
    pub fn led(axis: Axis, top: PathRate, limits: &Limits) -> Option<Self> {
        let mut limits = limits.of_axis(axis, Pace::Rapid);
        limits.acceleration /= 2;
        limits.jerk /= 4;
        let top = top.min(PathRate::from_raw(i32::MAX as u32));
        let ramp = shape::ramp_within(top, &limits, TICKS as u16)?;
        Some(Self {
            towards: Towards::Plus,
            speed: top.min(ramp.cap()),
            ramp,
        })
    }
}

/// A press or a step, or its renewal, or a handwheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// Number of the press.
    pub number: u8,
    /// What X does.
    pub x: Option<AxisPress>,
    /// What Z does.
    pub z: Option<AxisPress>,
    /// How the spindle turns, before override; at rest: not by this press.
    pub spindle: Rpm,
    /// The rapid override acts, else the feed override.
    pub at_rapid: bool,
    /// Planned for an open door: no axis is faster than 9043.
    pub slow: bool,
    /// Where the machine is with the tip of the tool at zero, if zones count: geometry and wear.
    pub tip: Option<Point>,
    /// A step: the axes go this far, and no farther. Of a handwheel: how far it has been turned since its claim, with its
    /// sign.
    pub way: Option<Length>,
    /// A handwheel leads the axis.
    pub wheel: Option<Wheel>,
    /// The last tick in which the press is alive; `None` for a short step, which is always made whole.
    pub until: Option<u32>,
    /// No press: the axes go back to where the program was left, each at the speed of its motion here.
    pub returns: bool,
}

impl Press {
    /// The side to which `axis` moves by it.
    #[must_use]
    pub fn side(&self, axis: &AxisPress) -> Towards {
        match (&self.wheel, self.way) {
            (Some(_), Some(way)) => Towards::of(way),
            _ => axis.towards,
        }
    }
}

/// What a tick needs to know.
#[derive(Clone, Copy, Debug)]
pub struct JogConditions {
    /// Number of the tick; it wraps.
    pub now: u32,
    /// Feed override.
    pub feed: Rate,
    /// Rapid override.
    pub rapid: Rate,
}

/// One axis.
#[derive(Debug)]
struct JogAxis {
    profile: Profile<TICKS>,
    /// It has begun and is not at rest again.
    moves: bool,
    /// Which way it moves.
    towards: Towards,
    /// Where it began.
    from: Length,
    /// How far it is to go from there.
    way: Length,
    /// It has gone the whole way in this direction: the present press moves it no farther.
    arrived: Option<Towards>,
    /// What leads it while a handwheel does.
    follower: Follower,
}

/// The axes that are moved by hand.
#[derive(Debug)]
pub struct Jog {
    x: JogAxis,
    z: JogAxis,
    press: Option<Press>,
    /// Number of the last press, and what became of it.
    last: (u8, PressState),
    /// Why it was refused.
    refusal: Option<Code>,
}

impl JogAxis {
    const fn new() -> Self {
        Self {
            profile: Profile::new(),
            moves: false,
            towards: Towards::Plus,
            from: Length::ZERO,
            way: Length::ZERO,
            arrived: None,
            follower: Follower::NEW,
        }
    }

    const fn begin_anew(&mut self) {
        self.profile.begin_anew();
        self.moves = false;
        self.arrived = None;
        self.follower = Follower::NEW;
    }

    /// One tick. `wanted`: what the press asks of this axis. True where counts of the handwheel are too many.
    fn tick(
        &mut self,
        at: &mut Length,
        wanted: Option<&AxisPress>,
        press: Option<&Press>,
        rate: Rate,
        travel: &AxisTravel,
    ) -> bool {
        let turned = Turned::of(wanted, press);
        if self.follower.is_under_way() || turned.is_some() && !self.moves {
            return self.follow(at, turned.as_ref(), travel);
        }
        let wanted = wanted.filter(|_| turned.is_none());
        let way = press.and_then(|press| press.way);
        self.go(at, wanted, way, rate, travel);
        false
    }

    /// One tick of a press or a step.
    fn go(
        &mut self,
        at: &mut Length,
        wanted: Option<&AxisPress>,
        way: Option<Length>,
        rate: Rate,
        travel: &AxisTravel,
    ) {
        if !self.moves {
            if let Some(wanted) = wanted
                && self.arrived != Some(wanted.towards)
            {
                self.begin(*at, wanted, way, travel);
            }
            return;
        }
        let wanted = wanted.filter(|wanted| wanted.towards == self.towards);
        let speed = match wanted {
            Some(wanted) => rate.of(wanted.speed),
            None => {
                self.profile.abandon();
                PathRate::ZERO
            }
        };
        let progress = self.profile.tick_at(speed);
        // Whole nanometres, rounded to the nearest.
        let nm = progress.travel.raw().saturating_add(1 << 15) >> 16;
        let gone = Length::from_nm(i64::try_from(nm).unwrap_or(i64::MAX));
        *at = match self.towards {
            Towards::Plus => self.from + gone,
            Towards::Minus => self.from - gone,
        };
        if progress.done {
            self.moves = false;
            // One that was let go and is asked for again has braked on its way, and one that a press takes over from a step
            // is at the end of that: it goes on.
            let ends = way.is_some() || travel.free(*at, self.towards) == Length::ZERO;
            let whole = gone >= self.way && ends;
            self.arrived = wanted.filter(|_| whole).map(|wanted| wanted.towards);
        }
    }

    fn begin(&mut self, at: Length, wanted: &AxisPress, way: Option<Length>, travel: &AxisTravel) {
        let free = travel.free(at, wanted.towards);
        let way = way.map_or(free, |way| way.min(free));
        if way == Length::ZERO {
            self.arrived = Some(wanted.towards);
        } else if self.profile.begin(way, wanted.speed, wanted.ramp) {
            (self.moves, self.towards) = (true, wanted.towards);
            (self.from, self.way) = (at, way);
            // It leaves the end at which it had arrived.
            self.arrived = None;
        }
    }

    /// Another step in the same direction while this one is under way.
    fn extend(&mut self, wanted: &AxisPress, more: Length, travel: &AxisTravel) {
        if !self.moves || self.towards != wanted.towards {
            return;
        }
        let free = travel.free(self.from, self.towards) - self.way;
        let more = more.min(free).max(Length::ZERO);
        if self.profile.extend(more) {
            self.way += more;
        }
    }
}

impl Default for Jog {
    fn default() -> Self {
        Self::new()
    }
}

impl Jog {
    /// Nothing is pressed, and nothing moves.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            x: JogAxis::new(),
            z: JogAxis::new(),
            press: None,
            last: (0, PressState::None),
            refusal: None,
        }
    }

    /// Nothing is pressed any more, and nothing moves.
    pub const fn begin_anew(&mut self) {
        self.x.begin_anew();
        self.z.begin_anew();
        self.end(PressState::Ended);
    }

    /// Takes a press, or the renewal of the one that is alive. The renewal of a press that has ended does nothing. A step
    /// goes on from the one under way.
    pub fn press(&mut self, press: &Press, x: &AxisTravel, z: &AxisTravel) {
        let (number, state) = self.last;
        if let Some(present) = &mut self.press
            && number == press.number
        {
            let until = later(present.until, press.until);
            *present = Press { until, ..*press };
            return;
        }
        if number == press.number && state != PressState::None {
            return;
        }
        for axis in [&mut self.x, &mut self.z] {
            axis.arrived = None;
            axis.follower.begin_claim();
        }
        if let (Some(way), None) = (press.way, press.wheel) {
            if let Some(wanted) = &press.x {
                self.x.extend(wanted, way, x);
            }
            if let Some(wanted) = &press.z {
                self.z.extend(wanted, way, z);
            }
        }
        self.take(press);
    }

    /// Begins a motion by hand that nobody renews, from rest.
    pub const fn begin(&mut self, press: &Press) {
        (self.x.arrived, self.z.arrived) = (None, None);
        self.take(press);
    }

    const fn take(&mut self, press: &Press) {
        self.press = Some(*press);
        self.last = (press.number, PressState::Runs);
        self.refusal = None;
    }

    /// A press that may not move the machine, and why. It ends the one before, as any new press does.
    pub const fn refuse(&mut self, number: u8, why: Code) {
        self.press = None;
        self.last = (number, PressState::Refused);
        self.refusal = Some(why);
    }

    /// How the press that is alive turns the spindle.
    #[must_use]
    pub fn turns(&self) -> Rpm {
        let press = self.press.as_ref();
        press.map_or(Rpm::STOPPED, |press| press.spindle)
    }

    /// Why the last press was refused, if it was.
    #[must_use]
    pub const fn refusal(&self) -> Option<Code> {
        self.refusal
    }

    /// The press is over: the axes brake.
    pub const fn release(&mut self) {
        self.end(PressState::Ended);
    }

    const fn end(&mut self, state: PressState) {
        if self.press.is_some() {
            self.press = None;
            self.last.1 = state;
        }
    }

    /// An axis moves, or a press is alive.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.press.is_some() || self.moves()
    }

    /// An axis moves.
    #[must_use]
    pub const fn moves(&self) -> bool {
        self.x.moves || self.z.moves
    }

    /// Number of the last press, and what became of it.
    #[must_use]
    pub const fn last(&self) -> (u8, PressState) {
        self.last
    }

    /// One tick: the position moves on. True, once in a claim, where a handwheel that is followed is too far ahead.
    pub fn tick(
        &mut self,
        now: &JogConditions,
        x: &AxisTravel,
        z: &AxisTravel,
        position: &mut Position,
    ) -> bool {
        if let Some(until) = self.press.as_ref().and_then(|press| press.until)
            && is_over(until, now.now)
        {
            self.end(PressState::Ended);
        }
        let press = self.press.as_ref();
        let rate = match press {
            Some(press) if press.at_rapid => now.rapid,
            _ => now.feed,
        };
        let wanted = press.and_then(|press| press.x.as_ref());
        let mut drops = self.x.tick(&mut position.x, wanted, press, rate, x);
        let wanted = press.and_then(|press| press.z.as_ref());
        drops |= self.z.tick(&mut position.z, wanted, press, rate, z);
        self.note_end();
        drops
    }

    /// A press in which every axis has gone its way is over. The spindle turns until it is let go.
    fn note_end(&mut self) {
        let Some(press) = &self.press else { return };
        let waits = |wanted: Option<AxisPress>, axis: &JogAxis| {
            wanted.is_some_and(|wanted| axis.arrived != Some(wanted.towards))
        };
        let turns = press.spindle != Rpm::STOPPED;
        if turns || waits(press.x, &self.x) || waits(press.z, &self.z) {
            return;
        }
        let state = match press.way {
            Some(_) => PressState::Ended,
            None => PressState::Limit,
        };
        self.end(state);
    }
}

/// The tick is behind `until`. Both wrap.
const fn is_over(until: u32, now: u32) -> bool {
    now.wrapping_sub(until) as i32 > 0
}

/// The later of two ends.
const fn later(present: Option<u32>, renewed: Option<u32>) -> Option<u32> {
    match (present, renewed) {
        (Some(present), Some(renewed)) if is_over(present, renewed) => Some(renewed),
        (present, _) => present,
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests;
