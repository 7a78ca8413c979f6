//! The blocks around tapping cycles: when rigid mode begins and ends, and which words may stand in between
//! ([G84/G88 sheet]). The words of the cycles themselves are `tap`'s.
//!
//! Rigid mode begins with the M code of 5210 and its S in the block right before the cycle (5200.0 = 0), or with S in the
//! cycle's block (5200.0 = 1). It ends with the cycle: G80, a G code of group 01, M02, M30. Ending it clears S. A cycle
//! without rigid mode is ordinary tapping: the spindle turns by M03 or M04 and its S.

use super::block::{Block, Letters, Word, g_arg};
use super::call::{SpindleCall, TapCall};
use super::choice::{Selection, SpindleChoice};
use super::codes::{Group, MGroup};
use super::plan::Plan;
use super::state::{AXES, State};
use super::tap::Kept;
use super::tapper::TapSpindle;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::params::Params;
use crate::units::Rpm;

/// The M code of rigid tapping (5210; 0 is 29).
pub(super) fn rigid_code(params: &Params) -> u8 {
    match params.tap_m_code() {
        0 => 29,
        code => code,
    }
}

/// What a program has set so far for tapping.
#[derive(Clone, Debug)]
pub(super) struct Tapping {
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
    /// Behind this G30 P99 only the board knows where the tool is.
    pub(super) away: Option<Span>,
}

impl Tapping {
    pub(super) const fn new() -> Self {
        Self {
            rigid: None,
            armed: None,
            cycle: None,
            spindle: TapSpindle::First,
            locked: None,
            away: None,
        }
    }

    pub(super) const fn is_on(&self) -> bool {
        self.rigid.is_some() || self.cycle.is_some()
    }

    /// True where [`State::around_taps`] must handle a block.
    #[inline]
    pub(super) fn concerns(&self, block: &Block) -> bool {
        const CODES: u8 = MGroup::Rigid.bit() | MGroup::Clamp.bit();
        self.is_on()
            || self.away.is_some()
            || block.has_groups(Group::Canned.bit())
            || block.has_m_groups(CODES)
    }

    /// M24–M27.
    pub(super) fn select(&mut self, word: &Word) {
        let number = word.value.mantissa().saturating_sub(23);
        let spindle = u32::try_from(number).ok().and_then(TapSpindle::new);
        self.spindle = spindle.unwrap_or(self.spindle);
    }

    /// A number meant for G98 is none for G99.
    pub(super) fn forget_feed(&mut self) {
        if let Some(kept) = &mut self.cycle {
            kept.feed = None;
        }
    }

    /// Refuses the end of the text while a tap stands in its hole, or right after the rigid M code [D141].
    pub(super) fn refuse_left(&self) -> Result<(), Alarm> {
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

impl State<'_> {
    /// A block in rigid mode or with a cycle in force, and one with G80, G84, G88, the rigid M code or an M code without a
    /// meaning of its own.
    #[inline(never)]
    pub(super) fn around_taps(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let codes = Codes::of(block);
        self.refuse_behind_return(block)?;
        if let Some(word) = &codes.one_shot
            && word.value.mantissa() == 30
        {
            self.modal(block, plan)?;
            return self.tap_return(block, word, plan);
        }
        self.refuse_out_of_phase(block, &codes)?;
        self.refuse_before_cycle(block, &codes)?;
        if let Some(tap) = &codes.tap
            && let Some(other) = codes.motion.or(codes.one_shot)
        {
            return Err(both(&other, tap));
        }
        if let Some(word) = &codes.cancel
            && self.tapping.is_on()
            && self.end_taps()
        {
            plan.spindle(word.span, SpindleCall::STOPPED);
        }
        if self.tapping.rigid.is_some()
            && let Some(word) = &codes.plane
            && word.value.mantissa() != i64::from(self.plane)
        {
            return Err(word.alarm(Code::TapPlane));
        }
        // The spindle of this block is that of its rigid mode.
        if let Some(word) = block.m(MGroup::TapSpindle) {
            self.tapping.select(&word);
        }
        if let Some(word) = &codes.rigid {
            self.begin_rigid(block, word, &codes, plan)?;
        } else if self.tapping.rigid.is_some() {
            self.refuse_spindle(block, &codes)?;
        }
        let is_tap_block =
            codes.tap.is_some() || (self.tapping.cycle.is_some() && codes.one_shot.is_none());
        if !is_tap_block && let Some(word) = block.m(MGroup::Clamp) {
            let args = [
                Arg::Int(word.value.mantissa()),
                Arg::None,
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::UnknownM).with(args));
        }
        if self.tapping.cycle.is_some()
            && let Some(word) = &codes.one_shot
            && !matches!(word.value.mantissa(), 4 | 50)
        {
            return Err(named(word, Code::TapCycleKept));
        }
        let motion_word = self.modal(block, plan)?;
        if is_tap_block {
            if self.is_rigid_block(block, codes.tap.as_ref()) {
                self.before_motion_codes(block, plan, None);
            } else {
                // The spindle is in speed mode, and S is its own.
                self.before_motion(block, plan)?;
            }
            self.tap(block, codes.tap.as_ref(), plan)?;
        } else if codes.rigid.is_some() {
            self.only(block, Letters::default())?;
            self.before_motion_codes(block, plan, None);
        } else {
            self.act(block, motion_word, plan)?;
        }
        if let Some(word) = block.m(MGroup::Flow)
            && matches!(word.value.mantissa(), 2 | 30)
            && self.tapping.is_on()
        {
            if let Some((_, span)) = &self.tapping.locked {
                return Err(locked(&word, *span));
            }
            if self.end_taps() {
                plan.spindle_stop(word.span);
            }
        }
        Ok(())
    }

    /// Ends the cycle, and with it rigid mode. True where that mode was on. Its S is cleared ([G84/G88 sheet], note 5); S
    /// and M03 of an ordinary tap are the spindle's own and stay [D95].
    pub(super) fn end_taps(&mut self) -> bool {
        self.tapping.armed = None;
        self.tapping.cycle = None;
        let rigid = self.tapping.rigid.take().is_some();
        if rigid {
            self.speed = 0;
            self.direction = 0;
        }
        rigid
    }

    /// With the tap in its hole: accepts only what keeps the tap in phase [D25]. `tap` checks the words of a cycle that
    /// goes on.
    fn refuse_out_of_phase(&self, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        let Some((_, span)) = &self.tapping.locked else {
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

    /// Behind the rigid M code: G84 or G88 and nothing else.
    fn refuse_before_cycle(&mut self, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        if self.tapping.armed.is_none() {
            return Ok(());
        }
        if let Some(word) = &codes.rigid {
            return Err(self.misplaced(word.alarm(Code::TapModePlace)));
        }
        if codes.tap.is_some() {
            self.tapping.armed = None;
            return Ok(());
        }
        let dwells = codes
            .one_shot
            .is_some_and(|word| word.value.mantissa() == 4);
        match block.leftmost(block.letters().common(AXES)) {
            Some(word) if !dwells => Err(self.misplaced(word.alarm(Code::TapModeAxis))),
            _ => Err(self.misplaced(Alarm::new(Code::TapModePlace, block.lead()))),
        }
    }

    /// The M code of 5210 and its S.
    fn begin_rigid(
        &mut self,
        block: &Block,
        word: &Word,
        codes: &Codes,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let elsewhere = codes.tap.is_some() || codes.one_shot.is_some();
        if self.tapping.is_on() || self.params.tap_by_g_code() || elsewhere {
            return Err(self.misplaced(word.alarm(Code::TapModePlace)));
        }
        if let Some(axis) = block.leftmost(block.letters().common(AXES)) {
            return Err(self.misplaced(axis.alarm(Code::TapModeAxis)));
        }
        if let Some(turn) = &codes.spindle {
            return Err(turn.alarm(Code::TapSpindleBusy));
        }
        let rpm = self.tap_speed(block.find(b'S'), word.span)?;
        self.begin_position_mode(rpm);
        self.tapping.armed = Some(word.span);
        plan.rigid(
            word.span,
            SpindleCall::rigid(rpm, self.spindle_choice(None)),
        );
        Ok(())
    }

    /// The source that selects the tapping spindle: E, else the signals of 5200.7, else M24–M27 [D85].
    pub(super) fn spindle_choice(&self, written: Option<TapSpindle>) -> SpindleChoice {
        match written {
            Some(spindle) => SpindleChoice::Written(spindle),
            None => SpindleChoice::Signals {
                by: if self.params.tap_spindle_by_rgtsp() {
                    Selection::Rgtsp
                } else {
                    Selection::Sws
                },
                otherwise: self.tapping.spindle,
            },
        }
    }

    /// The spindle stands and waits for taps.
    pub(super) fn begin_position_mode(&mut self, rpm: Rpm) {
        self.tapping.rigid = Some(rpm);
        self.speed = 0;
        self.direction = 0;
    }

    /// S of rigid mode, signed; `span` is to blame where it is missing.
    pub(super) fn tap_speed(&self, word: Option<Word>, span: Span) -> Result<Rpm, Alarm> {
        let limit = self.highest_tap_speed();
        let args = [Arg::Int(i64::from(limit)), Arg::None, Arg::None, Arg::None];
        let Some(word) = word else {
            return Err(Alarm::new(Code::TapSpeed, span).with(args));
        };
        if word.value.has_point() {
            return Err(word.alarm(Code::PointInInteger));
        }
        let speed = word.value.mantissa();
        match i32::try_from(speed) {
            Ok(rpm) if rpm != 0 && rpm.unsigned_abs() <= limit => Ok(Rpm::new(rpm)),
            _ => Err(word.alarm(Code::TapSpeed).with(args)),
        }
    }

    /// 5241, and never more than the spindle can (3772).
    pub(super) fn highest_tap_speed(&self) -> u32 {
        self.params.tap_max_rpm().min(self.params.spindle_max_rpm())
    }

    /// Refuses to turn a spindle that is in position mode, and an S that is in the wrong place.
    fn refuse_spindle(&self, block: &Block, codes: &Codes) -> Result<(), Alarm> {
        if let Some(word) = &codes.spindle {
            return Err(word.alarm(Code::TapSpindleBusy));
        }
        let Some(word) = block.find(b'S') else {
            return Ok(());
        };
        match &codes.one_shot {
            // S of a G50 is the limit, and else of no tap.
            Some(_) if !is_limit(block, codes) => Err(word.alarm(Code::TapSpindleBusy)),
            None if !self.params.tap_by_g_code() => {
                Err(self.misplaced(word.alarm(Code::TapModePlace)))
            }
            _ => Ok(()),
        }
    }

    fn misplaced(&self, alarm: Alarm) -> Alarm {
        let code = Arg::Int(i64::from(rigid_code(self.params)));
        alarm.with([code])
    }
}

fn is_limit(block: &Block, codes: &Codes) -> bool {
    let is_g50 = |word: &Word| word.value.mantissa() == 50;
    codes.one_shot.as_ref().is_some_and(is_g50) && !block.has_any(super::state::PLANE_AXES)
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
