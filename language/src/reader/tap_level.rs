//! R of a tap in a Haas, which is a coordinate: the core has it as a distance from where the tool is.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::call::Position;
use leadscrew_core::units::{Decimal, Length};

use super::Acting;
use crate::dialect::{Control, has_code};
use crate::word::{Given, Word};

impl Acting<'_, '_> {
    /// The words of a block with R as a distance; `None` where they are right as they are.
    pub(super) fn tap_level(&self, line: u32, words: &[Word]) -> Result<Option<Vec<Word>>, Alarm> {
        let core = &*self.core;
        let has = |code| has_code(words, code);
        let now = core.interpreter.in_force();
        let is_level = |word: &Word| word.letter == b'R' && !word.value().is_null();
        let index = words.iter().position(is_level);
        let Some(index) = index.filter(|_| {
            core.control == Control::Haas && (has(84) || (now.taps && !has(80))) && !has(88)
        }) else {
            return Ok(None);
        };
        let across = now.plane == 17 && !core.params.tap_axis_fixed();
        let letter = if across { b'X' } else { b'Z' };
        let of = |at: Position| if across { at.x } else { at.z };
        let unit = core.unit();
        let level = if now.taps {
            // In rigid mode nothing moves but the tap.
            let at = unit.length(&words[index])?.value;
            let on_axis = if across { at.nm() / 2 } else { at.nm() };
            of(now.origin) + Length::from_nm(on_axis)
        } else {
            of(self.probe(line, letter, &words[index])?)
        };
        let away = level - of(core.interpreter.position());
        let step = unit.step_nm;
        let half = step / 2 * away.signum();
        let count = (away.nm() + half) / step;
        let mut words = words.to_vec();
        words[index].given = Given::Written(Decimal::new(count, unit.decimals));
        Ok(Some(words))
    }
}
