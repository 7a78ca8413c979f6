//! Tools and work offsets: the keys and texts of `tools list` and `offsets list`, written as `tools set` does.

use leadscrew_core::offsets::Offsets;

use super::super::super::{Base, Table};
use super::super::object;
use super::{Change, Complaint, Told};
use crate::cli::Global;
use crate::commands::tools::{Home, of_params};
use crate::failure::Outcome;
use crate::tools::{Change as Changed, Key, changes, much, unknown};
use crate::words::both;

/// The table that is in force.
fn table(base: &Base) -> Outcome<Offsets> {
    match &base.offsets {
        Table::Board(Some(table)) => Ok(**table),
        Table::Board(None) | Table::Unknown => of_params(&base.params),
    }
}

/// All of it, by its keys. A thread that was picked up is none of a tool's, and is not touched.
pub fn sheet(base: &Base, tag: &str) -> Outcome<String> {
    let table = table(base)?;
    Ok(object(|json| {
        json.text("by", tag);
        json.text("seen", &table.revision.0.to_string());
        json.object_at("values", |json| {
            for key in Key::all().filter(is_shown) {
                json.text(&key.to_string(), &key.shown(key.get(&table)));
            }
        });
    }))
}

const fn is_shown(key: &Key) -> bool {
    !matches!(key, Key::Thread(_))
}

/// What a change would do.
pub fn check(base: &Base, change: &Change) -> Outcome<Told> {
    Ok(laid_over(&table(base)?, change).0)
}

/// Does it: the board stores all of it, or nothing.
pub fn write(global: &Global, change: &Change) -> Outcome<Told> {
    let mut home = Home::open(global)?;
    home.is_whole()?;
    let (told, table) = laid_over(&home.table, change);
    if told.writes(change) {
        home.commit(&table)?;
    }
    Ok(told)
}

fn laid_over(old: &Offsets, change: &Change) -> (Told, Offsets) {
    let mut new = *old;
    let what = both!("revision", "修订号");
    if let Some(why) = change.stale(&what, &old.revision.0.to_string()) {
        return (Told::refused(why), new);
    }
    let mut told = Told::default();
    for (name, text) in &change.values {
        let put = match Key::find(name)[..] {
            [key] if is_shown(&key) => key.parse(text).and_then(|raw| key.set(&mut new, raw)),
            _ => Err(unknown(name)),
        };
        if let Err(words) = put {
            told.complaints.push(Complaint {
                key: name.clone(),
                bad: true,
                words,
            });
        }
    }
    let changes = changes(old, &new);
    for key in much(&changes) {
        told.complaints.push(Complaint {
            key: key.to_string(),
            bad: false,
            words: both!(
                "{key} changes by more than 1 mm, which is hardly wear",
                "{key} 的变化超过 1 mm，不像是磨损"
            ),
        });
    }
    told.changes = texts(&changes);
    told.judge(change);
    (told, new)
}

/// Name, old value and new value of each.
pub(super) fn texts(changes: &[Changed]) -> Vec<[String; 3]> {
    let text = |one: &Changed| {
        let [old, new] = [one.old, one.new].map(|raw| one.key.shown(raw));
        [one.key.to_string(), old, new]
    };
    changes.iter().map(text).collect()
}
