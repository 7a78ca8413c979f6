//! `params get`: single parameters, with range and source.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, FindError, Params};

use super::json_list;
use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::params::{Loaded, functions, meaning, name, unknown_key, value_text};
use crate::setup;
use crate::words::Both;

/// Prints what the keys name; a number with bits or axes means all of them.
pub fn run(global: &Global, keys: &[String]) -> Outcome {
    let lang = global.lang();
    let mut entries = Vec::new();
    for key in keys {
        match Entry::find_text(key) {
            Ok(entry) => entries.push(entry),
            Err(FindError::PartMissing(first)) => {
                entries.extend(Entry::all().iter().filter(|e| e.no == first.no));
            }
            Err(error) => {
                let told = unknown_key(key, error, lang);
                return Err(Failure::Usage(Both::same(format!(
                    "{}; {}",
                    told.message, told.help
                ))));
            }
        }
    }
    let loaded = setup::load(global)?;
    if global.json {
        return output::write(&json_list(entries.into_iter(), &loaded, lang));
    }
    let mut out = String::new();
    for entry in entries {
        describe(&mut out, entry, &loaded, lang);
    }
    output::write(out.as_bytes())
}

fn describe(out: &mut String, entry: &Entry, loaded: &Loaded, lang: Lang) {
    let value = value_text(entry, loaded.params.get(entry));
    let built_in = value_text(entry, Params::slant_bed().get(entry));
    let (min, max) = (
        entry.unit().number(entry.min()),
        entry.unit().text(entry.max()),
    );
    let alias = entry.alias().map(|a| format!("/{a}")).unwrap_or_default();
    let source = loaded.source(entry);
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{entry}{alias} {} = {value}", name(entry));
    if let Some(words) =
        functions::row_of(entry).and_then(|_| functions::words(loaded.params.get(entry)))
    {
        let _ = writeln!(out, "    {words}");
    }
    let _ = writeln!(out, "    {}", meaning(entry, lang));
    let _ = match (lang, source) {
        (Lang::En, None) if loaded.of_a_board => {
            writeln!(
                out,
                "    {min} to {max}; the board's value, built in {built_in}"
            )
        }
        (Lang::Zh, None) if loaded.of_a_board => {
            writeln!(out, "    {min} 至 {max}；控制板的值，内置值 {built_in}")
        }
        (Lang::En, None) => writeln!(out, "    {min} to {max}; the built-in machine's value"),
        (Lang::En, Some(by)) => {
            writeln!(out, "    {min} to {max}; set by {by}, built in {built_in}")
        }
        (Lang::Zh, None) => writeln!(out, "    {min} 至 {max}；内置机床的值"),
        (Lang::Zh, Some(by)) => {
            writeln!(out, "    {min} 至 {max}；由 {by} 设定，内置值 {built_in}")
        }
    };
}
