//! Names and limits against printed ones.

use super::Made;
use crate::limits::by_formula;
use crate::{Designation, Limits, NotKnown, Origin, Series, Side, inspect, measure};

fn limits(name: &str, side: Side) -> Limits {
    Limits::of(&Designation::read(name, side).unwrap())
}

/// Limits of the pitch diameter by ISO 965-2: diameter, pitch, 6g highest and lowest, 6H lowest and highest.
pub const ISO_965_2: [[f64; 6]; 20] = [
    [3.0, 0.5, 2.655, 2.580, 2.675, 2.775],
    [4.0, 0.7, 3.523, 3.433, 3.545, 3.663],
    [5.0, 0.8, 4.456, 4.361, 4.480, 4.605],
    [6.0, 1.0, 5.324, 5.212, 5.350, 5.500],
    [8.0, 1.25, 7.160, 7.042, 7.188, 7.348],
    [10.0, 1.5, 8.994, 8.862, 9.026, 9.206],
    [12.0, 1.75, 10.829, 10.679, 10.863, 11.063],
    [12.0, 1.5, 10.994, 10.854, 11.026, 11.216],
    [12.0, 1.25, 11.160, 11.028, 11.188, 11.368],
    [14.0, 2.0, 12.663, 12.503, 12.701, 12.913],
    [16.0, 2.0, 14.663, 14.503, 14.701, 14.913],
    [20.0, 2.5, 18.334, 18.164, 18.376, 18.600],
    [20.0, 1.5, 18.994, 18.854, 19.026, 19.216],
    [24.0, 3.0, 22.003, 21.803, 22.051, 22.316],
    [30.0, 3.5, 27.674, 27.462, 27.727, 28.007],
    [36.0, 4.0, 33.342, 33.118, 33.402, 33.702],
    [40.0, 3.0, 38.003, 37.803, 38.051, 38.316],
    [42.0, 4.5, 39.014, 38.778, 39.077, 39.392],
    [48.0, 5.0, 44.681, 44.431, 44.752, 45.087],
    [64.0, 6.0, 60.023, 59.743, 60.103, 60.478],
];

fn close(value: Option<crate::Mm>, asked: f64) {
    let value = value.unwrap().0;
    assert!((value - asked).abs() < 1e-9, "{value} instead of {asked}");
}

/// The tables of ISO 965-1 make what ISO 965-2 prints, and the formulas of ISO 965-1 that or a neighbour in R40.
#[test]
fn the_tables_make_what_is_printed() {
    for [d, p, high, low, nut_low, nut_high] in ISO_965_2 {
        let bolt = limits(&format!("M{d}x{p}-6g"), Side::External);
        let nut = limits(&format!("M{d}x{p}-6H"), Side::Internal);
        assert_eq!((bolt.origin, nut.origin), (Origin::Table, Origin::Table));
        close(bolt.pitch.high, high);
        close(bolt.pitch.low, low);
        close(nut.pitch.low, nut_low);
        close(nut.pitch.high, nut_high);
        for (side, printed) in [
            (Side::External, high - low),
            (Side::Internal, nut_high - nut_low),
        ] {
            let formula = by_formula(side, d, p, 6);
            let printed = printed * 1000.0;
            assert!(
                (printed / formula - 1.0).abs() < 0.066,
                "M{d}x{p}: {printed} {formula}"
            );
        }
    }
}

/// Major diameters of bolts and minor diameters of nuts, as printed.
#[test]
fn crests_as_printed() {
    for (name, low, high) in [
        ("M3-6g", 2.874, 2.980),
        ("M6-6g", 5.794, 5.974),
        ("M10-6g", 9.732, 9.968),
        ("M12x1-6g", 11.794, 11.974),
        ("M20-6g", 19.623, 19.958),
        ("M36-6g", 35.465, 35.940),
    ] {
        let major = limits(name, Side::External).major;
        close(major.low, low);
        close(major.high, high);
    }
    for (name, low, high) in [
        ("M3-6H", 2.459, 2.599),
        ("M6-6H", 4.917, 5.153),
        ("M10-6H", 8.376, 8.676),
        ("M20-6H", 17.294, 17.744),
        ("M36-6H", 31.670, 32.270),
    ] {
        let minor = limits(name, Side::Internal).minor;
        close(minor.low, low);
        close(minor.high, high);
    }
    let fine = limits("M12x1-6g", Side::External);
    close(fine.pitch.high, 11.324);
    close(limits("M10x0.75-6g", Side::External).major.high, 9.978);
}

/// Other grades are steps of R40 from the sixth: Td2 of M10x1.5 from 3 to 9, Td 4 and 8, TD1 4 to 8.
#[test]
fn other_grades_are_steps_of_the_sixth() {
    let pitch = |grade: u8| {
        let band = limits(&format!("M10-{grade}g"), Side::External).pitch;
        ((band.high.unwrap() - band.low.unwrap()).0 * 1000.0).round()
    };
    let all: Vec<f64> = (3..=9).map(pitch).collect();
    assert_eq!(all, [67.0, 85.0, 106.0, 132.0, 170.0, 212.0, 265.0]);
    let crest = |name: &str, side: Side| {
        let limits = limits(name, side);
        let band = if side == Side::External {
            limits.major
        } else {
            limits.minor
        };
        ((band.high.unwrap() - band.low.unwrap()).0 * 1000.0).round()
    };
    let bolt = |grade: u8| crest(&format!("M10-6g{grade}g"), Side::External);
    assert_eq!([4, 6, 8].map(bolt), [150.0, 236.0, 375.0]);
    let nut = |grade: u8| crest(&format!("M10-6H{grade}H"), Side::Internal);
    assert_eq!(
        [4, 5, 6, 7, 8].map(nut),
        [190.0, 236.0, 300.0, 375.0, 475.0]
    );
}

#[test]
fn the_minor_diameter_of_a_small_inch_nut_is_bound() {
    // #0-80: .0465/.0514; #2-56: .0667/.0737.
    for (name, high) in [("#0-80UNF-2B", 0.0514), ("#2-56UNC-2B", 0.0737)] {
        let found = limits(name, Side::Internal).minor.high.unwrap().0 / 25.4;
        assert!((found - high).abs() < 1.1e-4, "{name}: {found}");
    }
}

#[test]
fn limits_as_printed() {
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
    close(limits("M68x6-6g", Side::External).pitch.high, 64.023);
    // No table has this pitch at this size.
    let other = limits("M68x1-6g", Side::External);
    assert_eq!(other.origin, Origin::Formula);
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
    // As the norms write them.
    assert_eq!(
        read("1/2-13 UNC-2A").unwrap().major,
        read("1/2-13UNC-2A").unwrap().major
    );
    assert_eq!(read("1 1/4 - 12 UNF - 2A").unwrap().major.0, 1.25 * 25.4);
    assert_eq!(
        read("1/2-14 NPT").unwrap().series,
        read("1/2-14NPT").unwrap().series
    );
    assert_eq!(read("M 30 x Ph4 P2 - 6g").unwrap().lead().0, 4.0);
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

/// The tip of a pipe thread's tool leaves the least truncation of the norm, 0.033 p, on either side: flanks and root of the
/// basic profile go together.
#[test]
fn the_tool_of_a_pipe_thread_is_that_of_its_root() {
    for side in [Side::External, Side::Internal] {
        let thread = Designation::read("1/2-14NPT", side).unwrap();
        let sharp = (thread.triangle() - thread.pitch * 0.8) * 0.5;
        assert!(
            (thread.tip().0 - sharp.0).abs() < 1e-3,
            "{:?}",
            thread.tip()
        );
    }
}
