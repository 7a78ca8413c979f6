//! While a tap is in a hole, nothing moves but the way out [D88], or deeper where K198 has left it
//! there in phase [D25].
//!
//! Set when the machine has come to rest with a tap in its hole: after power-up, a reset, an emergency stop or an alarm.
//! All that was queued before has been forgotten then; so it is enough to look at calls as they are taken up. Behind K198 a
//! reader of programs refuses the same by word and line; a board need not have been fed by one.

use crate::alarm::{Alarm, Arg, Code};
use crate::cycle::{MoveKind, Moves};
use crate::journal::{TapHole, TapRecord};
use crate::program::{Call, CallKind};

/// The hole that is guarded, if one is.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    hole: Option<TapHole>,
    /// The program has left the tap there, and goes on.
    in_phase: bool,
}

impl Guard {
    /// No tap is in a hole.
    #[must_use]
    pub const fn open() -> Self {
        Self {
            hole: None,
            in_phase: false,
        }
    }

    /// By the newest entry of the tap journal.
    #[must_use]
    pub fn of(tap: Option<&TapRecord>) -> Self {
        Self {
            hole: tap.filter(|tap| tap.in_hole).map(|tap| tap.hole),
            in_phase: false,
        }
    }

    /// Behind a call with K198.
    #[must_use]
    pub const fn in_phase(hole: TapHole) -> Self {
        Self {
            hole: Some(hole),
            in_phase: true,
        }
    }

    /// Lets a call in; a return opens the way for what comes behind it, and so does a tap in phase that goes on.
    ///
    /// # Errors
    /// [`Code::TapInHole`] for a call that moves an axis or commands a spindle, and for the end of a program that has left
    /// the tap there.
    #[inline(never)]
    pub fn admit(&mut self, call: &Call, moves: &Moves) -> Result<(), Alarm> {
        let Some(hole) = &self.hole else {
            return Ok(());
        };
        let (opens, ends) = match &call.kind {
            CallKind::TapReturn(_) => (true, false),
            CallKind::Tap(tap) => (
                self.in_phase && tap.continues && tap.axis == hole.axis,
                false,
            ),
            CallKind::End(_) | CallKind::Over => (false, self.in_phase),
            _ => (false, false),
        };
        if opens {
            self.hole = None;
            return Ok(());
        }
        let harmless = |kind: &MoveKind| matches!(kind, MoveKind::Dwell(_) | MoveKind::Aux(_));
        if !ends && moves.clone().all(|next| harmless(&next.kind)) {
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
