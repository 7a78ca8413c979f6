//! The comments in the first lines of a file: `(DIALECT FANUC-B)`, `(ALLOW 4800 4985)`, `(STOCK X60 L100)`.
//!
//! Whoever starts a program asks for those of its file, and the flow for those of a subprogram's file [D273]. This module
//! must not know what becomes of them.

use std::io;

use leadscrew_core::alarm::{Alarm, Code};

use crate::dialect::{Control, Named, named};
use crate::lines::{Lines, Place, Source};
use crate::stock::{self, Said, Stock};
use crate::text::span;
use crate::whose::Whose;

/// Bytes at the front of a file in which such comments may begin a line.
const BYTES: u64 = 4096;

/// What the first lines of a file say of it as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heading {
    /// The control that the file names.
    pub control: Option<Control>,
    /// The numbers that are not to be told of its lines.
    pub allowed: Allowed,
    /// The stock.
    pub stock: Option<Stock>,
    /// The file names a control that is none.
    pub alarm: Option<Alarm>,
    /// The comment of the stock cannot be read.
    pub warning: Option<Alarm>,
    /// A comment with ALLOW names what is no number that may be silenced.
    pub unknown: Option<Alarm>,
}

impl Heading {
    /// Reads the front of a file, which is there.
    ///
    /// # Errors
    /// The text cannot be read.
    pub fn read<S: Source>(lines: &mut Lines<S>, file: Whose) -> io::Result<Self> {
        let mut heading = Self::default();
        let mut at = Place::start_of(file);
        while at.byte < BYTES
            && let Some(line) = lines.line(at)?
        {
            heading.line(at.line, line.text);
            at = line.next;
        }
        Ok(heading)
    }

    fn line(&mut self, line: u32, text: &[u8]) {
        match named(text) {
            Named::Control(control) => self.control = Some(control),
            Named::Unknown { from, to } => {
                let alarm = Alarm::new(Code::DialectUnknown, span(line, from, to));
                self.alarm.get_or_insert(alarm);
            }
            Named::Nothing => {}
        }
        match stock::said(text) {
            Said::Stock(stock) => _ = self.stock.get_or_insert(stock),
            Said::Unreadable { from, to } => {
                let warning = Alarm::new(Code::StockUnreadable, span(line, from, to));
                self.warning.get_or_insert(warning);
            }
            Said::Nothing => {}
        }
        if let Some((from, to)) = self.allowed.add_of(text) {
            let told = Alarm::new(Code::AllowUnknown, span(line, from, to));
            self.unknown.get_or_insert(told);
        }
    }
}

/// Numbers of what looks wrong, which a file or a machine silences: one bit for each that there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allowed(u32);

impl Allowed {
    /// All of them are told.
    pub const NONE: Self = Self(0);

    /// The place of a number; `None` for all others, which nobody silences.
    const fn bit(number: u16) -> Option<u32> {
        match number {
            4800..=4811 => Some(1 << (number - 4800)),
            4976..=4978 => Some(1 << (number - 4976 + 24)),
            4980..=4991 => Some(1 << (number - 4980 + 12)),
            _ => None,
        }
    }

    /// True for the numbers of what looks wrong, which may be silenced.
    #[must_use]
    pub const fn may_have(number: u16) -> bool {
        Self::bit(number).is_some()
    }

    /// Adds a number; false for one that may not be silenced.
    pub const fn add(&mut self, number: u16) -> bool {
        match Self::bit(number) {
            Some(bit) => {
                self.0 |= bit;
                true
            }
            None => false,
        }
    }

    /// True for a number that is silenced.
    #[must_use]
    pub const fn has(self, number: u16) -> bool {
        matches!(Self::bit(number), Some(bit) if self.0 & bit != 0)
    }

    /// Those of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Adds those of `(ALLOW 4800 4985)` in a line. The place of the first that is none.
    fn add_of(&mut self, line: &[u8]) -> Option<(usize, usize)> {
        const WORD: &[u8] = b"(ALLOW ";
        let is = |window: &[u8]| window.eq_ignore_ascii_case(WORD);
        let mut at = line.windows(WORD.len()).position(is)? + WORD.len();
        let mut unknown = None;
        let numbers = line[at..].split(|byte| *byte == b')').next();
        for number in numbers
            .unwrap_or_default()
            .split(|byte| matches!(byte, b' ' | b',' | b'\t' | b'\r' | b'\n'))
        {
            let (from, to) = (at, at + number.len());
            at = to + 1;
            let text = std::str::from_utf8(number).ok();
            let known = text.and_then(|text| text.parse().ok());
            if from != to && !known.is_some_and(|number| self.add(number)) {
                unknown.get_or_insert((from, to));
            }
        }
        unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_that_may_be_silenced_has_a_place_of_its_own() {
        let may: Vec<u16> = (0..=u16::MAX)
            .filter(|number| Allowed::may_have(*number))
            .collect();
        let numbers = (4800..=4811).chain(4976..=4978).chain(4980..=4991);
        assert_eq!(may, numbers.collect::<Vec<_>>());
        let mut all = Allowed::default();
        for number in &may {
            let mut one = Allowed::default();
            assert!(one.add(*number) && one.has(*number));
            assert!(!all.has(*number), "{number} shares its place");
            all = all.and(one);
        }
        assert!(!all.add(4056) && !all.has(4056));
    }

    #[test]
    fn the_first_lines_are_read_and_no_others() {
        let read = |text: &str| {
            Heading::read(&mut Lines::new(text.as_bytes()), Whose::Program).expect("a text")
        };
        let text =
            "%\nO1 (ALLOW 4800, 4985 4056)\n(dialect fanuc-b) (allow 4991)\n(STOCK X60 L100)\n";
        let heading = read(text);
        assert_eq!(heading.control, Some(Control::FanucB));
        let silenced = |number: &u16| heading.allowed.has(*number);
        let all: Vec<u16> = (4000..5000).filter(silenced).collect();
        assert_eq!(all, [4800, 4985, 4991]);
        assert_eq!(heading.stock.map(|stock| stock.length), Some(100_000_000));
        // 4056 may not be silenced.
        let unknown = heading.unknown.map(|alarm| (alarm.number(), alarm.span));
        assert_eq!(unknown, Some((4975, span(2, 21, 25))));
        for text in [
            "(ALLOW 9999 ABC)",
            "(ALLOW ABC)",
            "(allow 4800,x)",
            "(ALLOW 4801",
        ] {
            let unknown = read(text).unknown;
            assert_eq!(unknown.is_some(), !text.ends_with('1'), "{text}");
        }
        assert_eq!((heading.alarm, heading.warning), (None, None));
        // A line that begins in the 4096th byte is one of them, and the next one is not.
        for (blanks, is_read) in [(4095, true), (4096, false)] {
            let heading = read(&("\n".repeat(blanks) + "(DIALECT HAAS)\n"));
            assert_eq!(heading.control.is_some(), is_read, "{blanks}");
        }
    }

    #[test]
    fn a_dialect_that_is_none_is_an_alarm_with_its_place() {
        let text = "O1\n(DIALECT  FANUK)\n";
        let heading = Heading::read(&mut Lines::new(text.as_bytes()), Whose::Program).unwrap();
        let alarm = heading.alarm.expect("an alarm");
        assert_eq!(alarm.code, Code::DialectUnknown);
        assert_eq!(
            (alarm.span.line, alarm.span.column, alarm.span.end),
            (2, 11, 16)
        );
    }
}
