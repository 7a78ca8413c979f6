//! Products that need 128 bits, for places that keep 64: the high half of a product, and `a · b / c`.
//!
//! The compiler's 128-bit division is two kilobytes of code, and the linker puts it in wherever it is written; so it is
//! written nowhere, and that by 64 bits is here [D159].

/// `a`, or the largest number with a sign where that is smaller.
pub const fn signed(a: u64) -> i64 {
    if a > i64::MAX as u64 {
        i64::MAX
    } else {
        a as i64
    }
}

/// The high 64 bits of `a · b`.
///
/// A 32-bit processor needs four multiplications for it and no library call.
#[must_use]
pub const fn mul_high(a: u64, b: u64) -> u64 {
    ((a as u128).wrapping_mul(b as u128) >> 64) as u64
}

/// `a · b`, exact.
pub const fn product(a: u64, b: u64) -> u128 {
    (a as u128).wrapping_mul(b as u128)
}

/// `a · b`, exact.
pub const fn signed_product(a: i64, b: i64) -> i128 {
    (a as i128).wrapping_mul(b as i128)
}

/// `a · b / c` rounded down; `u64::MAX` where that does not fit or `c` is zero. For the background, not for the tick.
#[must_use]
#[inline(never)]
pub const fn mul_div(a: u64, b: u64, c: u64) -> u64 {
    narrow_div((a as u128).wrapping_mul(b as u128), c)
}

/// `a / b` rounded down; `u64::MAX` where that does not fit or `b` is zero. For the background, not for the tick.
#[inline(never)]
pub const fn narrow_div(a: u128, b: u64) -> u64 {
    let (upper, mut digits) = ((a >> 64) as u64, a as u64);
    if upper >= b {
        return u64::MAX;
    }
    if upper == 0
        && let Some(quotient) = digits.checked_div(b)
    {
        return quotient;
    }
    // Long division in digits of 32 bits (Knuth, algorithm D): both shifted until the divisor's highest bit is set.
    let shift = b.leading_zeros();
    let b = b.wrapping_shl(shift);
    let mut rest =
        upper.wrapping_shl(shift) | (digits >> 1).wrapping_shr(63_u32.wrapping_sub(shift));
    digits = digits.wrapping_shl(shift);
    let mut round = 0_u8;
    while round < 2 {
        // A digit by the divisor's upper half: at most 2³² + 1, so that its product with the lower one fits.
        let (upper, lower) = (b >> 32, b & u32::MAX as u64);
        let mut digit = match rest.checked_div(upper) {
            Some(digit) => digit,
            None => 0,
        };
        rest = rest.wrapping_sub(digit.wrapping_mul(upper)) << 32 | digits >> 32;
        let less = digit.wrapping_mul(lower);
        let mut too_large = rest < less;
        rest = rest.wrapping_sub(less);
        while too_large {
            digit = digit.wrapping_sub(1);
            let (more, carry) = rest.overflowing_add(b);
            (rest, too_large) = (more, !carry);
        }
        // The quotient follows the digits out.
        digits = digits << 32 | digit;
        round = round.wrapping_add(1);
    }
    digits
}

/// `a / b` rounded down; `u128::MAX` where `b` is zero. For the background, not for the tick.
#[inline(never)]
pub const fn div_wide(a: u128, b: u64) -> u128 {
    let upper = (a >> 64) as u64;
    let Some(first) = upper.checked_div(b) else {
        return u128::MAX;
    };
    let rest = upper.wrapping_sub(first.wrapping_mul(b));
    let second = narrow_div((rest as u128) << 64 | a as u64 as u128, b);
    (first as u128) << 64 | second as u128
}

/// `a · b`; `u128::MAX` where that does not fit. One copy for all: inlined it is long.
#[inline(never)]
pub const fn mul_wide(a: u128, b: u64) -> u128 {
    a.saturating_mul(b as u128)
}

/// A divisor with its reciprocal, so that the tick divides by multiplying.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor {
    value: u32,
    reciprocal: u64,
}

impl Divisor {
    /// Prepares a division by `value`; zero counts as one.
    #[must_use]
    pub const fn new(value: u32) -> Self {
        let value = if value == 0 { 1 } else { value };
        let reciprocal = match u64::MAX.checked_div(value as u64) {
            Some(r) => r,
            None => u64::MAX,
        };
        Self { value, reciprocal }
    }

    /// Quotient and remainder of `dividend`, exact.
    #[must_use]
    pub const fn divide(self, dividend: u64) -> (u64, u32) {
        // The reciprocal lacks less than one unit, so the estimate lacks less than dividend / 2⁶⁴ + 1: at most one.
        let value = self.value as u64;
        let estimate = mul_high(dividend, self.reciprocal);
        let rest = dividend.wrapping_sub(estimate.wrapping_mul(value));
        if rest >= value {
            (estimate.wrapping_add(1), rest.wrapping_sub(value) as u32)
        } else {
            (estimate, rest as u32)
        }
    }

    /// The divisor.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// Numbers with long runs of ones and zeros, in addition to ordinary numbers.
    fn samples(seed: u64) -> impl Iterator<Item = u64> {
        let mut state = seed;
        (0..2_000).map(move |i| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            match i % 4 {
                0 => state,
                1 => state >> (i % 61),
                2 => u64::MAX << (i % 63),
                _ => u64::MAX >> (i % 63),
            }
        })
    }

    #[test]
    fn mul_high_is_the_high_half() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            for (a, b) in samples(seed).zip(samples(seed).skip(1)) {
                let exact = (u128::from(a) * u128::from(b)) >> 64;
                assert_eq!(u128::from(mul_high(a, b)), exact, "{a} * {b}");
            }
        });
    }

    #[test]
    fn wide_division_is_the_compilers() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            const DIGITS: [u64; 5] = [0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF];
            let borders = || DIGITS.into_iter().flat_map(|a| DIGITS.map(|b| a << 32 | b));
            let check = |a: u128, b: u64| {
                let exact = a.checked_div(u128::from(b)).unwrap_or(u128::MAX);
                assert_eq!(div_wide(a, b), exact, "{a} / {b}");
                let narrow = u64::try_from(exact).unwrap_or(u64::MAX);
                assert_eq!(narrow_div(a, b), narrow, "{a} / {b}");
            };
            for upper in borders() {
                for lower in borders() {
                    for b in borders() {
                        check(u128::from(upper) << 64 | u128::from(lower), b);
                    }
                }
            }
            for ((upper, lower), b) in samples(seed)
                .zip(samples(seed).skip(1))
                .zip(samples(seed).skip(2))
            {
                let a = u128::from(upper) << 64 | u128::from(lower);
                check(a, b);
                check(a >> 64, b);
                check(a >> (b & 127), b);
            }
        });
    }

    #[test]
    fn wide_products_saturate() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            for ((upper, lower), b) in samples(seed)
                .zip(samples(seed).skip(1))
                .zip(samples(seed).skip(2))
            {
                let a = (u128::from(upper) << 64 | u128::from(lower)) >> (b & 127);
                assert_eq!(mul_wide(a, b), a.saturating_mul(u128::from(b)));
            }
        });
    }

    #[test]
    fn divisor_divides_exactly() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            for (a, b) in samples(seed).zip(samples(seed).skip(1)) {
                let b = ((b >> 32) as u32).max(1);
                let (q, r) = Divisor::new(b).divide(a);
                assert_eq!((q, r), (a / u64::from(b), (a % u64::from(b)) as u32));
            }
            assert_eq!(Divisor::new(1).divide(u64::MAX), (u64::MAX, 0));
        });
    }

    #[test]
    fn mul_div_rounds_down_and_saturates() {
        assert_eq!(mul_div(7, 3, 2), 10);
        assert_eq!(mul_div(u64::MAX, 2, 1), u64::MAX);
        assert_eq!(mul_div(u64::MAX, 6, 7), 15_811_494_920_322_472_812);
        assert_eq!(mul_div(1, 1, 0), u64::MAX);
    }
}
