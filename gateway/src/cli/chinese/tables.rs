//! The Chinese texts as the files have them: by the name of the command, and below it by argument and possible value.
//!
//! ```text
//! ["io wait"]                     a command; [leadscrew] is the program itself, [shared] what several commands have
//! about = "…"                     what it does; all behind an empty line is only in the long help
//! remarks = ["…"]                 the words of its examples, from the top; what is typed stands in the English ones
//! ["io wait".args]                its arguments, by the names of the fields
//! level = "…"
//! ["io wait".values.level]        the possible values of one of them
//! on = "…"
//! ```
//!
//! It must not know how they get to the commands.

use toml::Spanned;
use toml::de::DeTable;

use super::lines::For;
use crate::words::is_wide;

/// The files. A command is in one of them.
pub(super) const FILES: [&str; 7] = [
    include_str!("common.toml"),
    include_str!("programs.toml"),
    include_str!("params.toml"),
    include_str!("tools.toml"),
    include_str!("operating.toml"),
    include_str!("machine.toml"),
    include_str!("agent.toml"),
];

/// The table of what several commands have.
pub(super) const SHARED: &str = "shared";
/// The command that clap adds, and the key of its text.
pub(super) const HELP: &str = "help";

/// All texts.
#[derive(Debug)]
pub(super) struct Tables(DeTable<'static>);

/// The texts of a command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'a>(Option<&'a DeTable<'static>>);

/// Where the texts of a command are: `io wait`, by the place above and the name.
///
/// Those below `help` are the commands themselves again.
pub(super) fn path(above: &str, name: &str) -> String {
    match (above, name) {
        (_, HELP) => above.to_owned(),
        ("" | "leadscrew", name) => name.to_owned(),
        (above, name) => format!("{above} {name}"),
    }
}

impl Tables {
    /// Reads the files; a test reads them with all that can be wrong.
    pub(super) fn read() -> Self {
        let files = FILES.iter().filter_map(|text| DeTable::parse(text).ok());
        Self(files.flat_map(Spanned::into_inner).collect())
    }

    /// The texts of the command at this place.
    pub(super) fn of(&self, path: &str) -> Words<'_> {
        Words(
            self.0
                .get(path)
                .and_then(|words| words.get_ref().as_table()),
        )
    }

    /// What the command `help` does.
    pub(super) fn help(&self) -> &str {
        self.of(SHARED).text(HELP).unwrap_or_default()
    }

    /// The text of an argument: the command's own, else that of several commands.
    pub(super) fn argument<'a>(&'a self, own: Words<'a>, id: &str) -> Option<&'a str> {
        let of = |words: Words<'a>| below(words.0?, "args")?.get(id)?.get_ref().as_str();
        of(own).or_else(|| of(self.of(SHARED)))
    }

    /// The text of a possible value of an argument.
    pub(super) fn value<'a>(&'a self, own: Words<'a>, id: &str, value: &str) -> Option<&'a str> {
        let of = |words: Words<'a>| {
            let of = below(below(words.0?, "values")?, id)?;
            of.get(value)?.get_ref().as_str()
        };
        of(own).or_else(|| of(self.of(SHARED)))
    }

    /// All of them.
    #[cfg(test)]
    pub(super) const fn all(&self) -> &DeTable<'static> {
        &self.0
    }
}

impl<'a> Words<'a> {
    /// What the command does.
    pub(super) fn about(self) -> Option<&'a str> {
        self.text("about")
    }

    fn text(self, key: &str) -> Option<&'a str> {
        self.0?.get(key)?.get_ref().as_str()
    }

    /// What stands below the help: the English lines with these remarks instead of their words.
    pub(super) fn after(self, english: &str, of: For) -> String {
        let remarks = self.0.and_then(|words| words.get("remarks"));
        let remarks = remarks.and_then(|all| all.get_ref().as_array());
        let mut remarks = remarks.into_iter().flatten();
        let lines = parts(english).map(|(typed, words)| {
            let words = match words {
                "" => String::new(),
                "Example:" | "Examples:" => of.text("示例："),
                english => {
                    let words = remarks.next().and_then(|words| words.get_ref().as_str());
                    let words = words.unwrap_or(english);
                    match typed {
                        "" => of.text(words),
                        _ => of.remark(words),
                    }
                }
            };
            format!("{typed}{words}")
        });
        lines.collect::<Vec<_>>().join("\n")
    }
}

/// The table of this name in a table.
fn below<'a>(table: &'a DeTable<'static>, name: &str) -> Option<&'a DeTable<'static>> {
    table.get(name)?.get_ref().as_table()
}

/// The lines below a help: what is typed, with the spaces behind it, and the words.
///
/// The words begin behind two spaces, or behind one where those of the line before began there.
pub(super) fn parts(text: &str) -> impl Iterator<Item = (&str, &str)> {
    text.lines().scan(0, |column, line| {
        let begin = line.len() - line.trim_start().len();
        let words = if begin == 0 {
            0
        } else if let Some(gap) = line[begin..].find("  ") {
            line.len() - line[begin + gap..].trim_start().len()
        } else {
            let there = line.split_at_checked(*column);
            match there {
                Some((typed, _)) if *column > begin && typed.ends_with(' ') => *column,
                _ => line.len(),
            }
        };
        *column = if words < line.len() { words } else { 0 };
        Some(line.split_at(words))
    })
}

/// The text with its lines joined; an empty line parts two paragraphs.
pub(super) fn paragraphs(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (number, paragraph) in text.split("\n\n").enumerate() {
        if number > 0 {
            out.push_str("\n\n");
        }
        for line in paragraph.lines() {
            let narrow = |c: Option<char>| c.is_some_and(|c| !c.is_whitespace() && !is_wide(c));
            if narrow(out.chars().next_back()) && narrow(line.chars().next()) {
                out.push(' ');
            }
            out.push_str(line);
        }
    }
    out
}
