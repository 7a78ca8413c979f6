//! Words whose values may be expressions.
//!
//! A word keeps its columns, and either the number as it is written or the value that was calculated. A calculated value
//! becomes a number of the increment of its word. This module must not know what a word is for.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::program::slip;
use leadscrew_core::units::Decimal;

use crate::expression::{Calculator, Lookup};
use crate::text::{Cursor, span};
use crate::value::Value;

/// The number of a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// As it is written.
    Written(Decimal),
    /// As it was calculated.
    Calculated(Value),
}

/// A letter with its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// A capital letter, or one of the small ones for a corner: [`Word::CHAMFER`] and those beside it.
    pub letter: u8,
    /// Its number.
    pub given: Given,
    /// The variable, where the number is written as `#i` and nothing else.
    pub variable: Option<i64>,
    /// Its place.
    pub span: Span,
}

impl Word {
    /// `,C`.
    pub const CHAMFER: u8 = b'c';
    /// `,R`, and D of the GSK.
    pub const ROUND: u8 = b'r';
    /// L of the GSK: what it measures is a parameter.
    pub const CHAMFER_L: u8 = b'l';
    /// C, I or K of FANUC and Haas: a chamfer whose sign says where the next motion goes.
    pub const CHAMFER_TOWARD: u8 = b'k';
    /// `,A`, and A of a line in a Haas: the angle of the line.
    pub const ANGLE: u8 = b'g';
    /// Q of G76 in one block: the start angle, for which the block that takes its place has no letter.
    pub const START_ANGLE: u8 = b'a';
    /// R of FANUC and Haas: a rounding with such a sign.
    pub const ROUND_TOWARD: u8 = b'q';

    /// An alarm that blames this word.
    #[cold]
    #[must_use]
    pub fn alarm(&self, code: Code) -> Alarm {
        Alarm::new(code, self.span).word(self.letter)
    }

    /// The value of the word.
    #[must_use]
    pub fn value(&self) -> Value {
        match self.given {
            Given::Written(number) => {
                let scale = libm::pow(10.0, f64::from(number.decimals()));
                Value::Number(number.mantissa() as f64 / scale)
            }
            Given::Calculated(value) => value,
        }
    }

    /// The number of a word that is a count from `low` to `high`.
    ///
    /// # Errors
    /// A number that is not whole, or out of range.
    pub fn count(&self, low: u32, high: u32) -> Result<u32, Alarm> {
        if let Given::Written(number) = self.given
            && number.has_point()
        {
            return Err(self.alarm(Code::PointInInteger));
        }
        let Some(whole) = self.value().whole() else {
            return Err(self.alarm(Code::PointInInteger));
        };
        match u32::try_from(whole) {
            Ok(count) if (low..=high).contains(&count) => Ok(count),
            _ => {
                let range = [Arg::Int(i64::from(low)), Arg::Int(i64::from(high))];
                Err(self.alarm(Code::WordOutOfRange).with(range))
            }
        }
    }

    /// The number of the word for the core, rounded to so many decimals where it was calculated; a count of increments has
    /// `step` decimals. `None` for a word without a value.
    #[must_use]
    pub fn decimal(&self, decimals: u8, step: u8) -> Option<Decimal> {
        match self.given {
            Given::Written(number) => Some(number),
            Given::Calculated(Value::Null) => None,
            Given::Calculated(Value::Number(number)) => Some(rounded(number, decimals)),
            Given::Calculated(Value::Increments(count)) => {
                let steps = libm::pow(10.0, f64::from(step));
                Some(rounded(count / steps, decimals))
            }
        }
    }
}

/// More than any word may have; what the core refuses with its own figures.
const MOST: f64 = 9e17;

/// A number with so many decimals, halves away from zero. A whole number is given without a point, as it would be written.
/// The sum of some tenths may miss a half by its last bits: such a number counts as the half.
fn rounded(number: f64, decimals: u8) -> Decimal {
    /// 16 units in the last place of a number next to 1.
    const NEAR: f64 = 16.0 * f64::EPSILON;
    let steps = 10_i64.pow(u32::from(decimals.min(9)));
    let scaled = number * steps as f64;
    let near = scaled + libm::copysign(NEAR * libm::fabs(scaled), scaled);
    let most = libm::copysign(MOST, scaled);
    let count = if libm::fabs(near) < MOST { near } else { most };
    let count = libm::round(count) as i64;
    let text = if count % steps == 0 {
        (count / steps).to_string()
    } else {
        let (whole, rest) = (count.unsigned_abs() / steps as u64, count % steps);
        let sign = if count < 0 { "-" } else { "" };
        let width = usize::from(decimals.min(9));
        format!("{sign}{whole}.{:0width$}", rest.unsigned_abs())
    };
    // Parsing gives the count of digits that a written number would have.
    Decimal::parse(text.as_bytes()).0
}

/// Reads the words of a block into `words`. ROUND in a word keeps the decimals that `decimals` gives for its letter.
///
/// # Errors
/// The first thing that is no word, or a mistake in an expression.
pub fn read<L: Lookup>(
    cursor: &mut Cursor<'_>,
    variables: &mut L,
    decimals: impl Fn(u8) -> u8,
    words: &mut Vec<Word>,
) -> Result<(), Alarm> {
    while let Some(byte) = cursor.peek() {
        let from = cursor.at();
        let whole = *cursor;
        let byte = match byte {
            b',' if corner(whole).is_some() => {
                cursor.advance();
                cursor.skip();
                corner(whole).unwrap_or(byte)
            }
            letter if letter.is_ascii_uppercase() => letter,
            _ => return Err(cursor.alarm(not_a_word(cursor.rest()))),
        };
        cursor.advance();
        let first = cursor.peek();
        let mut ahead = *cursor;
        if matches!(first, Some(b'+' | b'-')) {
            ahead.advance();
        }
        let (given, variable) = match ahead.peek() {
            Some(b'#' | b'[') => {
                *cursor = ahead;
                let (value, variable) =
                    calculated(cursor, variables, decimals(byte.to_ascii_uppercase()))?;
                let given = match (value, first) {
                    (Value::Null, _) => Value::Null,
                    (Value::Number(number), Some(b'-')) => Value::Number(-number),
                    (Value::Increments(count), Some(b'-')) => Value::Increments(-count),
                    _ => value,
                };
                (Given::Calculated(given), variable)
            }
            _ => (Given::Written(written(cursor, byte, from, whole)?), None),
        };
        words.push(Word {
            letter: byte,
            given,
            variable,
            span: cursor.span_from(from),
        });
    }
    Ok(())
}

/// The letter of `,C`, `,R` or `,A` in words of their own.
fn corner(mut cursor: Cursor<'_>) -> Option<u8> {
    cursor.advance();
    match cursor.peek() {
        Some(b'C') => Some(Word::CHAMFER),
        Some(b'R') => Some(Word::ROUND),
        Some(b'A') => Some(Word::ANGLE),
        _ => None,
    }
}

/// The value at `#` or `[`, and the number of the variable at `#`.
fn calculated<L: Lookup>(
    cursor: &mut Cursor<'_>,
    variables: &mut L,
    decimals: u8,
) -> Result<(Value, Option<i64>), Alarm> {
    if cursor.peek() == Some(b'[') {
        let value = Calculator::in_word(cursor, variables, decimals).brackets()?;
        return Ok((value, None));
    }
    let (number, span) = Calculator::in_word(cursor, variables, decimals).variable()?;
    Ok((variables.look_up(number, span)?, Some(number)))
}

/// The number that is written after a letter.
fn written(
    cursor: &mut Cursor<'_>,
    letter: u8,
    from: usize,
    whole: Cursor<'_>,
) -> Result<Decimal, Alarm> {
    let text = cursor.rest();
    let (number, after) = Decimal::parse(text);
    for _ in after.len()..text.len() {
        cursor.advance();
    }
    let code = if number.digits() == 0 {
        if is_statement(whole) {
            return Err(Alarm::new(
                Code::MacroAndWords,
                span(cursor.line(), from, from + 1),
            ));
        }
        match after {
            [0, ..] => Code::WideText,
            _ => Code::NumberMissing,
        }
    } else if number.digits() > Decimal::MAX_DIGITS {
        Code::NumberTooLong
    } else if after.first() == Some(&b'.') {
        Code::SecondPoint
    } else {
        return Ok(number);
    };
    let figure = match code {
        Code::NumberMissing => slip(letter, after),
        _ => i64::from(Decimal::MAX_DIGITS),
    };
    // Spaces after a letter belong to no number.
    let end = if after.len() == text.len() {
        from + 1
    } else {
        cursor.at()
    };
    let alarm = Alarm::new(code, span(cursor.line(), from, end)).with([Arg::Int(figure)]);
    Err(alarm.word(letter))
}

/// True where a statement begins that cannot stand after words.
fn is_statement(mut cursor: Cursor<'_>) -> bool {
    ["GOTO", "IF", "WHILE", "DO", "END"]
        .iter()
        .any(|word| cursor.take_word(word))
}

/// Why a word cannot begin here.
const fn not_a_word(text: &[u8]) -> Code {
    match text {
        [b'#', ..] => Code::MacroAndWords,
        [b'[' | b']' | b'=' | b'*', ..] => Code::MacroNotAvailable,
        [b'/', ..] => Code::SkipNotFirst,
        [b'%', ..] => Code::PercentInBlock,
        [b')', ..] | [0xEF, 0xBC, 0x89, ..] => Code::CommentClosed,
        [0, ..] | [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Code::WideText,
        [0x80..=0xFF, ..] => Code::NotAscii,
        _ => Code::UnknownCharacter,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct One;

    impl Lookup for One {
        fn look_up(&mut self, number: i64, span: Span) -> Result<Value, Alarm> {
            match number {
                0 => Ok(Value::Null),
                1 => Ok(Value::Number(12.34567)),
                2 => Ok(Value::Increments(12_500.0)),
                _ => Err(Alarm::new(Code::VariableNumber, span)),
            }
        }
    }

    fn words(text: &str) -> Result<Vec<Word>, Alarm> {
        let mut words = Vec::new();
        let mut cursor = Cursor::new(1, text.as_bytes(), 0);
        read(&mut cursor, &mut One, |_| 3, &mut words)?;
        Ok(words)
    }

    #[test]
    fn values_are_rounded_to_the_increment_of_their_word() {
        for (number, decimals, expected) in [
            (1.0005, 3, "1.001"),
            (-1.0005, 3, "-1.001"),
            (1.00049, 3, "1"),
            (-0.0004, 3, "0"),
            (0.1 + 0.2, 4, "0.3"),
            (2.5, 0, "3"),
            (-2.5, 0, "-3"),
            (60.0, 3, "60"),
            (-0.25, 3, "-0.250"),
            (1e30, 3, "900000000000000"),
        ] {
            let expected = Decimal::parse(expected.as_bytes()).0;
            let found = rounded(number, decimals);
            assert_eq!(found.scaled(9), expected.scaled(9), "{number}");
            assert_eq!(
                found.has_point(),
                number.fract() != 0.0 && found.decimals() > 0
            );
        }
        assert_eq!(rounded(20_560.0, 0).digits(), 5);
    }

    #[test]
    fn a_word_has_its_columns_and_its_value() {
        let all = words("g1 X-#1 Z[#1*2]F 0.2 (a) Y#0 U#2").unwrap();
        let shown: Vec<_> = all
            .iter()
            .map(|word| (word.letter, word.span.column, word.span.end))
            .collect();
        assert_eq!(
            shown,
            [
                (b'G', 1, 3),
                (b'X', 4, 8),
                (b'Z', 9, 16),
                (b'F', 16, 21),
                (b'Y', 26, 29),
                (b'U', 30, 33)
            ]
        );
        let decimal = |index: usize| all[index].decimal(3, 3).map(|number| number.scaled(3));
        assert_eq!(decimal(1), Some(Ok(-12_346)));
        assert_eq!(decimal(2), Some(Ok(24_691)));
        assert_eq!(decimal(3), Some(Ok(200)));
        assert_eq!(decimal(4), None);
        assert_eq!(decimal(5), Some(Ok(12_500)));
        assert_eq!(all[1].variable, Some(1));
        assert_eq!(all[2].variable, None);
    }

    #[test]
    fn what_is_no_word_is_told_at_its_columns() {
        for (text, number, column, end) in [
            ("X#9", 115, 2, 4),
            ("X[1", 125, 4, 5),
            ("X Z1", 4003, 1, 2),
            ("X-.", 4003, 1, 4),
            ("O\0", 4051, 1, 2),
            ("X#1 \u{fffe}", 4002, 5, 6),
            ("X1 #1=5", 127, 4, 5),
            ("X1 GOTO 5", 127, 4, 5),
            ("X#1]", 4011, 4, 5),
            ("X#1 /M8", 4009, 5, 6),
            ("X#1 %", 4010, 5, 6),
            ("X#1)", 4008, 4, 5),
            ("X#1 ?", 4001, 5, 6),
            ("X#1 \u{e4}", 4002, 5, 6),
            ("X#1\0", 4051, 4, 5),
            ("X#1 Z1.2.3", 4005, 5, 9),
            ("X#1 Z1234567890123456789", 4004, 5, 25),
        ] {
            let alarm = words(text).expect_err(text);
            let found = (alarm.number(), alarm.span.column, alarm.span.end);
            assert_eq!(found, (number, column, end), "{text}");
        }
    }

    #[test]
    fn a_count_is_whole_and_in_range() {
        let one = |text: &str| words(text).unwrap()[0].count(1, 9999);
        assert_eq!(one("P12"), Ok(12));
        assert_eq!(one("P[2*3]"), Ok(6));
        let refused = |text| one(text).map_err(|alarm| alarm.number());
        assert_eq!(refused("P1."), Err(4023));
        assert_eq!(refused("P#1"), Err(4023));
        assert_eq!(refused("P0"), Err(4025));
        assert_eq!(refused("P-5"), Err(4025));
    }
}
