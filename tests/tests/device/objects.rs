//! The object dictionary as any CANopen tool finds it.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::device::dictionary::{Access, Initial, Kind, PARAMETERS, items};
use leadscrew_core::board::{Command, State};
use leadscrew_core::bus::{
    Abort, BoardCommand, BoardPlace, BoardSpindle, BoardStatus, Mapped, Object, SdoError,
    SdoProtocol,
};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

fn refused(abort: Abort) -> SdoError {
    SdoError::Refused(abort.code())
}

#[test]
fn the_page_of_the_bus_names_every_object() {
    let page = include_str!("../../../docs/bus.md");
    for item in items() {
        let index = item.object.index;
        // The parameters have a page of their own.
        if (PARAMETERS..0x5000).contains(&index) {
            continue;
        }
        let (alone, family) = (format!("{index:04X}h"), format!("{:02X}xxh", index >> 8));
        let is_named = page.contains(&alone) || page.contains(&family);
        assert!(is_named, "docs/bus.md does not name {alone}: {item:?}");
    }
}

#[test]
fn every_object_answers_as_the_dictionary_says() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut last = None;
    let mut count = 0;
    for item in items() {
        assert!(Some(item.object) > last, "{item:?}: in order, each once");
        last = Some(item.object);
        count += 1;
        for protocol in [SdoProtocol::Short, SdoProtocol::Block] {
            let read = gateway.read(&mut sim, item.object, protocol);
            match (item.access, item.object.index) {
                (Access::Write, _) => assert_eq!(read, Err(refused(Abort::WriteOnly))),
                // The history of a machine without errors, and what has not been yet.
                (_, 0x1003) if item.object.sub > 0 => {
                    assert_eq!(read, Err(refused(Abort::NoData)));
                }
                (_, 0x5030) if item.object.sub > 0 => {
                    assert_eq!(read, Err(refused(Abort::NoData)));
                }
                _ => {
                    let bytes = read.unwrap_or_else(|e| panic!("{item:?}: {e:?}"));
                    if let Some(length) = item.kind.bytes() {
                        assert_eq!(bytes.len(), length, "{item:?}");
                    }
                    if let (Initial::Number(number), Some(length)) =
                        (item.initial, item.kind.bytes())
                    {
                        assert_eq!(bytes, number.to_le_bytes()[..length], "{item:?}");
                    }
                    if let Initial::Text(text) = item.initial {
                        assert_eq!(bytes, text.as_bytes());
                    }
                }
            }
        }
        if matches!(item.access, Access::Const | Access::Read) {
            let length = item.kind.bytes().unwrap_or(4);
            let zeros = [0; 8];
            let written =
                gateway.write(&mut sim, item.object, &zeros[..length], SdoProtocol::Short);
            assert_eq!(written, Err(refused(Abort::ReadOnly)), "{item:?}");
        }
        if item.access == Access::Both && item.kind != Kind::Domain {
            let length = item.kind.bytes().unwrap();
            let zeros = [0; 9];
            let long = gateway.write(
                &mut sim,
                item.object,
                &zeros[..=length],
                SdoProtocol::Segmented,
            );
            assert_eq!(long, Err(refused(Abort::TooLong)), "{item:?}");
            if length > 1 {
                let short = gateway.write(
                    &mut sim,
                    item.object,
                    &zeros[..length - 1],
                    SdoProtocol::Short,
                );
                assert_eq!(short, Err(refused(Abort::TooShort)), "{item:?}");
            }
        }
    }
    assert!(count > 300, "{count}");
    for (object, abort) in [
        (Object::new(0x1002, 0), Abort::NoObject),
        (Object::new(0x1018, 5), Abort::NoSubIndex),
        (Object::new(0x2000, 0), Abort::NoObject),
        (Object::new(0x2000 + 1420, 4), Abort::NoSubIndex),
        (Object::new(0x2000 + 9007, 1), Abort::NoSubIndex),
        (Object::new(0x6041, 0), Abort::NoObject),
    ] {
        assert_eq!(
            gateway.read(&mut sim, object, SdoProtocol::Short),
            Err(refused(abort)),
            "{object:?}"
        );
        assert_eq!(
            gateway.write(&mut sim, object, &[0], SdoProtocol::Short),
            Err(refused(abort)),
            "{object:?}"
        );
    }
}

/// What the dictionary says of the limits, and with it the EDS, is what the board goes by: what stands after power-up is
/// within them, and what is next to them is refused with the code that says which side it is on.
#[test]
fn every_value_is_within_the_limits_that_are_told_and_nothing_beyond_is_taken() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let (mut read, mut refusals) = (0, 0);
    for item in items() {
        let Some(length) = item.kind.bytes() else {
            assert_eq!(item.range, None, "{item:?}");
            continue;
        };
        // The numbers that so many bytes can say.
        let bits = 8 * length as u32;
        let all = match item.kind {
            Kind::I16 | Kind::I32 | Kind::I64 => -(1_i128 << (bits - 1))..1 << (bits - 1),
            _ => 0..1_i128 << bits,
        };
        let (low, high) = item.range.map_or((all.start, all.end - 1), |(low, high)| {
            (i128::from(low), i128::from(high))
        });
        assert!(all.contains(&low) && all.contains(&high), "{item:?}");
        if item.access != Access::Write
            && let Ok(bytes) = gateway.read(&mut sim, item.object, SdoProtocol::Short)
        {
            let mut raw = [0; 8];
            raw[..length].copy_from_slice(&bytes);
            let value = match item.kind {
                Kind::U64 => i128::from(u64::from_le_bytes(raw)),
                kind => i128::from(kind.number(raw)),
            };
            assert!((low..=high).contains(&value), "{item:?}: {value}");
            read += 1;
        }
        if !matches!(item.access, Access::Both | Access::Write) {
            continue;
        }
        let least = all.start;
        let most = all.end - 1;
        for (values, abort) in [
            ([high + 1, most], Abort::TooHigh),
            ([low - 1, least], Abort::TooLow),
        ] {
            for value in values {
                if (low..=high).contains(&value) || !all.contains(&value) {
                    continue;
                }
                let bytes = value.to_le_bytes();
                let written = gateway.write(
                    &mut sim,
                    item.object,
                    &bytes[..length],
                    SdoProtocol::Segmented,
                );
                assert_eq!(written, Err(refused(abort)), "{item:?}: {value}");
                refusals += 1;
            }
        }
    }
    assert!(read > 300 && refusals > 300, "{read}, {refusals}");
}

#[test]
fn mappings_are_those_of_the_frames() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut same = |index, mapping: &[Mapped]| {
        assert_eq!(gateway.number(&mut sim, index, 0), Ok(mapping.len() as u64));
        for (sub, mapped) in (1..).zip(mapping) {
            let raw = u64::from(mapped.raw());
            assert_eq!(gateway.number(&mut sim, index, sub), Ok(raw));
            let item = items()
                .find(|item| item.object == mapped.object)
                .expect("the mapped object");
            assert!(item.mappable);
            assert_eq!(item.kind.bytes(), Some(usize::from(mapped.bits / 8)));
        }
    };
    same(0x1600, &BoardCommand::MAPPING);
    same(0x1A00, &BoardStatus::MAPPING);
    same(0x1A01, &BoardPlace::MAPPING);
    same(0x1A02, &BoardSpindle::MAPPING);
}

#[test]
fn the_frame_with_all_setpoints_is_told_of_as_tpdo4() {
    for (set, cob_id) in [(0, 0xC000_0481), (1, 0x4000_0481)] {
        let params = with(&[("9031", set)]);
        let mut sim = machine(&params, &PlantOptions::default());
        let mut gateway = Gateway::connect(&mut sim);
        let mut read = |index, sub| gateway.number(&mut sim, index, sub).unwrap();
        assert_eq!(
            [read(0x1803, 0), read(0x1803, 1), read(0x1803, 2)],
            [2, cob_id, 1]
        );
        assert_eq!(read(0x1A03, 0), 0);
    }
}

#[test]
fn the_facts_of_5001h_are_those_of_the_process_data() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    for _ in 0..30 {
        sim.step();
        gateway.listen(&mut sim);
    }
    assert_eq!(gateway.number(&mut sim, 0x5001, 0), Ok(12));
    let state = gateway.status.state as u64;
    assert_eq!(gateway.number(&mut sim, 0x5001, 2), Ok(state));
    let credit = u64::from(gateway.status.credit);
    assert!(credit > 0);
    assert_eq!(gateway.number(&mut sim, 0x5001, 7), Ok(credit));
    // Nothing is synchronised.
    assert_eq!(gateway.number(&mut sim, 0x5001, 12), Ok(0x8000));
}

#[test]
fn the_operator_works_by_sdo_too() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut write = |sim: &mut _, sub, value: u8| {
        gateway.write(sim, Object::new(0x5000, sub), &[value], SdoProtocol::Short)
    };
    assert_eq!(write(&mut sim, 4, 50), Ok(()));
    assert_eq!(write(&mut sim, 3, 0x11), Ok(()));
    assert_eq!(write(&mut sim, 2, 2), Ok(()));
    assert_eq!(write(&mut sim, 2, 40), Err(refused(Abort::TooHigh)));
    assert_eq!(write(&mut sim, 2, 7), Err(refused(Abort::Value)));
    sim.step();
    let operator = *sim.board().ticker().operator();
    assert!(operator.hold && operator.single_block);
    assert_eq!(operator.feed_percent(), 50);
    // 255 leaves it.
    assert_eq!(write(&mut sim, 4, 255), Ok(()));
    sim.step();
    assert_eq!(gateway.number(&mut sim, 0x5000, 4), Ok(50));
    assert_eq!(gateway.number(&mut sim, 0x5000, 3), Ok(1));
}

#[test]
fn signals_are_inputs_and_undefined_bits_are_refused() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let object = Object::new(0x5060, 0);
    let mut write = |sim: &mut _, value: u16| {
        gateway.write(sim, object, &value.to_le_bytes(), SdoProtocol::Short)
    };
    assert_eq!(write(&mut sim, 0x0021), Ok(()));
    assert_eq!(write(&mut sim, 0x0008), Err(refused(Abort::Value)));
    assert_eq!(write(&mut sim, 0x8008), Err(refused(Abort::Value)));
    sim.step();
    let signals = sim.board().ticker().operator().signals;
    assert!(signals.g61_2);
    assert_eq!(signals.sws, 2);
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x21));
}

/// Bits 12 to 14 of 5060h.
#[test]
fn hold_single_block_and_emergency_stop_are_told_behind_the_signals() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let signals = |gateway: &mut Gateway, sim: &mut _| gateway.number(sim, 0x5060, 0);
    assert_eq!(signals(&mut gateway, &mut sim), Ok(0));
    let orders = [
        (Command::Hold, 0x1000),
        (Command::SingleBlock(true), 0x3000),
        (Command::Resume, 0x2000),
        (Command::Stop, 0x6000),
        (Command::Hold, 0x7000),
        (Command::SingleBlock(false), 0x5000),
        // Nothing is held any more either.
        (Command::Reset, 0),
    ];
    for (command, expected) in orders {
        sim.command(command);
        // A reset brings the drives up again.
        for _ in 0..1000 {
            sim.step();
        }
        assert_eq!(
            signals(&mut gateway, &mut sim),
            Ok(expected),
            "after {command:?}"
        );
    }
    // Another alarm is no emergency stop.
    sim.command(Command::Halt(Code::NetworkStop));
    for _ in 0..1000 {
        sim.step();
    }
    assert!(sim.board().ticker().has_alarm());
    assert_eq!(signals(&mut gateway, &mut sim), Ok(0));
}

/// Bit 15 of 5060h: no index has passed before the spindle has turned.
#[test]
fn that_the_angle_counts_from_the_index_is_told_behind_the_signals() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0));
    for call in calls("M3 S300\nG4 X1\nM5\nM30\n", &Params::sheets()) {
        assert!(sim.offer(&call));
    }
    // The spindle turns for a second, and comes to a stop.
    for _ in 0..10_000 {
        sim.step();
    }
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x8000));
}

/// [D164]
#[test]
fn who_writes_signals_back_neither_sets_nor_ends_what_is_mirrored() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let write = |gateway: &mut Gateway, sim: &mut _, value: u16| {
        let object = Object::new(0x5060, 0);
        gateway.write(sim, object, &value.to_le_bytes(), SdoProtocol::Short)
    };
    // All four, with SWS1: the signal counts, nothing is held or stopped, no index has passed.
    assert_eq!(write(&mut gateway, &mut sim, 0xF010), Ok(()));
    sim.step();
    let operator = *sim.board().ticker().operator();
    assert!(!operator.hold && !operator.single_block);
    assert_eq!(operator.signals.sws, 1);
    assert_eq!(sim.board().ticker().state(), State::Idle);
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x0010));
    // The other way round: they are on, and are written as 0.
    sim.command(Command::Hold);
    sim.command(Command::SingleBlock(true));
    sim.step();
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x3010));
    assert_eq!(write(&mut gateway, &mut sim, 0x0020), Ok(()));
    sim.step();
    assert_eq!(sim.board().ticker().operator().signals.sws, 2);
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x3020));
    // What means nothing is refused with them too, and changes nothing.
    assert_eq!(
        write(&mut gateway, &mut sim, 0x3008),
        Err(refused(Abort::Value))
    );
    assert_eq!(
        write(&mut gateway, &mut sim, 0x3002),
        Err(refused(Abort::Value))
    );
    sim.step();
    assert_eq!(gateway.number(&mut sim, 0x5060, 0), Ok(0x3020));
}
