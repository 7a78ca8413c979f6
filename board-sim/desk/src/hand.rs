//! What a hand does at a machine, whatever keeps the machine running: each request of [`control`](crate::control) is
//! carried out here on a [`Handled`]. It must not know where requests come from.

use leadscrew_board_sim::TurretFault;
use leadscrew_common::failure::Outcome;
use leadscrew_common::number;
use leadscrew_common::words::{Both, both};
use leadscrew_core::board::Inputs;
use leadscrew_core::params::Contact as Input;

use crate::clock::Speed;
use crate::control::{Answer, Contact, Door, Level, Power, Request, Turret, View};

/// What a person can press or open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contacts {
    /// The door.
    pub door: Door,
    /// The emergency stop is pressed.
    pub estop: bool,
    /// Feed hold is pressed.
    pub hold: bool,
}

impl Contacts {
    /// The board's pins.
    #[must_use]
    pub fn pins(self) -> Inputs {
        Inputs {
            stop: self.estop,
            hold: self.hold,
            ..Inputs::default()
        }
    }
}

/// A machine that a hand is at.
pub trait Handled {
    /// What is pressed or open.
    fn contacts(&self) -> Contacts;
    /// Somebody presses or opens something.
    fn touch(&mut self, contacts: Contacts);
    /// The board has an input for the door.
    fn has_door(&self) -> bool;
    /// Somebody sets an input, or leaves it to the simulated devices.
    fn set_input(&mut self, input: Input, on: Option<bool>);
    /// Somebody turns the handwheel at the board's own input.
    fn turn_wheel(&mut self, counts: i32);
    /// What is wrong with the turret from now on.
    fn spoil_turret(&mut self, fault: TurretFault);
    /// What is wrong with a drive, the spindle, the encoder, the wire or the flash from now on. False where this machine
    /// has no such faults.
    fn spoil(&mut self, request: &Request) -> bool;
    /// Takes the power of board and drives, or gives it.
    ///
    /// # Errors
    /// The flash cannot be saved; the board does not start.
    fn power(&mut self, to: Power) -> Outcome;
    /// Machine time from now on.
    fn set_speed(&mut self, speed: Speed);
    /// The machine is to end.
    fn end(&mut self);
    /// The machine as it is.
    fn view(&self) -> View;
}

/// Carries out what was asked for.
pub fn carry_out(machine: &mut impl Handled, request: &Request) -> Answer {
    let contacts = machine.contacts();
    let mut note = None;
    match *request {
        Request::Door { to } => {
            machine.touch(Contacts {
                door: to,
                ..contacts
            });
            if !machine.has_door() {
                note = Some(both!(
                    "the board has no input for the door (parameter 9423 is 0): nothing follows from it",
                    "控制板没有门的输入（参数 9423 为 0）：不会产生任何作用"
                ));
            }
        }
        Request::Estop { to } => machine.touch(Contacts {
            estop: to == Contact::Press,
            ..contacts
        }),
        Request::Hold { to } => machine.touch(Contacts {
            hold: to == Contact::Press,
            ..contacts
        }),
        Request::Input { number, to } => {
            let Some(input) = Input::new(number) else {
                return Answer::refused(wrong_input(number));
            };
            let on = match to {
                Level::On => Some(true),
                Level::Off => Some(false),
                Level::Auto => None,
            };
            machine.set_input(input, on);
        }
        Request::Wheel { counts } => machine.turn_wheel(counts),
        Request::Turret { to } => machine.spoil_turret(match to {
            Turret::Well => TurretFault::None,
            Turret::Stuck => TurretFault::Stuck,
            Turret::Slips => TurretFault::Slips,
            Turret::Loose => TurretFault::Loose,
        }),
        Request::Block { .. }
        | Request::Drive { .. }
        | Request::Spindle { .. }
        | Request::Encoder { .. }
        | Request::Bus { .. }
        | Request::Flash { .. } => {
            if !machine.spoil(request) {
                return Answer::refused(no_fault());
            }
        }
        Request::Power { to } => {
            if let Err(failure) = machine.power(to) {
                return Answer::refused(failure.words().unwrap_or_default());
            }
        }
        Request::Speed { thousandths } => match Speed::of_thousandths(thousandths) {
            Some(speed) => machine.set_speed(speed),
            None => return Answer::refused(wrong_speed()),
        },
        Request::State => {}
        Request::Down => machine.end(),
    }
    Answer {
        ok: true,
        error: None,
        note: note.map(Into::into),
        machine: Some(machine.view()),
    }
}

/// The contacts that are on, from 1 on.
#[must_use]
pub fn numbers(on: u32) -> Vec<u8> {
    Input::of_bits(on).map(Input::number).collect()
}

/// The words for a fault that this machine does not have.
fn no_fault() -> Both {
    both!(
        "this machine has its faults from the options of `board-sim`: a machine that `leadscrew up` keeps has this one",
        "这台机床的故障由 `board-sim` 的选项给出：由 `leadscrew up` 启动的机床才有这种故障"
    )
}

/// The words for an input that does not exist.
fn wrong_input(number: u8) -> Both {
    both!(
        "there is no input {number}: they are counted from 1 to 32",
        "没有输入 {number}：编号为 1 至 32"
    )
}

/// The words for a speed that is refused.
#[must_use]
pub fn wrong_speed() -> Both {
    let [least, most] = Speed::RANGE;
    let factor = |thousandths: u32| number::text::<3>(thousandths.into());
    let (least, most) = (factor(least), factor(most));
    both!(
        "machine time runs at {least} to {most} times real time: beyond that the board would miss the heartbeats of \
         gateways",
        "机床时间可为真实时间的 {least} 至 {most} 倍：超出后控制板会丢失网关心跳"
    )
}
