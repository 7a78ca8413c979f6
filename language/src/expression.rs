//! Expressions of macro B: read and calculated in one pass, without a tree.
//!
//! Brackets and functions first, then `* / MOD AND`, then `+ - OR XOR`, each from left to right; one comparison
//! (`EQ NE GT GE LT LE`) may stand in a pair of brackets. Each mistake is an alarm at its own columns. Numbers are `f64`
//! and functions come from one portable library: the bits are the same on every machine. This module must not know what
//! a variable is, only how to ask for its value.

pub(crate) mod functions;
#[cfg(test)]
mod tests;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use crate::text::Cursor;
use crate::value::{Value, equal};
use functions::Function;

/// How deep brackets may be nested.
pub const DEPTH: u32 = 16;

/// The variables that an expression may name.
pub trait Lookup {
    /// The value of variable `#number`, written at `span`.
    ///
    /// # Errors
    /// There is no such variable, or no value is known for it.
    fn look_up(&mut self, number: i64, span: Span) -> Result<Value, Alarm>;
}

/// Calculates one expression after another of a block.
#[derive(Debug)]
pub struct Calculator<'c, 't, L> {
    cursor: &'c mut Cursor<'t>,
    variables: &'c mut L,
    /// Decimals to which ROUND rounds: those of the word's increment, 0 outside of words.
    decimals: u8,
    depth: u32,
}

/// An operator between two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Times,
    Over,
    Mod,
    And,
    Plus,
    Minus,
    Or,
    Xor,
}

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comparison {
    Eq,
    Ne,
    Gt,
    Ge,
    Lt,
    Le,
}

const PRODUCTS: [(&str, Operator); 4] = [
    ("*", Operator::Times),
    ("/", Operator::Over),
    ("MOD", Operator::Mod),
    ("AND", Operator::And),
];
const SUMS: [(&str, Operator); 4] = [
    ("+", Operator::Plus),
    ("-", Operator::Minus),
    ("OR", Operator::Or),
    ("XOR", Operator::Xor),
];
const COMPARISONS: [(&str, Comparison); 6] = [
    ("EQ", Comparison::Eq),
    ("NE", Comparison::Ne),
    ("GT", Comparison::Gt),
    ("GE", Comparison::Ge),
    ("LT", Comparison::Lt),
    ("LE", Comparison::Le),
];

impl<'c, 't, L: Lookup> Calculator<'c, 't, L> {
    /// Calculates at `cursor`, outside of words.
    pub const fn new(cursor: &'c mut Cursor<'t>, variables: &'c mut L) -> Self {
        Self::in_word(cursor, variables, 0)
    }

    /// Calculates the value of a word whose increment has so many decimals.
    pub const fn in_word(cursor: &'c mut Cursor<'t>, variables: &'c mut L, decimals: u8) -> Self {
        Self {
            cursor,
            variables,
            decimals,
            depth: 0,
        }
    }

    /// An expression without brackets around it, as on the right of `=`.
    ///
    /// # Errors
    /// The first mistake.
    pub fn sum(&mut self) -> Result<Value, Alarm> {
        let mut left = self.product()?;
        while let Some((operator, span)) = self.one_of(&SUMS) {
            let right = self.product()?;
            left = apply(operator, left, right, span)?;
        }
        Ok(left)
    }

    /// An expression in brackets.
    ///
    /// # Errors
    /// The first mistake.
    pub fn brackets(&mut self) -> Result<Value, Alarm> {
        self.open()?;
        let left = self.sum()?;
        let value = match self.one_of(&COMPARISONS) {
            None => left,
            Some((comparison, _)) => {
                let right = self.sum()?;
                Value::Number(f64::from(u8::from(holds(comparison, left, right))))
            }
        };
        self.close()?;
        Ok(value)
    }

    /// A condition in brackets: true where it is another number than 0.
    ///
    /// # Errors
    /// The first mistake.
    pub fn condition(&mut self) -> Result<bool, Alarm> {
        Ok(self.brackets()?.number() != 0.0)
    }

    /// The number of the variable whose `#` is next, and its columns.
    ///
    /// # Errors
    /// No number after `#`, or one that is not whole.
    pub fn variable(&mut self) -> Result<(i64, Span), Alarm> {
        let from = self.cursor.here().column;
        if !self.cursor.take(b'#') {
            return Err(self.cursor.alarm(Code::Formula));
        }
        let value = match self.cursor.peek() {
            Some(b'[') => self.brackets()?,
            Some(b'#') => {
                self.deeper()?;
                let value = self.named()?;
                self.depth -= 1;
                value
            }
            _ => self.literal()?,
        };
        let span = self.cursor.span_from(usize::from(from) - 1);
        match value.whole() {
            Some(number) => Ok((number, span)),
            None => Err(Alarm::new(Code::Formula, span)),
        }
    }

    /// The value of the variable whose `#` is next.
    ///
    /// # Errors
    /// The first mistake.
    pub fn named(&mut self) -> Result<Value, Alarm> {
        let (number, span) = self.variable()?;
        self.variables.look_up(number, span)
    }

    fn product(&mut self) -> Result<Value, Alarm> {
        let mut left = self.factor()?;
        while let Some((operator, span)) = self.one_of(&PRODUCTS) {
            let right = self.factor()?;
            left = apply(operator, left, right, span)?;
        }
        Ok(left)
    }

    fn factor(&mut self) -> Result<Value, Alarm> {
        let (mut signed, mut negative) = (false, false);
        loop {
            if self.cursor.take(b'-') {
                negative = !negative;
            } else if !self.cursor.take(b'+') {
                break;
            }
            signed = true;
        }
        let value = match self.cursor.peek() {
            Some(b'#') => self.named()?,
            Some(b'[') => self.brackets()?,
            Some(b'A'..=b'Z') => self.function()?,
            _ => self.literal()?,
        };
        let number = value.number();
        Ok(match (signed, negative) {
            (false, _) => value,
            (true, true) => Value::Number(-number),
            (true, false) => Value::Number(number),
        })
    }

    fn literal(&mut self) -> Result<Value, Alarm> {
        self.cursor.skip();
        let from = self.cursor.at();
        let digits = self.cursor.digits();
        let number = std::str::from_utf8(digits)
            .ok()
            .filter(|text| text.bytes().any(|byte| byte.is_ascii_digit()))
            .and_then(|text| text.parse::<f64>().ok())
            .filter(|number| number.is_finite());
        match number {
            Some(number) => Ok(Value::Number(number)),
            None => Err(Alarm::new(Code::Formula, self.cursor.span_from(from))),
        }
    }

    fn function(&mut self) -> Result<Value, Alarm> {
        self.cursor.skip();
        let from = self.cursor.at();
        let name = self.cursor.letters().to_ascii_uppercase();
        let Some(function) = Function::named(&name) else {
            return Err(Alarm::new(Code::Formula, self.cursor.span_from(from)));
        };
        self.open()?;
        let first = self.sum()?.number();
        let mut second = None;
        if function.takes_two() && self.cursor.take(b',') {
            second = Some(self.sum()?.number());
        }
        self.close()?;
        if function == Function::Atan && second.is_none() && self.is_over_brackets() {
            self.cursor.take(b'/');
            second = Some(self.brackets()?.number());
        }
        function
            .apply(first, second, self.decimals)
            .and_then(in_range)
            .map_err(|code| Alarm::new(code, self.cursor.span_from(from)))
    }

    /// True before `/[`, which gives ATAN its second argument.
    fn is_over_brackets(&self) -> bool {
        let mut ahead = *self.cursor;
        ahead.take(b'/') && ahead.peek() == Some(b'[')
    }

    fn one_of<T: Copy>(&mut self, list: &[(&str, T)]) -> Option<(T, Span)> {
        // Where there is none, what was calculated ends before the spaces.
        let mut ahead = *self.cursor;
        ahead.skip();
        let from = ahead.at();
        let (_, found) = list.iter().find(|(word, _)| ahead.take_word(word))?;
        *self.cursor = ahead;
        Some((*found, ahead.span_from(from)))
    }

    fn deeper(&mut self) -> Result<(), Alarm> {
        if self.depth == DEPTH {
            let limit = [Arg::Int(i64::from(DEPTH))];
            return Err(self.cursor.alarm(Code::BracketsTooDeep).with(limit));
        }
        self.depth += 1;
        Ok(())
    }

    fn open(&mut self) -> Result<(), Alarm> {
        if self.cursor.peek() != Some(b'[') {
            return Err(self.cursor.alarm(Code::Formula));
        }
        self.deeper()?;
        self.cursor.advance();
        Ok(())
    }

    fn close(&mut self) -> Result<(), Alarm> {
        if !self.cursor.take(b']') {
            return Err(self.cursor.alarm(Code::Formula));
        }
        self.depth -= 1;
        Ok(())
    }
}

fn apply(operator: Operator, left: Value, right: Value, span: Span) -> Result<Value, Alarm> {
    let (a, b) = (left.number(), right.number());
    let result = match operator {
        Operator::Times => Ok(a * b),
        Operator::Over if b == 0.0 => Err(Code::DivisionByZero),
        Operator::Over => Ok(a / b),
        Operator::Mod => functions::remainder(a, b),
        Operator::And => functions::bits(a, b, |a, b| a & b),
        Operator::Plus => Ok(a + b),
        Operator::Minus => Ok(a - b),
        Operator::Or => functions::bits(a, b, |a, b| a | b),
        Operator::Xor => functions::bits(a, b, |a, b| a ^ b),
    };
    result
        .and_then(in_range)
        .map_err(|code| Alarm::new(code, span))
}

fn in_range(number: f64) -> Result<Value, Code> {
    if number.is_finite() {
        Ok(Value::Number(number))
    } else {
        Err(Code::MacroOverflow)
    }
}

/// A null is equal to nothing but another null; in order it counts as 0.
fn holds(comparison: Comparison, left: Value, right: Value) -> bool {
    let (a, b) = (left.number(), right.number());
    let same = equal(a, b);
    let same_value = same && left.is_null() == right.is_null();
    match comparison {
        Comparison::Eq => same_value,
        Comparison::Ne => !same_value,
        Comparison::Gt => a > b && !same,
        Comparison::Ge => a > b || same,
        Comparison::Lt => a < b && !same,
        Comparison::Le => a < b || same,
    }
}
