//! Feed and spindle: F, S, M03 M04 M05 with the coolant and flow codes that share their place in a block, and the speed
//! limit of G50.

use super::block::{Block, Word, g_arg};
use super::call::{FeedRate, SpindleCall};
use super::codes::MGroup;
use super::plan::Plan;
use super::state::State;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::units::{Feed, FeedPerTurn, Rpm};

/// The feed in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModalFeed {
    None,
    PerMinute(Feed),
    PerTurn(FeedPerTurn),
}

impl State<'_> {
    /// F outside threads.
    #[inline]
    pub(super) fn set_feed(&mut self, word: &Word) -> Result<(), Alarm> {
        self.feed = if self.per_turn {
            ModalFeed::PerTurn(self.scale.feed_per_turn(word)?)
        } else {
            ModalFeed::PerMinute(self.scale.feed(word)?)
        };
        Ok(())
    }

    /// The feed of a cut at `span`; in a dry run the dry-run feed, once there is one to replace.
    #[inline]
    pub(super) fn feed(&self, span: Span, code: i64) -> Result<FeedRate, Alarm> {
        let feed = match self.feed {
            ModalFeed::None => {
                let args = [g_arg(code), Arg::None, Arg::None, Arg::None];
                return Err(Alarm::new(Code::FeedMissing, span).with(args));
            }
            ModalFeed::PerMinute(feed) => FeedRate::PerMinute(feed),
            ModalFeed::PerTurn(feed) => FeedRate::PerTurn(feed, self.rpm()),
        };
        if self.options.dry_run {
            return Ok(FeedRate::PerMinute(self.params.dry_run_feed()));
        }
        Ok(feed)
    }

    /// Commanded spindle speed.
    pub(super) fn rpm(&self) -> Rpm {
        let speed = i32::try_from(self.speed).unwrap_or(i32::MAX);
        Rpm::new(speed.saturating_mul(self.direction))
    }

    fn speed(&self, word: &Word) -> Result<u32, Alarm> {
        let limit = self.params.spindle_max_rpm();
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
            self.speed = self.speed(word)?;
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
            self.direction = if word.value.mantissa() == 3 { 1 } else { -1 };
        }
        if let Some(word) = speed.or(turn) {
            if let Some(limit) = self.speed_limit
                && self.speed > limit
            {
                let asked = Arg::Int(i64::from(self.speed));
                let args = [asked, Arg::Int(i64::from(limit)), Arg::None, Arg::None];
                plan.warn(word.alarm(Code::SpeedLimited).with(args));
                self.speed = limit;
            }
            plan.spindle(word.span, SpindleCall::speed(self.rpm()));
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
            self.direction = 0;
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
            if code != 1 || self.options.optional_stop {
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
        if self.speed > limit && self.direction != 0 {
            let asked = Arg::Int(i64::from(self.speed));
            let args = [asked, Arg::Int(i64::from(limit)), Arg::None, Arg::None];
            plan.warn(word.alarm(Code::SpeedLimited).with(args));
            self.speed = limit;
            plan.spindle(word.span, SpindleCall::speed(self.rpm()));
        }
        Ok(())
    }
}
