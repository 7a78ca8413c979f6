//! K198: a hole that goes on in phase, and the blocks that may follow K198.

use super::taps::{holes, taps_on};
use super::*;
use crate::alarm::Code;
use crate::units::Angle;

#[test]
fn k198_goes_on_in_phase() {
    let text = "G0 X50 Z5\nM29 S1000\nG84 C90 Z-20 R-2 Q4 F2000 K198 M10\nG4 P100\nM8\nM0\nG84 Z-25 K198\nG84 Z-30 Q0\nC180\nG80";
    let taps = taps_on(&[], text);
    let [first, second, third, fourth] = taps.as_slice() else {
        panic!("{taps:?}")
    };
    let hole = Position {
        c: Angle::from_udeg(90_000_000),
        ..at(500_000, 50_000)
    };
    assert_eq!((first.repeat, first.continues), (TapRepeat::Stay, false));
    assert_eq!((second.repeat, second.continues), (TapRepeat::Stay, true));
    assert_eq!((third.repeat, third.continues), (holes(1), true));
    assert_eq!(second.start, TapAxis::Z.with(hole, mm(-20)));
    assert_eq!(third.start, TapAxis::Z.with(hole, mm(-25)));
    for call in [first, second, third] {
        assert_eq!(
            (call.hole, call.level.value, call.clamp),
            (hole, mm(3), Some(10))
        );
    }
    assert_eq!(
        (third.form, third.bottom.value),
        (TapForm::Standard, mm(-30))
    );
    assert_eq!((fourth.continues, fourth.start), (false, hole));
}

#[test]
fn s_of_a_hole_that_goes_on_does_not_begin_rigid_mode_again() {
    // The spindle would leave position mode with the tap in its hole.
    let text = "G84 Z-20 F2 S1000 K198\nG84 Z-30 S500\nC90 S700\nG80";
    let (kinds, _) = kinds_on(&[("5200.0", "1")], &std::format!("G99\n{text}"));
    let begins: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            CallKind::Spindle(call) if call.mode != SpindleMode::Speed => Some(call.rpm),
            _ => None,
        })
        .collect();
    assert_eq!(begins, [Rpm::new(1000), Rpm::new(700)]);
    let speeds: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            CallKind::Tap(call) => Some(call.speed),
            _ => None,
        })
        .collect();
    assert_eq!(speeds, [rpm(1000), rpm(500), rpm(700)]);
}

#[test]
fn after_k198_everything_else_is_refused() {
    const IN: &str = "M29 S1000\nG84 Z-20 F2000 K198\n";
    for text in [
        "G80",
        "M30",
        "M2",
        "G0",
        "G1 X5",
        "G0 Z5",
        "X5",
        "H5",
        "Z-30",
        "G53 Z5",
        "G50 X5",
        "G50 S5",
        "G17",
        "T0101",
        "M3",
        "M5",
        "M29 S1000",
        "M25",
        "G75 X5 P1",
        "G84 X5 Z-30",
        "G84 C5 Z-30",
        "G84 Z-30 R-1",
        "G84 Z-30 K2",
        "G84 Z-30 E2",
        "G84 Z-30 F1000",
        "G84 Z-30 M10",
        "G84 Z-19",
        "G84 Z-20",
        "G84",
        "G84 W-19",
        "G88 X5 F2000",
        "G84 Z-30 T0101",
        "G84 Z-30 M25",
    ] {
        let alarm = alarm(&std::format!("{IN}{text}"));
        assert_eq!(
            (alarm.code, alarm.span.line),
            (Code::TapLocked, 3),
            "{text}"
        );
        assert_eq!(alarm.args[0], crate::alarm::Arg::Int(2), "{text}");
    }
    let by_g = machine(&[("5200.0", "1")]);
    for text in ["S500", "S500 G84 Z-30", "G84 Z-30 S-1000"] {
        let text = std::format!("G84 Z-20 F2000 S1000 K198\n{text}");
        let (_, alarm) = read_with(text.as_bytes(), &by_g, Options::default());
        assert_eq!(alarm.expect(&text).code, Code::TapLocked, "{text}");
    }
    // The word that changes spindle, lead or cycle is the one to blame.
    for (text, column) in [
        ("G84 Z-30 E2", 10),
        ("G84 Z-30 F1000", 10),
        ("G88 X5 F2000", 1),
        ("G88", 1),
    ] {
        let alarm = alarm(&std::format!("{IN}{text}"));
        assert_eq!(
            (alarm.code, alarm.span.line, alarm.span.column),
            (Code::TapLocked, 3, column),
            "{text}"
        );
        assert!(alarm.word.is_some(), "{text}");
    }
    for text in ["", "G4 X1", "%"] {
        let alarm = alarm(&std::format!("{IN}{text}"));
        assert_eq!(
            (alarm.code, alarm.span),
            (Code::TapLeftInHole, span(2, 1, 4))
        );
    }
}
