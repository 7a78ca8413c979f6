//! The start of every command: the machine's parameters, the language, and the use of colour.

use std::path::{Path, PathBuf};

use leadscrew_board_sim::plant::Flash;
use leadscrew_can::Address;
use leadscrew_core::alarm::Lang;
use leadscrew_core::call::Position;
use leadscrew_core::cycle::Context;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::identity;
use leadscrew_core::offsets::{InPlace, Offsets, Revision};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Carried, Options};
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{Angle, Length};
use leadscrew_language::dialect::Control;
use leadscrew_language::flow::Passes;
use leadscrew_language::heading::Allowed;
use leadscrew_verification::Hole;

use crate::beside;
use crate::certified::Judge;
use crate::cli::{DialectName, Drive, Global};
use crate::commands::board::{self, Base, Table};
use crate::diagnostics::{self, Diagnostic};
use crate::failure::{Failure, Outcome};
use crate::origin::Origin;
use crate::output;
use crate::params::drives::OfProfile;
use crate::params::{self, Loaded};
use crate::program::{Begin, Start};
use crate::source::SourceFile;
use crate::state::{StateFile, stored_set};
use crate::synchronism::Synchronism;
use crate::threads::Threads;
use crate::tools;
use crate::trace::Summary;
use crate::variables::VariableFile;
use crate::words::{self, both};

/// The start of a command.
#[derive(Debug)]
pub struct Setup<'a> {
    /// Options as typed.
    pub global: &'a Global,
    /// The machine's parameters.
    pub params: Params,
    /// The profiles of its drives, where the machine file names them.
    pub profiles: Vec<OfProfile>,
    /// The table of offsets and tools; `None`: the parameters of old count.
    pub offsets: Option<Offsets>,
    /// Language of messages.
    pub lang: Lang,
    /// The inputs at the start.
    pub signals: Signals,
    /// Standard error is a terminal, and colour is wanted.
    pub colour: bool,
    /// Start position of the tool, as a board has reported it; `None`: by the options.
    pub position: Option<Position>,
    /// The spindle turns at the start, as a board has reported.
    pub turning: bool,
    /// The gear that is in at the start, as a board has reported; 0: nobody knows, as after power-up.
    pub gear: u8,
    /// The tool in place at the start, as a board has reported.
    pub tool: InPlace,
    /// The newest entry of the tap journal, if a machine is known.
    pub tap: Option<TapRecord>,
    /// The flash of the simulated board, if it is kept.
    pub kept: Option<(StateFile, Flash)>,
    /// The control that programs are written for, if they name none.
    pub control: Control,
    /// Numbers that the machine file silences.
    pub allow: Allowed,
    /// The machine file beside the program.
    pub machine: Option<PathBuf>,
    /// The variables that outlive a program.
    pub variables: VariableFile,
    /// What the line before has left in force, where lines are typed one by one.
    pub carried: Option<Carried>,
    /// How often the machine carries out a main program that begins itself again.
    pub passes: Passes,
    /// Where the program is started, if not at its first line.
    pub from: Option<Start>,
}

impl<'a> Setup<'a> {
    /// Loads the files and values of the options and reports their mistakes. They are laid over the set of the board, real
    /// or simulated.
    pub fn new(global: &'a Global, program: Option<&Path>, answer: Answer<'_>) -> Outcome<Self> {
        Self::of(global, board::base(global, answer)?, None, program, answer)
    }

    /// The same over a known set; `None`: the built-in machine.
    pub fn over(
        global: &'a Global,
        base: Option<Base>,
        program: Option<&Path>,
        answer: Answer<'_>,
    ) -> Outcome<Self> {
        Self::of(global, base, None, program, answer)
    }

    /// The same for a simulated machine that will run `program` with the tick of `drive`.
    pub fn with_drive(global: &'a Global, drive: &Drive, program: &SourceFile) -> Outcome<Self> {
        let tick = drive.tick_us.map(|tick| format!("9000={tick}"));
        let (path, program) = (program.path(), &program.name());
        Self::of(global, None, tick, Some(path), Answer::Run { program })
    }

    /// A set in the flash of a simulated board is the board's own set, as on a real board [D107].
    fn of(
        global: &'a Global,
        base: Option<Base>,
        last: Option<String>,
        program: Option<&Path>,
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
        let (base, table) = match base {
            Some(base) => (Some(base.params), base.offsets),
            None => (None, Table::Unknown),
        };
        let base = base.or_else(|| stored.clone());
        let tap = match &kept {
            Some((state, flash)) => state.journal(flash)?,
            None => None,
        };
        let table = match &kept {
            // The way out of a hole needs no offsets: a damaged table does not keep a tap in it.
            Some(_) if tap.is_some_and(|record| record.in_hole) => Table::Unknown,
            Some((state, flash)) => Table::Board(state.offsets(flash)?.map(Box::new)),
            None => table,
        };
        let offsets = offsets_of(global, table)?;
        let set: Vec<String> = global.set.iter().cloned().chain(last).collect();
        let machine = program.and_then(beside::find);
        let mut files = global.params.clone();
        let mut said = None;
        match (&machine, &base) {
            (Some(file), None) => files.insert(0, file.clone()),
            // The board's own set counts.
            (Some(file), Some(board)) => {
                let over = Some(board.clone());
                let loaded =
                    params::load_over(over, std::slice::from_ref(file), &[], global.lang())?;
                let loaded = told_good_in(global, loaded, answer)?;
                if identity(&loaded.params) != identity(board) {
                    differs(file, global.lang());
                }
                said = Some((loaded.dialect, loaded.allow));
            }
            (None, _) => {}
        }
        let mut loaded = params::load_over(base, &files, &set, global.lang())?;
        let variables = match program {
            Some(_) => VariableFile::load(global, machine.as_deref(), &mut loaded.diagnostics)?,
            None => VariableFile::default(),
        };
        let loaded = told_good_in(global, loaded, answer)?;
        let (dialect, allow) = said.unwrap_or_default();
        let allow = loaded.allow.and(allow);
        let named = global.dialect.map(DialectName::control);
        let control = named.or(loaded.dialect).or(dialect).unwrap_or_default();
        let (params, profiles) = (loaded.params, loaded.profiles);
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
        Ok(Self {
            global,
            params,
            profiles,
            offsets,
            lang: global.lang(),
            signals: signals(global),
            colour: diagnostics::colour(),
            position: None,
            turning: false,
            gear: 0,
            tool: InPlace::default(),
            tap,
            kept,
            control,
            allow,
            machine,
            variables,
            carried: None,
            passes: Passes::Once,
            from: None,
        })
    }

    /// The context of a call for a tool at `at`, with the hole that a tap may be in.
    pub const fn context<'h>(&self, at: Position, hole: &'h Hole) -> Context<'h> {
        Context {
            at,
            signals: self.signals,
            tap: hole.record(),
        }
    }

    /// Position of the drives at power-up.
    pub fn power_up(&self) -> Position {
        power_up(self.global)
    }

    /// Start position of the tool. An axis with a tap in its hole stands at the bottom [D26].
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

    /// What a program begins with that is carried out once.
    pub fn begin(&self) -> Begin {
        Begin {
            options: self.options(),
            control: self.control,
            kept: self.variables.values.clone(),
            passes: Passes::Once,
            allowed: self.allow,
            carried: self.carried,
        }
    }

    /// The options for reading programs.
    pub fn options(&self) -> Options {
        Options {
            skip: self.global.skip,
            optional_stop: self.global.optional_stop,
            dry_run: self.global.dry_run,
            position: self.start(),
            passes_machine_codes: self.global.bus == Address::Sim,
            offsets: self.offsets,
            gear: self.gear,
            ..Options::default()
        }
    }

    /// The revision of the table that programs are resolved with; 0 where the parameters of old count.
    pub fn revision(&self) -> Revision {
        self.offsets
            .map_or(Revision::default(), |table| table.revision)
    }

    /// The machine file beside the program, as it is shown.
    pub fn machine(&self) -> Option<String> {
        self.machine.as_deref().map(words::path)
    }
}

/// Position of simulated drives at power-up.
pub fn power_up(global: &Global) -> Position {
    let at = global.at.unwrap_or_default();
    Position {
        x: Length::from_nm(at.x_nm),
        z: Length::from_nm(at.z_nm),
        c: Angle::from_udeg(at.c_udeg),
    }
}

/// The table that programs are resolved with: the board's, or without a board that of `--tools`.
fn offsets_of(global: &Global, known: Table) -> Outcome<Option<Offsets>> {
    let file = match &global.tools {
        Some(path) => Some((path, tools::read(path, global.lang())?)),
        None => None,
    };
    match (known, file) {
        (Table::Unknown, file) => Ok(file.map(|(_, table)| table)),
        (Table::Board(board), None) => Ok(board.map(|table| *table)),
        (Table::Board(board), Some((path, wanted))) => {
            let same = board
                .as_deref()
                .is_some_and(|board| tools::changes(board, &wanted).is_empty());
            if same {
                return Ok(board.map(|table| *table));
            }
            let file = words::path(path);
            Err(Failure::WrongBecause(both!(
                "`--tools {file}` is not the tool table of the board: leave it out, or write it first (`leadscrew tools push \
                 {file}`)",
                "`--tools {file}` 与控制板的刀具表不同：请去掉该选项，或先写入（`leadscrew tools push {file}`）"
            )))
        }
    }
}

/// Tells that a board does not have the set of the file beside the program.
fn differs(file: &Path, lang: Lang) {
    let file = words::path(file);
    let told = both!(
        "note: {file} differs from the parameters of the board, which count; `leadscrew params diff {file}` shows where\n",
        "注意：{file} 与控制板的参数不同，以控制板为准；`leadscrew params diff {file}` 可查看差异\n"
    );
    diagnostics::say(told.get(lang));
}

/// The inputs set by the options. The last value of a name counts.
fn signals(global: &Global) -> Signals {
    let mut signals = Signals::default();
    for set in &global.signal {
        signals.set(set.signal, set.level);
    }
    signals
}

/// The parameters of the options, with all their mistakes reported. A mistake ends the command.
pub fn load(global: &Global) -> Outcome<Loaded> {
    let base = board::base(global, Answer::Parameters)?;
    let base = base.map(|base| base.params);
    let loaded = params::load_over(base, &global.params, &global.set, global.lang())?;
    told_good(global, loaded)
}

/// Checks files and options by themselves: their own mistakes can be reported without a board.
///
/// # Errors
/// A file that cannot be read; mistakes in it, which have been reported.
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
    // The cross-checks may have another result over another set.
    let wrong = |d: &Diagnostic| !d.warning && matches!(d.number, ..4420 | 4440..4450);
    if loaded.diagnostics.iter().any(wrong) {
        return told_good_in(global, loaded, answer);
    }
    Ok(loaded)
}

/// Returns the set after reporting its mistakes. A mistake ends the command.
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

/// The form of a command's JSON result. The result has this form also where wrong parameters stop the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer<'a> {
    /// Only `ok`, `alarms` and `warnings`.
    Parameters,
    /// As for `check`: no file has been checked.
    Check,
    /// Lines, as for `expand`; `jsonl` where this is the format also without `--json`.
    Moves {
        /// `--format jsonl`.
        jsonl: bool,
    },
    /// As for `simulate` and `run`: nothing has moved.
    Run {
        /// The program's name as typed.
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
                    Threads::default().fields(&Judge::default(), o);
                }
            }
            loaded.report_fields(o);
            if let Self::Run { program } = self {
                let origin = Origin {
                    program: program.to_owned(),
                    parameters: None,
                    machine: None,
                    board: None,
                };
                origin.fields(o);
            }
        })
    }
}
