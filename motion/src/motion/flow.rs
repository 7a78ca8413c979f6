//! Joined cuts in the tick: how fast the next piece of the way is put into the profile.
//!
//! The way of joined cuts is cut into [stretches](Stretch), each with the largest rate that the corners and bends near to
//! it allow. The profile is ahead of the tool by the length of its means. So a rate that holds at the tool has to hold in
//! the profile's input some way before and after it; the look-ahead of the background, which plans the stretches, includes
//! that. Here the input follows the stretch in force at once, and the profile makes it smooth.
//!
//! This module knows rates and lengths. It knows nothing of paths, corners or axes.

use super::plan::Scaling;
use super::rate::{PathRate, Rate};
use super::segment::Epoch;

/// Cuts that can be on the way from the profile's input to the tool. The queue of the tick holds some more.
pub const CUTS_AHEAD: u64 = 28;
/// The most stretches that one cut has.
pub const STRETCHES_OF_A_CUT: usize = 7;

/// A piece of the way of joined cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Length, in 1/256 nm.
    pub length: u64,
    /// The largest rate, whatever the overrides are.
    pub top: PathRate,
    /// Rate at [`Rate::FULL`].
    pub nominal: PathRate,
    /// What the tick multiplies the rate by.
    pub scaling: Scaling,
    /// It begins after a stop.
    pub anew: bool,
    /// The block ends here. The next one may follow without a stop; single block stops.
    pub ends_block: bool,
    /// The epoch in which it was planned.
    pub epoch: Epoch,
}

impl Stretch {
    /// No way at all, within a block.
    const NONE: Self = Self {
        length: 0,
        top: PathRate::ZERO,
        nominal: PathRate::ZERO,
        scaling: Scaling::Feed,
        anew: false,
        ends_block: false,
        epoch: Epoch::FIRST,
    };

    /// What is put in in a tick; `rate` makes the factor of a scaling.
    fn rate(&self, rate: impl Fn(Scaling) -> Rate) -> u64 {
        rate(self.scaling)
            .of(self.nominal)
            .min(self.top)
            .raw()
            .into()
    }
}

/// The input of the profile in one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Input {
    /// The rate.
    pub(super) rate: PathRate,
    /// The next stretch was taken: it is in force from now on.
    pub(super) taken: bool,
}

/// The stretch in force.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    now: Stretch,
    /// What of it has not been put in yet, in 1/256 nm.
    left: u64,
    /// No stretch has been taken yet.
    fresh: bool,
    /// Nothing follows: there is a stop, single block stops here, or the rest was given up.
    ended: bool,
}

impl Flow {
    /// Nothing is under way.
    pub(super) const fn new() -> Self {
        Self {
            now: Stretch::NONE,
            left: 0,
            fresh: false,
            ended: true,
        }
    }

    /// A motion begins; its first stretch is the next one that comes.
    pub(super) const fn begin(&mut self) {
        self.now = Stretch::NONE;
        self.left = 0;
        (self.fresh, self.ended) = (true, false);
    }

    /// Gives up the rest.
    pub(super) const fn abandon(&mut self) {
        self.left = 0;
        self.ended = true;
    }

    /// The stretch of which something is put in next: the one in force, or the `next` one where nothing of it is left.
    pub(super) fn asks_for<'a>(&'a self, next: Option<&'a Stretch>) -> &'a Stretch {
        match next {
            Some(next) if self.left == 0 && !self.ended => next,
            _ => &self.now,
        }
    }

    /// True where nothing is left to put in, and nothing follows or is known to follow: the motion may end when the tool
    /// has come to rest.
    pub(super) const fn may_end(&self) -> bool {
        self.left == 0 && (self.ended || self.now.ends_block)
    }

    /// The input of this tick. `next` is the next stretch, if it is known. `rate` makes the factor of a scaling; `single`:
    /// single block is on.
    pub(super) fn input(
        &mut self,
        next: Option<&Stretch>,
        single: bool,
        rate: impl Fn(Scaling) -> Rate,
    ) -> Input {
        let mut taken = self.left == 0 && self.take(next, single);
        let wanted = self.now.rate(&rate);
        let mut input = wanted.min(self.left);
        self.left = self.left.wrapping_sub(input);
        // The rest of the tick is of the next stretch, at the slower of the two rates.
        if input < wanted && !taken && self.take(next, single) {
            taken = true;
            let more = self.now.rate(&rate).min(wanted);
            let more = more.saturating_sub(input).min(self.left);
            self.left = self.left.wrapping_sub(more);
            input = input.wrapping_add(more);
        }
        Input {
            // Not above a rate.
            rate: PathRate::from_raw(input as u32),
            taken,
        }
    }

    /// Goes on to the next stretch. False where there is none, or none may begin.
    fn take(&mut self, next: Option<&Stretch>, single: bool) -> bool {
        self.ended |= self.now.ends_block && single;
        self.ended |= !self.fresh && next.is_some_and(|next| next.anew);
        let Some(next) = next.filter(|_| !self.ended) else {
            return false;
        };
        self.now = *next;
        self.fresh = false;
        self.left = next.length;
        true
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn stretch(length: u64, top: u32, ends_block: bool) -> Stretch {
        Stretch {
            length,
            top: PathRate::from_raw(top),
            nominal: PathRate::from_raw(100),
            scaling: Scaling::Feed,
            anew: false,
            ends_block,
            epoch: Epoch::default(),
        }
    }

    /// The inputs until the flow may end, at most 30.
    fn inputs(stretches: &[Stretch], single: bool, rate: Rate) -> (Vec<u32>, usize) {
        let (mut flow, mut taken, mut inputs) = (Flow::new(), 0, Vec::new());
        flow.begin();
        for _ in 0..30 {
            let input = flow.input(stretches.get(taken), single, |_| rate);
            taken += usize::from(input.taken);
            inputs.push(input.rate.raw());
            if flow.may_end() && (flow.ended || taken == stretches.len()) {
                break;
            }
        }
        (inputs, taken)
    }

    #[test]
    fn each_stretch_has_its_rate_and_all_of_the_length_is_put_in() {
        let stretches = [
            stretch(250, 1_000, false),
            stretch(60, 40, true),
            stretch(200, 80, true),
            Stretch {
                anew: true,
                ..stretch(500, 80, true)
            },
        ];
        // Where two stretches meet in a tick the slower of their rates counts: 50 at 100 and nothing at 40.
        let (way, taken) = inputs(&stretches, false, Rate::FULL);
        assert_eq!(way, [100, 100, 50, 40, 40, 80, 80, 20]);
        assert_eq!((way.iter().sum::<u32>(), taken), (510, 3));
        let (slow, _) = inputs(&stretches, false, Rate::percent(50));
        assert_eq!(slow[..7], [50, 50, 50, 50, 50, 40, 40]);
        assert_eq!(inputs(&stretches, false, Rate::HOLD).0, [0; 30]);
    }

    #[test]
    fn single_block_stops_at_the_end_of_a_block() {
        let stretches = [
            stretch(120, 1_000, false),
            stretch(60, 40, true),
            stretch(200, 80, true),
        ];
        let (way, taken) = inputs(&stretches, true, Rate::FULL);
        assert_eq!((way.iter().sum::<u32>(), taken), (180, 2));
    }

    #[test]
    fn it_waits_within_a_block_and_may_end_at_the_end_of_one() {
        let mut flow = Flow::new();
        flow.begin();
        let none = flow.input(None, false, |_| Rate::FULL);
        assert_eq!((none.rate.raw(), flow.may_end()), (0, false));
        let first = stretch(50, 1_000, false);
        assert_eq!(
            flow.input(Some(&first), false, |_| Rate::FULL).rate.raw(),
            50
        );
        assert!(!flow.may_end());
        let second = stretch(50, 1_000, true);
        assert_eq!(
            flow.input(Some(&second), false, |_| Rate::FULL).rate.raw(),
            50
        );
        assert!(flow.may_end());
        // It goes on where more has come in time.
        let third = stretch(50, 1_000, true);
        assert!(flow.input(Some(&third), false, |_| Rate::FULL).taken);
        flow.abandon();
        assert!(flow.may_end() && !flow.input(Some(&third), false, |_| Rate::FULL).taken);
    }
}
