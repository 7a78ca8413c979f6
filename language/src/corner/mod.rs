//! A chamfer or a rounding between two motions.
//!
//! [`insert`] takes the two motions as they are programmed and gives back the shortened first, the new
//! element, and the
//! shortened second. Each motion is a line or an arc that cuts.
//!
//! This module must not know words and dialects: which letter means which [`Corner`] is settled before.

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::units::Length;

use crate::geometry::{Carrier, Piece, V, arc_centre, meet, nearest};
use crate::plane::{Element, Point, Shape};

/// What is put between two motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// A straight line between the two places at this distance from the corner (`,C`; `L` of type II).
    Chamfer(Length),
    /// A straight line of this length, with its ends at equal distances from the corner (`L` of type I).
    ChamferLine(Length),
    /// An arc of this radius, tangent to both motions (`,R`, `D`).
    Round(Length),
}

/// The sign of a leg (`C±i`, `K±k`, `R±r`): where the next motion goes, at a right angle to a motion along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toward {
    /// X+ (true) or X−, after a motion along Z.
    X(bool),
    /// Z+ (true) or Z−, after a motion along X.
    Z(bool),
}

/// A corner that is worked in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inserted {
    /// The first motion, shortened; a line of no length where the leg is all of it (an arc would be a full circle).
    pub first: Element,
    /// The chamfer or the arc; `None` where the motions are tangent, or where its ends are one place.
    pub between: Option<Element>,
    /// The second motion, shortened in the same way; it begins where `between` ends.
    pub second: Element,
}

/// A turn below this, radians, is no corner.
const TANGENT: f64 = 1e-6;
/// An element shorter than this, nm, is none: its ends are rounded, and an arc could become a full circle.
const NOTHING: f64 = 4.0;
/// How much longer than its element a leg may be, nm: ends are rounded.
const ROUNDED: f64 = 1.0;
/// Legs that are tried for a chamfer at an arc, before one is halved.
const STEPS: u32 = 64;
/// Halvings until the legs of a chamfer are known to less than a nanometre.
const HALVINGS: u32 = 60;

/// Puts `corner`, written at `span`, between `first`, which begins at `start`, and `next`. `toward` is the
/// direction that a sign asks for. The size of `corner` is above zero.
///
/// # Errors
/// 0051 without a next motion, 0052 where one of the two does not cut, 0055 where a leg is longer than its
/// motion, the size is
/// not above zero, or `toward` does not agree.
pub fn insert(
    start: Point,
    first: &Element,
    next: Option<&Element>,
    corner: Corner,
    toward: Option<Toward>,
    span: Span,
) -> Result<Inserted, Alarm> {
    let alarm = |code| Alarm::new(code, span);
    let at = first.end;
    let moves = |next: &&Element| next.end != at || matches!(next.shape, Shape::Arc { .. });
    let next = next.filter(moves).ok_or(alarm(Code::CornerNextMissing))?;
    if first.shape == Shape::Rapid || next.shape == Shape::Rapid {
        return Err(alarm(Code::CornerNextWrong));
    }
    let a = Piece::new(at, start, first);
    let b = Piece::new(at, at, next);
    if toward.is_some_and(|toward| !toward.agrees(&a, &b)) {
        return Err(alarm(Code::CornerTooLong));
    }
    let turn = a.last().turn(b.first());
    let as_it_is = Inserted {
        first: *first,
        between: None,
        second: *next,
    };
    if turn.abs() < TANGENT {
        return Ok(as_it_is);
    }
    let cut = cut(&a, &b, corner, turn).ok_or(alarm(Code::CornerTooLong))?;
    if (cut.to - cut.from).length() < NOTHING {
        if cut.from.length() < NOTHING {
            return Ok(as_it_is);
        }
        // The second motion comes back along the first, and crosses it there: the tip between them goes.
        let tip = cut.from.from(at);
        return Ok(Inserted {
            first: shortened_first(start, first, tip),
            between: None,
            second: shortened_second(at, next, tip),
        });
    }
    let (from, to) = (cut.from.from(at), cut.to.from(at));
    let shape = match cut.arc {
        None => Shape::Line,
        Some(centre) => Shape::Arc {
            i: at.x + nearest(centre.x) - from.x,
            k: at.z + nearest(centre.z) - from.z,
            clockwise: turn < 0.0,
        },
    };
    Ok(Inserted {
        first: shortened_first(start, first, from),
        between: Some(Element {
            end: to,
            shape,
            span,
        }),
        second: shortened_second(at, next, to),
    })
}

/// The first motion, which begins at `start` and now ends at `end`.
fn shortened_first(start: Point, first: &Element, end: Point) -> Element {
    let shape = match first.shape {
        Shape::Arc { .. } if end == start => Shape::Line,
        shape => shape,
    };
    Element {
        end,
        shape,
        ..*first
    }
}

/// The second motion, which began at `at` and now begins at `start`.
fn shortened_second(at: Point, second: &Element, start: Point) -> Element {
    let shape = match second.shape {
        Shape::Arc { .. } if start == second.end => Shape::Line,
        shape => shape_from(at, shape, start),
    };
    Element { shape, ..*second }
}

impl Toward {
    fn agrees(self, a: &Piece, b: &Piece) -> bool {
        let (u, w) = (a.last(), b.first());
        let is_straight = a.bend.is_none() && b.bend.is_none();
        let sign = |plus: bool| if plus { 1.0 } else { -1.0 };
        is_straight
            && match self {
                Self::X(plus) => u.x == 0.0 && w.z == 0.0 && w.x == sign(plus),
                Self::Z(plus) => u.z == 0.0 && w.x == 0.0 && w.z == sign(plus),
            }
    }
}

/// The shape of an element that begins at `to` and not at `from`.
fn shape_from(from: Point, shape: Shape, to: Point) -> Shape {
    match shape {
        Shape::Arc { i, k, clockwise } => {
            let centre = arc_centre(from, i, k);
            Shape::Arc {
                i: centre.x - to.x,
                k: centre.z - to.z,
                clockwise,
            }
        }
        straight => straight,
    }
}

/// Where the new element begins and ends, and its centre; seen from the corner.
struct Cut {
    from: V,
    to: V,
    arc: Option<V>,
}

fn cut(a: &Piece, b: &Piece, corner: Corner, turn: f64) -> Option<Cut> {
    let chamfer = |leg: f64| {
        Some(Cut {
            from: at_distance(a, End::Last, leg)?,
            to: at_distance(b, End::First, leg)?,
            arc: None,
        })
    };
    let size = |length: Length| (length > Length::ZERO).then_some(length.nm() as f64);
    match corner {
        Corner::Chamfer(leg) => chamfer(size(leg)?),
        Corner::ChamferLine(length) => chamfer(leg_of(a, b, size(length)?, turn)?),
        Corner::Round(radius) => round(a, b, size(radius)?, turn),
    }
}

/// Which end of an element is at the corner.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    First,
    Last,
}

impl End {
    /// The direction away from the corner: along the element, or against it.
    fn inwards(self) -> f64 {
        match self {
            Self::First => 1.0,
            Self::Last => -1.0,
        }
    }

    /// The end of `piece` that is not at the corner.
    fn other(self, piece: &Piece) -> V {
        match self {
            Self::First => piece.end,
            Self::Last => piece.start,
        }
    }

    /// `place`, which leaves `rest` of `piece`; its other end where that is nothing, and `None` beyond it. An
    /// arc that is left with less than its rounding could go the other way round.
    fn leaves(self, piece: &Piece, rest: f64, place: V) -> Option<V> {
        if rest < -ROUNDED {
            return None;
        }
        Some(if rest < NOTHING {
            self.other(piece)
        } else {
            place
        })
    }
}

/// The place of an element at a straight distance from the corner; `None` beyond its other end.
fn at_distance(piece: &Piece, end: End, distance: f64) -> Option<V> {
    let inwards = end.inwards();
    let Some(bend) = piece.bend else {
        let rest = (piece.end - piece.start).length() - distance;
        return end.leaves(piece, rest, piece.first() * (inwards * distance));
    };
    let arm = -bend.centre;
    let radius = arm.length();
    if distance > 2.0 * radius + ROUNDED {
        return None;
    }
    let angle = 2.0 * libm::asin((distance / (2.0 * radius)).min(1.0));
    let place = bend.centre + turned(arm, bend.hand() * inwards * angle);
    end.leaves(piece, (piece.turning().abs() - angle) * radius, place)
}

fn turned(v: V, angle: f64) -> V {
    v * libm::cos(angle) + v.left() * libm::sin(angle)
}

/// The distance from the corner at which a chamfer is `length` long.
fn leg_of(a: &Piece, b: &Piece, length: f64, turn: f64) -> Option<f64> {
    // β = π − turn.
    let leg = length / (2.0 * libm::sin((PI - turn.abs()) / 2.0));
    if a.bend.is_none() && b.bend.is_none() {
        return leg.is_finite().then_some(leg);
    }
    // The first of some legs that is wide enough, then half again and again: arcs may come together again.
    let width = |leg: f64| {
        let (from, to) = (
            at_distance(a, End::Last, leg)?,
            at_distance(b, End::First, leg)?,
        );
        Some((to - from).length())
    };
    let longest = longest(a, End::Last).min(longest(b, End::First));
    let steps = (1..=STEPS).map(|step| longest * f64::from(step) / f64::from(STEPS));
    let is_wide = |leg: &f64| width(*leg).is_some_and(|width| width >= length);
    let mut long = { steps }.find(is_wide)?;
    let mut short = (long - longest / f64::from(STEPS)).max(0.0);
    for _ in 0..HALVINGS {
        let middle = (short + long) / 2.0;
        if width(middle)? < length {
            short = middle;
        } else {
            long = middle;
        }
    }
    Some(long)
}

/// The largest distance from the corner up to which an element goes steadily away.
fn longest(piece: &Piece, end: End) -> f64 {
    match piece.bend {
        // By the radius at the corner, as everything here: that of the other end may be another by its rounding.
        Some(bend) => {
            let turning = piece.turning().abs().min(PI);
            2.0 * bend.centre.length() * libm::sin(turning / 2.0)
        }
        None => end.other(piece).length(),
    }
}

/// An arc of `radius`, tangent to both.
fn round(a: &Piece, b: &Piece, radius: f64, turn: f64) -> Option<Cut> {
    if turn.abs() > PI - TANGENT {
        return None;
    }
    let corner = V::default();
    let offset = radius * turn.signum();
    let centre = meet(a.carrier(corner, offset)?, b.carrier(corner, offset)?, turn)?;
    Some(Cut {
        from: touch(a, End::Last, centre, offset)?,
        to: touch(b, End::First, centre, offset)?,
        arc: Some(centre),
    })
}

/// Where a circle around `centre` touches an element; `None` beyond its end.
fn touch(piece: &Piece, end: End, centre: V, offset: f64) -> Option<V> {
    let Some(Carrier::Circle { bend, .. }) = piece.carrier(V::default(), 0.0) else {
        let place = centre - piece.first().left() * offset;
        let way = place.dot(piece.first() * end.inwards());
        let rest = (piece.end - piece.start).length() - way;
        return end.leaves(piece, rest, place).filter(|_| way >= -ROUNDED);
    };
    let arm = -bend.centre;
    let radius = arm.length();
    let place = bend.centre + (centre - bend.centre).unit() * radius;
    let angle = bend.hand() * end.inwards() * arm.turn(place - bend.centre);
    let angle = if angle * radius < -ROUNDED {
        angle + 2.0 * PI
    } else {
        angle
    };
    end.leaves(piece, (piece.turning().abs() - angle) * radius, place)
}
