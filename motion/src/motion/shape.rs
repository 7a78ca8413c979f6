//! Chooses the ramp of a motion: the two means with which the motion ends soonest within the limits of its path.
//!
//! This module knows only numbers. A ramp of m ticks may reach the smaller of the rates a·n1 and j·n1·n2, with
//! n1 + n2 = m. The best split makes this rate largest. The rate grows with m, so everything here is a search over m.

use super::limits::PathLimits;
use super::profile::{CAPACITY, Ramp};
use super::rate::PathRate;
use super::wide::mul_div_up;
use crate::units::Length;

/// The ramp for a motion of `length` at `nominal` that can go up to `limits.speed`.
///
/// If the motion is too short for this top speed, it gets the shorter ramp of a lower speed, chosen to be quickest at
/// `nominal`. `None` if the ramp would be longer than [`CAPACITY`] ticks.
pub(super) fn ramp(length: Length, nominal: PathRate, limits: &PathLimits) -> Option<Ramp> {
    let units = units(length);
    let cap = limits.speed.raw().max(2);
    let goal = nominal.raw().min(cap).max(1);

    let least = smallest(limits, Figure::Rate(2))?;
    let full = smallest(limits, Figure::Rate(cap));
    // The smallest ramp for which the motion is too short.
    let over = smallest(limits, Figure::Way(goal, units));

    // Ticks and rate. If the motion can never go faster than `goal`, one tick less of ramp may be worth a slightly
    // lower speed.
    let (own, may_be_shorter) = match (full, over) {
        (Some(full), over) if over.is_none_or(|over| over > full) => ((full, cap), goal == cap),
        (_, Some(over)) => {
            let m = over.max(least);
            let share = units.checked_div(u64::from(m)).unwrap_or(0);
            let share = u32::try_from(share).unwrap_or(u32::MAX);
            ((m, share.min(cap).max(2)), true)
        }
        (_, None) => return None,
    };
    let shorter = own.0.saturating_sub(1);
    let mut best = own;
    if may_be_shorter && shorter >= least {
        let other = (shorter, split(shorter, limits).1.min(cap));
        if ticks_in_units(units, nominal, other) <= ticks_in_units(units, nominal, own) {
            best = other;
        }
    }
    let (m, rate) = best;
    let (n1, _) = split(m, limits);
    Ramp::new(PathRate::from_raw(rate), n1, m.saturating_sub(n1))
}

/// The ramp for a motion that may go up to `cap` and has to stop at any time, within `most` ticks. Where the ramp to `cap`
/// would be longer, the motion is slower. `None` where not even the lowest rate has so short a ramp.
// Called for each axis in two ways.
#[inline(never)]
pub(super) fn ramp_within(cap: PathRate, limits: &PathLimits, most: u16) -> Option<Ramp> {
    let cap = cap.raw().min(limits.speed.raw()).max(2);
    let ticks = smallest(limits, Figure::Rate(cap)).map_or(most, |ticks| ticks.min(most));
    let (n1, rate) = split(ticks, limits);
    Ramp::new(
        PathRate::from_raw(rate.min(cap)),
        n1,
        ticks.saturating_sub(n1),
    )
}

/// Number of profile ticks from rest at the start to rest at the end, at [`super::Rate::FULL`] throughout. Zero for no
/// length.
pub(super) fn duration_ticks(length: Length, nominal: PathRate, ramp: &Ramp) -> u64 {
    ticks_in_units(
        units(length),
        nominal,
        (ramp.ticks() as u16, ramp.cap().raw()),
    )
}

/// The ticks with a ramp of this many ticks to the rate `cap`.
#[inline(never)]
fn ticks_in_units(units: u64, nominal: PathRate, (ticks, cap): (u16, u32)) -> u64 {
    if units == 0 {
        return 0;
    }
    let ticks = u64::from(ticks);
    let share = units.checked_div(ticks).unwrap_or(0);
    let level = u64::from(nominal.raw().min(cap)).min(share).max(1);
    mul_div_up(units, 1, level).saturating_add(ticks)
}

/// The best split of `m` ticks, and the rate (1/256 nm per tick) that this split makes possible.
#[inline(never)]
fn split(m: u16, limits: &PathLimits) -> (u16, u32) {
    let ratio = limits
        .acceleration
        .checked_div(limits.jerk)
        .unwrap_or(u64::MAX);
    let crossing = u16::try_from(u64::from(m).saturating_sub(ratio)).unwrap_or(0);
    let most = m.saturating_sub(1).max(1);
    let half = m.div_ceil(2).min(most).max(1);
    let mut best = (half, 0);
    for n1 in [half, crossing.saturating_sub(1), crossing] {
        let n1 = n1.max(half).min(most);
        let n2 = m.saturating_sub(n1).max(1);
        // 2⁻³² nm to 1/256 nm. Values that saturate are beyond any cap.
        let by_accel = limits.acceleration.saturating_mul(u64::from(n1));
        let product = u32::from(n1).wrapping_mul(u32::from(n2));
        let by_jerk = limits.jerk.saturating_mul(u64::from(product));
        let rate = u32::try_from(by_accel.min(by_jerk) >> 24).unwrap_or(u32::MAX);
        if rate > best.1 {
            best = (n1, rate);
        }
    }
    best
}

/// The condition for which a ramp is searched.
#[derive(Clone, Copy)]
enum Figure {
    /// The ramp reaches this rate.
    Rate(u32),
    /// At its rate, or at the first value if that is less, the ramp's ticks make a longer way than the second value.
    Way(u32, u64),
}

/// The smallest ramp of 2…[`CAPACITY`] ticks that meets the condition; all longer ramps meet it too.
#[inline(never)]
fn smallest(limits: &PathLimits, figure: Figure) -> Option<u16> {
    let (mut low, mut high) = (2_u16, CAPACITY.wrapping_add(1));
    while low < high {
        let middle = low.midpoint(high);
        let (_, rate) = split(middle, limits);
        let enough = match figure {
            Figure::Rate(least) => rate >= least,
            Figure::Way(most, way) => {
                u64::from(rate.min(most)).wrapping_mul(u64::from(middle)) > way
            }
        };
        if enough {
            high = middle;
        } else {
            low = middle.saturating_add(1);
        }
    }
    (low <= CAPACITY).then_some(low)
}

const fn units(length: Length) -> u64 {
    if length.nm() < 0 {
        0
    } else {
        (length.nm() as u64) << 8
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    fn limits(speed: u32, acceleration: u64, jerk: u64) -> PathLimits {
        PathLimits {
            speed: PathRate::from_raw(speed),
            acceleration: acceleration << 24,
            jerk: jerk << 24,
        }
    }

    fn nm(nm: i64) -> Length {
        Length::from_nm(nm)
    }

    /// Figures in the units of this module: speed, acceleration and jerk in 1/256 nm per tick, tick², tick³.
    #[test]
    fn hand_worked_full_ramps() {
        // v = 1000, a = 100, j = 20: n1 = 10, n2 = 1000 / (10·20) = 5.
        let ramp = ramp(
            nm(1_000),
            PathRate::from_raw(1_000),
            &limits(1_000, 100, 20),
        )
        .unwrap();
        assert_eq!((ramp.cap().raw(), ramp.means()), (1_000, (10, 5)));
        // 256 000 units at 1000: 256 ticks, and 15 for the ramp.
        assert_eq!(
            duration_ticks(nm(1_000), PathRate::from_raw(1_000), &ramp),
            271
        );
    }

    #[test]
    fn hand_worked_jerk_only() {
        // The acceleration limit is never reached: n1·n2 ≥ v / j = 100. The best split is 10 + 10, not 1 + 100.
        let ramp = ramp(
            nm(1_000),
            PathRate::from_raw(1_000),
            &limits(1_000, 1_000, 10),
        )
        .unwrap();
        assert_eq!((ramp.cap().raw(), ramp.means()), (1_000, (10, 10)));
    }

    #[test]
    fn hand_worked_short_move() {
        // 25 nm = 6400 units. The acceleration limit has no effect, j = 1: m ticks allow a rate of (m/2)² and need a
        // way of m·(m/2)² = m³/4 ≤ 6400. m = 29 with n = (15, 14) has v = 210 and needs 6090 units; 30 with (15, 15)
        // allows 225 but has only 6400 / 30 = 213. Ticks with 29: ⌈6400/210⌉ + 29 = 31 + 29 = 60. Ticks with 30:
        // ⌈6400/213⌉ + 30 = 31 + 30 = 61.
        let ramp = ramp(nm(25), PathRate::from_raw(1_000), &limits(1_000, 1_000, 1)).unwrap();
        assert_eq!((ramp.cap().raw(), ramp.means()), (210, (15, 14)));
        assert_eq!(duration_ticks(nm(25), PathRate::from_raw(1_000), &ramp), 60);
    }

    #[test]
    fn a_feed_keeps_room_for_the_override_where_it_costs_nothing() {
        // Nominal 100 of a cap of 150. A long move has room for the whole override.
        let limits = limits(150, 1_000, 1);
        let long = ramp(nm(1_000), PathRate::from_raw(100), &limits).unwrap();
        assert_eq!(long.cap().raw(), 150);
        // 9 nm = 2304 units: 25 ticks (150) would need 2500 at 100 per tick; 23 (12·11 = 132) need 2300.
        let short = ramp(nm(9), PathRate::from_raw(100), &limits).unwrap();
        assert_eq!((short.cap().raw(), short.means()), (132, (12, 11)));
    }

    #[test]
    fn refuses_ramps_beyond_the_capacity() {
        let limits = limits(u32::MAX, 1_000, 1);
        assert_eq!(ramp(nm(1 << 40), limits.speed, &limits), None);
        assert_eq!(
            ramp(nm(1_000), limits.speed, &limits).map(|r| r.ticks() < 2048),
            Some(true)
        );
    }

    /// No other ramp of two means is quicker.
    #[test]
    fn no_other_ramp_is_quicker() {
        leadscrew_seed::volume(7, |seed| {
            let mut random = leadscrew_seed::Random(seed);
            let mut random = |range| 1 + random.below(range);
            for _ in 0..300 {
                let limits = limits(random(600) as u32 + 1, random(60), random(30));
                let length = nm(random(60) as i64);
                let nominal = limits.speed;
                let chosen =
                    duration_ticks(length, nominal, &ramp(length, nominal, &limits).unwrap());
                let mut best = u64::MAX;
                for n1 in 1..64_u16 {
                    for n2 in 1..64_u16 {
                        let v = (limits.acceleration >> 24) * u64::from(n1);
                        let v = v.min((limits.jerk >> 24) * u64::from(n1) * u64::from(n2));
                        let cap = PathRate::from_raw(limits.speed.raw().min(v as u32));
                        if let Some(other) = Ramp::new(cap, n1, n2) {
                            best = best.min(duration_ticks(length, nominal, &other));
                        }
                    }
                }
                assert!(chosen <= best, "{limits:?} {length:?}: {chosen} > {best}");
            }
        });
    }
}
