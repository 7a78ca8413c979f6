//! The speed and the lead of a tap: from S of rigid mode or of a turning spindle, from the dry run, and from the
//! extraction override ([G84/G88 sheet]).

use super::mode::{Tapping, highest_tap_speed, rigid_code, tap_speed};
use super::words::{Kept, TapFeed};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{Extraction, SpindleCall, TapCall, TapMode};
use crate::text::{Block, Letters, Modal, Plan, Word};
use crate::units::{CentiRpm, Lead, Rpm};

/// What turns a tap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    pub(super) mode: TapMode,
    /// Signed: minus is a left-hand tap. Zero where the spindle of an ordinary tap stands.
    pub(super) rpm: Rpm,
    /// S, which is known of a standing spindle too.
    s: u32,
}

impl Tapping {
    /// True where a tapping block taps in rigid mode: it is on, or begins with S in the block of G84 or G88 (`word`).
    pub(super) fn is_rigid_block(
        &self,
        modal: &Modal<'_>,
        block: &Block,
        word: Option<&Word>,
    ) -> bool {
        let begins = modal.params.tap_by_g_code() && word.is_some();
        self.rigid.is_some() || (begins && block.has_any(Letters::of(b"S")))
    }

    /// Rigid mode, which a block may begin, or the spindle as it turns.
    pub(super) fn turning(
        &mut self,
        modal: &mut Modal<'_>,
        block: &Block,
        word: Option<&Word>,
        span: Span,
        kept: &Kept,
        plan: &mut Plan,
    ) -> Result<Turning, Alarm> {
        let rigid = |rpm: Rpm| Turning {
            mode: TapMode::Rigid,
            rpm,
            s: rpm.abs(),
        };
        let by_g_code = modal.params.tap_by_g_code();
        let written = block.find(b'S').filter(|_| by_g_code);
        match self.rigid {
            Some(rpm) if written.is_none() => Ok(rigid(rpm)),
            None if !self.is_rigid_block(modal, block, word) => {
                let rpm = modal.rpm();
                if by_g_code && rpm == Rpm::STOPPED {
                    // The programmer more likely meant rigid mode without S than forgot to start the spindle.
                    return tap_speed(modal, None, span).map(rigid);
                }
                Ok(Turning {
                    mode: TapMode::Floating,
                    rpm,
                    s: modal.speed,
                })
            }
            _ => {
                let rpm = tap_speed(modal, written, span)?;
                self.begin_position_mode(modal, rpm);
                // With the tap in its hole (K198) the spindle is in position mode and has to stay there.
                if self.locked.is_none() {
                    let span = written.map_or(span, |word| word.span);
                    let spindle = self.spindle_choice(modal, kept.spindle);
                    plan.rigid(span, SpindleCall::rigid(rpm, spindle));
                }
                Ok(rigid(rpm))
            }
        }
    }
}

/// S; in a dry run what the dry-run feed makes of the lead, never above the highest tapping speed. A spindle in speed
/// mode turns as it does: there the dry run changes nothing.
pub(super) fn infeed_speed(modal: &Modal<'_>, turning: &Turning, lead: Lead) -> CentiRpm {
    let rpm = i32::try_from(turning.rpm.abs()).unwrap_or(i32::MAX);
    let written = CentiRpm::of_rpm(Rpm::new(rpm));
    if !modal.options.dry_run || turning.mode == TapMode::Floating {
        return written;
    }
    let feed = modal.params.dry_run_feed().nm_per_min();
    let hundredths = feed
        .saturating_mul(100)
        .saturating_mul(lead.denominator())
        .checked_div(lead.numerator())
        .unwrap_or(0);
    let limit = i64::from(highest_tap_speed(modal)).saturating_mul(100);
    let speed = hundredths.min(limit).max(1);
    CentiRpm::new(i32::try_from(speed).unwrap_or(i32::MAX))
}

/// The speed of the way out, and what was asked for: the infeed's times the extraction override.
pub(super) fn extraction(modal: &Modal<'_>, call: &TapCall) -> (CentiRpm, CentiRpm) {
    if call.mode == TapMode::Floating {
        return (call.speed, call.speed);
    }
    let asked = call.notes.extraction.of(call.speed).get();
    let limit = i64::from(highest_tap_speed(modal)).saturating_mul(100);
    let limit = i32::try_from(limit).unwrap_or(i32::MAX);
    (CentiRpm::new(asked.min(limit)), CentiRpm::new(asked))
}

/// The extraction override by 5200.4, 5201.3, 5201.4, 5202.6, 5211 and J [D28]. An ordinary tap has none.
pub(super) fn extraction_override(
    modal: &Modal<'_>,
    j: Option<u32>,
    turning: &Turning,
) -> Extraction {
    if !modal.params.tap_extract_override() || turning.mode == TapMode::Floating {
        return Extraction::NONE;
    }
    let (part, whole) = match j {
        Some(j) if modal.params.tap_extract_by_j() => {
            let (s, most) = range_of_j(modal, turning);
            if (s..=most).contains(&j) {
                (j, s)
            } else {
                (1, 1)
            }
        }
        _ => {
            let unit = if modal.params.tap_extract_tens() {
                10
            } else {
                1
            };
            let percent = u32::from(modal.params.tap_extract_percent());
            (percent.saturating_mul(unit), 100)
        }
    };
    // 5211 = 0 means 100 %.
    Extraction::new(part, whole).unwrap_or_default()
}

/// What J may be: S to twice S, or with 5202.6 to twenty times S.
fn range_of_j(modal: &Modal<'_>, turning: &Turning) -> (u32, u32) {
    let s = turning.rpm.abs();
    let times = if modal.params.tap_extract_wide() {
        20
    } else {
        2
    };
    (s, s.saturating_mul(times))
}

/// Warns where a J that is written in rigid mode has no effect [D176].
pub(super) fn note_j(modal: &Modal<'_>, block: &Block, turning: &Turning, plan: &mut Plan) {
    let Some(word) = block.find(b'J') else {
        return;
    };
    if !modal.params.tap_extract_override() || !modal.params.tap_extract_by_j() {
        plan.warn(word.alarm(Code::TapExtractionOff));
        return;
    }
    let (low, high) = range_of_j(modal, turning);
    let j = word.value.mantissa();
    if j < i64::from(low) || j > i64::from(high) {
        let rpm = |rpm| Arg::Rpm(Rpm::new(i32::try_from(rpm).unwrap_or(i32::MAX)));
        plan.warn(
            word.alarm(Code::TapExtractionRange)
                .with([rpm(low), rpm(high)]),
        );
    }
}

pub(super) fn limited(modal: &Modal<'_>, block: &Block, span: Span, asked: CentiRpm) -> Alarm {
    let alarm = match block.find(b'J') {
        Some(word) => word.alarm(Code::TapExtractionLimited),
        None => Alarm::new(Code::TapExtractionLimited, span),
    };
    let asked = Rpm::new(asked.get() / 100);
    let limit = Arg::Int(i64::from(highest_tap_speed(modal)));
    alarm.with([Arg::Rpm(asked), limit])
}

/// K198 needs rigid mode; J does nothing outside it [D95].
pub(super) fn refuse_in_ordinary(
    modal: &Modal<'_>,
    block: &Block,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    if let Some(word) = block.find(b'K')
        && word.value.mantissa() == 198
    {
        let code = Arg::Int(i64::from(rigid_code(modal.params)));
        let args = [code, Arg::None, Arg::None, Arg::None];
        return Err(word.alarm(Code::TapStayNotRigid).with(args));
    }
    if let Some(word) = block.find(b'J') {
        plan.warn(word.alarm(Code::TapExtractionNotRigid));
    }
    Ok(())
}

/// F/S under G98, F under G99, as a ratio.
pub(super) fn tap_lead(
    modal: &Modal<'_>,
    kept: &Kept,
    turning: &Turning,
    span: Span,
) -> Result<At<Lead>, Alarm> {
    let Some(feed) = kept.feed else {
        return Err(Alarm::new(Code::TapFeed, span));
    };
    let lead = match feed.value {
        TapFeed::PerMinute(_) if turning.s == 0 => {
            let code = Arg::Int(i64::from(rigid_code(modal.params)));
            let args = [kept.name(), code, Arg::None, Arg::None];
            return Err(Alarm::new(Code::TapSpindleStands, span).with(args));
        }
        TapFeed::PerMinute(f) => Lead::new(f.nm_per_min(), i64::from(turning.s)),
        TapFeed::PerTurn(f) => Lead::new(f.nm(), 1),
    };
    match lead {
        Some(lead) => Ok(At::new(lead, feed.span)),
        None => Err(Alarm::new(Code::TapFeed, feed.span).word(b'F')),
    }
}
