//! Feed and spindle: F, S, M03 M04 M05 with the coolant and flow codes that share their place in a block, constant surface
//! speed (G96, G97) and its limit (G50 S).

use super::state::State;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{LengthUnit, SpindleCall};
use crate::text::{Block, MGroup, Plan, Word};
use crate::units::{Feed, Length};

/// The highest S under G96, m/min or ft/min.
const SURFACE_MOST: u32 = 4000;

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
        self.modal.refuse_by_gear(word.span, speed)?;
        Ok(speed)
    }

    /// Refuses a spindle that is to turn with no gear known, or faster than it turns in its gear: by S of an earlier gear.
    #[inline(never)]
    pub(super) fn refuse_by_gear(&self, block: &Block) -> Result<(), Alarm> {
        let word = block.m(MGroup::Spindle).or_else(|| block.find(b'S'));
        let span = word.map_or(block.lead(), |word| word.span);
        let speed = match self.modal.in_surface {
            // Its law has the limit of the gear.
            true => 1,
            false => self.modal.rpm().abs(),
        };
        self.modal.refuse_by_gear(span, speed)
    }

    /// S under G96: metres or feet a minute.
    fn surface(&self, word: &Word) -> Result<Feed, Alarm> {
        let speed = i64::from(word.count(SURFACE_MOST)?);
        Ok(Feed::from_nm_per_min(match self.modal.length_unit() {
            LengthUnit::Metric => speed.saturating_mul(1_000_000_000),
            LengthUnit::Inch => speed.saturating_mul(304_800_000),
        }))
    }

    /// G96 or G97 at `word`. Without S, G97 holds the speed that the spindle has here, and G96 takes the surface speed that
    /// was in force before.
    pub(super) fn speed_mode(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let surface = word.value.mantissa() == 96;
        let written = block.find(b'S').is_some();
        if surface && !written && self.modal.surface.is_none() {
            return Err(word.alarm(Code::SurfaceSpeedMissing));
        }
        if !surface && let Some(law) = self.modal.law() {
            let milli = law.milli_rpm(self.modal.position.x);
            self.modal.speed = milli.saturating_add(500) / 1000;
            if !written && self.modal.direction != 0 {
                plan.spindle(word.span, SpindleCall::speed(self.modal.rpm()));
            }
        }
        self.modal.in_surface = surface;
        if !surface {
            self.told = None;
        }
        Ok(())
    }

    /// Refuses a thread or a tap at `span` under G96: it needs a speed that stays.
    pub(super) fn refuse_surface(&self, span: Span) -> Result<(), Alarm> {
        if self.modal.in_surface {
            return Err(Alarm::new(Code::SurfaceSpeedInCycle, span));
        }
        Ok(())
    }

    /// Under G96: tells the spindle its law where the block has changed the law. The tool was at `from` before the block.
    pub(super) fn follow_surface(&mut self, block: &Block, from: Length, plan: &mut Plan) {
        let direction = self.modal.direction;
        let law = self.modal.law().filter(|_| direction != 0);
        let told = law.map(|law| (law, direction));
        if told != self.told
            && let Some(law) = law
        {
            plan.spindle(block.lead(), SpindleCall::surface(law, from, direction));
        }
        self.told = told;
    }

    /// S and the M codes that come before the motion.
    pub(super) fn before_motion(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let word = block.find(b'S');
        if let Some(word) = &word {
            if self.modal.in_surface {
                self.modal.surface = Some(self.surface(word)?);
            } else {
                self.modal.speed = self.speed(word)?;
                self.tell_limit(word, plan);
            }
        }
        self.before_motion_codes(block, plan, word);
        Ok(())
    }

    /// Warns where S of G50 is lower than this S of G97.
    fn tell_limit(&self, word: &Word, plan: &mut Plan) {
        let limited = self.modal.options.limits_every_speed;
        if let Some(limit) = self.modal.speed_limit
            && limited
            && self.modal.speed > limit
        {
            let args = [
                Arg::Int(i64::from(self.modal.speed)),
                Arg::Int(i64::from(limit)),
                // The remedy is another one than at G50.
                Arg::GCode(970),
            ];
            plan.warn(word.alarm(Code::SpeedLimited).with(args));
        }
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
        if let Some(word) = speed.or(turn)
            && !self.modal.in_surface
        {
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

    /// S of G50 as the highest speed under G96. What the spindle cannot do anyway is told.
    pub(super) fn limit_speed(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let Some(word) = block.find(b'S') else {
            return Ok(());
        };
        let highest = self.modal.params.spindle_most(self.modal.gear);
        let limit = word.count(u32::MAX)?;
        if limit > highest {
            let args = [Arg::Int(i64::from(limit)), Arg::Int(i64::from(highest))];
            plan.warn(word.alarm(Code::SpeedLimited).with(args));
        }
        self.modal.speed_limit = Some(limit.min(highest));
        let turns = self.modal.direction != 0 && !self.modal.in_surface;
        if turns && self.modal.options.limits_every_speed && self.modal.speed > limit {
            plan.spindle(word.span, SpindleCall::speed(self.modal.rpm()));
        }
        Ok(())
    }
}
