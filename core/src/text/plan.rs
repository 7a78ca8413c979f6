//! The actions of one block, in the order in which the machine does them.

use crate::alarm::{Alarm, Span};
use crate::call::{Aux, Call, CallKind, FeedRate, Position, SpindleCall};
use crate::units::Millis;

/// The output of a program, in the order in which the machine acts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly every event is a call, and the core has no heap to put one on"
)]
pub enum Event {
    /// One action of the machine.
    Call(Call),
    /// A message to the operator, in its place in the order; the program goes on.
    Warning(Alarm),
}

/// Warnings a block can raise.
const WARNINGS: usize = 2;

/// The events of one block. Bits of `pending` from the lowest: warnings; M41 to M44; S M03 M04, M08, M24–M27, rigid
/// mode, T, machine functions, G04; G61 G64; the motion, or several straight moves; M05, M09, machine functions, M00
/// M01 M02 M30.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pending: u32,
    /// The warning that threads follow a groove was given.
    told_of_pickup: bool,
    origin: Position,
    warnings: [Alarm; WARNINGS],
    gear: (Span, u16),
    spindle: (Span, SpindleCall),
    coolant_on: Span,
    tap_spindle: (Span, u16),
    rigid: (Span, SpindleCall),
    tool: (Span, u16),
    dwell: (Span, Millis),
    exact_stop: (Span, bool),
    motion: (Span, CallKind),
    path: Path,
    spindle_stop: Span,
    coolant_off: Span,
    flow: (Span, u16),
    functions: Functions,
}

/// The most machine functions of a block.
pub(crate) const FUNCTIONS: usize = 4;

/// M codes of the table of machine functions, in their order.
#[derive(Clone, Copy, Debug)]
struct Functions {
    codes: [(Span, u16); FUNCTIONS],
    /// The codes in the list, those that come after the motion, and those that have been taken; a bit each.
    listed: u8,
    behind: u8,
}

impl Functions {
    const NONE: Self = Self {
        codes: [(NOWHERE, 0); FUNCTIONS],
        listed: 0,
        behind: 0,
    };

    fn push(&mut self, span: Span, code: u16, behind: bool) {
        let free = self.listed.trailing_ones();
        if let Some(place) = self.codes.get_mut(free as usize) {
            *place = (span, code);
            let bit = 1_u8.wrapping_shl(free);
            self.listed |= bit;
            self.behind |= if behind { bit } else { 0 };
        }
    }

    /// The next one before the motion, or behind it, and whether there are more.
    fn next(&mut self, behind: bool) -> Option<((Span, u16), bool)> {
        let wanted = self.listed & if behind { self.behind } else { !self.behind };
        let rest = wanted & wanted.wrapping_sub(1);
        let place = wanted.trailing_zeros() as usize;
        let code = *self.codes.get(place)?;
        self.listed ^= wanted ^ rest;
        Some((code, rest != 0))
    }
}

const NOWHERE: Span = Span {
    line: 0,
    column: 0,
    end: 0,
};

/// The most straight moves of a block: a turning cycle has four.
const STRAIGHTS: usize = 4;

/// Straight moves, one after the other.
#[derive(Clone, Copy, Debug)]
struct Path {
    span: Span,
    moves: [(Position, Option<FeedRate>); STRAIGHTS],
    /// Moves in the list, and those that have been taken.
    count: u8,
    taken: u8,
}

impl Path {
    const EMPTY: Self = Self {
        span: Span {
            line: 0,
            column: 0,
            end: 0,
        },
        moves: [(Position::ZERO, None); STRAIGHTS],
        count: 0,
        taken: 0,
    };

    fn push(&mut self, to: Position, feed: Option<FeedRate>) {
        if let Some(place) = self.moves.get_mut(usize::from(self.count)) {
            *place = (to, feed);
            self.count = self.count.saturating_add(1);
        }
    }

    /// The next move, and whether there are more.
    fn next(&mut self) -> Option<(CallKind, bool)> {
        let (to, feed) = *self.moves.get(usize::from(self.taken))?;
        self.taken = self.taken.saturating_add(1);
        let kind = match feed {
            Some(feed) => CallKind::Line(to, feed),
            None => CallKind::Rapid(to),
        };
        Some((kind, self.taken < self.count))
    }
}

const WARNING_0: u32 = 1 << 0;
const WARNING_1: u32 = 1 << 1;
const GEAR: u32 = 1 << 2;
const SPINDLE: u32 = 1 << 3;
const COOLANT_ON: u32 = 1 << 4;
const TAP_SPINDLE: u32 = 1 << 5;
const RIGID: u32 = 1 << 6;
const TOOL: u32 = 1 << 7;
const BEFORE: u32 = 1 << 8;
const DWELL: u32 = 1 << 9;
const EXACT_STOP: u32 = 1 << 10;
const MOTION: u32 = 1 << 11;
const PATH: u32 = 1 << 12;
const SPINDLE_STOP: u32 = 1 << 13;
const COOLANT_OFF: u32 = 1 << 14;
const BEHIND: u32 = 1 << 15;
const FLOW: u32 = 1 << 16;

impl Plan {
    pub(crate) const fn new() -> Self {
        const NONE: Alarm = Alarm::new(crate::alarm::Code::CutInMode, NOWHERE);
        Self {
            pending: 0,
            told_of_pickup: false,
            origin: Position::ZERO,
            warnings: [NONE; WARNINGS],
            gear: (NOWHERE, 0),
            spindle: (NOWHERE, SpindleCall::STOPPED),
            coolant_on: NOWHERE,
            tap_spindle: (NOWHERE, 0),
            rigid: (NOWHERE, SpindleCall::STOPPED),
            tool: (NOWHERE, 0),
            dwell: (NOWHERE, Millis::new(0)),
            exact_stop: (NOWHERE, false),
            motion: (NOWHERE, CallKind::End(0)),
            path: Path::EMPTY,
            spindle_stop: NOWHERE,
            coolant_off: NOWHERE,
            flow: (NOWHERE, 0),
            functions: Functions::NONE,
        }
    }

    /// Clears the plan.
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.pending = 0;
    }

    /// Sets the origin that all calls of the block carry.
    #[inline]
    pub(crate) fn set_origin(&mut self, origin: Position) {
        self.origin = origin;
    }

    /// The warning that threads follow a groove: of a program's first thread.
    pub(crate) fn warn_of_pickup(&mut self, alarm: Alarm) {
        if !self.told_of_pickup {
            self.told_of_pickup = true;
            self.warn(alarm);
        }
    }

    pub(crate) fn warn(&mut self, alarm: Alarm) {
        let (bit, index) = if self.pending & WARNING_0 == 0 {
            (WARNING_0, 0)
        } else {
            (WARNING_1, 1)
        };
        self.pending |= bit;
        if let Some(place) = self.warnings.get_mut(index) {
            *place = alarm;
        }
    }

    pub(crate) fn gear(&mut self, span: Span, code: u16) {
        self.pending |= GEAR;
        self.gear = (span, code);
    }

    pub(crate) fn spindle(&mut self, span: Span, call: SpindleCall) {
        self.pending |= SPINDLE;
        self.spindle = (span, call);
    }

    pub(crate) fn coolant_on(&mut self, span: Span) {
        self.pending |= COOLANT_ON;
        self.coolant_on = span;
    }

    pub(crate) fn tap_spindle(&mut self, span: Span, code: u16) {
        self.pending |= TAP_SPINDLE;
        self.tap_spindle = (span, code);
    }

    pub(crate) fn rigid(&mut self, span: Span, call: SpindleCall) {
        self.pending |= RIGID;
        self.rigid = (span, call);
    }

    pub(crate) fn tool(&mut self, span: Span, number: u16) {
        self.pending |= TOOL;
        self.tool = (span, number);
    }

    pub(crate) fn dwell(&mut self, span: Span, time: Millis) {
        self.pending |= DWELL;
        self.dwell = (span, time);
    }

    pub(crate) fn exact_stop(&mut self, span: Span, exact: bool) {
        self.pending |= EXACT_STOP;
        self.exact_stop = (span, exact);
    }

    #[inline]
    pub(crate) fn motion(&mut self, span: Span, kind: CallKind) {
        self.pending |= MOTION;
        self.motion = (span, kind);
    }

    /// One of the straight moves of a block that has several, in their order; a rapid where it has no feed.
    pub(crate) fn straight(&mut self, span: Span, to: Position, feed: Option<FeedRate>) {
        if self.pending & PATH == 0 {
            self.path = Path {
                span,
                ..Path::EMPTY
            };
        }
        self.pending |= PATH;
        self.path.push(to, feed);
    }

    pub(crate) fn spindle_stop(&mut self, span: Span) {
        self.pending |= SPINDLE_STOP;
        self.spindle_stop = span;
    }

    pub(crate) fn coolant_off(&mut self, span: Span) {
        self.pending |= COOLANT_OFF;
        self.coolant_off = span;
    }

    /// A machine function of the table, before the motion or behind it.
    pub(crate) fn function(&mut self, span: Span, code: u16, behind: bool) {
        if self.pending & (BEFORE | BEHIND) == 0 {
            self.functions = Functions::NONE;
        }
        self.pending |= if behind { BEHIND } else { BEFORE };
        self.functions.push(span, code, behind);
    }

    pub(crate) fn flow(&mut self, span: Span, code: u16) {
        self.pending |= FLOW;
        self.flow = (span, code);
    }

    /// True where a call is to come.
    #[inline]
    pub(crate) const fn has_call(&self) -> bool {
        self.pending & !(WARNING_0 | WARNING_1) != 0
    }

    /// True where the next call is a stroke that is joined to the one before.
    pub(crate) const fn is_joined(&self) -> bool {
        let is_motion = self.pending & !(WARNING_0 | WARNING_1) == MOTION;
        is_motion && matches!(&self.motion.1, CallKind::Thread(thread) if thread.part.is_joined())
    }

    /// The next event.
    #[inline]
    pub(crate) fn next(&mut self) -> Option<Event> {
        let first = self.pending & self.pending.wrapping_neg();
        self.pending ^= first;
        if first == MOTION {
            // Most blocks are this and nothing else.
            return Some(self.call(self.motion.0, self.motion.1));
        }
        self.other(first)
    }

    fn other(&mut self, bit: u32) -> Option<Event> {
        let (span, kind) = match bit {
            WARNING_0 | WARNING_1 => {
                let index = usize::from(bit == WARNING_1);
                return self.warnings.get(index).copied().map(Event::Warning);
            }
            GEAR => (self.gear.0, CallKind::Aux(Aux::M(self.gear.1))),
            SPINDLE => (self.spindle.0, CallKind::Spindle(self.spindle.1)),
            COOLANT_ON => (self.coolant_on, CallKind::Aux(Aux::M(8))),
            TAP_SPINDLE => (
                self.tap_spindle.0,
                CallKind::Aux(Aux::M(self.tap_spindle.1)),
            ),
            RIGID => (self.rigid.0, CallKind::Spindle(self.rigid.1)),
            TOOL => (self.tool.0, CallKind::Aux(Aux::T(self.tool.1))),
            DWELL => (self.dwell.0, CallKind::Dwell(self.dwell.1)),
            EXACT_STOP => (self.exact_stop.0, CallKind::ExactStop(self.exact_stop.1)),
            PATH => {
                let (kind, more) = self.path.next()?;
                if more {
                    self.pending |= PATH;
                }
                (self.path.span, kind)
            }
            BEFORE | BEHIND => {
                let ((span, code), more) = self.functions.next(bit == BEHIND)?;
                if more {
                    self.pending |= bit;
                }
                (span, CallKind::Aux(Aux::M(code)))
            }
            SPINDLE_STOP => (self.spindle_stop, CallKind::Spindle(SpindleCall::STOPPED)),
            COOLANT_OFF => (self.coolant_off, CallKind::Aux(Aux::M(9))),
            FLOW => match self.flow.1 {
                code @ (2 | 30) => (self.flow.0, CallKind::End(code)),
                code => (self.flow.0, CallKind::Aux(Aux::M(code))),
            },
            _ => return None,
        };
        Some(self.call(span, kind))
    }

    #[inline]
    const fn call(&self, span: Span, kind: CallKind) -> Event {
        Event::Call(Call {
            span,
            origin: self.origin,
            kind,
        })
    }
}
