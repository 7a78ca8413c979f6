//! Checks whether an axis can follow an encoder: of a slow spindle few counts tell too little, whole counts shake an
//! axis that taps where their edges are not timed, and they leave a thread beside its place.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::params::{Params, metres};
use crate::units::{Acceleration, Axis, Lead, Length, Rpm, mul_div, signed};

/// Checks the lead of an ordinary tap, which `axis` follows at `rpm`, forwards and backwards. The cycle's G word stands at
/// `span`.
///
/// # Errors
/// The spindle is so slow that the observer cannot keep hold of it ([`Code::SpeedForEncoder`]); the counts shake the axis
/// beyond its acceleration ([`Code::LeadForEncoder`]).
pub(crate) fn can_tap(
    lead: At<Lead>,
    axis: Axis,
    rpm: Rpm,
    span: Span,
    params: &Params,
) -> Result<(), Alarm> {
    let resolution = params.resolution();
    let noise = resolution
        .noise_of_few(lead.value)
        .or_else(|| params.count_noise(lead.value, axis));
    fast_enough(resolution.slowest_of_tap(), resolution.counts, rpm, span)?;
    quiet_enough(lead, axis, noise, params)
}

/// Checks that the encoder does not shake `axis` by more than the axis' acceleration.
fn quiet_enough(
    lead: At<Lead>,
    axis: Axis,
    noise: Option<Acceleration>,
    params: &Params,
) -> Result<(), Alarm> {
    let limit = params.motion_acceleration(axis);
    match noise {
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

/// A pass as its encoder sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnLead {
    /// The largest lead.
    pub lead: At<Lead>,
    /// The long axis, which follows the spindle.
    pub long: Axis,
    /// The short axis, and its steepest way beside the long one: rise and run.
    pub short: Axis,
    pub steepest: [Length; 2],
    pub rpm: Rpm,
}

/// Checks the lead of a pass. The cycle's G word stands at `span`.
///
/// # Errors
/// The counts of the encoder come too seldom ([`Code::SpeedForEncoder`]), or leave too large an error along the lead where
/// the angle is learned ([`Code::EncoderUncertain`]); else as [`can_tap`].
pub(crate) fn can_thread(pass: &OnLead, span: Span, params: &Params) -> Result<(), Alarm> {
    let &OnLead { lead, rpm, .. } = pass;
    let encoder = params.resolution();
    fast_enough(encoder.slowest_of_thread(), encoder.counts, rpm, span)?;
    if !encoder.is_learned() {
        let noise = |axis| params.count_noise(lead.value, axis);
        quiet_enough(lead, pass.long, noise(pass.long), params)?;
        // In a run-out it follows the long one at a slope.
        let [rise, run] = pass.steepest.map(|part| part.nm().unsigned_abs());
        let beside = noise(pass.short).map(|noise| {
            let along = noise.nm_per_s2().unsigned_abs();
            Acceleration::from_nm_per_s2(signed(mul_div(along, rise, run.max(1))))
        });
        return quiet_enough(lead, pass.short, beside, params);
    }
    let most = params.encoder_error();
    match encoder.uncertainty(lead.value, rpm) {
        Some(error) if error > most => {
            let figures = [
                Arg::Length(lead.value.rounded()),
                Arg::Length(error),
                Arg::Length(most),
                Arg::Rpm(Rpm::new(rpm.get().saturating_abs())),
            ];
            Err(Alarm::new(Code::EncoderUncertain, lead.span)
                .word(b'F')
                .with(figures))
        }
        _ => Ok(()),
    }
}

/// Checks that a spindle is not slower than `slowest`. One that stands is an alarm of its own.
fn fast_enough(slowest: Rpm, counts: u32, rpm: Rpm, span: Span) -> Result<(), Alarm> {
    let rpm = Rpm::new(rpm.get().saturating_abs());
    if rpm.get() == 0 || rpm.get() >= slowest.get() {
        return Ok(());
    }
    let counts = mul_div(u64::from(counts), u64::from(rpm.abs()), 60);
    let figures = [
        Arg::Rpm(rpm),
        Arg::Int(signed(counts)),
        Arg::Int(i64::from(slowest.get())),
    ];
    Err(Alarm::new(Code::SpeedForEncoder, span)
        .word(b'S')
        .with(figures))
}
