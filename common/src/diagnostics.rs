//! Words for alarms and warnings: a template of the core's table, its figures in the reader's units, and the place in the
//! source with a caret under it.

use std::io::{IsTerminal as _, Write as _};
use std::path::Path;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};
use leadscrew_language::dialect::remedies;
use leadscrew_language::whose::{Whose, line_in_file};
pub use leadscrew_wording::{figure, zone_words};
use leadscrew_wording::{fill, fill_with};

use crate::json::Json;
use crate::source::SourceFile;
use crate::words::{Both, is_obeyed, one_line, pick, plain};

/// An alarm or a warning in words.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The file as it was named.
    pub file: String,
    /// The alarm's number.
    pub number: u16,
    /// A warning: nothing stops.
    pub warning: bool,
    /// Line from 1; 0 without a place in the text.
    pub line: u32,
    /// The line as the machine counts it, over all files of the program.
    pub counted: u32,
    /// First column from 1, in characters.
    pub column: usize,
    /// Column after the last character.
    pub end_column: usize,
    /// The word's letter.
    pub word: Option<char>,
    /// The cause.
    pub message: String,
    /// The remedy.
    pub help: String,
    /// The line of the place. Tabs and undecodable bytes are replaced one for one.
    text: Option<String>,
    lang: Lang,
}

impl Diagnostic {
    /// Puts `alarm` into words. `inch`: the program is in inches at the place of the alarm.
    pub fn new(alarm: &Alarm, source: &SourceFile, lang: Lang, inch: bool) -> Self {
        let line = line_in_file(alarm.span.line);
        // The board, too, tells lines of subprograms that have a file of their own.
        let own = source.beside(Whose::line(alarm.span.line));
        let program = source;
        let source = own.as_ref().unwrap_or(source);
        let raw = source.line(line);
        let columns = |byte: u16| {
            let bytes = usize::from(byte).saturating_sub(1);
            let Some(raw) = &raw else { return bytes + 1 };
            String::from_utf8_lossy(&raw[..bytes.min(raw.len())])
                .chars()
                .count()
                + 1
        };
        let column = columns(alarm.span.column);
        // The span shows which word was written, the alarm which value it means: U is shown where an end was written as U.
        let written = raw.as_ref().and_then(|raw| {
            let letter = raw.get(usize::from(alarm.span.column).checked_sub(1)?)?;
            letter
                .is_ascii_alphabetic()
                .then(|| letter.to_ascii_uppercase())
        });
        // A value that no word gave has the span of the G word. The text may name the letter, but the word is absent.
        let absent = written == Some(b'G') && alarm.word != written;
        let alarm = &Alarm {
            word: alarm
                .word
                .map(|word| written.filter(|_| !absent).unwrap_or(word)),
            ..*alarm
        };
        Self {
            file: source.name(),
            number: alarm.number(),
            warning: alarm.code.is_warning(),
            line,
            counted: alarm.span.line,
            column,
            end_column: columns(alarm.span.end).max(column + 1),
            word: alarm.word.filter(|_| !absent).map(char::from),
            message: match alarm.code {
                Code::ProgramNotFound => looked_in(alarm, program, source, lang),
                code => fill(code.cause(lang), alarm, lang, inch),
            },
            help: comma(alarm, raw.as_deref(), lang)
                .or_else(|| remedies::help(alarm, lang))
                .unwrap_or_else(|| fill(alarm.code.help(lang), alarm, lang, inch)),
            text: raw.map(|raw| printable(&raw)),
            lang,
        }
    }

    /// A mistake in a parameter file or an option, which are no programs. Its figures are texts.
    pub fn of_option(code: Code, figures: &[String], place: &Place, lang: Lang) -> Self {
        let text = |template| fill_with(template, None, |n| figures.get(n).cloned());
        Self {
            file: place.file.clone(),
            number: code.number(),
            warning: code.is_warning(),
            line: place.line,
            counted: place.line,
            column: place.column,
            end_column: place.end_column.max(place.column + 1),
            word: None,
            message: text(code.cause(lang)),
            help: text(code.help(lang)),
            text: (place.line > 0).then(|| printable(place.text.as_bytes())),
            lang,
        }
    }

    /// The line of the place, if there is one.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// The fields of the machine formats, with `file` where the caller wants it.
    pub fn fields(&self, json: &mut Json, with_file: bool) {
        if with_file || self.counted != self.line {
            json.text("file", &self.file);
        }
        json.integer("no", i64::from(self.number));
        json.integer("line", i64::from(self.line));
        json.integer("column", self.column as i64);
        json.integer("end_column", self.end_column as i64);
        if let Some(word) = self.word {
            json.text("word", word.encode_utf8(&mut [0; 4]));
        }
        json.text("message", &self.message);
        json.text("help", &self.help);
    }

    /// Text for a person: number, cause, place with a caret, remedy.
    pub fn render(&self, colour: bool) -> String {
        let (level, name) = match (self.warning, self.lang) {
            (false, Lang::En) => (Level::ERROR, "alarm"),
            (false, Lang::Zh) => (Level::ERROR, "报警"),
            (true, Lang::En) => (Level::WARNING, "warning"),
            (true, Lang::Zh) => (Level::WARNING, "警告"),
        };
        let help = match self.lang {
            Lang::En => Level::HELP,
            Lang::Zh => Level::HELP.with_name("措施"),
        };
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let file = &one_line(&self.file);
        let title = level
            .with_name(name)
            .primary_title(&self.message)
            .id(format!("{:04}", self.number));
        let text = self.text.as_deref().unwrap_or_default();
        let group = match &self.text {
            Some(_) if self.line > 0 => {
                let byte = |column: usize| {
                    text.char_indices()
                        .nth(column - 1)
                        .map_or(text.len(), |(at, _)| at)
                };
                let span = byte(self.column)..byte(self.end_column);
                title.element(
                    Snippet::source(text)
                        .line_start(self.line as usize)
                        .path(file)
                        .annotation(AnnotationKind::Primary.span(span)),
                )
            }
            _ => title.element(annotate_snippets::Origin::path(file)),
        };
        renderer.render(&[group.element(help.message(&self.help))])
    }
}

/// A place outside of programs: in a parameter file, or in an option on the command line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named, or the option.
    pub file: String,
    /// Line from 1; 0 without a place.
    pub line: u32,
    /// First column from 1, in characters.
    pub column: usize,
    /// Column after the last character.
    pub end_column: usize,
    /// The line.
    pub text: String,
}

/// Prints a diagnostic for people: to standard error.
pub fn print(diagnostic: &Diagnostic, colour: bool) {
    // Standard error is closed: nobody can be told.
    let _ = writeln!(std::io::stderr(), "{}", diagnostic.render(colour));
}

/// Prints other words for people, also to standard error.
pub fn say(text: &str) {
    // Standard error is closed: nobody can be told.
    let _ = std::io::stderr().write_all(plain(text.to_owned()).as_bytes());
}

/// What to do about a comma in a number: `X30,5`.
fn comma(alarm: &Alarm, raw: Option<&[u8]>, lang: Lang) -> Option<String> {
    let at = usize::from(alarm.span.column).checked_sub(1)?;
    let behind = raw?.get(at..)?;
    let is_comma = behind.first() == Some(&b',') && behind.get(1)?.is_ascii_digit();
    (alarm.code == Code::UnknownCharacter && is_comma).then(|| {
        let help = pick(
            lang,
            "write a point in the number: `30.5`",
            "数字中请写小数点：`30.5`",
        );
        help.to_owned()
    })
}

/// The line in a printable form. A tab becomes one space, so that columns stay columns. Control characters and undecodable
/// bytes become one replacement character each.
fn printable(raw: &[u8]) -> String {
    String::from_utf8_lossy(raw)
        .chars()
        .map(|c| match c {
            '\t' => ' ',
            c if is_obeyed(c) => char::REPLACEMENT_CHARACTER,
            c => c,
        })
        .collect()
}

/// The cause of a call that leads nowhere: the files in which the program was looked for. `caller` is the one that calls.
fn looked_in(alarm: &Alarm, program: &SourceFile, caller: &SourceFile, lang: Lang) -> String {
    let mut files = format!("`{}`", one_line(&caller.name()));
    if caller.path() != program.path() {
        files += pick(lang, " and ", " 和 ");
        files += &format!("`{}`", one_line(&program.name()));
    }
    let number = match alarm.args[0] {
        Arg::Int(number) => u32::try_from(number).ok(),
        _ => None,
    };
    let own = number.and_then(Whose::file_of);
    let own = own.and_then(|own| match program.beside(own) {
        Some(file) => Some(file.name()),
        None => own.name(),
    });
    let own = own.map(|own| one_line(&own)).unwrap_or_default();
    fill_with(alarm.code.cause(lang), None, |n| match n {
        0 => Some(figure(alarm.args[0], lang, false)),
        1 => Some(files.clone()),
        2 => Some(own.clone()),
        _ => None,
    })
}

/// <https://no-color.org>: any non-empty `NO_COLOR` switches colour off.
pub fn colour() -> bool {
    std::io::stderr().is_terminal()
        && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// A template with … in place of its figures.
#[must_use]
pub fn blanks(template: &str) -> String {
    let keys = ["{0}", "{1}", "{2}", "{3}", "{w}"];
    let fill = |text: String, key: &&str| text.replace(*key, "…");
    keys.iter().fold(template.to_owned(), fill)
}

/// An alarm that a board gives as its reason: number, cause and remedy in one sentence.
#[must_use]
pub fn alarm_words(alarm: &Alarm) -> Both {
    let source = SourceFile::new(Path::new("the board"));
    let told = |lang| {
        let told = Diagnostic::new(alarm, &source, lang, false);
        format!("{:04} {}; {}", told.number, told.message, told.help)
    };
    Both {
        en: told(Lang::En),
        zh: told(Lang::Zh),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_are_not_named_leave_no_gap_behind() {
        let mut figures = [Arg::Letter(b'X'), Arg::Letter(b'Z'), Arg::None];
        let told = |figures: &[Arg]| alarm_words(&Alarm::of(Code::NotReferenced, figures)).en;
        let behind = "; home first (`leadscrew home`)";
        assert_eq!(told(&figures), format!("4503 not referenced: X Z{behind}"));
        figures[2] = Arg::Letter(b'C');
        assert_eq!(
            told(&figures),
            format!("4503 not referenced: X Z C{behind}")
        );
    }
}
