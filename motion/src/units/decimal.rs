//! The number of a word, exactly as it was written.

/// A decimal number `mantissa · 10^−decimals`, with what its notation tells: how many digits, a point, a sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Decimal {
    mantissa: i64,
    decimals: u8,
    digits: u8,
    point: bool,
    sign: bool,
}

/// Why a [`Decimal`] is not a whole count of some step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecimalError {
    /// A digit other than 0 stands beyond the step.
    Inexact,
    /// The count is beyond 64 bits.
    TooLarge,
}

/// Appends the digits at the front of `text` to `mantissa`; with it come their count and what follows.
#[inline(always)]
fn digits_of(text: &[u8], mantissa: i64) -> (i64, usize, &[u8]) {
    let mut rest = text.iter();
    let mut value = mantissa;
    while let Some(byte) = rest.as_slice().first() {
        let digit = u64::from(*byte).wrapping_sub(u64::from(b'0'));
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(digit.cast_signed());
        rest.next();
    }
    let rest = rest.as_slice();
    (value, text.len().wrapping_sub(rest.len()), rest)
}

/// 10⁰ … 10¹⁸.
const POW10: [i64; 19] = {
    let mut table = [1; 19];
    let mut rest: &mut [i64] = &mut table;
    let mut value: i64 = 1;
    while let Some((first, tail)) = rest.split_first_mut() {
        *first = value;
        value = value.wrapping_mul(10);
        rest = tail;
    }
    table
};

impl Decimal {
    /// Most digits a number may be written with; what fits is exact.
    pub const MAX_DIGITS: u8 = 18;

    /// `mantissa · 10^−decimals`, as if written without a sign word or a point.
    #[must_use]
    pub const fn new(mantissa: i64, decimals: u8) -> Self {
        Self {
            mantissa,
            decimals,
            digits: 0,
            point: decimals > 0,
            sign: mantissa < 0,
        }
    }

    /// Reads the number at the front of `text` (`12`, `-.5`, `+3.`) and gives what follows it. Where no digit stands
    /// there, [`digits`](Self::digits) is 0; above [`MAX_DIGITS`](Self::MAX_DIGITS) of them the value means nothing.
    #[inline]
    #[must_use]
    pub fn parse(text: &[u8]) -> (Self, &[u8]) {
        let (sign, negative, rest) = match text {
            [b'-', rest @ ..] => (true, true, rest),
            [b'+', rest @ ..] => (true, false, rest),
            _ => (false, false, text),
        };
        let (mut mantissa, mut digits, mut rest) = digits_of(rest, 0);
        let (mut decimals, mut point) = (0, false);
        if let [b'.', tail @ ..] = rest {
            point = true;
            (mantissa, decimals, rest) = digits_of(tail, mantissa);
            digits = digits.saturating_add(decimals);
        }
        if digits > usize::from(Self::MAX_DIGITS) {
            (digits, decimals) = (255, 0);
        }
        let number = Self {
            mantissa: if negative {
                mantissa.wrapping_neg()
            } else {
                mantissa
            },
            // At most 18, or 255.
            decimals: decimals as u8,
            digits: digits as u8,
            point,
            sign,
        };
        (number, rest)
    }

    /// The digits without the point, signed.
    #[must_use]
    pub const fn mantissa(self) -> i64 {
        self.mantissa
    }

    /// Digits after the point.
    #[must_use]
    pub const fn decimals(self) -> u8 {
        self.decimals
    }

    /// Digits written, leading zeros included (`P020560` has 6); 255 for more than [`MAX_DIGITS`](Self::MAX_DIGITS).
    #[must_use]
    pub const fn digits(self) -> u8 {
        self.digits
    }

    /// True where a decimal point was written.
    #[must_use]
    pub const fn has_point(self) -> bool {
        self.point
    }

    /// True where a sign was written.
    #[must_use]
    pub const fn has_sign(self) -> bool {
        self.sign
    }

    /// The number in steps of `10^−decimals`.
    ///
    /// # Errors
    /// [`DecimalError::Inexact`] where a digit other than 0 stands beyond the step, [`DecimalError::TooLarge`] beyond
    /// 64 bits.
    #[inline]
    pub fn scaled(self, decimals: u8) -> Result<i64, DecimalError> {
        if self.decimals <= decimals {
            let factor = POW10.get(usize::from(decimals.wrapping_sub(self.decimals)));
            factor
                .and_then(|factor| self.mantissa.checked_mul(*factor))
                .ok_or(DecimalError::TooLarge)
        } else {
            self.shortened(decimals)
        }
    }

    /// [`scaled`](Self::scaled) for fewer decimals than were written.
    #[cold]
    fn shortened(self, decimals: u8) -> Result<i64, DecimalError> {
        if self.mantissa == 0 {
            return Ok(0);
        }
        // Beyond the table the number is below one step whatever its digits.
        let divisor = POW10.get(usize::from(self.decimals.wrapping_sub(decimals)));
        let Some(divisor) = divisor else {
            return Err(DecimalError::Inexact);
        };
        match (
            self.mantissa.checked_div(*divisor),
            self.mantissa.checked_rem(*divisor),
        ) {
            (Some(count), Some(0)) => Ok(count),
            _ => Err(DecimalError::Inexact),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    fn read(text: &str) -> Decimal {
        let (number, rest) = Decimal::parse(text.as_bytes());
        assert!(rest.is_empty(), "{text}");
        number
    }

    #[test]
    fn notation_is_kept() {
        let p = read("020560");
        assert_eq!(
            (p.mantissa(), p.digits(), p.has_point(), p.has_sign()),
            (20560, 6, false, false)
        );
        let x = read("-.50");
        assert_eq!((x.mantissa(), x.decimals(), x.digits()), (-50, 2, 2));
        assert!(x.has_point() && x.has_sign());
        assert!(read("3.").has_point());
        assert!(read("+3").has_sign());
        assert_eq!(read("1234567890123456789").digits(), 255);
        assert_eq!(Decimal::parse(b"X").0.digits(), 0);
        assert_eq!(Decimal::parse(b".").0.digits(), 0);
        assert_eq!(Decimal::parse(b"1.2.3").1, b".3");
    }

    #[test]
    fn scaling_is_exact_or_refused() {
        assert_eq!(read("60").scaled(4), Ok(600_000));
        assert_eq!(read("60.64").scaled(4), Ok(606_400));
        assert_eq!(read("0.00010").scaled(4), Ok(1));
        assert_eq!(read("0.00015").scaled(4), Err(DecimalError::Inexact));
        assert_eq!(read("-0.00015").scaled(4), Err(DecimalError::Inexact));
        assert_eq!(
            read("999999999999999999").scaled(4),
            Err(DecimalError::TooLarge)
        );
        assert_eq!(read(&format!("0.{}", "0".repeat(17))).scaled(3), Ok(0));
        assert_eq!(
            read(".000000000000000001").scaled(0),
            Err(DecimalError::Inexact)
        );
    }
}
