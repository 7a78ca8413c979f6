//! G74, G75 and G76 in one block, as Haas and the older FANUC write them: the steps and depths are I, K and D.
//!
//! A groove becomes the block of the two-line form. A thread becomes the two blocks of a G78, which has words for the way
//! of the infeed [D226].

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::units::{Decimal, StartAngle};

use super::Control;
use super::translator::{Setting, code_of, has_code};
use crate::value::Value;
use crate::word::{Given, Word};

fn has(words: &[Word], letters: &[u8]) -> bool {
    words.iter().any(|word| letters.contains(&word.letter))
}

/// True for a thread in one block, also one whose height or first depth is missing: D and A are its words alone. K is too
/// on a Haas, and without P and Q on a FANUC; on a GSK it is the run-out of the two-line form.
pub(super) fn is_thread(words: &[Word], control: Control) -> bool {
    let k_is_height = match control {
        Control::Haas => true,
        _ => control.is_fanuc() && !has(words, b"PQ"),
    };
    has_code(words, 76)
        && has(words, b"XUZW")
        && (has(words, b"DA") || k_is_height && has(words, b"K"))
}

/// The G word of a thread in one block.
pub fn thread_word(words: &[Word], control: Control) -> Option<Span> {
    is_thread(words, control).then(|| g76(words).map(|word| word.span))?
}

/// An alarm of a thread in one block: it names the code and the letters that were written, and not those of the G78 that
/// it was turned into.
pub fn as_written(mut alarm: Alarm, words: &[Word]) -> Alarm {
    if !words.iter().any(|word| word.span == alarm.span) {
        return alarm;
    }
    let written = |letter| match letter {
        b'P' => b'K',
        b'Q' => b'D',
        b'R' => b'I',
        other => other,
    };
    alarm.word = alarm.word.map(written);
    for arg in &mut alarm.args {
        *arg = match *arg {
            Arg::GCode(780) => Arg::GCode(760),
            Arg::Letter(letter) => Arg::Letter(written(letter)),
            other => other,
        };
    }
    alarm
}

fn g76(words: &[Word]) -> Option<&Word> {
    let is = |word: &&Word| code_of(word) == Some(76);
    words.iter().find(is)
}

/// True for a groove, or pecks along Z, in one block.
fn is_groove(words: &[Word]) -> bool {
    (has_code(words, 74) || has_code(words, 75)) && has(words, b"IKD")
}

/// The blocks that take the place of a block in the one-line form; `None` for any other block.
///
/// # Errors
/// A word that the form does not have, or a number out of its range.
pub fn blocks(
    words: &[Word],
    control: Control,
    now: Setting,
) -> Result<Option<Vec<Vec<Word>>>, Alarm> {
    if is_groove(words) {
        return Ok(Some(vec![groove(words, control, now)?]));
    }
    if is_thread(words, control) {
        return Ok(Some(thread(words)?.into()));
    }
    Ok(None)
}

/// I is the step of X on the radius, K that of Z, D the relief.
fn groove(words: &[Word], control: Control, now: Setting) -> Result<Vec<Word>, Alarm> {
    let diameter = control == Control::Gsk980td;
    words
        .iter()
        .map(|word| {
            let (letter, factor) = match word.letter {
                b'P' | b'Q' | b'R' => return Err(word.alarm(Code::WordWithoutUse)),
                b'I' => (b'P', if diameter { 2 } else { 1 }),
                b'K' => (b'Q', 1),
                b'D' => (b'R', 1),
                _ => return Ok(*word),
            };
            let counts = now.counts && diameter && letter != b'R';
            let scale = if counts { now.increment } else { 0 };
            Ok(Word {
                letter,
                given: times(word, factor, scale)?,
                ..*word
            })
        })
        .collect()
}

/// A number times `factor`, as a count of increments of `decimals`.
fn times(word: &Word, factor: i64, decimals: u8) -> Result<Given, Alarm> {
    match word.given {
        Given::Written(number) if decimals > 0 => {
            let step = [Arg::Decimal(1, decimals)];
            let beyond = |_| word.alarm(Code::DigitBeyondIncrement).with(step);
            let count = number.scaled(decimals).map_err(beyond)?;
            let count = count.saturating_mul(factor);
            Ok(Given::Written(
                Decimal::parse(count.to_string().as_bytes()).0,
            ))
        }
        Given::Written(number) if factor == 1 => Ok(Given::Written(number)),
        _ => Ok(match word.value() {
            Value::Null => Given::Calculated(Value::Null),
            Value::Number(number) => {
                let steps = libm::pow(10.0, f64::from(decimals));
                Given::Calculated(Value::Number(number * factor as f64 * steps))
            }
            Value::Increments(count) => Given::Calculated(Value::Increments(count * factor as f64)),
        }),
    }
}

/// K is the height, D the first depth, I the taper, A the angle, P the way of the infeed, Q the start angle [D274].
fn thread(words: &[Word]) -> Result<[Vec<Word>; 2], Alarm> {
    let Some(code) = g76(words) else {
        return Ok([Vec::new(), words.to_vec()]);
    };
    let find = |letter| words.iter().find(|word: &&Word| word.letter == letter);
    let count = |letter, high| find(letter).map(|word| word.count(0, high)).transpose();
    let whole = |word: &Word| Word {
        given: Given::Written(without_point(word)),
        ..*word
    };
    let angle = match find(b'A') {
        Some(word) => whole(word).count(0, 99)?,
        None => 60,
    };
    // As [G78 sheet]: 1 down the −Z flank, 4 both flanks in turn; D 1 decreasing, 0 equal.
    let (way, decreasing) = match count(b'P', 4)?.unwrap_or(1) {
        0 | 1 => (1, 1),
        2 => (4, 1),
        3 => (1, 0),
        _ => (4, 0),
    };
    let given = |text: &str| Given::Written(Decimal::parse(text.as_bytes()).0);
    let made = |letter, text: &str| Word {
        letter,
        given: given(text),
        variable: None,
        span: code.span,
    };
    let cycle = made(b'G', "78");
    let mut first: Vec<Word> = words
        .iter()
        .filter(|word| word.letter == b'N')
        .copied()
        .collect();
    first.extend([
        cycle,
        made(b'P', &format!("01{way:02}{angle:02}")),
        made(b'R', "0"),
        made(b'D', &decreasing.to_string()),
    ]);
    let mut second = Vec::with_capacity(words.len());
    for word in words {
        let letter = match word.letter {
            b'N' | b'A' | b'P' => continue,
            b'R' | b'J' => return Err(word.alarm(Code::WordWithoutUse)),
            b'Q' => {
                if second
                    .iter()
                    .any(|known: &Word| known.letter == Word::START_ANGLE)
                {
                    return Err(word.alarm(Code::WordTwice));
                }
                word.count(0, StartAngle::FULL)?;
                Word::START_ANGLE
            }
            b'G' if word.span == code.span => {
                second.push(cycle);
                continue;
            }
            b'I' => b'R',
            b'K' => b'P',
            b'D' => b'Q',
            b'E' => b'F',
            other => other,
        };
        second.push(Word { letter, ..*word });
    }
    Ok([first, second])
}

/// `60.` as 60.
fn without_point(word: &Word) -> Decimal {
    match word.given {
        Given::Written(number) => match number.scaled(0) {
            Ok(whole) => Decimal::parse(whole.to_string().as_bytes()).0,
            Err(_) => number,
        },
        Given::Calculated(_) => word.decimal(0, 0).unwrap_or_default(),
    }
}
