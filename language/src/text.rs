//! The bytes of one line: what the core reads alone, where a block begins and ends, and a cursor in a block.
//!
//! Comments nest and may be written with full-width parentheses. After a `;` stands another block, or a comment up to the
//! end of the line where no word begins there. Columns count bytes from 1. This module must not know what a statement
//! means.

mod cursor;
mod glance;
mod piece;
#[cfg(test)]
mod tests;

pub use cursor::{Cursor, span};
pub use glance::{Glance, glance, has_blocks, number};
use piece::begins_block;
pub use piece::{Piece, piece};

/// The parenthesis at the front of `text`: its bytes, and true where it opens.
pub fn parenthesis(text: &[u8]) -> Option<(usize, bool)> {
    match text {
        [b'(', ..] => Some((1, true)),
        [b')', ..] => Some((1, false)),
        [0xEF, 0xBC, 0x88, ..] => Some((3, true)),
        [0xEF, 0xBC, 0x89, ..] => Some((3, false)),
        _ => None,
    }
}

/// The place after a comment that is `depth` parentheses deep at `from`, or the depth at the end of the text.
pub fn comment_end(text: &[u8], from: usize, mut depth: u32) -> Result<usize, u32> {
    let mut at = from;
    while depth > 0 {
        if at >= text.len() {
            return Err(depth);
        }
        match parenthesis(&text[at..]) {
            Some((bytes, opens)) => {
                depth = if opens {
                    depth.saturating_add(1)
                } else {
                    depth - 1
                };
                at += bytes;
            }
            None => at += 1,
        }
    }
    Ok(at)
}

/// True for the spaces that may stand anywhere between words.
const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

/// `text` without the spaces at its front.
pub fn trimmed(text: &[u8]) -> &[u8] {
    let blanks = text.iter().take_while(|byte| is_blank(**byte)).count();
    &text[blanks..]
}
