//! The three forms, both axes, both hands: the line, the bottom, the turns.

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::call::{Hand, HandChoice, Position, TapAxis, TapCall, TapCycle};
use leadscrew_core::units::{Lead, Millis, Turns};

use super::hole::{bottom, deep, high_speed, nm, sheet};
use super::watch::{depth, locked, set, tap};
use leadscrew_tests::machine::Ran;
use leadscrew_tests::params::with;

/// Turns of the spindle from one row to another, summed up over all rows.
fn turned(ran: &Ran) -> f64 {
    let rows: Vec<_> = ran
        .rows
        .iter()
        .filter(|row| row.spindle_set.is_some())
        .collect();
    rows.windows(2)
        .map(|rows| ((set(rows[1]) - set(rows[0])).raw() as f64).abs())
        .sum::<f64>()
        / 2f64.powi(32)
}

/// Travel of the tap axis while it is geared, in nanometres.
fn geared(ran: &Ran, hole: &TapCall) -> i64 {
    let rows: Vec<_> = locked(ran).collect();
    let first = depth(rows[0], hole).abs();
    first
        + rows
            .windows(2)
            .map(|rows| (depth(rows[1], hole) - depth(rows[0], hole)).abs())
            .sum::<i64>()
}

#[test]
fn the_sheets_hole_turns_25_times_in_and_out() {
    let hole = TapCall {
        dwell: Millis::new(300),
        ..sheet()
    };
    let ran = tap(&hole, &with(&[]));
    assert_eq!(geared(&ran, &hole), 100_000_000);
    assert!((turned(&ran) - 50.0).abs() < 1e-6, "{}", turned(&ran));
    // At the bottom exactly 25 turns from R, where it stands for the dwell.
    let start = ran
        .rows
        .iter()
        .find_map(|row| row.spindle_set)
        .expect("position mode");
    let standing: Vec<_> = locked(&ran)
        .filter(|row| depth(row, &hole) == 50_000_000)
        .collect();
    assert!(standing.len() >= 300, "{}", standing.len());
    assert!(
        standing
            .iter()
            .all(|row| set(row) - start == Turns::whole(25))
    );
    // Out again it is where it began, to the last bit.
    assert_eq!(locked(&ran).last().map(set), Some(start));
}

#[test]
fn high_speed_pecks_go_124_mm_geared() {
    let hole = high_speed(sheet(), 4_000, 1_000);
    let ran = tap(&hole, &with(&[]));
    assert_eq!(geared(&ran, &hole), 124_000_000);
    assert!((turned(&ran) - 62.0).abs() < 1e-6);
}

#[test]
fn deep_pecks_go_724_mm_geared() {
    let hole = deep(sheet(), 4_000, 1_000);
    let ran = tap(&hole, &with(&[]));
    assert_eq!(geared(&ran, &hole), 724_000_000);
    assert!((turned(&ran) - 362.0).abs() < 1e-6);
}

#[test]
fn a_left_hand_tap_turns_the_other_way() {
    let right = tap(&sheet(), &with(&[]));
    let hole = TapCall {
        hand: HandChoice::Written(Hand::Left),
        ..sheet()
    };
    let left = tap(&hole, &with(&[]));
    let lowest = |ran: &Ran| {
        locked(ran)
            .min_by_key(|row| row.position.z)
            .map(|row| set(row).raw())
            .expect("rows")
    };
    let start = |ran: &Ran| locked(ran).last().map(|row| set(row).raw()).expect("rows");
    assert_eq!(lowest(&right) - start(&right), 25 << 32);
    assert_eq!(lowest(&left) - start(&left), -(25 << 32));
}

#[test]
fn x_taps_on_the_radius_inwards_and_outwards() {
    for target in [5_000_000, 45_000_000] {
        let place = Position {
            x: nm(25_000_000),
            ..Position::ZERO
        };
        let hole = TapCall {
            cycle: TapCycle::G88,
            axis: TapAxis::X,
            hole: place,
            level: At::new(
                nm(if target < 25_000_000 {
                    22_000_000
                } else {
                    28_000_000
                }),
                Span::default(),
            ),
            bottom: At::new(nm(target), Span::default()),
            ..sheet()
        };
        tap(&hole, &with(&[]));
        tap(&high_speed(hole, 3_000, 500), &with(&[]));
        tap(&deep(hole, 3_000, 500), &with(&[]));
    }
}

/// Leads that no binary fraction holds: an inch thread, a third of a millimetre.
#[test]
fn odd_leads_stay_on_the_line() {
    for (numerator, denominator) in [
        (25_400_000, 13),
        (1_000_000, 3),
        (25_400_000, 56),
        (12_345_679, 7),
    ] {
        let hole = TapCall {
            lead: At::new(
                Lead::new(numerator, denominator).expect("a lead"),
                Span::default(),
            ),
            ..bottom(sheet(), -13_577)
        };
        tap(&hole, &with(&[]));
        tap(&high_speed(hole, 1_700, 300), &with(&[]));
        tap(&deep(hole, 1_700, 300), &with(&[]));
    }
}

/// More pecks than any queue has places.
#[test]
fn hundreds_of_pecks_are_one_way_in_and_out() {
    let hole = high_speed(bottom(sheet(), -20_050), 100, 40);
    let ran = tap(&hole, &with(&[("5261", 50)]));
    // 200 whole infeeds and the rest, 200 times back.
    assert_eq!(geared(&ran, &hole), 2 * (20_050_000 + 200 * 40_000));
}

#[test]
fn without_a_return_the_pecks_join_end_to_end() {
    let hole = high_speed(bottom(sheet(), -7_300), 1_000, 0);
    let ran = tap(&hole, &with(&[]));
    assert_eq!(geared(&ran, &hole), 14_600_000);
}

#[test]
fn several_holes_begin_where_the_spindle_stands() {
    let hole = TapCall {
        step: Position {
            x: nm(3_000_000),
            ..Position::ZERO
        },
        level: At::new(nm(-2_000_000), Span::default()),
        repeat: leadscrew_core::call::TapRepeat::Holes(3.try_into().expect("three")),
        ..bottom(sheet(), -10_000)
    };
    let ran = tap(&hole, &with(&[]));
    assert_eq!(geared(&ran, &hole), 3 * 16_000_000);
    let last = ran.rows.last().expect("rows").position;
    assert_eq!((last.x.nm(), last.z.nm()), (6_000_000, 0));
}
