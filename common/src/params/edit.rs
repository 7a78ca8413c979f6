//! Changes values in the text of a parameter file. Comments, order and style stay, byte by byte.
//!
//! An existing value or key is replaced in its place. A new value gets a line of its own next to a similar one. The text
//! must have been read without a mistake before.

use std::ops::Range;

use leadscrew_core::params::Entry;
use toml::de::{DeTable, DeValue};

use super::file::in_order;
use super::{functions, literal, name};

/// A value in a file: the pieces of its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// The number or name, without quotes.
    pub head: String,
    /// The bit or axis, where it is a key of its own.
    pub part: Option<String>,
    /// Place of the head.
    pub head_span: Range<usize>,
    /// Place of the part.
    pub part_span: Option<Range<usize>>,
    /// Place of the value.
    pub value_span: Range<usize>,
    /// How the head and the part are written together.
    pub style: Style,
    /// The value is written as `true` or `false`.
    pub boolean: bool,
}

/// How a key is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// `"1420.X" = …`, `5130 = …`.
    Single,
    /// `1420.X = …`.
    Dotted,
    /// `X = …` under `[1420]`.
    Header,
    /// `1420 = { X = … }`.
    Inline,
}

impl Leaf {
    /// `1420.X`.
    #[must_use]
    pub fn key(&self) -> String {
        match &self.part {
            Some(part) => format!("{}.{part}", self.head),
            None => self.head.clone(),
        }
    }
}

/// Every value of a file in order, without the top-level keys in `skip`. `None` for a text that is not TOML.
#[must_use]
pub fn leaves(text: &str, skip: &[&str]) -> Option<Vec<Leaf>> {
    let table = DeTable::parse(text).ok()?;
    let mut found = Vec::new();
    for (key, value) in in_order(table.get_ref()) {
        let head = key.get_ref().as_ref();
        if skip.contains(&head) {
            continue;
        }
        let DeValue::Table(parts) = value.get_ref() else {
            found.push(Leaf {
                head: head.to_owned(),
                part: None,
                head_span: key.span(),
                part_span: None,
                value_span: value.span(),
                style: Style::Single,
                boolean: matches!(value.get_ref(), DeValue::Boolean(_)),
            });
            continue;
        };
        for (part, value) in in_order(parts) {
            let (style, head_span) = head_of(text, &part.span(), key.span());
            found.push(Leaf {
                head: head.to_owned(),
                part: Some(part.get_ref().as_ref().to_owned()),
                head_span,
                part_span: Some(part.span()),
                value_span: value.span(),
                style,
                boolean: matches!(value.get_ref(), DeValue::Boolean(_)),
            });
        }
    }
    found.sort_by_key(|leaf| leaf.value_span.start);
    Some(found)
}

/// The place of a part's head. A table knows only the first place where its name is written.
fn head_of(text: &str, part: &Range<usize>, first: Range<usize>) -> (Style, Range<usize>) {
    let line = text[..part.start].rfind('\n').map_or(0, |at| at + 1);
    let before = text[line..part.start].trim_end();
    if let Some(head) = before.strip_suffix('.') {
        let head = head.trim_end();
        let indent = head.len() - head.trim_start().len();
        return (Style::Dotted, line + indent..line + head.len());
    }
    if before.is_empty() {
        (Style::Header, first)
    } else {
        (Style::Inline, first)
    }
}

/// A replacement in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replacement {
    /// The replaced piece; an empty piece is a place to insert.
    pub span: Range<usize>,
    /// The new text.
    pub by: String,
}

/// The text after all replacements. They may not overlap; insertions at one place stay in the given order.
#[must_use]
pub fn replaced(text: &str, mut replacements: Vec<Replacement>) -> String {
    replacements.sort_by_key(|replacement| replacement.span.start);
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for Replacement { span, by } in replacements {
        out.push_str(&text[at..span.start]);
        out.push_str(&by);
        at = span.end;
    }
    out.push_str(&text[at..]);
    out
}

/// The text of a file with these values. Existing values are changed in place, the others are added.
#[must_use]
pub fn with_values(text: &str, values: &[(&'static Entry, i64)]) -> String {
    let end = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let Some(leaves) = leaves(text, &super::OTHER_KEYS) else {
        return text.to_owned();
    };
    let functions::Rewritten {
        mut replacements,
        rows,
    } = functions::rewritten(text, values);
    let mut added = String::new();
    for &(entry, raw) in values {
        if functions::row_of(entry).is_some_and(|row| rows.contains(&row)) {
            continue;
        }
        let same = |leaf: &&Leaf| Entry::find_text(&leaf.key()) == Ok(entry);
        if let Some(leaf) = leaves.iter().find(same) {
            replacements.push(Replacement {
                span: leaf.value_span.clone(),
                by: match (leaf.boolean, raw) {
                    (true, 0) => "false".into(),
                    (true, _) => "true".into(),
                    (false, _) => literal(entry, raw),
                },
            });
            continue;
        }
        // Another axis or bit of the same number, the last one.
        let like = leaves
            .iter()
            .rev()
            .find(|leaf| Entry::find_text(&leaf.key()).is_ok_and(|other| other.no == entry.no));
        match like {
            Some(like) => replacements.push(beside(text, like, entry, raw, end)),
            None => {
                added.push_str(&format!("{} = {}{end}", name(entry), literal(entry, raw)));
            }
        }
    }
    if !added.is_empty() {
        replacements.push(at_top(text, &leaves, added, end));
    }
    replaced(text, replacements)
}

/// Adds a value next to one of the same number, in the same style.
fn beside(text: &str, like: &Leaf, entry: &Entry, raw: i64, end: &str) -> Replacement {
    let full = entry.to_string();
    let part = full.split_once('.').map_or("", |(_, part)| part);
    let value = literal(entry, raw);
    if like.style == Style::Inline {
        let at = like.value_span.end;
        return Replacement {
            span: at..at,
            by: format!(", {part} = {value}"),
        };
    }
    let key = match like.style {
        Style::Dotted => format!("{}.{part}", &text[like.head_span.clone()]),
        Style::Header => part.to_owned(),
        // A name may stand for one bit by itself.
        Style::Single | Style::Inline => name(entry),
    };
    line_behind(text, like.value_span.end, &format!("{key} = {value}"), end)
}

/// Adds a line after the line with the byte `at`.
fn line_behind(text: &str, at: usize, line: &str, end: &str) -> Replacement {
    match text[at..].find('\n') {
        Some(more) => Replacement {
            span: at + more + 1..at + more + 1,
            by: format!("{line}{end}"),
        },
        None => Replacement {
            span: text.len()..text.len(),
            by: format!("{end}{line}{end}"),
        },
    }
}

/// Adds lines after the last value that is not under a header; at the beginning where all values are under headers.
fn at_top(text: &str, leaves: &[Leaf], lines: String, end: &str) -> Replacement {
    let first_header = leaves
        .iter()
        .filter(|leaf| leaf.style == Style::Header)
        .map(|leaf| leaf.head_span.start)
        .chain(header_of_others(text))
        .min()
        .unwrap_or(text.len());
    let last = leaves
        .iter()
        .filter(|leaf| leaf.style != Style::Header && leaf.value_span.end <= first_header)
        .map(|leaf| leaf.value_span.end)
        .chain(schema_end(text))
        .max();
    if let Some(at) = last {
        return line_behind(text, at, lines.trim_end(), end);
    }
    if first_header < text.len() {
        return Replacement {
            span: 0..0,
            by: format!("{lines}{end}"),
        };
    }
    let open = !text.is_empty() && !text.ends_with('\n');
    Replacement {
        span: text.len()..text.len(),
        by: if open { format!("{end}{lines}") } else { lines },
    }
}

/// The place of the first header that is not a parameter's.
fn header_of_others(text: &str) -> Option<usize> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let head = line.trim_start().strip_prefix('[');
        let head = head.map(|head| head.split([']', '.']).next().unwrap_or_default());
        if head.is_some_and(|head| super::OTHER_KEYS.contains(&head.trim())) {
            return Some(start);
        }
        start += line.len();
    }
    None
}

/// The end of the value of `schema`.
fn schema_end(text: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    Some(table.get_ref().get(super::schema::KEY)?.span().end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(key: &str) -> &'static Entry {
        Entry::find_text(key).unwrap()
    }

    #[track_caller]
    fn changed(text: &str, values: &[(&str, i64)], expected: &str) {
        let values: Vec<_> = values.iter().map(|(key, raw)| (entry(key), *raw)).collect();
        assert_eq!(with_values(text, &values), expected);
        // The file reads as requested, and a second edit changes nothing.
        let loaded = super::super::load_text("f", expected, leadscrew_core::alarm::Lang::En);
        for (entry, raw) in &values {
            assert_eq!(loaded.params.get(entry), *raw, "{entry}");
        }
        assert_eq!(with_values(expected, &values), expected);
    }

    #[test]
    fn a_value_changes_where_it_stands_and_nothing_else_does() {
        changed(
            "# my lathe\n\n\"1420.X\" =   \"12 m/min\"   # rapid, was 10\nthread_angle = \"55 °\"\n",
            &[("1420.X", 11_000_000_000), ("058", 60)],
            "# my lathe\n\n\"1420.X\" =   \"11000 mm/min\"   # rapid, was 10\nthread_angle = \"60 °\"\n",
        );
        changed(
            "[1420] # slides\r\n  X = '12 m/min' # a\r\n\r\n[drive.X]\r\nmax_torque = 5\r\n",
            &[("1420.X", 11_000_000_000)],
            "[1420] # slides\r\n  X = \"11000 mm/min\" # a\r\n\r\n[drive.X]\r\nmax_torque = 5\r\n",
        );
        changed(
            "work_offset_g54 = { X = \"1 mm\", Z = \"2 mm\" } # zero\n182.7 = true\n",
            &[("1221.Z", 3_000_000), ("182.7", 0)],
            "work_offset_g54 = { X = \"1 mm\", Z = \"3 mm\" } # zero\n182.7 = false\n",
        );
        changed(
            "1320.C = \"7 °\"",
            &[("1320.C", i64::MAX)],
            "1320.C = \"none\"",
        );
    }

    #[test]
    fn what_a_file_does_not_have_comes_beside_its_like() {
        changed(
            "rapid_rate.X = \"12 m/min\" # slow\ntap_m_code = 0\n",
            &[("1420.Z", 9_000_000_000)],
            "rapid_rate.X = \"12 m/min\" # slow\nrapid_rate.Z = \"9000 mm/min\"\ntap_m_code = 0\n",
        );
        changed(
            "tap_m_code = 0\n[1420]\nX = \"12 m/min\"",
            &[("1420.Z", 9_000_000_000), ("9007", 12)],
            "tap_m_code = 0\nspindle_tolerance_percent = \"12 %\"\n[1420]\nX = \"12 m/min\"\nZ = \"9000 mm/min\"\n",
        );
        changed(
            "9101 = { X = \"1 mm\" }\n",
            &[("9101.Z", 2_000_000)],
            "9101 = { X = \"1 mm\", Z = \"2 mm\" }\n",
        );
        changed(
            "# only words\n[1420]\nX = \"12 m/min\"\n",
            &[("9007", 12)],
            "spindle_tolerance_percent = \"12 %\"\n\n# only words\n[1420]\nX = \"12 m/min\"\n",
        );
        changed(
            "schema = 2 # of this file\n\n[drive.X]\nmax_torque = 5\n",
            &[("9007", 12)],
            "schema = 2 # of this file\nspindle_tolerance_percent = \"12 %\"\n\n[drive.X]\nmax_torque = 5\n",
        );
        changed("", &[("182.7", 1)], "pq_in_mm = 1\n");
        changed("# none", &[("182.7", 1)], "# none\npq_in_mm = 1\n");
    }

    #[test]
    fn every_value_of_the_table_can_be_added_and_changed() {
        let all = |pick: fn(&Entry) -> i64| -> Vec<_> {
            Entry::all()
                .iter()
                .map(|entry| (entry, pick(entry)))
                .collect()
        };
        let low = with_values("# all\n", &all(|entry| entry.min()));
        let high = with_values(&low, &all(|entry| entry.none().unwrap_or(entry.max())));
        assert_eq!(low.lines().count(), high.lines().count());
        for (text, pick) in [
            (low, (|entry| entry.min()) as fn(&Entry) -> i64),
            (high, |entry| entry.none().unwrap_or(entry.max())),
        ] {
            let mut loader = super::super::Loader::new(None, leadscrew_core::alarm::Lang::En);
            loader.file("f", text.as_bytes());
            assert!(loader.loaded.is_good(), "{:?}", loader.loaded.diagnostics);
            for entry in Entry::all() {
                assert_eq!(loader.loaded.params.get(entry), pick(entry), "{entry}");
            }
        }
    }
}
