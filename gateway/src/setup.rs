//! What every command starts from: the machine's parameters, the language, and whether colour is welcome.

use std::path::PathBuf;

use leadscrew_board_sim::plant::Flash;
use leadscrew_can::Address;
use leadscrew_core::alarm::Lang;
use leadscrew_core::cycle::Context;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::identity;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Dialect, Options, Position};
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{Angle, Length};

use crate::cli::{DialectName, Drive, Global};
use crate::commands::board;
use crate::diagnostics::{self, Diagnostic};
use crate::failure::{Failure, Outcome};
use crate::hole::Hole;
use crate::origin::Origin;
use crate::output;
use crate::params::{self, Loaded};
use crate::source::SourceFile;
use crate::state::{StateFile, stored_set};
use crate::synchronism::Synchronism;
use crate::threads::Threads;
use crate::trace::Summary;
use crate::words::{self, both};

/// The start of a command.
#[derive(Debug)]
pub struct Setup<'a> {
    /// Options as typed.
    pub global: &'a Global,
    /// The machine.
    pub params: Params,
    /// Language of messages.
    pub lang: Lang,
    /// The inputs from the start on.
    pub signals: Signals,
    /// Standard error is a terminal and nobody minds colour.
    pub colour: bool,
    /// Where the tool stands at the start, where a board has said so; else by the options.
    pub position: Option<Position>,
    /// The spindle turns at the start, as a board has said.
    pub turning: bool,
    /// The newest entry of the tap journal, where a machine is known.
    pub tap: Option<TapRecord>,
    /// The flash of the simulated board, where it is kept.
    pub kept: Option<(StateFile, Flash)>,
}

impl<'a> Setup<'a> {
    /// Loads what the options name, and tells what is wrong with it. The set of the board, real or simulated,
    /// lies below it.
    pub fn new(global: &'a Global, answer: Answer<'_>) -> Outcome<Self> {
        Self::of(global, board::base(global, answer)?, None, answer)
    }

    /// The same over a set that is known already; `None`: the built-in machine.
    pub fn over(global: &'a Global, base: Option<Params>, answer: Answer<'_>) -> Outcome<Self> {
        Self::of(global, base, None, answer)
    }

    /// The same for a simulated machine that is to run `program` with `drive`'s tick.
    pub fn with_drive(global: &'a Global, drive: &Drive, program: &SourceFile) -> Outcome<Self> {
        let tick = drive.tick_us.map(|tick| format!("9000={tick}"));
        let program = &program.name();
        Self::of(global, None, tick, Answer::Run { program })
    }

    /// A set that is stored in the flash of a simulated board is that board's own, as with a real one [D107].
    fn of(
        global: &'a Global,
        base: Option<Params>,
        last: Option<String>,
        answer: Answer<'_>,
    ) -> Outcome<Self> {
        let kept = match &global.state {
            None => None,
            Some(path) => {
                let state = StateFile::new(path);
                let flash = state.load_or_new()?;
                Some((state, flash))
            }
        };
        let stored = match &kept {
            Some((_, flash)) => stored_set(flash),
            None => None,
        };
        let base = base.or_else(|| stored.clone());
        let set: Vec<String> = global.set.iter().cloned().chain(last).collect();
        let loaded = params::load_over(base, &global.params, &set, global.lang())?;
        let params = told_good_in(global, loaded, answer)?.params;
        if let (Some(path), Some(stored)) = (&global.state, stored)
            && identity(&stored) != identity(&params)
        {
            return Err(Failure::Usage(both!(
                "`--params` and `--set` make another machine than the one stored in `{file}`: leave them out, or change \
                 that board's parameters first (`leadscrew params push --state {file}`)",
                "`--params` 和 `--set` 给出的机床与 `{file}` 中保存的不同：请去掉这些选项，或先修改该控制板的参数（`leadscrew \
                 params push --state {file}`）",
                file = words::path(path)
            )));
        }
        let tap = match &kept {
            Some((state, flash)) => state.journal(flash)?,
            None => None,
        };
        Ok(Self {
            global,
            params,
            lang: global.lang(),
            signals: signals(global),
            colour: diagnostics::colour(),
            position: None,
            turning: false,
            tap,
            kept,
        })
    }

    /// What the moves of a call depend on for a tool at `at`, with what is known of a tap in its hole.
    pub const fn context<'h>(&self, at: Position, hole: &'h Hole) -> Context<'h> {
        Context {
            at,
            signals: self.signals,
            tap: hole.record(),
        }
    }

    /// Where the drives stand at power-up.
    pub fn power_up(&self) -> Position {
        let at = self.global.at.unwrap_or_default();
        Position {
            x: Length::from_nm(at.x_nm),
            z: Length::from_nm(at.z_nm),
            c: Angle::from_udeg(at.c_udeg),
        }
    }

    /// Where the tool stands at the start: an axis with a tap in its hole at the bottom [D26].
    fn start(&self) -> Position {
        if let Some(position) = self.position {
            return position;
        }
        let position = self.power_up();
        match self.tap.filter(|record| record.in_hole) {
            Some(record) => record.hole.axis.with(position, record.hole.bottom),
            None => position,
        }
    }

    /// How programs are read.
    pub fn options(&self) -> Options {
        Options {
            dialect: match self.global.dialect {
                DialectName::Gsk980td => Dialect::Gsk980td,
                DialectName::Gsk988 => Dialect::Gsk988,
            },
            skip: self.global.skip,
            optional_stop: self.global.optional_stop,
            dry_run: self.global.dry_run,
            position: self.start(),
        }
    }
}

/// The inputs that the options set; the last of a name counts.
fn signals(global: &Global) -> Signals {
    let mut signals = Signals::default();
    for set in &global.signal {
        signals.set(set.signal, set.level);
    }
    signals
}

/// The parameters that the options make, with everything that is wrong with them told; wrong ones end the command.
pub fn load(global: &Global) -> Outcome<Loaded> {
    let base = board::base(global, Answer::Parameters)?;
    let loaded = params::load_over(base, &global.params, &global.set, global.lang())?;
    told_good(global, loaded)
}

/// Files and options by themselves: what is wrong with them over whatever set needs no board to be told.
///
/// # Errors
/// A file that cannot be read; mistakes in it, which have been told.
pub fn alone(global: &Global, files: &[PathBuf], set: &[String]) -> Outcome<Loaded> {
    alone_in(global, files, set, Answer::Parameters)
}

/// The same where `--json` has the form of another command's result.
///
/// # Errors
/// As [`alone`].
pub fn alone_in(
    global: &Global,
    files: &[PathBuf],
    set: &[String],
    answer: Answer<'_>,
) -> Outcome<Loaded> {
    let loaded = params::load(files, set, global.lang())?;
    // What the cross-checks find may be otherwise over another set.
    let wrong = |d: &Diagnostic| !d.warning && d.number < 4420;
    if loaded.diagnostics.iter().any(wrong) {
        return told_good_in(global, loaded, answer);
    }
    Ok(loaded)
}

/// The set, with what is wrong with it told; a wrong one ends the command.
pub fn told_good(global: &Global, loaded: Loaded) -> Outcome<Loaded> {
    told_good_in(global, loaded, Answer::Parameters)
}

/// The same where `--json` has the form of another command's result.
fn told_good_in(global: &Global, loaded: Loaded, answer: Answer<'_>) -> Outcome<Loaded> {
    loaded.tell(diagnostics::colour());
    if loaded.is_good() {
        return Ok(loaded);
    }
    if global.json || answer == (Answer::Moves { jsonl: true }) {
        answer.refused(&loaded, &global.bus)?;
    }
    Err(Failure::Wrong)
}

/// The form of a command's machine-readable result, which it also has where wrong parameters let nothing begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer<'a> {
    /// `ok`, `alarms` and `warnings` alone.
    Parameters,
    /// That of `check`: no file has been looked at.
    Check,
    /// Lines, as those of `expand`; `jsonl` where that is the format without `--json`, too.
    Moves {
        /// `--format jsonl`.
        jsonl: bool,
    },
    /// That of `simulate` and `run`: nothing has moved.
    Run {
        /// As it was typed.
        program: &'a str,
    },
}

impl Answer<'_> {
    fn refused(self, loaded: &Loaded, bus: &Address) -> Outcome {
        if let Self::Moves { .. } = self {
            // Warnings first: an alarm is the last line.
            for (key, warning) in [("warning", true), ("alarm", false)] {
                for told in loaded.diagnostics.iter().filter(|d| d.warning == warning) {
                    output::json(|o| o.object_at(key, |o| told.fields(o, true)))?;
                }
            }
            return Ok(());
        }
        output::json(|o| {
            o.flag("ok", false);
            match self {
                Self::Parameters | Self::Moves { .. } => {}
                Self::Check => o.array_at("files", |_| {}),
                Self::Run { .. } if *bus != Address::Sim => board::no_figures(bus, o),
                Self::Run { .. } => {
                    Summary::new(&loaded.params).fields(&Synchronism::default(), o);
                    Threads::default().fields(o);
                }
            }
            loaded.report_fields(o);
            if let Self::Run { program } = self {
                let origin = Origin {
                    program: program.to_owned(),
                    parameters: None,
                    board: None,
                };
                origin.fields(o);
            }
        })
    }
}
