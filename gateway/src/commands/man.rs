//! `man`: manual pages, made of the same texts as `--help`.

use std::io;
use std::path::Path;

use clap::{Command, CommandFactory as _};
use clap_mangen::Man;
use leadscrew_core::alarm::Lang;

use crate::cli::{Cli, chinese};
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::words::both;

/// Prints the page of a command, or writes all pages into a folder.
pub fn run(command: &[String], to: Option<&Path>, lang: Lang) -> Outcome {
    let mut all = Cli::command().disable_help_subcommand(true);
    // Gives each command its full name and the options that all have.
    all.build();
    if lang == Lang::Zh {
        all = chinese::translated(all, chinese::For::Page);
    }
    if let Some(folder) = to {
        let failed = |error| Failure::file(Doing::Write, folder.display(), &error);
        std::fs::create_dir_all(folder).map_err(failed)?;
        return write_all(&all, folder, lang).map_err(failed);
    }
    let (_, page) = page(find(all, command)?, lang).map_err(|error| Failure::stdout(&error))?;
    output::write(&page)
}

/// The page of a command, and the name of its file.
fn page(command: Command, lang: Lang) -> io::Result<(String, Vec<u8>)> {
    let man = Man::new(command);
    let mut page = Vec::new();
    man.render(&mut page)?;
    let page = match lang {
        Lang::En => page,
        Lang::Zh => chinese::in_chinese(&String::from_utf8_lossy(&page)).into_bytes(),
    };
    Ok((man.get_filename(), page))
}

/// Writes the pages of a command and of all below it.
fn write_all(command: &Command, folder: &Path, lang: Lang) -> io::Result<()> {
    for below in command.get_subcommands() {
        write_all(below, folder, lang)?;
    }
    let (name, page) = page(command.clone(), lang)?;
    std::fs::write(folder.join(name), page)
}

/// The command with this name, below it the verb.
fn find(all: Command, names: &[String]) -> Outcome<Command> {
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
