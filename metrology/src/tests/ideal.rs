//! Ideal threads: within 1 µm and one minute of the norm.

use super::{Made, within};
use crate::{Degrees, Grid, Mm, Nose, Side, Stock, Tool, Turns, Work, inspect, measure};

const MICROMETRE: f64 = 1e-3;
const MINUTE: f64 = 1.0 / 60.0;

fn prove(made: &Made) {
    let work = made.cut();
    let name = &made.thread.text;
    let found = measure(&work, &made.thread).unwrap();
    let close = |what: &str, value: f64, asked: f64, most: f64| {
        assert!(
            (value - asked).abs() <= most,
            "{name}: {what} {value} instead of {asked}"
        );
    };
    for value in [found.pitch.low, found.pitch.mean, found.pitch.high] {
        close("pitch diameter", value, made.pitch_diameter, MICROMETRE);
    }
    for flank in found.flanks {
        for value in [flank.low, flank.mean, flank.high] {
            close("flank", value, made.thread.angle.0 / 2.0, MINUTE);
        }
    }
    let crest = made.stock().radius.0 * 2.0;
    let floor = 2.0 * made.radius();
    let (major, minor) = match made.thread.side {
        Side::External => (crest, floor),
        Side::Internal => (floor, crest),
    };
    close("major", found.major.mean, major, MICROMETRE);
    close("minor", found.minor.mean, minor, MICROMETRE);
    close("root", found.root.0, made.thread.tip().0, MICROMETRE);
    close(
        "lead",
        found.lead.lead.0,
        made.thread.lead().0,
        0.05 * MICROMETRE,
    );
    close("cumulative", found.lead.cumulative.0, 0.0, MICROMETRE);
    close("drunkenness", found.drunkenness.worst.0, 0.0, MICROMETRE);
    if let Some(wires) = found.wires {
        close("over wires", wires.pitch.0, made.pitch_diameter, MICROMETRE);
    }
    assert_eq!(found.starts.len(), usize::from(made.thread.starts));
    for start in &found.starts {
        close("start", start.0, 0.0, MICROMETRE);
    }
    let functional = found.functional.unwrap().diameter.0;
    close("functional", functional, made.pitch_diameter, MICROMETRE);
}

#[test]
fn bolts_of_the_table_in_the_middle_of_their_tolerance() {
    for [d, p, high, low, _, _] in super::norms::ISO_965_2 {
        prove(&Made::ideal(
            &format!("M{d}x{p}-6g"),
            Side::External,
            (high + low) / 2.0,
        ));
    }
}

#[test]
fn nuts_of_the_table_in_the_middle_of_their_tolerance() {
    for [d, p, _, _, low, high] in super::norms::ISO_965_2 {
        prove(&Made::ideal(
            &format!("M{d}x{p}-6H"),
            Side::Internal,
            (high + low) / 2.0,
        ));
    }
}

#[test]
fn inches_and_more_than_one_start() {
    for name in [
        "1/4-20UNC-2A",
        "1/2-13UNC-2A",
        "1-1/4-12UNF-3A",
        "#10-32UNF-2A",
    ] {
        let mut made = Made::ideal(name, Side::External, 0.0);
        made.pitch_diameter = made.thread.pitch_diameter().0 - 0.05;
        prove(&made);
    }
    for name in ["1/4-20UNC-2B", "3/4-10UNC-2B"] {
        let mut made = Made::ideal(name, Side::Internal, 0.0);
        made.pitch_diameter = made.thread.pitch_diameter().0 + 0.05;
        prove(&made);
    }
    for name in ["M30x4P2-6g", "M40x9P3-6g", "M20xPh5P1.25-6g", "M60x12P2-6g"] {
        let mut made = Made::ideal(name, Side::External, 0.0);
        made.pitch_diameter = made.thread.pitch_diameter().0 - 0.1;
        made.turns = 4.0;
        prove(&made);
    }
}

/// M40x3: wires of 1.7321, 40.649 over them at the basic pitch diameter, 0.8 µm for the angle of the helix.
#[test]
fn wires_as_in_a_table() {
    let made = Made::ideal("M40x3-6g", Side::External, 38.0514);
    let wires = measure(&made.cut(), &made.thread).unwrap().wires.unwrap();
    within(wires.wire.0, 1.7321, 1e-4);
    assert!((wires.over.0 - 40.6502).abs() < 1e-3, "{wires:?}");
}

#[test]
fn the_sheet_says_what_a_gauge_says() {
    let judged = |pitch_diameter: f64| {
        let mut made = Made::ideal("M40x3-6g", Side::External, pitch_diameter);
        made.thread.major.0 = 40.0;
        let found = measure(&made.cut(), &made.thread).unwrap();
        let sheet = inspect(&found, &made.thread);
        (sheet.go, sheet.no_go, sheet.rows[1].within)
    };
    assert_eq!(judged(37.9), (Some(true), Some(true), Some(true)));
    assert_eq!(judged(38.002), (Some(true), Some(true), Some(true)));
    assert_eq!(judged(38.004), (Some(false), Some(true), Some(false)));
    assert_eq!(judged(37.804), (Some(true), Some(true), Some(true)));
    assert_eq!(judged(37.802), (Some(true), Some(false), Some(false)));
}

#[test]
fn the_outline_of_an_edge_is_what_it_removes() {
    let (place, radius) = (-5.0, 18.16);
    let shapes = [
        Tool::vee(Degrees(60.0), Nose::Round(Mm(0.433))),
        Tool {
            nose: Nose::Flat(Mm(0.2)),
            minus: Degrees(27.0),
            plus: Degrees(3.0),
        },
    ];
    for tool in shapes {
        let stock = Stock {
            side: Side::External,
            radius: Mm(20.0),
            taper: 0.0,
            from: Mm(-10.0),
            face: Mm(0.0),
        };
        let grid = Grid {
            angles: 4,
            step: Mm(0.002),
        };
        let mut work = Work::new(stock, grid);
        work.stamp(0, place, radius, &tool, 1, 1);
        let outline = tool.outline(Mm(20.0 - radius));
        assert!(
            outline.windows(2).all(|pair| pair[0].0 <= pair[1].0),
            "{outline:?}"
        );
        let (left, right) = (outline[0], outline[outline.len() - 1]);
        assert!((left.1.0 - 1.84).abs() < 1e-9 && (right.1.0 - 1.84).abs() < 1e-9);
        let mut compared = 0;
        for (z, cut) in work.section(Turns(0.0), Mm(-10.0), Mm(0.0)) {
            let at = z.0 - place;
            let next = outline
                .windows(2)
                .find(|pair| pair[0].0.0 <= at && at <= pair[1].0.0);
            let drawn = next.map_or(20.0, |pair| {
                let [(Mm(z0), Mm(u0)), (Mm(z1), Mm(u1))] = [pair[0], pair[1]];
                let part = if z1 > z0 { (at - z0) / (z1 - z0) } else { 0.0 };
                compared += 1;
                radius + u0 + (u1 - u0) * part
            });
            // Round noses are drawn as chords.
            assert!((drawn - cut.0).abs() < 0.001, "{at}: {drawn} {cut:?}");
        }
        assert!(compared > 500, "{compared}");
    }
}
