//! The shifted contour as a height over the way of the strokes, and where a level meets it.
//!
//! Ends are exact integers. A crossing is rounded to the nanometre away from the part. Square roots are those of integers,
//! so a crossing has the same bits everywhere.

use super::frame::{Frame, Local};

/// What is taken off a wall and is nothing, nm: a circle whose centre is rounded.
const NOTHING: f64 = 1_000.0;

/// The circle of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub centre: Local,
    /// Radius squared, nm².
    pub square: i128,
}

/// A part of an element in which neither `h` nor `l` turns back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub from: Local,
    pub to: Local,
    /// The element of the contour, from 0.
    pub element: usize,
    /// For an arc.
    pub circle: Option<Circle>,
}

/// Which neighbour a crossing between two nanometres goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Round {
    Down,
    Up,
}

/// A place on the profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Which piece.
    pub piece: usize,
    /// Where on it.
    pub at: Local,
}

/// A part of a level above the profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    /// Where the profile comes down through the level.
    pub left: Place,
    /// Where it goes up through the level, or ends.
    pub right: Place,
}

/// The pieces of `C'` from `A'` on.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    pub frame: Frame,
    pub pieces: Vec<Piece>,
    /// True where the first piece is the move of block `ns`.
    pub has_first: bool,
}

/// The root of a square, rounded down.
pub(super) fn floor_root(square: i128) -> i64 {
    i64::try_from(square.max(0).isqrt()).unwrap_or(i64::MAX)
}

/// The root of a square, rounded up.
pub(super) fn ceil_root(square: i128) -> i64 {
    let root = floor_root(square);
    root + i64::from(i128::from(root) * i128::from(root) < square)
}

impl Piece {
    /// Where the piece is at height `h`, which lies between its ends.
    fn cross(&self, h: i64, round: Round) -> Local {
        let l = match self.circle {
            None => self.cross_line(h, round),
            Some(circle) => self.cross_circle(circle, h, round),
        };
        Local {
            h,
            l: l.clamp(self.from.l, self.to.l),
        }
    }

    fn cross_line(&self, h: i64, round: Round) -> i64 {
        let rise = i128::from(self.to.h) - i128::from(self.from.h);
        if rise == 0 {
            return self.from.l;
        }
        let way = (i128::from(h) - i128::from(self.from.h))
            * (i128::from(self.to.l) - i128::from(self.from.l));
        let (way, rise) = (way * rise.signum(), rise.abs());
        let whole = match round {
            Round::Down => way.div_euclid(rise),
            Round::Up => -(-way).div_euclid(rise),
        };
        self.from.l + i64::try_from(whole).unwrap_or(0)
    }

    fn cross_circle(&self, circle: Circle, h: i64, round: Round) -> i64 {
        let rise = i128::from(h) - i128::from(circle.centre.h);
        let square = circle.square - rise * rise;
        let before = self.to.l <= circle.centre.l;
        match (before, round) {
            (true, Round::Down) => circle.centre.l - ceil_root(square),
            (true, Round::Up) => circle.centre.l - floor_root(square),
            (false, Round::Down) => circle.centre.l + floor_root(square),
            (false, Round::Up) => circle.centre.l + ceil_root(square),
        }
    }
}

impl Profile {
    /// The lowest height; `None` where nothing moves.
    pub fn lowest(&self) -> Option<i64> {
        self.pieces.iter().map(|piece| piece.to.h).min()
    }

    /// The first part of level `h` between two pieces (both included) that has something of the profile below it. The
    /// profile begins above the level.
    pub fn interval(&self, h: i64, first: usize, last: usize) -> Option<Interval> {
        let mut left: Option<Place> = None;
        let mut deep = false;
        let pieces = self.pieces.iter().enumerate();
        for (index, piece) in pieces.take(last + 1).skip(first) {
            if left.is_none() && piece.to.h <= h {
                left = Some(Place {
                    piece: index,
                    at: piece.cross(h, Round::Up),
                });
                deep = false;
            }
            let Some(begin) = left else { continue };
            deep |= piece.to.h < h;
            let right = if piece.to.h > h {
                piece.cross(h, Round::Down)
            } else if index == last {
                Local { h, l: piece.to.l }
            } else {
                continue;
            };
            left = None;
            if deep && right.l > begin.at.l {
                return Some(Interval {
                    left: begin,
                    right: Place {
                        piece: index,
                        at: right,
                    },
                });
            }
        }
        None
    }

    /// The mouth of a pocket that begins at `left`: the last of the highest places before it, from `begin` on. What is
    /// above `limit` counts as high as `limit`.
    pub fn mouth(&self, begin: Place, left: Place, limit: i64) -> Place {
        let mut best = begin;
        best.at.h = best.at.h.min(limit);
        let pieces = self.pieces.iter().enumerate();
        for (index, piece) in pieces.take(left.piece + 1).skip(begin.piece) {
            if piece.from.h >= limit && piece.to.h < limit {
                best = Place {
                    piece: index,
                    at: piece.cross(limit, Round::Up),
                };
            }
            if piece.to.h.min(limit) >= best.at.h {
                best = Place {
                    piece: index,
                    at: Local {
                        h: piece.to.h.min(limit),
                        l: piece.to.l,
                    },
                };
            }
        }
        best
    }

    /// Where a level begins at height `h`: on the move of `ns`, or at `A'`.
    pub fn begin(&self, h: i64, start: Local) -> i64 {
        match self.first() {
            Some(first) if h < start.h => first.cross(h.max(first.to.h), Round::Up).l,
            _ => start.l,
        }
    }

    /// The move of `ns`, where it comes down.
    pub fn first(&self) -> Option<&Piece> {
        let first = self.pieces.first()?;
        (self.has_first && first.to.h < first.from.h).then_some(first)
    }

    /// True where the move of `ns` has a wall of its own: at rapid it would go through what stands beside it.
    pub fn is_slanted(&self) -> bool {
        let first = self.first();
        first.is_some_and(|first| first.from.l != first.to.l)
    }

    /// True with a pocket: the contour comes down again behind its first block.
    pub fn sinks(&self) -> bool {
        let mut pieces = self.pieces.iter().filter(|piece| piece.element > 0);
        pieces.any(|piece| piece.to.h < piece.from.h)
    }

    /// True where a move by `up` and by `on` along the strokes takes something off a wall that leads down behind the
    /// first block.
    pub fn loses_on_a_wall(&self, up: i64, on: i64) -> bool {
        let loses = |rise: i64, run: i64| {
            let (rise, run) = (rise as f64, run as f64);
            let left = run * up as f64 - rise * on as f64;
            left < -NOTHING * libm::hypot(rise, run)
        };
        let walls = self.pieces.iter().filter(|piece| piece.element > 0);
        let mut walls = walls.filter(|piece| piece.to.h < piece.from.h);
        walls.any(|piece| match piece.circle {
            None => loses(piece.to.h - piece.from.h, piece.to.l - piece.from.l),
            // It is steepest at one of its ends, where its direction is across the radius.
            Some(circle) => [piece.from, piece.to].into_iter().any(|at| {
                let (h, l) = (at.h - circle.centre.h, at.l - circle.centre.l);
                loses(-l.abs(), h.abs())
            }),
        })
    }

    /// True where the straight way from the profile's end to `home` goes through it.
    pub fn blocks(&self, end: Local, home: Local) -> bool {
        let way = i128::from(end.l) - i128::from(home.l);
        let rise = i128::from(end.h) - i128::from(home.h);
        let is_above = |place: Local| {
            let from_home = i128::from(place.l) - i128::from(home.l);
            (0..=way).contains(&from_home)
                && way > 0
                && (i128::from(place.h) - i128::from(home.h)) * way > rise * from_home
        };
        // A block ns that moves along one axis is no wall.
        let walls = self
            .pieces
            .iter()
            .filter(|piece| piece.element > 0 || piece.from.l != piece.to.l);
        walls.into_iter().any(|piece| {
            let (from, to) = (piece.from, piece.to);
            let top = from.h.max(to.h);
            // An arc stays below the corners over it, and what lies over home below its higher end.
            let (from_h, to_h) = match piece.circle {
                Some(_) => (top, top),
                None => (from.h, to.h),
            };
            let over_home = from.l < home.l && home.l < to.l;
            is_above(Local {
                h: from_h,
                l: from.l,
            }) || is_above(Local { h: to_h, l: to.l })
                || (over_home && is_above(Local { h: top, l: home.l }))
        })
    }
}
