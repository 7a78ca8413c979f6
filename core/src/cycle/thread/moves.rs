//! G76 and G78: turns one call into its moves, lazily and in constant memory ([G76 sheet], [G78 sheet]).
//!
//! This module knows the order of the passes and of the moves in a pass. `shape` gives their corners, `depth` their
//! depths.

use super::depth::{Depths, MOST_PASSES};
use super::helix::{Helix, TURN_UDEG};
use super::refuse::refuse_thread;
use super::shape::{Corners, MachinePoint, Pass, Point, Shape};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{ThreadCall, ThreadCycle, start_angle};
use crate::moves::{Cycle, Move, MoveKind, Stage, Tag, ThreadMove};
use crate::units::{Length, StartAngle};

/// The moves of a G76 or G78 cycle.
///
/// For each depth, for each start: rapid to the pass's start, synchronous run-in (E), stroke and run-out, rapid X to
/// X_A, rapid Z to Z_A. Moves of zero length are left out. The last move ends at A, that of G32 at D or behind its run-out.
/// Nothing can fail after the value is made.
#[derive(Clone, Copy, Debug)]
pub struct ThreadMoves {
    helix: Helix,
    /// L.
    starts: u8,
    /// Start under way, from 1.
    start: u8,
    shape: Shape,
    passes: Passes,
    step: Step,
    /// The step after the approach, and the step after the stroke.
    after_approach: Step,
    after_stroke: Step,
    /// A, and the corners of the pass under way.
    home: MachinePoint,
    pass: Places,
    /// Rough or finish.
    stroke: Stage,
    /// Helix angle from the pass's start to its stroke and to its run-out, in millionths of a degree.
    to_line: u32,
    to_leave: u32,
    /// Angle of the first start.
    first_angle: StartAngle,
    /// Start angle in millionths of a degree.
    angle: u32,
    /// The last rapid and the last synchronous move. They already hold most of the next move. Changing three fields before
    /// a plain copy takes half the instructions of building a new move.
    rapid: Move,
    thread: Move,
}

/// The corners of a pass in the order of its moves.
#[derive(Clone, Copy, Debug, Default)]
struct Places {
    begin: MachinePoint,
    line: MachinePoint,
    leave: MachinePoint,
    end: MachinePoint,
}

/// The next step of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Approach,
    RunIn,
    Stroke,
    RunOut,
    Retract,
    Return,
}

/// Depths of all passes: rough ones, then finishing ones at full depth [D2].
#[derive(Clone, Copy, Debug)]
struct Passes {
    rough: Depths,
    height: Length,
    finish_left: u8,
    number: u32,
}

/// The counts and extremes of a thread cycle, for reports and for checks of physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadSummary {
    /// Rough passes, each counted once however many starts there are.
    pub rough: u32,
    /// All passes: rough and finishing.
    pub passes: u32,
    /// Largest shift of a pass's start along Z, `|Z_n − Z_A|`.
    pub z_shift_max: Length,
    /// The shortest distance on the long axis from a pass's start to D (X: on the radius).
    pub shortest_stroke: Length,
    /// The first pass with this shortest distance, from 0.
    pub shortest: u32,
    /// True where X is the long axis.
    pub long_x: bool,
}

impl ThreadMoves {
    /// The moves of `call`, whose G word stands at `span`.
    ///
    /// # Errors
    /// Everything that geometry forbids, before the first move: see the codes 0315, 0316 and 4100–4110. Alarms about one
    /// pass name its number.
    pub fn new(call: &ThreadCall, span: Span) -> Result<Self, Alarm> {
        refuse_thread(call, span)?;
        let moves = Self::of(call, span);
        // Where the largest shift that a pass could have leaves enough of the thread, no pass has to be looked at.
        if moves.shape.is_surely_long_enough() && Depths::are_surely_few(call) {
            return Ok(moves);
        }
        moves.examine(span)?;
        Ok(moves)
    }

    /// The counts and extremes of `call`; refuses the same calls as [`ThreadMoves::new`].
    pub(crate) fn survey(call: &ThreadCall, span: Span) -> Result<ThreadSummary, Alarm> {
        refuse_thread(call, span)?;
        Self::of(call, span).examine(span)
    }

    /// Refuses impossible passes, and too many passes.
    fn examine(&self, span: Span) -> Result<ThreadSummary, Alarm> {
        let mut room = Ok(());
        let summary = self.walk(|pass, corners| {
            if room.is_ok() && !self.shape.stays {
                room = self.shape.check_pass(pass.number, corners, span);
            }
        });
        if summary.rough > MOST_PASSES {
            let most = [Arg::Int(i64::from(MOST_PASSES))];
            return Err(Alarm::new(Code::TooManyPasses, span).with(most));
        }
        room.map(|()| summary)
    }

    /// The moves of a call that [`refuse_thread`] has accepted. [`ThreadMoves::examine`] tells whether its passes are
    /// possible.
    #[inline]
    pub(crate) fn of(call: &ThreadCall, span: Span) -> Self {
        let shape = Shape::of(call);
        let tag = Tag {
            cycle: match call.cycle {
                ThreadCycle::G76 => Cycle::G76,
                ThreadCycle::G78 => Cycle::G78,
                ThreadCycle::G92 => Cycle::G92,
                ThreadCycle::G32 => Cycle::G32,
                ThreadCycle::G34 => Cycle::G34,
            },
            pass: 0,
            start: 1,
            peck: 0,
            stage: Stage::Approach,
            depth: Length::ZERO,
        };
        let rapid = Move {
            span,
            to: call.start,
            kind: MoveKind::Rapid,
            tag: Some(tag),
        };
        let synchronous = ThreadMove {
            lead: call.lead.value,
            change: call.change.value,
            pass_angle: call.first_angle,
            angle_udeg: micros(call.first_angle),
            long_x: shape.long_x,
            part: call.part,
            last: false,
            rpm: call.rpm,
        };
        Self {
            helix: Helix::new(call.lead.value),
            starts: call.starts.value,
            // Past the last start of no depth.
            start: call.starts.value,
            shape,
            passes: Passes {
                rough: Depths::new(call),
                height: call.height.value,
                finish_left: call.finish_passes.value.max(1),
                number: 0,
            },
            step: Step::Approach,
            after_approach: if shape.has_run_in() {
                Step::RunIn
            } else {
                Step::Stroke
            },
            after_stroke: if shape.has_run_out() {
                Step::RunOut
            } else {
                after_synchronous(&shape)
            },
            home: shape.place(&shape.home()),
            pass: Places::default(),
            stroke: Stage::Rough,
            to_line: 0,
            to_leave: 0,
            first_angle: call.first_angle,
            angle: micros(call.first_angle),
            rapid,
            thread: Move {
                kind: MoveKind::Thread(synchronous),
                ..rapid
            },
        }
    }

    /// True from the last pass of the last start on.
    #[must_use]
    pub const fn is_at_last_pass(&self) -> bool {
        self.start == self.starts && self.passes.finish_left == 0
    }

    /// Leaves out the first `passes` depths. Call this before the first move.
    pub(crate) fn leave_out(&mut self, passes: u32) {
        for _ in 0..passes {
            self.passes.next();
        }
    }

    /// The next move by reference: [`Iterator::next`] without the copy.
    #[inline]
    pub fn advance(&mut self) -> Option<&Move> {
        loop {
            match self.step {
                Step::Approach => {
                    if !self.begin_pass() {
                        return None;
                    }
                    self.step = self.after_approach;
                    if self.pass.begin != self.home {
                        return self.rapid(self.pass.begin, Stage::Approach);
                    }
                }
                Step::RunIn => {
                    self.step = Step::Stroke;
                    return self.thread(self.pass.line, Stage::RunIn, 0, false);
                }
                Step::Stroke => {
                    let leave = self.pass.leave;
                    let last = self.after_stroke != Step::RunOut;
                    self.step = self.after_stroke;
                    return self.thread(leave, self.stroke, self.to_line, last);
                }
                Step::RunOut => {
                    self.step = after_synchronous(&self.shape);
                    return self.thread(self.pass.end, Stage::RunOut, self.to_leave, true);
                }
                Step::Retract => {
                    self.step = Step::Return;
                    let end = self.pass.end;
                    if end.x != self.home.x {
                        let out = MachinePoint {
                            x: self.home.x,
                            z: end.z,
                        };
                        return self.rapid(out, Stage::Retract);
                    }
                }
                Step::Return => {
                    self.step = Step::Approach;
                    if self.pass.end.z != self.home.z {
                        return self.rapid(self.home, Stage::Return);
                    }
                }
            }
        }
    }

    /// Counts and extremes over the passes that have not begun yet. Call this before the first move to cover all passes.
    /// The time grows with the number of passes.
    #[must_use]
    pub fn summary(&self) -> ThreadSummary {
        self.walk(|_, _| {})
    }

    /// Where the synchronous motion of the last pass begins, its first start. A call without a pass has none; its start.
    pub(super) fn last_begin(&self) -> MachinePoint {
        let mut begin = self.shape.place(&self.shape.line().begin);
        self.walk(|_, corners| begin = self.shape.place(&corners.begin));
        begin
    }

    /// Shows every pass with its corners. Stops at the first rough pass above the limit.
    fn walk(&self, mut show: impl FnMut(&Pass, &Corners)) -> ThreadSummary {
        let mut summary = ThreadSummary {
            rough: 0,
            passes: 0,
            z_shift_max: Length::ZERO,
            shortest_stroke: Length::from_nm(i64::MAX),
            shortest: 0,
            long_x: self.shape.long_x,
        };
        for pass in self.passes {
            let corners = self.shape.corners(&pass);
            show(&pass, &corners);
            let shift = Length::from_nm(corners.begin.along);
            summary.z_shift_max = summary.z_shift_max.max(shift);
            let stroke = self.shape.stroke(&corners);
            if stroke < summary.shortest_stroke {
                summary.shortest_stroke = stroke;
                summary.shortest = summary.passes;
            }
            summary.passes = summary.passes.wrapping_add(1);
            if pass.stroke == Stage::Rough {
                summary.rough = summary.rough.wrapping_add(1);
                if summary.rough > MOST_PASSES {
                    break;
                }
            }
        }
        summary
    }

    /// Goes to the next start of the depth, or to the next depth. False after the last.
    #[inline]
    fn begin_pass(&mut self) -> bool {
        if self.start < self.starts {
            self.turn_to(self.start.wrapping_add(1));
            return true;
        }
        let Some(pass) = self.passes.next() else {
            return false;
        };
        let corners = self.shape.corners(&pass);
        if self.shape.has_run_out() {
            self.to_leave = self.helix.angle(self.along(corners.leave, corners.begin));
        }
        if self.shape.has_run_in() {
            self.pass.line = self.shape.place(&corners.line);
            self.to_line = self.helix.angle(self.along(corners.line, corners.begin));
        }
        self.pass.begin = self.shape.place(&corners.begin);
        self.pass.leave = self.shape.place(&corners.leave);
        self.pass.end = self.shape.place(&corners.end);
        self.stroke = pass.stroke;
        if let (Some(rapid), Some(thread)) = (&mut self.rapid.tag, &mut self.thread.tag) {
            rapid.pass = pass.number;
            rapid.depth = pass.depth;
            thread.pass = pass.number;
            thread.depth = pass.depth;
        }
        if self.start != 1 {
            self.turn_to(1);
        }
        true
    }

    /// Begins start number `start` of a depth.
    #[cold]
    fn turn_to(&mut self, start: u8) {
        self.start = start;
        let further = start_angle(start.wrapping_sub(1), self.starts);
        let angle = StartAngle::from_mdeg(self.first_angle.mdeg().wrapping_add(further.mdeg()));
        self.angle = micros(angle);
        if let MoveKind::Thread(thread) = &mut self.thread.kind {
            thread.pass_angle = angle;
        }
        for tag in [&mut self.rapid.tag, &mut self.thread.tag]
            .into_iter()
            .flatten()
        {
            tag.start = start;
        }
    }

    /// Distance on the long axis from `begin` on.
    #[inline]
    fn along(&self, to: Point, begin: Point) -> u64 {
        if self.shape.long_x {
            to.out.abs_diff(begin.out)
        } else {
            to.along.abs_diff(begin.along)
        }
    }

    #[inline]
    fn rapid(&mut self, to: MachinePoint, stage: Stage) -> Option<&Move> {
        let next = &mut self.rapid;
        (next.to.x, next.to.z) = (to.x, to.z);
        if let Some(tag) = &mut next.tag {
            tag.stage = stage;
        }
        Some(next)
    }

    #[inline]
    fn thread(&mut self, to: MachinePoint, stage: Stage, turned: u32, last: bool) -> Option<&Move> {
        // Both are at most a turn, and the start angle is less.
        let angle = self.angle.wrapping_add(turned);
        let next = &mut self.thread;
        (next.to.x, next.to.z) = (to.x, to.z);
        if let MoveKind::Thread(thread) = &mut next.kind {
            thread.angle_udeg = if angle >= TURN_UDEG {
                angle.wrapping_sub(TURN_UDEG)
            } else {
                angle
            };
            thread.last = last && !thread.part.goes_on();
        }
        if let Some(tag) = &mut next.tag {
            tag.stage = stage;
        }
        Some(next)
    }
}

/// The step after the last synchronous move of a pass. A stroke has no further pass.
const fn after_synchronous(shape: &Shape) -> Step {
    if shape.stays {
        Step::Approach
    } else {
        Step::Retract
    }
}

/// In millionths of a degree.
const fn micros(angle: StartAngle) -> u32 {
    angle.mdeg().wrapping_mul(1000)
}

impl Iterator for ThreadMoves {
    type Item = Move;

    #[inline]
    fn next(&mut self) -> Option<Move> {
        self.advance().copied()
    }
}

impl core::iter::FusedIterator for ThreadMoves {}

impl Iterator for Passes {
    type Item = Pass;

    #[inline]
    fn next(&mut self) -> Option<Pass> {
        let number = self.number.wrapping_add(1);
        let (depth, stroke) = match self.rough.next_depth(number) {
            Some(depth) => (depth, Stage::Rough),
            None => {
                self.finish_left = self.finish_left.checked_sub(1)?;
                (self.height, Stage::Finish)
            }
        };
        self.number = number;
        Some(Pass {
            number,
            depth,
            stroke,
        })
    }
}

#[cfg(test)]
#[allow(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used
)]
mod tests {
    use super::*;
    use crate::alarm::At;
    use crate::call::{ChainPart, CutIn, Infeed, Position, RunOut};
    use crate::units::{Angle, Lead, LeadChange, Remainder, Rpm};

    /// A thread with little room for what it asks for.
    fn narrow(mut draw: impl FnMut(i64, i64) -> i64) -> ThreadCall {
        fn at<T>(value: T) -> At<T> {
            At::new(value, Span::default())
        }
        let nm = Length::from_nm;
        let mut chance = |one_in: i64| draw(0, one_in - 1) == 0;
        let (left_out, no_taper, long_x) = (chance(3), chance(2), chance(2));
        let (external, towards_plus, equal) = (chance(2), chance(2), chance(3));
        let size = [10_000, 1_000_000, 50_000_000][draw(0, 2) as usize];
        let travel = draw(1, size);
        let height = draw(2, size);
        let allowance = draw(0, height / 2);
        let lean = match (no_taper, long_x) {
            (true, _) => 0,
            (_, true) => draw(-size, size),
            (_, false) => draw(-travel, travel),
        };
        let room = height + lean.abs() + draw(0, height);
        let side = if external { 1 } else { -1 };
        let sigma = if towards_plus { 1 } else { -1 };
        let start = Position {
            x: nm(draw(-size, size)),
            z: nm(draw(-size, size)),
            c: Angle::ZERO,
        };
        let run_in = if draw(0, 1) == 0 {
            draw(0, size / 4)
        } else {
            0
        };
        ThreadCall {
            cycle: ThreadCycle::G78,
            start,
            end_x: at(start.x - nm(room * side)),
            end_z: at(start.z + nm(travel * sigma)),
            taper: at(nm(lean)),
            height: at(nm(height)),
            first_depth: at(nm(draw(1, height))),
            min_step: at(nm(draw(0, height / 20))),
            allowance: at(nm(allowance)),
            finish_passes: at(draw(1, 3) as u8),
            angle: at([0, 29, 30, 55, 60, 80][draw(0, 5) as usize]),
            infeed: if equal {
                Infeed::Equal
            } else {
                Infeed::Decreasing
            },
            cut_in: at([
                CutIn::Centre,
                CutIn::Left,
                CutIn::Right,
                CutIn::RightCentre,
                CutIn::LeftRight,
                CutIn::Trailing,
            ][draw(0, 5) as usize]),
            starts: at(1),
            change: At::new(LeadChange::NONE, Span::default()),
            first_angle: StartAngle::INDEX,
            part: ChainPart::Whole,
            run_in: at(nm(run_in)),
            run_out: (!left_out).then(|| RunOut {
                short: at(nm(draw(1, size / 4))),
                long: at(nm(draw(1, size / 4))),
                short_rest: Remainder::ZERO,
                long_rest: Remainder::ZERO,
            }),
            lead: at(Lead::new(1_000_000, 1).unwrap()),
            increment: nm(1),
            rpm: Rpm::new(300),
        }
    }

    /// Every call that the short cut accepts is also accepted by a look at every pass. Both outcomes happen often.
    #[test]
    fn no_thread_is_let_pass_that_a_look_at_every_pass_refuses() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            let mut state = seed;
            let mut draw = |low: i64, high: i64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                low + (state % (high - low + 1) as u64) as i64
            };
            let (mut sure, mut doubtful, mut refused) = (0, 0, 0);
            for _ in 0..60_000 {
                let call = narrow(&mut draw);
                let span = Span::default();
                if refuse_thread(&call, span).is_err() {
                    continue;
                }
                let moves = ThreadMoves::of(&call, span);
                let looked_at = moves.examine(span);
                if moves.shape.is_surely_long_enough() && Depths::are_surely_few(&call) {
                    assert!(looked_at.is_ok(), "{call:?}: {looked_at:?}");
                    sure += 1;
                } else if looked_at.is_ok() {
                    doubtful += 1;
                } else {
                    refused += 1;
                }
            }
            assert!(
                sure > 5_000 && doubtful > 500 && refused > 500,
                "{sure} {doubtful} {refused}"
            );
        });
    }
}
