//! `run` on a real bus, in three parts: the arguments and the board are checked here, [`work`] feeds and watches the
//! program, [`tell`] reports the result.

mod tell;
mod work;

use std::time::SystemTime;

use leadscrew_core::alarm::Lang;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::Status;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::Rpm;
use leadscrew_core::zones::Zones;

pub use self::tell::no_figures;
use self::work::Ran;
use super::{Base, Machine, Table};
use crate::certified::Judge;
use crate::checking::Report;
use crate::cli::{Global, Run};
use crate::commands::run::passes;
use crate::diagnostics;
use crate::execution::tell_report;
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::link::Link;
use crate::origin::Origin;
use crate::setup::{Answer, Setup, alone_in};
use crate::source::SourceFile;
use crate::start;
use crate::words::{Both, both};

/// Refuses an option that only a simulated machine can do.
fn refuse(global: &Global, args: &Run) -> Outcome {
    let drive = &args.drive;
    let option = if !args.drives.drive.is_empty() {
        "--drive"
    } else if drive.spindle_ripple.is_some() {
        "--spindle-ripple"
    } else if drive.tick_us.is_some() {
        "--tick-us"
    } else if global.at.is_some() {
        "--at"
    } else {
        return Ok(());
    };
    let bus = &global.bus;
    Err(Failure::Usage(both!(
        "`{option}` is for the machine inside the command (`--bus sim`); behind `--bus {bus}` stands one of its own",
        "`{option}` 只用于命令内部的模拟机床（`--bus sim`）；`--bus {bus}` 后面是另一台独立的机床"
    )))
}

/// A program that was carried out, well or not.
pub struct Done<'a> {
    pub setup: Setup<'a>,
    pub link: Link,
    report: Report,
    pub ran: Ran,
    origin: Origin,
    pub verdict: Outcome,
    /// Whether what the program has changed is kept: offsets by the board, variables by a file. It has run all the same.
    pub kept: Outcome,
}

/// The verdict; what is not kept is told beside one that is no better.
pub fn end(verdict: Outcome, kept: Outcome, lang: Lang) -> Outcome {
    if verdict.is_err()
        && let Err(lost) = &kept
    {
        let _ = lost.report(lang, false);
    }
    verdict.and(kept)
}

/// Runs a program on a board.
pub fn run(global: &Global, source: &SourceFile, args: &Run) -> Outcome {
    let done = perform(global, source, args, Work::Program, &mut |_, _| Ok(()))?;
    let (setup, ran) = (&done.setup, &done.ran);
    let judge = Judge::new(&setup.params, args.tolerance);
    if global.json {
        let ended = (done.verdict.is_ok(), &done.kept);
        tell::result(setup, &done.report, ran, &done.origin, ended, &judge)?;
    } else {
        tell::summary(setup, source, ran, &done.origin, &done.verdict, &judge)?;
    }
    end(done.verdict, done.kept, global.lang())
}

/// Checks a program and carries it out on a board. `begin` sees what the check goes by, and may add to it.
pub fn perform<'a>(
    global: &'a Global,
    source: &SourceFile,
    args: &Run,
    work: Work,
    begin: &mut dyn FnMut(&mut Setup<'a>, &Status) -> Outcome,
) -> Outcome<Done<'a>> {
    perform_on(global, source, args, work, &mut Machine::meet, begin)
}

/// The same on the board that `meet` meets.
pub fn perform_on<'a>(
    global: &'a Global,
    source: &SourceFile,
    args: &Run,
    work: Work,
    meet: &mut dyn FnMut(&Global) -> Outcome<Machine>,
    begin: &mut dyn FnMut(&mut Setup<'a>, &Status) -> Outcome,
) -> Outcome<Done<'a>> {
    refuse(global, args)?;
    // A mistyped name needs no board.
    source
        .open()
        .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
    let program = source.name();
    let answer = Answer::Run { program: &program };
    alone_in(global, &global.params, &global.set, answer)?;
    let mut machine = meet(global)?;
    let tap = TapRecord::decode(&machine.link.journal()?).ok().flatten();
    let in_hole = tap.is_some_and(|record| record.in_hole);
    let base = Base {
        // The way out of a hole needs no offsets: a damaged table does not keep a tap in it.
        offsets: if in_hole {
            Table::Unknown
        } else {
            machine.table()?
        },
        params: machine.params.clone(),
    };
    let mut setup = Setup::over(global, Some(base), Some(source.path()), answer)?;
    machine.agrees_with(&setup)?;
    let mut link = machine.link;
    link.nobody_by_hand()?;
    let status = link.status()?;
    work::ready(&status, &link, global)?;
    if !in_hole {
        work::referenced(&status, &link)?;
    }
    ensure_mode(&mut link, work)?;
    setup.passes = passes(args);
    setup.position = Some(status.position);
    setup.turning = status.command != Rpm::STOPPED;
    if setup.params.has_gears() {
        setup.gear = link.contacts()?.gear;
    }
    if !Zones::of(&setup.params).are_off() {
        setup.tool = link.tool()?;
    }
    setup.tap = tap;
    begin(&mut setup, &status)?;
    let origin = Origin {
        program: program.clone(),
        parameters: Some(status.parameters),
        machine: setup.machine(),
        board: Some((link.board_name()?, SystemTime::now())),
    };
    let report = tell_report(&setup, source)?;
    if !report.alarms.is_empty() {
        if global.json {
            tell::result(
                &setup,
                &report,
                &Ran::default(),
                &origin,
                (false, &Ok(())),
                &Judge::new(&setup.params, None),
            )?;
        }
        return Err(Failure::Wrong);
    }
    if let Some(line) = args.from {
        setup.from = Some(start::agree(&setup, source, line.get(), args.consent())?);
    }
    interrupt::defer(UnderWay::Machine);
    let (_, threads) = link.certificates()?;
    let bar = tell::bar(report.moves, global.json, setup.lang);
    let (mut ran, outcome) = work::carry_out(
        &setup,
        source,
        &mut link,
        status,
        &threads,
        args.handwheel,
        bar,
    );
    for diagnostic in ran.alarms.iter().chain(&ran.warnings) {
        diagnostics::print(diagnostic, setup.colour);
    }
    if let Err(lost) = outcome {
        tell::lost(&setup, &ran, &lost)?;
        return Err(lost);
    }
    // The table was made from the one that the program was resolved with: what somebody has written into that since its end
    // is not lost [D536]. What a disk or a board does not keep is no reason to lose the rest.
    let kept = ran
        .offsets
        .as_ref()
        .map(|table| link.commit_offsets(table, setup.revision()))
        .transpose();
    let values = ran.variables.as_ref();
    let saved = values.map_or(Ok(None), |values| setup.variables.save(values, setup.lang));
    let (revision, kept) = match kept {
        Ok(revision) => (revision, Ok(())),
        Err(trouble) => (None, Err(Failure::from(trouble))),
    };
    ran.revision = revision;
    let kept = kept.and(saved.map(drop).map_err(not_kept));
    let verdict = tell::verdict(&setup, &ran, args.tolerance);
    Ok(Done {
        setup,
        link,
        report,
        ran,
        origin,
        verdict,
        kept,
    })
}

/// No command line is wrong where a program has run and its variables could not be written.
fn not_kept(failure: Failure) -> Failure {
    // It may have told its reason elsewhere.
    let Some(Both { en, zh }) = failure.words() else {
        return Failure::Wrong;
    };
    Failure::WrongBecause(both!(
        "the program has run, and its variables are not kept: {en}",
        "程序已执行，但变量未能保存：{zh}"
    ))
}

/// What a board is to do, for the mode that it has to be in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// A program.
    Program,
    /// A line that was typed.
    Typed,
}

/// Brings the board into the mode for a work. The machine is at rest.
fn ensure_mode(link: &mut Link, work: Work) -> Outcome {
    let mode = match work {
        Work::Program => OperatingMode::Automatic,
        Work::Typed => OperatingMode::Mdi,
    };
    Ok(link.set_mode(mode)?)
}

#[cfg(test)]
mod tests;
