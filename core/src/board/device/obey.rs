//! The device's reactions to others, and to their silence: NMT master, gateway, operator's PDO.
//!
//! Must not know what the device sends.

use super::Device;
use super::served::Served;
use super::tell::HEARTBEAT_ERROR;
use crate::alarm::Code;
use crate::bus::{
    BoardCommand, Emcy, Frame, JogRequest, NmtEvent, NmtState, PdoCommunication, Service,
    StepRequest, WheelRequest,
};
use crate::params::Params;
use crate::tick::{Command, State};

/// The reaction of a running program to the loss of the gateway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Loss {
    Hold,
    Stop,
    CarryOn,
}

impl Loss {
    const fn of(params: &Params) -> Self {
        match params.gateway_loss() {
            0 => Self::Hold,
            1 => Self::Stop,
            _ => Self::CarryOn,
        }
    }
}

impl Device {
    pub(super) fn obey(&mut self, event: NmtEvent, params: &Params) {
        match event {
            NmtEvent::Entered(NmtState::Stopped) => {
                self.halt();
                self.end_transfer(params);
            }
            NmtEvent::Entered(_) => {}
            NmtEvent::ResetNode => {
                self.halt();
                self.end_transfer(params);
                self.restarts = true;
            }
            NmtEvent::ResetCommunication => {
                self.end_transfer(params);
                self.values.reset_communication(params);
                let boot_up = self.nmt.boot();
                self.say(boot_up);
            }
        }
    }

    /// A controlled stop, if anything moves or is about to move.
    fn halt(&mut self) {
        self.values.program_buffer.close();
        if !self.values.snapshot.is_at_rest() {
            self.values.command(Command::Halt(Code::NetworkStop));
        }
    }

    pub(super) fn end_transfer(&mut self, params: &Params) {
        let mut served = Served {
            values: &mut self.values,
            params,
        };
        self.sdo.reset(&mut served);
        self.answers.clear();
    }

    /// Starts the application again, with the set in force if there is no other.
    pub(super) fn restart(&mut self, params: &Params) {
        self.restarts = false;
        self.values.reset_communication(params);
        self.values.begin_anew(params);
        let boot_up = self.nmt.boot();
        self.say(boot_up);
    }

    /// RPDO1, 2, 3 or 4.
    pub(super) fn process(&mut self, service: Service, frame: &Frame, params: &Params) {
        let [command, jog, step, wheel] =
            self.values.pdos.received().map(PdoCommunication::is_valid);
        match service {
            Service::Rpdo1 if command => self.command_of(frame, params),
            Service::Rpdo2 if jog => {
                if let Some(request) = JogRequest::payload(frame) {
                    self.values.jog(&request, params);
                }
            }
            Service::Rpdo3 if step => {
                if let Some(request) = StepRequest::payload(frame) {
                    self.values.step(&request, params);
                }
            }
            Service::Rpdo4 if wheel => {
                if let Some(request) = WheelRequest::payload(frame) {
                    self.values.wheel(&request, params);
                }
            }
            _ => {}
        }
    }

    fn command_of(&mut self, frame: &Frame, params: &Params) {
        let Some(raw) = BoardCommand::raw(frame) else {
            return;
        };
        let values = &mut self.values;
        // The objects from 5000h:03 on, one byte each.
        for (sub, value) in (3..).zip(raw.settings) {
            values.setting(sub, *value);
        }
        if let Some(order) = raw.order
            && self.gate.is_new(raw.count, order)
            && values.is_fresh((raw.count, order), raw.echo, params)
        {
            self.gate.take(raw.count, raw.order);
            // A refused order is in the event log.
            let _ = values.order(order, params);
        }
        values.count = self.gate.count();
    }

    /// The gateway is lost.
    pub(super) fn lose(&mut self, params: &Params) {
        if let State::Homing = self.values.snapshot.state {
            self.values.command(Command::Halt(Code::HomeCancelled));
        }
        if !self.values.snapshot.in_program {
            return;
        }
        let loss = Loss::of(params);
        if loss == Loss::Stop {
            // The alarm has an emergency message of its own.
            self.values.command(Command::Halt(Code::GatewayLost));
            return;
        }
        if loss == Loss::Hold {
            self.values.command(Command::Hold);
        }
        self.values.warn(Code::GatewayLost);
        self.values.emcy.raise(Emcy {
            code: HEARTBEAT_ERROR,
            ..Emcy::of_alarm(Code::GatewayLost.number())
        });
    }
}
