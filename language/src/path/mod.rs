//! The path of a program between the core and the board: chamfers and roundings first, then the round nose.
//!
//! ```text
//! events of the core ─► corners ─► nose ─► events of the reader
//! ```
//!
//! Both look ahead, so a motion may come out some blocks after it was read. The order of all events stays. While neither is
//! at work, events pass as they are. This module knows the calls that move; it must not know text.

mod corners;
mod round;
mod words;

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::call::{ArcCall, Call, CallKind, FeedRate, Position};
use leadscrew_core::offsets::{self, Source};
use leadscrew_core::program::Event;

use crate::nose::{Nose, Side};
use crate::plane::{Element, Point, Shape};
use corners::{Asked, Corners};
use round::Round;
pub(crate) use words::is_word;

/// Both stages, and what the words of the program ask of them.
#[derive(Debug)]
pub(crate) struct Path {
    corners: Corners,
    round: Round,
    side: Side,
    nose: Nose,
    /// The corner after the motion of the block under way.
    corner: Option<Asked>,
    /// The moves that come are not the programmed path: no compensation.
    suspended: bool,
    /// Where the programmed path is.
    at: Position,
    out: VecDeque<Event>,
}

/// Where the motion of an event begins, and how it is compensated: as its block says. A motion may wait for its corner
/// while the next block says otherwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct How {
    from: Position,
    side: Side,
    nose: Nose,
}

impl Path {
    /// G40, and no corner.
    pub fn new() -> Self {
        Self {
            corners: Corners::default(),
            round: Round::default(),
            side: Side::None,
            nose: Nose::default(),
            corner: None,
            suspended: false,
            at: Position::ZERO,
            out: VecDeque::new(),
        }
    }

    /// True where events pass as they are.
    pub fn is_idle(&self) -> bool {
        self.side == Side::None
            && self.corner.is_none()
            && self.corners.is_free()
            && self.round.is_free()
    }

    /// G40 to G42.
    pub fn side(&self) -> Side {
        self.side
    }

    /// The code of group 07: 40 to 42.
    pub fn code(&self) -> u32 {
        match self.side {
            Side::None => 40,
            Side::Left => 41,
            Side::Right => 42,
        }
    }

    /// A block begins, with the machine at `at` after the blocks before.
    pub fn begin(&mut self, at: Position) {
        self.at = at;
    }

    /// The moves from now on are the programmed path, or not.
    pub fn suspend(&mut self, suspended: bool) {
        self.suspended = suspended;
    }

    /// The tool of offset `number`: its nose is that of the table, or of the parameters.
    pub fn tool(&mut self, number: u16, offsets: Source<'_>) {
        self.nose = nose_of(number, offsets);
    }

    /// Takes an event of the core through the corners; what leaves them goes to `each`.
    ///
    /// # Errors
    /// What a corner refuses.
    pub fn shape(
        &mut self,
        event: Event,
        each: &mut dyn FnMut(&mut Self, Event, How) -> Result<(), Alarm>,
    ) -> Result<(), Alarm> {
        let end = end_of(&event);
        let corner = end.and_then(|_| self.corner.take());
        let mut ready = VecDeque::new();
        let how = How {
            from: self.at,
            side: if self.suspended {
                Side::None
            } else {
                self.side
            },
            nose: self.nose,
        };
        self.corners.push(event, how, corner, &mut ready)?;
        if let Some(end) = end {
            self.at = end;
        }
        for (event, how) in ready {
            each(self, event, how)?;
        }
        Ok(())
    }

    /// Takes an event through the nose.
    ///
    /// # Errors
    /// What the compensation refuses.
    pub fn compensate(&mut self, event: Event, how: How) -> Result<(), Alarm> {
        let How { from, side, nose } = how;
        self.round.push(event, from, side, nose, &mut self.out)
    }

    /// The block is over.
    ///
    /// # Errors
    /// Its corner had no motion to follow.
    pub fn end_block(&mut self) -> Result<(), Alarm> {
        match self.corner.take() {
            Some(asked) => Err(Alarm::new(Code::CornerNextWrong, asked.span)),
            None => Ok(()),
        }
    }

    /// The contour of a cycle was read.
    ///
    /// # Errors
    /// Its last corner has no second motion.
    pub fn end_contour(&mut self) -> Result<(), Alarm> {
        self.corners.finish()
    }

    /// The path is over, or another one follows.
    ///
    /// # Errors
    /// A corner has no second motion, or what the compensation refuses.
    pub fn finish(&mut self) -> Result<(), Alarm> {
        self.corners.finish()?;
        self.round.finish(&mut self.out)
    }

    /// The next event that is ready.
    pub fn next(&mut self) -> Option<Event> {
        self.out.pop_front()
    }
}

/// The nose of the tool with this offset number, or of none.
fn nose_of(number: u16, offsets: Source<'_>) -> Nose {
    let number = u8::try_from(number % 100).unwrap_or(0);
    let offsets::Nose { radius, tip } = offsets.nose(number);
    Nose { radius, tip }
}

/// Where a motion in a straight line or an arc ends.
fn end_of(event: &Event) -> Option<Position> {
    let Event::Call(call) = event else {
        return None;
    };
    match &call.kind {
        CallKind::Rapid(to) | CallKind::Line(to, _) => Some(*to),
        CallKind::Arc(arc) => Some(arc.end),
        _ => None,
    }
}

/// A motion as an element of the plane.
fn element(call: &Call) -> Option<Element> {
    let (to, shape) = match &call.kind {
        CallKind::Rapid(to) => (*to, Shape::Rapid),
        CallKind::Line(to, _) => (*to, Shape::Line),
        CallKind::Arc(arc) => (
            arc.end,
            Shape::Arc {
                i: arc.i,
                k: arc.k,
                clockwise: arc.clockwise,
            },
        ),
        _ => return None,
    };
    Some(Element {
        end: point(to),
        shape,
        span: call.span,
    })
}

fn point(position: Position) -> Point {
    Point {
        x: position.x,
        z: position.z,
    }
}

/// The speed of a motion that cuts.
const fn feed_of(call: &Call) -> Option<FeedRate> {
    match &call.kind {
        CallKind::Line(_, feed) => Some(*feed),
        CallKind::Arc(arc) => Some(arc.feed),
        _ => None,
    }
}

/// The call of an element: place and block of `like`, its C and its feed. Without a feed it is a rapid.
fn call(element: &Element, like: &Call) -> Call {
    let c = end_of(&Event::Call(*like)).map_or(Position::ZERO.c, |end| end.c);
    let to = Position {
        x: element.end.x,
        z: element.end.z,
        c,
    };
    let kind = match (element.shape, feed_of(like)) {
        (Shape::Arc { i, k, clockwise }, Some(feed)) => CallKind::Arc(ArcCall {
            end: to,
            i,
            k,
            clockwise,
            feed,
        }),
        (Shape::Line, Some(feed)) => CallKind::Line(to, feed),
        _ => CallKind::Rapid(to),
    };
    Call { kind, ..*like }
}

#[cfg(test)]
pub(crate) mod tests;
