//! Lengths of a block with and without a point: some controls count increments where there is none.

use super::looks::Words;

/// A word of X, U, Z or W whose number is written out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// Its letter.
    pub letter: u8,
    /// Its number.
    pub value: f64,
    /// It has a point.
    pub has_point: bool,
    /// Byte of the letter in its line.
    pub from: usize,
    /// Byte behind the number.
    pub to: usize,
}

/// The lengths of a line, comments aside.
pub fn lengths(line: &[u8]) -> impl Iterator<Item = Written> {
    let words = Words::of(line).0.into_iter();
    words
        .filter(|word| matches!(word.letter, b'X' | b'U' | b'Z' | b'W'))
        .map(|word| Written {
            letter: word.letter,
            value: word.value,
            has_point: word.has_point,
            from: word.from,
            to: word.to,
        })
}

/// The words of a text whose numbers are written out, comments aside: letter and number.
pub fn written(text: &[u8]) -> impl Iterator<Item = (u8, f64)> {
    let words = Words::of(text).0.into_iter();
    words.map(|word| (word.letter, word.value))
}

#[cfg(test)]
mod tests {
    use super::lengths;

    #[test]
    fn lengths_have_their_places_and_comments_have_none() {
        let line = b"N10 G1 x5000 (X1.) Z-2. F100 X#1 U.5";
        let found: Vec<_> = lengths(line)
            .map(|word| (word.letter, word.value, word.has_point, word.from, word.to))
            .collect();
        assert_eq!(
            found,
            [
                (b'X', 5000.0, false, 7, 12),
                (b'Z', -2.0, true, 19, 23),
                (b'U', 0.5, true, 33, 36)
            ]
        );
    }
}
