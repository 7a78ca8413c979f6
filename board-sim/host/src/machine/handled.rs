//! What a hand does at this machine: contacts, inputs, power and time.

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_board_sim::{TurretFault, fit_switches, places};
use leadscrew_common::failure::Outcome;
use leadscrew_core::params::{Contact, Params};
use leadscrew_desk::clock::Speed;
use leadscrew_desk::control::{Door, Power, Request, View};
use leadscrew_desk::hand::{Contacts, Handled, carry_out, numbers};

use super::{Machine, no_plant, say};

impl Machine {
    /// Carries out what a hand has asked for.
    pub(super) fn be_handled(&mut self) {
        let Some(mut hand) = self.hand.take() else {
            return;
        };
        hand.answer(|request| carry_out(self, request));
        self.hand = Some(hand);
    }

    /// Board and drives lose their power; the axes stay where they are.
    fn switch_off(&mut self) -> Outcome {
        if self.unplugged {
            return Ok(());
        }
        let params = self.board.params();
        self.options.at = places(&self.plant, params).unwrap_or(self.options.at);
        // What is being written is torn, as by any loss of power.
        self.flash.power(false);
        self.unplugged = true;
        say("the power is switched off");
        match &self.state {
            Some(state) => state.save(&self.flash),
            None => Ok(()),
        }
    }

    /// Board and drives come up with what the flash holds.
    fn switch_on(&mut self) -> Outcome {
        if !self.unplugged {
            return Ok(());
        }
        self.begin_anew(Some(self.options.at))?;
        let params = self.board.params().clone();
        self.options.servos = self.drives.servos(&params)?;
        self.plant = fitted(&params, &self.options)?;
        self.tick_us = params.tick_us();
        self.unplugged = false;
        Ok(())
    }
}

/// A plant with the switches of its machine.
pub(super) fn fitted(params: &Params, options: &PlantOptions) -> Outcome<Plant> {
    let mut plant = Plant::new(params, options).map_err(|error| no_plant(&error))?;
    fit_switches(&mut plant, params);
    Ok(plant)
}

impl Handled for Machine {
    fn contacts(&self) -> Contacts {
        self.contacts
    }

    fn touch(&mut self, contacts: Contacts) {
        self.contacts = contacts;
        self.around.open_door(contacts.door == Door::Open);
    }

    fn has_door(&self) -> bool {
        self.board.params().door_input() != 0
    }

    fn set_input(&mut self, input: Contact, on: Option<bool>) {
        self.around.set(input, on);
    }

    fn turn_wheel(&mut self, counts: i32) {
        self.wheel.turn(counts);
    }

    fn spoil_turret(&mut self, fault: TurretFault) {
        self.around.spoil_turret(fault);
    }

    fn spoil(&mut self, _request: &Request) -> bool {
        false
    }

    fn power(&mut self, to: Power) -> Outcome {
        if to != Power::On {
            self.switch_off()?;
        }
        if to != Power::Off {
            self.switch_on()?;
        }
        Ok(())
    }

    fn set_speed(&mut self, speed: Speed) {
        self.speed = speed;
    }

    fn end(&mut self) {
        self.last = Some(self.ticks);
    }

    fn view(&self) -> View {
        let ticker = self.board.ticker();
        let [inputs, outputs] = match self.unplugged {
            true => [0, 0],
            false => [ticker.machine_inputs(), ticker.machine_outputs()],
        };
        View {
            name: self
                .hand
                .as_ref()
                .map_or_else(String::new, |hand| hand.name().to_string()),
            pid: std::process::id(),
            node: self.node.get(),
            power: !self.unplugged,
            door: self.contacts.door,
            estop: self.contacts.estop,
            hold: self.contacts.hold,
            inputs: numbers(inputs),
            outputs: numbers(outputs),
            speed: self.speed.thousandths(),
            tick_us: self.tick_us,
            ticks: self.ticks,
            slips: 0,
            lost_ticks: 0,
            clients: 0,
            dropped: 0,
            outdated: false,
        }
    }
}
