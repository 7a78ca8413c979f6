//! The value of a variable or an expression.
//!
//! A variable is null until something is assigned to it. Macro A of the GSK 980TD counts in input increments: a variable
//! that such a macro has set says so, and the word that takes it applies its own increment.

/// A number, or none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Value {
    /// Nothing was assigned. Arithmetic takes 0 for it; a word with it is passed over.
    #[default]
    Null,
    /// A number in the unit of the word that takes it: millimetres, inches, degrees, or a count.
    Number(f64),
    /// A count of input increments, from macro A. Arithmetic takes the count.
    Increments(f64),
}

impl Value {
    /// The number that arithmetic takes: 0 for null.
    #[must_use]
    pub const fn number(self) -> f64 {
        match self {
            Self::Null => 0.0,
            Self::Number(number) | Self::Increments(number) => number,
        }
    }

    /// True where nothing was assigned.
    #[must_use]
    pub const fn is_null(self) -> bool {
        matches!(self, Self::Null)
    }

    /// The whole number that this is, up to the tolerance of a comparison.
    #[must_use]
    pub fn whole(self) -> Option<i64> {
        let number = self.number();
        let whole = libm::round(number);
        // Beyond 2⁵³ neighbours of a float are further apart than 1.
        (equal(number, whole) && libm::fabs(whole) < 9.0e15).then_some(whole as i64)
    }
}

/// The relative difference up to which two numbers count as equal in a comparison; below 1 it is absolute.
const TOLERANCE: f64 = 1e-9;

/// True for numbers that a comparison takes for equal.
#[must_use]
pub fn equal(a: f64, b: f64) -> bool {
    let scale = libm::fmax(1.0, libm::fmax(libm::fabs(a), libm::fabs(b)));
    libm::fabs(a - b) <= TOLERANCE * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_whole_is_whole() {
        assert_eq!(Value::Number(0.29 * 100.0).whole(), Some(29));
        assert_eq!(Value::Null.whole(), Some(0));
        assert_eq!(Value::Number(-2.0).whole(), Some(-2));
        assert_eq!(Value::Number(2.5).whole(), None);
        assert_eq!(Value::Number(1e16).whole(), None);
    }

    #[test]
    fn the_tolerance_is_relative_above_one_and_absolute_below() {
        assert!(equal(0.0, 9e-10) && !equal(0.0, 1.1e-9));
        assert!(equal(1e6, 1e6 + 9e-4) && !equal(1e6, 1e6 + 1.1e-3));
    }
}
