//! Tests the division of 64-bit numbers, with and without signs: at the limits of their digits, and at numbers between.

use core::hint::black_box;

/// The 16-bit digits of the tested numbers.
const DIGITS: [u64; 6] = [0, 1, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF];
/// The number of numbers with four such digits.
const BORDERS: u64 = 6 * 6 * 6 * 6;

/// Checks all divisions, and gives their number.
pub fn checks() -> u32 {
    let mut checks = 0;
    for dividend in (0..BORDERS).map(border) {
        for divisor in (1..BORDERS).map(border) {
            checks += check(dividend, divisor);
        }
    }
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> (state & 63)
    };
    for _ in 0..100_000 {
        checks += check(random(), random().max(1));
    }
    checks
}

fn border(mut number: u64) -> u64 {
    let mut value = 0;
    for _ in 0..4 {
        value = value << 16 | DIGITS[(number as u32 % 6) as usize];
        number = u64::from(number as u32 / 6);
    }
    value
}

fn check(dividend: u64, divisor: u64) -> u32 {
    let (n, d) = (black_box(dividend), black_box(divisor));
    let (quotient, rest) = (n / d, n % d);
    let product = quotient.checked_mul(divisor);
    let back = product.and_then(|product| product.checked_add(rest));
    assert!(
        back == Some(dividend) && rest < divisor,
        "{dividend:#x} / {divisor:#x}: {quotient:#x}, {rest:#x}"
    );

    let (n, d) = (dividend as i64, divisor as i64);
    if let (Some(quotient), Some(rest)) = (
        black_box(n).checked_div(black_box(d)),
        black_box(n).checked_rem(black_box(d)),
    ) {
        let sizes = (n.unsigned_abs() / d.unsigned_abs()) as i64;
        let rests = (n.unsigned_abs() % d.unsigned_abs()) as i64;
        let expected = if (n < 0) == (d < 0) { sizes } else { -sizes };
        assert_eq!(quotient, expected, "{n:#x} / {d:#x}");
        let expected = if n < 0 { -rests } else { rests };
        assert_eq!(rest, expected, "{n:#x} % {d:#x}");
    }
    1
}
