//! An ordinary tap in the tick: the spindle's angle in, a setpoint and the spindle's next command out. No division, no
//! loop; one square root of 64 bits.

use super::course::{Leg, Place};
use super::law::Region;
use super::plan::FloatPlan;
use crate::alarm::{Alarm, Arg, Code};
use crate::call::Position;
use crate::motion::ease::Fine;
use crate::motion::executor::{Arrival, Motion};
use crate::motion::tap::TapLine;
use crate::spindle::Observer;
use crate::units::{Length, Ticks, TurnRate, Turns};

/// The axis stands at R for this many ticks before the next segment begins [D52].
const SETTLING: u8 = 2;

/// Each tick at a wrong speed takes back this many ticks at the right speed. So the ticks that a spindle collects on
/// its way up to a higher speed do not count when it slows down again [D153]. A wrong tick does not take back all
/// ticks, since ripple leaves the band in every turn.
const UNSETTLING: u32 = 2;

/// The inputs of one tick of an ordinary tap.
#[derive(Clone, Copy, Debug)]
pub struct FloatTick<'a> {
    /// The observer that tells the angle of the spindle.
    pub observer: &'a Observer,
    /// Time from the sample to the instant at which the axis' setpoint takes effect.
    pub ahead: Ticks,
    /// The operator asks for feed hold.
    pub hold: bool,
    /// The feed hold acts at once, in the hole too (5200.6).
    pub inside: bool,
    /// The condition of the spindle before a hole begins.
    pub arrival: &'a Arrival,
}

/// The result of one tick of an ordinary tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatPoint {
    /// The setpoint.
    pub position: Position,
    /// What the axis is doing.
    pub motion: Motion,
    /// True when the axis is held to the helix.
    pub locked: bool,
    /// Number of moves of the hole done before the move of this tick.
    pub offset: u32,
    /// True when nothing is left to do.
    pub done: bool,
    /// The fault of the spindle, for [`FloatRun::alarm`]. The axis is being brought to rest, or stands.
    pub alarm: Option<Code>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// At R, until the spindle turns as it must. `speed` counts ticks without the speed, `index` ticks without the
    /// index. `settled` counts ticks with both, minus the ticks that wrong speeds have taken back.
    Arriving {
        speed: u32,
        index: u32,
        settled: u32,
    },
    /// The axis follows, and the spindle is on its way to the next turning point.
    Turning,
    /// At R between two pecks, held by a feed hold.
    Resting,
    /// At the bottom, with this many ticks left.
    Dwelling(u32),
    /// The axis brakes by time. The value is its speed in 2⁻¹⁶ nm per tick.
    Forced(Fine),
    /// Over, since this many ticks.
    Settling(u8),
}

/// The state of an ordinary tap under way. The caller passes the same plan in every tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloatRun {
    stage: Stage,
    place: Place,
    /// The next turning point: angle from R, inwards, 2⁻³² turns.
    target: i64,
    /// True while the spindle brakes for the turning point.
    braking: bool,
    /// Commanded speed, inwards, 2⁻³² turns per tick.
    speed: i64,
    /// The spindle's angle, inwards, at which the helix is at R.
    base: Turns,
    /// The axis' depth below R, and its way in the last tick.
    way: Fine,
    step: Fine,
    /// Moves done.
    done: u32,
    position: Position,
    /// True when the axis is at rest together with the spindle, in a feed hold or after a stop.
    rested: bool,
    aborted: bool,
    /// `astray`: ticks for which the spindle has not turned as it must. `stopping`: ticks for which it has been
    /// stopping.
    astray: u32,
    stopping: u32,
}

impl FloatRun {
    /// A tap that begins where the machine stands: at R.
    #[must_use]
    pub fn new(plan: &FloatPlan, position: Position) -> Self {
        Self {
            stage: Stage::Arriving {
                speed: 0,
                index: 0,
                settled: 0,
            },
            place: plan.course.first(),
            target: 0,
            braking: false,
            speed: plan.entry,
            base: Turns::ZERO,
            way: 0,
            step: 0,
            done: 0,
            position,
            rested: false,
            aborted: false,
            astray: 0,
            stopping: 0,
        }
    }

    /// The speed to command to the spindle, signed like M03 and M04.
    #[must_use]
    pub fn command(&self, plan: &FloatPlan) -> TurnRate {
        let inwards = Turns::from_raw(plan.turner.rate(self.speed).raw());
        TurnRate::from_raw(plan.law.inward(inwards).raw())
    }

    /// The line on which the axis and the measured spindle are in the locked part; `None` while the tap has not begun.
    #[must_use]
    pub fn line(&self, plan: &FloatPlan) -> Option<TapLine> {
        if let Stage::Arriving { .. } = self.stage {
            return None;
        }
        Some(TapLine {
            gear: *plan.law.gear(),
            origin: plan.law.inward(self.base),
        })
    }

    /// Gives up the rest of the tap: the spindle is stopped, and the axis follows it until it stands. True if nothing
    /// moves, so that the tap is over at once.
    #[must_use]
    pub fn stop(&mut self) -> bool {
        self.aborted = true;
        matches!(self.stage, Stage::Arriving { .. } | Stage::Settling(_))
    }

    /// The alarm `code` of a [`FloatPoint`], with the spindle's measured and wanted speed.
    #[must_use]
    #[inline(never)]
    pub fn alarm(&self, code: Code, plan: &FloatPlan, observer: &Observer) -> Alarm {
        let measured = Arg::Rpm(observer.speed().rpm());
        let (measured, wanted) = match code {
            Code::SpindleNotArrived => (measured, Arg::Rpm(self.command(plan).rpm())),
            Code::SpindleTooFast => (measured, Arg::Rpm(plan.speed_limit.rpm())),
            Code::FloatSpindleRuns => (measured, Arg::None),
            _ => (Arg::None, Arg::None),
        };
        Alarm::new(code, plan.span).with([measured, wanted])
    }

    /// One tick.
    pub fn tick(&mut self, plan: &FloatPlan, now: &FloatTick<'_>) -> FloatPoint {
        let mut point = FloatPoint {
            position: self.position,
            motion: Motion::Run,
            locked: false,
            offset: self.done,
            done: false,
            alarm: None,
        };
        match self.stage {
            Stage::Arriving { .. } => {
                point.motion = if now.hold {
                    self.stage = Stage::Arriving {
                        speed: 0,
                        index: 0,
                        settled: 0,
                    };
                    Motion::Hold
                } else {
                    point.alarm = self.arrive(plan, now);
                    point.done = point.alarm.is_some();
                    Motion::Wait
                };
                return point;
            }
            Stage::Settling(ticks) => {
                self.stage = Stage::Settling(ticks.saturating_add(1));
                point.done = ticks.saturating_add(1) > SETTLING;
                return point;
            }
            Stage::Forced(speed) => {
                self.speed = plan.turner.towards(self.speed, 0);
                point.done = self.brake(plan, speed);
            }
            Stage::Turning | Stage::Resting | Stage::Dwelling(_) => {
                let angle = now.observer.predict(now.ahead.and(plan.lag));
                let helix = plan.law.travel(plan.law.inward(angle) - self.base);
                let (way, region) = plan.law.at(helix);
                let step = way.wrapping_sub(self.way);
                if runs_on(plan, way, step, region) {
                    point.alarm = Some(Code::FloatSpindleRuns);
                    self.force(plan, step);
                } else {
                    (self.way, self.step) = (way, step);
                    point.locked = region == Region::Locked;
                    (point.motion, point.alarm) = self.turn(plan, now, region);
                    point.done = self.aborted && self.rested;
                }
            }
        }
        self.position = plan.law.position(self.position, self.way);
        point.position = self.position;
        point
    }

    /// The spindle's speed inwards.
    fn measured(plan: &FloatPlan, now: &FloatTick<'_>) -> TurnRate {
        let speed = Turns::from_raw(now.observer.speed().raw());
        TurnRate::from_raw(plan.law.inward(speed).raw())
    }

    /// Waits for speed and index. Then the tap begins: the axis leaves R.
    fn arrive(&mut self, plan: &FloatPlan, now: &FloatTick<'_>) -> Option<Code> {
        let measured = Self::measured(plan, now).raw();
        let Stage::Arriving {
            speed,
            index,
            settled,
        } = &mut self.stage
        else {
            return None;
        };
        let wanted = plan.entry_rate.raw();
        let below = (wanted / 100).wrapping_mul(i64::from(now.arrival.tolerance_percent));
        let (least, most) = (wanted.wrapping_sub(below), wanted.wrapping_add(wanted >> 4));
        if measured < least || measured > most {
            let late = *speed > now.arrival.speed_ticks;
            *speed = speed.saturating_add(1);
            *settled = settled.saturating_sub(UNSETTLING);
            return late.then_some(Code::SpindleNotArrived);
        }
        if !now.observer.indexed() {
            let patience = now.arrival.index_ticks(plan.entry_rate.rpm());
            let late = *index > patience;
            *index = index.saturating_add(1);
            return late.then_some(Code::NoIndex);
        }
        if *settled < plan.settling {
            *settled = settled.saturating_add(1);
            return None;
        }
        let angle = now.observer.predict(now.ahead.and(plan.lag));
        let before = Turns::from_raw(plan.law.join_turns());
        self.base = plan.law.inward(angle) + before;
        self.stage = Stage::Turning;
        self.aim(plan);
        None
    }

    /// Sets the turning point for the leg that begins.
    fn aim(&mut self, plan: &FloatPlan) {
        self.braking = false;
        self.astray = 0;
        self.stopping = 0;
        let mut place = &self.place;
        // A re-entry goes on into the infeed without a stop.
        let behind = plan.course.after(place);
        if place.leg == Leg::Reenter
            && let Some(infeed) = &behind
        {
            place = infeed;
        }
        self.target = if place.depth == Length::ZERO {
            plan.out.wrapping_neg()
        } else {
            let beyond = if plan.course.is_bottom(place) {
                plan.beyond
            } else {
                0
            };
            plan.law.turns_to(place.depth).saturating_add(beyond)
        };
    }

    /// Commands the spindle from leg to leg.
    fn turn(
        &mut self,
        plan: &FloatPlan,
        now: &FloatTick<'_>,
        region: Region,
    ) -> (Motion, Option<Code>) {
        let standing = now.observer.speed().abs() <= plan.standing;
        let held = now.hold && now.inside;
        if held || self.aborted {
            self.speed = plan.turner.towards(self.speed, 0);
            self.braking = false;
            self.astray = 0;
            // Once the spindle has come to rest, the sample noise of the standing spindle does not count.
            self.rested |= self.speed == 0 && standing;
            if !self.rested {
                return (Motion::Run, self.overdue(plan, now));
            }
            return (Motion::Hold, None);
        }
        self.rested = false;
        match self.stage {
            Stage::Dwelling(left) => {
                let left = left.saturating_sub(1);
                self.stage = Stage::Dwelling(left);
                if left == 0 {
                    self.next(plan, now);
                }
                return (Motion::Dwell, None);
            }
            Stage::Resting if now.hold => return (Motion::Hold, None),
            Stage::Resting => {
                self.stage = Stage::Turning;
                self.aim(plan);
            }
            _ => {}
        }
        if self.place.leg == Leg::Extract && region == Region::Out {
            self.done = self.done.saturating_add(1);
            self.stage = Stage::Settling(0);
            return (Motion::Run, None);
        }
        self.lead(plan, now);
        if self.place.leg == Leg::Reenter && self.way >= self.place.depth.nm().wrapping_shl(16) {
            self.next(plan, now);
            return (Motion::Run, None);
        }
        if self.braking {
            if standing {
                self.speed = 0;
                self.next(plan, now);
                return (Motion::Run, None);
            }
            return (Motion::Run, self.overdue(plan, now));
        }
        (Motion::Run, self.astray(plan, now, standing))
    }

    /// The next command on the way to the turning point.
    fn lead(&mut self, plan: &FloatPlan, now: &FloatTick<'_>) {
        let turner = &plan.turner;
        let outwards = matches!(self.place.leg, Leg::Back | Leg::Extract);
        // The angle of the spindle when the command reaches it.
        let angle = (plan.law.inward(now.observer.predict(Ticks::ONE)) - self.base).raw();
        let left = self.target.wrapping_sub(angle);
        let left = if outwards { left.wrapping_neg() } else { left };
        let most = if self.place.leg == Leg::Extract {
            turner.top()
        } else {
            let near = (self.speed.unsigned_abs() as i64).wrapping_add(turner.gentle());
            // The exact speed, a square root, is certainly needed only while the spindle already brakes.
            let enough = if self.braking {
                i64::MAX
            } else {
                near.max(turner.top()).saturating_add(1)
            };
            let stopping = turner.stopping_or(left, enough);
            self.braking |= stopping <= near;
            stopping.min(turner.top())
        };
        let wanted = if outwards { most.wrapping_neg() } else { most };
        self.speed = turner.towards(self.speed, wanted);
    }

    /// Ends the leg. The next leg begins, or waits at R in a feed hold.
    fn next(&mut self, plan: &FloatPlan, now: &FloatTick<'_>) {
        self.done = self.done.saturating_add(1);
        let Some(place) = plan.course.after(&self.place) else {
            self.stage = Stage::Settling(0);
            return;
        };
        let at_r = self.place.depth == Length::ZERO;
        self.place = place;
        self.stage = match place.leg {
            Leg::Dwell => Stage::Dwelling(plan.course.dwell()),
            _ if at_r && now.hold => Stage::Resting,
            _ => Stage::Turning,
        };
        self.aim(plan);
    }

    /// The alarm for a spindle that takes longer to stop than it may.
    fn overdue(&mut self, plan: &FloatPlan, now: &FloatTick<'_>) -> Option<Code> {
        self.stopping = self.stopping.saturating_add(1);
        if self.stopping <= now.arrival.speed_ticks {
            return None;
        }
        self.stopping = 0;
        self.force(plan, self.step);
        Some(Code::FloatSpindleRuns)
    }

    /// The alarm for a spindle that does not turn as commanded [D67].
    fn astray(&mut self, plan: &FloatPlan, now: &FloatTick<'_>, standing: bool) -> Option<Code> {
        let measured = Self::measured(plan, now);
        let told = plan.turner.rate(self.speed).abs() > plan.standing;
        let backwards = !standing && measured.is_negative() != (self.speed < 0);
        let too_fast = measured.abs() > plan.speed_limit;
        let trouble = if !told || !(standing || backwards || too_fast) {
            None
        } else if too_fast {
            // This time is longer than the observer overshoots after a quick ramp.
            Some((Code::SpindleTooFast, 20))
        } else {
            Some((Code::SpindleStopped, if backwards { 10 } else { 1 }))
        };
        now.arrival.count_astray(&mut self.astray, trouble)
    }

    /// From this tick on the axis brakes by time.
    fn force(&mut self, plan: &FloatPlan, step: Fine) {
        self.aborted = true;
        self.stage = Stage::Forced(step);
        self.brake(plan, step);
    }

    /// One tick of braking by time; true once the axis stands.
    fn brake(&mut self, plan: &FloatPlan, speed: Fine) -> bool {
        let slower = (speed.unsigned_abs() as Fine)
            .wrapping_sub(plan.brake)
            .max(0);
        let step = slower.wrapping_mul(speed.signum());
        self.step = step;
        // The axis stays between R and the bottom, whatever happens.
        self.way = self.way.wrapping_add(step).max(0).min(plan.law.length());
        self.stage = Stage::Forced(step);
        step == 0
    }
}

/// True if the axis must brake now to come to rest at the bottom, because the spindle has not braked.
fn runs_on(plan: &FloatPlan, way: Fine, step: Fine, region: Region) -> bool {
    if step <= 0 || region == Region::Bottom {
        return false;
    }
    // Speed in nm/16 per tick.
    let speed = u64::from(u32::try_from(step >> 12).unwrap_or(u32::MAX));
    let square = speed.wrapping_mul(speed);
    if square <= plan.corner {
        return false;
    }
    let (_, round) = plan.law.halves();
    let left = plan
        .law
        .length()
        .wrapping_sub(round)
        .wrapping_sub(way)
        .wrapping_sub(step);
    // No stop needs more than four metres, so the way left is limited to 32 bits.
    let left = u32::try_from(left.max(0) >> 16).unwrap_or(u32::MAX);
    let room = u64::from(plan.room).wrapping_mul(u64::from(left));
    square > plan.corner.saturating_add(room)
}
