//! The guard of a tap in its hole: only the way out may move [D88], or the same hole deeper where K198 has left the tap
//! there in phase [D25].
//!
//! The guard is set when the machine has come to rest with a tap in its hole: after power-up, a reset, an emergency stop or
//! an alarm. The queue is empty then, so it is enough to check calls when they are opened. After K198 a reader of programs
//! refuses the same calls by word and line; but a board need not get its calls from such a reader.

use crate::alarm::{Alarm, Arg, Code};
use crate::call::{Call, CallKind};
use crate::cycle::Moves;
use crate::journal::{TapHole, TapRecord};
use crate::moves::MoveKind;

/// The guarded hole, if there is one.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    hole: Option<TapHole>,
    /// The program has left the tap there and goes on.
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

    /// A guard from the newest entry of the tap journal.
    #[must_use]
    pub fn of(tap: Option<&TapRecord>) -> Self {
        Self {
            hole: tap.filter(|tap| tap.in_hole).map(|tap| tap.hole),
            in_phase: false,
        }
    }

    /// A guard after a call with K198.
    #[must_use]
    pub const fn in_phase(hole: TapHole) -> Self {
        Self {
            hole: Some(hole),
            in_phase: true,
        }
    }

    /// Admits a call. A return opens the way for the calls after it; so does a tap in phase that continues.
    ///
    /// # Errors
    /// [`Code::TapInHole`] for a call that moves an axis or commands a spindle, and for the end of a program that has left
    /// the tap in its hole.
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
            CallKind::End(_) | CallKind::Over | CallKind::LineOver => (false, self.in_phase),
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
        Err(Alarm::new(Code::TapInHole, call.span).with(figures(hole)))
    }

    /// Why nothing may be moved by hand; `None` where no tap is in a hole.
    #[must_use]
    pub fn refusal(&self) -> Option<Alarm> {
        let hole = self.hole.as_ref()?;
        Some(Alarm::of(Code::TapInHole, &figures(hole)))
    }
}

/// Axis and bottom of the hole.
fn figures(hole: &TapHole) -> [Arg; 4] {
    [
        Arg::Letter(hole.letter()),
        hole.figure(hole.bottom),
        Arg::None,
        Arg::None,
    ]
}
