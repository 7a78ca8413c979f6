//! G30 P99: the way out of a hole in which a tap was stopped ([G84/G88 sheet]).
//!
//! After the return only the board knows where the tool is. So no motion follows in the program, unless the text itself
//! has left the tap in the hole (K198).

use super::block::{Block, Letters, Word};
use super::call::{CallKind, TapReturn};
use super::codes::{Group, MGroup};
use super::plan::Plan;
use super::state::{AXES, State};
use super::tap_mode::named;
use crate::alarm::{Alarm, Arg, Code};
use crate::units::{CentiRpm, Rpm};

impl State<'_> {
    /// The block of a G30 (`word`).
    pub(super) fn tap_return(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let is_return = block
            .find(b'P')
            .is_some_and(|p| !p.value.has_point() && p.value.mantissa() == 99);
        if !is_return {
            return Err(named(word, Code::GNotAvailable));
        }
        let groups = [Group::Motion, Group::Canned].map(|group| block.g(group));
        let functions = [
            MGroup::Spindle,
            MGroup::Rigid,
            MGroup::TapSpindle,
            MGroup::Clamp,
        ]
        .map(|group| block.m(group));
        let words = block.letters().without(Letters::of(b"NOPS"));
        let others = groups.into_iter().chain(functions).flatten();
        let first = others
            .chain(block.leftmost(words))
            .min_by_key(|word| word.span.column);
        if let Some(other) = first {
            return Err(other.alarm(Code::WordWithoutUse));
        }
        if self.params.tap_by_g_code() {
            return Err(word.alarm(Code::TapReturnByGCode));
        }
        let locked = self.tapping.locked.take();
        if locked.is_none() && self.tapping.is_on() {
            return Err(named(word, Code::TapCycleKept));
        }
        let highest = CentiRpm::of_rpm(rpm(self.highest_tap_speed()));
        let beyond = self.params.tap_return_extra();
        let call = TapReturn {
            speed: self.return_speed(block)?,
            highest,
            beyond,
            unit: self.length_unit(),
        };
        self.end_taps();
        match locked {
            Some((hole, _)) => {
                let inward = (hole.bottom.value - hole.level.value).signum();
                let end = hole.level.value - beyond.times(inward);
                self.position = hole.axis.with(self.position, end);
            }
            None => self.tapping.away = Some(word.span),
        }
        self.before_motion_codes(block, plan, None);
        plan.motion(word.span, CallKind::TapReturn(call));
        Ok(())
    }

    /// S: a whole number without a sign, from 1 to the highest speed of a tap.
    fn return_speed(&self, block: &Block) -> Result<Option<CentiRpm>, Alarm> {
        let Some(word) = block.find(b'S') else {
            return Ok(None);
        };
        let highest = self.highest_tap_speed();
        match word.count(u32::MAX)? {
            speed if speed > 0 && speed <= highest => Ok(Some(CentiRpm::of_rpm(rpm(speed)))),
            _ => {
                let limit = Arg::Int(i64::from(highest));
                let args = [limit, Arg::None, Arg::None, Arg::None];
                Err(word.alarm(Code::TapSpeed).with(args))
            }
        }
    }

    /// After a return nothing moves: the text does not know where the tool is.
    pub(super) fn refuse_behind_return(&self, block: &Block) -> Result<(), Alarm> {
        let Some(span) = &self.tapping.away else {
            return Ok(());
        };
        let dwells = block
            .g(Group::OneShot)
            .is_some_and(|word| word.value.mantissa() == 4);
        let motion = block.letters().common(AXES.and(Letters::of(b"IKR")));
        match block.leftmost(motion) {
            Some(word) if !dwells => {
                let line = Arg::Int(i64::from(span.line));
                let args = [line, Arg::None, Arg::None, Arg::None];
                Err(word.alarm(Code::TapReturnNotLast).with(args))
            }
            _ => Ok(()),
        }
    }
}

fn rpm(speed: u32) -> Rpm {
    Rpm::new(i32::try_from(speed).unwrap_or(i32::MAX))
}
