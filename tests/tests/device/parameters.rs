//! Parameters over the bus: one by one with their ranges, or a whole set, all or nothing.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::bus::{Abort, BoardState, Object, Order, SdoError, SdoProtocol};
use leadscrew_core::link::{ImageWriter, identity};
use leadscrew_core::params::{Entry, Params};
use leadscrew_tests::gateway::{Gateway, Upload};
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

pub const IMAGE: Object = Object::new(0x5010, 1);

pub fn parameter(no: u16, sub: u8) -> Object {
    Object::new(0x2000 + no, sub)
}

pub fn write(
    gateway: &mut Gateway,
    sim: &mut Sim,
    object: Object,
    value: i64,
    length: usize,
) -> Result<(), SdoError> {
    let bytes = value.to_le_bytes();
    let written = gateway.write(sim, object, &bytes[..length], SdoProtocol::Short);
    written.map_err(|error| match error {
        SdoError::Refused(_) => error,
        other => panic!("{other:?}"),
    })
}

pub fn refused(abort: Abort) -> Result<(), SdoError> {
    Err(SdoError::Refused(abort.code()))
}

/// Lets the drives come up again.
pub fn rest(gateway: &mut Gateway, sim: &mut Sim) {
    for _ in 0..2000 {
        sim.step();
        while sim.event().is_some() {}
        gateway.listen(sim);
        if gateway.status.state == BoardState::Idle {
            return;
        }
    }
    panic!("the drives did not come up: {:?}", gateway.status);
}

#[test]
fn a_value_is_taken_in_its_range_and_comes_into_force() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    // 9007: 1…50 %.
    let tolerance = parameter(9007, 0);
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9007, 0), Ok(15));
    let before = gateway.number(&mut sim, 0x1020, 1).unwrap();
    for (value, expected) in [
        (51, refused(Abort::TooHigh)),
        (0, refused(Abort::TooLow)),
        (10, Ok(())),
    ] {
        assert_eq!(write(&mut gateway, &mut sim, tolerance, value, 1), expected);
    }
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9007, 0), Ok(10));
    assert_ne!(gateway.number(&mut sim, 0x1020, 1), Ok(before));
    rest(&mut gateway, &mut sim);
    // An axis is a sub-index, and the second number of a record is the same parameter.
    let rapid = parameter(1420, 2);
    let slow = 1_000_000_000;
    assert_eq!(gateway.number(&mut sim, 0x2000 + 1420, 0), Ok(3));
    let length = gateway
        .read(&mut sim, rapid, SdoProtocol::Short)
        .unwrap()
        .len();
    assert_eq!(
        write(&mut gateway, &mut sim, rapid, slow, length),
        refused(Abort::Incompatible),
        "slower than the cutting feed"
    );
    assert_eq!(
        gateway.number(&mut sim, 0x2000 + 19, 0),
        gateway.number(&mut sim, 0x2000 + 5130, 0)
    );
}

#[test]
fn bits_are_one_byte_and_no_limit_is_a_value() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let switch = parameter(9008, 0);
    assert_eq!(write(&mut gateway, &mut sim, switch, 1, 1), Ok(()));
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9008, 0), Ok(1));
    assert_eq!(
        write(&mut gateway, &mut sim, switch, 2, 1),
        refused(Abort::TooHigh)
    );
}

/// "None" is the next number beyond the values, and C alone has it [D197].
#[test]
fn a_rotary_axis_may_have_no_limit_and_a_slide_has_one() {
    /// 99 999.9999°, and millimetres.
    const MOST: i64 = 99_999_999_900;
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut expected = Params::sheets();
    for (no, sign, beyond) in [(1320, 1, Abort::TooHigh), (1321, -1, Abort::TooLow)] {
        let limit = parameter(no, 3);
        let mut read = |sim: &mut Sim| {
            let bytes = gateway.read(sim, limit, SdoProtocol::Segmented).unwrap();
            i64::from_le_bytes(bytes.try_into().unwrap())
        };
        assert_eq!(read(&mut sim), sign * (MOST + 1), "none, as built in");
        for value in [sign * MOST, sign * (MOST + 1)] {
            assert_eq!(write(&mut gateway, &mut sim, limit, value, 8), Ok(()));
            rest(&mut gateway, &mut sim);
            let bytes = gateway.read(&mut sim, limit, SdoProtocol::Segmented);
            assert_eq!(bytes.unwrap(), value.to_le_bytes());
            // In the set it is what files and images have.
            let entry = Entry::find_text(&format!("{no}.C")).unwrap();
            let raw = entry.none().filter(|_| value.abs() > MOST);
            expected.set(entry, raw.unwrap_or(value)).unwrap();
            assert_eq!(
                gateway.number(&mut sim, 0x1020, 1),
                Ok(identity(&expected).into())
            );
        }
        let integer = if sign > 0 { i64::MAX } else { i64::MIN };
        for (sub, least) in [(1, MOST + 1), (2, MOST + 1), (3, MOST + 2)] {
            for value in [sign * least, integer] {
                assert_eq!(
                    write(&mut gateway, &mut sim, parameter(no, sub), value, 8),
                    refused(beyond),
                    "{no}.{sub}: {value}"
                );
            }
        }
    }
}

#[test]
fn each_drive_has_a_number_of_its_own() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let z = parameter(9015, 2);
    let first = parameter(9016, 0);
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9015, 2), Ok(17));
    for (object, node, expected, why) in [
        (z, 0, Abort::TooLow, None),
        // The gateway's.
        (z, 127, Abort::TooHigh, None),
        // X, and the last of the spindles.
        (z, 16, Abort::Incompatible, Some(4377)),
        (z, 35, Abort::Incompatible, Some(4377)),
        // The board.
        (z, 1, Abort::Incompatible, Some(4378)),
        (first, 124, Abort::TooHigh, None),
        (first, 15, Abort::Incompatible, Some(4377)),
        (first, 1, Abort::Incompatible, Some(4378)),
    ] {
        let written = write(&mut gateway, &mut sim, object, node, 1);
        assert_eq!(written, refused(expected), "{node}");
        if let Some(why) = why {
            assert_eq!(gateway.number(&mut sim, 0x5010, 7), Ok(why), "{node}");
        }
    }
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9015, 2), Ok(17));
    assert_eq!(write(&mut gateway, &mut sim, z, 126, 1), Ok(()));
    assert_eq!(gateway.number(&mut sim, 0x2000 + 9015, 2), Ok(126));
}

#[test]
fn a_running_machine_and_a_protected_one_refuse_with_their_reasons() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let program = calls("G98 F500\nG01 X20\nM30\n", &params);
    Upload::new(1, &program).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    for _ in 0..100 {
        sim.step();
    }
    let tolerance = parameter(9007, 0);
    let mut image = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::new(&params).read(0, &mut image);
    assert_eq!(
        write(&mut gateway, &mut sim, tolerance, 10, 1),
        refused(Abort::State)
    );
    assert_eq!(
        gateway.write(&mut sim, IMAGE, &image, SdoProtocol::Block),
        refused(Abort::State)
    );
    gateway.order(&mut sim, Order::Reset);
    rest(&mut gateway, &mut sim);

    let enable = parameter(9026, 0);
    assert_eq!(write(&mut gateway, &mut sim, enable, 0, 1), Ok(()));
    assert_eq!(
        write(&mut gateway, &mut sim, tolerance, 10, 1),
        refused(Abort::LocalControl)
    );
    assert_eq!(
        gateway.write(&mut sim, IMAGE, &image, SdoProtocol::Block),
        refused(Abort::LocalControl)
    );
    assert_eq!(write(&mut gateway, &mut sim, enable, 1, 1), Ok(()));
    assert_eq!(write(&mut gateway, &mut sim, tolerance, 10, 1), Ok(()));
}

#[test]
fn an_image_is_read_written_and_taken_whole_or_not_at_all() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let wanted = with(&[("9007", 12), ("9009", 2_000_000), ("1221.Z", 5_000_000)]);
    let mut image = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::new(&wanted).read(0, &mut image);
    let identity_of = |gateway: &mut Gateway, sim: &mut Sim| {
        gateway.number(sim, 0x1020, 1).expect("the identity") as u32
    };

    // Damaged, short, of another table, and one that cannot work.
    let mut damaged = image.clone();
    damaged[100] ^= 1;
    let mut foreign = image.clone();
    foreign[0] ^= 1;
    let mut impossible = wanted.clone();
    let rapid = Entry::find_text("1420.X").unwrap();
    impossible.set(rapid, rapid.min()).unwrap();
    let mut useless = image.clone();
    ImageWriter::new(&impossible).read(0, &mut useless);
    for (bytes, abort) in [
        (&damaged[..], Abort::Crc),
        (&image[..image.len() - 1], Abort::Length),
        (&foreign[..], Abort::Incompatible),
        (&useless[..], Abort::Incompatible),
    ] {
        for protocol in [SdoProtocol::Block, SdoProtocol::Segmented] {
            assert_eq!(
                gateway.write(&mut sim, IMAGE, bytes, protocol),
                refused(abort),
                "{abort:?}"
            );
            assert_eq!(
                identity_of(&mut gateway, &mut sim),
                identity(&Params::sheets())
            );
        }
    }
    gateway
        .write(&mut sim, IMAGE, &image, SdoProtocol::Block)
        .unwrap();
    assert_eq!(identity_of(&mut gateway, &mut sim), identity(&wanted));
    for protocol in [SdoProtocol::Block, SdoProtocol::Short] {
        assert_eq!(gateway.read(&mut sim, IMAGE, protocol), Ok(image.clone()));
    }
    // The drives come up, and the machine works with it.
    rest(&mut gateway, &mut sim);
    let before = sim.board().ticker().executor().position();
    assert_eq!(before, Default::default());
}
