//! G71 and G72: strokes level by level, each pocket to its bottom, then the contour with its allowance.

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Arg, At, Code};
use leadscrew_core::units::Length;

use super::frame::Local;
use super::profile::{Place, Profile};
use super::tree::{self, Stroke, Tree};
use super::words::{Allowance, Along, Roughing};
use super::{Contour, Cut};
use crate::plane::{Element, Point, Shape};

/// Moves that are decided and not yet given.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// A straight move that belongs to no element.
    Go { to: Local, rapid: bool },
    /// On the move of block `ns`.
    First(Local),
    /// On the profile, from piece `next` to a place.
    Walk { next: usize, to: Place },
    /// On `C'`, from this element to the end.
    Contour(usize),
}

/// What is decided next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Strokes,
    Contour,
    Home,
    Done,
}

/// The moves of G71 or G72.
#[derive(Clone, Debug)]
pub struct Rough<'a> {
    contour: &'a Contour,
    words: Roughing,
    /// What the strokes leave.
    left: Allowance,
    profile: Profile,
    /// The profile of the last pass, where the strokes leave more than it does.
    last: Option<Profile>,
    tree: Tree,
    steps: VecDeque<Step>,
    stage: Stage,
    /// `A'`.
    start: Local,
    /// Where the steps that are decided end.
    at: Local,
    /// Where the last move that was given ends.
    given: Point,
}

impl<'a> Rough<'a> {
    pub(super) fn new(contour: &'a Contour, along: Along, words: &Roughing) -> Result<Self, Alarm> {
        let refused = |word: At<Length>| Alarm::new(Code::ContourDepth, word.span);
        if words.depth.value <= Length::ZERO || !words.depth.value.is_in_range() {
            return Err(refused(words.depth).word(match along {
                Along::Z => b'U',
                Along::X => b'W',
            }));
        }
        if words.retract.value < Length::ZERO || !words.retract.value.is_in_range() {
            return Err(refused(words.retract).word(b'R'));
        }
        let (infeed, stroke) = match along {
            Along::Z => (contour.axes.x, contour.axes.z),
            Along::X => (contour.axes.z, contour.axes.x),
        };
        if !infeed {
            let span = contour.elements.first().map_or(words.span, |ns| ns.span);
            return Err(Alarm::new(Code::ContourFirst, span));
        }
        let left = words.allowance.and(words.left);
        let of = |left| Profile::new(contour, along, left, !stroke, words.tolerance);
        let profile = of(&left)?;
        let (x, z) = into_the_part(&profile, words.left);
        let words_left = [(x, b'I', words.left.x.radius()), (z, b'K', words.left.z)];
        if let Some((_, letter, length)) = words_left.into_iter().find(|(into, ..)| *into) {
            let alarm = Alarm::new(Code::RoughLeftInside, words.span).word(letter);
            return Err(alarm.with([Arg::Length(length)]));
        }
        let has_wall = profile.sinks() || profile.is_slanted();
        if words.left.along(along) != Length::ZERO && has_wall {
            return Err(
                Alarm::new(Code::PocketAllowance, words.span).word(match along {
                    Along::Z => b'K',
                    Along::X => b'I',
                }),
            );
        }
        let last = match words.left {
            Allowance::NONE => None,
            _ => Some(of(&words.allowance)?),
        };
        let start = profile.frame.enter(left.shift(contour.start));
        tree::check(contour, &profile, start, words.depth.value.nm())?;
        let first = Step::Go {
            to: start,
            rapid: true,
        };
        Ok(Self {
            contour,
            words: *words,
            tree: Tree::new(&profile, start),
            profile,
            left,
            last,
            steps: VecDeque::from([first]),
            stage: Stage::Strokes,
            start,
            at: start,
            given: contour.start,
        })
    }

    /// True where the pass along the contour cuts into a wall that leads down into a pocket: the allowance along the
    /// strokes takes more from it than the one across them leaves.
    #[must_use]
    pub fn cuts_into_a_wall(&self) -> bool {
        let moved = self.words.allowance.shift(Point::default());
        let Local { h: up, l: on } = self.profile.frame.enter(moved);
        on < 0 && self.profile.loses_on_a_wall(up, on)
    }

    /// True where the contour with its allowance is higher than the cycle's start in a place: what stands there is cut
    /// by the last pass alone.
    #[must_use]
    pub fn starts_inside(&self) -> bool {
        let start = self.start.h;
        self.profile.pieces.iter().any(|piece| piece.to.h > start)
    }

    /// Decides on steps to a place.
    fn go(&mut self, to: Local, rapid: bool) {
        self.steps.push_back(Step::Go { to, rapid });
        self.at = to;
    }

    fn first_to(&mut self, to: Local) {
        self.steps.push_back(Step::First(to));
        self.at = to;
    }

    /// Back along a level to the move of `ns`.
    fn back_to_first(&mut self, h: i64) {
        let l = self.profile.begin(h, self.start);
        self.go(Local { h, l }, true);
        if h > self.start.h && self.profile.is_slanted() {
            self.go(self.start, true);
        }
    }

    /// Decides on the next stroke; false where there is none.
    fn stroke(&mut self) -> bool {
        let depth = self.words.depth.value.nm();
        let Some(stroke) = self.tree.next(&self.profile, |level| Some(level - depth)) else {
            return false;
        };
        self.approach(&stroke);
        let (left, right) = (stroke.interval.left.at, stroke.interval.right.at);
        self.go(right, false);
        let retract = self.words.retract.value.nm();
        let away = Local {
            h: right.h + retract,
            l: (right.l - retract).max(left.l),
        };
        self.go(away, !self.words.retract_feeds);
        true
    }

    /// To where the stroke begins, over levels that are open.
    fn approach(&mut self, stroke: &Stroke) {
        let Stroke {
            interval,
            mouth,
            above,
        } = *stroke;
        let high = above + self.words.retract.value.nm();
        if self.at.h < high && self.at != self.start {
            self.go(
                Local {
                    h: high,
                    l: self.at.l,
                },
                true,
            );
        }
        let to = interval.left;
        if let (0, Some(first)) = (mouth.piece, self.profile.first().copied()) {
            self.back_to_first(self.at.h);
            if to.piece == 0 {
                self.first_to(to.at);
                return;
            }
            self.first_to(first.to);
            self.steps.push_back(Step::Walk { next: 1, to });
        } else {
            if self.at != mouth.at {
                self.go(
                    Local {
                        h: high,
                        l: mouth.at.l,
                    },
                    true,
                );
                self.go(mouth.at, false);
            }
            let next = mouth.piece;
            self.steps.push_back(Step::Walk { next, to });
        }
        self.at = to.at;
    }

    /// Up out of the last pocket, and to where the contour begins.
    fn approach_contour(&mut self) {
        if self.at != self.start {
            let high = self.tree.open() + self.words.retract.value.nm();
            let h = self.at.h.max(high);
            self.go(Local { h, l: self.at.l }, true);
            self.back_to_first(h);
        }
        if !self.words.semi_finish {
            return;
        }
        if self.last.is_some() {
            self.approach_pass();
        }
        let first = self.contour.elements.first();
        if let Some(first) = first {
            let to = self.shifted(first.end);
            self.first_to(to);
        }
        self.steps.push_back(Step::Contour(1));
    }

    /// From where the strokes begin to where the last pass does: that lies nearer to the contour.
    fn approach_pass(&mut self) {
        let begin = self.shifted(self.contour.start);
        if !self.profile.is_slanted() {
            // Down to the contour where it begins, and not in front of it.
            self.go(
                Local {
                    l: begin.l,
                    ..self.at
                },
                true,
            );
            return;
        }
        // The move of `ns` is a wall that the pass cuts from its front.
        let h = self.at.h.max(self.start.h);
        self.go(Local { h, ..self.at }, true);
        self.go(Local { h, l: self.start.l }, true);
        self.go(begin, false);
    }

    /// Back to `A`: straight, or over the contour where it stands in the way.
    fn home(&mut self) {
        let home = self.profile.frame.enter(self.contour.start);
        if self.words.semi_finish {
            let last = self.contour.elements.last();
            let end = last.map_or(home, |last| self.shifted(last.end));
            let profile = self.last.as_ref().unwrap_or(&self.profile);
            if profile.blocks(end, home) {
                let pieces = profile.pieces.iter();
                let high = home.h.max(self.start.h);
                let h = pieces.map(|piece| piece.to.h).fold(high, i64::max);
                self.go(Local { h, l: end.l }, true);
                self.go(Local { h, l: home.l }, true);
            }
        }
        self.go(home, true);
    }

    fn shifted(&self, point: Point) -> Local {
        self.profile.frame.enter(self.words.allowance.shift(point))
    }

    /// The move of one step; what is left of the step goes back to the front.
    fn take(&mut self, step: Step) -> Option<Cut> {
        match step {
            Step::Go { to, rapid } => {
                let shape = if rapid { Shape::Rapid } else { Shape::Line };
                Some(self.cut(self.profile.frame.leave(to), shape, None))
            }
            Step::First(to) => {
                let elements = &self.contour.elements;
                let shape = if self.profile.is_slanted() {
                    Shape::Line
                } else {
                    elements.first()?.shape
                };
                Some(self.cut(self.profile.frame.leave(to), shape, Some(0)))
            }
            Step::Walk { next, to } => {
                let (end, element, after) = self.until_joint(next, to)?;
                if let Some(next) = after {
                    self.steps.push_front(Step::Walk { next, to });
                }
                let shape = self.part_of(element, end);
                Some(self.cut(end, shape, Some(element)))
            }
            Step::Contour(index) => {
                let element = *self.contour.elements.get(index)?;
                self.steps.push_front(Step::Contour(index + 1));
                let shape = match element.shape {
                    Shape::Rapid => Shape::Line,
                    shape => shape,
                };
                let end = self.words.allowance.shift(element.end);
                Some(self.cut(end, shape, Some(index)))
            }
        }
    }

    /// From piece `next` to the end of its element, or to `to` where that is before: the end, the element, and the piece
    /// that the walk goes on with.
    fn until_joint(&self, next: usize, to: Place) -> Option<(Point, usize, Option<usize>)> {
        let element = self.profile.pieces.get(next)?.element;
        let pieces = self.profile.pieces.iter().enumerate();
        let (last, piece) = pieces
            .take(to.piece + 1)
            .skip(next)
            .take_while(|(_, piece)| piece.element == element)
            .last()?;
        let (end, after) = if last == to.piece {
            (to.at, None)
        } else {
            (piece.to, Some(last + 1))
        };
        Some((self.profile.frame.leave(end), element, after))
    }

    /// The shape of a part of an element that ends at `end` and begins where the tool is.
    fn part_of(&self, element: usize, end: Point) -> Shape {
        let from = match element.checked_sub(1) {
            Some(before) => self.contour.elements[before].end,
            None => self.contour.start,
        };
        let Shape::Arc { i, k, clockwise } = self.contour.elements[element].shape else {
            return Shape::Line;
        };
        // Between two places this near, rounding could turn an arc into nearly a whole circle.
        let near = (end.x - self.given.x).abs() + (end.z - self.given.z).abs();
        if near <= Length::from_nm(4) {
            return Shape::Line;
        }
        let from = self.left.shift(from);
        Shape::Arc {
            i: from.x + i - self.given.x,
            k: from.z + k - self.given.z,
            clockwise,
        }
    }

    fn cut(&self, end: Point, shape: Shape, of: Option<usize>) -> Cut {
        let element = of.and_then(|of| self.contour.elements.get(of));
        let span = element.map_or(self.words.span, |element| element.span);
        Cut {
            element: Element { end, shape, span },
            of,
        }
    }

    /// Decides on what comes next; false at the end.
    fn decide(&mut self) -> bool {
        self.stage = match self.stage {
            Stage::Strokes => {
                if self.stroke() {
                    Stage::Strokes
                } else {
                    self.approach_contour();
                    Stage::Contour
                }
            }
            Stage::Contour => {
                self.home();
                Stage::Home
            }
            Stage::Home | Stage::Done => Stage::Done,
        };
        self.stage != Stage::Done
    }
}

impl Iterator for Rough<'_> {
    type Item = Cut;

    fn next(&mut self) -> Option<Cut> {
        loop {
            while let Some(step) = self.steps.pop_front() {
                let Some(cut) = self.take(step) else { continue };
                if cut.element.end != self.given {
                    self.given = cut.element.end;
                    return Some(cut);
                }
            }
            if !self.decide() {
                return None;
            }
        }
    }
}

/// The axes, X and Z, in which an allowance moves the contour into the part.
fn into_the_part(profile: &Profile, allowance: Allowance) -> (bool, bool) {
    let frame = profile.frame;
    let (x, z) = (allowance.x.radius().nm(), allowance.z.nm());
    match frame.along {
        Along::Z => (x * frame.up < 0, z * frame.forward > 0),
        Along::X => (x * frame.forward > 0, z * frame.up < 0),
    }
}
