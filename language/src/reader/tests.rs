//! Programs against the calls of the core.

use super::*;
use crate::reading::{self, Outcome};
use leadscrew_core::alarm::Arg;
use leadscrew_core::call::Position;
use leadscrew_core::offsets::Offsets;
use leadscrew_core::program::Events;
use leadscrew_core::units::{Angle, Length};

fn read_with(text: &str, params: &Params, options: Options) -> Outcome {
    reading::read(text, params, options, Rules::default())
}

fn read(text: &str) -> Outcome {
    read_with(text, &Params::sheets(), Options::default())
}

/// The same by the core alone.
fn alone(text: &str, params: &Params, options: Options) -> Outcome {
    let mut events = Vec::new();
    for event in Events::new(text.as_bytes(), params, options) {
        match event {
            Ok(event) => events.push(event),
            Err(alarm) => return (events, Some(alarm)),
        }
    }
    (events, None)
}

/// What a program does, without places.
fn kinds(text: &str) -> Vec<CallKind> {
    let (events, alarm) = read(text);
    assert_eq!(alarm, None, "{text}");
    let kind = |event| match event {
        Event::Call(call) => call.kind,
        Event::Warning(alarm) => panic!("{alarm:?} in {text}"),
    };
    events.into_iter().map(kind).collect()
}

#[test]
fn programs_without_macros_are_what_they_are_to_the_core() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "nc") {
            continue;
        }
        count += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        // All cut short, too: each of them has its own end or its own alarm.
        for end in (0..text.len())
            .filter(|end| text.is_char_boundary(*end))
            .chain([text.len()])
        {
            let text = &text[..end];
            let (params, options) = (Params::sheets(), Options::default());
            let (mut expected, found) = (alone(text, &params, options), read(text));
            // A `G9` that is cut off is a code that is refused by name.
            expected.1 = expected
                .1
                .map(|alarm| Control::default().in_own_codes(alarm));
            // A letter in front of a space is a word only with the number after it.
            if expected != found {
                let number = expected.1.map(|alarm| alarm.number());
                assert!(
                    matches!(number, Some(4003 | 4030)),
                    "{text}: {expected:?} {found:?}"
                );
            }
        }
    }
    assert!(count > 10, "{count} examples");
}

#[test]
fn a_calculated_word_does_what_the_written_one_does() {
    for (calculated, written) in [
        ("#1=12.3456\nG0 X#1 Z-#1", "\nG0 X12.3456 Z-12.3456"),
        ("#1=10/3\nG1 X#1 F[#1*30]", "\nG1 X3.3333 F100"),
        ("G20 G0 X[10/3]", "G20 G0 X3.33333"),
        ("#1=1;G#1 X5 F#1", "      G1  X5 F1 "),
        ("M[1+2] S[100*5]", "M3     S500"),
        ("#1=500;G4 P[#1+0.4]", "       G4 P500"),
        ("G4 X[1/3]", "G4 X.333"),
        ("C[1/3]\nH[2/3]", "C.3333\nH.6667"),
        ("G0 X[ROUND[1.23456]]", "G0 X1.2346"),
        ("G0 X#5 Z1", "G0     Z1"),
        (
            "#1=2000\nG0 X20 Z5\nG75 R.5\nG75 X10 Z-9 P#1 Q[#1*1.5] F50",
            "\nG0 X20 Z5\nG75 R.5\nG75 X10 Z-9 P2000 Q3000 F50",
        ),
        (
            "#1=20560\nG0 X80 Z10\nG76 P#1 Q1500 R.1",
            "\nG0 X80 Z10\nG76 P20560 Q1500 R.1",
        ),
        ("G65 H01 P#1 Q123450\nG0 X#1", "\nG0 X12.345"),
        (
            "G65 H01 P#1 Q500\nM3 S#1\nG1 X1 F#1\nG99 F#1",
            "\nM3 S500\nG1 X1 F500\nG99 F.05",
        ),
    ] {
        let calls = |(events, alarm): (Vec<Event>, Option<Alarm>)| {
            assert_eq!(alarm, None, "{calculated}");
            let kinds = events.into_iter().map(|event| match event {
                Event::Call(call) => (call.span.line, call.kind),
                Event::Warning(alarm) => panic!("{alarm:?}"),
            });
            kinds
                .map(|(line, kind)| (line, without_places(kind)))
                .collect::<Vec<_>>()
        };
        let (params, options) = (Params::sheets(), Options::default());
        let expected = calls(alone(written, &params, options));
        assert_eq!(calls(read(calculated)), expected, "{calculated}");
        assert!(expected.len() < 9);
    }
}

/// A call as text, without the columns of its words.
fn without_places(kind: CallKind) -> String {
    let text = format!("{kind:?}");
    let mut parts = text.split("span: Span {");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push_str(part.split_once('}').map_or(part, |(_, rest)| rest));
    }
    out
}

#[test]
fn an_alarm_of_the_core_has_the_columns_of_the_text() {
    for (text, number, line, column, end) in [
        ("#1=5\nG0 X#1 X[#1+1]", 4013, 2, 8, 15),
        ("G1 X[2*3]", 4034, 1, 1, 3),
        ("M8;#1=1;G0 A#1", 4012, 1, 12, 15),
        ("G[200+1]", 4018, 1, 1, 9),
        ("X[1E5]", 125, 1, 4, 5),
        ("X[POW[10,12]]", 4025, 1, 1, 14),
        ("S[-5]", 4024, 1, 1, 6),
        ("#4=1\nN5 G0 O#4", 4014, 2, 7, 10),
    ] {
        let alarm = read(text).1.unwrap_or_else(|| panic!("no alarm: {text}"));
        let span = alarm.span;
        assert_eq!(
            (alarm.number(), span.line, span.column, span.end),
            (number, line, column, end),
            "{text}"
        );
    }
}

#[test]
fn macros_can_ask_where_the_program_stands() {
    let at = |x: i64, z: i64| Position {
        x: Length::from_nm(x * 500_000),
        z: Length::from_nm(z * 1_000_000),
        c: Angle::ZERO,
    };
    assert_eq!(
        kinds("G0 X40 Z-7\nG0 X[#5001+2] Z[#5002-1]").last(),
        Some(&CallKind::Rapid(at(42, -8)))
    );
    assert_eq!(
        kinds("G50 X100 Z50\nG0 X#5021 Z#5022").last(),
        Some(&CallKind::Rapid(at(-100, -50)))
    );
    assert_eq!(
        kinds("O7\nN3 T0102 S500 G1 X0 F120\nG0 X[#4109+#4119+#4120] Z[#4115+#4114+#4001]").last(),
        Some(&CallKind::Rapid(at(722, 11)))
    );
    assert_eq!(
        kinds("G99\nG0 X#4005 Z#4006").last(),
        Some(&CallKind::Rapid(at(99, 21)))
    );
    assert_eq!(
        kinds("G20 G0 X1\nG21\nX#5001").last(),
        Some(&CallKind::Rapid(Position {
            x: Length::from_nm(12_700_000),
            ..Position::ZERO
        }))
    );
    for text in ["#5001=1", "#4001=1"] {
        assert_eq!(
            read(text).1.map(|alarm| alarm.number()),
            Some(116),
            "{text}"
        );
    }
    for text in ["#1=#3005", "#1=#2033", "#1=#5223", "#3005=1"] {
        assert_eq!(
            read(text).1.map(|alarm| alarm.number()),
            Some(115),
            "{text}"
        );
    }
}

#[test]
fn a_part_family_and_a_subprogram() {
    let text = "O1\nG0 X100 Z5\nM98 P20002\nG65 P3 A10. B4.\nM30\nO2\nG0 U-10.\nM99\nO3\n#3=0\nWHILE[#3LT#2]DO1\nG0 Z[#5002-#1]\n#3=#3+1\nEND1\nM99\n";
    let found: Vec<_> = kinds(text);
    let z: Vec<i64> = found
        .iter()
        .filter_map(|kind| match kind {
            CallKind::Rapid(to) => Some(to.z.nm() / 1_000_000),
            _ => None,
        })
        .collect();
    assert_eq!(z, [5, 5, 5, -5, -15, -25, -35]);
    assert_eq!(found.last(), Some(&CallKind::End(30)));
}

#[test]
fn the_end_of_the_text_is_minded_as_by_the_core() {
    assert_eq!(
        read("(open\n#1=3").1.map(|alarm| alarm.number()),
        Some(4007)
    );
    let (events, alarm) = read("G0 X5\nM99");
    assert_eq!((events.len(), alarm), (2, None));
    assert!(matches!(events[1], Event::Warning(alarm) if alarm.number() == 4992));
}

/// A machine with IS-B, as the worked cases are written for.
fn is_b() -> Params {
    let mut params = Params::sheets();
    let entry = leadscrew_core::params::Entry::find_text("1004.1").expect("a parameter");
    params.set(entry, 0).expect("in range");
    params
}

/// The moves of a program after its first, X as a diameter: `R` rapid, `F` feed, `A` arc with its radius and direction.
fn moves(text: &str) -> String {
    let (events, alarm) = read_with(text, &is_b(), Options::default());
    assert_eq!(alarm, None, "{text}");
    let figure = |nm: i64| {
        let text = format!("{:.6}", nm as f64 / 1e6);
        let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
        if text == "-0" { "0".to_owned() } else { text }
    };
    let mut at = Position::ZERO;
    let mut list = Vec::new();
    for event in events {
        let Event::Call(call) = event else { continue };
        let (letter, to, round) = match call.kind {
            CallKind::Rapid(to) => ('R', to, String::new()),
            CallKind::Line(to, _) => ('F', to, String::new()),
            CallKind::Arc(arc) => {
                let radius = (arc.i.nm() as f64).hypot(arc.k.nm() as f64).round();
                let way = if arc.clockwise { "cw" } else { "ccw" };
                ('A', arc.end, format!("/{}{way}", figure(radius as i64)))
            }
            _ => continue,
        };
        if to != at {
            let (x, z) = (figure(to.x.nm() * 2), figure(to.z.nm()));
            list.push(format!("{letter}{x},{z}{round}"));
        }
        at = to;
    }
    list.remove(0);
    list.join(" ")
}

const SHAFT: &str = "N1 G0 X20\nG1 Z-10\nX24 Z-20\nX36\nN2 X40 Z-21\n";

#[test]
fn roughing_along_z_reads_its_contour() {
    let text = format!("G98 F100\nG0 X40 Z2\nG71 U3 R0.5\nG71 P1 Q2 U0.4 W0.1\n{SHAFT}");
    assert_eq!(
        moves(&text),
        "R40.4,2.1 R34.4,2.1 F34.4,-19.9 F35.4,-19.4 R35.4,2.1 R28.4,2.1 F28.4,-19.9 F29.4,-19.4 R29.4,2.1 \
         R22.4,2.1 F22.4,-14.9 F23.4,-14.4 R23.4,2.1 R20.4,2.1 F20.4,-9.9 F24.4,-19.9 F36.4,-19.9 F40.4,-20.9 R40,2"
    );
    let bore = "G98 F100\nG0 X16 Z2\nG71 U2 R0.5\nG71 P1 Q2 U-0.4 W0.1\nN1 G0 X28\nG1 Z-10\nX24\nZ-20\nN2 X16\n";
    assert_eq!(
        moves(bore),
        "R15.6,2.1 R19.6,2.1 F19.6,-19.9 F18.6,-19.4 R18.6,2.1 R23.6,2.1 F23.6,-19.9 F22.6,-19.4 R22.6,2.1 \
         R27.6,2.1 F27.6,-9.9 F23.6,-9.9 F23.6,-19.9 F15.6,-19.9 R16,2"
    );
}

#[test]
fn roughing_across_and_in_copies() {
    let face =
        "G98 F100\nG0 X60 Z2\nG72 W2 R0.5\nG72 P1 Q2 U0 W0.1\nN1 G0 Z-6\nG1 X40\nZ-3\nX20\nN2 Z1\n";
    assert_eq!(
        moves(face),
        "R60,2.1 R60,0.1 F20,0.1 F21,0.6 R60,0.6 R60,-1.9 F20,-1.9 F21,-1.4 R60,-1.4 R60,-3.9 F40,-3.9 F41,-3.4 \
         R60,-3.4 R60,-5.9 F40,-5.9 F40,-2.9 F20,-2.9 F20,1.1 R60,2"
    );
    let copies = "G98 F100\nG0 X50 Z5\nG73 U3 W1 R3\nG73 P1 Q2 U0.4 W0.2\nN1 G0 X20 Z0\nG1 Z-10\nG2 X30 Z-15 R5\nN2 G1 X40\n";
    assert_eq!(
        moves(copies),
        "R56.4,6.2 R26.4,1.2 F26.4,-8.8 A36.4,-13.8/5cw F46.4,-13.8 R53.4,5.7 R23.4,0.7 F23.4,-9.3 A33.4,-14.3/5cw \
         F43.4,-14.3 R50.4,5.2 R20.4,0.2 F20.4,-9.8 A30.4,-14.8/5cw F40.4,-14.8 R50,5"
    );
}

#[test]
fn finishing_cuts_the_contour_as_it_is_written() {
    let text = format!("G98 F100\nG0 X40 Z2\nG71 U3 R0.5\nG71 P1 Q2 U0.4 W0.1\n{SHAFT}G70 P1 Q2\n");
    let all = moves(&text);
    assert!(
        all.ends_with("R40,2 R20,2 F20,-10 F24,-20 F36,-20 F40,-21 R40,2"),
        "{all}"
    );
}

/// The second tool has a contour with the numbers of the first.
#[test]
fn finishing_takes_the_contour_that_was_roughed_last() {
    let first = "G98 F100\nG0 X42 Z2\nG71 U5 R.5\nG71 P10 Q20 U.4 W.1\nN10 G0 X20\nG1 Z-10\nN20 X42\nG70 P10 Q20\n";
    let second =
        "G0 X16 Z2\nG71 U5 R.5\nG71 P10 Q20 U-.4 W.1\nN10 G0 X24\nG1 Z-8\nN20 X16\nG70 P10 Q20\n";
    let only = |text: &str| moves(&text.replace("N10", "N1").replace("P10", "P1"));
    let (one, other) = (only(first), only(&format!("G98 F100\n{second}")));
    let place = other.find("R15.6").unwrap();
    let both = format!("{one} R16,2 {}", &other[place..]);
    assert_eq!(moves(&format!("{first}{second}M30\n")), both);
    // A block of the first lines has the number of the contour.
    let header = format!("N10 G21 G40\nN20 G97\n{first}");
    assert_eq!(moves(&header), one);
    // Q is the first of its number behind the block of P.
    let behind = "G98 F100\nG0 X42 Z2\nG70 P10 Q20\nM30\nN20 X1\nN10 G0 X20\nG1 Z-10\nN20 X42\n";
    assert_eq!(moves(behind), "R20,2 F20,-10 F42,-10 R42,2");
}

#[test]
fn a_contour_whose_number_stands_twice_is_refused_where_nothing_was_roughed() {
    let told = |text: &str| {
        let alarm = read_with(text, &is_b(), Options::default()).1?;
        let lines = [alarm.args[1], alarm.args[2]];
        Some((alarm.number(), alarm.span.line, lines))
    };
    let contour = "N10 G0 X20\nG1 Z-10\nN20 X42\n";
    let start = "G98 F100\nG0 X42 Z2\n";
    let twice = |line, one, other| Some((4876, line, [Arg::Int(one), Arg::Int(other)]));
    let text = format!("{start}G70 P10 Q20\nG0 X50\n{contour}M1\nN10 G0 X30\nM30");
    assert_eq!(told(&text), twice(3, 5, 9));
    let text = format!("O1\nN10 G21\nN20 G97\n{start}{contour}G71 U2 R1\nG71 P10 Q20 U.4\nM30");
    assert_eq!(told(&text), twice(10, 2, 6));
    // Another program of the file has numbers of its own.
    let text = format!("O1\n{start}G70 P10 Q20\nM30\n{contour}O2\n{contour}M99");
    assert_eq!(told(&text), None);
}

#[test]
fn a_cycle_without_its_contour_is_refused() {
    let refused = |text: &str| {
        read_with(text, &is_b(), Options::default())
            .1
            .map(|alarm| alarm.number())
    };
    let before = "G98 F100\nG0 X40 Z2\nG71 U3 R0.5\n";
    assert_eq!(refused(&format!("{before}G71 P1 U1\n{SHAFT}")), Some(61));
    assert_eq!(refused(&format!("{before}G71 P1 Q9\n{SHAFT}")), Some(63));
    assert_eq!(refused(&format!("{before}G71 P2 Q1\n{SHAFT}")), Some(63));
    assert_eq!(
        refused("G98 F100\nG0 X40 Z2\nG71 U0\nG71 P1 Q2\nN1 G0 X20\nN2 G1 Z-5\n"),
        Some(62)
    );
    assert_eq!(
        refused("G98 F100\nG0 X40 Z2\nG71 P1 Q2\nN1 G0 X20\nM98 P5\nN2 G1 Z-5\n"),
        Some(66)
    );
    assert_eq!(
        refused("G98 F100\nG0 X40 Z2\nG71 P1 Q2\nN1 G1 Z-5\nN2 X30\n"),
        Some(65)
    );
}

/// The radius of X, Z of the first rapid, in 0.1 µm, and the table that a program leaves.
fn ends(text: &str) -> (Vec<(i64, i64)>, Option<Offsets>) {
    let params = Params::sheets();
    let (kept, rules) = (Kept::default(), Rules::default());
    let mut reader = Reader::new(text.as_bytes(), &params, Options::default(), kept, rules);
    let mut ends = Vec::new();
    while !reader.is_over() {
        reader
            .step(&mut |event| {
                if let Event::Call(call) = event
                    && let CallKind::Rapid(to) = call.kind
                {
                    ends.push((to.x.nm() / 100, to.z.nm() / 100));
                }
            })
            .unwrap_or_else(|trouble| panic!("{trouble:?} in {text}"));
    }
    (ends, reader.interpreter().written_offsets().copied())
}

#[test]
fn variables_of_the_table_are_read_and_written_as_by_g10() {
    for (by_variables, by_g10) in [
        ("#2003=.1\n#2103=-.2", "G10 P3 X.1 Z-.2"),
        (
            "#2703=-50\n#2803=7.5\n#2903=.4\n#2303=3",
            "G10 P10003 X-50 Z7.5 R.4 Q3",
        ),
        ("#5201=1\n#5202=2", "G10 P0 X1 Z2"),
        ("#5221=1\n#5322=2", "G10 L2 P1 X1\nG10 L2 P6 Z2"),
        ("G20\n#2003=.1", "G20\nG10 P3 X.1"),
        ("#1=3\n#[2000+#1]=#[2000+#1]+.05", "G10 P3 U.05"),
        ("#2=10003\nG10 P#2 R[.2+.2] Q[1+2]", "G10 P10003 R.4 Q3"),
    ] {
        let ((_, ours), (_, theirs)) = (ends(by_variables), ends(by_g10));
        assert_eq!(ours, theirs, "{by_variables}");
        assert!(ours.is_some());
    }
    let text = "G10 P10003 X4 Z5 R.4 Q3\nG10 P3 X.5\nG10 P0 Z1\nG10 L2 P2 X6\n\
        G0 X#2703 Z#2803\nX#2903 Z#2303\nX#2003 Z#5202\nX#5241 Z#2203";
    let expected = [(2, 5), (0, 3), (0, 1), (3, 0)];
    let shift = 10_000;
    let (found, _) = ends(text);
    let found: Vec<_> = found
        .iter()
        .map(|(x, z)| (x / 10_000, (z - shift) / 10_000))
        .collect();
    assert_eq!(found, expected);
    let number = |text| read(text).1.map(|alarm| (alarm.number(), alarm.span.line));
    assert_eq!(number("\n#2003=1000"), Some((4582, 2)));
    assert_eq!(number("#2203=1"), Some((116, 1)));
    assert_eq!(number("#2033=1"), Some((115, 1)));
}

#[test]
fn the_nose_is_that_of_the_table_after_g10() {
    let path = "G98 G42 G1 X20 Z0 F100\nZ-20\nX30\nG40 G0 X40 Z5\nM30";
    let written = format!("G0 X40 Z5 T0101\nG10 P10001 R.8 Q3\n{path}");
    let known = format!("G10 P10001 R.8 Q3\nG0 X40 Z5 T0101\n{path}");
    let other = format!("G10 P10001 R.4 Q3\nG0 X40 Z5 T0101\n{path}");
    let (written, known) = (kinds(&written), kinds(&known));
    assert_eq!(written, known);
    assert_ne!(written, kinds(&other));
}

/// Without a code of its own the first block would be a rapid in one cycle, and a cut in another.
#[test]
fn the_first_block_of_a_contour_has_its_own_motion() {
    let refused = |text: &str| {
        let alarm = read_with(text, &is_b(), Options::default()).1?;
        Some((alarm.number(), alarm.span.line))
    };
    let roughed = "G98 F100\nG0 X42 Z2\nG71 U2 R2\nG71 P1 Q2 U.4 W.1\n";
    for (first, cycle) in [
        ("N1 X20", "G71"),
        ("N1 X20 Z0", "G73"),
        ("N1 Z-9", "G72"),
        ("N1 G90 X20", "G71"),
    ] {
        let text = format!(
            "{}{first}\nG1 Z-10\nN2 X42\n",
            roughed.replace("G71", cycle).replace("G72 U2", "G72 W2")
        );
        assert_eq!(refused(&text), Some((65, 5)), "{text}");
    }
    for first in ["N1 G0 X20", "N1 G01 X20", "N1 G40 G00 X20", "N1 G#1 X20"] {
        let text = format!("#1=1\n{roughed}{first}\nG1 Z-10\nN2 X42\n");
        assert_eq!(refused(&text), None, "{text}");
    }
    // A block without a move is not the first one.
    let text = format!("{roughed}N1 F80\nG0 X20\nG1 Z-10\nN2 X42\n");
    assert_eq!(refused(&text), Some((65, 5)), "{text}");
    // G70 alone.
    assert_eq!(
        refused("G98 F100\nG0 X42 Z2\nG70 P1 Q2\nN1 X20\nG1 Z-10\nN2 X42\n"),
        Some((65, 4))
    );
}

#[test]
fn a_contour_writes_no_offsets() {
    let text =
        "G0 X40 Z5\nG71 U2 R1\nG71 P1 Q3 U1 W.1 F100\nN1 G0 X20\nN2 G10 P0 X1\nN3 G1 Z-20\nM30";
    let alarm = read(text).1.unwrap();
    assert_eq!(
        (alarm.number(), alarm.span.line),
        (Code::ContourWord.number(), 5)
    );
}

#[test]
fn what_stands_behind_a_percent_or_a_mark_in_a_block_is_read_as_by_the_core() {
    let options = Options {
        skip: true,
        ..Options::default()
    };
    let params = Params::sheets();
    for text in [
        // A comment after a block that is passed over.
        "/G0;%(a\nG0 X1",
        "/G0;%(a)\nG0 X1)",
        "/A;;%(a",
        // A second mark is none.
        "\u{feff}\u{feff}G0 X1",
        "\u{feff}G0 X1",
    ] {
        let expected = alone(text, &params, options);
        assert_eq!(read_with(text, &params, options), expected, "{text}");
    }
}
