//! `params diff`: what differs between two sets. Exit code 1 where anything does.

use leadscrew_core::params::Params;

use super::home::Home;
use crate::cli::{Diff, Global};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::params::difference::{self, Change, DriveChange, changes};
use crate::params::{self};
use crate::setup::{alone, told_good};
use crate::words::pick;

/// Compares.
pub fn run(global: &Global, args: &Diff) -> Outcome {
    let lang = global.lang();
    if let [first, second] = &args.files[..] {
        let load = |file: &std::path::PathBuf| {
            let files: Vec<_> = global.params.iter().chain([file]).cloned().collect();
            told_good(global, params::load(&files, &global.set, lang)?)
        };
        let (old, new) = (load(first)?, load(second)?);
        return tell(global, &changes(&old.params, &new.params), &[]);
    }
    let files: Vec<_> = global.params.iter().chain(&args.files).cloned().collect();
    alone(global, &files, &global.set)?;
    let mut home = Home::open(global)?;
    if files.is_empty() && global.set.is_empty() {
        return tell(global, &changes(&Params::slant_bed(), home.params()), &[]);
    }
    let base = match &home {
        Home::BuiltIn(_) => None,
        Home::Board(machine) => Some(machine.params.clone()),
    };
    let wanted = told_good(global, params::load_over(base, &files, &global.set, lang)?)?;
    let drives = home.drive_changes(&wanted.drives, &wanted.params)?;
    tell(global, &changes(home.params(), &wanted.params), &drives)
}

/// Prints what differs.
fn tell(global: &Global, changes: &[Change], drives: &[DriveChange]) -> Outcome {
    let lang = global.lang();
    let same = changes.is_empty() && drives.is_empty();
    if global.json {
        output::json(|o| {
            o.flag("ok", true);
            difference::fields(o, changes, drives);
        })?;
    } else if same {
        output::write(pick(lang, "no difference\n", "没有差别\n").as_bytes())?;
    } else {
        output::write(difference::text(changes, drives, lang).as_bytes())?;
    }
    if same { Ok(()) } else { Err(Failure::Wrong) }
}
