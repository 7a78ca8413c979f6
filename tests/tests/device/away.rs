//! A held program is left, its axes are moved by hand, and it goes on where it was held [D255].

use super::by_hand::{Hand, RENEWAL};
use leadscrew_core::board::{Inputs, State};
use leadscrew_core::bus::{BoardState, Object, Order, SdoProtocol};
use leadscrew_core::call::Position;
use leadscrew_core::link::{Certificate, Status, ThreadReader, ThreadState};
use leadscrew_core::operating::{Led, OperatingMode, PressState, Towards, WheelFactor};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::{Axis, Length};
use leadscrew_tests::gateway::Upload;
use leadscrew_tests::machine::calls;
use leadscrew_tests::random::Random;

/// Cuts with exact stops, a dwell, an arc, joined cuts, rapids and a groove: nothing that depends on the spindle's angle.
const PARTS: &str = "G98 M3 S500\nG0 X60 Z-20\nG1 X40 F2000\nG4 P300\nG1 Z-60 F1500\nG2 X60 Z-70 R10\nG64\nG1 X62 Z-71\n\
    X63 Z-74\nX65 Z-80\nG61\nG0 X80 Z-30\nG75 R0.5\nG75 X60 Z-36 P40000 Q30000 F2000\nG0 X100 Z-5\nM30\n";
/// It is over after so many ticks.
const TICKS: u64 = 14_000;

impl Hand {
    fn order(&mut self, order: Order) {
        self.gateway.order(&mut self.sim, order);
        self.run(3);
    }

    fn state(&self) -> State {
        self.sim.board().ticker().state()
    }

    fn left(&self) -> Option<Position> {
        self.sim.board().ticker().left()
    }

    /// Begins a program.
    fn begin(params: &Params, text: &str) -> Self {
        let mut hand = Self::on(params, OperatingMode::Automatic);
        let mut upload = Upload::new(1, &calls(text, params));
        upload.feed(&mut hand.gateway, &mut hand.sim);
        hand.gateway.order(&mut hand.sim, Order::Run);
        while !upload.is_done() {
            hand.run(20);
            upload.feed(&mut hand.gateway, &mut hand.sim);
        }
        hand
    }

    /// So many ticks after its begin it is held, and stands. False where it was over before.
    fn held_after(&mut self, ticks: u64) -> bool {
        self.run(ticks);
        self.order(Order::Hold);
        for _ in 0..20_000 {
            match self.state() {
                State::Held => return true,
                State::Idle => return false,
                _ => self.tick(),
            }
        }
        panic!("it is not held: {:?}", self.state());
    }

    /// A step in mode step, in 0.1 µm of the slide.
    fn goes(&mut self, on_z: bool, way: i32) {
        self.press = self.press.wrapping_add(1);
        for _ in 0..4_000 {
            let step = self.step(on_z, way);
            self.sim.receive(&step);
            self.run(20);
            assert_ne!(
                self.gateway.beat.state,
                PressState::Refused,
                "{}",
                self.refused()
            );
            if self.state() != State::ByHand && self.gateway.beat.state == PressState::Ended {
                return;
            }
        }
        panic!("the step does not end");
    }

    /// The program is resumed from the point where it was left: the axes come back, and stand there.
    fn comes_back(&mut self) -> Vec<Position> {
        self.mode(OperatingMode::Automatic);
        let mut way = vec![self.at()];
        self.gateway.order(&mut self.sim, Order::Resume);
        for _ in 0..60_000 {
            self.tick();
            way.push(self.at());
            if self.state() == State::Held && Some(self.at()) == self.left() {
                return way;
            }
        }
        panic!("the axes do not come back");
    }

    /// The positions from the next order on, to the end of the program.
    fn rest(&mut self) -> Vec<Position> {
        self.gateway.order(&mut self.sim, Order::Resume);
        let mut rest = Vec::new();
        for _ in 0..100_000 {
            self.tick();
            rest.push(self.at());
            if self.state() == State::Idle && !self.sim.board().ticker().in_program() {
                return rest;
            }
        }
        panic!(
            "the program does not end: {:?} {:?} {:?}",
            self.state(),
            self.gateway.status,
            self.warnings
        );
    }

    /// The certificate of the run, and what became of its threads.
    fn certificates(&mut self) -> (Certificate, Vec<ThreadState>) {
        let object = Object::new(0x5041, 0);
        let bytes = self
            .gateway
            .read(&mut self.sim, object, SdoProtocol::Block)
            .unwrap();
        let threads = ThreadReader::new(&bytes).unwrap();
        let run = Certificate::decode(&bytes).unwrap().unwrap();
        let states = threads.map(|thread| thread.unwrap().record.state);
        (run, states.collect())
    }

    fn status(&mut self) -> Status {
        let object = Object::new(0x5001, 1);
        let bytes = self
            .gateway
            .read(&mut self.sim, object, SdoProtocol::Block)
            .unwrap();
        Status::decode(&bytes).unwrap().unwrap()
    }
}

/// What the program does after a hold after so many ticks without being left: the reference. `None`: it was over.
fn undisturbed(params: &Params, text: &str, ticks: u64) -> Option<(Position, Vec<Position>)> {
    let mut hand = Hand::begin(params, text);
    if !hand.held_after(ticks) {
        return None;
    }
    let point = hand.at();
    hand.run(50);
    Some((point, hand.rest()))
}

fn um(um: i64) -> Length {
    Length::from_nm(um * 1_000)
}

#[test]
fn a_held_program_is_left_and_goes_on_as_if_it_had_not_been() {
    let params = Params::sheets();
    let mut cases = 0;
    for ticks in (100..TICKS).step_by(leadscrew_seed::amount(1_301, 97)) {
        let Some((point, rest)) = undisturbed(&params, PARTS, ticks) else {
            continue;
        };
        let mut hand = Hand::begin(&params, PARTS);
        assert!(hand.held_after(ticks));
        assert_eq!(hand.at(), point, "{ticks}");
        hand.mode(OperatingMode::Step);
        assert_eq!(hand.left(), Some(point), "{ticks}");
        // 20 mm of the diameter.
        hand.goes(false, 100_000);
        hand.goes(true, 30_000);
        assert_eq!(hand.at().x - point.x, um(10_000));
        assert_eq!(hand.status().left, Some(point));
        hand.comes_back();
        hand.stands(100);
        assert_eq!(hand.gateway.status.state, BoardState::Hold);
        assert_eq!(hand.rest(), rest, "{ticks}");
        assert_eq!(hand.status().left, None);
        assert_eq!(hand.warnings, []);
        cases += 1;
    }
    assert!(cases >= 5, "{cases}");
}

/// The axes that move on a way, in this order. One moves at a time, and slowly.
fn legs(way: &[Position], params: &Params) -> String {
    let slow = params.slow_feed().nm_per_min() * i64::from(params.tick_us()) / 60_000_000;
    let mut legs = String::new();
    for pair in way.windows(2) {
        let (x, z) = ((pair[1].x - pair[0].x).nm(), (pair[1].z - pair[0].z).nm());
        assert!(x == 0 || z == 0, "one at a time");
        assert!(x.abs().max(z.abs()) <= slow + 1, "{x} {z} {slow}");
        let leg = match (x, z) {
            (0, 0) => continue,
            (_, 0) => 'x',
            _ => 'z',
        };
        if !legs.ends_with(leg) {
            legs.push(leg);
        }
    }
    legs
}

/// One axis after the other, slowly, and last the one that left first: out of a groove and into it again along X alone, out
/// of a bore and into it along Z alone.
#[test]
fn the_axes_come_back_as_they_left() {
    let params = Params::sheets();
    let cases: [(&[(bool, i32)], &str); 9] = [
        // Outside: X away, along Z, X to the point.
        (&[(false, 100_000), (true, 30_000)], "zx"),
        (&[(false, 100_000), (true, -30_000)], "zx"),
        // In a bore: X off its wall, out of it along Z.
        (&[(false, -10_000), (true, 300_000)], "zx"),
        // A drill: along Z, then aside.
        (&[(true, 300_000), (false, 100_000)], "xz"),
        (&[(true, 300_000), (false, -100_000)], "xz"),
        (&[(true, 300_000), (true, -400_000)], "z"),
        (&[(false, 100_000), (false, -150_000)], "x"),
        // Past the point to its other side: that is the side on which the axis has left.
        (&[(false, 50_000), (false, -80_000), (true, 300_000)], "zx"),
        (&[(true, 30_000), (true, -90_000), (false, 100_000)], "xz"),
    ];
    for (steps, wanted) in cases {
        let mut hand = Hand::begin(&params, PARTS);
        assert!(hand.held_after(1_500));
        let point = hand.at();
        hand.mode(OperatingMode::Step);
        for (on_z, way) in steps {
            hand.goes(*on_z, *way);
        }
        let way = hand.comes_back();
        assert_eq!(legs(&way, &params), wanted, "{steps:?}");
        assert_eq!(hand.at(), point);
    }
}

/// A handwheel may be turned back past the point: the side on which an axis has left is where it is when another one is
/// led.
#[test]
fn the_axes_come_back_as_a_handwheel_led_them() {
    let params = Params::sheets();
    for sign in [1_i16, -1] {
        let mut hand = Hand::begin(&params, PARTS);
        assert!(hand.held_after(1_500));
        let point = hand.at();
        hand.mode(OperatingMode::Wheel);
        for (leads, turns) in [(Led::X, [(-5, 10), (5, 40)]), (Led::Z, [(0, 1), (5, 20)])] {
            hand.press = hand.press.wrapping_add(1);
            let mut count = 1_000_u16;
            for (by, frames) in turns {
                for _ in 0..frames {
                    count = count.wrapping_add_signed(sign * by);
                    let turned = hand.wheel(leads, WheelFactor::Hundred, count);
                    hand.sim.receive(&turned);
                    hand.run(RENEWAL);
                }
            }
            hand.until(|hand| hand.state() == State::Held);
        }
        let away = hand.at();
        assert_eq!((away.x - point.x).nm().signum(), i64::from(sign));
        let way = hand.comes_back();
        assert_eq!(legs(&way, &params), "zx", "{sign}");
        assert_eq!(hand.at(), point);
    }
}

/// From the wrong side of the point the axis that comes back last first goes to the side on which it left.
#[test]
fn the_first_leg_leads_away_from_the_work() {
    let params = Params::sheets();
    let mut hand = Hand::begin(&params, PARTS);
    assert!(hand.held_after(1_500));
    let point = hand.at();
    hand.mode(OperatingMode::Step);
    hand.goes(false, 50_000);
    hand.goes(true, 300_000);
    hand.goes(false, -80_000);
    let way = hand.comes_back();
    // Beside the point X does not go below it.
    for at in &way {
        assert!(at.z != point.z || at.x >= point.x);
    }
    let turn = way.iter().position(|at| at.z != way[0].z).unwrap();
    assert_eq!(way[turn].x, point.x);
}

/// Of a thread between its passes, and after a retract out of a stroke: the passes after it are whole, in one groove.
#[test]
fn a_thread_is_left_after_its_retract() {
    const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X100 Z50\nM30\n";
    for retracts in [0, 1] {
        let mut params = Params::sheets();
        let entry = Entry::find_text("9008.0").unwrap();
        params.set(entry, retracts).unwrap();
        for ticks in (1_000..9_000).step_by(leadscrew_seed::amount(1_700, 110)) {
            let mut hand = Hand::begin(&params, THREAD);
            if !hand.held_after(ticks) {
                continue;
            }
            let point = hand.at();
            hand.mode(OperatingMode::Step);
            assert_eq!(hand.left(), Some(point), "{ticks}");
            hand.goes(false, 100_000);
            hand.goes(true, 30_000);
            hand.comes_back();
            let rest = hand.rest();
            assert_eq!(
                rest.last().map(|at| (at.x, at.z)),
                Some((um(50_000), um(50_000)))
            );
            let (run, threads) = hand.certificates();
            assert_eq!(threads, [ThreadState::Finished], "{ticks}");
            assert!(run.largest < um(3), "{ticks} {:?}", run.largest);
        }
    }
}

#[test]
fn a_reset_or_an_alarm_forgets_the_point_and_says_so() {
    let params = Params::sheets();
    for order in [Order::Reset, Order::Stop] {
        for on_the_way in [false, true] {
            let mut hand = Hand::begin(&params, PARTS);
            assert!(hand.held_after(1_500));
            hand.mode(OperatingMode::Step);
            hand.goes(false, 100_000);
            if on_the_way {
                hand.mode(OperatingMode::Automatic);
                hand.order(Order::Resume);
                hand.run(200);
                assert_eq!(hand.state(), State::ByHand);
            }
            let before = hand.at();
            hand.order(order);
            hand.run(500);
            assert_eq!(hand.left(), None);
            // It comes to rest and goes nowhere else.
            assert!((before.x - hand.at().x).nm() < 1_000_000);
            hand.mode(OperatingMode::Automatic);
            hand.order(Order::Resume);
            hand.run(20);
            assert_eq!(hand.refused(), 4591);
            hand.stands(200);
            hand.order(Order::Reset);
            hand.run(500);
            assert_eq!(hand.state(), State::Idle);
            // The next program is one of its own.
            let mut upload = Upload::new(2, &calls("G0 X10\nM30\n", &params));
            upload.feed(&mut hand.gateway, &mut hand.sim);
            hand.order(Order::Run);
            hand.run(30);
            hand.order(Order::Resume);
            hand.run(20);
            assert_eq!(hand.refused(), 0);
        }
    }
}

/// A reset while the tool is elsewhere moves nothing: the way out of a thread counts from the thread alone.
#[test]
fn a_reset_moves_nothing_where_a_thread_was_left() {
    const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nM30\n";
    let mut params = Params::sheets();
    params.set(Entry::find_text("9008.0").unwrap(), 1).unwrap();
    for ticks in (1_000..7_000).step_by(leadscrew_seed::amount(700, 50)) {
        let mut hand = Hand::begin(&params, THREAD);
        if !hand.held_after(ticks) {
            continue;
        }
        hand.mode(OperatingMode::Step);
        // Where the thread would be.
        hand.goes(false, -30_000);
        let at = hand.at();
        hand.order(Order::Reset);
        hand.run(400);
        assert_eq!((hand.state(), hand.at()), (State::Idle, at), "{ticks}");
    }
}

/// Once the tool has left its thread, or a stop has left it there, its ways out are over. A later reset led it 48 mm
/// inwards by itself, from where it had been moved to by hand.
#[test]
fn a_later_reset_moves_nothing_wherever_the_tool_was_moved() {
    const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nM30\n";
    const STROKE: &str = "M3 S300\nG4 P500\nG0 X76 Z10\nG32 Z-30 F3 J2 K3\nM30\n";
    let params = Params::sheets();
    let stopped = Inputs {
        stop: true,
        ..Inputs::default()
    };
    for (text, way) in [(THREAD, 1), (THREAD, -1), (STROKE, 1), (STROKE, -1)] {
        for ticks in [2_500, 4_000, 5_500] {
            for by_reset in [true, false] {
                let mut hand = Hand::begin(&params, text);
                hand.run(ticks);
                if !by_reset {
                    hand.sim.set_pins(stopped);
                    hand.run(400);
                    hand.sim.set_pins(Inputs::default());
                }
                hand.order(Order::Reset);
                hand.until(|hand| hand.gateway.status.state == BoardState::Idle);
                hand.mode(OperatingMode::Step);
                hand.goes(false, way * 300_000);
                let at = hand.at();
                hand.order(Order::Reset);
                hand.run(600);
                let now = (hand.state(), hand.at());
                assert_eq!(now, (State::Idle, at), "{text} {way} {ticks} {by_reset}");
            }
        }
    }
}

#[test]
fn a_hold_on_the_way_back_stays_there_and_the_next_resume_goes_on_with_it() {
    let params = Params::sheets();
    let (point, rest) = undisturbed(&params, PARTS, 1_500).unwrap();
    for order in [
        Order::Hold,
        Order::Mode(OperatingMode::Manual),
        Order::Cancel,
    ] {
        let mut hand = Hand::begin(&params, PARTS);
        assert!(hand.held_after(1_500));
        hand.mode(OperatingMode::Step);
        hand.goes(false, 100_000);
        hand.goes(true, 30_000);
        for _ in 0..3 {
            hand.mode(OperatingMode::Automatic);
            hand.order(Order::Resume);
            hand.run(50);
            assert_eq!(hand.state(), State::ByHand);
            // Not before it stands.
            hand.order(Order::Resume);
            hand.run(20);
            assert_eq!(hand.refused(), 4507);
            hand.order(order);
            hand.run(300);
            assert_eq!(hand.state(), State::Held, "{order:?}");
            assert_ne!(hand.at(), point);
            hand.stands(100);
        }
        hand.comes_back();
        assert_eq!(hand.rest(), rest);
    }
}

#[test]
fn what_a_left_program_lets_in() {
    let params = Params::sheets();
    let mut hand = Hand::begin(&params, PARTS);
    // Not before it is held.
    hand.run(1_000);
    hand.mode(OperatingMode::Manual);
    assert_eq!(hand.refused(), 4502);
    assert!(hand.held_after(500));
    let point = hand.at();
    // A press in the program's own mode.
    hand.press += 1;
    let press = hand.jog(Some(Towards::Plus), None);
    hand.sim.receive(&press);
    hand.run(40);
    assert_eq!(hand.refused(), 4502);
    for mode in [OperatingMode::Reference, OperatingMode::Mdi] {
        hand.mode(mode);
        assert_eq!(hand.refused(), 4502, "{mode:?}");
    }
    hand.mode(OperatingMode::Manual);
    assert_eq!((hand.refused(), hand.left()), (0, Some(point)));
    // A resume does nothing in a mode by hand.
    hand.order(Order::Resume);
    hand.stands(100);
    assert_eq!(hand.state(), State::Held);
    for order in [
        Order::Run,
        Order::Home(leadscrew_core::units::Axes::NONE),
        Order::Mode(OperatingMode::Reference),
    ] {
        hand.order(order);
        hand.run(20);
        assert_eq!(hand.refused(), 4502, "{order:?}");
    }
    hand.mode(OperatingMode::Manual);
    // A hold keeps it from being moved until it is taken back.
    hand.order(Order::Hold);
    hand.press += 1;
    let press = hand.jog(Some(Towards::Plus), None);
    hand.sim.receive(&press);
    hand.run(20);
    assert_eq!(hand.refused(), 4506);
    hand.order(Order::Resume);
    hand.press += 1;
    let press = hand.jog(Some(Towards::Plus), None);
    hand.sim.receive(&press);
    hand.run(60);
    assert!(hand.at().x > point.x);
    assert_eq!(hand.gateway.status.state, BoardState::Run);
    assert!(hand.gateway.status.flags.program);
    hand.run(400);
    assert_eq!(hand.gateway.status.state, BoardState::Hold);
}

/// The contact of feed hold stops what a hand moves, and the way back; while it is open nothing moves.
#[test]
fn the_contact_of_feed_hold_stops_both() {
    let contact = |hand: &mut Hand, hold| {
        hand.sim.set_pins(Inputs {
            hold,
            ..Inputs::default()
        });
    };
    let params = Params::sheets();
    let mut hand = Hand::begin(&params, PARTS);
    assert!(hand.held_after(1_500));
    let point = hand.at();
    hand.mode(OperatingMode::Manual);
    hand.press += 1;
    for tick in 0..300 {
        if tick % 20 == 0 {
            let press = hand.jog(Some(Towards::Plus), None);
            hand.sim.receive(&press);
        }
        if tick == 200 {
            contact(&mut hand, true);
        }
        hand.tick();
    }
    hand.run(200);
    assert_eq!(hand.state(), State::Held);
    assert!(hand.at().x > point.x);
    hand.press += 1;
    let press = hand.jog(Some(Towards::Plus), None);
    hand.sim.receive(&press);
    hand.stands(100);
    assert_eq!(hand.refused(), 4506);
    hand.mode(OperatingMode::Automatic);
    hand.order(Order::Resume);
    hand.stands(200);
    contact(&mut hand, false);
    hand.order(Order::Resume);
    hand.run(100);
    assert_eq!(hand.state(), State::ByHand);
    contact(&mut hand, true);
    hand.run(200);
    assert_eq!(hand.state(), State::Held);
    hand.stands(100);
    contact(&mut hand, false);
    hand.comes_back();
    assert_eq!(hand.at(), point);
}

/// With a tap in its hole nothing leaves it but the way out.
#[test]
fn a_tap_in_its_hole_is_not_left() {
    let params = Params::sheets();
    let text = "G98 G0 X50 Z5\nM29 S100\nG84 Z-30 R-5 F200 K198\nG4 P60000\nG30 P99\nM30\n";
    let mut hand = Hand::begin(&params, text);
    let in_hole = |hand: &Hand| {
        let tap = hand.sim.board().tap_record();
        tap.is_some_and(|tap| tap.in_hole)
    };
    hand.until(in_hole);
    hand.order(Order::Hold);
    while hand.state() != State::Held {
        hand.tick();
        assert!(in_hole(&hand));
    }
    for mode in [OperatingMode::Step, OperatingMode::Manual] {
        hand.mode(mode);
        assert_eq!((hand.refused(), hand.left()), (4310, None));
    }
}

/// Held at any tick, moved anywhere within the limits, by steps and presses, and brought back with holds on the way: the
/// program ends as ever, and no setpoint is beyond the travel.
#[test]
fn wherever_it_is_held_and_moved_the_program_goes_on_unchanged() {
    let mut params = Params::sheets();
    for (number, mm) in [
        ("1320.X", 90),
        ("1321.X", -1),
        ("1320.Z", 5),
        ("1321.Z", -90),
    ] {
        let entry = Entry::find_text(number).unwrap();
        params.set(entry, mm * 1_000_000).unwrap();
    }
    let within = |at: Position| {
        Axis::ALL[..2].iter().all(|&axis| {
            let at = if axis == Axis::X { at.x } else { at.z };
            let range = params.soft_limit_minus(axis)..=params.soft_limit_plus(axis);
            range.contains(&at.nm())
        })
    };
    leadscrew_seed::volume(71, |seed| {
        let mut random = Random(seed);
        for _ in 0..leadscrew_seed::amount(3, 30) {
            let ticks = random.within(50, TICKS as i64) as u64;
            let Some((point, rest)) = undisturbed(&params, PARTS, ticks) else {
                continue;
            };
            let mut hand = Hand::begin(&params, PARTS);
            assert!(hand.held_after(ticks));
            for _ in 0..random.within(1, 3) {
                for _ in 0..random.within(1, 4) {
                    hand.mode(OperatingMode::Manual);
                    let towards = |random: &mut Random| {
                        random.of(&[None, Some(Towards::Plus), Some(Towards::Minus)])
                    };
                    let (x, z) = (towards(&mut random), towards(&mut random));
                    hand.press = hand.press.wrapping_add(1);
                    for _ in 0..random.within(1, 200) {
                        let press = hand.jog(x, z);
                        hand.sim.receive(&press);
                        for _ in 0..20 {
                            hand.tick();
                            assert!(within(hand.at()), "seed {seed}: {:?}", hand.at());
                        }
                    }
                    hand.run(400);
                    assert_eq!(hand.state(), State::Held, "seed {seed}");
                }
                // At the point the program would go on.
                if random.chance(50) && hand.at() != point {
                    hand.mode(OperatingMode::Automatic);
                    hand.order(Order::Resume);
                    hand.run(random.within(0, 3_000) as u64);
                    if hand.left().is_some() {
                        hand.order(Order::Hold);
                        hand.run(400);
                    }
                }
            }
            if hand.at() != point {
                let way = hand.comes_back();
                assert!(way.into_iter().all(within), "seed {seed}");
            }
            hand.mode(OperatingMode::Automatic);
            assert_eq!(hand.rest(), rest, "seed {seed}, held after {ticks}");
        }
    });
}
