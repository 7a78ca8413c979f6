//! Files of offsets and tools: TOML, a line a record.
//!
//! ```toml
//! shift = { X = 0, Z = 0 }
//! G54 = { X = 0, Z = -400 }
//! thread = { X = 0, Z = 0, angle = "off" }
//! T1 = { X = -250.76, Z = 94.875, wear = { X = -0.02, Z = 0 }, radius = 0.4, tip = 3, station = 1, measured = "XZ" }
//! ```
//!
//! What a file does not name stays as it is. A length is a number of millimetres or a text with its unit.

use std::fmt::Write as _;
use std::path::Path;

use leadscrew_core::alarm::Lang;
use leadscrew_core::offsets::{Offsets, TOOLS};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Field, Groove, Key, unknown};
use crate::failure::{Failure, Outcome};
use crate::params;
use crate::words::{Both, both, path as shown_path};

/// The table of a file by itself: what it does not name is 0.
///
/// # Errors
/// A file that cannot be read, or a mistake in it.
pub fn read(path: &Path, lang: Lang) -> Outcome<Offsets> {
    let mut table = Offsets::default();
    apply(&mut table, path, lang)?;
    Ok(table)
}

/// Lays a file over a table.
///
/// # Errors
/// As [`read`].
pub fn apply(table: &mut Offsets, path: &Path, lang: Lang) -> Outcome {
    let text = params::read(path, lang)?;
    let name = shown_path(path);
    let wrong = |at: usize, why: &Both| {
        let line = text.get(..at).unwrap_or_default().matches('\n').count() + 1;
        Failure::WrongBecause(both!(
            "{name}:{line}: {en}",
            "{name}:{line}：{zh}",
            en = why.en,
            zh = why.zh
        ))
    };
    let parsed = DeTable::parse(&text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let why = Both::same(error.message());
        wrong(at, &why)
    })?;
    let mut values = Vec::new();
    flatten("", parsed.get_ref(), &mut values);
    for (name, value) in values {
        let at = value.span().start;
        let [key] = Key::find(&name)[..] else {
            return Err(wrong(at, &unknown(&name)));
        };
        let written = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(_) | DeValue::Float(_) => {
                // Its digits, as they stand there: no binary fraction comes between.
                text.get(value.span()).unwrap_or_default().replace('_', "")
            }
            _ => String::from("?"),
        };
        let raw = key.parse(&written).map_err(|why| wrong(at, &why))?;
        key.set(table, raw).map_err(|why| wrong(at, &why))?;
    }
    Ok(())
}

/// All values with their whole keys, in no order.
fn flatten<'t, 'v>(
    before: &str,
    table: &'t DeTable<'v>,
    values: &mut Vec<(String, &'t Spanned<DeValue<'v>>)>,
) {
    for (key, value) in table {
        let name = format!("{before}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) => flatten(&format!("{name}."), inner, values),
            _ => values.push((name, value)),
        }
    }
}

/// The text of a file with every value.
#[must_use]
pub fn whole(table: &Offsets, origin: &str, lang: Lang) -> String {
    let head = match lang {
        Lang::En => {
            "# Lengths in mm, X in diameter. tip: 0 to 9; measured: the axes that have been touched off."
        }
        Lang::Zh => "# 长度单位 mm，X 为直径值。tip：刀尖方向 0 至 9；measured：已对刀的轴。",
    };
    let mut out = format!("# {origin}\n{head}\n\n");
    let value = |key: Key| key.shown(key.get(table));
    let mut pair = |name: &str, keys: [Key; 2]| {
        let [x, z] = keys.map(value);
        // Writing into a string cannot fail.
        let _ = writeln!(out, "{name} = {{ X = {x}, Z = {z} }}");
    };
    let axes = [
        leadscrew_core::units::Axis::X,
        leadscrew_core::units::Axis::Z,
    ];
    pair("shift", axes.map(Key::Shift));
    for code in 54..=59 {
        pair(&format!("G{code}"), axes.map(|axis| Key::Work(code, axis)));
    }
    let [x, z, angle] = Groove::ALL.map(|field| value(Key::Thread(field)));
    let angle = match table.thread.angle {
        Some(_) => angle,
        None => format!("\"{angle}\""),
    };
    let _ = writeln!(out, "thread = {{ X = {x}, Z = {z}, angle = {angle} }}");
    out.push('\n');
    for number in 1..=TOOLS as u8 {
        let of = |field| value(Key::Tool(number, field));
        let [x, z, wear_x, wear_z, radius, tip, station, measured] = Field::ALL.map(of);
        let _ = writeln!(
            out,
            "T{number} = {{ X = {x}, Z = {z}, wear = {{ X = {wear_x}, Z = {wear_z} }}, radius = {radius}, tip = {tip}, \
             station = {station}, measured = \"{measured}\" }}"
        );
    }
    out
}
