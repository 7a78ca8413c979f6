//! A threading pass in the executor: the wait for the spindle, and the limits for the spindle during the stroke.

use super::{Active, Conditions, Executor, Motion, Setpoint};
use crate::alarm::{Alarm, Arg, Code};
use crate::motion::segment::{Pass, Segment};
use crate::motion::thread::{Phase, ThreadPlan, ThreadRun};
use crate::spindle::{Follower, Learner, Prediction};
use crate::units::{Axis, TurnRate, Turns};

/// The axes stand for this many ticks at the end of a pass before the next segment begins. Then no third difference
/// spans the last setpoints of the pass and the first setpoints of the next segment, so their jerks do not add.
const SETTLING: u8 = 2;

/// How many ticks a pass has waited.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Waited {
    /// Ticks of waiting for the speed.
    speed: u32,
    /// Ticks of waiting for the index, at speed.
    index: u32,
    /// Ticks of waiting until the spindle's swings are learned, at speed.
    swings: u32,
}

/// A stroke under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) run: ThreadRun,
    /// Ticks for which the spindle has not turned as it must. An alarm follows after a second of standing, after a tenth of
    /// a second of turning the wrong way, or after a hundredth of a second above the speed for which the pass is planned.
    astray: u32,
    /// Ticks since the axes came to rest.
    settled: u8,
}

/// What goes after the learned angle of the spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followers {
    long: Follower,
    /// That of the short axis, where its drive has another delay.
    short: Follower,
}

impl Followers {
    /// Followers for a pass, which have not begun.
    fn new(plan: &ThreadPlan, learner: &Learner) -> Self {
        let pole = learner.tracker().pole_of_follower();
        let follower = Follower::new(*plan.follower(), pole);
        Self {
            long: follower,
            short: follower,
        }
    }

    /// Begin on the learned angle.
    fn begin(&mut self, plan: &ThreadPlan, learner: &Learner) {
        let long_x = plan.long_x();
        self.long.begin(&learner.at(long_x).learned);
        self.short.begin(&learner.at(!long_x).learned);
    }

    /// A tick of a pass. `apart`: the setpoint of the short axis takes effect at another instant.
    #[cold]
    #[inline(never)]
    fn tick(&mut self, learner: &Learner, long_x: bool, apart: bool) -> Led {
        Led {
            speed: learner.speed(long_x),
            angle: follow(&mut self.long, learner.at(long_x)),
            beside: apart.then(|| follow(&mut self.short, learner.at(!long_x))),
            lost: self.long.is_lost(),
        }
    }
}

/// The spindle as a pass follows it.
struct Led {
    speed: TurnRate,
    /// Where the setpoint of the long axis takes effect, and of the short one where that is another instant.
    angle: Turns,
    beside: Option<Turns>,
    /// The angle is farther from what is learned than it may be.
    lost: bool,
}

/// The angle of the follower.
fn follow(follower: &mut Follower, angle: &Prediction) -> Turns {
    let beside = follower.tick(&angle.learned);
    // Rounded to 2⁻³².
    Turns::from_raw(angle.angle) + Turns::from_raw(beside.wrapping_add(1 << 15) >> 16)
}

impl Executor {
    /// A tick of the wait. The pass begins when the spindle turns as commanded, its index is known and the retract is
    /// queued.
    pub(super) fn wait(
        &mut self,
        now: &Conditions<'_>,
        pass: &Pass,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        if now.hold {
            self.active = Active::Waiting(Waited::default());
            self.tell(setpoint, Motion::Hold);
            return Ok(());
        }
        let speed = now.observer.speed();
        let wanted = TurnRate::of_rpm(pass.rpm);
        if !self.arrived(speed, wanted) {
            if self.waits_longer(|waited| &mut waited.speed) > self.arrival.speed_ticks {
                self.active = Active::Free;
                return Err(Alarm::new(Code::SpindleNotArrived, self.span)
                    .with([Arg::Rpm(speed.rpm()), Arg::Rpm(pass.rpm)]));
            }
        } else if !now.observer.indexed() {
            self.has_arrived();
            let patience = self.arrival.index_ticks(pass.rpm);
            if self.waits_longer(|waited| &mut waited.index) > patience {
                self.active = Active::Free;
                return Err(Alarm::new(Code::NoIndex, self.span));
            }
        } else if let Some(learner) = now.learner
            && !learner.tracker().is_ready()
        {
            self.has_arrived();
            self.followers = None;
            let patience = learner.tracker().patience();
            if self.waits_longer(|waited| &mut waited.swings) > patience {
                self.active = Active::Free;
                return Err(
                    Alarm::new(Code::SpindleNotSteady, self.span).with([Arg::Rpm(speed.rpm())])
                );
            }
        } else if let Some(learner) = now.learner
            && self.followers.is_none()
        {
            // A tick of its own, for its divisions; and swings are told in the tick after the one that is ready.
            self.followers = Some(Followers::new(&pass.plan, learner));
        } else if now.more {
            // Both axes must be in time, so the axis with the slower drive decides when the pass leaves.
            let by_x = now.ahead_x > now.ahead_z;
            let begun = match (now.learner, &mut self.followers) {
                (Some(learner), Some(followers)) => {
                    followers.begin(&pass.plan, learner);
                    let angle = Turns::from_raw(learner.at(by_x).angle);
                    ThreadRun::start(&pass.plan, angle, learner.speed(by_x))
                }
                _ => {
                    let ahead = now.ahead_x.max(now.ahead_z);
                    ThreadRun::start(&pass.plan, now.observer.predict(ahead), speed)
                }
            };
            match begun {
                Ok(run) => {
                    self.active = Active::Thread(Stroke {
                        run,
                        astray: 0,
                        settled: 0,
                    });
                }
                Err(alarm) => {
                    self.active = Active::Free;
                    return Err(alarm);
                }
            }
        }
        self.tell(setpoint, Motion::Wait);
        Ok(())
    }

    /// The stroke under way, `pass`, is over, because the next one of its chain takes over.
    pub fn leave_stroke(&mut self, pass: &Pass) {
        self.crossed = false;
        if let Active::Thread(stroke) = &mut self.active {
            stroke.run.leave(&pass.plan);
        }
    }

    /// The next stroke of a chain takes over.
    pub fn take_over(&mut self, segment: &Segment, pass: &Pass) {
        if let Active::Thread(stroke) = &mut self.active {
            stroke.run.take_over(&pass.plan);
            self.number = segment.number;
            self.span = segment.span;
            self.stops = segment.stops;
        }
    }

    /// A spindle that swings is within its tolerance and beside it by turns: each time it has as long to come back.
    const fn has_arrived(&mut self) {
        if let Active::Waiting(waited) = &mut self.active {
            waited.speed = 0;
        }
    }

    /// Counts one more tick of one of the waits and returns its ticks so far.
    fn waits_longer(&mut self, which: impl FnOnce(&mut Waited) -> &mut u32) -> u32 {
        let Active::Waiting(waited) = &mut self.active else {
            return 0;
        };
        let ticks = which(waited);
        *ticks = ticks.saturating_add(1);
        *ticks
    }

    fn arrived(&self, speed: TurnRate, wanted: TurnRate) -> bool {
        if wanted == TurnRate::ZERO || speed.is_negative() != wanted.is_negative() {
            return false;
        }
        let off = speed
            .abs()
            .raw()
            .saturating_sub(wanted.abs().raw())
            .saturating_abs();
        let tolerance =
            (wanted.abs().raw() / 100).saturating_mul(i64::from(self.arrival.tolerance_percent));
        off <= tolerance
    }

    /// A tick of the pass.
    pub(super) fn cut_on(
        &mut self,
        now: &Conditions<'_>,
        plan: &ThreadPlan,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        let Active::Thread(Stroke {
            run,
            astray,
            settled,
        }) = &mut self.active
        else {
            return Ok(());
        };
        if now.hold && !self.aborting && run.phase() == Phase::Waiting {
            // The axes have not left the start point yet, so the pass waits again after the hold.
            self.active = Active::Waiting(Waited::default());
            self.tell(setpoint, Motion::Hold);
            return Ok(());
        }
        let turning = now.observer.is_turning();
        let long_x = plan.long_x();
        let (long, short) = if long_x {
            (now.ahead_x, now.ahead_z)
        } else {
            (now.ahead_z, now.ahead_x)
        };
        let Led {
            speed,
            angle,
            beside,
            lost,
        } = match (&mut self.followers, now.learner) {
            (Some(followers), Some(learner)) => followers.tick(learner, long_x, long != short),
            _ => Led {
                speed: now.observer.speed(),
                angle: now.observer.predict(long),
                beside: (long != short).then(|| now.observer.predict(short)),
                lost: false,
            },
        };
        // An axis that is not on the thread where its run-in ends does not begin to cut.
        let (lost, patience) = match run.phase() {
            Phase::Locked => (lost, 300),
            Phase::Joining if plan.is_joined() => (lost, 300),
            Phase::Joining => (lost && run.locks(plan, angle), u32::MAX),
            Phase::Waiting | Phase::Braking | Phase::Done => (false, 0),
        };
        let backwards = turning && speed.is_negative() != plan.is_reverse();
        let too_fast = speed.abs() > plan.speed_limit();
        let trouble = if !run.is_led() {
            None
        } else if too_fast {
            Some((Code::SpindleTooFast, 100))
        } else if backwards {
            Some((Code::SpindleStopped, 10))
        } else if !turning {
            Some((Code::SpindleStopped, 1))
        } else if lost {
            Some((Code::SpindleSwings, patience))
        } else {
            None
        };
        let trouble = self.arrival.count_astray(astray, trouble);
        if trouble.is_some() {
            // The axes must brake from this very tick on. A tick in which they stood would be a jolt.
            run.stop(plan);
        }
        let mut ahead = angle;
        let point = match beside {
            None => run.tick(plan, angle),
            Some(beside) => {
                if short > long {
                    ahead = beside;
                }
                run.tick_apart(plan, angle, beside)
            }
        };
        self.crossed = run.is_over(plan, ahead);
        // A stop takes the axes along the same path, but at a pace of its own.
        let is_led = run.is_led();
        self.position = point.position;
        let motion = match point.phase {
            Phase::Waiting => Motion::Wait,
            Phase::Done => {
                *settled = settled.saturating_add(1);
                if *settled > SETTLING {
                    self.active = Active::Free;
                }
                Motion::Run
            }
            Phase::Joining | Phase::Locked | Phase::Braking => Motion::Run,
        };
        match trouble {
            None => {}
            Some(Code::SpindleTooFast) => return Err(plan.too_fast(speed)),
            Some(Code::SpindleSwings) => {
                let axis = if long_x { Axis::X } else { Axis::Z };
                let args = [Arg::Letter(axis.letter()), Arg::Rpm(speed.rpm())];
                return Err(Alarm::new(Code::SpindleSwings, self.span).with(args));
            }
            Some(code) => return Err(Alarm::new(code, self.span)),
        }
        self.tell(setpoint, motion);
        setpoint.locked = is_led && point.phase == Phase::Locked;
        setpoint.number = self.number.saturating_add(u32::from(point.move_index));
        Ok(())
    }
}
