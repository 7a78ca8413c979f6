//! The executor: it turns one segment after another into one setpoint per tick.
//!
//! The executor knows planned segments, the angle of the spindle and the operator's overrides and feed hold. It knows
//! nothing of moves, program text, drives or frames. A tick is constant work: it begins at most one segment.
//!
//! A planned segment is large. It stays at the head of its queue until it is done. The caller of the executor passes
//! the same segment in every tick; the executor itself keeps only the state that changes [D104].

mod aside;
mod float;
mod joined;
mod pass;

use super::flow::Stretch;
use super::plan::{Scaling, Timed};
use super::rate::{PathRate, Rate};
use super::run::Run;
use super::segment::{Action, Plan, Stops, Task};
use super::tap::{FloatRun, Tap, TapLine, TapRun};
use super::thread::{Helix, Retract, ThreadRun};
use super::turn::{Orientation, TurnRun};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::Position;
use crate::spindle::{Learner, Observer};
use crate::units::{Divisor, Length, Rpm, Ticks, TurnRate, Turns};
pub use aside::Aside;
use pass::{Followers, Stroke, Waited};

/// A rapid that leads out of a groove, at the lowest override.
const LEAST_RAPID: Rate = Rate::percent(25);

/// The inputs of one tick of motion.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// The observer that tells the angle of the spindle.
    pub observer: &'a Observer,
    /// What a pass on the lead follows instead, where the encoder has few counts.
    pub learner: Option<&'a Learner>,
    /// Time from the sample to the instant at which an X setpoint takes effect.
    pub ahead_x: Ticks,
    /// The same for Z.
    pub ahead_z: Ticks,
    /// Feed override.
    pub feed: Rate,
    /// Rapid override, at most [`Rate::FULL`].
    pub rapid: Rate,
    /// The operator asks for feed hold.
    pub hold: bool,
    /// True when the segment after the stroke (its retract) is in the queue, so that the stroke may begin. Only matters
    /// while a pass [waits](Executor::is_waiting).
    pub more: bool,
    /// Single block is on.
    pub single: bool,
    /// The next stretch of joined cuts. Once it [was taken](Executor::has_taken), the caller removes it from its queue.
    pub stretch: Option<&'a Stretch>,
    /// What no hold stops leads out of the work: it is not the way back into a thread.
    pub leads_out: bool,
}

impl Conditions<'_> {
    /// What operator and spindle multiply a programmed rate by.
    fn rate(&self, scaling: Scaling) -> Rate {
        match scaling {
            Scaling::Rapid => self.rapid,
            Scaling::Feed => self.feed,
            Scaling::Turns(commanded) => self.feed.times(turning(self.observer.speed(), commanded)),
        }
    }
}

/// The condition of the spindle for a stroke, and the longest wait for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// The spindle has arrived when its measured speed is within this many per cent of the commanded speed.
    pub tolerance_percent: u8,
    /// Ticks the spindle may take to arrive.
    pub speed_ticks: u32,
    /// Ticks in a minute.
    pub ticks_per_minute: u32,
}

impl Arrival {
    /// The longest wait for the index at a speed: two turns and a second, in ticks.
    pub(super) fn index_ticks(&self, rpm: Rpm) -> u32 {
        let per_minute = self.ticks_per_minute;
        let turn = per_minute.checked_div(rpm.abs()).unwrap_or(per_minute);
        turn.saturating_mul(2).saturating_add(per_minute / 60)
    }

    /// Counts the ticks in which the spindle does not turn as it must. `trouble` holds the alarm code and the patience
    /// for it: this part of a second (100 means a hundredth). Returns the code once the trouble has lasted longer than
    /// that.
    pub(super) fn count_astray(
        &self,
        astray: &mut u32,
        trouble: Option<(Code, u32)>,
    ) -> Option<Code> {
        let Some((code, part)) = trouble else {
            *astray = 0;
            return None;
        };
        let patience = (self.ticks_per_minute / 60).checked_div(part).unwrap_or(0);
        *astray = astray.saturating_add(1);
        if *astray <= patience {
            return None;
        }
        *astray = 0;
        Some(code)
    }
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

/// The setpoint of a tick and the move to which it belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Machine position.
    pub position: Position,
    /// What the axes are doing.
    pub motion: Motion,
    /// True when the long axis is held to the helix, or axis and spindle to the tap's master.
    pub locked: bool,
    /// Commanded angle of the spindle while it is in position mode.
    pub spindle: Option<Turns>,
    /// Number of the move; 0 where nothing executes.
    pub number: u32,
    /// Line of the move's block; 0 where nothing executes.
    pub line: u32,
}

/// The law by which an axis follows the spindle.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    /// The exact helix of a threading pass.
    Thread(Helix),
    /// The line of a rigid tap.
    Tap(TapLine),
    /// The line that an ordinary tap follows.
    Float(TapLine),
}

#[derive(Clone, Copy, Debug)]
enum Active {
    Free,
    Timed,
    /// Cuts that are joined.
    Joined,
    /// A pass waits for the spindle before it begins.
    Waiting(Waited),
    Thread(Stroke),
    Tap(TapRun),
    /// An ordinary tap, and the speed that it commands the spindle, from its first tick on.
    Float(FloatRun, Option<TurnRate>),
    Dwell(u32),
    /// The spindle turns to an angle, and no axis moves.
    Turn(TurnRun),
}

/// The one long-lived executor of a machine.
#[derive(Clone, Debug)]
pub struct Executor {
    active: Active,
    position: Position,
    /// Commanded spindle angle, in position mode.
    spindle: Option<Turns>,
    number: u32,
    span: Span,
    arrival: Arrival,
    stops: Stops,
    aborting: bool,
    /// True when a stroke of a tap has ended in this tick.
    turned: bool,
    /// True when the next stretch was taken in this tick.
    taken: bool,
    /// True when the tool has passed the end of a joined cut in this tick.
    crossed: bool,
    /// What the axes of a pass go after, if the spindle's angle is learned.
    followers: Option<Followers>,
    /// Where a feed per turn stands with its spindle, and for how many ticks.
    stalled: (Position, u32),
    run: Run,
}

impl Executor {
    const ZERO: Position = Position {
        x: Length::ZERO,
        z: Length::ZERO,
        c: crate::units::Angle::ZERO,
    };

    const NOWHERE: Span = Span {
        line: 0,
        column: 0,
        end: 0,
    };

    /// An executor at rest at the machine's zero.
    // Inlined so that it writes straight into the caller's place; the result of a separate function would be copied
    // there [D146].
    #[must_use]
    #[inline(always)]
    pub const fn new(arrival: Arrival) -> Self {
        Self {
            run: Run::new(),
            active: Active::Free,
            position: Self::ZERO,
            spindle: None,
            number: 0,
            span: Self::NOWHERE,
            stops: Stops::NONE,
            arrival,
            aborting: false,
            turned: false,
            taken: false,
            crossed: false,
            followers: None,
            stalled: (Self::ZERO, 0),
        }
    }

    /// Resets in place to the state of [`new`](Self::new): the motion under way and the position are forgotten.
    pub const fn begin_anew(&mut self, arrival: Arrival) {
        let Self {
            run,
            active,
            position,
            spindle,
            number,
            span,
            stops,
            arrival: expected,
            aborting,
            turned,
            taken,
            crossed,
            followers,
            stalled,
        } = self;
        run.begin_anew();
        *active = Active::Free;
        *position = Self::ZERO;
        *spindle = None;
        (*number, *span, *stops) = (0, Self::NOWHERE, Stops::NONE);
        *expected = arrival;
        (*aborting, *turned) = (false, false);
        (*taken, *crossed) = (false, false);
        *followers = None;
        *stalled = (Self::ZERO, 0);
    }

    /// Sets the position at which the machine stands. Has an effect only while nothing is under way.
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

    /// True when the next segment may begin.
    #[must_use]
    pub const fn is_free(&self) -> bool {
        matches!(self.active, Active::Free)
    }

    /// The operator's stops that the segment under way, or the last one of the program, allows.
    #[must_use]
    pub const fn stops(&self) -> Stops {
        self.stops
    }

    /// Nothing that moved last counts any more: this is what the operator's stops may do now.
    pub const fn tell_stops(&mut self, stops: Stops) {
        if self.is_free() {
            self.stops = stops;
        }
    }

    /// The threading pass under way.
    #[must_use]
    pub const fn thread(&self) -> Option<&ThreadRun> {
        match &self.active {
            Active::Thread(stroke) => Some(&stroke.run),
            _ => None,
        }
    }

    /// True while a pass waits for its spindle and for the segment after the pass.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        matches!(self.active, Active::Waiting(_))
    }

    /// True while a pass waits or is under way.
    #[must_use]
    pub const fn is_on_the_lead(&self) -> bool {
        matches!(self.active, Active::Waiting(_) | Active::Thread(_))
    }

    /// True while joined cuts are under way.
    #[must_use]
    pub const fn is_joined(&self) -> bool {
        matches!(self.active, Active::Joined)
    }

    /// True while a rigid tap is under way.
    #[must_use]
    pub const fn is_tapping(&self) -> bool {
        matches!(self.active, Active::Tap(_))
    }

    /// True while the spindle turns to an angle.
    #[must_use]
    pub const fn is_orienting(&self) -> bool {
        matches!(self.active, Active::Turn(_))
    }

    /// The law by which an axis follows the spindle in the segment under way (`current`); `None` if no axis follows the
    /// spindle.
    #[must_use]
    pub fn law(&self, current: Option<Task<'_>>) -> Option<Law> {
        Some(match (&self.active, current?.plan?) {
            (Active::Thread(stroke), Plan::Thread(pass)) => {
                Law::Thread(stroke.run.helix(&pass.plan))
            }
            (Active::Tap(run), Plan::Tap(tap)) => Law::Tap(run.line(tap)),
            (Active::Float(run, _), Plan::Float(plan)) => Law::Float(run.line(plan)?),
            _ => return None,
        })
    }

    /// True if a stroke of a tap ended in the last tick.
    #[must_use]
    pub const fn has_turned(&self) -> bool {
        self.turned
    }

    /// Commanded spindle angle, in position mode.
    #[must_use]
    pub const fn spindle(&self) -> Option<Turns> {
        self.spindle
    }

    /// Tells that the spindle stands at `angle` in position mode, or (`None`) is in speed mode again. Has no effect
    /// while a tap is under way, or the spindle turns to an angle.
    pub const fn set_spindle(&mut self, angle: Option<Turns>) {
        if !self.is_tapping() && !self.is_orienting() {
            self.spindle = angle;
        }
    }

    /// Begins a segment of motion; the board itself executes commands and marks. Ignored while another segment is under
    /// way.
    pub fn begin(&mut self, task: Task<'_>) {
        if !self.is_free() {
            return;
        }
        let segment = task.segment;
        self.number = segment.number;
        self.span = segment.span;
        self.stops = segment.stops;
        self.aborting = false;
        match (&segment.action, task.plan) {
            (Action::Timed(timed), _) if self.run.begin(timed) => {
                self.active = match timed.rounding {
                    None => Active::Timed,
                    Some(_) => Active::Joined,
                };
            }
            (Action::Planned, Some(Plan::Thread(_))) => {
                self.active = Active::Waiting(Waited::default());
                self.followers = None;
            }
            (Action::Planned, Some(Plan::Tap(tap))) => {
                if let Some(angle) = self.spindle
                    && !tap.is_empty()
                {
                    self.active = Active::Tap(TapRun::new(tap, self.position, angle));
                }
            }
            (Action::Planned, Some(Plan::Float(plan))) => {
                self.active = Active::Float(FloatRun::new(plan, self.position), None);
            }
            (Action::Dwell(ticks), _) => self.active = Active::Dwell(*ticks),
            _ => {}
        }
    }

    /// Begins to turn the spindle, which stands in position mode, by `way`: for the move `number`. Ignored while a segment
    /// is under way.
    #[cold]
    #[inline(never)]
    pub fn begin_turn(&mut self, way: Turns, by: &Orientation, number: u32, span: Span) {
        let Some(from) = self.spindle.filter(|_| self.is_free()) else {
            return;
        };
        (self.number, self.span, self.stops) = (number, span, Stops::NONE);
        self.aborting = false;
        match TurnRun::begin(from, way, by, &mut self.run) {
            Some(turn) => self.active = Active::Turn(turn),
            // Less than a length of a nanometre.
            None if way.raw().unsigned_abs() < 4 => self.spindle = Some(from + way),
            None => {}
        }
    }

    /// Reports the segment that has just begun as part of another segment: a way out of a pass and back belongs to the
    /// pass.
    pub const fn tell_as(&mut self, number: u32, span: Span, frozen: Option<u8>) {
        self.number = number;
        self.span = span;
        self.stops.frozen = frozen;
    }

    /// Emergency stop: the segment under way (`current`) comes to rest on its path, both axes of a synchronised move
    /// together [D18]. The rest of the segment is forgotten.
    pub fn stop(&mut self, current: Option<Task<'_>>) {
        self.aborting = true;
        // The tick asks again, if the way to rest still leads on.
        self.crossed = false;
        match (&mut self.active, current.and_then(Task::pass)) {
            (Active::Free, _) => {}
            (Active::Timed | Active::Joined | Active::Turn(_), _) => self.run.abandon(),
            (Active::Thread(stroke), Some(pass)) => stroke.run.stop(&pass.plan),
            (Active::Tap(tap), _) => {
                if tap.stop(&mut self.run) {
                    self.active = Active::Free;
                }
            }
            (Active::Float(run, _), _) => {
                if run.stop() {
                    self.active = Active::Free;
                }
            }
            (Active::Waiting(_) | Active::Dwell(_) | Active::Thread(_), _) => {
                self.active = Active::Free;
            }
        }
    }

    /// For reset, and for feed hold with immediate retract. The short axis leaves a stroke along the run-out's slope
    /// towards `target` while the long axis stays in lead. Any other motion stops as by [`stop`](Self::stop).
    pub fn retract(&mut self, current: Option<Task<'_>>, target: Length) -> Retract {
        if let Active::Thread(stroke) = &mut self.active
            && let Some(pass) = current.and_then(Task::pass)
        {
            self.aborting = true;
            self.crossed = false;
            return stroke.run.retract(&pass.plan, target);
        }
        self.stop(current);
        Retract::Standing
    }

    /// Runs one tick and writes its setpoint. `current` is the segment that was begun, until the executor
    /// [is free](Self::is_free) again.
    ///
    /// # Errors
    /// The spindle does not do what a stroke needs: [`NoIndex`](crate::alarm::Code::NoIndex),
    /// [`SpindleNotArrived`](crate::alarm::Code::SpindleNotArrived), and the errors of [`ThreadRun::start`]. The
    /// setpoint of such a tick is then the first on the way to rest; [`stop`](Self::stop) continues this way.
    pub fn tick(
        &mut self,
        now: &Conditions<'_>,
        current: Option<Task<'_>>,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        self.turned = false;
        setpoint.motion = Motion::Idle;
        setpoint.locked = false;
        setpoint.number = 0;
        setpoint.line = 0;
        let done = self.advance(now, current, setpoint);
        setpoint.position = self.position;
        setpoint.spindle = self.spindle;
        done
    }

    /// One tick of the segment under way. Writes what the axes are doing into the setpoint; writes nothing if no
    /// segment is under way.
    fn advance(
        &mut self,
        now: &Conditions<'_>,
        current: Option<Task<'_>>,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        let Some(Task { segment, plan }) = current else {
            return self.stand(now, setpoint);
        };
        match (&self.active, &segment.action, plan) {
            (Active::Timed, Action::Timed(timed), _) => self.move_on(now, timed, setpoint),
            (Active::Joined, Action::Timed(timed), _) => self.flow_on(now, timed, setpoint),
            (Active::Tap(_), _, Some(Plan::Tap(tap))) => {
                self.tap_on(now, tap, setpoint);
                Ok(())
            }
            (Active::Float(..), _, Some(Plan::Float(plan))) => self.float_on(now, plan, setpoint),
            (Active::Waiting(_), _, Some(Plan::Thread(pass))) => self.wait(now, pass, setpoint),
            (Active::Thread(_), _, Some(Plan::Thread(pass))) => {
                self.cut_on(now, &pass.plan, setpoint)
            }
            _ => self.stand(now, setpoint),
        }
    }

    /// A tick of a dwell, or of no motion of an axis at all. Also frees the executor if `current` is not the segment that
    /// was begun, which cannot happen.
    fn stand(&mut self, now: &Conditions<'_>, setpoint: &mut Setpoint) -> Result<(), Alarm> {
        let Active::Dwell(left) = &mut self.active else {
            if let Active::Turn(turn) = self.active {
                self.turn_on(turn, setpoint);
            } else {
                self.active = Active::Free;
            }
            return Ok(());
        };
        let motion = if now.hold {
            Motion::Hold
        } else {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.active = Active::Free;
            }
            Motion::Dwell
        };
        self.tell(setpoint, motion);
        Ok(())
    }

    /// A tick of a spindle that turns to its angle. No feed hold acts on it, as none does on M03.
    #[cold]
    #[inline(never)]
    fn turn_on(&mut self, turn: TurnRun, setpoint: &mut Setpoint) {
        let (angle, done) = turn.tick(&mut self.run, self.aborting);
        self.spindle = Some(angle);
        if done {
            self.active = Active::Free;
        }
        self.tell(setpoint, Motion::Wait);
    }

    /// Writes into the setpoint what the axes are doing, and for which move.
    fn tell(&self, setpoint: &mut Setpoint, motion: Motion) {
        setpoint.motion = motion;
        setpoint.number = self.number;
        setpoint.line = self.span.line;
    }

    /// A tick of a tap.
    fn tap_on(&mut self, now: &Conditions<'_>, tap: &Tap, setpoint: &mut Setpoint) {
        let Active::Tap(run) = &mut self.active else {
            return;
        };
        let hold = now.hold && !self.stops.hold_not_inside && !self.aborting;
        let rate = if tap.feed_override {
            now.feed
        } else {
            Rate::FULL
        };
        let point = run.tick(tap, &mut self.run, &mut self.position, rate, hold);
        self.spindle = Some(point.angle);
        self.turned = point.turned;
        if point.done {
            self.active = Active::Free;
        }
        self.tell(setpoint, point.motion);
        setpoint.locked = true;
        setpoint.number = self.number.saturating_add(point.offset);
    }

    /// A tick of a move that is driven by time.
    fn move_on(
        &mut self,
        now: &Conditions<'_>,
        timed: &Timed,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        let hold = now.hold && !self.stops.hold_not_inside;
        let rate = if hold {
            Rate::HOLD
        } else {
            now.rate(timed.scaling)
        };
        // A low override would leave the tool in a groove: the way out is made all the same [D575].
        let goes_on = self.stops.hold_not_inside && timed.scaling == Scaling::Rapid;
        let rate = if goes_on && now.leads_out {
            rate.max(LEAST_RAPID)
        } else {
            rate
        };
        let step = self.run.tick(rate, timed);
        self.moved(now, timed, hold, step.done, setpoint)
    }

    /// The run has made its tick.
    #[inline]
    fn moved(
        &mut self,
        now: &Conditions<'_>,
        timed: &Timed,
        hold: bool,
        done: bool,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        self.position = self.run.position();
        if done {
            self.active = Active::Free;
        }
        let is_still = self.run.at_rest() && !done;
        let motion = match hold && is_still {
            true => Motion::Hold,
            false => Motion::Run,
        };
        self.tell(setpoint, motion);
        if is_still && !hold {
            let (_, scaling) = self.asks_for(timed, now.stretch);
            return self.await_turns(now, scaling);
        }
        Ok(())
    }

    /// The rate and the scaling by which the motion under way (`timed`) goes next. Of joined cuts that is not always the
    /// cut in which the tool is.
    #[must_use]
    pub fn asks_for(&self, timed: &Timed, next: Option<&Stretch>) -> (PathRate, Scaling) {
        match self.active {
            Active::Joined => self.run.asks_for(next),
            _ => (timed.nominal, timed.scaling),
        }
    }

    /// A feed per turn stands while the spindle stands, but no longer than a stroke waits for it [D46].
    #[cold]
    #[inline(never)]
    fn await_turns(&mut self, now: &Conditions<'_>, scaling: Scaling) -> Result<(), Alarm> {
        let Scaling::Turns(commanded) = scaling else {
            return Ok(());
        };
        if now.observer.is_turning() || self.stalled.0 != self.position {
            self.stalled = (self.position, 0);
            return Ok(());
        }
        let (_, ticks) = &mut self.stalled;
        *ticks = ticks.saturating_add(1);
        if *ticks <= self.arrival.speed_ticks {
            return Ok(());
        }
        self.stalled = (self.position, 0);
        // 2⁻¹⁶ turns per second, to the nearest.
        let rpm = u64::from(commanded.get())
            .saturating_mul(60)
            .saturating_add(1 << 15)
            >> 16;
        let rpm = Rpm::new(i32::try_from(rpm).unwrap_or(i32::MAX));
        let figures = [now.observer.speed().rpm(), rpm].map(Arg::Rpm);
        Err(Alarm::new(Code::SpindleNotArrived, self.span).with(figures))
    }

    /// True while an abort is bringing the axes to rest.
    #[must_use]
    pub const fn is_aborting(&self) -> bool {
        self.aborting && !self.is_free()
    }
}

/// A rate at an override of 100 %, at the measured speed of the spindle.
#[must_use]
pub fn programmed(nominal: PathRate, scaling: Scaling, observer: &Observer) -> PathRate {
    match scaling {
        Scaling::Rapid | Scaling::Feed => nominal,
        Scaling::Turns(commanded) => turning(observer.speed(), commanded).of(nominal),
    }
}

/// Measured speed divided by commanded speed.
fn turning(measured: TurnRate, commanded: Divisor) -> Rate {
    let (ratio, _) = commanded.divide(measured.abs().raw() as u64);
    Rate::from_raw(u32::try_from(ratio).unwrap_or(u32::MAX))
}
