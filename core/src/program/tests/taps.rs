//! G84 and G88: what a program's words become.

use super::*;
use crate::alarm::Code;
use crate::units::{Angle, Millis};
use core::num::NonZeroU8;
use std::string::String;

/// The way to a hole, and rigid mode with 1000 rpm.
pub(super) const READY: &str = "G98 G0 X50 Z0\nM29 S1000\n";

pub(super) fn taps_on(values: &[(&str, &str)], text: &str) -> Vec<TapCall> {
    let (kinds, _) = kinds_on(values, text);
    let tap = |kind| match kind {
        CallKind::Tap(call) => Some(call),
        _ => None,
    };
    kinds.into_iter().filter_map(tap).collect()
}

/// The last tap after [`READY`].
pub(super) fn tap_on(values: &[(&str, &str)], text: &str) -> TapCall {
    let text = String::from_iter([READY, text]);
    *taps_on(values, &text).last().expect("a tap")
}

pub(super) fn tap(text: &str) -> TapCall {
    tap_on(&[], text)
}

pub(super) fn holes(count: u8) -> TapRepeat {
    TapRepeat::Holes(NonZeroU8::new(count).unwrap())
}

#[test]
fn the_sheets_program_as_printed() {
    let text = "G98;\nG0 X50 Z0;\nM29 S1000;\nG84 Z-50 P3000 F2000;\nG80;\nM30;\n";
    let (kinds, warnings) = kinds_on(&[], text);
    assert!(warnings.is_empty(), "{warnings:?}");
    let [rapid, rigid, CallKind::Tap(call), off, end] = kinds.as_slice() else {
        panic!("{kinds:?}")
    };
    assert_eq!(*rapid, CallKind::Rapid(at(500_000, 0)));
    assert_eq!(
        *rigid,
        CallKind::Spindle(SpindleCall::rigid(Rpm::new(1000), SpindleChoice::default()))
    );
    assert_eq!(*off, CallKind::Spindle(SpindleCall::STOPPED));
    assert_eq!(*end, CallKind::End(30));
    assert_eq!((call.cycle, call.axis), (TapCycle::G84, TapAxis::Z));
    assert_eq!((call.start, call.hole), (at(500_000, 0), at(500_000, 0)));
    assert_eq!(
        (call.level.value, call.bottom.value),
        (Length::ZERO, mm(-50))
    );
    assert_eq!(
        (call.form, call.dwell),
        (TapForm::Standard, Millis::new(3000))
    );
    assert_eq!(lead_of(call), (2_000_000, 1));
    assert_eq!(
        (call.hand, call.speed, call.extract),
        (HandChoice::Signal, rpm(1000), rpm(1000))
    );
    assert_eq!(
        (call.spindle, call.repeat),
        (SpindleChoice::default(), holes(1))
    );
    assert_eq!((call.clamp, call.continues), (None, false));
}

#[test]
fn the_lead_is_an_exact_ratio() {
    assert_eq!(lead_of(&tap("G84 Z-9 F1250")), (1_250_000, 1));
    let third = taps_on(&[], "M29 S3\nG84 Z-9 F1000");
    assert_eq!(lead_of(&third[0]), (1_000_000_000, 3));
    assert_eq!(lead_of(&tap("G99 G84 Z-9 F1.5")), (1_500_000, 1));
    // 1/13 inch a turn.
    let inch = taps_on(&[], "G20 M29 S1300\nG84 Z-.5 F100");
    assert_eq!(lead_of(&inch[0]), (25_400_000, 13));
}

#[test]
fn a_minus_is_a_left_hand_tap() {
    let (kinds, _) = kinds_on(&[], "M29 S-800\nG84 Z-9 F1000");
    assert_eq!(
        kinds[0],
        CallKind::Spindle(SpindleCall::rigid(Rpm::new(-800), SpindleChoice::default()))
    );
    let CallKind::Tap(call) = kinds[1] else {
        panic!("{kinds:?}")
    };
    assert_eq!(
        (call.hand, call.speed),
        (HandChoice::Written(Hand::Left), rpm(800))
    );
    assert_eq!(lead_of(&call), (1_250_000, 1));
}

#[test]
fn the_tap_axis_goes_by_code_and_plane() {
    let axis = |values: &[_], text: &str| {
        let text = std::format!("G0 X50 Z5\n{text}");
        taps_on(values, &text)[0].axis
    };
    for (plane, g84, g88) in [
        ("G17", Some(TapAxis::X), None),
        ("G18", Some(TapAxis::Z), Some(TapAxis::X)),
        ("G19", None, Some(TapAxis::Z)),
    ] {
        for (code, expected) in [("G84", g84), ("G88", g88)] {
            let (bottom, fixed) = match expected {
                Some(TapAxis::X) => ("X10", TapAxis::X),
                Some(TapAxis::Z) => ("Z-10", TapAxis::Z),
                None => continue,
            };
            let text = std::format!("{plane} M29 S500\n{code} {bottom} F500");
            assert_eq!(axis(&[], &text), fixed, "{text}");
        }
        for (code, bottom, expected) in [("G84", "Z-10", TapAxis::Z), ("G88", "X10", TapAxis::X)] {
            let text = std::format!("{plane} M29 S500\n{code} {bottom} F500");
            assert_eq!(axis(&[("5209.0", "1")], &text), expected, "{text}");
        }
    }
}

#[test]
fn words_of_both_axes() {
    // G84: the hole by X, U, C, H; the bottom by Z, or by W from R.
    let call = tap("G84 X40 C90 R-5 W-20 F1000");
    assert_eq!(
        call.hole,
        Position {
            c: Angle::from_udeg(90_000_000),
            ..at(400_000, 0)
        }
    );
    assert_eq!((call.level.value, call.bottom.value), (mm(-5), mm(-25)));
    assert_eq!(call.step, Position::ZERO);
    // G88: the hole by Z; the bottom by X, or by U from R as a diameter; R is a radius.
    let call = tap("G88 Z-20 R-2 U-30 F1000");
    assert_eq!(call.hole, at(500_000, -200_000));
    assert_eq!((call.level.value, call.bottom.value), (mm(23), mm(8)));
    let call = tap("G88 Z-20 X20 F1000");
    assert_eq!((call.level.value, call.bottom.value), (mm(25), mm(10)));
}

#[test]
fn pecks_and_their_return() {
    let peck =
        |infeed, back| match tap_on(&[], &std::format!("G84 Z-50 F1000 {infeed} {back}")).form {
            TapForm::HighSpeed(peck) => Some((peck.infeed.value, peck.back.value)),
            TapForm::Standard => None,
            TapForm::Deep(_) => panic!("deep"),
        };
    assert_eq!(peck("", ""), None);
    assert_eq!(peck("Q0", "D0"), None);
    assert_eq!(peck("Q4", ""), Some((mm(4), mm(1))));
    assert_eq!(peck("Q4", "D2.5"), Some((mm(4), um(2_500))));
    assert_eq!(peck("Q.5", ""), Some((um(500), um(500))));
    assert_eq!(peck("Q4", "D0"), Some((mm(4), Length::ZERO)));
    let deep = tap_on(&[("5200.5", "1"), ("5213", "0.3 mm")], "G84 Z-50 F1000 Q4").form;
    let TapForm::Deep(deep) = deep else {
        panic!("{deep:?}")
    };
    assert_eq!(deep.back.value, um(300));
}

#[test]
fn words_that_would_do_nothing_are_refused() {
    let alarm = |text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), &machine(&[]), Options::default());
        alarm.map(|alarm| (alarm.number(), alarm.span.line, alarm.span.column))
    };
    // A return from pecks without pecks, also where Q came to be 0 afterwards.
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 D3"), Some((207, 2, 12)));
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 Q0 D3"), Some((207, 2, 15)));
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 Q4 D3\nX5 Q0"), Some((207, 3, 4)));
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 D0"), None);
    // J is a spindle speed, and written like one.
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 J12.0"), Some((4023, 2, 12)));
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 J12"), None);
    // Rigid mode that no cycle follows.
    assert_eq!(alarm("M29 S9"), Some((203, 1, 1)));
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9"), None);
}

#[test]
fn what_is_kept_from_hole_to_hole() {
    let text = "M29 S1000\nG84 C90 Z-20 R-2 Q4 P500 F1500 D2 J1500 E2 M10\nC180\nC270 Z-15 P0\nH45\nG84 C0\n";
    let taps = taps_on(&[], text);
    let first = taps[0];
    assert_eq!(
        (first.spindle, first.clamp),
        (SpindleChoice::Written(TapSpindle::Second), Some(10))
    );
    assert_eq!(taps.len(), 5);
    for (call, degrees) in taps.iter().zip([90, 180, 270, 315, 0]) {
        assert_eq!(call.hole.c, Angle::from_udeg(degrees * 1_000_000));
        assert_eq!((call.form == first.form, call.level.value), (true, mm(-2)));
        assert_eq!(
            (call.lead, call.spindle, call.clamp),
            (first.lead, first.spindle, first.clamp)
        );
    }
    assert_eq!(
        (taps[1].bottom.value, taps[1].dwell),
        (mm(-20), Millis::new(500))
    );
    assert_eq!(
        (taps[2].bottom.value, taps[2].dwell),
        (mm(-15), Millis::new(0))
    );
    assert_eq!(
        (taps[3].bottom.value, taps[3].start),
        (mm(-15), taps[2].hole)
    );
    // An increment is one from the R plane in every hole.
    let taps = taps_on(&[], "G0 Z3\nM29 S100\nG84 W-8 R-1 F100\nU10\n");
    assert_eq!([taps[0].bottom.value, taps[1].bottom.value], [mm(-6); 2]);
    // Another axis begins anew: nothing is kept.
    let text = String::from_iter([READY, "G84 Z-9 F1000\nG88 Z-3"]);
    assert_eq!(alarm(&text).code, Code::TapBottomMissing);
}

#[test]
fn words_without_a_hole_change_what_is_kept() {
    let taps = taps_on(
        &[],
        &String::from_iter([READY, "G84 Z-9 F1000\nP200\nZ-12\nF2000\nM8\nG4 P5\nX40"]),
    );
    let [_, second] = taps.as_slice() else {
        panic!("{taps:?}")
    };
    assert_eq!(
        (second.bottom.value, second.dwell),
        (mm(-12), Millis::new(200))
    );
    assert_eq!(lead_of(second), (2_000_000, 1));
}

#[test]
fn repeats_apply_increments_again() {
    let text = String::from_iter([READY, "G84 H30 U-4 Z-9 F1000 K4\nG80 G1 W-1 F100"]);
    let (kinds, _) = kinds_on(&[], &text);
    let CallKind::Tap(call) = kinds[2] else {
        panic!("{kinds:?}")
    };
    assert_eq!(call.repeat, holes(4));
    assert_eq!(call.hole.c, Angle::from_udeg(30_000_000));
    assert_eq!(
        call.step,
        Position {
            c: Angle::from_udeg(30_000_000),
            ..at(-40_000, 0)
        }
    );
    // The tool stands at the last hole, at the initial level.
    let last = Position {
        c: Angle::from_udeg(120_000_000),
        ..at(340_000, -10_000)
    };
    assert!(
        matches!(kinds[4], CallKind::Line(to, _) if to == last),
        "{kinds:?}"
    );
    assert_eq!(tap("G84 C30 Z-9 F1000 K99").step, Position::ZERO);
}
