//! The shape of a pass: its one to three moves as ways along the long axis and steps of the short axis.

use super::ramp::{Slope, along, slope};
use crate::alarm::{Alarm, Code, Span};
use crate::call::Position;
use crate::motion::ease::Fine;
use crate::moves::{Move, MoveKind, Stage, ThreadMove};
use crate::units::{Axis, Lead, LeadChange, Length};

/// A pass without a speed. Ways are magnitudes; steps of the short axis carry their sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The block.
    pub span: Span,
    /// The thread figures of the first move.
    pub thread: ThreadMove,
    pub from: Position,
    pub end: Position,
    /// The long axis moves in the minus direction.
    pub backward: bool,
    /// The whole way on the long axis.
    pub length: Length,
    /// Way of the run-in, and the distance from the line's extension at which it begins; 0 without a run-in.
    pub run_in: Fine,
    pub run_in_rise: Fine,
    /// Way of the run-out, and the distance from the line's extension at which it ends; 0 without a run-out.
    pub run_out: Fine,
    pub run_out_rise: Fine,
    /// Slope of the line.
    pub taper: Slope,
    /// The lead at the end, and the largest of the stroke: those of the moves, unless the lead changes.
    pub last: Lead,
    pub largest: Lead,
}

impl Shape {
    /// The shape of `moves`; the first move begins at `from`. `None` unless the moves are a stroke with at most one
    /// run-in and one run-out.
    #[inline(never)]
    pub fn of(from: Position, moves: &[Move]) -> Option<Self> {
        let (mut thread, mut run_in, mut stroke, mut run_out) = (None, None, None, None);
        for each in moves {
            let MoveKind::Thread(figures) = &each.kind else {
                return None;
            };
            thread.get_or_insert(figures);
            let place = match each.tag.map(|tag| tag.stage) {
                Some(Stage::RunIn) => &mut run_in,
                Some(Stage::RunOut) => &mut run_out,
                _ => &mut stroke,
            };
            if place.replace(&each.to).is_some() {
                return None;
            }
        }
        let (thread, stroke) = (*thread?, stroke?);
        let begins = run_in.unwrap_or(&from);
        let end = run_out.unwrap_or(stroke);

        let long_x = thread.long_x;
        let (run_in, run_in_rise) = step(&from, begins, long_x);
        let (way, rise) = step(begins, stroke, long_x);
        let (run_out, run_out_rise) = step(stroke, end, long_x);
        let (length, _) = step(&from, end, long_x);
        let last = thread.change.after(thread.lead, length.abs())?;
        let taper = slope(fine(rise), fine(way.abs()).max(1) as u64);
        let (run_in, run_out) = (fine(run_in.abs()), fine(run_out.abs()));
        Some(Self {
            span: moves.first()?.span,
            thread,
            from,
            end: *end,
            backward: length.nm() < 0,
            length: length.abs(),
            run_in,
            run_in_rise: along(run_in, taper).wrapping_sub(fine(run_in_rise)),
            run_out,
            run_out_rise: fine(run_out_rise).wrapping_sub(along(run_out, taper)),
            taper,
            last,
            largest: if thread.change > LeadChange::NONE {
                last
            } else {
                thread.lead
            },
        })
    }

    /// The whole way in 2⁻¹⁶ nm.
    pub const fn fine_length(&self) -> Fine {
        self.length.nm().wrapping_shl(16)
    }

    /// Long and short axis.
    pub const fn axes(&self) -> (Axis, Axis) {
        if self.thread.long_x {
            (Axis::X, Axis::Z)
        } else {
            (Axis::Z, Axis::X)
        }
    }

    /// The alarm `code` at the pass's block.
    pub const fn alarm(&self, code: Code) -> Alarm {
        Alarm::new(code, self.span)
    }
}

/// The step from one point to the next, as its part along the long axis and its part along the short axis.
#[inline(never)]
fn step(from: &Position, to: &Position, long_x: bool) -> (Length, Length) {
    let (x, z) = (to.x - from.x, to.z - from.z);
    if long_x { (x, z) } else { (z, x) }
}

/// A length in 2⁻¹⁶ nm.
pub(super) const fn fine(length: Length) -> Fine {
    length.nm().wrapping_shl(16)
}
