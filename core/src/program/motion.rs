//! Straight and circular motion: axis words to a target, G00 to G03 and G53.

use super::arc::{self, centre_by_radius, end_error};
use super::state::{Motion, State, needs_words};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{ArcCall, Call, CallKind, Position};
use crate::text::{AXES, Block, Letters, PLANE_AXES, Plan, Word, g_arg};
use crate::units::{Angle, Axis, Length};

/// How a calculated move gets to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Straight, as fast as the axes allow.
    Rapid,
    /// Straight, at the feed in force.
    Line,
    /// On a circle in X–Z, at the feed in force.
    Arc {
        /// Centre minus start, on the radius.
        i: Length,
        /// Centre minus start, along Z.
        k: Length,
        /// G02.
        clockwise: bool,
    },
}

/// Words of an arc in addition to the end point.
const CENTRE: Letters = Letters::of(b"IK");

impl State<'_> {
    /// G00 to G03, written or modal; `used` are words of the block that something else has taken.
    #[inline]
    pub(super) fn travel(
        &mut self,
        block: &Block,
        word: Option<Word>,
        used: Letters,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let clockwise = match self.motion {
            Motion::Rapid | Motion::Line => {
                block.only(AXES.and(used))?;
                if !block.has_any(AXES) {
                    return Ok(());
                }
                self.stroked = None;
                let span = word.map_or(block.lead(), |word| word.span);
                let to = self.modal.target(block, self.modal.origin)?;
                let kind = if self.motion == Motion::Rapid {
                    CallKind::Rapid(to)
                } else {
                    CallKind::Line(
                        to,
                        self.modal.feed(span, 1, &[self.modal.position.x, to.x])?,
                    )
                };
                self.modal.position = to;
                plan.motion(span, kind);
                return Ok(());
            }
            Motion::Clockwise => true,
            Motion::CounterClockwise => false,
            Motion::Turning(cycle) => {
                let span = word.map_or(block.lead(), |word| word.span);
                return self.turning.read(cycle, &self.modal, block, span, plan);
            }
            Motion::Stroke | Motion::VariableStroke => {
                let span = word.map_or(block.lead(), |word| word.span);
                self.refuse_surface(span)?;
                let (modal, before) = (&self.modal, self.stroked.as_ref());
                let stroked = if self.motion == Motion::Stroke {
                    self.thread.read_stroke(modal, block, span, before, plan)?
                } else if before.is_some() && block.has_any(PLANE_AXES) {
                    return Err(Alarm::new(Code::StrokeAfterStroke, span));
                } else {
                    self.thread.read_variable(modal, block, span, plan)?
                };
                if let Some(stroked) = stroked {
                    self.modal.position = stroked.end();
                    self.stroked = Some(stroked);
                }
                return Ok(());
            }
            Motion::Thread => {
                let span = word.map_or(block.lead(), |word| word.span);
                self.refuse_surface(span)?;
                return self.thread.read_single(&self.modal, block, span, plan);
            }
        };
        let shape = CENTRE.and(Letters::of(b"R"));
        block.only(PLANE_AXES.and(shape).and(used))?;
        if !block.has_any(PLANE_AXES.and(shape)) {
            return Ok(());
        }
        self.stroked = None;
        let span = word.map_or(block.lead(), |word| word.span);
        self.arc(block, span, clockwise, plan)
    }

    fn arc(
        &mut self,
        block: &Block,
        span: Span,
        clockwise: bool,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let named = |code: Code, arg: Arg| {
            let name = g_arg(self.motion.code());
            Alarm::new(code, span).with([name, arg])
        };
        if self.modal.plane != 18 {
            return Err(named(Code::ArcPlane, g_arg(i64::from(self.modal.plane))));
        }
        let end = self.modal.target(block, self.modal.origin)?;
        let way = arc::Way {
            x: end.x - self.modal.position.x,
            z: end.z - self.modal.position.z,
        };
        let centre = match block.find(b'R') {
            Some(radius) => {
                if let Some(word) = block.leftmost(block.letters().common(CENTRE)) {
                    return Err(word.alarm(Code::ArcTwoCentres));
                }
                let value = self.modal.scale.length(&radius)?;
                if value == Length::ZERO {
                    return Err(radius.alarm(Code::ArcWithoutRadius));
                }
                if way.is_zero() {
                    return Err(radius.alarm(Code::FullCircleByRadius));
                }
                let large = value < Length::ZERO;
                centre_by_radius(way, value.abs(), clockwise, large).map_err(|least| {
                    let args = [Arg::Length(least), Arg::None, Arg::None, Arg::None];
                    radius.alarm(Code::ArcRadiusTooSmall).with(args)
                })?
            }
            None => {
                let (i, k) = (block.find(b'I'), block.find(b'K'));
                if i.is_none() && k.is_none() {
                    return Err(named(Code::ArcCentreMissing, Arg::None));
                }
                let length = |word: &Option<Word>| match word {
                    Some(word) => self.modal.scale.length(word),
                    None => Ok(Length::ZERO),
                };
                let centre = arc::Way {
                    x: length(&i)?,
                    z: length(&k)?,
                };
                let word = i.or(k);
                let blame = |code: Code| match &word {
                    Some(word) => word.alarm(code),
                    None => Alarm::new(code, span),
                };
                if centre.is_zero() {
                    return Err(blame(Code::ArcWithoutRadius));
                }
                if let Some(error) = end_error(way, centre) {
                    let args = [Arg::Length(error), Arg::None, Arg::None, Arg::None];
                    return Err(blame(Code::ArcEndOffCircle).with(args));
                }
                centre
            }
        };
        let call = ArcCall {
            end,
            i: centre.x,
            k: centre.z,
            clockwise,
            feed: self.modal.feed(
                span,
                self.motion.code(),
                &self.reach(end, centre, clockwise),
            )?,
        };
        self.modal.position = end;
        plan.motion(span, CallKind::Arc(call));
        Ok(())
    }

    /// Where an arc from the present position is at its ends, and nearest to the spindle's axis.
    fn reach(&self, end: Position, centre: arc::Way, clockwise: bool) -> [Length; 3] {
        let from = self.modal.position;
        let way = arc::Way {
            x: end.x - from.x,
            z: end.z - from.z,
        };
        let axis = self.modal.origin.x;
        let nearest = if self.modal.in_surface {
            arc::nearest_to(axis, from.x, way, centre, clockwise)
        } else {
            None
        };
        [from.x, end.x, nearest.unwrap_or(end.x)]
    }

    /// A move that was calculated, with what is in force.
    pub(super) fn trace(&mut self, span: Span, to: Position, way: Way) -> Result<Call, Alarm> {
        let kind = match way {
            Way::Rapid => CallKind::Rapid(to),
            Way::Line => {
                let places = [self.modal.position.x, to.x];
                CallKind::Line(to, self.modal.feed(span, 1, &places)?)
            }
            Way::Arc { i, k, clockwise } => CallKind::Arc(ArcCall {
                end: to,
                i,
                k,
                clockwise,
                feed: self.modal.feed(
                    span,
                    if clockwise { 2 } else { 3 },
                    &self.reach(to, arc::Way { x: i, z: k }, clockwise),
                )?,
            }),
        };
        self.modal.position = to;
        self.stroked = None;
        Ok(Call {
            span,
            origin: self.modal.origin,
            kind,
        })
    }

    /// G28, and G30 P2 to P4: rapid to the point that the words name, and from there to the reference point (1240 to 1243),
    /// each with the named axes alone. A turning cycle, G92, G32 or G34 in force ends.
    pub(super) fn reference_point(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let number = match (word.value.mantissa(), block.find(b'P')) {
            (28, _) => 1,
            (_, None) => 2,
            (_, Some(point)) => match point.count(99)? {
                number @ 2..=4 => number,
                _ => return Err(point.out_of_range(Arg::Int(2), Arg::Int(4))),
            },
        };
        block.only(if number == 1 {
            AXES
        } else {
            AXES.and(Letters::of(b"P"))
        })?;
        if !block.has_any(AXES) {
            return Err(needs_words(word));
        }
        let between = self.modal.target(block, self.modal.origin)?;
        let params = self.modal.params;
        let coordinate = |axis| match number {
            1 => params.reference_point(axis),
            2 => params.second_reference_point(axis),
            3 => params.third_reference_point(axis),
            _ => params.fourth_reference_point(axis),
        };
        let mut end = between;
        if block.has_any(Letters::of(b"XU")) {
            end.x = Length::from_nm(coordinate(Axis::X));
        }
        if block.has_any(Letters::of(b"ZW")) {
            end.z = Length::from_nm(coordinate(Axis::Z));
        }
        if block.has_any(Letters::of(b"CH")) {
            end.c = Angle::from_udeg(coordinate(Axis::C));
        }
        if self.motion.cuts_thread() || matches!(self.motion, Motion::Turning(_)) {
            self.motion = Motion::Rapid;
        }
        self.modal.position = end;
        plan.straight(word.span, between, None);
        plan.straight(word.span, end, None);
        Ok(())
    }

    /// G53: rapid to machine coordinates, whatever the modal motion.
    pub(super) fn machine_coordinates(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let increments = Letters::of(b"UWH");
        if let Some(word) = block.leftmost(block.letters().common(increments)) {
            return Err(word.alarm(Code::IncrementInMachineCoordinates));
        }
        block.only(AXES)?;
        if !block.has_any(AXES) {
            return Err(needs_words(word));
        }
        let to = self.modal.target(block, Position::ZERO)?;
        self.modal.position = to;
        plan.motion(word.span, CallKind::Rapid(to));
        Ok(())
    }
}
