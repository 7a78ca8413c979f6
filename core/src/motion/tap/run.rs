//! A tap in the tick: one step after another, axis and spindle from one setpoint.

use super::gear::TapLine;
use super::plan::{Stroke, Tap, TapStep};
use crate::motion::executor::Motion;
use crate::motion::line::Line;
use crate::motion::path::Path;
use crate::motion::plan::Timed;
use crate::motion::rate::{PathRate, Rate};
use crate::motion::run::Run;
use crate::program::Position;
use crate::units::Turns;

/// What one tick of a tap says.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct TapPoint {
    /// The setpoint.
    pub(in crate::motion) position: Position,
    /// The commanded spindle angle at it.
    pub(in crate::motion) angle: Turns,
    /// What the axes are doing.
    pub(in crate::motion) motion: Motion,
    /// Steps done before the one of this tick.
    pub(in crate::motion) offset: u32,
    /// Nothing is left to do.
    pub(in crate::motion) done: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// At rest before a step.
    Between,
    /// In a stroke.
    Moving,
    /// In a dwell, so many ticks to go.
    Dwelling(u32),
}

/// A tap under way.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct TapRun {
    tap: Tap,
    line: TapLine,
    stage: Stage,
    index: u8,
    left: u32,
    /// Steps done.
    done: u32,
    position: Position,
    aborted: bool,
}

impl TapRun {
    /// A tap that begins where the machine stands, with the spindle at `angle`.
    pub(in crate::motion) fn new(tap: &Tap, position: Position, angle: Turns) -> Self {
        Self {
            tap: *tap,
            line: TapLine::through(tap.gear, position, angle),
            stage: Stage::Between,
            index: 0,
            left: tap.repeats(),
            done: 0,
            position,
            aborted: false,
        }
    }

    /// The line it is on.
    pub(in crate::motion) const fn line(&self) -> &TapLine {
        &self.line
    }

    /// The feed override acts.
    pub(in crate::motion) const fn feed_override(&self) -> bool {
        self.tap.feed_override
    }

    /// Gives up what is left. True where nothing moves and it is over at once.
    pub(in crate::motion) fn stop(&mut self, run: &mut Run) -> bool {
        self.aborted = true;
        run.abandon();
        self.stage != Stage::Moving
    }

    /// One tick at `rate`; `hold`: nothing new begins, and a stroke is at rate zero.
    pub(in crate::motion) fn tick(&mut self, run: &mut Run, rate: Rate, hold: bool) -> TapPoint {
        let offset = self.done;
        if self.stage == Stage::Between && !hold {
            self.begin(run);
        }
        let (motion, over) = match &mut self.stage {
            Stage::Between => (Motion::Hold, false),
            Stage::Dwelling(_) if hold => (Motion::Hold, false),
            Stage::Dwelling(left) => {
                *left = left.saturating_sub(1);
                (Motion::Dwell, *left == 0)
            }
            Stage::Moving => {
                let step = run.tick(if hold { Rate::HOLD } else { rate });
                self.position = step.position;
                let resting = hold && run.at_rest() && !step.done;
                let motion = if resting { Motion::Hold } else { Motion::Run };
                (motion, step.done)
            }
        };
        let done = over && self.finish_step();
        TapPoint {
            position: self.position,
            angle: self.line.angle(self.position),
            motion,
            offset,
            done,
        }
    }

    fn begin(&mut self, run: &mut Run) {
        self.stage = match self.tap.step(self.index) {
            Some(TapStep::Dwell(ticks)) => Stage::Dwelling(*ticks),
            Some(TapStep::Stroke(stroke)) => {
                let timed = timed(stroke, self.line.gear.axis(), self.position);
                if run.begin(&timed) {
                    Stage::Moving
                } else {
                    Stage::Between
                }
            }
            // Not reached: a tap without a step is over before it begins.
            None => Stage::Dwelling(1),
        };
    }

    /// The next step; true where there is none.
    fn finish_step(&mut self) -> bool {
        (self.index, self.left) = self.tap.after(self.index, self.left);
        self.done = self.done.saturating_add(1);
        self.stage = Stage::Between;
        self.aborted || self.tap.step(self.index).is_none()
    }
}

/// A stroke from where the machine stands, for the profile.
fn timed(stroke: &Stroke, axis: crate::program::TapAxis, from: Position) -> Timed {
    let to = axis.with(from, axis.of(from) + stroke.travel);
    Timed {
        path: Path::Line(Line::along_axis(from, to, axis)),
        length: stroke.travel.abs(),
        nominal: stroke.nominal,
        ramp: stroke.ramp,
        exit: PathRate::ZERO,
        feed: None,
    }
}
