//! Numbers as they are written: without a point, where a control counts increments then, and with more digits than its
//! increment has.
//!
//! The words are those of system A, behind the translator: corners have letters of their own, and what counts increments in
//! any case has become a length.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::units::Decimal;

use super::Setting;
use super::translator::{has_code, is_one_shot, motion_of, orients};
use crate::word::{Given, Word};

/// What a block is, for the numbers of its words.
struct Block {
    /// The code of group 01.
    motion: i64,
    /// Nothing but motion.
    alone: bool,
    /// G04.
    dwell: bool,
    /// G10: C is an increment of R.
    offsets: bool,
    /// G65 or G66: its words are arguments.
    arguments: bool,
    /// A tapping cycle: F is a lead.
    taps: bool,
    /// G73 with its passes in R or D.
    pattern: bool,
    /// G76 in one block or two.
    thread: bool,
    /// M19 without motion: R is an angle in degrees.
    orients: bool,
    /// The feed is per turn.
    per_turn: bool,
    /// Decimals of a length and of an angle.
    length: u8,
    angle: u8,
}

impl Block {
    fn of(words: &[Word], setting: Setting) -> Self {
        let has = |code| has_code(words, code);
        let inch = has(20) || (setting.inch && !has(21));
        let angle = setting.increment - u8::from(setting.inch);
        Self {
            motion: motion_of(words, setting),
            alone: !setting.holes && !words.iter().any(is_one_shot),
            dwell: has(4),
            offsets: has(10),
            arguments: has(65) || has(66),
            taps: setting.holes || has(84) || has(88),
            pattern: has(73),
            thread: has(76),
            orients: orients(words),
            per_turn: has(99) || (setting.per_turn && !has(98)),
            length: angle + u8::from(inch),
            angle,
        }
    }

    /// Decimals that the number of a word may have; `None` for a word that has no increment.
    fn decimals(&self, letter: u8) -> Option<u8> {
        if self.arguments {
            return None;
        }
        Some(match letter {
            b'X' | b'U' if self.dwell => 3,
            b'X' | b'Z' | b'U' | b'W' | b'I' | b'J' | b'K' | b'R' => self.length,
            b'D' if !self.pattern => self.length,
            Word::CHAMFER | Word::ROUND | Word::CHAMFER_L | Word::CHAMFER_TOWARD => self.length,
            Word::ROUND_TOWARD => self.length,
            b'C' if self.offsets => self.length,
            b'C' | b'H' => self.angle,
            b'F' | b'E' => 6 - u8::from(self.length > self.angle),
            _ => return None,
        })
    }

    /// Decimals of the increment that a number without a point counts; `None` for a word that is a count or a unit anyway.
    fn counted(&self, letter: u8) -> Option<u8> {
        if self.arguments {
            return match letter {
                b'X' | b'Z' | b'U' | b'W' | b'I'..=b'K' | b'R' => Some(self.length),
                b'A'..=b'C' => Some(self.angle),
                _ => None,
            };
        }
        match letter {
            b'I' | b'J' | b'K' => {
                let centre = self.alone && matches!(self.motion, 2 | 3);
                let of_cycle = self.pattern || self.thread;
                let run_out = self.alone && letter != b'I' && matches!(self.motion, 32 | 92);
                (centre || of_cycle || run_out).then_some(self.length)
            }
            // The passes of G73 in two lines.
            b'R' if self.pattern || self.orients => None,
            b'F' | b'E' => None,
            Word::ANGLE => Some(self.angle),
            letter => self.decimals(letter),
        }
    }
}

/// Reads the numbers of a block: a length or an angle without a point counts increments, where the control does.
///
/// # Errors
/// A feed per turn, or a lead, without a point: controls differ in what it counts.
pub fn count(words: &mut [Word], setting: Setting) -> Result<(), Alarm> {
    if !setting.counts_increments {
        return Ok(());
    }
    let block = Block::of(words, setting);
    let stroke = block.alone && matches!(block.motion, 32 | 34 | 92);
    let lead = stroke || block.thread || block.taps;
    for word in words {
        let Given::Written(number) = word.given else {
            continue;
        };
        if number.has_point() || number.mantissa() == 0 {
            continue;
        }
        let per_turn = lead || block.per_turn;
        let is_feed = matches!(word.letter, b'F' | b'E') && per_turn;
        let is_change = word.letter == b'K' && stroke && block.motion == 34;
        if (is_feed || is_change) && !block.arguments && !block.dwell {
            return Err(word.alarm(Code::FeedWithoutPoint));
        }
        if let Some(decimals) = block.counted(word.letter) {
            word.given = Given::Written(Decimal::new(number.mantissa(), decimals));
        }
    }
    Ok(())
}

/// Rounds numbers that have more digits than the increment; what is to be told of the first.
pub fn round(words: &mut [Word], setting: Setting) -> Option<Alarm> {
    let is_long = |word: &Word| match word.given {
        Given::Written(number) => number.decimals() > 3,
        Given::Calculated(_) => false,
    };
    if !words.iter().any(is_long) {
        return None;
    }
    let block = Block::of(words, setting);
    let mut told = None;
    for word in words {
        let Given::Written(number) = word.given else {
            continue;
        };
        let Some(decimals) = block.decimals(word.letter) else {
            continue;
        };
        if let Some(count) = rounded(number, decimals) {
            word.given = Given::Written(Decimal::new(count, decimals));
            let used = [Arg::Decimal(count, decimals)];
            told.get_or_insert(word.alarm(Code::DigitsRounded).with(used));
        }
    }
    told
}

/// The number in steps of `decimals`, halves away from zero; `None` where it is a whole count of them.
fn rounded(number: Decimal, decimals: u8) -> Option<i64> {
    let beyond = number.decimals().checked_sub(decimals).filter(|n| *n > 0)?;
    let step = 10_i128.pow(u32::from(beyond));
    let mantissa = i128::from(number.mantissa());
    if mantissa % step == 0 {
        return None;
    }
    let away = mantissa.signum() * (step / 2);
    i64::try_from((mantissa + away) / step).ok()
}
