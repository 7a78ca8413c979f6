//! The depths of the rough passes ([G76 sheet], steps 5 and 6, and its Q word; [G78 sheet], D word).
//!
//! Knows lengths only: nothing of angles, tapers or moves. All comparisons are exact.

use core::num::NonZero;

use crate::program::{Infeed, ThreadCall};
use crate::units::{Length, div_wide, mul_wide, product, root_wide};

/// Rough passes of one cycle at most; more is an alarm.
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
    /// Depth of the pass before; `limit` at the end.
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
    /// What it grows by.
    growth: u64,
    /// Where the root is expected.
    guess: NonZero<u64>,
    /// The root before.
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

    /// The depth of the next pass, which is number `n` (from 1, one after the other); `None` after the one at the limit.
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
                    // floor(2x) decides to which side x is rounded; a half goes up.
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
    /// `floor(√value)` for the next pass, by Newton's steps: one division nearly always.
    #[inline]
    fn next_root(&mut self) -> u64 {
        let value = self.value;
        // After one step x is the root or above it; from there the steps only fall until they have it.
        let mut x = mean(value, self.guess);
        while x.get().wrapping_mul(x.get()) > value {
            x = mean(value, x);
        }
        let root = x.get();
        self.value = value.wrapping_add(self.growth);
        // The roots bend: the next step is a little shorter than this one.
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

/// The first n > 1 with `(√n − √(n−1))·Δd < Δdmin`; beyond every pass where there is none.
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
    let mut n = 2_u32;
    let mut parts = mul_wide(part, 6);
    while parts <= whole {
        parts = parts.wrapping_add(part << 2);
        n = n.wrapping_add(1);
        if n > MOST_PASSES {
            return u32::MAX;
        }
    }
    // Now the bracket is positive. From Δdmin² on there is no doubt; below it is this pass or the next one.
    let over = parts.wrapping_sub(whole);
    if over >= part || long_product(part, part) < long_product(over, whole) {
        n
    } else {
        n.wrapping_add(1)
    }
}

/// A 256-bit product: (high, low). The factors here are below 2⁸⁶.
#[cfg_attr(feature = "small", inline(never))]
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
mod tests {
    use super::*;

    /// Against the definition, squared twice in numbers small enough for it.
    #[test]
    fn the_least_step_begins_where_the_definition_says() {
        for first in 1..200u128 {
            for least in 1..first {
                let left = (first * first - least * least).pow(2);
                let right = (2 * first * least).pow(2);
                let n = (2..=u128::from(MOST_PASSES)).find(|n| left < (n - 1) * right);
                let found = first_clamped(first as u64, least as u64);
                assert_eq!(
                    u128::from(found),
                    n.unwrap_or(u128::from(u32::MAX)),
                    "{first} {least}"
                );
            }
        }
    }
}
