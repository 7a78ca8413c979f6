//! The board's side of the bus, and the state of its controller by error frames.

use std::time::Duration;

use leadscrew_can::{Address, BitRate, Can, Fault, Packet, Received};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::Both;
use leadscrew_core::bus::{BusState, Controller, ErrorCounts, FdFrame, Frame};
use leadscrew_core::params::Params;

/// A frame that a CANopen node receives.
#[derive(Clone, Copy, Debug)]
pub enum Heard<'a> {
    /// A classical frame.
    Frame(&'a Frame),
    /// A frame of CAN FD.
    Fd(&'a FdFrame),
}

/// An open bus.
pub struct Wire {
    can: Box<dyn Can>,
    /// The data rate of CAN FD frames, in kbit/s; `None` where none are sent.
    fd_kbit: Option<u32>,
    heard: Vec<Received>,
    controller: Controller,
    /// The interface has no controller that the kernel would restart.
    is_virtual: bool,
    /// Frames sent, and received.
    pub counts: [u64; 2],
}

impl Wire {
    /// Opens the bus; an adapter gets the bit rate of the parameters (9020). Where the parameters ask for a CAN FD
    /// frame (9031), the bus has to carry CAN FD.
    pub fn open(address: &Address, params: &Params) -> Outcome<Self> {
        let kbit = params.bus_kbit();
        let rate = BitRate::of_kbit(kbit).ok_or_else(|| {
            Failure::WrongBecause(Both::same(format!("no adapter has {kbit} kbit/s (9020)")))
        })?;
        let mut wire = Self::on(leadscrew_can::open(address, rate).map_err(Failure::bus)?);
        wire.is_virtual = match address {
            Address::SocketCan(name) => leadscrew_can::is_virtual(name),
            _ => true,
        };
        if params.setpoint_frame() == 1 {
            wire.use_fd(params.fd_kbit())?;
        }
        Ok(wire)
    }

    /// From now on the bus carries CAN FD frames with their data at this rate. An adapter is told a new rate.
    pub fn use_fd(&mut self, kbit: u32) -> Outcome {
        if self.fd_kbit != Some(kbit) {
            self.can.use_fd(kbit).map_err(Failure::bus)?;
            self.fd_kbit = Some(kbit);
        }
        Ok(())
    }

    fn on(can: Box<dyn Can>) -> Self {
        Self {
            can,
            is_virtual: true,
            fd_kbit: None,
            heard: Vec::new(),
            controller: Controller::default(),
            counts: [0; 2],
        }
    }

    /// The user's name of the bus.
    pub fn name(&self) -> &str {
        self.can.name()
    }

    /// The state of the controller, by its error frames.
    pub const fn controller(&self) -> Controller {
        self.controller
    }

    /// Takes a bus that is open already.
    #[cfg(test)]
    pub fn open_already(can: Box<dyn Can>, is_virtual: bool) -> Self {
        Self {
            is_virtual,
            ..Self::on(can)
        }
    }

    /// True where only the board itself can restart a controller that has left the bus.
    pub const fn is_virtual(&self) -> bool {
        self.is_virtual
    }

    /// Notes that the controller was restarted, and is in order.
    pub fn restart(&mut self) {
        self.controller = Controller::default();
    }

    /// Sends frames.
    pub fn send(&mut self, frames: &[Frame]) -> Outcome {
        if frames.is_empty() {
            return Ok(());
        }
        let [sent, _] = &mut self.counts;
        *sent += frames.len() as u64;
        self.can.send(frames).map_err(Failure::bus)
    }

    /// Sends a CAN FD frame after all frames sent before.
    pub fn send_fd(&mut self, frame: &FdFrame) -> Outcome {
        let [sent, _] = &mut self.counts;
        *sent += 1;
        self.can.send_fd(&[*frame]).map_err(Failure::bus)
    }

    /// Waits at most `patience` for frames, and passes on each CANopen frame in the order of arrival. Gives their number.
    pub fn listen(&mut self, patience: Duration, mut to: impl FnMut(Heard<'_>)) -> Outcome<usize> {
        self.heard.clear();
        self.can
            .receive(&mut self.heard, patience)
            .map_err(Failure::bus)?;
        let mut count = 0;
        let [_, received] = &mut self.counts;
        for heard in &self.heard {
            note(&mut self.controller, &heard.packet);
            match &heard.packet {
                Packet::Frame(frame) => to(Heard::Frame(frame)),
                Packet::Fd(frame) => match frame.frame() {
                    Some(frame) => to(Heard::Fd(&frame)),
                    None => continue,
                },
                // A CANopen node does not receive other kinds of frames.
                _ => continue,
            }
            *received += 1;
            count += 1;
        }
        Ok(count)
    }

    /// Frames that were lost because the receive buffer was full.
    pub fn dropped(&self) -> u64 {
        self.can.dropped().unwrap_or(0)
    }
}

/// Takes the controller's state from an error frame.
fn note(controller: &mut Controller, packet: &Packet) {
    let Packet::Error(error) = packet else {
        return;
    };
    if let Some((sending, receiving)) = error.counters() {
        controller.errors = ErrorCounts { sending, receiving };
    }
    // The worst fault comes first.
    for fault in error.faults() {
        let state = match fault {
            Fault::BusOff => BusState::Off,
            Fault::Passive => BusState::Passive,
            Fault::Restarted => BusState::Active,
            // Active again, or on the way there. Only a restart ends bus-off.
            Fault::Active | Fault::Warning if controller.state == BusState::Passive => {
                BusState::Active
            }
            _ => continue,
        };
        controller.state = state;
        return;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_can::{ErrorFrame, pair};

    /// Classes of error and states of the controller, as in the kernel.
    const CONTROLLER: u32 = 0x004;
    const BUS_OFF: u32 = 0x040;
    const RESTARTED: u32 = 0x100;

    #[test]
    fn error_frames_tell_how_the_controller_is() {
        let (mut other, end) = pair();
        let mut wire = Wire::on(Box::new(end));
        let mut after = |class, state, sending, receiving| {
            let data = [0, state, 0, 0, 0, 0, sending, receiving];
            let error = ErrorFrame { class, data };
            other.inject(Packet::Error(error)).unwrap();
            wire.listen(Duration::ZERO, |_| {}).unwrap();
            let Controller { state, errors } = wire.controller();
            (state, errors.sending, errors.receiving)
        };
        assert_eq!(after(CONTROLLER, 0x08, 97, 3), (BusState::Active, 97, 3));
        assert_eq!(after(CONTROLLER, 0x20, 128, 3), (BusState::Passive, 128, 3));
        assert_eq!(after(CONTROLLER, 0x08, 120, 3), (BusState::Active, 120, 3));
        assert_eq!(after(BUS_OFF, 0, 248, 3), (BusState::Off, 248, 3));
        // A message that the controller is in order does not end bus-off.
        assert_eq!(after(CONTROLLER, 0x40, 0, 3), (BusState::Off, 0, 3));
        assert_eq!(after(RESTARTED, 0, 0, 3), (BusState::Active, 0, 3));
    }
}
