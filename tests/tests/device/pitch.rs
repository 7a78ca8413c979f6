//! Errors of the pitch that the board takes off (1861, 1862, 1871 to 1886): what the drives are told while axes
//! are moved by hand.

use leadscrew_core::board::Command;
use leadscrew_core::bus::BoardState;
use leadscrew_core::operating::{OperatingMode, Towards};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_seed::{amount, volume};
use leadscrew_tests::params::{set, with};
use leadscrew_tests::random::Random;

use super::backlash::{INCREMENT, PUT_IN, keeps_acceleration};
use super::by_hand::{BRAKING, Hand, WINDOW};

/// The backlash of Z.
const BACKLASH: i64 = 20_000;

/// A table of an axis, in millimetres and nanometres.
struct Table {
    origin: i64,
    spacing: i64,
    errors: Vec<i64>,
}

impl Table {
    /// Around the place where the machine stands; from one point to the next it changes by up to 1 µm a millimetre.
    fn any(random: &mut Random) -> Self {
        let spacing = random.within(10, 40);
        Self {
            origin: -spacing * random.within(3, 12),
            spacing,
            errors: (0..16)
                .map(|_| 100 * random.within(-5 * spacing, 5 * spacing))
                .collect(),
        }
    }

    fn write(&self, params: &mut Params, axis: char) {
        set(params, &format!("1861.{axis}"), self.origin * 1_000_000);
        set(params, &format!("1862.{axis}"), self.spacing * 1_000_000);
        for (number, error) in (1871..).zip(&self.errors) {
            set(params, &format!("{number}.{axis}"), error / 100);
        }
    }

    /// The error at a place: between two points from the parabola of the one to that of the other.
    fn at(&self, place: i64) -> i64 {
        let way = (place as f64 / 1e6 - self.origin as f64) / self.spacing as f64;
        let (k, u) = (way.floor() as i64, way - way.floor());
        let value = |k: i64| self.errors[k.clamp(0, 15) as usize] as f64;
        let parabola = |k: i64, u: f64| {
            let slope = (value(k + 1) - value(k - 1)) / 2.0;
            let bend = value(k + 1) - 2.0 * value(k) + value(k - 1);
            value(k) + slope * u + bend * u * u / 2.0
        };
        let gone = u * u * (3.0 - 2.0 * u);
        ((1.0 - gone) * parabola(k, u) + gone * parabola(k + 1, u - 1.0)).round() as i64
    }
}

fn judge(hand: &mut Hand, params: &Params, tables: &[Table; 2], on_minus: bool, what: &str) {
    for (axis, table) in [Axis::X, Axis::Z].into_iter().zip(tables) {
        let at = hand.along(axis);
        let put_in = match axis {
            Axis::Z if on_minus => BACKLASH,
            _ => 0,
        };
        let drive = hand.sim.plant().place(params, axis).unwrap();
        let apart = drive + put_in + table.at(at) - at;
        assert!(apart.abs() <= INCREMENT, "{what}: {axis:?} {apart} nm");
    }
}

/// Any presses in any order; and an emergency stop, from which the board reads the places of its drives.
#[test]
fn the_drive_is_told_less_by_the_error_and_keeps_the_limits() {
    volume(0x1871, |seed| {
        let mut random = Random(seed);
        let (rounds, mut taken) = (amount(20, 120), 0);
        for round in 0..rounds {
            let tables = [(); 2].map(|()| Table::any(&mut random));
            let mut params = with(&[("1851.Z", BACKLASH)]);
            tables[0].write(&mut params, 'X');
            tables[1].write(&mut params, 'Z');
            if params.validate().is_err() {
                continue;
            }
            taken += 1;
            let mut hand = Hand::on(&params, OperatingMode::Manual);
            let mut drives = [Axis::X, Axis::Z].map(|axis| (axis, Vec::new()));
            let mut tick = |hand: &mut Hand| {
                hand.tick();
                for (axis, places) in &mut drives {
                    places.push(hand.sim.plant().place(&params, *axis).unwrap());
                }
            };
            let mut on_minus = false;
            for _ in 0..8 {
                let axis = random.of(&[Axis::X, Axis::Z]);
                let towards = random.of(&[Towards::Plus, Towards::Minus]);
                let (speed, ticks) = (random.within(500, 5_000), random.within(200, 600));
                for part in 0..ticks as u64 {
                    hand.press_on(axis, towards, speed as u16, part);
                    tick(&mut hand);
                }
                (0..WINDOW + BRAKING + PUT_IN).for_each(|_| tick(&mut hand));
                if axis == Axis::Z {
                    on_minus = towards == Towards::Minus;
                }
                judge(&mut hand, &params, &tables, on_minus, &format!("{round}"));
            }
            for (axis, places) in &drives {
                keeps_acceleration(places, *axis, &params, &round.to_string());
            }
            let at = [Axis::X, Axis::Z].map(|axis| hand.along(axis));
            hand.sim.command(Command::Stop);
            hand.run(100);
            hand.sim.command(Command::Reset);
            hand.until(|hand| hand.gateway.status.state == BoardState::Idle);
            hand.run(300);
            for (axis, at) in [Axis::X, Axis::Z].into_iter().zip(at) {
                let off = hand.along(axis) - at;
                assert!(off.abs() <= INCREMENT, "{round}: {axis:?} {off} nm");
            }
            judge(
                &mut hand,
                &params,
                &tables,
                on_minus,
                &format!("{round}: again"),
            );
        }
        assert!(taken * 4 >= rounds, "{taken} of {rounds} tables");
    });
}
