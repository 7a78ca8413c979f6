//! Rows of machine functions as the words of a machine file, and their change within the text of one.

use std::ops::Range;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, FunctionAction, FunctionRow};

use super::{Table, row_of};
use crate::params::edit::Replacement;

/// `m.8 = { set = "output:1" }`: what a value of 9401 to 9416 means, as a line of a file; `None` for one that is no row.
#[must_use]
pub fn words(value: i64) -> Option<String> {
    let row = FunctionRow::of(value)?;
    Some(format!("m.{} = {}", row.code, braces(&row, None)))
}

/// The same with its number, so that it comes into the same row again.
pub(in crate::params) fn line(entry: &Entry, value: i64) -> Option<String> {
    let row = FunctionRow::of(value)?;
    Some(format!("m.{} = {}", row.code, braces(&row, row_of(entry))))
}

fn braces(row: &FunctionRow, number: Option<u8>) -> String {
    format!("{{ {} }}", fields(row, number).join(", "))
}

/// The keys with their values.
fn fields(row: &FunctionRow, number: Option<u8>) -> Vec<String> {
    let mut out = Vec::new();
    let time = match row.time_ms {
        ms if ms.is_multiple_of(1000) => format!("\"{} s\"", ms / 1000),
        ms => format!("\"{ms} ms\""),
    };
    let pulse = matches!(row.switches, Some((_, FunctionAction::Pulse)));
    if let Some((output, action)) = row.switches {
        let key = match action {
            FunctionAction::On | FunctionAction::Pulse => "set",
            FunctionAction::Off => "clear",
        };
        out.push(format!("{key} = \"output:{}\"", output.number()));
    }
    if pulse {
        out.push(format!("pulse = {time}"));
    }
    if let Some(answer) = row.answer {
        let level = u8::from(answer.on);
        out.push(format!(
            "answer = \"input:{}={level}\"",
            answer.input.number()
        ));
        if !pulse {
            out.push(format!("within = {time}"));
        }
    }
    if row.behind {
        out.push("when = \"after\"".into());
    }
    out.extend(number.map(|number| format!("row = {number}")));
    out
}

/// What becomes of a file whose tables of M codes are changed.
#[derive(Debug, Default)]
pub struct Rewritten {
    /// The changes of its text.
    pub replacements: Vec<Replacement>,
    /// The rows that stand in its tables, from 1.
    pub rows: Vec<u8>,
}

/// The changes that give the tables of a file these values. Each then says its row: what stands in front of it may be gone.
#[must_use]
pub fn rewritten(text: &str, values: &[(&'static Entry, i64)]) -> Rewritten {
    let mut out = Rewritten::default();
    let loaded = crate::params::load_text("", text, Lang::En);
    let new = |table: &Table| {
        let of_row = |(entry, _): &&(&Entry, i64)| row_of(entry) == Some(table.row);
        values.iter().find(of_row).map(|&(_, value)| value)
    };
    if !loaded.functions.iter().any(|table| new(table).is_some()) {
        return out;
    }
    for table in &loaded.functions {
        out.rows.push(table.row);
        let written = Written::of(text, table);
        match new(table).map(FunctionRow::of) {
            Some(Some(row)) => written.becomes(&row, table.row, &mut out.replacements),
            Some(None) => written.goes(&mut out.replacements),
            None if table.pinned => {}
            None => written.pin(table.row, &mut out.replacements),
        }
    }
    out
}

/// How a table stands in a file.
struct Written<'a> {
    text: &'a str,
    key: Range<usize>,
    style: Style,
}

enum Style {
    /// `[m.8]` and lines under it, up to the byte.
    Header(usize),
    /// `m.8 = { … }`, with the bytes of the braces.
    Braces(Range<usize>),
    /// `m.8.set = …`: lines of its own, each with its beginning and its end.
    Lines(Vec<Range<usize>>),
}

impl<'a> Written<'a> {
    fn of(text: &'a str, table: &Table) -> Self {
        let key = table.key.clone();
        let line = line_at(text, key.start);
        let style = if text[line.clone()].trim_start().starts_with('[') {
            Style::Header(section_end(text, line.end))
        } else if text[table.value.clone()].starts_with('{') {
            Style::Braces(table.value.clone())
        } else {
            let mut lines: Vec<_> = table.fields.iter().map(|at| line_at(text, *at)).collect();
            lines.dedup();
            Style::Lines(lines)
        };
        Self { text, key, style }
    }

    fn becomes(&self, row: &FunctionRow, number: u8, out: &mut Vec<Replacement>) {
        let code = Replacement {
            span: self.key.clone(),
            by: row.code.to_string(),
        };
        match &self.style {
            Style::Header(end) => {
                out.push(code);
                let begin = line_at(self.text, self.key.start).end;
                let ending = line_end(self.text);
                let mut by: String = fields(row, Some(number))
                    .iter()
                    .flat_map(|field| [field, ending])
                    .collect();
                by.push_str(&comments(&self.text[begin..*end]));
                // A header in the last line of a file without its end.
                if !self.text[..begin].ends_with('\n') {
                    by.insert_str(0, ending);
                }
                out.push(Replacement {
                    span: begin..*end,
                    by,
                });
            }
            Style::Braces(span) => {
                out.push(code);
                out.push(Replacement {
                    span: span.clone(),
                    by: braces(row, Some(number)),
                });
            }
            Style::Lines(lines) => {
                let head = line_at(self.text, self.key.start).start;
                let head = &self.text[head..self.key.start];
                for (at, line) in lines.iter().enumerate() {
                    let by = match at {
                        0 => format!(
                            "{head}{} = {}{}",
                            row.code,
                            braces(row, Some(number)),
                            line_end(self.text)
                        ),
                        _ => String::new(),
                    };
                    out.push(Replacement {
                        span: line.clone(),
                        by,
                    });
                }
            }
        }
    }

    fn goes(&self, out: &mut Vec<Replacement>) {
        let mut remove = |span: Range<usize>, by: String| out.push(Replacement { span, by });
        let line = line_at(self.text, self.key.start);
        match &self.style {
            Style::Header(end) => {
                let kept = comments(&self.text[line.end..*end]);
                remove(line.start..*end, kept);
            }
            Style::Braces(value) => {
                let behind = &self.text[value.end..line_at(self.text, value.end).end];
                let before = &self.text[line.start..self.key.start];
                if before.contains('{') || behind.trim_start().starts_with([',', '}']) {
                    // One of several within braces: with the comma behind it, else with the one before.
                    let comma = behind.trim_start().starts_with(',');
                    let more = behind.find(',').map_or(0, |at| at + 1);
                    let start = self.text[..self.key.start].rfind([',', '{']);
                    let start = start.filter(|at| self.text[*at..].starts_with(','));
                    match (comma, start) {
                        (true, _) => remove(self.key.start..value.end + more, String::new()),
                        (false, Some(start)) => remove(start..value.end, String::new()),
                        (false, None) => remove(self.key.start..value.end, String::new()),
                    }
                } else {
                    remove(line.start..line_at(self.text, value.end).end, String::new());
                }
            }
            Style::Lines(lines) => {
                for line in lines {
                    remove(line.clone(), String::new());
                }
            }
        }
    }

    fn pin(&self, number: u8, out: &mut Vec<Replacement>) {
        let ending = line_end(self.text);
        let (at, by) = match &self.style {
            Style::Header(_) => {
                let at = line_at(self.text, self.key.start).end;
                (at, format!("row = {number}{ending}"))
            }
            Style::Braces(span) => (span.start + 1, format!(" row = {number},")),
            Style::Lines(lines) => {
                let line = line_at(self.text, self.key.start);
                let head = &self.text[line.start..self.key.end];
                let at = lines.first().map_or(line.start, |line| line.start);
                (at, format!("{head}.row = {number}{ending}"))
            }
        };
        out.push(Replacement { span: at..at, by });
    }
}

/// How lines of a file end.
fn line_end(text: &str) -> &'static str {
    if text.contains("\r\n") { "\r\n" } else { "\n" }
}

/// The line with a byte, its end included.
fn line_at(text: &str, byte: usize) -> Range<usize> {
    let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
    let end = text[byte..]
        .find('\n')
        .map_or(text.len(), |at| byte + at + 1);
    start..end
}

/// The end of the lines of a table: those before the next header, without the comments that belong to that.
fn section_end(text: &str, from: usize) -> usize {
    let (mut at, mut end) = (from, from);
    for line in text[from..].split_inclusive('\n') {
        let bare = line.trim_start();
        if bare.starts_with('[') {
            break;
        }
        at += line.len();
        if !bare.is_empty() && !bare.starts_with('#') {
            end = at;
        }
    }
    end
}

/// The lines of a text that are comments.
fn comments(text: &str) -> String {
    let lines = text.split_inclusive('\n');
    lines
        .filter(|line| line.trim_start().starts_with('#'))
        .collect()
}
