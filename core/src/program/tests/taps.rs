//! G84 and G88: what a program's words become, when rigid mode begins and ends, and every alarm around it.

use super::parameters::machine;
use super::*;
use crate::alarm::Code;
use crate::units::{Angle, CentiRpm, Millis};
use core::num::NonZeroU8;
use std::string::String;

/// The way to a hole, and rigid mode with 1000 rpm.
const READY: &str = "G98 G0 X50 Z0\nM29 S1000\n";

fn kinds_on(values: &[(&str, &str)], text: &str) -> (Vec<CallKind>, Vec<u16>) {
    let params = machine(values);
    let (events, alarm) = read_with(text.as_bytes(), &params, Options::default());
    assert_eq!(alarm, None, "{text}");
    let (mut kinds, mut warnings) = (Vec::new(), Vec::new());
    for event in events {
        match event {
            Event::Call(call) => kinds.push(call.kind),
            Event::Warning(alarm) => warnings.push(alarm.number()),
        }
    }
    (kinds, warnings)
}

fn taps_on(values: &[(&str, &str)], text: &str) -> Vec<TapCall> {
    let (kinds, _) = kinds_on(values, text);
    let tap = |kind| match kind {
        CallKind::Tap(call) => Some(call),
        _ => None,
    };
    kinds.into_iter().filter_map(tap).collect()
}

/// The last tap behind [`READY`].
fn tap_on(values: &[(&str, &str)], text: &str) -> TapCall {
    let text = String::from_iter([READY, text]);
    *taps_on(values, &text).last().expect("a tap")
}

fn tap(text: &str) -> TapCall {
    tap_on(&[], text)
}

fn lead_of(call: &TapCall) -> (i64, i64) {
    (call.lead.value.numerator(), call.lead.value.denominator())
}

fn rpm(value: i32) -> CentiRpm {
    CentiRpm::of_rpm(Rpm::new(value))
}

fn holes(count: u8) -> TapRepeat {
    TapRepeat::Holes(NonZeroU8::new(count).unwrap())
}

#[test]
fn the_sheets_program_as_printed() {
    let text = "G98;\nG0 X50 Z0;\nM29 S1000;\nG84 Z-50 P3000 F2000;\nG80;\nM30;\n";
    let (kinds, warnings) = kinds_on(&[], text);
    assert_eq!(warnings, []);
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
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9 Q4 D3\nX5 Q0"), Some((207, 2, 15)));
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

#[test]
fn the_spindle_that_taps() {
    let spindle = |text: &str| taps_on(&[], text)[0].spindle;
    let by_signal = |by, otherwise| SpindleChoice::Signals { by, otherwise };
    let sws = |otherwise| by_signal(Selection::Sws, otherwise);
    assert_eq!(spindle("M29 S9\nG84 Z-9 F9"), sws(TapSpindle::First));
    assert_eq!(spindle("M26\nM29 S9\nG84 Z-9 F9"), sws(TapSpindle::Third));
    let interlocked = "M27\nM24\nM29 S9\nG84 Z-9 F9";
    assert_eq!(spindle(interlocked), sws(TapSpindle::First));
    let e4 = SpindleChoice::Written(TapSpindle::Fourth);
    assert_eq!(spindle("M26\nM29 S9\nG84 Z-9 F9 E4"), e4);
    let text = "M26\nM29 S9\nG84 Z-9 F9";
    let rgtsp = taps_on(&[("5200.7", "1")], text)[0].spindle;
    assert_eq!(rgtsp, by_signal(Selection::Rgtsp, TapSpindle::Third));
    // With S in the cycle's block its E is known at once.
    let (kinds, _) = kinds_on(&[("5200.0", "1")], "M26\nG84 Z-9 F9 S9 E4");
    let rigid = SpindleCall::rigid(Rpm::new(9), e4);
    assert_eq!(kinds[1], CallKind::Spindle(rigid));
    let (kinds, _) = kinds_on(&[], "M25 M29 M8 S9\nG84 Z-9 F9");
    assert_eq!(
        kinds[..3],
        [
            CallKind::Aux(Aux::M(8)),
            CallKind::Aux(Aux::M(25)),
            CallKind::Spindle(SpindleCall::rigid(Rpm::new(9), sws(TapSpindle::Second)))
        ]
    );
}

#[test]
fn rigid_mode_by_the_cycles_own_block() {
    let by_g = &[("5200.0", "1")];
    let (kinds, _) = kinds_on(by_g, "G84 X10 Z-10 F500 S600\nX20\nX30 S-500\nG80");
    let rigid =
        |rpm| CallKind::Spindle(SpindleCall::rigid(Rpm::new(rpm), SpindleChoice::default()));
    assert_eq!((kinds[0], kinds[3]), (rigid(600), rigid(-500)));
    assert_eq!(kinds[5], CallKind::Spindle(SpindleCall::STOPPED));
    let taps = taps_on(by_g, "G84 X10 Z-10 F500 S600\nX20\nX30 S-500\nG80");
    assert_eq!(
        [taps[1].hand, taps[2].hand],
        [HandChoice::Signal, HandChoice::Written(Hand::Left)]
    );
    assert_eq!(lead_of(&taps[2]), (1_000_000, 1));
    let number = |text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), &machine(by_g), Options::default());
        alarm.map(|alarm| (alarm.number(), alarm.span.column))
    };
    assert_eq!(number("G84 Z-10 F500"), Some((200, 1)));
    assert_eq!(number("G84 Z-10 F500 S0"), Some((200, 15)));
    assert_eq!(number("M29 S500"), Some((203, 1)));
    // Ended with the cycle.
    assert_eq!(
        number("G84 Z-10 F500 S9\nG80\nG84 Z-10 F500"),
        Some((200, 1))
    );
    assert_eq!(number("G84 Z-10 F500 S9\nG4 X1 S9"), Some((4066, 7)));
}

#[test]
fn rigid_mode_by_another_m_code() {
    let other = &[("5210", "135")];
    assert_eq!(taps_on(other, "M135 S9\nG84 Z-9 F9").len(), 1);
    let number = |values: &[_], text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), &machine(values), Options::default());
        alarm.map(|alarm| alarm.number())
    };
    assert_eq!(number(other, "M29 S9"), Some(4019));
    // A code with a meaning of its own keeps it.
    assert_eq!(number(&[("5210", "8")], "M8\nG84 Z-9 F9"), Some(4060));
}

#[test]
fn rigid_mode_ends_and_s_with_it() {
    let stopped = CallKind::Spindle(SpindleCall::STOPPED);
    for text in ["G80", "G0 X80", "G1 X80 F9", "G80 G0 X80", "G0"] {
        let text = std::format!("M3 S300\nM29 S9\nG84 Z-9 F9\n{text}\nM3");
        let (kinds, _) = kinds_on(&[], &text);
        assert_eq!(kinds[3], stopped, "{text}");
        assert_eq!(*kinds.last().unwrap(), spindle(0), "{text}");
    }
    // A speed of its own in the block takes the place of the stop.
    let (kinds, _) = kinds_on(&[], "M29 S9\nG84 Z-9 F9\nG80 M4 S400");
    assert_eq!(kinds[2..], [spindle(-400)]);
    let (kinds, _) = kinds_on(&[], "M29 S9\nG84 Z-9 F9\nX5 M30");
    assert!(matches!(kinds[2], CallKind::Tap(_)));
    assert_eq!(kinds[3..], [stopped, CallKind::End(30)]);
    // Without rigid mode G80 does nothing.
    assert_eq!(
        kinds_on(&[], "M3 S300\nG80\nM4").0,
        [spindle(300), spindle(-300)]
    );
    // F of a tap is none of a cut.
    assert_eq!(alarm("M29 S9\nG84 Z-9 F9\nG1 X5").code, Code::FeedMissing);
    assert_eq!(alarm("G1 X5 F9\nM29 S9\nG84 Z-9").code, Code::TapFeed);
}

#[test]
fn the_table_of_the_extraction_override() {
    const ON: (&str, &str) = ("5200.4", "1");
    const J: (&str, &str) = ("5201.4", "1");
    const WIDE: (&str, &str) = ("5202.6", "1");
    const TENS: (&str, &str) = ("5201.3", "1");
    const P150: (&str, &str) = ("5211", "150");
    type Case<'a> = (&'a [(&'a str, &'a str)], &'a str, i32);
    let cases: &[Case] = &[
        // 5200.4 = 0: 100 %, whatever else there is.
        (&[P150], "", 100_000),
        (&[J, WIDE, P150], "J1500", 100_000),
        // 5201.4 = 0: 5211, in 1 % or 10 %; 0 is 100 %.
        (&[ON], "", 100_000),
        (&[ON, P150], "", 150_000),
        (&[ON, P150], "J1200", 150_000),
        (&[ON, ("5211", "12"), TENS], "", 120_000),
        (&[ON, ("5211", "12")], "", 12_000),
        (&[ON, ("5211", "33")], "", 33_000),
        // 5201.4 = 1: J within its range, 100 % outside it, 5211 without it.
        (&[ON, J, P150], "", 150_000),
        (&[ON, J, P150], "J1200", 120_000),
        (&[ON, J, P150], "J1000", 100_000),
        (&[ON, J, P150], "J2000", 200_000),
        (&[ON, J, P150], "J2001", 100_000),
        (&[ON, J, P150], "J999", 100_000),
        (&[ON, J, P150], "J0", 100_000),
        // Without a limit in the way: 5202.6 = 1 allows 2000 %.
        (&[ON, J, WIDE, P150], "J2001", 200_100),
        (&[ON, J, WIDE, P150], "J999", 100_000),
    ];
    for (values, word, expected) in cases {
        let call = tap_on(values, &std::format!("G84 Z-9 F1000 {word}"));
        assert_eq!(call.extract.get(), *expected, "{values:?} {word}");
        assert_eq!(call.speed, rpm(1000));
    }
    // J is kept until the cycle ends.
    let text = "M29 S100\nG84 Z-9 F100 J150\nX5\nG80\nM29 S100\nG84 Z-9 F100";
    let speeds: Vec<_> = taps_on(&[ON, J], text)
        .iter()
        .map(|call| call.extract)
        .collect();
    assert_eq!(speeds, [rpm(150), rpm(150), rpm(100)]);
    let wide = taps_on(&[ON, J, WIDE], "M29 S100\nG84 Z-9 F100 J2000\nJ2001 X5");
    assert_eq!([wide[0].extract, wide[1].extract], [rpm(2000), rpm(100)]);
}

#[test]
fn nothing_turns_faster_than_5241() {
    let values = &[("5200.4", "1"), ("5211", "200"), ("5241", "1500 rpm")];
    let text = String::from_iter([READY, "G84 Z-9 F1000\nX5\nX6"]);
    let (kinds, warnings) = kinds_on(values, &text);
    assert_eq!(warnings, [4902]);
    let CallKind::Tap(call) = kinds[4] else {
        panic!("{kinds:?}")
    };
    assert_eq!((call.speed, call.extract), (rpm(1000), rpm(1500)));
    let number = |values: &[_], text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), &machine(values), Options::default());
        alarm.map(|alarm| alarm.number())
    };
    assert_eq!(number(values, "M29 S1500\nG84 Z-9 F900"), None);
    assert_eq!(number(values, "M29 S1501"), Some(200));
    assert_eq!(number(values, "M29 S-1501"), Some(200));
    // The spindle's own limit holds too.
    assert_eq!(number(&[("5241", "9999 rpm")], "M29 S3001"), Some(200));
}

#[test]
fn a_dry_run_keeps_the_lead() {
    let params = machine(&[("1410", "300 mm/min"), ("5200.4", "1"), ("5211", "150")]);
    let options = Options {
        dry_run: true,
        ..Options::default()
    };
    let read = |text: &str| match read_with(text.as_bytes(), &params, options).0.last() {
        Some(Event::Call(Call {
            kind: CallKind::Tap(call),
            ..
        })) => *call,
        other => panic!("{other:?}"),
    };
    let call = read("M29 S1000\nG84 Z-9 F2000");
    assert_eq!(lead_of(&call), (2_000_000, 1));
    assert_eq!((call.speed, call.extract), (rpm(150), rpm(225)));
    // Lead 0.05: 6000 rpm would be needed.
    let call = read("M29 S1000\nG84 Z-9 F50");
    assert_eq!((call.speed, call.extract), (rpm(3000), rpm(3000)));
}

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

#[test]
fn a_tap_waits_for_a_stop_of_the_spindle_only() {
    // Rigid mode stops a spindle that turns; what it turned at is forgotten.
    let (kinds, _) = kinds_on(&[], "M3 S500\nM29 S100\nG84 Z-9 F100\nG80\nM3 S700");
    assert_eq!(
        kinds[1],
        CallKind::Spindle(SpindleCall::rigid(Rpm::new(100), SpindleChoice::default()))
    );
    assert_eq!(*kinds.last().unwrap(), spindle(700));
}
