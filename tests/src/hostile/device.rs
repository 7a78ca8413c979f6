//! Frames of any node to a board at work on a bus: its whole dictionary, its process data, its network commands.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::board::Event;
use leadscrew_core::bus::{CobId, Frame, NodeId, Object, Order, SdoProtocol, Service};
use leadscrew_core::link::{ImageReader, ImageWriter};
use leadscrew_core::params::Params;

use crate::gateway::{Gateway, NODE, Upload};
use crate::machine::{calls, machine};

/// The most ticks.
const TICKS: u32 = 3_000;

/// The longest way of an axis in a tick with any parameter set: 240 m/min for 10 ms.
const FARTHEST: i64 = 40_000_001;

/// The program that runs meanwhile.
const WORK: &str =
    "G98 G0 X20 Z5\nM3 S900\nG1 X24 Z-4 F1200\nG75 R0.2\nG75 X20 P10000 F900\nG0 X30 Z8\nM30\n";

/// The first byte chooses whether a program runs. After it come records of ten bytes: the sender of the frame, the number
/// of ticks before it, and its eight bytes.
///
/// # Panics
/// Where an axis moves farther in a tick than any parameter set allows, or moves while the machine says that it is idle;
/// where the board sends without end, or has an unusable parameter set afterwards.
pub fn device(data: &[u8]) {
    let Some((choice, records)) = data.split_first() else {
        return;
    };
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    if choice & 1 == 1 {
        let program = calls(WORK, &params);
        Upload::new(1, &program).feed(&mut gateway, &mut sim);
        gateway.order(&mut sim, Order::Run);
    }
    let mut left = TICKS;
    let mut watch = Watch::default();
    for record in records.chunks_exact(10) {
        let (Some((&[who, wait], payload)), true) = (record.split_first_chunk(), left > 0) else {
            break;
        };
        let ticks = u32::from(wait & 0x3F).min(left);
        left -= ticks;
        for _ in 0..ticks {
            watch.tick(&mut sim);
        }
        let length = 8 - usize::from(wait >> 6);
        if let Some(frame) = from(who, payload.get(..length).unwrap_or(payload)) {
            sim.receive(&frame);
        }
        sim.settle();
        listen(&mut sim);
    }
    for _ in 0..50 {
        watch.tick(&mut sim);
    }
    whole(&mut sim);
}

/// One frame in four is for the SDO server. The others are of any service of the board, of a drive, or of no node.
fn from(who: u8, payload: &[u8]) -> Option<Frame> {
    let id = match who {
        0..=95 => CobId::of(Service::SdoRequest, NODE),
        96..=127 => CobId::of(Service::Rpdo1, NODE),
        128..=143 => CobId::new(0)?,
        144..=159 => CobId::of(Service::Heartbeat, NodeId::new(127)?),
        _ => CobId::new(u16::from(who - 160) * 23 % 0x800)?,
    };
    Frame::new(id, payload)
}

/// Reads the board's answers, which must end.
fn listen(sim: &mut Sim) {
    let sent = core::iter::from_fn(|| sim.transmit()).take(1_000).count();
    assert!(sent < 1_000, "it sends without end");
}

/// The set in force afterwards must work.
fn whole(sim: &mut Sim) {
    let mut gateway = Gateway::default();
    let image = Object::new(0x5010, 1);
    // A node that was stopped, or does not listen for another reason, sends nothing.
    let Ok(bytes) = gateway.read(sim, image, SdoProtocol::Segmented) else {
        return;
    };
    assert_eq!(bytes.len(), ImageWriter::BYTES as usize);
    let mut params = Params::sheets();
    let mut reader = ImageReader::new();
    let read = reader
        .take(&bytes, &mut params)
        .and_then(|()| reader.finish(&params));
    assert_eq!(read, Ok(()));
    assert!(params.validate().is_ok(), "a set that cannot work");
}

/// Checks rows one by one.
#[derive(Default)]
struct Watch {
    last: Option<Row>,
    /// Rows that are not checked: the drives have come up, perhaps with another scale.
    skips: u32,
}

impl Watch {
    fn tick(&mut self, sim: &mut Sim) {
        let row = sim.step();
        listen(sim);
        while let Some(event) = sim.event() {
            if event == Event::Ready {
                self.skips = 3;
            }
        }
        let Some(row) = row else {
            return;
        };
        let last = self.last.replace(row);
        if self.skips > 0 {
            self.skips -= 1;
            return;
        }
        let Some(last) = last else {
            return;
        };
        let x = (row.position.x - last.position.x).nm().abs();
        let z = (row.position.z - last.position.z).nm().abs();
        assert!(x.max(z) <= FARTHEST, "it jumps: {last:?} {row:?}");
        let idle = last.doing == Doing::Idle && row.doing == Doing::Idle;
        assert!(!idle || x == 0 && z == 0, "moves when idle: {row:?}");
    }
}
