//! The shifted contour as a height over the way of the strokes, and where a level meets it.
//!
//! Ends are exact integers. A crossing is rounded to the nanometre away from the part. Square roots are those of integers,
//! so a crossing has the same bits everywhere.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::units::Length;

use super::frame::{Frame, Local};
use super::rough::Along;
use super::{Allowance, Contour};
use crate::plane::{Element, Point, Shape};

/// How far an arc whose centre was rounded may go back, nm.
const ROUNDING: i64 = 2;

/// The circle of a piece.
#[derive(Clone, Copy, Debug)]
struct Circle {
    centre: Local,
    /// Radius squared, nm².
    square: i128,
}

/// A part of an element in which neither `h` nor `l` turns back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub from: Local,
    pub to: Local,
    /// The element of the contour, from 0.
    pub element: usize,
    circle: Option<Circle>,
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

fn floor_root(square: i128) -> i64 {
    i64::try_from(square.max(0).isqrt()).unwrap_or(i64::MAX)
}

fn ceil_root(square: i128) -> i64 {
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

/// What the profile is made from, while it is made.
struct Maker<'a> {
    profile: Profile,
    at: Local,
    /// Type I: heights may not turn back either.
    one_way: bool,
    tolerance: i64,
    allowance: &'a Allowance,
}

impl Profile {
    /// The profile of `contour`, moved by `allowance`.
    ///
    /// # Errors
    /// [`Code::ContourTurnsBack`] at the element that turns back by more than `tolerance`.
    pub fn new(
        contour: &Contour,
        along: Along,
        allowance: &Allowance,
        one_way: bool,
        tolerance: Length,
    ) -> Result<Self, Alarm> {
        let frame = frame(contour, along);
        let mut maker = Maker {
            profile: Self {
                frame,
                pieces: Vec::new(),
                has_first: false,
            },
            at: frame.enter(allowance.shift(contour.start)),
            one_way,
            tolerance: tolerance.nm(),
            allowance,
        };
        let mut from = contour.start;
        for (index, element) in contour.elements.iter().enumerate() {
            maker.add(index, from, element)?;
            from = element.end;
        }
        Ok(maker.profile)
    }

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

impl Maker<'_> {
    fn add(&mut self, index: usize, from: Point, element: &Element) -> Result<(), Alarm> {
        let frame = self.profile.frame;
        let start = frame.enter(self.allowance.shift(from));
        let end = frame.enter(self.allowance.shift(element.end));
        self.refuse(element, false, self.at.l - end.l)?;
        if self.one_way && index > 0 {
            self.refuse(element, true, self.at.h - end.h)?;
        }
        let mut apex = None;
        let circle = match element.shape {
            Shape::Arc { i, k, clockwise } => {
                let (centre, over) = (
                    Point {
                        x: from.x + i,
                        z: from.z + k,
                    },
                    frame.is_over(clockwise),
                );
                let centre = frame.enter(self.allowance.shift(centre));
                let (h, l) = (start.h - centre.h, start.l - centre.l);
                let square = i128::from(h) * i128::from(h) + i128::from(l) * i128::from(l);
                let circle = Circle { centre, square };
                apex = self.turns(element, start, end, circle, over)?;
                (square > 0).then_some(circle)
            }
            Shape::Rapid | Shape::Line => None,
        };
        // Within the tolerance the profile goes on without going back.
        let to = Local {
            h: if self.one_way && index > 0 {
                end.h.max(self.at.h)
            } else {
                end.h
            },
            l: end.l.max(self.at.l),
        };
        if let Some(apex) = apex {
            self.push(index, apex, circle);
        }
        self.push(index, to, circle);
        Ok(())
    }

    fn push(&mut self, element: usize, to: Local, circle: Option<Circle>) {
        if to != self.at {
            self.profile.has_first |= element == 0;
            self.profile.pieces.push(Piece {
                from: self.at,
                to,
                element,
                circle,
            });
        }
        self.at = to;
    }

    /// Refuses an arc that turns back; gives its highest or lowest place where that is not one of its ends.
    fn turns(
        &self,
        element: &Element,
        start: Local,
        end: Local,
        circle: Circle,
        over: bool,
    ) -> Result<Option<Local>, Alarm> {
        let (centre, up) = (circle.centre, if over { 1 } else { -1 });
        let radius = ceil_root(circle.square);
        if start == end {
            self.refuse(element, false, 2 * radius)?;
        }
        if (start.h - centre.h) * up < 0 {
            self.refuse(element, false, start.l - (centre.l - radius) - ROUNDING)?;
        }
        if (end.h - centre.h) * up < 0 {
            self.refuse(element, false, centre.l + radius - end.l - ROUNDING)?;
        }
        if !(start.l < centre.l && centre.l < end.l) {
            return Ok(None);
        }
        let top = centre.h + up * floor_root(circle.square);
        if self.one_way {
            let from = if over { end.h } else { start.h };
            self.refuse(element, true, (top - from).abs() - ROUNDING)?;
        }
        Ok(Some(Local {
            h: top,
            l: centre.l,
        }))
    }

    fn refuse(&self, element: &Element, infeed: bool, back: i64) -> Result<(), Alarm> {
        if back <= self.tolerance {
            return Ok(());
        }
        let letter = self.profile.frame.along.letter(infeed);
        Err(Alarm::new(Code::ContourTurnsBack, element.span)
            .with([Arg::Letter(letter), Arg::Length(Length::from_nm(back))]))
    }
}

/// How the contour lies: the strokes go toward its end, and the tool comes from `A`.
fn frame(contour: &Contour, along: Along) -> Frame {
    let start = contour.start;
    let (start_h, start_l) = along.split(start);
    let end = contour.elements.last().map_or(start, |last| last.end);
    let forward = match along.split(end).1 - start_l {
        0 => -1,
        way => way.signum(),
    };
    let mut frame = Frame {
        along,
        up: 1,
        forward,
    };
    let first = contour.elements.first().map_or(start, |ns| ns.end);
    let mut farthest = start_h - along.split(first).0;
    if farthest == 0 {
        // Block ns does not feed in: what is farthest from A lies in the part.
        let mut from = start;
        for element in &contour.elements {
            let mut see = |h: i64| {
                if h.abs() > farthest.abs() {
                    farthest = h;
                }
            };
            see(start_h - along.split(element.end).0);
            if let Shape::Arc { i, k, clockwise } = element.shape {
                let centre = Point {
                    x: from.x + i,
                    z: from.z + k,
                };
                let ((h, l), (to, from)) = (
                    along.split(centre),
                    (along.split(element.end), along.split(from)),
                );
                let (a, b) = (i128::from(from.0 - h), i128::from(from.1 - l));
                let radius = floor_root(a * a + b * b);
                if (from.1 < l) != (to.1 < l) {
                    let over = if frame.is_over(clockwise) { 1 } else { -1 };
                    see(start_h - (h + over * radius));
                }
            }
            from = element.end;
        }
    }
    if farthest < 0 {
        frame.up = -1;
    }
    frame
}
