//! Time-driven motions in the tick: the profile and the motion under way.
//!
//! A motion ends in an exact stop, or it flows: it gets its way as [stretches](Stretch), its corners are rounded, and the
//! next motion joins it without a stop.
//!
//! This module knows planned motions; it knows nothing of moves or limits, nor of how the rate is made.

use super::flow::{Flow, Stretch};
use super::plan::{Scaling, Timed};
use super::profile::{Profile, Progress, Ramp};
use super::rate::{PathRate, Rate, Travel};
use super::rounding::Rounding;
use crate::call::Position;
use crate::units::Length;

/// The result of one tick of a [`Run`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// The setpoint.
    pub position: Position,
    /// True when the axes stand and nothing is left to do.
    pub done: bool,
}

/// The result of one tick of joined motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Flowed {
    /// The next stretch was taken.
    pub(super) taken: bool,
    /// The tool has passed the end of the motion: [`Run::cross`] has to follow in this tick, with the next motion.
    pub(super) crossed: bool,
    /// The axes stand and nothing is left to do.
    pub(super) done: bool,
}

/// Time-driven motion in the tick. This long-lived object holds the profile and the changing state of the motion under
/// way. The motion itself stays where it is: the caller passes the same motion in every tick until it is done.
#[derive(Clone, Debug)]
pub struct Run {
    /// A motion is under way.
    moving: bool,
    /// Of joined motions: distance of the tool, and where the motion under way begins.
    travel: Travel,
    origin: Travel,
    position: Position,
    flow: Flow,
    rounding: Rounding,
    profile: Profile,
}

impl Default for Run {
    fn default() -> Self {
        Self::new()
    }
}

impl Run {
    /// At rest, nothing planned.
    #[must_use]
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            profile: Profile::new(),
            moving: false,
            travel: Travel::ZERO,
            origin: Travel::ZERO,
            position: Position::ZERO,
            flow: Flow::new(),
            rounding: Rounding::new(),
        }
    }

    /// Resets in place to the state of [`new`](Self::new): a motion under way is forgotten.
    pub const fn begin_anew(&mut self) {
        self.profile.begin_anew();
        self.moving = false;
        self.flow.abandon();
        self.rounding.rest();
    }

    /// Starts a motion from rest. Returns false and changes nothing while the last motion is not done.
    #[must_use]
    pub fn begin(&mut self, motion: &Timed) -> bool {
        let start = motion.path.start();
        let begun = match motion.rounding {
            Some(mean) if self.profile.begin_open(motion.ramp) => {
                self.flow.begin();
                self.rounding.begin(start, mean);
                (self.travel, self.origin) = (Travel::ZERO, Travel::ZERO);
                self.moving = true;
                true
            }
            Some(_) => false,
            None => self.begin_length(motion.length, motion.nominal, motion.ramp),
        };
        if begun {
            self.position = start;
        }
        begun
    }

    /// One tick at `rate` of a motion that ends in an exact stop.
    pub fn tick(&mut self, rate: Rate, current: &Timed) -> Step {
        if !self.moving {
            return Step {
                position: self.position,
                done: true,
            };
        }
        let progress = self.progress(rate);
        self.position = current.path.at(progress.travel);
        Step {
            position: self.position,
            done: progress.done,
        }
    }

    /// One tick of joined motions; `current` is the one in which the tool is, `next` the next stretch of the way, if it is
    /// known. `rate` makes the factor of a scaling; `single`: single block is on.
    pub(super) fn flow(
        &mut self,
        current: &Timed,
        next: Option<&Stretch>,
        single: bool,
        rate: impl Fn(Scaling) -> Rate,
    ) -> Flowed {
        if !self.moving {
            return Flowed {
                done: true,
                ..Flowed::default()
            };
        }
        let input = self.flow.input(next, single, rate);
        self.travel = self.profile.put_in(input.rate);
        let here = self.travel.beyond(self.origin);
        let crossed = here > Travel::of(current.length);
        if !crossed {
            self.round(current, here);
        }
        let done = !crossed && self.flow.may_end() && !input.taken && self.at_rest();
        self.moving = !done;
        Flowed {
            taken: input.taken,
            crossed,
            done,
        }
    }

    /// Of joined motions: the rate and the scaling of what is put in next, which is ahead of the tool.
    pub(super) fn asks_for(&self, next: Option<&Stretch>) -> (PathRate, Scaling) {
        let stretch = self.flow.asks_for(next);
        (stretch.nominal, stretch.scaling)
    }

    /// The tool has passed the end of `last` in this tick: it is in `next` now.
    pub(super) fn cross(&mut self, last: Length, next: &Timed) {
        self.origin = self.origin.and(Travel::of(last));
        let here = self.travel.beyond(self.origin);
        self.round(next, here);
    }

    // Used twice, and large.
    #[inline(never)]
    fn round(&mut self, motion: &Timed, here: Travel) {
        self.position = self.rounding.put(motion.path.at(here));
    }

    /// Starts a motion for which the run keeps only the profile. Returns false and changes nothing while the last
    /// motion is not done.
    pub(super) fn begin_length(&mut self, length: Length, nominal: PathRate, ramp: Ramp) -> bool {
        if !self.profile.begin(length, nominal, ramp) {
            return false;
        }
        self.flow.abandon();
        self.moving = true;
        true
    }

    /// One tick at `rate` of a motion begun by [`begin_length`](Self::begin_length).
    pub(super) fn progress(&mut self, rate: Rate) -> Progress {
        let progress = self.profile.tick(rate);
        self.moving &= !progress.done;
        progress
    }

    /// Gives up the rest. The axes stop as on a feed hold, and then the run is done.
    pub const fn abandon(&mut self) {
        self.flow.abandon();
        self.profile.abandon();
        if self.at_rest() {
            self.moving = false;
        }
    }

    /// True while nothing moves, also in a feed hold.
    #[must_use]
    pub const fn at_rest(&self) -> bool {
        self.profile.at_rest() && self.rounding.has_settled()
    }

    /// The last setpoint.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }

    /// The profile, for reading its state.
    #[must_use]
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }
}
