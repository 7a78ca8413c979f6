//! A drive's objects by SDO: the values that it gives, those that it takes and when, and those that it keeps.

extern crate std;

use core::time::Duration;
use std::vec::Vec;

use super::super::*;
use leadscrew_core::bus::{
    Abort, CobId, Controlword, DriveStatus, Emcy, Mapped, Mode, NmtCommand, NmtState, NodeId,
    Object, SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoUpload, Setpoints, SpindleCommand,
    SyncProducer,
};
use leadscrew_core::params::Entry;

const NOW: Duration = Duration::ZERO;
const PATIENCE: Duration = Duration::from_secs(1);

/// A plant whose drives have booted.
struct Bench {
    plant: Plant,
    sync: SyncProducer,
}

impl Bench {
    fn with(params: &Params) -> Self {
        Self {
            plant: Plant::new(params, &PlantOptions::default()).unwrap(),
            sync: SyncProducer::new(),
        }
    }

    fn new() -> Self {
        let mut bench = Self::with(&Params::sheets());
        assert_eq!(bench.tick().len(), 7, "boot-up messages");
        bench
    }

    fn tick(&mut self) -> Vec<Frame> {
        self.plant.advance();
        let mut heard = Vec::new();
        let sync = self.sync.next();
        self.plant.exchange(&[sync], |frame| heard.push(frame));
        heard
    }

    fn hear(&mut self, frame: &Frame) -> Vec<Frame> {
        let mut heard = Vec::new();
        self.plant.hear(frame, |frame| heard.push(frame));
        heard
    }

    fn nmt(&mut self, command: NmtCommand) {
        assert!(self.hear(&command.frame(None)).is_empty());
    }

    fn read(&mut self, node: NodeId, index: u16, sub: u8) -> Result<u32, Abort> {
        let mut bytes = [0; 8];
        let mut buffer = SdoBuffer::new(&mut bytes);
        let object = Object::new(index, sub);
        let mut upload =
            SdoUpload::new(node, object, &mut buffer, SdoProtocol::Short, PATIENCE, NOW);
        while let Some(request) = upload.poll(NOW) {
            for answer in self.hear(&request) {
                upload.receive(&answer, NOW);
            }
        }
        result(upload.outcome())?;
        let mut raw = [0; 4];
        let read = buffer.bytes();
        raw[..read.len()].copy_from_slice(read);
        Ok(u32::from_le_bytes(raw))
    }

    fn write(
        &mut self,
        node: NodeId,
        index: u16,
        sub: u8,
        value: u32,
        bytes: usize,
    ) -> Result<(), Abort> {
        let data = value.to_le_bytes();
        let object = Object::new(index, sub);
        let mut download = SdoDownload::new(
            node,
            object,
            &data[..bytes],
            SdoProtocol::Short,
            PATIENCE,
            NOW,
        );
        while let Some(request) = download.poll(NOW) {
            for answer in self.hear(&request) {
                download.receive(&answer, NOW);
            }
        }
        result(download.outcome())
    }
}

fn result(outcome: Option<Result<(), SdoError>>) -> Result<(), Abort> {
    match outcome.expect("answered at once") {
        Ok(()) => Ok(()),
        Err(SdoError::Refused(code)) => Err(Abort::from_code(code).unwrap()),
        Err(error) => panic!("{error:?}"),
    }
}

#[test]
fn drives_are_where_the_parameters_say() {
    let mut params = Params::sheets();
    for (key, node) in [("9015.X", 70), ("9015.C", 32), ("9016", 5), ("9014", 2)] {
        params.set(Entry::find_text(key).unwrap(), node).unwrap();
    }
    let mut bench = Bench::with(&params);
    let mut nodes: Vec<_> = bench
        .tick()
        .iter()
        .filter_map(|frame| frame.id().service().map(|(_, node)| node.get()))
        .collect();
    nodes.sort_unstable();
    assert_eq!(nodes, [5, 6, 17, 32, 70], "boot-up messages");
    let mut second_rpdo = |node| bench.read(NodeId::new(node).unwrap(), 0x1601, 2);
    // A spindle has mode and speed in its second RPDO at any node, and an axis the mode alone.
    assert_eq!(second_rpdo(6), Ok(0x60FF_0020));
    assert_eq!(second_rpdo(32), Err(Abort::NoSubIndex));
}

#[test]
fn a_drive_says_what_it_is_and_how() {
    let mut bench = Bench::new();
    let x = NodeId::DRIVE_X;
    for (index, sub, expected) in [
        (0x1000, 0, Ok(0x0002_0192)),
        (0x1018, 2, Ok(0x4C53_4452)),
        (0x1018, 4, Ok(16)),
        (0x1400, 1, Ok(0x210)),
        (0x1600, 0, Ok(2)),
        (0x1600, 1, Ok(0x6040_0010)),
        (0x1600, 2, Ok(0x607A_0020)),
        (0x1600, 11, Ok(0)),
        (0x1600, 12, Err(Abort::NoSubIndex)),
        (0x1800, 1, Ok(0x4000_0190)),
        (0x1800, 2, Ok(4)),
        (0x1A00, 2, Ok(0x6064_0020)),
        (0x6041, 0, Ok(0x0250)),
        (0x6061, 0, Ok(8)),
        (0x6064, 0, Ok(0)),
        (0x60C2, 1, Ok(1)),
        (0x60C2, 2, Ok(0xFD)),
        (0x60C2, 3, Err(Abort::NoSubIndex)),
        // Off, until a machine needs them.
        (0x1401, 1, Ok(0x8000_0310)),
        (0x1801, 1, Ok(0xC000_0290)),
        (0x1601, 1, Ok(0x6060_0008)),
        (0x1A01, 2, Ok(0x60FD_0020)),
        (0x6098, 0, Ok(37)),
        (0x6099, 1, Ok(200_000)),
        (0x6099, 3, Err(Abort::NoSubIndex)),
        (0x60FE, 1, Err(Abort::NoObject)),
    ] {
        assert_eq!(bench.read(x, index, sub), expected, "{index:04X}h:{sub}");
    }
    // A spindle also takes its mode and speed.
    assert_eq!(bench.read(NodeId::SPINDLE_1, 0x1601, 2), Ok(0x60FF_0020));
    assert_eq!(bench.read(NodeId::SPINDLE_4, 0x1018, 4), Ok(35));
    // Other tools use block transfer.
    let mut bytes = [0; 8];
    let mut buffer = SdoBuffer::new(&mut bytes);
    let object = Object::new(0x1000, 0);
    let mut upload = SdoUpload::new(x, object, &mut buffer, SdoProtocol::Block, PATIENCE, NOW);
    while let Some(request) = upload.poll(NOW) {
        for answer in bench.hear(&request) {
            upload.receive(&answer, NOW);
        }
    }
    assert_eq!(upload.outcome(), Some(Ok(())));
}

#[test]
fn limits_change_in_every_state_communication_in_pre_operational_alone() {
    let mut bench = Bench::new();
    let z = NodeId::DRIVE_Z;
    bench.nmt(NmtCommand::Start);
    assert_eq!(bench.write(z, 0x607F, 0, 500_000, 4), Ok(()));
    assert_eq!(bench.read(z, 0x607F, 0), Ok(500_000));
    for (index, sub, value, bytes, abort) in [
        (0x607F, 0, 0, 4, Abort::TooLow),
        (0x607F, 0, u32::MAX, 4, Abort::TooHigh),
        (0x607F, 0, 1, 2, Abort::TooShort),
        (0x60C2, 1, 1, 2, Abort::TooLong),
        (0x60C2, 1, 2, 1, Abort::State),
        (0x1800, 2, 8, 1, Abort::State),
        (0x6064, 0, 1, 4, Abort::ReadOnly),
        (0x1000, 0, 1, 4, Abort::ReadOnly),
        (0x2105, 3, 1, 1, Abort::NoObject),
    ] {
        assert_eq!(
            bench.write(z, index, sub, value, bytes),
            Err(abort),
            "{index:04X}h:{sub}"
        );
    }
    bench.nmt(NmtCommand::PreOperational);
    assert_eq!(bench.write(z, 0x60C2, 1, 2, 1), Ok(()));
    assert_eq!(bench.write(z, 0x60C2, 2, 0xF9, 1), Err(Abort::TooLow));
    assert_eq!(bench.write(z, 0x60C2, 2, 1, 1), Err(Abort::TooHigh));
    assert_eq!(bench.write(z, 0x1800, 2, 241, 1), Err(Abort::Value));
    assert_eq!(bench.write(z, 0x1800, 2, 2, 1), Ok(()));
    bench.nmt(NmtCommand::Start);
    // From now on it answers at every second SYNC.
    let answers = (0..8)
        .flat_map(|_| bench.tick())
        .filter(|frame| DriveStatus::decode(frame).is_some_and(|(node, _)| node == z));
    assert_eq!(answers.count(), 4);
    // The other drives have not changed.
    assert_eq!(bench.read(NodeId::DRIVE_X, 0x1800, 2), Ok(4));
}

/// What `params push` writes for an axis that homes.
#[test]
fn an_axis_is_set_up_to_home() {
    let mut bench = Bench::new();
    let x = NodeId::DRIVE_X;
    for (index, sub, value, bytes) in [
        (0x1401, 1, 0x0310, 4),
        (0x1801, 2, 255, 1),
        (0x1801, 1, 0x0290 | 1 << 30, 4),
        (0x6098, 0, 24, 1),
        (0x6099, 1, 300_000, 4),
        (0x6099, 2, 10_000, 4),
        (0x609A, 0, 1_000_000, 4),
        (0x607C, 0, 0, 4),
    ] {
        let told = bench.write(x, index, sub, value, bytes);
        assert_eq!(told, Ok(()), "{index:04X}h:{sub}");
        assert_eq!(bench.read(x, index, sub), Ok(value), "{index:04X}h:{sub}");
    }
    // Methods that it does not have, and a report at every so many SYNCs.
    for method in [0, 3, 6, 15, 16, 31, 32, 36, 38, 0xFF] {
        assert_eq!(bench.write(x, 0x6098, 0, method, 1), Err(Abort::Value));
    }
    assert_eq!(bench.write(x, 0x1801, 2, 4, 1), Err(Abort::Value));
    bench.nmt(NmtCommand::Start);
    let report = |frames: Vec<Frame>| {
        let mut own = frames.into_iter().filter(|frame| frame.id().get() == 0x290);
        own.next().map(|frame| Vec::from(frame.payload()))
    };
    // At once, and then at every 16th SYNC.
    assert_eq!(report(bench.tick()), Some(Vec::from([8, 0, 0, 0, 0])));
    for _ in 1..16 {
        assert_eq!(report(bench.tick()), None);
    }
    assert_eq!(report(bench.tick()), Some(Vec::from([8, 0, 0, 0, 0])));
}

#[test]
fn a_mapping_is_emptied_before_it_is_filled_and_takes_what_belongs_there() {
    let mut bench = Bench::new();
    let x = NodeId::DRIVE_X;
    assert_eq!(bench.write(x, 0x1600, 0, 0, 1), Err(Abort::State), "in use");
    assert_eq!(bench.write(x, 0x1400, 1, 0x8000_0211, 4), Err(Abort::Value));
    assert_eq!(bench.write(x, 0x1400, 1, 0x8000_0210, 4), Ok(()));
    assert_eq!(bench.write(x, 0x1600, 1, 0x6040_0010, 4), Err(Abort::State));
    assert_eq!(bench.write(x, 0x1600, 0, 0, 1), Ok(()));
    assert_eq!(
        bench.write(x, 0x1600, 1, 0x6060_0008, 4),
        Err(Abort::NotMappable)
    );
    assert_eq!(bench.write(x, 0x1600, 1, 0x6040_0010, 4), Ok(()));
    assert_eq!(bench.write(x, 0x1600, 2, 0x607A_0020, 4), Ok(()));
    assert_eq!(bench.write(x, 0x1600, 0, 1, 1), Err(Abort::PdoLength));
    assert_eq!(bench.write(x, 0x1600, 0, 2, 1), Ok(()));
    assert_eq!(bench.write(x, 0x1400, 1, 0x210, 4), Ok(()));
}

/// Maps `objects` into RPDO1 of Z, whose identifier becomes `id`.
fn map_z(bench: &mut Bench, id: u32, objects: &[u32]) -> Result<(), Abort> {
    let z = NodeId::DRIVE_Z;
    let now = bench.read(z, 0x1400, 1)?;
    bench.write(z, 0x1400, 1, now | 1 << 31, 4)?;
    bench.write(z, 0x1600, 0, 0, 1)?;
    for (sub, object) in (1..).zip(objects) {
        bench.write(z, 0x1600, sub, *object, 4)?;
    }
    bench.write(z, 0x1600, 0, objects.len() as u32, 1)?;
    bench.write(z, 0x1400, 1, id, 4)
}

#[test]
fn a_drive_takes_its_own_of_a_frame_for_many_and_tells_of_one_that_ends_before_it() {
    let mut bench = Bench::new();
    let z = NodeId::DRIVE_Z;
    // Refused while the PDO is used, and for identifiers other than its own and those of boards.
    assert_eq!(bench.write(z, 0x1400, 1, 0x481, 4), Err(Abort::Value));
    assert_eq!(
        map_z(&mut bench, 0x212, &[0x6040_0010, 0x607A_0020]),
        Err(Abort::Value)
    );
    let dummies = [0x0007_0020, 0x0006_0010];
    let own = [0x6040_0010, 0x607A_0020];
    let mapping = [dummies, own].concat();
    let wrong: [&[u32]; 3] = [&dummies, &[own, dummies].concat(), &[own[0], dummies[0]]];
    for wrong in wrong {
        assert_eq!(map_z(&mut bench, 0x481, wrong), Err(Abort::PdoLength));
    }
    assert_eq!(map_z(&mut bench, 0x481, &mapping), Ok(()));
    assert_eq!(bench.read(z, 0x1600, 0), Ok(4));
    bench.nmt(NmtCommand::Start);

    let told = |bench: &mut Bench, content: &[u8]| {
        let id = CobId::new(0x481).unwrap();
        let frame = FdFrame::new(id, content, true).unwrap();
        bench.plant.tell_together(&frame);
        let emergencies = bench.tick();
        let emergencies = emergencies.iter().filter_map(Emcy::decode);
        let codes: Vec<_> = emergencies.map(|(node, emcy)| (node, emcy.code)).collect();
        (
            codes,
            bench.read(z, 0x6040, 0).unwrap(),
            bench.read(z, 0x607A, 0).unwrap(),
        )
    };
    let mut content = [0x11; 24];
    content[6..12].copy_from_slice(&[6, 0, 0x78, 0x56, 0x34, 0x12]);
    assert_eq!(told(&mut bench, &content), (Vec::new(), 6, 0x1234_5678));
    // Other drives ignore it: they listen to another identifier.
    assert_eq!(bench.read(NodeId::DRIVE_X, 0x6040, 0), Ok(0));
    // Eight bytes are two more than X gets, and four less than Z needs.
    let short = (std::vec![(z, 0x8210)], 6, 0x1234_5678);
    assert_eq!(told(&mut bench, &content[..8]), short);
    assert_eq!(told(&mut bench, &content[..8]).0, [], "once is enough");
    content[8] = 0x79;
    assert_eq!(told(&mut bench, &content), (Vec::new(), 6, 0x1234_5679));
    assert_eq!(told(&mut bench, &content[..8]).0, [(z, 0x8210)]);
    // A frame of its own identifier no longer commands it.
    let alone = leadscrew_core::bus::DriveCommand {
        control: leadscrew_core::bus::Controlword::ENABLE_OPERATION,
        target: Increments::new(0),
    };
    bench.plant.exchange(&[alone.frame(z)], |_| {});
    assert_eq!(told(&mut bench, &content), (Vec::new(), 6, 0x1234_5679));
}

/// The bytes after a drive's own do not concern it. Still, a drive may report them, each time.
#[test]
fn a_drive_that_is_made_so_tells_of_every_frame_that_is_longer_than_its_mapping() {
    let mut params = Params::sheets();
    params.set(Entry::find_text("9031").unwrap(), 1).unwrap();
    for tells_longer in [false, true] {
        let drives = DriveOptions {
            tells_longer,
            ..DriveOptions::default()
        };
        let options = PlantOptions {
            drives,
            ..PlantOptions::default()
        };
        let mut bench = Bench {
            plant: Plant::new(&params, &options).unwrap(),
            sync: SyncProducer::new(),
        };
        bench.tick();
        bench.nmt(NmtCommand::Start);
        let id = CobId::new(0x481).unwrap();
        let mut told = |bytes: usize| {
            let frame = FdFrame::new(id, &[0; 64][..bytes], true).unwrap();
            bench.plant.tell_together(&frame);
            let heard = bench.tick();
            let emergencies = heard.iter().filter_map(Emcy::decode);
            let told = emergencies.map(|(node, emcy)| (node.get(), emcy.code));
            told.collect::<Vec<_>>()
        };
        let longer = |nodes: &[u8]| -> Vec<(u8, u16)> {
            let told = nodes.iter().filter(|_| tells_longer);
            told.map(|node| (*node, 0x8220)).collect()
        };
        // Of X, Z, C and spindle 1 only the last one's bytes end with the frame.
        let short = [(33, 0x8210), (34, 0x8210), (35, 0x8210)];
        assert_eq!(told(24), [longer(&[16, 17, 18]), short.to_vec()].concat());
        for _ in 0..3 {
            assert_eq!(told(24), longer(&[16, 17, 18]));
        }
    }
}

/// 6007h: the reaction of a drive to NMT stop, without a SYNC.
#[test]
fn a_drive_that_is_stopped_by_nmt_does_what_it_is_set_up_for() {
    let spindle = NodeId::SPINDLE_1;
    for (option, power, speed) in [
        (0, Power::Enabled, 500_000),
        (1, Power::Fault, 0),
        (2, Power::Disabled, 0),
        (3, Power::QuickStop, 0),
    ] {
        let mut bench = Bench::new();
        assert_eq!(bench.read(spindle, 0x6007, 0), Ok(3), "as delivered");
        assert_eq!(bench.write(spindle, 0x6007, 0, option, 2), Ok(()));
        assert_eq!(bench.read(spindle, 0x6007, 0), Ok(option));
        bench.nmt(NmtCommand::Start);
        let speed_told = SpindleCommand {
            mode: Mode::Velocity,
            velocity: MilliRpm::new(500_000),
        };
        for control in [0x06, 0x07, 0x0F] {
            let command = leadscrew_core::bus::DriveCommand {
                control: Controlword::from_raw(control),
                target: Increments::new(0),
            };
            let frames = [command.frame(spindle), speed_told.frame(spindle)];
            bench.plant.exchange(&frames, |_| {});
            bench.tick();
        }
        let drive = bench.plant.spindle_drive();
        assert_eq!(drive.velocity(), MilliRpm::new(500_000));
        bench.nmt(NmtCommand::Stop);
        let drive = bench.plant.spindle_drive();
        assert_eq!(
            (drive.power(), drive.velocity()),
            (power, MilliRpm::new(speed)),
            "{option}"
        );
        bench.tick();
        let drive = bench.plant.spindle_drive();
        assert_eq!(drive.power(), power, "{option}, at the next SYNC");
    }
    let mut bench = Bench::new();
    for (value, abort) in [(4, Abort::TooHigh), (0xFFFF, Abort::TooLow)] {
        assert_eq!(bench.write(spindle, 0x6007, 0, value, 2), Err(abort));
    }
    assert_eq!(bench.read(spindle, 0x6007, 1), Err(Abort::NoSubIndex));
}

#[test]
fn drives_of_a_machine_with_one_frame_for_all_are_delivered_so() {
    let mut params = Params::sheets();
    params.set(Entry::find_text("9031").unwrap(), 1).unwrap();
    let mut bench = Bench::with(&params);
    bench.tick();
    let nodes = [16, 17, 18, 32, 33, 34, 35].map(|node| NodeId::new(node).unwrap());
    for (place, node) in nodes.into_iter().enumerate() {
        assert_eq!(bench.read(node, 0x1400, 1), Ok(0x481));
        let mapping: Vec<u32> = Setpoints::mapping(place).map(Mapped::raw).collect();
        assert_eq!(bench.read(node, 0x1600, 0), Ok(mapping.len() as u32));
        for (sub, raw) in (1..).zip(mapping) {
            assert_eq!(bench.read(node, 0x1600, sub), Ok(raw));
        }
    }
}

#[test]
fn what_is_not_saved_is_gone_after_a_reset() {
    let mut bench = Bench::new();
    let c = NodeId::DRIVE_C;
    let save = u32::from_le_bytes(*b"save");
    assert_eq!(bench.write(c, 0x6083, 0, 1000, 4), Ok(()));
    assert_eq!(
        bench.write(c, 0x1010, 1, save ^ 1, 4),
        Err(Abort::NotStored)
    );
    assert_eq!(bench.write(c, 0x1010, 1, save, 4), Ok(()));
    assert_eq!(bench.write(c, 0x6083, 0, 2000, 4), Ok(()));
    bench.nmt(NmtCommand::ResetNode);
    let heard = bench.tick();
    assert!(heard.contains(&NmtState::BootUp.frame(c)));
    assert_eq!(bench.read(c, 0x6083, 0), Ok(1000));
}

#[test]
fn a_client_that_falls_silent_is_told_so() {
    let mut bench = Bench::new();
    let x = NodeId::DRIVE_X;
    let data = [0; 8];
    let object = Object::new(0x1000, 0);
    let mut download = SdoDownload::new(
        x,
        Object {
            sub: 1,
            index: 0x1010,
        },
        &data[..4],
        SdoProtocol::Segmented,
        PATIENCE,
        NOW,
    );
    let first = download.poll(NOW).unwrap();
    assert_eq!(bench.hear(&first).len(), 1);
    let aborts: Vec<_> = (0..1100)
        .flat_map(|_| bench.tick())
        .filter(|frame| frame.id().get() == 0x590)
        .collect();
    assert_eq!(aborts.len(), 1);
    assert_eq!(aborts[0].payload()[4..], 0x0504_0000_u32.to_le_bytes());
    assert_eq!(bench.read(x, object.index, 0), Ok(0x0002_0192));
}
