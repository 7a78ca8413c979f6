//! Where a block of a line begins and ends.

use super::{comment_end, parenthesis, trimmed};

/// One block of a line, as bytes of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Its end: that of the line, or its `;`.
    pub end: usize,
    /// The front of the next block of the line.
    pub next: Option<usize>,
    /// The parenthesis of a comment that has no end in this line, and how deep it is.
    pub open: Option<(usize, u32)>,
}

/// The block that begins at byte `from` of a line.
#[must_use]
pub fn piece(text: &[u8], from: usize) -> Piece {
    let mut at = from;
    while let Some(byte) = text.get(at) {
        match parenthesis(&text[at..]) {
            Some((bytes, true)) => match comment_end(text, at + bytes, 1) {
                Ok(after) => at = after,
                Err(depth) => {
                    return Piece {
                        end: text.len(),
                        next: None,
                        open: Some((at, depth)),
                    };
                }
            },
            _ if *byte == b';' => {
                let next = at + 1;
                return Piece {
                    end: at,
                    next: (begins_block(&text[next..]) && next < text.len()).then_some(next),
                    open: None,
                };
            }
            _ => at += 1,
        }
    }
    Piece {
        end: text.len(),
        next: None,
        open: None,
    }
}

/// Statements that begin with letters, and what must follow these for a statement.
const STATEMENTS: [(&str, &[u8]); 5] = [
    ("IF", b"["),
    ("WHILE", b"["),
    ("GOTO", b"0123456789#["),
    ("DO", b"0123456789"),
    ("END", b"0123456789"),
];

/// True where text after a `;` is another block. Other text is a comment up to the end of the line.
#[must_use]
pub fn begins_block(text: &[u8]) -> bool {
    let rest = trimmed(text);
    match rest {
        [] | [b'(' | b')' | b'%' | b'/' | b';', ..] | [0xEF, 0xBC, 0x88 | 0x89, ..] => true,
        [b'#', tail @ ..] => matches!(trimmed(tail), [b'0'..=b'9' | b'[' | b'#', ..]),
        [b':', tail @ ..] => matches!(tail, [b'0'..=b'9', ..]),
        [b'<', tail @ ..] => matches!(tail, [b'O' | b'o', b'0'..=b'9', ..]),
        [letter, tail @ ..] if letter.is_ascii_alphabetic() => {
            let value = trimmed(tail);
            matches!(value, [b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' | b'[', ..])
                || STATEMENTS.iter().any(|(word, follows)| {
                    starts_with_word(rest, word)
                        && trimmed(&rest[word.len()..])
                            .first()
                            .is_some_and(|byte| follows.contains(byte))
                })
        }
        _ => false,
    }
}

fn starts_with_word(text: &[u8], word: &str) -> bool {
    text.get(..word.len())
        .is_some_and(|front| front.eq_ignore_ascii_case(word.as_bytes()))
}
