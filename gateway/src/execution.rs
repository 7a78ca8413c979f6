//! The common part of `simulate`, `plot` and `run`: check the whole program, run it on the machine, judge it, report the
//! result.

use leadscrew_board_sim::plant::ServoOptions;
use leadscrew_core::link::identity;

use crate::certified::Judge;
use crate::checking::{self, Detail, Report};
use crate::cli::Drive;
use crate::diagnostics::{self, Diagnostic};
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::machine::{self, Ended, Observer};
use crate::origin::Origin;
use crate::output;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::synchronism::Synchronism;
use crate::trace::Summary;
use crate::values::Tolerance;
use crate::words::{Both, both};

/// Checks a program and reports the findings.
///
/// # Errors
/// A file that cannot be read.
pub fn tell_report(setup: &Setup, source: &SourceFile) -> Outcome<Report> {
    let report = checking::check(setup, source, Detail::Verdict)?;
    report.print(setup);
    Ok(report)
}

/// A program on the machine.
#[derive(Debug)]
pub struct Execution<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    /// The result of the check.
    pub report: Report,
    ended: Ended,
}

impl<'a> Execution<'a> {
    /// Checks a program and reports the findings. A program with an alarm goes no further.
    pub fn prepare(setup: &'a Setup, source: &'a SourceFile) -> Outcome<Self> {
        let report = tell_report(setup, source)?;
        let execution = Self {
            setup,
            source,
            report,
            ended: Ended::default(),
        };
        if execution.report.alarms.is_empty() {
            return Ok(execution);
        }
        if setup.global.json {
            execution.print_json(&Summary::new(&setup.params), false, None)?;
        }
        Err(Failure::Wrong)
    }

    /// Runs the program, with these drives of X and Z, and reports the machine's warnings and alarms.
    pub fn run(
        &mut self,
        drive: &Drive,
        servos: [Option<ServoOptions>; 2],
        observer: &mut dyn Observer,
    ) -> Outcome {
        self.ended = machine::run(self.setup, drive, servos, self.source, observer)?;
        let known = |warning: &Diagnostic| {
            self.report
                .warnings
                .iter()
                .any(|w| w.number == warning.number)
        };
        self.ended.warnings.retain(|warning| !known(warning));
        for diagnostic in self.ended.alarms.iter().chain(&self.ended.warnings) {
            diagnostics::print(diagnostic, self.setup.colour);
        }
        Ok(())
    }

    /// Keeps the variables of a program that came to its end; gives the file where it was written.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep_variables(&self) -> Outcome<Option<String>> {
        match &self.ended.variables {
            Some(values) => self.setup.variables.save(values, self.setup.lang),
            None => Ok(None),
        }
    }

    /// True where the program has written offsets, which this machine does not keep.
    pub fn forgets_offsets(&self) -> bool {
        self.ended.writes_offsets
    }

    /// True where the user has ended the run.
    pub fn is_interrupted(&self) -> bool {
        self.ended.interrupted
    }

    /// True where the program came to its end without an alarm of the machine.
    pub fn is_whole(&self) -> bool {
        self.ended.alarms.is_empty() && !self.ended.interrupted && !self.ended.cut
    }

    /// Judges the run, and writes the JSON result if it is wanted.
    pub fn conclude(&self, summary: &Summary, tolerance: Option<Tolerance>) -> Outcome {
        let above = tolerance.and_then(|tolerance| self.above(summary, tolerance));
        let within = above.is_none();
        if self.setup.global.json {
            self.print_json(summary, self.is_whole() && within, tolerance)?;
        }
        if !self.ended.alarms.is_empty() {
            return Err(Failure::Machine);
        }
        if self.ended.interrupted {
            return Err(Failure::Interrupted);
        }
        if self.ended.cut {
            return Err(Failure::MachineBecause(both!(
                "the power was taken away, as `--cut-power` asks; what the board had stored is kept",
                "已按 `--cut-power` 断电；控制板存储的内容已保留"
            )));
        }
        above.map_or(Ok(()), |above| Err(Failure::WrongBecause(above)))
    }

    /// Why a tolerance is not met: by the board's measurement of a thread, or by the simulation's own knowledge.
    fn above(&self, summary: &Summary, tolerance: Tolerance) -> Option<Both> {
        let mut above = self
            .ended
            .threads
            .above(tolerance, &self.judge(Some(tolerance)));
        if let Some(truly) = summary.above(tolerance) {
            above.get_or_insert_default().join(&truly);
        }
        above.map(|above| above.words(tolerance))
    }

    /// The errors of synchronism as measured by the board.
    pub fn measured(&self) -> Synchronism {
        self.ended.threads.measured()
    }

    /// The threads, for a person: a line each.
    pub fn threads(&self, tolerance: Option<Tolerance>) -> String {
        let judge = self.judge(tolerance);
        self.ended.threads.text(&judge, self.setup.lang)
    }

    fn judge(&self, tolerance: Option<Tolerance>) -> Judge {
        Judge::new(&self.setup.params, tolerance)
    }

    fn print_json(&self, summary: &Summary, ok: bool, tolerance: Option<Tolerance>) -> Outcome {
        output::json(|json| {
            json.flag("ok", ok);
            summary.fields(&self.measured(), json);
            self.ended.threads.fields(&self.judge(tolerance), json);
            self.origin_fields(json);
        })
    }

    /// `alarms` and `warnings` of check and run, and where the result comes from.
    pub fn origin_fields(&self, json: &mut Json) {
        let alarms = self.report.alarms.iter().chain(&self.ended.alarms);
        let warnings = self.report.warnings.iter().chain(&self.ended.warnings);
        json.array_at("alarms", |json| {
            alarms.for_each(|d| json.object(|json| d.fields(json, true)))
        });
        json.array_at("warnings", |json| {
            warnings.for_each(|d| json.object(|json| d.fields(json, true)))
        });
        let origin = Origin {
            program: self.source.name(),
            parameters: Some(identity(&self.setup.params)),
            machine: self.setup.machine(),
            board: None,
        };
        origin.fields(json);
    }
}
