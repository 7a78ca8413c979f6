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
        // A planned motion is some 200 bytes: it is read in place.
        let Some(current) = &self.current else {
            return Step {
                position: self.position,
                joined: false,
                done: true,
            };
        };
        let progress = self.profile.tick(rate);
        let travel = progress.travel.beyond(self.origin);
        let end = Travel::of(current.length);
        let joined = travel > end && self.next.is_some();
        if joined {
            self.position = self.enter_next(end, travel.beyond(end));
        } else {
            self.position = current.path.at(travel);
        }
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

    /// Makes the joined motion the current one, which starts where the one of length `end` stops; its position at
    /// `travel`.
    fn enter_next(&mut self, end: Travel, travel: Travel) -> Position {
        self.origin = Travel::from_raw(self.origin.raw().saturating_add(end.raw()));
        self.current = self.next.take();
        self.current
            .as_ref()
            .map_or(self.position, |motion| motion.path.at(travel))
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

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;
    use super::*;
    use crate::motion::{Line, Path, Ramp};
    use crate::units::Angle;
    use std::vec::Vec;

    fn z(nm: i64) -> Position {
        Position {
            x: Length::from_nm(3),
            z: Length::from_nm(nm),
            c: Angle::ZERO,
        }
    }

    fn line(from: i64, to: i64, nominal: u32, exit: u32) -> Timed {
        let path = Path::Line(Line::new(z(from), z(to)));
        Timed {
            path,
            length: path.length(),
            nominal: PathRate::from_raw(nominal),
            ramp: Ramp::new(PathRate::from_raw(51_200), 7, 4).unwrap(),
            exit: PathRate::from_raw(exit),
            feed: None,
        }
    }

    /// Setpoints to the end, and the tick in which the joined motion was entered.
    fn finish(run: &mut Run) -> (Vec<i64>, Option<usize>) {
        let (mut setpoints, mut joined) = (Vec::new(), None);
        loop {
            let step = run.tick(Rate::FULL);
            if step.joined {
                joined = Some(setpoints.len());
            }
            setpoints.push(step.position.z.nm());
            if step.done {
                return (setpoints, joined);
            }
        }
    }

    #[test]
    fn two_joined_lines_run_like_one() {
        for seam in [1, 777, 5_000, 9_999] {
            let mut one = Run::new();
            assert!(one.begin(&line(0, 10_000, 51_200, 0)));
            let mut two = Run::new();
            assert!(two.begin(&line(0, seam, 51_200, 51_200)));
            assert!(two.join(&line(seam, 10_000, 51_200, 0)));
            let (whole, _) = finish(&mut one);
            let (pieces, joined) = finish(&mut two);
            assert_eq!(whole, pieces, "{seam}");
            assert_eq!(joined, whole.iter().position(|&at| at > seam), "{seam}");
        }
    }

    #[test]
    fn joining_late_still_ends_exactly() {
        // All of the first is put in already; the axis slows down and goes on.
        let mut run = Run::new();
        assert!(run.begin(&line(0, 5_000, 51_200, 51_200)));
        let mut last = 0;
        for _ in 0..28 {
            last = run.tick(Rate::FULL).position.z.nm();
        }
        assert!(run.profile().remaining() == Length::ZERO && last < 5_000);
        assert!(run.join(&line(5_000, 9_000, 25_600, 0)));
        let (setpoints, _) = finish(&mut run);
        assert_eq!(setpoints.last(), Some(&9_000));
        assert!(setpoints.is_sorted());
    }

    #[test]
    fn three_lines_one_after_another() {
        let mut run = Run::new();
        assert!(run.begin(&line(0, 4_000, 51_200, 51_200)));
        assert!(run.join(&line(4_000, 8_000, 51_200, 51_200)));
        // Only one can wait.
        let third = line(8_000, 12_000, 51_200, 0);
        assert!(!run.join(&third));
        while !run.tick(Rate::FULL).joined {}
        assert!(run.join(&third));
        let (setpoints, joined) = finish(&mut run);
        assert!(joined.is_some());
        assert_eq!(setpoints.last(), Some(&12_000));
    }

    #[test]
    fn exact_stops_and_other_ramps_do_not_join() {
        let mut run = Run::new();
        let next = line(100, 200, 256, 0);
        assert!(!run.join(&next));
        assert!(run.begin(&line(0, 100, 256, 0)));
        assert!(!run.join(&next));
        assert!(!run.begin(&next));
        let mut run = Run::new();
        assert!(run.begin(&line(0, 100, 256, 256)));
        let mut other = next;
        other.ramp = Ramp::new(PathRate::from_raw(51_200), 7, 5).unwrap();
        assert!(!run.join(&other));
    }

    #[test]
    fn held_and_abandoned_it_stands_where_it_is() {
        let mut run = Run::new();
        assert!(run.begin(&line(0, 10_000, 51_200, 51_200)));
        assert!(run.join(&line(10_000, 20_000, 51_200, 0)));
        for _ in 0..30 {
            run.tick(Rate::FULL);
        }
        for _ in 0..11 {
            assert!(!run.tick(Rate::HOLD).done);
        }
        assert!(run.at_rest());
        assert_eq!(run.position(), z(30 * 200));
        run.abandon();
        let step = run.tick(Rate::FULL);
        assert_eq!((step.position, step.done), (z(6_000), true));
        // The next motion starts here and knows nothing of the last.
        assert!(run.begin(&line(6_000, 6_100, 256, 0)));
        let (setpoints, joined) = finish(&mut run);
        assert_eq!((setpoints.len(), joined), (100 + 11, None));
        assert_eq!(setpoints.last(), Some(&6_100));
    }
}
