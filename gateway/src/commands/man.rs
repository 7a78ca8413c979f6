//! `man`: manual pages, made of the same texts as `--help`.

use std::path::Path;

use clap::CommandFactory as _;
use clap_mangen::Man;

use crate::cli::Cli;
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::words::both;

/// Prints the page of a command, or writes all pages into a folder.
pub fn run(command: &[String], to: Option<&Path>) -> Outcome {
    let mut all = Cli::command().disable_help_subcommand(true);
    // Gives each command its full name and the options that all have.
    all.build();
    if let Some(folder) = to {
        return write_all(all, folder);
    }
    let mut page = Vec::new();
    Man::new(find(all, command)?)
        .render(&mut page)
        .map_err(|error| Failure::stdout(&error))?;
    output::write(&page)
}

fn write_all(all: clap::Command, folder: &Path) -> Outcome {
    let failed = |error| Failure::file(Doing::Write, folder.display(), &error);
    std::fs::create_dir_all(folder).map_err(failed)?;
    clap_mangen::generate_to(all, folder).map_err(failed)
}

/// The command with this name, below it the verb.
fn find(all: clap::Command, names: &[String]) -> Outcome<clap::Command> {
    names.iter().try_fold(all, |at, name| {
        let below = at.find_subcommand(name).cloned();
        below.ok_or_else(|| {
            let typed = names.join(" ");
            Failure::Usage(both!(
                "there is no command `{typed}`; `leadscrew --help` lists them",
                "没有命令 `{typed}`；`leadscrew --help` 会列出所有命令"
            ))
        })
    })
}
