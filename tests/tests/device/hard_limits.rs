//! Hard limit switches: what an axis does that comes onto one, and how it is moved off it over the bus.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::State;
use leadscrew_core::bus::{BoardState, JogRequest, Order};
use leadscrew_core::call::Call;
use leadscrew_core::operating::{Led, OperatingMode, PressState, Towards, WheelFactor};
use leadscrew_core::params::{Contact, Params};
use leadscrew_core::units::{Axis, Length};
use leadscrew_seed::{amount, volume};
use leadscrew_tests::gateway::{NODE, Upload};
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::by_hand::{BRAKING, Hand, RENEWAL, WINDOW};

/// Inputs 5 to 8: X-, X+, Z-, Z+; on while their contacts are open.
const WIRED: [(&str, i64); 5] = [
    ("9064.X", 5),
    ("9065.X", 6),
    ("9064.Z", 7),
    ("9065.Z", 8),
    ("9421", 0b1111_0000),
];

const ENDS: [(Axis, Towards, u8); 4] = [
    (Axis::X, Towards::Minus, 5),
    (Axis::X, Towards::Plus, 6),
    (Axis::Z, Towards::Minus, 7),
    (Axis::Z, Towards::Plus, 8),
];

/// A switch counts as off after so many ticks.
const CALM: u64 = 40;

fn wired() -> Params {
    with(&WIRED)
}

impl Hand {
    fn contact(&mut self, input: u8, on: Option<bool>) {
        let contact = Contact::new(input).unwrap();
        self.sim.around().set(contact, on);
    }

    pub(super) fn along(&self, axis: Axis) -> i64 {
        let at = self.at();
        match axis {
            Axis::X => at.x.nm(),
            _ => at.z.nm(),
        }
    }

    /// A new press of this axis at so many mm/min, renewed for so many ticks, and let go.
    fn push(&mut self, axis: Axis, towards: Towards, mm_per_min: u16, ticks: u64) {
        for tick in 0..ticks {
            self.press_on(axis, towards, mm_per_min, tick);
            self.tick();
        }
    }

    /// What whoever presses says in this tick of a press.
    pub(super) fn press_on(&mut self, axis: Axis, towards: Towards, mm_per_min: u16, tick: u64) {
        if tick == 0 {
            self.press = self.press.wrapping_add(1);
        }
        if tick.is_multiple_of(RENEWAL) {
            let frame = JogRequest {
                session: self.session,
                press: self.press,
                x: (axis == Axis::X).then_some(towards),
                z: (axis == Axis::Z).then_some(towards),
                spindle: None,
                rapid: false,
                speed: mm_per_min,
                echo: self.gateway.beat.beat,
            };
            self.sim.receive(&frame.frame(NODE));
        }
    }

    fn alarm(&self) -> Option<Alarm> {
        match self.sim.board().ticker().state() {
            State::Alarm(alarm) => Some(alarm),
            _ => None,
        }
    }

    fn reset(&mut self) {
        self.gateway.order(&mut self.sim, Order::Reset);
        self.until(|hand| hand.gateway.status.state == BoardState::Idle);
    }
}

fn sign(towards: Towards) -> u8 {
    match towards {
        Towards::Minus => b'-',
        Towards::Plus => b'+',
    }
}

/// What is said of this end.
fn names(axis: Axis, towards: Towards) -> [Arg; 4] {
    let figures = [axis.letter(), sign(towards), sign(towards.opposite())];
    let [axis, side, back] = figures.map(Arg::Letter);
    [axis, side, back, Arg::None]
}

/// The fastest press of these tests, in mm/min.
const FASTEST: i64 = 5_000;

/// The longest way to rest in nm after a press of so many mm/min has moved its axis by `moved` nm.
///
/// The ramp has room for an override of 150 %, up to the fastest press. At full speed the way is half of the ramp's time
/// at that speed. A ramp that has just begun gets faster still while its acceleration goes: the whole press, up and
/// down, takes no more than the ramp's time at full speed.
fn way_to_rest(axis: Axis, mm_per_min: i64, moved: i64) -> f64 {
    /// Ticks until the board has seen the switch and the axis brakes.
    const SEEN: f64 = 2.0;
    let nm_per_ms = |mm_per_min: i64| mm_per_min as f64 / 0.06;
    let params = wired();
    let acceleration = params.acceleration(axis).nm_per_s2() as f64 / 1e6;
    let jerk = params.jerk(axis).nm_per_s3() as f64 / 1e9;
    let top = nm_per_ms(FASTEST.min(mm_per_min * 3 / 2));
    let rise = f64::min(acceleration / jerk, (top / jerk).sqrt());
    let ramp = rise.ceil() + (top / (rise * jerk)).ceil();
    let speed = nm_per_ms(mm_per_min);
    speed * (SEEN + f64::max(ramp / 2.0, ramp - moved as f64 / speed))
}

/// Whichever end, from whatever speed: the axis rests in the way of its ramps, on an alarm with its name; then it moves
/// away only, and slowly, by press, step and handwheel.
#[test]
fn an_axis_brakes_at_its_switch_and_moves_away_from_it_only() {
    volume(0x4542, |seed| {
        let mut random = Random(seed);
        for round in 0..amount(8, 120) {
            let (axis, towards, input) = ENDS[round % 4];
            let what = format!("{round}: {axis:?} {towards:?}");
            let mut hand = Hand::on(&wired(), OperatingMode::Manual);
            let speed = random.within(60, FASTEST);
            let began = hand.along(axis);
            hand.push(axis, towards, speed as u16, random.within(1, 900) as u64);
            let before = hand.along(axis);
            hand.contact(input, Some(true));
            hand.push(axis, towards, speed as u16, BRAKING);
            let alarm = hand.alarm().expect(&what);
            assert_eq!(alarm.code, Code::HardLimit, "{what}");
            assert_eq!(alarm.args, names(axis, towards), "{what}");
            let way = (hand.along(axis) - before).abs();
            let longest = way_to_rest(axis, speed, (before - began).abs());
            assert!(
                way as f64 <= longest,
                "{what}: {way} nm, at most {longest:.0}"
            );
            // Its renewals say what has ended it.
            assert_eq!(hand.gateway.beat.state, PressState::Refused, "{what}");
            assert_eq!(hand.refused(), 4542, "{what}");
            hand.stands(50);
            hand.reset();
            hand.stands(100);
            leave(&mut hand, (axis, towards, input), &what);
        }
    });
}

/// The axis stands at its switch, ready: what is let in and what is not.
fn leave(hand: &mut Hand, (axis, towards, input): (Axis, Towards, u8), what: &str) {
    let at = hand.along(axis);
    let away = towards.opposite();
    let refused = |hand: &Hand, by: &str| {
        assert_eq!(hand.along(axis), at, "{what} {by}");
        assert_eq!(hand.refused(), 4542, "{what} {by}");
        assert_eq!(hand.gateway.beat.state, PressState::Refused, "{what} {by}");
        assert_eq!(hand.alarm(), None, "{what} {by}");
    };
    hand.push(axis, towards, 500, 100);
    refused(hand, "press");
    hand.mode(OperatingMode::Step);
    let step = |hand: &mut Hand, side: Towards| {
        hand.press = hand.press.wrapping_add(1);
        let way = if side == Towards::Plus { 1_000 } else { -1_000 };
        let frame = hand.step(axis == Axis::Z, way);
        hand.sim.receive(&frame);
        hand.run(200);
    };
    step(hand, towards);
    refused(hand, "step");
    // The other axis is free.
    let other = if axis == Axis::X { Axis::Z } else { Axis::X };
    let stood = hand.along(other);
    hand.press = hand.press.wrapping_add(1);
    let frame = hand.step(other == Axis::Z, 1_000);
    hand.sim.receive(&frame);
    hand.run(200);
    assert_eq!(hand.along(other) - stood, 100_000, "{what}");
    step(hand, away);
    assert_eq!((hand.along(axis) - at).abs(), 100_000, "{what}");
    // Back is refused while the switch is still on.
    let at = hand.along(axis);
    step(hand, towards);
    assert_eq!((hand.along(axis), hand.refused()), (at, 4542), "{what}");
    hand.run(WINDOW + BRAKING);
    hand.mode(OperatingMode::Wheel);
    hand.press = hand.press.wrapping_add(1);
    let led = if axis == Axis::X { Led::X } else { Led::Z };
    let mut count = 0_u16;
    let mut turn = |hand: &mut Hand, counts: i16, frames: u32| {
        for _ in 0..frames {
            count = count.wrapping_add_signed(counts);
            let frame = hand.wheel(led, WheelFactor::Ten, count);
            hand.sim.receive(&frame);
            let before = hand.along(axis);
            hand.run(RENEWAL);
            // Never a nanometre back.
            let way = hand.along(axis) - before;
            assert!(
                if away == Towards::Plus {
                    way >= 0
                } else {
                    way <= 0
                },
                "{what}"
            );
        }
    };
    let out = if away == Towards::Plus { 1 } else { -1 };
    turn(hand, 0, 2);
    turn(hand, 5 * out, 10);
    turn(hand, 0, 15);
    let off = (hand.along(axis) - at).abs();
    assert!(off >= 20_000, "{what}: {off}");
    // Turned back, it stands.
    turn(hand, -2 * out, 5);
    turn(hand, 0, 15);
    // More than it was turned away: that is a way towards the switch.
    turn(hand, -20 * out, 5);
    assert_eq!(hand.refused(), 4542, "{what}");
    hand.run(WINDOW + BRAKING);
    // Off the switch, all is free again; on the way it may bounce.
    hand.mode(OperatingMode::Manual);
    let before = hand.along(axis);
    hand.push(axis, away, 5_000, 200);
    // As slow as 9043.
    let way = (hand.along(axis) - before).abs();
    assert!(way <= 3_400_000, "{what}: {way}");
    for on in [false, true, false, true, false] {
        hand.contact(input, Some(on));
        hand.push(axis, away, 500, 20);
    }
    assert_eq!(hand.alarm(), None, "{what}");
    hand.run(CALM + WINDOW + BRAKING);
    let at = hand.along(axis);
    hand.push(axis, towards, 500, 100);
    assert_ne!(hand.along(axis), at, "{what}");
    assert_eq!(hand.refused(), 0, "{what}");
    assert_eq!(hand.alarm(), None, "{what}");
}

fn load(hand: &mut Hand, number: u32, given: &[Call]) {
    Upload::new(number, given).feed(&mut hand.gateway, &mut hand.sim);
}

/// A program is stopped, and none moves an axis while one stands at a switch.
#[test]
fn a_program_stops_and_none_begins() {
    let params = wired();
    for program in ["G0 Z-200\n", "G98 G1 Z-50 F500\n", "G1 X-20 Z-20 F300\n"] {
        let mut hand = Hand::on(&params, OperatingMode::Automatic);
        let given = calls(program, &params);
        load(&mut hand, 1, &given);
        hand.gateway.order(&mut hand.sim, Order::Run);
        hand.run(150);
        let before = hand.at();
        hand.contact(7, Some(true));
        hand.run(BRAKING);
        let alarm = hand.alarm().expect(program);
        assert_eq!(alarm.args, names(Axis::Z, Towards::Minus), "{program}");
        assert!(
            (hand.at().z - before.z).nm().abs() < 25_000_000,
            "{program}"
        );
        hand.reset();
        // A new one is refused before it begins, whatever way it goes.
        let given = calls("G0 Z0\n", &params);
        load(&mut hand, 2, &given);
        hand.gateway.order(&mut hand.sim, Order::Run);
        let at = hand.at();
        hand.run(100);
        assert_eq!((hand.at(), hand.refused()), (at, 4542), "{program}");
        assert_eq!(hand.alarm(), None, "{program}");
    }
}

/// A wire that breaks is a switch that is on, also while nothing moves.
#[test]
fn a_broken_wire_is_a_hit() {
    let mut hand = Hand::on(&wired(), OperatingMode::Manual);
    hand.run(200);
    assert_eq!(hand.alarm(), None);
    // The level of a contact that opens.
    hand.contact(8, Some(true));
    hand.run(5);
    let alarm = hand.alarm().expect("an alarm");
    assert_eq!(alarm.args, names(Axis::Z, Towards::Plus));
    hand.run(40);
    hand.reset();
    hand.push(Axis::Z, Towards::Plus, 500, 60);
    assert_eq!((hand.refused(), hand.along(Axis::Z)), (4542, 0));
}

/// The switches of the simulated machine stand 5 mm beyond its travel, which an axis without a reference may leave.
#[test]
fn the_simulated_machine_has_switches_beyond_its_travel() {
    let mut values = WIRED.to_vec();
    values.extend([("1321.Z", -10_000_000), ("9050.Z", 1)]);
    let mut hand = Hand::on(&with(&values), OperatingMode::Manual);
    let from = hand.at().z;
    hand.push(Axis::Z, Towards::Minus, 1_000, 1_500);
    assert_eq!(hand.alarm().map(|alarm| alarm.code), Some(Code::HardLimit));
    let gone = (from - hand.at().z).nm();
    assert!((15_000_000..16_000_000).contains(&gone), "{gone}");
    hand.reset();
    hand.push(Axis::Z, Towards::Plus, 1_000, 300);
    hand.run(WINDOW + BRAKING);
    assert!(hand.at().z - from > Length::from_nm(-15_000_000));
    assert_eq!(hand.alarm(), None);
}
