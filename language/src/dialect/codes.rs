//! Which code of a control is which of system A.

use leadscrew_core::alarm::{Alarm, Arg, Code};

use super::{Control, refusals};
use crate::value::Value;
use crate::word::{Given, Word};

/// Pairs: as the control writes it, and as system A does.
type Pairs = &'static [(i64, i64)];

/// True for a code, in tenths, of a FANUC or Haas that ends what this machine does not have: it stands in the first lines
/// of programs, and there is nothing to do [D442].
const fn ends_nothing(tenths: i64, control: Control) -> bool {
    match tenths {
        // G23 G25 G49 G69, and the end of G12.1 and G112.
        230 | 250 | 490 | 690 | 131 | 1130 => true,
        // The end of G10, which ends with its block here.
        110 => control.is_fanuc(),
        _ => false,
    }
}

/// Takes the codes and words out of a block that say nothing on this machine: cancels, G103 P and G187 P of a Haas, V0 of
/// G28; and M23 and M24, which have been heard. E of G187 is a tolerance, and is not passed over [D484].
pub(super) fn leave_out(words: &mut Vec<Word>, control: Control) {
    let code = |word: &Word, letter| (word.letter == letter).then(|| tenths(word))?;
    let has = |tenths| words.iter().any(|word| code(word, b'G') == Some(tenths));
    let goes_home = has(280) || has(300);
    let tolerance = words.iter().any(|word| word.letter == b'E');
    let looks_ahead = control == Control::Haas && (has(1030) || (has(1870) && !tolerance));
    words.retain(|word| {
        let is_zero = word.value().is_null() || word.value().whole() == Some(0);
        let leaves = match word.letter {
            b'V' | b'Y' => goes_home && is_zero,
            _ if control.is_gsk() => false,
            b'G' => code(word, b'G').is_some_and(|code| {
                ends_nothing(code, control) || (looks_ahead && matches!(code, 1030 | 1870))
            }),
            b'M' => control == Control::Haas && matches!(code(word, b'M'), Some(230 | 240)),
            b'P' => looks_ahead,
            _ => false,
        };
        !leaves
    });
}

/// Ten times the number of a code.
fn tenths(word: &Word) -> Option<i64> {
    match word.given {
        Given::Written(number) => number.scaled(1).ok(),
        // G#1, with the 13.1 of #4021.
        Given::Calculated(value) => Value::Number(value.number() * 10.0).whole(),
    }
}

const SYSTEM_B: Pairs = &[
    (77, 90),
    (78, 92),
    (79, 94),
    (33, 32),
    (92, 50),
    (94, 98),
    (95, 99),
];

const SYSTEM_C: Pairs = &[
    (20, 90),
    (21, 92),
    (24, 94),
    (33, 32),
    (92, 50),
    (72, 70),
    (73, 71),
    (74, 72),
    (75, 73),
    (76, 74),
    (77, 75),
    (78, 76),
    (70, 20),
    (71, 21),
    (94, 98),
    (95, 99),
];

impl Control {
    const fn pairs(self) -> Pairs {
        match self {
            Self::FanucB => SYSTEM_B,
            Self::FanucC => SYSTEM_C,
            Self::Gsk980td | Self::Gsk988 | Self::FanucA | Self::Haas => &[],
        }
    }

    /// The code of system A for `code` of this control; `None` for a code of system A that this control writes in another
    /// way, or has with another meaning.
    #[must_use]
    pub fn to_a(self, code: i64) -> Option<i64> {
        let pairs = self.pairs();
        match pairs.iter().find(|(own, _)| *own == code) {
            Some((_, a)) => Some(*a),
            None if pairs.iter().any(|(_, a)| *a == code) => None,
            None => Some(code),
        }
    }

    /// True for a code that the GSK and system A do not have, and this control does.
    pub(super) fn has_of_its_own(self, code: i64) -> bool {
        let pairs = self.pairs();
        pairs.iter().any(|(own, _)| *own == code)
            || match self {
                Self::FanucB | Self::FanucC => matches!(code, 81 | 82 | 85 | 89 | 91),
                Self::Haas => matches!(code, 81 | 82 | 85 | 89 | 91 | 103),
                Self::FanucA => matches!(code, 85 | 89),
                Self::Gsk980td | Self::Gsk988 => false,
            }
    }

    /// How this control writes `code` of system A.
    #[must_use]
    pub fn written(self, code: i64) -> i64 {
        let pair = self.pairs().iter().find(|(_, a)| *a == code);
        pair.map_or(code, |(own, _)| *own)
    }

    /// The alarm with the codes as this control writes them.
    #[must_use]
    pub fn in_own_codes(self, mut alarm: Alarm) -> Alarm {
        if let (Code::UnknownG | Code::GNotAvailable, Arg::GCode(tenths)) =
            (alarm.code, alarm.args[0])
        {
            if let Some(named) = refusals::by_name(self, alarm, tenths) {
                return named;
            }
            if alarm.code == Code::UnknownG {
                // It names what was written.
                return refusals::of_another(self, alarm, tenths);
            }
        }
        for arg in &mut alarm.args {
            if let Arg::GCode(tenths) = arg
                && let Ok(own) = u16::try_from(self.written(i64::from(*tenths / 10)))
                && *tenths % 10 == 0
            {
                *tenths = own * 10;
            }
        }
        alarm
    }
}
