//! The tick of motion: one segment after another becomes one setpoint a tick.
//!
//! Knows planned segments, the spindle's angle and how far the operator lets things go; knows nothing of moves, program
//! text, drives or frames. Constant work: at most one segment is begun in a tick.

use super::rate::Rate;
use super::run::Run;
use super::segment::{Action, Pass, Segment, Stops};
use super::tap::{TapLine, TapRun};
use super::thread::{Phase, Retract, ThreadRun};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::program::{FeedRate, Position};
use crate::spindle::Observer;
use crate::units::{Length, Rpm, Ticks, TurnRate, Turns};

/// Ticks for which the axes stand at the end of a pass before the next segment begins. The last setpoints of the pass and
/// the first of the next segment then share no third difference, so their jerks do not add.
const SETTLING: u8 = 2;

/// What one tick of motion depends on.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// Where the spindle is.
    pub observer: &'a Observer,
    /// How far ahead of the sample an X setpoint takes effect.
    pub ahead_x: Ticks,
    /// The same for Z.
    pub ahead_z: Ticks,
    /// Feed override.
    pub feed: Rate,
    /// Rapid override, at most [`Rate::FULL`].
    pub rapid: Rate,
    /// Feed hold is asked for.
    pub hold: bool,
    /// What comes next is in the queue: a stroke may begin, its retract is there.
    pub more: bool,
}

/// How the spindle must be for a stroke, and how long to wait for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// Measured speed within this many per cent of the commanded one counts as arrived.
    pub tolerance_percent: u8,
    /// Ticks the spindle may take to arrive.
    pub speed_ticks: u32,
    /// Ticks in a minute.
    pub ticks_per_minute: u32,
}

/// What the axes are doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Nothing is under way.
    #[default]
    Idle,
    /// Moving, or between two moves.
    Run,
    /// At rest by feed hold.
    Hold,
    /// Standing for a dwell.
    Dwell,
    /// Waiting for the spindle.
    Wait,
}

/// The setpoint of a tick and what it belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Machine position.
    pub position: Position,
    /// What the axes are doing.
    pub motion: Motion,
    /// The long axis is held to the helix, or axis and spindle to the tap's master.
    pub locked: bool,
    /// Commanded angle of the spindle while it is in position mode.
    pub spindle: Option<Turns>,
    /// Number of the move; 0 where nothing executes.
    pub number: u32,
    /// Its block's line; 0 where nothing executes.
    pub line: u32,
}

/// For how many ticks a pass has waited, and for what.
#[derive(Clone, Copy, Debug, Default)]
struct Waited {
    /// For the speed.
    speed: u32,
    /// For the index, at speed.
    index: u32,
}

#[derive(Clone, Copy, Debug)]
enum Active {
    Free,
    Timed(Option<FeedRate>),
    /// For the spindle, to begin the last pass.
    Waiting(Waited),
    Thread(ThreadRun),
    Tap(TapRun),
    Dwell(u32),
}

/// The one long-lived executor of a machine.
#[derive(Clone, Debug)]
pub struct Executor {
    run: Run,
    active: Active,
    position: Position,
    /// Commanded spindle angle, in position mode.
    spindle: Option<Turns>,
    number: u32,
    span: Span,
    stops: Stops,
    /// The last pass begun, for doing it again.
    pass: Option<Pass>,
    arrival: Arrival,
    aborting: bool,
    /// Ticks for which the spindle has not turned as it must in a stroke: a second of standing is an alarm, a tenth of it
    /// of turning the wrong way, a hundredth of being faster than the pass is planned for.
    astray: u32,
    /// Ticks since the pass came to rest.
    settled: u8,
}

impl Executor {
    /// At rest at the machine's zero.
    #[must_use]
    pub const fn new(arrival: Arrival) -> Self {
        const ZERO: Position = Position {
            x: Length::ZERO,
            z: Length::ZERO,
            c: crate::units::Angle::ZERO,
        };
        Self {
            run: Run::new(),
            active: Active::Free,
            position: ZERO,
            spindle: None,
            number: 0,
            span: Span {
                line: 0,
                column: 0,
                end: 0,
            },
            stops: Stops {
                hold_not_inside: false,
                hold_not_before: false,
                single_block: false,
                frozen: None,
                tap_cycle: false,
                stops_after_last_hole: false,
            },
            pass: None,
            arrival,
            aborting: false,
            astray: 0,
            settled: 0,
        }
    }

    /// Says where the machine stands. Only while nothing is under way.
    pub const fn set_position(&mut self, position: Position) {
        if self.is_free() {
            self.position = position;
        }
    }

    /// The last setpoint.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }

    /// True where the next segment may begin.
    #[must_use]
    pub const fn is_free(&self) -> bool {
        matches!(self.active, Active::Free)
    }

    /// What the segment under way, or the last one, lets an operator do.
    #[must_use]
    pub const fn stops(&self) -> Stops {
        self.stops
    }

    /// The pass under way.
    #[must_use]
    pub const fn thread(&self) -> Option<&ThreadRun> {
        match &self.active {
            Active::Thread(run) => Some(run),
            _ => None,
        }
    }

    /// The line of the tap under way.
    #[must_use]
    pub const fn tap(&self) -> Option<&TapLine> {
        match &self.active {
            Active::Tap(run) => Some(run.line()),
            _ => None,
        }
    }

    /// Commanded spindle angle, in position mode.
    #[must_use]
    pub const fn spindle(&self) -> Option<Turns> {
        self.spindle
    }

    /// The spindle stands at `angle` in position mode, or is in speed mode again. Not while a tap is under way.
    pub const fn set_spindle(&mut self, angle: Option<Turns>) {
        if self.tap().is_none() {
            self.spindle = angle;
        }
    }

    /// Begins a segment of motion; commands and marks are the board's. Ignored while another is under way.
    pub fn begin(&mut self, segment: &Segment) {
        if !self.is_free() {
            return;
        }
        self.number = segment.number;
        self.span = segment.span;
        self.stops = segment.stops;
        self.aborting = false;
        self.active = match &segment.action {
            Action::Timed(timed) if self.run.begin(timed) => Active::Timed(timed.feed),
            Action::Thread(pass) => {
                self.pass = Some(*pass);
                (self.settled, self.astray) = (0, 0);
                Active::Waiting(Waited::default())
            }
            Action::Tap(tap) => match self.spindle {
                Some(angle) if !tap.is_empty() => {
                    Active::Tap(TapRun::new(tap, self.position, angle))
                }
                _ => Active::Free,
            },
            Action::Dwell(ticks) => Active::Dwell(*ticks),
            _ => Active::Free,
        };
    }

    /// Emergency stop: whatever is under way comes to rest on its path, both axes of a synchronised move together
    /// [D18]; what is left of it is forgotten.
    pub fn stop(&mut self) {
        self.aborting = true;
        match &mut self.active {
            Active::Free => {}
            Active::Timed(_) => self.run.abandon(),
            Active::Thread(run) => run.stop(),
            Active::Tap(tap) => {
                if tap.stop(&mut self.run) {
                    self.active = Active::Free;
                }
            }
            Active::Waiting(_) | Active::Dwell(_) => self.active = Active::Free,
        }
    }

    /// Reset, and feed hold with immediate retract: a stroke is left along the run-out's slope towards `target` on the
    /// short axis while the long one stays in lead; anything else stops as by [`stop`](Self::stop).
    pub fn retract(&mut self, target: Length) -> Retract {
        if let Active::Thread(run) = &mut self.active {
            self.aborting = true;
            return run.retract(target);
        }
        self.stop();
        Retract::Standing
    }

    /// One tick.
    ///
    /// # Errors
    /// What the spindle does not do for a stroke: [`Code::NoIndex`], [`Code::SpindleNotArrived`], and what
    /// [`ThreadRun::start`] refuses. The axes stand then.
    pub fn tick(&mut self, now: &Conditions<'_>) -> Result<Setpoint, Alarm> {
        let number = self.number;
        let mut offset = 0;
        let mut locked = false;
        let motion = match &mut self.active {
            Active::Free => {
                return Ok(Setpoint {
                    position: self.position,
                    spindle: self.spindle,
                    ..Setpoint::default()
                });
            }
            Active::Tap(tap) => {
                let hold = now.hold && !self.stops.hold_not_inside && !self.aborting;
                let rate = if tap.feed_override() {
                    now.feed
                } else {
                    Rate::FULL
                };
                let point = tap.tick(&mut self.run, rate, hold);
                self.position = point.position;
                self.spindle = Some(point.angle);
                offset = point.offset;
                locked = true;
                if point.done {
                    self.active = Active::Free;
                }
                point.motion
            }
            Active::Timed(feed) => {
                let hold = now.hold && !self.stops.hold_not_inside;
                let rate = if hold {
                    Rate::HOLD
                } else {
                    match feed {
                        None => now.rapid,
                        Some(FeedRate::PerMinute(_)) => now.feed,
                        Some(FeedRate::PerTurn(_, rpm)) => {
                            now.feed.times(turning(now.observer.speed(), *rpm))
                        }
                    }
                };
                let step = self.run.tick(rate);
                self.position = step.position;
                if step.joined {
                    self.number = self.number.saturating_add(1);
                }
                if step.done {
                    self.active = Active::Free;
                }
                if hold && self.run.at_rest() && !step.done {
                    Motion::Hold
                } else {
                    Motion::Run
                }
            }
            Active::Dwell(left) => {
                if now.hold {
                    Motion::Hold
                } else {
                    *left = left.saturating_sub(1);
                    if *left == 0 {
                        self.active = Active::Free;
                    }
                    Motion::Dwell
                }
            }
            Active::Waiting(waited) => {
                if now.hold {
                    *waited = Waited::default();
                    Motion::Hold
                } else {
                    let mut waited = *waited;
                    match self.wait(&mut waited, now) {
                        Ok(None) => self.active = Active::Waiting(waited),
                        Ok(Some(run)) => self.active = Active::Thread(run),
                        Err(alarm) => {
                            self.active = Active::Free;
                            return Err(alarm);
                        }
                    }
                    Motion::Wait
                }
            }
            Active::Thread(run) if now.hold && !self.aborting && run.phase() == Phase::Waiting => {
                // It has not left yet: it waits again after the hold.
                self.active = Active::Waiting(Waited::default());
                Motion::Hold
            }
            Active::Thread(run) => {
                let speed = now.observer.speed();
                let turning = now.observer.is_turning();
                let backwards = turning && speed.is_negative() != run.plan().is_reverse();
                let too_fast = speed.abs() > run.plan().speed_limit();
                let as_planned = turning && !backwards && !too_fast;
                if as_planned || !run.is_led() {
                    self.astray = 0;
                } else {
                    let per_second = self.arrival.ticks_per_minute / 60;
                    let patience = if too_fast {
                        per_second / 100
                    } else if backwards {
                        per_second / 10
                    } else {
                        per_second
                    };
                    self.astray = self.astray.saturating_add(1);
                    if self.astray > patience {
                        self.astray = 0;
                        return Err(if too_fast {
                            run.plan().too_fast(speed)
                        } else {
                            Alarm::new(Code::SpindleStopped, self.span)
                        });
                    }
                }
                let (long, short) = if run.plan().long_x() {
                    (now.ahead_x, now.ahead_z)
                } else {
                    (now.ahead_z, now.ahead_x)
                };
                let angle = now.observer.predict(long);
                let point = if long == short {
                    run.tick(angle)
                } else {
                    run.tick_apart(angle, now.observer.predict(short))
                };
                self.position = point.position;
                locked = point.phase == Phase::Locked;
                offset = u32::from(point.move_index);
                match point.phase {
                    Phase::Waiting => Motion::Wait,
                    Phase::Done => {
                        self.settled = self.settled.saturating_add(1);
                        if self.settled > SETTLING {
                            self.active = Active::Free;
                        }
                        Motion::Run
                    }
                    Phase::Joining | Phase::Locked | Phase::Braking => Motion::Run,
                }
            }
        };
        Ok(Setpoint {
            position: self.position,
            motion,
            locked,
            spindle: self.spindle,
            number: number.saturating_add(offset),
            line: self.span.line,
        })
    }

    /// The pass begins (`None`: not yet) when the spindle turns as commanded, its index is known and the retract is queued.
    fn wait(&self, waited: &mut Waited, now: &Conditions<'_>) -> Result<Option<ThreadRun>, Alarm> {
        let Some(pass) = &self.pass else {
            return Err(Alarm::new(Code::SpindleNotArrived, self.span));
        };
        let speed = now.observer.speed();
        let wanted = TurnRate::of_rpm(pass.rpm);
        if !self.arrived(speed, wanted) {
            waited.speed = waited.speed.saturating_add(1);
            if waited.speed > self.arrival.speed_ticks {
                return Err(Alarm::new(Code::SpindleNotArrived, self.span).with([
                    Arg::Rpm(speed.rpm()),
                    Arg::Rpm(pass.rpm),
                    Arg::None,
                    Arg::None,
                ]));
            }
            return Ok(None);
        }
        if !now.observer.indexed() {
            // Two turns at the commanded speed and a second.
            let per_minute = self.arrival.ticks_per_minute;
            let turn = per_minute.checked_div(pass.rpm.abs()).unwrap_or(per_minute);
            let patience = turn.saturating_mul(2).saturating_add(per_minute / 60);
            waited.index = waited.index.saturating_add(1);
            if waited.index > patience {
                return Err(Alarm::new(Code::NoIndex, self.span));
            }
            return Ok(None);
        }
        if !now.more {
            return Ok(None);
        }
        // Both axes have to be in time: the one with the slower drive leaves first.
        let ahead = now.ahead_x.max(now.ahead_z);
        ThreadRun::start(pass.plan, now.observer.predict(ahead), speed).map(Some)
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

    /// True while an abort is bringing the axes to rest.
    #[must_use]
    pub const fn is_aborting(&self) -> bool {
        self.aborting && !self.is_free()
    }

    /// Where the exact helix of the pass under way stands at a spindle angle, and on which axis; `None` outside.
    #[must_use]
    pub fn helix(&self, angle: Turns) -> Option<(bool, Length)> {
        self.thread()
            .map(|run| (run.plan().long_x(), run.helix(angle)))
    }
}

/// Measured over commanded speed.
fn turning(measured: TurnRate, commanded: Rpm) -> Rate {
    let wanted = TurnRate::of_rpm(commanded).abs().raw() >> 16;
    let ratio = measured.abs().raw().checked_div(wanted.max(1)).unwrap_or(0);
    Rate::from_raw(u32::try_from(ratio).unwrap_or(u32::MAX))
}
