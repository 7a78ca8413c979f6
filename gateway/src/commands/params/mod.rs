//! `params`: one file a verb, and what they share: a value as text and as JSON.

mod block;
mod diff;
mod docs;
mod drive;
mod eds;
mod get;
mod home;
mod list;
mod migrate;
mod pdo;
mod pull;
mod push;
mod restore;
mod validate;
mod write;

pub use push::{Wish, carry_out, transact};

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, Params, Part};

use crate::cli::{Global, ParamsCommand};
use crate::failure::Outcome;
use crate::json::Json;
use crate::output;
use crate::params::{Loaded, meaning};

/// Does what was typed.
pub fn run(global: &Global, command: &ParamsCommand) -> Outcome {
    match command {
        ParamsCommand::List { filter } => list::run(global, filter.as_deref()),
        ParamsCommand::Get { keys } => get::run(global, keys),
        ParamsCommand::Validate => validate::run(global),
        ParamsCommand::Docs { eds } => docs::run(global, *eds),
        ParamsCommand::Write(args) => write::run(global, args),
        ParamsCommand::Pull(args) => pull::run(global, args),
        ParamsCommand::Push(args) => push::run(global, args),
        ParamsCommand::Restore(args) => restore::run(global, args),
        ParamsCommand::Diff(args) => diff::run(global, args),
        ParamsCommand::Migrate(args) => migrate::run(global, args),
    }
}

/// The unit as a table shows it: a diameter says that it is one.
fn unit_text(entry: &Entry, lang: Lang) -> String {
    match (entry.unit().is_diameter(), lang) {
        (false, _) => entry.unit().symbol().into(),
        (true, Lang::En) => format!("{} (diameter)", entry.unit().symbol()),
        (true, Lang::Zh) => format!("{}（直径值）", entry.unit().symbol()),
    }
}

/// One value with its definition, an element of `params` in the machine format.
fn json(json: &mut Json, entry: &Entry, loaded: &Loaded, lang: Lang) {
    let number = |json: &mut Json, key: &str, raw| {
        if entry.none() == Some(raw) {
            json.null(key);
        } else {
            json.number(key, entry.unit().number(raw));
        }
    };
    json.object(|o| {
        o.text("key", &entry.to_string());
        o.integer("no", i64::from(entry.no));
        if let Some(alias) = entry.alias() {
            o.integer("alias", i64::from(alias));
        }
        match entry.part {
            Part::Whole => {}
            Part::Bit(bit) => o.integer("bit", i64::from(bit)),
            Part::Axis(axis) => {
                o.text("axis", char::from(axis.letter()).encode_utf8(&mut [0; 4]));
            }
        }
        o.text("name", entry.text().name);
        number(o, "value", loaded.params.get(entry));
        o.text("unit", entry.unit().symbol());
        if entry.unit().is_diameter() {
            o.flag("diameter", true);
        }
        number(o, "min", entry.min());
        number(o, "max", entry.max());
        if entry.none().is_some() {
            o.flag("none_allowed", true);
        }
        number(o, "default", Params::slant_bed().get(entry));
        if let Some(source) = loaded.source(entry) {
            o.text("set_by", &source);
        }
        o.text("meaning", meaning(entry, lang));
        o.text("sheet", entry.text().sheet);
    });
}

/// `{"params":[…]}` of some entries.
fn json_list<'a>(entries: impl Iterator<Item = &'a Entry>, loaded: &Loaded, lang: Lang) -> Vec<u8> {
    output::line(|o| list_at(o, entries, loaded, lang))
}

/// `params` of an object.
pub fn list_at<'a>(
    o: &mut Json,
    entries: impl Iterator<Item = &'a Entry>,
    loaded: &Loaded,
    lang: Lang,
) {
    o.array_at("params", |list| {
        for entry in entries {
            json(list, entry, loaded, lang);
        }
    });
}
