//! Drilling against move lists worked out by hand.

use leadscrew_core::alarm::Arg;
use leadscrew_core::params::Params;
use leadscrew_core::program::Event;
use leadscrew_core::units::Length;

use super::{Hole, Step};
use crate::dialect::Control;
use crate::path::tests::moves_of;
use crate::reading::{Outcome, read_on, with};

fn read_with(sets: &[(&str, i64)], control: Control, text: &str) -> Outcome {
    read_on(&with(Params::slant_bed(), sets), control, text)
}

#[track_caller]
fn moves(sets: &[(&str, i64)], control: Control, text: &str) -> String {
    let (events, alarm) = read_with(sets, control, text);
    assert_eq!(alarm, None, "{text}");
    moves_of(&events)
}

fn refused(control: Control, text: &str) -> u16 {
    read_with(&[], control, text).1.expect(text).number()
}

/// Its R would be the level of the next hole.
#[test]
fn no_angle_of_the_spindle_between_two_holes() {
    let text = "G98 G0 X0 Z5;G83 Z-12 R-3 Q5000 P500 F100;M19 R90";
    for control in [Control::FanucA, Control::Gsk980td, Control::Haas] {
        assert_eq!(refused(control, text), 4021, "{control:?}");
        let (_, alarm) = read_with(&[], control, &text.replace("M19", "G80;M19"));
        assert_eq!(alarm, None, "{control:?}");
    }
}

#[test]
fn pecks_of_a_face_hole() {
    let text = "G98 G0 X0 Z5;G83 Z-12 R-3 Q5000 P500 F100;G80";
    let shallow = "R0,5 R0,2 F0,-3 R0,-2 F0,-8 R0,-7 F0,-12 D R0,5";
    assert_eq!(moves(&[], Control::FanucA, text), shallow);
    assert_eq!(moves(&[], Control::Gsk980td, text), shallow);
    let in_mm = text.replace("Q5000", "Q5.");
    assert_eq!(moves(&[], Control::Gsk988, &in_mm), shallow);
    assert_eq!(moves(&[("182.7", 1)], Control::Gsk980td, &in_mm), shallow);
    // R of a Haas is a coordinate.
    let haas = in_mm.replace("R-3", "R2.");
    let cleared = "R0,5 R0,2 F0,-3 R0,2 R0,-2 F0,-8 R0,2 R0,-7 F0,-12 D R0,5";
    let deep = [("5101.2", 1)];
    assert_eq!(moves(&deep, Control::FanucA, text), cleared);
    for set in [0, 1] {
        assert_eq!(
            moves(&[("5101.2", set)], Control::Haas, &haas),
            cleared,
            "{set}"
        );
    }
    // The clearance is not more than the depth so far.
    let wide = [("5114", 8_000_000)];
    let wide = moves(&wide, Control::FanucA, text);
    assert_eq!(wide, "R0,5 R0,2 F0,-3 R0,2 F0,-8 R0,0 F0,-12 D R0,5");
}

#[test]
fn holes_one_after_the_other() {
    // What is not written again stays; the place alone asks for the next hole.
    let text = "G98 G0 X40 Z5;G83 X40 C0 Z-5 R-3 F100;C90.;X20 K2;G80;X50";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R40,5 R40,5 R40,2 F40,-5 R40,5 R40,5 R40,2 F40,-5 R40,5 R20,5 R20,2 F20,-5 R20,5 R20,5 R20,2 F20,-5 R20,5 R50,5"
    );
    // The bottom as an increment counts from R; the code of motion goes on after G80.
    let text = "G98 G0 X0 Z5;G1 Z4 F50;G83 W-7 R-2 F100;G80;Z3";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R0,5 F0,4 R0,2 F0,-5 R0,4 F0,3"
    );
    // A motion ends the cycle.
    let text = "G98 G0 X0 Z5;G83 Z-5 R-3 F100;G0 X10;X20";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R0,5 R0,2 F0,-5 R0,5 R10,5 R20,5"
    );
}

/// What is not written again stays, with the code or without it.
#[test]
fn a_cycle_that_is_written_again_keeps_its_words() {
    for (control, first, again) in [
        (Control::FanucA, "G83 Z-10 R-3 Q5000 P200", "Z-20"),
        (Control::Gsk980td, "G83 Z-10 R-3 Q5000 P200", "Z-20"),
        (Control::FanucB, "G83 Z-10 R-3 Q5000 P200", "X10"),
        (Control::Haas, "G83 Z-10 R2 Q5 P200", "X4 Z-20"),
        (Control::Haas, "G83 Z-10 R2 Q5 P200", "X4 R1"),
        (Control::FanucB, "G82 Z-10 R-3 P200", "X10"),
    ] {
        let start = if control == Control::FanucB {
            "G94"
        } else {
            "G98"
        };
        let with = |code: &str| {
            let text = format!("{start} G0 X0 Z5;{first} F100;{code} {again};G80");
            moves(&[], control, &text)
        };
        assert_eq!(with(&first[..3]), with(""), "{first};{again}");
    }
    // One cycle keeps for another what it has no use for.
    let text = "G94 G0 X0 Z5;G83 Z-10 R-3 Q5000 P200 F100;G81 X10;G83 X20;G80";
    assert_eq!(
        moves(&[], Control::FanucB, text),
        "R0,5 R0,2 F0,-3 R0,-2 F0,-8 R0,-7 F0,-10 D R0,5 R10,5 R10,2 F10,-10 R10,5 \
         R20,5 R20,2 F20,-3 R20,-2 F20,-8 R20,-7 F20,-10 D R20,5"
    );
    // The bottom may come with the code that is written again; G80 and the other axis forget all.
    let text = "G98 G0 X0 Z5;G83 R-3 Q5000 F100;G83 Z-5;G80";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R0,5 R0,2 F0,-3 R0,-2 F0,-5 R0,5"
    );
    for text in [
        "G98 G0 X0 Z5;G83 Z-5 R-3 F100;G80;G83 X4",
        "G98 G0 X50 Z5;G83 Z-5 R-3 F100;G87 Z-3",
    ] {
        assert_eq!(refused(Control::FanucA, text), 4062, "{text}");
    }
}

/// Q of a FANUC counts increments wherever a cycle of holes reads it.
#[test]
fn pecks_of_a_fanuc_are_increments() {
    let text = "G98 G0 X0 Z5;G83 Z-5 R-3 Q5000 F100;X10 Q3000;G80";
    let pecked =
        "R0,5 R0,2 F0,-3 R0,-2 F0,-5 R0,5 R10,5 R10,2 F10,-1 R10,0 F10,-4 R10,-3 F10,-5 R10,5";
    assert_eq!(moves(&[], Control::FanucA, text), pecked);
    assert_eq!(
        moves(&[], Control::FanucB, &text.replace("G98", "G94")),
        pecked
    );
    let text = "G98 G0 X0 Z5;G83 R-3 F100;Z-5 Q5000;#1=3000;X10 Q#1;G80";
    assert_eq!(
        moves(&[], Control::FanucC, &text.replace("G98", "G94")),
        pecked
    );
    assert_eq!(
        refused(Control::FanucA, "G98 G0 X0 Z5;G83 R-3 F100;Z-5 Q5."),
        4045
    );
    // G65 has its own Q.
    let text = "G98 G0 X0 Z5;G83 Z-5 R-3 Q5000 F100;G65 P9 Q1.;X10;G80;M30;O9;M99";
    assert!(
        moves(&[], Control::FanucA, text).contains("R10,2 F10,-3 R10,-2 F10,-5"),
        "{text}"
    );
}

/// Q of another unit is told, once for each Q.
#[test]
fn pecks_of_another_unit_are_told() {
    let told = |control, text: &str| {
        let (events, alarm) = read_with(&[], control, text);
        assert_eq!(alarm, None, "{text}");
        let number = |event: &Event| match event {
            Event::Warning(alarm) => Some((alarm.number(), alarm.span.line)),
            Event::Call(_) => None,
        };
        events.iter().filter_map(number).collect::<Vec<_>>()
    };
    let start = "G98 G0 X0 Z2;";
    let one = |control, hole: &str| told(control, &format!("{start}{hole} F100;X10;G80"));
    assert_eq!(one(Control::FanucA, "G83 Z-20 Q5"), [(4802, 2)]);
    assert_eq!(one(Control::Gsk980td, "G83 Z-20 Q5"), [(4802, 2)]);
    assert_eq!(one(Control::Gsk988, "G83 Z-20 Q5000"), [(4982, 2)]);
    assert_eq!(one(Control::Haas, "G83 Z-20 R1 Q5000"), [(4982, 2)]);
    for right in [
        "G83 Z-20 Q5000",
        "G83 Z-20 Q30000",
        "G83 Z-20",
        "G83 Z-20 Q0",
    ] {
        assert_eq!(one(Control::FanucA, right), [], "{right}");
    }
    // Another Q is told anew.
    let text = format!("{start}G83 Z-20 Q5 F100;X10;X20 Q6;G80");
    assert_eq!(told(Control::FanucA, &text), [(4802, 2), (4802, 4)]);
}

/// G85 and G89 of a FANUC dwell and come out at feed, one along Z and the other along X.
#[test]
fn boring_of_a_fanuc() {
    for (control, start) in [
        (Control::FanucA, "G98"),
        (Control::FanucB, "G94"),
        (Control::FanucC, "G94"),
    ] {
        let text = format!("{start} G0 X20 Z2;G85 Z-10 R-1 P500 F100;G80");
        assert_eq!(
            moves(&[], control, &text),
            "R20,2 R20,1 F20,-10 D F20,1 R20,2"
        );
        let text = format!("{start} G0 X50 Z-5;G89 Z-10 X20 R-5 P500 F100;Z-20;G80");
        assert_eq!(
            moves(&[], control, &text),
            "R50,-5 R50,-10 R40,-10 F20,-10 D F40,-10 R50,-10 R50,-20 R40,-20 F20,-20 D F40,-20 R50,-20"
        );
        let text = format!("{start} G0 X50 Z-5;G89 Z-10 R-5 F100;G80");
        let alarm = read_with(&[], control, &text).1.expect("no bottom");
        assert_eq!(
            (alarm.number(), alarm.args[0], alarm.args[1]),
            (4062, Arg::GCode(890), Arg::Letter(b'X'))
        );
    }
    // A Haas has both along Z.
    let text = "G98 G0 X20 Z2;G89 Z-10 R1 P500 F100;G80";
    assert_eq!(
        moves(&[], Control::Haas, text),
        "R20,2 R20,1 F20,-10 D F20,1 R20,2"
    );
    for control in [Control::Gsk980td, Control::Gsk988] {
        assert_eq!(refused(control, "G98 G0 X20 Z2;G85 Z-10 R-1 F100"), 4018);
    }
    for (control, code) in [(Control::FanucA, 81), (Control::FanucA, 82)] {
        assert_eq!(
            refused(control, &format!("G98 G0 X20 Z2;G{code} Z-10 R-1 F100")),
            4018
        );
    }
    let alarm = read_with(&[], Control::Haas, "G98 G0 X0 Z2;G81 X4 R1 F100")
        .1
        .unwrap();
    assert_eq!((alarm.number(), alarm.args[0]), (4062, Arg::GCode(810)));
}

/// A block of another code has its own words.
#[test]
fn codes_of_one_block_between_holes() {
    let first = "G98 G0 X0 Z5;G83 Z-5 R-3 F100";
    let drilled = "R0,5 R0,2 F0,-5 R0,5";
    for (control, code, then) in [
        (Control::FanucA, "G4 X1.", " D"),
        (Control::FanucA, "G4 P500", " D"),
        (Control::FanucA, "G4 U1.", " D"),
        (Control::Gsk980td, "G4 P500", " D"),
        (Control::FanucA, "G50 S1500", ""),
        (Control::FanucA, "G10 P1 X0 Z0", ""),
        (Control::FanucA, "G53 X20 Z5", " R20,5"),
    ] {
        let text = format!("{first};{code};X10;G80");
        let expected = format!("{drilled}{then} R10,5 R10,2 F10,-5 R10,5");
        assert_eq!(moves(&[], control, &text), expected, "{text}");
    }
    // G28 and G30 end the cycle, and what follows is a rapid.
    for (control, code) in [
        (Control::FanucA, "G28 U0 W0"),
        (Control::Gsk980td, "G28 U0 W0"),
        (Control::FanucA, "G30 U0 W0"),
        (Control::Haas, "G28"),
    ] {
        let first = if control == Control::Haas {
            first.replace("R-3", "R2")
        } else {
            first.to_owned()
        };
        let of = |text: String| moves(&[], control, &text);
        let ended = of(format!("{first};{code};X10;Z4"));
        assert_eq!(ended, of(format!("{first};G80;{code};X10;Z4")), "{code}");
    }
    // The place of the work has changed, and that of the tool has not.
    let text = format!("{first};G50 X0 Z6;X10;G80");
    let expected = format!("{drilled} R10,6 R10,3 F10,-5 R10,6");
    assert_eq!(moves(&[], Control::FanucA, &text), expected);
    assert_eq!(
        refused(Control::FanucA, "G98 G0 X0 Z5;G83 R-3 F100;G28 U0"),
        4062
    );
}

/// A cycle may keep its words and drill at a later place; one that never does has lost a word.
#[test]
fn a_cycle_without_a_hole_is_refused() {
    let text = "G98 G0 X0 Z5;G83 R-3 F100;Z-5;G80";
    assert_eq!(moves(&[], Control::FanucA, text), "R0,5 R0,2 F0,-5 R0,5");
    for end in ["G80", "G0 X10", "M30", "G87 X30 R-5"] {
        let text = format!("G98 G0 X50 Z5;G83 R-3 Q3000 F100;{end}");
        assert_eq!(refused(Control::FanucA, &text), 4062, "{end}");
    }
}

#[test]
fn holes_from_the_side_and_clamps() {
    let text = "G98 G0 X50 Z-10;G87 C45. X30 R-5 Q6000 F80 M77;G80";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R50,-10 R50,-10 M77 R40,-10 F30,-10 R50,-10 M78"
    );
    let text = "G98 G0 X50 Z-10;G87 U-10. R-5 F80;G80";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R50,-10 R40,-10 F30,-10 R50,-10"
    );
    // What ends the program comes after the hole.
    let text = "G98 G0 X50 Z-10;G87 X30 R-5 F80 M9 M2;X10";
    assert_eq!(
        moves(&[], Control::FanucA, text),
        "R50,-10 R40,-10 F30,-10 R50,-10 M9 M2"
    );
    // M29 begins rigid tapping, so M28 has no code after it that unclamps.
    assert_eq!(
        refused(Control::FanucA, "G98 G0 X50;G87 X30 R-5 F80 M28"),
        4067
    );
}

#[test]
fn cycles_of_the_other_systems() {
    let drilled = "R0,5 R0,2 F0,-5 ";
    for (words, after) in [
        ("G98 G81 Z-5 R-3", "R0,5"),
        ("G99 G81 Z-5 R-3", "R0,2"),
        ("G98 G82 Z-5 R-3 P100", "D R0,5"),
        ("G98 G85 Z-5 R-3", "F0,2 R0,5"),
        ("G99 G85 Z-5 R-3", "F0,2"),
        ("G98 G85 Z-5 R-3 P100", "D F0,2 R0,5"),
    ] {
        let text = format!("G94 G0 X0 Z5;{words} F100;G80");
        let found = moves(&[], Control::FanucB, &text);
        assert_eq!(found, format!("{drilled}{after}"), "{words}");
    }
    // With G99 the next hole begins at R, and R stays where it is.
    let text = "G94 G0 X0 Z5;G99 G81 Z-5 R-3 F100;X10;G80";
    assert_eq!(
        moves(&[], Control::FanucB, text),
        "R0,5 R0,2 F0,-5 R0,2 R10,2 F10,-5 R10,2"
    );
}

#[test]
fn what_is_refused() {
    let refused = |text| refused(Control::FanucA, text);
    assert_eq!(refused("G98 G0 X0 Z5;G83 R-3 F100 X1"), 4062);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z2 R-3 F100"), 4085);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z-5 R3 F100"), 4085);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z-50 R-3 Q1 F100"), 4085);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z-5 R-3"), 4034);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z-5 R-3 I5 F100"), 4028);
    assert_eq!(refused("G98 G0 X0 Z5;G83 Z-5 R-3 Q-5000 F100"), 4046);
    assert_eq!(refused("G98 G0 X0 Z5;G83 G1 Z-5 R-3 F100"), 4065);
}

/// Any hole: the feed goes to the bottom in steps of at most a peck, a rapid never goes deeper than the feed has been, and
/// the end is where it belongs.
#[test]
fn holes_by_chance() {
    leadscrew_seed::volume(83, |seed| {
        let mut chance = crate::figures::Chance::new(seed);
        for _ in 0..leadscrew_seed::amount(20_000, 80_000) {
            let nm = |value: f64| Length::from_nm(value as i64);
            let sign = if chance.below(2) == 0 { 1 } else { -1 };
            let depth = nm(chance.size(1e3, 1e8));
            let rise = nm(chance.size(1.0, 1e7) - 1.0);
            let hole = Hole {
                initial: Length::from_nm(5_000_000) + rise.times(sign),
                level: Length::from_nm(5_000_000),
                bottom: Length::from_nm(5_000_000) - depth.times(sign),
                peck: (chance.below(3) > 0)
                    .then(|| nm(chance.size(depth.nm() as f64 / 500.0 + 1.0, 1e8))),
                deep: chance.below(2) == 0,
                clearance: nm(chance.size(1e3, 1e7)),
                dwell: chance.below(2) as u32 * 10,
                feeds_out: chance.below(2) == 0,
                ends_at_r: chance.below(2) == 0,
            };
            let below = |place: Length| (hole.level - place).times(sign);
            let (mut at, mut reached, mut feeds, mut dwelt) =
                (hole.initial, Length::ZERO, 0, false);
            let done: Result<(), ()> = hole.steps(|step| {
                match step {
                    Step::Rapid(to) => {
                        assert!(below(to) <= reached, "{hole:?}");
                        at = to;
                    }
                    Step::Feed(to) if below(to) > reached => {
                        let peck = hole.peck.unwrap_or(depth);
                        assert!(
                            below(to) - reached <= peck && below(at) <= reached,
                            "{hole:?}"
                        );
                        (at, reached, feeds) = (to, below(to), feeds + 1);
                    }
                    Step::Feed(to) => {
                        assert!(
                            hole.feeds_out && to == hole.level && reached == depth,
                            "{hole:?}"
                        );
                        at = to;
                    }
                    Step::Dwell(_) => {
                        assert_eq!(at, hole.bottom, "{hole:?}");
                        dwelt = true;
                    }
                }
                Ok(())
            });
            assert_eq!(done, Ok(()));
            assert_eq!((reached, feeds), (depth, hole.pecks()), "{hole:?}");
            assert_eq!(dwelt, hole.dwell > 0);
            let end = if hole.ends_at_r {
                hole.level
            } else {
                hole.initial
            };
            assert_eq!(at, end, "{hole:?}");
        }
    });
}
