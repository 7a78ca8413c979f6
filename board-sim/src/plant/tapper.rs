//! A spindle that only taps, or stands in for another one: a drive in position mode, and what turns with it. It has no
//! encoder on the board; its drive tells where it is, zero at power-up.

use super::drive::{Drive, DriveOptions};
use super::follower::Follower;
use super::spindle::FineTurns;
use leadscrew_core::bus::{Frame, Increments, NodeId};

/// One of the spindles from 2 on, or what stands in for the first.
#[derive(Clone, Copy, Debug)]
pub struct Tapper {
    drive: Drive,
    position: Follower,
    per_turn: u32,
    /// It has moved on the way to the last SYNC.
    turning: bool,
}

impl Tapper {
    /// A spindle that stands at 0; its drive counts `per_turn` increments to a turn and executes a target like `position`
    /// does. `still` is a follower that nothing moves.
    pub(super) fn new(
        node: NodeId,
        options: DriveOptions,
        position: Follower,
        still: Follower,
        per_turn: u32,
    ) -> Self {
        Self {
            drive: Drive::new(node, options, still),
            position,
            per_turn,
            turning: false,
        }
    }

    /// The time up to the next SYNC: in position mode it goes where the target latched there says.
    pub fn advance(&mut self) {
        let before = self.position.fine();
        match self.drive.coming_target() {
            Some(target) if self.drive.is_positioning() => {
                // The drive counts in 32 bits, the spindle turns on: the nearest of all angles the target can mean.
                let newest = self.position.newest();
                let way = target.get().wrapping_sub(newest as i32);
                self.position
                    .follow_count(newest.wrapping_add(i64::from(way)));
            }
            _ => self.position.stop(),
        }
        self.turning = self.position.fine() != before;
    }

    /// A SYNC.
    pub fn sync(&mut self, send: impl FnMut(Frame)) {
        self.drive.turns(self.turning);
        self.drive.sync(Some(self.actual()), send);
    }

    /// Where its drive says it is.
    #[must_use]
    pub const fn actual(&self) -> Increments {
        self.position.actual()
    }

    /// Its true angle.
    #[must_use]
    pub const fn angle(&self) -> FineTurns {
        FineTurns::of_fine_increments(self.position.fine(), self.per_turn)
    }

    /// Its drive, to make trouble.
    pub const fn drive(&mut self) -> &mut Drive {
        &mut self.drive
    }
}
