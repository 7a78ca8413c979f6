//! Rigid mode: what begins and ends it, which spindle it is, and how fast it may turn.

use super::taps::{READY, tap_on, taps_on};
use super::*;
use crate::alarm::Code;
use std::string::String;

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
    type Case<'a> = (&'a [(&'a str, &'a str)], &'a str, i32, &'a [u16]);
    let cases: &[Case] = &[
        // 5200.4 = 0: 100 %, whatever else there is.
        (&[P150], "", 100_000, &[]),
        (&[J, WIDE, P150], "J1500", 100_000, &[4910]),
        // 5201.4 = 0: 5211, in 1 % or 10 %; 0 is 100 %.
        (&[ON], "", 100_000, &[]),
        (&[ON, P150], "", 150_000, &[]),
        (&[ON, P150], "J1200", 150_000, &[4910]),
        (&[ON, ("5211", "12"), TENS], "", 120_000, &[]),
        (&[ON, ("5211", "12")], "", 12_000, &[]),
        (&[ON, ("5211", "33")], "", 33_000, &[]),
        // 5201.4 = 1: J within its range, 100 % outside it, 5211 without it.
        (&[ON, J, P150], "", 150_000, &[]),
        (&[ON, J, P150], "J1200", 120_000, &[]),
        (&[ON, J, P150], "J1000", 100_000, &[]),
        (&[ON, J, P150], "J2000", 200_000, &[]),
        (&[ON, J, P150], "J2001", 100_000, &[4911]),
        (&[ON, J, P150], "J999", 100_000, &[4911]),
        (&[ON, J, P150], "J0", 100_000, &[4911]),
        // Without a limit in the way: 5202.6 = 1 allows 2000 %.
        (&[ON, J, WIDE, P150], "J2001", 200_100, &[]),
        (&[ON, J, WIDE, P150], "J999", 100_000, &[4911]),
    ];
    for (values, word, expected, warned) in cases {
        let block = std::format!("G84 Z-9 F1000 {word}");
        let call = tap_on(values, &block);
        let (_, warnings) = kinds_on(values, &String::from_iter([READY, &block]));
        assert_eq!(warnings, *warned, "{values:?} {word}");
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
fn a_tap_waits_for_a_stop_of_the_spindle_only() {
    // Rigid mode stops a spindle that turns; what it turned at is forgotten.
    let (kinds, _) = kinds_on(&[], "M3 S500\nM29 S100\nG84 Z-9 F100\nG80\nM3 S700");
    assert_eq!(
        kinds[1],
        CallKind::Spindle(SpindleCall::rigid(Rpm::new(100), SpindleChoice::default()))
    );
    assert_eq!(*kinds.last().unwrap(), spindle(700));
}

#[test]
fn m19_is_an_angle_where_no_row_of_the_table_is_it() {
    let angle = |text: &str| {
        let (kinds, _) = kinds_on(&[], text);
        let found = kinds.iter().find_map(|kind| match kind {
            CallKind::Spindle(SpindleCall {
                mode: SpindleMode::Orient(angle),
                rpm: Rpm::STOPPED,
            }) => Some(angle.udeg()),
            _ => None,
        });
        found.expect("an angle")
    };
    for (text, udeg) in [
        ("M19", 0),
        ("M19 R90", 90_000_000),
        ("M19 R90.5", 90_500_000),
        ("R-90 M19", 270_000_000),
        ("M19 R360", 0),
        ("M19 R-725.125", 354_875_000),
        // R is an angle whatever is in force, and whatever cycle has a word of that name.
        ("G20 M19 R90.5", 90_500_000),
        ("G3 X2 Z0 R1 F99\nM19 R5", 5_000_000),
        ("G1 F9 M8 M19 R5", 5_000_000),
        ("G0 X10 M19", 0),
        ("G96 S100 M3\nM19 R5\nG0 X9", 5_000_000),
    ] {
        assert_eq!(angle(text), udeg, "{text}");
    }
    // The spindle stands from then on.
    let (kinds, _) = kinds_on(&[], "M3 S500\nM19 R5\nS300\nG97 S400");
    let last: Vec<_> = kinds.iter().skip(2).collect();
    assert!(
        last.iter()
            .all(|kind| **kind == CallKind::Spindle(SpindleCall::STOPPED))
    );

    let number = |values: &[_], text: &str| {
        let (_, alarm) = read_with(text.as_bytes(), &machine(values), Options::default());
        alarm.map(|alarm| (alarm.number(), alarm.span.column))
    };
    for (text, alarm) in [
        ("M19 M3 S100", (4017, 1)),
        ("M19 S100", (4028, 5)),
        ("G1 Z5 F9 M19 R5", (4028, 14)),
        ("G4 X1 M19 R5", (4028, 11)),
        ("M19 P5", (4028, 5)),
        ("M19 R1.23456", (4026, 5)),
        // Not as the code that clamps C, with an R that would be the level of the next hole.
        ("M29 S500\nG84 Z-10 R-3 F2\nM19 R90", (4021, 1)),
    ] {
        assert_eq!(number(&[], text), Some(alarm), "{text}");
    }
    assert_eq!(number(&[("3720", "1799")], "M19"), Some((4875, 1)));
    assert_eq!(number(&[("3720", "1800")], "M19"), None);
    // A row is what it was: R says nothing to it.
    let row = &[("9401", "191010000000")];
    assert_eq!(number(row, "M19"), None);
    assert_eq!(number(row, "M19 R5"), Some((4028, 5)));
}
