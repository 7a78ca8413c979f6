//! Any call to its moves.

use super::{GrooveMoves, Move, MoveKind, TapMoves, ThreadMoves, tap_return};
use crate::alarm::Alarm;
use crate::journal::TapRecord;
use crate::program::{Aux, Call, CallKind, Position, SpindleCall, SpindleChoice, SpindleMode};
use crate::signals::Signals;

/// What the moves of a call depend on besides its words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Context<'a> {
    /// Where the tool stands.
    pub at: Position,
    /// The inputs when the call is taken up.
    pub signals: Signals,
    /// The newest entry of the tap journal, if there is one.
    pub tap: Option<&'a TapRecord>,
}

impl Context<'_> {
    /// A tool that stands at `at`, all inputs as at power-up, nothing in the tap journal.
    #[must_use]
    pub fn standing(at: Position) -> Self {
        Self {
            at,
            signals: Signals::default(),
            tap: None,
        }
    }
}

/// The moves of one call. Constant memory, whatever the call; nothing can fail once it is made.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one lives at a time and there is no heap to put the large one on"
)]
pub enum Moves {
    /// At most one move.
    One(Option<Move>),
    /// G76, G78.
    Thread(ThreadMoves),
    /// G75.
    Groove(GrooveMoves),
    /// G84, G88.
    Tap(TapMoves),
}

/// The moves of `call` in a context. A straight move of no length is none. Dwells, spindle commands and
/// machine functions carry the standing position; the end of the program is a machine function too.
///
/// # Errors
/// What the geometry of a cycle or the signals forbid, before any of its moves.
pub fn expand(call: &Call, context: &Context<'_>) -> Result<Moves, Alarm> {
    let mut moves = Moves::One(None);
    moves.begin(call, context)?;
    Ok(moves)
}

/// The move of a call that is no cycle.
#[inline(never)]
fn single(call: &Call, context: &Context<'_>) -> Result<Option<Move>, Alarm> {
    let at = context.at;
    let (to, kind) = match call.kind {
        CallKind::Rapid(to) | CallKind::Line(to, _) if to == at => return Ok(None),
        CallKind::Over | CallKind::Thread(_) | CallKind::Groove(_) | CallKind::Tap(_) => {
            return Ok(None);
        }
        CallKind::TapReturn(ref out) => return tap_return(out, call.span, context),
        CallKind::Rapid(to) => (to, MoveKind::Rapid),
        CallKind::Line(to, feed) => (to, MoveKind::Feed(feed)),
        CallKind::Arc(arc) => {
            let kind = MoveKind::Arc {
                i: arc.i,
                k: arc.k,
                clockwise: arc.clockwise,
                feed: arc.feed,
            };
            (arc.end, kind)
        }
        CallKind::Dwell(time) => (at, MoveKind::Dwell(time)),
        CallKind::Spindle(spindle) => {
            let mode = match spindle.mode {
                SpindleMode::Speed => SpindleMode::Speed,
                SpindleMode::Rigid(choice) => {
                    let taps = context.signals.spindle(choice, call.span)?;
                    SpindleMode::Rigid(SpindleChoice::Written(taps))
                }
            };
            (at, MoveKind::Spindle(SpindleCall { mode, ..spindle }))
        }
        CallKind::Aux(aux) => (at, MoveKind::Aux(aux)),
        CallKind::End(code) => (at, MoveKind::Aux(Aux::M(code))),
    };
    Ok(Some(Move {
        span: call.span,
        to,
        kind,
        tag: None,
    }))
}

impl Moves {
    /// Makes these the moves of `call`, as [`expand`] does: in place, for they are large.
    ///
    /// # Errors
    /// As [`expand`]; these are as they were.
    pub fn begin(&mut self, call: &Call, context: &Context<'_>) -> Result<(), Alarm> {
        *self = match &call.kind {
            CallKind::Thread(thread) => {
                ThreadMoves::survey(thread, call.span)?;
                Self::Thread(ThreadMoves::of(thread, call.span))
            }
            CallKind::Groove(groove) => Self::Groove(GrooveMoves::new(groove, call.span)?),
            CallKind::Tap(tap) => Self::Tap(TapMoves::new(tap, context.signals, call.span)?),
            _ => Self::One(single(call, context)?),
        };
        Ok(())
    }

    /// Warnings that come before the moves; some calls have one.
    #[must_use]
    pub const fn warning(&self) -> Option<Alarm> {
        match self {
            Self::Groove(groove) => groove.warning(),
            Self::One(_) | Self::Thread(_) | Self::Tap(_) => None,
        }
    }
}

impl Iterator for Moves {
    type Item = Move;

    #[inline]
    fn next(&mut self) -> Option<Move> {
        match self {
            Self::One(one) => one.take(),
            Self::Thread(thread) => thread.next(),
            Self::Groove(groove) => groove.next(),
            Self::Tap(tap) => tap.next(),
        }
    }
}

impl core::iter::FusedIterator for Moves {}
