//! Checks whether an axis can follow an encoder: of a slow spindle few counts tell too little, and whole counts shake an
//! axis on the lead where their edges are not timed.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::params::{Params, metres};
use crate::units::{Axis, Lead, Length, Rpm, mul_div, signed};

/// Checks a lead that `axis` must follow at `rpm`, which may not be below `slowest`. The cycle's G word stands at `span`.
///
/// # Errors
/// The noise exceeds the axis' acceleration ([`Code::LeadForEncoder`]); the spindle is so slow that the observer cannot
/// keep hold of it ([`Code::SpeedForEncoder`]).
pub(crate) fn can_follow(
    lead: At<Lead>,
    axis: Axis,
    rpm: Rpm,
    slowest: Rpm,
    span: Span,
    params: &Params,
) -> Result<(), Alarm> {
    let encoder = params.resolution();
    let rpm = Rpm::new(rpm.get().saturating_abs());
    // A spindle that stands is an alarm of its own.
    if rpm.get() != 0 && rpm.get() < slowest.get() {
        let counts = mul_div(u64::from(encoder.counts), u64::from(rpm.abs()), 60);
        let figures = [
            Arg::Rpm(rpm),
            Arg::Int(signed(counts)),
            Arg::Int(i64::from(slowest.get())),
        ];
        return Err(Alarm::new(Code::SpeedForEncoder, span)
            .word(b'S')
            .with(figures));
    }
    let limit = params.acceleration(axis);
    match params.count_noise(lead.value, axis) {
        Some(noise) if noise > limit => {
            let [much, most] = [noise, limit].map(|one| one.nm_per_s2().unsigned_abs());
            let written = lead.value.rounded();
            // In whole micrometres, rounded down.
            let longest = mul_div(written.nm().unsigned_abs(), most, much.saturating_mul(1000));
            let figures = [
                Arg::Length(written),
                metres(noise),
                metres(limit),
                Arg::Length(Length::from_nm(signed(longest.saturating_mul(1000)))),
            ];
            Err(Alarm::new(Code::LeadForEncoder, lead.span)
                .word(b'F')
                .with(figures))
        }
        _ => Ok(()),
    }
}
