//! For tests: a board in this process, and an end of its bus with faults.

use std::time::Duration;

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_can::{Can, CanError, Filter, Packet, Received, Stamp};
use leadscrew_core::bus::{Abort, BoardState, CobId, FdFrame, Frame, NodeId, Service};
use leadscrew_core::call::Position;
use leadscrew_core::link::{Status, VERSION};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axes, Rpm, TurnRate, Turns};

use super::{Inside, Link};

/// A board at power-up with its drives.
pub fn machine(flash: Flash) -> Inside {
    machine_of(&Params::sheets(), flash)
}

/// The same with these parameters.
pub fn machine_of(params: &Params, flash: Flash) -> Inside {
    machine_with(params, &PlantOptions::default(), flash)
}

/// The same with another plant.
pub fn machine_with(params: &Params, options: &PlantOptions, flash: Flash) -> Inside {
    let mut sim = Sim::power_up(params, options, flash).map(Box::new).unwrap();
    sim.join(NodeId::BOARD).unwrap();
    let tick_us = sim.tick_us();
    Inside::new(sim, tick_us)
}

/// A client of the board.
pub fn link(inside: &Inside) -> Link {
    Link::on(Box::new(inside.clone()), NodeId::BOARD)
}

/// The status of a board without work.
pub fn status() -> Status {
    Status {
        version: VERSION,
        tick: 0,
        state: BoardState::Idle,
        alarm: None,
        in_program: false,
        left: None,
        line: 0,
        number: 0,
        position: Position::default(),
        spindle: Turns::default(),
        speed: TurnRate::default(),
        command: Rpm::default(),
        hold: false,
        single_block: false,
        feed_percent: 100,
        rapid_percent: 100,
        spindle_percent: 100,
        sync_error: None,
        late: 0,
        program: 0,
        next_call: 0,
        credit: 2048,
        newest_event: 0,
        signals: 0,
        referenced: Axes::ALL,
        unreferenced: Axes::NONE,
        parameters: 0,
    }
}

/// The fate of a frame from this side.
pub enum Fate {
    /// It arrives.
    Arrives,
    /// It arrives, and another node sends a frame after it.
    AndThen(Frame),
    /// It does not arrive. The frame inside is heard instead.
    Lost(Option<Frame>),
    /// The bus is closed.
    Closed,
}

/// An end of the bus whose frames pass through `sent` and `heard`.
struct Between<S, H> {
    inside: Inside,
    /// Decides the fate of each frame from this side.
    sent: S,
    /// Changes each frame of the board before this side hears it.
    heard: H,
    /// The next frame to hear, before frames of the board.
    next: Option<Frame>,
}

/// A client on whose end of the bus a node does not do what is written to it where that `is_meant` (the first four bytes
/// of the request, as SDO has them: command, index, sub-index): it `says` so, or nothing at all.
pub fn wayward(
    inside: &Inside,
    node: NodeId,
    is_meant: impl Fn([u8; 4]) -> bool + Send + 'static,
    says: bool,
) -> Link {
    let sent = move |frame: &Frame| {
        let request = CobId::of(Service::SdoRequest, node);
        let [command, low, high, sub, ..] = *frame.payload() else {
            return Fate::Arrives;
        };
        if frame.id() != request || !is_meant([command, low, high, sub]) {
            return Fate::Arrives;
        }
        let [a, b, c, d] = Abort::Access.code().to_le_bytes();
        let refusal = [0x80, low, high, sub, a, b, c, d];
        let refusal = Frame::new(CobId::of(Service::SdoReply, node), &refusal);
        Fate::Lost(refusal.filter(|_| says))
    };
    let mut link = between(inside, sent, |frame| frame);
    link.set_patience(Duration::from_millis(50));
    link
}

/// A client whose frames to and from the board pass through `sent` and `heard`.
pub fn between(
    inside: &Inside,
    sent: impl FnMut(&Frame) -> Fate + Send + 'static,
    heard: impl FnMut(Frame) -> Frame + Send + 'static,
) -> Link {
    let inside = inside.clone();
    let end = Between {
        inside,
        sent,
        heard,
        next: None,
    };
    Link::on(Box::new(end), NodeId::BOARD)
}

impl<S, H> Can for Between<S, H>
where
    S: FnMut(&Frame) -> Fate + Send,
    H: FnMut(Frame) -> Frame + Send,
{
    fn name(&self) -> &str {
        "between"
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        for frame in frames {
            match (self.sent)(frame) {
                Fate::Arrives => self.inside.send(&[*frame])?,
                Fate::AndThen(said) => {
                    self.inside.send(&[*frame, said])?;
                    self.next = Some(said);
                }
                Fate::Lost(answer) => self.next = answer,
                Fate::Closed => {
                    let name = self.name().into();
                    return Err(CanError::Closed { name });
                }
            }
        }
        Ok(())
    }

    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError> {
        self.inside.use_fd(data_kbit)
    }

    fn send_fd(&mut self, frames: &[FdFrame]) -> Result<(), CanError> {
        self.inside.send_fd(frames)
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let next = self.next.take().map(|frame| Received {
            time: Stamp::now(),
            packet: Packet::Frame(frame),
        });
        let count = next.iter().len();
        into.extend(next);
        let patience = if count > 0 { Duration::ZERO } else { patience };
        let before = into.len();
        let received = self.inside.receive(into, patience)?;
        for received in into.iter_mut().skip(before) {
            if let Packet::Frame(frame) = &mut received.packet {
                *frame = (self.heard)(*frame);
            }
        }
        Ok(count + received)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.inside.listen_for(filters)
    }

    fn dropped(&self) -> Result<u64, CanError> {
        Ok(0)
    }
}
