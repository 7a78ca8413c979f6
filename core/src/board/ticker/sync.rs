//! A beat that somebody else gives: when the drives may be brought up by it, and what it means where it ends [D166].
//!
//! Without SYNC no drive latches anything: each axis stands where the last one has left it, while the path of the board
//! goes on, and a spindle turns on at its last speed, whatever it is told. So behind three periods without one the
//! drives are stopped by network management, which takes no SYNC, and brought up anew by the reset; none of them moves
//! when the beat is back. A board that has only come off the beat has drives that still follow: they are braked.

use super::state::Mode;
use super::{Ends, Ticker};
use crate::alarm::{Alarm, Arg, Code};
use crate::bus::{SyncHeard, SyncProducer, SyncVerdict};

impl Ticker {
    /// What the period that ends with the next tick has brought of the SYNC that somebody else gives. To be said before
    /// each tick of a board that follows the bus (9029); where it is not said, nothing was heard.
    pub const fn follow(&mut self, heard: SyncHeard) {
        self.beat.hear(heard);
    }

    /// The beat comes from the bus, and its owner has to say what was [heard](Self::follow) of it.
    #[must_use]
    pub const fn follows_bus(&self) -> bool {
        self.beat.is_for_bus()
    }

    /// The beat that the board gives; `None` where it follows the bus. For an owner who goes on giving it while the
    /// ticker is made anew: others may be at work by it.
    pub const fn beat_given(&mut self) -> Option<&mut SyncProducer> {
        self.drives.sync()
    }

    /// Periods, since power-up, in which setpoints were late for the SYNC that the board follows; 65535 is followed by 0.
    #[must_use]
    pub const fn sync_late(&self) -> u16 {
        self.beat.late()
    }

    /// Judges a period of a beat that is not the board's own.
    #[inline(never)]
    pub(super) fn keep_beat(&mut self, ends: &mut Ends<'_, '_>) {
        let verdict = self.beat.tick(self.mode == Mode::Starting);
        if self.beat.has_ended() {
            self.drives.stop();
        }
        let code = match verdict {
            SyncVerdict::Good => return,
            SyncVerdict::Lost => Code::SyncLost,
            SyncVerdict::Unsteady => Code::SyncUnsteady,
        };
        let figures = self.beat.figures().map(|figure| Arg::Int(figure.into()));
        self.raise(&Alarm::of(code, &figures), ends);
    }
}
