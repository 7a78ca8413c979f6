//! Tables of the board for the page: what is in them, and how they are changed.
//!
//! ```text
//! reading ──► what the panel has read of the board; the bus is not asked
//! change ───► looked at by that, or written: a link of its own, the code of `tools set` and `params push`, one transaction
//! touching ─► looked at by where the machine stands, or written: the same with the code of `touch`
//! ```
//!
//! A change names what it was made in: in another table or set nothing is written. This must not know pages, or who may
//! order.

mod params;
mod tools;
mod touch;

use std::sync::{Arc, Mutex, PoisonError};

use leadscrew_core::alarm::Lang;
use leadscrew_panel::Sheet;
use serde_json::Value;

pub use self::touch::Touching;
use super::object;
use super::views::Views;
use crate::cli::{Global, LangName};
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::words::{Both, both, is_obeyed, one_line};

/// More values than any table has.
const VALUES: usize = 512;
/// No name of a value, and no value, is longer.
const LONGEST: usize = 64;

/// Values of a table that are to be others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    sheet: Sheet,
    /// What it was made in: the revision of the table, the identity of the set.
    seen: String,
    /// Name and text of each.
    values: Vec<(String, String)>,
    /// It is looked at, and not written.
    check: bool,
    /// Warnings have been read.
    sure: bool,
    zh: bool,
}

impl Change {
    /// The change of this name; `None`: there is none, or what belongs to it is wrong.
    pub fn of(op: &str, args: &Value) -> Option<Self> {
        let sheet = match op {
            "tools" => Sheet::Tools,
            "params" => Sheet::Params,
            _ => return None,
        };
        let set = args["set"].as_object()?;
        if set.is_empty() || set.len() > VALUES {
            return None;
        }
        let mut values = Vec::new();
        for (key, value) in set {
            let key = short(key).filter(|key| !key.contains('='))?;
            values.push((key, short(value.as_str()?)?));
        }
        Some(Self {
            sheet,
            seen: short(args["seen"].as_str()?)?,
            values,
            check: args["check"].as_bool()?,
            sure: args["sure"] == true,
            zh: args["zh"] == true,
        })
    }

    const fn lang(&self) -> Lang {
        if self.zh { Lang::Zh } else { Lang::En }
    }

    /// Why nothing is written where the board has another one by now.
    fn stale(&self, what: &Both, now: &str) -> Option<Both> {
        let seen = one_line(&self.seen);
        let Both { en, zh } = what;
        (self.seen != now).then(|| {
            both!(
                "the board has {en} {now} by now, and these changes were made in {seen}: nothing has been written, and what was \
                 typed stays; look at the values that are new, then review again",
                "控制板现为{zh} {now}，而这些修改基于 {seen}：未写入任何内容，已输入的内容保留；请查看新值后重新核对"
            )
        })
    }
}

/// What is to be said of a value.
struct Complaint {
    /// Its name as it was sent; empty where it is none of them.
    key: String,
    /// With it nothing is written.
    bad: bool,
    words: Both,
}

/// What a change would do, or has done.
#[derive(Default)]
struct Told {
    /// Name, old value, new value.
    changes: Vec<[String; 3]>,
    complaints: Vec<Complaint>,
    notes: Vec<Both>,
    /// Why nothing has been written.
    why: Option<Both>,
}

impl Told {
    const fn refused(why: Both) -> Self {
        Self {
            changes: Vec::new(),
            complaints: Vec::new(),
            notes: Vec::new(),
            why: Some(why),
        }
    }

    /// With what is wrong nothing is written, and with a warning nothing that nobody has read.
    fn judge(&mut self, change: &Change) {
        let is = |bad| move |complaint: &Complaint| complaint.bad == bad;
        if self.complaints.iter().any(is(true)) {
            self.why = Some(both!(
                "nothing has been written: what is wrong stands beside its value; correct it, then review again",
                "未写入任何内容：错误已标在相应的值旁；请更正后重新核对"
            ));
        } else if !change.check && !change.sure && self.complaints.iter().any(is(false)) {
            self.why = Some(both!(
                "nothing has been written: there are warnings; review the changes again, then write them",
                "未写入任何内容：有警告；请重新核对后再写入"
            ));
        }
    }

    /// There is something to write, and nothing against it.
    fn writes(&self, change: &Change) -> bool {
        !change.check && self.why.is_none() && !self.changes.is_empty()
    }

    fn json(&self) -> String {
        object(|json| {
            json.flag("ok", self.why.is_none());
            if let Some(why) = &self.why {
                json.text("en", &why.en);
                json.text("zh", &why.zh);
            }
            put_changes(json, &self.changes);
            json.array_at("complaints", |list| {
                for Complaint { key, bad, words } in &self.complaints {
                    list.object(|o| {
                        o.text("key", key);
                        o.flag("bad", *bad);
                        o.text("en", &words.en);
                        o.text("zh", &words.zh);
                    });
                }
            });
            json.array_at("notes", |list| {
                for note in &self.notes {
                    list.object(|o| {
                        o.text("en", &note.en);
                        o.text("zh", &note.zh);
                    });
                }
            });
        })
    }
}

/// The tables of one board.
pub struct Tables {
    views: Arc<Views>,
    turn: Mutex<()>,
}

impl Tables {
    /// Nothing has been asked.
    pub const fn new(views: Arc<Views>) -> Self {
        Self {
            views,
            turn: Mutex::new(()),
        }
    }

    /// What is in a table, as JSON; `error` where it is not known.
    pub fn sheet(&self, sheet: Sheet, zh: bool) -> String {
        let read = self.views.has().and_then(|(base, tag)| match sheet {
            Sheet::Tools => tools::sheet(&base, &tag),
            Sheet::Params => Ok(params::sheet(
                &base.params,
                &tag,
                if zh { Lang::Zh } else { Lang::En },
            )),
        });
        read.unwrap_or_else(|failure| {
            let words = said(failure);
            object(|json| json.text("error", if zh { &words.zh } else { &words.en }))
        })
    }

    /// Looks at a change or writes it, one at a time, and says what has become of it, as JSON.
    /// Where `void` says why by the time that it is its turn, nothing is done.
    pub fn change(&self, change: &Change, void: &dyn Fn() -> Option<Both>) -> String {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(why) = void() {
            return Told::refused(why).json();
        }
        let told = self.told(change);
        told.unwrap_or_else(|failure| Told::refused(said(failure)))
            .json()
    }

    /// Waits for the end of one that is under way.
    pub fn settle(&self) {
        drop(self.turn.lock());
    }

    /// Looks at a touch or writes it, in turn with the changes.
    pub fn touch(&self, touching: &Touching, void: &dyn Fn() -> Option<Both>) -> String {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(why) = void() {
            return Told::refused(why).json();
        }
        touching.answer(&self.global(touching.zh))
    }

    /// The options of the panel, for a command that nobody at its terminal has typed.
    pub fn global(&self, zh: bool) -> Global {
        Global {
            // No bar and no question on the terminal of the panel.
            json: true,
            dry_run: false,
            lang: if zh { LangName::Zh } else { LangName::En },
            ..self.views.global().clone()
        }
    }

    fn told(&self, change: &Change) -> Outcome<Told> {
        let global = self.global(change.zh);
        match (change.sheet, change.check) {
            (Sheet::Tools, true) => tools::check(&self.views.has()?.0, change),
            (Sheet::Tools, false) => tools::write(&global, change),
            (Sheet::Params, true) => params::check(&self.views.has()?.0.params, change),
            (Sheet::Params, false) => params::write(&global, change),
        }
    }
}

/// A text that is no longer than a name or a value may be.
fn short(text: &str) -> Option<String> {
    let fits = text.len() <= LONGEST && !text.chars().any(is_obeyed);
    fits.then(|| text.to_owned())
}

/// A list of changes: name, old value, new value.
fn put_changes(json: &mut Json, changes: &[[String; 3]]) {
    json.array_at("changes", |list| {
        for [key, old, new] in changes {
            list.object(|o| {
                o.text("key", key);
                o.text("old", old);
                o.text("new", new);
            });
        }
    });
}

/// The words of a failure.
pub fn said(failure: Failure) -> Both {
    failure.words().unwrap_or_else(|| {
        both!(
            "the change was not carried out: look at the alarms",
            "修改未执行：请查看报警"
        )
    })
}

#[cfg(test)]
mod tests;
