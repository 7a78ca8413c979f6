//! A program that follows a handwheel along its path.

use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{BoardState, Object, Order, SdoProtocol};
use leadscrew_core::operating::{Led, OperatingMode, PressState, WheelFactor};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::Upload;
use leadscrew_tests::machine::calls;

use super::by_hand::{Hand, RENEWAL, WINDOW};

/// 5002h:07.
const BY_WHEEL: Object = Object::new(0x5002, 7);

/// A machine with a program that follows a wheel.
struct Path {
    hand: Hand,
    count: u16,
    factor: WheelFactor,
    /// The fastest tick of X and Z, in nm.
    fastest: [i64; 2],
}

impl Path {
    /// The program has begun.
    fn new(text: &str) -> Self {
        let mut path = Self::loaded(text);
        assert!(path.set(1));
        path.order(Order::Run);
        path
    }

    fn loaded(text: &str) -> Self {
        let mut hand = Hand::new(OperatingMode::Automatic);
        Upload::new(1, &calls(text, &Params::sheets())).feed(&mut hand.gateway, &mut hand.sim);
        hand.press = 1;
        Self {
            hand,
            count: 65_500,
            factor: WheelFactor::Ten,
            fastest: [0; 2],
        }
    }

    /// Writes 5002h:07. False where that is refused.
    fn set(&mut self, to: u8) -> bool {
        let hand = &mut self.hand;
        let write = hand
            .gateway
            .write(&mut hand.sim, BY_WHEEL, &[to], SdoProtocol::Short);
        write.is_ok()
    }

    fn order(&mut self, order: Order) {
        self.hand.gateway.order(&mut self.hand.sim, order);
        self.run(20);
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            let before = self.hand.at();
            self.hand.tick();
            let at = self.hand.at();
            let gone = [at.x - before.x, at.z - before.z];
            for (fastest, gone) in self.fastest.iter_mut().zip(gone) {
                *fastest = gone.nm().abs().max(*fastest);
            }
        }
    }

    /// Turns by so many counts in each of so many frames.
    fn turn(&mut self, counts: i16, frames: u32) {
        for _ in 0..frames {
            self.count = self.count.wrapping_add_signed(counts);
            let frame = self.hand.wheel(Led::Path, self.factor, self.count);
            self.hand.sim.receive(&frame);
            self.run(RENEWAL);
        }
    }

    /// How often the operator was asked for a start.
    fn asked(&self) -> usize {
        let asks = |code: &&Code| **code == Code::RunsByItself;
        self.hand.warnings.iter().filter(asks).count()
    }

    fn z(&self) -> i64 {
        self.hand.at().z.nm()
    }

    fn state(&self) -> BoardState {
        self.hand.gateway.status.state
    }

    /// Until the machine is in this state.
    fn until(&mut self, state: BoardState) {
        self.hand.until(|hand| hand.gateway.status.state == state);
    }
}

#[test]
fn the_tool_goes_as_far_as_the_wheel_is_turned_and_no_faster_than_programmed() {
    let mut path = Path::new("G98 G1 Z-50 F600\nM30\n");
    path.run(500);
    assert_eq!(path.z(), 0);
    for (factor, counts) in [
        (WheelFactor::One, 100),
        (WheelFactor::Ten, 10),
        (WheelFactor::Hundred, 1),
    ] {
        path.factor = factor;
        let from = path.z();
        path.turn(0, 1);
        path.turn(counts, 20);
        path.turn(0, 30);
        // 2 mm, at half of 10 mm/s; the last bit of the mean stays behind.
        let gone = from - path.z();
        assert!((1_990_000..=2_000_000).contains(&gone), "{gone}");
        let at = path.z();
        path.turn(0, 20);
        assert!(at - path.z() < 1_000);
    }
    assert_eq!(path.hand.gateway.beat.state, PressState::Runs);
    // Backwards nothing moves, and a turn back takes nothing of what comes after it.
    let at = path.z();
    path.turn(-50, 20);
    assert!(at - path.z() < 1_000);
    // Ten times as fast as programmed.
    path.fastest = [0; 2];
    path.turn(20, 50);
    assert_eq!(path.fastest, [0, 10_000]);
    // Until the end, behind which no program follows a wheel.
    for _ in 0..40 {
        path.turn(20, 10);
    }
    assert_eq!(path.z(), -50_000_000);
    assert_eq!(path.state(), BoardState::Idle);
    assert_eq!(path.hand.gateway.beat.state, PressState::Ended);
}

/// What the path goes by is ahead of the tool, and so is a feed that changes.
#[test]
fn the_tool_goes_no_farther_than_the_wheel_where_the_feed_changes() {
    for text in [
        "G98 G64\nG1 Z-0.3 F10\nG1 Z-60 F2000\nM30\n",
        "G98 G64\nG1 Z-0.3 F2000\nG1 Z-60 F10\nM30\n",
        "G98 G64\nG1 Z-0.1 F2000\nG1 Z-0.2 F10\nG1 Z-0.3 F500\nG1 Z-60 F10\nM30\n",
    ] {
        let mut path = Path::new(text);
        path.factor = WheelFactor::One;
        path.turn(0, 1);
        let mut way = 0;
        // 6 mm/min, which each of the feeds can take.
        for _ in 0..250 {
            path.turn(2, 1);
            way += 2_000;
            assert!(-path.z() <= way, "{text} {} of {way}", -path.z());
        }
        path.turn(0, 60);
        let left = way + path.z();
        assert!((0..1_000).contains(&left), "{text} {left}");
    }
}

#[test]
fn what_is_turned_slowly_is_not_lost() {
    let mut path = Path::new("G98 G1 Z-60 F8000\nM30\n");
    path.factor = WheelFactor::One;
    path.turn(0, 1);
    for _ in 0..40 {
        path.turn(1, 1);
        path.turn(0, 9);
    }
    // The mean gives out what is worth a step of the rate.
    let left = 40_000 + path.z();
    assert!((0..300).contains(&left), "{left}");
}

/// The link is lost, or the wheel let go of: the tool stands soon, and what is turned later is not made up for.
#[test]
fn without_frames_the_tool_stands() {
    let mut path = Path::new("G98 G1 Z-50 F600\nM30\n");
    path.turn(0, 1);
    path.turn(15, 20);
    path.run(1_000);
    let at = path.z();
    assert!((-3_000_000..-2_900_000).contains(&at), "{at}");
    path.run(WINDOW);
    assert!(at - path.z() < 10);
    assert!(path.hand.sim.board().ticker().in_program());
}

#[test]
fn a_rapid_goes_at_a_quarter_at_most_and_a_dwell_by_time() {
    // 1420.Z is 16 m/min.
    let quarter = 16_000_000_000 / 60_000 / 4;
    let mut path = Path::new("G0 Z-20\nG4 P300\nG98 G1 Z-30 F600\nM30\n");
    path.factor = WheelFactor::Hundred;
    path.run(300);
    assert_eq!(path.z(), 0);
    path.turn(0, 1);
    path.turn(200, 40);
    path.turn(0, 40);
    // The wheel was turned by 800 mm: the rapid is done, and so is the dwell behind it.
    assert!(path.z() < -20_000_000);
    assert!(
        (quarter - 2..=quarter + 1).contains(&path.fastest[1]),
        "{:?}",
        path.fastest
    );
}

/// A thread and a tap wait for the operator, run by themselves, and are what they are without a wheel.
#[test]
fn threads_and_taps_ask_and_run_by_themselves() {
    for text in [
        "M3 S300\nG4 P500\nG0 X80 Z10\nG92 X76 Z-20 F3\nX75\nG0 X100\nM30\n",
        "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-20 P20000 Q15000 F3\nG0 X100\nM30\n",
        "G98\nG0 X0 Z5\nM29 S400\nG84 Z-20 R-3 F600\nG80\nG0 X100\nM30\n",
        "G98\nG0 X0 Z5\nM3 S400\nG84 Z-20 R-3 F600\nG80\nG0 X100\nM30\n",
    ] {
        let mut path = Path::new(text);
        path.factor = WheelFactor::Hundred;
        path.run(200);
        path.turn(0, 1);
        // As far as to the start of the cycle.
        for _ in 0..100 {
            if path.state() == BoardState::Hold {
                break;
            }
            path.turn(50, 4);
        }
        assert_eq!(path.state(), BoardState::Hold, "{text}");
        assert_eq!(path.asked(), 1, "{text}");
        let at = path.hand.at();
        path.turn(100, 20);
        assert_eq!(path.hand.at(), at, "{text}");
        // It runs without the wheel, to the rapid behind it.
        path.order(Order::Resume);
        let mut deepest = at.z;
        for _ in 0..60_000 {
            path.run(1);
            deepest = deepest.min(path.hand.at().z);
        }
        assert!(deepest.nm() <= -20_000_000, "{text} {deepest:?}");
        assert_eq!(path.asked(), 1, "{text}");
        assert!(path.hand.sim.board().ticker().in_program(), "{text}");
        let at = path.hand.at();
        path.run(500);
        assert_eq!(path.hand.at(), at, "{text}");
        for _ in 0..100 {
            path.turn(100, 4);
        }
        path.until(BoardState::Idle);
        assert!(!path.hand.sim.board().ticker().in_program());
    }
}

#[test]
fn a_wheel_that_nothing_follows_is_told_so() {
    let mut path = Path::loaded("G98 G1 Z-50 F600\nM30\n");
    path.turn(10, 3);
    assert_eq!(path.hand.refused(), 4513);
    assert_eq!(path.hand.gateway.beat.state, PressState::Refused);
    // Its refusal stands, though the program follows one now.
    assert!(path.set(1));
    path.order(Order::Run);
    path.turn(10, 10);
    assert_eq!(path.z(), 0);
    path.hand.press += 1;
    path.turn(10, 10);
    path.turn(0, 30);
    let z = path.z();
    assert!((-900_000..-890_000).contains(&z), "{z}");
    // Not while it is under way.
    assert!(!path.set(0));
    path.run(20);
    assert_eq!(path.hand.refused(), 4502);
}

/// A reset forgets the wheel: the next program runs without one.
#[test]
fn after_a_reset_a_program_runs_without_a_wheel() {
    let text = "G98 G1 Z-5 F600\nM30\n";
    let mut path = Path::new(text);
    path.turn(0, 1);
    path.turn(10, 10);
    path.order(Order::Reset);
    path.until(BoardState::Idle);
    let at = path.z();
    path.turn(10, 10);
    assert_eq!(path.z(), at);
    let again = calls(text, &Params::sheets());
    let hand = &mut path.hand;
    Upload::new(2, &again).feed(&mut hand.gateway, &mut hand.sim);
    path.order(Order::Run);
    path.run(2_000);
    assert_eq!(path.z(), -5_000_000);
}
