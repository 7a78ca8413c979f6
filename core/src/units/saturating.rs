//! 64-bit arithmetic that saturates, each operation written once.

/// a + b.
pub(crate) const fn sum(a: i64, b: i64) -> i64 {
    a.saturating_add(b)
}

/// a − b.
pub(crate) const fn difference(a: i64, b: i64) -> i64 {
    a.saturating_sub(b)
}

/// a · b.
pub(crate) const fn times(a: i64, b: i64) -> i64 {
    a.saturating_mul(b)
}

/// −a.
pub(crate) const fn negative(a: i64) -> i64 {
    a.saturating_neg()
}

/// |a|.
pub(crate) const fn magnitude(a: i64) -> i64 {
    a.saturating_abs()
}

/// |a|.
pub(crate) const fn size(a: i64) -> u64 {
    a.unsigned_abs()
}

/// a · b, without signs.
pub(crate) const fn multiple(a: u64, b: u64) -> u64 {
    a.saturating_mul(b)
}

/// a, as one with a sign.
pub(crate) const fn signed(a: u64) -> i64 {
    if a > i64::MAX as u64 {
        i64::MAX
    } else {
        a as i64
    }
}

/// −1, 0 or +1.
pub(crate) const fn sign(a: i64) -> i64 {
    a.signum()
}
