//! What is to be known of a program without running it: what `check` says, and the path, both by the parameters and the
//! table that the board has now. The bus is not asked for it.
//!
//! This must not know pages. One program is looked at at a time: it takes a processor, and the machine's side needs one
//! too.

use std::path::Path;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use leadscrew_core::call::Position;
use leadscrew_core::link::Status;
use leadscrew_core::offsets::Offsets;
use leadscrew_core::params::Params;
use leadscrew_panel::View;

use super::super::{Base, Table};
use super::{object, path};
use crate::checking::{self, Detail};
use crate::cli::{Global, LangName};
use crate::failure::{Failure, Outcome};
use crate::setup::{Answer, Setup};
use crate::source::SourceFile;
use crate::start::{self, Shown, Unfound};
use crate::words::{self, Both, both, pick};

/// What a board has.
#[derive(Debug)]
struct Known {
    base: Base,
    /// Names both: another one where either is another, and after each loss of the board.
    tag: String,
    /// Where its axes stand.
    position: Position,
}

/// Looks at programs.
#[derive(Debug)]
pub struct Views {
    /// With the options of the panel.
    global: Global,
    known: Mutex<Option<Known>>,
    /// Where the axes stood when the program began that runs from here.
    begun: Mutex<Option<Position>>,
    /// The gear that is in, as its program has to know.
    gear: AtomicU8,
    /// How often the board was lost.
    losses: AtomicU32,
    turn: Mutex<()>,
}

impl Views {
    /// Nothing is known of the board yet.
    pub fn new(global: &Global) -> Self {
        Self {
            global: Global {
                // What the loading of parameters says to a program is for nobody.
                json: false,
                ..global.clone()
            },
            known: Mutex::default(),
            begun: Mutex::default(),
            gear: AtomicU8::new(0),
            losses: AtomicU32::new(0),
            turn: Mutex::default(),
        }
    }

    /// With the options of the panel.
    pub const fn global(&self) -> &Global {
        &self.global
    }

    /// The parameters and the table that the board has, and the tag of both.
    ///
    /// # Errors
    /// They are not known.
    pub fn has(&self) -> Outcome<(Base, String)> {
        let known = self.known();
        let known = known
            .as_ref()
            .map(|known| (known.base.clone(), known.tag.clone()));
        known.ok_or_else(|| Failure::WrongBecause(unread()))
    }

    fn known(&self) -> MutexGuard<'_, Option<Known>> {
        // It is replaced whole.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Nothing is known of the board any more. Another one may be found in its place, with a table of the same revision.
    pub fn forget(&self) {
        self.losses.fetch_add(1, Ordering::Relaxed);
        *self.known() = None;
        self.begin(None);
        self.note_gear(0);
    }

    /// Takes where the axes stand. A program is looked at from there at once, not from where they stood a second ago.
    pub fn note_place(&self, position: Position) {
        if let Some(known) = &mut *self.known() {
            known.position = position;
        }
    }

    /// Takes what the board has; `None` where that is not known. Nothing is renewed where it has the same as before.
    pub fn note(&self, read: Option<(&Params, Option<&Offsets>)>, status: &Status) {
        let mut known = self.known();
        let Some((params, table)) = read else {
            *known = None;
            return;
        };
        let revision = table.map_or(0, |table| table.revision.0);
        let losses = self.losses.load(Ordering::Relaxed);
        let tag = format!("{revision}-{:08x}-{losses}", status.parameters);
        if known.as_ref().is_some_and(|known| known.tag == tag) {
            return;
        }
        *known = Some(Known {
            base: Base {
                params: params.clone(),
                offsets: Table::Board(table.copied().map(Box::new)),
            },
            tag,
            position: status.position,
        });
    }

    /// A program begins where the axes stand, or has ended: while it runs, paths begin where it has begun.
    pub fn begin(&self, at: Option<Position>) {
        *self.begun.lock().unwrap_or_else(PoisonError::into_inner) = at;
    }

    /// Takes the gear that is in.
    pub fn note_gear(&self, gear: u8) {
        self.gear.store(gear, Ordering::Relaxed);
    }

    /// By what programs are looked at now.
    pub fn tag(&self) -> Option<String> {
        self.known().as_ref().map(|known| known.tag.clone())
    }

    /// What is asked of a program, as JSON; `error` where there is nothing to say.
    pub fn of(&self, program: &Path, view: View, zh: bool) -> String {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        self.look(program, view, zh).unwrap_or_else(|failure| {
            let words = failure.words().unwrap_or_else(unsaid);
            let text = if zh { &words.zh } else { &words.en };
            object(|json| json.text("error", text))
        })
    }

    fn look(&self, program: &Path, view: View, zh: bool) -> Outcome<String> {
        let known = self.known();
        let (base, tag, position) = match &*known {
            Some(known) => (known.base.clone(), known.tag.clone(), known.position),
            None => return Err(Failure::WrongBecause(unread())),
        };
        drop(known);
        let mut global = self.global.clone();
        global.lang = if zh { LangName::Zh } else { LangName::En };
        let source = SourceFile::new(program);
        let mut setup = Setup::over(&global, Some(base), Some(program), Answer::Check)?;
        if let View::Start(line) = view {
            setup.position = Some(position);
            if setup.params.has_gears() {
                setup.gear = self.gear.load(Ordering::Relaxed);
            }
            let found = start::find(&setup, &source, line).map_err(unfound)?;
            let (start, shown) = Shown::of(found, &setup, &source)?;
            return Ok(object(|json| {
                json.text("by", &tag);
                json.text("shown", &shown.to_string());
                json.text("text", start::shown(&start, &setup).get(setup.lang));
            }));
        }
        if view == View::Path {
            let begun = *self.begun.lock().unwrap_or_else(PoisonError::into_inner);
            setup.position = Some(begun.unwrap_or(position));
            return path::json(&setup, &source, &tag);
        }
        let report = checking::check(&setup, &source, Detail::Verdict)?;
        let further: String = report
            .unlisted
            .iter()
            .map(|kind| kind.words().get(setup.lang).to_owned() + pick(setup.lang, ". ", "。"))
            .collect();
        Ok(object(|json| {
            json.text("by", &tag);
            json.flag("ok", report.alarms.is_empty());
            json.integer("moves", i64::try_from(report.moves).unwrap_or(i64::MAX));
            json.text("more", further.trim_end());
            for (key, list) in [("alarms", &report.alarms), ("warnings", &report.warnings)] {
                json.array_at(key, |json| {
                    // Of the text itself no file is named.
                    for diagnostic in list {
                        json.object(|json| diagnostic.fields(json, false));
                    }
                });
            }
        }))
    }
}

/// Why a line is no start, with the place of what is wrong: of the text itself no file is named.
fn unfound(unfound: Unfound) -> Failure {
    let told = match unfound {
        Unfound::Wrong(told) => told,
        Unfound::Because(failure) => return failure,
    };
    let file = match told.counted == told.line {
        true => String::new(),
        false => Path::new(&told.file)
            .file_name()
            .map_or_else(String::new, |name| {
                words::one_line(&name.to_string_lossy()) + ":"
            }),
    };
    let (number, line) = (told.number, told.line);
    let words = format!("{file}{line}: {number:04} {}; {}", told.message, told.help);
    Failure::WrongBecause(Both::same(words))
}

fn unread() -> Both {
    both!(
        "the parameters and the tool table of the board are not read yet, or the table is damaged: look at the alarms",
        "尚未读到控制板的参数和刀具表，或刀具表已损坏：请查看报警"
    )
}

/// Of a failure that has told its reason elsewhere.
fn unsaid() -> Both {
    both!(
        "the machine file beside the program is wrong: `leadscrew check` says where",
        "程序旁边的机床文件有误：`leadscrew check` 会指出位置"
    )
}
