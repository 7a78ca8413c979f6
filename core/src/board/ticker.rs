//! The tick: one SYNC period of the whole board.
//!
//! ```text
//! inputs (encoder sample, frames since the last tick) ─► observer, drives ─► executor ─► SYNC, RPDOs
//! ```
//!
//! Knows segments, the spindle's encoder and the drives; knows nothing of calls or cycles. Bounded work: every loop runs
//! over the axes or over the frames of one period. States are a type. Where a segment begins, coming to rest,
//! rigid mode and the ways out of a stroke have files of their own.

mod anew;
mod away;
mod begin;
mod float;
mod journal;
mod rigid;
mod state;
mod stopping;
mod withheld;

use core::mem::MaybeUninit;

use heapless::Vec;

use self::journal::Journal;
use self::state::{Mode, Then};
pub use self::state::{Outcome, State};
use super::detour::{Detour, Route};
use super::drives::{Drives, FRAMES, Figures};
use super::event::{Command, Event, Switching};
use super::kept::Found;
use super::nodes::DriveNodes;
use super::operator::Operator;
use super::queue::{DetourOut, EventIn, SegmentOut, put, take};
use super::spindles::Spindle;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::Setpoints;
use crate::bus::{Frame, SyncProducer};
use crate::journal::TapRecord;
use crate::motion::{Arrival, Conditions, Cut, Epoch, Executor, Setpoint, Task, WaysOut};
use crate::params::Params;
use crate::program::{Position, TapSpindle};
use crate::signals::Signals;
use crate::spindle::{EncoderSample, Observer, SpindleEvent};
use crate::units::{Axis, Rpm, Ticks};

/// What the tick has to say to the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Forget everything and go on from here; what is planned from now on is marked with this epoch.
    Restart(Position, Epoch),
    /// Plan this way.
    Route(Route),
}

/// What one tick gives. Made once and filled in every tick: nothing as large is copied about in it.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// To be sent in this order; SYNC first.
    pub frames: Vec<Frame, FRAMES>,
    /// The setpoint, effective at the next SYNC plus the drives' latency.
    pub setpoint: Setpoint,
    /// To be stored, instead of any entry before.
    pub journal: Option<TapRecord>,
    /// For the switches of the board.
    pub switching: Switching,
    /// What all drives are told in one frame of CAN FD (9031), behind the other frames of the period.
    pub together: Option<Setpoints>,
}

/// The queues of one tick.
pub struct Ends<'a, 'q> {
    /// The program's segments.
    pub segments: &'a mut SegmentOut<'q>,
    /// The answer to a [`Route`].
    pub detours: &'a mut DetourOut<'q>,
    /// What happened.
    pub events: &'a mut EventIn<'q>,
}

/// Where the segment under way lies: at the head of its queue, until it is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Source {
    /// None is under way.
    #[default]
    None,
    /// The program.
    Program,
    /// A detour.
    Detour,
}

impl Ends<'_, '_> {
    /// The segment under way.
    fn current(&self, source: Source) -> Option<Task<'_>> {
        match source {
            Source::None => None,
            Source::Program => self.segments.peek(),
            Source::Detour => self.detours.peek().map(|segment| Task {
                segment,
                plan: None,
            }),
        }
    }
}

/// What the ways out of a pass need of it, also when it is over.
#[derive(Clone, Copy, Debug)]
struct LastPass {
    number: u32,
    span: Span,
    frozen: Option<u8>,
    ways: WaysOut,
}

/// Position mode of the spindle.
// Told by its kind: to compare it would compare what is in it.
#[derive(Clone, Copy, Debug)]
enum Rigid {
    /// Speed mode.
    Off,
    /// Coming to a stand; the move that asked for it, its line, and the ticks it has taken.
    Entering { number: u32, line: u32, ticks: u32 },
    /// In position mode: it turns with the tap axis only.
    On,
    /// Speed mode as soon as it stands.
    Leaving,
}

/// The tick side of a board.
#[derive(Debug)]
pub struct Ticker {
    mode: Mode,
    /// Percent in force; frozen inside a thread cycle.
    spindle_percent: u8,
    /// The spindle that is in position mode, or on the way.
    taps_with: TapSpindle,
    /// The encoder has slipped, and the index still stands for the old count.
    slipped: bool,
    /// Single block has stopped between two segments.
    paused: bool,
    /// Single block stops before the next segment unless that belongs to a hole.
    pauses_unless_hole: bool,
    /// A machine function is not answered yet: the next segment waits.
    awaits: bool,
    /// For the output of this tick.
    switching: Switching,
    /// The program has begun and not ended.
    in_program: bool,
    /// The drives have come up since they were last asked to: they are told where to be. Until then each holds where it is.
    is_up: bool,
    /// Where the segment under way lies.
    source: Source,
    /// Of the last segment of the program that was carried to its end.
    done: Cut,
    detour: Detour,
    /// Reset: the tool has to be brought clear of the crests.
    clearing: bool,
    /// Of the segments that count.
    epoch: Epoch,
    /// Of the way asked for last.
    route_epoch: Epoch,
    /// What was found of the stored parameters at power-up.
    found: Found,
    /// S with M03/M04, before override.
    commanded: Rpm,
    /// Position mode.
    rigid: Rigid,
    /// Ticks that leaving it has waited.
    waited: u32,
    /// Ticks it has stood on its alarm.
    stood: u32,
    operator: Operator,
    given: Given,
    observer: Observer,
    /// The last pass begun.
    pass: Option<LastPass>,
    /// Where the machine stood when the power went.
    remembered: Option<Position>,
    /// What the background has not heard yet.
    notice: Option<Notice>,
    journal: Journal,
    /// The alarm of a mode that has one: large, and not to be copied with every change of mode.
    alarm: Alarm,
    drives: Drives,
    executor: Executor,
}

/// What the parameters say.
#[derive(Clone, Copy, Debug)]
struct Given {
    /// How far ahead of the sample a setpoint takes effect, on X and on Z.
    ahead_x: Ticks,
    ahead_z: Ticks,
    arrival: Arrival,
    /// Ticks of a second.
    second: u32,
    /// Leaving position mode waits for RGTAP = 0 (5200.2).
    waits_for_rgtap: bool,
    edge_time: bool,
    hold_retracts: bool,
}

impl Given {
    /// `None` for a tick of nothing.
    fn of(params: &Params) -> Option<Self> {
        let tick_us = params.tick_us();
        let ticks_per_minute = 60_000_000_u32.checked_div(tick_us)?;
        let ramp_ms = u64::from(params.spindle_ramp_ms())
            .saturating_mul(u64::from(params.spindle_max_rpm()))
            / 1000;
        // Twice the time from rest to the greatest speed, and a second.
        let speed_ticks = ramp_ms
            .saturating_mul(2)
            .saturating_add(1000)
            .saturating_mul(u64::from(ticks_per_minute / 60))
            / 1000;
        let ahead = |axis| Ticks::one_and(params.latency_us(axis), tick_us);
        Some(Self {
            ahead_x: ahead(Axis::X),
            ahead_z: ahead(Axis::Z),
            arrival: Arrival {
                tolerance_percent: params.spindle_tolerance_percent(),
                speed_ticks: u32::try_from(speed_ticks).unwrap_or(u32::MAX),
                ticks_per_minute,
            },
            second: ticks_per_minute / 60,
            waits_for_rgtap: params.tap_wait_rgtap(),
            edge_time: params.encoder_edge_time(),
            hold_retracts: params.thread_hold_retracts(),
        })
    }
}

impl Ticker {
    /// A tick side for a parameter set; `None` where it cannot work (a scale or tick of nothing): such a set does not
    /// pass its own checks.
    #[must_use]
    pub fn new(
        params: &Params,
        remembered: Option<Position>,
        tap: Option<TapRecord>,
    ) -> Option<Self> {
        let given = Given::of(params)?;
        let figures = Figures::of(params)?;
        Some(Self::made(params, &given, &figures, remembered, tap))
    }

    /// The same, put into its place.
    pub fn put<'a>(
        place: &'a mut MaybeUninit<Self>,
        params: &Params,
        remembered: Option<Position>,
        tap: Option<TapRecord>,
    ) -> Option<&'a mut Self> {
        let figures = (Given::of(params), Figures::of(params));
        let (Some(given), Some(figures)) = &figures else {
            return None;
        };
        Some(place.write(Self::made(params, given, figures, remembered, tap)))
    }

    // Written straight to where it will be, which the caller says: as a function of
    // its own it would be copied there [D146].
    #[inline(always)]
    fn made(
        params: &Params,
        given: &Given,
        figures: &Figures,
        remembered: Option<Position>,
        tap: Option<TapRecord>,
    ) -> Self {
        Self {
            mode: Mode::Starting,
            spindle_percent: 100,
            taps_with: TapSpindle::First,
            slipped: false,
            paused: false,
            pauses_unless_hole: false,
            awaits: false,
            switching: Switching::Nothing,
            stood: 0,
            in_program: false,
            is_up: false,
            source: Source::None,
            done: Cut::NONE,
            detour: Detour::None,
            clearing: false,
            epoch: Epoch::default(),
            route_epoch: Epoch::default(),
            found: Found::default(),
            commanded: Rpm::STOPPED,
            rigid: Rigid::Off,
            waited: 0,
            operator: Operator::new(),
            given: *given,
            observer: Self::observer_of(params),
            pass: None,
            remembered,
            notice: None,
            journal: Journal::new(tap, given.second),
            // Read in a mode that has one only.
            alarm: Alarm::new(Code::EmergencyStop, Span::default()),
            drives: Drives::new(params, figures),
            executor: Executor::new(given.arrival),
        }
    }

    #[inline(never)]
    fn observer_of(params: &Params) -> Observer {
        Observer::new(
            params.encoder_counts(),
            params.observer_bandwidth_hz(),
            params.tick_us(),
        )
        .for_ramp(params.spindle_ramp_ms())
    }

    /// A program begins: until its end an empty queue is a wait, not idleness.
    pub const fn program_begins(&mut self) {
        self.in_program = true;
    }

    /// Where its drives are on the bus.
    #[must_use]
    pub const fn drive_nodes(&self) -> DriveNodes {
        self.drives.nodes()
    }

    /// What is planned in this epoch counts.
    #[must_use]
    pub const fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Takes an operator's command; it acts in the next tick.
    pub const fn command(&mut self, command: Command) {
        self.operator.take(command);
    }

    /// A machine function that has been switched is not answered yet, or is: until then no other segment begins.
    pub const fn await_machine(&mut self, awaits: bool) {
        self.awaits = awaits;
    }

    /// Ticks of a second.
    #[must_use]
    pub const fn second(&self) -> u32 {
        self.given.second
    }

    /// Sets the inputs; they act in the next tick.
    pub const fn signals(&mut self, signals: Signals) {
        self.operator.signals = signals;
    }

    /// The SYNC that the board gives, for an owner who goes on giving it while the ticker is made anew.
    pub const fn sync(&mut self) -> &mut SyncProducer {
        self.drives.sync()
    }

    /// One SYNC period. `received`: the frames since the last tick.
    pub fn tick(
        &mut self,
        sample: EncoderSample,
        received: &[Frame],
        ends: &mut Ends<'_, '_>,
        output: &mut Output,
    ) {
        for frame in received {
            self.drives.hear(frame);
        }
        self.observe(sample, ends);
        self.watch_drives(ends);
        self.obey(ends);
        self.drop_stale(ends);
        let instant = self.take_up(ends);

        let moved = !self.executor.is_free();
        let setpoint = &mut output.setpoint;
        self.execute(setpoint, ends);
        if let Some((number, line, motion)) = instant {
            (setpoint.number, setpoint.line) = (number, line);
            setpoint.motion = motion;
        }
        self.release(ends);
        let motion = setpoint.motion;
        self.settle(motion, moved, ends);
        self.keep_journal(ends, output);
        output.switching = core::mem::take(&mut self.switching);
        output.frames.clear();
        self.send(&mut output.frames, ends);
        let together = self.drives.together();
        // Nearly always there is none, and it is long.
        if together.is_some() || output.together.is_some() {
            output.together = together.copied();
        }
    }

    /// Lets a segment that is done go from the head of its queue.
    fn release(&mut self, ends: &mut Ends<'_, '_>) {
        if !self.executor.is_free() {
            return;
        }
        match core::mem::take(&mut self.source) {
            Source::None => {}
            // The pass that was left stays: it is done again.
            Source::Program if self.detour == Detour::Leaving => {}
            Source::Program => {
                if let Some(head) = ends.segments.head()
                    && !matches!(self.mode, Mode::Stopping(_))
                {
                    self.done = head.cut;
                }
                ends.segments.take();
            }
            Source::Detour => {
                take(ends.detours);
            }
        }
    }

    fn execute(&mut self, setpoint: &mut Setpoint, ends: &mut Ends<'_, '_>) {
        let conditions = Conditions {
            observer: &self.observer,
            ahead_x: self.given.ahead_x,
            ahead_z: self.given.ahead_z,
            feed: self.operator.feed(),
            rapid: self.operator.rapid(),
            hold: self.operator.hold,
            // Asked for where a stroke waits.
            more: self.executor.is_waiting()
                && self.source == Source::Program
                && ends.segments.has_second(),
        };
        let current = ends.current(self.source);
        if let Err(alarm) = self.executor.tick(&conditions, current, setpoint) {
            self.raise(&alarm, ends);
        }
    }

    fn observe(&mut self, mut sample: EncoderSample, ends: &mut Ends<'_, '_>) {
        if !self.given.edge_time {
            sample.edge_age_ns = None;
        }
        // Of one before, in a tap that is over by now.
        self.begin_new_count();
        if let Some(SpindleEvent::Slipped { counts }) = self.observer.tick(sample) {
            self.slip(counts, ends);
        }
    }

    // What happens seldom is kept out of the tick's own code, which is leaner by it [D140].

    #[cold]
    #[inline(never)]
    fn slip(&mut self, counts: i32, ends: &mut Ends<'_, '_>) {
        self.slipped = true;
        self.begin_new_count();
        let alarm = Alarm::of(Code::IndexSlipped, &[Arg::Int(i64::from(counts))]);
        let in_cycle = self.executor.stops().frozen.is_some()
            && matches!(self.mode, Mode::Running | Mode::Held);
        if in_cycle || self.executor.thread().is_some() || self.executor.is_floating() {
            self.raise(&alarm, ends);
        } else {
            emit(ends.events, Event::Warning(alarm));
        }
    }

    fn watch_drives(&mut self, ends: &mut Ends<'_, '_>) {
        match self.mode {
            Mode::Alarm | Mode::Stopping(Then::Alarm) => {
                self.drives.let_go(self.mode == Mode::Alarm);
                return;
            }
            Mode::Starting if self.drives.enable() => self.come_up(ends),
            _ => {}
        }
        if let Some(alarm) = self.drives.failure() {
            self.raise(&alarm, ends);
        }
    }

    /// The drives are enabled.
    #[cold]
    #[inline(never)]
    fn come_up(&mut self, ends: &mut Ends<'_, '_>) {
        emit(ends.events, Event::Ready);
        let mut position = self.drives.position(self.remembered.take());
        self.place_tap(&mut position, ends);
        self.executor.set_position(position);
        self.restart(position);
        self.mode = Mode::Idle;
        self.is_up = true;
        self.tell_found(ends);
    }

    fn obey(&mut self, ends: &mut Ends<'_, '_>) {
        if self.operator.asks() {
            self.act(ends);
        }
        if self.operator.hold && self.given.hold_retracts {
            self.leave_stroke(ends);
        }
    }

    /// Carries out what the operator asks for: stop, reset, resume, in this order.
    #[cold]
    #[inline(never)]
    fn act(&mut self, ends: &mut Ends<'_, '_>) {
        if let Some(code) = self.operator.takes_stop() {
            self.raise(&Alarm::new(code, Span::default()), ends);
        }
        if self.operator.has_trouble() {
            self.suffer(ends);
        }
        if self.operator.reset_waits() {
            self.reset(ends);
        }
        if self.operator.takes_resume() {
            self.operator.hold = false;
            self.paused = false;
            if self.detour == Detour::AtHome
                && let Some(pass) = &self.pass
            {
                self.detour = Detour::Back;
                let start = pass.ways.start;
                self.route([Some(start), None]);
            }
        }
    }

    fn send(&mut self, frames: &mut Vec<Frame, FRAMES>, ends: &mut Ends<'_, '_>) {
        // Frozen in a thread cycle, also while a reset leaves it.
        self.spindle_percent = match self.mode {
            Mode::Running | Mode::Held | Mode::Stopping(_) => self.executor.stops().frozen,
            Mode::Starting | Mode::Idle | Mode::Alarm => None,
        }
        .unwrap_or(self.operator.spindle_percent());
        let velocity = self.velocity();
        self.leave_rigid();
        let spindle = match self.executor.spindle() {
            Some(angle) => Spindle::Angle(angle),
            None => Spindle::Speed(velocity),
        };
        let position = self.executor.position();
        let beyond = self.drives.send(position, self.is_up, spindle, frames);
        if let Some(axis) = beyond {
            let args = [Arg::Letter(axis.letter()), Arg::None, Arg::None, Arg::None];
            let alarm = Alarm::new(Code::BeyondDriveRange, Span::default()).with(args);
            self.raise(&alarm, ends);
        }
    }
}

/// A reader that does not keep up loses the newest events, not the machine its tick; states and alarms are also in the
/// tick's output.
fn emit(events: &mut EventIn<'_>, event: Event) {
    // Full: nothing to be done, the queue is bounded and the tick does not wait.
    let _ = put(events, event);
}
