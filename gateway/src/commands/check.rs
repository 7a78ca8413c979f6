//! `check`: everything that can be known before a machine is switched on.

use std::io::{self, Write as _};

use crate::checking::{self, Report, plural};
use crate::cli::Check;
use crate::diagnostics;
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::setup::Setup;
use crate::source::SourceFile;

/// Checks programs and reports on all of them.
pub fn run(setup: &Setup, args: &Check) -> Outcome {
    let mut reports = Vec::new();
    for path in &args.programs {
        let source = SourceFile::new(path);
        let report = checking::check(setup, &source)?;
        if !setup.global.json {
            tell(setup, &source, &report)?;
        }
        reports.push((source, report));
    }
    let fails =
        |report: &Report| !report.alarms.is_empty() || (args.strict && report.lead_in_too_short);
    let ok = !reports.iter().any(|(_, report)| fails(report));
    if setup.global.json {
        let mut json = Json::new();
        json.object(|json| {
            json.flag("ok", ok);
            json.array_at("files", |json| {
                for (source, report) in &reports {
                    json.object(|json| report.fields(source, json));
                }
            });
        });
        let mut bytes = json.into_bytes();
        bytes.push(b'\n');
        io::stdout()
            .write_all(&bytes)
            .map_err(|error| Failure::stdout(&error))?;
    }
    if ok { Ok(()) } else { Err(Failure::Wrong) }
}

/// The diagnostics of a file, then one line about it and one for each cycle.
fn tell(setup: &Setup, source: &SourceFile, report: &Report) -> Outcome {
    for diagnostic in report.alarms.iter().chain(&report.warnings) {
        diagnostics::print(diagnostic, setup.colour);
    }
    let verdict = match (report.alarms.len(), report.warnings.len()) {
        (0, 0) => "ok".to_owned(),
        (0, warnings) => format!("ok, {}", plural(warnings as u64, "warning")),
        (alarms, 0) => plural(alarms as u64, "alarm"),
        (alarms, warnings) => {
            format!(
                "{}, {}",
                plural(alarms as u64, "alarm"),
                plural(warnings as u64, "warning")
            )
        }
    };
    let moves = plural(report.moves, "move");
    let mut text = format!("{}: {verdict}; {moves}\n", source.name());
    for cycle in &report.cycles {
        text.push_str("  ");
        text.push_str(&cycle.text());
        text.push('\n');
    }
    io::stdout()
        .write_all(text.as_bytes())
        .map_err(|error| Failure::stdout(&error))
}
