//! The differences of two sets: number and name, old and new value with units.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, Params, Part};

use super::{functions, name, value_text};
use crate::json::Json;
use crate::words::pick;

/// A value that differs in the second set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The parameter.
    pub entry: &'static Entry,
    /// Its raw value in the first set.
    pub old: i64,
    /// Its raw value in the second set.
    pub new: i64,
}

/// All differences in the order of the table.
#[must_use]
pub fn changes(old: &Params, new: &Params) -> Vec<Change> {
    Entry::all()
        .iter()
        .map(|entry| Change {
            entry,
            old: old.get(entry),
            new: new.get(entry),
        })
        .filter(|change| change.old != change.new)
        .collect()
}

/// The name of the block of inputs and outputs among drives.
pub const BLOCK: &str = "IO";

/// An object of a drive, or of the block of inputs and outputs, that differs from the wanted one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DriveChange {
    /// `X`; [`BLOCK`].
    pub drive: &'static str,
    /// `607Fh:00h max_profile_velocity`.
    pub object: String,
    /// The present value.
    pub old: String,
    /// The wanted value.
    pub new: String,
}

/// The differences, one per line; empty for none.
#[must_use]
pub fn text(changes: &[Change], drives: &[DriveChange], lang: Lang) -> String {
    let of_set = changes.iter().map(|change| {
        let mut new = value_text(change.entry, change.new);
        let words = functions::row_of(change.entry).and_then(|_| functions::words(change.new));
        if let Some(words) = words {
            let _ = write!(new, "  # {words}");
        }
        [
            change.entry.to_string(),
            name(change.entry),
            value_text(change.entry, change.old),
            new,
        ]
    });
    let of_drives = drives.iter().map(|change| {
        [
            match change.drive {
                BLOCK => pick(lang, "I/O block", "输入输出模块").to_owned(),
                drive => format!("{} {drive}", pick(lang, "drive", "驱动器")),
            },
            change.object.clone(),
            change.old.clone(),
            change.new.clone(),
        ]
    });
    let rows: Vec<_> = of_set.chain(of_drives).collect();
    // A Chinese character takes two places.
    let columns =
        |text: &str| -> usize { text.chars().map(|c| 1 + usize::from(c >= '\u{2e80}')).sum() };
    let width = |at: usize| rows.iter().map(|row| columns(&row[at])).max().unwrap_or(0);
    let widths = [width(0), width(1), width(2)];
    let mut out = String::new();
    for row in &rows {
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(out, "{cell}{}", " ".repeat(width - columns(cell) + 2));
        }
        let [_, _, _, new] = row;
        let _ = writeln!(out, "→ {new}");
    }
    out
}

/// `"same"`, `"changes"` and `"drives"` in the machine format.
pub fn fields(json: &mut Json, changes: &[Change], drives: &[DriveChange]) {
    json.flag("same", changes.is_empty() && drives.is_empty());
    json.array_at("changes", |list| {
        for change in changes {
            list.object(|o| change.fields(o));
        }
    });
    json.array_at("drives", |list| {
        for change in drives {
            list.object(|o| {
                o.text("drive", change.drive);
                o.text("object", &change.object);
                o.text("old", &change.old);
                o.text("new", &change.new);
            });
        }
    });
}

impl Change {
    fn fields(&self, json: &mut Json) {
        let entry = self.entry;
        json.text("key", &entry.to_string());
        json.integer("no", i64::from(entry.no));
        match entry.part {
            Part::Whole => {}
            Part::Bit(bit) => json.integer("bit", i64::from(bit)),
            Part::Axis(axis) => {
                json.text("axis", char::from(axis.letter()).encode_utf8(&mut [0; 4]));
            }
        }
        json.text("name", entry.text().name);
        for (key, raw) in [("old", self.old), ("new", self.new)] {
            if entry.none() == Some(raw) {
                json.null(key);
            } else {
                json.number(key, entry.unit().number(raw));
            }
        }
        json.text("unit", entry.unit().symbol());
        if entry.unit().is_diameter() {
            json.flag("diameter", true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_told_in_columns() {
        let old = Params::slant_bed();
        assert_eq!(changes(&old, &old), []);
        let mut new = old.clone();
        for (key, raw) in [
            ("1420.X", 11_000_000_000),
            ("1320.C", 90_000_000),
            ("182.7", 1),
        ] {
            new.set(Entry::find_text(key).unwrap(), raw).unwrap();
        }
        let drives = [DriveChange {
            drive: "X",
            object: "6072h:00h max_torque".into(),
            old: "1000".into(),
            new: "900".into(),
        }];
        let expected = "\
182.7    pq_in_mm              0             → 1
1320.C   soft_limit_plus.C     none          → 90 °
1420.X   rapid_rate.X          12000 mm/min  → 11000 mm/min
drive X  6072h:00h max_torque  1000          → 900
";
        let found = changes(&old, &new);
        assert_eq!(text(&found, &drives, Lang::En), expected);
        assert_eq!(text(&[], &[], Lang::En), "");
        let back: Vec<_> = changes(&new, &old)
            .into_iter()
            .map(|change| Change {
                old: change.new,
                new: change.old,
                ..change
            })
            .collect();
        assert_eq!(back, found);
    }
}
