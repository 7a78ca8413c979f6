//! The state of the machine, and other values of the tick side for readers outside.

use super::{Notice, Ticker};
use crate::alarm::{Alarm, Code};
use crate::bus::Increments;
use crate::call::TapSpindle;
use crate::motion::{Cut, Executor, Law, Task};
use crate::operating::PressState;
use crate::spindle::Observer;
use crate::tick::machine::Interlocks;
use crate::tick::operator::Operator;
use crate::units::{Rpm, Turns};

/// The state of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// The drives are being enabled.
    Starting,
    /// Enabled, without work.
    Idle,
    /// Carrying out segments.
    Running,
    /// Axes find their reference.
    Homing,
    /// At rest by feed hold or single block.
    Held,
    /// Axes are moved by hand.
    ByHand,
    /// Coming to rest after an alarm, an emergency stop or a reset.
    Stopping(Outcome),
    /// At rest after an alarm, until reset.
    Alarm(Alarm),
}

/// The result of a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Ready again.
    Reset,
    /// Latched.
    Alarm(Alarm),
}

impl State {
    /// The alarm that the machine stops on or stands on.
    #[must_use]
    pub const fn alarm(&self) -> Option<&Alarm> {
        match self {
            Self::Alarm(alarm) | Self::Stopping(Outcome::Alarm(alarm)) => Some(alarm),
            _ => None,
        }
    }

    /// The machine is ready for calls: up, and neither stopping nor on an alarm.
    #[must_use]
    pub const fn takes_calls(&self) -> bool {
        matches!(self, Self::Idle | Self::Running | Self::Held)
    }

    /// True after too many failures: neither a reset nor other parameters let the machine move any more.
    pub const fn stays_at_rest(&self) -> bool {
        matches!(self, Self::Alarm(alarm) if matches!(alarm.code, Code::FailsAgain))
    }
}

impl Ticker {
    /// The state of the machine.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// True where the machine is ready for calls: up, and neither stopping nor on an alarm.
    #[must_use]
    pub const fn takes_calls(&self) -> bool {
        self.state.takes_calls()
    }

    /// True while the machine stops or stands on an alarm.
    #[must_use]
    pub const fn has_alarm(&self) -> bool {
        self.state.alarm().is_some()
    }

    /// A message for the background, until [it has read it](Self::notice_heard). A restart replaces an earlier message. No
    /// other message is made while a way is still to be planned. A message that was made between two ticks is told after
    /// the journal's entry that belongs to it.
    #[must_use]
    pub(in crate::tick) const fn notice(&self) -> Option<&Notice> {
        if self.journal.has_entry() {
            return None;
        }
        self.notice.as_ref()
    }

    /// The background has read the message.
    pub(in crate::tick) const fn notice_heard(&mut self) {
        self.notice = None;
    }

    /// The operator's settings.
    #[must_use]
    pub const fn operator(&self) -> &Operator {
        &self.operator
    }

    /// The executor, to read from.
    #[must_use]
    pub const fn executor(&self) -> &Executor {
        &self.executor
    }

    /// The observed spindle.
    #[must_use]
    pub const fn observer(&self) -> &Observer {
        &self.observer
    }

    /// The law by which an axis is held to the spindle, if one is. `head`: the head of the program's queue.
    #[must_use]
    pub fn law(&self, head: Option<Task<'_>>) -> Option<Law> {
        self.executor.law(head.filter(|_| self.has_begun()))
    }

    /// True while the head of the program's queue is under way.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.course.is_in_program_segment()
    }

    /// The spindle's angle at the instant when the setpoint of the tick before takes effect, on X or on Z.
    #[must_use]
    pub fn effective_angle(&self, on_x: bool) -> Turns {
        let ahead = if on_x {
            self.given.ahead_x
        } else {
            self.given.ahead_z
        };
        self.observer.predict(ahead.less_one())
    }

    /// The same for a pass on the lead, which follows another angle where the encoder has few counts; and by how much that
    /// angle has grown since the last sample.
    #[must_use]
    pub fn angle_of_pass(&self, on_x: bool) -> (Turns, Turns) {
        let Some(learner) = &self.learner else {
            let angle = self.effective_angle(on_x);
            return (angle, angle - self.observer.angle());
        };
        learner.before(on_x)
    }

    /// Where the drive of X or Z says that it was at the last SYNC, and how much of it has been put in at reversals, in
    /// nanometres; `None` where its status did not come with this tick.
    #[must_use]
    pub(in crate::tick) fn has_told(&self, on_x: bool) -> Option<(Increments, i64)> {
        self.drives.has_told(on_x)
    }

    /// The spindle whose angle is in the setpoint.
    #[must_use]
    pub const fn tap_spindle(&self) -> TapSpindle {
        self.spindle.taps_with()
    }

    /// Commanded spindle speed, override included.
    #[must_use]
    pub fn spindle_command(&self) -> Rpm {
        self.spindle.commanded()
    }

    /// True where the spindle's power stage is needed. This is so while the machine is up or comes to rest; while the
    /// spindle still turns on an alarm, for no longer than it may take to stop; and while a tap is in its hole, which must
    /// not lose its spindle [D190].
    #[must_use]
    pub const fn needs_spindle(&self) -> bool {
        let brakes = match self.state {
            State::Idle
            | State::Running
            | State::Held
            | State::ByHand
            | State::Homing
            | State::Stopping(_) => true,
            State::Alarm(_) => {
                self.observer.is_turning() && self.stood <= self.given.arrival.speed_ticks
            }
            State::Starting => false,
        };
        brakes || self.journal.has_hole()
    }

    /// A program is under way: its end has not been reached.
    #[must_use]
    pub const fn in_program(&self) -> bool {
        self.course.in_program()
    }

    /// The machine's inputs that are on, as far as they have been told.
    #[must_use]
    pub const fn machine_inputs(&self) -> u32 {
        self.machine.on()
    }

    /// The machine's inputs that have been told.
    #[must_use]
    pub const fn machine_known(&self) -> u32 {
        self.machine.known()
    }

    /// The machine's outputs that are on.
    #[must_use]
    pub const fn machine_outputs(&self) -> u32 {
        self.machine.outputs()
    }

    /// The gear of spindle 1 that is in, from 1; 0: nobody knows.
    #[must_use]
    pub const fn gear(&self) -> u8 {
        self.gear
    }

    /// What is open, or has no pressure.
    #[must_use]
    pub const fn interlocks(&self) -> Interlocks {
        self.machine.interlocks()
    }

    /// Number of the last press, and what became of it.
    #[must_use]
    pub const fn jog(&self) -> (u8, PressState) {
        self.jog.last()
    }

    /// Why the last press was refused by the tick, if it was.
    #[must_use]
    pub const fn jog_refused(&self) -> Option<Code> {
        self.jog.refusal()
    }

    /// The thread or hole of the last segment that was carried to its end without a stop.
    #[must_use]
    pub const fn done(&self) -> Cut {
        self.course.done()
    }
}
