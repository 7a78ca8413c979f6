//! The time-driven tick alone: profile and path, without the board round it.
//!
//! `cargo run --release --example timed -- line 1000000` or `arc`; counted with
//! `valgrind --tool=callgrind target/release/examples/timed line 100000` and again with twice as many: the difference is
//! free of start-up and planning. The override wobbles, so that the governor has work in every tick.

use std::hint::black_box;

use leadscrew_core::alarm::Span;
use leadscrew_core::cycle::{Move, MoveKind};
use leadscrew_core::motion::{Limits, Rate, Run, plan};
use leadscrew_core::params::Params;
use leadscrew_core::program::{FeedRate, Position};
use leadscrew_core::units::{Angle, Feed, Length};

fn main() {
    let arc = std::env::args().nth(1).as_deref() == Some("arc");
    let ticks: u32 = std::env::args()
        .nth(2)
        .and_then(|n| n.parse().ok())
        .unwrap_or(1_000_000);
    let metre = 1_000_000_000_i64;
    let feed = FeedRate::PerMinute(Feed::from_nm_per_min(1_000));
    let kind = if arc {
        MoveKind::Arc {
            i: Length::ZERO,
            k: Length::from_nm(metre.wrapping_neg()),
            clockwise: false,
            feed,
        }
    } else {
        MoveKind::Feed(feed)
    };
    let target = Move {
        span: Span::default(),
        to: Position {
            x: Length::from_nm(metre),
            z: Length::from_nm(metre.wrapping_neg()),
            c: Angle::from_udeg(if arc { 0 } else { 90_000_000 }),
        },
        kind,
        tag: None,
    };
    let limits = Limits::from_params(&Params::slant_bed());
    let Ok(Some(planned)) = plan::timed(Position::default(), &target, &limits) else {
        println!("this cannot be planned");
        return;
    };
    let mut run = Run::new();
    if !run.begin(&planned) {
        return;
    }
    for tick in 0..ticks {
        let rate = Rate::from_raw(60_000_u32.saturating_add(tick & 0xfff));
        black_box(run.tick(black_box(rate)));
    }
    println!("{ticks} ticks, then at {:?}", run.position());
}
