//! Where the centre of the nose goes at a corner between two motions.
//!
//! The corner is the origin. A result is a list of places: the first is the end of the first motion, the last
//! is the start of
//! the second, and straight moves join them. Must not know the window, tips and alarms.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Entry;
use crate::geometry::{Carrier, Piece, V, meet};

/// A corner whose offset elements are no further apart than this, nm, is tangent: ends are rounded in the program.
const TANGENT: f64 = 500.0;
/// The same where the offset elements do not meet.
const NEARLY_TANGENT: f64 = 5_000.0;
/// A corner that turns further is none of the two, radians. The nose is then 40 nm closer per millimetre of
/// its radius.
const TANGENT_TURN: f64 = 0.02;
/// A turn that is a reversal, or a right angle, within the error of the calculation, radians.
const SAME: f64 = 1e-6;
/// An intersection further than this many radii from the corner is another one.
const FAR: f64 = 3.0;

/// A corner, seen by the nose.
struct Corner<'a> {
    a: &'a Piece,
    b: &'a Piece,
    offset: f64,
    /// Directions before and after it.
    u: [V; 2],
    /// From the corner to the centre, perpendicular to the first and the second motion.
    feet: [V; 2],
    /// How far the path turns, positive to the left.
    turn: f64,
}

impl<'a> Corner<'a> {
    fn new(a: &'a Piece, b: &'a Piece, offset: f64) -> Self {
        let u = [a.last(), b.first()];
        Self {
            a,
            b,
            offset,
            u,
            feet: u.map(|u| u.left() * offset),
            turn: u[0].turn(u[1]),
        }
    }

    fn is_reversal(&self) -> bool {
        self.turn.abs() > PI - SAME
    }

    /// The path turns away from the nose. Where it turns back on itself, the curvature says on which side the
    /// workpiece is.
    fn is_outside(&self) -> bool {
        if self.is_reversal() {
            let bend = self.a.curvature(V::default()) + self.b.curvature(V::default());
            bend * self.offset >= 0.0
        } else {
            self.turn * self.offset < 0.0
        }
    }

    fn is_tangent(&self, apart: f64) -> bool {
        let turn = self.turn.abs();
        turn < TANGENT_TURN && turn * self.offset.abs() <= apart
    }

    /// Where the straight lines through both feet meet.
    fn peak(&self) -> V {
        (self.feet[0] + self.feet[1]) * (1.0 / (1.0 + libm::cos(self.turn)))
    }

    fn carriers(&self) -> Option<[Carrier; 2]> {
        let corner = V::default();
        let a = self.a.carrier(corner, self.offset)?;
        Some([a, self.b.carrier(corner, self.offset)?])
    }

    fn is_lines(&self) -> bool {
        self.a.bend.is_none() && self.b.bend.is_none()
    }

    /// Straight on from both feet and across. The foot of an arc is a place of its own; on a line it is none.
    fn straight_on(&self, between: &[V]) -> Vec<V> {
        let [first, last] = [self.a, self.b].map(|piece| piece.bend.is_some());
        let before = first.then_some(self.feet[0]);
        let after = last.then_some(self.feet[1]);
        let between = between.iter().copied();
        before.into_iter().chain(between).chain(after).collect()
    }

    /// Round an outside corner.
    fn round(&self) -> Vec<V> {
        if self.turn.abs() > FRAC_PI_2 + SAME {
            let [u, w] = self.u.map(|u| u * self.offset.abs());
            return self.straight_on(&[self.feet[0] + u, self.feet[1] - w]);
        }
        match self.intersection_ahead() {
            Some(place) => vec![place],
            None => self.straight_on(&[self.peak()]),
        }
    }

    /// Where both offset elements meet after the end of the first and before the start of the second.
    fn intersection_ahead(&self) -> Option<V> {
        if self.is_lines() {
            return Some(self.peak());
        }
        let [a, b] = self.carriers()?;
        let place = meet(a, b, self.turn)?;
        let goes_on =
            |piece: &Piece, u: V| piece.bend.is_none() || piece.direction(place).dot(u) > 0.0;
        let is_ahead = (place - self.feet[0]).dot(self.u[0]) >= 0.0
            && (place - self.feet[1]).dot(self.u[1]) <= 0.0
            && goes_on(self.a, self.u[0])
            && goes_on(self.b, self.u[1]);
        (is_ahead && place.length() <= FAR * self.offset.abs()).then_some(place)
    }
}

/// Between two compensated motions. `None` where the offset elements of an inside corner do not meet.
pub(super) fn corner(a: &Piece, b: &Piece, offset: f64) -> Option<Vec<V>> {
    let corner = Corner::new(a, b, offset);
    if corner.is_tangent(TANGENT) {
        return Some(vec![corner.peak()]);
    }
    if corner.is_outside() {
        return Some(corner.round());
    }
    if corner.is_reversal() {
        return None;
    }
    if corner.is_lines() {
        return Some(vec![corner.peak()]);
    }
    let [a, b] = corner.carriers()?;
    match meet(a, b, corner.turn) {
        Some(place) => Some(vec![place]),
        None => corner
            .is_tangent(NEARLY_TANGENT)
            .then(|| vec![corner.peak()]),
    }
}

/// From a motion in which the compensation comes into force to the next.
pub(super) fn start_up(a: &Piece, b: &Piece, offset: f64, entry: Entry) -> Vec<V> {
    let corner = Corner::new(a, b, offset);
    match entry {
        Entry::B if corner.is_outside() => corner.round(),
        _ => vec![corner.feet[1]],
    }
}

/// From the last compensated motion to the one in which the compensation goes.
pub(super) fn cancel(a: &Piece, b: &Piece, offset: f64, entry: Entry) -> Vec<V> {
    let corner = Corner::new(a, b, offset);
    match entry {
        Entry::B if corner.is_outside() => corner.round(),
        _ => vec![corner.feet[0]],
    }
}
