//! The tick: one SYNC period of the whole board.
//!
//! ```text
//! inputs (encoder sample, frames since the last tick) ─► observer, drives ─► executor ─► SYNC, RPDOs
//! ```
//!
//! Knows segments, the spindle's encoder and the drives; knows nothing of calls or cycles. Bounded work: every loop runs
//! over the axes or over the frames of one period.
//!
//! Each part of the tick's state owns what it changes:
//!
//! | part | what it answers for |
//! |---|---|
//! | [`State`] | where the machine is; every change of it is in `transition` |
//! | `Course` | how far the program has come, and where single block stops |
//! | `Jog` | axes that are moved by hand |
//! | `Handwheel` | the rate of a program that follows a handwheel |
//! | `Away` | the way out of a stroke and back |
//! | `Left` | a held program whose axes are moved by hand meanwhile |
//! | `SpindleMode` | what the spindles are told: a speed, or position mode |
//! | `Journal` | the entry of the tap in its hole |
//! | `Home` | the references of the axes |
//! | `Watch` | the hard limit switches |
//! | `Machine` | inputs and outputs of the machine, and what they mean |
//! | `Operator` | what the operator has asked for and set |
//! | `Drives`, `Observer`, `Executor` | the drives, the measured spindle, the segment under way |

mod anew;
mod away;
mod begin;
mod by_hand;
mod course;
mod functions;
mod handwheel;
mod home;
mod interlock;
mod journal;
mod left;
mod limits;
mod orient;
mod search;
mod setup;
mod spindle;
mod state;
mod stopping;
mod surface;
mod tool;
mod transition;
mod withheld;

use heapless::Vec;

use self::away::{Away, LastPass};
use self::course::{Course, Source};
use self::functions::{ChuckWait, Pending};
use self::handwheel::Handwheel;
use self::home::Home;
use self::journal::Journal;
use self::left::Left;
use self::limits::Watch;
use self::setup::Given;
pub use self::setup::Setup;
use self::spindle::SpindleMode;
pub use self::state::{Outcome, State};
use self::tool::ToolIn;
use super::command::{Command, Switching};
use super::detour::{Detour, Route};
use super::drives::{Drives, FRAMES};
use super::machine::Machine;
use super::nodes::DriveNodes;
use super::operator::Operator;
use super::queue::{DetourOut, EventIn, SegmentOut, put};
use super::spindles::Spindle;
use super::stored::Found;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::Frame;
use crate::bus::Setpoints;
use crate::call::Position;
use crate::journal::TapRecord;
use crate::motion::{AxisTravel, Conditions, Epoch, Executor, Jog, Setpoint, Task};
use crate::signals::Signals;
use crate::spindle::{EncoderSample, Learner, Observer, SpindleEvent};
use crate::tick::Event;
use crate::units::Length;

/// A message of the tick to the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Drop all plans and start again from this position. Segments planned from now on carry this epoch.
    Restart(Position, Epoch),
    /// Plan this way.
    Route(Route),
}

/// The result of one tick. It is made once and filled in every tick, because it is too large to copy in a tick.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// Frames to send, in this order; SYNC first.
    pub frames: Vec<Frame, FRAMES>,
    /// The setpoint, effective at the next SYNC plus the drives' latency.
    pub setpoint: Setpoint,
    /// An entry of the tap journal to store. It replaces any entry given before.
    pub journal: Option<TapRecord>,
    /// What the board's switches have to do.
    pub switching: Switching,
    /// The board's own outputs that are on; bit 0 is output 1.
    pub outputs: u16,
    /// The setpoints of all drives in one frame of CAN FD (9031). This frame follows the other frames of the period.
    pub together: Option<Setpoints>,
}

/// The queues of a ticker.
pub(super) struct Ends<'q> {
    /// The program's segments.
    pub segments: SegmentOut<'q>,
    /// The answer to a [`Route`].
    pub detours: DetourOut<'q>,
    /// Events.
    pub events: EventIn<'q>,
}

/// The tick side of a board.
#[derive(Debug)]
pub struct Ticker {
    state: State,
    /// The encoder has lost or gained counts, and the index still belongs to the old count.
    slipped: bool,
    /// A machine function has not been answered yet, so the next segment waits.
    awaits: bool,
    /// For the output of this tick.
    switching: Switching,
    course: Course,
    away: Away,
    left: Option<Left>,
    spindle: SpindleMode,
    /// The state of the stored parameters at power-up.
    found: Found,
    /// Ticks since power-up; it wraps.
    now: u32,
    /// Ticks since the machine came to rest on its alarm.
    stood: u32,
    operator: Operator,
    given: Given,
    observer: Observer,
    /// What a pass on the lead follows, where the encoder has few counts.
    learner: Option<Learner>,
    /// The position of the machine when the power went.
    remembered: Option<Position>,
    /// A message that the background has not read yet.
    notice: Option<Notice>,
    journal: Journal,
    drives: Drives,
    jog: Jog,
    /// How far X and Z may go by the last press, or on the way back.
    free: [AxisTravel; 2],
    handwheel: Handwheel,
    home: Home,
    /// The hard limit switches.
    limits: Watch,
    machine: Machine,
    /// A machine function that has not been answered.
    function: Option<Pending>,
    /// The gear of spindle 1 that is in, from 1; 0: nobody knows.
    gear: u8,
    /// The tool that is in, where a tool changer is.
    tool: ToolIn,
    chuck_wait: ChuckWait,
    /// Ticks since a resume that waits for the spindle.
    resuming: Option<u32>,
    executor: Executor,
}

impl Ticker {
    /// The machine at power-up; see [`Tick::new`](super::Tick::new).
    // Written straight to the place that the caller names. As a function of its own, the value would be copied there
    // [D146].
    #[inline(always)]
    pub(super) fn new(setup: &Setup, remembered: Option<Position>, tap: Option<TapRecord>) -> Self {
        let given = setup.given;
        Self {
            state: State::Starting,
            slipped: false,
            awaits: false,
            switching: Switching::Nothing,
            now: 0,
            stood: 0,
            course: Course::new(),
            away: Away::new(),
            left: None,
            spindle: SpindleMode::new(),
            found: setup.found,
            operator: Operator::new(),
            given,
            observer: setup.observer,
            learner: setup.learner,
            remembered,
            notice: None,
            journal: Journal::new(tap, given.second),
            drives: Drives::new(&setup.figures),
            jog: Jog::new(),
            free: [given.travel_x, given.travel_z],
            handwheel: Handwheel::OFF,
            home: Home::new(),
            limits: Watch::NEW,
            machine: Machine::new(given.wiring),
            function: None,
            gear: 0,
            tool: ToolIn::Unknown,
            chuck_wait: ChuckWait::default(),
            resuming: None,
            executor: Executor::new(given.arrival),
        }
    }

    /// A program, or a line that was `typed`, begins: until its end an empty queue is a wait, not idleness.
    pub(super) const fn program_begins(&mut self, typed: bool) {
        self.course.begin_program(typed);
    }

    /// The node numbers of its drives.
    #[must_use]
    pub const fn drive_nodes(&self) -> DriveNodes {
        self.drives.nodes()
    }

    /// Segments of this epoch count.
    #[must_use]
    pub const fn epoch(&self) -> Epoch {
        self.course.epoch()
    }

    /// Takes an operator's command; it acts in the next tick.
    // Called in many places.
    #[inline(never)]
    pub fn command(&mut self, command: Command) {
        match command {
            Command::Block(inputs) => self.machine.hear_block(inputs),
            Command::BlockLost(loss) => self.machine.lose_block(loss),
            Command::Release => {
                self.jog.release();
                self.stay_away();
            }
            // Whoever holds while the spindle comes to its speed means the program.
            Command::Hold => self.resuming = None,
            Command::ByWheel(on) => self.handwheel.set(on),
            Command::Turned(way) => self.handwheel.turn(way),
            _ => {}
        }
        self.operator.take(command);
    }

    /// `awaits`: a machine function has been switched and not answered yet. Until it is answered, no other segment begins.
    pub(super) const fn await_machine(&mut self, awaits: bool) {
        self.awaits = awaits;
    }

    /// Ticks in a second.
    #[must_use]
    pub const fn second(&self) -> u32 {
        self.given.second
    }

    /// Sets the inputs; they act in the next tick.
    pub const fn signals(&mut self, signals: Signals) {
        self.operator.signals = signals;
    }

    /// One SYNC period. `received`: the frames since the last tick.
    pub(super) fn tick(
        &mut self,
        sample: EncoderSample,
        received: &[Frame],
        ends: &mut Ends<'_>,
        output: &mut Output,
    ) {
        self.now = self.now.wrapping_add(1);
        for frame in received {
            self.drives.hear(frame);
        }
        self.observe(sample, ends);
        self.watch_drives(ends);
        self.watch_limits(ends);
        self.obey(ends);
        self.course.drop_stale(ends);
        self.away.drop_stale(ends);
        let instant = self.take_up(ends);

        let moved = !self.executor.is_free();
        let from = self.place_at_limit();
        if self.jog.is_busy() {
            self.move_by_hand(ends);
        }
        let setpoint = &mut output.setpoint;
        self.execute(setpoint, ends);
        if let Some((number, line, motion)) = instant {
            (setpoint.number, setpoint.line) = (number, line);
            setpoint.motion = motion;
        }
        if let Some(from) = from {
            self.keep_off(from, ends);
        }
        self.release(ends);
        let motion = setpoint.motion;
        self.settle(motion, moved, ends);
        self.keep_journal(ends, output);
        output.switching = core::mem::take(&mut self.switching);
        output.outputs = self.machine.outputs() as u16;
        output.frames.clear();
        self.send(&mut output.frames, ends);
        let together = self.drives.together();
        // There is nearly never a common frame, and copying it takes long.
        if together.is_some() || output.together.is_some() {
            output.together = together.copied();
        }
    }

    /// A finished segment leaves its queue.
    fn release(&mut self, ends: &mut Ends<'_>) {
        if self.executor.is_free() {
            // A pass that feed hold has left stays in the queue, because it is repeated.
            let is_left = self.away.stage() == Detour::Leaving;
            let is_whole = !matches!(self.state, State::Stopping(_));
            self.course.release(is_left, is_whole, ends);
        }
    }

    fn execute(&mut self, setpoint: &mut Setpoint, ends: &mut Ends<'_>) {
        let is_joined = self.executor.is_joined();
        if self.executor.has_crossed() {
            self.next_stroke(ends);
        }
        let [feed, rapid] = if self.handwheel.is_on() {
            self.rates_by_wheel(ends)
        } else {
            [self.operator.feed(), self.operator.rapid()]
        };
        let conditions = Conditions {
            observer: &self.observer,
            learner: self.learner.as_ref(),
            ahead_x: self.given.ahead_x,
            ahead_z: self.given.ahead_z,
            feed,
            rapid,
            hold: self.operator.hold,
            // Only a waiting stroke needs to know.
            more: self.executor.is_waiting()
                && self.course.is_in_program_segment()
                && ends.segments.has_second(),
            single: self.operator.single_block,
            leads_out: self.away.stage() != Detour::Back,
            stretch: if is_joined {
                self.course.stretch(ends)
            } else {
                None
            },
        };
        let current = self.course.current(ends);
        if let Err(alarm) = self.executor.tick(&conditions, current, setpoint) {
            self.raise(&alarm, ends);
        }
        if is_joined {
            if self.executor.has_taken() {
                ends.segments.drop_stretch();
            }
            if self.executor.has_crossed() {
                self.cross(setpoint, ends);
            }
        }
    }

    /// The next stroke of a chain takes over from the one under way.
    #[inline(never)]
    fn next_stroke(&mut self, ends: &mut Ends<'_>) {
        if !ends.segments.has_second() {
            return self.raise(&Alarm::of(Code::StrokeLate, &[]), ends);
        }
        if let Some(pass) = self.course.current(ends).and_then(Task::pass) {
            self.executor.leave_stroke(pass);
        }
        self.go_on(ends);
        if let Some(task) = self.course.current(ends)
            && let Some(pass) = task.pass()
        {
            self.executor.take_over(task.segment, pass);
            self.away.begin_pass(LastPass::of(task.segment, pass));
        }
    }

    /// The segment under way is over without a stop, and the next one of the program is under way.
    fn go_on(&mut self, ends: &mut Ends<'_>) {
        let is_whole = !matches!(self.state, State::Stopping(_));
        self.course.release(false, is_whole, ends);
        self.course.take_from(Source::Program);
        if let Some(next) = ends.segments.head() {
            let started = Event::Started {
                number: next.number,
                line: next.span.line,
            };
            emit(&mut ends.events, started);
        }
    }

    /// The tool has passed the end of a joined cut: the next one is under way.
    #[inline(never)]
    fn cross(&mut self, setpoint: &mut Setpoint, ends: &mut Ends<'_>) {
        let over = self.course.current(ends).and_then(Task::timed);
        let length = over.map_or(Length::ZERO, |timed| timed.length);
        self.go_on(ends);
        let next = self.course.current(ends);
        self.executor.cross(length, next, setpoint);
    }

    fn observe(&mut self, mut sample: EncoderSample, ends: &mut Ends<'_>) {
        if !self.given.edge_time {
            sample.edge_age_ns = None;
        }
        // For a slip during a tap that has ended since.
        self.begin_new_count();
        let event = self.observer.tick(sample);
        if let Some(learner) = &mut self.learner {
            let wanted = self.executor.is_on_the_lead();
            learner.expect(self.spindle.commanded());
            learner.tick(&self.observer, sample.edge_age_ns, event.is_some(), wanted);
        }
        if let Some(SpindleEvent::Slipped { counts }) = event {
            self.slip(counts, ends);
        }
    }

    /// After lost or gained counts the next index pulse begins a new count. This moves the angle by up to half a turn, so
    /// it waits until no axis follows the angle.
    const fn begin_new_count(&mut self) {
        if self.slipped && !self.executor.is_floating() {
            self.slipped = false;
            self.observer.forget_index();
        }
    }

    // Rare work stays out of the tick's own code, which is shorter without it [D140].

    #[cold]
    #[inline(never)]
    fn slip(&mut self, counts: i32, ends: &mut Ends<'_>) {
        self.slipped = true;
        self.begin_new_count();
        let alarm = Alarm::of(Code::IndexSlipped, &[Arg::Int(i64::from(counts))]);
        let in_cycle = self.executor.stops().frozen.is_some()
            && matches!(self.state, State::Running | State::Held);
        if in_cycle || self.executor.thread().is_some() || self.executor.is_floating() {
            self.raise(&alarm, ends);
        } else {
            emit(&mut ends.events, Event::Warning(alarm));
        }
    }

    fn watch_drives(&mut self, ends: &mut Ends<'_>) {
        match self.state {
            State::Alarm(_) => return self.let_go(true),
            State::Stopping(Outcome::Alarm(_)) => return self.let_go(false),
            State::Starting if self.drives.enable() => self.come_up(ends),
            State::Homing => self.go_on_homing(ends),
            _ => {}
        }
        if let Some(alarm) = self.drives.failure() {
            self.lose_references();
            self.raise(&alarm, ends);
        }
    }

    /// The machine stops on an alarm, or stands on it.
    #[cold]
    #[inline(never)]
    fn let_go(&mut self, at_rest: bool) {
        self.lose_references();
        self.drives.let_go(at_rest);
    }

    /// The drives are enabled.
    #[cold]
    #[inline(never)]
    fn come_up(&mut self, ends: &mut Ends<'_>) {
        self.lose_references();
        emit(&mut ends.events, Event::Ready);
        let mut position = self.drives.position(self.remembered.take());
        self.place_tap(&mut position, ends);
        self.drives.rest_at(position);
        self.transition_to_ready(position);
        self.tell_found(ends);
    }

    fn obey(&mut self, ends: &mut Ends<'_>) {
        if self.machine.has_changed() || self.resuming.is_some() {
            self.heed_machine(ends);
        }
        if self.operator.asks() {
            self.act(ends);
        }
        if self.operator.hold && self.given.hold_retracts {
            self.leave_stroke(ends);
        }
    }

    /// Carries out what the operator asks for: stop, reset, resume, homing, in this order.
    #[cold]
    #[inline(never)]
    fn act(&mut self, ends: &mut Ends<'_>) {
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
            // A program that was left goes on by a return alone.
            match self.has_left() {
                true => self.operator.hold = false,
                false => self.resume(ends),
            }
        }
        if self.operator.takes_return() {
            self.go_on_from_left(ends);
        }
        if self.operator.is_to_leave() {
            self.leave();
        }
        if self.operator.takes_cancel() && matches!(self.state, State::Homing) {
            self.transition_to_stopping_by_reset(ends);
        }
        if let Some(axes) = self.operator.takes_home() {
            self.home(axes, ends);
        }
    }

    fn send(&mut self, frames: &mut Vec<Frame, FRAMES>, ends: &mut Ends<'_>) {
        // Frozen in a thread cycle, and also while a reset leaves that cycle.
        let frozen = match self.state {
            State::Running | State::Held | State::Stopping(_) => self.executor.stops().frozen,
            State::ByHand if self.has_left() => self.executor.stops().frozen,
            State::Starting | State::Idle | State::ByHand | State::Homing | State::Alarm(_) => None,
        };
        let percent = frozen.unwrap_or(self.operator.spindle_percent());
        // A tool that leaves a thread is led by the spindle until it is out.
        let stands = self.spindle.is_suspended() && self.executor.thread().is_none();
        self.spindle.set_percent(if stands { 0 } else { percent });
        let velocity = self.velocity();
        self.leave_rigid();
        let spindle = match self.executor.spindle() {
            Some(angle) => Spindle::Angle(angle),
            None => Spindle::Speed(velocity),
        };
        let position = self.executor.position();
        let beyond = self.drives.send(position, spindle, frames);
        if let Some(axis) = beyond {
            let args = [Arg::Letter(axis.letter()), Arg::None, Arg::None, Arg::None];
            let alarm = Alarm::new(Code::BeyondDriveRange, Span::default()).with(args);
            self.raise(&alarm, ends);
        }
    }
}

/// Reports an event. If the reader of the queue is too slow, the newest events are lost, but the tick keeps its time.
/// States and alarms are also in the tick's output.
fn emit(events: &mut EventIn<'_>, event: Event) {
    // The queue is full: the tick does not wait.
    let _ = put(events, event);
}
