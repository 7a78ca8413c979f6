//! Lines that are given by their angle: A beside X or Z of the end, or two lines that meet by their angles alone [D366].
//!
//! The angle is counted from +Z toward +X. What the block leaves out becomes a word of its own, U or W, so everything
//! behind sees an ordinary line.

use leadscrew_core::alarm::{Alarm, Code};

use super::Acting;
use crate::dialect::is_of_axis;
use crate::flow::Done;
use crate::value::Value;
use crate::word::{Given, Word};

/// A line whose end is where the next one comes from.
#[derive(Clone, Debug)]
pub(super) struct Open {
    line: u32,
    words: Vec<Word>,
    angle: Word,
}

/// Where a block leads, from where the tool is: X on the radius and Z; `None` where it does not say.
#[derive(Clone, Copy, Debug)]
struct Way {
    x: Option<f64>,
    z: Option<f64>,
    /// All of it is written as X and Z.
    is_absolute: bool,
}

/// Below this a line does not get on along an axis.
const STANDS: f64 = 1e-9;

/// Longer ways are no way: the angle hardly differs from that of the axis.
const LONGEST: f64 = 1e5;

/// How far a line of this angle goes along X and Z.
fn direction(angle: &Word) -> (f64, f64) {
    let degrees = match angle.value() {
        Value::Increments(count) => count / 1000.0,
        value => value.number(),
    };
    let (sine, cosine) = libm::sincos(degrees.to_radians());
    (sine, cosine)
}

fn refused(angle: &Word) -> Alarm {
    Alarm::new(Code::AngleEnd, angle.span).word(b'A')
}

impl Acting<'_, '_> {
    /// A line was left open by its angle, and no other came.
    pub(super) fn refuse_open_line(&mut self) -> Result<(), Alarm> {
        match self.core.open_line.take() {
            Some(open) => Err(refused(&open.angle)),
            None => Ok(()),
        }
    }

    /// Carries out a block of a line that is given by its angle; `None` where it is none.
    ///
    /// # Errors
    /// Angle and words that do not tell where the line ends.
    pub(super) fn line_by_angle(
        &mut self,
        line: u32,
        words: &[Word],
    ) -> Result<Option<Done>, Alarm> {
        let angle = words
            .iter()
            .find(|word| word.letter == Word::ANGLE)
            .copied();
        let Some(angle) = angle else {
            self.refuse_open_line()?;
            return Ok(None);
        };
        if angle.value().is_null() {
            return Err(refused(&angle));
        }
        let way = self.way(words);
        let mut rest: Vec<Word> = words.to_vec();
        rest.retain(|word| word.letter != Word::ANGLE);
        if let Some(open) = self.core.open_line.take() {
            return self.two_lines(open, line, rest, &angle, way).map(Some);
        }
        let (x, z) = direction(&angle);
        match (way.x, way.z) {
            (Some(along), None) if x.abs() > STANDS => {
                rest.push(self.increment(&angle, b'W', along * z / x)?);
            }
            (None, Some(along)) if z.abs() > STANDS => {
                rest.push(self.increment(&angle, b'U', 2.0 * along * x / z)?);
            }
            (None, None) => {
                self.core.open_line = Some(Open {
                    line,
                    words: rest,
                    angle,
                });
                return Ok(Some(Done::default()));
            }
            _ => return Err(refused(&angle)),
        }
        self.after_angle(line, &rest).map(Some)
    }

    /// Two lines that meet where their angles lead: the second has X and Z of its end.
    fn two_lines(
        &mut self,
        open: Open,
        line: u32,
        rest: Vec<Word>,
        angle: &Word,
        way: Way,
    ) -> Result<Done, Alarm> {
        let (Some(end_x), Some(end_z), true) = (way.x, way.z, way.is_absolute) else {
            return Err(refused(&open.angle));
        };
        let (x, z) = direction(&open.angle);
        let (next_x, next_z) = direction(angle);
        let cross = x * next_z - z * next_x;
        if cross.abs() < STANDS {
            return Err(refused(&open.angle));
        }
        // Where the first line has gone so far, the second leads to the end.
        let far = (end_x * next_z - end_z * next_x) / cross;
        let mut first = open.words;
        first.push(self.increment(&open.angle, b'U', 2.0 * far * x)?);
        first.push(self.increment(&open.angle, b'W', far * z)?);
        let before = self.after_angle(open.line, &first)?;
        let after = self.after_angle(line, &rest)?;
        Ok(Done {
            moved: before.moved || after.moved,
            ..after
        })
    }

    fn after_angle(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
        match self.drill(line, words)? {
            Some(done) => Ok(done),
            None => self.plain_words(line, words),
        }
    }

    /// Where the words of a block lead.
    fn way(&self, words: &[Word]) -> Way {
        let here = |number| {
            let value = self.core.system(number, self.modes);
            value.ok().flatten().map_or(0.0, Value::number)
        };
        let inch = self.core.interpreter.is_inch();
        let mut way = Way {
            x: None,
            z: None,
            is_absolute: true,
        };
        for word in words.iter().filter(|word| is_of_axis(word.letter)) {
            let number = match word.value() {
                Value::Null => continue,
                Value::Number(number) => number,
                Value::Increments(count) => {
                    let decimals = self.core.increment(word.letter, inch);
                    count / libm::pow(10.0, f64::from(decimals))
                }
            };
            match word.letter {
                b'X' => way.x = Some((number - here(5001)) / 2.0),
                b'U' => way.x = Some(number / 2.0),
                b'Z' => way.z = Some(number - here(5002)),
                _ => way.z = Some(number),
            }
            way.is_absolute &= matches!(word.letter, b'X' | b'Z');
        }
        way
    }

    /// A word that the angle gives.
    fn increment(&self, angle: &Word, letter: u8, number: f64) -> Result<Word, Alarm> {
        if number.abs() > LONGEST {
            return Err(refused(angle));
        }
        Ok(Word {
            letter,
            given: Given::Calculated(Value::Number(number)),
            variable: None,
            span: angle.span,
        })
    }
}
