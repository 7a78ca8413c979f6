//! The tick: one SYNC period of the whole board.
//!
//! ```text
//! inputs (encoder sample, frames since the last tick) ─► observer, drive masters ─► executor ─► SYNC, RPDOs
//! ```
//!
//! Knows segments, the spindle's encoder and the drives' masters; knows nothing of calls or cycles. Bounded work: every
//! loop runs over the axes or over the frames of one period. States are a type; every change goes through one function.

use heapless::Vec;

use super::background::{AXES, overridden};
use super::event::{Command, Event};
use super::queue::{EventIn, SegmentOut, put, take};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::{
    DriveConfig, DriveMaster, FollowingLimit, Frame, Increments, MilliRpm, NodeId, Periods, Scale,
    SpindleMaster, SyncProducer,
};
use crate::motion::{Action, Arrival, Conditions, Executor, Motion, Rate, Segment, Setpoint};
use crate::params::Params;
use crate::program::Position;
use crate::spindle::{EncoderSample, Observer, SpindleEvent};
use crate::units::{Angle, Axis, Length, Rpm, Ticks};

/// Frames a board sends in one period at most: SYNC, and for each of four drives a start, an RPDO1 and an RPDO2.
pub const FRAMES: usize = 16;

/// Where the machine is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// The drives are being enabled.
    Starting,
    /// Enabled, and nothing to do.
    Idle,
    /// Carrying out segments.
    Running,
    /// At rest by feed hold or single block.
    Held,
    /// Coming to rest after an alarm, an emergency stop or a reset.
    Stopping(Outcome),
    /// At rest after an alarm, until reset.
    Alarm(Alarm),
}

/// What a stop ends in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Ready again.
    Reset,
    /// Latched.
    Alarm(Alarm),
}

/// What one tick gives.
#[derive(Clone, Debug)]
pub struct Output {
    /// To be sent in this order; SYNC first.
    pub frames: Vec<Frame, FRAMES>,
    /// The setpoint, effective at the next SYNC plus the drives' latency.
    pub setpoint: Setpoint,
    /// Where the machine is.
    pub state: State,
    /// The background must start afresh from here: what was queued is forgotten.
    pub restart: Option<Position>,
}

/// The operator's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    hold: bool,
    single_block: bool,
    feed: u8,
    rapid: u8,
    spindle: u8,
    wish: Option<Wish>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wish {
    Reset,
    Stop,
}

impl Operator {
    const NEW: Self = Self {
        hold: false,
        single_block: false,
        feed: 100,
        rapid: 100,
        spindle: 100,
        wish: None,
    };

    /// Single block is on.
    #[must_use]
    pub const fn single_block(&self) -> bool {
        self.single_block
    }

    /// Spindle override in percent.
    #[must_use]
    pub const fn spindle_percent(&self) -> u8 {
        self.spindle
    }
}

/// The tick side of a board.
#[derive(Debug)]
pub struct Ticker {
    state: State,
    operator: Operator,
    executor: Executor,
    observer: Observer,
    sync: SyncProducer,
    axes: [DriveMaster; 3],
    scales: [Scale; 3],
    spindle_drive: SpindleMaster,
    /// Where the machine stood when the power went, if its drives agree.
    remembered: Option<Position>,
    ahead: [Ticks; 3],
    /// S with M03/M04, before override.
    commanded: Rpm,
    /// Percent in force; frozen inside a thread cycle.
    spindle_percent: u8,
    /// Single block or feed hold has stopped between two segments.
    paused: bool,
    /// The program has not ended.
    in_program: bool,
    thread_clearance: Length,
    edge_time: bool,
}

impl Ticker {
    /// A tick side for a parameter set; `None` where it cannot work (an encoder, scale or tick of nothing): such a set
    /// does not pass its own checks.
    #[must_use]
    pub fn new(params: &Params, remembered: Option<Position>) -> Option<Self> {
        let tick_us = params.tick_us();
        let step = Periods::from_ms(params.drive_time_ms(), tick_us)?;
        let scale = |axis| Scale::new(params.drive_numerator(axis), params.drive_denominator(axis));
        let scales = [scale(Axis::X)?, scale(Axis::Z)?, scale(Axis::C)?];
        let [scale_x, scale_z, scale_c] = scales;
        let config = |letter, node, scale: Scale, following| DriveConfig {
            letter,
            node,
            scale,
            step,
            // A status comes every fourth SYNC.
            silence: Periods::new(12),
            following,
        };
        let master = |letter, node, scale, following| {
            DriveMaster::new(config(letter, node, scale, following))
        };
        let following = |axis, scale: Scale| {
            Some(FollowingLimit {
                increments: scale.limit(params.following_error_limit(axis)),
                time: Periods::from_ms(params.following_error_ms(), tick_us)?,
            })
        };
        let ticks_per_minute = 60_000_000_u32.checked_div(tick_us)?;
        let ramp_ms = u64::from(params.spindle_ramp_ms())
            .saturating_mul(u64::from(params.spindle_max_rpm()))
            / 1000;
        let second = u64::from(ticks_per_minute / 60);
        // Twice the time from rest to the greatest speed, and a second.
        let speed_ticks = ramp_ms
            .saturating_mul(2)
            .saturating_add(1000)
            .saturating_mul(second)
            / 1000;
        let ahead = |axis| Ticks::one_and(params.latency_us(axis), tick_us);
        Some(Self {
            state: State::Starting,
            operator: Operator::NEW,
            executor: Executor::new(Arrival {
                tolerance_percent: params.spindle_tolerance_percent(),
                speed_ticks: u32::try_from(speed_ticks).unwrap_or(u32::MAX),
                ticks_per_minute,
            }),
            observer: Observer::new(
                params.encoder_counts(),
                params.observer_bandwidth_hz(),
                tick_us,
            ),
            sync: SyncProducer::new(),
            axes: [
                master(b'X', NodeId::DRIVE_X, scale_x, following(Axis::X, scale_x)),
                master(b'Z', NodeId::DRIVE_Z, scale_z, following(Axis::Z, scale_z)),
                master(b'C', NodeId::DRIVE_C, scale_c, following(Axis::C, scale_c)),
            ],
            scales,
            spindle_drive: SpindleMaster::new(config(b'S', NodeId::SPINDLE_1, scale_c, None)),
            remembered,
            ahead: [ahead(Axis::X), ahead(Axis::Z), ahead(Axis::C)],
            commanded: Rpm::STOPPED,
            spindle_percent: 100,
            paused: false,
            in_program: false,
            thread_clearance: params.thread_clearance(),
            edge_time: params.encoder_edge_time(),
        })
    }

    /// Where the machine is.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The operator's settings.
    #[must_use]
    pub const fn operator(&self) -> &Operator {
        &self.operator
    }

    /// The executor, for what it can tell.
    #[must_use]
    pub const fn executor(&self) -> &Executor {
        &self.executor
    }

    /// The spindle, as observed.
    #[must_use]
    pub const fn observer(&self) -> &Observer {
        &self.observer
    }

    /// A program begins: until its end an empty queue is a wait, not idleness.
    pub const fn program_begins(&mut self) {
        self.in_program = true;
    }

    /// Takes an operator's command; it acts in the next tick.
    pub const fn command(&mut self, command: Command) {
        let operator = &mut self.operator;
        match command {
            Command::Hold => operator.hold = true,
            Command::Resume => {
                operator.hold = false;
                self.paused = false;
            }
            // A stop is not undone by a reset that comes before it has acted.
            Command::Reset if operator.wish.is_none() => operator.wish = Some(Wish::Reset),
            Command::Reset => {}
            Command::Stop => operator.wish = Some(Wish::Stop),
            Command::SingleBlock(on) => operator.single_block = on,
            Command::FeedOverride(percent) => operator.feed = at_most(percent, 150),
            Command::RapidOverride(percent) => operator.rapid = at_most(percent, 100),
            Command::SpindleOverride(percent) => {
                operator.spindle = if percent < 50 {
                    50
                } else {
                    at_most(percent, 120)
                };
            }
        }
    }

    /// One SYNC period. `received`: the frames since the last tick.
    pub fn tick(
        &mut self,
        sample: EncoderSample,
        received: &[Frame],
        segments: &mut SegmentOut<'_>,
        events: &mut EventIn<'_>,
    ) -> Output {
        for frame in received {
            self.hear(frame);
        }
        self.observe(sample, events);
        self.watch_drives(events);
        self.obey(events);
        let instant = self.take_up(segments, events);

        let [ahead_x, ahead_z, _] = self.ahead;
        let conditions = Conditions {
            observer: &self.observer,
            ahead_x,
            ahead_z,
            feed: Rate::percent(self.operator.feed),
            rapid: Rate::percent(self.operator.rapid),
            hold: self.operator.hold,
            more: segments.ready(),
        };
        let moved = !self.executor.is_free();
        let mut setpoint = match self.executor.tick(&conditions) {
            Ok(setpoint) => setpoint,
            Err(alarm) => {
                self.raise(alarm, events);
                Setpoint {
                    position: self.executor.position(),
                    ..Setpoint::default()
                }
            }
        };
        if let Some((number, line)) = instant {
            (setpoint.number, setpoint.line) = (number, line);
            setpoint.motion = Motion::Run;
        }
        let restart = self.settle(&setpoint, moved, segments, events);
        let mut frames = Vec::new();
        self.send(&mut frames, events);
        Output {
            frames,
            setpoint,
            state: self.state,
            restart,
        }
    }

    fn hear(&mut self, frame: &Frame) {
        for drive in &mut self.axes {
            if drive.receive(frame) {
                return;
            }
        }
        self.spindle_drive.drive_mut().receive(frame);
    }

    fn observe(&mut self, mut sample: EncoderSample, events: &mut EventIn<'_>) {
        if !self.edge_time {
            sample.edge_age_ns = None;
        }
        if let Some(SpindleEvent::Slipped { counts }) = self.observer.tick(sample)
            && self.executor.thread().is_some()
        {
            let args = [Arg::Int(i64::from(counts)), Arg::None, Arg::None, Arg::None];
            self.raise(
                Alarm::new(Code::IndexSlipped, Span::default()).with(args),
                events,
            );
        }
    }

    fn watch_drives(&mut self, events: &mut EventIn<'_>) {
        if self.state == State::Starting {
            let mut enabled = true;
            for drive in self.axes.iter_mut().chain([self.spindle_drive.drive_mut()]) {
                // A failure stays latched until reset; it is raised below.
                let asked = drive.enable();
                enabled &= asked.is_ok() && drive.is_enabled();
            }
            if enabled {
                self.ready(events);
                return;
            }
        }
        if matches!(
            self.state,
            State::Alarm(_) | State::Stopping(Outcome::Alarm(_))
        ) {
            return;
        }
        let failed = self
            .axes
            .iter()
            .chain([self.spindle_drive.drive()])
            .find_map(DriveMaster::alarm);
        if let Some(alarm) = failed {
            self.raise(alarm, events);
        }
    }

    /// All drives hold their positions: the board takes these over, to the nanometre where it remembers them.
    fn ready(&mut self, events: &mut EventIn<'_>) {
        let [x, z, c] = &self.axes;
        let [scale_x, scale_z, scale_c] = &self.scales;
        let read = Position {
            x: Length::from_nm(scale_x.position(x.target())),
            z: Length::from_nm(scale_z.position(z.target())),
            c: Angle::from_udeg(scale_c.position(c.target())),
        };
        let position = match self.remembered.take() {
            Some(remembered) if self.demands(remembered) == self.demands(read) => remembered,
            _ => read,
        };
        self.executor.set_position(position);
        self.state = State::Idle;
        emit(events, Event::Ready);
    }

    /// An alarm: the axes come to rest on their path, and what is queued is forgotten. The first one stays.
    fn raise(&mut self, alarm: Alarm, events: &mut EventIn<'_>) {
        match self.state {
            State::Alarm(_) | State::Stopping(Outcome::Alarm(_)) => return,
            _ => {}
        }
        self.executor.stop();
        self.commanded = Rpm::STOPPED;
        self.state = State::Stopping(Outcome::Alarm(alarm));
        emit(events, Event::Alarm(alarm));
    }

    fn obey(&mut self, events: &mut EventIn<'_>) {
        match self.operator.wish.take() {
            None => {}
            Some(Wish::Stop) => {
                self.raise(Alarm::new(Code::EmergencyStop, Span::default()), events);
            }
            Some(Wish::Reset) => match self.state {
                State::Alarm(_) => {
                    for drive in self.axes.iter_mut().chain([self.spindle_drive.drive_mut()]) {
                        drive.reset();
                    }
                    self.operator.hold = false;
                    self.paused = false;
                    self.state = State::Starting;
                }
                State::Idle | State::Running | State::Held => self.reset_in_motion(),
                State::Starting | State::Stopping(_) => {}
            },
        }
    }

    fn reset_in_motion(&mut self) {
        let target = self.executor.thread().map(|run| {
            // Clear of the crests and then some; never beyond the start level.
            let home = self
                .executor
                .last_pass()
                .map_or(run.plan().start(), |pass| pass.home);
            let (from, to) = if run.plan().long_x() {
                (self.executor.position().z, home.z)
            } else {
                (self.executor.position().x, home.x)
            };
            let depth = self
                .executor
                .last_pass()
                .map_or(Length::ZERO, |pass| pass.depth);
            let way = (depth + self.thread_clearance).min((to - from).abs());
            from + way.times((to - from).signum())
        });
        match target {
            Some(target) => {
                self.executor.retract(target);
            }
            None => self.executor.stop(),
        }
        self.operator.hold = false;
        self.paused = false;
        // The spindle goes on turning until the tool is out of the thread.
        self.state = State::Stopping(Outcome::Reset);
    }

    /// Begins the next segment where one may begin. Number and line of one that is over at once come back.
    fn take_up(
        &mut self,
        segments: &mut SegmentOut<'_>,
        events: &mut EventIn<'_>,
    ) -> Option<(u32, u32)> {
        if !matches!(self.state, State::Idle | State::Running | State::Held)
            || !self.executor.is_free()
            || self.paused
        {
            return None;
        }
        let next = segments.peek()?;
        if self.operator.hold && !next.stops.hold_not_before {
            return None;
        }
        let segment = take(segments)?;
        self.state = State::Running;
        self.in_program = true;
        self.start(&segment, events)
    }

    fn start(&mut self, segment: &Segment, events: &mut EventIn<'_>) -> Option<(u32, u32)> {
        let (number, line) = (segment.number, segment.span.line);
        let instant = match segment.action {
            Action::Timed(_) | Action::Thread(_) | Action::Dwell(_) => {
                emit(events, Event::Started { number, line });
                self.executor.begin(segment);
                return None;
            }
            Action::Spindle(rpm) => {
                self.commanded = rpm;
                Event::Spindle(rpm)
            }
            Action::Aux(aux) => Event::Aux(aux),
            Action::Alarm(alarm) => {
                self.raise(alarm, events);
                return None;
            }
            Action::End => {
                self.in_program = false;
                self.state = State::Idle;
                emit(events, Event::Finished);
                return None;
            }
        };
        emit(events, Event::Started { number, line });
        emit(events, instant);
        self.paused = segment.stops.single_block;
        Some((number, line))
    }

    /// State changes that follow from motion having come to rest; `moved`: a segment was under way in this tick.
    fn settle(
        &mut self,
        setpoint: &Setpoint,
        moved: bool,
        segments: &mut SegmentOut<'_>,
        events: &mut EventIn<'_>,
    ) -> Option<Position> {
        match self.state {
            State::Stopping(outcome) => {
                // One a tick; the queue is short.
                take(segments);
                if !self.executor.is_free() || segments.ready() {
                    return None;
                }
                self.in_program = false;
                self.commanded = Rpm::STOPPED;
                self.state = match outcome {
                    Outcome::Reset => State::Idle,
                    Outcome::Alarm(alarm) => State::Alarm(alarm),
                };
                Some(self.executor.position())
            }
            State::Running | State::Held => {
                if moved && self.executor.is_free() && self.executor.stops().single_block {
                    self.paused = true;
                }
                let resting = setpoint.motion == Motion::Hold
                    || (self.executor.is_free() && (self.paused || self.operator.hold));
                if resting && self.state == State::Running {
                    self.state = State::Held;
                    emit(events, Event::Held);
                } else if !resting {
                    self.state = State::Running;
                }
                None
            }
            State::Starting | State::Idle | State::Alarm(_) => None,
        }
    }

    fn demands(&self, position: Position) -> [Option<Increments>; 3] {
        let [x, z, c] = &self.scales;
        [
            x.increments(position.x.nm()),
            z.increments(position.z.nm()),
            c.increments(position.c.udeg()),
        ]
    }

    fn send(&mut self, frames: &mut Vec<Frame, FRAMES>, events: &mut EventIn<'_>) {
        // More than FRAMES cannot come together: one SYNC and three for each of four drives.
        let mut put = |frame: Frame| frames.push(frame).is_ok();
        put(self.sync.next());
        let demands = self.demands(self.executor.position());
        let mut out_of_range = None;
        for ((drive, demand), axis) in self.axes.iter_mut().zip(demands).zip(AXES) {
            if demand.is_none() {
                out_of_range = Some(axis);
            }
            let output = drive.tick(demand);
            for frame in [output.network, output.command].into_iter().flatten() {
                put(frame);
            }
        }
        let in_cycle = self.executor.stops().thread_cycle
            && matches!(self.state, State::Running | State::Held);
        if !in_cycle {
            self.spindle_percent = self.operator.spindle;
        }
        let velocity = MilliRpm::of(self.commanded, u16::from(self.spindle_percent));
        let output = self.spindle_drive.tick(velocity);
        let drive = output.drive;
        for frame in [output.speed, drive.network, drive.command]
            .into_iter()
            .flatten()
        {
            put(frame);
        }
        if let Some(axis) = out_of_range {
            let args = [Arg::Letter(axis.letter()), Arg::None, Arg::None, Arg::None];
            self.raise(
                Alarm::new(Code::BeyondDriveRange, Span::default()).with(args),
                events,
            );
        }
    }

    /// Commanded spindle speed, override included.
    #[must_use]
    pub fn spindle_command(&self) -> Rpm {
        overridden(self.commanded, self.spindle_percent)
    }

    /// A program is under way: its end has not been reached.
    #[must_use]
    pub const fn in_program(&self) -> bool {
        self.in_program
    }
}

const fn at_most(percent: u8, most: u8) -> u8 {
    if percent > most { most } else { percent }
}

/// A reader that does not keep up loses the newest events, not the machine its tick; states and alarms are also in the
/// tick's output.
fn emit(events: &mut EventIn<'_>, event: Event) {
    if put(events, event).is_err() {
        // Nothing to be done: the queue is bounded and the tick does not wait.
    }
}
