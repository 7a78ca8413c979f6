//! Products that need 128 bits, for places that keep 64: the high half of a product, and `a · b / c`.
//!
//! A 128-bit division is two kilobytes of code, and the linker puts it in wherever it is written; so it is written here, and
//! nowhere else [D140].

/// The high 64 bits of `a · b`.
///
/// A 32-bit processor needs four multiplications for it and no library call.
#[must_use]
#[cfg_attr(feature = "small", inline(never))]
pub const fn mul_high(a: u64, b: u64) -> u64 {
    ((a as u128).wrapping_mul(b as u128) >> 64) as u64
}

/// `a · b`, exact.
#[cfg_attr(feature = "small", inline(never))]
pub(crate) const fn product(a: u64, b: u64) -> u128 {
    (a as u128).wrapping_mul(b as u128)
}

/// `a · b`, exact.
#[cfg_attr(feature = "small", inline(never))]
pub(crate) const fn signed_product(a: i64, b: i64) -> i128 {
    (a as i128).wrapping_mul(b as i128)
}

/// The root of `a`, rounded down. For the background, not for the tick.
#[inline(never)]
pub(crate) const fn root_wide(a: u128) -> u64 {
    if a == 0 {
        return 0;
    }
    // The whole width is used: v = a · 2^shift, and the root of a is that of v without shift/2 bits.
    let shift = a.leading_zeros() & !1;
    let v = a << shift;
    // The upper half's root, and what that lacks over twice the root: at most one too many in the last place.
    let upper = (v >> 64) as u64;
    let half = upper.isqrt();
    let lacks = upper.wrapping_sub(half.wrapping_mul(half));
    let lacks = (lacks << 31) | (v as u64 >> 33);
    let below = match lacks.checked_div(half) {
        Some(below) => below,
        None => 0,
    };
    let root = (half << 32).saturating_add(below);
    let root = if product(root, root) > v {
        root.wrapping_sub(1)
    } else {
        root
    };
    root >> (shift >> 1)
}

/// `a · b / c` rounded down; `u64::MAX` where that does not fit or `c` is zero. A 128-bit division: for the background,
/// not for the tick.
#[must_use]
#[inline(never)]
pub const fn mul_div(a: u64, b: u64, c: u64) -> u64 {
    match div_wide(product(a, b), c as u128) {
        Some(q) if q <= u64::MAX as u128 => q as u64,
        _ => u64::MAX,
    }
}

/// `a / b` rounded down; `None` where `b` is zero. For the background, not for the tick.
#[inline(never)]
pub(crate) const fn div_wide(a: u128, b: u128) -> Option<u128> {
    a.checked_div(b)
}

/// `a · b`; `u128::MAX` where that does not fit. Likewise of one copy.
#[inline(never)]
pub(crate) const fn mul_wide(a: u128, b: u128) -> u128 {
    a.saturating_mul(b)
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

    /// Numbers with long runs of ones and zeros beside ordinary ones.
    fn samples() -> impl Iterator<Item = u64> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
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
        for (a, b) in samples().zip(samples().skip(1)) {
            let exact = (u128::from(a) * u128::from(b)) >> 64;
            assert_eq!(u128::from(mul_high(a, b)), exact, "{a} * {b}");
        }
    }

    #[test]
    fn the_root_of_128_bits_is_rounded_down() {
        let mut wide: std::vec::Vec<u128> = samples()
            .zip(samples().skip(1))
            .map(|(a, b)| (u128::from(a) << 64) | u128::from(b))
            .collect();
        for a in samples() {
            let square = u128::from(a) * u128::from(a);
            wide.extend([square.saturating_sub(1), square, square + 1]);
        }
        wide.extend((0..128).flat_map(|bit| [(1 << bit) - 1, 1 << bit, u128::MAX >> bit]));
        for a in wide {
            assert_eq!(u128::from(root_wide(a)), a.isqrt(), "{a}");
        }
    }

    #[test]
    fn divisor_divides_exactly() {
        for (a, b) in samples().zip(samples().skip(1)) {
            let b = ((b >> 32) as u32).max(1);
            let (q, r) = Divisor::new(b).divide(a);
            assert_eq!((q, r), (a / u64::from(b), (a % u64::from(b)) as u32));
        }
        assert_eq!(Divisor::new(1).divide(u64::MAX), (u64::MAX, 0));
    }

    #[test]
    fn mul_div_rounds_down_and_saturates() {
        assert_eq!(mul_div(7, 3, 2), 10);
        assert_eq!(mul_div(u64::MAX, 2, 1), u64::MAX);
        assert_eq!(mul_div(u64::MAX, 6, 7), 15_811_494_920_322_472_812);
        assert_eq!(mul_div(1, 1, 0), u64::MAX);
    }
}
