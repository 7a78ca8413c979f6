//! Exact vectors in a plane: their lengths, and their directions relative to each other.

use super::root::root_wide;
use super::wide::{product, signed_product};

/// Along the first axis and along the second; each below 2⁶³.
pub type Vector = (i64, i64);

/// The sign of the cross product: positive where `to` lies from `from` less than half a turn on, from the first axis
/// towards the second, zero where they have one line.
#[inline(never)]
pub fn side(from: Vector, to: Vector) -> i32 {
    let cross = signed_product(from.0, to.1).wrapping_sub(signed_product(from.1, to.0));
    if cross < 0 { -1 } else { i32::from(cross != 0) }
}

/// The sign of the dot product: positive where `to` lies less than a quarter turn to either side of `from`.
pub fn ahead(from: Vector, to: Vector) -> i32 {
    side(from, (to.1.wrapping_neg(), to.0))
}

/// The length of a vector of these sizes, rounded down.
#[inline(never)]
pub(crate) fn length(a: u64, b: u64) -> u64 {
    root_wide(square(a, b))
}

/// The same, rounded up.
#[inline(never)]
pub fn length_up(a: u64, b: u64) -> u64 {
    let length = length(a, b);
    length.wrapping_add(u64::from(product(length, length) < square(a, b)))
}

#[inline(never)]
fn square(a: u64, b: u64) -> u128 {
    product(a, a).wrapping_add(product(b, b))
}

/// True if the counter-clockwise way from `first` to `last` passes through `point`. The way is a whole turn if `first`
/// and `last` point the same way.
pub fn passes(first: Vector, point: Vector, last: Vector) -> bool {
    let whole = side(first, last) == 0 && ahead(first, last) > 0;
    if whole {
        return true;
    }
    let (to_point, to_last) = (half(first, point), half(first, last));
    if to_point != to_last {
        return to_point < to_last;
    }
    side(point, last) >= 0
}

/// 0 if `to` lies less than half a turn counter-clockwise of `from`, else 1.
fn half(from: Vector, to: Vector) -> u8 {
    let side = side(from, to);
    u8::from(side < 0 || (side == 0 && ahead(from, to) < 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_lies_to_one_side_or_on_the_line() {
        const FAR: i64 = (1 << 62) - 1;
        assert_eq!(side((FAR, FAR), (FAR, FAR - 1)), -1);
        assert_eq!(side((FAR, FAR), (FAR - 1, FAR)), 1);
        assert_eq!(side((3, -2), (-9, 6)), 0);
        assert_eq!(ahead((3, -2), (-9, 6)), -1);
        assert_eq!(ahead((FAR, 1), (-1, FAR)), 0);
        assert_eq!(ahead((FAR, 2), (-1, FAR)), 1);
        assert_eq!(side((0, 0), (5, 7)), 0);
    }

    #[test]
    fn lengths_are_rounded_down_and_up() {
        assert_eq!((length(3, 4), length_up(3, 4)), (5, 5));
        assert_eq!((length(1, 1), length_up(1, 1)), (1, 2));
        assert_eq!((length(0, 0), length_up(0, 0)), (0, 0));
        let far = 3 << 60;
        assert_eq!(
            (length(far, 4 << 60), length_up(far, 4 << 60)),
            (5 << 60, 5 << 60)
        );
        assert_eq!(length_up(far, (4 << 60) + 1), (5 << 60) + 1);
    }
}
