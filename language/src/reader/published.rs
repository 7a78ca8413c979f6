//! What programs write that were published for other controls: each does what the same program in plain words does.

use super::*;
use crate::reading;
use leadscrew_core::params::Entry;

/// Calls as text, warnings by number, and the alarm at the end: number, line, column.
type Told = (Vec<String>, Vec<u16>, Option<(u16, u32, u16)>);

/// What a program does as text, its warnings by number, and the alarm that ends it with its place.
fn read(control: Control, params: &Params, text: &str) -> Told {
    let rules = Rules {
        control,
        ..Rules::default()
    };
    let (events, alarm) = reading::read(text, params, Options::default(), rules);
    let (mut calls, mut warnings) = (Vec::new(), Vec::new());
    for event in events {
        match event {
            Event::Call(call) => calls.push(without_places(&call.kind)),
            Event::Warning(warning) => warnings.push(warning.number()),
        }
    }
    let place = |alarm: Alarm| (alarm.number(), alarm.span.line, alarm.span.column);
    (calls, warnings, alarm.map(place))
}

/// A call as text, without the places of its words.
fn without_places(kind: &CallKind) -> String {
    let text = format!("{kind:?}");
    let mut parts = text.split("span: Span {");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push_str(part.split_once('}').map_or(part, |(_, rest)| rest));
    }
    out
}

/// The set of the sheets with one bit off.
fn without(bit: &str) -> Params {
    let mut params = Params::sheets();
    let entry = Entry::find_text(bit).expect("the parameter exists");
    params.set(entry, 0).expect("within its range");
    params
}

fn increments() -> Params {
    let mut params = without("3401.0");
    let entry = Entry::find_text("1004.1").expect("the parameter exists");
    params.set(entry, 0).expect("within its range");
    params
}

/// Both programs do the same, and the first is told of with `warnings`.
fn same(control: Control, params: &Params, text: &str, plain: &str, warnings: &[u16]) {
    let found = read(control, params, text);
    let whole = if params.whole_units() {
        params.clone()
    } else {
        without("1004.1")
    };
    let expected = read(control, &whole, plain);
    assert_eq!(expected.2, None, "{plain}");
    assert!(!expected.0.is_empty(), "{plain}");
    assert_eq!((found.0, found.2), (expected.0, None), "{text}");
    assert_eq!(found.1, warnings, "{text}");
}

#[test]
fn numbers_without_a_point_count_increments_where_the_parameter_says_so() {
    use Control::{FanucA, FanucB, FanucC, Gsk988, Haas};
    let off = increments();
    for (control, text, plain) in [
        (
            FanucA,
            "G98 G0 X100 Z-5000\nG1 U2000 W-1.5 F100",
            "G98 G0 X.1 Z-5.\nG1 U2. W-1.5 F100",
        ),
        (
            FanucA,
            "G98 G1 X10000 F50\nG2 X20000 Z-5000 R5000",
            "G98 G1 X10. F50\nG2 X20. Z-5. R5.",
        ),
        (
            FanucA,
            "G98 G1 X10000 F50\nG3 X20000 Z-5000 K-5000",
            "G98 G1 X10. F50\nG3 X20. Z-5. K-5.",
        ),
        (
            FanucA,
            "G98 F50 G1 X10000 C500\nZ5000",
            "G98 F50 G1 X10. C.5\nZ5.",
        ),
        (
            FanucA,
            "G98 F50 G1 X10000,R500\nZ-5000",
            "G98 F50 G1 X10.,R.5\nZ-5.",
        ),
        (FanucA, "G4 X1500\nG4 P200", "G4 X1.5\nG4 P200"),
        (FanucA, "G10 P1 X100 Z-200\nG0 X0", "G10 P1 X.1 Z-.2\nG0 X0"),
        (
            FanucA,
            "G50 X100000 Z200000\nG0 X0 Z0",
            "G50 X100. Z200.\nG0 X0 Z0",
        ),
        (FanucA, "G28 U2000 W0\nG0 X1000", "G28 U2. W0\nG0 X1."),
        (
            FanucA,
            "M3 S500 G0 X40000 Z5000\nG92 X30000 Z-20000 R-500 F2.",
            "M3 S500 G0 X40. Z5.\nG92 X30. Z-20. R-.5 F2.",
        ),
        (
            FanucA,
            "M3 S500 G0 X40000 Z5000\nG76 P010060 Q100 R200\nG76 X36000 Z-20000 P1200 Q400 F2.",
            "M3 S500 G0 X40. Z5.\nG76 P010060 Q100 R.2\nG76 X36. Z-20. P1200 Q400 F2.",
        ),
        (
            FanucA,
            "G98 F50 G0 X40000 Z2000\nG73 U3000 W1000 R3\nG73 P1 Q2 U400 W200\nN1 G0 X20000 Z0\nN2 G1 Z-10000",
            "G98 F50 G0 X40. Z2.\nG73 U3. W1. R3\nG73 P1 Q2 U.4 W.2\nN1 G0 X20. Z0\nN2 G1 Z-10.",
        ),
        (
            FanucA,
            "G98 F50 G0 X40000 Z2000\nG71 U2000 R500\nG71 P1 Q2 U400 W200\nN1 G0 X20000\nN2 G1 Z-10000",
            "G98 F50 G0 X40. Z2.\nG71 U2. R.5\nG71 P1 Q2 U.4 W.2\nN1 G0 X20.\nN2 G1 Z-10.",
        ),
        (
            FanucA,
            "G98 G0 X0 Z5000\nG83 Z-12000 R-3000 Q5000 P500 K2 F100",
            "G98 G0 X0 Z5.\nG83 Z-12. R-3. Q5000 P500 K2 F100",
        ),
        (FanucA, "G20 G0 X10000\nX5", "G20 G0 X1.\nX.0005"),
        (
            FanucB,
            "G94 G91 G1 X2000 F100\nG90 X5000",
            "G94 G91 G1 X2. F100\nG90 X5.",
        ),
        (
            FanucC,
            "G94 F50 G0 X40000 Z2000\nG20 X30000 Z-5000",
            "G94 F50 G0 X40. Z2.\nG20 X30. Z-5.",
        ),
        (
            Haas,
            "G98 G0 X40000 Z2000\nG1 Z-5000 F100",
            "G98 G0 X40. Z2.\nG1 Z-5. F100",
        ),
        (
            Gsk988,
            "G0 X40000 Z2000\nG1 Z-5000 F100",
            "G0 X40. Z2.\nG1 Z-5. F100",
        ),
        (
            FanucA,
            "G65 P9 A1500 X2000 D3\nM30\nO9\nG0 X#24 Z#1\nG0 X#7\nM99",
            "G65 P9 A1.5 X2. D3\nM30\nO9\nG0 X#24 Z#1\nG0 X#7\nM99",
        ),
    ] {
        same(control, &off, text, plain, &[]);
    }
    // A GSK 980TD has no such parameter, and a calculated number is one.
    let text = "G0 X40 Z2\nX20";
    same(Control::Gsk980td, &off, text, text, &[]);
    same(
        Control::FanucA,
        &off,
        "#1=5\nG0 X#1 Z[#1*2]",
        "G0 X5. Z10.",
        &[],
    );
}

#[test]
fn a_feed_per_turn_without_a_point_is_refused_there() {
    let off = increments();
    for (text, column) in [
        ("G99 G1 X10000 F20", 15),
        ("M3 S500\nG98 G32 Z-10000 F2", 17),
        ("G98 M3 S500\nG92 X10000 Z-10000 F2", 20),
        ("M3 S500\nG98 G34 Z-10000 F2. K1", 21),
    ] {
        let alarm = read(Control::FanucA, &off, text).2;
        let line = text.lines().count() as u32;
        assert_eq!(alarm, Some((4090, line, column)), "{text}");
    }
    same(
        Control::FanucA,
        &off,
        "G99 G1 X10. F.2",
        "G99 G1 X10. F.2",
        &[],
    );
}

#[test]
fn digits_beyond_the_increment_are_rounded_and_told_once() {
    let sheets = Params::sheets();
    let plain_b = without("1004.1");
    for (control, params, text, plain) in [
        (
            Control::FanucA,
            &plain_b,
            "G98 G1 X12.34549 Z-1.00050 F100\nX-.0005 W.12345",
            "G98 G1 X12.345 Z-1.001 F100\nX-.001 W.123",
        ),
        (
            Control::Haas,
            &plain_b,
            "G98 G1 X10 F100.1234567\nG3 X20 Z-5 R5.00049",
            "G98 G1 X10 F100.123457\nG3 X20 Z-5 R5.",
        ),
        (
            Control::FanucA,
            &sheets,
            "G0 X12.34564\nZ-1.234",
            "G0 X12.3456\nZ-1.234",
        ),
        (
            Control::FanucA,
            &plain_b,
            "G20 G0 X1.23456\nX2.34567",
            "G20 G0 X1.2346\nX2.3457",
        ),
        (
            Control::FanucA,
            &plain_b,
            "G98 F50 G1 X20,R.50001\nZ-10",
            "G98 F50 G1 X20,R.5\nZ-10",
        ),
    ] {
        let found = read(control, params, text);
        let expected = read(control, params, plain);
        assert_eq!(expected, (expected.0.clone(), vec![], None), "{plain}");
        assert_eq!(found, (expected.0, vec![4998], None), "{text}");
    }
    // More digits that are 0 say nothing, and a GSK is asked to be exact.
    same(
        Control::FanucA,
        &sheets,
        "G0 X12.3400000\nZ1",
        "G0 X12.34\nZ1",
        &[],
    );
    assert_eq!(
        read(Control::Gsk980td, &plain_b, "G0 X1.2345").2,
        Some((4026, 1, 4))
    );
}

#[test]
fn a_line_may_be_given_by_its_angle() {
    let params = Params::sheets();
    use Control::{FanucA, FanucB, Haas};
    for (control, text, plain) in [
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 X40 ,A135",
            "G98 F50 G0 X20 Z0\nG1 X40 Z-10",
        ),
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 Z-10,A-45",
            "G98 F50 G0 X20 Z0\nG1 Z-10 X40",
        ),
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 W-10 A150",
            "G98 F50 G0 X20 Z0\nG1 W-10 X31.547",
        ),
        (
            Haas,
            "G98 F50 G0 X20 Z0\nG1 U20 A150",
            "G98 F50 G0 X20 Z0\nG1 U20 Z-17.3205",
        ),
        (
            FanucB,
            "G94 F50 G0 X20 Z0\nG91 G1 X20 ,A135",
            "G94 F50 G0 X20 Z0\nG1 X40 Z-10",
        ),
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 Z-10 A180",
            "G98 F50 G0 X20 Z0\nG1 Z-10",
        ),
        // Two lines: the first goes at 45° off, the second along Z and square.
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 ,A135\nX40 Z-30,A180",
            "G98 F50 G0 X20 Z0\nG1 X40 Z-10\nX40 Z-30",
        ),
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 A180,R2.\n(to the face)\nX40 Z-30 A90",
            "G98 F50 G0 X20 Z0\nG1 Z-30,R2.\nX40 Z-30",
        ),
        (
            FanucA,
            "G98 F50 G0 X20 Z0\nG1 Z-10,A150 R2.\nZ-20",
            "G98 F50 G0 X20 Z0\nG1 Z-10 X31.547,R2.\nZ-20",
        ),
        (
            FanucA,
            "G98 F50 G0 X60 Z2\nG71 U5. R.5\nG71 P1 Q2 U0 W0\nN1 G0 X20\nG1 Z-10\nG1 X40,A135\nN2 Z-30",
            "G98 F50 G0 X60 Z2\nG71 U5. R.5\nG71 P1 Q2 U0 W0\nN1 G0 X20\nG1 Z-10\nG1 X40 Z-20\nN2 Z-30",
        ),
    ] {
        same(control, &params, text, plain, &[]);
    }
    let coarse = without("1004.1");
    let tell = |text| read(FanucA, &coarse, text).2;
    for (text, number, line, column) in [
        // Along an axis that the line does not move, both axes, and none.
        ("G98 F50 G0 X20 Z0\nG1 X40 A180", 4089, 2, 8),
        ("G98 F50 G0 X20 Z0\nG1 Z-5 ,A90", 4089, 2, 8),
        ("G98 F50 G0 X20 Z0\nG1 X40 Z-5 ,A90", 4089, 2, 12),
        ("G98 F50 G0 X20 Z0\nG1 ,A90", 4089, 2, 4),
        ("G98 F50 G0 X20 Z0\nG1 ,A90\nM30", 4089, 2, 4),
        ("G98 F50 G0 X20 Z0\nG1 ,A90\nX40,A30", 4089, 2, 4),
        ("G98 F50 G0 X20 Z0\nG1 ,A90\nU40 Z-5,A30", 4089, 2, 4),
        ("G98 F50 G0 X20 Z0\nG1 ,A30\nX40 Z-5,A30", 4089, 2, 4),
        ("G98 F50 G0 X20 Z0\nG1 X40,A179.99999", 4089, 2, 7),
        ("G0 X20 ,A45", 4028, 1, 8),
    ] {
        assert_eq!(tell(text), Some((number, line, column)), "{text}");
    }
    let alarm = read(Control::Gsk980td, &params, "F50 G1 X20,A45").2;
    assert_eq!(alarm, Some((4028, 1, 11)));
}

#[test]
fn a_contour_may_end_with_a_rapid_that_leads_back() {
    let params = Params::sheets();
    let first = "G98 F50 G0 X60 Z2\nG71 U3. R.5\nG71 P1 Q2 U.4 W.1\n";
    for (contour, kept, warnings) in [
        (
            "N1 G0 X20\nG1 Z-10\nX40\nN2 G0 Z2",
            "N1 G0 X20\nG1 Z-10\nN2 X40",
            &[4997][..],
        ),
        (
            "N1 G0 X20\nG1 Z-10\nX40\nG0 X50\nN2 Z2",
            "N1 G0 X20\nG1 Z-10\nX40\nN2 G0 X50",
            &[4997],
        ),
        (
            "N1 G0 X20\nG1 Z-10\nX40\nN2 G0 X60 Z2",
            "N1 G0 X20\nG1 Z-10\nN2 X40",
            &[4997],
        ),
        (
            "N1 G0 X20 W0\nG1 Z-10\nX16 Z-15\nX40\nG0 X50\nN2 Z3",
            "N1 G0 X20 W0\nG1 Z-10\nX16 Z-15\nX40\nN2 G0 X50",
            &[4997],
        ),
        // On into the same direction it is what it was.
        (
            "N1 G0 X20\nG1 Z-10\nX40\nN2 G0 X50 Z-11",
            "N1 G0 X20\nG1 Z-10\nX40\nN2 G1 X50 Z-11",
            &[],
        ),
    ] {
        let text = format!("{first}{contour}");
        same(
            Control::FanucA,
            &params,
            &text,
            &format!("{first}{kept}"),
            warnings,
        );
    }
    for (contour, line) in [
        // Back through what is cut, down before it goes back, and a cut that goes back.
        ("N1 G0 X20\nG1 Z-10\nX40\nN2 G0 X30 Z2", 7),
        ("N1 G0 X20\nG1 Z-10\nX40\nG0 X38\nN2 G0 Z2", 7),
        ("N1 G0 X20\nG1 Z-10\nX40\nG0 X50\nZ2\nN2 X30", 8),
        ("N1 G0 X20\nG1 Z-10\nX40\nN2 Z2", 7),
        ("N1 G0 X20\nG1 Z-10\nX40\nG0 Z2\nN2 G1 X44", 7),
    ] {
        let alarm = read(Control::FanucA, &params, &format!("{first}{contour}")).2;
        assert_eq!(
            alarm.map(|(number, line, _)| (number, line)),
            Some((64, line)),
            "{contour}"
        );
    }
    let bore = "G98 F50 G0 X10 Z2\nG72 W2. R.5\nG72 P1 Q2 U-.4 W.1\nN1 G0 Z-10\nG1 X20\nZ-4\nN2 ";
    let all = format!("{bore}G0 X10");
    same(
        Control::FanucA,
        &params,
        &all,
        &bore.replace("\nZ-4\nN2 ", "\nN2 Z-4"),
        &[4997],
    );
    // G70 goes there, and G73 too.
    let text = "G98 F50 G0 X60 Z2\nN1 G0 X20\nG1 Z-10\nX40\nN2 G0 Z2\nG70 P1 Q2";
    assert_eq!(read(Control::FanucA, &params, text).1, &[] as &[u16]);
}

#[test]
fn the_main_program_may_stand_behind_its_subprogram() {
    let params = Params::sheets();
    for (text, plain) in [
        (
            "%\nO10\nG0 X5\nM99\nO1\nG0 X1\nM98 P10\nM30\n%",
            "O1\nG0 X1\nM98 P10\nM30\nO10\nG0 X5\nM99",
        ),
        (
            "O0010 (SUB)\nG0 X5\nM99\nO0001 (MAIN)\nG0 X1\nM98 P30010\nN5 M02",
            "O1\nG0 X1\nM98 P30010\nN5 M02\nO10\nG0 X5\nM99",
        ),
        (
            "O10\nG0 X#1\nM99\nO1\nG65 P10 A3\nM30",
            "O1\nG65 P10 A3\nM30\nO10\nG0 X#1\nM99",
        ),
        // By way of another.
        (
            "O10\nG0 X5\nM99\nO11\nM98 P10\nM99\nO1\nM98 P11\nG0 X1\nM30",
            "O1\nM98 P11\nG0 X1\nM30\nO10\nG0 X5\nM99\nO11\nM98 P10\nM99",
        ),
        (
            "O10\nG0 X5\nM99\nO1\nM98 P11\nG0 X1\nM30\nO11\nM98 P10\nM99",
            "O1\nM98 P11\nG0 X1\nM30\nO11\nM98 P10\nM99\nO10\nG0 X5\nM99",
        ),
    ] {
        for control in [Control::Gsk980td, Control::FanucA] {
            same(control, &params, text, plain, &[4999]);
        }
    }
    for text in [
        // The first ends, is called by nobody, or does not return.
        "O1\nG0 X1\nM98 P10\nM30\nO10\nG0 X5\nM99",
        "O10\nG0 X5\nM99\nO1\nG0 X1\nM98 P11\nM30\nO11\nM99",
        "O10\nG0 X5\nO1\nG0 X1\nM98 P10\nM30",
        "O10\nG0 X5\nM99\nO1\nG0 X1\nM98 P10\nM99",
    ] {
        let (calls, warnings, alarm) = read(Control::FanucA, &params, text);
        assert!(calls.iter().any(|call| call.contains("Rapid")), "{text}");
        assert!(!warnings.contains(&4999) && alarm.is_none(), "{text}");
    }
}
