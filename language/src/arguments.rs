//! The arguments of a macro: words of a G65 or G66 block to local variables.

use leadscrew_core::alarm::{Alarm, Code};

use crate::value::Value;
use crate::variables::{Locals, NO_LOCALS};
use crate::word::Word;

/// The variable of each letter, where I, J and K stand once.
const VARIABLES: [(u8, usize); 18] = [
    (b'A', 1),
    (b'B', 2),
    (b'C', 3),
    (b'D', 7),
    (b'E', 8),
    (b'F', 9),
    (b'H', 11),
    (b'M', 13),
    (b'Q', 17),
    (b'R', 18),
    (b'S', 19),
    (b'T', 20),
    (b'U', 21),
    (b'V', 22),
    (b'W', 23),
    (b'X', 24),
    (b'Y', 25),
    (b'Z', 26),
];

/// The first variable of the triples I J K, and how many triples there are.
const TRIPLES: (usize, usize) = (4, 10);

/// The local variables of a macro that is called with these words; P and L are the call's own.
///
/// # Errors
/// A letter that is no argument, or an eleventh triple of I, J and K.
pub fn arguments<'w>(words: impl IntoIterator<Item = &'w Word>) -> Result<Locals, Alarm> {
    let mut locals = NO_LOCALS;
    // The triple in which the last I, J or K stood, and its place in it.
    let (mut triple, mut last) = (0, None);
    for word in words {
        let variable = match word.letter {
            b'P' | b'L' => continue,
            b'I'..=b'K' => {
                let within = usize::from(word.letter - b'I');
                if last.is_some_and(|last| within <= last) {
                    triple += 1;
                }
                last = Some(within);
                (triple < TRIPLES.1).then_some(TRIPLES.0 + 3 * triple + within)
            }
            letter => VARIABLES
                .iter()
                .find(|(known, _)| *known == letter)
                .map(|(_, variable)| *variable),
        };
        let Some(variable) = variable else {
            return Err(word.alarm(Code::ArgumentAddress));
        };
        // An argument without a value is an argument that is not there.
        if !matches!(word.value(), Value::Null) {
            locals[variable - 1] = word.value();
        }
    }
    Ok(locals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::Lookup;
    use crate::text::Cursor;
    use leadscrew_core::alarm::Span;

    struct Nothing;

    impl Lookup for Nothing {
        fn look_up(&mut self, _: i64, _: Span) -> Result<Value, Alarm> {
            Ok(Value::Null)
        }
    }

    fn called(text: &str) -> Result<Vec<(usize, f64)>, Alarm> {
        let mut words = Vec::new();
        let mut cursor = Cursor::new(1, text.as_bytes(), 0);
        crate::word::read(&mut cursor, &mut Nothing, |_| 3, &mut words)?;
        let locals = arguments(&words)?;
        let set = (1..).zip(locals).filter(|(_, value)| !value.is_null());
        Ok(set
            .map(|(number, value)| (number, value.number()))
            .collect())
    }

    #[test]
    fn letters_are_variables() {
        assert_eq!(
            called("P9 A1 B2 I-3 I4 D5"),
            Ok(vec![(1, 1.0), (2, 2.0), (4, -3.0), (7, 5.0)])
        );
        assert_eq!(
            called("A1 B2 C3 I4 J5 K6 D7 E8 F9 H11 M13 Q17 R18 S19 T20 U21 V22 W23 X24 Y25 Z26 L5"),
            Ok([
                1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26
            ]
            .map(|number| (number, number as f64))
            .into())
        );
        // J after K begins a triple, and so does I after J.
        assert_eq!(called("K1 J2 I3"), Ok(vec![(6, 1.0), (8, 2.0), (10, 3.0)]));
        assert_eq!(called("A#1 X1.5"), Ok(vec![(24, 1.5)]));
        let all = "I1J2K3".repeat(10);
        assert_eq!(called(&all).unwrap().last(), Some(&(33, 3.0)));
    }

    #[test]
    fn other_letters_are_refused() {
        for (text, column) in [("A1 G1", 4), ("N5 A1", 1), ("A1 O5", 4)] {
            let alarm = called(text).expect_err(text);
            assert_eq!((alarm.number(), alarm.span.column), (129, column), "{text}");
        }
        assert!(called(&"I1".repeat(11)).is_err());
    }
}
