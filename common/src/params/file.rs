//! Parameter files: TOML with one value per key; keys by number, alias or name; values with their unit.
//!
//! ```toml
//! "1420.X" = "12000 mm/min"
//! rapid_rate.Z = "16 m/min"
//! 182.7 = 1
//! [work_offset_g55]
//! X = "120.5 mm"
//! ```
//!
//! Six keys are no parameters: `schema`, the version of the file's table; `drive`, the sections of the drives; `dialect`,
//! the control that programs beside the file are written for; `allow`, the numbers that are not told of these programs;
//! `io` and `m`, names of inputs and outputs and what M codes do with them, which become parameters.

use std::borrow::Cow;
use std::cell::Cell;
use std::io::Read as _;
use std::ops::Range;
use std::path::Path;

use leadscrew_core::alarm::{Code, Lang};
use leadscrew_core::params::{Entry, FindError, Writing};
use leadscrew_language::dialect::Control;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::{Loader, drives, functions, mistake, schema};
use crate::diagnostics::{self, Diagnostic, Place};
use crate::failure::{Doing, Failure, Outcome, unreadable};
use crate::source::SourceFile;
use crate::words::both;

/// Longest machine file in bytes. The whole table with all its comments is a twentieth of it.
pub const LONGEST: u64 = 1 << 18;

/// Longest part of a line in a message, in bytes.
const SHOWN: usize = 1024;

/// The bytes of a file, up to the longest machine file.
pub fn read_bytes(path: &Path) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    let opened = SourceFile::new(path).raw();
    opened
        .and_then(|file| file.take(LONGEST + 1).read_to_end(&mut bytes))
        .and_then(|read| match read as u64 {
            0..=LONGEST => Ok(()),
            _ => Err(unreadable(both!(
                "it is longer than the {LONGEST} bytes that a machine file may have, and one has some thousand: name another \
                 file, or remove from this one what is no parameter",
                "它超过机床参数文件允许的 {LONGEST} 字节，而这种文件通常只有几千字节：请指定另一个文件，或删去其中不是参数的内容"
            ))),
        })
        .map_err(|error| Failure::file(Doing::Read, path.display(), &error))?;
    Ok(bytes)
}

/// The text of a file.
///
/// # Errors
/// A file that cannot be read, or that is no text; its place and the remedy have been reported.
pub fn read(path: &Path, lang: Lang) -> Outcome<String> {
    let bytes = read_bytes(path)?;
    match text(&bytes) {
        Ok(text) => Ok(text.into_owned()),
        Err(wrong) => {
            let name = path.display().to_string();
            let place = wrong.place(&name, &bytes);
            let told = Diagnostic::of_option(wrong.code, &wrong.figures, &place, lang);
            diagnostics::print(&told, diagnostics::colour());
            Err(Failure::Wrong)
        }
    }
}

/// The reason and the place where bytes are no text.
struct NoText {
    code: Code,
    figures: Vec<String>,
    at: usize,
}

impl NoText {
    fn place(&self, name: &str, bytes: &[u8]) -> Place {
        let before = &bytes[..self.at];
        let start = before
            .iter()
            .rposition(|b| *b == b'\n')
            .map_or(0, |at| at + 1);
        let rest = &bytes[start..];
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        let lossy = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let column = lossy(&before[start..]).chars().count() + 1;
        Place {
            file: name.to_owned(),
            line: u32::try_from(before.iter().filter(|b| **b == b'\n').count() + 1)
                .unwrap_or(u32::MAX),
            column,
            end_column: column + 1,
            text: lossy(&rest[..end.min(SHOWN)]),
        }
    }
}

/// The text in these bytes.
fn text(bytes: &[u8]) -> Result<Cow<'_, str>, NoText> {
    let wrong = |name: &str, at| NoText {
        code: Code::ParamEncoding,
        figures: vec![name.to_owned()],
        at,
    };
    match bytes {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => return Err(wrong("UTF-16", 0)),
        [0, other, ..] | [other, 0, ..] if *other != 0 => return Err(wrong("UTF-16", 0)),
        _ => {}
    }
    let text = std::str::from_utf8(bytes);
    let text = text.map_err(|error| {
        let at = error.valid_up_to();
        if is_gbk(&bytes[at..]) {
            return wrong("GBK", at);
        }
        let byte = bytes.get(at).copied().unwrap_or_default();
        NoText {
            code: Code::ParamNoText,
            figures: vec![format!("{byte:02X}h")],
            at,
        }
    })?;
    // Lines of an old editor, which end with a carriage return alone.
    Ok(if text.contains('\r') && !text.contains('\n') {
        text.replace('\r', "\n").into()
    } else {
        text.into()
    })
}

/// True where every byte beyond ASCII belongs to a pair of GBK.
fn is_gbk(mut bytes: &[u8]) -> bool {
    loop {
        bytes = match bytes {
            [] => return true,
            [0..=0x7F, rest @ ..] => rest,
            [0x81..=0xFE, 0x40..=0x7E | 0x80..=0xFE, rest @ ..] => rest,
            _ => return false,
        };
    }
}

/// Takes every value of a file.
pub fn apply(loader: &mut Loader, name: &str, bytes: &[u8]) {
    match text(bytes) {
        Ok(text) => apply_text(loader, name, &text),
        Err(wrong) => loader.report(wrong.code, &wrong.figures, &wrong.place(name, bytes)),
    }
}

fn apply_text(loader: &mut Loader, name: &str, text: &str) {
    let source = Source::new(name, text);
    match DeTable::parse(text) {
        Ok(table) => source.table(loader, table.get_ref()),
        Err(error) => {
            let span = error.span().unwrap_or(0..text.len().min(1));
            loader.report(
                Code::ParamSyntax,
                &[error.message().to_owned()],
                &source.place(&span),
            );
        }
    }
}

/// The text of a file, and its name in messages.
pub struct Source<'a> {
    name: &'a str,
    text: &'a str,
    /// Beginnings of its lines.
    lines: Vec<usize>,
    /// The beginning of a line, a byte in it, and the number of characters between them: places come in the order of the
    /// file.
    counted: Cell<(usize, usize, usize)>,
}

impl<'a> Source<'a> {
    fn new(name: &'a str, text: &'a str) -> Self {
        let ends = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            name,
            text,
            lines: std::iter::once(0).chain(ends).collect(),
            counted: Cell::default(),
        }
    }

    /// The file, as it was named.
    pub const fn name(&self) -> &'a str {
        self.name
    }

    fn table(&self, loader: &mut Loader, table: &DeTable) {
        // A file of another version would only give wrong reasons.
        if let Some(value) = table.get(schema::KEY)
            && schema::version(self.text) != Ok(Some(schema::SCHEMA))
        {
            let found = self.text_at(&value.span());
            let figures = [mistake::shown(found), schema::SCHEMA.to_string()];
            return loader.report(Code::ParamSchema, &figures, &self.place(&value.span()));
        }
        // Values may be names, and a row goes where the values leave room.
        if let Some((key, value)) = table.get_key_value(functions::IO) {
            functions::names(loader, self, key, value);
        }
        for (key, value) in in_order(table) {
            let name = key.get_ref().as_ref();
            match value.get_ref() {
                _ if name == schema::KEY => {}
                _ if [functions::IO, functions::M].contains(&name) => {}
                _ if name == super::DIALECT => self.dialect(loader, value),
                _ if name == super::ALLOW => self.allow(loader, value),
                _ if name == drives::KEY => drives::apply(loader, self, key, value),
                DeValue::Table(parts) => self.parts(loader, key, parts),
                _ => match Entry::find_text(name) {
                    Ok(entry) => self.value(loader, entry, &key.span(), value),
                    Err(error) => loader.not_found(name, error, &self.place(&key.span())),
                },
            }
        }
        if let Some((key, value)) = table.get_key_value(functions::M) {
            functions::apply(loader, self, key, value);
        }
    }

    /// `dialect = "fanuc-b"`
    fn dialect(&self, loader: &mut Loader, value: &Spanned<DeValue>) {
        let named = match value.get_ref() {
            DeValue::String(name) => Control::of_name(name),
            _ => None,
        };
        match named {
            Some(control) => loader.loaded.dialect = Some(control),
            None => {
                let found = self.text_at(&value.span());
                let figures = [mistake::shown(found), Control::names()];
                loader.report(Code::ParamDialect, &figures, &self.place(&value.span()));
            }
        }
    }

    /// `allow = [4800, 4985]`
    fn allow(&self, loader: &mut Loader, value: &Spanned<DeValue>) {
        let DeValue::Array(items) = value.get_ref() else {
            return loader.report(Code::ParamAllow, &[], &self.place(&value.span()));
        };
        for item in items.iter() {
            let number = match item.get_ref() {
                DeValue::Integer(number) => number.as_str().parse().ok(),
                _ => None,
            };
            if !number.is_some_and(|number| loader.loaded.allow.add(number)) {
                loader.report(Code::ParamAllow, &[], &self.place(&item.span()));
            }
        }
    }

    /// `[1420]`, `rapid_rate.X = …`, `182.7 = …`: the keys of the inner table are axes or bits.
    fn parts(&self, loader: &mut Loader, head: &Spanned<DeString>, parts: &DeTable) {
        let name = head.get_ref().as_ref();
        // An unknown number or name is reported once, not for each of its parts.
        if let Err(error @ FindError::Unknown) = Entry::find_text(name) {
            return loader.not_found(name, error, &self.place(&head.span()));
        }
        for (key, value) in in_order(parts) {
            let part = key.get_ref().as_ref();
            let full = format!("{name}.{part}");
            let inner = matches!(value.get_ref(), DeValue::Table(_));
            match Entry::find_text(&full) {
                Ok(entry) if !inner => self.value(loader, entry, &key.span(), value),
                Ok(entry) => loader.not_found(
                    &format!("{full}.…"),
                    FindError::NoSuchPart(entry),
                    &self.place(&key.span()),
                ),
                Err(error) => loader.not_found(&full, error, &self.place(&key.span())),
            }
        }
    }

    fn value(
        &self,
        loader: &mut Loader,
        entry: &'static Entry,
        key: &Range<usize>,
        value: &Spanned<DeValue>,
    ) {
        let at_value = self.place(&value.span());
        let number;
        let text = match value.get_ref() {
            DeValue::String(text) => {
                match functions::contact_number(loader, entry, text, &at_value) {
                    Some(Some(contact)) => {
                        number = contact.number().to_string();
                        number.as_str()
                    }
                    Some(None) => return,
                    None => text.as_ref(),
                }
            }
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
            // A decimal number without a unit. The missing unit depends on the parameter.
            DeValue::Float(float) => float.as_str(),
            DeValue::Boolean(true) if entry.max() == 1 => "1",
            DeValue::Boolean(false) if entry.max() == 1 => "0",
            _ => {
                let example = mistake::example(entry, Writing::UnitRequired);
                let figures = [mistake::label(entry), example];
                return loader.report(Code::ParamKind, &figures, &at_value);
            }
        };
        loader.set(
            entry,
            text,
            Writing::UnitRequired,
            &self.place(key),
            &at_value,
        );
    }

    /// What is written there.
    pub fn text_at(&self, span: &Range<usize>) -> &'a str {
        self.text.get(span.clone()).unwrap_or_default()
    }

    /// Line and columns of a span, which is cut at the end of its first line.
    pub fn place(&self, span: &Range<usize>) -> Place {
        let after = self.lines.partition_point(|begin| *begin <= span.start);
        let begin = self.lines[after.saturating_sub(1)];
        let end = self
            .lines
            .get(after)
            .map_or(self.text.len(), |next| next - 1);
        let line = self.text[begin..end].trim_end_matches('\r');
        let within = |byte: usize| byte.clamp(begin, begin + line.len());
        let count = |from: usize, to: usize| {
            let part = self.text.get(from..to);
            part.map_or(0, |part| part.chars().count())
        };
        let (start, end) = (within(span.start), within(span.end));
        let before = match self.counted.get() {
            (line, byte, known) if line == begin && byte <= start => known + count(byte, start),
            _ => count(begin, start),
        };
        self.counted.set((begin, start, before));
        Place {
            file: self.name.to_owned(),
            line: u32::try_from(after.max(1)).unwrap_or(u32::MAX),
            column: before + 1,
            end_column: before + count(start, end) + 1,
            text: line[..line.floor_char_boundary(SHOWN)].to_owned(),
        }
    }
}

/// The keys in the order of the file; the table itself is in alphabetical order.
pub fn in_order<'a, 'i>(
    table: &'a DeTable<'i>,
) -> Vec<(&'a Spanned<DeString<'i>>, &'a Spanned<DeValue<'i>>)> {
    let mut items: Vec<_> = table.iter().collect();
    items.sort_by_key(|(key, _)| key.span().start);
    items
}
