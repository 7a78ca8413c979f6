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
    /// The compensation has ended without a move: the tool stands beside the programmed path.
    is_off: bool,
}

impl Round {
    /// True where nothing is held, and the tool is on the programmed path.
    pub fn is_free(&self) -> bool {
        self.filter.is_none() && !self.is_off
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
            return self.pass(event, out);
        }
        let filter = self
            .filter
            .get_or_insert_with(|| Filter::new(point(from), Entry::A, Post::Rear));
        let input = match &event {
            Event::Call(call) => match (element(call), &call.kind) {
                (Some(element), _) => {
                    self.is_off = false;
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
                (None, CallKind::Aux(Aux::T(_))) => {
                    self.is_off = true;
                    Input::Break {
                        at: point(from),
                        payload: event,
                    }
                }
                (
                    None,
                    CallKind::Dwell(_)
                    | CallKind::Spindle(_)
                    | CallKind::Aux(_)
                    | CallKind::ExactStop(_),
                ) => Input::Still(event),
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
                    return self.pass(event, out);
                }
            },
            Event::Warning(_) => Input::Still(event),
        };
        filter.push(input)?;
        self.pull(out);
        Ok(())
    }

    /// Hands on what is not compensated.
    ///
    /// # Errors
    /// 4602 for a call that begins where the tool stands, and not at a place of its own, beside the path.
    fn pass(&mut self, event: Event, out: &mut VecDeque<Event>) -> Result<(), Alarm> {
        if let Event::Call(call) = &event {
            let is_stroke = match &call.kind {
                CallKind::Tap(_) => true,
                CallKind::Thread(thread) => thread.cycle.is_stroke(),
                _ => false,
            };
            if is_stroke && self.is_off {
                return Err(Alarm::new(Code::NoseInCycle, call.span));
            }
            let comes_back = matches!(call.kind, CallKind::Thread(_) | CallKind::Groove(_));
            self.is_off &= end_of(&event).is_none() && !comes_back;
        }
        out.push_back(event);
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
            self.is_off = true;
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
