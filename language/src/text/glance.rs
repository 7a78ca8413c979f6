//! One fast look at a line: may the core read it unchanged?

use super::{begins_block, parenthesis};

/// What a look at a line has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glance {
    /// Nothing that the core does not read by itself.
    Plain {
        /// The end of what it reads: that of the line, or a `;` with a comment without parentheses after it.
        until: usize,
        /// The line is more than comments, spaces and `%`.
        blocks: bool,
    },
    /// Something that may be a macro, a call, a jump or a program number.
    Special,
}

/// Looks at a line that begins inside of `depth` comments, and gives the depth at its end. A special line leaves it.
pub fn glance(text: &[u8], depth: &mut u32) -> Glance {
    let (mut at, mut inside, mut blocks) = (0, *depth, false);
    while let Some(byte) = text.get(at) {
        let rest = &text[at..];
        if inside > 0 || matches!(byte, b'(' | b')' | 0xEF) {
            match parenthesis(rest) {
                Some((bytes, true)) => {
                    inside = inside.saturating_add(1);
                    at += bytes;
                }
                Some((bytes, false)) => {
                    inside = inside.saturating_sub(1);
                    at += bytes;
                }
                None => at += 1,
            }
            continue;
        }
        match byte {
            b' ' | b'\t' | b'\r' | b'%' => {}
            b';' if !begins_block(&rest[1..]) => {
                *depth = 0;
                return Glance::Plain { until: at, blocks };
            }
            b';' => {}
            _ if is_special(rest) => return Glance::Special,
            _ => blocks = true,
        }
        at += 1;
    }
    *depth = inside;
    Glance::Plain {
        until: text.len(),
        blocks,
    }
}

/// True where something begins that the core does not read.
fn is_special(text: &[u8]) -> bool {
    match text {
        [b'#' | b'[' | b'<' | b':' | b'O' | b'o', ..] => true,
        // A number of a skip, and a number after a space.
        [b'/', b'1'..=b'9', ..] => true,
        [letter, b' ' | b'\t', rest @ ..] if letter.is_ascii_alphabetic() => {
            matches!(super::trimmed(rest), [b'0'..=b'9' | b'.' | b'+' | b'-', ..])
        }
        [b'M' | b'm', rest @ ..] => matches!(code(rest), 97..=99),
        [b'G' | b'g', rest @ ..] => matches!(code(rest), 65..=67),
        [b'E' | b'e', b'N' | b'n', ..] => true,
        _ => false,
    }
}

/// The whole number at the front of `text`.
fn code(text: &[u8]) -> u32 {
    text.iter()
        .take_while(|byte| byte.is_ascii_digit())
        .fold(0_u32, |code, byte| {
            code.saturating_mul(10)
                .saturating_add(u32::from(byte - b'0'))
        })
}
