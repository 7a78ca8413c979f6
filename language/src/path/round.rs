//! The round nose on the way of the events.

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::call::{Aux, Call, CallKind, Position};
use leadscrew_core::program::Event;

use super::{call, element, end_of, point};
use crate::nose::{Entry, Filter, Input, Motion, Nose, Output, Post, Side};

/// The filter while a compensation is in force, and a little longer.
#[derive(Debug, Default)]
pub(super) struct Round {
    filter: Option<Filter<Event>>,
    /// The last motion that came out.
    last: Option<Call>,
}

impl Round {
    /// True where nothing is held.
    pub fn is_free(&self) -> bool {
        self.filter.is_none()
    }

    /// The next event; its motion begins at `from`.
    ///
    /// # Errors
    /// What the compensation refuses, before the motion that the alarm names has come out.
    pub fn push(
        &mut self,
        event: Event,
        from: Position,
        side: Side,
        nose: Nose,
        out: &mut VecDeque<Event>,
    ) -> Result<(), Alarm> {
        if self.filter.is_none() && (side == Side::None || end_of(&event).is_none()) {
            out.push_back(event);
            return Ok(());
        }
        let filter = self
            .filter
            .get_or_insert_with(|| Filter::new(point(from), Entry::A, Post::Rear));
        let input = match &event {
            Event::Call(call) => match (element(call), &call.kind) {
                (Some(element), _) => {
                    let turns = end_of(&event).is_some_and(|end| end.c != from.c);
                    if side != Side::None && turns {
                        return Err(Alarm::new(Code::NoseInCycle, call.span));
                    }
                    let motion = Motion {
                        element,
                        side,
                        nose,
                    };
                    Input::Motion(motion, event)
                }
                (None, CallKind::Aux(Aux::T(_))) => Input::Break {
                    at: point(from),
                    payload: event,
                },
                (None, CallKind::Dwell(_) | CallKind::Spindle(_) | CallKind::Aux(_)) => {
                    Input::Still(event)
                }
                (None, CallKind::End(_) | CallKind::Over | CallKind::LineOver) => {
                    self.finish(out)?;
                    out.push_back(event);
                    return Ok(());
                }
                (None, _) if side != Side::None => {
                    return Err(Alarm::new(Code::NoseInCycle, call.span));
                }
                (None, _) => {
                    self.finish(out)?;
                    out.push_back(event);
                    return Ok(());
                }
            },
            Event::Warning(_) => Input::Still(event),
        };
        filter.push(input)?;
        self.pull(out);
        Ok(())
    }

    /// The path is over: the last motion ends perpendicular.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn finish(&mut self, out: &mut VecDeque<Event>) -> Result<(), Alarm> {
        if let Some(filter) = &mut self.filter {
            filter.finish()?;
            self.pull(out);
            self.filter = None;
        }
        Ok(())
    }

    /// What may come out, as calls. The filter goes where it holds nothing more.
    fn pull(&mut self, out: &mut VecDeque<Event>) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        while let Some(output) = filter.pull() {
            match output {
                Output::Motion(element, Event::Call(like)) => {
                    let moved = call(&element, &like);
                    self.last = Some(like);
                    out.push_back(Event::Call(moved));
                }
                Output::Corner(element) => {
                    if let Some(like) = &self.last {
                        out.push_back(Event::Call(call(&element, like)));
                    }
                }
                // Nothing is left of a motion.
                Output::Still(event) if end_of(&event).is_some() => {
                    if let Event::Call(like) = event {
                        self.last = Some(like);
                    }
                }
                Output::Motion(_, event) | Output::Still(event) | Output::Break(event) => {
                    out.push_back(event);
                }
            }
        }
        if filter.is_empty() {
            self.filter = None;
        }
    }
}
