//! A program passed over without carrying anything out: where its blocks, numbers and loops are.
//!
//! Searches use it: for a block number, for a program, for the end of a loop. This module must not know what the search is
//! for.

use std::io;

use leadscrew_core::alarm::Span;

use crate::lines::{Lines, Place, Source};
use crate::statement::{Statement, head, statement};
use crate::text::{Cursor, comment_end, parenthesis, piece, trimmed};
use crate::whose::Whose;

/// The begin or the end of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// DO, with or without WHILE.
    Do(u8),
    /// END.
    End(u8),
}

/// One block, from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outline {
    /// Where it begins.
    pub place: Place,
    /// Where the next begins.
    pub after: Place,
    /// Its statement, from the first byte on.
    pub span: Span,
    /// The number of a program that begins here.
    pub program: Option<u32>,
    /// N.
    pub sequence: Option<u32>,
    /// The loop that begins or ends here.
    pub mark: Option<Mark>,
}

/// Passes over blocks.
#[derive(Clone, Copy, Debug)]
pub struct Scanner {
    at: Place,
    /// How many comments are open.
    depth: u32,
    /// A block has come.
    started: bool,
}

impl Scanner {
    /// From the front of a file.
    #[must_use]
    pub const fn of(file: Whose) -> Self {
        Self {
            at: Place::start_of(file),
            depth: 0,
            started: false,
        }
    }

    /// From the front of a block.
    #[must_use]
    pub const fn from(at: Place) -> Self {
        Self {
            at,
            depth: 0,
            started: true,
        }
    }

    /// The next block that is not empty; `None` at the end of the text, which may be a `%`.
    ///
    /// # Errors
    /// The text cannot be read.
    pub fn next<S: Source>(&mut self, lines: &mut Lines<S>) -> io::Result<Option<Outline>> {
        loop {
            if !self.started {
                self.at = behind_leader(lines, self.at)?;
            }
            let Some(line) = lines.line(self.at)? else {
                return Ok(None);
            };
            let text = line.text;
            if self.depth > 0 {
                match comment_end(text, self.at.column, self.depth) {
                    Ok(after) => (self.at.column, self.depth) = (after, 0),
                    Err(depth) => {
                        (self.at, self.depth) = (line.next, depth);
                        continue;
                    }
                }
            }
            let piece = piece(text, self.at.column);
            let place = self.at;
            self.at = piece.next.map_or(line.next, |next| place.in_line(next));
            self.depth = piece.open.map_or(0, |(_, depth)| depth);
            let mut cursor = Cursor::new(place.line, &text[..piece.end], place.column);
            let mut place = place;
            while cursor.take(b'%') {
                if self.started {
                    return Ok(None);
                }
                place = place.in_line(cursor.at());
            }
            if cursor.is_done() {
                continue;
            }
            self.started = true;
            return Ok(Some(self.outline(place, cursor)));
        }
    }

    fn outline(&self, place: Place, mut cursor: Cursor<'_>) -> Outline {
        let head = head(&mut cursor);
        let mut outline = Outline {
            place,
            after: self.at,
            span: cursor.here(),
            program: None,
            sequence: head.sequence.map(|(number, ..)| number),
            mark: None,
        };
        match statement(&mut cursor) {
            Statement::Program(number) => outline.program = Some(number),
            Statement::While => {
                pass_brackets(&mut cursor);
                if cursor.take_word("DO") {
                    outline.mark = number(&mut cursor).map(Mark::Do);
                }
            }
            Statement::Do => outline.mark = number(&mut cursor).map(Mark::Do),
            Statement::End => outline.mark = number(&mut cursor).map(Mark::End),
            _ => {}
        }
        outline
    }
}

/// Lines of a leader.
const LEADER: usize = 64;

/// The place where a file begins that is read from `at` on: what stands in front of the first `%` is the leader of a tape,
/// where a name or a remark may be written, and no control reads it. A line that could be a block is none of it. Any place
/// but the front of a file stays.
///
/// # Errors
/// The text cannot be read.
pub fn behind_leader<S: Source>(lines: &mut Lines<S>, at: Place) -> io::Result<Place> {
    let mut front = at;
    if at != Place::start_of(at.file()) {
        return Ok(at);
    }
    for _ in 0..LEADER {
        let Some(line) = lines.line(front)? else {
            break;
        };
        let next = line.next;
        match behind_controls(line.text) {
            text @ [b'%', ..] => return Ok(front.in_line(line.text.len() - text.len())),
            text if may_be_block(text) => break,
            _ => {}
        }
        front = next;
    }
    Ok(at)
}

/// A line without the blanks and the codes of a tape punch at its front.
fn behind_controls(text: &[u8]) -> &[u8] {
    let blank = |byte: &u8| *byte == b' ' || byte.is_ascii_control();
    let front = text.iter().take_while(|byte| blank(byte)).count();
    &text[front..]
}

/// True for a line that could be a block or a comment: it begins with neither two letters nor a letter of another script.
fn may_be_block(text: &[u8]) -> bool {
    match text {
        [] => false,
        _ if parenthesis(text).is_some() => true,
        [first, rest @ ..] if first.is_ascii_alphabetic() => {
            !trimmed(rest).first().is_some_and(u8::is_ascii_alphabetic)
        }
        [first, ..] => first.is_ascii(),
    }
}

/// True where the program stands in this file behind the `%` that ends its text.
///
/// # Errors
/// The text cannot be read.
pub fn is_behind_end<S: Source>(
    lines: &mut Lines<S>,
    file: Whose,
    number: u32,
) -> io::Result<bool> {
    let mut scanner = Scanner::of(file);
    while scanner.next(lines)?.is_some() {}
    while lines.line(scanner.at)?.is_some() {
        let block = scanner.next(lines)?;
        if block.is_some_and(|block| block.program == Some(number)) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The number of a loop.
fn number(cursor: &mut Cursor<'_>) -> Option<u8> {
    let number = std::str::from_utf8(cursor.digits()).ok()?.parse().ok()?;
    (1..=3).contains(&number).then_some(number)
}

/// Passes over an expression in brackets.
fn pass_brackets(cursor: &mut Cursor<'_>) {
    let mut depth = 0_usize;
    while let Some(byte) = cursor.peek() {
        match byte {
            b'[' => depth += 1,
            b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        cursor.advance();
        if depth == 0 {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_seen_from_outside() {
        let text = "%\nO0001 (MAIN)\n(N5 in a\ncomment) N10 #1=0; WHILE[[#1]LT3]DO1\n/N20 G0 X1;;\nEND1\n<O2>\nM99\n%\nN30\n";
        let mut lines = Lines::new(text.as_bytes());
        let mut scanner = Scanner::of(Whose::Program);
        let mut found = Vec::new();
        while let Some(block) = scanner.next(&mut lines).unwrap() {
            found.push((block.place.line, block.program, block.sequence, block.mark));
        }
        assert_eq!(
            found,
            [
                (2, Some(1), None, None),
                (4, None, Some(10), None),
                (4, None, None, Some(Mark::Do(1))),
                (5, None, Some(20), None),
                (6, None, None, Some(Mark::End(1))),
                (7, Some(2), None, None),
                (8, None, None, None),
            ]
        );
    }
}
