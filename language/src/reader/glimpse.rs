//! What a plain text has: its letters and its codes. Numbers are not looked at further.

/// The G codes of a plain text, without those in its comments.
pub(super) fn codes(text: &[u8]) -> impl Iterator<Item = i64> {
    let mut depth = 0_u32;
    text.iter().enumerate().filter_map(move |(at, byte)| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        (depth == 0 && matches!(byte, b'G' | b'g'))
            .then(|| i64::from(crate::text::number(&text[at + 1..])))
    })
}

/// The letters of the words of a plain text, without its comments.
pub(super) fn letters(text: &[u8]) -> impl Iterator<Item = u8> {
    let mut depth = 0_u32;
    text.iter().filter_map(move |byte| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        let letter = byte.to_ascii_uppercase();
        (depth == 0 && letter.is_ascii_uppercase()).then_some(letter)
    })
}
