//! Notation: spaces, case, line endings, comments, block skip, places.

use super::*;
use crate::units::Decimal;

#[test]
fn notation_makes_no_difference() {
    let plain = kinds("G0 X50 Z10\nG1 X40. Z-2.50 F100\nM30\n");
    for text in [
        "g0x50z10\ng1x40z-2.5f100\nm30",
        "G00X+50.Z010\r\nG01 X040 Z-02.500 F100.0\r\nM30\r\n",
        "N1 G0 X50 Z10;\nN2 G1 X40 Z-2.5 F100 ; (cut)\nN3 M30;",
        "(a) G0 (b) X50 (c(d)) Z10\n  \t G1\tX40 Z-2.5 F100\n\nM30",
        "G0 X50 Z10; G1 X40 Z-2.5 F100; M30",
        "\u{feff}%\nO0001\nG0 X50 Z10\nG1 X40 Z-2.5 F100\nM30\n%",
        "Z10 X50 G0\nF100 Z-2.5 X40 G1\nM30",
        "/G0 X50 Z10\nN2 /G1 X40 Z-2.5 F100\nM30",
    ] {
        assert_eq!(kinds(text), plain, "{text}");
    }
}

#[test]
fn skipped_blocks_do_nothing() {
    let options = Options {
        skip: true,
        ..Options::default()
    };
    let text = "/G0 X50 (a;b\u{29}\nN5 /nonsense ##; G0 Z1\n/G28\n";
    let (events, alarm) = read_with(text.as_bytes(), &Params::sheets(), options);
    assert_eq!(alarm, None);
    let [Event::Call(call)] = events[..] else {
        panic!("{events:?}")
    };
    assert_eq!(
        (call.kind, call.span),
        (CallKind::Rapid(at(0, 10_000)), span(2, 18, 20))
    );
}

#[test]
fn comments_go_on_over_the_line_only_behind_a_block() {
    let text = "G0 X1; (one\ntwo (three)\n\nfour) Z1\nG0 X2";
    assert_eq!(
        kinds(text),
        [
            CallKind::Rapid(at(10_000, 0)),
            CallKind::Rapid(at(10_000, 10_000)),
            CallKind::Rapid(at(20_000, 10_000))
        ]
    );
    let open = alarm("G0 X1 (one\ntwo)");
    assert_eq!((open.number(), open.span), (4007, span(1, 7, 8)));
    // Closed by the wrong parenthesis is not closed.
    let open = alarm("G0 X1; (one\nG1 Z5 (two)\n");
    assert_eq!((open.number(), open.span), (4007, span(1, 8, 9)));
}

#[test]
fn places_count_bytes_from_one() {
    let call = calls("\n  G00 X1\n  X2 Z3 M8")[0];
    assert_eq!(call.span, span(2, 3, 6));
    let all = calls("\n  G00 X1\n  X2 Z3 M8");
    assert_eq!((all[1].span, all[2].span), (span(3, 9, 11), span(3, 3, 5)));
    let alarm = alarm("(攻丝) G01 X10. Q-5.25 F1");
    assert_eq!((alarm.span, alarm.word), (span(1, 19, 25), Some(b'Q')));
}

#[test]
fn lines_have_a_limit() {
    let fits = std::format!("G0 X1{}", " ".repeat(MAX_LINE - 5));
    assert_eq!(fits.len(), MAX_LINE);
    assert_eq!(kinds(&std::format!("{fits}\nG0 X2")).len(), 2);
    assert_eq!(kinds(&fits).len(), 1);
    let long = alarm(&std::format!("{fits} \nG0 X2"));
    assert_eq!((long.number(), long.span), (4006, span(1, 1025, 1026)));
    // What is complete in front of the cut is done.
    let (events, _) = read(&std::format!("G0 X1; {}", " ".repeat(MAX_LINE)));
    assert_eq!(events.len(), 1);
}

#[test]
fn a_line_holds_one_line() {
    let params = Params::sheets();
    let mut interpreter = Interpreter::new(&params, Options::default());
    assert_eq!(interpreter.line(b"G0 X1\r\n", 1, &mut |_| ()), Ok(()));
    let alarm = interpreter
        .line(b"G0 X1\nG0 X2", 2, &mut |_| ())
        .unwrap_err();
    assert_eq!(alarm.number(), 4001);
    // After an alarm nothing more is read.
    let mut count = 0;
    assert_eq!(interpreter.line(b"G0 X3", 3, &mut |_| count += 1), Ok(()));
    assert_eq!(count, 0);
}

#[test]
fn words_are_a_block_like_a_written_one() {
    let params = Params::sheets();
    for text in [
        "N7 G1 X40.5 Z-2 F100 M8",
        "G0 X1 X2",
        "G1 X5",
        "O5",
        "A1",
        "T0102",
        "M30",
        "",
    ] {
        let mut written = Interpreter::new(&params, Options::default());
        let mut given = written.clone();
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        let end = written.line(text.as_bytes(), 3, &mut |event| expected.push(event));
        let mut column = 1;
        let words = text.split_terminator(' ').map(|word| {
            let place = span(3, column, column + word.len() as u16);
            column = place.end + 1;
            let (number, rest) = Decimal::parse(&word.as_bytes()[1..]);
            assert!(rest.is_empty());
            (word.as_bytes()[0], number, place)
        });
        let same = given.words(3, words, &mut |event| found.push(event));
        assert_eq!((found, same), (expected, end), "{text}");
        assert_eq!(given.is_ended(), written.is_ended(), "{text}");
        assert_eq!(given.in_force(), written.in_force(), "{text}");
        let more = given.words(4, [], &mut |event| panic!("{event:?}"));
        assert_eq!(more, Ok(()), "{text}");
    }
}

#[test]
fn the_modal_state_is_that_of_the_blocks_so_far() {
    let params = Params::sheets();
    let mut interpreter = Interpreter::new(&params, Options::default());
    let now = interpreter.in_force();
    assert_eq!((now.motion, now.plane, now.system), (0, 18, 54));
    assert_eq!((now.per_turn, now.feed, now.speed), (false, None, 0));
    let text = b"G3 X0 R9 G17 G56 G99 F0.25 M3 S500";
    // An arc in the wrong plane is an alarm; what the block has set before stays.
    assert!(interpreter.line(text, 1, &mut |_| {}).is_err());
    let now = interpreter.in_force();
    assert_eq!((now.motion, now.plane, now.system), (3, 17, 56));
    assert!(now.per_turn && now.speed == 500);
    let feed = now.feed.map(FeedRate::nominal);
    assert_eq!(feed.map(|feed| feed.nm_per_min()), Some(125_000_000));
}

/// The same blocks as one text, and as texts that each go on after the one before.
#[test]
fn what_a_text_leaves_in_force_holds_in_the_next_and_makes_no_call() {
    let params = Params::sheets();
    for blocks in [
        &[
            "G0 X50 Z10",
            "X40",
            "G1 Z-2 F100",
            "X30",
            "M3 S500",
            "S600",
            "G3 X35 Z-4 R3",
            "M5 S1",
        ][..],
        &[
            "G20 G55 G99 T0102",
            "M4 S200",
            "G1 X1. Z-1. F0.01",
            "W-0.1",
            "G21 G1 U1 F0.3",
        ],
        &["G50 X20 Z5", "G0 X21", "T0303 G59", "X22", "G50 W3", "Z0"],
        &[
            "G96 S120 M3",
            "G50 S1500",
            "G0 X30",
            "X20",
            "G97",
            "X25",
            "G96 S100",
        ],
        // A cycle ends, and its words with it.
        &["G17", "G0 X50 Z2", "G1 F200", "G2 X60 Z2 R9 G18"],
    ] {
        let text = blocks.join("\n");
        let whole = calls(&text);
        let mut apart = Vec::new();
        let (mut carried, mut position) = (None, Position::ZERO);
        for (line, block) in (1..).zip(blocks) {
            let options = Options {
                position,
                ..Options::default()
            };
            let mut reader = Interpreter::new(&params, options);
            if let Some(carried) = &carried {
                reader.carry(carried);
            }
            let mut take = |event| match event {
                Event::Call(call) => apart.push(call),
                Event::Warning(warning) => panic!("{warning:?}"),
            };
            reader.line(block.as_bytes(), line, &mut take).unwrap();
            reader.finish(&mut take).unwrap();
            (carried, position) = (Some(reader.carried()), reader.position());
        }
        assert_eq!(apart, whole, "{text}");
    }
    let mut cycle = Interpreter::new(&params, Options::default());
    cycle.line(b"G90 X10 Z-5 F100", 1, &mut |_| {}).unwrap();
    assert_eq!((cycle.in_force().motion, cycle.carried().motion), (90, 0));
}
