//! A handwheel at the board's own input: switches choose what it leads, and no detent is lost.

use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{BoardState, Order};
use leadscrew_core::operating::{OperatingMode, Towards};
use leadscrew_core::params::{Contact, Params};
use leadscrew_tests::params::set;
use leadscrew_tests::random::Random;

use super::by_hand::{Hand, RENEWAL, WINDOW};

/// The first of its switches: X, Z, ×10, ×100 are inputs 5 to 8.
const FIRST: u8 = 5;
const X: u8 = 0;
const Z: u8 = 1;
const TEN: u8 = 2;
const HUNDRED: u8 = 3;

/// From the last detent to rest, and until the claim has ended.
const RUN_OUT: u64 = 300;
const CLAIM: u64 = 500 + WINDOW + RENEWAL + RUN_OUT;

fn params() -> Params {
    let mut params = Params::slant_bed();
    set(&mut params, "9048", FIRST.into());
    params
}

struct Pendant(Hand);

impl Pendant {
    fn new(mode: OperatingMode) -> Self {
        Self(Hand::on(&params(), mode))
    }

    fn switch(&mut self, switch: u8, on: bool) {
        let input = Contact::new(FIRST + switch).unwrap();
        self.0.sim.around().set(input, Some(on));
        // Three samples have to agree, and the background hears of it.
        self.0.run(10);
    }

    /// Turns, and waits for the axis.
    fn turn(&mut self, counts: i32) {
        self.0.sim.turn_wheel(counts);
        while self.0.sim.wheel_turns() {
            self.0.tick();
        }
        self.0.run(RUN_OUT);
    }

    fn z(&self) -> i64 {
        self.0.at().z.nm()
    }

    fn x(&self) -> i64 {
        self.0.at().x.nm()
    }
}

#[test]
fn its_switches_choose_the_axis_and_what_a_detent_is_worth() {
    let mut wheel = Pendant::new(OperatingMode::Wheel);
    let (x, z) = (wheel.x(), wheel.z());
    // No axis, no motion.
    wheel.turn(50);
    assert_eq!((wheel.x(), wheel.z()), (x, z));
    wheel.switch(Z, true);
    wheel.turn(-7);
    assert_eq!(wheel.z(), z - 7_000);
    wheel.switch(TEN, true);
    wheel.turn(100);
    assert_eq!(wheel.z(), z - 7_000 + 1_000_000);
    wheel.switch(TEN, false);
    wheel.switch(HUNDRED, true);
    wheel.turn(-10);
    assert_eq!(wheel.z(), z - 7_000);
    assert_eq!(wheel.x(), x);
    // X on the diameter. With both axes, or both factors, nothing.
    wheel.switch(X, true);
    wheel.turn(5);
    wheel.switch(Z, false);
    wheel.switch(TEN, true);
    wheel.turn(5);
    assert_eq!((wheel.x(), wheel.z()), (x, z - 7_000));
    wheel.switch(HUNDRED, false);
    wheel.turn(-12);
    assert_eq!((wheel.x(), wheel.z()), (x - 60_000, z - 7_000));
    assert_eq!(wheel.0.warnings, []);
}

#[test]
fn it_leads_in_its_mode_alone_and_says_nothing_elsewhere() {
    let mut wheel = Pendant::new(OperatingMode::Manual);
    wheel.switch(Z, true);
    let z = wheel.z();
    wheel.turn(20);
    assert_eq!((wheel.z(), &*wheel.0.warnings), (z, &[][..]));
    // What was turned before does not come after.
    wheel.0.mode(OperatingMode::Wheel);
    wheel.0.run(RUN_OUT);
    assert_eq!(wheel.z(), z);
    wheel.turn(20);
    assert_eq!(wheel.z(), z + 20_000);
}

/// A claim that has ended gives the axes free; the next begins without a loss.
#[test]
fn it_keeps_the_axes_no_longer_than_it_is_turned() {
    let mut wheel = Pendant::new(OperatingMode::Wheel);
    wheel.switch(Z, true);
    let z = wheel.z();
    wheel.turn(20);
    wheel.0.run(CLAIM);
    assert_eq!(wheel.0.gateway.status.state, BoardState::Idle);
    wheel.0.mode(OperatingMode::Manual);
    wheel.0.hold(Towards::Plus, 200);
    wheel.0.run(CLAIM);
    let jogged = wheel.z();
    assert!(jogged > z + 20_000);
    wheel.0.mode(OperatingMode::Wheel);
    wheel.turn(-1);
    assert_eq!(wheel.z(), jogged - 1_000);
    assert_eq!(wheel.0.warnings, []);
}

/// A wheel that is refused says so once, and not with every detent.
#[test]
fn a_refusal_is_told_once() {
    let mut wheel = Pendant::new(OperatingMode::Wheel);
    wheel.switch(Z, true);
    let events = |wheel: &mut Pendant| {
        let Hand { sim, gateway, .. } = &mut wheel.0;
        gateway.number(sim, 0x5040, 1).unwrap()
    };
    let (z, before) = (wheel.z(), events(&mut wheel));
    wheel.0.gateway.order(&mut wheel.0.sim, Order::Hold);
    wheel.turn(100);
    assert_eq!(wheel.z(), z);
    let told = events(&mut wheel) - before;
    assert!((1..=2).contains(&told), "{told} entries in the log");
    // Nothing comes after, and once it has stood it leads again.
    wheel.0.gateway.order(&mut wheel.0.sim, Order::Resume);
    wheel.0.run(CLAIM);
    assert_eq!(wheel.z(), z);
    wheel.turn(5);
    assert_eq!(wheel.z(), z + 5_000);
}

#[test]
fn after_an_alarm_it_begins_anew_where_it_is() {
    let mut wheel = Pendant::new(OperatingMode::Wheel);
    wheel.switch(Z, true);
    wheel.turn(20);
    wheel.0.sim.turn_wheel(200);
    wheel.0.run(100);
    wheel.0.gateway.order(&mut wheel.0.sim, Order::Stop);
    wheel.0.run(1_500);
    assert_eq!(wheel.0.gateway.status.state, BoardState::Alarm);
    assert!(!wheel.0.sim.wheel_turns());
    let z = wheel.z();
    wheel.0.gateway.order(&mut wheel.0.sim, Order::Reset);
    wheel
        .0
        .until(|hand| hand.gateway.status.state == BoardState::Idle);
    wheel.0.run(RUN_OUT);
    assert_eq!(wheel.z(), z);
    wheel.turn(3);
    assert_eq!(wheel.z(), z + 3_000);
    assert!(
        wheel
            .0
            .warnings
            .iter()
            .all(|code| *code == Code::EmergencyStop)
    );
}

/// Turned to and fro at random, with any pauses: the axis ends where the detents say.
#[test]
fn no_detent_is_lost() {
    leadscrew_seed::volume(48, |seed| {
        let mut random = Random(seed);
        let mut wheel = Pendant::new(OperatingMode::Wheel);
        wheel.switch(Z, true);
        let mut expected = wheel.z();
        for _ in 0..leadscrew_seed::amount(40, 800) {
            // Never out of the travel.
            let toward = if expected > 0 { -1 } else { 1 };
            let counts = toward * random.within(-15, 44);
            expected += counts * 1_000;
            wheel.0.sim.turn_wheel(counts as i32);
            let pause = random.within(0, 899) as u64;
            while wheel.0.sim.wheel_turns() {
                wheel.0.tick();
            }
            wheel.0.run(pause);
        }
        wheel.0.run(RUN_OUT);
        assert_eq!(wheel.z(), expected);
        assert_eq!(wheel.0.warnings, []);
    });
}
