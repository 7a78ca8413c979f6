//! Macro A of GSK: `G65 Hm P#i Q#j R#k`.
//!
//! The 980TD counts in input increments: numbers without a point, and variables that such a block has set, are whole
//! counts; `÷`, the root and the functions of an angle cut off what is not whole, and angles are thousandths of a degree.
//! As soon as an operand has a point, or comes from a variable of macro B, the block calculates with plain numbers and
//! degrees, as the 980TDi does. This module must not know loops or places.

use leadscrew_core::alarm::{Alarm, Arg, Code};

use crate::expression::functions::{self, Function};
use crate::value::{Value, equal};
use crate::variables::{Scope, System};
use crate::word::{Given, Word};

/// What follows after a block of macro A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// The next block.
    Next,
    /// The block with this N.
    Jump(u32),
}

/// The first number of the alarms that H99 raises.
const FIRST_ALARM: i64 = 500;

/// An operand.
#[derive(Clone, Copy, Debug)]
struct Operand {
    number: f64,
    /// It is a count of increments.
    counts: bool,
}

/// Carries out a block of macro A; `words` are those after `Hm`, which is `which`.
///
/// # Errors
/// The alarm of H99, a function that does not exist, an operand that is missing or has no result.
pub fn carry_out<S: System>(
    which: &Word,
    words: &[Word],
    scope: &mut Scope<'_, S>,
) -> Result<After, Alarm> {
    let function = which.count(0, 99)?;
    for (index, word) in words.iter().enumerate() {
        if !matches!(word.letter, b'P' | b'Q' | b'R') {
            return Err(word.alarm(Code::WordWithoutUse));
        }
        if words[..index]
            .iter()
            .any(|other| other.letter == word.letter)
        {
            return Err(word.alarm(Code::WordTwice));
        }
    }
    let find = |letter| words.iter().find(|word| word.letter == letter);
    let Some(target) = find(b'P') else {
        return Err(which.alarm(Code::MacroStatement));
    };
    let operand = |letter| match find(letter) {
        Some(word) => Ok(of(word)),
        None => Err(which.alarm(Code::MacroStatement)),
    };
    match function {
        80 => return Ok(After::Jump(target.count(0, 99_999_999)?)),
        81..=86 => {
            let (a, b) = (operand(b'Q')?.number, operand(b'R')?.number);
            let holds = match function {
                81 => equal(a, b),
                82 => !equal(a, b),
                83 => a > b && !equal(a, b),
                84 => a < b && !equal(a, b),
                85 => a > b || equal(a, b),
                _ => a < b || equal(a, b),
            };
            let to = target.count(0, 99_999_999)?;
            return Ok(if holds { After::Jump(to) } else { After::Next });
        }
        99 => {
            let number = FIRST_ALARM + i64::from(target.count(0, 2499)?);
            return Err(which.alarm(Code::ProgramAlarm).with([Arg::Int(number)]));
        }
        _ => {}
    }
    let Some(variable) = target.variable else {
        return Err(target.alarm(Code::MacroStatement));
    };
    let first = operand(b'Q')?;
    let second = match function {
        1 | 21 | 22 | 24 | 25 => None,
        _ => Some(operand(b'R')?),
    };
    let own = of(target);
    let counts =
        first.counts && second.is_none_or(|second| second.counts) && (function != 26 || own.counts);
    let b = second.map_or(0.0, |second| second.number);
    let result = calculate(function, own.number, first.number, b, counts)
        .map_err(|code| which.alarm(code))?;
    if !result.is_finite() {
        return Err(which.alarm(Code::MacroOverflow));
    }
    let value = if counts {
        Value::Increments(result)
    } else {
        Value::Number(result)
    };
    scope.assign(variable, value, target.span)?;
    Ok(After::Next)
}

fn of(word: &Word) -> Operand {
    let value = word.value();
    Operand {
        number: value.number(),
        counts: match (word.given, value) {
            (Given::Written(number), _) => !number.has_point(),
            (_, Value::Number(_)) => false,
            (_, Value::Null | Value::Increments(_)) => true,
        },
    }
}

/// `own` is the value of the variable that takes the result.
fn calculate(function: u32, own: f64, a: f64, b: f64, counts: bool) -> Result<f64, Code> {
    let whole = |number: f64| if counts { libm::trunc(number) } else { number };
    let angle = if counts { b / 1000.0 } else { b };
    let of_angle = |function: Function| function.apply(angle, None, 0);
    Ok(match function {
        1 => a,
        2 => a + b,
        3 => a - b,
        4 => a * b,
        5 if b == 0.0 => return Err(Code::DivisionByZero),
        5 => whole(a / b),
        11 => functions::bits(a, b, |a, b| a | b)?,
        12 => functions::bits(a, b, |a, b| a & b)?,
        13 => functions::bits(a, b, |a, b| a ^ b)?,
        21 => whole(Function::Sqrt.apply(a, None, 0)?),
        22 => libm::fabs(a),
        23 => functions::remainder(a, b)?,
        24 => functions::from_bcd(a)?,
        25 => functions::to_bcd(a)?,
        26 if b == 0.0 => return Err(Code::DivisionByZero),
        26 => whole(own * a / b),
        27 => whole(libm::sqrt(a * a + b * b)),
        31 => whole(a * of_angle(Function::Sin)?),
        32 => whole(a * of_angle(Function::Cos)?),
        33 => whole(a * of_angle(Function::Tan)?),
        34 => {
            let turned = Function::Atan.apply(a, Some(b), 0)?;
            whole(if counts { turned * 1000.0 } else { turned })
        }
        _ => return Err(Code::MacroStatement),
    })
}
