//! A row of the table of machine functions (9401 to 9416): what an M code switches, and what answers it.
//!
//! Thirteen decimal digits, CCC H OO A II TTTT, so that a row is one number that a person can write. Must not know what
//! a program or a board does with it.

use super::Params;

/// Rows of the table.
pub const ROWS: u8 = 16;

/// The most outputs, and the most inputs.
pub const CONTACTS: u8 = 32;

/// The first input, and the first output, of a block on the bus (9461); those before it are the board's own.
pub const FIRST_OF_BLOCK: u8 = 17;

/// An input or output, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact(u8);

impl Contact {
    /// The contact with this number; `None` for 0, and for more than there are.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        if number == 0 || number > CONTACTS {
            return None;
        }
        Some(Self(number))
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        (1..=CONTACTS).filter_map(Self::new)
    }

    /// Those whose [bits](Self::bit) are set.
    pub fn of_bits(bits: u32) -> impl Iterator<Item = Self> {
        Self::all().filter(move |contact| bits & contact.bit() != 0)
    }

    /// The bit of the contact with this number; 0 for a number that none has.
    #[must_use]
    pub fn bit_of(number: u8) -> u32 {
        Self::new(number).map_or(0, Self::bit)
    }

    /// Its number, from 1 on.
    #[must_use]
    pub const fn number(self) -> u8 {
        self.0
    }

    /// True where it is the block's.
    #[must_use]
    pub const fn is_of_block(self) -> bool {
        self.0 >= FIRST_OF_BLOCK
    }

    /// Its bit.
    #[must_use]
    pub const fn bit(self) -> u32 {
        1_u32.wrapping_shl(self.0.wrapping_sub(1) as u32)
    }
}

/// What a function does to its output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Switches it on.
    On,
    /// Switches it off.
    Off,
    /// Switches it on until the answer is there, or, where there is none, for the time of the row.
    Pulse,
}

/// The input that answers, and the level at which it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The input.
    pub input: Contact,
    /// True where it answers when it is on.
    pub on: bool,
}

/// A row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FunctionRow {
    /// M code.
    pub code: u16,
    /// What it switches.
    pub switches: Option<(Contact, Action)>,
    /// What answers it.
    pub answer: Option<Answer>,
    /// The longest wait for the answer; without one, the length of a pulse.
    pub time_ms: u32,
    /// It comes after the motion of its block.
    pub behind: bool,
}

impl FunctionRow {
    /// The row that a value of 9401 to 9416 means; `None` for 0, and for one that means nothing.
    #[inline(never)]
    #[must_use]
    pub const fn of(value: i64) -> Option<Self> {
        // Two halves of 32 bits: CCC H OO, and A II TTTT.
        if value <= 0 || value >= 10_000_000_000_000 {
            return None;
        }
        let front = (value / 10_000_000) as u32;
        let back = (value % 10_000_000) as u32;
        let (code, how, output) = (front / 1000, front / 100 % 10, front % 100);
        let (answers, input) = (back / 1_000_000, back / 10_000 % 100);
        let time_ms = (back % 10_000).saturating_mul(10);
        let answer = match (answers, Contact::new(input as u8)) {
            (0, None) => None,
            (1 | 2, Some(input)) => Some(Answer {
                input,
                on: answers == 1,
            }),
            _ => return None,
        };
        let switches = match (how % 5, Contact::new(output as u8)) {
            (0, None) => None,
            (1, Some(output)) => Some((output, Action::On)),
            (2, Some(output)) => Some((output, Action::Off)),
            (3, Some(output)) => Some((output, Action::Pulse)),
            _ => return None,
        };
        // What waits needs a time, and what does nothing is no row.
        let waits = answer.is_some() || matches!(switches, Some((_, Action::Pulse)));
        if code == 0 || (switches.is_none() && answer.is_none()) || waits == (time_ms == 0) {
            return None;
        }
        Some(Self {
            code: code as u16,
            switches,
            answer,
            time_ms,
            behind: how >= 5,
        })
    }

    /// The value of 9401 to 9416 that means this row. A time is cut to its steps of 10 ms.
    #[must_use]
    pub fn value(&self) -> i64 {
        let (output, how) = match self.switches {
            None => (0, 0),
            Some((output, Action::On)) => (output.number(), 1),
            Some((output, Action::Off)) => (output.number(), 2),
            Some((output, Action::Pulse)) => (output.number(), 3),
        };
        let (input, level) = match self.answer {
            None => (0, 0),
            Some(Answer { input, on: true }) => (input.number(), 1),
            Some(Answer { input, on: false }) => (input.number(), 2),
        };
        let how = if self.behind {
            5_u8.wrapping_add(how)
        } else {
            how
        };
        let digits = [
            (1000, i64::from(self.code)),
            (10, i64::from(how)),
            (100, i64::from(output)),
            (10, level),
            (100, i64::from(input)),
            (10_000, i64::from(self.time_ms.wrapping_div(10))),
        ];
        digits.iter().fold(0, |value: i64, &(room, digit)| {
            value.saturating_mul(room).saturating_add(digit)
        })
    }

    /// True where `other` and this one switch the same output, so that a block cannot have both.
    #[must_use]
    pub fn excludes(&self, other: &Self) -> bool {
        matches!((self.switches, other.switches), (Some((one, _)), Some((two, _))) if one == two)
    }
}

impl Params {
    /// The row of an M code.
    #[inline(never)]
    #[must_use]
    pub fn function(&self, code: u16) -> Option<FunctionRow> {
        self.functions().find(|row| row.code == code)
    }

    /// M19 brings the spindle to an angle: no row of the table says otherwise.
    #[must_use]
    pub fn orients_by_m19(&self) -> bool {
        self.function(19).is_none()
    }

    /// All rows that mean something.
    pub fn functions(&self) -> impl Iterator<Item = FunctionRow> {
        (1..=ROWS).filter_map(|place| FunctionRow::of(self.m_row(place)))
    }

    /// The values of the table, a row or not.
    pub(super) fn function_values(&self) -> impl Iterator<Item = i64> {
        (1..=ROWS).map(|place| self.m_row(place))
    }
}

#[cfg(test)]
#[expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_its_digits() {
        let output = |number| Contact::new(number).unwrap();
        for (value, row) in [
            (
                8_1_01_1_01_0200,
                FunctionRow {
                    code: 8,
                    switches: Some((output(1), Action::On)),
                    answer: Some(Answer {
                        input: output(1),
                        on: true,
                    }),
                    time_ms: 2000,
                    behind: false,
                },
            ),
            (
                9_7_01_0_00_0000,
                FunctionRow {
                    code: 9,
                    switches: Some((output(1), Action::Off)),
                    answer: None,
                    time_ms: 0,
                    behind: true,
                },
            ),
            (
                999_8_32_2_32_9999,
                FunctionRow {
                    code: 999,
                    switches: Some((output(32), Action::Pulse)),
                    answer: Some(Answer {
                        input: output(32),
                        on: false,
                    }),
                    time_ms: 99_990,
                    behind: true,
                },
            ),
            (
                60_0_00_1_03_0100,
                FunctionRow {
                    code: 60,
                    switches: None,
                    answer: Some(Answer {
                        input: output(3),
                        on: true,
                    }),
                    time_ms: 1000,
                    behind: false,
                },
            ),
        ] {
            assert_eq!(FunctionRow::of(value), Some(row), "{value}");
            assert_eq!(row.value(), value);
        }
    }

    #[test]
    fn what_means_nothing_is_no_row() {
        for value in [
            0,
            -1,
            // No code; an output that does nothing; one too high; one without a number.
            1_01_1_01_0200,
            8_0_01_1_01_0200,
            8_1_33_1_01_0200,
            8_1_00_1_01_0200,
            // An answer without input, an input without answer, one too high, no such level.
            8_1_01_1_00_0200,
            8_1_01_0_01_0200,
            8_1_01_1_33_0200,
            8_1_01_3_01_0200,
            // A wait without time, a pulse without time, a time for nothing.
            8_1_01_1_01_0000,
            8_3_01_0_00_0000,
            8_1_01_0_00_0200,
            // Neither output nor answer, and no such action.
            8_0_00_0_00_0000,
            8_4_01_1_01_0200,
            8_9_01_1_01_0200,
            1000_1_01_1_01_0200,
        ] {
            assert_eq!(FunctionRow::of(value), None, "{value}");
        }
    }

    #[test]
    fn each_contact_has_a_bit_of_its_own() {
        let bits = (1..=CONTACTS).map(|number| Contact::new(number).unwrap().bit());
        assert_eq!(bits.sum::<u32>(), u32::MAX);
        assert_eq!(Contact::all().count(), 32);
        assert!(Contact::of_bits(0x8001).map(Contact::number).eq([1, 16]));
        assert_eq!(
            [0, 1, 16, 32, 33].map(Contact::bit_of),
            [0, 1, 0x8000, 1 << 31, 0]
        );
        assert_eq!(Contact::new(0), None);
        assert_eq!(Contact::new(33), None);
        let of_block = Contact::all().filter(|contact| contact.is_of_block());
        assert!(of_block.map(Contact::number).eq(17..=32));
    }
}
