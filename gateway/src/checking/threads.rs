//! Threads in a check: what a cycle needs, and what a chain of strokes needs as the one thread that it is.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{ChainPart, ThreadCall, ThreadCycle};
use leadscrew_core::cycle::{self, ThreadReport};
use leadscrew_core::units::Rpm;

use super::{Checker, CycleReport, ThreadFigures};

impl Checker<'_> {
    /// A thread, or a stroke of a chain.
    pub(super) fn thread(&mut self, call: &ThreadCall, span: Span, time_us: i64, inch: bool) {
        let params = &self.setup.params;
        let findings = match cycle::thread_findings(call, span, params) {
            Ok(findings) => findings,
            Err(alarm) => return self.tell(&alarm, inch),
        };
        for alarm in findings.alarms.iter().flatten() {
            self.tell(alarm, inch);
        }
        if call.part != ChainPart::Whole {
            return self.chain(call, span, time_us, inch);
        }
        let Some(report) = findings.report else {
            return;
        };
        let rpm_max = if self.lists_cycles() {
            cycle::rpm_max(call, span, params)
        } else {
            Ok(Rpm::STOPPED)
        };
        self.keep_thread(call, span, &report, rpm_max, time_us, inch);
    }

    /// A stroke of a chain: with the last one the chain is looked at as the one thread that it is.
    fn chain(&mut self, call: &ThreadCall, span: Span, time_us: i64, inch: bool) {
        if !call.part.is_joined() {
            (self.chain, self.chain_us) = (Vec::new(), 0);
        }
        self.chain.push((*call, span));
        self.chain_us += time_us;
        if call.part.goes_on() || self.chain.iter().any(|(one, _)| one.rpm == Rpm::STOPPED) {
            return;
        }
        let chain = std::mem::take(&mut self.chain);
        let params = &self.setup.params;
        let report = match cycle::chain_report(&chain, params) {
            Ok(report) => report,
            Err(alarm) => return self.tell(&alarm, inch),
        };
        let rpm_max = if self.lists_cycles() {
            cycle::chain_rpm_max(&chain, params)
        } else {
            Ok(Rpm::STOPPED)
        };
        let (first, span) = &chain[0];
        self.keep_thread(first, *span, &report, rpm_max, self.chain_us, inch);
    }

    /// Keeps what a thread needs.
    fn keep_thread(
        &mut self,
        call: &ThreadCall,
        span: Span,
        report: &ThreadReport,
        rpm_max: Result<Rpm, Alarm>,
        time_us: i64,
        inch: bool,
    ) {
        for warning in report.warnings.iter().flatten() {
            self.tell(warning, inch);
        }
        self.keep(CycleReport {
            line: span.line,
            cycle: match call.cycle {
                ThreadCycle::G76 => "G76",
                ThreadCycle::G78 => "G78",
                ThreadCycle::G92 => "G92",
                ThreadCycle::G32 => "G32",
                ThreadCycle::G34 => "G34",
            },
            passes: report.passes,
            tap_speed: None,
            tap_lead_in_nm: None,
            thread: Some(ThreadFigures {
                z_shift_max_nm: report.z_shift_max.nm(),
                lead_in_nm: report.lead_in.nm(),
                start_before_nm: report.start_before.nm(),
                rpm_max: rpm_max.map_or(0, |rpm| i64::from(rpm.get())),
                encoder_error_nm: report.uncertainty.map(|error| error.nm()),
                variable: report.variable.map(|(turns, lead)| (turns, lead.nm())),
            }),
            time_us,
        });
    }
}
