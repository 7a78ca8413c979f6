//! `params list`: every parameter and its value, a line each.

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Entry;

use super::json_list;
use crate::cli::Global;
use crate::commands::table::table;
use crate::failure::Outcome;
use crate::output;
use crate::params::{Loaded, meaning, name, value_text};
use crate::setup;

/// Prints the table.
pub fn run(global: &Global, filter: Option<&str>) -> Outcome {
    let loaded = setup::load(global)?;
    let lang = global.lang();
    let wanted = filter.unwrap_or_default().to_lowercase();
    let entries = Entry::all().iter().filter(|e| matches(e, &wanted));
    if global.json {
        return output::write(&json_list(entries, &loaded, lang));
    }
    let rows: Vec<_> = entries.map(|e| row(e, &loaded, lang)).collect();
    let head = match lang {
        Lang::En => ["No.", "alias", "name", "value", "meaning"],
        Lang::Zh => ["号", "别号", "名称", "值", "含义"],
    };
    output::write(table(&head.map(String::from), &rows).as_bytes())
}

fn matches(entry: &Entry, wanted: &str) -> bool {
    let text = entry.text();
    let alias = entry.alias().map(|a| a.to_string()).unwrap_or_default();
    [&entry.to_string(), &alias, &name(entry), text.en, text.zh]
        .iter()
        .any(|field| field.to_lowercase().contains(wanted))
}

/// A star marks what differs from the built-in machine's file.
fn row(entry: &Entry, loaded: &Loaded, lang: Lang) -> [String; 5] {
    let mut value = value_text(entry, loaded.params.get(entry));
    if loaded.source(entry).is_some() {
        value.push_str(" *");
    }
    [
        entry.to_string(),
        entry.alias().map(|a| a.to_string()).unwrap_or_default(),
        name(entry),
        value,
        meaning(entry, lang).to_owned(),
    ]
}
