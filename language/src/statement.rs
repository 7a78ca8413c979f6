//! What one block is: a statement of macro B or of program flow, words, or text that the core reads by itself.
//!
//! Only the front of the block is read here; expressions are calculated when the statement is carried out. This module
//! must not know variables, loops or calls.

use crate::text::{Cursor, Glance, glance};

/// What stands in front of a statement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// `/`, with or without a number: the block may be passed over.
    pub skip: bool,
    /// The byte after a `/` with a number, which the core does not read.
    pub numbered: Option<usize>,
    /// N, and the bytes of the line in which it stands.
    pub sequence: Option<(u32, usize, usize)>,
}

/// What a block is, from its head on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Statement {
    /// Nothing.
    Empty,
    /// `#i = …`; the cursor is at `#`.
    Assign,
    /// `IF [ … ] …`; the cursor is at the bracket.
    If,
    /// `GOTO n`; the cursor is after GOTO.
    Goto,
    /// `WHILE [ … ] DO m`; the cursor is at the bracket.
    While,
    /// `DO m`: the cursor is after DO.
    Do,
    /// `END m`; the cursor is after END.
    End,
    /// The number of a program: `O1`, `:1` or `<O1>`; the cursor is after it.
    Program(u32),
    /// DPRNT and what belongs to it; the cursor is after it.
    Print,
    /// Words without values that have to be calculated, and without calls.
    Plain,
    /// Words of which this module cannot say as much.
    Words,
}

/// Reads `/` and N, in any order.
pub fn head(cursor: &mut Cursor<'_>) -> Head {
    let mut head = Head::default();
    skips(cursor, &mut head);
    cursor.skip();
    let from = cursor.at();
    let mut ahead = *cursor;
    if ahead.take(b'N')
        && let Some(number) = number(&mut ahead)
    {
        *cursor = ahead;
        head.sequence = Some((number, from, cursor.at()));
        skips(cursor, &mut head);
    }
    head
}

fn skips(cursor: &mut Cursor<'_>, head: &mut Head) {
    while cursor.take(b'/') {
        head.skip = true;
        if matches!(cursor.rest(), [b'1'..=b'9', ..]) {
            cursor.advance();
            head.numbered = Some(cursor.at());
        }
    }
}

/// Tells what follows the head. The cursor goes to where the statement says.
pub fn statement(cursor: &mut Cursor<'_>) -> Statement {
    match cursor.peek() {
        None => Statement::Empty,
        Some(b'#') => Statement::Assign,
        Some(b'I') if cursor.take_word("IF") => Statement::If,
        Some(b'W') if cursor.take_word("WHILE") => Statement::While,
        Some(b'G') if cursor.take_word("GOTO") => Statement::Goto,
        Some(b'B' | b'D' | b'P') if prints(cursor) => Statement::Print,
        Some(b'D') if cursor.take_word("DO") => Statement::Do,
        Some(b'E') if cursor.take_word("END") => Statement::End,
        Some(b'O' | b'<' | b':') => match program(cursor) {
            Some(number) => Statement::Program(number),
            None => Statement::Words,
        },
        Some(_) => match glance(cursor.rest(), &mut 0) {
            Glance::Plain(_) => Statement::Plain,
            _ => Statement::Words,
        },
    }
}

/// Takes a statement that prints to a serial port.
fn prints(cursor: &mut Cursor<'_>) -> bool {
    let statements = ["DPRNT", "BPRNT", "POPEN", "PCLOS"];
    statements.into_iter().any(|word| cursor.take_word(word))
}

/// `O1`, `:1` or `<O1>`.
fn program(cursor: &mut Cursor<'_>) -> Option<u32> {
    let mut ahead = *cursor;
    let pointed = ahead.take(b'<');
    if pointed || ahead.peek() == Some(b'O') {
        if !ahead.take(b'O') {
            return None;
        }
    } else if !ahead.take(b':') {
        return None;
    }
    let number = number(&mut ahead)?;
    if pointed && !ahead.take(b'>') {
        return None;
    }
    *cursor = ahead;
    Some(number)
}

/// A number of one to eight digits without a point.
fn number(cursor: &mut Cursor<'_>) -> Option<u32> {
    let digits = cursor.digits();
    if digits.len() > 8 {
        return None;
    }
    std::str::from_utf8(digits).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Head, Statement, usize) {
        let mut cursor = Cursor::new(1, text.as_bytes(), 0);
        let head = head(&mut cursor);
        let statement = statement(&mut cursor);
        (head, statement, cursor.at())
    }

    #[test]
    fn the_front_of_a_block_tells_what_it_is() {
        for (text, statement, at) in [
            ("", Statement::Empty, 0),
            (" (note) ", Statement::Empty, 8),
            ("N5 #1=3", Statement::Assign, 3),
            ("if [#1EQ1] GOTO 5", Statement::If, 2),
            ("WHILE[1]DO1", Statement::While, 5),
            ("DO 1", Statement::Do, 2),
            ("/ END1", Statement::End, 5),
            ("GOTO#1", Statement::Goto, 4),
            ("O1234(NAME)", Statement::Program(1234), 5),
            ("<O12>", Statement::Program(12), 5),
            (":0007 G0 X1", Statement::Program(7), 5),
            ("G0 X1 (#1)", Statement::Plain, 0),
            ("G0 X#1", Statement::Words, 0),
            ("M98 P5", Statement::Words, 0),
            ("O1.5", Statement::Words, 0),
            ("O#1", Statement::Words, 0),
            ("O123456789", Statement::Words, 0),
        ] {
            let (_, found, place) = read(text);
            assert_eq!((found, place), (statement, at), "{text}");
        }
    }

    #[test]
    fn the_head_is_a_skip_and_a_number() {
        let head = |text| read(text).0;
        assert_eq!(head("N0010 G0").sequence, Some((10, 0, 5)));
        assert_eq!(head(" /2 N 7#1=2").sequence, Some((7, 4, 7)));
        let skipped = ["/M8", "/3 M8", "N5 /M8", "N5/2M8", "M8"].map(|text| {
            let head = head(text);
            (head.skip, head.numbered)
        });
        let (numbered, plain) = (|at| (true, Some(at)), (true, None));
        assert_eq!(
            skipped,
            [plain, numbered(2), plain, numbered(4), (false, None)]
        );
        assert_eq!(head("N1.5 G0").sequence, None);
        assert_eq!(head("N#1").sequence, None);
    }
}
