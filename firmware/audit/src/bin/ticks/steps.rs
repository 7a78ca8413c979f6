//! What is counted: rows `room/step`.

use leadscrew_core::alarm::Span;
use leadscrew_core::cycle::{GrooveMoves, Move, MoveKind, ThreadMoves};
use leadscrew_core::motion::{Limits, Rate, Run, plan};
use leadscrew_core::params::Params;
use leadscrew_core::program::{FeedRate, Position};
use leadscrew_core::units::{Angle, Feed, Length};

use crate::calls;
use crate::count::{MAX_STEPS, count, spin};

/// Counts everything.
pub fn all() {
    count("known-loop-2000", 100, || (), |(), _| spin(1000));
    expand();
    motion();
}

/// From a call to its moves: once a call, then once a move.
fn expand() {
    let thread = calls::o0013();
    let span = Span::default();
    count(
        "expand/g76-begin",
        1,
        || (),
        |(), _| ThreadMoves::new(&thread, span),
    );
    let moves = || ThreadMoves::new(&thread, span).expect("the sheet's example");
    count("expand/g76-move", moves().count(), moves, |moves, _| {
        moves.next()
    });

    let groove = calls::o0008();
    count(
        "expand/g75-begin",
        1,
        || (),
        |(), _| GrooveMoves::new(&groove, span),
    );
    let moves = || GrooveMoves::new(&groove, span).expect("the sheet's example");
    count("expand/g75-move", moves().count(), moves, |moves, _| {
        moves.next()
    });
}

/// Time-driven motion: planning once a move, then the tick.
fn motion() {
    let limits = Limits::from_params(&Params::slant_bed());
    let start = Position::default();
    let line = Move {
        span: Span::default(),
        to: Position {
            x: Length::from_nm(31_415_926),
            z: Length::from_nm(-77_123_457),
            c: Angle::from_udeg(123_456_789),
        },
        kind: MoveKind::Feed(FeedRate::PerMinute(Feed::from_nm_per_min(3_000_000_000))),
        tag: None,
    };
    ticks("line", start, &line, &limits);
}

fn ticks(name: &str, start: Position, target: &Move, limits: &Limits) {
    let plan = || {
        plan::timed(start, target, limits)
            .ok()
            .flatten()
            .expect("a move that time drives")
    };
    count(format_args!("plan/{name}"), 1, || (), |(), _| plan());
    let timed = plan();
    let begin = || {
        let mut run = Run::new();
        assert!(run.begin(&timed), "a run at rest takes a motion");
        run
    };
    let mut run = begin();
    let steps = (0..MAX_STEPS)
        .take_while(|step| !run.tick(override_at(*step)).done)
        .count();
    count(format_args!("tick/{name}"), steps, begin, |run, step| {
        run.tick(override_at(step))
    });
}

/// The operator at work: as programmed, slower, held, faster.
fn override_at(step: usize) -> Rate {
    match step / 100 % 8 {
        2 => Rate::percent(37),
        4 => Rate::HOLD,
        6 => Rate::percent(150),
        _ => Rate::FULL,
    }
}
