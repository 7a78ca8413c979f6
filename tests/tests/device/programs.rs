//! Programs over the wire give the same setpoints as without it, whatever their size and whatever goes wrong on the way.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::board::Event;
use leadscrew_core::board::device::{DROP, PROGRAM_BYTES};
use leadscrew_core::bus::{
    Abort, BoardState, NodeId, Object, Order, SdoDownload, SdoError, SdoProtocol,
};
use leadscrew_core::call::{Call, CallKind, TapSpindle};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::{
    Certificate, EventReader, SetpointHash, Status, VERSION, Version, encode_call,
};
use leadscrew_core::params::Params;
use leadscrew_core::program::{self, Options};
use leadscrew_tests::gateway::{BATCH, Gateway, NODE, Upload};
use leadscrew_tests::machine::{Ran, STANDING_TICKS, calls, machine, run_calls};

/// Feeds, starts and carries out the program in lock-step: a tick waits for what the gateway still has to send.
fn run_fed(calls: &[Call], protocol: SdoProtocol, most: u32) -> (Ran, Gateway, Certificate) {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut upload = Upload::new(7, calls);
    (upload.protocol, upload.most) = (protocol, most);
    upload.feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    sim.settle();
    let mut ran = Ran::default();
    while !upload.is_done() || sim.is_busy() {
        while sim.awaits_program() && upload.feed(&mut gateway, &mut sim) {}
        step(&mut sim, &mut gateway, &mut ran);
        if ran.alarm.is_some() {
            break;
        }
    }
    for _ in 0..STANDING_TICKS {
        ran.rows.extend(sim.step());
    }
    sim.last_rows(|row| ran.rows.push(row));
    let bytes = gateway
        .read(&mut sim, Object::new(0x5041, 0), SdoProtocol::Block)
        .unwrap();
    let certificate = Certificate::decode(&bytes).unwrap().unwrap();
    (ran, gateway, certificate)
}

/// The hash of the contract, over the rows of a run.
fn hash_of(rows: &[Row]) -> u64 {
    let mut hash = SetpointHash::new();
    for row in rows {
        let spindle = row.spindle_set.map(|angle| (TapSpindle::First, angle));
        hash.push(row.position, spindle, row.doing == Doing::Run);
    }
    hash.value()
}

fn step(sim: &mut Sim, gateway: &mut Gateway, ran: &mut Ran) {
    ran.rows.extend(sim.step());
    while let Some(event) = sim.event() {
        if let Event::Alarm(alarm) = event {
            ran.alarm = Some(alarm);
        }
        ran.events.push(event);
    }
    gateway.listen(sim);
}

fn examples() -> Vec<(String, Vec<Call>)> {
    let params = Params::sheets();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
    let mut found: Vec<_> = std::fs::read_dir(folder)
        .expect("the examples")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ext| ext == "nc"))
        .filter_map(|path| {
            let text = std::fs::read(&path).expect("a file");
            let calls: Option<Vec<Call>> =
                program::Events::new(text.as_slice(), &params, Options::default())
                    .filter_map(|event| match event {
                        Ok(program::Event::Call(call)) => Some(Some(call)),
                        Ok(program::Event::Warning(_)) => None,
                        Err(_) => Some(None),
                    })
                    .collect();
            let mut calls = calls?;
            if !matches!(calls.last()?.kind, CallKind::End(_)) {
                let over = Call {
                    kind: CallKind::Over,
                    ..*calls.last()?
                };
                calls.push(over);
            }
            Some((path.file_name()?.to_string_lossy().into_owned(), calls))
        })
        .collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// The first row in which two runs differ.
fn difference(a: &[Row], b: &[Row]) -> Option<usize> {
    (0..a.len().max(b.len())).find(|&n| a.get(n) != b.get(n))
}

/// `run` where no program waits for it changes nothing, and is not swallowed: a warning by process data, an abort by SDO.
#[test]
fn a_run_without_a_program_is_refused_visibly() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let refusals = |sim: &mut Sim, gateway: &mut Gateway| {
        let entries = gateway
            .read(sim, Object::new(0x5040, 3), SdoProtocol::Segmented)
            .unwrap();
        EventReader::new(&entries)
            .map(Result::unwrap)
            .filter(
                |entry| matches!(entry.event, Event::Warning(w) if w.code == Code::NothingToRun),
            )
            .count()
    };
    gateway.order(&mut sim, Order::Run);
    assert_eq!(refusals(&mut sim, &mut gateway), 1);
    let by_sdo = |sim: &mut Sim, gateway: &mut Gateway| {
        let echo = sim.board().device().beat().ms().to_le_bytes();
        let told = gateway.write(sim, Object::new(0x5000, 7), &echo, SdoProtocol::Short);
        assert_eq!(told, Ok(()));
        gateway.write(sim, Object::new(0x5000, 2), &[1], SdoProtocol::Segmented)
    };
    let refused = Err(SdoError::Refused(Abort::State.code()));
    assert_eq!(by_sdo(&mut sim, &mut gateway), refused);
    assert_eq!(refusals(&mut sim, &mut gateway), 2);
    // A program that waits, and one that runs already.
    let calls = calls("G98 G1 X20 F100\nM30\n", &params);
    Upload::new(7, &calls).feed(&mut gateway, &mut sim);
    assert_eq!(by_sdo(&mut sim, &mut gateway), Ok(()));
    assert_eq!(by_sdo(&mut sim, &mut gateway), refused);
    // A program is under way: that is another refusal (4502).
    assert_eq!(refusals(&mut sim, &mut gateway), 2);
}

#[test]
fn every_example_gives_the_same_rows_over_the_wire() {
    let examples = examples();
    assert!(examples.len() >= 10, "{}", examples.len());
    let mut fed = 0;
    for (name, calls) in examples {
        let direct = run_calls(
            calls.clone(),
            &Params::sheets(),
            &PlantOptions::default(),
            |_, _| {},
        );
        let (over_wire, gateway, certificate) = run_fed(&calls, SdoProtocol::Block, u32::MAX);
        assert_eq!(
            difference(&direct.rows, &over_wire.rows),
            None,
            "{name}: first row that differs"
        );
        assert_eq!(direct.events, over_wire.events, "{name}");
        assert_eq!(certificate.program, 7, "{name}");
        assert_eq!(
            certificate.setpoint_hash,
            Some(hash_of(&direct.rows)),
            "{name}"
        );
        // The board judges by what it measures; the simulation knows better, but not by much.
        let truly: Vec<i64> = direct
            .rows
            .iter()
            .filter_map(|r| r.error)
            .map(|e| e.abs().nm())
            .collect();
        if direct.alarm.is_none() && (name.contains("g76") || name.contains("g84-tap")) {
            let largest = truly.iter().max().copied().unwrap_or(0);
            assert!(
                certificate.measured.abs_diff(truly.len() as u64) <= 60,
                "{name}: {certificate:?}, {}",
                truly.len()
            );
            assert!(
                certificate.largest.nm() <= largest + 2000,
                "{name}: {certificate:?}, {largest}"
            );
        }
        assert_eq!(direct.alarm, over_wire.alarm, "{name}");
        if direct.alarm.is_none() {
            assert_eq!(gateway.emergencies, [], "{name}");
            fed += 1;
        }
    }
    assert!(fed >= 10, "{fed}");
}

/// Many short lines back and forth.
fn long_program(lines: usize) -> Vec<Call> {
    let mut text = String::from("G98 F3000\n");
    for line in 0..lines {
        let x = 20 + line % 3;
        text.push_str(&format!("G01 X{x}.5 Z-{}.25\n", line % 5));
    }
    text.push_str("M30\n");
    calls(&text, &Params::sheets())
}

#[test]
fn a_program_larger_than_the_memory_runs_call_by_call_or_in_batches() {
    let calls = long_program(400);
    let bytes: usize = calls.iter().map(|c| encode_call(c).unwrap().len()).sum();
    assert!(bytes > 2 * PROGRAM_BYTES, "{bytes}");
    let direct = run_calls(
        calls.clone(),
        &Params::sheets(),
        &PlantOptions::default(),
        |_, _| {},
    );
    for (protocol, most) in [
        (SdoProtocol::Block, u32::MAX),
        (SdoProtocol::Segmented, 5),
        (SdoProtocol::Block, 1),
    ] {
        let (over_wire, ..) = run_fed(&calls, protocol, most);
        assert_eq!(difference(&direct.rows, &over_wire.rows), None);
        assert_eq!(over_wire.events.last(), Some(&Event::Finished));
    }
}

#[test]
fn nothing_moves_before_run_and_a_hold_goes_past_a_transfer() {
    let calls = long_program(30);
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut upload = Upload::new(1, &calls);
    upload.feed(&mut gateway, &mut sim);
    let mut ran = Ran::default();
    for _ in 0..50 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    assert!(ran.rows.iter().all(|row| row.doing == Doing::Idle));
    assert_eq!(gateway.status.state, BoardState::Idle);
    gateway.order(&mut sim, Order::Run);
    for _ in 0..100 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    assert_eq!(gateway.status.state, BoardState::Run);
    // Half of a transfer is on the wire when the operator presses hold.
    let image = Object::new(0x5020, 1);
    let data = [0; 200];
    let now = core::time::Duration::ZERO;
    let mut transfer = SdoDownload::new(NODE, image, &data, SdoProtocol::Segmented, now, now);
    for _ in 0..5 {
        let frame = transfer.poll(now).expect("a segment");
        sim.receive(&frame);
        while let Some(frame) = sim.transmit() {
            transfer.receive(&frame, now);
        }
    }
    assert_eq!(transfer.outcome(), None);
    assert!(!sim.board().ticker().operator().hold);
    gateway.order(&mut sim, Order::Hold);
    sim.step();
    assert!(sim.board().ticker().operator().hold, "in the next tick");
}

#[test]
fn a_transfer_that_is_broken_off_leaves_the_program_as_it_was() {
    let calls = long_program(3);
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let upload = Upload::new(1, &calls);
    let (bytes, count) = upload.batch(u16::MAX).unwrap();
    for frames in 1..10 {
        let now = core::time::Duration::ZERO;
        let mut transfer = SdoDownload::new(NODE, BATCH, &bytes, SdoProtocol::Segmented, now, now);
        for _ in 0..frames {
            let frame = transfer.poll(now).expect("a segment");
            sim.receive(&frame);
            while let Some(frame) = sim.transmit() {
                transfer.receive(&frame, now);
            }
        }
        // Another transfer begins; the previous one is lost.
        assert_eq!(gateway.number(&mut sim, 0x5020, 4), Ok(0));
        assert_eq!(
            gateway.number(&mut sim, 0x5020, 5),
            Ok(PROGRAM_BYTES as u64)
        );
    }
    gateway
        .write(&mut sim, BATCH, &bytes, SdoProtocol::Block)
        .unwrap();
    assert_eq!(gateway.number(&mut sim, 0x5020, 4), Ok(u64::from(count)));
}

#[test]
fn a_batch_that_comes_twice_is_carried_out_once() {
    let calls = long_program(20);
    let direct = run_calls(
        calls.clone(),
        &Params::sheets(),
        &PlantOptions::default(),
        |_, _| {},
    );
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut upload = Upload::new(1, &calls);
    upload.most = 4;
    while let Some((bytes, count)) = upload.batch(u16::MAX) {
        for _ in 0..3 {
            gateway
                .write(&mut sim, BATCH, &bytes, SdoProtocol::Block)
                .unwrap();
        }
        upload.taken(count);
    }
    gateway.order(&mut sim, Order::Run);
    let mut ran = Ran::default();
    sim.settle();
    while sim.is_busy() {
        step(&mut sim, &mut gateway, &mut ran);
    }
    assert_eq!(ran.events, direct.events);
    let count = ran.rows.len();
    assert_eq!(difference(&direct.rows[..count], &ran.rows), None);
}

#[test]
fn another_version_of_the_link_is_refused_and_both_can_be_named() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let upload = Upload::new(1, &long_program(1));
    let (mut bytes, _) = upload.batch(u16::MAX).unwrap();
    bytes[1] ^= 0x01;
    assert_eq!(
        gateway.write(&mut sim, BATCH, &bytes, SdoProtocol::Block),
        Err(SdoError::Refused(Abort::Incompatible.code()))
    );
    let raw = gateway.number(&mut sim, 0x5020, 2).unwrap();
    assert_eq!(Version::from_raw(raw), VERSION);
}

#[test]
fn calls_that_no_program_can_say_are_refused_whole() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut calls = long_program(2);
    let far = leadscrew_core::units::Length::from_nm(1 << 50);
    calls[1].origin.x = far;
    let upload = Upload::new(1, &calls);
    let (bytes, _) = upload.batch(u16::MAX).unwrap();
    assert_eq!(
        gateway.write(&mut sim, BATCH, &bytes, SdoProtocol::Block),
        Err(SdoError::Refused(Abort::Value.code()))
    );
    assert_eq!(gateway.number(&mut sim, 0x5020, 4), Ok(0));
    assert_eq!(gateway.number(&mut sim, 0x5020, 3), Ok(0));
}

#[test]
fn a_reset_forgets_the_program_and_the_rest_of_it_is_refused() {
    let calls = long_program(200);
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut upload = Upload::new(1, &calls);
    upload.feed(&mut gateway, &mut sim);
    assert!(!upload.is_done(), "there is more of it");
    gateway.order(&mut sim, Order::Run);
    let mut ran = Ran::default();
    for _ in 0..300 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    let (rest, _) = upload.batch(u16::MAX).unwrap();
    gateway.order(&mut sim, Order::Reset);
    // Even before the axes stand.
    assert_eq!(
        gateway.write(&mut sim, BATCH, &rest, SdoProtocol::Block),
        Err(SdoError::Refused(Abort::State.code()))
    );
    for _ in 0..300 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    assert_eq!(ran.events.last(), Some(&Event::Reset));
    assert_eq!(gateway.status.state, BoardState::Idle);
    assert_eq!(
        gateway.number(&mut sim, 0x5020, 5),
        Ok(PROGRAM_BYTES as u64)
    );
    // Another program runs as if nothing had happened.
    let other = calls_of("G98 F1000\nG01 X10\nM30\n");
    let mut upload = Upload::new(2, &other);
    upload.feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    for _ in 0..20_000 {
        step(&mut sim, &mut gateway, &mut ran);
        if ran.events.last() == Some(&Event::Finished) {
            return;
        }
    }
    panic!("the second program did not end: {:?}", ran.events.last());
}

fn calls_of(text: &str) -> Vec<Call> {
    calls(text, &Params::sheets())
}

#[test]
fn events_and_status_are_read_as_they_happened() {
    let calls = calls_of("G98 F1000\nG01 X10\nM08\nM30\n");
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    Upload::new(5, &calls).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    let mut ran = Ran::default();
    sim.settle();
    while sim.is_busy() {
        step(&mut sim, &mut gateway, &mut ran);
    }
    let bytes = gateway
        .read(&mut sim, Object::new(0x5040, 3), SdoProtocol::Block)
        .unwrap();
    let logged: Vec<_> = EventReader::new(&bytes).map(Result::unwrap).collect();
    // The machine was ready before it joined.
    let happened: Vec<_> = logged.iter().map(|entry| entry.event).collect();
    assert_eq!(happened[0], Event::Ready);
    assert_eq!(happened[1..], ran.events);
    let newest = logged.last().unwrap().number;
    assert_eq!(gateway.number(&mut sim, 0x5040, 1), Ok(u64::from(newest)));
    // From a number on.
    let from = Object::new(0x5040, 2);
    gateway
        .write(&mut sim, from, &newest.to_le_bytes(), SdoProtocol::Short)
        .unwrap();
    let bytes = gateway
        .read(&mut sim, Object::new(0x5040, 3), SdoProtocol::Short)
        .unwrap();
    assert_eq!(EventReader::new(&bytes).count(), 1);

    let bytes = gateway
        .read(&mut sim, Object::new(0x5001, 1), SdoProtocol::Short)
        .unwrap();
    let status = Status::decode(&bytes).unwrap().unwrap();
    assert_eq!(status.state, BoardState::Idle);
    assert_eq!(status.position, ran.rows.last().unwrap().position);
    assert_eq!((status.program, status.next_call), (5, calls.len() as u32));
    assert_eq!(status.newest_event, newest);
    assert_eq!(status.alarm, None);
}

#[test]
fn an_alarm_is_told_once_with_its_number_and_cleared_by_the_reset() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    Upload::new(5, &calls_of("G98 F1000\nG01 X10\nG01 X5000\nM30\n")).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    let mut ran = Ran::default();
    for _ in 0..1000 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    let alarm = ran.alarm.expect("beyond the travel");
    assert_eq!(gateway.status.alarm, Some(alarm.number()));
    assert_eq!(gateway.status.state, BoardState::Alarm);
    let [emcy] = gateway.emergencies[..] else {
        panic!("{:?}", gateway.emergencies);
    };
    let [low, high] = alarm.number().to_le_bytes();
    assert_eq!((emcy.code, emcy.register), (0xFF00, 0x81));
    assert_eq!(emcy.detail, [low, high, 0, 0, 0]);
    assert_eq!(gateway.number(&mut sim, 0x1001, 0), Ok(0x81));
    assert_eq!(gateway.number(&mut sim, 0x1003, 0), Ok(1));
    assert_eq!(
        gateway.number(&mut sim, 0x1003, 1),
        Ok(u64::from(alarm.number()) << 16 | 0xFF00)
    );
    let told: Alarm = status(&mut gateway, &mut sim).alarm.unwrap();
    assert_eq!(told, alarm);
    gateway.order(&mut sim, Order::Reset);
    for _ in 0..1000 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    assert_eq!(gateway.emergencies.len(), 2);
    assert_eq!(gateway.emergencies[1].code, 0);
    assert_eq!(gateway.status.alarm, None);
    assert_eq!(gateway.number(&mut sim, 0x1001, 0), Ok(0));
    assert_ne!(alarm.code, Code::EmergencyStop);
    assert_eq!(NODE, NodeId::BOARD);
}

fn status(gateway: &mut Gateway, sim: &mut Sim) -> Status {
    let bytes = gateway
        .read(sim, Object::new(0x5001, 1), SdoProtocol::Block)
        .unwrap();
    Status::decode(&bytes).unwrap().unwrap()
}

#[test]
fn the_tap_journal_is_read_and_its_record_dropped() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let (record, discard) = (Object::new(0x5030, 1), Object::new(0x5030, 2));
    let drop = DROP.to_le_bytes();
    let refused = |abort: Abort| Err(SdoError::Refused(abort.code()));
    let write = |gateway: &mut Gateway, sim: &mut Sim, bytes: &[u8]| {
        gateway.write(sim, discard, bytes, SdoProtocol::Short)
    };
    assert_eq!(write(&mut gateway, &mut sim, &drop), refused(Abort::NoData));
    let tap = "G98\nG0 X0 Z5\nM29 S400\nG84 Z-20 R-3 F600\nM30\n";
    Upload::new(1, &calls_of(tap)).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    let mut ran = Ran::default();
    let in_hole = |sim: &Sim| {
        let position = sim.board().ticker().executor().position();
        position.z.nm() < -10_000_000
    };
    while !in_hole(&sim) {
        step(&mut sim, &mut gateway, &mut ran);
        assert!(ran.rows.len() < 20_000 && ran.alarm.is_none());
    }
    assert_eq!(write(&mut gateway, &mut sim, &drop), refused(Abort::State));
    gateway.order(&mut sim, Order::Stop);
    for _ in 0..500 {
        step(&mut sim, &mut gateway, &mut ran);
    }
    let bytes = gateway
        .read(&mut sim, record, SdoProtocol::Short)
        .expect("the record");
    let told = TapRecord::decode(&bytes).expect("undamaged");
    assert_eq!(told.as_ref(), sim.board().ticker().tap_record());
    assert!(told.is_some_and(|tap| tap.in_hole));
    assert_eq!(
        write(&mut gateway, &mut sim, b"none"),
        refused(Abort::Value)
    );
    assert_eq!(write(&mut gateway, &mut sim, &drop), Ok(()));
    step(&mut sim, &mut gateway, &mut ran);
    let left = sim.board().ticker().tap_record();
    assert!(left.is_none_or(|tap| !tap.in_hole), "{left:?}");
}
