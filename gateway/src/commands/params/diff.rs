//! `params diff`: what differs between two sets. Exit code 1 where anything does, 3 where a drive or the block does not
//! answer; what is known without the block is told all the same.

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
        return tell(global, &changes(&old.params, &new.params), &[], None);
    }
    let files: Vec<_> = global.params.iter().chain(&args.files).cloned().collect();
    alone(global, &files, &global.set)?;
    let mut home = Home::open(global)?;
    if files.is_empty() && global.set.is_empty() {
        return tell(
            global,
            &changes(&Params::slant_bed(), home.params()),
            &[],
            None,
        );
    }
    let base = match &home {
        Home::BuiltIn(_) => None,
        Home::Board(machine) => Some(machine.params.clone()),
    };
    let wanted = told_good(global, params::load_over(base, &files, &global.set, lang)?)?;
    let (drives, unknown) = home.drive_changes(&wanted.drives, &wanted.params)?;
    tell(
        global,
        &changes(home.params(), &wanted.params),
        &drives,
        unknown,
    )
}

/// Prints what differs, and why not all of it is known.
fn tell(
    global: &Global,
    changes: &[Change],
    drives: &[DriveChange],
    unknown: Option<Failure>,
) -> Outcome {
    let lang = global.lang();
    let same = changes.is_empty() && drives.is_empty();
    if global.json {
        output::json(|o| {
            match &unknown {
                None => o.flag("ok", true),
                Some(failure) => failure.fields(lang, o),
            }
            difference::fields(o, changes, drives);
        })?;
    } else if !same {
        output::write(difference::text(changes, drives, lang).as_bytes())?;
    } else if unknown.is_none() {
        output::write(pick(lang, "no difference\n", "没有差别\n").as_bytes())?;
    } else {
        output::write(pick(lang, "no other difference\n", "其余没有差别\n").as_bytes())?;
    }
    match unknown {
        Some(failure) => Err(failure),
        None if same => Ok(()),
        None => Err(Failure::Wrong),
    }
}
