//! The messages that the page sends, and their answers. A worker carries them today; they have nothing of it in them.

use leadscrew_board_sim::SimError;
use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::alarm::Lang;
use leadscrew_core::board::Command;
use leadscrew_core::params::{Entry, Params};
use leadscrew_inspection::Cutting;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::examples::FOLDERS;
use crate::machine::{Fault, Machine, drive};
use crate::program::{Found, Program};
use crate::thread::Thread;

/// What stays between two messages: at most one machine, and the language.
#[derive(Default)]
pub struct Session {
    machine: Option<Machine>,
    lang: Lang,
}

/// What is asked.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
enum Ask {
    /// The programs that come along.
    Examples,
    /// What is wrong with a program, and its path.
    Check(Job),
    /// The same, and a machine at power-up with the program in it.
    Load(Job),
    /// Time passes.
    Step { ticks: u32 },
    /// Feed hold.
    Hold,
    /// On after feed hold.
    Resume,
    /// Something goes wrong.
    Fault { what: Fault },
    /// No machine any more.
    Reset,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Job {
    text: String,
    /// The folder whose machine it is.
    folder: String,
    zh: bool,
    /// Amplitude in thousandths of a percent and frequency in thousandths of a hertz.
    ripple: Option<[u32; 2]>,
    /// Counts of the spindle encoder for a turn.
    counts: Option<u32>,
    /// Gain of the drives' position loops in 1/s; ideal drives where there is none.
    kv: Option<u32>,
    /// The threads are cut and measured.
    #[serde(default)]
    measure: bool,
}

/// A refusal that is no alarm of the machine, by its key in the words of the page.
#[derive(Debug, Serialize)]
struct Refused {
    refused: &'static str,
    figure: String,
}

fn refused(refused: &'static str, figure: impl ToString) -> Refused {
    let figure = figure.to_string();
    Refused { refused, figure }
}

/// Answers a message.
pub fn answer(session: &mut Session, message: &[u8]) -> Vec<u8> {
    let value = match serde_json::from_slice(message) {
        Err(error) => Err(refused("message", error)),
        Ok(ask) => session.answer(ask),
    };
    let value = value.unwrap_or_else(|refused| json!(refused));
    value.to_string().into_bytes()
}

impl Session {
    fn answer(&mut self, ask: Ask) -> Result<Value, Refused> {
        match ask {
            Ask::Examples => Ok(examples()),
            Ask::Check(job) => Ok(checked(&job.read(&job.params()?)?)),
            Ask::Load(job) => self.load(&job),
            Ask::Step { ticks } => {
                self.at_work()?.step(ticks);
                self.state()
            }
            Ask::Hold => self.command(Command::Hold),
            Ask::Resume => self.command(Command::Resume),
            Ask::Fault { what } => {
                self.at_work()?.fault(what);
                self.state()
            }
            Ask::Reset => {
                self.machine = None;
                Ok(json!({}))
            }
        }
    }

    fn load(&mut self, job: &Job) -> Result<Value, Refused> {
        self.machine = None;
        self.lang = job.lang();
        let params = job.params()?;
        let mut program = job.read(&params)?;
        if program.is_good() {
            let calls = std::mem::take(&mut program.calls);
            let threads = std::mem::take(&mut program.threads);
            let cutting = job.measure.then(|| Cutting::new(threads));
            let machine = Machine::new(&params, &job.options()?, calls, cutting);
            self.machine = Some(machine.map_err(|error| match error {
                SimError::Board(alarm) => refused("alarm", Found::new(&alarm, self.lang, false)),
                SimError::Plant(error) => refused("plant", format!("{error:?}")),
            })?);
        }
        Ok(checked(&program))
    }

    fn command(&mut self, command: Command) -> Result<Value, Refused> {
        self.at_work()?.command(command);
        self.state()
    }

    fn at_work(&mut self) -> Result<&mut Machine, Refused> {
        self.machine.as_mut().ok_or_else(|| refused("nothing", ""))
    }

    fn state(&mut self) -> Result<Value, Refused> {
        let lang = self.lang;
        let machine = self.at_work()?;
        let told = std::mem::take(&mut machine.told);
        let told = told.iter().map(|alarm| Found::new(alarm, lang, false));
        Ok(json!({
            "state": machine.state(),
            "samples": machine.samples(),
            "threads": machine.cuts().iter().map(Thread::of).collect::<Vec<_>>(),
            "told": told.collect::<Vec<_>>(),
        }))
    }
}

impl Job {
    const fn lang(&self) -> Lang {
        if self.zh { Lang::Zh } else { Lang::En }
    }

    fn read(&self, params: &Params) -> Result<Program, Refused> {
        Program::read(self.text.as_bytes(), params, self.lang())
            .map_err(|error| refused("message", error))
    }

    fn params(&self) -> Result<Params, Refused> {
        let folder = FOLDERS.iter().find(|folder| folder.name == self.folder);
        let folder = folder.ok_or_else(|| refused("folder", &self.folder))?;
        let mut params = folder.params();
        if let Some(counts) = self.counts {
            let set = Entry::find_text("encoder_counts")
                .is_ok_and(|entry| params.set(entry, counts.into()).is_ok());
            if !set {
                return Err(refused("counts", counts));
            }
        }
        params
            .validate()
            .map_err(|alarm| refused("alarm", Found::new(&alarm, self.lang(), false)))?;
        Ok(params)
    }

    fn options(&self) -> Result<PlantOptions, Refused> {
        let ripple = match self.ripple {
            None => None,
            Some([percent, hertz]) => {
                let ripple = Ripple::new(percent, hertz);
                Some(ripple.ok_or_else(|| refused("ripple", format!("{percent}@{hertz}")))?)
            }
        };
        Ok(PlantOptions {
            ripple,
            servos: [self.kv.map(drive); 2],
            ..PlantOptions::default()
        })
    }
}

fn checked(program: &Program) -> Value {
    json!({
        "good": program.is_good(),
        "found": program.found,
        "path": program.path,
        "too_long": program.too_long,
    })
}

fn examples() -> Value {
    let each = FOLDERS.iter().flat_map(|folder| {
        let of = |(name, text): &(&str, &str)| json!({"folder": folder.name, "name": name, "text": text});
        folder.programs.iter().map(of)
    });
    each.collect()
}
