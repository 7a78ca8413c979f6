//! Tells the result of a run on a board: the verdict, the words for a person, the JSON object.
//!
//! Knows the results of [`work`](super::work); must not know the board.

use std::io::IsTerminal as _;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leadscrew_can::Address;
use leadscrew_core::alarm::Lang;
use leadscrew_core::offsets::Revision;

use super::work::Ran;
use crate::certified::Judge;
use crate::checking::{Report, plural};
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::number;
use crate::origin::Origin;
use crate::output;
use crate::place::SourceLine;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::synchronism::Synchronism;
use crate::values::Tolerance;
use crate::words::{both, pick};

/// The verdict on a run that was carried to its end.
pub fn verdict(setup: &Setup, ran: &Ran, tolerance: Option<Tolerance>) -> Outcome {
    if ran.refused {
        Err(Failure::Wrong)
    } else if !ran.alarms.is_empty() {
        Err(Failure::Machine)
    } else if ran.interrupted {
        Err(Failure::Interrupted)
    } else if ran.reset {
        Err(Failure::MachineBecause(both!(
            "the board was reset by somebody else; the program has ended in line {line}",
            "控制板被其它操作者复位；程序在第 {line} 行结束",
            line = SourceLine(ran.line)
        )))
    } else {
        within(setup, ran, tolerance)
    }
}

/// The result so far of a run whose board was lost: the board may still finish its work.
pub fn lost(setup: &Setup, ran: &Ran, lost: &Failure) -> Outcome {
    if setup.global.json {
        output::json(|json| {
            lost.fields(setup.lang, json);
            ran.threads.fields(&Judge::new(&setup.params, None), json);
            for (key, told) in [("alarms", &ran.alarms), ("warnings", &ran.warnings)] {
                json.array_at(key, |json| {
                    for diagnostic in told {
                        json.object(|json| diagnostic.fields(json, true));
                    }
                });
            }
        })
    } else {
        output::write(
            ran.threads
                .text(&Judge::new(&setup.params, None), setup.lang)
                .as_bytes(),
        )
    }
}

/// The result for a person.
pub fn summary(
    setup: &Setup,
    source: &SourceFile,
    ran: &Ran,
    origin: &Origin,
    verdict: &Outcome,
    judge: &Judge,
) -> Outcome {
    let word = match verdict {
        Ok(()) => pick(setup.lang, "done", "完成"),
        Err(Failure::Interrupted) => pick(setup.lang, "interrupted", "已中断"),
        Err(Failure::WrongBecause(_)) => pick(setup.lang, "out of tolerance", "超差"),
        Err(_) => pick(setup.lang, "stopped", "已停止"),
    };
    let figures = Figures::of(ran, setup);
    let error = if figures.errors.ticks > 0 {
        let (worst, rms) = (figures.errors.worst(), figures.errors.rms());
        both!(
            " · worst synchronism error {worst_en} µm ({rms} µm RMS), as measured",
            " · 测得的最大同步误差 {worst_zh} µm（均方根 {rms} µm）",
            worst_en = worst.en,
            worst_zh = worst.zh
        )
    } else {
        both!("", "")
    };
    let text = both!(
        "{name}: {word}: {words} · {time} s · {late} setpoints late{en}\nsetpoints {hash}\n",
        "{name}：{word}：移动 {moves} 段 · {time} s · 迟到设定值 {late} 个{zh}\n设定值校验 {hash}\n",
        name = source.shown(),
        words = plural(ran.moves, "move"),
        moves = ran.moves,
        time = number::rounded::<6>(figures.time_us, 3),
        late = ran.late,
        hash = figures
            .hash
            .as_deref()
            .unwrap_or(pick(setup.lang, "unknown", "未知")),
        en = error.en,
        zh = error.zh
    );
    output::write(text.get(setup.lang).as_bytes())?;
    output::write(ran.threads.text(judge, setup.lang).as_bytes())?;
    if let Some(Revision(revision)) = ran.revision {
        let told = both!(
            "offsets and tools: written by the program, revision {revision}\n",
            "偏置与刀具：已由程序写入，修订号 {revision}\n"
        );
        output::write(told.get(setup.lang).as_bytes())?;
    }
    if let Some(line) = origin.line() {
        output::write(line.get(setup.lang).as_bytes())?;
    }
    Ok(())
}

/// The certificate in the contract's units.
#[derive(Debug, Default)]
struct Figures {
    ticks: u64,
    time_us: i64,
    hash: Option<String>,
    /// As measured by the board.
    errors: Synchronism,
}

impl Figures {
    fn of(ran: &Ran, setup: &Setup) -> Self {
        let Some(certificate) = &ran.certificate else {
            return Self::default();
        };
        let time = certificate
            .ticks
            .saturating_mul(u64::from(setup.params.tick_us()));
        let hash = certificate.setpoint_hash;
        Self {
            ticks: certificate.ticks,
            time_us: i64::try_from(time).unwrap_or(i64::MAX),
            hash: hash.map(|hash| format!("{hash:016x}")),
            errors: certificate.into(),
        }
    }

    /// Writes the known values, with what was seen of the run.
    fn fields(
        &self,
        bus: &Address,
        ran: &Ran,
        path_nm: Option<i64>,
        judge: &Judge,
        json: &mut Json,
    ) {
        json.text("bus", &bus.to_string());
        json.number("moves", ran.moves);
        json.number("ticks", self.ticks);
        json.decimal::<6>("time_s", self.time_us);
        match path_nm {
            Some(nm) => json.decimal::<6>("path_mm", nm),
            None => json.null("path_mm"),
        }
        match &self.hash {
            Some(hash) => json.text("setpoint_hash", hash),
            None => json.null("setpoint_hash"),
        }
        // A machine knows only the measured values.
        self.errors.field("sync_error_um", json);
        self.errors.field("measured_error_um", json);
        json.integer("late", i64::from(ran.late));
        ran.threads.fields(judge, json);
        if let Some(Revision(revision)) = ran.revision {
            json.integer("offsets_revision", revision.into());
        }
    }
}

/// The figures of a run that has not begun.
pub fn no_figures(bus: &Address, json: &mut Json) {
    Figures::default().fields(bus, &Ran::default(), None, &Judge::default(), json);
}

/// Compares the board's measurements of each thread, and of the run, with the requested tolerance.
fn within(setup: &Setup, ran: &Ran, tolerance: Option<Tolerance>) -> Outcome {
    let Some(tolerance) = tolerance else {
        return Ok(());
    };
    let mut above = ran
        .threads
        .above(tolerance, &Judge::new(&setup.params, Some(tolerance)));
    if let Some(run) = &ran.certificate
        && tolerance.is_below(run.largest.nm())
    {
        // The run stands for a thread whose own certificate is missing.
        let above = above.get_or_insert_default();
        above.worst_nm = above.worst_nm.max(run.largest.nm());
    }
    match above {
        Some(above) => Err(Failure::WrongBecause(above.words(tolerance))),
        None => Ok(()),
    }
}

/// The result object. The path is the sum of the moves; it is known where all of them were carried out.
pub fn result(
    setup: &Setup,
    report: &Report,
    ran: &Ran,
    origin: &Origin,
    (ok, kept): (bool, &Outcome),
    judge: &Judge,
) -> Outcome {
    let figures = Figures::of(ran, setup);
    let path_nm = ok.then(|| report.path_nm.round() as i64);
    output::json(|json| {
        match kept {
            Err(lost) if ok => lost.fields(setup.lang, json),
            _ => json.flag("ok", ok),
        }
        figures.fields(&setup.global.bus, ran, path_nm, judge, json);
        for (key, first, then) in [
            ("alarms", &report.alarms, &ran.alarms),
            ("warnings", &report.warnings, &ran.warnings),
        ] {
            json.array_at(key, |json| {
                for diagnostic in first.iter().chain(then) {
                    json.object(|json| diagnostic.fields(json, true));
                }
            });
        }
        origin.fields(json);
    })
}

/// A progress bar over the moves, only on a terminal.
pub fn bar(moves: u64, json: bool, lang: Lang) -> ProgressBar {
    if json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(moves), ProgressDrawTarget::stderr());
    let template = pick(
        lang,
        "{bar:40} move {pos}/{len}  {msg}",
        "{bar:40} 移动 {pos}/{len}  {msg}",
    );
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
