//! What differs between two tables, for people and for machines. Revisions do not count.

use std::fmt::Write as _;

use leadscrew_core::offsets::Offsets;

use super::{Key, Raw};
use crate::json::Json;

/// A value that differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// Which one.
    pub key: Key,
    /// In the first table.
    pub old: Raw,
    /// In the second.
    pub new: Raw,
}

/// All that differs, in the order of files.
#[must_use]
pub fn changes(old: &Offsets, new: &Offsets) -> Vec<Change> {
    let both = Key::all().map(|key| Change {
        key,
        old: key.get(old),
        new: key.get(new),
    });
    both.filter(|change| change.old != change.new).collect()
}

/// A line each.
#[must_use]
pub fn text(changes: &[Change]) -> String {
    let width = changes.iter().map(|c| c.key.to_string().len()).max();
    let mut out = String::new();
    for Change { key, old, new } in changes {
        let name = key.to_string();
        let (old, new) = (key.shown(*old), key.shown(*new));
        let quoted = |text: String| if text.is_empty() { "-".into() } else { text };
        // Writing into a string cannot fail.
        let _ = writeln!(
            out,
            "{name:width$}  {} → {}",
            quoted(old),
            quoted(new),
            width = width.unwrap_or(0)
        );
    }
    out
}

/// `changes` of a result.
pub fn fields(json: &mut Json, changes: &[Change]) {
    json.array_at("changes", |list| {
        for Change { key, old, new } in changes {
            list.object(|o| {
                o.text("key", &key.to_string());
                value(o, "old", *key, *old);
                value(o, "new", *key, *new);
            });
        }
    });
}

/// A value: a number, or the letters of the measured axes.
pub fn value(json: &mut Json, name: &str, key: Key, raw: Raw) {
    match key {
        Key::Tool(_, super::Field::Measured) => json.text(name, &key.shown(raw)),
        Key::Thread(super::Groove::Angle) if raw < 0 => json.text(name, &key.shown(raw)),
        _ => json.number(name, key.shown(raw)),
    }
}
