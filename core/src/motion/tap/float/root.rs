//! A square root for the tick: of 64 bits, with nothing dearer than a division of 32 bits, which a Cortex-M4 has.

/// √`square`, rounded down.
pub(super) fn root(square: u64) -> u64 {
    if square == 0 {
        return 0;
    }
    // The first digit of base 2¹⁶ from the upper half, as large as it can be; the second by a division, and one less where it
    // was too large.
    let shift = square.leading_zeros() & !1;
    let scaled = square.wrapping_shl(shift);
    let (upper, lower) = ((scaled >> 32) as u32, scaled as u32);
    let first = upper.isqrt();
    let rest = upper.wrapping_sub(first.wrapping_mul(first));
    // (rest · 2¹⁶ + the next 16 bits) / 2·first; the rest is 2·first at most, so half of both fits.
    let half = rest.wrapping_shl(15) | lower >> 17;
    let second = half.checked_div(first).unwrap_or(0);
    let rest = half.wrapping_sub(second.wrapping_mul(first));
    let rest = u64::from(rest.wrapping_shl(1) | lower >> 16 & 1) << 16 | u64::from(lower & 0xFFFF);
    let second = u64::from(second);
    let both = (u64::from(first) << 16).wrapping_add(second);
    let too_large = rest < second.wrapping_mul(second);
    both.wrapping_sub(u64::from(too_large))
        .wrapping_shr(shift >> 1)
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::root;

    #[test]
    fn it_is_the_root() {
        for small in 0..100_000 {
            assert_eq!(root(small), small.isqrt(), "{small}");
        }
        for size in 3..=31 {
            let edge = 1_u64 << size;
            for side in [edge - 1, edge, edge + 1, edge / 3 * 2, edge / 5 * 7] {
                let square = side * side;
                for square in [square - 1, square, square + 1, square + 2 * side] {
                    assert_eq!(root(square), square.isqrt(), "{square}");
                }
            }
        }
        let mut some = 0x9E37_79B9_7F4A_7C15_u64;
        for _ in 0..200_000 {
            some ^= some << 13;
            some ^= some >> 7;
            some ^= some << 17;
            let square = some >> (some & 63);
            assert_eq!(root(square), square.isqrt(), "{square}");
        }
        let largest = u64::from(u32::MAX);
        for square in [u64::MAX, largest * largest, largest * largest - 1] {
            assert_eq!(root(square), square.isqrt(), "{square}");
        }
    }
}
