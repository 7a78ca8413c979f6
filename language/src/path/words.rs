//! The words that ask for a side of the path or for a corner. The core does not know them.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::offsets::Source;
use leadscrew_core::program::Event;
use leadscrew_core::units::Length;

use super::corners::Asked;
use super::{Path, nose_of};
use crate::corner::{Corner, Toward};
use crate::nose::Side;
use crate::roughing::Unit;
use crate::word::Word;

/// The words of a block that are left, and a message.
pub struct Taken {
    /// For the core.
    pub words: Vec<Word>,
    /// For the operator, before the block.
    pub warning: Option<Event>,
}

impl Path {
    /// Takes G40 to G42 and the corner out of a block. `acts`: a side comes into force, which it does not in the contour of
    /// G71 to G73.
    ///
    /// # Errors
    /// Two sides or two corners in a block; a corner without a size.
    pub fn take(
        &mut self,
        words: &[Word],
        unit: Unit,
        acts: bool,
        offset: u16,
        offsets: Source<'_>,
    ) -> Result<Taken, Alarm> {
        let mut taken = Taken {
            words: Vec::with_capacity(words.len()),
            warning: None,
        };
        let mut seen: Option<Word> = None;
        for word in words {
            if let Some(side) = side(word) {
                if let Some(other) = seen.replace(*word) {
                    let codes = [other, *word].map(|word| {
                        let code = word.value().whole().unwrap_or(0);
                        Arg::GCode(u16::try_from(code * 10).unwrap_or(0))
                    });
                    return Err(word.alarm(Code::GroupTwice).with(codes));
                }
                if acts {
                    self.side = side;
                    if side != Side::None && nose_of(offset, offsets).radius == Length::ZERO {
                        let number = [Arg::Int(i64::from(offset % 100))];
                        let warning = word.alarm(Code::NoseRadiusMissing).with(number);
                        taken.warning = Some(Event::Warning(warning));
                    }
                }
            } else if is_corner(word) {
                if self.corner.is_some() {
                    return Err(word.alarm(Code::WordTwice));
                }
                let written = unit.length(word)?.value;
                let has_sign = matches!(word.letter, Word::CHAMFER_TOWARD | Word::ROUND_TOWARD);
                let size = if has_sign { written.abs() } else { written };
                if size <= Length::ZERO {
                    return Err(word.alarm(Code::CornerTooLong));
                }
                let corner = match word.letter {
                    Word::CHAMFER_L if !offsets.params.corner_l_by_legs() => {
                        Corner::ChamferLine(size)
                    }
                    Word::CHAMFER | Word::CHAMFER_L | Word::CHAMFER_TOWARD => Corner::Chamfer(size),
                    _ => Corner::Round(size),
                };
                let plus = written > Length::ZERO;
                let along_z = words.iter().any(|word| matches!(word.letter, b'Z' | b'W'));
                let toward = has_sign.then_some(if along_z {
                    Toward::X(plus)
                } else {
                    Toward::Z(plus)
                });
                self.corner = Some(Asked {
                    corner,
                    toward,
                    span: word.span,
                });
            } else {
                taken.words.push(*word);
            }
        }
        Ok(taken)
    }
}

/// True for a word that is taken out.
pub fn is_word(word: &Word) -> bool {
    is_corner(word) || side(word).is_some()
}

/// True for the word of a corner.
fn is_corner(word: &Word) -> bool {
    matches!(
        word.letter,
        Word::CHAMFER | Word::ROUND | Word::CHAMFER_L | Word::CHAMFER_TOWARD | Word::ROUND_TOWARD
    )
}

/// The side that a word asks for.
fn side(word: &Word) -> Option<Side> {
    if word.letter != b'G' {
        return None;
    }
    Some(match word.value().whole()? {
        40 => Side::None,
        41 => Side::Left,
        42 => Side::Right,
        _ => return None,
    })
}
