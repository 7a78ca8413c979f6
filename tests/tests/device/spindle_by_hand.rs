//! The spindle turned by hand over the bus: as long as a press lives, behind what keeps M03 from turning it.

use leadscrew_core::board::Inputs;
use leadscrew_core::bus::{BoardCommand, BoardState, Frame, JogRequest, Order};
use leadscrew_core::operating::{OperatingMode, PressState, Towards};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::Rpm;
use leadscrew_tests::gateway::{NODE, Upload};
use leadscrew_tests::machine::{calls, calls_of_line};
use leadscrew_tests::params::with;

use super::by_hand::{BRAKING, Hand, RENEWAL, WINDOW};

/// The spindle comes to any speed of these tests, or to a stand, within this, in ticks.
const RAMP: u64 = 500;

/// Inputs 1 to 3: the door, the chuck and its pressure are as they ought to be.
const WELL: u16 = 0b111;

fn inputs(levels: u16) -> Inputs {
    Inputs {
        machine: Some(levels),
        ..Inputs::default()
    }
}

fn guarded() -> Params {
    with(&[("9423", 1), ("9424", 2), ("9425", 3)])
}

impl Hand {
    fn turn(&self, towards: Option<Towards>, speed: u16) -> Frame {
        JogRequest {
            session: self.session,
            press: self.press,
            x: None,
            z: None,
            spindle: towards,
            rapid: false,
            speed,
            echo: self.gateway.beat.beat,
        }
        .frame(NODE)
    }

    /// Begins a press of the spindle and renews it for so many ticks.
    fn hold_spindle(&mut self, towards: Towards, speed: u16, ticks: u64) {
        self.press = self.press.wrapping_add(1);
        self.renew_spindle(towards, speed, ticks);
    }

    fn renew_spindle(&mut self, towards: Towards, speed: u16, ticks: u64) {
        for tick in 0..ticks {
            if tick % RENEWAL == 0 {
                let frame = self.turn(Some(towards), speed);
                self.sim.receive(&frame);
            }
            self.tick();
        }
    }

    fn commanded(&self) -> i32 {
        self.sim.board().ticker().spindle_command().get()
    }

    fn turns(&self) -> Rpm {
        self.sim.board().ticker().observer().speed().rpm()
    }

    /// Carries out a line that is typed, in its mode.
    fn line(&mut self, text: &str, params: &Params) {
        self.mode(OperatingMode::Mdi);
        for call in &calls_of_line(text, params) {
            while !self.sim.offer(call) {
                self.tick();
            }
        }
        self.run(4_000);
        self.mode(OperatingMode::Manual);
        assert_eq!(self.refused(), 0);
    }

    /// A press is refused, and nothing turns by it.
    fn turns_not(&mut self, speed: u16, number: u16, why: &str) {
        let commanded = self.commanded();
        self.hold_spindle(Towards::Plus, speed, 60);
        assert_eq!(self.refused(), number, "{why}");
        assert_eq!(self.commanded(), commanded, "{why}");
        self.run(WINDOW);
    }
}

#[test]
fn it_turns_while_the_press_is_renewed_and_stands_after_its_release() {
    for (towards, sign) in [(Towards::Plus, 1), (Towards::Minus, -1)] {
        for (speed, rpm) in [(0, 50), (120, 120)] {
            let mut hand = Hand::new(OperatingMode::Manual);
            hand.hold_spindle(towards, speed, RAMP);
            assert_eq!(hand.gateway.beat.state, PressState::Runs);
            assert_eq!(hand.gateway.status.state, BoardState::Run);
            assert_eq!(hand.turns().get(), sign * rpm);
            let release = hand.turn(None, speed);
            hand.sim.receive(&release);
            hand.run(2);
            assert_eq!(hand.commanded(), 0);
            hand.run(4 * RAMP);
            assert_eq!(hand.turns(), Rpm::STOPPED);
            assert_eq!(hand.gateway.beat.state, PressState::Ended);
            assert_eq!(hand.gateway.status.state, BoardState::Idle);
        }
    }
}

#[test]
fn the_spindle_override_acts() {
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.hold_spindle(Towards::Plus, 100, RAMP);
    for percent in [50, 120] {
        let levels = BoardCommand {
            spindle: Some(percent),
            ..BoardCommand::default()
        };
        hand.sim.receive(&levels.frame(NODE));
        hand.renew_spindle(Towards::Plus, 100, RAMP);
        assert_eq!(hand.turns().get(), i32::from(percent));
    }
}

/// The cable is out at any tick of a press: it is told to stand no later than the window after the last frame.
#[test]
fn without_frames_it_is_told_to_stand_in_time_at_every_tick_of_a_press() {
    for ticks in (1..300).step_by(leadscrew_seed::amount(23, 1)) {
        let mut hand = Hand::new(OperatingMode::Manual);
        hand.hold_spindle(Towards::Minus, 0, ticks);
        let last = ticks - (ticks - 1) % RENEWAL;
        hand.run(WINDOW + 2 - (ticks - last));
        assert_eq!(hand.commanded(), 0, "{ticks}");
        // The beat comes every 10 ms.
        hand.run(12);
        assert_eq!(hand.gateway.beat.state, PressState::Ended, "{ticks}");
        // Fresh renewals of a press that is over turn nothing.
        hand.renew_spindle(Towards::Minus, 0, 60);
        assert_eq!(hand.commanded(), 0, "{ticks}");
    }
}

#[test]
fn what_m03_has_commanded_does_not_come_back() {
    let params = Params::sheets();
    for frames in [true, false] {
        let mut hand = Hand::new(OperatingMode::Manual);
        hand.line("M3 S300\n", &params);
        assert_eq!(hand.turns().get(), 300);
        hand.hold_spindle(Towards::Minus, 0, RAMP);
        assert_eq!(hand.turns().get(), -50);
        if frames {
            let release = hand.turn(None, 0);
            hand.sim.receive(&release);
        }
        hand.run(WINDOW + 4 * RAMP);
        assert_eq!(hand.commanded(), 0);
        assert_eq!(hand.turns(), Rpm::STOPPED);
        // An axis does not bring it back, nor does the mode for lines.
        hand.hold(Towards::Minus, 60);
        hand.run(WINDOW + BRAKING);
        hand.mode(OperatingMode::Mdi);
        assert_eq!(hand.commanded(), 0);
    }
}

/// Another press, also one of an axis, ends it; one of an axis alone leaves the spindle as it is.
#[test]
fn a_press_of_an_axis_takes_its_place() {
    let params = Params::sheets();
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.hold_spindle(Towards::Plus, 0, RAMP);
    hand.hold(Towards::Minus, 100);
    assert_eq!(hand.commanded(), 0);
    assert!(hand.at().z.nm() < 0);
    hand.run(WINDOW + BRAKING);
    hand.line("M3 S300\n", &params);
    hand.hold(Towards::Minus, 100);
    hand.run(WINDOW + BRAKING);
    assert_eq!(hand.commanded(), 300);
}

#[test]
fn what_ends_a_press_ends_it_and_nothing_turns_on_by_itself() {
    type Ends = fn(&mut Hand);
    let cases: [(&str, Ends); 7] = [
        ("hold", |hand| {
            hand.gateway.order(&mut hand.sim, Order::Hold)
        }),
        ("stop", |hand| {
            hand.gateway.order(&mut hand.sim, Order::Stop)
        }),
        ("cancel", |hand| {
            hand.gateway.order(&mut hand.sim, Order::Cancel);
        }),
        ("reset", |hand| {
            hand.gateway.order(&mut hand.sim, Order::Reset);
        }),
        ("mode", |hand| {
            let mode = Order::Mode(OperatingMode::Step);
            hand.gateway.order(&mut hand.sim, mode);
        }),
        ("door", |hand| hand.sim.set_pins(inputs(WELL & !1))),
        ("chuck", |hand| hand.sim.set_pins(inputs(WELL & !2))),
    ];
    for (name, ends) in cases {
        let mut hand = Hand::on(&guarded(), OperatingMode::Manual);
        hand.sim.set_pins(inputs(WELL));
        hand.run(5);
        hand.hold_spindle(Towards::Plus, 0, RAMP);
        assert_eq!(hand.commanded(), 50, "{name}");
        ends(&mut hand);
        hand.renew_spindle(Towards::Plus, 0, 5);
        assert_eq!(hand.commanded(), 0, "{name}");
        hand.renew_spindle(Towards::Plus, 0, 100);
        // What it ended for is over.
        hand.sim.set_pins(inputs(WELL));
        hand.sets_right();
        assert_eq!(hand.gateway.status.state, BoardState::Idle, "{name}");
        hand.renew_spindle(Towards::Plus, 0, 100);
        assert_eq!(hand.commanded(), 0, "{name}");
        hand.hold_spindle(Towards::Plus, 0, 100);
        assert_eq!(hand.commanded(), 50, "{name}");
    }
}

#[test]
fn door_chuck_and_pressure_keep_it_from_turning() {
    let params = guarded();
    for pin in [1, 2, 4] {
        let mut hand = Hand::on(&params, OperatingMode::Manual);
        hand.sim.set_pins(inputs(WELL & !pin));
        hand.run(5);
        hand.turns_not(0, 4506, &format!("input {pin}"));
        hand.sim.set_pins(inputs(WELL));
        hand.run(5);
        hand.hold_spindle(Towards::Plus, 0, 60);
        assert_eq!((hand.refused(), hand.commanded()), (0, 50));
    }
}

#[test]
fn feed_hold_keeps_it_from_turning() {
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.gateway.order(&mut hand.sim, Order::Hold);
    hand.run(20);
    hand.turns_not(0, 4506, "hold");
}

#[test]
fn a_spindle_that_is_held_at_an_angle_is_let_go_first() {
    let params = Params::sheets();
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.line("M19 R90\n", &params);
    hand.turns_not(0, 4563, "M19");
    hand.line("M5\n", &params);
    hand.hold_spindle(Towards::Plus, 0, RAMP);
    assert_eq!((hand.refused(), hand.turns().get()), (0, 50));
}

/// Also where only a renewal asks for too much.
#[test]
fn it_turns_no_faster_than_the_spindle_and_its_gear() {
    let params = Params::sheets();
    let most = params.spindle_max_rpm() as u16;
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.turns_not(most + 1, 4564, "3772");
    hand.hold_spindle(Towards::Plus, most, 60);
    assert_eq!(hand.commanded(), i32::from(most));
    hand.renew_spindle(Towards::Plus, most + 1, 60);
    assert_eq!((hand.refused(), hand.commanded()), (4564, 0));
    let params = with(&[("9431", 4), ("9436", 1), ("9441", 40)]);
    let mut hand = Hand::on(&params, OperatingMode::Manual);
    hand.turns_not(0, 4554, "no gear is known");
    hand.line("M41\n", &params);
    hand.turns_not(0, 4557, "9441");
    hand.hold_spindle(Towards::Plus, 40, 60);
    assert_eq!((hand.refused(), hand.commanded()), (0, 40));
}

#[test]
fn a_jog_speed_of_0_is_no_parameter() {
    let mut params = Params::sheets();
    let entry = Entry::find_text("9049").unwrap();
    for (rpm, good) in [(0, false), (1, true), (1_000, true), (1_001, false)] {
        assert_eq!(params.set(entry, rpm).is_ok(), good, "{rpm}");
    }
}

#[test]
fn other_modes_and_programs_keep_it_from_turning() {
    for mode in OperatingMode::ALL {
        if mode != OperatingMode::Manual {
            Hand::new(mode).turns_not(0, 4501, mode.name());
        }
    }
    let params = Params::sheets();
    let mut hand = Hand::new(OperatingMode::Automatic);
    let text = "M3 S300\nG98 G1 X40 Z-100 F500\nM30\n";
    Upload::new(1, &calls(text, &params)).feed(&mut hand.gateway, &mut hand.sim);
    hand.gateway.order(&mut hand.sim, Order::Run);
    hand.run(1_000);
    assert_eq!(hand.commanded(), 300);
    hand.turns_not(0, 4502, "a program under way");
    hand.gateway.order(&mut hand.sim, Order::Hold);
    hand.run(500);
    hand.turns_not(0, 4502, "a program that is held");
    // It is left: its axes move, its spindle is needed as it is.
    hand.mode(OperatingMode::Manual);
    hand.gateway.order(&mut hand.sim, Order::Resume);
    hand.run(50);
    hand.turns_not(0, 4502, "a program that was left");
    hand.hold(Towards::Plus, 60);
    assert_eq!((hand.refused(), hand.commanded()), (0, 300));
}
