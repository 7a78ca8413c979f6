//! What a plain text has: its letters and its codes. Numbers are not looked at further.

/// The G codes of a plain text, without those in its comments.
pub(super) fn codes(text: &[u8]) -> impl Iterator<Item = i64> {
    places(text, b'G').map(|at| code(text, at))
}

/// From where to where the first code stands that is `asked` for.
pub(super) fn place_of_code(text: &[u8], asked: fn(i64) -> bool) -> Option<(usize, usize)> {
    let from = places(text, b'G').find(|at| asked(code(text, *at)))?;
    Some((from, word_end(text, from)))
}

/// From where to where the first word with this letter stands.
pub(super) fn place_of(text: &[u8], letter: u8) -> Option<(usize, usize)> {
    let from = places(text, letter).next()?;
    Some((from, word_end(text, from)))
}

/// The text with spaces where the words of a letter stand.
pub(super) fn blanked(text: &[u8], letter: u8) -> Vec<u8> {
    let mut rest = text.to_vec();
    for from in places(text, letter) {
        rest[from..word_end(text, from)].fill(b' ');
    }
    rest
}

/// Where the words of a letter begin.
fn places(text: &[u8], letter: u8) -> impl Iterator<Item = usize> {
    let words = words(text).filter(move |(_, found)| *found == letter);
    words.map(|(at, _)| at)
}

/// Where the words of a plain text begin, each with its letter; those in its comments are none.
fn words(text: &[u8]) -> impl Iterator<Item = (usize, u8)> {
    let mut depth = 0_u32;
    text.iter().enumerate().filter_map(move |(at, byte)| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        let letter = byte.to_ascii_uppercase();
        (depth == 0 && letter.is_ascii_uppercase()).then_some((at, letter))
    })
}

fn code(text: &[u8], at: usize) -> i64 {
    i64::from(crate::text::number(&text[at + 1..]))
}

/// The end of the word that begins at `from`.
fn word_end(text: &[u8], from: usize) -> usize {
    let is_number = |byte: &u8| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.');
    let number = crate::text::trimmed(&text[from + 1..]);
    let digits = number.iter().take_while(|byte| is_number(byte)).count();
    text.len() - number.len() + digits
}

/// The letters of the words of a plain text, without its comments.
pub(super) fn letters(text: &[u8]) -> impl Iterator<Item = u8> {
    words(text).map(|(_, letter)| letter)
}
