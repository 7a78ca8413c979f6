//! The shape of a pass: its one to three moves as ways along the long axis and steps of the short one.

use super::ramp::{Slope, along, slope};
use crate::alarm::{Alarm, Code, Span};
use crate::cycle::{Move, MoveKind, Stage, ThreadMove};
use crate::motion::ease::Fine;
use crate::program::Position;
use crate::units::Length;

/// A pass without speed. Ways are magnitudes; steps of the short axis carry their sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// The block.
    pub span: Span,
    /// Its first move's figures.
    pub thread: ThreadMove,
    pub from: Position,
    pub end: Position,
    /// The long axis runs towards minus.
    pub backward: bool,
    /// The whole way on the long axis.
    pub length: Length,
    /// Way of the run-in, and how far beside the line's extension it begins; 0 without one.
    pub run_in: Fine,
    pub run_in_rise: Fine,
    /// Way of the run-out, and how far beside the line's extension it ends; 0 without one.
    pub run_out: Fine,
    pub run_out_rise: Fine,
    /// Slope of the line.
    pub taper: Slope,
}

impl Shape {
    /// The shape of `moves`, the first of which begins at `from`.
    ///
    /// # Errors
    /// [`Code::ThreadMovesMixed`] unless they are a stroke with at most one run-in and one run-out.
    pub fn of(from: Position, moves: &[Move]) -> Result<Self, Alarm> {
        let mixed = |span| Err(Alarm::new(Code::ThreadMovesMixed, span));
        let Some(first) = moves.first() else {
            return mixed(Span::default());
        };
        let MoveKind::Thread(thread) = first.kind else {
            return mixed(first.span);
        };
        let (mut run_in, mut stroke, mut run_out) = (None, None, None);
        for each in moves {
            if !matches!(each.kind, MoveKind::Thread(_)) {
                return mixed(first.span);
            }
            let place = match each.tag.map(|tag| tag.stage) {
                Some(Stage::RunIn) => &mut run_in,
                Some(Stage::RunOut) => &mut run_out,
                _ => &mut stroke,
            };
            if place.replace(each.to).is_some() {
                return mixed(first.span);
            }
        }
        let Some(stroke) = stroke else {
            return mixed(first.span);
        };
        let end = run_out.unwrap_or(stroke);

        let split = |p: Position| {
            if thread.long_x {
                (p.x, p.z)
            } else {
                (p.z, p.x)
            }
        };
        let fine = |length: Length| length.nm().wrapping_shl(16);
        let (long_0, short_0) = split(from);
        let (long_1, short_1) = split(run_in.unwrap_or(from));
        let (long_2, short_2) = split(stroke);
        let (long_3, short_3) = split(end);
        let stroke_way = fine((long_2 - long_1).abs());
        let taper = slope(fine(short_2 - short_1), stroke_way.max(1) as u64);
        let run_in = fine((long_1 - long_0).abs());
        let run_out = fine((long_3 - long_2).abs());
        Ok(Self {
            span: first.span,
            thread,
            from,
            end,
            backward: long_3 < long_0,
            length: (long_3 - long_0).abs(),
            run_in,
            run_in_rise: fine(short_0 - short_1).wrapping_add(along(run_in, taper)),
            run_out,
            run_out_rise: fine(short_3 - short_2).wrapping_sub(along(run_out, taper)),
            taper,
        })
    }

    /// The whole way in 2⁻¹⁶ nm.
    pub const fn fine_length(&self) -> Fine {
        self.length.nm().wrapping_shl(16)
    }

    /// The alarm `code` at the pass's block.
    pub const fn alarm(&self, code: Code) -> Alarm {
        Alarm::new(code, self.span)
    }
}
