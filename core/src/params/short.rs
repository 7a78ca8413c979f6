//! Values of the built-in set as they lie in flash. This file knows nothing of the rest of the core, because the build
//! script holds against it what it writes.

/// A value of the built-in set as it lies in flash, where eight bytes for each would be most of it: its digits, and in the
/// lowest four bits how many zeros follow them. An extreme stands for an extreme.
pub(super) const fn lengthen(value: i32) -> i64 {
    match value {
        i32::MIN => return i64::MIN,
        i32::MAX => return i64::MAX,
        _ => {}
    }
    let (mut digits, mut zeros) = ((value >> 4) as i64, value & 15);
    while zeros > 0 {
        digits = digits.wrapping_mul(10);
        zeros = zeros.wrapping_sub(1);
    }
    digits
}
