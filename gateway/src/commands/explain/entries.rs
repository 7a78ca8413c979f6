//! What provokes each alarm and what does it right, from the files of the folder `explained`: one file for each kind.
//!
//! ```text
//! programs.toml  wrong, right       two programs                          `leadscrew check`
//! machines.toml  wrong, right       two machine files                     `leadscrew params validate`
//! scripts.toml   raise, mend        commands at a machine on the desk     typed one after the other
//! others.toml    en, zh             how it comes about, in words          other tests
//! ```
//!
//! The tables `files`, `wrong_files` and `right_files` of a number are files beside them, by name. It must not know how
//! they are shown.

use std::collections::BTreeMap;

use toml::de::{DeTable, DeValue};

use crate::words::Both;

/// What is told of a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A program that raises it, and one that does not.
    Programs(Pair),
    /// A machine file that raises it, and one that does not.
    Machines(Pair),
    /// Commands, the last of which tells it, and commands that set it right.
    Commands(Pair),
    /// How it comes about, where nobody can provoke it at a desk.
    Words(Both),
}

/// Two texts beside each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pair {
    /// The one that raises the alarm.
    pub wrong: String,
    /// The one that does not, or sets it right.
    pub right: String,
    /// Files that both need.
    pub files: Vec<File>,
    /// Files that the wrong one needs.
    pub wrong_files: Vec<File>,
    /// Files that the right one needs.
    pub right_files: Vec<File>,
}

/// A file beside a program or a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// The file of each kind, and what its texts are called.
const KINDS: [(&str, Kind); 4] = [
    (
        include_str!("../../explained/programs.toml"),
        Kind::Pair(["wrong", "right"], Entry::Programs),
    ),
    (
        include_str!("../../explained/machines.toml"),
        Kind::Pair(["wrong", "right"], Entry::Machines),
    ),
    (
        include_str!("../../explained/scripts.toml"),
        Kind::Pair(["raise", "mend"], Entry::Commands),
    ),
    (include_str!("../../explained/others.toml"), Kind::Words),
];

#[derive(Clone, Copy)]
enum Kind {
    Pair([&'static str; 2], fn(Pair) -> Entry),
    Words,
}

/// The entries by number.
pub fn entries() -> BTreeMap<u16, Entry> {
    let mut entries = BTreeMap::new();
    for (text, kind) in KINDS {
        // The files are part of the program, and a test reads all of them.
        let Ok(file) = DeTable::parse(text) else {
            continue;
        };
        for (number, entry) in file.get_ref() {
            let entry = read(entry.get_ref(), kind);
            if let (Ok(number), Some(entry)) = (number.get_ref().parse(), entry) {
                entries.insert(number, entry);
            }
        }
    }
    entries
}

fn read(entry: &DeValue<'_>, kind: Kind) -> Option<Entry> {
    let text = |key| Some(entry.get(key)?.get_ref().as_str()?.to_owned());
    let files = |key| {
        let table = entry.get(key).and_then(|files| files.get_ref().as_table());
        let file = |name: &str, text: &DeValue<'_>| {
            let (name, text) = (name.to_owned(), text.as_str()?.to_owned());
            Some(File { name, text })
        };
        let files = table.into_iter().flatten();
        files
            .filter_map(|(name, text)| file(name.get_ref(), text.get_ref()))
            .collect()
    };
    Some(match kind {
        Kind::Pair([wrong, right], make) => make(Pair {
            wrong: text(wrong)?,
            right: text(right)?,
            files: files("files"),
            wrong_files: files("wrong_files"),
            right_files: files("right_files"),
        }),
        Kind::Words => Entry::Words(Both {
            en: text("en")?,
            zh: text("zh")?,
        }),
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use leadscrew_core::alarm::Code;

    use super::*;

    #[test]
    fn the_files_are_read_whole_and_each_number_has_one_place() {
        let read = entries();
        let mut seen = BTreeSet::new();
        for (text, kind) in KINDS {
            let file = DeTable::parse(text).unwrap();
            for (number, entry) in file.get_ref() {
                let number: u16 = number.get_ref().parse().unwrap();
                assert!(seen.insert(number), "{number} is there twice");
                assert!(Code::from_number(number).is_some(), "{number}");
                let keys: &[&str] = match kind {
                    Kind::Pair(texts, _) => {
                        &[texts[0], texts[1], "files", "wrong_files", "right_files"]
                    }
                    Kind::Words => &["en", "zh"],
                };
                for (key, value) in entry.get_ref().as_table().unwrap() {
                    assert!(keys.contains(&&**key.get_ref()), "{number}: {key:?}");
                    let is_text = value.get_ref().as_str().is_some();
                    let files = value.get_ref().as_table();
                    let are_texts = files.is_some_and(|files| {
                        files.values().all(|text| text.get_ref().as_str().is_some())
                    });
                    assert!(is_text || are_texts, "{number}: {key:?}");
                }
                assert!(read.contains_key(&number), "{number} lacks a key");
            }
        }
        assert_eq!(read.len(), seen.len());
    }
}
