//! Turns any call into its moves.

use super::Context;
use super::groove::{GrooveMoves, refuse_groove};
use super::tap::{TapMoves, refuse_tap, way_out};
use super::thread::ThreadMoves;
use crate::alarm::Alarm;
use crate::call::{Aux, Call, CallKind, SpindleChoice, SpindleMode};
use crate::moves::{Move, MoveKind};

/// The moves of one call. Their memory is constant for every call. Nothing can fail after they are made.
#[derive(Clone, Copy, Debug)]
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

/// The moves of `call` in a context. A straight move of zero length is left out. Dwells, spindle commands and machine
/// functions carry the position at which the tool stands; the end of the program is a machine function too.
///
/// # Errors
/// The cycle is forbidden by its geometry or by the signals. The error comes before any move.
pub fn expand(call: &Call, context: &Context<'_>) -> Result<Moves, Alarm> {
    let mut moves = Moves::One(None);
    moves.begin(call, context)?;
    Ok(moves)
}

/// Changes `next` into the move of a call that is no cycle; `next` must stand at the tool's position. False where the
/// call has no move.
#[inline(never)]
fn single(next: &mut Move, call: &Call, context: &Context<'_>) -> Result<bool, Alarm> {
    let at = next.to;
    next.kind = match &call.kind {
        CallKind::Rapid(to) | CallKind::Line(to, _) if *to == at => return Ok(false),
        CallKind::Over
        | CallKind::LineOver
        | CallKind::ExactStop(_)
        | CallKind::Thread(_)
        | CallKind::Groove(_)
        | CallKind::Tap(_) => return Ok(false),
        CallKind::TapReturn(out) => return way_out(next, out, context),
        CallKind::Rapid(to) => {
            next.to = *to;
            MoveKind::Rapid
        }
        CallKind::Line(to, feed) => {
            next.to = *to;
            MoveKind::Feed(*feed)
        }
        CallKind::Arc(arc) => {
            next.to = arc.end;
            MoveKind::Arc {
                i: arc.i,
                k: arc.k,
                clockwise: arc.clockwise,
                feed: arc.feed,
            }
        }
        CallKind::Dwell(time) => MoveKind::Dwell(*time),
        CallKind::Spindle(spindle) => {
            let mut spindle = *spindle;
            if let SpindleMode::Rigid(choice) = &mut spindle.mode {
                let taps = context.signals.spindle(*choice, call.span)?;
                *choice = SpindleChoice::Written(taps);
            }
            MoveKind::Spindle(spindle)
        }
        CallKind::Aux(aux) => MoveKind::Aux(*aux),
        CallKind::End(code) => MoveKind::Aux(Aux::M(*code)),
    };
    Ok(true)
}

impl Moves {
    /// Makes these the moves of `call`, as [`expand`] does, but in place: the moves are a large value.
    ///
    /// # Errors
    /// As [`expand`]; then these moves are unchanged.
    pub fn begin(&mut self, call: &Call, context: &Context<'_>) -> Result<(), Alarm> {
        let span = call.span;
        match &call.kind {
            CallKind::Thread(thread) => {
                *self = match ThreadMoves::new(thread, span) {
                    Ok(moves) => Self::Thread(moves),
                    Err(alarm) => return Err(alarm),
                };
            }
            CallKind::Groove(groove) => {
                refuse_groove(groove, span)?;
                *self = Self::Groove(GrooveMoves::of(groove, span));
            }
            CallKind::Tap(tap) => {
                let spindle = refuse_tap(tap, context.signals, span)?;
                let hand = context.signals.hand(tap.hand);
                *self = Self::Tap(TapMoves::of(tap, hand, spindle, span));
            }
            CallKind::Rapid(_)
            | CallKind::Line(..)
            | CallKind::Arc(_)
            | CallKind::Dwell(_)
            | CallKind::Spindle(_)
            | CallKind::Aux(_)
            | CallKind::TapReturn(_)
            | CallKind::End(_)
            | CallKind::Over
            | CallKind::LineOver
            | CallKind::ExactStop(_) => {
                let mut next = Move {
                    span,
                    to: context.at,
                    kind: MoveKind::Rapid,
                    tag: None,
                };
                let moves = single(&mut next, call, context)?;
                *self = Self::One(moves.then_some(next));
            }
        }
        Ok(())
    }

    /// Warnings that come before the moves; some calls have one.
    #[must_use]
    pub fn warning(&self) -> Option<Alarm> {
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
        let next = match self {
            Self::One(one) => return one.take(),
            Self::Thread(thread) => thread.advance(),
            Self::Groove(groove) => groove.advance(),
            Self::Tap(tap) => tap.advance(),
        };
        next.copied()
    }
}

impl core::iter::FusedIterator for Moves {}
