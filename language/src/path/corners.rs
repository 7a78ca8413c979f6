//! Chamfers and roundings on the way of the events: a motion with a corner waits for the next motion.

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::call::{Call, CallKind};
use leadscrew_core::program::Event;

use super::{How, call, element, point};
use crate::corner::{Corner, Toward, insert};
use crate::plane::{Point, Shape};

/// Events that may stand between the two motions of a corner.
const BETWEEN: usize = 8;

/// What waits.
#[derive(Debug, Default)]
pub(super) struct Corners {
    waiting: Option<Waiting>,
}

/// The corner that a block asks for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub corner: Corner,
    /// Where the next motion has to go.
    pub toward: Option<Toward>,
    /// Its word.
    pub span: Span,
}

/// A motion whose end is a corner.
#[derive(Debug)]
struct Waiting {
    first: Call,
    how: How,
    corner: Asked,
    between: Vec<Event>,
}

/// Events, each with where its motion begins.
type Ready = VecDeque<(Event, How)>;

impl Corners {
    /// True where nothing waits.
    pub fn is_free(&self) -> bool {
        self.waiting.is_none()
    }

    /// The next event. Its motion may have a corner at its end.
    ///
    /// # Errors
    /// 0051, 0052 and 0055 at the word of the corner.
    pub fn push(
        &mut self,
        event: Event,
        how: How,
        corner: Option<Asked>,
        ready: &mut Ready,
    ) -> Result<(), Alarm> {
        let motion = match &event {
            Event::Call(call) => element(call).map(|element| (*call, element)),
            Event::Warning(_) => None,
        };
        let Some((next, next_element)) = motion else {
            return self.other(event, how, ready);
        };
        let (mut next, mut how) = (next, how);
        if let Some(waiting) = self.waiting.take() {
            let Some(first) = element(&waiting.first) else {
                return Ok(());
            };
            let start = point(waiting.how.from);
            let corner = insert(
                start,
                &first,
                Some(&next_element),
                waiting.corner.corner,
                waiting.corner.toward,
                waiting.corner.span,
            )?;
            let mut at = waiting.how;
            let mut put = |call: Call, ready: &mut Ready| {
                ready.push_back((Event::Call(call), at));
                if let Some(end) = super::end_of(&Event::Call(call)) {
                    at.from = end;
                }
            };
            let is_way = |from: Point, to: Point, shape: Shape| {
                from != to || matches!(shape, Shape::Arc { .. })
            };
            if is_way(start, corner.first.end, corner.first.shape) {
                put(call(&corner.first, &waiting.first), ready);
            }
            if let Some(between) = &corner.between {
                put(call(between, &waiting.first), ready);
            }
            how.from = at.from;
            let others = waiting.between.into_iter();
            ready.extend(others.map(|event| (event, at)));
            next = call(&corner.second, &next);
        }
        match corner {
            Some(corner) => {
                self.waiting = Some(Waiting {
                    first: next,
                    how,
                    corner,
                    between: Vec::new(),
                });
            }
            None => ready.push_back((Event::Call(next), how)),
        }
        Ok(())
    }

    /// An event that is no motion of the plane.
    fn other(&mut self, event: Event, how: How, ready: &mut Ready) -> Result<(), Alarm> {
        let Some(waiting) = &mut self.waiting else {
            ready.push_back((event, how));
            return Ok(());
        };
        let may_wait = match &event {
            Event::Warning(_) => true,
            Event::Call(call) => matches!(
                call.kind,
                CallKind::Dwell(_)
                    | CallKind::Spindle(_)
                    | CallKind::Aux(_)
                    | CallKind::ExactStop(_)
            ),
        };
        if !may_wait || waiting.between.len() == BETWEEN {
            return Err(Alarm::new(Code::CornerNextMissing, waiting.corner.span));
        }
        waiting.between.push(event);
        Ok(())
    }

    /// No motion follows.
    ///
    /// # Errors
    /// 0051 where one was expected.
    pub fn finish(&mut self) -> Result<(), Alarm> {
        match self.waiting.take() {
            Some(waiting) => Err(Alarm::new(Code::CornerNextMissing, waiting.corner.span)),
            None => Ok(()),
        }
    }
}
