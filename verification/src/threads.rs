//! Threads: what a cycle needs, and what a chain of strokes needs as the one thread that it is.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{ChainPart, ThreadCall, ThreadCycle};
use leadscrew_core::cycle::{self, ThreadReport};
use leadscrew_core::units::{Length, Rpm};

use crate::figures::{CycleFigures, ThreadFigures};
use crate::verifier::{Findings, Verifier};

impl Verifier<'_> {
    /// A thread, or a stroke of a chain.
    pub(crate) fn thread(
        &mut self,
        call: &ThreadCall,
        span: Span,
        time_us: i64,
        to: &mut dyn Findings,
    ) {
        let params = self.machine.params;
        let findings = match cycle::thread_findings(call, span, params) {
            Ok(findings) => findings,
            Err(alarm) => return to.tell(&alarm),
        };
        for alarm in findings.alarms.iter().flatten() {
            to.tell(alarm);
        }
        if call.part != ChainPart::Whole {
            return self.chain(call, span, time_us, to);
        }
        let Some(report) = findings.report else {
            return;
        };
        let rpm_max = if to.wants_figures() {
            cycle::rpm_max(call, span, params)
        } else {
            Ok(Rpm::STOPPED)
        };
        keep(call, span, &report, rpm_max, time_us, to);
    }

    /// A stroke of a chain: with the last one the chain is looked at as the one thread that it is.
    fn chain(&mut self, call: &ThreadCall, span: Span, time_us: i64, to: &mut dyn Findings) {
        if !call.part.is_joined() {
            (self.chain, self.chain_us) = (Vec::new(), 0);
        }
        self.chain.push((*call, span));
        self.chain_us += time_us;
        if call.part.goes_on() || self.chain.iter().any(|(one, _)| one.rpm == Rpm::STOPPED) {
            return;
        }
        let chain = std::mem::take(&mut self.chain);
        let params = self.machine.params;
        let report = match cycle::chain_report(&chain, params) {
            Ok(report) => report,
            Err(alarm) => return to.tell(&alarm),
        };
        let rpm_max = if to.wants_figures() {
            cycle::chain_rpm_max(&chain, params)
        } else {
            Ok(Rpm::STOPPED)
        };
        let (first, span) = &chain[0];
        keep(first, *span, &report, rpm_max, self.chain_us, to);
    }

    /// A thread may be refused by its geometry for another reason: a feed rate in place of the lead makes a run-out that is
    /// longer than the thread. Physics can still be checked without run-in and run-out.
    pub(crate) fn causes(&self, thread: &ThreadCall, span: Span, to: &mut dyn Findings) {
        let mut bare = *thread;
        bare.run_in.value = Length::ZERO;
        bare.run_out = None;
        if let Ok(findings) = cycle::thread_findings(&bare, span, self.machine.params) {
            for alarm in findings.alarms.iter().flatten() {
                to.tell(alarm);
            }
        }
    }
}

/// Tells what a thread needs.
fn keep(
    call: &ThreadCall,
    span: Span,
    report: &ThreadReport,
    rpm_max: Result<Rpm, Alarm>,
    time_us: i64,
    to: &mut dyn Findings,
) {
    for warning in report.warnings.iter().flatten() {
        to.tell(warning);
    }
    to.cycle(CycleFigures {
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
