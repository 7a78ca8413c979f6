//! Reads objects of the board and of drives over a live bus. Nothing is written and nothing moves.
//!
//! A question is one SDO upload. While another client has a transfer with the node, it is not asked. Questions and answers
//! go to the caller, who hears them like all other frames.

use std::time::{Duration, Instant};

use leadscrew_can::{Can, CanError, Packet, Received, Stamp};
use leadscrew_core::bus::{CobId, Frame, NodeId, Object, Service};

use super::machine::Machine;
use crate::block::{INPUTS, OUTPUTS};

/// The wait for an answer.
const ANSWER: Duration = Duration::from_millis(300);
/// Without a frame of a transfer for this time, nobody has one with the node.
const QUIET: Duration = Duration::from_millis(24);
/// How long such a pause is waited for.
const PATIENCE: Duration = Duration::from_secs(1);

/// What the board is asked.
const BOARD: &[Object] = &[
    Object::new(0x1006, 0),
    Object::new(0x1016, 1),
    Object::new(0x1017, 0),
    // Its alarm, which its status has only where somebody has started it.
    Object::new(0x5001, 4),
];
/// What each drive is asked.
const DRIVE: &[Object] = &[
    Object::new(0x1006, 0),
    Object::new(0x1016, 1),
    Object::new(0x1017, 0),
    Object::new(0x1400, 1),
    Object::new(0x1400, 2),
    Object::new(0x1800, 1),
    Object::new(0x1800, 2),
    Object::new(0x60C2, 1),
    Object::new(0x60C2, 2),
    Object::new(0x6060, 0),
    Object::new(0x6061, 0),
];
/// What the block of inputs and outputs is asked.
const BLOCK: &[Object] = &[
    OUTPUTS,
    Object::new(0x1017, 0),
    Object::new(0x1400, 1),
    Object::new(0x1800, 1),
];
/// So often, where it does not answer: a rule needs as many questions.
const TRIES: usize = 3;
/// Mappings: the count first, then as many entries.
const MAPPINGS: [u16; 2] = [0x1600, 0x1A00];

/// What is read, for people.
pub const READ: &str = "board 1006h 1016h:01 1017h 5001h:04; drives 1006h 1016h:01 1017h 1400h:01 1400h:02 1600h 1800h:01 1800h:02 1A00h \
    60C2h 6060h 6061h; I/O block 1017h 1400h:01 1600h 1800h:01 1A00h 6000h 6200h";

/// Reads all of it. `hear` gets every frame, the questions too.
///
/// # Errors
/// The bus is gone.
pub fn ask(
    can: &mut dyn Can,
    machine: &Machine,
    hear: &mut dyn FnMut(Stamp, &Packet),
    go_on: &dyn Fn() -> bool,
) -> Result<(), CanError> {
    let mut asking = Asking { can, hear };
    for object in BOARD {
        if !go_on() || !asking.read(machine.board, *object)?.is_there() {
            break;
        }
    }
    for drive in &machine.drives {
        let mut there = true;
        for object in DRIVE {
            there = there && go_on() && asking.read(drive.node, *object)?.is_there();
        }
        if there {
            asking.read_mappings(drive.node)?;
        }
    }
    if let Some(block) = machine.block {
        let mut there = false;
        for _ in 0..TRIES {
            there = there || go_on() && asking.read(block, INPUTS)?.is_there();
        }
        for object in BLOCK {
            there = there && go_on() && asking.read(block, *object)?.is_there();
        }
        if there {
            asking.read_mappings(block)?;
        }
    }
    Ok(())
}

/// An answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// The lowest byte of the value.
    Value(u8),
    Refused,
    Silent,
}

impl Answer {
    fn is_there(self) -> bool {
        self != Self::Silent
    }
}

struct Asking<'a> {
    can: &'a mut dyn Can,
    hear: &'a mut dyn FnMut(Stamp, &Packet),
}

impl Asking<'_> {
    fn read_mappings(&mut self, node: NodeId) -> Result<(), CanError> {
        for index in MAPPINGS {
            if let Answer::Value(count) = self.read(node, Object::new(index, 0))? {
                for sub in 1..=count.min(16) {
                    self.read(node, Object::new(index, sub))?;
                }
            }
        }
        Ok(())
    }

    fn read(&mut self, node: NodeId, object: Object) -> Result<Answer, CanError> {
        let request = CobId::of(Service::SdoRequest, node);
        let reply = CobId::of(Service::SdoReply, node);
        let end = Instant::now() + PATIENCE;
        while self
            .wait(QUIET, |frame| [request, reply].contains(&frame.id()))?
            .is_some()
        {
            if Instant::now() > end {
                return Ok(Answer::Refused);
            }
        }
        let [low, high] = object.index.to_le_bytes();
        let Some(question) = Frame::new(request, &[0x40, low, high, object.sub, 0, 0, 0, 0]) else {
            return Ok(Answer::Silent);
        };
        self.can.send(&[question])?;
        (self.hear)(Stamp::now(), &Packet::Frame(question));
        let answer = self.wait(ANSWER, |frame| {
            frame.id() == reply && frame.payload().get(1..4) == Some(&[low, high, object.sub])
        })?;
        Ok(match answer.as_ref().map(Frame::payload) {
            None => Answer::Silent,
            Some([command, _, _, _, value, ..]) if command >> 5 == 2 => Answer::Value(*value),
            Some(_) => Answer::Refused,
        })
    }

    /// Hears until such a frame comes, or for so long.
    fn wait(
        &mut self,
        time: Duration,
        wanted: impl Fn(&Frame) -> bool,
    ) -> Result<Option<Frame>, CanError> {
        let end = Instant::now() + time;
        let mut packets: Vec<Received> = Vec::new();
        let mut found = None;
        while found.is_none() {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            packets.clear();
            self.can.receive(&mut packets, left)?;
            for Received { time, packet } in &packets {
                (self.hear)(*time, packet);
                if let Some(frame) = packet.frame().filter(|frame| wanted(frame)) {
                    found.get_or_insert(*frame);
                }
            }
        }
        Ok(found)
    }
}
