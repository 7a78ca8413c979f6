//! Worked examples, move by move.

use leadscrew_core::alarm::At;
use leadscrew_core::units::{Diameter, Length};

use super::notation::{contour, expected, moves, nm, span};
use crate::contour::{Allowance, Along, Repeats, Roughing};

/// Words in millimetres: Δd, e, Δu, Δw.
pub fn words(text: &str) -> Roughing {
    let all: Vec<i64> = text.split_whitespace().map(nm).collect();
    let length = |place: usize| Length::from_nm(all[place]);
    Roughing {
        left: Allowance::NONE,
        depth: At::new(length(0), span(101)),
        retract: At::new(length(1), span(102)),
        retract_feeds: true,
        allowance: Allowance {
            x: Diameter::from_nm(all[2]),
            z: length(3),
        },
        semi_finish: true,
        tolerance: Length::ZERO,
        span: span(100),
    }
}

const SHAFT: &str = "R20,2 F20,-10 F24,-20 F36,-20 F40,-21";

const SHAFT_ROUGH: &str = "R40.4,2.1 R34.4,2.1 F34.4,-19.9 F35.4,-19.4 R35.4,2.1 R28.4,2.1 F28.4,-19.9 F29.4,-19.4 \
    R29.4,2.1 R22.4,2.1 F22.4,-14.9 F23.4,-14.4 R23.4,2.1 R20.4,2.1 F20.4,-9.9 F24.4,-19.9 F36.4,-19.9 F40.4,-20.9 R40,2";

#[test]
fn a_shaft_is_roughed_along_z() {
    let shaft = contour("40,2", "X", SHAFT);
    let rough = shaft.rough(Along::Z, &words("3 0.5 0.4 0.1"));
    let rough = rough.expect("a cycle");
    assert!(!rough.cuts_into_a_wall() && !rough.starts_inside());
    assert_eq!(moves(rough), expected("40,2", SHAFT_ROUGH));
}

#[test]
fn what_i_and_k_leave_is_cut_by_the_last_pass() {
    // Strokes 1 mm on the diameter and 0.2 mm along Z off the contour with its allowance, and the pass on it.
    let shaft = contour("40,2", "X", SHAFT);
    let mut words = words("3 0.5 0.4 0.1");
    words.left = Allowance {
        x: Diameter::from_nm(1_000_000),
        z: Length::from_nm(200_000),
    };
    let rough = shaft.rough(Along::Z, &words).expect("a cycle");
    let wanted = "R41.4,2.3 R35.4,2.3 F35.4,-19.7 F36.4,-19.2 R36.4,2.3 R29.4,2.3 F29.4,-19.7 F30.4,-19.2 R30.4,2.3 \
         R23.4,2.3 F23.4,-14.7 F24.4,-14.2 R24.4,2.3 R24.4,2.1 R20.4,2.1 F20.4,-9.9 F24.4,-19.9 F36.4,-19.9 \
         F40.4,-20.9 R40,2";
    assert_eq!(moves(rough), expected("40,2", wanted));
}

#[test]
fn k_goes_with_no_pocket() {
    let pocket = contour("40,0", "XZ", "R40,0 F30,-5 F36,-8 F30,-11 F40,-16");
    let mut words = words("2 0 0 0");
    words.left.z = Length::from_nm(1);
    let alarm = pocket.rough(Along::Z, &words).expect_err("an alarm");
    assert_eq!((alarm.number(), alarm.word), (4866, Some(b'K')));
    words.left = Allowance {
        x: Diameter::from_nm(2),
        z: Length::ZERO,
    };
    assert!(pocket.rough(Along::Z, &words).is_ok());
}

#[test]
fn the_retract_is_at_rapid_where_the_dialect_has_it_so() {
    let shaft = contour("40,2", "X", SHAFT);
    let mut words = words("3 0.5 0.4 0.1");
    words.retract_feeds = false;
    let mut rough = SHAFT_ROUGH.to_string();
    for retract in ["35.4,-19.4", "29.4,-19.4", "23.4,-14.4"] {
        rough = rough.replace(&format!("F{retract}"), &format!("R{retract}"));
    }
    let cycle = shaft.rough(Along::Z, &words).expect("a cycle");
    assert_eq!(moves(cycle), expected("40,2", &rough));
}

#[test]
fn a_bore_is_roughed_along_z() {
    let bore = contour("16,2", "X", "R28,2 F28,-10 F24,-10 F24,-20 F16,-20");
    let rough = bore.rough(Along::Z, &words("2 0.5 -0.4 0.1"));
    let rough = rough.expect("a cycle");
    assert_eq!(
        moves(rough),
        expected(
            "16,2",
            "R15.6,2.1 R19.6,2.1 F19.6,-19.9 F18.6,-19.4 R18.6,2.1 R23.6,2.1 F23.6,-19.9 F22.6,-19.4 R22.6,2.1 \
             R27.6,2.1 F27.6,-9.9 F23.6,-9.9 F23.6,-19.9 F15.6,-19.9 R16,2"
        )
    );
}

#[test]
fn a_pocket_is_cut_after_the_level_over_it() {
    let text = "R30,2 F30,-10 F20,-15 F20,-25 F30,-30 F30,-40 F40,-40";
    let pocket = contour("40,2", "XZ", text);
    let rough = pocket.rough(Along::Z, &words("2.5 0.5 0 0"));
    assert_eq!(
        moves(rough.expect("a cycle")),
        expected(
            "40,2",
            "R35,2 F35,-40 F36,-39.5 R36,2 R30,2 F30,-40 F31,-39.5 R31,-10 F30,-10 F25,-12.5 F25,-27.5 F26,-27 R31,-27 \
             R31,2 R30,2 F30,-10 F20,-15 F20,-25 F30,-30 F30,-40 F40,-40 R40,2"
        )
    );
}

#[test]
fn a_face_is_roughed_along_x() {
    let face = contour("60,2", "Z", "R60,-6 F40,-6 F40,-3 F20,-3 F20,1");
    let rough = face.rough(Along::X, &words("2 0.5 0 0.1"));
    assert_eq!(
        moves(rough.expect("a cycle")),
        expected(
            "60,2",
            "R60,2.1 R60,0.1 F20,0.1 F21,0.6 R60,0.6 R60,-1.9 F20,-1.9 F21,-1.4 R60,-1.4 R60,-3.9 F40,-3.9 F41,-3.4 \
             R60,-3.4 R60,-5.9 F40,-5.9 F40,-2.9 F20,-2.9 F20,1.1 R60,2"
        )
    );
}

#[test]
fn a_pattern_is_repeated() {
    let text = "R20,0 F20,-10 A30,-15/5cw F40,-15";
    let pattern = contour("50,5", "XZ", text);
    let words = Repeats {
        x: Length::from_nm(3_000_000),
        z: Length::from_nm(1_000_000),
        passes: At::new(3, span(101)),
        allowance: words("1 0 0.4 0.2").allowance,
        span: span(100),
    };
    assert_eq!(
        moves(pattern.pattern(&words).expect("a cycle")),
        expected(
            "50,5",
            "R56.4,6.2 R26.4,1.2 F26.4,-8.8 A36.4,-13.8/5cw F46.4,-13.8 R53.4,5.7 R23.4,0.7 F23.4,-9.3 A33.4,-14.3/5cw \
             F43.4,-14.3 R50.4,5.2 R20.4,0.2 F20.4,-9.8 A30.4,-14.8/5cw F40.4,-14.8 R50,5"
        )
    );
}

#[test]
fn a_contour_is_finished_as_it_is_written() {
    let shaft = contour("40,2", "X", SHAFT);
    let finish: Vec<_> = shaft.finish(span(100)).collect();
    assert_eq!(
        moves(finish.iter().copied()),
        expected("40,2", "R20,2 F20,-10 F24,-20 F36,-20 F40,-21 R40,2")
    );
    let lines: Vec<_> = finish.iter().map(|cut| cut.element.span.line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 100]);
    assert_eq!(finish[5].of, None);
}
