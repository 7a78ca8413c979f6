//! The state of the tick side at one instant, for readers outside. It is made between two ticks, never in a tick.

use super::hard_limits::HardLimits;
use super::machine::Interlocks;
use super::operator::Operator;
use super::ticker::{Outcome, State, Ticker};
use crate::alarm::{Alarm, Code};
use crate::bus::BoardState;
use crate::call::TapSpindle;
use crate::journal::TapRecord;
use crate::motion::{Cut, Motion, Setpoint};
use crate::operating::PressState;
use crate::signals::Signals;
use crate::units::{Axes, Rpm, TurnRate, Turns};

/// The operator's contacts on a board with pins for them. This is their state only; their effects are
/// [commands](super::Command).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contacts {
    /// Feed hold is pressed.
    pub hold: bool,
    /// The emergency stop is pressed, or its circuit is open.
    pub stop: bool,
}

/// The tick side of a board between two ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// The state of the machine.
    pub state: State,
    /// The last setpoint.
    pub setpoint: Setpoint,
    /// A program is under way.
    pub in_program: bool,
    /// A held program was left.
    pub has_left: bool,
    /// The thread or hole of the last segment that was carried to its end.
    pub done: Cut,
    /// Angle of the spindle at the last SYNC.
    pub spindle: Turns,
    /// That angle counts from the index: the last one is no more than two turns away.
    pub indexed: bool,
    /// Measured speed of the spindle.
    pub speed: TurnRate,
    /// Commanded speed of the spindle, override included.
    pub command: Rpm,
    /// The spindle's power stage is needed: see [`Ticker::needs_spindle`].
    pub needs_spindle: bool,
    /// The spindle in position mode, or the last one.
    pub spindle_in_use: TapSpindle,
    /// The newest entry of the tap journal.
    pub tap: Option<TapRecord>,
    /// The axes whose position is that of the machine: see [`Ticker::referenced`].
    pub referenced: Axes,
    /// The axes without a reference that a program needs.
    pub unreferenced: Axes,
    /// The machine's inputs that are on, as far as they have been told.
    pub machine_inputs: u32,
    /// Those that have been told.
    pub machine_known: u32,
    /// Its outputs that are on.
    pub machine_outputs: u32,
    /// The gear of spindle 1 that is in, from 1; 0: nobody knows.
    pub gear: u8,
    /// What is open, or has no pressure.
    pub interlocks: Interlocks,
    /// The ends at which a hard limit switch is on.
    pub hard_limits: HardLimits,
    /// The operator's settings.
    pub operator: Operator,
    /// Number of the last press by hand, and what became of it.
    pub jog: (u8, PressState),
    /// Why the tick has refused it, if it has.
    pub jog_refused: Option<Code>,
    /// The operator's contacts; [`Contacts::default`] where the board has none.
    pub contacts: Contacts,
}

impl Snapshot {
    /// The state after the tick that gave `setpoint`, with these contacts.
    // Two functions call it.
    #[inline(never)]
    #[must_use]
    pub fn new(ticker: &Ticker, setpoint: &Setpoint, contacts: Contacts) -> Self {
        Self {
            state: ticker.state(),
            setpoint: *setpoint,
            in_program: ticker.in_program(),
            has_left: ticker.has_left(),
            done: ticker.done(),
            spindle: ticker.observer().angle(),
            indexed: ticker.observer().indexed(),
            speed: ticker.observer().speed(),
            command: ticker.spindle_command(),
            needs_spindle: ticker.needs_spindle(),
            spindle_in_use: ticker.tap_spindle(),
            tap: ticker.tap_entry(),
            referenced: ticker.referenced(),
            unreferenced: ticker.unreferenced(),
            machine_inputs: ticker.machine_inputs(),
            machine_known: ticker.machine_known(),
            machine_outputs: ticker.machine_outputs(),
            gear: ticker.gear(),
            interlocks: ticker.interlocks(),
            hard_limits: ticker.hard_limits(),
            operator: *ticker.operator(),
            jog: ticker.jog(),
            jog_refused: ticker.jog_refused(),
            contacts,
        }
    }

    /// The state of the machine in one word.
    #[must_use]
    pub const fn board_state(&self) -> BoardState {
        match (self.state, self.setpoint.motion) {
            (State::Alarm(_) | State::Stopping(Outcome::Alarm(_)), _) => BoardState::Alarm,
            (State::Starting, _) => BoardState::Starting,
            (State::Stopping(Outcome::Reset), _) => BoardState::Stopping,
            (State::Homing, _) => BoardState::Run,
            (_, Motion::Hold) | (State::Held, _) => BoardState::Hold,
            (State::ByHand, _) => BoardState::Run,
            (_, Motion::Dwell) => BoardState::Dwell,
            (_, Motion::Wait) => BoardState::Wait,
            (_, Motion::Run) => BoardState::Run,
            // The next segment is not in the queue yet.
            (State::Running, Motion::Idle) => BoardState::Wait,
            (State::Idle, Motion::Idle) if self.in_program => BoardState::Wait,
            (State::Idle, Motion::Idle) => BoardState::Idle,
        }
    }

    /// The alarm on which it stops or stands.
    #[must_use]
    pub const fn alarm(&self) -> Option<&Alarm> {
        match &self.state {
            State::Alarm(alarm) | State::Stopping(Outcome::Alarm(alarm)) => Some(alarm),
            _ => None,
        }
    }

    /// Object 5060h: the [bits](Signals::bits) of the inputs, and mirrored bits after them [D164]. Feed hold and emergency
    /// stop are 1 while their contact is active or while they act: the hold until resume or reset, the stop until the reset
    /// of its alarm. The last bit says that the spindle's angle counts from its index.
    // Two functions call it.
    #[inline(never)]
    #[must_use]
    pub fn signals(&self) -> u16 {
        let operator = &self.operator;
        let mut bits = operator.signals.bits();
        if operator.hold || self.contacts.hold {
            bits |= Signals::HOLD;
        }
        if operator.single_block {
            bits |= Signals::SINGLE_BLOCK;
        }
        let stands = |alarm: &Alarm| alarm.code == Code::EmergencyStop;
        if self.contacts.stop || self.alarm().is_some_and(stands) {
            bits |= Signals::STOP;
        }
        if self.indexed {
            bits |= Signals::INDEXED;
        }
        bits
    }

    /// Object 5061h: the board's own inputs that are on; bit 16 where they have been told; from bit 24 on its
    /// [interlocks](crate::operating::Interlock), each at the place of its number.
    #[must_use]
    pub fn machine(&self) -> u32 {
        let told = (self.machine_known & 1) << 16;
        u32::from(self.machine_inputs as u16) | told | u32::from(self.interlocks.bits()) << 24
    }

    /// 5062h: its outputs that are on, and from bit 24 on the gear.
    #[must_use]
    pub fn machine_out(&self) -> u32 {
        u32::from(self.machine_outputs as u16) | u32::from(self.gear) << 24
    }

    /// 5063h: the inputs of the block that are on, and from bit 16 on those that it has told.
    #[must_use]
    pub fn block(&self) -> u32 {
        self.machine_inputs >> 16 | self.machine_known & 0xFFFF_0000
    }

    /// Nothing moves or is about to move: parameters may change.
    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        match self.state {
            State::Starting | State::Alarm(_) => true,
            State::Idle => !self.in_program,
            State::Running | State::Held | State::Homing | State::ByHand | State::Stopping(_) => {
                false
            }
        }
    }

    /// The machine takes calls.
    #[must_use]
    pub const fn takes_calls(&self) -> bool {
        matches!(self.state, State::Idle | State::Running | State::Held)
    }
}
