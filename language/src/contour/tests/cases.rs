//! Single cases: pockets, degenerate contours, alarms.

use leadscrew_core::alarm::{Alarm, Arg, At, Code};
use leadscrew_core::units::{Diameter, Length};

use super::notation::{contour, expected, moves, path, span};
use super::vectors::words;
use crate::contour::{Along, Axes, Contour, Repeats};
use crate::plane::Point;

fn along_z(axes: &str, text: &str, text_words: &str, wanted: &str) {
    let contour = contour("40,0", axes, text);
    let cycle = contour
        .rough(Along::Z, &words(text_words))
        .expect("a cycle");
    assert_eq!(moves(cycle), expected("40,0", wanted));
}

fn refused(axes: &str, text: &str, text_words: &str) -> Alarm {
    let contour = contour("40,0", axes, text);
    contour
        .rough(Along::Z, &words(text_words))
        .expect_err("an alarm")
}

#[test]
fn a_pocket_with_two_bottoms_is_cut_one_bottom_after_the_other() {
    // Levels 36, 32, 28, 24: the peak of X 30 divides the pocket from level 28 on.
    along_z(
        "XZ",
        "R40,0 F20,-10 F30,-15 F22,-19 F40,-28",
        "2 0 0 0",
        "F36,-2 F36,-26 R36,-2 F32,-4 F32,-24 R32,-4 F28,-6 F28,-14 R28,-6 F24,-8 F24,-12 R32,-12 R32,-15 \
         F30,-15 F28,-16 F28,-22 R28,-16 F24,-18 F24,-20 R40,-20 R40,0 F20,-10 F30,-15 F22,-19 F40,-28 R40,0",
    );
}

#[test]
fn the_walls_of_a_pocket_may_be_arcs() {
    // A half circle of radius 5 around X 40 Z -10; the level 2 above its bottom is 4 to each side.
    along_z(
        "XZ",
        "R40,0 F40,-5 A30,-10/5cw A40,-15/5cw",
        "3 0.5 0 0",
        "R41,-5 F40,-5 A34,-6/5cw F34,-14 F35,-13.5 R41,-13.5 R41,0 R40,0 F40,-5 A30,-10/5cw A40,-15/5cw R40,0",
    );
}

#[test]
fn a_peak_that_touches_a_level_does_not_divide_it() {
    along_z(
        "XZ",
        "R40,0 F30,-5 F36,-8 F30,-11 F40,-16",
        "2 0 0 0",
        "F36,-2 F36,-14 R36,-2 F32,-4 F32,-6 R36,-6 R36,-8 F32,-10 F32,-12 R40,-12 R40,0 F30,-5 F36,-8 F30,-11 F40,-16 \
         R40,0",
    );
}

#[test]
fn a_depth_that_is_more_than_all_leaves_the_contour_alone() {
    along_z(
        "X",
        "R20,0 F20,-10 F30,-12",
        "50 0.5 0 0",
        "R20,0 F20,-10 F30,-12 R40,0",
    );
}

#[test]
fn one_block_is_a_contour() {
    along_z("X", "R20,0", "2 0.5 0 0", "R20,0 R40,0");
    let one = contour("40,0", "X", "R20,0");
    assert_eq!(moves(one.finish(span(9))), expected("40,0", "R20,0 R40,0"));
}

#[test]
fn elements_without_length_are_dropped() {
    along_z(
        "X",
        "F20,0 F20,0 F20,-10 F20,-10 F28,-10 F28,-10",
        "3 1 0 0",
        "F34,0 F34,-10 F36,-9 R36,0 F28,0 F28,-10 F30,-9 R30,0 F22,0 F22,-10 F24,-9 R24,0 F20,0 F20,-10 F28,-10 R40,0",
    );
}

#[test]
fn a_retract_ends_at_the_start_of_a_short_stroke() {
    along_z(
        "X",
        "R30,0 F30,-1 F40,-1",
        "3 2 0 0",
        "R34,0 F34,-1 F38,0 R30,0 F30,-1 F40,-1 R40,0",
    );
}

#[test]
fn the_way_home_goes_over_what_stands() {
    along_z(
        "XZ",
        "R20,0 F20,-10 F38,-10 F38,-30 F20,-30 F20,-40",
        "50 0 0 0",
        "R20,0 F20,-10 F38,-10 F38,-30 F20,-30 F20,-40 R40,-40 R40,0",
    );
}

#[test]
fn what_turns_back_is_an_alarm_at_its_element() {
    let alarm = refused("X", "R20,0 F20,-10 F18,-12 F30,-13", "2 0 0 0");
    let args = [
        Arg::Letter(b'X'),
        Arg::Diameter(Diameter::from_nm(2_000_000)),
    ];
    let wanted = Alarm::new(Code::ContourTurnsBack, span(3)).with(args);
    assert_eq!(alarm, wanted);
    let back = refused("XZ", "R20,0 F20,-10 F22,-9.9 F30,-13", "2 0 0 0");
    assert_eq!((back.span, back.args[0]), (span(3), Arg::Letter(b'Z')));
    // Beyond the end of its diameter an arc goes back, though its end lies forward of its start.
    let round = refused("XZ", "R20,0 F20,-10 A28,-12/3cw F40,-20", "2 0 0 0");
    assert_eq!((round.code, round.span), (Code::ContourTurnsBack, span(3)));
}

#[test]
fn a_small_turn_back_is_within_the_tolerance() {
    let contour = contour("40,0", "X", "R20,0 F20,-10 F19.99,-12 F30,-13");
    let mut words = words("4 0 0 0");
    words.tolerance = Length::from_nm(5_000);
    let cycle = contour.rough(Along::Z, &words).expect("a cycle");
    let last: Vec<_> = moves(cycle);
    let wanted = expected("40,0", "F19.99,-12 F30,-13 R40,0");
    assert_eq!(last[last.len() - 3..], wanted);
    words.tolerance = Length::from_nm(4_999);
    assert!(contour.rough(Along::Z, &words).is_err());
}

#[test]
fn the_first_block_fits_its_cycle() {
    let first = |axes, along| {
        let contour = contour("40,0", axes, "R20,0 F20,-10");
        let cycle = contour.rough(along, &words("2 0 0 0"));
        cycle.err().map(|alarm| (alarm.code, alarm.span))
    };
    let wrong = Some((Code::ContourFirst, span(1)));
    assert_eq!(first("Z", Along::Z), wrong);
    assert_eq!(first("X", Along::X), wrong);
    assert_eq!(first("X", Along::Z), None);
    let start = Point::default();
    let axes = Axes { x: true, z: true };
    let arc = Contour::new(start, axes, path(start, "A10,-5/5cw"));
    assert_eq!(arc.expect_err("an arc").code, Code::ContourFirst);
    let none = Axes { x: false, z: false };
    assert!(Contour::new(start, none, path(start, "F10,-5")).is_err());
    assert!(Contour::new(start, axes, Vec::new()).is_err());
}

#[test]
fn a_contour_has_a_thousand_elements_at_most() {
    let start = Point::default();
    let axes = Axes { x: true, z: false };
    let text = "F10,0 ".repeat(1001);
    let long = path(start, &text);
    assert!(Contour::new(start, axes, long[..1000].to_vec()).is_ok());
    let alarm = Contour::new(start, axes, long).expect_err("too long");
    assert_eq!((alarm.code, alarm.span), (Code::ContourLong, span(1001)));
}

#[test]
fn words_out_of_range_are_alarms_at_their_words() {
    for (text, line, word) in [
        ("0 0 0 0", 101, b'U'),
        ("-1 0 0 0", 101, b'U'),
        ("1 -1 0 0", 102, b'R'),
    ] {
        let alarm = refused("X", "R20,0 F20,-10", text);
        let found = (alarm.code, alarm.span, alarm.word);
        assert_eq!(found, (Code::ContourDepth, span(line), Some(word)));
    }
    let pattern = contour("40,0", "X", "R20,0");
    let words = Repeats {
        passes: At::new(0, span(7)),
        ..Repeats::default()
    };
    let alarm = pattern.pattern(&words).expect_err("no pass");
    assert_eq!((alarm.code, alarm.span), (Code::ContourDepth, span(7)));
}

/// So many pockets of the same depth, side by side.
fn pockets(many: usize) -> String {
    let mut text = String::from("R40,0 ");
    for pocket in 0..many {
        let z = pocket * 4;
        text += &format!(
            "F39,-{} F30,-{} F30,-{} F39,-{} ",
            z + 1,
            z + 2,
            z + 3,
            z + 4
        );
    }
    text
}

#[test]
fn thirty_two_pockets_are_held_and_no_more() {
    let held = contour("40,0", "XZ", &pockets(32));
    assert!(held.rough(Along::Z, &words("1 0 0 0")).is_ok());
    let alarm = refused("XZ", &pockets(33), "1 0 0 0");
    assert_eq!(
        (alarm.code, alarm.args[0]),
        (Code::ContourPockets, Arg::Int(33))
    );
}

#[test]
fn pockets_in_pockets_are_held_eight_deep() {
    // Each peak is 2 lower than the one before: the level below it divides what is left.
    let nested = |many: i64| {
        let mut text = String::from("R100,0 ");
        for step in 1..=many {
            text += &format!(
                "F4,-{} F{},-{} ",
                step * 2 - 1,
                98 - 4 * (many - step),
                step * 2
            );
        }
        text += &format!("F4,-{} F100,-{}", many * 2 + 1, many * 2 + 2);
        let contour = contour("100,0", "XZ", &text);
        contour
            .rough(Along::Z, &words("1 0 0 0"))
            .map(|cycle| cycle.count())
    };
    assert!(nested(8).is_ok_and(|moves| moves > 100));
    let alarm = nested(9).expect_err("too deep");
    assert_eq!(
        (alarm.code, alarm.args[1]),
        (Code::ContourPockets, Arg::Int(9))
    );
}

#[test]
fn a_contour_that_comes_back_from_above_the_start_is_refused() {
    let alarm = refused("XZ", "R20,0 F20,-5 F50,-10 F30,-15", "2 0 0 0");
    assert_eq!((alarm.code, alarm.span), (Code::ContourAboveStart, span(4)));
    let above = contour("40,0", "X", "R20,0 F20,-5 F50,-10");
    let cycle = above.rough(Along::Z, &words("2 0 0 0")).expect("a cycle");
    assert!(cycle.starts_inside());
}

#[test]
fn an_allowance_that_cuts_into_a_wall_is_seen() {
    // The wall goes down by 5 on 3.
    let pocket = contour("40,0", "XZ", "R30,0 F30,-5 F20,-8 F40,-12");
    let cuts = |text| {
        let cycle = pocket.rough(Along::Z, &words(text)).expect("a cycle");
        cycle.cuts_into_a_wall()
    };
    assert!(!cuts("2 0 0.4 0"));
    assert!(!cuts("2 0 0.4 0.115") && cuts("2 0 0.4 0.125"));
    // Away from the wall, into the one behind it.
    assert!(!cuts("2 0 0.4 -0.2"));
}

#[test]
fn a_cycle_of_a_million_levels_gives_its_first_moves_at_once() {
    let deep = contour("2000,0", "X", "F0,0 F0,-10 F2000,-10");
    let cycle = deep
        .rough(Along::Z, &words("0.000002 0 0 0"))
        .expect("a cycle");
    assert_eq!(cycle.take(1000).count(), 1000);
}

#[test]
fn one_pass_of_a_pattern_is_moved_by_the_allowance_alone() {
    let pattern = contour("40,0", "XZ", "R20,-1 F20,-10");
    let words = Repeats {
        x: Length::from_nm(3_000_000),
        passes: At::new(1, span(7)),
        allowance: words("1 0 0.4 0.2").allowance,
        ..Repeats::default()
    };
    assert_eq!(
        moves(pattern.pattern(&words).expect("a cycle")),
        expected("40,0", "R40.4,0.2 R20.4,-0.8 F20.4,-9.8 R40,0")
    );
}

#[test]
fn a_bottom_that_lies_on_a_level_has_no_stroke() {
    along_z(
        "XZ",
        "R40,0 F36,-2 F36,-6 F40,-8 F30,-10 F30,-12 F40,-14",
        "2 0 0 0",
        "R40,-8 F36,-8.8 F36,-13.2 R36,-8.8 F32,-9.6 F32,-12.4 R40,-12.4 R40,0 F36,-2 F36,-6 F40,-8 F30,-10 F30,-12 \
         F40,-14 R40,0",
    );
}

#[test]
fn a_retract_may_lead_above_the_start() {
    along_z(
        "X",
        "F30,0 F30,-9 F40,-9",
        "2 3 0 0",
        "F36,0 F36,-9 F42,-6 R42,0 F32,0 F32,-9 F38,-6 R38,0 F30,0 F30,-9 F40,-9 R40,0",
    );
}
