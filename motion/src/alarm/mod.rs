//! Alarms and warnings as data: a number, a place, and the figures that explain the alarm.
//!
//! An [`Alarm`] is small and has no text in it, so the board can raise and send one; the text (cause and remedy, English
//! and Chinese, with the figures put in) is made where a person reads it, from the templates in `table.rs`. Warnings have
//! the same shape and numbers of their own.

mod no_lead;
mod table;

pub use no_lead::NoLead;
pub use table::{Code, Lang};

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::operating::{Interlock, OperatingMode, Zone};
use crate::units::{Angle, Diameter, Feed, Length, Rpm};

/// A place in the program text: the line (from 1) and the columns (from 1, `end` exclusive) of a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct Span {
    /// Line in the file, from 1; 0 where nothing in the text is meant.
    pub line: u32,
    /// First column of the word, from 1.
    pub column: u16,
    /// Column after its last character.
    pub end: u16,
}

/// A value together with the word it was written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// The word; [`Span::default`] where the value is a parameter's.
    pub span: Span,
}

impl<T> At<T> {
    /// `value`, written at `span`.
    pub const fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }

    /// The value, without its place.
    pub const fn get(&self) -> &T {
        &self.value
    }
}

/// A figure in the text of an alarm. The reader's units (mm or inch, diameter or radius) are chosen by its type.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Arg {
    /// Nothing here.
    #[default]
    None,
    /// A whole number without unit (a pass, a count, a parameter number).
    Int(i64),
    /// A radius, depth or Z value.
    Length(Length),
    /// An X value.
    Diameter(Diameter),
    /// A rotary angle.
    Angle(Angle),
    /// A path speed.
    Feed(Feed),
    /// A spindle speed.
    Rpm(Rpm),
    /// No alarm tells a lead.
    Lead(NoLead),
    /// A percentage.
    Percent(i32),
    /// A decimal `mantissa · 10^−decimals` as it was written.
    Decimal(i64, u8),
    /// One letter: an address or an axis.
    Letter(u8),
    /// A G code in tenths (`G5.1` is 51).
    GCode(u16),
    /// A number printed as four hexadecimal digits and an `h` (an error code).
    Hex(u16),
    /// A key or a checksum, printed as eight hexadecimal digits and an `h`.
    Key(u32),
    /// A CiA 402 statusword, printed like [`Arg::Hex`], followed by the name of its state.
    Statusword(u16),
    /// A mode of the machine.
    Mode(OperatingMode),
    /// What keeps the machine from something.
    Interlock(Interlock),
    /// Where no tip of a tool may be.
    Zone(Zone),
}

/// An alarm or a warning: what ([`Code`]), where, at which word, and up to four figures for the template.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Alarm {
    /// Which condition.
    pub code: Code,
    /// Where in the text; of the G word if the cause is a missing word.
    pub span: Span,
    /// The address letter of the word (`b'P'`); `None` where the word is missing or none is to blame.
    pub word: Option<u8>,
    /// Figures, in the order of the template's `{0}`…`{3}`.
    pub args: [Arg; 4],
}

impl Alarm {
    /// A condition at a place, without a word.
    #[must_use]
    pub const fn new(code: Code, span: Span) -> Self {
        Self {
            code,
            span,
            word: None,
            args: [Arg::None; 4],
        }
    }

    /// An alarm without a place in a text, with the figures of its template.
    #[must_use]
    pub fn of(code: Code, figures: &[Arg]) -> Self {
        let mut alarm = Self::new(code, Span::default());
        alarm.fill(figures);
        alarm
    }

    /// Names the word to blame.
    #[must_use]
    pub const fn word(mut self, letter: u8) -> Self {
        self.word = Some(letter);
        self
    }

    /// Gives the figures of the template, four at most; those that are not given stay as they are.
    #[must_use]
    #[inline]
    pub fn with<const N: usize>(mut self, figures: [Arg; N]) -> Self {
        const {
            assert!(N <= 4, "a template has four figures at most");
        }
        self.fill(&figures);
        self
    }

    /// The same of as many as there are.
    pub(crate) fn fill(&mut self, figures: &[Arg]) {
        for (place, figure) in self.args.iter_mut().zip(figures) {
            *place = *figure;
        }
    }

    /// The alarm's number in the list of the trade.
    #[must_use]
    pub const fn number(&self) -> u16 {
        self.code.number()
    }
}
