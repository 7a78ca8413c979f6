//! One motion in the window: what is programmed, and where the tip goes instead.
//!
//! Must not know other motions.

use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::units::Length;

use super::{Motion, Post, Side};
use crate::geometry::{Piece, V, arc_centre};
use crate::plane::{Element, Point, Shape};

/// A motion in the window.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Where it begins on the drawing.
    pub(super) start: Point,
    /// As it is programmed.
    pub(super) element: Element,
    /// Offset to the left of the path, nm; 0 without compensation.
    pub(super) offset: f64,
    /// From the imaginary tip to the centre of the nose.
    tip: Point,
    /// How long the compensation is in force where it begins.
    pub(super) begins: Begins,
    /// Where the tip begins.
    pub(super) from: Point,
    /// Where the tip ends; then the places round the corner. Empty until the next motion is known.
    pub(super) way: Vec<Point>,
    /// Nothing is left of the motion.
    pub(super) is_nothing: bool,
}

/// How long the compensation is in force where a motion begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Begins {
    /// It comes into force in this motion.
    StartUp,
    /// It came into force in the motion before.
    AfterStartUp,
    /// Longer.
    InForce,
}

impl Begins {
    /// For the motion after this one.
    pub(super) const fn next(self) -> Self {
        match self {
            Self::StartUp => Self::AfterStartUp,
            Self::AfterStartUp | Self::InForce => Self::InForce,
        }
    }
}

impl Track {
    /// `motion`, which begins at `start` and is the first with compensation, or one without.
    pub(super) fn new(start: Point, motion: &Motion, post: Post) -> Self {
        let radius = motion.nose.radius.nm() as f64;
        let mirror = match post {
            Post::Rear => 1,
            Post::Front => -1,
        };
        let left = mirror as f64 * radius;
        let offset = match motion.side {
            Side::None => 0.0,
            Side::Left => left,
            Side::Right => -left,
        };
        let mut track = Self {
            start,
            element: motion.element,
            offset,
            tip: Point::default(),
            begins: Begins::StartUp,
            from: start,
            way: Vec::new(),
            is_nothing: false,
        };
        if track.is_compensated() {
            let (x, z) = centre_of_tip(motion.nose.tip);
            let radius = motion.nose.radius.abs();
            track.tip = Point {
                x: radius.times(x * mirror),
                z: radius.times(z),
            };
        } else {
            track.way = vec![motion.element.end];
        }
        track
    }

    /// True where there is a radius on one of the sides.
    pub(super) fn is_compensated(&self) -> bool {
        self.offset != 0.0
    }

    /// Same side, radius and tip.
    pub(super) fn has_the_nose_of(&self, other: &Self) -> bool {
        self.offset == other.offset && self.tip == other.tip
    }

    /// The nose radius.
    pub(super) fn radius(&self) -> Length {
        Length::from_nm(self.offset.abs() as i64)
    }

    /// It cuts, and the nose is on the drawing along all of it.
    pub(super) fn is_surface(&self) -> bool {
        self.begins != Begins::StartUp && self.element.shape != Shape::Rapid
    }

    /// The compensation comes and goes in straight moves.
    pub(super) fn must_be_straight(&self) -> Result<(), Alarm> {
        match self.element.shape {
            Shape::Arc { .. } => Err(Alarm::new(Code::NoseStartUpArc, self.element.span)),
            Shape::Rapid | Shape::Line => Ok(()),
        }
    }

    /// The drawing, seen from `origin`.
    pub(super) fn piece_at(&self, origin: Point) -> Piece {
        Piece::new(origin, self.start, &self.element)
    }

    /// The path of the centre, seen from `origin`; `None` until the end is known, and where nothing is left.
    pub(super) fn centre_piece_at(&self, origin: Point) -> Option<Piece> {
        let mut element = self.output()?;
        element.end = plus(element.end, self.tip);
        Some(Piece::new(origin, plus(self.from, self.tip), &element))
    }

    /// The path of the centre with the moves round the corner after it, as above; the motion itself comes
    /// first, and as a
    /// place where nothing is left of it.
    pub(super) fn nose_pieces_at(&self, origin: Point) -> Vec<Piece> {
        let line = |from, to| Piece {
            start: V::between(origin, plus(from, self.tip)),
            end: V::between(origin, plus(to, self.tip)),
            bend: None,
        };
        let own = self.centre_piece_at(origin);
        let own = own.or_else(|| self.way.first().map(|end| line(*end, *end)));
        let corners = self.way.windows(2).map(|pair| line(pair[0], pair[1]));
        own.into_iter().chain(corners).collect()
    }

    /// The tip where the centre is at `place` seen from `origin`.
    pub(super) fn tip_at(&self, origin: Point, place: V) -> Point {
        let centre = place.from(origin);
        Point {
            x: centre.x - self.tip.x,
            z: centre.z - self.tip.z,
        }
    }

    /// The tip perpendicular to the end.
    pub(super) fn foot_of_end(&self) -> Point {
        let end = self.element.end;
        self.tip_at(end, self.piece_at(end).last().left() * self.offset)
    }

    /// The motion of the tip; `None` where nothing is left of it.
    pub(super) fn output(&self) -> Option<Element> {
        let end = *self.way.first()?;
        if self.is_nothing {
            return None;
        }
        let mut element = Element {
            end,
            ..self.element
        };
        if let Shape::Arc { i, k, .. } = &mut element.shape {
            let centre = arc_centre(self.start, *i, *k);
            *i = centre.x - self.tip.x - self.from.x;
            *k = centre.z - self.tip.z - self.from.z;
        }
        Some(element)
    }

    /// The moves round the corner after it.
    pub(super) fn corners(&self) -> impl DoubleEndedIterator<Item = Element> + use<> {
        let shape = match self.element.shape {
            Shape::Rapid => Shape::Rapid,
            Shape::Line | Shape::Arc { .. } => Shape::Line,
        };
        let span = self.element.span;
        let pairs: Vec<_> = self.way.windows(2).map(|pair| (pair[0], pair[1])).collect();
        pairs
            .into_iter()
            .filter(|(from, to)| from != to)
            .map(move |(_, end)| Element { end, shape, span })
    }
}

fn plus(a: Point, b: Point) -> Point {
    Point {
        x: a.x + b.x,
        z: a.z + b.z,
    }
}

/// The centre seen from the imaginary tip, in radii along X and Z, for a tip direction.
const fn centre_of_tip(tip: u8) -> (i64, i64) {
    match tip {
        1 => (-1, -1),
        2 => (-1, 1),
        3 => (1, 1),
        4 => (1, -1),
        5 => (0, -1),
        6 => (-1, 0),
        7 => (0, 1),
        8 => (1, 0),
        _ => (0, 0),
    }
}
