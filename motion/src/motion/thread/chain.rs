//! A chain: strokes of G32 that are one thread.
//!
//! The spindle's angle leads the axes through all of the strokes. Where two of them meet, the velocity of an axis for each
//! turn changes; an ease rounds this corner, for both axes alike, and is over before the next corner begins. So at any time
//! only one stroke and the corner at its start matter, and the tick has one plan at a time: the next stroke takes over
//! before its corner begins, where both plans are the same straight line.
//!
//! This module keeps the strokes and makes their plans, one after the other. It must not know when they are asked for.

use heapless::Vec;

use super::pace::Pace;
use super::plan::ThreadPlan;
use super::ramp::{DIAGONAL, Machine, Slope, along, seen, slope};
use super::shape::{Shape, fine};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{ChainPart, Position};
use crate::motion::ease::{Bounds, Ease};
use crate::motion::lead::turns_of;
use crate::motion::limits::bounds;
use crate::motion::wide::{mul_div_up, root_mul_div_up};
use crate::moves::{Move, MoveKind, Stage, ThreadMove};
use crate::params::Params;
use crate::units::{
    Axis, Lead, Length, Rpm, TurnRate, Turns, mul_div, narrow_div, product, signed,
};

/// A stroke without what the whole chain has in common.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    span: Span,
    number: u32,
    x: Length,
    z: Length,
    lead: Lead,
}

/// The strokes of one chain.
#[derive(Debug)]
pub struct Chain {
    strokes: Vec<Stroke, { ChainPart::MOST }>,
    from: Position,
    /// The figures of the first stroke.
    thread: Option<ThreadMove>,
    /// The run-out of the last stroke.
    run_out: Option<Move>,
    is_whole: bool,
    stop: Stop,
}

/// What a stop and a follower need to know of the whole chain.
#[derive(Clone, Copy, Debug, Default)]
struct Stop {
    /// The greatest speed of an axis, nm/s.
    speed: u64,
    /// The greatest speed along a helix, nm/s: a run-out may be steeper.
    helix: u64,
    /// The time of the longest corner, ns.
    corner: u64,
}

/// A corner between two strokes, as the second one sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corner {
    /// Change of the long axis' way, and of the short axis beside the line, for each way on the helix behind the corner.
    pub gain: Slope,
    pub bend: Slope,
    pub ease: Ease,
}

/// How a stroke of a chain begins and ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joints {
    /// The corner to the stroke before.
    pub before: Option<Corner>,
    /// Half of the corner to the next stroke, as an angle.
    pub after: Option<Turns>,
    /// Ticks that a stop takes.
    pub stop: u32,
    /// The greatest speed of an axis in the chain, and along a helix, nm/s.
    pub speed: u64,
    pub helix: u64,
}

impl Chain {
    /// No stroke.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            strokes: Vec::new(),
            from: Position::ZERO,
            thread: None,
            run_out: None,
            is_whole: false,
            stop: Stop {
                speed: 0,
                helix: 0,
                corner: 0,
            },
        }
    }

    /// Forgets all strokes.
    pub fn clear(&mut self) {
        self.strokes.clear();
        self.thread = None;
        self.run_out = None;
        self.is_whole = false;
        self.stop = Stop::default();
    }

    /// Number of strokes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.strokes.len()
    }

    /// True without a stroke.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.strokes.is_empty()
    }

    /// The last stroke is there.
    #[must_use]
    pub const fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// False where a stroke of this part cannot come now.
    #[must_use]
    pub fn admits(&self, part: ChainPart) -> bool {
        self.is_empty() != part.is_joined()
    }

    /// Number and block of a stroke.
    #[must_use]
    pub fn place(&self, index: usize) -> Option<(u32, Span)> {
        let stroke = self.strokes.get(index)?;
        Some((stroke.number, stroke.span))
    }

    /// Where a stroke begins.
    #[must_use]
    pub fn start(&self, index: usize) -> Position {
        let mut at = self.from;
        if let Some(before) = index
            .checked_sub(1)
            .and_then(|before| self.strokes.get(before))
        {
            (at.x, at.z) = (before.x, before.z);
        }
        at
    }

    /// The last move of the chain.
    #[must_use]
    pub fn last(&self) -> Option<Move> {
        self.run_out
            .or_else(|| self.stroke(self.len().checked_sub(1)?))
    }

    /// Takes the next move, which begins at `from` and has this `number`: a stroke, or the run-out of the last one.
    ///
    /// # Errors
    /// More strokes than a chain may have, or a move that does not belong to it.
    pub fn push(&mut self, from: Position, next: &Move, number: u32) -> Result<(), Alarm> {
        let mixed = Alarm::new(Code::ThreadMovesMixed, next.span);
        let MoveKind::Thread(thread) = &next.kind else {
            return Err(mixed);
        };
        if self.is_whole {
            return Err(mixed);
        }
        self.is_whole = thread.last;
        let is_run_out = next.tag.is_some_and(|tag| tag.stage == Stage::RunOut);
        if is_run_out {
            if self.is_empty() || self.run_out.is_some() {
                return Err(mixed);
            }
            self.run_out = Some(*next);
            return Ok(());
        }
        if !self.admits(thread.part) || thread.part == ChainPart::Whole {
            return Err(mixed);
        }
        if self.is_empty() {
            self.from = from;
            self.thread = Some(*thread);
        }
        let stroke = Stroke {
            span: next.span,
            number,
            x: next.to.x,
            z: next.to.z,
            lead: thread.lead,
        };
        let most = [Arg::Int(ChainPart::MOST as i64)];
        let too_long = Alarm::new(Code::ChainTooLong, next.span).with(most);
        self.strokes.push(stroke).map_err(|_| too_long)
    }

    /// A stroke as a move.
    fn stroke(&self, index: usize) -> Option<Move> {
        let (stroke, thread) = (self.strokes.get(index)?, self.thread?);
        let from = self.start(index);
        let (x, z) = (stroke.x - from.x, stroke.z - from.z);
        Some(Move {
            span: stroke.span,
            to: Position {
                x: stroke.x,
                z: stroke.z,
                c: from.c,
            },
            kind: MoveKind::Thread(ThreadMove {
                lead: stroke.lead,
                // The same rule as for a call; a run-out does not change it.
                long_x: x.abs() > z.abs(),
                last: false,
                ..thread
            }),
            tag: None,
        })
    }

    fn shape(&self, index: usize) -> Option<Shape> {
        let mut moves: Vec<Move, 2> = Vec::new();
        let mut stroke = self.stroke(index)?;
        if let Some(run_out) = self
            .run_out
            .filter(|_| index == self.len().saturating_sub(1))
        {
            if let (MoveKind::Thread(one), MoveKind::Thread(other)) =
                (&mut stroke.kind, &run_out.kind)
            {
                one.long_x = other.long_x;
            }
            moves.push(stroke).ok()?;
            moves.push(run_out).ok()?;
        } else {
            moves.push(stroke).ok()?;
        }
        Shape::of(self.start(index), &moves)
    }

    fn shape_or_alarm(&self, index: usize) -> Result<Shape, Alarm> {
        let span = self
            .place(index)
            .map_or_else(Span::default, |(_, span)| span);
        self.shape(index)
            .ok_or(Alarm::new(Code::ThreadMovesMixed, span))
    }

    /// Checks a stroke; all of them in order, before the first is planned.
    ///
    /// # Errors
    /// As [`ThreadPlan::new`]; and a stroke that the corners at its ends use up ([`Code::StrokeTooShortInChain`]).
    #[inline(never)]
    pub fn examine(
        &mut self,
        index: usize,
        params: &Params,
        commanded: Option<Rpm>,
        measured: TurnRate,
    ) -> Result<(), Alarm> {
        let shape = &self.shape_or_alarm(index)?;
        let commanded = commanded.unwrap_or(shape.thread.rpm);
        let pace = &Pace::new(params, commanded, measured).in_chain();
        let machine = pace.machine(shape, params, pace.margin);
        // Along its line an axis is at most as fast as the long one; within a run-out the short one may be faster.
        let steepest = machine.taper.max(run_out_slope(shape)).max(DIAGONAL);
        self.stop.speed = self.stop.speed.max(seen(machine.speed, steepest));
        self.stop.helix = self.stop.helix.max(machine.speed);
        let before = match index.checked_sub(1) {
            Some(before) => corner(&self.shape_or_alarm(before)?, shape, &machine).ease,
            None => Ease::default(),
        };
        // The run-out and both ends have corners of their own.
        for ease in [before, machine.plain(), machine.straight(steepest)] {
            let time = mul_div(ease.half_nm() as u64, 2_000_000_000, machine.speed.max(1));
            self.stop.corner = self.stop.corner.max(time);
        }
        self.plan(index, params, Some(commanded), measured)
            .map(drop)
    }

    /// Plans a stroke.
    ///
    /// # Errors
    /// As [`examine`](Self::examine).
    #[inline(never)]
    pub fn plan(
        &self,
        index: usize,
        params: &Params,
        commanded: Option<Rpm>,
        measured: TurnRate,
    ) -> Result<ThreadPlan, Alarm> {
        let shape = &self.shape_or_alarm(index)?;
        let commanded = commanded.unwrap_or(shape.thread.rpm);
        let pace = &Pace::new(params, commanded, measured).in_chain();
        let before = match index.checked_sub(1) {
            Some(before) => {
                let machine = pace.machine(shape, params, pace.margin);
                Some(corner(&self.shape_or_alarm(before)?, shape, &machine))
            }
            None => None,
        };
        let next = index.saturating_add(1);
        let after = if next < self.len() {
            let next = &self.shape_or_alarm(next)?;
            let machine = pace.machine(next, params, pace.margin);
            let corner = corner(shape, next, &machine);
            Some(turns_of(next.thread.lead, corner.ease.half()))
        } else {
            None
        };
        let joints = Joints {
            before,
            after,
            stop: self.stop.ticks(params),
            speed: self.stop.speed,
            helix: self.stop.helix,
        };
        let mut plan = ThreadPlan::default();
        plan.fill(shape, params, Some(commanded), measured, Some(&joints))?;
        Ok(plan)
    }
}

impl Stop {
    /// Ticks of a stop that slows the angle down, over corners and all.
    ///
    /// Corners have 3/5 of an axis' acceleration and its jerk. With the relative speed 1 − u²·(3 − 2·u) over a time T, the
    /// stop needs at most 3/2·v/T of the acceleration and 6·v/T² of the jerk, and for a corner of the time C another
    /// 9/4·j·C/T. Where the latencies of the drives differ by τ, that is n ticks, the way v·τ by which one axis is ahead
    /// goes with the relative speed: another 6·v·τ/T² of the acceleration, which steps by as much where the stop begins and
    /// ends. So T is at least 15/4·v/a + √(15·v·τ/a), √((40 + 12·n)·v/j) and 16/5·C: the acceleration holds, and the jerks
    /// add to less than twice the limit [D53].
    fn ticks(&self, params: &Params) -> u32 {
        const NS: u64 = 1_000_000_000;
        let least = bounds(params, Axis::X).least(&bounds(params, Axis::Z));
        let Bounds { acceleration, jerk } = least;
        let by_speed = mul_div_up(self.speed.saturating_mul(15) >> 2, NS, acceleration.max(1));
        let tick_us = u64::from(params.tick_us()).max(1);
        let apart_us = params.latency_apart_us();
        let by_lead = root_mul_div_up(
            self.speed.saturating_mul(apart_us.saturating_mul(15)),
            NS.wrapping_mul(1000),
            acceleration.max(1),
        );
        let apart = mul_div(apart_us, 12, tick_us);
        let by_jerk = root_mul_div_up(
            self.speed.saturating_mul(apart.saturating_add(40)),
            NS.wrapping_mul(NS),
            jerk.max(1),
        );
        let by_corner = self.corner.saturating_mul(16) / 5;
        let time = by_speed.saturating_add(by_lead).max(by_jerk).max(by_corner);
        mul_div_up(time, 1, tick_us.saturating_mul(1000))
            .saturating_add(1)
            .min(u64::from(u32::MAX)) as u32
    }
}

impl Default for Chain {
    fn default() -> Self {
        Self::new()
    }
}

/// The slope of a run-out beside the line, without its corner.
fn run_out_slope(shape: &Shape) -> u64 {
    if shape.run_out == 0 {
        return 0;
    }
    slope(shape.run_out_rise, shape.run_out as u64)
        .unsigned_abs()
        .saturating_mul(2)
}

/// The corner from `before` into `shape`, for axes that are as fast as `machine` says.
#[inline(never)]
fn corner(before: &Shape, shape: &Shape, machine: &Machine) -> Corner {
    let share = lead_share(before.thread.lead, shape.thread.lead);
    let of = |way: Length| along(slope(fine(way), before.fine_length().max(1) as u64), share);
    let (x, z) = (
        of(before.end.x - before.from.x),
        of(before.end.z - before.from.z),
    );
    let (mut long, short) = if shape.thread.long_x { (x, z) } else { (z, x) };
    if shape.backward {
        long = long.wrapping_neg();
    }
    let gain = (DIAGONAL as Slope).wrapping_sub(long);
    let turn = shape.taper.wrapping_sub(short);
    Corner {
        gain,
        bend: along(gain, shape.taper).wrapping_sub(turn),
        ease: machine.turn(gain.unsigned_abs(), turn.unsigned_abs()),
    }
}

/// The lead before a corner as a part of the one behind it, in 2⁻⁴⁰.
fn lead_share(before: Lead, behind: Lead) -> Slope {
    let ((nm, turns), (own_nm, own_turns)) = (before.parts(), behind.parts());
    let (above, below) = (product(nm, own_turns), product(own_nm, turns));
    // Shifted until the divisor fits; 64 bits of it remain.
    let shift = 64_u32.saturating_sub(below.leading_zeros());
    let (above, below) = (above.wrapping_shr(shift), below.wrapping_shr(shift) as u64);
    signed(narrow_div(above.wrapping_shl(40), below)).min(1 << 62)
}

#[cfg(test)]
mod tests;
