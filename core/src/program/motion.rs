//! Straight and circular motion: axis words to a target, G00 to G03 and G53.

use super::arc::{Way, centre_by_radius, end_error};
use super::block::{Block, Letters, Word, g_arg};
use super::call::{ArcCall, CallKind, Position};
use super::plan::Plan;
use super::state::{AXES, Motion, PLANE_AXES, State, needs_words};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::units::{Angle, Diameter, Length};

/// Words of an arc in addition to the end point.
const CENTRE: Letters = Letters::of(b"IK");

impl State<'_> {
    /// Where the axis words send the machine, with the work zero at `origin`.
    #[inline]
    pub(super) fn target(&self, block: &Block, origin: Position) -> Result<Position, Alarm> {
        let mut to = self.position;
        if let Some(word) = block.find(b'X') {
            to.x = within(origin.x + self.scale.radius(&word)?, &word)?;
        } else if let Some(word) = block.find(b'U') {
            to.x = within(to.x + self.scale.radius(&word)?, &word)?;
        }
        if let Some(word) = block.find(b'Z') {
            to.z = within(origin.z + self.scale.length(&word)?, &word)?;
        } else if let Some(word) = block.find(b'W') {
            to.z = within(to.z + self.scale.length(&word)?, &word)?;
        }
        if block.has_any(Letters::of(b"CH")) {
            if let Some(word) = block.find(b'C') {
                to.c = within_turns(origin.c + self.scale.angle(&word)?, &word)?;
            } else if let Some(word) = block.find(b'H') {
                to.c = within_turns(to.c + self.scale.angle(&word)?, &word)?;
            }
        }
        Ok(to)
    }

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
                self.only(block, AXES.and(used))?;
                if !block.has_any(AXES) {
                    return Ok(());
                }
                let span = word.map_or(block.lead(), |word| word.span);
                let to = self.target(block, self.origin)?;
                let kind = if self.motion == Motion::Rapid {
                    CallKind::Rapid(to)
                } else {
                    CallKind::Line(to, self.feed(span, 1)?)
                };
                self.position = to;
                plan.motion(span, kind);
                return Ok(());
            }
            Motion::Clockwise => true,
            Motion::CounterClockwise => false,
        };
        let shape = CENTRE.and(Letters::of(b"R"));
        self.only(block, PLANE_AXES.and(shape).and(used))?;
        if !block.has_any(PLANE_AXES.and(shape)) {
            return Ok(());
        }
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
        if self.plane != 18 {
            return Err(named(Code::ArcPlane, g_arg(i64::from(self.plane))));
        }
        let end = self.target(block, self.origin)?;
        let way = Way {
            x: end.x - self.position.x,
            z: end.z - self.position.z,
        };
        let centre = match block.find(b'R') {
            Some(radius) => {
                if let Some(word) = block.leftmost(block.letters().common(CENTRE)) {
                    return Err(word.alarm(Code::ArcTwoCentres));
                }
                let value = self.scale.length(&radius)?;
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
                    Some(word) => self.scale.length(word),
                    None => Ok(Length::ZERO),
                };
                let centre = Way {
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
            feed: self.feed(span, self.motion.code())?,
        };
        self.position = end;
        plan.motion(span, CallKind::Arc(call));
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
        self.only(block, AXES)?;
        if !block.has_any(AXES) {
            return Err(needs_words(word));
        }
        let to = self.target(block, Position::ZERO)?;
        self.position = to;
        plan.motion(word.span, CallKind::Rapid(to));
        Ok(())
    }

    /// The end point of a cycle on X and Z and the words to blame for it: nowhere where they are missing.
    pub(super) fn cycle_end(&self, block: &Block) -> Result<(Position, Span, Span), Alarm> {
        let end = self.target(block, self.origin)?;
        let place = |absolute, increment| {
            block
                .find(absolute)
                .or_else(|| block.find(increment))
                .map_or(Span::default(), |word| word.span)
        };
        Ok((end, place(b'X', b'U'), place(b'Z', b'W')))
    }
}

/// The same for a rotary axis.
fn within_turns(angle: Angle, word: &Word) -> Result<Angle, Alarm> {
    let limit = Length::INPUT_LIMIT.nm();
    if angle.udeg().unsigned_abs() <= limit.unsigned_abs() {
        return Ok(angle);
    }
    let limit = Arg::Angle(Angle::from_udeg(limit));
    Err(word.alarm(Code::PositionOutOfRange).with([limit]))
}

/// A coordinate that the machine arithmetic can carry.
#[inline]
fn within(coordinate: Length, word: &Word) -> Result<Length, Alarm> {
    if coordinate.is_in_range() {
        return Ok(coordinate);
    }
    Err(out_of_range(word))
}

/// The alarm of a word that leads beyond what the machine arithmetic can carry.
#[cold]
pub(super) fn out_of_range(word: &Word) -> Alarm {
    let limit = if matches!(word.letter, b'X' | b'U') {
        Arg::Diameter(Diameter::of_radius(Length::INPUT_LIMIT))
    } else {
        Arg::Length(Length::INPUT_LIMIT)
    };
    let args = [limit, Arg::None, Arg::None, Arg::None];
    word.alarm(Code::PositionOutOfRange).with(args)
}
