//! G84 and G88: turns one call into its moves, lazily and in constant memory ([G84/G88 sheet]).

use super::refuse::refuse_tap;
use crate::alarm::{Alarm, Span};
use crate::call::{
    Aux, Hand, Position, TapCall, TapCycle, TapForm, TapPeck, TapRepeat, TapSpindle,
};
use crate::moves::{Cycle, Move, MoveKind, Stage, Tag, TapMove};
use crate::signals::Signals;
use crate::units::{CentiRpm, Length, TurnRatio};

/// The moves of a tapping cycle, hole by hole.
///
/// Rapid to the hole, clamp, rapid to R; the strokes of the form; dwell; out to R; rapid to where the hole ends (the
/// initial level, or R), unclamp.
/// Targets are absolute, R ± n·q, clipped at the bottom. Moves of zero length are left out. A hole with K198 ends at its
/// bottom; the call that continues the hole begins with the infeed. Nothing can fail after the value is made.
#[derive(Clone, Copy, Debug)]
pub struct TapMoves {
    call: TapCall,
    hand: Hand,
    spindle: TapSpindle,
    /// The direction into the hole along the tap axis: −1 or +1.
    inward: i64,
    /// From R to the bottom.
    total: Length,
    /// The last move. It ends at the tool's position.
    made: Move,
    /// How far below R the tool is.
    depth: Length,
    /// How far below R the hole is cut.
    cut: Length,
    /// The hole, its tap axis where the tool leaves it.
    place: Position,
    hole: u8,
    infeeds: u32,
    /// True while the hole starts at R and has had no stroke.
    fresh: bool,
    next: Next,
}

/// The next step of the cycle.
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
    pub fn new(call: &TapCall, signals: Signals, span: Span) -> Result<Self, Alarm> {
        let spindle = refuse_tap(call, signals, span)?;
        Ok(Self::of(call, signals.hand(call.hand), spindle, span))
    }

    /// The moves of a call that [`refuse_tap`] has accepted, with this spindle and this direction of the tap.
    pub(crate) fn of(call: &TapCall, hand: Hand, spindle: TapSpindle, span: Span) -> Self {
        let level = call.level.value;
        let way = call.bottom.value - level;
        let inward = way.signum();
        let depth = (call.axis.of(call.start) - level).times(inward);
        Self {
            call: *call,
            hand,
            spindle,
            inward,
            total: way.abs(),
            made: Move {
                span,
                to: call.start,
                kind: MoveKind::Rapid,
                tag: Some(Tag {
                    cycle: match call.cycle {
                        TapCycle::G84 => Cycle::G84,
                        TapCycle::G88 => Cycle::G88,
                    },
                    pass: 0,
                    start: 0,
                    peck: 0,
                    stage: Stage::Approach,
                    depth,
                }),
            },
            depth,
            cut: if call.continues { depth } else { Length::ZERO },
            place: call.hole,
            hole: 1,
            infeeds: 0,
            fresh: !call.continues,
            next: if call.continues {
                Next::Infeed
            } else {
                Next::Approach
            },
        }
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

    /// Where the call's G word stands.
    pub(crate) const fn span(&self) -> Span {
        self.made.span
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

    /// Completes the last move, which already has its kind and its end.
    fn make(&mut self, stage: Stage, peck: u32) -> bool {
        if let Some(tag) = &mut self.made.tag {
            tag.pass = u32::from(self.hole);
            tag.peck = peck;
            tag.stage = stage;
            tag.depth = self.depth;
        }
        true
    }

    fn rapid(&mut self, to: Position, stage: Stage) -> bool {
        if to == self.made.to {
            return false;
        }
        self.made.to = to;
        self.made.kind = MoveKind::Rapid;
        self.depth = (self.call.axis.of(to) - self.call.level.value).times(self.inward);
        self.make(stage, 0)
    }

    /// A stroke to `depth` below R at a spindle speed; none where the tap is already there.
    fn stroke(&mut self, depth: Length, speed: CentiRpm, stage: Stage) -> bool {
        let travel = depth - self.depth;
        if travel == Length::ZERO {
            return false;
        }
        let outward = travel < Length::ZERO;
        // A right-hand tap goes in with a plus.
        let turns = TurnRatio::of_travel(travel, self.call.lead.value);
        let left = matches!(self.hand, Hand::Left);
        self.depth = depth;
        let coordinate = self.call.level.value + depth.times(self.inward);
        self.made.to = self.call.axis.with(self.made.to, coordinate);
        self.made.kind = MoveKind::Tap(TapMove {
            mode: self.call.mode,
            axis: self.call.axis,
            spindle: self.spindle,
            lead: self.call.lead.value,
            hand: self.hand,
            level: self.call.level.value,
            bottom: self.call.bottom.value,
            turns: if left { turns.reversed() } else { turns },
            speed: if left == outward {
                speed
            } else {
                speed.reversed()
            },
            outward,
            opens: self.fresh,
            closes: stage == Stage::Extract,
        });
        self.fresh = false;
        let peck = if stage == Stage::Tap { self.infeeds } else { 0 };
        self.make(stage, peck)
    }

    fn infeed(&mut self) -> bool {
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

    fn back(&mut self) -> bool {
        let to = if self.is_deep() {
            self.next = Next::Reenter;
            Length::ZERO
        } else {
            self.next = Next::Infeed;
            self.gap()
        };
        self.stroke(to, self.call.extract, Stage::Retract)
    }

    /// d above the depth that is cut, but not above R.
    fn gap(&self) -> Length {
        let back = self.peck().map_or(Length::ZERO, |peck| peck.back.value);
        (self.cut - back).max(Length::ZERO)
    }

    fn aux(&mut self, code: Option<u16>, stage: Stage) -> bool {
        let Some(code) = code else {
            return false;
        };
        self.made.kind = MoveKind::Aux(Aux::M(code));
        self.make(stage, 0)
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

    /// The next move by reference: [`Iterator::next`] without the copy.
    pub fn advance(&mut self) -> Option<&Move> {
        loop {
            let made = match self.next {
                Next::Approach => {
                    self.next = Next::Clamp;
                    // The way in begins where the tool is.
                    let axis = self.call.axis;
                    let over = axis.with(self.place, axis.of(self.made.to));
                    self.rapid(over, Stage::Approach)
                }
                Next::Clamp => {
                    self.next = Next::RPlane;
                    self.aux(self.call.clamp, Stage::Clamp)
                }
                Next::RPlane => {
                    self.next = Next::Infeed;
                    let level = self.call.axis.with(self.made.to, self.call.level.value);
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
                    self.made.kind = MoveKind::Dwell(time);
                    time.get() > 0 && self.make(Stage::Dwell, 0)
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
            if made {
                return Some(&self.made);
            }
        }
    }
}

impl Iterator for TapMoves {
    type Item = Move;

    fn next(&mut self) -> Option<Move> {
        self.advance().copied()
    }
}

impl core::iter::FusedIterator for TapMoves {}
