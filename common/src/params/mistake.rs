//! Messages about a key or a value that is refused: the condition and its figures, as texts.

use leadscrew_core::alarm::{Code, Lang};
use leadscrew_core::params::{Entry, FindError, Params, SetError, ValueError, Writing};

use crate::diagnostics::{Diagnostic, Place};

/// A condition with its figures.
pub type Mistake = (Code, Vec<String>);

/// The number with its name, as in messages.
pub fn label(entry: &Entry) -> String {
    format!("{entry} ({})", entry.text().name)
}

/// A key without a value in the table.
pub fn not_found(name: &str, error: FindError) -> Mistake {
    let name_text = shown(name);
    match error {
        FindError::Unknown => match nearest(name) {
            Some(near) => (Code::ParamUnknownNear, vec![name_text, near]),
            None => (Code::ParamUnknown, vec![name_text]),
        },
        FindError::PartMissing(first) => (Code::ParamPartMissing, vec![name_text, parts(first)]),
        FindError::NoSuchPart(first) => (Code::ParamNoSuchPart, vec![name_text, parts(first)]),
    }
}

/// The same for a key in an argument, which has no place.
pub fn unknown_key(name: &str, error: FindError, lang: Lang) -> Diagnostic {
    let (code, figures) = not_found(name, error);
    Diagnostic::of_option(code, &figures, &Place::default(), lang)
}

/// A value that was refused.
pub fn not_taken(entry: &Entry, text: &str, writing: Writing, error: SetError) -> Mistake {
    let figures = |more: &[String]| {
        let mut all = vec![label(entry), shown(text)];
        all.extend_from_slice(more);
        all
    };
    match error {
        SetError::OutOfRange => {
            let (min, max) = (
                entry.unit().text(entry.min()),
                entry.unit().text(entry.max()),
            );
            (
                Code::ParamOutOfRange,
                figures(&[min.to_string(), max.to_string()]),
            )
        }
        SetError::Value(error) => match error {
            ValueError::NoNumber => (Code::ParamNotANumber, figures(&[example(entry, writing)])),
            ValueError::WrongUnit if entry.unit().is_bare() => {
                (Code::ParamNoUnit, figures(&[example(entry, writing)]))
            }
            ValueError::WrongUnit => (Code::ParamWrongUnit, figures(&[spellings(entry)])),
            ValueError::UnitMissing => {
                let with_unit = format!("`\"{} {}\"`", shown(text), entry.unit().symbol());
                (Code::ParamUnitMissing, figures(&[with_unit]))
            }
            ValueError::TooFine => {
                let step = entry.unit().text(1).to_string();
                (Code::ParamTooFine, figures(&[step]))
            }
            // `Entry::parse` gives this one as out of range.
            ValueError::TooLarge => not_taken(entry, text, writing, SetError::OutOfRange),
        },
    }
}

/// An example of a value: the built-in machine's.
pub fn example(entry: &Entry, writing: Writing) -> String {
    let raw = Params::slant_bed().get(entry);
    match writing {
        _ if entry.none() == Some(raw) => "`\"none\"`".into(),
        Writing::UnitRequired if !entry.unit().is_bare() => {
            format!("`\"{}\"`", entry.unit().text(raw))
        }
        _ => format!("`{}`", entry.unit().number(raw)),
    }
}

/// Every key of the number of `first`, as a choice.
fn parts(first: &Entry) -> String {
    let keys = Entry::all()
        .iter()
        .filter(|e| e.no == first.no)
        .map(|e| format!("`{e}`"));
    keys.collect::<Vec<_>>().join(" / ")
}

fn spellings(entry: &Entry) -> String {
    let names = entry.unit().spellings().iter().map(|(name, _)| *name);
    // The Greek µ looks like the micro sign; one of them is enough for a reader.
    let names = names.filter(|name| !name.is_empty() && !name.contains('\u{3bc}'));
    names.collect::<Vec<_>>().join(", ")
}

/// A name that may have been meant, with the part after the point.
fn nearest(key: &str) -> Option<String> {
    let (head, tail) = key.split_at(key.find('.').unwrap_or(key.len()));
    let head = head.to_lowercase();
    if !(3..=60).contains(&head.chars().count()) || head.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let allowed = (head.chars().count() / 3).max(1);
    let names = Entry::all().iter().map(|e| e.text().name);
    let near = names.filter_map(|name| {
        let distance = distance(&head, name);
        // A word of the name, as `rapid` in `rapid_rate`, is nearer than any misspelling.
        let is_word = name.split('_').any(|word| word == head) || name.starts_with(&head);
        match (is_word, distance <= allowed) {
            (_, true) => Some((distance, name)),
            (true, false) => Some((allowed + distance, name)),
            (false, false) => None,
        }
    });
    near.min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| format!("{name}{tail}"))
}

/// The number of characters to insert, remove or replace between two texts.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// A key or value for a message: on one line and of bounded length.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut out: String = text
        .chars()
        .take(LONGEST)
        .flat_map(char::escape_debug)
        .collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_is_guessed_and_nonsense_is_not() {
        for (typed, meant) in [
            ("rapid_rat.X", "rapid_rate.X"),
            ("rapid", "rapid_rate"),
            ("acelleration", "acceleration"),
            ("TICK_US_", "tick_us"),
        ] {
            assert_eq!(nearest(typed).as_deref(), Some(meant));
        }
        for nonsense in ["", "x", "1421", "0000", "colour_of_the_sky", "你好吗"] {
            assert_eq!(nearest(nonsense), None, "{nonsense}");
        }
    }

    #[test]
    fn distances() {
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", "abc"), 0);
        assert_eq!(distance("kitten", "sitting"), 3);
    }
}
