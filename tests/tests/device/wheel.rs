//! An axis that a handwheel leads over the bus.

use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{BoardState, Order};
use leadscrew_core::operating::{Led, OperatingMode, PressState, WheelFactor};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};
use leadscrew_tests::params::set;

use super::by_hand::{BRAKING, Hand, RENEWAL, WINDOW};

/// No axis takes longer from the last count to its rest, in ticks.
const RUN_OUT: u64 = 300;

/// A wheel that is turned by the hand of the other tests.
struct Wheel {
    hand: Hand,
    on_z: bool,
    factor: WheelFactor,
    count: u16,
}

impl Wheel {
    fn new(mode: OperatingMode) -> Self {
        Self::at_machine(mode, &Params::slant_bed())
    }

    fn at_machine(mode: OperatingMode, params: &Params) -> Self {
        let mut hand = Hand::on(params, mode);
        hand.press = 1;
        Self {
            hand,
            on_z: true,
            factor: WheelFactor::Ten,
            // It wraps within the first counts.
            count: 65_530,
        }
    }

    fn send(&mut self) {
        let leads = if self.on_z { Led::Z } else { Led::X };
        let frame = self.hand.wheel(leads, self.factor, self.count);
        self.hand.sim.receive(&frame);
    }

    /// Turns by so many counts in each of so many frames.
    fn turn(&mut self, counts: i16, frames: u32) {
        for _ in 0..frames {
            self.count = self.count.wrapping_add_signed(counts);
            self.send();
            self.hand.run(RENEWAL);
        }
    }

    fn z(&self) -> i64 {
        self.hand.at().z.nm()
    }

    fn x(&self) -> i64 {
        self.hand.at().x.nm()
    }
}

#[test]
fn an_axis_goes_as_far_as_the_wheel_is_turned_in_the_unit_of_its_factor() {
    let mut wheel = Wheel::new(OperatingMode::Wheel);
    for (on_z, factor, nm) in [
        (true, WheelFactor::One, 1_000),
        (true, WheelFactor::Ten, 10_000),
        (true, WheelFactor::Hundred, 100_000),
        // X counts on the diameter.
        (false, WheelFactor::One, 500),
        (false, WheelFactor::Hundred, 50_000),
    ] {
        wheel.hand.press += 1;
        (wheel.on_z, wheel.factor) = (on_z, factor);
        let (x, z) = (wheel.x(), wheel.z());
        wheel.turn(0, 3);
        assert_eq!(wheel.hand.gateway.beat.state, PressState::Runs);
        wheel.turn(-5, 10);
        wheel.turn(2, 10);
        wheel.turn(0, 15);
        let gone = if on_z { wheel.z() - z } else { wheel.x() - x };
        assert_eq!(gone, -30 * nm, "{factor:?}");
    }
    assert_eq!(wheel.hand.refused(), 0);
    // The other axis needs a claim of its own.
    wheel.on_z = true;
    let z = wheel.z();
    wheel.turn(5, 10);
    assert_eq!(wheel.z(), z);
}

#[test]
fn only_its_mode_lets_a_wheel_in_and_nothing_else_moves_there() {
    for mode in OperatingMode::ALL {
        let mut wheel = Wheel::new(mode);
        wheel.turn(0, 2);
        wheel.turn(-5, 20);
        let led = mode == OperatingMode::Wheel;
        assert_eq!(wheel.hand.refused(), if led { 0 } else { 4501 }, "{mode:?}");
        assert_eq!(wheel.z() < 0, led, "{mode:?}");
    }
}

/// The first frame of a claim moves nothing, nor does a count that the wheel cannot have gone to since the last frame.
#[test]
fn a_new_claim_and_a_wheel_that_was_away_count_from_where_it_is() {
    let mut wheel = Wheel::new(OperatingMode::Wheel);
    wheel.turn(-5, 1);
    wheel.hand.stands(RUN_OUT);
    wheel.hand.press += 1;
    wheel.count = 12_345;
    wheel.turn(0, 5);
    assert_eq!(wheel.z(), 0);
    for away in [16_385, -16_385, i16::MIN] {
        wheel.turn(away, 1);
        wheel.turn(0, 15);
        assert_eq!(wheel.z(), 0, "{away}");
    }
    wheel.turn(-1, 1);
    wheel.turn(0, 15);
    assert_eq!(wheel.z(), -10_000);
}

/// The link is lost at any moment: the target freezes, and nothing that comes later is made up for.
#[test]
fn without_frames_an_axis_rests_and_the_counts_since_are_lost() {
    for frames in (1..30).step_by(leadscrew_seed::amount(7, 1)) {
        let mut wheel = Wheel::new(OperatingMode::Wheel);
        wheel.turn(0, 1);
        wheel.turn(-20, frames);
        wheel.hand.run(WINDOW + RUN_OUT);
        assert_eq!(wheel.hand.gateway.status.state, BoardState::Idle);
        assert_eq!(wheel.hand.gateway.beat.state, PressState::Ended);
        // All that came, though the wheel is at its highest speed nearly.
        assert_eq!(wheel.z(), -200_000 * i64::from(frames));
        let z = wheel.z();
        wheel.turn(-20, 10);
        assert_eq!(wheel.z(), z);
        // A new claim goes on from there.
        wheel.hand.press += 1;
        wheel.turn(0, 1);
        wheel.turn(-1, 1);
        wheel.turn(0, 15);
        assert_eq!(wheel.z(), z - 10_000);
    }
}

/// A frame that sat in a queue for seconds leads nothing.
#[test]
fn an_old_frame_leads_nothing() {
    let mut wheel = Wheel::new(OperatingMode::Wheel);
    let echo = wheel.hand.gateway.beat.beat;
    wheel.turn(0, 1);
    wheel.hand.run(3_000);
    wheel.hand.gateway.beat.beat = echo;
    wheel.hand.press += 1;
    wheel.send();
    wheel.count = wheel.count.wrapping_sub(50);
    wheel.send();
    wheel.hand.stands(RUN_OUT);
}

#[test]
fn a_hold_an_alarm_and_a_change_of_mode_end_a_claim() {
    for order in [
        Order::Hold,
        Order::Stop,
        Order::Cancel,
        Order::Reset,
        Order::Mode(OperatingMode::Manual),
    ] {
        let mut wheel = Wheel::new(OperatingMode::Wheel);
        wheel.turn(0, 1);
        wheel.turn(-10, 10);
        wheel.hand.gateway.order(&mut wheel.hand.sim, order);
        wheel.hand.run(RUN_OUT);
        let z = wheel.z();
        wheel.turn(-10, 10);
        assert_eq!(wheel.z(), z, "{order:?}");
        for order in [
            Order::Reset,
            Order::Resume,
            Order::Mode(OperatingMode::Wheel),
        ] {
            wheel.hand.gateway.order(&mut wheel.hand.sim, order);
            wheel.hand.run(200);
        }
        wheel.turn(-10, 10);
        assert_eq!(wheel.z(), z, "{order:?}");
        assert_eq!(wheel.hand.gateway.status.state, BoardState::Idle);
    }
}

#[test]
fn the_travel_ends_exactly_and_a_second_operator_waits() {
    let mut wheel = Wheel::new(OperatingMode::Wheel);
    wheel.factor = WheelFactor::Hundred;
    wheel.on_z = false;
    let params = wheel.hand.sim.board().params();
    let end = params.soft_limit_plus(Axis::X);
    wheel.turn(0, 1);
    let frames = end / 1_000_000 + 20;
    wheel.turn(20, frames as u32);
    wheel.turn(0, 15);
    assert_eq!(wheel.hand.at().x, Length::from_nm(end));
    assert_eq!(wheel.hand.refused(), 0);
    // Another one, while the claim is alive.
    let own = wheel.hand.session;
    (wheel.hand.session, wheel.hand.press) = (2, 77);
    wheel.send();
    wheel.hand.run(20);
    assert_eq!(wheel.hand.refused(), 4505);
    assert_eq!(wheel.hand.gateway.beat.session, own);
    wheel.hand.run(2 * WINDOW + BRAKING);
    wheel.turn(0, 1);
    wheel.turn(-1, 1);
    wheel.turn(0, 15);
    assert_eq!(wheel.hand.at().x, Length::from_nm(end - 50_000));
}

/// Ten times as fast as its axis: what is turned in 50 ms is followed, and what 9045 says where 9044.0 is 1.
#[test]
fn a_wheel_that_is_too_fast_is_told_of_where_it_is_followed() {
    for (follows, lag, told) in [(0, 0, 0), (1, 0, 1), (1, 7_000_000, 1), (1, 100_000_000, 0)] {
        let mut params = Params::slant_bed();
        set(&mut params, "9044.0", follows);
        set(&mut params, "9045", lag);
        let mut wheel = Wheel::at_machine(OperatingMode::Wheel, &params);
        wheel.factor = WheelFactor::Hundred;
        wheel.turn(0, 1);
        wheel.turn(-100, 8);
        wheel.turn(0, 150);
        // 3 m/min in 7 renewals, and what was still to come then.
        let least = 7_000_000 + 2_500_000 + lag;
        let z = -wheel.z();
        let wanted = least.min(80_000_000);
        assert!((wanted..=wanted + 1_000_000).contains(&z), "{z} {lag}");
        assert_eq!(wheel.hand.warnings, vec![Code::WheelTooFast; told]);
    }
}

/// IS-C: a count is a tenth of that.
#[test]
fn a_count_is_an_input_increment() {
    let mut wheel = Wheel::at_machine(OperatingMode::Wheel, &Params::sheets());
    wheel.turn(0, 1);
    wheel.turn(-3, 10);
    wheel.turn(0, 15);
    assert_eq!(wheel.z(), -30_000);
}
