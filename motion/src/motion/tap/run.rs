//! A rigid tap in the tick: one step after another; axis and spindle follow one setpoint.

use super::gear::TapLine;
use super::plan::{Stroke, Tap, TapStep};
use crate::call::Position;
use crate::motion::executor::Motion;
use crate::motion::rate::{Rate, Travel};
use crate::motion::run::Run;
use crate::units::{Length, Turns};

/// The result of one tick of a tap.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct TapPoint {
    /// The commanded spindle angle at the setpoint.
    pub(in crate::motion) angle: Turns,
    /// What the axes are doing.
    pub(in crate::motion) motion: Motion,
    /// Number of steps done before the step of this tick.
    pub(in crate::motion) offset: u32,
    /// True when nothing is left to do.
    pub(in crate::motion) done: bool,
    /// True when a stroke has just ended.
    pub(in crate::motion) turned: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// At rest before a step.
    Between,
    /// In a stroke that began at this position of the tap axis.
    Moving(Length),
    /// In a dwell, with this many ticks left.
    Dwelling(u32),
}

/// The changing state of a tap under way. The steps stay in the plan, which the caller passes unchanged in every tick.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct TapRun {
    /// Commanded spindle angle at R.
    origin: Turns,
    stage: Stage,
    index: u8,
    left: u32,
    /// Steps done.
    done: u32,
    aborted: bool,
}

impl TapRun {
    /// A tap that begins where the machine stands, with the spindle at `angle`.
    pub(in crate::motion) fn new(tap: &Tap, position: Position, angle: Turns) -> Self {
        Self {
            origin: angle - tap.gear.turns(position),
            stage: Stage::Between,
            index: 0,
            left: tap.repeats(),
            done: 0,
            aborted: false,
        }
    }

    /// The line on which axis and spindle are.
    pub(in crate::motion) const fn line(&self, tap: &Tap) -> TapLine {
        TapLine {
            gear: tap.gear,
            origin: self.origin,
        }
    }

    /// Gives up the rest of the tap. True if nothing moves, so that the tap is over at once.
    pub(in crate::motion) const fn stop(&mut self, run: &mut Run) -> bool {
        self.aborted = true;
        run.abandon();
        !matches!(self.stage, Stage::Moving(_))
    }

    /// One tick at `rate`, from the last setpoint to the next. With `hold` no new step begins, and a stroke runs at
    /// rate zero.
    pub(in crate::motion) fn tick(
        &mut self,
        tap: &Tap,
        run: &mut Run,
        position: &mut Position,
        rate: Rate,
        hold: bool,
    ) -> TapPoint {
        let offset = self.done;
        let step = tap.step(self.index);
        let axis = tap.gear.axis();
        if self.stage == Stage::Between && !hold {
            self.begin(step, axis.of(*position), run);
        }
        let (motion, over) = match (&mut self.stage, step) {
            (Stage::Between, _) => (Motion::Hold, false),
            (Stage::Dwelling(_), _) if hold => (Motion::Hold, false),
            (Stage::Dwelling(left), _) => {
                *left = left.saturating_sub(1);
                (Motion::Dwell, *left == 0)
            }
            (Stage::Moving(from), Some(TapStep::Stroke(stroke))) => {
                let progress = run.progress(if hold { Rate::HOLD } else { rate });
                axis.set(position, *from + way(stroke, progress.travel));
                let resting = hold && run.at_rest() && !progress.done;
                let motion = if resting { Motion::Hold } else { Motion::Run };
                (motion, progress.done)
            }
            // Never reached: only a stroke moves.
            (Stage::Moving(_), _) => (Motion::Run, true),
        };
        let turned = over && matches!(self.stage, Stage::Moving(_));
        let done = over && self.finish_step(tap);
        TapPoint {
            angle: self.origin + tap.gear.turns(*position),
            motion,
            offset,
            done,
            turned,
        }
    }

    fn begin(&mut self, step: Option<&TapStep>, from: Length, run: &mut Run) {
        self.stage = match step {
            Some(TapStep::Dwell(ticks)) => Stage::Dwelling(*ticks),
            Some(TapStep::Stroke(stroke)) => {
                if run.begin_length(stroke.travel.abs(), stroke.nominal, stroke.ramp) {
                    Stage::Moving(from)
                } else {
                    Stage::Between
                }
            }
            // Never reached: a tap without a step is over before it begins.
            None => Stage::Dwelling(1),
        };
    }

    /// Goes to the next step; true if there is none.
    fn finish_step(&mut self, tap: &Tap) -> bool {
        (self.index, self.left) = tap.after(self.index, self.left);
        self.done = self.done.saturating_add(1);
        self.stage = Stage::Between;
        self.aborted || tap.step(self.index).is_none()
    }
}

/// The distance covered in a stroke, rounded to the nearest nanometre; the whole travel at the end.
const fn way(stroke: &Stroke, travel: Travel) -> Length {
    let length = stroke.travel.nm().unsigned_abs();
    let way = travel.raw().wrapping_add(1 << 15) >> 16;
    let way = if way > length { length } else { way } as i64;
    Length::from_nm(if stroke.travel.nm() < 0 {
        way.wrapping_neg()
    } else {
        way
    })
}
