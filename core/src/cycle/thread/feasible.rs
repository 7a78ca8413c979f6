//! G76 and G78 and the machine's limits: spindle, feeds, lead-in, run-out.

use super::moves::{ThreadMoves, ThreadSummary};
use super::settle;
use super::shape::long_way;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{ChainPart, ThreadCall};
use crate::feasible::{Gather, OnLead, Pass, can_thread};
use crate::motion::{Chain, ThreadPlan};
use crate::moves::{Move, MoveKind};
use crate::params::Params;
use crate::units::{
    Axis, Feed, Lead, LeadChange, Length, Rpm, TurnRate, Turns, mul_div, signed, signed_product,
};

/// The largest number of different warnings, or of different alarms, of one thread cycle.
pub const FINDINGS: usize = 6;

/// The needs of a thread cycle at its commanded speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadReport {
    /// Number of passes, rough and finishing; each start of a multiple thread makes all of them.
    pub passes: u32,
    /// Largest shift of a pass's start point along Z.
    pub z_shift_max: Length,
    /// Distance along the long axis from a pass's start to where the axis is on the lead: jerk included, and the drive,
    /// where the lag of one is taken off (9070).
    pub lead_in: Length,
    /// The start must lie at least this far before the material: the lead-in, plus the shift if Z is the long axis.
    pub start_before: Length,
    /// How far the thread may be beside its place by what the encoder cannot tell; `None` where that is nothing.
    pub uncertainty: Option<Length>,
    /// Where the lead changes: turns of the stroke in millionths, and the lead at its end.
    pub variable: Option<(i64, Length)>,
    /// Warnings, for what may leave a mark on the work but stops nothing: long lead-in, falling lead, run-out that
    /// lags, parameters 107 and 5129.
    pub warnings: [Option<Alarm>; FINDINGS],
}

impl ThreadReport {
    /// True if the warnings contain the one about the lead-in (`check --strict`).
    #[must_use]
    pub fn lead_in_is_long(&self) -> bool {
        self.warnings
            .iter()
            .flatten()
            .any(|warning| warning.code == Code::LeadInLong)
    }
}

/// All errors of a thread cycle, not only the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadFindings {
    /// In order of importance; empty if the cycle can run.
    pub alarms: [Option<Alarm>; FINDINGS],
    /// The report, if the cycle can run.
    pub report: Option<ThreadReport>,
}

/// Checks a thread cycle. Its G word stands at `span`.
///
/// # Errors
/// - The geometry forbids the cycle: see [`ThreadMoves::new`].
/// - The spindle stands ([`Code::SpindleStopped`]), or the speed exceeds the spindle's highest speed
///   ([`Code::SpeedAboveSpindle`]).
/// - The pitch is longer than the shortest stroke: [`Code::PitchTooLong`].
/// - Lead times speed exceeds the long axis' feed: [`Code::LeadTooFast`].
/// - The encoder is too coarse for lead or speed: [`Code::EncoderUncertain`], [`Code::SpeedForEncoder`],
///   [`Code::LeadForEncoder`].
/// - The run-out exceeds the short axis' feed: [`Code::RunOutTooFast`].
/// - There is no room for joining, run-in or braking: [`Code::StrokeTooShortForSpeed`], [`Code::RunInTooFast`].
pub fn thread_report(
    call: &ThreadCall,
    span: Span,
    params: &Params,
) -> Result<ThreadReport, Alarm> {
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

/// The first error that [`thread_findings`] would find for a call at the speed `rpm`. It needs little memory, so a
/// board can use it.
///
/// # Errors
/// As [`thread_report`].
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

/// Plans the passes that demand most of the machine. Passes each plan to `seen` and each error to `wrong`.
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
    if speed != 0
        && let Err(alarm) = &can_thread(&on_lead(call, &summary, rpm), span, params)
    {
        wrong(alarm);
    }
    // A stroke of a chain may be shorter than a turn, and what it asks for depends on the strokes beside it.
    let is_whole = call.part == ChainPart::Whole;
    if is_whole && let Some(alarm) = &pitch(call, summary.shortest_stroke) {
        wrong(alarm);
    }
    if speed != 0 && is_whole {
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

/// Like [`thread_report`], but goes on after the first error.
///
/// # Errors
/// The geometry forbids the cycle: without moves there is nothing to check.
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
        &mut |plan| figures.take(plan, call, params),
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
    // A stroke that ends where it stops has no run-out that could be longer.
    if figures.falling > Length::ZERO && !call.cycle.is_stroke() {
        warnings.push(warn(
            Code::FallingLead,
            span,
            Arg::Length(figures.falling),
            Arg::Length(figures.braking),
            Arg::None,
        ));
    }
    if figures.lag > Length::ZERO {
        warnings.push(run_out_lags(call, span, figures.lag, figures.needed));
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
            uncertainty: params
                .resolution()
                .uncertainty(largest(call).value, call.rpm),
            variable: figures
                .turns
                .map(|turns| (turns.micro(), last(call).rounded())),
            warnings: warnings.0,
        }),
    })
}

/// What the strokes of a whole chain need at their commanded speed, which is that of the first.
///
/// # Errors
/// The first alarm, at the block that it is about: a stroke that geometry forbids ([`ThreadMoves::new`]), or what a plan
/// refuses ([`Chain::examine`]).
pub fn chain_report(
    strokes: &[(ThreadCall, Span)],
    params: &Params,
) -> Result<ThreadReport, Alarm> {
    let mut chain = gather(strokes)?;
    can_cut_chain(&mut chain, strokes, params, None)?;
    let first = chain.plan(0, params, None, TurnRate::ZERO)?;
    let last = chain.plan(chain.len().saturating_sub(1), params, None, TurnRate::ZERO)?;
    let mut warnings = List::default();
    let lag = last.run_out_lag().abs();
    if lag > Length::ZERO
        && let Some((call, span)) = strokes.last()
    {
        warnings.push(run_out_lags(call, *span, lag, last.run_out_needed()));
    }
    let lead_in = strokes.first().map_or(first.lead_in(), |(call, _)| {
        settle::lead_in(&first, params, call.lead.value, call.rpm)
    });
    Ok(ThreadReport {
        passes: 1,
        z_shift_max: Length::ZERO,
        lead_in,
        start_before: lead_in,
        uncertainty: strokes
            .iter()
            .filter_map(|(call, _)| {
                let rpm = strokes.first()?.0.rpm;
                params.resolution().uncertainty(call.lead.value, rpm)
            })
            .max(),
        variable: None,
        warnings: warnings.0,
    })
}

/// As [`rpm_max`], for the strokes of a whole chain.
///
/// # Errors
/// A stroke that geometry forbids.
pub fn chain_rpm_max(strokes: &[(ThreadCall, Span)], params: &Params) -> Result<Rpm, Alarm> {
    let mut chain = gather(strokes)?;
    Ok(largest_speed(params, |rpm| {
        can_cut_chain(&mut chain, strokes, params, Some(rpm)).is_ok()
    }))
}

/// The strokes as one chain.
fn gather(strokes: &[(ThreadCall, Span)]) -> Result<Chain, Alarm> {
    let mut chain = Chain::new();
    let mut number = 0_u32;
    for (call, span) in strokes {
        let mut at = call.start;
        for next in ThreadMoves::new(call, *span)? {
            number = number.saturating_add(1);
            chain.push(at, &next, number)?;
            at = next.to;
        }
    }
    Ok(chain)
}

fn can_cut_chain(
    chain: &mut Chain,
    strokes: &[(ThreadCall, Span)],
    params: &Params,
    rpm: Option<Rpm>,
) -> Result<(), Alarm> {
    for (index, (call, _)) in strokes.iter().enumerate() {
        if let Err(mut alarm) = chain.examine(index, params, rpm, TurnRate::ZERO) {
            to_word(call, &mut alarm);
            return Err(alarm);
        }
    }
    Ok(())
}

/// The largest whole spindle speed at which the cycle can run, up to the spindle's highest speed; [`Rpm::STOPPED`] if
/// no speed works. It plans a few dozen passes, so it is for reports only.
///
/// # Errors
/// The geometry forbids the cycle.
pub fn rpm_max(call: &ThreadCall, span: Span, params: &Params) -> Result<Rpm, Alarm> {
    let summary = ThreadMoves::survey(call, span)?;
    let passes = extremes(&summary).map(|number| pass(call, span, number));
    let can = |rpm: Rpm| {
        passes
            .iter()
            .all(|pass| plan(call, pass, params, rpm).is_ok())
    };
    Ok(largest_speed(params, can))
}

/// The largest speed up to the spindle's at which something `can` run.
fn largest_speed(params: &Params, mut can: impl FnMut(Rpm) -> bool) -> Rpm {
    // Most threads can: one plan instead of a dozen, each of which is dear where its run-out lags.
    let most = i32::try_from(params.spindle_max_rpm()).unwrap_or(i32::MAX);
    if can(Rpm::new(most)) {
        return Rpm::new(most);
    }
    // Invariant: the cycle can run at `low` (or `low` is 0), and it cannot run at `high`.
    let mut low = 0_i32;
    let mut high = most;
    while high.saturating_sub(low) > 1 {
        let middle = low.midpoint(high);
        if can(Rpm::new(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Rpm::new(low)
}

/// Plans a pass, and checks its run-out's speed.
#[inline(never)]
fn plan(call: &ThreadCall, pass: &Pass, params: &Params, rpm: Rpm) -> Result<ThreadPlan, Alarm> {
    // A plan is large, so it stays where it is written.
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

/// The warning for a run-out that is `lag` short of J at the end of K, and the K that it would need.
fn run_out_lags(call: &ThreadCall, span: Span, lag: Length, needed: Length) -> Alarm {
    let at = call.run_out.map_or(span, |run_out| run_out.long.span);
    let at = if at == Span::default() { span } else { at };
    Alarm::new(Code::RunOutLags, at).with([Arg::Length(lag), Arg::Length(needed)])
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

/// The lead at the end of a stroke. Anywhere else it is that of the whole thread.
fn last(call: &ThreadCall) -> Lead {
    let last = call.change.value.after(call.lead.value, long_way(call));
    last.unwrap_or(call.lead.value)
}

/// The largest lead of a thread.
fn largest(call: &ThreadCall) -> At<Lead> {
    let span = call.lead.span;
    if call.change.value > LeadChange::NONE {
        At::new(last(call), span)
    } else {
        call.lead
    }
}

/// The passes of a call as their encoder sees them.
fn on_lead(call: &ThreadCall, summary: &ThreadSummary, rpm: Rpm) -> OnLead {
    // A stroke goes from where it begins to its end; a cycle's line is as long as Z, and as wide as its taper.
    let x = if call.cycle.is_stroke() {
        call.end_x.value - call.start.x
    } else {
        call.taper.value
    };
    let z = call.end_z.value - call.start.z;
    let (long, short, line) = if summary.long_x {
        (Axis::X, Axis::Z, [z, x])
    } else {
        (Axis::Z, Axis::X, [x, z])
    };
    // A run-in is at 45°.
    let equal = Length::from_nm(1);
    let run_in = (call.run_in.value > Length::ZERO).then_some([equal, equal]);
    let run_out = call.run_out.map(|out| [out.short.value, out.long.value]);
    let steeper = |one: [Length; 2], other: [Length; 2]| {
        let [[a, b], [c, d]] = [one, other].map(|slope| slope.map(|part| part.nm().unsigned_abs()));
        let product = |one: u64, other: u64| u128::from(one).saturating_mul(other.into());
        if product(c, b) > product(a, d) {
            other
        } else {
            one
        }
    };
    OnLead {
        lead: largest(call),
        long,
        short,
        steepest: [run_in, run_out].into_iter().flatten().fold(line, steeper),
        rpm,
    }
}

/// S as written, without the direction.
const fn positive(rpm: Rpm) -> Rpm {
    Rpm::new(rpm.get().saturating_abs())
}

/// Moves the planner's alarm to the program word that has to change.
fn to_word(call: &ThreadCall, alarm: &mut Alarm) {
    let span = match alarm.code {
        Code::LeadTooFast => call.lead.span,
        Code::LeadChangeTooFast => call.change.span,
        Code::RunInTooFast => call.run_in.span,
        Code::StrokeTooShortForSpeed | Code::StrokeTooShortInChain if alarm.word == Some(b'X') => {
            call.end_x.span
        }
        Code::StrokeTooShortForSpeed | Code::StrokeTooShortInChain => call.end_z.span,
        _ => Span::default(),
    };
    if span != Span::default() {
        alarm.span = span;
    }
}

/// A pitch (lead over starts) longer than the shortest stroke: the programmer wrote a feed rate by mistake.
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

/// Numbers of the passes that demand most of the machine: the last (largest J), the pass with the shortest stroke, and
/// the first (shortest run-in, smallest J). All passes share slope, K and lead; J and run-in grow with depth.
const fn extremes(summary: &ThreadSummary) -> [u32; 3] {
    [summary.passes.saturating_sub(1), summary.shortest, 0]
}

/// Pass number `number` of a cycle with valid geometry. A pass is large, so it is made again each time.
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

/// The largest figures over all passes.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    /// Half of the last join, its rise, and the taper.
    join: Option<(Length, Length, i64)>,
    lead_in: Length,
    braking: Length,
    falling: Length,
    lag: Length,
    needed: Length,
    turns: Option<Turns>,
}

impl Figures {
    fn take(&mut self, plan: &ThreadPlan, call: &ThreadCall, params: &Params) {
        // Most passes join alike, and stepping a drive is dear.
        let join = Some((plan.lead_in(), plan.join_rise(), plan.taper()));
        if self.join != join {
            let lead_in = settle::lead_in(plan, params, call.lead.value, call.rpm);
            (self.lead_in, self.join) = (self.lead_in.max(lead_in), join);
        }
        self.braking = self.braking.max(plan.braking());
        self.falling = self.falling.max(plan.falling_lead());
        self.lag = self.lag.max(plan.run_out_lag().abs());
        self.needed = self.needed.max(plan.run_out_needed());
        self.turns = plan.variable_turns();
    }
}

/// A list of at most [`FINDINGS`] alarms. There are no more different alarms than this.
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
