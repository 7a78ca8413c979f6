//! What is around the simulated machine: a closed door, a clamped work piece, and devices that answer at once.
//!
//! Each machine function has what it switches: its input answers as soon as its output is switched. Somebody may set an
//! input, which then stays. Must not know how the board reads its inputs.

use super::turret::{Turret, TurretFault};
use leadscrew_core::params::{Answer, BY_SWITCH, Contact, FunctionAction, Params};
use leadscrew_core::units::Axis;

/// A reference switch lets go so much before the place where it comes on, in nanometres.
const HYSTERESIS_NM: i64 = 20_000;

/// The hard limit switches of the simulated machine (9064, 9065) come on so far beyond the ends of its travel (1320, 1321),
/// in nanometres.
pub(crate) const OVERRUN_NM: i64 = 5_000_000;

/// The inputs of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Around {
    /// Inputs that somebody has set, and their levels.
    set: u32,
    levels: u32,
    /// The door is open.
    door_open: bool,
    /// What devices answer.
    answers: u32,
    /// The reference switches of X and Z that stand at an input are on.
    at_switch: [bool; 2],
    /// The hard limit switches of X and Z that stand at an input are on: minus, plus.
    at_limit: [[bool; 2]; 2],
    turret: Turret,
}

impl Around {
    /// Opens or closes the door. It moves the input of 9423.
    pub const fn open_door(&mut self, open: bool) {
        self.door_open = open;
    }

    /// Takes over what somebody has set. What devices have done meanwhile stays.
    pub const fn be_as(&mut self, set: &Self) {
        let (answers, mut turret) = (self.answers, self.turret);
        let (at_switch, at_limit) = (self.at_switch, self.at_limit);
        turret.spoil(set.turret.fault());
        *self = *set;
        (self.answers, self.turret) = (answers, turret);
        (self.at_switch, self.at_limit) = (at_switch, at_limit);
    }

    /// What is wrong with the turret from now on.
    pub const fn spoil_turret(&mut self, fault: TurretFault) {
        self.turret.spoil(fault);
    }

    /// Sets an input on or off, or lets devices have it again.
    pub const fn set(&mut self, input: Contact, on: Option<bool>) {
        let bit = input.bit();
        match on {
            Some(true) => (self.set, self.levels) = (self.set | bit, self.levels | bit),
            Some(false) => (self.set, self.levels) = (self.set | bit, self.levels & !bit),
            None => self.set &= !bit,
        }
    }

    /// X or Z stands here, in nanometres. An axis that looks for a switch at an input (9050 = 2) has one whose edge is at
    /// the place of 9058, and which stays on beyond; it lets go a little later than it comes on. A hard limit switch is on
    /// [beyond the travel](OVERRUN_NM).
    pub fn stand(&mut self, params: &Params, axis: Axis, place: i64) {
        let [x, z] = &mut self.at_switch;
        let on = if axis == Axis::X { x } else { z };
        let beyond = place.saturating_sub(params.home_position(axis));
        let beyond = match params.home_towards(axis) {
            Some(0) => beyond.saturating_neg(),
            _ => beyond,
        };
        let edge = if *on { -HYSTERESIS_NM } else { 0 };
        *on = params.home_method(axis) == BY_SWITCH && beyond >= edge;
        let [x, z] = &mut self.at_limit;
        let [minus, plus] = if axis == Axis::X { x } else { z };
        for (on, beyond) in [
            (minus, params.soft_limit_minus(axis).saturating_sub(place)),
            (plus, place.saturating_sub(params.soft_limit_plus(axis))),
        ] {
            let edge = if *on { HYSTERESIS_NM } else { 0 };
            *on = beyond >= OVERRUN_NM.saturating_sub(edge);
        }
    }

    /// The inputs that are on while these outputs are.
    #[must_use]
    pub fn inputs(&mut self, params: &Params, outputs: u32) -> u32 {
        for row in params.functions() {
            let Some(Answer { input, on }) = row.answer else {
                continue;
            };
            let acts = row.switches.is_none_or(|(output, action)| {
                (outputs & output.bit() != 0) == (action != FunctionAction::Off)
            });
            match (acts, on) {
                (true, true) => self.answers |= input.bit(),
                (true, false) => self.answers &= !input.bit(),
                (false, _) => {}
            }
        }
        let bit = Contact::bit_of;
        let held = [
            params.chuck_pressure_input(),
            params.tailstock_pressure_input(),
            params.enable_input(),
        ];
        let chuck = bit(params.chuck_input());
        let answered = params.functions().filter_map(|row| row.answer);
        // A chuck that no function opens is closed.
        let chuck = match answered
            .map(|answer| answer.input.bit())
            .any(|input| input == chuck)
        {
            true => 0,
            false => chuck,
        };
        let door = bit(params.door_input());
        let on = held
            .into_iter()
            .fold(self.answers | chuck, |all, input| all | bit(input));
        let on = on | self.turret.inputs(params, outputs);
        let switches = [Axis::X, Axis::Z].into_iter().zip(self.at_switch);
        let on = switches
            .filter(|(_, on)| *on)
            .filter_map(|(axis, _)| params.home_input(axis))
            .fold(on, |all, input| all | bit(input));
        let limits = [Axis::X, Axis::Z].into_iter().zip(self.at_limit);
        let on = limits
            .flat_map(|(axis, on)| {
                let inputs = [
                    params.limit_input_minus(axis),
                    params.limit_input_plus(axis),
                ];
                inputs.into_iter().zip(on)
            })
            .filter(|(_, on)| *on)
            .filter_map(|(input, _)| input)
            .fold(on, |all, input| all | bit(input));
        let on = (on & !self.set) | (self.levels & self.set);
        match self.door_open {
            true => on & !door,
            false => on | door,
        }
    }

    /// The same as levels at the board's inputs.
    #[must_use]
    pub fn wires(&mut self, params: &Params, outputs: u32) -> u32 {
        self.inputs(params, outputs) ^ params.inputs_inverted()
    }
}
