//! One fast look at a line: may the core read it unchanged?

use super::{begins_block, comment_end, is_blank, parenthesis};

/// What a look at a line has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glance {
    /// Nothing that the core does not read by itself, up to this byte: the end of the line, or a `;` with a comment
    /// without parentheses after it.
    Plain(usize),
    /// Something that may be a macro, a call, a jump or a program number.
    Special,
}

/// Bytes that have to be looked at. Every line is read this way, and most bytes are digits.
const STOPS: [bool; 256] = {
    let mut table = [false; 256];
    let mut stops: &[u8] = b"()\xEF;#[<:Oo/ \tMmGgEe,LlDd";
    while let [stop, rest @ ..] = stops {
        table[*stop as usize] = true;
        stops = rest;
    }
    table
};

/// Looks at a line that begins inside of `depth` comments, and gives the depth at its end. A special line leaves it.
pub fn glance(text: &[u8], depth: &mut u32) -> Glance {
    let mut at = match comment_end(text, 0, *depth) {
        Ok(after) => after,
        Err(inside) => {
            *depth = inside;
            return Glance::Plain(text.len());
        }
    };
    while let Some(skipped) = text[at..].iter().position(|byte| STOPS[usize::from(*byte)]) {
        at += skipped;
        let rest = &text[at..];
        match (rest[0], parenthesis(rest)) {
            (_, Some((bytes, true))) => match comment_end(text, at + bytes, 1) {
                Ok(after) => at = after,
                Err(inside) => {
                    *depth = inside;
                    return Glance::Plain(text.len());
                }
            },
            (b';', _) if !begins_block(&rest[1..]) => {
                *depth = 0;
                return Glance::Plain(at);
            }
            (b' ' | b'\t', _) if at > 0 && text[at - 1].is_ascii_alphabetic() => {
                if matches!(super::trimmed(rest), [b'0'..=b'9' | b'.' | b'+' | b'-', ..]) {
                    return Glance::Special;
                }
                at += 1;
            }
            _ if is_special(rest) => return Glance::Special,
            _ => at += 1,
        }
    }
    *depth = 0;
    Glance::Plain(text.len())
}

/// True for a line that is more than comments, spaces and `%`. It begins inside of `depth` comments.
pub fn has_blocks(text: &[u8], depth: u32) -> bool {
    let mut at = comment_end(text, 0, depth).unwrap_or(text.len());
    while let Some(byte) = text.get(at) {
        match parenthesis(&text[at..]) {
            Some((bytes, true)) => at = comment_end(text, at + bytes, 1).unwrap_or(text.len()),
            _ if matches!(byte, b'%' | b';') || is_blank(*byte) => at += 1,
            _ => return true,
        }
    }
    false
}

/// True where something begins that the core does not read.
fn is_special(text: &[u8]) -> bool {
    match text {
        [b'#' | b'[' | b'<' | b':' | b'O' | b'o', ..] | [b'/', b'1'..=b'9', ..] => true,
        [b',', rest @ ..] => matches!(
            super::trimmed(rest),
            [b'C' | b'c' | b'R' | b'r' | b'A' | b'a', ..]
        ),
        [b'M' | b'm', b'0' | b'9', ..] => matches!(number(&text[1..]), 97..=99),
        [b'G' | b'g', rest @ ..] => {
            let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
            rest.get(digits) == Some(&b'.')
                || matches!(number(rest), 40..=42 | 65..=67 | 70..=76 | 81..=83 | 85..=87 | 89)
        }
        [b'L' | b'l' | b'D' | b'd', ..] => true,
        [b'E' | b'e', b'N' | b'n', ..] => true,
        _ => false,
    }
}

/// The whole number at the front of `text`.
pub fn number(text: &[u8]) -> u32 {
    text.iter()
        .take_while(|byte| byte.is_ascii_digit())
        .fold(0_u32, |code, byte| {
            code.saturating_mul(10)
                .saturating_add(u32::from(byte - b'0'))
        })
}
