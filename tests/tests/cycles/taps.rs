//! Taps: the sheet's three programs and the worked case, every form move by move, and refusals.

use std::num::NonZeroU8;

use leadscrew_core::call::*;
use leadscrew_core::cycle::*;
use leadscrew_core::motion::Course;
use leadscrew_core::moves::*;
use leadscrew_core::params::{Entry, Params, Writing};
use leadscrew_core::program::*;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::*;

use crate::build::*;

/// The sheet's hole: Z−50 from Z0 at F2000 S1000.
fn hole() -> TapCall {
    let here = point(50.0, 0.0);
    TapCall {
        cycle: TapCycle::G84,
        mode: TapMode::Rigid,
        axis: TapAxis::Z,
        start: here,
        hole: here,
        step: Position::ZERO,
        level: at(Length::ZERO),
        bottom: word(mm(-50.0), 30),
        form: TapForm::Standard,
        dwell: Millis::new(3000),
        lead: at(Lead::new(nm(2000.0), 1000).unwrap()),
        hand: HandChoice::Signal,
        speed: CentiRpm::new(100_000),
        extract: CentiRpm::new(100_000),
        spindle: SpindleChoice::default(),
        repeat: holes(1),
        clamp: None,
        continues: false,
        notes: TapNotes::default(),
    }
}

pub fn holes(count: u8) -> TapRepeat {
    TapRepeat::Holes(NonZeroU8::new(count).unwrap())
}

fn peck(q: f64, d: f64) -> TapPeck {
    TapPeck {
        infeed: word(mm(q), 40),
        back: word(mm(d), 50),
    }
}

pub fn moves(call: &TapCall) -> Vec<Move> {
    TapMoves::new(call, Signals::default(), place(1))
        .unwrap()
        .collect()
}

pub fn tap_of(m: &Move) -> Option<TapMove> {
    match m.kind {
        MoveKind::Tap(tap) => Some(tap),
        _ => None,
    }
}

/// Stage and depth below R, in micrometres, of every move.
fn depths(moves: &[Move]) -> Vec<(Stage, i64)> {
    let row = |m: &Move| {
        let tag = m.tag.unwrap();
        (tag.stage, tag.depth.nm() / 1000)
    };
    moves.iter().map(row).collect()
}

/// Synchronous travel of the tap axis.
fn travel(moves: &[Move], from: Length) -> i64 {
    let (mut at, mut sum) = (from, 0);
    for m in moves {
        if tap_of(m).is_some() {
            sum += (m.to.z - at).abs().nm();
        }
        at = m.to.z;
    }
    sum
}

fn infeeds(moves: &[Move]) -> usize {
    let is_infeed = |m: &&Move| m.tag.unwrap().stage == Stage::Tap;
    moves.iter().filter(is_infeed).count()
}

/// The moves of a program on the built-in machine with these numbers changed.
fn program(values: &[(&str, &str)], text: &str) -> Vec<Move> {
    let mut params = Params::sheets();
    for (key, value) in values {
        let entry = Entry::find_text(key).unwrap();
        let raw = entry.parse(value, Writing::UnitOptional).unwrap();
        params.set(entry, raw).unwrap();
    }
    let mut here = Position::ZERO;
    let mut list = Vec::new();
    for event in Events::new(text.as_bytes(), &params, Options::default()) {
        if let Event::Call(call) = event.unwrap_or_else(|alarm| panic!("{alarm:?}: {text}")) {
            for m in expand(&call, &Context::standing(here))
                .unwrap_or_else(|alarm| panic!("{alarm:?}: {text}"))
            {
                here = m.to;
                list.push(m);
            }
        }
    }
    list
}

fn in_hole(moves: &[Move]) -> Vec<Move> {
    let mine = moves.iter().filter(|m| m.tag.is_some());
    mine.copied().collect()
}

#[test]
fn the_sheets_standard_hole() {
    let text = "G98;\nG0 X50 Z0;\nM29 S1000;\nG84 Z-50 P3000 F2000;\nG80;\nM30;\n";
    let list = in_hole(&program(&[], text));
    assert_eq!(
        depths(&list),
        [
            (Stage::Tap, 50_000),
            (Stage::Dwell, 50_000),
            (Stage::Extract, 0)
        ]
    );
    let (down, up) = (tap_of(&list[0]).unwrap(), tap_of(&list[2]).unwrap());
    assert_eq!(
        list[0].to,
        Position {
            c: Angle::ZERO,
            ..point(50.0, -50.0)
        }
    );
    assert_eq!(list[1].kind, MoveKind::Dwell(Millis::new(3000)));
    assert_eq!(
        [down.turns.micro(), up.turns.micro()],
        [25_000_000, -25_000_000]
    );
    assert_eq!([down.speed.get(), up.speed.get()], [100_000, -100_000]);
    assert_eq!(
        (down.opens, down.closes, down.outward),
        (true, false, false)
    );
    assert_eq!((up.opens, up.closes, up.outward), (false, true, true));
    assert_eq!((down.level, down.bottom), (Length::ZERO, mm(-50.0)));
    assert_eq!(down.lead, lead(2.0));
}

#[test]
fn the_sheets_pecks() {
    let text = "G98;\nG0 X50 Z0;\nM29 S1000;\nG84 Z-50 Q4.0 P3000 F2000;\nG80;\nM30;\n";
    for (deep, millimetres) in [("0", 124), ("1", 724)] {
        let list = in_hole(&program(&[("5200.5", deep)], text));
        assert_eq!(infeeds(&list), 13);
        assert_eq!(travel(&list, Length::ZERO), millimetres * 1_000_000);
        let numbers = list.iter().map(|m| m.tag.unwrap().peck);
        let numbers: Vec<_> = numbers.filter(|n| *n != 0).collect();
        assert_eq!(numbers, (1..=13).collect::<Vec<_>>());
        assert_eq!(
            depths(&list)[list.len() - 3..],
            [
                (Stage::Tap, 50_000),
                (Stage::Dwell, 50_000),
                (Stage::Extract, 0)
            ]
        );
    }
    let high = in_hole(&program(&[], text));
    assert_eq!(
        depths(&high)[..4],
        [
            (Stage::Tap, 4_000),
            (Stage::Retract, 3_000),
            (Stage::Tap, 8_000),
            (Stage::Retract, 7_000)
        ]
    );
    let deep = in_hole(&program(&[("5200.5", "1")], text));
    assert_eq!(
        depths(&deep)[..6],
        [
            (Stage::Tap, 4_000),
            (Stage::Retract, 0),
            (Stage::Reenter, 3_000),
            (Stage::Tap, 8_000),
            (Stage::Retract, 0),
            (Stage::Reenter, 7_000)
        ]
    );
}

/// What the tick goes through in an ordinary tap is what the cycle says, leg for leg.
#[test]
fn the_legs_of_an_ordinary_tap_are_the_moves_of_the_cycle() {
    let nm = Length::from_nm;
    for (q, d) in [
        (4_000_000, 1_000_000),
        (4_000_000, 0),
        (4_000_000, 4_000_000),
        (15_000_000, 1),
        (7_500_000, 7_499_999),
        (99_000_000, 3),
    ] {
        let peck = TapPeck {
            infeed: at(nm(q)),
            back: at(nm(d)),
        };
        for form in [
            TapForm::Standard,
            TapForm::HighSpeed(peck),
            TapForm::Deep(peck),
        ] {
            for dwell in [0, 250] {
                let call = TapCall {
                    mode: TapMode::Floating,
                    bottom: at(nm(-15_000_000)),
                    form,
                    dwell: Millis::new(dwell),
                    ..hole()
                };
                let inside: Vec<Length> = moves(&call)
                    .iter()
                    .filter(|m| matches!(m.kind, MoveKind::Tap(_) | MoveKind::Dwell(_)))
                    .map(|m| call.level.value - m.to.z)
                    .collect();
                let course = Course::new(nm(15_000_000), &form, dwell);
                assert_eq!(course.depths().collect::<Vec<_>>(), inside, "{form:?}");
            }
        }
    }
}

#[test]
fn the_way_to_a_hole_and_back() {
    let start = point(80.0, 5.0);
    let call = TapCall {
        start,
        hole: point(50.0, 5.0),
        level: at(mm(2.0)),
        bottom: at(mm(-10.0)),
        clamp: Some(10),
        repeat: holes(2),
        step: Position {
            x: dia(-4.0),
            z: Length::ZERO,
            c: Angle::from_udeg(7),
        },
        ..hole()
    };
    let list = moves(&call);
    let rows: Vec<_> = list
        .iter()
        .map(|m| {
            (
                m.tag.unwrap().pass,
                m.tag.unwrap().stage,
                m.tag.unwrap().depth.nm() / 1_000_000,
            )
        })
        .collect();
    let of_hole = |pass| {
        [
            (pass, Stage::Approach, -3),
            (pass, Stage::Clamp, -3),
            (pass, Stage::RPlane, 0),
            (pass, Stage::Tap, 12),
            (pass, Stage::Dwell, 12),
            (pass, Stage::Extract, 0),
            (pass, Stage::Return, -3),
            (pass, Stage::Unclamp, -3),
        ]
    };
    assert_eq!(rows, [of_hole(1), of_hole(2)].concat());
    let codes: Vec<_> = list
        .iter()
        .filter_map(|m| match m.kind {
            MoveKind::Aux(Aux::M(code)) => Some(code),
            _ => None,
        })
        .collect();
    assert_eq!(codes, [10, 11, 10, 11]);
    assert_eq!([list[0].to, list[6].to], [call.hole; 2]);
    let second = Position {
        x: dia(46.0),
        z: mm(5.0),
        c: Angle::from_udeg(12 + 7),
    };
    assert_eq!([list[8].to, list[14].to], [second; 2]);
    let opened: Vec<_> = list
        .iter()
        .filter_map(tap_of)
        .map(|tap| tap.opens)
        .collect();
    assert_eq!(opened, [true, false, true, false]);
}

#[test]
fn the_hand_turns_it_round() {
    let left = TapCall {
        hand: HandChoice::Written(Hand::Left),
        form: TapForm::Deep(peck(20.0, 5.0)),
        ..hole()
    };
    let right = TapCall {
        hand: HandChoice::Signal,
        ..left
    };
    for (l, r) in moves(&left).iter().zip(moves(&right)) {
        let (Some(l), Some(r)) = (tap_of(l), tap_of(&r)) else {
            continue;
        };
        assert_eq!((l.turns, l.speed), (r.turns.reversed(), r.speed.reversed()));
        assert_eq!(l.turns.micro().signum(), i64::from(l.speed.get().signum()));
        assert_eq!(l.outward, l.speed.get() > 0);
    }
}

#[test]
fn the_override_is_for_retracts_and_the_way_in_again() {
    let call = TapCall {
        extract: CentiRpm::new(150_000),
        form: TapForm::Deep(peck(20.0, 5.0)),
        ..hole()
    };
    for m in moves(&call) {
        let Some(tap) = tap_of(&m) else { continue };
        let expected = match m.tag.unwrap().stage {
            Stage::Tap => 100_000,
            Stage::Reenter => 150_000,
            _ => -150_000,
        };
        assert_eq!(tap.speed.get(), expected);
    }
}

#[test]
fn a_side_tap_is_on_the_radius() {
    let text = "G98 G0 X60 Z-10\nM29 S500\nG88 Z-20 R-5 X20 F500 Q8\nG80";
    let list = in_hole(&program(&[], text));
    assert_eq!(
        depths(&list),
        [
            (Stage::Approach, -5_000),
            (Stage::RPlane, 0),
            (Stage::Tap, 8_000),
            (Stage::Retract, 7_000),
            (Stage::Tap, 15_000),
            (Stage::Extract, 0),
            (Stage::Return, -5_000)
        ]
    );
    assert_eq!(
        list[4].to,
        Position {
            c: Angle::ZERO,
            ..point(20.0, -20.0)
        }
    );
    let turns: Vec<_> = list
        .iter()
        .filter_map(tap_of)
        .map(|tap| tap.turns.micro())
        .collect();
    assert_eq!(turns, [8_000_000, -1_000_000, 8_000_000, -15_000_000]);
}

#[test]
fn a_bolt_circle() {
    let text = "G98 G0 X40 Z5\nM29 S1000\nG84 C0 Z-12 R-3 F1000 M10\nC90\nC180\nC270\nG80";
    let list = in_hole(&program(&[], text));
    // The first hole is where the C axis stands: no approach.
    assert_eq!(list.len(), 6 + 3 * 7);
    let angles: Vec<_> = list
        .iter()
        .filter(|m| m.tag.unwrap().stage == Stage::Tap)
        .map(|m| m.to.c.udeg() / 1_000_000)
        .collect();
    assert_eq!(angles, [0, 90, 180, 270]);
}

#[test]
fn k198_stays_and_goes_on() {
    let text =
        "G98 G0 X40 Z5\nM29 S1000\nG84 X20 Z-7 R-3 F1000 Q4 M10 K198\nG4 P100\nG84 Z-13 P50\nG80";
    let list = program(&[("5200.5", "1")], text);
    let list = in_hole(&list);
    assert_eq!(
        depths(&list),
        [
            (Stage::Approach, -3_000),
            (Stage::Clamp, -3_000),
            (Stage::RPlane, 0),
            (Stage::Tap, 4_000),
            (Stage::Retract, 0),
            (Stage::Reenter, 3_000),
            (Stage::Tap, 8_000),
            (Stage::Retract, 0),
            (Stage::Reenter, 7_000),
            (Stage::Tap, 9_000),
            (Stage::Tap, 12_000),
            (Stage::Retract, 0),
            (Stage::Reenter, 11_000),
            (Stage::Tap, 15_000),
            (Stage::Dwell, 15_000),
            (Stage::Extract, 0),
            (Stage::Return, -3_000),
            (Stage::Unclamp, -3_000)
        ]
    );
    let flags: Vec<_> = list
        .iter()
        .filter_map(tap_of)
        .map(|tap| (tap.opens, tap.closes))
        .collect();
    assert_eq!(flags[0], (true, false));
    assert_eq!(*flags.last().unwrap(), (false, true));
    assert!(
        flags[1..flags.len() - 1]
            .iter()
            .all(|f| *f == (false, false))
    );
    // The turns of the whole hole come back to where they began.
    let turns: i64 = list
        .iter()
        .filter_map(tap_of)
        .map(|tap| tap.turns.micro())
        .sum();
    assert_eq!(turns, 0);
}

#[test]
fn what_cannot_be_tapped() {
    let refused = |call: &TapCall| {
        let alarm = TapMoves::new(call, Signals::default(), place(1)).unwrap_err();
        (alarm.number(), alarm.word, alarm.span.column)
    };
    let z = |level, bottom| TapCall {
        level: word(mm(level), 20),
        bottom: word(mm(bottom), 30),
        ..hole()
    };
    // At R, and on the side of the initial level; without an R both sides are right.
    assert_eq!(refused(&z(0.0, 0.0)), (207, Some(b'Z'), 30));
    assert_eq!(refused(&z(-2.0, -2.0)), (207, Some(b'Z'), 30));
    assert_eq!(refused(&z(-2.0, -1.0)), (207, Some(b'Z'), 30));
    assert_eq!(refused(&z(2.0, -50.0)), (207, Some(b'Z'), 30));
    assert_eq!(moves(&z(0.0, 50.0)).len(), 3);
    assert_eq!(moves(&z(2.0, 50.0)).len(), 5);
    let side = TapCall {
        axis: TapAxis::X,
        level: at(dia(50.0)),
        bottom: word(dia(50.0), 30),
        ..hole()
    };
    assert_eq!(refused(&side), (207, Some(b'X'), 30));
    // d above q.
    for form in [TapForm::HighSpeed, TapForm::Deep] {
        let with = |q, d| TapCall {
            form: form(peck(q, d)),
            ..hole()
        };
        assert_eq!(refused(&with(4.0, 4.0001)), (207, Some(b'D'), 50));
        assert_eq!(infeeds(&moves(&with(4.0, 4.0))), 13);
        assert_eq!(infeeds(&moves(&with(4.0, 0.0))), 13);
        assert_eq!(infeeds(&moves(&with(0.0051, 0.0))), 9804);
        assert_eq!(refused(&with(0.005, 0.0)), (4130, Some(b'Q'), 40));
        assert_eq!(refused(&with(0.0, 0.0)), (4110, Some(b'Q'), 40));
        assert_eq!(refused(&with(4.0, -0.1)), (4110, Some(b'D'), 50));
    }
    let far = Length::from_nm((1 << 42) + 1);
    let too_far = |call: TapCall| assert_eq!(refused(&call).0, 4110);
    too_far(TapCall {
        bottom: at(-far),
        ..hole()
    });
    too_far(TapCall {
        level: at(far),
        ..hole()
    });
    too_far(TapCall {
        step: Position {
            x: far,
            ..Position::ZERO
        },
        ..hole()
    });
    // What no program makes.
    for call in [
        TapCall {
            speed: CentiRpm::new(0),
            ..hole()
        },
        TapCall {
            extract: CentiRpm::new(-1),
            ..hole()
        },
        TapCall {
            continues: true,
            ..hole()
        },
        TapCall {
            continues: true,
            start: point(50.0, -50.0),
            ..hole()
        },
    ] {
        assert_eq!(refused(&call), (4131, None, 1));
    }
}

/// Ordinary tapping makes the moves of rigid tapping, out at S; the spindle's own command comes before them, and none comes
/// after G80.
#[test]
fn an_ordinary_tap_makes_the_same_moves() {
    let text = "G98 M4 S400\nG0 X50 Z5\nG84 Z-10 R-4 Q6 D1 P200 F500 M10\nG80\nM30";
    let list = program(&[("5200.4", "1"), ("5211", "150")], text);
    assert!(matches!(list[0].kind, MoveKind::Spindle(_)));
    let cycle: Vec<Move> = list.iter().filter(|m| m.tag.is_some()).copied().collect();
    let expected = [
        (Stage::Clamp, -4_000),
        (Stage::RPlane, 0),
        (Stage::Tap, 6_000),
        (Stage::Retract, 5_000),
        (Stage::Tap, 11_000),
        (Stage::Dwell, 11_000),
        (Stage::Extract, 0),
        (Stage::Return, -4_000),
        (Stage::Unclamp, -4_000),
    ];
    assert_eq!(depths(&cycle), expected);
    // M04: left hand, minus on the way in; 1.25 mm a turn, out at S whatever the override says.
    let strokes: Vec<_> = cycle
        .iter()
        .filter_map(tap_of)
        .map(|tap| (tap.turns.micro(), tap.speed.get(), tap.opens, tap.closes))
        .collect();
    assert_eq!(
        strokes,
        [
            (-4_800_000, -40_000, true, false),
            (800_000, 40_000, false, false),
            (-4_800_000, -40_000, false, false),
            (8_800_000, 40_000, false, true),
        ]
    );
    // After the hole: M30 alone.
    assert!(matches!(
        list.last().map(|m| m.kind),
        Some(MoveKind::Aux(Aux::M(30)))
    ));
    assert_eq!(list.len(), cycle.len() + 3);
}
