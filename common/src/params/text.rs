//! A parameter as text: its name, its value with a unit, and both in the form of a machine file.

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, Part};

/// `thread_angle`, `rapid_rate.X`: the name that a machine file may use for the number.
#[must_use]
pub fn name(entry: &Entry) -> String {
    match entry.part {
        Part::Axis(axis) => format!("{}.{}", entry.text().name, char::from(axis.letter())),
        Part::Whole | Part::Bit(_) => entry.text().name.into(),
    }
}

/// A raw value with its unit, for a person.
#[must_use]
pub fn value_text(entry: &Entry, raw: i64) -> String {
    if entry.none() == Some(raw) {
        "none".into()
    } else {
        entry.unit().text(raw).to_string()
    }
}

/// The same for a machine file: a plain number, or a text with the unit.
#[must_use]
pub fn literal(entry: &Entry, raw: i64) -> String {
    if entry.none() != Some(raw) && entry.unit().is_bare() {
        entry.unit().number(raw).to_string()
    } else {
        format!("\"{}\"", value_text(entry, raw))
    }
}

/// The meaning of the parameter.
#[must_use]
pub fn meaning(entry: &Entry, lang: Lang) -> &'static str {
    match lang {
        Lang::En => entry.text().en,
        Lang::Zh => entry.text().zh,
    }
}

/// A chapter of the table: its numbers, and its heading in both languages.
#[derive(Debug)]
pub struct Chapter {
    /// True for a number of this chapter.
    pub numbers: fn(u16) -> bool,
    en: &'static str,
    zh: &'static str,
}

impl Chapter {
    /// The heading.
    #[must_use]
    pub const fn title(&self, lang: Lang) -> &'static str {
        match lang {
            Lang::En => self.en,
            Lang::Zh => self.zh,
        }
    }
}

/// All numbers in the order of the manual and of files.
pub const CHAPTERS: [Chapter; 4] = [
    Chapter {
        numbers: |no| no < 1000,
        en: "Cycles: numbers of the 980TD",
        zh: "循环：980TD 参数号",
    },
    Chapter {
        numbers: |no| (5000..9000).contains(&no),
        en: "Cycles: numbers of the 988",
        zh: "循环：988 参数号",
    },
    Chapter {
        numbers: |no| (1000..5000).contains(&no),
        en: "Machine: FANUC numbers",
        zh: "机床：FANUC 参数号",
    },
    Chapter {
        numbers: |no| no >= 9000,
        en: "Machine: our own numbers",
        zh: "机床：自有参数号",
    },
];
