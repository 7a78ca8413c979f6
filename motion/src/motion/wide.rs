//! Wide arithmetic for planning, where a division may cost hundreds of instructions. Nothing here runs in a tick.
//!
//! Every function saturates at the end of its range: if the result does not fit, and if a divisor is zero.

use crate::units::{div_wide, narrow_div, product, root_wide};

/// a · b / c rounded up.
#[inline(never)]
pub(crate) fn mul_div_up(a: u64, b: u64, c: u64) -> u64 {
    // c < 2⁶⁴ and a · b ≤ (2⁶⁴ − 1)²: the sum fits.
    let wide = product(a, b).wrapping_add(u128::from(c.saturating_sub(1)));
    narrow_div(wide, c)
}

/// a · 2^`shift` / b rounded to the nearest, within the range of signed numbers; `shift` ≤ 62.
#[inline(never)]
pub(crate) fn ratio(a: u64, b: u64, shift: u32) -> u64 {
    let scaled = u128::from(a).wrapping_shl(shift);
    narrow_div(scaled.wrapping_add(u128::from(b >> 1)), b).min(i64::MAX as u64)
}

/// √(a · b / c) rounded up.
#[inline(never)]
pub(crate) fn root_mul_div_up(a: u64, b: u64, c: u64) -> u64 {
    root_wide(div_wide(product(a, b), c)).saturating_add(1)
}
