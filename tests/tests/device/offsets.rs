//! The table of offsets and tools on a board: what is stored, when it may change, and which programs run with it.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::device::objects::{
    COMMIT_OFFSETS, OFFSETS, OFFSETS_FOUND, OFFSETS_REFUSAL, OFFSETS_REVISION, OFFSETS_STATE,
    STAGED_OFFSETS,
};
use leadscrew_core::board::device::{CommitState, UNMARKED};
use leadscrew_core::board::{Event, Mark, Region};
use leadscrew_core::bus::{Abort, BoardState, Object, Order, SdoError, SdoProtocol};
use leadscrew_core::call::{Hand, TapAxis, TapNotes, TapSpindle};
use leadscrew_core::journal::{TapHole, TapRecord};
use leadscrew_core::link::{EventReader, decode_alarm};
use leadscrew_core::offsets::image::{BYTES, Image, sum};
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::Params;
use leadscrew_core::units::{CentiRpm, Diameter, Lead, Length, Turns};
use leadscrew_store::Store;
use leadscrew_tests::gateway::{Gateway, Upload};
use leadscrew_tests::machine::calls;

use super::kept::power_up;
use super::parameters::{refused, write};

/// A table that is told apart by the geometry of a tool.
fn table(revision: u32) -> Offsets {
    let mut table = Offsets {
        revision: Revision(revision),
        ..Offsets::default()
    };
    table.tools[3].geometry.x = Diameter::from_nm(i64::from(revision) * 100);
    table
}

fn image(revision: u32) -> Image {
    table(revision).encode().expect("within its ranges")
}

fn number(gateway: &mut Gateway, sim: &mut Sim, object: Object) -> u32 {
    let read = gateway.number(sim, object.index, object.sub);
    u32::try_from(read.expect("a number")).expect("of 32 bits")
}

fn stage(gateway: &mut Gateway, sim: &mut Sim, bytes: &[u8]) -> Result<(), SdoError> {
    gateway.write(sim, STAGED_OFFSETS, bytes, SdoProtocol::Block)
}

fn commit(gateway: &mut Gateway, sim: &mut Sim, checksum: u32) -> Result<(), SdoError> {
    write(gateway, sim, COMMIT_OFFSETS, checksum.into(), 4)
}

fn push(gateway: &mut Gateway, sim: &mut Sim, revision: u32) -> Result<(), SdoError> {
    let image = image(revision);
    stage(gateway, sim, &image)?;
    commit(gateway, sim, sum(&image))
}

fn in_force(gateway: &mut Gateway, sim: &mut Sim) -> Offsets {
    let bytes = gateway.read(sim, OFFSETS, SdoProtocol::Block);
    Offsets::decode(&bytes.expect("an image")).expect("whole")
}

fn reason(gateway: &mut Gateway, sim: &mut Sim) -> Option<Alarm> {
    let bytes = gateway.read(sim, OFFSETS_REFUSAL, SdoProtocol::Block);
    decode_alarm(&bytes.expect("a reason")).expect("an alarm")
}

fn alarm(code: Code, figures: &[i64]) -> Option<Alarm> {
    let figures: Vec<_> = figures.iter().map(|figure| Arg::Int(*figure)).collect();
    Some(Alarm::of(code, &figures))
}

fn states(gateway: &mut Gateway, sim: &mut Sim) -> [u32; 3] {
    [OFFSETS_STATE, OFFSETS_REVISION, OFFSETS_FOUND].map(|object| number(gateway, sim, object))
}

const NONE: u32 = CommitState::None as u32;
const DONE: u32 = CommitState::Done as u32;
const REFUSED: u32 = CommitState::Refused as u32;

fn connected() -> (Sim, Gateway) {
    let (sim, gateway, _) = power_up(Flash::erased());
    (sim, gateway)
}

/// The codes of the board's warnings and alarms so far.
fn told(gateway: &mut Gateway, sim: &mut Sim) -> Vec<Alarm> {
    let bytes = gateway.read(sim, Object::new(0x5040, 3), SdoProtocol::Block);
    let bytes = bytes.expect("the log");
    let events = EventReader::new(&bytes).map(|logged| logged.expect("an entry").event);
    let alarms = events.filter_map(|event| match event {
        Event::Warning(alarm) | Event::Alarm(alarm) => Some(alarm),
        _ => None,
    });
    alarms.collect()
}

fn step(gateway: &mut Gateway, sim: &mut Sim, ticks: u32) {
    for _ in 0..ticks {
        sim.step();
        while sim.event().is_some() {}
        gateway.listen(sim);
    }
}

const PROGRAM: &str = "G98 G1 X20 Z-20 F300\nM30\n";

fn upload(gateway: &mut Gateway, sim: &mut Sim, program: u32, revision: u32) {
    let mut upload = Upload::new(program, &calls(PROGRAM, &Params::sheets()));
    upload.offsets = Revision(revision);
    assert!(upload.feed(gateway, sim));
    assert!(upload.is_done());
}

fn run(gateway: &mut Gateway, sim: &mut Sim) -> Result<(), SdoError> {
    if !sim.board().device().mode().runs() {
        gateway.order(sim, Order::Mode(OperatingMode::Automatic));
    }
    let echo = sim.board().device().beat().ms();
    write(gateway, sim, Object::new(0x5000, 7), echo.into(), 2).expect("an echo");
    write(gateway, sim, Object::new(0x5000, 2), 1, 1)
}

#[test]
fn a_table_is_stored_in_force_and_there_when_the_power_comes_back() {
    let (mut sim, mut gateway) = connected();
    assert_eq!(states(&mut gateway, &mut sim), [NONE, 0, 1]);
    assert_eq!(in_force(&mut gateway, &mut sim), Offsets::default());
    let set = number(&mut gateway, &mut sim, Object::new(0x1020, 1));
    for revision in 1..=4 {
        let staged = image(revision);
        stage(&mut gateway, &mut sim, &staged).expect("the next");
        assert_eq!(in_force(&mut gateway, &mut sim).revision.0, revision - 1);
        commit(&mut gateway, &mut sim, sum(&staged)).expect("staged");
        assert_eq!(in_force(&mut gateway, &mut sim), table(revision));
        assert_eq!(states(&mut gateway, &mut sim), [DONE, revision, 0]);
        assert_eq!(reason(&mut gateway, &mut sim), None);
    }
    // A commit that comes again, because its answer was lost, counts once.
    commit(&mut gateway, &mut sim, sum(&image(4))).expect("done");
    assert_eq!(states(&mut gateway, &mut sim), [DONE, 4, 0]);
    // The application has not begun anew: the drives have stayed enabled.
    step(&mut gateway, &mut sim, 20);
    assert!(gateway.heard.iter().all(|frame| {
        let status = leadscrew_core::bus::BoardStatus::decode(frame);
        status.is_none_or(|(_, status)| status.state == BoardState::Idle)
    }));
    assert_eq!(number(&mut gateway, &mut sim, Object::new(0x1020, 1)), set);
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(in_force(&mut gateway, &mut sim), table(4));
    assert_eq!(states(&mut gateway, &mut sim), [NONE, 4, 0]);
}

#[test]
fn what_is_no_next_table_is_refused_and_changes_nothing() {
    let (mut sim, mut gateway) = connected();
    push(&mut gateway, &mut sim, 1).expect("the first");
    let before = sim.flash().clone();
    let mut tip = image(2);
    tip[16 + 96 + 20] = 10;
    let content = tip.len() - 4;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&tip[..content]);
    let mut beyond = tip;
    beyond[content..].copy_from_slice(&crc.to_le_bytes());
    let other = Code::OffsetsOtherRevision;
    let incomplete = alarm(Code::OffsetsIncomplete, &[]);
    for (bytes, abort, expected) in [
        (&image(1)[..], Abort::State, alarm(other, &[0, 1])),
        (&image(3)[..], Abort::State, alarm(other, &[2, 1])),
        (&tip[..], Abort::Crc, incomplete),
        (&image(2)[..BYTES - 1], Abort::Length, incomplete),
        (&[0; BYTES][..], Abort::Crc, incomplete),
        (
            &beyond[..],
            Abort::Value,
            alarm(Code::OffsetsOutOfRange, &[1]),
        ),
    ] {
        assert_eq!(stage(&mut gateway, &mut sim, bytes), refused(abort));
        assert_eq!(reason(&mut gateway, &mut sim), expected);
        assert_eq!(states(&mut gateway, &mut sim), [REFUSED, 1, 0]);
        // What was refused is not committed either.
        let sum = u32::from_le_bytes(*bytes.last_chunk().expect("four bytes"));
        if sum != self::sum(&image(1)) {
            assert!(commit(&mut gateway, &mut sim, sum).is_err());
        }
    }
    let long = [0; BYTES + 1];
    assert_eq!(
        stage(&mut gateway, &mut sim, &long),
        refused(Abort::TooLong)
    );
    stage(&mut gateway, &mut sim, &image(2)).expect("the next");
    assert_eq!(commit(&mut gateway, &mut sim, 1), refused(Abort::Value));
    assert_eq!(reason(&mut gateway, &mut sim), incomplete);
    assert_eq!(in_force(&mut gateway, &mut sim), table(1));
    assert_eq!(*sim.flash(), before);
    commit(&mut gateway, &mut sim, sum(&image(2))).expect("it is still staged");
}

#[test]
fn nothing_changes_while_a_program_is_under_way_or_held() {
    let (mut sim, mut gateway) = connected();
    push(&mut gateway, &mut sim, 1).expect("the first");
    stage(&mut gateway, &mut sim, &image(2)).expect("at rest");
    upload(&mut gateway, &mut sim, 7, 1);
    run(&mut gateway, &mut sim).expect("its revision is in force");
    step(&mut gateway, &mut sim, 100);
    let at_work = alarm(Code::OffsetsAtWork, &[]);
    let mut held = false;
    for order in [None, Some(Order::Hold)] {
        if let Some(order) = order {
            gateway.order(&mut sim, order);
            step(&mut gateway, &mut sim, 500);
            held = gateway.status.state == BoardState::Hold;
        }
        let checksum = sum(&image(2));
        assert_eq!(
            commit(&mut gateway, &mut sim, checksum),
            refused(Abort::State)
        );
        assert_eq!(reason(&mut gateway, &mut sim), at_work);
        assert_eq!(
            stage(&mut gateway, &mut sim, &image(2)),
            refused(Abort::State)
        );
        assert_eq!(in_force(&mut gateway, &mut sim), table(1));
    }
    assert!(held);
    gateway.order(&mut sim, Order::Reset);
    step(&mut gateway, &mut sim, 2000);
    commit(&mut gateway, &mut sim, sum(&image(2))).expect("at rest again");
}

#[test]
fn a_program_runs_with_its_own_revision_only() {
    let (mut sim, mut gateway) = connected();
    let begins = |gateway: &mut Gateway, sim: &mut Sim, program, revision| {
        upload(gateway, sim, program, revision);
        let ran = run(gateway, sim);
        step(gateway, sim, 7000);
        ran
    };
    // No table: programs resolved with the parameters name 0.
    assert_eq!(begins(&mut gateway, &mut sim, 1, 0), Ok(()));
    assert_eq!(begins(&mut gateway, &mut sim, 2, 1), refused(Abort::State));
    push(&mut gateway, &mut sim, 1).expect("the first");
    assert_eq!(begins(&mut gateway, &mut sim, 3, 0), refused(Abort::State));
    assert_eq!(begins(&mut gateway, &mut sim, 4, 1), Ok(()));
    // A change between the program and its start.
    upload(&mut gateway, &mut sim, 5, 1);
    push(&mut gateway, &mut sim, 2).expect("nothing runs yet");
    assert_eq!(run(&mut gateway, &mut sim), refused(Abort::State));
    let other = |named, now| alarm(Code::OffsetsOtherRevision, &[named, now]).expect("one");
    let mut found = told(&mut gateway, &mut sim);
    found.retain(|alarm| alarm.code == Code::OffsetsOtherRevision);
    assert_eq!(found, [other(1, 0), other(0, 1), other(1, 2)]);
}

#[test]
fn a_damaged_table_is_told_and_no_program_runs_with_the_one_before() {
    let (mut sim, mut gateway) = connected();
    for revision in 1..=2 {
        push(&mut gateway, &mut sim, revision).expect("the next");
    }
    let mut flash = sim.flash().clone();
    let mut store = Store::new(&mut flash).expect("a store");
    store.write(Region::OffsetsB, b"damaged").expect("written");
    let (mut sim, mut gateway, _) = power_up(flash);
    assert_eq!(states(&mut gateway, &mut sim), [NONE, 2, 2]);
    assert_eq!(in_force(&mut gateway, &mut sim), table(1));
    upload(&mut gateway, &mut sim, 1, 1);
    assert_eq!(run(&mut gateway, &mut sim), refused(Abort::State));
    let last = told(&mut gateway, &mut sim).pop();
    assert_eq!(last, alarm(Code::OffsetsDamaged, &[1]));
    // The number of the lost table is not given again.
    assert_eq!(push(&mut gateway, &mut sim, 2), refused(Abort::State));
    push(&mut gateway, &mut sim, 3).expect("the next");
    assert_eq!(states(&mut gateway, &mut sim), [DONE, 3, 0]);
    upload(&mut gateway, &mut sim, 2, 3);
    assert_eq!(run(&mut gateway, &mut sim), Ok(()));
}

#[test]
fn nothing_whole_is_no_table_and_not_forgotten() {
    let mut flash = Flash::erased();
    let mut store = Store::new(&mut flash).expect("a store");
    let mark = Mark(5).encode();
    store.write(Region::OffsetsMark, &mark).expect("written");
    store.write(Region::OffsetsA, &[1; 40]).expect("written");
    let (mut sim, mut gateway, _) = power_up(flash);
    assert_eq!(states(&mut gateway, &mut sim), [NONE, 5, 3]);
    assert_eq!(in_force(&mut gateway, &mut sim), Offsets::default());
    upload(&mut gateway, &mut sim, 1, 0);
    assert_eq!(run(&mut gateway, &mut sim), refused(Abort::State));
    push(&mut gateway, &mut sim, 6).expect("the next");
    assert_eq!(states(&mut gateway, &mut sim), [DONE, 6, 0]);
}

#[test]
fn a_table_that_cannot_be_stored_does_not_come_into_force() {
    let (mut sim, mut gateway) = connected();
    push(&mut gateway, &mut sim, 1).expect("the first");
    sim.flash_mut().set_broken(true);
    push(&mut gateway, &mut sim, 2).expect("it is good");
    assert_eq!(states(&mut gateway, &mut sim), [REFUSED, 1, 0]);
    let expected = alarm(Code::OffsetsNotStored, &[]);
    assert_eq!(reason(&mut gateway, &mut sim), expected);
    assert_eq!(in_force(&mut gateway, &mut sim), table(1));
    sim.flash_mut().set_broken(false);
    push(&mut gateway, &mut sim, 2).expect("the next");
    assert_eq!(states(&mut gateway, &mut sim), [DONE, 2, 0]);
}

/// Only G30 P99 can move then, and no offset counts for it.
#[test]
fn a_damaged_table_keeps_no_tap_in_its_hole() {
    let record = TapRecord {
        sequence: 1,
        in_hole: true,
        hole: TapHole {
            axis: TapAxis::Z,
            level: Length::ZERO,
            bottom: Length::from_nm(-20_000_000),
            lead: Lead::new(2_000_000_000, 1000).expect("a lead"),
            hand: Hand::Right,
            spindle: TapSpindle::First,
            speed: CentiRpm::new(20_000),
            notes: TapNotes::default(),
        },
        position: Length::from_nm(-20_000_000),
        angle: Turns::default(),
    };
    let mut flash = Flash::erased();
    let mut store = Store::new(&mut flash).expect("a store");
    let region = Region::TapJournal;
    store.write(region, &record.encode()).expect("written");
    let (region, garbage) = (Region::OffsetsA, [1; 40]);
    store.write(region, &garbage).expect("written");
    let (mut sim, mut gateway, _) = power_up(flash);
    assert_eq!(states(&mut gateway, &mut sim)[2], 3, "nothing is whole");
    let out = calls("G30 P99 S200\nM30\n", &Params::sheets());
    assert!(Upload::new(1, &out).feed(&mut gateway, &mut sim));
    assert_eq!(run(&mut gateway, &mut sim), Ok(()));
}

/// Neither a write enable nor a password is asked for: offsets are the operator's everyday work.
#[test]
fn offsets_are_not_protected_as_parameters_are() {
    let params = leadscrew_tests::params::with(&[("9026.0", 0), ("9028", 4711)]);
    let mut sim = leadscrew_tests::machine::machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    push(&mut gateway, &mut sim, 1).expect("taken");
    assert_eq!(in_force(&mut gateway, &mut sim), table(1));
}

#[test]
fn a_marked_position_is_kept_until_the_power_goes() {
    let (mut sim, mut gateway) = connected();
    let marks = [8, 9].map(|sub| Object::new(0x5011, sub));
    let read = |gateway: &mut Gateway, sim: &mut Sim| {
        marks.map(|object| number(gateway, sim, object) as i32)
    };
    assert_eq!(read(&mut gateway, &mut sim), [UNMARKED; 2]);
    write(&mut gateway, &mut sim, marks[0], -2_123_400, 4).expect("a position");
    write(&mut gateway, &mut sim, marks[1], 5, 4).expect("a position");
    push(&mut gateway, &mut sim, 1).expect("the first");
    assert_eq!(read(&mut gateway, &mut sim), [-2_123_400, 5]);
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(read(&mut gateway, &mut sim), [UNMARKED; 2]);
}

#[test]
fn nothing_changes_in_the_mode_that_finds_the_reference() {
    let (mut sim, mut gateway) = connected();
    stage(&mut gateway, &mut sim, &image(1)).expect("in manual");
    gateway.order(&mut sim, Order::Mode(OperatingMode::Reference));
    let names = [OperatingMode::Manual, OperatingMode::Reference].map(Arg::Mode);
    let wrong = Some(Alarm::of(Code::WrongMode, &names));
    let checksum = sum(&image(1));
    let mark = Object::new(0x5011, 8);
    for number in 0..3 {
        let written = match number {
            0 => stage(&mut gateway, &mut sim, &image(1)),
            1 => commit(&mut gateway, &mut sim, checksum),
            _ => write(&mut gateway, &mut sim, mark, 5, 4),
        };
        assert_eq!(written, refused(Abort::State), "{number}");
        assert_eq!(reason(&mut gateway, &mut sim), wrong, "{number}");
    }
    assert_eq!(in_force(&mut gateway, &mut sim), Offsets::default());
    gateway.order(&mut sim, Order::Mode(OperatingMode::Automatic));
    commit(&mut gateway, &mut sim, checksum).expect("it is still staged");
    assert_eq!(in_force(&mut gateway, &mut sim), table(1));
}

#[test]
fn no_position_is_marked_while_a_program_is_under_way() {
    let (mut sim, mut gateway) = connected();
    let mark = Object::new(0x5011, 8);
    write(&mut gateway, &mut sim, mark, 5, 4).expect("at rest");
    upload(&mut gateway, &mut sim, 7, 0);
    run(&mut gateway, &mut sim).expect("it runs");
    step(&mut gateway, &mut sim, 100);
    let other = write(&mut gateway, &mut sim, mark, 6, 4);
    assert_eq!(other, refused(Abort::State));
    let at_work = alarm(Code::OffsetsAtWork, &[]);
    assert_eq!(reason(&mut gateway, &mut sim), at_work);
    assert_eq!(number(&mut gateway, &mut sim, mark), 5);
    // It may be forgotten.
    write(&mut gateway, &mut sim, mark, UNMARKED.into(), 4).expect("none");
    assert_eq!(number(&mut gateway, &mut sim, mark) as i32, UNMARKED);
}
