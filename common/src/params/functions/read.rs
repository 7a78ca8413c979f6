//! Reads `[io.NAME]` and `[m.CODE]` of a file into names and rows.

use std::ops::Range;

use leadscrew_core::alarm::Code;
use leadscrew_core::params::{
    Answer, Contact, Entry, FIRST_OF_BLOCK, FunctionAction, FunctionRow, ROWS,
};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::place::Side;
use super::{BLOCK_NODE, INVERTED, IO, Io, M, Named, RESET_OFF, SAFE, Table, entry};
use crate::diagnostics::Place;
use crate::params::file::{Source, in_order};
use crate::params::{Loader, key, mistake};

type Key<'a, 'i> = &'a Spanned<DeString<'i>>;
type Value<'a, 'i> = &'a Spanned<DeValue<'i>>;

/// What the two tables may have.
const IO_KEYS: [&str; 4] = ["at", "invert", "reset_off", "safe"];
const M_KEYS: [&str; 7] = ["set", "clear", "pulse", "answer", "within", "when", "row"];

/// The longest time of a row in milliseconds, and its step.
const LONGEST_MS: u32 = 99_990;
const STEP_MS: u32 = 10;

/// Parameters whose value may be a name: 9423 to 9426 and 9429, and 9427.
const INPUTS: [u16; 5] = [9423, 9424, 9425, 9426, 9429];
const OUTPUT: u16 = 9427;

/// Reads the names under `io`.
pub fn names(loader: &mut Loader, source: &Source, head: Key, value: Value) {
    let DeValue::Table(all) = value.get_ref() else {
        return not_a_table(loader, source, IO, "[io.coolant]", head);
    };
    let (mut inverted, mut reset_off) = (Bits::default(), Bits::default());
    let mut safe = Bits::default();
    for (name, value) in in_order(all) {
        let text = name.get_ref().as_ref();
        let head = format!("[io.{}]", mistake::shown(text));
        let DeValue::Table(table) = value.get_ref() else {
            not_a_table(loader, source, &format!("io.{text}"), &head, name);
            continue;
        };
        let mut fields = Fields {
            loader,
            source,
            head,
            table,
            at: name.span(),
        };
        fields.keys(&IO_KEYS);
        let Some((place, span)) = fields.text("at", "`\"input:1\"`, `\"output:1\"`") else {
            fields.missing("at", "`at = \"input:1\"` / `at = \"output:1\"`");
            continue;
        };
        let Some(io) = Io::at(&place) else {
            fields.wrong(
                "at",
                &span,
                "`\"input:1\"` … `\"input:16\"` / `\"output:1\"` … `\"output:16\"` / `\"pin:PC4\"` / `\"401:5:in0\"`",
            );
            continue;
        };
        if let Some(node) = Io::node_at(&place) {
            fields.block(node, &span);
        }
        for (key, side, bits) in [
            ("invert", Side::Input, &mut inverted),
            ("reset_off", Side::Output, &mut reset_off),
            ("safe", Side::Output, &mut safe),
        ] {
            let Some((on, span)) = fields.flag(key) else {
                continue;
            };
            // What the board itself switches is off without it.
            let has_it = key != "safe" || io.contact.is_of_block();
            if io.side == side && has_it {
                bits.take(io.contact, on, fields.source.place(&span));
            } else {
                fields.idle(key, &format!("at = \"{place}\""), &span);
            }
        }
        let named = Named {
            name: text.to_owned(),
            io,
        };
        let known = &mut loader.loaded.names;
        known.retain(|other| other.name != named.name);
        known.push(named);
    }
    inverted.put(loader, INVERTED, 0);
    reset_off.put(loader, RESET_OFF, 0);
    safe.put(loader, SAFE, FIRST_OF_BLOCK - 1);
}

/// Bits of a number of inputs or outputs that names set.
#[derive(Default)]
struct Bits {
    named: u32,
    on: u32,
    place: Option<Place>,
}

impl Bits {
    fn take(&mut self, contact: Contact, on: bool, place: Place) {
        self.named |= contact.bit();
        self.on |= if on { contact.bit() } else { 0 };
        self.place.get_or_insert(place);
    }

    /// The bits that are not named stay. `skipped` contacts have no bit.
    fn put(self, loader: &mut Loader, number: u16, skipped: u8) {
        let (Some(place), Ok(entry)) = (self.place, Entry::find(number, None)) else {
            return;
        };
        let before = loader.loaded.params.get(entry);
        let [named, on] = [self.named, self.on].map(|bits| i64::from(bits >> skipped));
        let raw = (before & !named) | on;
        loader.put(entry, raw, &place);
    }
}

/// Reads the tables under `m`, behind all values of the file.
pub fn apply(loader: &mut Loader, source: &Source, head: Key, value: Value) {
    let DeValue::Table(all) = value.get_ref() else {
        return not_a_table(loader, source, M, "[m.8]", head);
    };
    let mut found = Vec::new();
    for (name, value) in in_order(all) {
        let text = name.get_ref().as_ref();
        let digits = text.len() <= 3 && text.bytes().all(|b| b.is_ascii_digit());
        let code = text.parse().ok().filter(|code| digits && *code > 0);
        let (Some(code), DeValue::Table(table)) = (code, value.get_ref()) else {
            not_a_table(loader, source, &format!("m.{text}"), "[m.8]", name);
            continue;
        };
        let mut fields = Fields {
            loader,
            source,
            head: format!("[m.{text}]"),
            table,
            at: name.span(),
        };
        fields.keys(&M_KEYS);
        let row = fields.row(code);
        let pinned = fields.pinned();
        let Some(row) = row else { continue };
        let table = Table {
            row: pinned.unwrap_or_default(),
            pinned: pinned.is_some(),
            key: name.span(),
            value: value.span(),
            fields: in_order(table)
                .iter()
                .map(|(key, _)| key.span().start)
                .collect(),
        };
        found.push((row, table));
    }
    // What says its row gets it before the others take what is left.
    found.sort_by_key(|(_, table)| !table.pinned);
    for (row, table) in found {
        let at = source.place(&table.key);
        loader.function(&row, table, &at);
    }
}

impl Loader {
    /// Puts a row where it says, else where its code has one from a file before, else into the first that is free.
    fn function(&mut self, row: &FunctionRow, table: Table, at: &Place) {
        let code = |value| FunctionRow::of(value).map(|row| row.code);
        let of_code =
            super::rows(&self.loaded.params).find(|(_, old)| code(*old) == Some(row.code));
        if let Some((other, _)) = of_code
            && let Some(line) = self.line_here(other)
        {
            let figures = [format!("M{}", row.code), line.to_string()];
            return self.report(Code::ParamTwice, &figures, at);
        }
        let free = || {
            let mut rows = super::rows(&self.loaded.params);
            rows.find(|(row, old)| *old == 0 && self.line_here(*row).is_none())
        };
        let pinned = table.pinned.then_some(table.row);
        let place = pinned.or_else(|| of_code.or_else(free).map(|(row, _)| row));
        let Some((place, entry)) = place.and_then(|row| Some((row, entry(row)?))) else {
            return self.report(Code::RowsTaken, &[row.code.to_string()], at);
        };
        // Its old row, where it moves to another.
        if let Some((other, _)) = of_code
            && other != place
            && let Some(old) = super::entry(other)
        {
            self.put(old, 0, at);
        }
        if self.put(entry, row.value(), at) {
            self.loaded.functions.push(Table {
                row: place,
                ..table
            });
        }
    }

    /// The line of this file that has set a row.
    fn line_here(&self, row: u8) -> Option<u32> {
        let source = self.loaded.sources.get(&key(entry(row)?))?;
        (source.layer == self.layer).then_some(source.place.line)
    }
}

/// The contact that a value names; `None` where the value of this parameter cannot be a name, or is none; `Some(None)`
/// where there is none of this name, which has been reported.
pub fn contact_number(
    loader: &mut Loader,
    entry: &Entry,
    text: &str,
    place: &Place,
) -> Option<Option<Contact>> {
    let side = match entry.no {
        number if INPUTS.contains(&number) => Side::Input,
        OUTPUT => Side::Output,
        _ => return None,
    };
    // Digits are a number, and what is wrong with them is told as of any other parameter.
    if text.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    Some(loader.contact(text, side, place))
}

impl Loader {
    /// The contact of a name or a place; what is wrong with it has been reported.
    fn contact(&mut self, text: &str, side: Side, place: &Place) -> Option<Contact> {
        let named = self.loaded.names.iter().find(|named| named.name == text);
        let io = named.map(|named| named.io).or_else(|| Io::at(text));
        let code = match io {
            Some(io) if io.side == side => return Some(io.contact),
            Some(_) => Code::IoOtherSide,
            None => Code::IoUnknown,
        };
        let figures = [mistake::shown(text), side.name().to_owned()];
        self.report(code, &figures, place);
        None
    }
}

/// `io`, `m`, or what is in them, is no table, or has no such name.
fn not_a_table(loader: &mut Loader, source: &Source, name: &str, example: &str, head: Key) {
    let place = source.place(&head.span());
    let figures = [
        format!("[{}]", name.split('.').next().unwrap_or_default()),
        mistake::shown(name),
        format!("`{example}`"),
    ];
    loader.report(Code::FieldUnknown, &figures, &place);
}

/// The keys of a table.
struct Fields<'l, 's, 't, 'i> {
    loader: &'l mut Loader,
    source: &'s Source<'s>,
    /// `[m.8]`.
    head: String,
    table: &'t DeTable<'i>,
    /// The bytes of its name.
    at: Range<usize>,
}

impl Fields<'_, '_, '_, '_> {
    /// Reports the keys that are none of these.
    fn keys(&mut self, known: &[&str]) {
        for (key, _) in in_order(self.table) {
            let name = key.get_ref().as_ref();
            if known.contains(&name) {
                continue;
            }
            let choice: Vec<_> = known.iter().map(|key| format!("`{key}`")).collect();
            let figures = [self.head.clone(), mistake::shown(name), choice.join(" / ")];
            let place = self.source.place(&key.span());
            self.loader.report(Code::FieldUnknown, &figures, &place);
        }
    }

    /// A place at the block with this node. There is one block.
    fn block(&mut self, node: u8, span: &Range<usize>) {
        let Ok(entry) = Entry::find(BLOCK_NODE, None) else {
            return;
        };
        let loaded = &self.loader.loaded;
        let source = loaded.sources.get(&key(entry));
        let other = loaded.params.get(entry);
        if source.is_none_or(|source| source.layer != self.loader.layer) {
            let place = self.source.place(span);
            self.loader.put(entry, node.into(), &place);
        } else if other != i64::from(node) {
            let expected = format!("`\"401:{other}:in0\"` … `\"401:{other}:out15\"`");
            self.wrong("at", span, &expected);
        }
    }

    fn has(&self, key: &str) -> Option<Range<usize>> {
        self.table.get(key).map(Spanned::span)
    }

    fn text(&mut self, key: &str, example: &str) -> Option<(String, Range<usize>)> {
        let value = self.table.get(key)?;
        match value.get_ref() {
            DeValue::String(text) => Some((text.to_string(), value.span())),
            _ => {
                self.wrong(key, &value.span(), example);
                None
            }
        }
    }

    fn flag(&mut self, key: &str) -> Option<(bool, Range<usize>)> {
        let value = self.table.get(key)?;
        match value.get_ref() {
            DeValue::Boolean(on) => Some((*on, value.span())),
            _ => {
                self.wrong(key, &value.span(), "`true` / `false`");
                None
            }
        }
    }

    /// What the table means as a row; `None` where anything is wrong with it, which has been reported.
    fn row(&mut self, code: u16) -> Option<FunctionRow> {
        let before = self.loader.loaded.diagnostics.len();
        let on = self.output("set");
        let off = self.output("clear");
        if let (Some(_), Some(span)) = (self.has("set"), self.has("clear")) {
            self.idle("set", "clear", &span);
        }
        let answer = self.answer();
        let pulse = self.time("pulse");
        let within = self.time("within");
        let behind = self.text("when", "`\"before\"` / `\"after\"`");
        let behind = behind.is_some_and(|(when, span)| match &*when {
            "before" => false,
            "after" => true,
            _ => {
                self.wrong("when", &span, "`\"before\"` / `\"after\"`");
                false
            }
        });
        match (self.has("pulse"), self.has("within"), self.has("answer")) {
            (Some(_), Some(span), _) => self.idle("pulse", "within", &span),
            (Some(_), None, _) if self.has("set").is_none() => {
                self.missing("set", "`set = \"output:1\"`");
            }
            (None, Some(_), None) => self.missing("answer", "`answer = \"input:1=1\"`"),
            (None, None, Some(_)) => self.missing("within", "`within = \"2 s\"`"),
            _ => {}
        }
        let any = ["set", "clear", "answer"].map(|key| self.has(key));
        if any.iter().all(Option::is_none)
            && self.has("pulse").is_none()
            && self.has("within").is_none()
        {
            self.missing(
                "set",
                "`set = \"output:1\"` / `clear = \"output:1\"` / `answer = \"input:1=1\"`",
            );
        }
        if self.loader.loaded.diagnostics.len() != before {
            return None;
        }
        let switches = match (on, off, pulse) {
            (Some(output), _, Some(_)) => Some((output, FunctionAction::Pulse)),
            (Some(output), _, None) => Some((output, FunctionAction::On)),
            (None, off, _) => off.map(|output| (output, FunctionAction::Off)),
        };
        Some(FunctionRow {
            code,
            switches,
            answer,
            time_ms: pulse.or(within).unwrap_or(0),
            behind,
        })
    }

    fn output(&mut self, key: &str) -> Option<Contact> {
        let (text, span) = self.text(key, "`\"output:1\"`")?;
        let place = self.source.place(&span);
        self.loader.contact(&text, Side::Output, &place)
    }

    /// `flow=1`.
    fn answer(&mut self) -> Option<Answer> {
        const EXAMPLE: &str = "`\"input:1=1\"` / `\"input:1=0\"`";
        let (text, span) = self.text("answer", EXAMPLE)?;
        let parts = text.rsplit_once('=');
        let parts = parts.map(|(name, level)| (name.trim(), level.trim()));
        let Some((name, level @ ("0" | "1"))) = parts else {
            self.wrong("answer", &span, EXAMPLE);
            return None;
        };
        let place = self.source.place(&span);
        let input = self.loader.contact(name, Side::Input, &place)?;
        Some(Answer {
            input,
            on: level == "1",
        })
    }

    /// A time of a row in milliseconds.
    fn time(&mut self, key: &str) -> Option<u32> {
        const EXAMPLE: &str = "`\"2 s\"` / `\"200 ms\"` (10 ms … 99.99 s)";
        let (text, span) = self.text(key, EXAMPLE)?;
        let ms = milliseconds(&text);
        let ms = ms.filter(|ms| (STEP_MS..=LONGEST_MS).contains(ms) && ms.is_multiple_of(STEP_MS));
        if ms.is_none() {
            self.wrong(key, &span, EXAMPLE);
        }
        ms
    }

    /// `row = 3`.
    fn pinned(&mut self) -> Option<u8> {
        let value = self.table.get("row")?;
        let row = match value.get_ref() {
            DeValue::Integer(number) => number.as_str().parse().ok(),
            _ => None,
        };
        let row = row.filter(|row| (1..=ROWS).contains(row));
        if row.is_none() {
            self.wrong("row", &value.span(), "`1` … `16`");
        }
        row
    }

    fn wrong(&mut self, key: &str, span: &Range<usize>, expected: &str) {
        let found = self.source.text_at(span).lines().next().unwrap_or_default();
        let found: String = found.chars().take(60).collect();
        let figures = [
            self.head.clone(),
            key.to_owned(),
            format!("`{found}`"),
            expected.to_owned(),
        ];
        let place = self.source.place(span);
        self.loader.report(Code::FieldValue, &figures, &place);
    }

    fn missing(&mut self, key: &str, example: &str) {
        // A key that is there and wrong has been reported.
        if self.has(key).is_some() {
            return;
        }
        let figures = [self.head.clone(), key.to_owned(), example.to_owned()];
        let place = self.source.place(&self.at);
        self.loader.report(Code::FieldMissing, &figures, &place);
    }

    fn idle(&mut self, key: &str, beside: &str, span: &Range<usize>) {
        let figures = [self.head.clone(), key.to_owned(), beside.to_owned()];
        let place = self.source.place(span);
        self.loader.report(Code::FieldIdle, &figures, &place);
    }
}

/// `2 s`, `0.5 s`, `200 ms`.
fn milliseconds(text: &str) -> Option<u32> {
    let text = text.trim();
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, 1),
        None => (text.strip_suffix('s')?, 1000),
    };
    let number = number.trim_end();
    let (whole, part) = number.split_once('.').unwrap_or((number, "0"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if !digits(whole) || !digits(part) || part.len() > 3 {
        return None;
    }
    let thousandths = format!("{part:0<3}").parse::<u32>().ok()?;
    let parts = thousandths.checked_mul(unit)?;
    if !parts.is_multiple_of(1000) {
        return None;
    }
    let whole = whole.parse::<u32>().ok()?.checked_mul(unit)?;
    whole.checked_add(parts / 1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds_or_milliseconds() {
        for (text, ms) in [
            ("2 s", Some(2000)),
            ("2s", Some(2000)),
            ("0.25 s", Some(250)),
            ("99.99 s", Some(99_990)),
            ("200 ms", Some(200)),
            ("1.5 ms", None),
            ("2", None),
            ("s", None),
            ("-1 s", None),
            ("1.2345 s", None),
            ("5000000 s", None),
            ("2 min", None),
        ] {
            assert_eq!(milliseconds(text), ms, "{text}");
        }
    }
}
