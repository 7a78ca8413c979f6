//! The words of G84 and G88 ([G84/G88 sheet]): kept from hole to hole, every one resolved or its
//! parameter taken. When rigid mode begins and ends is `tap_mode`'s.

use core::num::NonZeroU8;

use super::mode::{ORIENT, Tapping, locked, rigid_code};
use super::speed::{
    Turning, extraction, extraction_override, infeed_speed, limited, note_j, refuse_in_ordinary,
    tap_lead,
};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{
    CallKind, Hand, HandChoice, Plane, Position, TapAxis, TapCall, TapCycle, TapForm, TapMode,
    TapNotes, TapPeck, TapRepeat, TapSpindle,
};
use crate::cycle::check::blame;
use crate::text::{
    AXES, Block, Known, Letters, MGroup, Modal, Plan, Range, Word, g_arg, m_code, out_of_range,
};
use crate::units::{Angle, CentiRpm, Feed, FeedPerTurn, Length, Millis, Rpm};

/// Words of a tapping block in addition to the axes.
const WORDS: Letters = Letters::of(b"RQPKDJE");

/// Where the bottom is, as it was written.
#[derive(Clone, Copy, Debug)]
enum Bottom {
    /// A work coordinate.
    Work(Length),
    /// From the R plane.
    FromR(Length),
}

/// F, as it was written.
#[derive(Clone, Copy, Debug)]
pub(super) enum TapFeed {
    PerMinute(Feed),
    PerTurn(FeedPerTurn),
}

/// What a cycle keeps from hole to hole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    cycle: TapCycle,
    axis: TapAxis,
    bottom: Option<At<Bottom>>,
    /// R: from the initial level to the R plane, signed.
    rise: At<Length>,
    /// Q, zero for none.
    infeed: At<Length>,
    /// D.
    back: Option<At<Length>>,
    dwell: Millis,
    pub(super) feed: Option<At<TapFeed>>,
    /// J.
    extract: Option<u32>,
    /// E.
    pub(super) spindle: Option<TapSpindle>,
    /// M.
    clamp: Option<u16>,
    /// The initial level, once a hole has ended at R and the tool does not tell it any more.
    initial: Option<Length>,
}

impl Kept {
    /// Its G code.
    pub(super) const fn code(&self) -> u8 {
        match self.cycle {
            TapCycle::G84 => 84,
            TapCycle::G88 => 88,
        }
    }

    const fn new(cycle: TapCycle, axis: TapAxis) -> Self {
        const NOWHERE: Span = Span {
            line: 0,
            column: 0,
            end: 0,
        };
        Self {
            cycle,
            axis,
            bottom: None,
            rise: At::new(Length::ZERO, NOWHERE),
            infeed: At::new(Length::ZERO, NOWHERE),
            back: None,
            dwell: Millis::new(0),
            feed: None,
            extract: None,
            spindle: None,
            clamp: None,
            initial: None,
        }
    }

    /// Its G code, for messages.
    pub(super) fn name(&self) -> Arg {
        match self.cycle {
            TapCycle::G84 => g_arg(84),
            TapCycle::G88 => g_arg(88),
        }
    }
}

/// Letters of an axis: absolute and increment.
const fn letters_of(axis: TapAxis) -> (u8, u8) {
    match axis {
        TapAxis::X => (b'X', b'U'),
        TapAxis::Z => (b'Z', b'W'),
    }
}

impl Tapping {
    /// A block with G84 or G88 (`word`), or one while such a cycle is in force.
    pub(crate) fn tap(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        word: Option<&Word>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        block.only(AXES.and(WORDS))?;
        let span = word.map_or(block.lead(), |word| word.span);
        let Some(mut kept) = self.cycle_of(modal, word)? else {
            return Ok(());
        };
        if let Some((before, since)) = &self.locked
            && let Some(word) = word
            && (before.cycle, before.axis) != (kept.cycle, kept.axis)
        {
            return Err(locked(word, *since));
        }
        read_kept(modal, block, &mut kept)?;
        let turning = self.turning(modal, block, word, span, &kept, plan)?;
        match turning.mode {
            TapMode::Floating => refuse_in_ordinary(modal, block, plan)?,
            TapMode::Rigid => note_j(modal, block, &turning, plan),
        }
        let (absolute, increment) = letters_of(kept.axis);
        let places = AXES.without(Letters::of(&[absolute, increment]));
        let repeat = match block.find(b'K') {
            Some(k) => Some((repeats(&k)?, k)),
            None => None,
        };
        if word.is_none() && !block.has_any(places) {
            self.cycle = Some(kept);
            return match repeat {
                Some((_, k)) => Err(k.alarm(Code::WordWithoutUse)),
                None => Ok(()),
            };
        }
        if modal.taps_end_at_r && self.locked.is_none() {
            kept.initial.get_or_insert(kept.axis.of(modal.position));
        }
        let call = self.hole(modal, block, &kept, &turning, span, repeat)?;
        let (extract, asked) = extraction(modal, &call);
        let call = TapCall { extract, ..call };
        let says_speed = word.is_some() || block.has_any(Letters::of(b"SJ"));
        if says_speed && asked > extract {
            plan.warn(limited(modal, block, span, asked));
        }
        modal.position = match call.repeat {
            TapRepeat::Stay => call.axis.with(call.hole, call.bottom.value),
            TapRepeat::Holes(holes) => nth(&call, holes),
        };
        self.locked = (call.repeat == TapRepeat::Stay).then_some((call, span));
        self.cycle = Some(kept);
        plan.motion(span, CallKind::Tap(call));
        Ok(())
    }

    /// What is kept of the cycle so far; nothing where another cycle or axis begins.
    fn cycle_of(&self, modal: &Modal<'_>, word: Option<&Word>) -> Result<Option<Kept>, Alarm> {
        let Some(word) = word else {
            return Ok(self.cycle);
        };
        let cycle = if word.value.mantissa() == 84 {
            TapCycle::G84
        } else {
            TapCycle::G88
        };
        let fixed = modal.params.tap_axis_fixed();
        let axis = match (cycle, fixed, modal.plane) {
            (TapCycle::G84, true, _) | (TapCycle::G84, _, 18) | (TapCycle::G88, false, 19) => {
                TapAxis::Z
            }
            (TapCycle::G88, true, _) | (TapCycle::G88, _, 18) | (TapCycle::G84, false, 17) => {
                TapAxis::X
            }
            _ => {
                let name = g_arg(word.value.mantissa());
                let plane = g_arg(i64::from(modal.plane));
                let args = [name, plane, Arg::None, Arg::None];
                return Err(word.alarm(Code::TapAxisMissing).with(args));
            }
        };
        let same = |kept: &Kept| kept.cycle == cycle && kept.axis == axis;
        let kept = self.cycle.filter(same);
        Ok(Some(kept.unwrap_or_else(|| Kept::new(cycle, axis))))
    }

    /// The call of a hole that begins at the initial level. Its extraction is still to come.
    fn new_hole(
        &self,
        modal: &Modal<'_>,
        block: &Block,
        kept: &Kept,
        turning: &Turning,
        span: Span,
        repeat: Option<(TapRepeat, Word)>,
    ) -> Result<TapCall, Alarm> {
        let axis = kept.axis;
        let initial = kept.initial.unwrap_or(axis.of(modal.position));
        let (hole, step) = places(modal, block, axis)?;
        let level = At::new(initial + kept.rise.value, kept.rise.span);
        let call = self.resolve(modal, kept, turning, span, level)?;
        // An end at R would hide that R lies on the wrong side.
        let at_r = modal.taps_end_at_r;
        let inward = (call.bottom.value - level.value).signum();
        if at_r && kept.rise.value.times(inward) < Length::ZERO {
            let (letter, _) = letters_of(axis);
            return Err(blame(Code::TapDepth, span, &call.bottom.span, letter));
        }
        let hole = axis.with(hole, if at_r { level.value } else { initial });
        let call = TapCall {
            start: modal.position,
            hole,
            step,
            repeat: repeat.map_or(TapRepeat::Holes(NonZeroU8::MIN), |(repeat, _)| repeat),
            ..call
        };
        if let TapRepeat::Holes(holes) = call.repeat {
            let last = nth(&call, holes);
            let turned = Length::from_nm(last.c.udeg());
            if !last.x.is_in_range() || !last.z.is_in_range() || !turned.is_in_range() {
                let blame = repeat.map_or(Alarm::new(Code::PositionOutOfRange, span), |(_, k)| {
                    out_of_range(&k)
                });
                return Err(blame);
            }
        }
        Ok(call)
    }

    /// What depends on the kept words and S alone.
    fn resolve(
        &self,
        modal: &Modal<'_>,
        kept: &Kept,
        turning: &Turning,
        span: Span,
        level: At<Length>,
    ) -> Result<TapCall, Alarm> {
        let (letter, _) = letters_of(kept.axis);
        let Some(bottom) = kept.bottom else {
            let args = [kept.name(), Arg::Letter(letter), Arg::None, Arg::None];
            return Err(Alarm::new(Code::TapBottomMissing, span).with(args));
        };
        let coordinate = match bottom.value {
            Bottom::Work(coordinate) => kept.axis.of(modal.origin) + coordinate,
            Bottom::FromR(depth) => level.value + depth,
        };
        let lead = tap_lead(modal, kept, turning, span)?;
        Ok(TapCall {
            cycle: kept.cycle,
            mode: turning.mode,
            axis: kept.axis,
            start: modal.position,
            hole: modal.position,
            step: Position::ZERO,
            level,
            bottom: At::new(coordinate, bottom.span),
            form: form(modal, kept),
            dwell: kept.dwell,
            lead,
            hand: if turning.rpm < Rpm::STOPPED {
                HandChoice::Written(Hand::Left)
            } else if turning.mode == TapMode::Floating {
                HandChoice::Written(Hand::Right)
            } else {
                HandChoice::Signal
            },
            speed: infeed_speed(modal, turning, lead.value),
            extract: CentiRpm::default(),
            spindle: self.spindle_choice(modal, kept.spindle),
            repeat: TapRepeat::Holes(NonZeroU8::MIN),
            clamp: kept.clamp,
            continues: false,
            notes: TapNotes {
                unit: modal.length_unit(),
                plane: Plane::new(modal.plane).unwrap_or_default(),
                extraction: extraction_override(modal, kept.extract, turning),
            },
        })
    }

    /// The call of a new hole, or the call that goes on in the hole a K198 has left the tap in: deeper, and in phase
    /// [D25].
    fn hole(
        &self,
        modal: &Modal<'_>,
        block: &Block,
        kept: &Kept,
        turning: &Turning,
        span: Span,
        repeat: Option<(TapRepeat, Word)>,
    ) -> Result<TapCall, Alarm> {
        let Some((before, since)) = &self.locked else {
            return self.new_hole(modal, block, kept, turning, span, repeat);
        };
        let at = |span: Span, letter: Option<u8>| {
            let line = [
                Arg::Int(i64::from(since.line)),
                Arg::None,
                Arg::None,
                Arg::None,
            ];
            let alarm = Alarm::new(Code::TapLocked, span).with(line);
            match letter {
                Some(letter) => alarm.word(letter),
                None => alarm,
            }
        };
        let (absolute, increment) = letters_of(kept.axis);
        let places = AXES.without(Letters::of(&[absolute, increment]));
        let refused = places.and(Letters::of(b"R"));
        if let Some(word) = block.leftmost(block.letters().common(refused)) {
            return Err(locked(&word, *since));
        }
        let repeat = match repeat {
            None => TapRepeat::Holes(NonZeroU8::MIN),
            Some((repeat @ TapRepeat::Holes(NonZeroU8::MIN), _))
            | Some((repeat @ TapRepeat::Stay, _)) => repeat,
            Some((_, word)) => return Err(locked(&word, *since)),
        };
        let call = self.resolve(modal, kept, turning, span, before.level)?;
        // S makes the hand, and with F the lead under G98.
        let changed: &[u8] = if call.hand != before.hand {
            b"S"
        } else if call.spindle != before.spindle {
            b"E"
        } else if call.lead.value != before.lead.value {
            b"FS"
        } else {
            b""
        };
        if !changed.is_empty() {
            let written = block.leftmost(block.letters().common(Letters::of(changed)));
            return Err(written.map_or(at(span, None), |word| locked(&word, *since)));
        }
        let inward = (before.bottom.value - before.level.value).signum();
        if (call.bottom.value - before.bottom.value).times(inward) <= Length::ZERO {
            let written = block.find(absolute).or_else(|| block.find(increment));
            return Err(match written {
                Some(word) => locked(&word, *since),
                None => at(span, None),
            });
        }
        Ok(TapCall {
            start: modal.position,
            hole: nth(before, NonZeroU8::MIN),
            repeat,
            clamp: before.clamp,
            continues: true,
            ..call
        })
    }
}

/// Hole number `n` of a call, its tap axis where the tool leaves it.
fn nth(call: &TapCall, n: NonZeroU8) -> Position {
    let steps = i64::from(n.get()).saturating_sub(1);
    Position {
        x: call.hole.x + call.step.x.times(steps),
        z: call.hole.z + call.step.z.times(steps),
        c: call.hole.c + Angle::from_udeg(call.step.c.udeg().saturating_mul(steps)),
    }
}

/// K: 1–99, or 198.
fn repeats(word: &Word) -> Result<TapRepeat, Alarm> {
    match word.count(u32::MAX)? {
        198 => Ok(TapRepeat::Stay),
        holes @ 1..=99 => match NonZeroU8::new(holes as u8) {
            Some(holes) => Ok(TapRepeat::Holes(holes)),
            None => Err(word.alarm(Code::TapRepeats)),
        },
        _ => Err(word.alarm(Code::TapRepeats)),
    }
}

/// An M code whose successor is as free as it is.
fn clamp_code(modal: &Modal<'_>, word: &Word) -> Result<u16, Alarm> {
    const LAST: i64 = 9998;
    let code = word.value.mantissa();
    // The spindle would have to be at an angle and in the hole.
    if code == ORIENT && modal.params.orients_by_m19() {
        return Err(word.alarm(Code::MNotAvailable).with([Arg::Int(code)]));
    }
    if code > LAST {
        return Err(word.out_of_range(Arg::Int(0), Arg::Int(LAST)));
    }
    let next = code.saturating_add(1);
    if m_code(next, rigid_code(modal.params)) != Known::Yes(MGroup::Clamp) {
        let args = [Arg::Int(code), Arg::Int(next), Arg::None, Arg::None];
        return Err(word.alarm(Code::TapClampCode).with(args));
    }
    Ok(code as u16)
}

/// The first hole and the way from hole to hole. The tap axis stays at the initial level.
fn places(modal: &Modal<'_>, block: &Block, axis: TapAxis) -> Result<(Position, Position), Alarm> {
    let target = modal.target(block, modal.origin)?;
    let hole = axis.with(target, axis.of(modal.position));
    let written = |letter| block.has_any(Letters::of(&[letter]));
    let mut step = Position::ZERO;
    if written(b'U') {
        step.x = hole.x - modal.position.x;
    }
    if written(b'W') {
        step.z = hole.z - modal.position.z;
    }
    if written(b'H') {
        step.c = hole.c - modal.position.c;
    }
    Ok((hole, axis.with(step, Length::ZERO)))
}

/// By Q and 5200.5; d is D, or the smaller of 5213 and Q.
fn form(modal: &Modal<'_>, kept: &Kept) -> TapForm {
    let infeed = kept.infeed;
    if infeed.value == Length::ZERO {
        return TapForm::Standard;
    }
    let back = kept.back.unwrap_or_else(|| {
        let back = modal.params.tap_peck_return().min(infeed.value);
        At::new(back, Span::default())
    });
    let peck = TapPeck { infeed, back };
    if modal.params.tap_deep_peck() {
        TapForm::Deep(peck)
    } else {
        TapForm::HighSpeed(peck)
    }
}

/// The words that stay.
fn read_kept(modal: &Modal<'_>, block: &Block, kept: &mut Kept) -> Result<(), Alarm> {
    const LONGEST_DWELL: u32 = 99_999_999;
    const FASTEST: u32 = 99_999;
    let (absolute, increment) = letters_of(kept.axis);
    let length = |word: &Word| match kept.axis {
        TapAxis::X => modal.scale.radius(word),
        TapAxis::Z => modal.scale.length(word),
    };
    if let Some(word) = block.find(absolute) {
        kept.bottom = Some(At::new(Bottom::Work(length(&word)?), word.span));
    } else if let Some(word) = block.find(increment) {
        kept.bottom = Some(At::new(Bottom::FromR(length(&word)?), word.span));
    }
    if let Some(word) = block.find(b'R') {
        kept.rise = modal.scale.distance(&word, Range::SIGNED_NINE_DIGITS)?;
    }
    if let Some(word) = block.find(b'Q') {
        word.not_negative()?;
        kept.infeed = modal.scale.distance(&word, Range::NINE_DIGITS)?;
    }
    if let Some(word) = block.find(b'D') {
        word.not_negative()?;
        kept.back = Some(modal.scale.distance(&word, Range::NINE_DIGITS)?);
    }
    // A return from pecks that are not made: D is more than Q, which is 0 [D141].
    if let Some(back) = &kept.back
        && kept.infeed.value == Length::ZERO
        && back.value > Length::ZERO
    {
        // Of two words the newer one does not fit: D may have stayed from a block before.
        return Err(match (block.find(b'D'), block.find(b'Q')) {
            (None, Some(infeed)) => infeed.alarm(Code::TapDepth),
            _ => Alarm::new(Code::TapDepth, back.span).word(b'D'),
        });
    }
    if let Some(word) = block.find(b'P') {
        kept.dwell = Millis::new(word.count(LONGEST_DWELL)?);
    }
    if let Some(word) = block.find(b'F') {
        if word.value.mantissa() <= 0 {
            return Err(word.alarm(Code::TapFeed));
        }
        let feed = if modal.per_turn {
            TapFeed::PerTurn(modal.scale.feed_per_turn(&word)?)
        } else {
            TapFeed::PerMinute(modal.scale.feed(&word)?)
        };
        kept.feed = Some(At::new(feed, word.span));
    }
    if let Some(word) = block.find(b'J') {
        word.not_negative()?;
        // A spindle speed, written as S is: without a point [D141].
        kept.extract = Some(word.count(FASTEST)?);
    }
    if let Some(word) = block.find(b'E') {
        let spindle = TapSpindle::new(word.count(u32::MAX)?);
        if spindle.is_none() {
            return Err(word.out_of_range(Arg::Int(1), Arg::Int(4)));
        }
        kept.spindle = spindle;
    }
    if let Some(word) = block.m(MGroup::Clamp) {
        kept.clamp = Some(clamp_code(modal, &word)?);
    }
    Ok(())
}
