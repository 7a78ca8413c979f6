//! A place in a block, and the small things that can be read there.

use leadscrew_core::alarm::{Alarm, Code, Span};

use super::{comment_end, is_blank};

/// A place in one block. Spaces and comments are passed over before anything is read.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'t> {
    line: u32,
    /// The line from its front to the end of the block.
    text: &'t [u8],
    at: usize,
}

impl<'t> Cursor<'t> {
    /// Byte `at` of line `line`; `text` is this line up to the end of the block.
    #[must_use]
    pub const fn new(line: u32, text: &'t [u8], at: usize) -> Self {
        Self { line, text, at }
    }

    /// The number of the line.
    #[must_use]
    pub const fn line(&self) -> u32 {
        self.line
    }

    /// The byte of the line that is next, spaces and comments included.
    #[must_use]
    pub const fn at(&self) -> usize {
        self.at
    }

    /// What is left of the block.
    #[must_use]
    pub fn rest(&self) -> &'t [u8] {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Passes over spaces and comments. A comment without an end goes to the end of the block.
    pub fn skip(&mut self) {
        while let Some(byte) = self.text.get(self.at) {
            if is_blank(*byte) {
                self.at += 1;
            } else if matches!(super::parenthesis(self.rest()), Some((_, true))) {
                let bytes = super::parenthesis(self.rest()).map_or(1, |(bytes, _)| bytes);
                self.at = comment_end(self.text, self.at + bytes, 1).unwrap_or(self.text.len());
            } else {
                return;
            }
        }
    }

    /// The next byte after spaces and comments, a letter as a capital.
    pub fn peek(&mut self) -> Option<u8> {
        self.skip();
        self.text.get(self.at).map(u8::to_ascii_uppercase)
    }

    /// Goes on by one byte.
    pub fn advance(&mut self) {
        self.at = self.text.len().min(self.at + 1);
    }

    /// Takes this byte if it is the next.
    pub fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        if found {
            self.advance();
        }
        found
    }

    /// Takes this word of capitals if it is next, whatever follows it.
    pub fn take_word(&mut self, word: &str) -> bool {
        self.skip();
        let found = self
            .rest()
            .get(..word.len())
            .is_some_and(|next| next.eq_ignore_ascii_case(word.as_bytes()));
        if found {
            self.at += word.len();
        }
        found
    }

    /// Takes the letters up to the first other byte.
    pub fn letters(&mut self) -> &'t [u8] {
        self.skip();
        let rest = self.rest();
        let count = rest
            .iter()
            .take_while(|byte| byte.is_ascii_alphabetic())
            .count();
        self.at += count;
        &rest[..count]
    }

    /// Takes digits and points, as they are written.
    pub fn digits(&mut self) -> &'t [u8] {
        self.skip();
        let rest = self.rest();
        let count = rest
            .iter()
            .take_while(|byte| byte.is_ascii_digit() || **byte == b'.')
            .count();
        self.at += count;
        &rest[..count]
    }

    /// True where nothing but spaces and comments is left.
    pub fn is_done(&mut self) -> bool {
        self.peek().is_none()
    }

    /// The columns from byte `from` to this place.
    #[must_use]
    pub fn span_from(&self, from: usize) -> Span {
        span(self.line, from, self.at.max(from + 1))
    }

    /// The columns of the next byte after spaces and comments.
    pub fn here(&mut self) -> Span {
        self.skip();
        span(self.line, self.at, self.at + 1)
    }

    /// An alarm at the next byte after spaces and comments.
    #[cold]
    pub fn alarm(&mut self, code: Code) -> Alarm {
        Alarm::new(code, self.here())
    }
}

/// The columns of bytes `from` … `to` of a line.
#[must_use]
pub fn span(line: u32, from: usize, to: usize) -> Span {
    let column = |byte: usize| u16::try_from(byte + 1).unwrap_or(u16::MAX);
    Span {
        line,
        column: column(from),
        end: column(to),
    }
}
