//! G30 P99: the way out of a hole in which a tap was stopped ([G84/G88 sheet]).
//!
//! After the return only the board knows where the tool is. So no motion follows in the program, unless the text itself
//! has left the tap in the hole (K198).

use super::mode::{Tapping, highest_tap_speed, named};
use crate::alarm::{Alarm, Arg, Code};
use crate::call::{CallKind, TapReturn};
use crate::text::{AXES, Block, Group, Letters, MGroup, Modal, Plan, Word};
use crate::units::{CentiRpm, Rpm};

impl Tapping {
    /// The block of a G30 (`word`).
    pub(crate) fn tap_return(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
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
        if modal.params.tap_by_g_code() {
            return Err(word.alarm(Code::TapReturnByGCode));
        }
        let locked = self.locked.take();
        if locked.is_none() && self.is_on() {
            return Err(named(word, Code::TapCycleKept));
        }
        let highest = CentiRpm::of_rpm(rpm(highest_tap_speed(modal)));
        let beyond = modal.params.tap_return_extra();
        let call = TapReturn {
            speed: return_speed(modal, block)?,
            highest,
            beyond,
            unit: modal.length_unit(),
        };
        self.end_taps(modal);
        match locked {
            Some((hole, _)) => {
                let inward = (hole.bottom.value - hole.level.value).signum();
                let end = hole.level.value - beyond.times(inward);
                modal.position = hole.axis.with(modal.position, end);
            }
            None => self.away = Some(word.span),
        }
        plan.motion(word.span, CallKind::TapReturn(call));
        Ok(())
    }

    /// After a return nothing moves: the text does not know where the tool is.
    pub(super) fn refuse_after_return(&self, block: &Block) -> Result<(), Alarm> {
        let Some(span) = &self.away else {
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

/// True where the G30 of a block is the return of a tap: G30 P99.
pub(crate) fn is_tap_return(block: &Block) -> bool {
    block
        .find(b'P')
        .is_some_and(|p| !p.value.has_point() && p.value.mantissa() == 99)
}

fn rpm(speed: u32) -> Rpm {
    Rpm::new(i32::try_from(speed).unwrap_or(i32::MAX))
}

/// S: a whole number without a sign, from 1 to the highest speed of a tap.
fn return_speed(modal: &Modal<'_>, block: &Block) -> Result<Option<CentiRpm>, Alarm> {
    let Some(word) = block.find(b'S') else {
        return Ok(None);
    };
    let highest = highest_tap_speed(modal);
    match word.count(u32::MAX)? {
        speed if speed > 0 && speed <= highest => Ok(Some(CentiRpm::of_rpm(rpm(speed)))),
        _ => {
            let limit = Arg::Int(i64::from(highest));
            let args = [limit, Arg::None, Arg::None, Arg::None];
            Err(word.alarm(Code::TapSpeed).with(args))
        }
    }
}
