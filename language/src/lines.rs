//! The lines of a program, read from places of its text as they are wanted.
//!
//! Memory holds one window of the text, whatever its length: a jump reads the text again from the place it goes to, and a
//! place carries its own byte, so there is no table of lines. This module must not know what stands in a line.

use std::io;

use leadscrew_core::program::MAX_LINE;

use crate::whose::{Whose, line_in_file};

/// A text that can be read again. Its lines end with line feeds.
pub trait Source {
    /// Reads bytes of the text from byte `at` on into `buffer`, which is not empty; 0 bytes at the end of the text.
    ///
    /// # Errors
    /// The text cannot be read there.
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize>;

    /// Turns to another file of the program: from then on its bytes are read. At first it is that of the program. False
    /// where there is no such file; the one before then stays.
    ///
    /// # Errors
    /// The file is there, and cannot be read.
    fn turn_to(&mut self, file: Whose) -> io::Result<bool> {
        Ok(file == Whose::Program)
    }
}

impl Source for &[u8] {
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = usize::try_from(at).ok().and_then(|at| self.get(at..));
        let rest = rest.unwrap_or_default();
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }
}

impl<S: Source> Source for &mut S {
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        (**self).read(at, buffer)
    }

    fn turn_to(&mut self, file: Whose) -> io::Result<bool> {
        (**self).turn_to(file)
    }
}

/// A place in the text of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// The line, from 1; it tells the file, too ([`Whose`]).
    pub line: u32,
    /// The first byte of the line in its file.
    pub byte: u64,
    /// The byte in the line.
    pub column: usize,
}

impl Place {
    /// The front of the program's file.
    pub const START: Self = Self::start_of(Whose::Program);

    /// The front of a file.
    #[must_use]
    pub const fn start_of(file: Whose) -> Self {
        Self {
            line: file.first_line(),
            byte: 0,
            column: 0,
        }
    }

    /// The file it is in.
    #[must_use]
    pub const fn file(self) -> Whose {
        Whose::line(self.line)
    }

    /// True where this place comes earlier in the text of the same file.
    #[must_use]
    pub const fn is_before(self, other: Self) -> bool {
        self.byte < other.byte || (self.byte == other.byte && self.column < other.column)
    }

    /// Another byte of the same line.
    #[must_use]
    pub const fn in_line(self, column: usize) -> Self {
        Self { column, ..self }
    }
}

/// One line, without its line feed.
#[derive(Clone, Copy, Debug)]
pub struct Line<'t> {
    /// Its text. Of a line that is too long, one byte more than a line may have.
    pub text: &'t [u8],
    /// The front of the next line.
    pub next: Place,
}

/// The mark some editors put at the front of a text.
const MARK: &[u8] = "\u{feff}".as_bytes();

/// Bytes of a line up to which its end is looked for: whatever is longer is no program, and may have no end at all.
pub const LONGEST: u64 = 64 << 20;

/// Bytes of the window.
const WINDOW: usize = 1 << 16;

/// Reads lines of a text.
#[derive(Debug)]
pub struct Lines<S> {
    source: S,
    /// The file that is read.
    file: Whose,
    window: Vec<u8>,
    /// The first byte of the text that is in the window.
    first: u64,
    filled: usize,
    /// The window reaches the end of the text.
    at_end: bool,
}

impl<S: Source> Lines<S> {
    /// Before anything is read.
    #[must_use]
    pub fn new(source: S) -> Self {
        Self {
            source,
            file: Whose::Program,
            window: vec![0; WINDOW],
            first: 0,
            filled: 0,
            at_end: false,
        }
    }

    /// True where this file is there; it is then the one that is read.
    ///
    /// # Errors
    /// The file is there, and cannot be read.
    pub fn has(&mut self, file: Whose) -> io::Result<bool> {
        if file == self.file {
            return Ok(true);
        }
        let there = self.source.turn_to(file)?;
        if there {
            self.file = file;
            self.go_to(0);
        }
        Ok(there)
    }

    /// The line at a place, from its front; `None` at the end of the text.
    ///
    /// # Errors
    /// The text cannot be read, or has a line that is no line of a program: of more than 64 MB.
    pub fn line(&mut self, at: Place) -> io::Result<Option<Line<'_>>> {
        if !self.has(at.file())? {
            return Err(io::ErrorKind::NotFound.into());
        }
        let mut begin = match at.byte.checked_sub(self.first) {
            Some(begin) if begin <= self.filled as u64 => begin as usize,
            _ => self.go_to(at.byte),
        };
        let mut feed = self.feed(begin);
        while feed.is_none() && !self.at_end && self.filled - begin <= MAX_LINE + MARK.len() {
            begin = self.refill(begin)?;
            feed = self.feed(begin);
        }
        if begin == self.filled {
            return Ok(None);
        }
        let (end, next) = match feed {
            Some(feed) => (feed, at.byte + (feed - begin) as u64 + 1),
            None => (self.filled, self.after_feed(at.byte)?),
        };
        // The search for the end of a long line may have moved the window.
        if at.byte < self.first {
            begin = self.go_to(at.byte);
            while !self.at_end && self.filled <= MAX_LINE + MARK.len() {
                begin = self.refill(begin)?;
            }
        }
        let end = end.min(self.filled);
        let mut text = &self.window[begin..end];
        if let Some(rest) = text
            .strip_prefix(MARK)
            .filter(|_| line_in_file(at.line) == 1)
            // The core passes over one, too; a second one is a mistake.
            .filter(|rest| !rest.starts_with(MARK))
        {
            text = rest;
        }
        let next = Place {
            line: (at.line + 1).min(at.file().last_line()),
            byte: next,
            column: 0,
        };
        Ok(Some(Line {
            text: &text[..text.len().min(MAX_LINE + 1)],
            next,
        }))
    }

    /// The first line feed from `begin` on.
    fn feed(&self, begin: usize) -> Option<usize> {
        let feed = memchr::memchr(b'\n', &self.window[begin..self.filled]);
        feed.map(|feed| begin + feed)
    }

    /// Empties the window and puts it at a byte of the text.
    fn go_to(&mut self, byte: u64) -> usize {
        (self.first, self.filled, self.at_end) = (byte, 0, false);
        0
    }

    /// Keeps the window from `begin` on and reads once, because a text may come slowly; gives the new place of `begin`.
    fn refill(&mut self, begin: usize) -> io::Result<usize> {
        self.window.copy_within(begin..self.filled, 0);
        self.first += begin as u64;
        self.filled -= begin;
        let at = self.first + self.filled as u64;
        match self.source.read(at, &mut self.window[self.filled..]) {
            Ok(0) => self.at_end = true,
            Ok(count) => self.filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        Ok(0)
    }

    /// The byte after the first line feed from `byte` on, or the end of the text.
    ///
    /// # Errors
    /// [`io::ErrorKind::FileTooLarge`] where there is none in [`LONGEST`] bytes.
    fn after_feed(&mut self, byte: u64) -> io::Result<u64> {
        let mut begin = (byte - self.first) as usize;
        loop {
            if let Some(feed) = self.feed(begin) {
                return Ok(self.first + feed as u64 + 1);
            }
            let read = self.first + self.filled as u64;
            if self.at_end {
                return Ok(read);
            }
            if read - byte > LONGEST {
                return Err(io::ErrorKind::FileTooLarge.into());
            }
            begin = self.filled;
            begin = self.refill(begin)?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Gives a few bytes at a time.
    struct Slow<'t>(&'t [u8], usize);

    impl Source for Slow<'_> {
        fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
            let most = buffer.len().min(self.1);
            self.0.read(at, &mut buffer[..most])
        }
    }

    #[test]
    fn lines_come_in_any_order() {
        leadscrew_seed::volume(5, lines_in_any_order);
    }

    fn lines_in_any_order(seed: u64) {
        let mut random = Random(seed);
        let mut text = Vec::new();
        let mut lines = Vec::new();
        for number in 0..4000 {
            let length = match random.below(50) {
                0 => 70_000,
                1 => MAX_LINE + random.below(4),
                _ => random.below(60),
            };
            let line = format!("{number}{}", "x".repeat(length));
            lines.push((text.len() as u64, line.clone()));
            text.extend_from_slice(line.as_bytes());
            text.push(b'\n');
        }
        text.pop();
        for size in [7, 4096, 1 << 20] {
            let mut read = Lines::new(Slow(&text, size));
            let count = if size == 7 { 200 } else { 20_000 };
            let mut index = 0;
            for _ in 0..count {
                let (byte, expected) = &lines[index];
                let at = Place {
                    line: index as u32 + 1,
                    byte: *byte,
                    column: 0,
                };
                let line = read.line(at).unwrap().expect("a line");
                let shown = expected.len().min(MAX_LINE + 1);
                assert_eq!(line.text, &expected.as_bytes()[..shown], "{index}");
                let after = lines
                    .get(index + 1)
                    .map_or(text.len() as u64, |next| next.0);
                assert_eq!((line.next.byte, line.next.line), (after, at.line + 1));
                let next = line.next;
                index += 1;
                if index == lines.len() {
                    assert!(read.line(next).unwrap().is_none());
                }
                if random.below(5) == 0 || index == lines.len() {
                    index = random.below(lines.len());
                }
            }
        }
    }

    #[test]
    fn the_mark_of_an_editor_is_no_part_of_the_first_line() {
        let text = "\u{feff}G0\n\u{feff}G1".as_bytes();
        let mut read = Lines::new(text);
        let first = read.line(Place::START).unwrap().unwrap();
        assert_eq!(first.text, b"G0");
        let next = first.next;
        let second = read.line(next).unwrap().unwrap();
        assert_eq!(second.text, "\u{feff}G1".as_bytes());
    }

    #[test]
    fn a_text_without_bytes_has_no_line() {
        let mut read = Lines::new(&b""[..]);
        assert!(read.line(Place::START).unwrap().is_none());
        let mut read = Lines::new(&b"\n"[..]);
        let first = read.line(Place::START).unwrap().unwrap();
        assert!(first.text.is_empty());
        let next = first.next;
        assert!(read.line(next).unwrap().is_none());
    }
}
