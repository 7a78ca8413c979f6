//! Bytes in, blocks out: one pass over the line, words straight into the slots of a [`Block`].
//!
//! A word is a letter and a number without a space between. `( … )`, also in full-width characters as the Chinese sheets
//! print it, is a comment and nests; it may go on past the end of the line where no block is open in front of it, since
//! the sheets print long remarks after the `;` this way. Columns count bytes from 1.

use super::block::Block;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::units::Decimal;

/// Longest line in bytes, its line feed not counted.
pub const MAX_LINE: usize = 1024;

/// The end of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    /// `;`: more may follow in the line.
    Block,
    /// The end of the line.
    Line,
    /// `%` at the end of the program text.
    Text,
}

/// How far a comment was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Inside {
    /// Up to its closing parenthesis.
    Closed,
    /// Up to a line feed, still open.
    LineEnd,
    /// Up to the end of the text, still open.
    TextEnd,
}

/// A comment that goes on over the end of a line.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Comment {
    depth: u32,
    opened: Span,
}

impl Comment {
    /// The place of the parenthesis that is still open.
    pub(crate) const fn open(&self) -> Option<Span> {
        if self.depth == 0 {
            None
        } else {
            Some(self.opened)
        }
    }
}

/// A place in the text of one line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cursor<'t> {
    rest: &'t [u8],
    len: usize,
    line: u32,
    cut: bool,
}

impl<'t> Cursor<'t> {
    /// The front of line `line`; the line may reach up to the first line feed of `text` or, without one, to its end.
    /// A line that is longer than [`MAX_LINE`] is read that far and then refused.
    #[inline]
    pub(crate) fn new(text: &'t [u8], line: u32) -> Self {
        let (rest, cut) = match text.get(MAX_LINE) {
            None => (text, false),
            Some(b'\n') => (text.get(..=MAX_LINE).unwrap_or(text), false),
            Some(_) => (text.get(..MAX_LINE).unwrap_or(text), true),
        };
        Self {
            rest,
            len: rest.len(),
            line,
            cut,
        }
    }

    /// The front of a line of which `text` is only the beginning.
    pub(crate) fn cut(text: &'t [u8], line: u32) -> Self {
        Self {
            rest: text,
            len: text.len(),
            line,
            cut: true,
        }
    }

    /// Bytes read so far.
    #[inline]
    pub(crate) const fn consumed(&self) -> usize {
        self.len.wrapping_sub(self.rest.len())
    }

    /// True where all of the text is read.
    pub(crate) const fn is_done(&self) -> bool {
        self.rest.is_empty()
    }

    /// Place of the next byte.
    pub(crate) const fn here(&self) -> Span {
        let column = self.column_of(self.rest);
        Span {
            line: self.line,
            column,
            end: column.saturating_add(1),
        }
    }

    #[inline]
    const fn column_of(&self, rest: &[u8]) -> u16 {
        // At most MAX_LINE + 2.
        self.len.wrapping_sub(rest.len()).wrapping_add(1) as u16
    }

    #[cold]
    fn alarm(&self, code: Code) -> Alarm {
        Alarm::new(code, self.here())
    }

    /// Reads one block. `start` is true while only `%` and comments have been read of the program.
    #[inline]
    pub(crate) fn block(
        &mut self,
        block: &mut Block,
        comment: &mut Comment,
        skip: bool,
        start: bool,
    ) -> Result<Ended, Alarm> {
        block.clear(self.line);
        if comment.depth != 0 {
            match self.comment(comment) {
                Inside::Closed => {}
                Inside::LineEnd => return Ok(Ended::Line),
                Inside::TextEnd => return self.end(),
            }
        }
        // The place is kept in a local, and in `self` only where it leaves this loop.
        let mut rest = self.rest;
        while let [byte, tail @ ..] = rest {
            // Clearing bit 5 makes a small letter a capital one, and no other byte a letter.
            let letter = byte & 0xDF;
            if letter.wrapping_sub(b'A') < 26 {
                let column = self.column_of(rest);
                let (value, after) = Decimal::parse(tail);
                if value.digits().wrapping_sub(1) >= Decimal::MAX_DIGITS
                    || matches!(after, [b'.', ..])
                {
                    return Err(self.bad_number(letter, value, column, after));
                }
                block.add(letter, value, column, self.column_of(after))?;
                rest = after;
                continue;
            }
            match *byte {
                b' ' | b'\t' => rest = tail,
                b'\n' => {
                    self.rest = tail;
                    return Ok(Ended::Line);
                }
                b';' => {
                    self.rest = tail;
                    return Ok(Ended::Block);
                }
                _ => {
                    self.rest = rest;
                    if let Some(ended) = self.sign(block, comment, skip, start)? {
                        return Ok(ended);
                    }
                    rest = self.rest;
                }
            }
        }
        self.rest = rest;
        self.end()
    }

    /// Reads anything other than a word, a space or the end of a block.
    #[cold]
    fn sign(
        &mut self,
        block: &mut Block,
        comment: &mut Comment,
        skip: bool,
        start: bool,
    ) -> Result<Option<Ended>, Alarm> {
        match self.rest {
            [b'(', ..] | [0xEF, 0xBC, 0x88, ..] => {
                let opened = self.here();
                *comment = Comment { depth: 0, opened };
                let ended = match self.comment(comment) {
                    Inside::Closed => return Ok(None),
                    Inside::LineEnd => Ended::Line,
                    Inside::TextEnd => self.end()?,
                };
                if !block.is_empty() {
                    return Err(Alarm::new(Code::CommentOpen, opened));
                }
                Ok(Some(ended))
            }
            [b')', ..] | [0xEF, 0xBC, 0x89, ..] => Err(self.alarm(Code::CommentClosed)),
            [b'\r', b'\n', tail @ ..] => {
                self.rest = tail;
                Ok(Some(Ended::Line))
            }
            [b'\r'] if !self.cut => {
                self.rest = &[];
                Ok(Some(Ended::Line))
            }
            [b'/', tail @ ..] => {
                if !block.has_no_lead() {
                    return Err(self.alarm(Code::SkipNotFirst));
                }
                self.rest = tail;
                if skip {
                    self.skip_block(block, comment).map(Some)
                } else {
                    Ok(None)
                }
            }
            [b'%', tail @ ..] => {
                if !block.is_empty() {
                    return Err(self.alarm(Code::PercentInBlock));
                }
                self.rest = tail;
                Ok(if start { None } else { Some(Ended::Text) })
            }
            [b'#' | b'[' | b']' | b'=' | b'*', ..] => Err(self.alarm(Code::MacroNotAvailable)),
            [0, ..] | [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Err(self.alarm(Code::WideText)),
            [0x80..=0xFF, ..] => Err(self.alarm(Code::NotAscii)),
            _ => Err(self.alarm(Code::UnknownCharacter)),
        }
    }

    /// The end of the text of the line.
    fn end(&self) -> Result<Ended, Alarm> {
        if self.cut {
            let args = [Arg::Int(MAX_LINE as i64), Arg::None, Arg::None, Arg::None];
            return Err(self.alarm(Code::LineTooLong).with(args));
        }
        Ok(Ended::Line)
    }

    /// Goes on in a comment, from its parenthesis or from the front of a line.
    fn comment(&mut self, comment: &mut Comment) -> Inside {
        loop {
            match self.rest {
                [] => return Inside::TextEnd,
                [b'\n', tail @ ..] => {
                    self.rest = tail;
                    return Inside::LineEnd;
                }
                [b'(', tail @ ..] | [0xEF, 0xBC, 0x88, tail @ ..] => {
                    self.rest = tail;
                    comment.depth = comment.depth.saturating_add(1);
                }
                [b')', tail @ ..] | [0xEF, 0xBC, 0x89, tail @ ..] => {
                    self.rest = tail;
                    comment.depth = comment.depth.saturating_sub(1);
                    if comment.depth == 0 {
                        return Inside::Closed;
                    }
                }
                [_, tail @ ..] => self.rest = tail,
            }
        }
    }

    /// Passes over the rest of a block that is skipped; only its comments matter.
    fn skip_block(&mut self, block: &mut Block, comment: &mut Comment) -> Result<Ended, Alarm> {
        block.clear(self.line);
        loop {
            match self.rest {
                [] => return self.end(),
                [b'\n', tail @ ..] => {
                    self.rest = tail;
                    return Ok(Ended::Line);
                }
                [b';', tail @ ..] => {
                    self.rest = tail;
                    return Ok(Ended::Block);
                }
                [b'(', ..] | [0xEF, 0xBC, 0x88, ..] => {
                    let opened = self.here();
                    *comment = Comment { depth: 0, opened };
                    match self.comment(comment) {
                        Inside::Closed => {}
                        Inside::LineEnd => return Err(Alarm::new(Code::CommentOpen, opened)),
                        Inside::TextEnd => {
                            self.end()?;
                            return Err(Alarm::new(Code::CommentOpen, opened));
                        }
                    }
                }
                [_, tail @ ..] => self.rest = tail,
            }
        }
    }

    #[cold]
    fn bad_number(&self, letter: u8, value: Decimal, column: u16, rest: &[u8]) -> Alarm {
        let code = if value.digits() == 0 {
            // `X#100`, `X[…]`: a macro, not a typing mistake.
            if matches!(rest, [b'#' | b'[', ..]) {
                Code::MacroNotAvailable
            } else if matches!(rest, [0, ..]) {
                Code::WideText
            } else {
                Code::NumberMissing
            }
        } else if value.digits() > Decimal::MAX_DIGITS {
            Code::NumberTooLong
        } else {
            Code::SecondPoint
        };
        let span = Span {
            line: self.line,
            column,
            end: self.column_of(rest),
        };
        let figure = match code {
            Code::NumberMissing => slip(letter, rest),
            _ => i64::from(Decimal::MAX_DIGITS),
        };
        let args = [Arg::Int(figure), Arg::None, Arg::None, Arg::None];
        Alarm::new(code, span).word(letter).with(args)
    }
}

/// A letter O stands for the digit 0.
pub const LETTER_O: i64 = 1;
/// Letters that follow one another: a remark, or a word of another language.
pub const LETTERS: i64 = 2;

/// Why a letter has no number, as the figure of [`Code::NumberMissing`]; `rest` is what stands behind it.
#[must_use]
pub fn slip(letter: u8, rest: &[u8]) -> i64 {
    let is_code = matches!(letter, b'G' | b'M');
    match rest {
        [b'O' | b'o', next, ..] if next.is_ascii_alphabetic() && !is_code => LETTERS,
        [b'O' | b'o', ..] => LETTER_O,
        // A letter with a number of its own is the next word.
        [next, b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' | b'[', ..]
            if next.is_ascii_alphabetic() =>
        {
            0
        }
        [next, ..] if next.is_ascii_alphabetic() => LETTERS,
        _ if letter == b'O' => LETTER_O,
        _ => 0,
    }
}
