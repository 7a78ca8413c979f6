//! One motion after another in the tick: the profile, the path under way and the path joined to it.
//!
//! Knows planned motions; knows nothing of moves, limits or what the rate is made of.

use super::plan::Timed;
use super::profile::Profile;
use super::rate::{PathRate, Rate, Travel};
use crate::program::Position;
use crate::units::Length;

/// What one tick of a [`Run`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// The setpoint.
    pub position: Position,
    /// True in the tick in which the setpoint leaves the first motion for the one joined to it.
    pub joined: bool,
    /// True where the axes stand and nothing is left to do.
    pub done: bool,
}

/// Time-driven motion in the tick. Long-lived: holds the profile and what it drives.
#[derive(Clone, Debug, Default)]
pub struct Run {
    profile: Profile,
    current: Option<Timed>,
    next: Option<Timed>,
    /// Travel at which the current path starts.
    origin: Travel,
    position: Position,
}

impl Run {
    /// At rest, nothing planned.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            profile: Profile::new(),
            current: None,
            next: None,
            origin: Travel::ZERO,
            position: Position {
                x: Length::ZERO,
                z: Length::ZERO,
                c: crate::units::Angle::ZERO,
            },
        }
    }

    /// Starts a motion from rest. False, and nothing changes, while the last one is not done.
    #[must_use]
    pub fn begin(&mut self, motion: &Timed) -> bool {
        if !self
            .profile
            .begin(motion.length, motion.nominal, motion.ramp)
        {
            return false;
        }
        self.position = motion.path.at(Travel::ZERO);
        self.current = Some(*motion);
        self.next = None;
        self.origin = Travel::ZERO;
        true
    }

    /// Joins a motion to the one under way, which must have asked for it by its exit rate: it runs on without a stop,
    /// with the same ramp, and the speed of the second holds from here on. Joining is for motions that go on in the same
    /// direction; who plans them answers for that. False, and nothing changes, where it cannot be done: nothing is under
    /// way, one is joined already, the first asks for a stop, or the ramps differ.
    #[must_use]
    pub fn join(&mut self, motion: &Timed) -> bool {
        let Some(current) = &self.current else {
            return false;
        };
        if current.exit == PathRate::ZERO || current.ramp != motion.ramp || self.next.is_some() {
            return false;
        }
        if !self.profile.extend(motion.length, motion.nominal) {
            return false;
        }
        self.next = Some(*motion);
        true
    }

    /// One tick at `rate`.
    pub fn tick(&mut self, rate: Rate) -> Step {
        let Some(mut current) = self.current else {
            return Step {
                position: self.position,
                joined: false,
                done: true,
            };
        };
        let progress = self.profile.tick(rate);
        let mut travel = progress.travel.beyond(self.origin);
        let end = Travel::of(current.length);
        let mut joined = false;
        if travel > end
            && let Some(next) = self.next.take()
        {
            travel = travel.beyond(end);
            self.origin = Travel::from_raw(self.origin.raw().saturating_add(end.raw()));
            self.current = Some(next);
            current = next;
            joined = true;
        }
        self.position = current.path.at(travel);
        if progress.done {
            self.current = None;
            self.next = None;
        }
        Step {
            position: self.position,
            joined,
            done: progress.done,
        }
    }

    /// Gives up what is left, the joined motion too: the axes stop as on a feed hold, and then the run is done.
    pub fn abandon(&mut self) {
        self.profile.abandon();
        if self.profile.at_rest() {
            self.current = None;
            self.next = None;
        }
    }

    /// True while nothing moves, on a feed hold too.
    #[must_use]
    pub const fn at_rest(&self) -> bool {
        self.profile.at_rest()
    }

    /// The last setpoint.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }

    /// The profile, for what it can tell.
    #[must_use]
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }
}
