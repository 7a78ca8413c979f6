//! Makes the profile from a contour: finds how the contour lies, and refuses what turns back.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::program::ARC_END_TOLERANCE;
use leadscrew_core::units::{Diameter, Length};

use super::Contour;
use super::frame::{Frame, Local};
use super::profile::{Circle, Piece, Profile, ceil_root, floor_root};
use super::words::{Allowance, Along};
use crate::plane::{Element, Point, Shape};

/// How far an arc may go back, nm, as its centre may miss: a program rounds it.
const ROUNDING: i64 = ARC_END_TOLERANCE.nm();

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
            self.refuse_arc(element, false, start.l - (centre.l - radius))?;
        }
        if (end.h - centre.h) * up < 0 {
            self.refuse_arc(element, false, centre.l + radius - end.l)?;
        }
        if !(start.l < centre.l && centre.l < end.l) {
            return Ok(None);
        }
        let mut top = centre.h + up * floor_root(circle.square);
        if self.one_way {
            let from = if over { end.h } else { start.h };
            self.refuse_arc(element, true, (top - from).abs())?;
            // What is left of the way back is flat.
            top = from;
        }
        Ok(Some(Local {
            h: top,
            l: centre.l,
        }))
    }

    /// The same within an arc.
    fn refuse_arc(&self, element: &Element, infeed: bool, back: i64) -> Result<(), Alarm> {
        if back <= ROUNDING {
            return Ok(());
        }
        self.refuse(element, infeed, back)
    }

    fn refuse(&self, element: &Element, infeed: bool, back: i64) -> Result<(), Alarm> {
        if back <= self.tolerance {
            return Ok(());
        }
        let letter = self.profile.frame.along.letter(infeed);
        let back = Length::from_nm(back);
        let back = match letter {
            b'X' => Arg::Diameter(Diameter::of_radius(back)),
            _ => Arg::Length(back),
        };
        Err(Alarm::new(Code::ContourTurnsBack, element.span).with([Arg::Letter(letter), back]))
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
