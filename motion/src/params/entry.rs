//! Definitions as data: the meaning of each number, and how to find a definition by number, alias or name.

use core::fmt;

use super::{ALIASES, ENTRIES, MEANINGS, RANGES, TEXTS, Unit};
use crate::units::Axis;

/// Which value of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The number has one value.
    Whole,
    /// One bit, 0–7.
    Bit(u8),
    /// One axis.
    Axis(Axis),
}

/// Which raw values are allowed. Many entries share one range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Range {
    /// The smallest.
    pub min: i64,
    /// The largest.
    pub max: i64,
    /// One more, outside of these, that stands for "none".
    pub none: Option<i64>,
}

/// What an entry has whose range does not exist: nothing is allowed. The build script writes no such entry.
const NOTHING: Range = Range {
    min: 0,
    max: -1,
    none: None,
};

/// One value of the table: what a machine must know to accept or refuse it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Number.
    pub no: u16,
    /// Which value of the number.
    pub part: Part,
    /// Place in the list of ranges.
    pub(super) range: u8,
    /// Which 16 bits of its place it has, from 1 on; 0 where it has all of it, or is a bit of it.
    pub(super) quarter: u8,
    /// Place in the set.
    pub(super) slot: u16,
}

/// What a value means to a person; a board does not ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Meaning {
    pub unit: Unit,
    /// Place in the texts.
    pub text: u16,
}

/// What a person reads about a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text {
    /// Key in machine files and on the command line.
    pub name: &'static str,
    /// What it is, in English.
    pub en: &'static str,
    /// What it is, in Chinese.
    pub zh: &'static str,
    /// Where it comes from: sheets and decisions.
    pub sheet: &'static str,
    /// First and last number of the family, where the parameter is one of several alike.
    pub family: Option<(u16, u16)>,
}

/// Why no single value was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FindError {
    /// No parameter has this number or name.
    Unknown,
    /// The number has bits or axes, and none is named; the entry is the first of them.
    PartMissing(&'static Entry),
    /// The number exists, but not with this bit or axis; the entry is the first it has.
    NoSuchPart(&'static Entry),
}

static NO_TEXT: Text = Text {
    name: "",
    en: "",
    zh: "",
    sheet: "",
    family: None,
};

impl Entry {
    /// The whole table, by number, then bit or axis.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &ENTRIES
    }

    /// Second number of the same record [D17].
    #[must_use]
    pub fn alias(&self) -> Option<u16> {
        let of_this = ALIASES.iter().find(|(_, no)| *no == self.no);
        of_this.map(|(alias, _)| *alias)
    }

    /// The number that is meant by a number or an alias.
    pub fn number_of(no: u16) -> u16 {
        let alias = ALIASES.iter().find(|(alias, _)| *alias == no);
        alias.map_or(no, |(_, no)| *no)
    }

    /// Smallest raw value.
    #[must_use]
    pub const fn min(&self) -> i64 {
        self.range().min
    }

    /// Largest raw value.
    #[must_use]
    pub const fn max(&self) -> i64 {
        self.range().max
    }

    /// Raw value that stands for "none", where that is allowed.
    #[must_use]
    pub const fn none(&self) -> Option<i64> {
        self.range().none
    }

    /// The range at the entry's place. The key of the table needs it in a constant, where `get` cannot be called.
    const fn range(&self) -> Range {
        let (mut ranges, mut place): (&[Range], u8) = (&RANGES, self.range);
        while let [first, rest @ ..] = ranges {
            if place == 0 {
                return *first;
            }
            (ranges, place) = (rest, place.saturating_sub(1));
        }
        NOTHING
    }

    /// What it means to a person; no two entries have all the same.
    fn meaning(&self) -> Option<&'static Meaning> {
        let place = ENTRIES.iter().position(|entry| entry == self)?;
        MEANINGS.get(place)
    }

    /// Unit; raw values are whole numbers of its smallest step.
    #[must_use]
    pub fn unit(&self) -> Unit {
        self.meaning().map_or(Unit::Number, |meaning| meaning.unit)
    }

    /// Name, meaning and source.
    #[must_use]
    pub fn text(&self) -> &'static Text {
        self.meaning()
            .and_then(|meaning| TEXTS.get(usize::from(meaning.text)))
            .unwrap_or(&NO_TEXT)
    }

    /// The value of a number or alias, as a bus asks for it.
    ///
    /// # Errors
    /// [`FindError`].
    pub fn find(no: u16, part: Option<Part>) -> Result<&'static Self, FindError> {
        let no = Self::number_of(no);
        Self::pick(part, false, |e| e.no == no)
    }

    /// The value that `NO`, `NO.BIT`, `NO.AXIS`, or the same with a name for the number, means. Zeros before a number
    /// do not count; letters may be small.
    ///
    /// # Errors
    /// [`FindError`].
    pub fn find_text(key: &str) -> Result<&'static Self, FindError> {
        let (head, tail) = match key.trim().split_once('.') {
            Some((head, tail)) => (head, Some(tail)),
            None => (key.trim(), None),
        };
        // A part that is not valid does not stop the search: an unknown number is the graver mistake.
        let part = tail.map(|tail| parse_part(tail).unwrap_or(Part::Bit(u8::MAX)));
        match parse_number(head) {
            Some(no) => Self::find(no, part),
            None => Self::pick(part, true, |e| e.text().name.eq_ignore_ascii_case(head)),
        }
    }

    /// `by_name`: a name says which bit it means, a number does not.
    fn pick(
        part: Option<Part>,
        by_name: bool,
        matches: impl Fn(&Self) -> bool,
    ) -> Result<&'static Self, FindError> {
        let mut candidates = ENTRIES.iter().filter(|e| matches(e));
        let first = candidates.next().ok_or(FindError::Unknown)?;
        match part {
            Some(part) if first.part == part => Ok(first),
            Some(part) => candidates
                .find(|e| e.part == part)
                .ok_or(FindError::NoSuchPart(first)),
            None if first.part == Part::Whole => Ok(first),
            None if by_name && matches!(first.part, Part::Bit(_)) => Ok(first),
            None => Err(FindError::PartMissing(first)),
        }
    }
}

/// Prints the number as users write it: `019`, `182.7`, `1420.X`.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:03}", self.no)?;
        match self.part {
            Part::Whole => Ok(()),
            Part::Bit(bit) => write!(f, ".{bit}"),
            Part::Axis(axis) => write!(f, ".{}", char::from(axis.letter())),
        }
    }
}

fn parse_number(text: &str) -> Option<u16> {
    // `parse` alone would take a sign.
    (!text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())).then_some(())?;
    text.parse().ok()
}

fn parse_part(text: &str) -> Option<Part> {
    let mut bytes = text.bytes();
    let part = match bytes.next()? {
        b @ b'0'..=b'7' => Part::Bit(b.wrapping_sub(b'0')),
        b'X' | b'x' => Part::Axis(Axis::X),
        b'Z' | b'z' => Part::Axis(Axis::Z),
        b'C' | b'c' => Part::Axis(Axis::C),
        _ => return None,
    };
    bytes.next().is_none().then_some(part)
}
