//! Backlash that the board puts in (1851): what the drives are told while axes are moved by hand.

use leadscrew_core::operating::{OperatingMode, Towards};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_seed::{amount, volume};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::by_hand::{BRAKING, Hand, WINDOW};

/// Ticks after which all of it has been put in.
pub(super) const PUT_IN: u64 = 300;
/// An increment of the drives, in nanometres.
pub(super) const INCREMENT: i64 = 100;
/// A motion back by less is no reversal yet.
const SURE: i64 = 2_000;

/// X or Z: its own way, and that of its drive.
struct Seen {
    axis: Axis,
    backlash: i64,
    at: i64,
    /// How far it has moved since it turned round last; minus where it has moved in the minus direction.
    way: i64,
    /// Where its drive was in each tick.
    drive: Vec<i64>,
}

impl Seen {
    fn new(axis: Axis, backlash: i64, hand: &Hand) -> Self {
        Self {
            axis,
            backlash,
            at: hand.along(axis),
            way: 0,
            drive: Vec::new(),
        }
    }

    fn note(&mut self, hand: &mut Hand, params: &Params) {
        let at = hand.along(self.axis);
        let moved = at - self.at;
        let turns = moved.signum() * self.way.signum() < 0;
        self.way = if turns { moved } else { self.way + moved };
        self.at = at;
        self.drive
            .push(hand.sim.plant().place(params, self.axis).unwrap());
    }

    /// At rest a drive is where its axis is, less the backlash on the minus side; until then it was within the limits.
    fn judge(&self, params: &Params, what: &str) {
        let put_in = if self.way < 0 { -self.backlash } else { 0 };
        let apart = self.drive.last().unwrap() - self.at - put_in;
        if self.way.abs() >= SURE {
            assert!(apart.abs() <= INCREMENT, "{what}: {apart} nm");
        }
        keeps_acceleration(&self.drive, self.axis, params, what);
    }
}

/// The places of a drive in each tick keep to the acceleration of its axis, within the rounding of three.
pub(super) fn keeps_acceleration(drive: &[i64], axis: Axis, params: &Params, what: &str) {
    let most = params.acceleration(axis).nm_per_s2() / 1_000_000 + 2 * INCREMENT;
    for three in drive.windows(3) {
        let acceleration = three[2] - 2 * three[1] + three[0];
        assert!(acceleration.abs() <= most, "{what}: {acceleration} nm/ms²");
    }
}

/// Any presses in any order, one in the other.
#[test]
fn the_drive_is_a_backlash_further_on_the_minus_side_and_keeps_the_limits() {
    let params = with(&[("1851.X", 12_300), ("1851.Z", 40_000)]);
    volume(0x1851, |seed| {
        let mut random = Random(seed);
        for round in 0..amount(3, 120) {
            let mut hand = Hand::on(&params, OperatingMode::Manual);
            let mut seen = [(Axis::X, 12_300), (Axis::Z, 40_000)]
                .map(|(axis, backlash)| Seen::new(axis, backlash, &hand));
            let mut tick = |hand: &mut Hand| {
                hand.tick();
                seen.iter_mut().for_each(|axis| axis.note(hand, &params));
            };
            for _ in 0..12 {
                let axis = random.of(&[Axis::X, Axis::Z]);
                let towards = random.of(&[Towards::Plus, Towards::Minus]);
                let (speed, ticks) = (random.within(60, 5_000), random.within(100, 400));
                for part in 0..ticks as u64 {
                    hand.press_on(axis, towards, speed as u16, part);
                    tick(&mut hand);
                }
                // A press ends at rest, or is let go in the next one.
                (0..random.of(&[0, WINDOW + BRAKING])).for_each(|_| tick(&mut hand));
            }
            (0..WINDOW + BRAKING + PUT_IN).for_each(|_| tick(&mut hand));
            for axis in &seen {
                axis.judge(&params, &format!("{round}: {:?}", axis.axis));
            }
        }
    });
}
