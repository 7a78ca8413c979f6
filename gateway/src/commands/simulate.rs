//! `simulate`: the setpoints of a program, tick by tick.

use std::fs::File;
use std::io;

use crate::cli::Simulate;
use crate::diagnostics;
use crate::execution::Execution;
use crate::failure::{Doing, Failure, Outcome};
use crate::machine::Observer;
use crate::profiles::Chosen;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::trace::{Columns, Csv, Setpoint, Summary};
use crate::words::both;

/// Simulates a program.
pub fn run(setup: &Setup, args: &Simulate) -> Outcome {
    let source = SourceFile::new(&args.program);
    if let Some(path) = &args.output {
        source.protect(path)?;
    }
    let chosen = Chosen::of(&args.drives.drive, setup.lang)?;
    let servos = chosen.servos(&setup.params)?;
    let mut execution = Execution::prepare(setup, &source)?;
    let tick_us = setup.params.tick_us();
    let cannot = |error: io::Error| match &args.output {
        Some(path) => Failure::file(Doing::Write, path.display(), &error),
        None => Failure::stdout(&error),
    };
    let csv = match &args.output {
        Some(path) => Some(Csv::new(
            File::create(path).map_err(cannot)?,
            tick_us,
            Columns {
                tappers: execution.report.tappers,
                actual: !chosen.is_ideal(),
            },
        )),
        None => None,
    };
    let mut recorder = Recorder {
        summary: Summary::new(&setup.params).with_drives(chosen.words()),
        csv,
        cannot: &cannot,
    };
    execution.run(&args.drive, servos, &mut recorder)?;
    let Recorder { summary, csv, .. } = recorder;
    if let Some(csv) = csv {
        csv.finish().map_err(cannot)?;
    }
    if !setup.global.json {
        diagnostics::say(&summary.text(&execution.measured(), setup.lang));
        diagnostics::say(&execution.threads(args.tolerance));
        if let Some(file) = setup.machine() {
            let told = both!("machine {file}\n", "机床 {file}\n");
            diagnostics::say(told.get(setup.lang));
        }
    }
    execution.conclude(&summary, args.tolerance)
}

/// Writes rows and sums up.
struct Recorder<'a> {
    summary: Summary,
    csv: Option<Csv<File>>,
    cannot: &'a dyn Fn(io::Error) -> Failure,
}

impl Observer for Recorder<'_> {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        self.summary.push(point);
        match &mut self.csv {
            Some(csv) => csv.push(point).map_err(self.cannot),
            None => Ok(()),
        }
    }
}
