//! `check`: everything that can be known before a machine is switched on.

use super::board;
use crate::checking::{self, Detail, Report, cycle_text, plural};
use crate::cli::{Check, Global};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::setup::{Answer, Setup};
use crate::source::SourceFile;
use crate::words::{Both, both};

/// Checks programs and reports on all of them.
pub fn run(global: &Global, args: &Check) -> Outcome {
    let base = board::base(global, Answer::Check)?;
    let mut reports = Vec::new();
    for path in &args.programs {
        let source = SourceFile::new(path);
        // Each has the machine of its own folder.
        let setup = Setup::over(global, base.clone(), Some(path), Answer::Check)?;
        let report = checking::check(&setup, &source, Detail::Cycles)?;
        if !global.json {
            tell(&setup, &source, &report)?;
        }
        reports.push((source, setup.machine(), report));
    }
    let fails =
        |report: &Report| !report.alarms.is_empty() || (args.strict && report.lead_in_too_short);
    let ok = !reports.iter().any(|(_, _, report)| fails(report));
    if global.json {
        output::json(|json| {
            json.flag("ok", ok);
            json.array_at("files", |json| {
                for (source, machine, report) in &reports {
                    json.object(|json| report.fields(source, machine.as_deref(), json));
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
    let machine = setup.machine().map_or(Both::default(), |file| {
        both!("; machine {file}", "；机床 {file}")
    });
    let line = both!(
        "{name}: {en}; {moves}{machine_en}\n",
        "{name}：{zh}；移动 {count} 段{machine_zh}\n",
        machine_en = machine.en,
        machine_zh = machine.zh,
        en = verdict.en,
        zh = verdict.zh,
        moves = plural(report.moves, "move"),
        count = report.moves
    );
    let mut text = line.get(lang).to_owned();
    for cycle in &report.cycles {
        text.push_str("  ");
        text.push_str(cycle_text(cycle).get(lang));
        text.push('\n');
    }
    if report.further_cycles > 0 {
        let further = both!(
            "  and {words}\n",
            "  另有 {count} 个循环\n",
            words = plural(report.further_cycles, "further cycle"),
            count = report.further_cycles
        );
        text.push_str(further.get(lang));
    }
    output::write(text.as_bytes())
}
