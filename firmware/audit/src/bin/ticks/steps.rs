//! What is counted: rows `room/step`.

use leadscrew_core::alarm::Span;
use leadscrew_core::cycle::{GrooveMoves, Move, MoveKind, ThreadMoves};
use leadscrew_core::motion::{Limits, Phase, Rate, Run, ThreadPlan, ThreadRun, plan};
use leadscrew_core::params::Params;
use leadscrew_core::program::{FeedRate, Position};
use leadscrew_core::spindle::{EncoderSample, Observer};
use leadscrew_core::units::{Angle, Feed, Length, Rpm, Ticks, TurnRate, Turns};

use crate::calls;
use crate::count::{MAX_STEPS, count, spin};

/// Counts everything.
pub fn all() {
    count("known-loop-2000", 100, || (), |(), _| spin(1000));
    expand();
    motion();
    observer();
    thread();
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

/// 300 rpm at a tick of a millisecond.
const SPINDLE: Rpm = Rpm::new(300);
const TURNS_PER_TICK: i64 = (1 << 32) / 200;

/// The observer, with the time of the last edge and an index every 200 ticks; and the prediction that follows it.
fn observer() {
    let params = Params::slant_bed();
    let counts = params.encoder_counts();
    let begin = || Observer::new(counts, params.observer_bandwidth_hz(), params.tick_us());
    count("plan/observer", 1, || (), |(), _| begin());
    let sample = |step: usize| EncoderSample {
        count: (step as i64 * i64::from(counts) / 200) as i32,
        edge_age_ns: Some(7 * (step as u32 % 7000)),
        index: (step % 200 == 100).then_some((step / 200) as i32 * counts as i32),
    };
    count("tick/observer", 2000, begin, |observer, step| {
        let event = observer.tick(sample(step));
        (event, observer.predict(Ticks::ONE))
    });
}

/// The first pass of O0013, from the wait for the index to rest in the end plane.
fn thread() {
    let params = Params::slant_bed();
    let call = calls::o0013();
    let moves = ThreadMoves::new(&call, Span::default()).expect("the sheet's example");
    let mut from = call.start;
    let mut pass = [None; 3];
    let mut taken = 0;
    for step in moves {
        match step.kind {
            MoveKind::Thread(_) => {
                pass[taken] = Some(step);
                taken += 1;
            }
            _ if taken > 0 => break,
            _ => from = step.to,
        }
    }
    let pass = pass.map(|step| step.or(pass[0]).expect("a pass has a stroke"));
    let moves = &pass[..taken];
    let speed = TurnRate::of_rpm(SPINDLE);
    count(
        "plan/thread",
        1,
        || (),
        |(), _| ThreadPlan::new(from, moves, &params, speed),
    );
    let plan = ThreadPlan::new(from, moves, &params, speed).expect("the sheet's example");
    let begin = || ThreadRun::start(plan, Turns::ZERO, speed).expect("the spindle turns");
    let angle = |step: usize| Turns::from_raw(step as i64 * TURNS_PER_TICK);
    let mut run = begin();
    let steps = (0..MAX_STEPS)
        .take_while(|step| run.tick(angle(*step)).phase != Phase::Done)
        .count();
    count("tick/thread", steps, begin, |run, step| {
        run.tick(angle(step))
    });
}
