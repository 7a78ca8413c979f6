//! Expansion alone: G76 cycles of 56 passes, five moves each, every one seen whole where it lies (`advance`; a copy of
//! each, as `next` makes it, takes some twenty instructions more).
//!
//! `cargo run --release --example expand -- 1000`; counted with
//! `valgrind --tool=callgrind target/release/examples/expand 1000` and again with 2000: the difference is free of
//! start-up.

use std::hint::black_box;

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::call::{ChainPart, CutIn, Infeed, Position, RunOut, ThreadCall, ThreadCycle};
use leadscrew_core::cycle::ThreadMoves;
use leadscrew_core::units::{
    Angle, Diameter, Lead, LeadChange, Length, Remainder, Rpm, StartAngle,
};

fn main() {
    let cycles: u32 = std::env::args()
        .nth(1)
        .and_then(|n| n.parse().ok())
        .unwrap_or(1000);
    let Some(call) = call() else {
        return;
    };
    let mut moves = 0u64;
    for _ in 0..cycles {
        let Ok(mut cycle) = ThreadMoves::new(black_box(&call), Span::default()) else {
            return;
        };
        let mut of_cycle = 0u64;
        while let Some(step) = cycle.advance() {
            of_cycle = of_cycle.wrapping_add(1);
            black_box(step);
        }
        moves = moves.wrapping_add(of_cycle);
    }
    println!("{cycles} cycles, {moves} moves");
}

/// M68×6 cut in 55 rough passes and one finishing pass.
fn call() -> Option<ThreadCall> {
    fn mm<const NM: i64>() -> At<Length> {
        At::new(Length::from_nm(NM), Span::default())
    }
    fn at<T>(value: T) -> At<T> {
        At::new(value, Span::default())
    }
    let c = Angle::ZERO;
    Some(ThreadCall {
        cycle: ThreadCycle::G76,
        start: Position {
            x: Diameter::from_nm(80_000_000).radius(),
            z: Length::from_nm(10_000_000),
            c,
        },
        end_x: at(Diameter::from_nm(60_640_000).radius()),
        end_z: mm::<{ -62_000_000 }>(),
        taper: at(Length::ZERO),
        height: mm::<3_680_000>(),
        first_depth: mm::<485_000>(),
        min_step: mm::<10_000>(),
        allowance: mm::<100_000>(),
        finish_passes: at(1),
        angle: at(60),
        infeed: Infeed::Decreasing,
        cut_in: at(CutIn::Trailing),
        starts: at(1),
        run_in: at(Length::ZERO),
        run_out: Some(RunOut {
            short: mm::<3_000_000>(),
            long: mm::<3_000_000>(),
            short_rest: Remainder::ZERO,
            long_rest: Remainder::ZERO,
        }),
        lead: at(Lead::new(6_000_000, 1)?),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::INDEX,
        part: ChainPart::Whole,
        increment: Length::from_nm(100),
        rpm: Rpm::new(300),
    })
}
