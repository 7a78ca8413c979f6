//! Words for alarms and warnings: a template of the core's table, its figures in the reader's units, and the place in the
//! source with a caret under it.

use std::io::{IsTerminal as _, Write as _};
use std::path::Path;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};
use leadscrew_core::bus::Statusword;
use leadscrew_core::operating::Interlock;
use leadscrew_language::whose::{Whose, line_in_file};

use crate::json::Json;
use crate::number;
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
            help: fill(alarm.code.help(lang), alarm, lang, inch),
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

/// Replaces `{0}`…`{3}` and `{w}` in a template with the figures of an alarm.
fn fill(template: &str, alarm: &Alarm, lang: Lang, inch: bool) -> String {
    let figures = |n| alarm.args.get(n).map(|arg| figure(*arg, lang, inch));
    let mut text = fill_with(template, alarm.word, figures);
    // Figures at the end may be absent: an alarm names one axis, or three.
    text.truncate(text.trim_end().len());
    text
}

/// Replaces `{0}`… and `{w}` in a template.
fn fill_with(
    template: &str,
    word: Option<u8>,
    figures: impl Fn(usize) -> Option<String>,
) -> String {
    let mut out = String::with_capacity(template.len() + 32);
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        let Some((key, after)) = after.split_once('}') else {
            out.push('{');
            rest = after;
            continue;
        };
        match key {
            "w" => out.push(word.map_or('?', char::from)),
            key => match key.parse().ok().and_then(&figures) {
                Some(figure) => out.push_str(&figure),
                // Not a figure: the braces belong to the text.
                None => out.extend(["{", key, "}"]),
            },
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// One figure with its unit.
pub fn figure(arg: Arg, lang: Lang, inch: bool) -> String {
    match arg {
        Arg::None => String::new(),
        Arg::Int(value) => value.to_string(),
        Arg::Length(value) => length(value.nm(), inch),
        Arg::Diameter(value) => length(value.nm(), inch),
        Arg::Angle(value) => format!("{}°", number::text::<6>(value.udeg())),
        Arg::Feed(value) => format!("{}/min", length(value.nm_per_min(), inch)),
        Arg::Rpm(value) => match lang {
            Lang::En => format!("{} rpm", value.get()),
            Lang::Zh => format!("{} r/min", value.get()),
        },
        Arg::Lead(none) => match none {},
        Arg::Percent(value) => format!("{value} %"),
        Arg::Decimal(mantissa, decimals) => written(mantissa, decimals),
        Arg::Letter(letter) => char::from(letter).to_string(),
        Arg::GCode(tenths) if tenths % 10 == 0 => format!("G{:02}", tenths / 10),
        Arg::GCode(tenths) => format!("G{:02}.{}", tenths / 10, tenths % 10),
        Arg::Hex(value) => format!("{value:04X}h"),
        Arg::Key(value) => format!("{value:08X}h"),
        Arg::Statusword(value) => match Statusword::from_raw(value).state() {
            Some(state) => format!("{value:04X}h ({})", state.name()),
            None => format!("{value:04X}h"),
        },
        Arg::Mode(mode) => mode.name().to_owned(),
        Arg::Interlock(interlock) => interlock_words(interlock, lang).to_owned(),
    }
}

const fn interlock_words(interlock: Interlock, lang: Lang) -> &'static str {
    match (interlock, lang) {
        (Interlock::Hold, Lang::En) => "feed hold",
        (Interlock::Hold, Lang::Zh) => "进给保持",
        (Interlock::Door, Lang::En) => "the open door",
        (Interlock::Door, Lang::Zh) => "门打开",
        (Interlock::Chuck, Lang::En) => "the open chuck",
        (Interlock::Chuck, Lang::Zh) => "卡盘松开",
        (Interlock::ChuckPressure, Lang::En) => "missing pressure of the chuck",
        (Interlock::ChuckPressure, Lang::Zh) => "卡盘压力缺失",
        (Interlock::TailstockPressure, Lang::En) => "missing pressure of the tailstock",
        (Interlock::TailstockPressure, Lang::Zh) => "尾座压力缺失",
        (Interlock::Enable, Lang::En) => "the enabling switch, which nobody holds,",
        (Interlock::Enable, Lang::Zh) => "使能开关未按住",
        (Interlock::Spindle, Lang::En) => "the spindle, which has not stood for a second,",
        (Interlock::Spindle, Lang::Zh) => "主轴静止未满一秒",
    }
}

/// A length in the program's unit: exact in millimetres, to the tenth of a micro-inch in inches.
fn length(nm: i64, inch: bool) -> String {
    if !inch {
        return format!("{} mm", number::text::<6>(nm));
    }
    // A nanometre is 10⁷ / 25 400 000 = 100 / 254 ten-millionths of an inch.
    let scaled = i128::from(nm) * 100;
    let half = 127 * scaled.signum();
    let value = i64::try_from((scaled + half) / 254).unwrap_or(i64::MAX);
    format!("{} in", number::text::<7>(value))
}

/// A decimal with the digits of its source.
fn written(mantissa: i64, decimals: u8) -> String {
    let digits = format!(
        "{:0width$}",
        mantissa.unsigned_abs(),
        width = usize::from(decimals) + 1
    );
    let (whole, fraction) = digits.split_at(digits.len() - usize::from(decimals));
    let sign = if mantissa < 0 { "-" } else { "" };
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{whole}{point}{fraction}")
}

/// <https://no-color.org>: any non-empty `NO_COLOR` switches colour off.
pub fn colour() -> bool {
    std::io::stderr().is_terminal()
        && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
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
    use leadscrew_core::alarm::Span;
    use leadscrew_core::units::{Diameter, Length, Rpm};

    use super::*;

    fn alarm() -> Alarm {
        Alarm::new(
            Code::LeadMissing,
            Span {
                line: 1,
                column: 1,
                end: 4,
            },
        )
        .word(b'F')
        .with([
            Arg::Length(Length::from_nm(1_500_000)),
            Arg::Diameter(Diameter::from_nm(60_640_000)),
            Arg::Rpm(Rpm::new(-300)),
            Arg::GCode(760),
        ])
    }

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

    #[test]
    fn figures_take_their_places() {
        let text = fill(
            "{w}: {0} of {1} at {2} in {3}, {9} {x}",
            &alarm(),
            Lang::En,
            false,
        );
        assert_eq!(text, "F: 1.5 mm of 60.64 mm at -300 rpm in G76, {9} {x}");
        assert_eq!(fill("open {", &alarm(), Lang::En, false), "open {");
    }

    #[test]
    fn inches_are_rounded_only_in_print() {
        assert_eq!(length(25_400_000, true), "1 in");
        assert_eq!(length(1_000_000, true), "0.0393701 in");
        assert_eq!(length(-1_000_000, true), "-0.0393701 in");
    }

    #[test]
    fn decimals_keep_their_digits() {
        assert_eq!(written(1500, 3), "1.500");
        assert_eq!(written(-5, 2), "-0.05");
        assert_eq!(written(7, 0), "7");
    }

    #[test]
    fn every_template_names_only_figures_that_can_be_filled() {
        for code in Code::ALL {
            for lang in [Lang::En, Lang::Zh] {
                for template in [code.cause(lang), code.help(lang)] {
                    let filled = fill(template, &alarm(), lang, false);
                    assert!(
                        !template.is_empty() && !filled.contains(['{', '}']),
                        "{code:?}: {template}"
                    );
                }
            }
        }
    }
}
