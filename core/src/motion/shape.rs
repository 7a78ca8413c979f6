//! Choosing the ramp of a motion: the two means that get it to its end soonest within the limits of its path.
//!
//! Knows numbers only. Of all ramps of m ticks the best splits them so that the rate it may reach, the least of a·n1 and
//! j·n1·n2 with n1 + n2 = m, is largest; that rate grows with m, so everything here is a search over m.

use super::limits::PathLimits;
use super::profile::{CAPACITY, Ramp};
use super::rate::PathRate;
use crate::units::Length;

/// The ramp for a motion of `length` at `nominal`, able to go up to `limits.speed`.
///
/// A motion too short for that top speed gets the shorter ramp of the lower speed that is quickest at `nominal`. `None`
/// where the ramp would be longer than [`CAPACITY`] ticks.
pub(super) fn ramp(length: Length, nominal: PathRate, limits: &PathLimits) -> Option<Ramp> {
    let units = units(length);
    let cap = limits.speed.raw().max(2);
    let goal = nominal.raw().min(cap).max(1);
    let fastest = |m: u16| split(m, limits).1;

    let least = smallest(|m| fastest(m) >= 2)?;
    let full = smallest(|m| fastest(m) >= cap);
    // The first ramp for which the motion is too short.
    let over = smallest(|m| u64::from(fastest(m).min(goal)).saturating_mul(u64::from(m)) > units);

    let (own, other) = match (full, over) {
        (Some(full), over) if over.is_none_or(|over| over > full) => {
            // Where nobody can go faster than `goal`, a tick less of ramp may be worth a little less speed.
            let shorter = full.saturating_sub(1);
            let other = if goal == cap && shorter >= least {
                build(shorter, fastest(shorter).min(cap), limits)
            } else {
                None
            };
            (build(full, cap, limits), other)
        }
        (_, Some(over)) => {
            let m = over.max(least);
            let share = units.checked_div(u64::from(m)).unwrap_or(0);
            let share = u32::try_from(share).unwrap_or(u32::MAX).clamp(2, cap);
            let shorter = over.saturating_sub(1);
            let other = if shorter >= least {
                build(shorter, fastest(shorter).min(cap), limits)
            } else {
                None
            };
            (build(m, share, limits), other)
        }
        (_, None) => return None,
    };
    match (own, other) {
        (Some(own), Some(other)) => {
            if ticks_in_units(units, nominal, &other) <= ticks_in_units(units, nominal, &own) {
                Some(other)
            } else {
                Some(own)
            }
        }
        (own, other) => own.or(other),
    }
}

/// Ticks from the start at rest to rest at the end, at [`super::Rate::FULL`] throughout: how often the profile ticks
/// until it is done. Zero for no length.
pub(super) fn duration_ticks(length: Length, nominal: PathRate, ramp: &Ramp) -> u64 {
    ticks_in_units(units(length), nominal, ramp)
}

fn ticks_in_units(units: u64, nominal: PathRate, ramp: &Ramp) -> u64 {
    if units == 0 {
        return 0;
    }
    let ticks = u64::from(ramp.ticks());
    let share = units.checked_div(ticks).unwrap_or(0);
    let level = u64::from(nominal.min(ramp.cap()).raw()).min(share).max(1);
    units.div_ceil(level.max(1)).saturating_add(ticks)
}

/// How `m` ticks are best split, and the rate (1/256 nm per tick) that makes possible.
fn split(m: u16, limits: &PathLimits) -> (u16, u32) {
    let ratio = limits
        .acceleration
        .checked_div(limits.jerk)
        .unwrap_or(u64::MAX);
    let crossing = u16::try_from(u64::from(m).saturating_sub(ratio)).unwrap_or(0);
    let most = m.saturating_sub(1).max(1);
    let half = m.div_ceil(2).min(most).max(1);
    [half, crossing.saturating_sub(1), crossing]
        .into_iter()
        .map(|n1| {
            let n1 = n1.max(half).min(most);
            let n2 = m.saturating_sub(n1).max(1);
            // 2⁻³² nm to 1/256 nm. What saturates is beyond any cap.
            let by_accel = limits.acceleration.saturating_mul(u64::from(n1)) >> 24;
            let by_jerk = limits
                .jerk
                .saturating_mul(u64::from(n1))
                .saturating_mul(u64::from(n2))
                >> 24;
            let rate = by_accel.min(by_jerk).min(u64::from(u32::MAX));
            (n1, rate as u32)
        })
        .fold(
            (half, 0),
            |best, next| if next.1 > best.1 { next } else { best },
        )
}

fn build(m: u16, rate: u32, limits: &PathLimits) -> Option<Ramp> {
    let (n1, _) = split(m, limits);
    Ramp::new(PathRate::from_raw(rate), n1, m.saturating_sub(n1))
}

/// The smallest ramp, 2…[`CAPACITY`] ticks, for which `enough` is true; it must stay true from there on.
fn smallest(enough: impl Fn(u16) -> bool) -> Option<u16> {
    let (mut low, mut high) = (2_u16, CAPACITY);
    if !enough(high) {
        return None;
    }
    while low < high {
        let middle = low.midpoint(high);
        if enough(middle) {
            high = middle;
        } else {
            low = middle.saturating_add(1);
        }
    }
    Some(low)
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

    /// Units of this module: speed, acceleration and jerk in 1/256 nm per tick, tick², tick³.
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
        // The acceleration limit is never reached: n1·n2 ≥ v / j = 100, best as 10 + 10, not as 1 + 100.
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
        // 25 nm = 6400 units. a is out of the way, j = 1: m ticks allow (m/2)², needing m·(m/2)² = m³/4 ≤ 6400: m = 29
        // with n = (15, 14), v = 210, 6090 units; 30 with (15, 15) allows 225 but has only 6400 / 30 = 213.
        // 29: ⌈6400/210⌉ + 29 = 31 + 29 = 60. 30: ⌈6400/213⌉ + 30 = 31 + 30 = 61.
        let ramp = ramp(nm(25), PathRate::from_raw(1_000), &limits(1_000, 1_000, 1)).unwrap();
        assert_eq!((ramp.cap().raw(), ramp.means()), (210, (15, 14)));
        assert_eq!(duration_ticks(nm(25), PathRate::from_raw(1_000), &ramp), 60);
    }

    #[test]
    fn a_feed_keeps_room_for_the_override_where_it_costs_nothing() {
        // Nominal 100 of a cap of 150. Long: room for the whole override.
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

    /// No ramp of the family gets there sooner.
    #[test]
    fn no_other_ramp_is_quicker() {
        let mut state = 7_u64;
        let mut random = |range: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            1 + (state >> 33) % range
        };
        for _ in 0..300 {
            let limits = limits(random(600) as u32 + 1, random(60), random(30));
            let length = nm(random(60) as i64);
            let nominal = limits.speed;
            let chosen = duration_ticks(length, nominal, &ramp(length, nominal, &limits).unwrap());
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
    }
}
