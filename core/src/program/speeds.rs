//! Feed and spindle: F, S, M03 M04 M05 with the coolant and flow codes that share their place in a block, and the speed
//! limit of G50.

use super::state::State;
use crate::alarm::{Alarm, Arg, Code};
use crate::call::SpindleCall;
use crate::text::{Block, MGroup, Plan, Word};

impl State<'_> {
    fn speed(&self, word: &Word) -> Result<u32, Alarm> {
        let limit = self.modal.params.spindle_max_rpm();
        let speed = word.count(u32::MAX)?;
        if speed > limit {
            let args = [
                Arg::Int(i64::from(speed)),
                Arg::Int(i64::from(limit)),
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::SpeedWordTooHigh).with(args));
        }
        Ok(speed)
    }

    /// S and the M codes that come before the motion.
    pub(super) fn before_motion(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let word = block.find(b'S');
        if let Some(word) = &word {
            self.modal.speed = self.speed(word)?;
        }
        self.before_motion_codes(block, plan, word);
        Ok(())
    }

    /// M03 M04 M08; `speed` is the S word of the block, if it is an ordinary one.
    pub(super) fn before_motion_codes(
        &mut self,
        block: &Block,
        plan: &mut Plan,
        speed: Option<Word>,
    ) {
        let turn = block
            .m(MGroup::Spindle)
            .filter(|word| word.value.mantissa() != 5);
        if let Some(word) = &turn {
            self.modal.direction = if word.value.mantissa() == 3 { 1 } else { -1 };
        }
        if let Some(word) = speed.or(turn) {
            if let Some(limit) = self.speed_limit
                && self.modal.speed > limit
            {
                let asked = Arg::Int(i64::from(self.modal.speed));
                let args = [asked, Arg::Int(i64::from(limit)), Arg::None, Arg::None];
                plan.warn(word.alarm(Code::SpeedLimited).with(args));
                self.modal.speed = limit;
            }
            plan.spindle(word.span, SpindleCall::speed(self.modal.rpm()));
        }
        if let Some(word) = block.m(MGroup::Coolant)
            && word.value.mantissa() == 8
        {
            plan.coolant_on(word.span);
        }
        if let Some(word) = block.m(MGroup::TapSpindle) {
            self.tapping.select(&word);
            plan.tap_spindle(word.span, word.value.mantissa() as u16);
        }
    }

    /// M05 M09 M00 M01 M02 M30.
    pub(super) fn after_motion(&mut self, block: &Block, plan: &mut Plan) {
        if let Some(word) = block.m(MGroup::Spindle)
            && word.value.mantissa() == 5
        {
            self.modal.direction = 0;
            plan.spindle_stop(word.span);
        }
        if let Some(word) = block.m(MGroup::Coolant)
            && word.value.mantissa() == 9
        {
            plan.coolant_off(word.span);
        }
        if let Some(word) = block.m(MGroup::Flow) {
            let code = word.value.mantissa();
            self.ended = matches!(code, 2 | 30);
            if code != 1 || self.modal.options.optional_stop {
                plan.flow(word.span, code as u16);
            }
        }
    }

    /// G50 without X U Z W: S is the speed limit.
    pub(super) fn limit_speed(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let Some(word) = block.find(b'S') else {
            return Ok(());
        };
        let limit = self.speed(&word)?;
        self.speed_limit = Some(limit);
        if self.modal.speed > limit && self.modal.direction != 0 {
            let asked = Arg::Int(i64::from(self.modal.speed));
            let args = [asked, Arg::Int(i64::from(limit)), Arg::None, Arg::None];
            plan.warn(word.alarm(Code::SpeedLimited).with(args));
            self.modal.speed = limit;
            plan.spindle(word.span, SpindleCall::speed(self.modal.rpm()));
        }
        Ok(())
    }
}
