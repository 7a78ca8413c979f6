//! How fast a tap turns: S, the dry run, and the extraction override ([G84/G88 sheet], cycles.md section 8).

use super::block::Block;
use super::call::TapCall;
use super::state::State;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::units::{CentiRpm, Lead, Rpm};

impl State<'_> {
    /// S; in a dry run what the dry-run feed makes of the lead, never above the highest tapping speed.
    pub(super) fn infeed_speed(&self, rpm: Rpm, lead: Lead) -> CentiRpm {
        let written = CentiRpm::of_rpm(Rpm::new(i32::try_from(rpm.abs()).unwrap_or(i32::MAX)));
        if !self.options.dry_run {
            return written;
        }
        let feed = self.params.dry_run_feed().nm_per_min();
        let hundredths = feed
            .saturating_mul(100)
            .saturating_mul(lead.denominator())
            .checked_div(lead.numerator())
            .unwrap_or(0);
        let limit = i64::from(self.highest_tap_speed()).saturating_mul(100);
        let speed = hundredths.min(limit).max(1);
        CentiRpm::new(i32::try_from(speed).unwrap_or(i32::MAX))
    }

    /// The speed of the way out, and what was asked for: the infeed's times the extraction override (5200.4, 5201.3,
    /// 5201.4, 5202.6, 5211, J [D28]).
    pub(super) fn extraction(
        &self,
        j: Option<u32>,
        call: &TapCall,
        rpm: Rpm,
    ) -> (CentiRpm, CentiRpm) {
        let (part, whole) = self.extraction_ratio(j, rpm);
        let speed = i64::from(call.speed.get());
        let half = whole >> 1;
        let asked = speed
            .saturating_mul(part)
            .saturating_add(half)
            .checked_div(whole)
            .unwrap_or(speed)
            .max(1);
        let limit = i64::from(self.highest_tap_speed()).saturating_mul(100);
        let speed = |raw: i64| CentiRpm::new(i32::try_from(raw).unwrap_or(i32::MAX));
        (speed(asked.min(limit)), speed(asked))
    }

    fn extraction_ratio(&self, j: Option<u32>, rpm: Rpm) -> (i64, i64) {
        if !self.params.tap_extract_override() {
            return (1, 1);
        }
        let s = i64::from(rpm.abs());
        match j.map(i64::from) {
            Some(j) if self.params.tap_extract_by_j() => {
                let most = if self.params.tap_extract_wide() {
                    20
                } else {
                    2
                };
                if j >= s && j <= s.saturating_mul(most) {
                    (j, s)
                } else {
                    (1, 1)
                }
            }
            _ => {
                let percent = i64::from(self.params.tap_extract_percent());
                let unit = if self.params.tap_extract_tens() {
                    10
                } else {
                    1
                };
                match percent {
                    0 => (1, 1),
                    percent => (percent.saturating_mul(unit), 100),
                }
            }
        }
    }

    pub(super) fn limited(&self, block: &Block, span: Span, asked: CentiRpm) -> Alarm {
        let alarm = match block.find(b'J') {
            Some(word) => word.alarm(Code::TapExtractionLimited),
            None => Alarm::new(Code::TapExtractionLimited, span),
        };
        let asked = Rpm::new(asked.get() / 100);
        let limit = Arg::Int(i64::from(self.highest_tap_speed()));
        alarm.with([Arg::Rpm(asked), limit, Arg::None, Arg::None])
    }
}
