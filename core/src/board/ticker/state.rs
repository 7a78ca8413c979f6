//! Where the machine is, and what else can be asked of the tick's side from outside.

use super::{Notice, Ticker};
use crate::alarm::{Alarm, Code};
use crate::board::operator::Operator;
use crate::motion::{Cut, Executor, Law, Task};
use crate::program::TapSpindle;
use crate::spindle::Observer;
use crate::units::{Rpm, Turns};

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

    /// Failed too often: neither a reset nor other parameters let it move any more.
    pub(super) const fn stays_at_rest(&self) -> bool {
        matches!(self, Self::Alarm(alarm) if matches!(alarm.code, Code::FailsAgain))
    }
}

impl Ticker {
    /// Where the machine is.
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

    /// What the background has to hear, until it [has heard it](Self::notice_heard). A restart makes what was said
    /// before it void; nothing else is said while a way is still to be planned. What was asked for between two ticks is
    /// told after the journal's entry that belongs to it.
    #[must_use]
    pub const fn notice(&self) -> Option<&Notice> {
        if self.journal.has_entry() {
            return None;
        }
        self.notice.as_ref()
    }

    /// The background has heard what there was to hear.
    pub const fn notice_heard(&mut self) {
        self.notice = None;
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

    /// By what an axis is held to the spindle, if one is; `head` is the head of the program's queue.
    #[must_use]
    pub fn law(&self, head: Option<Task<'_>>) -> Option<Law> {
        self.executor.law(head.filter(|_| self.has_begun()))
    }

    /// The head of the program's queue is under way: it has begun, and is not done.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.course.is_in_program_segment()
    }

    /// The spindle's angle when the setpoint of the tick before takes effect, on X or on Z.
    #[must_use]
    pub fn effective_angle(&self, on_x: bool) -> Turns {
        let ahead = if on_x {
            self.given.ahead_x
        } else {
            self.given.ahead_z
        };
        self.observer.predict(ahead.less_one())
    }

    /// The spindle whose angle a setpoint has.
    #[must_use]
    pub const fn tap_spindle(&self) -> TapSpindle {
        self.spindle.taps_with()
    }

    /// Commanded spindle speed, override included.
    #[must_use]
    pub fn spindle_command(&self) -> Rpm {
        self.spindle.commanded()
    }

    /// The spindle's power stage is needed: the machine is up or comes to rest, the spindle still turns on an alarm (no
    /// longer than it may take to stop), or a tap is in its hole, which must not lose its spindle [D190].
    #[must_use]
    pub const fn needs_spindle(&self) -> bool {
        let brakes = match self.state {
            State::Idle | State::Running | State::Held | State::Stopping(_) => true,
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

    /// The thread or hole of the last segment that was carried to its end, with nothing that stopped it.
    #[must_use]
    pub const fn done(&self) -> Cut {
        self.course.done()
    }
}
