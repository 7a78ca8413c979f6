//! Backlash that the board puts in (1851): what the drives are told while axes are moved by hand.

use leadscrew_core::operating::{OperatingMode, Towards};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_seed::{amount, volume};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::by_hand::{BRAKING, Hand, WINDOW};

/// Ticks after which all of it has been put in.
const PUT_IN: u64 = 300;
/// An increment of the drives, in nanometres.
const INCREMENT: i64 = 100;

fn loose() -> Params {
    with(&[("1851.X", 12_300), ("1851.Z", 40_000)])
}

fn backlash(axis: Axis) -> i64 {
    if axis == Axis::X { 12_300 } else { 40_000 }
}

impl Hand {
    fn place(&mut self, params: &Params, axis: Axis) -> i64 {
        self.sim.plant().place(params, axis).unwrap()
    }
}

/// Any presses in any order: at rest a drive is where its axis is, less the backlash on the minus side; on the way there
/// it stays within the limits of the axis.
#[test]
fn the_drive_is_a_backlash_further_on_the_minus_side_and_keeps_the_limits() {
    volume(0x1851, |seed| {
        let mut random = Random(seed);
        let params = loose();
        for round in 0..amount(3, 1_000) {
            let mut hand = Hand::on(&params, OperatingMode::Manual);
            let mut sides = [Towards::Plus; 2];
            let mut places: [Vec<i64>; 2] = Default::default();
            for _ in 0..12 {
                let (number, axis) = random.of(&[(0, Axis::X), (1, Axis::Z)]);
                let towards = random.of(&[Towards::Plus, Towards::Minus]);
                let (speed, ticks) = (random.within(60, 5_000), random.within(100, 400));
                // A press ends at rest, or is let go in the next one.
                let rest = random.of(&[0, WINDOW + BRAKING]);
                let before = hand.along(axis);
                for part in 0..ticks as u64 + rest {
                    if part < ticks as u64 {
                        hand.press_on(axis, towards, speed as u16, part);
                    }
                    hand.tick();
                    for (places, axis) in places.iter_mut().zip([Axis::X, Axis::Z]) {
                        places.push(hand.place(&params, axis));
                    }
                }
                if (hand.along(axis) - before).abs() > 10_000 {
                    sides[number] = towards;
                }
            }
            hand.run(WINDOW + BRAKING + PUT_IN);
            for (axis, (side, places)) in [Axis::X, Axis::Z]
                .into_iter()
                .zip(sides.iter().zip(&places))
            {
                let put_in = if *side == Towards::Plus {
                    0
                } else {
                    -backlash(axis)
                };
                let apart = hand.place(&params, axis) - hand.along(axis) - put_in;
                assert!(
                    apart.abs() <= INCREMENT,
                    "{round}: {axis:?} {side:?}: {apart} nm"
                );
                let most = params.acceleration(axis).nm_per_s2() / 1_000_000 + 2 * INCREMENT;
                let fastest = places
                    .windows(3)
                    .map(|three| (three[2] - 2 * three[1] + three[0]).abs())
                    .max();
                assert!(
                    fastest.is_some_and(|most_here| most_here <= most),
                    "{round}: {axis:?}: {fastest:?}"
                );
            }
        }
    });
}
