//! Axes that are moved by hand over the bus: modes, presses, steps, and the dead man.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::Event;
use leadscrew_core::bus::{
    BoardState, Frame, JogRequest, Object, Order, SdoProtocol, StepRequest, WheelRequest,
};
use leadscrew_core::call::Position;
use leadscrew_core::operating::{Led, OperatingMode, PressState, Towards, WheelFactor};
use leadscrew_core::params::Params;
use leadscrew_core::units::Length;
use leadscrew_tests::gateway::{Gateway, NODE, Upload};
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::random::Random;

/// A frame of a press comes so often, in ticks.
pub(super) const RENEWAL: u64 = 20;
/// Parameter 9040.
pub(super) const WINDOW: u64 = 100;
/// No axis of the built-in machine takes longer to brake from the speed of these tests, in ticks.
pub(super) const BRAKING: u64 = 150;

pub(super) struct Hand {
    pub sim: Sim,
    pub gateway: Gateway,
    pub(super) session: u8,
    pub press: u8,
    pub(super) ticks: u64,
    pub warnings: Vec<Code>,
}

impl Hand {
    pub(super) fn new(mode: OperatingMode) -> Self {
        Self::on(&Params::sheets(), mode)
    }

    pub fn on(params: &Params, mode: OperatingMode) -> Self {
        let mut sim = machine(params, &PlantOptions::default());
        let gateway = Gateway::connect(&mut sim);
        let mut hand = Self {
            sim,
            gateway,
            session: 1,
            press: 0,
            ticks: 0,
            warnings: Vec::new(),
        };
        hand.until(|hand| hand.gateway.status.state == BoardState::Idle);
        hand.mode(mode);
        hand
    }

    pub fn mode(&mut self, mode: OperatingMode) {
        self.gateway.order(&mut self.sim, Order::Mode(mode));
        self.run(20);
    }

    /// What a press ended for is over: reset, gone on, and manual mode.
    pub fn sets_right(&mut self) {
        for order in [
            Order::Reset,
            Order::Resume,
            Order::Mode(OperatingMode::Manual),
        ] {
            self.gateway.order(&mut self.sim, order);
            self.run(200);
        }
    }

    pub fn tick(&mut self) {
        self.ticks += 1;
        self.sim.step();
        while let Some(event) = self.sim.event() {
            if let Event::Warning(alarm) | Event::Alarm(alarm) = event {
                self.warnings.push(alarm.code);
            }
        }
        self.gateway.listen(&mut self.sim);
    }

    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    pub fn until(&mut self, done: impl Fn(&Self) -> bool) {
        for _ in 0..5_000 {
            if done(self) {
                return;
            }
            self.tick();
        }
        panic!("it does not come to pass: {:?}", self.gateway.beat);
    }

    pub fn at(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    /// A press of the present number, with the newest beat that was heard.
    pub fn jog(&self, x: Option<Towards>, z: Option<Towards>) -> Frame {
        JogRequest {
            session: self.session,
            press: self.press,
            x,
            z,
            spindle: None,
            rapid: false,
            speed: 1_000,
            echo: self.gateway.beat.beat,
        }
        .frame(NODE)
    }

    pub fn step(&self, on_z: bool, way: i32) -> Frame {
        StepRequest {
            session: self.session,
            count: self.press,
            on_z,
            way,
            echo: self.gateway.beat.beat,
        }
        .frame(NODE)
    }

    /// A handwheel of the present claim that shows this count.
    pub fn wheel(&self, leads: Led, factor: WheelFactor, count: u16) -> Frame {
        WheelRequest {
            session: self.session,
            leads,
            factor,
            claim: self.press,
            count,
            echo: self.gateway.beat.beat,
        }
        .frame(NODE)
    }

    /// Begins a press and renews it for so many ticks. The frames that were sent come back.
    pub(super) fn hold(&mut self, z: Towards, ticks: u64) -> Vec<Frame> {
        self.press = self.press.wrapping_add(1);
        let mut sent = Vec::new();
        for tick in 0..ticks {
            if tick % RENEWAL == 0 {
                let frame = self.jog(None, Some(z));
                self.sim.receive(&frame);
                sent.push(frame);
            }
            self.tick();
        }
        sent
    }

    /// Nothing moves for so many ticks.
    pub fn stands(&mut self, ticks: u64) {
        let at = self.at();
        for _ in 0..ticks {
            self.tick();
            assert_eq!(self.at(), at);
        }
    }

    pub fn refused(&self) -> u16 {
        self.gateway.beat.refused
    }
}

#[test]
fn an_axis_moves_while_the_press_is_renewed_and_rests_after_its_release() {
    let mut hand = Hand::new(OperatingMode::Manual);
    let from = hand.at();
    hand.hold(Towards::Minus, 600);
    assert_eq!(hand.gateway.status.state, BoardState::Run);
    assert_eq!(hand.gateway.beat.state, PressState::Runs);
    // 1 m/min is 16.7 µm in a tick.
    let gone = (from.z - hand.at().z).nm();
    assert!((8_000_000..10_000_000).contains(&gone), "{gone}");
    let release = hand.jog(None, None);
    hand.sim.receive(&release);
    hand.run(BRAKING);
    assert_eq!(hand.gateway.beat.state, PressState::Ended);
    assert_eq!(hand.gateway.status.state, BoardState::Idle);
    hand.stands(200);
}

/// The cable is out at any tick of a press: at rest no later than the window and the braking time after the last frame.
#[test]
fn without_frames_the_axis_rests_in_time_at_every_tick_of_a_press() {
    for ticks in (1..300).step_by(leadscrew_seed::amount(23, 1)) {
        let mut hand = Hand::new(OperatingMode::Manual);
        hand.hold(Towards::Minus, ticks);
        let last = ticks - (ticks - 1) % RENEWAL;
        hand.run(WINDOW + BRAKING - (ticks - last));
        assert_eq!(hand.gateway.status.state, BoardState::Idle, "{ticks}");
        hand.stands(50);
    }
}

/// Frames that come late, twice, in another order, or after seconds in a queue move nothing once the press is over.
#[test]
fn what_was_in_a_queue_moves_nothing() {
    leadscrew_seed::volume(31, |seed| {
        let mut random = Random(seed);
        for _ in 0..leadscrew_seed::amount(2, 12) {
            let mut hand = Hand::new(OperatingMode::Manual);
            let mut sent = hand.hold(Towards::Minus, random.within(50, 349) as u64);
            sent.extend(hand.hold(Towards::Plus, random.within(50, 349) as u64));
            if random.chance(50) {
                let release = hand.jog(None, None);
                hand.sim.receive(&release);
            }
            hand.run(WINDOW + BRAKING);
            hand.run(random.within(0, 3_999) as u64);
            let at = hand.at();
            for _ in 0..100 {
                let frame = random.of(&sent);
                hand.sim.receive(&frame);
                hand.run(random.within(0, 29) as u64);
                assert_eq!(hand.at(), at, "seed {seed}");
            }
        }
    });
}

/// Two ways lead to the board: a release that comes before the frames of its press, at rest or under way.
#[test]
fn a_press_whose_release_has_overtaken_it_moves_nothing() {
    for under_way in [false, true] {
        let mut hand = Hand::new(OperatingMode::Manual);
        if under_way {
            hand.hold(Towards::Plus, 100);
        }
        hand.press = hand.press.wrapping_add(1);
        let release = hand.jog(None, None);
        hand.sim.receive(&release);
        hand.run(if under_way { BRAKING } else { 1 });
        for _ in 0..20 {
            let late = hand.jog(None, Some(Towards::Minus));
            hand.sim.receive(&late);
            hand.stands(RENEWAL);
        }
        assert_eq!(hand.gateway.beat.state, PressState::Refused);
        assert_eq!((hand.gateway.beat.press, hand.refused()), (hand.press, 0));
        // The next one moves, of this session and of another.
        let at = hand.at();
        hand.hold(Towards::Minus, 100);
        assert!(hand.at().z < at.z);
        let release = hand.jog(None, None);
        hand.sim.receive(&release);
        hand.run(WINDOW + BRAKING + RENEWAL);
        (hand.session, hand.press) = (2, 7);
        let at = hand.at();
        hand.hold(Towards::Minus, 100);
        assert!(hand.at().z < at.z);
    }
}

/// A press that has ended for want of frames: fresh renewals of the same number move nothing, a new number does.
#[test]
fn a_press_that_has_ended_is_dead() {
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.hold(Towards::Minus, 100);
    hand.run(WINDOW + BRAKING);
    for _ in 0..20 {
        let frame = hand.jog(None, Some(Towards::Minus));
        hand.sim.receive(&frame);
        hand.stands(RENEWAL);
    }
    let at = hand.at();
    hand.hold(Towards::Minus, 100);
    assert!(hand.at().z < at.z);
}

#[test]
fn a_hold_an_alarm_and_a_change_of_mode_end_a_press_and_nothing_goes_on_by_itself() {
    for order in [
        Order::Hold,
        Order::Stop,
        Order::Cancel,
        Order::Reset,
        Order::Mode(OperatingMode::Step),
    ] {
        let mut hand = Hand::new(OperatingMode::Manual);
        hand.hold(Towards::Minus, 200);
        hand.gateway.order(&mut hand.sim, order);
        hand.run(BRAKING);
        let renewals = |hand: &mut Hand| {
            for _ in 0..10 {
                let frame = hand.jog(None, Some(Towards::Minus));
                hand.sim.receive(&frame);
                hand.stands(RENEWAL);
            }
        };
        renewals(&mut hand);
        hand.sets_right();
        assert_eq!(hand.gateway.status.state, BoardState::Idle, "{order:?}");
        renewals(&mut hand);
    }
}

#[test]
fn every_mode_lets_in_what_is_its_own() {
    for mode in OperatingMode::ALL {
        let mut hand = Hand::new(mode);
        hand.hold(Towards::Minus, 100);
        let jogs = mode == OperatingMode::Manual;
        assert_eq!(hand.refused(), if jogs { 0 } else { 4501 }, "{mode:?}");
        assert_eq!(hand.at().z < Length::ZERO, jogs, "{mode:?}");
        hand.run(WINDOW + BRAKING);
        let at = hand.at();
        hand.press += 1;
        let step = hand.step(true, -1_000);
        hand.sim.receive(&step);
        hand.run(300);
        let steps = mode == OperatingMode::Step;
        assert_eq!(hand.refused(), if steps { 0 } else { 4501 }, "{mode:?}");
        let gone = at.z - hand.at().z;
        let wanted = if steps { 100_000 } else { 0 };
        assert_eq!(gone, Length::from_nm(wanted), "{mode:?}");
    }
}

#[test]
fn steps_are_made_whole_and_one_that_leaves_the_travel_not_at_all() {
    let mut hand = Hand::new(OperatingMode::Step);
    let at = hand.at();
    // Four steps of 1 mm, each twice; a fifth does not wait.
    for _ in 0..5 {
        hand.press += 1;
        let step = hand.step(true, -10_000);
        hand.sim.receive(&step);
        hand.sim.receive(&step);
        hand.run(12);
    }
    assert_eq!(hand.refused(), 4511);
    hand.run(1_000);
    assert_eq!(at.z - hand.at().z, Length::from_nm(4_000_000));
    // The travel of X ends somewhere within 800 mm.
    let at = hand.at();
    hand.press += 1;
    let step = hand.step(false, 8_000_000);
    hand.sim.receive(&step);
    hand.run(100);
    assert_eq!(hand.refused(), 4540);
    assert_eq!(hand.at(), at);
    // A long step needs its frame renewed.
    hand.press += 1;
    for _ in 0..10 {
        let step = hand.step(true, -500_000);
        hand.sim.receive(&step);
        hand.run(RENEWAL);
    }
    hand.run(WINDOW + BRAKING);
    assert_eq!(hand.gateway.status.state, BoardState::Idle);
    let gone = (at.z - hand.at().z).nm();
    assert!((1_000_000..20_000_000).contains(&gone), "{gone}");
}

#[test]
fn one_session_moves_the_machine_at_a_time() {
    let mut hand = Hand::new(OperatingMode::Manual);
    hand.hold(Towards::Minus, 100);
    let (own, press) = (hand.session, hand.press);
    (hand.session, hand.press) = (2, 77);
    let other = hand.jog(Some(Towards::Minus), None);
    hand.sim.receive(&other);
    hand.run(30);
    assert_eq!(hand.refused(), 4505);
    assert_eq!(hand.gateway.beat.session, own);
    assert_eq!(hand.gateway.beat.press, press);
    assert_eq!(hand.gateway.beat.state, PressState::Runs);
    assert_eq!(hand.at().x, Length::ZERO);
    // After the window it is free.
    hand.run(2 * WINDOW + BRAKING);
    let other = hand.jog(Some(Towards::Minus), None);
    hand.sim.receive(&other);
    hand.run(60);
    assert_eq!(hand.gateway.beat.session, 2);
    assert!(hand.at().x < Length::ZERO);
}

#[test]
fn a_program_under_way_refuses_and_goes_on() {
    let mut hand = Hand::new(OperatingMode::Automatic);
    let params = Params::sheets();
    let text = "G98 G1 X40 Z-100 F500\nM30\n";
    Upload::new(1, &calls(text, &params)).feed(&mut hand.gateway, &mut hand.sim);
    hand.gateway.order(&mut hand.sim, Order::Run);
    hand.run(200);
    for order in [Order::Mode(OperatingMode::Manual), Order::Run] {
        hand.gateway.order(&mut hand.sim, order);
        hand.run(20);
        assert_eq!(hand.refused(), 4502);
    }
    hand.hold(Towards::Plus, 40);
    assert_eq!(hand.refused(), 4502);
    assert_eq!(hand.gateway.status.state, BoardState::Run);
}

/// An order that has waited in a queue for longer than 9047 starts nothing, nor does one without an echo.
#[test]
fn an_old_order_starts_nothing() {
    use leadscrew_core::bus::BoardCommand;
    let mut hand = Hand::new(OperatingMode::Automatic);
    let params = Params::sheets();
    let text = "G98 G1 X40 Z-100 F500\nM30\n";
    Upload::new(1, &calls(text, &params)).feed(&mut hand.gateway, &mut hand.sim);
    let run = BoardCommand {
        echo: Some(hand.gateway.beat.beat),
        ..BoardCommand::order(Order::Run, 50)
    };
    hand.run(1_100);
    let before = hand.gateway.status.count;
    for old in [run, BoardCommand { echo: None, ..run }] {
        hand.sim.receive(&old.frame(NODE));
        hand.run(50);
        assert_eq!(hand.refused(), 4508);
        assert_eq!(hand.gateway.status.count, before);
        assert_eq!(hand.gateway.status.state, BoardState::Idle);
    }
    let fresh = BoardCommand {
        echo: Some(hand.gateway.beat.beat),
        ..run
    };
    hand.sim.receive(&fresh.frame(NODE));
    hand.run(50);
    assert_eq!(hand.refused(), 0);
    assert_eq!(hand.gateway.status.count, 51);
    assert_eq!(hand.gateway.status.state, BoardState::Run);
}

/// A parameter in the moment in which a press is let in: one of the two is refused, and nothing begins anew while it moves.
#[test]
fn a_press_and_a_change_of_parameters_do_not_meet() {
    for press_first in [true, false] {
        let mut hand = Hand::new(OperatingMode::Manual);
        hand.press = 1;
        let write = |hand: &mut Hand| {
            let bytes = 234_u16.to_le_bytes();
            let ramp = Object::new(0x2000 + 9004, 0);
            hand.gateway
                .write(&mut hand.sim, ramp, &bytes, SdoProtocol::Short)
        };
        if press_first {
            let press = hand.jog(None, Some(Towards::Minus));
            hand.sim.receive(&press);
            assert!(write(&mut hand).is_err());
            hand.run(60);
            assert!(hand.at().z < Length::ZERO);
        } else {
            let _ = write(&mut hand);
            let press = hand.jog(None, Some(Towards::Minus));
            hand.sim.receive(&press);
            hand.stands(200);
            assert_eq!(hand.gateway.beat.state, PressState::Refused);
        }
    }
}
