//! `tools set`, `offsets set` and `tools push`: a change of the table, stored by the board whole or not at all.

use std::io::{self, BufRead as _, IsTerminal as _};

use leadscrew_core::offsets::Offsets;

use super::home::Home;
use crate::cli::{Assign, Global, PushTools};
use crate::commands::ending;
use crate::diagnostics::say;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::tools::{self, Change, Key, changes, much, unknown};
use crate::words::{both, pick};

/// Sets single values.
pub fn run(global: &Global, args: &Assign, belongs: impl Fn(Key) -> bool) -> Outcome {
    for text in &args.values {
        let (key, _) = tools::parts(text).map_err(Failure::Usage)?;
        let key = key.strip_suffix(['+', '-']).unwrap_or(key);
        if !Key::find(key).into_iter().all(&belongs) {
            return Err(Failure::Usage(unknown(key)));
        }
    }
    let mut home = Home::open(global)?;
    home.is_whole()?;
    home.board()?;
    let mut table = home.table;
    for text in &args.values {
        tools::assign(&mut table, text).map_err(Failure::WrongBecause)?;
    }
    change(global, &mut home, &table, args.yes)
}

/// Sends files.
pub fn push(global: &Global, args: &PushTools) -> Outcome {
    // What is wrong with the files by themselves needs no board to be told.
    for file in &args.files {
        tools::read(file, global.lang())?;
    }
    let mut home = Home::open(global)?;
    home.warn(global);
    home.board()?;
    let mut table = home.table;
    for file in &args.files {
        tools::apply(&mut table, file, global.lang())?;
    }
    change(global, &mut home, &table, args.yes)
}

/// Carries a change out, or shows it.
pub fn change(global: &Global, home: &mut Home, table: &Offsets, yes: bool) -> Outcome {
    let changes = changes(&home.table, table);
    let much = much(&changes);
    if !much.is_empty() && !yes && !global.dry_run {
        ask(global, &much, &changes)?;
    }
    let is_new = home.is_whole().is_err();
    if !global.dry_run && (!changes.is_empty() || is_new) {
        home.commit(table)?;
    }
    tell(global, home, &changes)
}

/// Asks about a wear that jumps. Where nobody can answer, it is refused.
fn ask(global: &Global, much: &[Key], changes: &[Change]) -> Outcome {
    let lang = global.lang();
    let keys: Vec<_> = much.iter().map(Key::to_string).collect();
    let keys = keys.join(", ");
    if io::stdin().is_terminal() && !global.json {
        say(&tools::text(changes));
        let question = both!(
            "{keys} changes by more than 1 mm. Write it? [y/N] ",
            "{keys} 的变化超过 1 mm。确定写入吗？[y/N] "
        );
        say(question.get(lang));
        let mut answer = String::new();
        let read = io::stdin().lock().read_line(&mut answer);
        if read.is_ok() && matches!(answer.trim(), "y" | "Y" | "yes") {
            return Ok(());
        }
    }
    Err(Failure::WrongBecause(both!(
        "{keys} changes by more than 1 mm, which is hardly wear; nothing has been written: `--yes` writes it",
        "{keys} 的变化超过 1 mm，不像是磨损；未写入任何内容：确实如此请加 `--yes`"
    )))
}

fn tell(global: &Global, home: &Home, changes: &[Change]) -> Outcome {
    let lang = global.lang();
    let revision = home.table.revision.0;
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.flag("done", !global.dry_run && !changes.is_empty());
            o.integer("revision", revision.into());
            tools::fields(o, changes);
        });
    }
    if changes.is_empty() {
        return output::write(pick(lang, "nothing to change\n", "无需更改\n").as_bytes());
    }
    let end = ending(global, &both!("revision {revision}", "修订号 {revision}"));
    output::write((tools::text(changes) + end.get(lang)).as_bytes())
}
