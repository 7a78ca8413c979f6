//! Parameters: the rows of `params list`, laid over the board's set as `--set` is, written as `params push` does.

use leadscrew_core::alarm::Lang;
use leadscrew_core::link::identity;
use leadscrew_core::params::{Entry, Params};

use super::super::super::Machine;
use super::super::object;
use super::{Change, Complaint, Told};
use crate::cli::Global;
use crate::commands::params::{carry_out, list_at};
use crate::failure::Outcome;
use crate::params::difference::changes;
use crate::params::{Loaded, load_over, value_text};
use crate::words::{Both, both};

/// All of them.
pub fn sheet(params: &Params, tag: &str, lang: Lang) -> String {
    let loaded = Loaded::of(params.clone());
    object(|json| {
        json.text("by", tag);
        json.text("seen", &name(params));
        list_at(json, Entry::all().iter(), &loaded, lang);
    })
}

/// The name of a set.
fn name(params: &Params) -> String {
    format!("{:08x}", identity(params))
}

/// What a change would do.
pub fn check(params: &Params, change: &Change) -> Outcome<Told> {
    Ok(laid_over(params, change)?.0)
}

/// Does it: the board takes the whole set into force and stores it, or keeps the old one.
pub fn write(global: &Global, change: &Change) -> Outcome<Told> {
    let mut machine = Machine::meet(global)?;
    let (mut told, wanted) = laid_over(&machine.params, change)?;
    if let Some(wanted) = wanted.filter(|_| told.writes(change)) {
        let done = carry_out(global, &mut machine, &wanted, None)?;
        told.notes = done.notes;
    }
    Ok(told)
}

fn laid_over(old: &Params, change: &Change) -> Outcome<(Told, Option<Loaded>)> {
    let what = both!("the parameters", "参数集");
    if let Some(why) = change.stale(&what, &name(old)) {
        return Ok((Told::refused(why), None));
    }
    let line = |(key, text): &(String, String)| format!("{key}={text}");
    let options: Vec<String> = change.values.iter().map(line).collect();
    let loaded = load_over(Some(old.clone()), &[], &options, change.lang())?;
    let mut told = Told::default();
    for found in &loaded.diagnostics {
        // The option that it is about, if it is about one.
        let key = found.text().and_then(|text| text.split_once('='));
        told.complaints.push(Complaint {
            key: key.map(|(key, _)| key.to_owned()).unwrap_or_default(),
            bad: !found.warning,
            words: Both::same(format!(
                "{:04} {}; {}",
                found.number, found.message, found.help
            )),
        });
    }
    let texts = changes(old, &loaded.params).into_iter().map(|one| {
        let [old, new] = [one.old, one.new].map(|raw| value_text(one.entry, raw));
        [one.entry.to_string(), old, new]
    });
    told.changes = texts.collect();
    told.judge(change);
    Ok((told, Some(loaded)))
}
