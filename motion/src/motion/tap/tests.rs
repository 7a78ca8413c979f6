extern crate std;

use super::*;
use crate::call::{Hand, Position, TapAxis, TapNotes, TapSpindle};
use crate::journal::TapHole;
use crate::units::{CentiRpm, Lead, Length, Turns};

fn z(nm: i64) -> Position {
    Position {
        z: Length::from_nm(nm),
        ..Position::ZERO
    }
}

fn gear(numerator: i64, denominator: i64, inward: i64, hand: Hand) -> Gear {
    let lead = Lead::new(numerator, denominator).unwrap();
    Gear::new(TapAxis::Z, Length::from_nm(5_000_000), inward, lead, hand).unwrap()
}

#[test]
fn whole_turns_are_exact_on_both_sides_of_r() {
    for (inward, hand, sign) in [
        (-1, Hand::Right, 1),
        (-1, Hand::Left, -1),
        (1, Hand::Right, 1),
        (1, Hand::Left, -1),
    ] {
        let gear = gear(2_000_000_000, 1000, inward, hand);
        for turns in -500..500_i32 {
            let at = z(5_000_000 + inward * i64::from(turns) * 2_000_000);
            assert_eq!(gear.turns(at), Turns::whole(sign * turns));
        }
    }
}

#[test]
fn any_lead_is_the_ratio_rounded_towards_zero() {
    leadscrew_seed::volume(11, |seed| {
        let mut random = leadscrew_seed::Random(seed);
        let mut random = |bits: u32| (random.bits() >> (64 - bits)) as i64;
        for _ in 0..100_000 {
            let (numerator, denominator) = (random(40) + 1_000_000, random(6) + 1);
            let gear = gear(numerator, denominator, -1, Hand::Right);
            let way = random(40);
            let scaled = (i128::from(way) * i128::from(denominator)) << 32;
            let exact = scaled / i128::from(numerator);
            let turns = gear.turns(z(5_000_000 - way));
            // A value within 2⁻⁶¹ of itself below the next unit counts as the next unit.
            let next = (exact + 1) * i128::from(numerator) <= scaled + (scaled >> 61) + 1;
            let beyond = i128::from(turns.raw()) - exact;
            assert!(
                beyond == 0 || next && beyond == 1,
                "{way} at {numerator}/{denominator}: {beyond} beyond"
            );
            assert_eq!(gear.turns(z(5_000_000 + way)), -turns);
            // There and back: the result is less than a nanometre from the start.
            let back = gear.position(turns).nm() - (5_000_000 - way);
            assert!(
                back.abs() <= 1 + ((numerator / denominator) >> 32),
                "{back}"
            );
        }
    });
}

#[test]
fn leads_that_cannot_be_geared_are_none() {
    let gear = |numerator, denominator| {
        let lead = Lead::new(numerator, denominator).unwrap();
        Gear::new(TapAxis::X, Length::ZERO, 1, lead, Hand::Right)
    };
    assert!(gear(1, 1 << 40).is_none());
    assert!(gear(i64::MAX, 1).is_none());
    assert!(gear(100, 1).is_some());
    assert!(gear(10_000_000_000, 1).is_some());
}

fn hole() -> TapHole {
    TapHole {
        axis: TapAxis::Z,
        level: Length::ZERO,
        bottom: Length::from_nm(-1),
        lead: Lead::new(2_000_000, 1).unwrap(),
        hand: Hand::Right,
        spindle: TapSpindle::First,
        speed: CentiRpm::new(1),
        notes: TapNotes::default(),
    }
}

fn tap(steps: &[i64]) -> Tap {
    let mut tap = Tap::new(
        gear(2_000_000, 1, -1, Hand::Right),
        hole(),
        Position::ZERO,
        false,
    );
    for nm in steps {
        let stroke = Stroke {
            travel: Length::from_nm(*nm),
            nominal: crate::motion::PathRate::from_raw(1000),
            ramp: crate::motion::Ramp::new(crate::motion::PathRate::from_raw(1000), 3, 2).unwrap(),
        };
        assert!(tap.push(TapStep::Stroke(stroke)), "{steps:?}");
    }
    tap
}

/// The strokes and dwells of a tap, step by step.
fn unrolled(tap: &Tap) -> std::vec::Vec<i64> {
    let (mut index, mut left) = (0, tap.repeats());
    let mut steps = std::vec::Vec::new();
    while let Some(TapStep::Stroke(stroke)) = tap.step(index) {
        steps.push(stroke.travel.nm());
        (index, left) = tap.after(index, left);
    }
    steps
}

#[test]
fn pecks_that_are_alike_are_stored_once_and_done_as_often() {
    for pecks in 0..40 {
        for (first, back, feed, rest) in [(4, -1, 5, 2), (4, -1, 5, 5), (4, -4, 8, 3), (1, 1, 1, 1)]
        {
            let mut steps = std::vec![first];
            for _ in 0..pecks {
                steps.extend([back, feed]);
            }
            steps.extend([back, rest, -50]);
            let tap = tap(&steps);
            assert_eq!(unrolled(&tap), steps);
        }
    }
}
