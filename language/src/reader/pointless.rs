//! A length of a cycle without a point that is too large in millimetres: it may have been meant as increments [D443].
//!
//! This module must not know what the cycles do.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::units::Length;

use super::Core;
use crate::dialect::Control;
use crate::word::{Given, Word};

impl Core<'_> {
    /// The alarm of an R out of range, which says what it would be in increments where it has no point.
    pub(super) fn without_point(&self, alarm: Alarm, words: &[Word]) -> Alarm {
        let may_count = self.control != Control::Gsk980td && self.params.whole_units();
        let blamed = words.iter().find(|word| word.span == alarm.span);
        match blamed.map(|word| (word.letter, word.given)) {
            Some((b'R', Given::Written(number)))
                if alarm.code == Code::WordOutOfRange && may_count && !number.has_point() =>
            {
                let unit = self.unit();
                let steps = 10_i64.saturating_pow(u32::from(unit.decimals));
                let increments = number.mantissa().saturating_mul(unit.step_nm);
                let lengths = [increments.saturating_mul(steps), increments];
                Alarm::new(Code::LengthWithoutPoint, alarm.span)
                    .word(b'R')
                    .with(lengths.map(|nm| Arg::Length(Length::from_nm(nm))))
            }
            _ => alarm,
        }
    }
}
