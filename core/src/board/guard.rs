//! While a tap is in a hole, nothing moves but the way out (cycles.md section 9) [D88].
//!
//! Set when the machine has come to rest with a tap in its hole: after power-up, a reset, an emergency stop or an alarm.
//! All that was queued before has been forgotten then; so it is enough to look at calls as they are taken up.

use crate::alarm::{Alarm, Arg, Code};
use crate::cycle::{MoveKind, Moves};
use crate::journal::{TapHole, TapRecord};
use crate::program::{Call, CallKind};

/// The hole that is guarded, if one is.
#[derive(Clone, Copy, Debug)]
pub struct Guard(Option<TapHole>);

impl Guard {
    /// No tap is in a hole.
    #[must_use]
    pub const fn open() -> Self {
        Self(None)
    }

    /// By the newest entry of the tap journal.
    #[must_use]
    pub fn of(tap: Option<&TapRecord>) -> Self {
        Self(tap.filter(|tap| tap.in_hole).map(|tap| tap.hole))
    }

    /// Lets a call in; a return opens the way for what comes behind it.
    ///
    /// # Errors
    /// [`Code::TapInHole`] for a call that moves an axis or commands a spindle.
    #[inline(never)]
    pub fn admit(&mut self, call: &Call, moves: &Moves) -> Result<(), Alarm> {
        let Some(hole) = &self.0 else {
            return Ok(());
        };
        if let CallKind::TapReturn(_) = call.kind {
            self.0 = None;
            return Ok(());
        }
        let harmless = |kind: &MoveKind| matches!(kind, MoveKind::Dwell(_) | MoveKind::Aux(_));
        if moves.clone().all(|next| harmless(&next.kind)) {
            return Ok(());
        }
        let args = [
            Arg::Letter(hole.letter()),
            hole.figure(hole.bottom),
            Arg::None,
            Arg::None,
        ];
        Err(Alarm::new(Code::TapInHole, call.span).with(args))
    }
}
