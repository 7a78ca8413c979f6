//! Axes moved by hand, by an operator whose frames get lost, come twice or stay away, and who holds, stops and turns
//! overrides meanwhile. Nothing moves beyond the travel, and at the end nothing moves at all.

use leadscrew_core::alarm::Code;
use leadscrew_core::board::State;
use leadscrew_core::bus::{BoardState, Frame, JogRequest, Order, StepRequest};
use leadscrew_core::operating::{OperatingMode, Towards};
use leadscrew_core::units::{Axis, Length};

use super::bench::Bench;
use super::operator::Operator;
use crate::gateway::NODE;

/// A press is renewed so often, in ticks.
const RENEWAL: u64 = 20;
/// The longest time until the machine stands after the last frame, in ticks.
const RESTS: u64 = 2_000;

/// The job: some presses and steps, then everything as before.
pub fn job(bench: &mut Bench) {
    let by_steps = bench.random.chance(30);
    let mode = if by_steps {
        OperatingMode::Step
    } else {
        OperatingMode::Manual
    };
    bench.ordered(Order::Mode(mode));
    let session = bench.random.within(1, 255) as u8;
    let mut number = bench.random.within(0, 255) as u8;
    for _ in 0..bench.random.within(1, 6) {
        number = number.wrapping_add(1);
        let ticks = bench.random.within(1, 600) as u64;
        let wish = Wish::draw(bench, by_steps);
        for tick in 0..ticks {
            if tick % RENEWAL == 0 && bench.random.chance(95) {
                let frame = wish.frame(bench, session, number);
                bench.send(frame);
            }
            if bench.random.within(0, 999) == 0 {
                disturb(bench);
            }
            tick_within_the_travel(bench);
        }
        if bench.random.chance(50) {
            let frame = Wish::RELEASED.frame(bench, session, number);
            bench.send(frame);
        }
        for _ in 0..bench.random.within(0, 300) {
            tick_within_the_travel(bench);
        }
    }
    Operator::put_right(bench);
    bench.until("the axes stand", RESTS, |bench| {
        matches!(bench.state(), State::Idle | State::Alarm(_))
    });
    if matches!(bench.state(), State::Alarm(_)) {
        bench.ordered(Order::Reset);
    }
    bench.until("the machine is up", RESTS, |bench| {
        bench.state() == State::Idle && bench.says(BoardState::Idle)
    });
    bench.ordered(Order::Resume);
    bench.operator.forget_causes(&[]);
    bench.end = None;
}

/// What is pressed.
#[derive(Clone, Copy)]
struct Wish {
    x: Option<Towards>,
    z: Option<Towards>,
    rapid: bool,
    mm_per_min: u16,
    step: Option<(bool, i32)>,
}

impl Wish {
    const RELEASED: Self = Self {
        x: None,
        z: None,
        rapid: false,
        mm_per_min: 0,
        step: None,
    };

    fn draw(bench: &mut Bench, by_steps: bool) -> Self {
        let r = &mut bench.random;
        let ways = [None, Some(Towards::Plus), Some(Towards::Minus)];
        Self {
            x: r.of(&ways),
            z: r.of(&ways),
            rapid: r.chance(20),
            mm_per_min: r.of(&[0, 1, 100, 1_000, 5_000, 60_000]),
            step: by_steps.then(|| (r.chance(50), r.within(-20_000, 20_000) as i32)),
        }
    }

    fn frame(&self, bench: &Bench, session: u8, number: u8) -> Frame {
        let echo = bench.beat.beat;
        match self.step {
            Some((on_z, way)) => StepRequest {
                session,
                count: number,
                on_z,
                way,
                echo,
            }
            .frame(NODE),
            None => JogRequest {
                session,
                press: number,
                x: self.x,
                z: self.z,
                spindle: None,
                rapid: self.rapid,
                speed: self.mm_per_min,
                echo,
            }
            .frame(NODE),
        }
    }
}

/// What else an operator does.
fn disturb(bench: &mut Bench) {
    match bench.random.within(0, 9) {
        0..=2 => bench.order(Order::Hold),
        3 | 4 => bench.order(Order::Resume),
        5 => bench.order(Order::Cancel),
        6 => {
            bench.operator.cause(&[Code::EmergencyStop]);
            bench.order(Order::Stop);
        }
        7 => bench.order(Order::Reset),
        8 => bench.order(Order::Mode(OperatingMode::Manual)),
        _ => bench.order(Order::Run),
    }
}

fn tick_within_the_travel(bench: &mut Bench) {
    bench.tick();
    if bench.state() != State::ByHand {
        return;
    }
    let at = bench.position();
    for (axis, at) in [(Axis::X, at.x), (Axis::Z, at.z)] {
        let low = Length::from_nm(bench.params.soft_limit_minus(axis));
        let high = Length::from_nm(bench.params.soft_limit_plus(axis));
        assert!(
            at >= low && at <= high,
            "{axis:?} at {at:?}, of {low:?} to {high:?}"
        );
    }
}
