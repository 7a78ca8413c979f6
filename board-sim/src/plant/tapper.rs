//! A spindle that only taps, or stands in for another spindle: a drive in position mode, and the spindle that it turns.
//! The board has no encoder for it; the drive reports the position, zero at power-up.

use super::drive::{Drive, DriveOptions};
use super::follower::Follower;
use super::spindle::FineTurns;
use leadscrew_core::bus::{Frame, Increments, NodeId};

/// One of the spindles from 2 on, or a stand-in for the first.
#[derive(Clone, Copy, Debug)]
pub struct Tapper {
    drive: Drive,
    position: Follower,
    per_turn: u32,
    /// The spindle has moved in the time up to the last SYNC.
    turning: bool,
}

impl Tapper {
    /// A spindle that stands at 0. Its drive counts `per_turn` increments in a turn and follows targets like
    /// `position`. `still` is a follower that never moves.
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

    /// Lets the time up to the next SYNC pass. In position mode the spindle reaches the target that this SYNC latches.
    pub fn advance(&mut self) {
        let before = self.position.fine();
        match self.drive.coming_target() {
            Some(target) if self.drive.is_positioning() => {
                // The drive counts in 32 bits, but the spindle turns on. So this takes the nearest of all angles with
                // this target.
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

    /// The position that the drive reports.
    #[must_use]
    pub const fn actual(&self) -> Increments {
        self.position.actual()
    }

    /// The true angle.
    #[must_use]
    pub const fn angle(&self) -> FineTurns {
        FineTurns::of_fine_increments(self.position.fine(), self.per_turn)
    }

    /// The drive, to give it faults.
    pub const fn drive(&mut self) -> &mut Drive {
        &mut self.drive
    }
}
