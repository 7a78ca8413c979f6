//! Square roots of 64 and 128 bits, rounded down.

use super::wide::narrow_div;

/// √`square`, of 64 bits: for the tick, with nothing dearer than a division of 32 bits, which a Cortex-M4 has.
pub fn root(square: u64) -> u64 {
    if square == 0 {
        return 0;
    }
    // The first digit of base 2¹⁶ from the upper half, as large as it can be; the
    // second by a division, and one less where it was too large.
    let shift = square.leading_zeros() & !1;
    let scaled = square.wrapping_shl(shift);
    let (upper, lower) = ((scaled >> 32) as u32, scaled as u32);
    let first = first_digit(upper);
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

/// √`square` of at least 2³⁰.
const fn first_digit(square: u32) -> u32 {
    // Newton's steps come down from above. From the middle of the range the first is off by 6 % at most, the second by
    // 1/500, the third by a tenth of a unit and what the divisions round away: less than one.
    let mut root = 46_341_u32;
    let mut step = 0_u8;
    while step < 3 {
        root = root.midpoint(over(square, root));
        step = step.wrapping_add(1);
    }
    root.wrapping_sub((over(square, root) < root) as u32)
}

const fn over(a: u32, b: u32) -> u32 {
    match a.checked_div(b) {
        Some(quotient) => quotient,
        None => 0,
    }
}

/// √`square`, of 128 bits. For the background, not for the tick.
#[inline(never)]
pub fn root_wide(square: u128) -> u64 {
    let upper = (square >> 64) as u64;
    if upper == 0 {
        return root(square as u64);
    }
    // Newton's steps from above, until there is none any more. The upper half of
    // the first guess is one more than the root of the upper half.
    let mut root = match u32::try_from(root(upper).wrapping_add(1)) {
        Ok(root) => u64::from(root) << 32,
        Err(_) => u64::MAX,
    };
    loop {
        let next = root.midpoint(narrow_div(square, root));
        if next >= root {
            return root;
        }
        root = next;
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

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
        leadscrew_seed::volume(0x9E37_79B9_7F4A_7C15, |seed| {
            let mut some = seed;
            for _ in 0..200_000 {
                some ^= some << 13;
                some ^= some >> 7;
                some ^= some << 17;
                let square = some >> (some & 63);
                assert_eq!(root(square), square.isqrt(), "{square}");
            }
        });
        let largest = u64::from(u32::MAX);
        for square in [u64::MAX, largest * largest, largest * largest - 1] {
            assert_eq!(root(square), square.isqrt(), "{square}");
        }
    }

    #[test]
    fn the_first_digit_is_the_root() {
        for side in 1_u32 << 15..1 << 16 {
            let square = side * side;
            for square in [square, square + side, square + 2 * side] {
                assert_eq!(first_digit(square), side, "{square}");
            }
        }
    }

    #[test]
    fn the_root_of_128_bits_is_rounded_down() {
        leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
            let mut state = seed;
            let mut random = || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                u128::from(state)
            };
            for round in 0..20_000 {
                let (a, b) = (random(), random());
                for wide in [a << 64 | b, (a << 64 | b) >> (round % 127)] {
                    assert_eq!(u128::from(root_wide(wide)), wide.isqrt(), "{wide}");
                }
                let side = a >> (round % 63);
                for wide in [
                    (side * side).saturating_sub(1),
                    side * side,
                    side * side + side,
                ] {
                    assert_eq!(u128::from(root_wide(wide)), wide.isqrt(), "{wide}");
                }
            }
            for bit in 0..128 {
                for wide in [(1 << bit) - 1, 1 << bit, u128::MAX >> bit, u128::MAX << bit] {
                    assert_eq!(u128::from(root_wide(wide)), wide.isqrt(), "{wide}");
                }
            }
            assert_eq!(root_wide(0), 0);
        });
    }
}
