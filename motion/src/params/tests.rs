//! The table against the sheets, and every way to a value.

extern crate std;
use std::collections::{BTreeMap, BTreeSet};
use std::format;
use std::string::ToString;
use std::vec::Vec;

use super::*;

/// The built-in machine with these values.
pub(super) fn slant_bed_with(values: &[(&str, i64)]) -> Params {
    let mut params = Params::slant_bed();
    for (key, value) in values {
        params.set(Entry::find_text(key).unwrap(), *value).unwrap();
    }
    params
}

/// Defaults of the sheets' numbers, as text; the alias must lead to the same record.
const SHEETS: &[(&str, Option<&str>, &str)] = &[
    ("019", Some("5130"), "5 × 0.1 lead"),
    ("056", Some("5139"), "0.5 mm"),
    ("057", Some("5142"), "1"),
    ("058", Some("5143"), "60 °"),
    ("059", Some("5140"), "0.1 mm"),
    ("060", Some("5141"), "0.1 mm"),
    ("107", None, "0 mm/min"),
    ("182.7", None, "0"),
    ("5129", None, "0"),
    ("5131", None, "45 °"),
    ("5144", None, "0"),
    ("5145", None, "1"),
    ("5200.0", None, "0"),
    ("5200.2", None, "0"),
    ("5200.4", None, "0"),
    ("5200.5", None, "0"),
    ("5200.6", None, "0"),
    ("5200.7", None, "0"),
    ("5201.2", None, "0"),
    ("5201.3", None, "0"),
    ("5201.4", None, "0"),
    ("5202.6", None, "0"),
    ("5203.2", None, "0"),
    ("5203.4", None, "0"),
    ("5209.0", None, "0"),
    ("5210", None, "0"),
    ("5211", None, "0"),
    ("5213", None, "1 mm"),
    ("5241", None, "3000 rpm"),
    ("5261", None, "500 ms"),
    ("5271", None, "500 ms"),
    ("5275", None, "0"),
    ("5276", None, "10 × 0.1 rpm"),
    ("5382", Some("5282"), "0 mm"),
];

/// Ranges that the sheets print.
const RANGES: &[(&str, &str, &str)] = &[
    ("019", "0", "99"),
    ("056", "0", "99.9999"),
    ("057", "0", "99"),
    ("058", "0", "99"),
    ("059", "0", "99.9999"),
    ("060", "0", "99.9999"),
    ("5144", "0", "4"),
    ("5145", "0", "1"),
    ("5210", "0", "255"),
    ("5211", "0", "200"),
    ("5241", "0", "9999"),
    ("5261", "0", "4000"),
];

fn value(params: &Params, key: &str) -> std::string::String {
    let entry = Entry::find_text(key).unwrap_or_else(|e| panic!("{key}: {e:?}"));
    entry.unit().text(params.get(entry)).to_string()
}

#[test]
fn every_number_of_the_sheets_is_there_with_its_default_and_nothing_else() {
    let params = Params::slant_bed();
    let mut known = BTreeSet::new();
    for &(key, alias, default) in SHEETS {
        let entry = Entry::find_text(key).unwrap();
        assert_eq!(entry.to_string(), key);
        assert_eq!(value(&params, key), default, "{key}");
        assert_eq!(
            entry.alias().map(|a| a.to_string()).as_deref(),
            alias,
            "{key}"
        );
        if let Some(alias) = alias {
            assert_eq!(Entry::find_text(alias), Ok(entry));
        }
        known.insert(key);
    }
    // No sheet prints the numbers of the contour cycles and of drilling, nor that of the corners.
    let elsewhere = |number| matches!(number, 181 | 5101 | 5114 | 5132..=5137);
    let sheets = |e: &&Entry| (e.no < 1000 || (5000..6000).contains(&e.no)) && !elsewhere(e.no);
    for entry in Entry::all().iter().filter(sheets) {
        assert!(known.contains(entry.to_string().as_str()), "{entry}");
    }
    for &(key, min, max) in RANGES {
        let entry = Entry::find_text(key).unwrap();
        assert_eq!(entry.unit().number(entry.min()).to_string(), min, "{key}");
        assert_eq!(entry.unit().number(entry.max()).to_string(), max, "{key}");
    }
}

#[test]
fn the_built_in_machine_is_that_of_the_contract() {
    let p = Params::slant_bed();
    let mm = 1_000_000;
    assert!(!p.increment_is_c() && Params::sheets().increment_is_c());
    assert_eq!(
        (p.soft_limit_minus(Axis::X), p.soft_limit_plus(Axis::X)),
        (-300 * mm, 300 * mm)
    );
    assert_eq!(
        (p.soft_limit_minus(Axis::Z), p.soft_limit_plus(Axis::Z)),
        (-1000 * mm, 1000 * mm)
    );
    assert_eq!(
        (p.soft_limit_minus(Axis::C), p.soft_limit_plus(Axis::C)),
        (i64::MIN, i64::MAX)
    );
    assert_eq!(p.rapid(Axis::X), Feed::from_nm_per_min(12_000 * mm));
    assert_eq!(p.rapid(Axis::Z), Feed::from_nm_per_min(16_000 * mm));
    assert_eq!(p.rapid(Axis::C), Feed::from_nm_per_min(7_200 * 60 * mm));
    assert_eq!(p.max_feed(Axis::X), Feed::from_nm_per_min(8_000 * mm));
    assert_eq!(p.max_feed(Axis::Z), Feed::from_nm_per_min(8_000 * mm));
    assert_eq!(
        p.acceleration(Axis::X),
        Acceleration::from_nm_per_s2(2_000 * mm)
    );
    assert_eq!(
        p.acceleration(Axis::Z),
        Acceleration::from_nm_per_s2(3_000 * mm)
    );
    assert_eq!(
        p.acceleration(Axis::C),
        Acceleration::from_nm_per_s2(20_000 * mm)
    );
    assert_eq!(p.jerk(Axis::X), Jerk::from_nm_per_s3(60_000 * mm));
    assert_eq!(p.jerk(Axis::Z), Jerk::from_nm_per_s3(60_000 * mm));
    assert_eq!(p.jerk(Axis::C), Jerk::from_nm_per_s3(400_000 * mm));
    assert_eq!((p.spindle_max_rpm(), p.spindle_ramp_ms()), (3000, 500));
    assert_eq!((p.encoder_counts(), p.tick_us()), (4096, 1000));
    for axis in Axis::ALL {
        assert_eq!(
            (p.drive_numerator(axis), p.drive_denominator(axis)),
            (1, 100)
        );
        assert_eq!((p.latency_us(axis), p.following_error_limit(axis)), (0, mm));
    }
    assert_eq!(p.dry_run_feed(), Feed::from_nm_per_min(3_000 * mm));
}

#[test]
fn accessors_follow_the_set() {
    let mut p = Params::slant_bed();
    let mut set = |key: &str, text: &str| {
        let entry = Entry::find_text(key).unwrap();
        let raw = entry.parse(text, Writing::UnitOptional).unwrap();
        p.set(entry, raw).unwrap();
    };
    set("019", "7");
    set("5142", "3");
    set("pq_in_mm", "1");
    set("5129", "1");
    set("5200.5", "1");
    set("1420.x", "15 m/min");
    set("1225.X", "10");
    set("work_offset_g58.Z", "-250.5 mm");
    set("9132.X", "0.0001");
    set("tool_offset_1.z", "1");
    set("1320.C", "90");
    set("1320.c", "NONE");
    assert_eq!((p.thread_chamfer(), p.thread_finish_passes()), (7, 3));
    assert!(p.pq_in_mm() && p.thread_high_speed() && p.tap_deep_peck());
    assert!(!p.tap_by_g_code() && !p.tap_hold_allowed());
    assert_eq!(p.rapid(Axis::X), Feed::from_nm_per_min(15_000_000_000));
    assert_eq!(
        p.work_offset(4),
        [Length::from_nm(5_000_000), Length::from_nm(-250_500_000)]
    );
    assert_eq!(p.work_offset(3), [Length::ZERO; 2]);
    assert_eq!(p.work_offset(6), [Length::ZERO; 2]);
    assert_eq!(p.tool_offset(32), [Length::from_nm(50), Length::ZERO]);
    assert_eq!(p.tool_offset(1), [Length::ZERO, Length::from_nm(1_000_000)]);
    assert_eq!(
        (p.tool_offset(0), p.tool_offset(33)),
        ([Length::ZERO; 2], [Length::ZERO; 2])
    );
    assert_eq!(p.soft_limit_plus(Axis::C), i64::MAX);
}

#[test]
fn a_bit_leaves_its_neighbours_alone() {
    let bits: Vec<_> = Entry::all().iter().filter(|e| e.no == 5200).collect();
    assert_eq!(bits.len(), 6);
    let mut p = Params::slant_bed();
    for bit in &bits {
        p.set(bit, 1).unwrap();
        assert_eq!(bits.iter().map(|b| p.get(b)).sum::<i64>(), 1);
        p.set(bit, 0).unwrap();
    }
    assert_eq!(p, Params::slant_bed());
}

#[test]
fn every_value_goes_through_text_and_back_and_stays_in_its_range() {
    for entry in Entry::all() {
        let mut p = Params::slant_bed();
        let built_in = p.get(entry);
        let raws = [
            entry.min(),
            entry.max(),
            built_in,
            (entry.min() + entry.max()) / 2,
        ];
        for raw in raws {
            p.set(entry, raw).unwrap();
            assert_eq!(p.get(entry), raw, "{entry}");
            if entry.none() == Some(raw) {
                continue;
            }
            let text = entry.unit().text(raw).to_string();
            assert_eq!(
                entry.parse(&text, Writing::UnitRequired),
                Ok(raw),
                "{entry} {text}"
            );
            let bare = entry.unit().number(raw).to_string();
            assert_eq!(
                entry.parse(&bare, Writing::UnitOptional),
                Ok(raw),
                "{entry} {bare}"
            );
        }
        for raw in [entry.min() - 1, entry.max() + 1] {
            let before = p.clone();
            assert_eq!(p.set(entry, raw), Err(SetError::OutOfRange), "{entry}");
            assert_eq!(p, before);
            let text = entry.unit().text(raw).to_string();
            assert_eq!(
                entry.parse(&text, Writing::UnitRequired),
                Err(SetError::OutOfRange)
            );
        }
        let huge = format!("{}", u128::MAX);
        assert_eq!(
            entry.parse(&huge, Writing::UnitOptional),
            Err(SetError::OutOfRange)
        );
        p.set(entry, built_in).unwrap();
        assert_eq!(p, Params::slant_bed(), "{entry}");
    }
}

#[test]
fn the_value_none_has_no_number() {
    let entry = Entry::find_text("1320.C").unwrap();
    assert_eq!(entry.parse("none", Writing::UnitRequired), Ok(i64::MAX));
    assert_eq!(
        entry.parse("9223372036854.77580", Writing::UnitOptional),
        Err(SetError::OutOfRange)
    );
    // A slide has ends, and a speed has a limit.
    for key in ["1320.X", "1320.Z", "1321.X", "1321.Z", "1420.C"] {
        let entry = Entry::find_text(key).unwrap();
        assert_eq!(
            entry.parse("none", Writing::UnitOptional),
            Err(SetError::Value(ValueError::NoNumber)),
            "{key}"
        );
        let mut params = Params::slant_bed();
        for none in [i64::MAX, i64::MIN] {
            assert_eq!(params.set(entry, none), Err(SetError::OutOfRange), "{key}");
        }
    }
}

#[test]
fn what_is_not_one_value_is_not_found() {
    let first = |key: &str| Entry::find_text(key).unwrap();
    for (key, error) in [
        ("", FindError::Unknown),
        ("18", FindError::Unknown),
        ("+19", FindError::Unknown),
        ("70000", FindError::Unknown),
        ("65555", FindError::Unknown),
        ("rapid", FindError::Unknown),
        ("18.7", FindError::Unknown),
        ("1420", FindError::PartMissing(first("1420.X"))),
        ("rapid_rate", FindError::PartMissing(first("1420.X"))),
        ("182", FindError::PartMissing(first("182.7"))),
        ("5200", FindError::PartMissing(first("5200.0"))),
        ("182.6", FindError::NoSuchPart(first("182.7"))),
        ("182.X", FindError::NoSuchPart(first("182.7"))),
        ("182.", FindError::NoSuchPart(first("182.7"))),
        ("19.0", FindError::NoSuchPart(first("19"))),
        ("1420.Y", FindError::NoSuchPart(first("1420.X"))),
        ("1420.XX", FindError::NoSuchPart(first("1420.X"))),
        ("1420.X.X", FindError::NoSuchPart(first("1420.X"))),
        ("1221.C", FindError::NoSuchPart(first("1221.X"))),
    ] {
        assert_eq!(Entry::find_text(key), Err(error), "{key}");
    }
    for (key, number) in [
        ("19", "019"),
        ("0019", "019"),
        (" 5130 ", "019"),
        ("Thread_Chamfer", "019"),
        ("pq_in_mm.7", "182.7"),
        ("rapid_rate.z", "1420.Z"),
        ("5282", "5382"),
    ] {
        assert_eq!(first(key).to_string(), number, "{key}");
    }
}

#[test]
fn the_table_is_in_order_and_every_text_is_there() {
    let key = |e: &Entry| match e.part {
        Part::Whole => (e.no, 0),
        Part::Bit(bit) => (e.no, i32::from(bit)),
        Part::Axis(axis) => (e.no, axis as i32),
    };
    assert!(Entry::all().windows(2).all(|w| key(&w[0]) < key(&w[1])));
    let mut names = BTreeMap::new();
    for entry in Entry::all() {
        let text = entry.text();
        for field in [text.name, text.en, text.zh, text.sheet] {
            assert!(!field.is_empty(), "{entry}");
        }
        assert!(!text.zh.is_ascii(), "{entry}");
        let number = match entry.part {
            Part::Bit(_) => entry.to_string(),
            _ => entry.no.to_string(),
        };
        assert_eq!(names.entry(text.name).or_insert(number.clone()), &number);
        // A name must not look like a number, or a file could not tell.
        assert!(
            !text.name.starts_with(|c: char| c.is_ascii_digit()),
            "{entry}"
        );
    }
}

/// What a set of each schema was made of. A table that has changed gets another row here, by hand, and with it the question
/// whether a file of the last schema would be wrong now: then [`SCHEMA`] counts up, and the gateway's list of migrations
/// gets the way there. A board tells sets apart by the key alone, which nobody can forget.
const TABLES: &[(u16, u32)] = &[
    (1, 0xDFE1_D610),
    (1, 0xBF2A_3EBB),
    (1, 0x6449_88D3),
    (1, 0x9B54_6192),
    // No slide without ends. A file that had one was right for no machine, and is told so at its line [D197].
    (1, 0xE253_FECC),
    // No board follows the SYNC of another: every file that a board told names 9029 and 9030 [D212].
    (2, 0x4B3D_87BA),
    // Reference points: 1240 to 1243.
    (2, 0x0881_C9AA),
    // Contour cycles: 5132 to 5137.
    (2, 0xAA61_B071),
    // Constant surface speed: 3771.
    (2, 0x7640_E40B),
    // Noses of tools: 9201 to 9216, 9301 to 9316.
    (2, 0xFA00_A73F),
    // L of a corner: 181.0. Drilling: 5101.2, 5114.
    (2, 0x31E9_AA8F),
    // The tolerance of a corner: 9033.
    (2, 0x080D_790C),
    // Jogging, and the age of an order: 9040 to 9043, 9047.
    (2, 0xC736_4277),
    // References: 9050, 9058 to 9062.
    (2, 0x8222_8EC1),
    // The handwheel: 9044 to 9046; machine functions and interlocks: 9401 to 9429.
    (2, 0x6828_BF6E),
    // Numbers without a point: 3401.0. Drives as they are: 9070 to 9074. Zones: 9091 to 9097. Gears and tool changes: 9431
    // to 9459.
    (2, 0xBD8A_319D),
    // A handwheel at the board: 9048.
    (2, 0x2143_2CC7),
    // How well the age of an actual position is known: 9075.
    (2, 0x5AFF_874E),
    // A reference by a switch at the board: 9050 = 2, 9051 to 9055.
    (2, 0x13C3_ED09),
    // Drives that get their setpoints in mode 7: 9076.
    (2, 0xD9B9_2B27),
    // A block of inputs and outputs on the bus: 9461 to 9463, and inputs and outputs up to 32.
    (2, 0xBCF5_5FED),
    // A spindle whose angle is learned: 9034, 9035.
    (2, 0xC89C_910C),
    // A reference switch at the drive: 9051 up to 35.
    (2, 0xEAA7_8BFB),
    // Hard limit switches: 9064, 9065.
    (2, 0x4287_256F),
    // Backlash: 1851.
    (2, 0x1A51_0C78),
    // Errors of the pitch: 1861, 1862, 1871 to 1886. The key knows the places in a set.
    (2, 0x4696_6F76),
    // What a drive takes of its targets: 9077, 9078.
    (2, 0x8799_7FAA),
    // The spindle by hand: 9049.
    (2, 0xA9EA_3970),
];

#[test]
fn the_schema_is_the_one_of_the_table() {
    assert_eq!(
        TABLES.last(),
        Some(&(SCHEMA, TABLE_KEY)),
        "the parameter table has changed: a row for {TABLE_KEY:#010X}, and a new schema if a file becomes wrong by it"
    );
    assert!(TABLES.is_sorted_by(|a, b| a.0 <= b.0 && a.1 != b.1));
}
