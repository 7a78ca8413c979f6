//! The comment that declares the stock: `(STOCK X60 L100)`, `(STOCK X60 L100 X0=20 Z1)`.
//!
//! It must not know what the stock is for.

/// A bar or a tube before the first cut, in nanometres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stock {
    /// X: the outside, a radius.
    pub outside: i64,
    /// X0: the hole that is there already, a radius; 0 where there is none.
    pub bore: i64,
    /// L: how far it reaches from its face toward the chuck.
    pub length: i64,
    /// Z: where its face is; 0 where it is not written.
    pub face: i64,
}

/// What a line says of the stock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Said {
    /// Nothing.
    Nothing,
    /// All of it.
    Stock(Stock),
    /// The comment is there and cannot be read; its bytes in the line.
    Unreadable {
        /// Where it begins.
        from: usize,
        /// Where it ends.
        to: usize,
    },
}

/// The largest value, a kilometre.
const MOST: i64 = 1_000_000_000_000;

/// Reads the comment of a line [D250].
#[must_use]
pub fn said(line: &[u8]) -> Said {
    const WORD: &[u8] = b"STOCK";
    let is = |window: &[u8]| window.eq_ignore_ascii_case(WORD);
    let Some(at) = line.windows(WORD.len()).position(is) else {
        return Said::Nothing;
    };
    let rest = &line[at + WORD.len()..];
    let opens = line[..at].trim_ascii_end().ends_with(b"(");
    // A remark such as `(STOCK 60 ROUND)` is none of this.
    let is_word = rest.first().is_some_and(u8::is_ascii_whitespace)
        && matches!(rest.trim_ascii_start(), [b'X' | b'x', ..]);
    if !opens || !is_word {
        return Said::Nothing;
    }
    let close = rest.iter().position(|byte| *byte == b')');
    let words = &rest[..close.unwrap_or(rest.len())];
    stock(words).map_or(
        Said::Unreadable {
            from: at,
            to: at + WORD.len() + words.trim_ascii_end().len(),
        },
        Said::Stock,
    )
}

fn stock(words: &[u8]) -> Option<Stock> {
    let (mut outside, mut bore, mut length, mut face) = (None, None, None, None);
    let words = words.split(u8::is_ascii_whitespace);
    for word in words.filter(|word| !word.is_empty()) {
        let (letter, number) = word.split_first()?;
        let (place, number) = match (letter.to_ascii_uppercase(), number) {
            (b'X', [b'0', b'=', number @ ..]) => (&mut bore, number),
            (b'X', number) => (&mut outside, number),
            (b'L', number) => (&mut length, number),
            (b'Z', number) => (&mut face, number),
            _ => return None,
        };
        if place.replace(nanometres(number)?).is_some() {
            return None;
        }
    }
    let stock = Stock {
        outside: outside? / 2,
        bore: bore.unwrap_or(0) / 2,
        length: length?,
        face: face.unwrap_or(0),
    };
    let makes_sense = stock.length > 0 && stock.bore >= 0 && stock.outside > stock.bore;
    makes_sense.then_some(stock)
}

/// Millimetres with up to six decimals.
fn nanometres(text: &[u8]) -> Option<i64> {
    let (sign, text) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        rest => (1, rest),
    };
    let point = text.iter().position(|byte| *byte == b'.');
    let (whole, part) = match point {
        Some(at) => (&text[..at], &text[at + 1..]),
        None => (text, &[][..]),
    };
    if whole.is_empty() && part.is_empty() || part.len() > 6 {
        return None;
    }
    let digits = whole.iter().chain(part);
    let zeros = std::iter::repeat_n(&b'0', 6 - part.len());
    let value = digits.chain(zeros).try_fold(0_i64, |value, byte| {
        let digit = byte.is_ascii_digit().then(|| i64::from(byte - b'0'))?;
        Some(value * 10 + digit).filter(|value| *value <= MOST)
    })?;
    Some(sign * value)
}

#[cfg(test)]
mod tests {
    use super::{Said, Stock, said};

    const MM: i64 = 1_000_000;

    #[test]
    fn a_stock_has_a_diameter_a_length_and_perhaps_a_bore_and_a_face() {
        let bar = Stock {
            outside: 30 * MM,
            bore: 0,
            length: 100 * MM,
            face: 0,
        };
        for line in ["(STOCK X60 L100)", "O1 ( stock  x60. l100.0 ) G0"] {
            assert_eq!(said(line.as_bytes()), Said::Stock(bar), "{line}");
        }
        let tube = Stock {
            outside: 30_250_000,
            bore: 10 * MM,
            length: 100 * MM,
            face: 1_500_000,
        };
        assert_eq!(said(b"(STOCK X60.5 L100 X0=20 Z1.5)"), Said::Stock(tube));
    }

    #[test]
    fn a_remark_is_none_and_a_slip_is_told_with_its_place() {
        for line in [
            "(STOCK 60 ROUND)",
            "(BAR STOCK X60 L100)",
            "STOCK X60 L100",
            "(STOCKX60)",
            "",
        ] {
            assert_eq!(said(line.as_bytes()), Said::Nothing, "{line}");
        }
        for words in [
            "X60",
            "X60 L",
            "X60 L0",
            "X60 L100 X0=60",
            "X60 L100 X50",
            "X60 L100 D2",
            "X60 L1O0",
            "X0 L100",
            "X60 L100 Z1.1234567",
            "X60 L-5",
            "X60 L100 X0=-2",
            "X99999999999999999999 L1",
            "X. L1",
        ] {
            let line = format!("(STOCK {words})");
            let place = Said::Unreadable {
                from: 1,
                to: line.len() - 1,
            };
            assert_eq!(said(line.as_bytes()), place, "{line}");
        }
    }
}
