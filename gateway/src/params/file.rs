//! Parameter files: TOML, one value a key, keys by number, alias or name, values with their unit.
//!
//! ```toml
//! "1420.X" = "12000 mm/min"
//! rapid_rate.Z = "16 m/min"
//! 182.7 = 1
//! [work_offset_g55]
//! X = "120.5 mm"
//! ```
//!
//! Two keys are no parameters: `schema`, the version of the table the file was written for, and `drive`, the sections of
//! the drives.

use std::io::Read as _;
use std::ops::Range;
use std::path::Path;

use leadscrew_core::alarm::Code;
use leadscrew_core::params::{Entry, FindError, Writing};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::{Loader, drives, mistake, schema};
use crate::diagnostics::Place;
use crate::failure::{Doing, Failure, Outcome};
use crate::source::SourceFile;

/// The text of a file.
pub fn read(path: &Path) -> Outcome<String> {
    let mut text = String::new();
    let opened = SourceFile::new(path).open();
    opened
        .and_then(|mut file| file.read_to_string(&mut text))
        .map_err(|error| Failure::file(Doing::Read, path.display(), &error))?;
    Ok(text)
}

/// Takes every value of a file.
pub fn apply(loader: &mut Loader, name: &str, text: &str) {
    let source = Source { name, text };
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
}

impl Source<'_> {
    fn table(&self, loader: &mut Loader, table: &DeTable) {
        // A file of another version would only make reasons that are none.
        if let Some(value) = table.get(schema::KEY)
            && schema::version(self.text) != Ok(Some(schema::SCHEMA))
        {
            let found = self.text.get(value.span()).unwrap_or_default();
            let figures = [mistake::shown(found), schema::SCHEMA.to_string()];
            return loader.report(Code::ParamSchema, &figures, &self.place(&value.span()));
        }
        for (key, value) in in_order(table) {
            let name = key.get_ref().as_ref();
            match value.get_ref() {
                _ if name == schema::KEY => {}
                _ if name == drives::KEY => drives::apply(loader, self, key, value),
                DeValue::Table(parts) => self.parts(loader, key, parts),
                _ => match Entry::find_text(name) {
                    Ok(entry) => self.value(loader, entry, &key.span(), value),
                    Err(error) => loader.not_found(name, error, &self.place(&key.span())),
                },
            }
        }
    }

    /// `[1420]`, `rapid_rate.X = …`, `182.7 = …`: the keys of the inner table are axes or bits.
    fn parts(&self, loader: &mut Loader, head: &Spanned<DeString>, parts: &DeTable) {
        let name = head.get_ref().as_ref();
        // An unknown number or name is told once, not for each of its parts.
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
        let text = match value.get_ref() {
            DeValue::String(text) => text.as_ref(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
            // A decimal number without a unit; what is missing depends on the parameter.
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

    /// Line and columns of a span; what goes on over the end of its first line is cut there.
    pub fn place(&self, span: &Range<usize>) -> Place {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let rest = self.text.get(line_start..).unwrap_or_default();
        let text = rest.lines().next().unwrap_or_default();
        let column = |byte: usize| {
            let within = byte.saturating_sub(line_start).min(text.len());
            text.get(..within).map_or(0, |s| s.chars().count()) + 1
        };
        Place {
            file: self.name.to_owned(),
            line: u32::try_from(before.matches('\n').count() + 1).unwrap_or(u32::MAX),
            column: column(span.start),
            end_column: column(span.end),
            text: text.to_owned(),
        }
    }
}

/// The keys as they stand in the file; the table itself is in alphabetical order.
pub fn in_order<'a, 'i>(
    table: &'a DeTable<'i>,
) -> Vec<(&'a Spanned<DeString<'i>>, &'a Spanned<DeValue<'i>>)> {
    let mut items: Vec<_> = table.iter().collect();
    items.sort_by_key(|(key, _)| key.span().start);
    items
}
