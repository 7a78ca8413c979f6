//! Parameters that outlive the power: what is stored, what a board starts with, and what it says about it.

use core::time::Duration;

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::device::objects::{COMMIT_OFFSETS, STAGED_OFFSETS};
use leadscrew_core::board::device::{CommitState, LOAD, SAVE};
use leadscrew_core::board::{Board, Event, KeptSet, Mark, Region, StoreError};
use leadscrew_core::bus::{
    Abort, BoardState, Object, Order, SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoUpload,
};
use leadscrew_core::link::{EventReader, ImageWriter, decode_alarm, identity};
use leadscrew_core::offsets::image::sum;
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::params::Params;
use leadscrew_store::Store;
use leadscrew_tests::gateway::{Gateway, NODE};
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;

use super::parameters::{IMAGE, parameter, refused, rest, write};

/// Sets that are told apart by the tolerance of the spindle's speed.
pub fn set(tolerance: i64) -> Params {
    with(&[("9007", tolerance)])
}

pub fn image(params: &Params) -> Vec<u8> {
    let mut image = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::with_password(params).read(0, &mut image);
    image
}

/// A board with this flash, and what it says at power-up.
pub fn power_up(flash: Flash) -> (Sim, Gateway, Vec<Event>) {
    let mut sim =
        Sim::with_flash(&Params::sheets(), &PlantOptions::default(), flash).expect("it starts");
    let mut gateway = Gateway::connect(&mut sim);
    let mut told = Vec::new();
    for _ in 0..50 {
        told.extend(std::iter::from_fn(|| sim.event()));
        sim.step();
        gateway.listen(&mut sim);
    }
    (sim, gateway, told)
}

pub fn push(gateway: &mut Gateway, sim: &mut Sim, params: &Params) -> Result<(), SdoError> {
    let pushed = gateway.write(sim, IMAGE, &image(params), SdoProtocol::Block);
    if pushed.is_ok() {
        assert_eq!(state(gateway, sim), CommitState::Done as u8);
        rest(gateway, sim);
    }
    pushed
}

fn number(gateway: &mut Gateway, sim: &mut Sim, index: u16, sub: u8) -> u32 {
    u32::try_from(gateway.number(sim, index, sub).expect("a number")).expect("of 32 bits")
}

pub fn state(gateway: &mut Gateway, sim: &mut Sim) -> u8 {
    number(gateway, sim, 0x5010, 2) as u8
}

pub fn in_force(gateway: &mut Gateway, sim: &mut Sim) -> u32 {
    number(gateway, sim, 0x1020, 1)
}

/// Why the last change was refused.
pub fn reason(gateway: &mut Gateway, sim: &mut Sim) -> Option<Alarm> {
    let object = Object::new(0x5010, 8);
    let bytes = gateway
        .read(sim, object, SdoProtocol::Block)
        .expect("a reason");
    let alarm = decode_alarm(&bytes).expect("an alarm");
    let code = number(gateway, sim, 0x5010, 7) as u16;
    assert_eq!(code, alarm.map_or(0, |alarm| alarm.number()));
    alarm
}

pub fn reason_code(gateway: &mut Gateway, sim: &mut Sim) -> Option<Code> {
    reason(gateway, sim).map(|alarm| alarm.code)
}

pub fn command(
    gateway: &mut Gateway,
    sim: &mut Sim,
    index: u16,
    sub: u8,
    value: u32,
) -> Result<(), SdoError> {
    let length = if (index, sub) == (0x5010, 5) { 1 } else { 4 };
    write(gateway, sim, Object::new(index, sub), value.into(), length)
}

/// A flash in which these sets have been stored, one after the other.
pub fn flash_with(sets: &[Params]) -> Flash {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    for params in sets {
        push(&mut gateway, &mut sim, params).expect("taken");
    }
    sim.flash().clone()
}

/// Puts bytes into a region without the board.
fn put(flash: &mut Flash, region: Region, bytes: &[u8]) {
    let mut store = Store::new(flash).expect("a store");
    store.write(region, bytes).expect("written");
}

fn kept(number: u32, params: &Params) -> Vec<u8> {
    let mut bytes = vec![0; KeptSet::BYTES];
    KeptSet { number, params }.fill(&mut bytes);
    bytes
}

fn alarms(told: &[Event]) -> Vec<Code> {
    let codes = told.iter().filter_map(|event| match event {
        Event::Alarm(alarm) | Event::Warning(alarm) => Some(alarm.code),
        _ => None,
    });
    codes.collect()
}

#[test]
fn what_is_pushed_is_there_when_the_power_comes_back() {
    let (mut sim, mut gateway, told) = power_up(Flash::erased());
    assert_eq!(alarms(&told), [Code::ParametersBuiltIn], "not silent");
    let identities = |gateway: &mut Gateway, sim: &mut Sim| {
        [(0x1020, 1), (0x5010, 3), (0x5010, 4)].map(|(index, sub)| number(gateway, sim, index, sub))
    };
    let built_in = identity(&Params::sheets());
    assert_eq!(identities(&mut gateway, &mut sim), [built_in, 0, 0]);
    assert_eq!(state(&mut gateway, &mut sim), CommitState::None as u8);

    let [first, second] = [set(10), set(12)];
    push(&mut gateway, &mut sim, &first).expect("taken");
    let ids = [&first, &second].map(identity);
    assert_eq!(identities(&mut gateway, &mut sim), [ids[0], ids[0], 0]);
    push(&mut gateway, &mut sim, &second).expect("taken");
    assert_eq!(identities(&mut gateway, &mut sim), [ids[1], ids[1], ids[0]]);

    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), [], "nothing to say");
    assert_eq!(identities(&mut gateway, &mut sim), [ids[1], ids[1], ids[0]]);
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9007, 0), Ok(12));
    // One value is a change like any other.
    let tolerance = parameter(9007, 0);
    assert_eq!(write(&mut gateway, &mut sim, tolerance, 14, 1), Ok(()));
    let third = identity(&set(14));
    assert_eq!(identities(&mut gateway, &mut sim), [third, third, ids[1]]);
    let (mut sim, mut gateway, _) = power_up(sim.flash().clone());
    assert_eq!(identities(&mut gateway, &mut sim), [third, third, ids[1]]);
    // What the flash holds already is not written again.
    let written = sim.flash().written();
    gateway
        .write(&mut sim, IMAGE, &image(&set(14)), SdoProtocol::Block)
        .expect("taken");
    assert_eq!(state(&mut gateway, &mut sim), CommitState::Done as u8);
    assert_eq!(sim.flash().written(), written);
}

/// Told in frames, in lock-step: the transfer with all its round trips, then the look whether it is stored, and the
/// identity of what is in force. On a wire of 1 Mbit/s each takes at most 111 µs and stuffing.
#[test]
fn a_whole_set_takes_few_frames_more_than_its_bytes() {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    let wanted = set(12);
    gateway.heard.clear();
    gateway.sent = 0;
    gateway
        .write(&mut sim, IMAGE, &image(&wanted), SdoProtocol::Block)
        .expect("taken");
    assert_eq!(state(&mut gateway, &mut sim), CommitState::Done as u8);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&wanted));
    let data = (ImageWriter::BYTES as usize).div_ceil(7);
    let blocks = data.div_ceil(127);
    // Begin and end of the transfer, an answer to each block, and two numbers read.
    let all = gateway.sent + gateway.heard.len();
    assert_eq!(all, data + 4 + blocks + 4);
    assert!(all * 10 <= data * 13, "{all} frames for {data} of data");
}

#[test]
fn the_last_good_set_can_be_taken_and_left_again() {
    let sets = [set(10), set(12)];
    let (mut sim, mut gateway, _) = power_up(flash_with(&sets));
    for expected in [&sets[0], &sets[1], &sets[0]] {
        assert_eq!(command(&mut gateway, &mut sim, 0x5010, 5, 1), Ok(()));
        assert_eq!(state(&mut gateway, &mut sim), CommitState::Done as u8);
        rest(&mut gateway, &mut sim);
        assert_eq!(in_force(&mut gateway, &mut sim), identity(expected));
    }
    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[0]));

    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    let none = command(&mut gateway, &mut sim, 0x5010, 5, 1);
    assert_eq!(none, refused(Abort::NoData));
    let other = command(&mut gateway, &mut sim, 0x5010, 5, 2);
    assert_eq!(other, refused(Abort::TooHigh));
}

#[test]
fn a_last_good_set_of_a_board_with_another_number_is_not_taken_where_a_drive_has_this_ones() {
    let sets = [set(10), set(12)];
    let mut flash = flash_with(&sets);
    let other = with(&[("9015.X", NODE.get().into())]);
    put(&mut flash, Region::ParametersA, &kept(1, &other));
    let (mut sim, mut gateway, told) = power_up(flash);
    assert_eq!(alarms(&told), [], "the newest set is in force");
    let written = sim.flash().written();
    let id = identity(&other);
    assert_eq!(number(&mut gateway, &mut sim, 0x5010, 4), id);
    assert_eq!(command(&mut gateway, &mut sim, 0x5010, 5, 1), Ok(()));
    assert_eq!(state(&mut gateway, &mut sim), CommitState::Refused as u8);
    let figures = [Arg::Letter(b'X'), Arg::Int(NODE.get().into())];
    let expected = Alarm::of(Code::DriveNodeOfBoard, &figures);
    assert_eq!(reason(&mut gateway, &mut sim), Some(expected));
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[1]));
    assert_eq!(sim.flash().written(), written);
    // And the board takes another one.
    push(&mut gateway, &mut sim, &sets[0]).expect("taken");
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[0]));
}

#[test]
fn a_new_board_keeps_its_built_in_set_when_it_is_told_to() {
    let (mut sim, mut gateway, _) = power_up(Flash::erased());
    assert_eq!(gateway.number(&mut sim, 0x1010, 1), Ok(2));
    assert_eq!(gateway.number(&mut sim, 0x1011, 1), Ok(1));
    for index in [0x1010, 0x1011] {
        let wrong = command(&mut gateway, &mut sim, index, 1, 1);
        assert_eq!(wrong, refused(Abort::NotStored));
    }
    assert_eq!(command(&mut gateway, &mut sim, 0x1010, 1, SAVE), Ok(()));
    rest(&mut gateway, &mut sim);
    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);
    assert_eq!(command(&mut gateway, &mut sim, 0x1010, 1, SAVE), Ok(()));
    push(&mut gateway, &mut sim, &set(10)).expect("taken");
    assert_eq!(command(&mut gateway, &mut sim, 0x1011, 1, LOAD), Ok(()));
    rest(&mut gateway, &mut sim);
    let built_in = identity(&Params::slant_bed());
    assert_eq!(in_force(&mut gateway, &mut sim), built_in);
}

/// The board is on an alarm that no reset takes away, and takes no program.
fn is_withheld(gateway: &mut Gateway, sim: &mut Sim, code: Code) {
    for _ in 0..2 {
        assert_eq!(gateway.status.state, BoardState::Alarm);
        assert_eq!(gateway.status.alarm, Some(code.number()));
        let program = calls("G0 X10\nM30\n", &Params::sheets());
        assert!(!sim.offer(&program[0]));
        gateway.order(sim, Order::Reset);
        for _ in 0..2000 {
            sim.step();
            gateway.listen(sim);
        }
    }
    let tolerance = parameter(9007, 0);
    assert_eq!(write(gateway, sim, tolerance, 11, 1), refused(Abort::State));
    assert_eq!(reason_code(gateway, sim), Some(code));
    let saved = command(gateway, sim, 0x1010, 1, SAVE);
    assert_eq!(saved, refused(Abort::State));
    assert_eq!(state(gateway, sim), CommitState::Refused as u8);
}

#[test]
fn a_damaged_set_is_an_alarm_that_offers_the_one_before() {
    let sets = [set(10), set(12)];
    // The newest of two is in the second place.
    let mut damaged = kept(2, &sets[1]);
    damaged[500] ^= 4;
    let mut flash = flash_with(&sets);
    put(&mut flash, Region::ParametersB, &damaged);
    let (mut sim, mut gateway, told) = power_up(flash.clone());
    assert_eq!(alarms(&told), [Code::ParametersOlder]);
    is_withheld(&mut gateway, &mut sim, Code::ParametersOlder);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[0]));
    assert_eq!(number(&mut gateway, &mut sim, 0x5010, 3), 0);
    assert_eq!(
        number(&mut gateway, &mut sim, 0x5010, 4),
        identity(&sets[0])
    );
    // Switching the board off and on does not help.
    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), [Code::ParametersOlder]);
    assert_eq!(command(&mut gateway, &mut sim, 0x5010, 5, 1), Ok(()));
    rest(&mut gateway, &mut sim);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[0]));
    let (_, _, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);

    // Another set does as well.
    let (mut sim, mut gateway, _) = power_up(flash);
    push(&mut gateway, &mut sim, &set(14)).expect("taken");
    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&set(14)));
}

#[test]
fn a_newest_set_that_is_gone_is_missed() {
    // As a store shows it whose newest entry is damaged: an older one in its place.
    let sets = [set(10), set(12), set(14)];
    let mut flash = flash_with(&sets);
    put(&mut flash, Region::ParametersA, &kept(1, &sets[0]));
    let (mut sim, mut gateway, told) = power_up(flash);
    assert_eq!(alarms(&told), [Code::ParametersOlder]);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&sets[1]));
}

#[test]
fn nothing_whole_is_an_alarm_and_no_reset_to_factory() {
    let mut flash = flash_with(&[set(10), set(12)]);
    for region in [Region::ParametersA, Region::ParametersB] {
        put(&mut flash, region, b"something else");
    }
    let (mut sim, mut gateway, told) = power_up(flash);
    assert_eq!(alarms(&told), [Code::ParametersLost]);
    is_withheld(&mut gateway, &mut sim, Code::ParametersLost);
    let none = command(&mut gateway, &mut sim, 0x5010, 5, 1);
    assert_eq!(none, refused(Abort::NoData));
    assert_eq!(command(&mut gateway, &mut sim, 0x1011, 1, LOAD), Ok(()));
    rest(&mut gateway, &mut sim);
    let (_, _, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);

    // Its mark alone says that there was one.
    let mut flash = Flash::erased();
    put(&mut flash, Region::ParametersMark, &Mark(3).encode());
    let (_, _, told) = power_up(flash);
    assert_eq!(alarms(&told), [Code::ParametersLost]);
}

#[test]
fn a_set_of_another_table_is_not_read_and_both_versions_are_named() {
    let mut foreign = kept(2, &set(12));
    // Its schema and the key of its table.
    foreign[2] = 7;
    foreign[8] ^= 0xFF;
    // It has some thirty numbers more.
    foreign.splice(100..100, [7; 240]);
    let end = foreign.len() - 4;
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&foreign[..end]);
    foreign[end..].copy_from_slice(&sum.to_le_bytes());
    let mut flash = flash_with(&[set(10)]);
    put(&mut flash, Region::ParametersB, &foreign);
    let (mut sim, mut gateway, told) = power_up(flash);
    let Some(Event::Alarm(alarm)) = told.iter().find(|event| matches!(event, Event::Alarm(_)))
    else {
        panic!("{told:?}");
    };
    use leadscrew_core::alarm::Arg;
    use leadscrew_core::params::{SCHEMA, TABLE_KEY};
    assert_eq!(alarm.code, Code::ParametersForeign);
    assert_eq!(
        alarm.args,
        [
            Arg::Int(7),
            Arg::Key(TABLE_KEY ^ 0xFF),
            Arg::Int(SCHEMA.into()),
            Arg::Key(TABLE_KEY)
        ]
    );
    is_withheld(&mut gateway, &mut sim, Code::ParametersForeign);
    let built_in = identity(&Params::sheets());
    assert_eq!(in_force(&mut gateway, &mut sim), built_in);
    // The last good one of this table is still there.
    assert_eq!(command(&mut gateway, &mut sim, 0x5010, 5, 1), Ok(()));
    rest(&mut gateway, &mut sim);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&set(10)));
}

#[test]
fn a_write_that_fails_leaves_the_old_set_in_force_and_stored() {
    let old = set(10);
    let (mut sim, mut gateway, _) = power_up(flash_with(std::slice::from_ref(&old)));
    sim.flash_mut().set_broken(true);
    gateway
        .write(&mut sim, IMAGE, &image(&set(12)), SdoProtocol::Block)
        .expect("it is a good set");
    assert_eq!(state(&mut gateway, &mut sim), CommitState::Refused as u8);
    assert_eq!(
        reason_code(&mut gateway, &mut sim),
        Some(Code::ParametersNotStored)
    );
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&old));
    assert_eq!(number(&mut gateway, &mut sim, 0x5010, 3), identity(&old));
    sim.flash_mut().set_broken(false);
    let (mut sim, mut gateway, told) = power_up(sim.flash().clone());
    assert_eq!(alarms(&told), []);
    assert_eq!(in_force(&mut gateway, &mut sim), identity(&old));
    push(&mut gateway, &mut sim, &set(12)).expect("taken");
}

/// The requests of a board without a flash, step by step.
#[test]
fn a_set_without_its_mark_is_stored_and_told() {
    let mut board = Board::new(&Params::sheets(), None, None).expect("a board");
    board.join(NODE).expect("room");
    let save = Object::new(0x1010, 1);
    let (now, patience) = (Duration::ZERO, Duration::from_secs(1));
    let frame = SdoDownload::new(NODE, save, b"save", SdoProtocol::Short, patience, now)
        .poll(now)
        .expect("a request");
    assert!(!board.receive(&frame));
    let mut buffer = [0; Region::LONGEST];
    let request = board.store().expect("the set");
    assert_eq!(request.region, Region::ParametersA);
    assert_eq!(request.fill(&mut buffer), kept(1, &Params::sheets()));
    assert!(board.store().is_none(), "one at a time");
    board.stored(Region::ParametersA, Ok(()));
    let request = board.store().expect("the mark");
    assert_eq!(request.region, Region::ParametersMark);
    assert_eq!(request.fill(&mut buffer), Mark(1).encode());
    assert!(board.device().is_changing());
    board.stored(Region::ParametersMark, Err(StoreError::Full));
    assert!(!board.device().is_changing());
    assert!(board.store().is_none());
    board.serve();
    assert_eq!(board.device().commit_state(), CommitState::Done);
    assert_eq!(told(&mut board), [Code::ParametersUnmarked]);
}

/// The same of the tool table.
#[test]
fn a_table_without_its_mark_is_stored_and_told() {
    let mut board = Board::new(&Params::sheets(), None, None).expect("a board");
    board.join(NODE).expect("room");
    let table = Offsets {
        revision: Revision(1),
        ..Offsets::default()
    };
    let image = table.encode().expect("within its ranges");
    let (now, patience) = (Duration::ZERO, Duration::from_secs(1));
    let protocol = SdoProtocol::Segmented;
    let mut staged = SdoDownload::new(NODE, STAGED_OFFSETS, &image, protocol, patience, now);
    while staged.outcome().is_none() {
        while let Some(frame) = staged.poll(now) {
            assert!(!board.receive(&frame));
        }
        board.serve();
        while let Some(frame) = board.transmit() {
            staged.receive(&frame, now);
        }
    }
    assert_eq!(staged.outcome(), Some(Ok(())));
    let sum = sum(&image).to_le_bytes();
    let frame = SdoDownload::new(
        NODE,
        COMMIT_OFFSETS,
        &sum,
        SdoProtocol::Short,
        patience,
        now,
    )
    .poll(now)
    .expect("a request");
    assert!(!board.receive(&frame));
    board.serve();
    for (region, result) in [
        (Region::OffsetsA, Ok(())),
        (Region::OffsetsMark, Err(StoreError::Full)),
    ] {
        assert_eq!(board.store().expect("a request").region, region);
        board.stored(region, result);
    }
    assert!(board.store().is_none());
    board.serve();
    assert_eq!(board.device().offsets(), &image);
    assert_eq!(told(&mut board), [Code::OffsetsUnmarked]);
}

/// What the event log of a board that nobody ticks has of alarms and warnings.
fn told(board: &mut Board) -> Vec<Code> {
    let events = transfer(board, Object::new(0x5040, 3));
    let events: Vec<_> = EventReader::new(&events)
        .map(|entry| entry.expect("an entry").event)
        .collect();
    alarms(&events)
}

/// Reads an object of a board that nobody ticks.
fn transfer(board: &mut Board, object: Object) -> Vec<u8> {
    let (now, patience) = (Duration::ZERO, Duration::from_secs(1));
    let mut room = vec![0; 4096];
    let mut sink = SdoBuffer::new(&mut room);
    let protocol = SdoProtocol::Segmented;
    let mut upload = SdoUpload::new(NODE, object, &mut sink, protocol, patience, now);
    while upload.outcome().is_none() {
        while let Some(frame) = upload.poll(now) {
            assert!(!board.receive(&frame));
        }
        board.serve();
        while let Some(frame) = board.transmit() {
            upload.receive(&frame, now);
        }
    }
    assert_eq!(upload.outcome(), Some(Ok(())));
    sink.bytes().to_vec()
}
