//! G70: the contour as it is written, then back to the start.

use leadscrew_core::alarm::Span;

use super::{Contour, Cut};
use crate::plane::{Element, Point, Shape};

/// The moves of G70.
#[derive(Clone, Debug)]
pub struct Finish<'a> {
    contour: &'a Contour,
    span: Span,
    at: Point,
    next: usize,
}

impl<'a> Finish<'a> {
    pub(super) const fn new(contour: &'a Contour, span: Span) -> Self {
        Self {
            contour,
            span,
            at: contour.start,
            next: 0,
        }
    }
}

impl Iterator for Finish<'_> {
    type Item = Cut;

    fn next(&mut self) -> Option<Cut> {
        let elements = &self.contour.elements;
        while self.next <= elements.len() {
            let of = self.next;
            self.next += 1;
            let element = elements.get(of).copied().unwrap_or(Element {
                end: self.contour.start,
                shape: Shape::Rapid,
                span: self.span,
            });
            let circle = matches!(element.shape, Shape::Arc { .. });
            if element.end != self.at || circle {
                self.at = element.end;
                return Some(Cut {
                    element,
                    of: (of < elements.len()).then_some(of),
                });
            }
        }
        None
    }
}
