//! `run`: check all of a program, upload it, run it, tell the result.

use std::fs::File;
use std::io::{self, BufWriter, IsTerminal as _};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leadscrew_board_sim::Direction;
use leadscrew_can::{Address, LogWriter, Packet, Stamp};
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{FdFrame, Frame};
use leadscrew_language::flow::Passes;

use super::board;
use crate::cli::{Global, Run};
use crate::execution::Execution;
use crate::failure::{Doing, Failure, Outcome};
use crate::machine::Observer;
use crate::output;
use crate::place::SourceLine;
use crate::profiles::Chosen;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::start;
use crate::trace::{Setpoint, Summary};
use crate::words::{both, pick};

/// Runs a program.
pub fn run(global: &Global, args: &Run) -> Outcome {
    let source = SourceFile::new(&args.program);
    if global.bus != Address::Sim {
        if args.record.is_some() {
            return Err(Failure::Usage(both!(
                "`run --record` writes the simulated bus; on a real one, `leadscrew record` in another terminal does it",
                "`run --record` 记录的是模拟总线；真实总线请在另一个终端用 `leadscrew record`"
            )));
        }
        return board::run(global, &source, args);
    }
    if args.handwheel {
        return Err(Failure::Usage(both!(
            "`--handwheel` needs a machine that somebody can turn a wheel at: `leadscrew up`, or a board (`--bus`)",
            "`--handwheel` 需要可转动手轮的机床：`leadscrew up` 或控制板（`--bus`）"
        )));
    }
    carry_out(global, &source, args)
}

/// How often a program is carried out that begins itself again: without an end, if nothing else is said.
#[must_use]
pub fn passes(args: &Run) -> Passes {
    args.passes.map_or(Passes::UntilStopped, Passes::Number)
}

/// Runs any text on the simulated machine.
pub fn carry_out(global: &Global, source: &SourceFile, args: &Run) -> Outcome {
    let (drive, record) = (&args.drive, args.record.as_deref());
    let mut setup = Setup::with_drive(global, drive, source)?;
    setup.passes = passes(args);
    if let Some(line) = args.from {
        setup.from = Some(start::agree(&setup, source, line.get(), args.consent())?);
    }
    let setup = &setup;
    if let Some(path) = record {
        source.protect(path)?;
    }
    let chosen = Chosen::of(&args.drives.drive, setup.lang)?;
    let servos = chosen.servos(&setup.params)?;
    let mut execution = Execution::prepare(setup, source)?;
    let tick_us = setup.params.tick_us();
    let log = match record {
        Some(path) => {
            let file = File::create(path)
                .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
            Some(LogWriter::new(BufWriter::new(file), "sim"))
        }
        None => None,
    };
    let mut watcher = Watcher {
        tick_us,
        lang: setup.lang,
        summary: Summary::new(&setup.params).with_drives(chosen.words()),
        log,
        unwritten: None,
        bar: bar(execution.report.moves, setup.global.json, setup.lang),
    };
    let ran = execution.run(drive, servos, &mut watcher);
    watcher.bar.finish_and_clear();
    ran?;
    if let (Some(log), Some(path)) = (watcher.log, record) {
        watcher
            .unwritten
            .map_or_else(|| log.finish().map(drop), Err)
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    }
    let variables = execution.keep_variables()?;
    let verdict = execution.conclude(&watcher.summary, args.tolerance);
    if !setup.global.json {
        let word = match verdict {
            Ok(()) => pick(setup.lang, "done", "完成"),
            Err(Failure::Interrupted) => pick(setup.lang, "interrupted", "已中断"),
            Err(Failure::Machine | Failure::MachineBecause(_)) => {
                pick(setup.lang, "stopped", "已停止")
            }
            Err(_) => pick(setup.lang, "out of tolerance", "超差"),
        };
        let (name, summary) = (source.shown(), &watcher.summary);
        let line = summary.line(setup.lang);
        let measured = execution.measured().as_measured(setup.lang);
        let told = both!(
            "{name}: {word}: {line}{measured}\n",
            "{name}：{word}：{line}{measured}\n"
        );
        let mut text = told.get(setup.lang).to_owned();
        if let Some(taps) = summary.taps() {
            text.push_str(pick(setup.lang, "taps ", "攻丝 "));
            text.push_str(taps.get(setup.lang));
            text.push('\n');
        }
        if let Some(cuts) = summary.cuts(setup.lang) {
            text.push_str(&cuts);
        }
        text.push_str(pick(setup.lang, "setpoints ", "设定值校验 "));
        text.push_str(&summary.hash());
        text.push('\n');
        if let Some(file) = setup.machine() {
            text.push_str(pick(setup.lang, "machine ", "机床 "));
            text.push_str(&file);
            text.push('\n');
        }
        if let Some(file) = variables {
            text.push_str(pick(setup.lang, "variables ", "变量 "));
            text.push_str(&file);
            text.push('\n');
        }
        if execution.forgets_offsets() {
            let told = both!(
                "note: the offsets that the program has written (G10) are forgotten: only a board keeps a table (`leadscrew up`)\n",
                "注意：程序写入的偏置（G10）不会保存：只有控制板才保存刀具表（`leadscrew up`）\n"
            );
            text.push_str(told.get(setup.lang));
        }
        text.push_str(&execution.threads(args.tolerance));
        output::write(text.as_bytes())?;
    }
    verdict
}

/// A bar over the moves, only where somebody watches.
fn bar(moves: u64, json: bool, lang: Lang) -> ProgressBar {
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

/// Sums up, shows progress, records frames.
struct Watcher {
    tick_us: u32,
    lang: Lang,
    summary: Summary,
    log: Option<LogWriter<BufWriter<File>>>,
    /// The first write to it that failed; told at the end.
    unwritten: Option<io::Error>,
    bar: ProgressBar,
}

impl Watcher {
    fn record(&mut self, tick: u64, packet: &Packet) {
        if let Some(log) = &mut self.log {
            let time = Stamp::from_micros(tick.saturating_mul(u64::from(self.tick_us)));
            if let Err(error) = log.push(time, packet) {
                self.unwritten.get_or_insert(error);
            }
        }
    }
}

impl Observer for Watcher {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        self.summary.push(point);
        if !self.bar.is_hidden() && point.tick.is_multiple_of(1 << 10) {
            let time = Duration::from_micros(point.tick.saturating_mul(u64::from(self.tick_us)));
            self.bar.set_position(point.step);
            let message = both!(
                "line {line}, {time:.1} s machine time",
                "第 {line} 行，机床时间 {time:.1} s",
                line = SourceLine(point.line),
                time = time.as_secs_f64()
            );
            self.bar.set_message(message.get(self.lang).to_owned());
        }
        Ok(())
    }

    fn frame(&mut self, tick: u64, _: Direction, frame: &Frame) {
        self.record(tick, &Packet::Frame(*frame));
    }

    fn together(&mut self, tick: u64, frame: &FdFrame) {
        self.record(tick, &Packet::Fd(frame.into()));
    }
}
