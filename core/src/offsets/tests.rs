#![allow(clippy::arithmetic_side_effects)]

extern crate std;

use std::vec::Vec;

use super::image::{BYTES, Head, ImageFault, check, empty};
use super::*;
use crate::checksum::crc32;
use crate::params::Entry;

fn mm(tenths: i64) -> Length {
    Length::from_nm(tenths * 100)
}

fn offset(x: i64, z: i64) -> Offset {
    Offset {
        x: Diameter::from_nm(x * 100),
        z: mm(z),
    }
}

/// Another value in every place.
fn full() -> Offsets {
    let mut table = Offsets {
        revision: Revision(0x0102_0304),
        shift: offset(-12_345, 67_891),
        ..Offsets::default()
    };
    table.thread = PickedUp {
        tip: offset(771_234, -654_321),
        angle: Some(Angle::from_udeg(123_456_700)),
    };
    for (at, work) in (1..).zip(&mut table.work) {
        *work = offset(-1_000_000 * at, -4_000_000 - at);
    }
    for (at, tool) in (1..).zip(&mut table.tools) {
        *tool = Tool {
            geometry: offset(-2_507_600 - at, 948_750 + at),
            wear: offset(-200 * at, 100 + at),
            radius: mm(4000 + at),
            tip: (at % 10) as u8,
            station: at as u8,
            measured_x: at % 2 == 0,
            measured_z: at % 3 == 0,
        };
    }
    table
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let sum = crc32(0, &bytes[..end]);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn a_table_comes_back_from_its_bytes() {
    for table in [Offsets::default(), full()] {
        let image = table.encode().unwrap();
        assert_eq!(Offsets::decode(&image), Ok(table));
        assert_eq!(
            check(&image),
            Ok(Head {
                revision: table.revision,
                sum: image::sum(&image)
            })
        );
    }
    assert_eq!(Offsets::default().encode(), Ok(empty()));
    assert_eq!(BYTES, 900);
}

#[test]
fn the_bytes_lie_where_the_page_says() {
    let image = full().encode().unwrap();
    assert_eq!(image[..8], [2, 0, 0, 0, 4, 3, 2, 1]);
    assert_eq!(image[8..12], (-12_345_i32).to_le_bytes());
    assert_eq!(image[16..20], (-1_000_000_i32).to_le_bytes());
    let second = 16 + 6 * 16 + 24;
    assert_eq!(image[second..second + 4], (-2_507_602_i32).to_le_bytes());
    assert_eq!(image[second + 16..second + 20], 4002_u32.to_le_bytes());
    assert_eq!(image[second + 20..second + 24], [2, 2, 1, 0]);
    let thread = 16 + 6 * 16 + 32 * 24;
    assert_eq!(image[thread..thread + 4], 771_234_i32.to_le_bytes());
    assert_eq!(image[thread + 8..thread + 12], 1_234_568_u32.to_le_bytes());
    assert_eq!(image[thread + 12..thread + 16], [0; 4]);
}

#[test]
fn every_damaged_bit_and_every_other_length_is_noticed() {
    let image = full().encode().unwrap();
    for bit in 0..BYTES * 8 {
        let mut damaged = image;
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(check(&damaged), Err(ImageFault::Damaged), "bit {bit}");
    }
    for length in 0..BYTES {
        assert_eq!(check(&image[..length]), Err(ImageFault::Damaged));
    }
    let mut long = image.to_vec();
    long.push(0);
    assert_eq!(check(&sealed(long)), Err(ImageFault::Damaged));
    let mut other = image.to_vec();
    other[0] = 1;
    let schema = ImageFault::Schema(1, Revision(0x0102_0304));
    assert_eq!(check(&sealed(other)), Err(schema));
}

#[test]
fn a_value_at_its_limit_is_taken_and_one_step_further_is_not() {
    type Change = fn(&mut Offsets, i64);
    let cases: [(Change, Length, Record); 10] = [
        (
            |t, n| t.shift.x = Diameter::from_nm(n),
            Offsets::WORK,
            Record::Shift,
        ),
        (
            |t, n| t.work[5].z = Length::from_nm(n),
            Offsets::WORK,
            Record::Work(59),
        ),
        (
            |t, n| t.tools[0].geometry.x = Diameter::from_nm(n),
            Offsets::GEOMETRY,
            Record::Tool(1),
        ),
        (
            |t, n| t.tools[31].geometry.z = Length::from_nm(-n),
            Offsets::GEOMETRY,
            Record::Tool(32),
        ),
        (
            |t, n| t.tools[1].wear.x = Diameter::from_nm(-n),
            Offsets::WEAR,
            Record::Tool(2),
        ),
        (
            |t, n| t.tools[1].radius = Length::from_nm(n),
            Offsets::RADIUS,
            Record::Tool(2),
        ),
        (
            |t, n| t.thread.tip.z = Length::from_nm(n),
            Offsets::WORK,
            Record::Thread,
        ),
        (
            |t, n| t.thread.angle = Some(Angle::from_udeg(n)),
            mm(3_599_999),
            Record::Thread,
        ),
        (
            |t, n| t.tools[6].tip = (n / 100) as u8,
            mm(9),
            Record::Tool(7),
        ),
        (
            |t, n| t.tools[7].station = (n / 100) as u8,
            mm(32),
            Record::Tool(8),
        ),
    ];
    for (change, most, record) in cases {
        let mut table = full();
        change(&mut table, most.nm());
        let image = table.encode().unwrap();
        assert_eq!(Offsets::decode(&image), Ok(table));
        change(&mut table, most.nm() + 100);
        assert_eq!(table.encode(), Err(record));
    }
    let mut fine = full();
    fine.tools[3].geometry.z = Length::from_nm(150);
    assert_eq!(fine.encode(), Err(Record::Tool(4)));
    let mut negative = full();
    negative.tools[3].radius = mm(-1);
    assert_eq!(negative.encode(), Err(Record::Tool(4)));
}

/// A board reads bytes that no program of ours has written.
#[test]
fn bytes_beyond_a_range_are_refused_with_their_record() {
    let image = full().encode().unwrap();
    let tool = |number: usize| 16 + 96 + 24 * (number - 1);
    for (at, bytes, record) in [
        (2, &[1][..], Record::Shift),
        (12, &1_000_000_000_i32.to_le_bytes(), Record::Shift),
        (16, &i32::MIN.to_le_bytes(), Record::Work(54)),
        (16 + 16 + 8, &[1], Record::Work(55)),
        (tool(5), &100_000_000_i32.to_le_bytes(), Record::Tool(5)),
        (
            tool(5) + 12,
            &(-1_000_000_i32).to_le_bytes(),
            Record::Tool(5),
        ),
        (tool(6) + 16, &u32::MAX.to_le_bytes(), Record::Tool(6)),
        (tool(7) + 20, &[10], Record::Tool(7)),
        (tool(8) + 21, &[33], Record::Tool(8)),
        (tool(32) + 22, &[4], Record::Tool(32)),
        (tool(32) + 23, &[1], Record::Tool(32)),
        (tool(33) + 4, &i32::MIN.to_le_bytes(), Record::Thread),
        (tool(33) + 8, &3_600_001_u32.to_le_bytes(), Record::Thread),
        (tool(33) + 15, &[1], Record::Thread),
    ] {
        let mut changed = image.to_vec();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        assert_eq!(
            check(&sealed(changed)),
            Err(ImageFault::Range(record)),
            "{at}"
        );
    }
}

#[test]
fn offsets_are_read_from_the_table_or_from_the_parameters() {
    let mut params = Params::sheets();
    for (key, raw) in [
        ("1221.X", 1_000_000),
        ("1222.Z", -5_000_000),
        ("9102.X", 250_000),
        ("9102.Z", 7_000_000),
        ("nose_radius_2", 400_000),
        ("nose_direction_2", 3),
    ] {
        params.set(Entry::find_text(key).unwrap(), raw).unwrap();
    }
    let old = Source {
        params: &params,
        table: None,
    };
    let table = Offsets::of_params(&params).unwrap();
    let new = Source {
        params: &Params::sheets(),
        table: Some(&table),
    };
    for source in [old, new] {
        assert_eq!(source.zero(0), [Length::from_nm(1_000_000), Length::ZERO]);
        assert_eq!(source.zero(1), [Length::ZERO, Length::from_nm(-5_000_000)]);
        assert_eq!(source.zero(6), [Length::ZERO; 2]);
        let tool = [Length::from_nm(250_000), Length::from_nm(7_000_000)];
        assert_eq!(source.tool(2), tool);
        assert_eq!(
            (source.tool(0), source.tool(33)),
            ([Length::ZERO; 2], [Length::ZERO; 2])
        );
        let (radius, tip) = (Length::from_nm(400_000), 3);
        assert_eq!(source.nose(2), Nose { radius, tip });
        assert_eq!(source.nose(0), Nose::default());
    }
    let tool = table.tools[1];
    assert!(tool.measured_x && tool.measured_z && !table.tools[0].measured_x);
}

#[test]
fn wear_and_shift_are_added() {
    let mut table = full();
    table.tools[0].wear = offset(-200, 50);
    let params = Params::sheets();
    let source = Source {
        params: &params,
        table: Some(&table),
    };
    let [x, z] = source.tool(1);
    assert_eq!(
        (x.nm(), z.nm()),
        ((-2_507_601 - 200) * 50, (948_751 + 50) * 100)
    );
    let [x, z] = source.zero(0);
    assert_eq!(
        (x.nm(), z.nm()),
        ((-1_000_000 - 12_345) * 50, (-4_000_001 + 67_891) * 100)
    );
    assert_eq!(source.work(0)[0].nm(), -1_000_000 * 50);
}

#[test]
fn parameters_that_no_table_can_have_are_named() {
    for (key, raw, record) in [
        ("nose_radius_4", -400_000, Record::Tool(4)),
        ("9103.Z", 150, Record::Tool(3)),
        ("1225.X", 25, Record::Work(58)),
    ] {
        let mut params = Params::sheets();
        params.set(Entry::find_text(key).unwrap(), raw).unwrap();
        assert_eq!(Offsets::of_params(&params), Err(record));
    }
}
