//! G73: the contour several times, each time nearer to where it is written.

use leadscrew_core::alarm::{Alarm, At, Code, Span};
use leadscrew_core::units::Length;

use super::{Allowance, Contour, Cut};
use crate::plane::{Element, Point, Shape};

/// The words of G73.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repeats {
    /// i: how far the first copy is from the last in X; a signed radius.
    pub x: Length,
    /// k: the same in Z.
    pub z: Length,
    /// d: how many copies.
    pub passes: At<i64>,
    /// Δu, Δw.
    pub allowance: Allowance,
    /// The word that the moves between copies come from.
    pub span: Span,
}

/// The moves of G73.
#[derive(Clone, Debug)]
pub struct Pattern<'a> {
    contour: &'a Contour,
    words: Repeats,
    at: Point,
    /// From 0.
    copy: i64,
    /// The next element; 0 is the way to the copy's own start.
    step: usize,
}

impl<'a> Pattern<'a> {
    pub(super) fn new(contour: &'a Contour, words: &Repeats) -> Result<Self, Alarm> {
        if words.passes.value < 1 {
            return Err(Alarm::new(Code::ContourDepth, words.passes.span).word(b'R'));
        }
        Ok(Self {
            contour,
            words: *words,
            at: contour.start,
            copy: 0,
            step: 0,
        })
    }

    /// `point` of the contour in this copy; after the last copy, as it is written.
    fn shift(&self, point: Point) -> Point {
        let steps = self.words.passes.value - 1;
        let left = steps - self.copy;
        if left < 0 {
            return point;
        }
        let share = |whole: Length| Length::from_nm(share(whole.nm(), left, steps));
        let moved = self.words.allowance.shift(point);
        Point {
            x: moved.x + share(self.words.x),
            z: moved.z + share(self.words.z),
        }
    }
}

/// `whole · left / steps`, halves away from zero; 0 where there is one pass.
fn share(whole: i64, left: i64, steps: i64) -> i64 {
    let (product, steps) = (i128::from(whole) * i128::from(left), i128::from(steps));
    if steps == 0 {
        return 0;
    }
    let nearest = (2 * product.abs() + steps) / (2 * steps);
    i64::try_from(nearest * product.signum()).unwrap_or(whole)
}

impl Iterator for Pattern<'_> {
    type Item = Cut;

    fn next(&mut self) -> Option<Cut> {
        while self.copy <= self.words.passes.value {
            let step = self.step;
            let last = self.copy == self.words.passes.value;
            let (element, of) = match step.checked_sub(1) {
                None => (
                    Element {
                        end: self.contour.start,
                        shape: Shape::Rapid,
                        span: self.words.span,
                    },
                    None,
                ),
                Some(of) => (self.contour.elements[of], Some(of)),
            };
            let end = self.shift(element.end);
            self.step += 1;
            if last || self.step > self.contour.elements.len() {
                self.step = 0;
                self.copy += 1;
            }
            if end != self.at || matches!(element.shape, Shape::Arc { .. }) {
                self.at = end;
                return Some(Cut {
                    element: Element { end, ..element },
                    of,
                });
            }
        }
        None
    }
}
