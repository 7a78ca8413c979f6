//! Bad input and odd input: any byte string gives calls or an alarm, and how it arrives makes no difference.

use leadscrew_seed::Random;

use super::*;

/// Lines that together use every word.
const LINES: &[&str] = &[
    "(remark)",
    "G50 X100 Z50 M3 S300; (set)",
    "G04 X2;",
    "N10 G00 X80 Z10",
    "G01 X60.5 W-12.25 F150 M8",
    "G02 U20 W-10 R12.5 F100",
    "G3 U10 W-5 I0. K-5 F80",
    "G76 P020560 Q1500 R0.1 J1 K2;",
    "G76 X60.64 Z-62 P36800 Q18000 F6;",
    "G78 P020245 Q0.15 R0.5 D1 L2 E.5",
    "G78 X60 Z-60 R-1 P3 Q1.8 I8 J1.5 K2",
    "G75 R0.5 F150",
    "G75 X40 Z-50 P60000 Q30000 R.1",
    "G20 G55 T0102",
    "G21 G54 T0100 (two\u{ff08}levels\u{ff09})",
    "G53 X0 Z0",
    "/G99 G1 U-1 F.2",
    "G98 F100 G18 G40 G61 G80 G97",
    "G50 S2000",
    "G64",
    "G0 C90",
    "G1 H-5 F90",
    "G18 G98 M29 S1000\nG84 X30 Z-50 R-2 Q4 P500 D1 J1500 E2 M10 F2000\nC180\nG80",
    "G18 G98 M26 M29 S-500\nG84 H30 W-20 F1000 K3\nG80",
    "G18 G98 M29 S1000\nG88 Z-20 U-5 F1000 K198\nG4 P5\nG88 U-6\nG80",
    "G84 Z-60",
    "M1",
    "M5 M9",
    "M30",
];

const ALPHABET: &[u8] =
    b"GMXZUWCHPQRFIJKDLETNOS0123456789.-+;()/% \t\r\n#=%*a\xef\xbc\x88\x89\x00\xff";

fn program(random: &mut Random) -> Vec<u8> {
    let mut text = Vec::new();
    if random.index(2) == 0 {
        text.extend_from_slice(b"%\nO0013; (name)\n");
    }
    for _ in 0..random.index(40) {
        text.extend_from_slice(LINES[random.index(LINES.len() - 1)].as_bytes());
        text.extend_from_slice(if random.index(4) == 0 { b"\r\n" } else { b"\n" });
    }
    for _ in 0..random.index(3) {
        if text.is_empty() {
            break;
        }
        let at = random.index(text.len());
        match random.index(3) {
            0 => text[at] = ALPHABET[random.index(ALPHABET.len())],
            1 => text.insert(at, ALPHABET[random.index(ALPHABET.len())]),
            _ => drop(text.remove(at)),
        }
    }
    text
}

fn noise(random: &mut Random) -> Vec<u8> {
    (0..random.index(120))
        .map(|_| ALPHABET[random.index(ALPHABET.len())])
        .collect()
}

fn options(random: &mut Random) -> Options {
    Options {
        dialect: if random.index(4) == 0 {
            Dialect::Gsk988
        } else {
            Dialect::Gsk980td
        },
        skip: random.index(2) == 0,
        optional_stop: random.index(2) == 0,
        dry_run: random.index(4) == 0,
        passes_machine_codes: random.index(4) == 0,
        per_turn: random.index(8) == 0,
        limits_every_speed: random.index(4) == 0,
        position: at(500_000, 100_000),
        offsets: None,
        gear: random.index(3) as u8,
    }
}

/// What every alarm and call promises.
fn check(text: &[u8], events: &[Event], alarm: Option<Alarm>) {
    let lines = text.iter().filter(|byte| **byte == b'\n').count() as u32 + 1;
    let place = |span: Span| {
        assert!(span.line >= 1 && span.line <= lines, "{span:?} of {lines}");
        assert!(span.column >= 1 && span.end > span.column, "{span:?}");
        assert!(usize::from(span.end) <= MAX_LINE + 2, "{span:?}");
    };
    if let Some(alarm) = alarm {
        assert!(!alarm.code.is_warning());
        place(alarm.span);
    }
    let mut last = 0;
    for event in events {
        match event {
            Event::Warning(alarm) => {
                assert!(alarm.code.is_warning());
                place(alarm.span);
            }
            Event::Call(call) => {
                place(call.span);
                assert!(call.span.line >= last);
                last = call.span.line;
                assert!(alarm.is_none_or(
                    |alarm| alarm.span.line >= last || matches!(alarm.number(), 4007 | 4068)
                ));
                if let CallKind::Rapid(to) | CallKind::Line(to, _) = call.kind {
                    assert!(to.x.is_in_range() && to.z.is_in_range());
                }
            }
        }
    }
}

/// The same through the stream reader, cut into random pieces.
fn in_pieces(text: &[u8], options: Options, random: &mut Random) -> (Vec<Event>, Option<Alarm>) {
    let params = Params::sheets();
    let mut reader = Reader::new(&params, options);
    let mut events = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let most = 1 + random.index(200);
        let size = 1 + random.index(rest.len().min(most));
        let (piece, tail) = rest.split_at(size);
        rest = tail;
        if let Err(alarm) = reader.push(piece, &mut |event| events.push(event)) {
            return (events, Some(alarm));
        }
    }
    let alarm = reader.finish(&mut |event| events.push(event)).err();
    (events, alarm)
}

#[test]
fn any_text_gives_calls_or_an_alarm_however_it_is_cut() {
    leadscrew_seed::volume(2024, |seed| {
        let mut random = Random(seed);
        let params = Params::sheets();
        let rounds = leadscrew_seed::amount(20_000, 300_000);
        let (mut clean, mut refused, mut done) = (0, 0, 0);
        for round in 0..rounds {
            let text = if round % 4 == 0 {
                noise(&mut random)
            } else {
                program(&mut random)
            };
            let options = options(&mut random);
            let (events, alarm) = read_with(&text, &params, options);
            check(&text, &events, alarm);
            done += events.len();
            if alarm.is_none() {
                clean += 1;
            } else {
                refused += 1;
            }
            let pieces = in_pieces(&text, options, &mut random);
            assert_eq!(
                pieces,
                (events, alarm),
                "{:?}",
                std::string::String::from_utf8_lossy(&text)
            );
        }
        // Neither side is empty, and programs come far, so that all of it was tested.
        assert!(
            clean > rounds / 20 && refused > rounds / 20 && done > 4 * rounds,
            "{clean} {refused} {done}"
        );
    });
}

#[test]
fn line_by_line_is_the_same_as_whole() {
    leadscrew_seed::volume(99, |seed| {
        let mut random = Random(seed);
        let params = Params::sheets();
        for _ in 0..5_000 {
            let text = program(&mut random);
            let options = options(&mut random);
            let mut interpreter = Interpreter::new(&params, options);
            let mut events = Vec::new();
            let mut failure = None;
            for (index, line) in text.split_inclusive(|byte| *byte == b'\n').enumerate() {
                let read =
                    interpreter.line(line, index as u32 + 1, &mut |event| events.push(event));
                if let Err(alarm) = read {
                    failure = Some(alarm);
                    break;
                }
            }
            let failure =
                failure.or_else(|| interpreter.finish(&mut |event| events.push(event)).err());
            assert_eq!((events, failure), read_with(&text, &params, options));
        }
    });
}

#[test]
fn spaces_and_case_make_no_difference() {
    leadscrew_seed::volume(5, |seed| {
        let mut random = Random(seed);
        for _ in 0..5_000 {
            let mut plain = std::string::String::new();
            let mut other = std::string::String::new();
            for _ in 0..1 + random.index(20) {
                let line = LINES[random.index(LINES.len() - 1)];
                if line.contains('(') || line.contains('%') {
                    continue;
                }
                plain.push_str(line);
                plain.push('\n');
                for word in line.split(' ') {
                    let spaces = random.index(3);
                    other.push_str(&" ".repeat(spaces));
                    if random.index(2) == 0 {
                        other.push_str(&word.to_ascii_lowercase());
                    } else {
                        other.push_str(word);
                    }
                }
                other.push_str(if random.index(2) == 0 { "\r\n" } else { "\n" });
            }
            let (first, second) = (read(&plain), read(&other));
            assert_eq!(
                first.1.map(|alarm| alarm.code),
                second.1.map(|alarm| alarm.code)
            );
            assert_eq!(first.0.len(), second.0.len());
            for (a, b) in first.0.iter().zip(&second.0) {
                match (a, b) {
                    (Event::Call(a), Event::Call(b)) => assert_eq!(
                        core::mem::discriminant(&a.kind),
                        core::mem::discriminant(&b.kind)
                    ),
                    (Event::Warning(a), Event::Warning(b)) => assert_eq!(a.code, b.code),
                    _ => panic!("{plain}{other}"),
                }
            }
        }
    });
}

#[test]
fn one_micron_of_text_is_one_micron_everywhere() {
    leadscrew_seed::volume(11, |seed| {
        // Inch text of a whole number of steps against the same length in millimetres.
        let mut random = Random(seed);
        for _ in 0..2_000 {
            let steps = random.index(1_000_000) as i64;
            let inch = std::format!("G20 G0 Z{}.{:05}", steps / 100_000, steps % 100_000);
            let (events, alarm) = read(&inch);
            assert_eq!(alarm, None);
            let Event::Call(call) = events[0] else {
                panic!()
            };
            let CallKind::Rapid(to) = call.kind else {
                panic!()
            };
            assert_eq!(to.z, Length::from_nm(steps * 254));
        }
    });
}
