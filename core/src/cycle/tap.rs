//! G84 and G88: one call to its moves, lazily and in constant memory ([G84/G88 sheet]; cycles.md section 8).

use super::check::{blame, tap_ranges};
use super::{Cycle, Move, MoveKind, Stage, Tag, TapMove};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::program::{
    Aux, Hand, Position, TapAxis, TapCall, TapCycle, TapForm, TapMode, TapPeck, TapRepeat,
    TapSpindle,
};
use crate::signals::Signals;
use crate::units::{CentiRpm, Length, TurnRatio};

/// Most infeeds of a hole.
const INFEEDS: i64 = 9999;

/// The moves of a tapping cycle, hole by hole.
///
/// Rapid to the hole, clamp, rapid to R; the strokes of the form; dwell; out to R; rapid to the initial level, unclamp.
/// Targets are absolute, R ± n·q, clipped at the bottom. Moves of no length are left out. A hole with K198 ends at its
/// bottom; the call that goes on begins with the infeed. Nothing can fail once it is made.
#[derive(Clone, Copy, Debug)]
pub struct TapMoves {
    span: Span,
    call: TapCall,
    hand: Hand,
    spindle: TapSpindle,
    /// The way in along the tap axis: −1 or +1.
    inward: i64,
    /// From R to the bottom.
    total: Length,
    /// Where the tool is: the place of the hole, and how far below R.
    at: Position,
    depth: Length,
    /// How far below R the hole is cut.
    cut: Length,
    /// The hole, its tap axis at the initial level.
    place: Position,
    hole: u8,
    infeeds: u32,
    /// No stroke of the hole has been made, and it starts at R.
    fresh: bool,
    next: Next,
}

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Approach,
    Clamp,
    RPlane,
    Infeed,
    Back,
    Reenter,
    Dwell,
    Extract,
    Return,
    Unclamp,
    Done,
}

impl TapMoves {
    /// The moves of `call`, whose G word stands at `span`, with these signals.
    ///
    /// # Errors
    /// Bottom at R or on the wrong side of it, or d > q (0207); lengths out of range (4110); more than 9999 infeeds (4130);
    /// speeds, or a depth to go on from, that no program can give (4131); two spindles selected at once (4263).
    #[inline(never)]
    pub fn new(call: &TapCall, signals: Signals, span: Span) -> Result<Self, Alarm> {
        tap_ranges(call, span)?;
        let hand = signals.hand(call.hand);
        let spindle = signals.spindle(call.spindle, span)?;
        let axis = call.axis;
        let level = call.level.value;
        let bottom = call.bottom.value;
        let initial = axis.of(call.hole);
        let inward = (bottom - level).signum();
        let approach = (level - initial).signum();
        let letter = match axis {
            TapAxis::X => b'X',
            TapAxis::Z => b'Z',
        };
        if inward == 0 || (approach != 0 && approach != inward) {
            return Err(blame(Code::TapDepth, span, &call.bottom.span, letter));
        }
        let total = (bottom - level).abs();
        let from = if call.continues {
            (axis.of(call.start) - level).times(inward)
        } else {
            Length::ZERO
        };
        let no_depth = call.continues && (from <= Length::ZERO || from >= total);
        // Only a spindle in speed mode can be found standing, and only in position mode can a tap stay in its hole.
        let slowest = match call.mode {
            TapMode::Rigid => 1,
            TapMode::Floating => 0,
        };
        let locked = call.continues || call.repeat == TapRepeat::Stay;
        let no_phase = locked && call.mode == TapMode::Floating;
        if no_depth || no_phase || call.speed.get() < slowest || call.extract.get() < slowest {
            return Err(Alarm::new(Code::TapCallRange, span));
        }
        if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = call.form {
            if peck.back.value > peck.infeed.value {
                return Err(blame(Code::TapDepth, span, &peck.back.span, b'D'));
            }
            if peck.infeed.value.times(INFEEDS) < total {
                let limit = [Arg::Int(INFEEDS)];
                return Err(blame(Code::TooManyPecks, span, &peck.infeed.span, b'Q').with(limit));
            }
        }
        Ok(Self {
            span,
            call: *call,
            hand,
            spindle,
            inward,
            total,
            at: call.start,
            depth: (axis.of(call.start) - level).times(inward),
            cut: from,
            place: call.hole,
            hole: 1,
            infeeds: 0,
            fresh: !call.continues,
            next: if call.continues {
                Next::Infeed
            } else {
                Next::Approach
            },
        })
    }

    /// Depth of the next infeed: the first multiple of q beyond what is cut, at most the bottom.
    fn target(&self) -> Length {
        let (TapForm::HighSpeed(peck) | TapForm::Deep(peck)) = self.call.form else {
            return self.total;
        };
        let q = peck.infeed.value;
        match self.cut.nm().checked_div(q.nm()) {
            Some(done) => q.times(done.saturating_add(1)).min(self.total),
            None => self.total,
        }
    }

    /// The spindle that turns the tap.
    #[must_use]
    pub const fn spindle(&self) -> TapSpindle {
        self.spindle
    }

    const fn peck(&self) -> Option<&TapPeck> {
        match &self.call.form {
            TapForm::Standard => None,
            TapForm::HighSpeed(peck) | TapForm::Deep(peck) => Some(peck),
        }
    }

    const fn is_deep(&self) -> bool {
        matches!(self.call.form, TapForm::Deep(_))
    }

    fn make(&self, kind: MoveKind, stage: Stage, peck: u32) -> Move {
        Move {
            span: self.span,
            to: self.at,
            kind,
            tag: Some(Tag {
                cycle: match self.call.cycle {
                    TapCycle::G84 => Cycle::G84,
                    TapCycle::G88 => Cycle::G88,
                },
                pass: u32::from(self.hole),
                start: 0,
                peck,
                stage,
                depth: self.depth,
            }),
        }
    }

    #[inline(never)]
    fn rapid(&mut self, to: Position, stage: Stage) -> Option<Move> {
        if to == self.at {
            return None;
        }
        self.at = to;
        self.depth = (self.call.axis.of(to) - self.call.level.value).times(self.inward);
        Some(self.make(MoveKind::Rapid, stage, 0))
    }

    /// A stroke to `depth` below R at a spindle speed, unless the tap is there.
    fn stroke(&mut self, depth: Length, speed: CentiRpm, stage: Stage) -> Option<Move> {
        let travel = depth - self.depth;
        if travel == Length::ZERO {
            return None;
        }
        let outward = travel < Length::ZERO;
        // Plus is the way in of a right-hand tap.
        let turns = TurnRatio::of_travel(travel, self.call.lead.value);
        let speed = if outward { speed.reversed() } else { speed };
        let (turns, speed) = match self.hand {
            Hand::Right => (turns, speed),
            Hand::Left => (turns.reversed(), speed.reversed()),
        };
        self.depth = depth;
        let coordinate = self.call.level.value + depth.times(self.inward);
        self.at = self.call.axis.with(self.at, coordinate);
        let kind = MoveKind::Tap(TapMove {
            mode: self.call.mode,
            axis: self.call.axis,
            spindle: self.spindle,
            lead: self.call.lead.value,
            hand: self.hand,
            level: self.call.level.value,
            bottom: self.call.bottom.value,
            turns,
            speed,
            outward,
            opens: self.fresh,
            closes: stage == Stage::Extract,
        });
        self.fresh = false;
        let peck = if stage == Stage::Tap { self.infeeds } else { 0 };
        Some(self.make(kind, stage, peck))
    }

    fn infeed(&mut self) -> Option<Move> {
        let target = self.target();
        self.cut = target;
        self.infeeds = self.infeeds.saturating_add(1);
        self.next = if target == self.total {
            Next::Dwell
        } else {
            Next::Back
        };
        self.stroke(target, self.call.speed, Stage::Tap)
    }

    fn back(&mut self) -> Option<Move> {
        let to = if self.is_deep() {
            self.next = Next::Reenter;
            Length::ZERO
        } else {
            self.next = Next::Infeed;
            self.gap()
        };
        self.stroke(to, self.call.extract, Stage::Retract)
    }

    /// d above what is cut, R at the most.
    fn gap(&self) -> Length {
        let back = self.peck().map_or(Length::ZERO, |peck| peck.back.value);
        (self.cut - back).max(Length::ZERO)
    }

    #[inline(never)]
    fn aux(&self, code: Option<u16>, stage: Stage) -> Option<Move> {
        code.map(|code| self.make(MoveKind::Aux(Aux::M(code)), stage, 0))
    }

    /// To the next hole, or to the end.
    fn go_on(&mut self) {
        let holes = match self.call.repeat {
            TapRepeat::Holes(holes) => holes.get(),
            TapRepeat::Stay => 1,
        };
        if self.hole >= holes {
            self.next = Next::Done;
            return;
        }
        self.hole = self.hole.saturating_add(1);
        self.infeeds = 0;
        self.cut = Length::ZERO;
        self.fresh = true;
        let step = &self.call.step;
        self.place = Position {
            x: self.place.x + step.x,
            z: self.place.z + step.z,
            c: self.place.c + step.c,
        };
        self.next = Next::Approach;
    }
}

impl Iterator for TapMoves {
    type Item = Move;

    fn next(&mut self) -> Option<Move> {
        loop {
            let made = match self.next {
                Next::Approach => {
                    self.next = Next::Clamp;
                    self.rapid(self.place, Stage::Approach)
                }
                Next::Clamp => {
                    self.next = Next::RPlane;
                    self.aux(self.call.clamp, Stage::Clamp)
                }
                Next::RPlane => {
                    self.next = Next::Infeed;
                    let level = self.call.axis.with(self.at, self.call.level.value);
                    self.rapid(level, Stage::RPlane)
                }
                Next::Infeed => self.infeed(),
                Next::Back => self.back(),
                Next::Reenter => {
                    self.next = Next::Infeed;
                    self.stroke(self.gap(), self.call.extract, Stage::Reenter)
                }
                Next::Dwell => {
                    self.next = match self.call.repeat {
                        TapRepeat::Stay => Next::Done,
                        TapRepeat::Holes(_) => Next::Extract,
                    };
                    let time = self.call.dwell;
                    (time.get() > 0).then(|| self.make(MoveKind::Dwell(time), Stage::Dwell, 0))
                }
                Next::Extract => {
                    self.next = Next::Return;
                    self.stroke(Length::ZERO, self.call.extract, Stage::Extract)
                }
                Next::Return => {
                    self.next = Next::Unclamp;
                    self.rapid(self.place, Stage::Return)
                }
                Next::Unclamp => {
                    let code = self.call.clamp.map(|code| code.saturating_add(1));
                    let made = self.aux(code, Stage::Unclamp);
                    self.go_on();
                    made
                }
                Next::Done => return None,
            };
            if made.is_some() {
                return made;
            }
        }
    }
}

impl core::iter::FusedIterator for TapMoves {}
