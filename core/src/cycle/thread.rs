//! G76 and G78: one call to its moves, lazily and in constant memory ([G76 sheet], [G78 sheet]; cycles.md sections 2–4).
//!
//! The order of passes and of the moves in a pass; where their corners lie is `shape`, how deep they are is `depth`.

use core::num::NonZero;

use super::depth::{Depths, MOST_PASSES};
use super::shape::{Corners, Point, Shape};
use super::{Cycle, Move, MoveKind, Stage, Tag, ThreadMove};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::program::{Position, ThreadCall, ThreadCycle, start_angle};
use crate::units::{Lead, Length, Rpm, StartAngle};

/// Millionths of a degree in a turn.
const TURN_UDEG: u32 = 360_000_000;

/// The moves of a G76 or G78 cycle.
///
/// For each depth, for each start: rapid to the pass's start, synchronous run-in (E), stroke and run-out, rapid X to
/// X_A, rapid Z to Z_A. Moves of no length are left out. The last one ends at A. Nothing can fail once it is made.
#[derive(Clone, Debug)]
pub struct ThreadMoves {
    span: Span,
    start: Position,
    lead: Lead,
    helix: Helix,
    rpm: Rpm,
    /// L.
    starts: u8,
    shape: Shape,
    passes: Passes,
    step: Step,
    /// The pass under way.
    corners: Corners,
    /// Helix angle from the pass's start to its stroke and to its run-out, in millionths of a degree.
    to_line: u32,
    to_leave: u32,
    angle: StartAngle,
    tag: Tag,
}

/// What comes next in a pass.
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

/// One pass.
#[derive(Clone, Copy, Debug)]
struct Pass {
    number: u32,
    depth: Length,
    finishing: bool,
}

/// What a thread cycle amounts to, for reports and for checks of physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadSummary {
    /// Rough passes, each counted once however many starts there are.
    pub rough: u32,
    /// All passes: rough and finishing.
    pub passes: u32,
    /// Largest shift of a pass's start along Z, `|Z_n − Z_A|`.
    pub z_shift_max: Length,
    /// Shortest way on the long axis from a pass's start to D (X: on the radius).
    pub shortest_stroke: Length,
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
        let shape = Shape::new(call, span)?;
        if call.starts.value == 0 {
            return Err(Alarm::new(Code::CycleStartsRange, span).word(b'L'));
        }
        let limit = call.height.value - call.allowance.value;
        let first = call.first_depth.value;
        let rough = Depths::new(
            call.infeed,
            limit,
            first,
            call.min_step.value,
            call.increment,
        );
        if !rough.is_surely_short(first) && rough.count().is_none() {
            return Err(Alarm::new(Code::TooManyPasses, span).with([
                Arg::Int(i64::from(MOST_PASSES)),
                Arg::None,
                Arg::None,
                Arg::None,
            ]));
        }
        let passes = Passes {
            rough,
            height: call.height.value,
            finish_left: call.finish_passes.value.max(1),
            number: 0,
        };
        if !shape.is_surely_long_enough() {
            for pass in passes {
                let u = shape.flank(pass.number, pass.depth, pass.finishing);
                shape.check_pass(pass.number, &shape.corners(pass.depth, u), span)?;
            }
        }
        let cycle = match call.cycle {
            ThreadCycle::G76 => Cycle::G76,
            ThreadCycle::G78 => Cycle::G78,
        };
        Ok(Self {
            span,
            start: call.start,
            lead: call.lead.value,
            helix: Helix::new(call.lead.value),
            rpm: call.rpm,
            starts: call.starts.value,
            shape,
            passes,
            step: Step::Approach,
            corners: Corners::default(),
            to_line: 0,
            to_leave: 0,
            angle: StartAngle::INDEX,
            tag: Tag {
                cycle,
                pass: 0,
                start: call.starts.value,
                peck: 0,
                stage: Stage::Approach,
                depth: Length::ZERO,
            },
        })
    }

    /// Counts and extremes over the passes that have not begun yet; ask before the first move for all of them. Takes a
    /// time that grows with their number.
    #[must_use]
    pub fn summary(&self) -> ThreadSummary {
        let mut summary = ThreadSummary {
            rough: 0,
            passes: 0,
            z_shift_max: Length::ZERO,
            shortest_stroke: Length::from_nm(i64::MAX),
            long_x: self.shape.long_x,
        };
        for pass in self.passes {
            let u = self.shape.flank(pass.number, pass.depth, pass.finishing);
            let corners = self.shape.corners(pass.depth, u);
            summary.passes = summary.passes.wrapping_add(1);
            summary.rough = summary.rough.wrapping_add(u32::from(!pass.finishing));
            let shift = (corners.begin.z - self.start.z).abs();
            summary.z_shift_max = summary.z_shift_max.max(shift);
            let stroke = self.shape.stroke(&corners);
            summary.shortest_stroke = summary.shortest_stroke.min(stroke);
        }
        summary
    }

    /// Goes to the next start of the depth, or to the next depth. False after the last.
    #[inline]
    fn begin_pass(&mut self) -> bool {
        if self.tag.start >= self.starts {
            let Some(pass) = self.passes.next() else {
                return false;
            };
            let u = self.shape.flank(pass.number, pass.depth, pass.finishing);
            self.corners = self.shape.corners(pass.depth, u);
            let Corners {
                begin, line, leave, ..
            } = self.corners;
            self.to_leave = self.helix.angle(self.along(leave, begin));
            if line != begin {
                self.to_line = self.helix.angle(self.along(line, begin));
            }
            self.tag.pass = pass.number;
            self.tag.depth = pass.depth;
            self.tag.start = 1;
            self.tag.stage = if pass.finishing {
                Stage::Finish
            } else {
                Stage::Rough
            };
            self.angle = StartAngle::INDEX;
        } else {
            self.angle = start_angle(self.tag.start, self.starts);
            self.tag.start = self.tag.start.wrapping_add(1);
        }
        true
    }

    /// Distance on the long axis.
    #[inline]
    fn along(&self, a: Point, b: Point) -> u64 {
        let length = if self.shape.long_x {
            a.x - b.x
        } else {
            a.z - b.z
        };
        length.nm().unsigned_abs()
    }

    #[inline]
    fn rapid(&self, to: Point, stage: Stage) -> Move {
        self.one(to, MoveKind::Rapid, stage)
    }

    #[inline]
    fn thread(&self, to: Point, stage: Stage, turned: u32, last: bool) -> Move {
        let angle = self.angle.mdeg().wrapping_mul(1000).wrapping_add(turned);
        let angle_udeg = if angle >= TURN_UDEG {
            angle.wrapping_sub(TURN_UDEG)
        } else {
            angle
        };
        let kind = MoveKind::Thread(ThreadMove {
            lead: self.lead,
            pass_angle: self.angle,
            angle_udeg,
            long_x: self.shape.long_x,
            last,
            rpm: self.rpm,
        });
        self.one(to, kind, stage)
    }

    #[inline]
    fn one(&self, to: Point, kind: MoveKind, stage: Stage) -> Move {
        Move {
            span: self.span,
            to: Position {
                x: to.x,
                z: to.z,
                c: self.start.c,
            },
            kind,
            tag: Some(Tag { stage, ..self.tag }),
        }
    }
}

impl Iterator for ThreadMoves {
    type Item = Move;

    #[inline]
    fn next(&mut self) -> Option<Move> {
        let home = Point {
            x: self.start.x,
            z: self.start.z,
        };
        loop {
            match self.step {
                Step::Approach => {
                    if !self.begin_pass() {
                        return None;
                    }
                    let Corners { begin, line, .. } = self.corners;
                    self.step = if line == begin {
                        Step::Stroke
                    } else {
                        Step::RunIn
                    };
                    if begin != home {
                        return Some(self.rapid(begin, Stage::Approach));
                    }
                }
                Step::RunIn => {
                    self.step = Step::Stroke;
                    return Some(self.thread(self.corners.line, Stage::RunIn, 0, false));
                }
                Step::Stroke => {
                    let Corners {
                        begin,
                        line,
                        leave,
                        end,
                    } = self.corners;
                    let turned = if line == begin { 0 } else { self.to_line };
                    let last = leave == end;
                    self.step = if last { Step::Retract } else { Step::RunOut };
                    return Some(self.thread(leave, self.tag.stage, turned, last));
                }
                Step::RunOut => {
                    self.step = Step::Retract;
                    let end = self.corners.end;
                    return Some(self.thread(end, Stage::RunOut, self.to_leave, true));
                }
                Step::Retract => {
                    self.step = Step::Return;
                    let end = self.corners.end;
                    if end.x != home.x {
                        let out = Point {
                            x: home.x,
                            z: end.z,
                        };
                        return Some(self.rapid(out, Stage::Retract));
                    }
                }
                Step::Return => {
                    self.step = Step::Approach;
                    if self.corners.end.z != home.z {
                        return Some(self.rapid(home, Stage::Return));
                    }
                }
            }
        }
    }
}

impl core::iter::FusedIterator for ThreadMoves {}

impl Iterator for Passes {
    type Item = Pass;

    #[inline]
    fn next(&mut self) -> Option<Pass> {
        let (depth, finishing) = match self.rough.next_depth() {
            Some(depth) => (depth, false),
            None => {
                self.finish_left = self.finish_left.checked_sub(1)?;
                (self.height, true)
            }
        };
        self.number = self.number.wrapping_add(1);
        Some(Pass {
            number: self.number,
            depth,
            finishing,
        })
    }
}

/// Distance along a lead to helix angle.
#[derive(Clone, Copy, Debug)]
struct Helix {
    /// Lead: `nm` nanometres per `turns` turns.
    nm: NonZero<u64>,
    turns: u64,
    /// True where 64 bits hold every product.
    narrow: bool,
}

impl Helix {
    fn new(lead: Lead) -> Self {
        // A Lead is positive by construction.
        let nm = NonZero::new(lead.numerator().unsigned_abs()).unwrap_or(NonZero::<u64>::MIN);
        let turns = lead.denominator().unsigned_abs();
        Self {
            nm,
            turns,
            // distance < 2⁴⁴, so distance·turns < 2⁶⁴; 2·remainder·360 000 000 < 2⁶³·5.
            narrow: turns < 1 << 20 && nm.get() < 1 << 34,
        }
    }

    /// The angle turned over `distance` nanometres, modulo a turn, to the nearest millionth of a degree.
    #[inline]
    fn angle(&self, distance: u64) -> u32 {
        let rounded = if self.narrow {
            let part = distance.wrapping_mul(self.turns) % self.nm;
            // Half a lead rounds to the nearest; nm < 2³⁴ keeps the sum below 2⁶³.
            let scaled = part.wrapping_mul(u64::from(TURN_UDEG));
            (scaled.wrapping_add(self.nm.get() >> 1) / self.nm) as u32
        } else {
            self.wide_angle(distance)
        };
        if rounded >= TURN_UDEG { 0 } else { rounded }
    }

    #[cold]
    fn wide_angle(&self, distance: u64) -> u32 {
        let nm = NonZero::<u128>::from(self.nm);
        let part = u128::from(distance).wrapping_mul(u128::from(self.turns)) % nm;
        let scaled = part.wrapping_mul(u128::from(TURN_UDEG));
        (scaled.wrapping_add(nm.get() >> 1) / nm) as u32
    }
}
