//! `check`: everything that can be known before a machine is switched on.

use crate::checking::{self, Detail, Report, plural};
use crate::cli::Check;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::words::both;

/// Checks programs and reports on all of them.
pub fn run(setup: &Setup, args: &Check) -> Outcome {
    let mut reports = Vec::new();
    for path in &args.programs {
        let source = SourceFile::new(path);
        let report = checking::check(setup, &source, Detail::Cycles)?;
        if !setup.global.json {
            tell(setup, &source, &report)?;
        }
        reports.push((source, report));
    }
    let fails =
        |report: &Report| !report.alarms.is_empty() || (args.strict && report.lead_in_too_short);
    let ok = !reports.iter().any(|(_, report)| fails(report));
    if setup.global.json {
        output::json(|json| {
            json.flag("ok", ok);
            json.array_at("files", |json| {
                for (source, report) in &reports {
                    json.object(|json| report.fields(source, json));
                }
            });
        })?;
    }
    if ok { Ok(()) } else { Err(Failure::Wrong) }
}

/// The diagnostics of a file, then one line about it and one for each cycle.
fn tell(setup: &Setup, source: &SourceFile, report: &Report) -> Outcome {
    report.print(setup);
    let (alarms, warnings) = (report.count(false), report.count(true));
    let verdict = match (alarms, warnings) {
        (0, 0) => both!("ok", "正常"),
        (0, _) => both!(
            "ok, {words}",
            "正常，{warnings} 个警告",
            words = plural(warnings, "warning")
        ),
        (_, 0) => both!(
            "{words}",
            "{alarms} 个报警",
            words = plural(alarms, "alarm")
        ),
        _ => both!(
            "{first}, {second}",
            "{alarms} 个报警，{warnings} 个警告",
            first = plural(alarms, "alarm"),
            second = plural(warnings, "warning")
        ),
    };
    let (name, lang) = (source.shown(), setup.lang);
    let line = both!(
        "{name}: {en}; {moves}\n",
        "{name}：{zh}；移动 {count} 段\n",
        en = verdict.en,
        zh = verdict.zh,
        moves = plural(report.moves, "move"),
        count = report.moves
    );
    let mut text = line.get(lang).to_owned();
    for cycle in &report.cycles {
        text.push_str("  ");
        text.push_str(cycle.text().get(lang));
        text.push('\n');
    }
    output::write(text.as_bytes())
}
