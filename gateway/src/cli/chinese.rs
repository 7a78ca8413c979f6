//! The help and the manual pages in Chinese: the same commands with other texts.
//!
//! English stands beside the commands, as their documentation. The Chinese texts are in the files of the folder `chinese`,
//! by command and argument; the tests of this module hold the two together. Nothing is parsed by these commands: they
//! are made where a help or a page is to be shown, and only then.

mod lines;
mod page;
mod tables;

#[cfg(test)]
mod tests;

use std::ffi::OsString;

use clap::builder::{PossibleValue, PossibleValuesParser, Resettable, StyledStr};
use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory as _, Error};

pub use lines::For;
pub use page::in_chinese;
use tables::{Tables, Words};

use super::Cli;

/// The answer to what was typed where clap has answered with a help in English; all other answers stay as they are.
#[must_use]
pub fn instead_of(english: Error, typed: &[OsString]) -> Error {
    let kind = english.kind();
    let is_help = matches!(
        kind,
        ErrorKind::DisplayHelp | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    );
    if !is_help {
        return english;
    }
    let mut all = Cli::command().term_width(lines::width());
    all.build();
    let asked = translated(all, For::Help).try_get_matches_from(typed);
    let Some(answer) = asked.err().filter(|answer| answer.kind() == kind) else {
        return english;
    };
    let text = lines::joined(&answer.render().ansi().to_string());
    printed(text, kind).unwrap_or(english)
}

/// Clap prints a finished text as it prints its own: with colours where somebody sees them.
fn printed(text: String, kind: ErrorKind) -> Option<Error> {
    let command = Command::new("leadscrew").override_help(StyledStr::from(text));
    let asked = match kind {
        ErrorKind::DisplayHelp => command.try_get_matches_from(["leadscrew", "--help"]),
        _ => command
            .arg_required_else_help(true)
            .try_get_matches_from(["leadscrew"]),
    };
    asked.err()
}

/// The built commands with the texts of the tables. What the tables lack stays English.
#[must_use]
pub fn translated(all: Command, of: For) -> Command {
    let with = With {
        tables: &Tables::read(),
        of,
    };
    with.command(all, "")
}

/// The texts, and what they are for.
#[derive(Clone, Copy)]
struct With<'a> {
    tables: &'a Tables,
    of: For,
}

impl With<'_> {
    /// The command at this place, and all below it.
    fn command(self, mut command: Command, above: &str) -> Command {
        let path = tables::path(above, command.get_name());
        let words = self.tables.of(&path);
        // `help` has the names of all commands below it.
        let about = if command.get_name() == tables::HELP {
            Some(self.tables.help())
        } else {
            words.about()
        };
        if let Some(text) = about {
            let (short, long) = self.both(text);
            command = command.about(short).long_about(long);
        }
        if let Some(after) = command.get_after_help() {
            let after = words.after(&after.to_string(), self.of);
            command = command.after_help(after);
        }
        command
            .mut_args(|arg| self.argument(arg, words))
            .mut_subcommands(|below| self.command(below, &path))
    }

    fn argument(self, mut arg: Arg, words: Words) -> Arg {
        let id = arg.get_id().to_string();
        if let Some(text) = self.tables.argument(words, &id) {
            let (short, long) = self.both(text);
            arg = arg.help(short).long_help(long);
        }
        let values = arg.get_possible_values();
        if values.iter().all(|value| value.get_help().is_none()) {
            return arg;
        }
        let values = values.into_iter().map(|value| {
            let text = self.tables.value(words, &id, value.get_name());
            match text {
                Some(text) => value.help(self.of.text(text)),
                None => value,
            }
        });
        arg.value_parser(PossibleValuesParser::new(
            values.collect::<Vec<PossibleValue>>(),
        ))
    }

    /// The first paragraph, and the whole where there are more: clap's rule for documentation.
    fn both(self, text: &str) -> (String, Resettable<StyledStr>) {
        let text = tables::paragraphs(text);
        let whole = self.of.text(&text);
        match text.split_once("\n\n") {
            None => (whole, Resettable::Reset),
            Some((short, _)) => (self.of.text(short), Resettable::Value(whole.into())),
        }
    }
}
