//! G76 and G78 against the machine: spindle, feeds, lead-in, run-out.

use super::encoder::can_follow;
use super::pass::{Gather, Pass};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::cycle::{Move, MoveKind, ThreadMoves, ThreadSummary};
use crate::motion::ThreadPlan;
use crate::params::Params;
use crate::program::ThreadCall;
use crate::units::{Axis, Feed, Length, Rpm, mul_div, signed, signed_product};

/// Different warnings, or different alarms, that one thread cycle can have.
pub const FINDINGS: usize = 6;

/// What a thread cycle needs at its commanded speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadReport {
    /// Passes, rough and finishing; each start of a multiple thread makes all of them.
    pub passes: u32,
    /// Largest shift of a pass's start along Z.
    pub z_shift_max: Length,
    /// From a pass's start to where the axis is on the lead, jerk included; along the long axis.
    pub lead_in: Length,
    /// Start at least this far before the material: lead-in, and the shift where Z is the long axis.
    pub start_before: Length,
    /// What leaves a mark and stops nothing: long lead-in, falling lead, run-out that lags, parameters 107 and 5129.
    pub warnings: [Option<Alarm>; FINDINGS],
}

impl ThreadReport {
    /// True where the warning about the lead-in is among the warnings (`check --strict`).
    #[must_use]
    pub fn lead_in_is_long(&self) -> bool {
        self.warnings
            .iter()
            .flatten()
            .any(|warning| warning.code == Code::LeadInLong)
    }
}

/// Everything that is wrong with a thread cycle, not only the first thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadFindings {
    /// In the order of importance; empty if the cycle can run.
    pub alarms: [Option<Alarm>; FINDINGS],
    /// The report, where the cycle can run.
    pub report: Option<ThreadReport>,
}

/// Checks a thread cycle whose G word stands at `span`.
///
/// # Errors
/// What geometry forbids (see [`ThreadMoves::new`]); a standing spindle ([`Code::SpindleStopped`]), more speed than it
/// has ([`Code::SpeedAboveSpindle`]), a pitch longer than the shortest stroke ([`Code::PitchTooLong`]), lead times speed
/// above the long axis' feed ([`Code::LeadTooFast`]), an encoder too coarse for lead or speed
/// ([`Code::LeadForEncoder`], [`Code::SpeedForEncoder`]), a run-out above the short axis' ([`Code::RunOutTooFast`]), and no
/// room for joining, run-in or braking ([`Code::StrokeTooShortForSpeed`], [`Code::RunInTooFast`]).
pub fn thread(call: &ThreadCall, span: Span, params: &Params) -> Result<ThreadReport, Alarm> {
    let findings = thread_findings(call, span, params)?;
    match (
        findings.alarms.into_iter().flatten().next(),
        findings.report,
    ) {
        (Some(alarm), _) => Err(alarm),
        (None, Some(report)) => Ok(report),
        (None, None) => Err(Alarm::new(Code::ThreadMovesMixed, span)),
    }
}

/// The first of what [`thread_findings`] finds of a call at a speed of its own, in little memory: what a board asks.
///
/// # Errors
/// As [`thread`].
pub fn thread_can_run(
    call: &ThreadCall,
    rpm: Rpm,
    span: Span,
    params: &Params,
) -> Result<(), Alarm> {
    let mut first = Ok(());
    let mut wrong = |alarm: &Alarm| {
        if first.is_ok() {
            first = Err(*alarm);
        }
    };
    examine(call, rpm, span, params, &mut wrong, &mut |_| {})?;
    first
}

/// Plans the passes that ask most of the machine, shows the plans, and says everything that is wrong.
fn examine(
    call: &ThreadCall,
    rpm: Rpm,
    span: Span,
    params: &Params,
    wrong: &mut dyn FnMut(&Alarm),
    seen: &mut impl FnMut(&ThreadPlan),
) -> Result<ThreadSummary, Alarm> {
    let summary = ThreadMoves::survey(call, span)?;
    let speed = rpm.abs();
    if speed == 0 {
        wrong(&Alarm::new(Code::SpindleStopped, span));
    } else if speed > params.spindle_max_rpm() {
        let most = i32::try_from(params.spindle_max_rpm()).unwrap_or(i32::MAX);
        let args = [Arg::Rpm(positive(rpm)), Arg::Rpm(Rpm::new(most))];
        wrong(&Alarm::new(Code::SpeedAboveSpindle, span).with(args));
    }
    let long = if summary.long_x { Axis::X } else { Axis::Z };
    if speed != 0
        && let Err(alarm) = &can_follow(call.lead, long, rpm, span, params)
    {
        wrong(alarm);
    }
    if let Some(alarm) = &pitch(call, summary.shortest_stroke) {
        wrong(alarm);
    }
    if speed != 0 {
        for number in extremes(&summary) {
            match &plan(call, &pass(call, span, number), params, rpm) {
                Ok(plan) => seen(plan),
                Err(alarm) => {
                    wrong(alarm);
                    break;
                }
            }
        }
    }
    Ok(summary)
}

/// As [`thread`], but goes on after the first thing that is wrong.
///
/// # Errors
/// What geometry forbids: without moves there is nothing to check.
pub fn thread_findings(
    call: &ThreadCall,
    span: Span,
    params: &Params,
) -> Result<ThreadFindings, Alarm> {
    let mut alarms = List::default();
    let mut figures = Figures::default();
    let summary = examine(
        call,
        call.rpm,
        span,
        params,
        &mut |alarm| alarms.push(*alarm),
        &mut |plan| figures.take(plan),
    )?;
    if alarms.first().is_some() {
        return Ok(ThreadFindings {
            alarms: alarms.0,
            report: None,
        });
    }

    let before = if summary.long_x {
        figures.lead_in
    } else {
        figures.lead_in + summary.z_shift_max
    };
    let mut warnings = List::default();
    let length = if summary.long_x {
        call.end_x.value - call.start.x
    } else {
        call.end_z.value - call.start.z
    };
    let warn = |code, span, a, b, c| Alarm::new(code, span).with([a, b, c]);
    if before.times(4) > length.abs() {
        warnings.push(warn(
            Code::LeadInLong,
            span,
            Arg::Length(before),
            Arg::Length(figures.lead_in),
            Arg::Length(before - figures.lead_in),
        ));
    }
    if figures.falling > Length::ZERO {
        warnings.push(warn(
            Code::FallingLead,
            span,
            Arg::Length(figures.falling),
            Arg::Length(figures.braking),
            Arg::None,
        ));
    }
    if figures.lag > Length::ZERO {
        let at = call.run_out.map_or(span, |run_out| run_out.long.span);
        let at = if at == Span::default() { span } else { at };
        warnings.push(warn(
            Code::RunOutLags,
            at,
            Arg::Length(figures.lag),
            Arg::Length(figures.needed),
            Arg::None,
        ));
    }
    if params.thread_high_speed() {
        warnings.push(warn(
            Code::HighSpeedNotBuilt,
            span,
            Arg::None,
            Arg::None,
            Arg::None,
        ));
    }
    if params.runout_speed() != Feed::default() && call.run_out.is_some() {
        let set = Arg::Feed(params.runout_speed());
        warnings.push(warn(
            Code::RunOutSpeedIgnored,
            span,
            set,
            Arg::None,
            Arg::None,
        ));
    }
    Ok(ThreadFindings {
        alarms: [None; FINDINGS],
        report: Some(ThreadReport {
            passes: summary.passes,
            z_shift_max: summary.z_shift_max,
            lead_in: figures.lead_in,
            start_before: before,
            warnings: warnings.0,
        }),
    })
}

/// The largest whole spindle speed at which the cycle can run, up to the spindle's own; [`Rpm::STOPPED`] if there is
/// none. Plans a few dozen passes: for reports.
///
/// # Errors
/// What geometry forbids.
pub fn rpm_max(call: &ThreadCall, span: Span, params: &Params) -> Result<Rpm, Alarm> {
    let summary = ThreadMoves::survey(call, span)?;
    let passes = extremes(&summary).map(|number| pass(call, span, number));
    let can = |speed: i32| {
        let rpm = Rpm::new(speed);
        passes
            .iter()
            .all(|pass| plan(call, pass, params, rpm).is_ok())
    };
    // Invariant: `low` can (or is 0), `high` is one more than may be tried, or cannot.
    let most = i32::try_from(params.spindle_max_rpm()).unwrap_or(i32::MAX);
    let mut low = 0_i32;
    let mut high = most.saturating_add(1);
    while high.saturating_sub(low) > 1 {
        let middle = low.midpoint(high);
        if can(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Rpm::new(low))
}

/// Plans a pass, and checks its run-out's speed.
#[inline(never)]
fn plan(call: &ThreadCall, pass: &Pass, params: &Params, rpm: Rpm) -> Result<ThreadPlan, Alarm> {
    // A plan is large, and stays where it is written.
    let mut plan = ThreadPlan::for_rpm(pass.from, &pass.moves, params, rpm);
    match &mut plan {
        Err(alarm) => to_word(call, alarm),
        Ok(_) => {
            if let Some(alarm) = run_out_too_fast(call, pass, params, rpm) {
                plan = Err(alarm);
            }
        }
    }
    plan
}

/// The alarm for a run-out above the short axis' feed.
#[inline(never)]
fn run_out_too_fast(call: &ThreadCall, pass: &Pass, params: &Params, rpm: Rpm) -> Option<Alarm> {
    let ([.., Move { to: from, .. }, last], Some(run_out)) = (&*pass.moves, &call.run_out) else {
        return None;
    };
    let MoveKind::Thread(thread) = &last.kind else {
        return None;
    };
    let (dx, dz) = ((last.to.x - from.x).abs(), (last.to.z - from.z).abs());
    let (short_axis, short, long) = if thread.long_x {
        (Axis::Z, dz, dx)
    } else {
        (Axis::X, dx, dz)
    };
    if long == Length::ZERO {
        return None;
    }
    let (nm, turns) = thread.lead.parts();
    let lead_speed = mul_div(nm, u64::from(rpm.abs()), turns);
    let speed = mul_div(
        lead_speed,
        short.nm().unsigned_abs(),
        long.nm().unsigned_abs(),
    );
    let speed = Feed::from_nm_per_min(signed(speed));
    let most = params.max_feed(short_axis);
    if speed <= most {
        return None;
    }
    let span = run_out.short.span;
    let span = if span == Span::default() {
        last.span
    } else {
        span
    };
    let args = [
        Arg::Letter(short_axis.letter()),
        Arg::Feed(speed),
        Arg::Feed(most),
        Arg::Rpm(positive(rpm)),
    ];
    Some(Alarm::new(Code::RunOutTooFast, span).word(b'J').with(args))
}

/// S as it is written: without the direction.
const fn positive(rpm: Rpm) -> Rpm {
    Rpm::new(rpm.get().saturating_abs())
}

/// Puts the planner's alarm at the word that has to change, where it is written.
fn to_word(call: &ThreadCall, alarm: &mut Alarm) {
    let span = match alarm.code {
        Code::LeadTooFast => call.lead.span,
        Code::RunInTooFast => call.run_in.span,
        Code::StrokeTooShortForSpeed if alarm.word == Some(b'X') => call.end_x.span,
        Code::StrokeTooShortForSpeed => call.end_z.span,
        _ => Span::default(),
    };
    if span != Span::default() {
        alarm.span = span;
    }
}

/// A pitch (lead over starts) longer than the shortest stroke is a feed rate by mistake.
fn pitch(call: &ThreadCall, stroke: Length) -> Option<Alarm> {
    let lead = call.lead.value;
    let starts = i64::from(call.starts.value.max(1));
    let room = signed_product(stroke.nm(), lead.denominator()).wrapping_mul(i128::from(starts));
    if i128::from(lead.numerator()) <= room {
        return None;
    }
    let pitch = lead.rounded().nm().checked_div(starts).unwrap_or(0);
    let args = [Arg::Length(Length::from_nm(pitch)), Arg::Length(stroke)];
    Some(
        Alarm::new(Code::PitchTooLong, call.lead.span)
            .word(b'F')
            .with(args),
    )
}

/// The passes that ask most of the machine, by their numbers: the last (largest J), the one with the shortest stroke, and
/// the first (shortest run-in, smallest J). All passes share slope, K and lead, and J and run-in grow with depth.
const fn extremes(summary: &ThreadSummary) -> [u32; 3] {
    [summary.passes.saturating_sub(1), summary.shortest, 0]
}

/// Pass `number` of a cycle that can be. Made anew when it is wanted: a pass is large.
#[inline(never)]
fn pass(call: &ThreadCall, span: Span, number: u32) -> Pass {
    let mut moves = ThreadMoves::of(call, span);
    moves.leave_out(number);
    let mut gather = Gather::new();
    let mut at = call.start;
    while let Some(next) = moves.advance() {
        if gather.take(at, next).is_some() {
            break;
        }
        at = next.to;
    }
    gather.pass()
}

/// The worst figures over the passes.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    lead_in: Length,
    braking: Length,
    falling: Length,
    lag: Length,
    needed: Length,
}

impl Figures {
    fn take(&mut self, plan: &ThreadPlan) {
        self.lead_in = self.lead_in.max(plan.lead_in());
        self.braking = self.braking.max(plan.braking());
        self.falling = self.falling.max(plan.falling_lead());
        self.lag = self.lag.max(plan.run_out_lag().abs());
        self.needed = self.needed.max(plan.run_out_needed());
    }
}

/// A list of at most [`FINDINGS`]: as many as there are different ones.
#[derive(Clone, Copy, Debug, Default)]
struct List([Option<Alarm>; FINDINGS]);

impl List {
    fn push(&mut self, alarm: Alarm) {
        if let Some(place) = self.0.iter_mut().find(|place| place.is_none()) {
            *place = Some(alarm);
        }
    }

    fn first(&self) -> Option<Alarm> {
        self.0.into_iter().flatten().next()
    }
}
