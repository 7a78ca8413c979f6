//! The version of the parameter table that a file was written for, and the way from an older file to this version.
//!
//! A version counts up with every release whose table differs; the board's storage uses the same number. A file without
//! `schema` counts as one of this version, and its mistakes are reported key by key [D119].

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Entry;

use super::edit::{Leaf, Replacement, leaves, replaced};
use super::value_text;
use crate::words::{Both, both};

/// The version of this program's table.
pub const SCHEMA: u32 = leadscrew_core::params::SCHEMA as u32;

/// The key in a file.
pub const KEY: &str = "schema";

/// The changes from one version to the next.
#[derive(Clone, Copy, Debug)]
pub struct Migration {
    /// The new version; the old one is the version before.
    pub to: u32,
    /// The changes.
    pub steps: &'static [Step],
}

/// One change of the table. Keys are written as in a file; a number and each of its names is a key.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// These keys have a new name; bits and axes stay.
    Renamed {
        /// Old number, second number and name.
        from: &'static [&'static str],
        /// The new name.
        to: &'static str,
    },
    /// These keys are gone.
    Dropped {
        /// Old number, second number and name.
        keys: &'static [&'static str],
        /// The reason, in English.
        en: &'static str,
        /// The reason, in Chinese.
        zh: &'static str,
    },
    /// A new key.
    New {
        /// Its key.
        key: &'static str,
    },
    /// A key with another range.
    Range {
        /// Its key.
        key: &'static str,
    },
}

/// All migrations, the oldest first.
pub const MIGRATIONS: &[Migration] = &[
    // No board follows the SYNC of another [D212].
    Migration {
        to: 2,
        steps: &[
            Step::Dropped {
                keys: &["9029", "sync_source"],
                en: "every board gives its own beat, on a wire of its own",
                zh: "每块控制板在自己的总线上发出节拍",
            },
            Step::Dropped {
                keys: &["9030", "bus_others"],
                en: "no other board is on its wire",
                zh: "总线上没有其他控制板",
            },
        ],
    },
];

/// The result of a migration of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Migrated {
    /// The old version.
    pub from: u32,
    /// The new version.
    pub to: u32,
    /// The steps.
    pub notes: Vec<Note>,
    /// The new text of the file.
    pub text: String,
}

/// A step, or a place that a person must check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// `renamed`, `dropped`, `new`, `range`.
    pub kind: &'static str,
    /// The key, as it is written in the file.
    pub key: String,
    /// In words.
    pub words: Both,
    /// A person must check this before the file can be used.
    pub open: bool,
}

/// The reason why a file cannot be migrated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unmigratable {
    /// It is not TOML, or its `schema` is no whole number.
    Unreadable,
    /// No migration leads from its version.
    Version(u32),
}

/// Migrates the text of a file to the last version of `migrations`. A file without a version counts as one of `first`.
///
/// # Errors
/// [`Unmigratable`].
pub fn migrate(
    text: &str,
    migrations: &[Migration],
    current: u32,
    first: Option<u32>,
) -> Result<Migrated, Unmigratable> {
    let from = match version(text)? {
        Some(version) => version,
        None => first.unwrap_or(current),
    };
    let mut notes = Vec::new();
    let mut text = text.to_owned();
    let mut at = from;
    while at != current {
        let next = migrations.iter().find(|m| at.checked_add(1) == Some(m.to));
        let Some(next) = next.filter(|_| at < current) else {
            return Err(Unmigratable::Version(from));
        };
        text = step(&text, next.steps, &mut notes).ok_or(Unmigratable::Unreadable)?;
        at = next.to;
    }
    let text = with_version(&text, current);
    Ok(Migrated {
        from,
        to: current,
        notes,
        text,
    })
}

/// The version in a file.
///
/// # Errors
/// [`Unmigratable::Unreadable`].
pub fn version(text: &str) -> Result<Option<u32>, Unmigratable> {
    use toml::de::{DeTable, DeValue};
    let table = DeTable::parse(text).map_err(|_| Unmigratable::Unreadable)?;
    match table.get_ref().get(KEY).map(|value| value.get_ref()) {
        None => Ok(None),
        Some(DeValue::Integer(number)) if number.radix() == 10 => number
            .as_str()
            .parse()
            .map(Some)
            .map_err(|_| Unmigratable::Unreadable),
        Some(_) => Err(Unmigratable::Unreadable),
    }
}

fn with_version(text: &str, version: u32) -> String {
    let table = toml::de::DeTable::parse(text).ok();
    let span = table.and_then(|table| Some(table.get_ref().get(KEY)?.span()));
    let end = if text.contains("\r\n") { "\r\n" } else { "\n" };
    match span {
        Some(span) => replaced(
            text,
            vec![Replacement {
                span,
                by: version.to_string(),
            }],
        ),
        None => format!("{KEY} = {version}{end}{text}"),
    }
}

fn step(text: &str, steps: &[Step], notes: &mut Vec<Note>) -> Option<String> {
    let mut replacements: Vec<Replacement> = Vec::new();
    let leaves = leaves(text, &super::OTHER_KEYS)?;
    let named = |key: &'static str| leaves.iter().filter(move |leaf| is(leaf, key));
    let mut note = |kind, key: String, words, open| {
        notes.push(Note {
            kind,
            key,
            words,
            open,
        });
    };
    for step in steps {
        match *step {
            Step::Renamed { from, to } => {
                for leaf in from.iter().flat_map(|key| named(key)) {
                    let whole = leaf.part.is_none() && leaf.head.contains('.');
                    let by = match leaf.head.split_once('.') {
                        Some((_, part)) if whole => format!("\"{to}.{part}\""),
                        _ => to.to_owned(),
                    };
                    let replacement = Replacement {
                        span: leaf.head_span.clone(),
                        by,
                    };
                    // Several axes under one header have one head.
                    if !replacements.contains(&replacement) {
                        replacements.push(replacement);
                    }
                    let words = both!("is called {to} now", "现在叫 {to}");
                    note("renamed", leaf.key(), words, false);
                }
            }
            Step::Dropped { keys, en, zh } => {
                for leaf in keys.iter().flat_map(|key| named(key)) {
                    // The line stays as a comment.
                    let line = text[..leaf.value_span.start]
                        .rfind('\n')
                        .map_or(0, |at| at + 1);
                    let replacement = Replacement {
                        span: line..line,
                        by: "# ".into(),
                    };
                    if !replacements.contains(&replacement) {
                        replacements.push(replacement);
                    }
                    let words = both!(
                        "is no more ({en}); its line is a comment now",
                        "已取消（{zh}）；该行已改为注释"
                    );
                    note("dropped", leaf.key(), words, false);
                }
            }
            Step::New { key } => {
                if named(key).next().is_none() {
                    let words = match Entry::find_text(key) {
                        Ok(entry) => {
                            let built_in = leadscrew_core::params::Params::slant_bed().get(entry);
                            let value = value_text(entry, built_in);
                            let (en, zh) = (
                                super::meaning(entry, Lang::En),
                                super::meaning(entry, Lang::Zh),
                            );
                            both!(
                                "is new and stays at {value}: {en}",
                                "是新参数，取内置值 {value}：{zh}"
                            )
                        }
                        Err(_) => both!("is new", "是新参数"),
                    };
                    note("new", key.to_owned(), words, false);
                }
            }
            Step::Range { key } => {
                for leaf in named(key) {
                    let words = match Entry::find_text(&leaf.key()) {
                        Ok(entry) => {
                            let (low, high) = (
                                entry.unit().number(entry.min()),
                                entry.unit().text(entry.max()),
                            );
                            both!(
                                "goes from {low} to {high} now: look at its value",
                                "范围现为 {low} 至 {high}：请检查它的值"
                            )
                        }
                        Err(_) => both!(
                            "takes other values now: look at its value",
                            "取值范围已改变：请检查它的值"
                        ),
                    };
                    note("range", leaf.key(), words, true);
                }
            }
        }
    }
    Some(replaced(text, replacements))
}

/// True where a key of the table means this leaf; a key without a part means all parts.
fn is(leaf: &Leaf, key: &str) -> bool {
    let plain = |text: &str| text.trim_start_matches('0').to_ascii_lowercase();
    let split = |text: &str| match text.split_once('.') {
        Some((head, part)) => (plain(head), Some(part.to_ascii_lowercase())),
        None => (plain(text), None),
    };
    let (head, part) = split(key);
    let (leaf_head, leaf_part) = split(&leaf.key());
    head == leaf_head && (part.is_none() || part == leaf_part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Version 8 called 1420 `fast` (or 1400), and had 1401, which no version has; version 9 came between.
    const SYNTHETIC: &[Migration] = &[
        Migration {
            to: 9,
            steps: &[Step::Renamed {
                from: &["fast", "1400"],
                to: "rapid",
            }],
        },
        Migration {
            to: 10,
            steps: &[
                Step::Renamed {
                    from: &["rapid"],
                    to: "1420",
                },
                Step::Dropped {
                    keys: &["1401", "fan"],
                    en: "there is no fan",
                    zh: "没有风扇",
                },
                Step::New { key: "9007" },
                Step::Range { key: "058" },
            ],
        },
    ];

    const OLD: &str = "# lathe\nschema = 8 # as delivered\n01400.X = \"12 m/min\" # X\nfast.Z=\"16 m/min\"\n\
                       \"1401.0\" = 1 # off\n\"thread_angle\" = \"55 °\"\n58 = \"55 °\"\n[9101]\nX = \"1 mm\"\n";
    const NEW: &str = "# lathe\nschema = 10 # as delivered\n1420.X = \"12 m/min\" # X\n1420.Z=\"16 m/min\"\n\
                       # \"1401.0\" = 1 # off\n\"thread_angle\" = \"55 °\"\n58 = \"55 °\"\n[9101]\nX = \"1 mm\"\n";

    #[test]
    fn an_older_file_goes_through_every_version() {
        let migrated = migrate(OLD, SYNTHETIC, 10, None).unwrap();
        assert_eq!((migrated.from, migrated.to), (8, 10));
        assert_eq!(migrated.text, NEW);
        let notes: Vec<_> = migrated
            .notes
            .iter()
            .map(|note| (note.kind, note.key.as_str(), note.words.en.as_str()))
            .collect();
        assert_eq!(
            notes,
            [
                ("renamed", "fast.Z", "is called rapid now"),
                ("renamed", "01400.X", "is called rapid now"),
                ("renamed", "rapid.X", "is called 1420 now"),
                ("renamed", "rapid.Z", "is called 1420 now"),
                (
                    "dropped",
                    "1401.0",
                    "is no more (there is no fan); its line is a comment now"
                ),
                (
                    "new",
                    "9007",
                    "is new and stays at 15 %: Measured spindle speed counts as arrived within this of the commanded one"
                ),
                ("range", "58", "goes from 0 to 99 ° now: look at its value"),
            ]
        );
        assert!(
            migrated
                .notes
                .iter()
                .all(|note| note.open == (note.kind == "range"))
        );
    }

    #[test]
    fn heads_are_renamed_wherever_they_stand() {
        let one = &SYNTHETIC[..1];
        for (old, new) in [
            ("\"fast.X\" = 1\n", "schema = 9\n\"rapid.X\" = 1\n"),
            (
                "[fast]\nX = 1\nZ = 2\n",
                "schema = 9\n[rapid]\nX = 1\nZ = 2\n",
            ),
            (
                "1400 = { X = 1, Z = 2 }\n",
                "schema = 9\nrapid = { X = 1, Z = 2 }\n",
            ),
            ("FAST . X = 1\r\n", "schema = 9\r\nrapid . X = 1\r\n"),
        ] {
            assert_eq!(migrate(old, one, 9, Some(8)).unwrap().text, new);
        }
    }

    #[test]
    fn versions_nobody_knows_are_named() {
        for (text, expected) in [
            ("schema = 11\n", Unmigratable::Version(11)),
            ("schema = 7\n", Unmigratable::Version(7)),
            ("schema = 0\n", Unmigratable::Version(0)),
            ("schema = -1\n", Unmigratable::Unreadable),
            ("schema = \"8\"\n", Unmigratable::Unreadable),
            ("schema = ", Unmigratable::Unreadable),
        ] {
            assert_eq!(migrate(text, SYNTHETIC, 10, None), Err(expected), "{text}");
        }
        let same = migrate("schema = 10\n9007 = 1\n", SYNTHETIC, 10, None).unwrap();
        assert_eq!(same.text, "schema = 10\n9007 = 1\n");
        assert!(same.notes.is_empty());
    }

    #[test]
    fn the_table_leads_to_this_version_without_a_gap() {
        for (before, after) in MIGRATIONS.iter().zip(MIGRATIONS.iter().skip(1)) {
            assert_eq!(before.to + 1, after.to);
        }
        assert_eq!(MIGRATIONS.last().map_or(1, |last| last.to), SCHEMA);
    }
}
