//! G84 of a Haas with a spindle that stands: the tap is rigid, without a code of its own.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::units::Decimal;

use super::Acting;
use crate::dialect::Control;
use crate::word::{Given, Word};

impl Acting<'_, '_> {
    /// Begins rigid mode in front of such a block, at its S or the one in force; the words of the block then, without S.
    /// `None` where they are right as they are.
    pub(super) fn rigid_by_itself(
        &mut self,
        line: u32,
        words: &[Word],
    ) -> Result<Option<Vec<Word>>, Alarm> {
        let now = self.core.interpreter.in_force();
        let is =
            |word: &Word, letter, code| word.letter == letter && word.value().whole() == Some(code);
        let tap = words.iter().find(|word| is(word, b'G', 84));
        let (Control::Haas, Some(tap), false, false) =
            (self.core.control, tap, now.taps, now.turns)
        else {
            return Ok(None);
        };
        if words
            .iter()
            .any(|word| is(word, b'M', 3) || is(word, b'M', 4))
        {
            return Ok(None);
        }
        let made = |letter, number| Word {
            letter,
            given: Given::Written(Decimal::new(number, 0)),
            variable: None,
            span: tap.span,
        };
        let written = words.iter().find(|word| word.letter == b'S').copied();
        let speed = match (written, now.speed) {
            (Some(word), _) => word,
            // The core says what is missing.
            (None, 0) => return Ok(None),
            (None, speed) => made(b'S', i64::from(speed)),
        };
        let without = words.iter().filter(|word| word.letter != b'S').copied();
        if self.core.params.tap_by_g_code() {
            return Ok(Some(without.chain([speed]).collect()));
        }
        let code = self.core.interpreter.rigid_code();
        self.plain_words(line, &[made(b'M', code.into()), speed])?;
        Ok(Some(without.collect()))
    }
}
