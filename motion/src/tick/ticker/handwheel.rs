//! A program that follows a handwheel: how fast it goes along its path, and what runs by itself.
//!
//! ```text
//! way that the wheel was turned ─► mean of 50 ms ─► speed along the path ─► share of the programmed one
//! ```
//!
//! What the spindle drives cannot follow a wheel: threads and taps run by themselves, and wait for the operator before they
//! begin. A dwell and machine functions take their time.
//!
//! Must not know who turns the wheel, or over which wire.

use super::{Ends, Ticker, emit};
use crate::alarm::{Alarm, Code};
use crate::motion::{Action, PathRate, Rate, Scaling, Segment, programmed};
use crate::tick::Event;
use crate::units::Length;

/// The mean is over this part of a second: 50 ms.
const MEAN: u32 = 20;

/// No rapid is faster.
const RAPID: Rate = Rate::percent(25);

/// The handwheel that a program follows.
#[derive(Debug)]
pub(super) struct Handwheel {
    /// The program follows it.
    on: bool,
    /// The operator has let a thread or a tap run by itself, or is asked to.
    alone: bool,
    /// What it was turned and the mean has not given out yet, in 1/256 nm.
    ahead: u32,
}

impl Handwheel {
    /// No program follows it.
    pub(super) const OFF: Self = Self {
        on: false,
        alone: false,
        ahead: 0,
    };

    pub(super) const fn is_on(&self) -> bool {
        self.on
    }

    /// The next program follows it, or does not.
    pub(super) const fn set(&mut self, on: bool) {
        *self = Self { on, ..Self::OFF };
    }

    /// It has been turned. Backwards it takes back what was not given out yet, and no more: no program runs backwards.
    pub(super) const fn turn(&mut self, way: Length) {
        let ahead = way
            .nm()
            .saturating_mul(256)
            .saturating_add(self.ahead as i64);
        self.ahead = if ahead < 0 {
            0
        } else if ahead > u32::MAX as i64 {
            u32::MAX
        } else {
            ahead as u32
        };
    }

    /// What the mean gives out in a tick.
    const fn give_out(&mut self, second: u32) -> PathRate {
        let step = match self.ahead.checked_div(second / MEAN) {
            Some(step) => step,
            None => self.ahead,
        };
        self.ahead = self.ahead.saturating_sub(step);
        PathRate::from_raw(step)
    }

    /// A share is rounded: what the path would have taken and does not get, it gets later. What it cannot take is dropped.
    fn keep(&mut self, turned: PathRate, share: Rate, whole: PathRate) {
        if share < Rate::FULL {
            let rest = turned.raw().saturating_sub(share.of(whole).raw());
            self.ahead = self.ahead.saturating_add(rest);
        }
    }
}

impl Ticker {
    /// Feed and rapid rate of this tick.
    #[cold]
    #[inline(never)]
    pub(super) fn rates_by_wheel(&mut self, ends: &Ends<'_>) -> [Rate; 2] {
        let [feed, rapid] = [self.operator.feed(), self.operator.rapid()];
        let turned = self.handwheel.give_out(self.given.second);
        let Some(task) = self.course.current(ends) else {
            return [feed, rapid];
        };
        let Some(timed) = task.timed().filter(|_| !runs_alone(task.segment)) else {
            return [feed, rapid];
        };
        let stretch = self.course.stretch(ends);
        let (nominal, scaling) = self.executor.asks_for(timed, stretch);
        let whole = programmed(nominal, scaling, &self.observer);
        let share = Rate::share(turned, whole);
        self.handwheel.keep(turned, share, whole);
        match scaling {
            Scaling::Turns(_) | Scaling::Feed => [feed.min(share), rapid],
            Scaling::Rapid => [feed, rapid.min(share).min(RAPID)],
        }
    }

    /// True where the next segment runs by itself and the operator has not let it: the program stops before it, until it is
    /// resumed.
    #[cold]
    #[inline(never)]
    pub(super) fn asks_for_start(&mut self, ends: &mut Ends<'_>) -> bool {
        let Some(next) = self.course.next(ends) else {
            return false;
        };
        if !runs_alone(next) {
            self.handwheel.alone &= !matches!(next.action, Action::Timed(_));
            return false;
        }
        if core::mem::replace(&mut self.handwheel.alone, true) || next.stops.hold_not_before {
            return false;
        }
        let warning = Alarm::new(Code::RunsByItself, next.span);
        emit(&mut ends.events, Event::Warning(warning));
        self.transition_to_running();
        self.course.begin_program(false);
        self.course.pause();
        true
    }
}

/// The spindle drives it, or it belongs to what the spindle drives.
fn runs_alone(segment: &Segment) -> bool {
    let stops = segment.stops;
    let in_cycle = stops.frozen.is_some() || stops.tap_cycle || stops.hold_not_before;
    in_cycle || matches!(segment.action, Action::Planned)
}
