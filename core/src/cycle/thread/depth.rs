//! The depths of the rough passes ([G76 sheet], steps 5 and 6, and its Q word; [G78 sheet], D word).
//!
//! Knows lengths only: nothing of angles, tapers or moves. All comparisons are exact.

use core::num::NonZero;

use crate::call::{Infeed, ThreadCall};
use crate::units::{Length, div_wide, mul_wide, product, root_wide};

/// The most rough passes of one cycle; more of them raise an alarm.
pub(crate) const MOST_PASSES: u32 = 9999;

/// The rough depths of a thread, one after the other, each larger than the one before; the last is height − allowance.
///
/// Decreasing infeed: `√n·Δd`, computed from n each time and rounded once to the nearest input increment. From the first
/// n whose step would be smaller than Δdmin on, every step is Δdmin [D1] (at least one increment). The first depth is Δd,
/// however small [D22].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depths {
    /// Where the sequence ends: k − d.
    limit: u64,
    /// Depth of the previous pass; `limit` at the end.
    previous: u64,
    /// From this pass on the step is constant.
    constant_from: u32,
    /// The constant step: Δdmin or Δd.
    step: u64,
    /// Input increment.
    increment: NonZero<u64>,
    /// How to find √n·Δd.
    root: Root,
}

/// How `√n·Δd` is found.
#[derive(Clone, Copy, Debug)]
enum Root {
    /// Δd is a whole number of increments, and `4·n·Δd²` fits 64 bits.
    Near(NearRoot),
    /// Anything else: Δd.
    Wide(u64),
}

/// `2·√n·Δd` in whole increments, from pass to pass.
#[derive(Clone, Copy, Debug)]
struct NearRoot {
    /// `4·n·Δd²` for the next n.
    value: u64,
    /// The increase of `4·n·Δd²` from one n to the next.
    growth: u64,
    /// The estimate of the next root.
    guess: NonZero<u64>,
    /// The previous root.
    root: u64,
}

impl Depths {
    /// The sequence down to k − d (positive) in first steps of Δd (positive) and last ones of Δdmin, rounded to the input
    /// increment. Lengths are within the input limit.
    #[inline(never)]
    pub(crate) fn new(call: &ThreadCall) -> Self {
        let limit = call.height.value - call.allowance.value;
        let first = magnitude(call.first_depth.value).max(1);
        let min_step = magnitude(call.min_step.value);
        let increment = NonZero::new(magnitude(call.increment)).unwrap_or(NonZero::<u64>::MIN);
        let (constant_from, step) = match call.infeed {
            // n·Δd is a constant step from the start.
            Infeed::Equal => (1, first),
            Infeed::Decreasing => (
                first_clamped(first, min_step),
                min_step.max(increment.get()),
            ),
        };
        let units = first / increment;
        // 4·n·units² < 2⁶⁴ for every n up to 9999.
        let root = match NonZero::new(units.wrapping_mul(2)) {
            Some(twice) if first % increment == 0 && units < 1 << 24 => {
                let growth = twice.get().wrapping_mul(twice.get());
                Root::Near(NearRoot {
                    value: growth,
                    growth,
                    guess: twice,
                    root: 0,
                })
            }
            _ => Root::Wide(first),
        };
        Self {
            limit: magnitude(limit),
            previous: 0,
            constant_from,
            step,
            increment,
            root,
        }
    }

    /// True where `call` certainly has no more passes than [`MOST_PASSES`]. A pass is never shallower than `√n·Δd` less
    /// half an increment, and √9999 > 99.99. Passes of equal infeed are deeper.
    pub(crate) fn are_surely_few(call: &ThreadCall) -> bool {
        let limit = magnitude(call.height.value - call.allowance.value);
        limit <= magnitude(call.first_depth.value).saturating_mul(99)
    }

    /// The depth of the next pass. `n` is its number: 1, 2, 3 and so on. `None` after the pass at the limit.
    #[inline]
    pub(crate) fn next_depth(&mut self, n: u32) -> Option<Length> {
        if self.previous >= self.limit {
            return None;
        }
        let depth = if n >= self.constant_from {
            self.previous.wrapping_add(self.step)
        } else {
            let root = match &mut self.root {
                Root::Near(near) => {
                    // floor(2x) decides whether x is rounded up or down; a half goes up.
                    let rounded = near.next_root().wrapping_add(1) >> 1;
                    rounded.wrapping_mul(self.increment.get())
                }
                Root::Wide(first) => wide_depth(*first, n, self.increment),
            };
            // A first depth is never below one increment, so this holds for it as well.
            root.max(self.previous.wrapping_add(self.increment.get()))
        };
        self.previous = depth.min(self.limit);
        Some(Length::from_nm(self.previous as i64))
    }
}

impl NearRoot {
    /// `floor(√value)` for the next pass by Newton's method. Nearly always one division is enough.
    #[inline]
    fn next_root(&mut self) -> u64 {
        let value = self.value;
        // After one step x is the root or above it. From there every step falls, until x is the root.
        let mut x = mean(value, self.guess);
        while x.get().wrapping_mul(x.get()) > value {
            x = mean(value, x);
        }
        let root = x.get();
        self.value = value.wrapping_add(self.growth);
        // The root grows more slowly with each pass: the next step is a little shorter than this step.
        let ahead = root.wrapping_mul(2).wrapping_sub(self.root);
        self.guess = NonZero::new(ahead).unwrap_or(x);
        self.root = root;
        root
    }
}

/// One of Newton's steps towards `√value` (at least 1) from `x`.
#[inline]
fn mean(value: u64, x: NonZero<u64>) -> NonZero<u64> {
    let sum = x.get().wrapping_add(value / x);
    NonZero::new(sum >> 1).unwrap_or(NonZero::<u64>::MIN)
}

/// `√n·first` to the nearest increment; the first depth as it is.
#[cold]
fn wide_depth(first: u64, n: u32, increment: NonZero<u64>) -> u64 {
    if n == 1 {
        return first;
    }
    // 4·n·first² < 2² · 2¹⁴ · 2⁸⁴; the root of a floor is the floor of the root.
    let square = product(first, first);
    let value = mul_wide(square, u64::from(n) << 2);
    let once = div_wide(value, increment.get());
    let twice = root_wide(div_wide(once, increment.get()));
    (twice.wrapping_add(1) >> 1).wrapping_mul(increment.get())
}

/// The first n > 1 with `(√n − √(n−1))·Δd < Δdmin`. Where no such n exists, a number above that of every pass.
///
/// `Δd·√n < Δdmin + Δd·√(n−1)`; squared (both sides are positive) `Δd² − Δdmin² < 2·Δd·Δdmin·√(n−1)`; squared again where
/// the left side is positive `Δdmin⁴ < ((4·n − 2)·Δdmin² − Δd²)·Δd²`. The steps decrease, so once true it stays true.
#[inline(never)]
fn first_clamped(first: u64, min_step: u64) -> u32 {
    if min_step == 0 {
        return u32::MAX;
    }
    if min_step >= first {
        return 2;
    }
    let (whole, part) = (product(first, first), product(min_step, min_step));
    // The first n with Δd² < (4·n − 2)·Δdmin². Two divisions, each rounded down, equal one division by the product.
    let ratio = div_wide(div_wide(whole, min_step), min_step);
    let ratio = ratio.min(u128::from(4 * MOST_PASSES)) as u32;
    let n = (ratio.wrapping_add(6) >> 2).max(2);
    if n > MOST_PASSES {
        return u32::MAX;
    }
    // Now the bracket is positive. From Δdmin² on this pass is certain; below, the answer is this pass or the next.
    let parts = n.wrapping_mul(4).wrapping_sub(2);
    let over = mul_wide(part, u64::from(parts)).wrapping_sub(whole);
    if over >= part || long_product(part, part) < long_product(over, whole) {
        n
    } else {
        n.wrapping_add(1)
    }
}

/// A 256-bit product: (high, low). The factors here are below 2⁸⁶.
const fn long_product(a: u128, b: u128) -> (u128, u128) {
    let (a1, a0) = ((a >> 64) as u64, a as u64);
    let (b1, b0) = ((b >> 64) as u64, b as u64);
    let low = product(a0, b0);
    let middle = product(a1, b0)
        .wrapping_add(product(a0, b1))
        .wrapping_add(low >> 64);
    let high = product(a1, b1).wrapping_add(middle >> 64);
    (high, (middle << 64) | low as u64 as u128)
}

/// A length's magnitude as a number of nanometres.
const fn magnitude(length: Length) -> u64 {
    length.nm().unsigned_abs()
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    /// A product of factors below 2⁹⁶, the highest digits first.
    fn wide(factors: &[u128]) -> [u32; 12] {
        let mut digits = [0; 12];
        digits[11] = 1;
        for factor in factors {
            let mut carry = 0;
            for digit in digits.iter_mut().rev() {
                carry += u128::from(*digit) * factor;
                *digit = carry as u32;
                carry >>= 32;
            }
            assert_eq!(carry, 0);
        }
        digits
    }

    /// The definition, squared twice: whether the step to pass n is below the least one.
    fn below(first: u64, least: u64, n: u32) -> bool {
        let (first, least) = (u128::from(first), u128::from(least));
        let (left, right) = (first * first - least * least, 2 * first * least);
        wide(&[left, left]) < wide(&[right, right, u128::from(n - 1)])
    }

    /// Compares the pass that was found with the definition and returns the pass. The steps decrease, so checking two
    /// passes is enough.
    #[track_caller]
    fn check(first: u64, least: u64) -> u32 {
        let n = first_clamped(first, least);
        let last = n.min(MOST_PASSES + 1) - 1;
        assert!(
            last < 2 || !below(first, least, last),
            "{first} {least} {n}"
        );
        assert!(
            n > MOST_PASSES || below(first, least, n),
            "{first} {least} {n}"
        );
        n
    }

    #[test]
    fn the_least_step_begins_where_the_definition_says() {
        for first in 2..200 {
            for least in 1..first {
                let found = check(first, least);
                let searched = (2..=MOST_PASSES).find(|n| below(first, least, *n));
                assert_eq!(searched, Some(found), "{first} {least}");
            }
        }
    }

    #[test]
    fn the_least_step_begins_there_at_every_border() {
        const LONGEST: u64 = 1 << 42;
        let leasts = [
            1,
            2,
            3,
            7,
            10,
            999,
            1000,
            12_345,
            (1 << 20) + 1,
            (1 << 31) - 1,
        ];
        let long = [
            LONGEST / 201,
            LONGEST / 200,
            LONGEST / 199,
            LONGEST / 3,
            LONGEST - 1,
        ];
        for least in leasts.into_iter().chain(long) {
            for n in [2, 3, 4, 10, 100, 5000, MOST_PASSES - 1, MOST_PASSES] {
                // The longest first step for which the steps have fallen to the least step by pass n.
                let (mut inside, mut outside) = (least + 1, LONGEST + 1);
                while outside - inside > 1 {
                    let middle = inside.midpoint(outside);
                    if below(middle, least, n) {
                        inside = middle;
                    } else {
                        outside = middle;
                    }
                }
                for first in inside.saturating_sub(2).max(1)..=(inside + 2).min(LONGEST) {
                    if first <= least {
                        assert_eq!(first_clamped(first, least), 2);
                    } else {
                        let found = check(first, least);
                        assert_eq!(found <= n, first <= inside, "{first} {least} {n}: {found}");
                    }
                }
            }
        }
        for (first, least) in [(LONGEST, 0), (LONGEST, 1), (400_000, 1000), (200, 1)] {
            assert_eq!(first_clamped(first, least), u32::MAX);
        }
    }
}
