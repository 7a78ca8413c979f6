//! Names and limits against printed ones.

use super::Made;
use crate::limits::pitch_tolerance;
use crate::tables::{ISO_965_2, r40};
use crate::{Designation, Limits, NotKnown, Origin, Series, Side, inspect, measure};

fn limits(name: &str, side: Side) -> Limits {
    Limits::of(&Designation::read(name, side).unwrap())
}

/// The formulas of ISO 965-1 give what ISO 965-2 prints, or a neighbour in R40.
#[test]
fn the_table_is_within_a_step_of_the_formula() {
    for [d, p, high, low, nut_low, nut_high] in ISO_965_2 {
        for (side, printed) in [
            (Side::External, high - low),
            (Side::Internal, nut_high - nut_low),
        ] {
            let formula = pitch_tolerance(side, d, p, 6);
            let printed = printed * 1000.0;
            assert!(
                (printed / formula - 1.0).abs() < 0.066,
                "M{d}x{p}: {printed} {formula}"
            );
        }
        let basic = d - 0.649_519 * p;
        assert!((nut_low - basic).abs() < 0.6e-3, "M{d}x{p}");
        let off = (basic - high) * 1000.0;
        assert!((off - r40(15.0 + 11.0 * p)).abs() < 1.6, "M{d}x{p}: {off}");
    }
}

#[test]
fn limits_as_printed() {
    let close = |value: Option<crate::Mm>, asked: f64| {
        let value = value.unwrap().0;
        assert!((value - asked).abs() < 0.6e-3, "{value} instead of {asked}");
    };
    let m40 = limits("M40x3-6g", Side::External);
    assert_eq!(m40.origin, Origin::Table);
    close(m40.pitch.high, 38.003);
    close(m40.pitch.low, 37.803);
    close(m40.major.high, 39.952);
    close(m40.major.low, 39.577);
    let m10 = limits("M10-6H", Side::Internal);
    close(m10.pitch.high, 9.206);
    close(m10.minor.low, 8.376);
    close(m10.minor.high, 8.676);
    let other = limits("M68x6-6g", Side::External);
    assert_eq!(other.origin, Origin::Formula);
    close(other.pitch.high, 64.023);
    // 1/4-20 UNC: 2A pitch .2164/.2127, major .2489/.2408; 2B pitch .2175/.2224, minor .196/.207.
    let inch = |value: Option<crate::Mm>, asked: f64, most: f64| {
        let value = value.unwrap().0 / 25.4;
        assert!((value - asked).abs() < most, "{value} instead of {asked}");
    };
    let quarter = limits("1/4-20UNC-2A", Side::External);
    inch(quarter.pitch.high, 0.2164, 6e-5);
    inch(quarter.pitch.low, 0.2127, 6e-5);
    inch(quarter.major.high, 0.2489, 6e-5);
    inch(quarter.major.low, 0.2408, 6e-5);
    let nut = limits("1/4-20UNC-2B", Side::Internal);
    inch(nut.pitch.low, 0.2175, 6e-5);
    inch(nut.pitch.high, 0.2224, 1.1e-4);
    inch(nut.minor.low, 0.196, 6e-4);
    inch(nut.minor.high, 0.207, 6e-4);
    // 1/2-14 NPT: E0 .75843, E1 .77843.
    let pipe = Designation::read("1/2-14NPT", Side::External).unwrap();
    inch(Some(pipe.pitch_diameter()), 0.77843, 6e-6);
}

#[test]
fn names() {
    let read = |name| Designation::read(name, Side::External);
    let m30 = read("M30x4P2-6g").unwrap();
    assert_eq!((m30.pitch.0, m30.starts, m30.lead().0), (2.0, 2, 4.0));
    assert_eq!(read("M16-6g").unwrap().pitch.0, 2.0);
    assert_eq!(read("M40x3"), Err(NotKnown::Class));
    assert_eq!(read("M40x3-6k"), Err(NotKnown::Class));
    assert_eq!(read("M40x3-5g6h"), Err(NotKnown::Class));
    assert!(read("M40x3-5g6g").is_ok());
    assert_eq!(read("M40x3-6H"), Err(NotKnown::Side));
    assert_eq!(read("M41-6g"), Err(NotKnown::Pitch));
    assert_eq!(read("M30x5P2-6g"), Err(NotKnown::Form));
    assert_eq!(read("Mx3-6g"), Err(NotKnown::Form));
    assert_eq!(read("1/4-20UNC-2B"), Err(NotKnown::Side));
    assert_eq!(read("1/4-20UNC-4A"), Err(NotKnown::Class));
    assert_eq!(read("1/5-14NPT"), Err(NotKnown::Size));
    assert_eq!(read("1/2-13NPT"), Err(NotKnown::Size));
    assert_eq!(read("G1/2"), Err(NotKnown::Form));
    assert!((read("#10-32UNF-2A").unwrap().major.0 - 0.19 * 25.4).abs() < 1e-9);
    assert!((read("1-1/4-12UNF-3A").unwrap().major.0 - 1.25 * 25.4).abs() < 1e-9);
}

/// A pipe thread whose pitch diameter at the plane L1 is the one of the norm, and others a turn off and more.
#[test]
fn a_taper_pipe_thread_is_judged_at_its_plane() {
    for (off, good) in [
        (0.0, true),
        (0.9, true),
        (-0.9, true),
        (1.1, false),
        (-1.1, false),
    ] {
        let mut made = Made::ideal("1/2-14NPT", Side::External, 0.0);
        let Series::Pipe { plane } = made.thread.series else {
            panic!("{:?}", made.thread)
        };
        let turn = made.thread.pitch.0 / 16.0;
        let e1 = made.thread.pitch_diameter().0 + off * turn;
        made.pitch_diameter = e1 - plane.0 / 16.0;
        made.thread.major = made.thread.major - plane * (1.0 / 16.0);
        let work = made.cut();
        let thread = Designation::read("1/2-14NPT", Side::External).unwrap();
        let found = measure(&work, &thread).unwrap();
        let sheet = inspect(&found, &thread);
        let row = sheet.rows[1];
        assert!((row.found.mean - e1).abs() < 2e-3, "{row:?} {e1}");
        assert!((found.taper + 1.0 / 16.0).abs() < 1e-5, "{}", found.taper);
        assert!((found.angle().0 - 60.0).abs() < 1.0 / 60.0);
        assert!(
            (found.lead.error.um()).abs() < 0.1,
            "{:?}",
            found.lead.error
        );
        assert_eq!((row.within, sheet.go), (Some(good), None));
    }
}
