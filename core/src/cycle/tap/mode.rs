//! The blocks around tapping cycles: when rigid mode begins and ends, and which words may stand in between
//! ([G84/G88 sheet]). The words of the cycles themselves are `tap`'s.
//!
//! Rigid mode begins with the M code of 5210 and its S in the block right before the cycle (5200.0 = 0), or with S in the
//! cycle's block (5200.0 = 1). It ends with the cycle: G80, a G code of group 01, M02, M30. Ending it clears S. A cycle
//! without rigid mode is ordinary tapping: the spindle turns by M03 or M04 and its S.

use super::return_words::is_tap_return;
use super::words::Kept;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{Selection, SpindleCall, SpindleChoice, TapCall, TapSpindle};
use crate::params::{Params, gear_of_code};
use crate::text::{
    AXES, Block, Group, Letters, MGroup, Modal, PLANE_AXES, Plan, Word, g_arg, is_machine_code,
};
use crate::units::{Angle, Rpm};

/// The M code of rigid tapping (5210; 0 is 29).
pub(crate) fn rigid_code(params: &Params) -> u8 {
    match params.tap_m_code() {
        0 => 29,
        code => code,
    }
}

/// What a program has set so far for tapping.
#[derive(Clone, Debug)]
pub(crate) struct Tapping {
    /// S of rigid mode, signed, never zero; `None` outside it.
    pub(super) rigid: Option<Rpm>,
    /// The rigid M code, where it stood in the block before.
    armed: Option<Span>,
    /// The cycle in force.
    pub(super) cycle: Option<Kept>,
    /// M24–M27.
    pub(super) spindle: TapSpindle,
    /// The hole that a K198 has left the tap in, and its block.
    pub(super) locked: Option<(TapCall, Span)>,
    /// After this G30 P99 only the board knows where the tool is.
    pub(super) away: Option<Span>,
}

impl Tapping {
    pub(crate) const fn new() -> Self {
        Self {
            rigid: None,
            armed: None,
            cycle: None,
            spindle: TapSpindle::First,
            locked: None,
            away: None,
        }
    }

    /// Rigid mode, or a cycle in force.
    pub(crate) const fn is_on(&self) -> bool {
        self.rigid.is_some() || self.cycle.is_some()
    }

    /// The cycle in force, as its G code.
    pub(crate) fn code(&self) -> Option<u8> {
        self.cycle.as_ref().map(Kept::code)
    }

    /// True where a block goes through [`begin`](Self::begin) and [`end`](Self::end).
    #[inline]
    pub(crate) fn concerns(&self, block: &Block) -> bool {
        const CODES: u8 = MGroup::Rigid.bit() | MGroup::Clamp.bit();
        self.is_on()
            || self.away.is_some()
            || block.has_groups(Group::Canned.bit())
            || block.has_m_groups(CODES)
    }

    /// M24–M27.
    pub(crate) fn select(&mut self, word: &Word) {
        let number = word.value.mantissa().saturating_sub(23);
        let spindle = u32::try_from(number).ok().and_then(TapSpindle::new);
        self.spindle = spindle.unwrap_or(self.spindle);
    }

    /// A number meant for G98 is none for G99.
    pub(crate) fn forget_feed(&mut self) {
        if let Some(kept) = &mut self.cycle {
            kept.feed = None;
        }
    }

    /// Refuses the end of the text while a tap stands in its hole, or right after the rigid M code [D141].
    pub(crate) fn refuse_left(&self) -> Result<(), Alarm> {
        match (&self.locked, self.armed) {
            (Some((_, span)), _) => Err(Alarm::new(Code::TapLeftInHole, *span)),
            (None, Some(span)) => Err(Alarm::new(Code::TapModePlace, span)),
            (None, None) => Ok(()),
        }
    }
}

/// What of a block tapping looks at.
struct Codes {
    /// G84 or G88.
    tap: Option<Word>,
    /// G80 or a G code of group 01.
    cancel: Option<Word>,
    motion: Option<Word>,
    one_shot: Option<Word>,
    rigid: Option<Word>,
    /// M03 M04 M05.
    spindle: Option<Word>,
    plane: Option<Word>,
}

impl Codes {
    fn of(block: &Block) -> Self {
        let canned = block.g(Group::Canned);
        let is_tap = |word: &Word| word.value.mantissa() != 80;
        let motion = block.g(Group::Motion);
        Self {
            tap: canned.filter(is_tap),
            cancel: canned.filter(|word| !is_tap(word)).or(motion),
            motion,
            one_shot: block.g(Group::OneShot),
            rigid: block.m(MGroup::Rigid),
            spindle: block.m(MGroup::Spindle),
            plane: block.g(Group::Plane),
        }
    }
}

/// The M codes of a block that have no meaning of their own: each is a row of the table of machine functions.
fn functions(modal: &mut Modal<'_>, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
    let params = modal.params;
    let row_of = |word: &Word| {
        let code = u16::try_from(word.value.mantissa()).ok()?;
        params.function(code)
    };
    let gear_of = |word: &Word| gear_of_code(u16::try_from(word.value.mantissa()).ok()?);
    for (place, word) in block.free_m().enumerate() {
        let code = word.value.mantissa();
        if let Some(gear) = gear_of(&word)
            && params.has_gears()
        {
            let other = block
                .free_m()
                .take(place)
                .find(|other| gear_of(other).is_some());
            if other.is_some() {
                return Err(exclude(other, &word));
            }
            shift(modal, &word, gear)?;
            plan.gear(word.span, code as u16);
            continue;
        }
        let Some(row) = row_of(&word) else {
            if code == ORIENT {
                orient(modal, block, &word, plan)?;
                continue;
            }
            if modal.options.passes_machine_codes && is_machine_code(code) {
                plan.warn(word.alarm(Code::MachineCodePassed).with([Arg::Int(code)]));
                continue;
            }
            let unknown = match code {
                1..=28 | 30..=999 => Code::FunctionMissing,
                _ => Code::UnknownM,
            };
            return Err(word.alarm(unknown).with([Arg::Int(code)]));
        };
        let earlier = block.free_m().take(place).chain(block.m(MGroup::Coolant));
        for other in earlier {
            if row_of(&other).is_some_and(|other| other.excludes(&row)) {
                return Err(exclude(Some(other), &word));
            }
        }
        plan.function(word.span, row.code, row.behind);
    }
    Ok(())
}

/// M19: the spindle stands at an angle, where no row of the table says otherwise.
pub(super) const ORIENT: i64 = 19;

/// The fewest counts of an encoder that tell an angle to 0.1°: the middle of a count is within half a count of it.
const ORIENT_COUNTS: u32 = 1_800;

/// The angle of an M19 without a row, in a block that has no other use for R: its word, or none.
pub(crate) fn orientation(block: &Block, params: &Params) -> Option<Word> {
    let is_own = |word: &Word| word.value.mantissa() == ORIENT && params.orients_by_m19();
    let canned = block
        .g(Group::Canned)
        .is_some_and(|word| word.value.mantissa() != 80);
    let moves = block.has_any(AXES) || block.g(Group::OneShot).is_some() || canned;
    let orients = !moves && block.free_m().any(|word| is_own(&word));
    block.find(b'R').filter(|_| orients)
}

/// M19 at `word`, with R in degrees, 0 without it.
fn orient(modal: &mut Modal<'_>, block: &Block, word: &Word, plan: &mut Plan) -> Result<(), Alarm> {
    // Any speed: a gear that is not known has none.
    modal.refuse_by_gear(word.span, 1)?;
    let counts = modal.params.encoder_counts();
    if counts < ORIENT_COUNTS {
        let figures = [counts, ORIENT_COUNTS].map(|counts| Arg::Int(counts.into()));
        return Err(word.alarm(Code::EncoderTooCoarseToOrient).with(figures));
    }
    if let Some(other) = block.m(MGroup::Spindle) {
        return Err(exclude(Some(other), word));
    }
    // A speed would turn it again.
    if let Some(speed) = block.find(b'S') {
        return Err(speed.alarm(Code::WordWithoutUse));
    }
    let angle = match &orientation(block, modal.params) {
        Some(angle) => modal.scale.angle(angle)?.udeg().rem_euclid(360_000_000),
        None => 0,
    };
    modal.direction = 0;
    plan.spindle(word.span, SpindleCall::orient(Angle::from_udeg(angle)));
    Ok(())
}

/// M41 to M44 on a machine with gears: the speeds that follow are those of this gear.
fn shift(modal: &mut Modal<'_>, word: &Word, gear: u8) -> Result<(), Alarm> {
    let refused = |code| Err(word.alarm(code).with([Arg::Int(word.value.mantissa())]));
    if modal.direction != 0 {
        return refused(Code::GearTurning);
    }
    if modal.params.gear(gear).is_none() {
        return refused(Code::GearMissing);
    }
    modal.gear = gear;
    Ok(())
}

/// Two M words that one block cannot have.
fn exclude(first: Option<Word>, second: &Word) -> Alarm {
    let code = |word: &Word| Arg::Int(word.value.mantissa());
    let first = first.as_ref().map_or(Arg::None, code);
    second.alarm(Code::MGroupTwice).with([first, code(second)])
}

/// What a block that concerns tapping does.
pub(crate) enum TapPart {
    /// G30 P99, at this G word.
    Return(Word),
    /// A cycle: the word of G84 or G88 if it is written, and whether it taps in rigid mode.
    Cycle(Option<Word>, bool),
    /// The rigid M code and nothing else.
    RigidCode,
    /// What it would do elsewhere.
    Other,
}

impl Tapping {
    /// The first part of a block that [`concerns`](Self::concerns) tapping: refuses what must not stand there, ends and
    /// begins rigid mode, and says what is left to do. The block's modes come after it.
    #[inline(never)]
    pub(crate) fn begin(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        plan: &mut Plan,
    ) -> Result<TapPart, Alarm> {
        let codes = Codes::of(block);
        self.refuse_after_return(block)?;
        if let Some(word) = codes.one_shot
            && word.value.mantissa() == 30
            && is_tap_return(block)
        {
            return Ok(TapPart::Return(word));
        }
        self.refuse_out_of_phase(block, &codes)?;
        self.refuse_before_cycle(modal, block, &codes)?;
        if let Some(tap) = &codes.tap
            && let Some(other) = codes.motion.or(codes.one_shot)
        {
            return Err(both(&other, tap));
        }
        if let Some(word) = &codes.cancel
            && self.is_on()
            && self.end_taps(modal)
        {
            plan.spindle(word.span, SpindleCall::STOPPED);
        }
        if self.rigid.is_some()
            && let Some(word) = &codes.plane
            && word.value.mantissa() != i64::from(modal.plane)
        {
            return Err(word.alarm(Code::TapPlane));
        }
        // The spindle of this block is that of its rigid mode.
        if let Some(word) = block.m(MGroup::TapSpindle) {
            self.select(&word);
        }
        if let Some(word) = &codes.rigid {
            self.begin_rigid(modal, block, word, &codes, plan)?;
        } else if self.rigid.is_some() {
            self.refuse_spindle(modal, block, &codes)?;
        }
        let is_cycle = codes.tap.is_some() || (self.cycle.is_some() && codes.one_shot.is_none());
        if !is_cycle {
            functions(modal, block, plan)?;
        } else if let Some(second) = block.free_m().nth(1) {
            return Err(exclude(block.m(MGroup::Clamp), &second));
        }
        if self.cycle.is_some()
            && let Some(word) = &codes.one_shot
            && !matches!(word.value.mantissa(), 4 | 50)
        {
            return Err(named(word, Code::TapCycleKept));
        }
        Ok(if is_cycle {
            let rigid = self.is_rigid_block(modal, block, codes.tap.as_ref());
            TapPart::Cycle(codes.tap, rigid)
        } else if codes.rigid.is_some() {
            TapPart::RigidCode
        } else {
            TapPart::Other
        })
    }

    /// The last part: M02 and M30 end tapping, but not with the tap in its hole.
    pub(crate) fn end(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        if let Some(word) = block.m(MGroup::Flow)
            && matches!(word.value.mantissa(), 2 | 30)
            && self.is_on()
        {
            if let Some((_, span)) = &self.locked {
                return Err(locked(&word, *span));
            }
            if self.end_taps(modal) {
                plan.spindle_stop(word.span);
            }
        }
        Ok(())
    }

    /// Ends the cycle, and with it rigid mode. True where that mode was on. Its S is cleared ([G84/G88 sheet], note 5); S
    /// and M03 of an ordinary tap are the spindle's own and stay [D95].
    pub(super) fn end_taps(&mut self, modal: &mut Modal<'_>) -> bool {
        self.armed = None;
        self.cycle = None;
        let rigid = self.rigid.take().is_some();
        if rigid {
            modal.speed = 0;
            modal.direction = 0;
        }
        rigid
    }

    /// With the tap in its hole: accepts only what keeps the tap in phase [D25]. `tap` checks the words of a cycle that
    /// goes on.
    fn refuse_out_of_phase(&self, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        let Some((_, span)) = &self.locked else {
            return Ok(());
        };
        let one_shot = codes
            .one_shot
            .filter(|word| codes.tap.is_some() || word.value.mantissa() != 4);
        let ends = block
            .m(MGroup::Flow)
            .filter(|word| matches!(word.value.mantissa(), 2 | 30));
        let refused = [
            codes.cancel,
            one_shot,
            codes.plane,
            codes.rigid,
            codes.spindle,
            block.m(MGroup::TapSpindle),
            block.m(MGroup::Clamp),
            block.find(b'T'),
            block.find(b'S').filter(|_| codes.tap.is_none()),
            ends,
        ];
        if let Some(word) = refused.iter().flatten().min_by_key(|word| word.span.column) {
            return Err(locked(word, *span));
        }
        let motion = if codes.tap.is_some() || codes.one_shot.is_some() {
            Letters::default()
        } else {
            AXES
        };
        match block.leftmost(block.letters().common(motion)) {
            Some(word) => Err(locked(&word, *span)),
            None => Ok(()),
        }
    }

    /// After the rigid M code: G84 or G88 and nothing else.
    fn refuse_before_cycle(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        codes: &Codes,
    ) -> Result<(), Alarm> {
        if self.armed.is_none() {
            return Ok(());
        }
        if let Some(word) = &codes.rigid {
            return Err(misplaced(modal, word.alarm(Code::TapModePlace)));
        }
        if codes.tap.is_some() {
            self.armed = None;
            return Ok(());
        }
        let dwells = codes
            .one_shot
            .is_some_and(|word| word.value.mantissa() == 4);
        match block.leftmost(block.letters().common(AXES)) {
            Some(word) if !dwells => Err(misplaced(modal, word.alarm(Code::TapModeAxis))),
            _ => Err(misplaced(
                modal,
                Alarm::new(Code::TapModePlace, block.lead()),
            )),
        }
    }

    /// The M code of 5210 and its S.
    fn begin_rigid(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        word: &Word,
        codes: &Codes,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let elsewhere = codes.tap.is_some() || codes.one_shot.is_some();
        if self.is_on() || modal.params.tap_by_g_code() || elsewhere {
            return Err(misplaced(modal, word.alarm(Code::TapModePlace)));
        }
        if let Some(axis) = block.leftmost(block.letters().common(AXES)) {
            return Err(misplaced(modal, axis.alarm(Code::TapModeAxis)));
        }
        if let Some(turn) = &codes.spindle {
            return Err(turn.alarm(Code::TapSpindleBusy));
        }
        let rpm = tap_speed(modal, block.find(b'S'), word.span)?;
        self.begin_position_mode(modal, rpm);
        self.armed = Some(word.span);
        plan.rigid(
            word.span,
            SpindleCall::rigid(rpm, self.spindle_choice(modal, None)),
        );
        Ok(())
    }

    /// The source that selects the tapping spindle: E, else the signals of 5200.7, else M24–M27 [D85].
    pub(super) fn spindle_choice(
        &self,
        modal: &Modal<'_>,
        written: Option<TapSpindle>,
    ) -> SpindleChoice {
        match written {
            Some(spindle) => SpindleChoice::Written(spindle),
            None => SpindleChoice::Signals {
                by: if modal.params.tap_spindle_by_rgtsp() {
                    Selection::Rgtsp
                } else {
                    Selection::Sws
                },
                otherwise: self.spindle,
            },
        }
    }

    /// The spindle stands and waits for taps.
    pub(super) fn begin_position_mode(&mut self, modal: &mut Modal<'_>, rpm: Rpm) {
        self.rigid = Some(rpm);
        modal.speed = 0;
        modal.direction = 0;
    }

    /// Refuses to turn a spindle that is in position mode, and an S that is in the wrong place.
    fn refuse_spindle(&self, modal: &Modal<'_>, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        if let Some(word) = &codes.spindle {
            return Err(word.alarm(Code::TapSpindleBusy));
        }
        let Some(word) = block.find(b'S') else {
            return Ok(());
        };
        match &codes.one_shot {
            // S of a G50 is the limit, and else of no tap.
            Some(_) if !is_limit(block, codes) => Err(word.alarm(Code::TapSpindleBusy)),
            None if !modal.params.tap_by_g_code() => {
                Err(misplaced(modal, word.alarm(Code::TapModePlace)))
            }
            _ => Ok(()),
        }
    }
}

fn is_limit(block: &Block, codes: &Codes) -> bool {
    let is_g50 = |word: &Word| word.value.mantissa() == 50;
    codes.one_shot.as_ref().is_some_and(is_g50) && !block.has_any(PLANE_AXES)
}

/// The alarm of a word that would take the tap out of phase; `span` is the block with K198.
pub(super) fn locked(word: &Word, span: Span) -> Alarm {
    let line = Arg::Int(i64::from(span.line));
    word.alarm(Code::TapLocked).with([line])
}

/// An alarm with the name of the G code to blame.
pub(super) fn named(word: &Word, code: Code) -> Alarm {
    let name = g_arg(word.value.mantissa());
    word.alarm(code).with([name])
}

/// Two codes that both take the axis words.
fn both(other: &Word, tap: &Word) -> Alarm {
    let (first, later) = if other.span.column > tap.span.column {
        (tap, other)
    } else {
        (other, tap)
    };
    let args = [
        g_arg(first.value.mantissa()),
        g_arg(later.value.mantissa()),
        Arg::None,
        Arg::None,
    ];
    later.alarm(Code::AxisWordsTwice).with(args)
}

/// 5241, and never more than the spindle can in its gear (3772).
pub(super) fn highest_tap_speed(modal: &Modal<'_>) -> u32 {
    modal
        .params
        .tap_max_rpm()
        .min(modal.params.spindle_most(modal.gear))
}

/// S of rigid mode, signed; `span` is to blame where it is missing.
pub(super) fn tap_speed(modal: &Modal<'_>, word: Option<Word>, span: Span) -> Result<Rpm, Alarm> {
    let limit = highest_tap_speed(modal);
    let args = [Arg::Int(i64::from(limit)), Arg::None, Arg::None, Arg::None];
    let Some(word) = word else {
        return Err(Alarm::new(Code::TapSpeed, span).with(args));
    };
    if word.value.has_point() {
        return Err(word.alarm(Code::PointInInteger));
    }
    let speed = word.value.mantissa();
    match i32::try_from(speed) {
        Ok(rpm) if rpm != 0 && rpm.unsigned_abs() <= limit => {
            modal.refuse_by_gear(word.span, rpm.unsigned_abs())?;
            Ok(Rpm::new(rpm))
        }
        _ => Err(word.alarm(Code::TapSpeed).with(args)),
    }
}

fn misplaced(modal: &Modal<'_>, alarm: Alarm) -> Alarm {
    let code = Arg::Int(i64::from(rigid_code(modal.params)));
    alarm.with([code])
}
