//! Time-driven moves and passes of a thread; a step is a tick.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{FeedRate, Position};
use leadscrew_core::cycle::ThreadMoves;
use leadscrew_core::motion::{
    Limits, Phase, Rate, Run, Step, ThreadPlan, ThreadPoint, ThreadRun, Timed, plan,
};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Feed, Length};

use super::{Work, calls, spindle, until};

/// More ticks than any of these moves takes.
const LONGEST: usize = 16_384;

/// A move driven by time, with changes of the override.
pub struct TimedMove {
    limits: Limits,
    target: Move,
}

impl TimedMove {
    /// A line of three axes.
    pub fn line() -> Self {
        Self::new(
            MoveKind::Feed(feed()),
            Position {
                x: Length::from_nm(31_415_926),
                z: Length::from_nm(-77_123_457),
                c: Angle::from_udeg(123_456_789),
            },
        )
    }

    /// Three quarters of a circle.
    pub fn arc() -> Self {
        Self::new(
            MoveKind::Arc {
                i: Length::from_nm(25_000_000),
                k: Length::ZERO,
                clockwise: true,
                feed: feed(),
            },
            Position {
                x: Length::from_nm(25_000_000),
                z: Length::from_nm(25_000_000),
                c: Angle::ZERO,
            },
        )
    }

    fn new(kind: MoveKind, to: Position) -> Self {
        Self {
            limits: Limits::from_params(&Params::sheets()),
            target: Move {
                span: Span::default(),
                to,
                kind,
                tag: None,
            },
        }
    }

    /// The work before the first tick.
    pub fn plan(&self) -> Result<Option<Timed>, Alarm> {
        plan::timed(Position::default(), &self.target, &self.limits)
    }
}

fn feed() -> FeedRate {
    FeedRate::PerMinute(Feed::from_nm_per_min(3_000_000_000))
}

/// The override: as programmed, slower, held, faster.
fn override_at(tick: usize) -> Rate {
    match tick / 100 % 8 {
        2 => Rate::percent(37),
        4 => Rate::HOLD,
        6 => Rate::percent(150),
        _ => Rate::FULL,
    }
}

impl Work for TimedMove {
    type State = (Run, Timed);
    type Out = Step;

    fn steps(&self) -> usize {
        let mut run = self.begin();
        until(LONGEST, |number| self.step(&mut run, number).done)
    }

    fn begin(&self) -> (Run, Timed) {
        let timed = self.plan().ok().flatten().expect("a move that time drives");
        let mut run = Run::new();
        assert!(run.begin(&timed), "a run at rest takes a motion");
        (run, timed)
    }

    fn step(&self, (run, timed): &mut (Run, Timed), number: usize) -> Step {
        run.tick(override_at(number), timed)
    }
}

/// The first pass of a thread, from the wait for the index to rest in the end plane.
pub struct ThreadPass {
    params: Params,
    from: Position,
    moves: [Move; 2],
}

impl ThreadPass {
    /// The [G76 sheet]'s example.
    pub fn o0013() -> Self {
        let call = calls::o0013();
        let mut moves = ThreadMoves::new(&call, Span::default()).expect("the sheet's example");
        let mut next = || moves.next().expect("a pass: approach, stroke, run-out");
        Self {
            params: Params::sheets(),
            from: next().to,
            moves: [next(), next()],
        }
    }

    /// The work before the first tick.
    pub fn plan(&self) -> Result<ThreadPlan, Alarm> {
        ThreadPlan::new(self.from, &self.moves, &self.params, spindle::speed())
    }
}

impl Work for ThreadPass {
    type State = (ThreadRun, ThreadPlan);
    type Out = ThreadPoint;

    fn steps(&self) -> usize {
        let mut run = self.begin();
        until(LONGEST, |number| {
            self.step(&mut run, number).phase == Phase::Done
        })
    }

    fn begin(&self) -> (ThreadRun, ThreadPlan) {
        let plan = self.plan().expect("the sheet's example");
        let run = ThreadRun::start(&plan, spindle::angle(0), spindle::speed());
        (run.expect("the spindle turns"), plan)
    }

    fn step(&self, (run, plan): &mut (ThreadRun, ThreadPlan), number: usize) -> ThreadPoint {
        run.tick(plan, spindle::angle(number))
    }
}
