//! Contours, the nose and corners in whole programs: what goes into a cycle, what comes after it, and what is refused.

use super::*;
use crate::figures::Chance;
use crate::path::tests::moves_of;
use crate::reading::{Outcome, read_on, with};

/// A machine whose tool 3 has a nose of 0.4 mm with tip direction 3.
fn machine() -> Params {
    let nose = [("nose_radius_3", 400_000), ("nose_direction_3", 3)];
    with(Params::sheets(), &nose)
}

/// What a program does, with `;` between its lines, and the alarm that ends it.
fn read(control: Control, text: &str) -> Outcome {
    read_on(&machine(), control, text)
}

/// The events of a program without an alarm.
#[track_caller]
fn events(control: Control, text: &str) -> Vec<Event> {
    let (events, alarm) = read(control, text);
    assert_eq!(alarm, None, "{text}");
    events
}

/// Its moves.
#[track_caller]
fn cut(control: Control, text: &str) -> String {
    moves_of(&events(control, text))
}

/// Number and line of the alarm of a program.
#[track_caller]
fn refused(control: Control, text: &str) -> (u16, u32, u16) {
    let alarm = read(control, text).1;
    let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    (alarm.number(), alarm.span.line, alarm.span.column)
}

/// The tool of the finishing cut is called in the contour, and its offsets are others.
#[test]
fn a_tool_of_the_contour_counts_in_the_finishing_cut_alone() {
    let offsets = "G99 F.2;G10 P1 X0 Z0;G10 P2 X-6 Z-4;T0101;G0 X44 Z2;";
    for cycle in [
        "G71 U4. R.5;G71 P1 Q2 U.4 W.1",
        "G72 W4. R.5;G72 P1 Q2 U.4 W.1",
        "G73 U4. W1. R3;G73 P1 Q2 U.4 W.1",
    ] {
        for control in [Control::Gsk980td, Control::FanucA] {
            let contour = |tool: &str| {
                let first = if cycle.starts_with("G72") {
                    format!("N1 G0 Z-20. {tool};G1 X24.;X20. {tool} Z-12.;N2 Z2.")
                } else {
                    format!("N1 G0 X20. {tool};G1 Z-12.;X24. {tool} Z-20.;{tool} (T9);N2 X44.")
                };
                format!("{offsets}{cycle};{first};")
            };
            let without = cut(control, &format!("{}M30", contour("")));
            let with = cut(control, &format!("{}M30", contour("T0202")));
            assert_eq!(with, without, "{control:?} {cycle}");
            let finished = cut(control, &format!("{}G70 P1 Q2;M30", contour("T 0202")));
            assert!(finished.contains("T202"), "{finished}");
        }
    }
}

/// A move that waits for its corner has the side of its own block.
#[test]
fn a_corner_before_the_block_with_g40_has_the_nose() {
    let front = "F.2;T0303;G0 X50. Z2.;G42 G0 X20.;G1 Z-10.;X30. Z-30.";
    let (short, long) = (
        cut(Control::FanucA, &format!("{front} ,R3.;G40 X50.;M30")),
        cut(Control::FanucA, &format!("{front} ,R3.;X48.;G40 X50.;M30")),
    );
    // The same up to the end of the rounding, which ends perpendicular to it.
    let until_arc = |list: &str| list.split(" A").next().map(str::to_owned);
    assert_eq!(until_arc(&short), until_arc(&long));
    assert_eq!(short.matches('A').count(), 1, "{short}");
    for (control, with, without) in [
        // The corner is drawn as a move of its own.
        (
            Control::FanucA,
            "G42 G0 X30.;G1 Z-10. ,C1.;G40 X40.;M30",
            "G42 G0 X30.;G1 Z-9.;X32. Z-10.;G40 X40.;M30",
        ),
        (
            Control::FanucA,
            "G42 G0 X30.;G1 Z-10. ,C1.;G40;X40.;M30",
            "G42 G0 X30.;G1 Z-9.;X32. Z-10.;G40 X40.;M30",
        ),
        (
            Control::Gsk980td,
            "G42 G0 X30.;G1 Z-10. D1.;G40 X40.;M30",
            "G42 G0 X30.;G1 Z-9.;G2 X32. Z-10. R1.;G40 G1 X40.;M30",
        ),
        // The other way round the compensation begins in its own block.
        (
            Control::FanucA,
            "G0 X10.;G1 X20. ,R1.;G42 Z-10.;X30.;G40 X40.;M30",
            "G0 X10.;G1 X18.;G3 X20. Z1. R1.;G42 G1 Z-10.;X30.;G40 X40.;M30",
        ),
    ] {
        let front = "F.2;T0303;G0 X50. Z2.;";
        assert_eq!(
            cut(control, &format!("{front}{with}")),
            cut(control, &format!("{front}{without}")),
            "{with}"
        );
    }
}

/// The warnings of a program: number and line.
fn told(control: Control, text: &str) -> Vec<(u16, u32)> {
    let told = events(control, text)
        .into_iter()
        .filter_map(|event| match event {
            Event::Warning(warning) => Some((warning.number(), warning.span.line)),
            Event::Call(_) => None,
        });
    told.collect()
}

/// The allowance along the strokes leads away from one wall of a pocket and into the other.
#[test]
fn an_allowance_that_cuts_into_a_wall_of_a_pocket_is_told() {
    let along_z = |allowances: &str, walls: &str| {
        let text = format!(
            "F.2;G0 X44. Z2.;G71 U2. R.5;G71 P1 Q2 {allowances};N1 G0 X40. W0;G1 Z-10.;{walls};N2 X42.;M30"
        );
        told(Control::FanucA, &text)
    };
    let here = vec![(4989, 4)];
    assert_eq!(along_z("U.4 W.3", "X30.;Z-20."), here);
    assert_eq!(along_z("U.4 W.01", "X30.;Z-20."), here);
    assert_eq!(along_z("U.4", "X30.;Z-20."), []);
    assert_eq!(along_z("U.4 W0", "X30.;Z-20."), []);
    // Δw·sin a is above Δu/2·cos a from tan a = 2 on.
    assert_eq!(along_z("U.4 W.1", "X30. Z-12.4;Z-20."), here);
    assert_eq!(along_z("U.4 W.1", "X30. Z-12.6;Z-20."), []);
    // An arc by its steepest place, at either end.
    assert_eq!(along_z("U.4 W.1", "G3 X30. Z-15. R5.;G1 Z-20."), here);
    assert_eq!(along_z("U.4 W.1", "G2 X30. Z-15. R5.;G1 Z-20."), here);
    assert_eq!(along_z("U.4 W.1", "G2 X30. Z-18.66 R10.;G1 Z-20."), []);
    // What rises is no such wall, nor the way to the contour.
    let text = "F.2;G0 X44. Z2.;G71 U2. R.5;G71 P1 Q2 U.4 W.1;N1 G0 X30.;G1 Z-10.;N2 X42.;M30";
    assert_eq!(told(Control::FanucA, text), []);
    let text = "F.2;G0 X44. Z2.;G71 U2. R.5;G71 P1 Q2 U.4 W.1;N1 G0 X30. Z1.5;G1 Z-10.;N2 X42.;M30";
    assert_eq!(told(Control::FanucA, text), []);
    // Once, where the allowance leads into the whole contour.
    assert_eq!(along_z("U.4 W-.1", "X30.;Z-20."), here);
    let along_x = |allowances: &str| {
        let text = format!(
            "F.2;G0 X60. Z2.;G72 W2. R.5;G72 P1 Q2 {allowances};N1 G0 Z0 U0;G1 X50.;Z-5.;X40.;N2 Z0;M30"
        );
        told(Control::FanucA, &text)
    };
    assert_eq!(along_x("U.4 W.1"), here);
    assert_eq!(along_x("W.1"), []);
}

/// After a roughing cycle modes are as before it; a finishing cut carries its blocks out.
#[test]
fn modes_of_a_contour_do_not_outlast_its_roughing() {
    let program = |before: &str, ns: &str, inside: &str, after: &str| {
        format!(
            "G95 F.2;G0 X44. Z2.;{before}G71 U4. R.5;G71 P1 Q2 U.4 W.1;{ns};{inside};{after};M30"
        )
    };
    let counted = "G91;G1 Z-14.;X4. Z-10.;N2 X20.";
    let list = cut(
        Control::FanucB,
        &program("", "N1 G0 X20.", counted, "G0 X60. Z5."),
    );
    assert!(list.ends_with(" R60,5 M30"), "{list}");
    let list = cut(
        Control::FanucB,
        &program(
            "G91;",
            "N1 G90 G0 X20.",
            "G1 Z-12.;X24. Z-20.;N2 X44.",
            "G0 X10. Z0",
        ),
    );
    assert!(list.ends_with(" R54,2 M30"), "{list}");
    let list = cut(
        Control::FanucB,
        &program("", "N1 G0 X20.", counted, "G70 P1 Q2;G0 X60. Z5."),
    );
    assert!(list.ends_with(" R104,7 M30"), "{list}");
}

/// The places of a profile as a program writes them: to the micrometre, or to the ten thousandth of an inch.
struct Written {
    inch: bool,
}

impl Written {
    /// A length in millimetres as it stands in the program.
    fn text(&self, mm: f64) -> String {
        if self.inch {
            format!("{:.4}", mm / 25.4)
        } else {
            format!("{mm:.3}")
        }
    }

    /// A shaft of cylinders with cones between them, and tangent roundings at both ends of a cone: arcs with I and K.
    fn shaft(&self, chance: &mut Chance) -> String {
        let word = |letter: &str, mm: f64| format!("{letter}{}", self.text(mm));
        let place = |x: f64, z: f64| format!("{} {}", word("X", 2.0 * x), word("Z", z));
        let centre = |i: f64, k: f64| format!("{} {}", word("I", i), word("K", k));
        let (mut x, mut z) = (chance.size(5.0, 10.0), 0.0);
        let mut text = format!("N1 G0 {};G1 {};", word("X", 2.0 * x), word("Z", z));
        for _ in 0..3 {
            let (sine, cosine) = chance.size(0.2, 1.3).sin_cos();
            z -= chance.size(1.0, 3.0);
            text += &format!("G1 {};", word("Z", z));
            let radius = chance.size(0.5, 2.0);
            (x, z) = (x + radius * (1.0 - cosine), z - radius * sine);
            text += &format!("G2 {} {};", place(x, z), centre(radius, 0.0));
            let length = chance.size(1.0, 3.0);
            (x, z) = (x + length * sine, z - length * cosine);
            text += &format!("G1 {};", place(x, z));
            let radius = chance.size(0.5, 2.0);
            (x, z) = (x + radius * (1.0 - cosine), z - radius * sine);
            let centre = centre(-radius * cosine, -radius * sine);
            text += &format!("G3 {} {centre};", place(x, z));
        }
        z -= chance.size(1.0, 3.0);
        text + &format!("G1 {};N2 {};", word("Z", z), word("X", 80.0))
    }
}

/// An arc misses its circle by what its words are rounded by; the nose still fits.
#[test]
fn arcs_with_rounded_centres_take_the_nose() {
    let text = "F.2;T0303;G0 X44. Z2;G42 G0 X24.59;G1 Z-2.961;G3 X24.901 Z-3.324 I-.344 K-.363;\
                G1 Z-9.;X30.;G40 X44;M30";
    events(Control::FanucA, text);
    leadscrew_seed::volume(0x0041_0043, |seed| {
        let mut chance = Chance::new(seed);
        for case in 0..leadscrew_seed::amount(60, 800) {
            let inch = case % 2 == 0;
            let shaft = Written { inch }.shaft(&mut chance);
            let shaft = shaft.replacen("G1", "G42 G1", 1);
            let unit = if inch { "G20" } else { "G21" };
            let text = format!("{unit} G99 F.01;T0303;G0 X90. Z1.;{shaft}G40 X90.;M30");
            let alarm = read(Control::FanucA, &text).1;
            assert_eq!(alarm, None, "seed {seed}, case {case}: {text}");
        }
    });
}

/// The top of an arc lies a little before its end where its centre is rounded.
#[test]
fn arcs_with_rounded_centres_do_not_turn_back() {
    let front = "F.2;G0 X50. Z2.;G71 U4. R.5;G71 P1 Q2 U.4 W.1;";
    for contour in [
        "N1 G0 X20.;G1 Z0;X39.397 Z-28.289;G3 X40. Z-30. I-4.698 K-1.71;G1 Z-40.;N2 X46.",
        "N1 G0 X20. Z2.;G1 Z-20.;X22.481 Z-24.368;G2 X30. Z-27. I3.759 K1.368;N2 G1 X46.",
        "N1 G0 X18.;G1 Z-12.;X18.204 Z-13.985;G2 X18.207 Z-14.028 R0.5;G1 X19.170 Z-19.532;N2 X46.",
    ] {
        let list = cut(Control::FanucA, &format!("{front}{contour};G70 P1 Q2;M30"));
        // No stroke goes into what a rounding has made of the arc.
        assert!(!list.contains("R50,-"), "{list}");
    }
    // What no rounding explains stays refused.
    let back = "N1 G0 X20.;G1 Z0;X39.397 Z-28.289;G3 X39.6 Z-31.4 I-4.698 K-1.71;G1 Z-40.;N2 X46.";
    assert_eq!(
        refused(Control::FanucA, &format!("{front}{back};M30")).0,
        64
    );
    leadscrew_seed::volume(0x0064, |seed| {
        let mut chance = Chance::new(seed);
        for case in 0..leadscrew_seed::amount(60, 800) {
            let inch = case % 2 == 0;
            let shaft = Written { inch }.shaft(&mut chance);
            let unit = if inch { "G20" } else { "G21" };
            let text =
                format!("{unit} G99 F.01;G0 X90. Z1.;G71 U1. R.1;G71 P1 Q2 U.02 W.01;{shaft}M30");
            let alarm = read(Control::FanucA, &text).1;
            assert_eq!(alarm, None, "seed {seed}, case {case}: {text}");
        }
    });
}

/// G40 alone leaves the tool where the nose was: a stroke would begin there.
#[test]
fn what_begins_where_the_tool_stands_wants_it_on_the_path() {
    let front = "F.2 M3 S500;T0303;G0 X44. Z2.;G42 G0 X30.;G1 Z-10.;G0 X36.;Z5.;";
    for (rest, line) in [
        ("G40;G32 Z-8. F1.;G0 X40.;M30", 9),
        ("G40;M8;G32 Z-8. F1.;G0 X40.;M30", 10),
        ("G40;G61;G32 Z-8. F1.;G0 X40.;M30", 10),
        ("G40;G34 Z-8. F1. K.1;G0 X40.;M30", 9),
        ("G40;G84 Z-8. F1.;G80;M30", 9),
    ] {
        let (number, at, _) = refused(Control::FanucA, &format!("{front}{rest}"));
        assert_eq!((number, at), (4602, line), "{rest}");
    }
    for rest in [
        "G40 G0 X36.;G32 Z-8. F1.;G0 X40.;M30",
        "G40;G0 Z5.1;G32 Z-8. F1.;G0 X40.;M30",
        "G40;G92 X35. Z-8. F1.;G0 X40.;M30",
        "G40;G92 X35. Z-8. F1.;G32 Z-8. F1.;G0 X40.;M30",
    ] {
        events(Control::FanucA, &format!("{front}{rest}"));
    }
}

/// The way back of a finishing cut is one of its block.
#[test]
fn the_way_back_of_a_finishing_cut_has_its_line() {
    let text = "F.2;G0 X45 Z2;G70 P1 Q2;M30;N1 G0 X45 Z-10;G1 X30 Z-12;N2 Z-30";
    let events = events(Control::FanucA, text);
    let rapids = events.iter().filter_map(|event| match event {
        Event::Call(call) if matches!(call.kind, CallKind::Rapid(_)) => Some(call.span.line),
        _ => None,
    });
    assert_eq!(rapids.collect::<Vec<_>>(), [2, 5, 3]);
}

/// What the roughing would leave out, or take for the contour, has no place in it.
#[test]
fn a_contour_has_motions_alone() {
    for cycle in [
        "G71 U4. R.5;G71 P1 Q2 U.4 W.1",
        "G73 U4. W1. R3;G73 P1 Q2 U.4 W.1",
        ";G70 P1 Q2",
    ] {
        for control in [Control::Gsk980td, Control::FanucA, Control::Haas] {
            for wrong in [
                "G75 R1.",
                "G32 X20. Z-20. F1.",
                "G90 X24. Z-20.",
                "G92 X24. Z-20. F1.",
                "G94 X24. Z-20.",
                "G50 X50. Z10.",
                "G50 S900",
                "G20",
                "G28 U0",
                "G53 X0",
                "G84 Z-20. F1.",
            ] {
                if wrong == "G53 X0" && control == Control::Gsk980td {
                    continue;
                }
                let text = format!(
                    "F.2;G0 X44. Z2.;{cycle};N1 G0 X20.;G1 Z-12.;(G32) {wrong};G1 X24.;N2 X44.;M30"
                );
                let found = refused(control, &text);
                assert_eq!(found, (66, 7, 7), "{control:?} {text}");
            }
        }
    }
    // What belongs there.
    let right = "G4 P100;G40 G1 X22.;G97 S500 M8;G99 F.1;G61;G64;G18;G54;X24. F.2 (G32)";
    for control in [Control::Gsk980td, Control::FanucA] {
        let text = format!(
            "F.2;G0 X44. Z2.;G71 U4. R.5;G71 P1 Q2 U.4;N1 G0 X20.;G1 Z-12.;{right};N2 X44.;G70 P1 Q2;M30"
        );
        events(control, &text);
    }
    let right = "G95 F.1;G90 X22.;G94 F50.;G91;X2.;G90";
    let text = format!(
        "G95 F.2;G0 X44. Z2.;G71 U4. R.5;G71 P1 Q2 U.4;N1 G0 X20.;G1 Z-12.;{right};N2 X44.;G70 P1 Q2;M30"
    );
    events(Control::FanucB, &text);
}

/// G61 and G64 keep their place between the motions.
#[test]
fn exact_stop_stands_under_the_nose_and_behind_a_corner() {
    let list = cut(
        Control::FanucA,
        "F.2;T0303;G0 X20. Z2.;G42 G1 Z0;G61 Z-10.;G64 X30.;G40 X40.;M30",
    );
    assert_eq!(
        list,
        "T303 R20,2 F20,-0.4 ExactStop(true) F20,-10 ExactStop(false) F29.2,-10 F40,-10 M30"
    );
    let list = cut(
        Control::FanucA,
        "F.2;G0 X20. Z-10.;G1 X40. ,R1.;G61 Z-30.;M30",
    );
    assert_eq!(
        list,
        "R20,-10 F38,-10 A40,-11/1ccw ExactStop(true) F40,-30 M30"
    );
}
