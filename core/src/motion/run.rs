//! Time-driven motions in the tick: the profile, the motion under way and the motion joined to it.
//!
//! This module knows planned motions; it knows nothing of moves or limits, nor of how the rate is made.

use super::plan::Timed;
use super::profile::{Profile, Progress, Ramp};
use super::rate::{PathRate, Rate, Travel};
use crate::call::Position;
use crate::units::Length;

/// The result of one tick of a [`Run`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// The setpoint.
    pub position: Position,
    /// True in the tick in which the setpoint leaves the first motion and enters the joined motion.
    pub joined: bool,
    /// True when the axes stand and nothing is left to do.
    pub done: bool,
}

/// Time-driven motion in the tick. This long-lived object holds the profile and the changing state of the motion under
/// way. The motion itself stays where it is: the caller passes the same motion in every tick until it is done.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// `moving`: a motion is under way. `joined`: another motion is joined to it.
    moving: bool,
    joined: bool,
    /// Travel at which the current path starts.
    origin: Travel,
    position: Position,
    profile: Profile,
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
            joined: false,
            origin: Travel::ZERO,
            position: Position {
                x: Length::ZERO,
                z: Length::ZERO,
                c: crate::units::Angle::ZERO,
            },
        }
    }

    /// Resets in place to the state of [`new`](Self::new): a motion under way is forgotten.
    pub const fn begin_anew(&mut self) {
        self.profile.begin_anew();
        (self.moving, self.joined) = (false, false);
        self.origin = Travel::ZERO;
    }

    /// Starts a motion from rest. Returns false and changes nothing while the last motion is not done.
    #[must_use]
    pub fn begin(&mut self, motion: &Timed) -> bool {
        if !self.begin_length(motion.length, motion.nominal, motion.ramp) {
            return false;
        }
        self.position = motion.path.start();
        true
    }

    /// Joins `next` to the motion under way, which must have asked for this by its exit rate. The axes run on without a
    /// stop, with the same ramp, and the speed of `next` holds from here on. Both motions must go in the same
    /// direction; the planner is responsible for this. Returns false and changes nothing if joining is impossible:
    /// nothing is under way, a motion is already joined, the first motion asks for a stop, or the ramps differ.
    #[must_use]
    pub const fn join(&mut self, current: &Timed, next: &Timed) -> bool {
        if !self.moving || self.joined {
            return false;
        }
        if current.exit.raw() == 0 || !current.ramp.is(&next.ramp) {
            return false;
        }
        self.joined = self.profile.extend(next.length, next.nominal);
        self.joined
    }

    /// One tick at `rate`. `next` is the joined motion. After a step with `joined`, the caller must pass this motion as
    /// `current`.
    pub fn tick(&mut self, rate: Rate, current: &Timed, next: Option<&Timed>) -> Step {
        if !self.moving {
            return Step {
                position: self.position,
                joined: false,
                done: true,
            };
        }
        let progress = self.progress(rate);
        let travel = progress.travel.beyond(self.origin);
        let end = Travel::of(current.length);
        let joined = match next {
            Some(next) if self.joined && travel > end => {
                self.origin = self.origin.and(end);
                self.joined = false;
                self.position = next.path.at(travel.beyond(end));
                true
            }
            _ => {
                self.position = current.path.at(travel);
                false
            }
        };
        Step {
            position: self.position,
            joined,
            done: progress.done,
        }
    }

    /// Starts a motion for which the run keeps only the profile. Returns false and changes nothing while the last
    /// motion is not done.
    pub(super) fn begin_length(&mut self, length: Length, nominal: PathRate, ramp: Ramp) -> bool {
        if !self.profile.begin(length, nominal, ramp) {
            return false;
        }
        (self.moving, self.joined) = (true, false);
        self.origin = Travel::ZERO;
        true
    }

    /// One tick at `rate` of a motion begun by [`begin_length`](Self::begin_length).
    pub(super) fn progress(&mut self, rate: Rate) -> Progress {
        let progress = self.profile.tick(rate);
        self.moving &= !progress.done;
        progress
    }

    /// Gives up the rest, the joined motion too. The axes stop as on a feed hold, and then the run is done.
    pub const fn abandon(&mut self) {
        self.profile.abandon();
        if self.profile.at_rest() {
            self.moving = false;
        }
    }

    /// True while nothing moves, also in a feed hold.
    #[must_use]
    pub const fn at_rest(&self) -> bool {
        self.profile.at_rest()
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

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;
    use super::*;
    use crate::motion::{Line, Path, Ramp, Scaling};
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
            scaling: Scaling::Rapid,
        }
    }

    /// A run together with its motions. On a board a queue holds the motions.
    struct Driven {
        run: Run,
        current: Timed,
        next: Option<Timed>,
    }

    impl Driven {
        fn new(motion: Timed) -> Self {
            let mut run = Run::new();
            assert!(run.begin(&motion));
            Self {
                run,
                current: motion,
                next: None,
            }
        }

        fn join(&mut self, next: Timed) -> bool {
            let joined = self.run.join(&self.current, &next);
            if joined {
                self.next = Some(next);
            }
            joined
        }

        fn tick(&mut self, rate: Rate) -> Step {
            let step = self.run.tick(rate, &self.current, self.next.as_ref());
            if step.joined {
                self.current = self.next.take().unwrap();
            }
            step
        }

        /// Setpoints to the end, and the tick in which the joined motion was entered.
        fn finish(mut self) -> (Vec<i64>, Option<usize>) {
            let (mut setpoints, mut joined) = (Vec::new(), None);
            loop {
                let step = self.tick(Rate::FULL);
                if step.joined {
                    joined = Some(setpoints.len());
                }
                setpoints.push(step.position.z.nm());
                if step.done {
                    return (setpoints, joined);
                }
            }
        }
    }

    #[test]
    fn two_joined_lines_run_like_one() {
        for seam in [1, 777, 5_000, 9_999] {
            let one = Driven::new(line(0, 10_000, 51_200, 0));
            let mut two = Driven::new(line(0, seam, 51_200, 51_200));
            assert!(two.join(line(seam, 10_000, 51_200, 0)));
            let (whole, _) = one.finish();
            let (pieces, joined) = two.finish();
            assert_eq!(whole, pieces, "{seam}");
            assert_eq!(joined, whole.iter().position(|&at| at > seam), "{seam}");
        }
    }

    #[test]
    fn joining_late_still_ends_exactly() {
        // The whole first motion has already entered the profile; the axis slows down and goes on.
        let mut driven = Driven::new(line(0, 5_000, 51_200, 51_200));
        let mut last = 0;
        for _ in 0..28 {
            last = driven.tick(Rate::FULL).position.z.nm();
        }
        assert!(driven.run.profile().remaining() == Length::ZERO && last < 5_000);
        assert!(driven.join(line(5_000, 9_000, 25_600, 0)));
        let (setpoints, _) = driven.finish();
        assert_eq!(setpoints.last(), Some(&9_000));
        assert!(setpoints.is_sorted());
    }

    #[test]
    fn three_lines_one_after_another() {
        let mut driven = Driven::new(line(0, 4_000, 51_200, 51_200));
        assert!(driven.join(line(4_000, 8_000, 51_200, 51_200)));
        // Only one motion can wait.
        let third = line(8_000, 12_000, 51_200, 0);
        assert!(!driven.join(third));
        while !driven.tick(Rate::FULL).joined {}
        assert!(driven.join(third));
        let (setpoints, joined) = driven.finish();
        assert!(joined.is_some());
        assert_eq!(setpoints.last(), Some(&12_000));
    }

    #[test]
    fn exact_stops_and_other_ramps_do_not_join() {
        let (first, next) = (line(0, 100, 256, 0), line(100, 200, 256, 0));
        let mut run = Run::new();
        assert!(!run.join(&first, &next));
        assert!(run.begin(&first));
        assert!(!run.join(&first, &next));
        assert!(!run.begin(&next));
        let first = line(0, 100, 256, 256);
        let mut run = Run::new();
        assert!(run.begin(&first));
        let mut other = next;
        other.ramp = Ramp::new(PathRate::from_raw(51_200), 7, 5).unwrap();
        assert!(!run.join(&first, &other));
    }

    #[test]
    fn held_and_abandoned_it_stands_where_it_is() {
        let mut driven = Driven::new(line(0, 10_000, 51_200, 51_200));
        assert!(driven.join(line(10_000, 20_000, 51_200, 0)));
        for _ in 0..30 {
            driven.tick(Rate::FULL);
        }
        for _ in 0..11 {
            assert!(!driven.tick(Rate::HOLD).done);
        }
        assert!(driven.run.at_rest());
        assert_eq!(driven.run.position(), z(30 * 200));
        driven.run.abandon();
        let step = driven.tick(Rate::FULL);
        assert_eq!((step.position, step.done), (z(6_000), true));
        // The next motion starts here and does not depend on the last one.
        let last = line(6_000, 6_100, 256, 0);
        assert!(driven.run.begin(&last));
        (driven.current, driven.next) = (last, None);
        let (setpoints, joined) = driven.finish();
        assert_eq!((setpoints.len(), joined), (100 + 11, None));
        assert_eq!(setpoints.last(), Some(&6_100));
    }
}
