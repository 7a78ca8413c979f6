//! Wide arithmetic for planning, where a division may cost thousands of instructions. Nothing here runs in a tick.
//!
//! Every function saturates: at the end of the range where a result does not fit, and where a divisor is zero.

use crate::units::{div_wide, product, root_wide};

/// a · b / c rounded up.
#[inline(never)]
pub(crate) fn mul_div_up(a: u64, b: u64, c: u64) -> u64 {
    let wide = product(a, b);
    // c < 2⁶⁴ and wide ≤ (2⁶⁴ − 1)²: the sum fits.
    narrow(div_wide(
        wide.wrapping_add(u128::from(c.saturating_sub(1))),
        u128::from(c),
    ))
}

/// a · 2^`shift` / b rounded to the nearest, for a signed a; `shift` ≤ 62.
#[inline(never)]
pub(crate) fn ratio(a: i64, b: u64, shift: u32) -> i64 {
    let scaled = u128::from(a.unsigned_abs()).wrapping_shl(shift);
    let half = u128::from(b >> 1);
    let magnitude = narrow(div_wide(scaled.wrapping_add(half), u128::from(b)));
    let magnitude = i64::try_from(magnitude).unwrap_or(i64::MAX);
    if a < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// √(a · b / c) rounded up.
#[inline(never)]
pub(crate) fn root_mul_div_up(a: u64, b: u64, c: u64) -> u64 {
    let wide = product(a, b);
    let Some(square) = div_wide(wide, u128::from(c)) else {
        return u64::MAX;
    };
    root_wide(square).saturating_add(1)
}

fn narrow(value: Option<u128>) -> u64 {
    value
        .and_then(|value| u64::try_from(value).ok())
        .unwrap_or(u64::MAX)
}
