//! The errors of a screw's pitch (1861, 1862, 1871 to 1886): the curve through them, and what it takes of the limits of an
//! axis.
//!
//! An error e is where the slide is, less where it should be, at [`POINTS`] places of one spacing h. The drive is told
//! so much less. (That it then stands elsewhere by e, where the error is another by e·e′, is left: 0.1 µm for 400 µm a
//! metre.) Between two points, u of the spacing behind the first, the curve goes from the parabola through that point
//! and its neighbours to the one of the next point and its neighbours:
//!
//! ```text
//! e(u) = e₀ + u·Δ − ½·u·(1 − u)·(D₀ + (D₁ − D₀)·u²·(3 − 2u))     Δ = e₁ − e₀; D: second difference at a point
//! ```
//!
//! At a point it has the value of the table, and slope and curvature of that point's parabola from both sides. Beyond the
//! ends the first and the last value go on as further points. With S, D and E as the largest first, second and third
//! differences, slope, curvature and its change are at most
//!
//! ```text
//! 7/4·S/h     2.53·D/h²     9·E/h³
//! ```

use core::num::NonZeroU32;

use super::Params;
use super::target::Highest;
use crate::units::{Axis, mul_div};

/// Place of the last value.
const LAST: usize = POINTS as usize - 1;

/// Points of a table.
const POINTS: u8 = 16;

/// What is taken off for errors of the pitch may use one part in so many of the axis' acceleration and jerk, and the motion
/// of the axis has none of it.
pub(super) const PITCH_PART: u64 = 25;

/// The largest change of the error from point to point is one part in so many of the spacing: 5 µm a millimetre.
pub(super) const STEEPEST: u64 = 200;

/// Nanometres of a micrometre: a table begins at a whole one.
const MICROMETRE: i64 = 1_000;

/// The largest error of a table, in nanometres.
pub(super) const LARGEST_PITCH_ERROR: i64 = 1_000_000;

/// A step of the table in nanometres.
const STEP: i32 = 100;

/// Spacings from one before the first point to one behind the last: beyond them nothing changes.
const SPACINGS: u32 = POINTS as u32 + 1;

/// Binary places of u.
const PLACES: u32 = 27;

/// Binary places of u in a nanometre times [`PitchCurve::pace`] that are not needed.
const FINER: u32 = 25;

/// The errors of an axis over its places. It has no state: at a place there is one error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PitchCurve {
    /// A spacing before the first point, in whole micrometres.
    from: i32,
    /// 1/h with [`PLACES`] + [`FINER`].
    pace: NonZeroU32,
    /// In steps of the table.
    values: [i16; POINTS as usize],
}

impl PitchCurve {
    /// Of X or Z. `None` where all errors are zero.
    pub fn of(params: &Params, axis: Axis) -> Option<Self> {
        let values = params.pitch_errors(axis)?;
        if values == [0; POINTS as usize] {
            return None;
        }
        let spacing = params.pitch_error_spacing(axis)?;
        let origin = params.pitch_error_origin(axis)?;
        let pace = (1_u64 << (PLACES + FINER)).checked_div(spacing.try_into().ok()?)?;
        let from = origin.wrapping_sub(spacing).checked_div(MICROMETRE)?;
        Some(Self {
            from: i32::try_from(from).ok()?,
            pace: NonZeroU32::new(u32::try_from(pace).ok()?)?,
            values,
        })
    }

    /// The error where the slide is to be at this place, in nanometres.
    #[inline(never)]
    pub fn at(&self, place: i64) -> i64 {
        let from = i64::from(self.from).wrapping_mul(MICROMETRE);
        let way = place.wrapping_sub(from).max(0).min(u32::MAX.into()) as u32;
        let fine = u64::from(way).wrapping_mul(u64::from(self.pace.get())) >> FINER;
        let fine = fine.min(u64::from(SPACINGS) << PLACES);
        let (point, u) = ((fine >> PLACES) as usize, fine as u32 & (ONE - 1));
        // The first point is 1.
        let value = |point: usize| {
            let place = point.saturating_sub(1).min(LAST);
            i32::from(self.values.get(place).copied().unwrap_or(0)).wrapping_mul(STEP)
        };
        let before = value(point.saturating_sub(1));
        let (first, second) = (value(point), value(point.wrapping_add(1)));
        let behind = value(point.wrapping_add(2));
        let step = second.wrapping_sub(first);
        let bend = step.wrapping_sub(first.wrapping_sub(before));
        let bend_behind = behind.wrapping_sub(second).wrapping_sub(step);
        // u², below 1; u²·(3 − 2u); u·(1 − u).
        let square = scaled(u, u);
        let gone = scaled(square, (3 * ONE).wrapping_sub(u.wrapping_mul(2)));
        let bow = scaled(u, ONE.wrapping_sub(u));
        let bend = i64::from(bend)
            .wrapping_add(product(bend_behind.wrapping_sub(bend), gone) >> PLACES)
            as i32;
        let part = product(step, u).wrapping_sub(product(bend, bow) >> 1);
        i64::from(first).wrapping_add(part.wrapping_add(HALF) >> PLACES)
    }

    /// The place of the slide where its drive is at this one, to a nanometre.
    pub fn place(&self, drive: i64) -> i64 {
        // Each time what is missing becomes 7/8 of a per cent of it at most; the range of an error is 1 mm.
        let mut place = drive;
        for _ in 0..4 {
            place = drive.wrapping_add(self.at(place));
        }
        place
    }
}

/// One, of u.
const ONE: u32 = 1 << PLACES;
const HALF: i64 = 1 << (PLACES - 1);

/// A product of two that have [`PLACES`], with as many.
const fn scaled(a: u32, b: u32) -> u32 {
    ((a as u64).wrapping_mul(b as u64) >> PLACES) as u32
}

const fn product(a: i32, share: u32) -> i64 {
    (a as i64).wrapping_mul(share as i32 as i64)
}

/// Why a table cannot be taken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unusable {
    /// From this point to the next it changes by so many tenths of a micrometre a millimetre.
    Steep { point: u8, slope: u64 },
    /// About this point, at the rapid rate, it takes so many tenths of a per cent of acceleration or jerk.
    Bent { point: u8, share: u64 },
}

impl Params {
    /// The errors of X or Z, in tenths of a micrometre.
    fn pitch_errors(&self, axis: Axis) -> Option<[i16; POINTS as usize]> {
        let mut values = [0; POINTS as usize];
        for (value, point) in values.iter_mut().zip(1..) {
            let [x, z] = self.pitch_error(point);
            *value = match axis {
                Axis::X => x,
                Axis::Z => z,
                Axis::C => return None,
            };
        }
        Some(values)
    }

    pub(super) fn has_pitch_errors(&self, axis: Axis) -> bool {
        (1..=POINTS).any(|point| {
            let [x, z] = self.pitch_error(point);
            match axis {
                Axis::X => x != 0,
                Axis::Z => z != 0,
                Axis::C => false,
            }
        })
    }

    /// Why the errors of an axis cannot be taken off.
    pub(super) fn unusable_pitch(&self, axis: Axis) -> Option<Unusable> {
        let curve = PitchCurve::of(self, axis)?;
        let spacing = self.pitch_error_spacing(axis)?.unsigned_abs();
        // Point 0 is the one before the first.
        let value = |point: u8| {
            let place = usize::from(point.clamp(1, POINTS).saturating_sub(1));
            i64::from(curve.values.get(place).copied().unwrap_or(0)).wrapping_mul(STEP.into())
        };
        let step = |point: u8| value(point.saturating_add(1)).wrapping_sub(value(point));
        let bend = |point: u8| match point {
            0 => 0,
            _ => step(point).wrapping_sub(step(point.saturating_sub(1))),
        };
        let of = |amount: i64, n: u64, d: u64| mul_div(amount.unsigned_abs(), n, d);
        let mut worst = None;
        let mut steepest = 0;
        for point in 1..POINTS {
            let amount = step(point).unsigned_abs();
            steepest = amount.max(steepest);
            if amount.saturating_mul(STEEPEST) > spacing {
                // Rounded up, so that it is more than is allowed.
                let slope = amount.saturating_mul(10_000).div_ceil(spacing.max(1));
                return Some(Unusable::Steep { point, slope });
            }
        }
        // Spacings in 2²⁰ seconds at the rapid rate, the acceleration and the jerk of the axis.
        let rapid = self.rapid(axis).nm_per_min().unsigned_abs();
        let pace = mul_div(rapid, 1 << 20, spacing.saturating_mul(60));
        let Highest { acceleration, jerk } = self.highest(axis);
        let paced = |amount: u64| mul_div(amount, pace, 1 << 20);
        for point in 0..=POINTS {
            let (here, next) = (bend(point), bend(point.saturating_add(1)));
            let bent = here
                .unsigned_abs()
                .max(next.unsigned_abs())
                .saturating_mul(253)
                / 100;
            let turned = next.abs_diff(here).saturating_mul(9);
            let inclined = |limit| of(steepest as i64, limit, spacing).saturating_mul(7) / 4;
            let a = inclined(acceleration).saturating_add(paced(paced(bent)));
            let j = inclined(jerk)
                .saturating_add(mul_div(paced(bent), acceleration, spacing).saturating_mul(3))
                .saturating_add(paced(paced(paced(turned))));
            let share = mul_div(a, 1000, acceleration).max(mul_div(j, 1000, jerk));
            if share >= 1000 / PITCH_PART && worst.is_none_or(|(_, most)| share > most) {
                worst = Some((point.max(1), share));
            }
        }
        worst.map(|(point, share)| Unusable::Bent { point, share })
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::params::Entry;
    use leadscrew_seed::{amount, volume};

    /// 1 mm = 10⁶ nm.
    const MM: i64 = 1_000_000;

    fn set(params: &mut Params, key: &str, raw: i64) -> bool {
        params.set(Entry::find_text(key).unwrap(), raw).is_ok()
    }

    /// Errors of Z in tenths of a micrometre from an origin on, in millimetres.
    fn with(origin: i64, spacing: i64, errors: &[i64]) -> Params {
        let mut params = Params::slant_bed();
        assert!(set(&mut params, "1861.Z", origin * MM));
        assert!(set(&mut params, "1862.Z", spacing * MM));
        for (number, error) in (1871..).zip(errors) {
            assert!(set(&mut params, &std::format!("{number}.Z"), *error));
        }
        params
    }

    fn curve(params: &Params) -> PitchCurve {
        PitchCurve::of(params, Axis::Z).unwrap()
    }

    #[test]
    fn at_a_point_it_is_the_value_and_beyond_the_ends_the_last_one() {
        let errors: Vec<i64> = (0..16).map(|k| 37 - 11 * k + 3 * k * k).collect();
        let params = with(-250, 25, &errors);
        let curve = curve(&params);
        for (k, error) in (0..).zip(&errors) {
            assert_eq!(curve.at((-250 + 25 * k) * MM), 100 * error, "{k}");
        }
        for (place, error) in [(-275, 37), (-10_000, 37), (150, 547), (10_000, 547)] {
            assert_eq!(curve.at(place * MM), 100 * error, "{place}");
        }
        assert_eq!(PitchCurve::of(&params, Axis::X), None);
        assert_eq!(PitchCurve::of(&params, Axis::C), None);
        assert_eq!(PitchCurve::of(&Params::slant_bed(), Axis::Z), None);
        // A straight error stays straight between its points.
        let straight: Vec<i64> = (0..16).map(|k| 20 * k).collect();
        let params = with(0, 10, &straight);
        assert_eq!(
            super::PitchCurve::of(&params, Axis::Z)
                .unwrap()
                .at(54_321_000),
            10_864
        );
    }

    /// By the formula of the header in floating point, with its bounds of slope and curvature; and back again.
    #[test]
    fn the_curve_is_the_one_that_is_stated_and_bends_no_more_than_that() {
        volume(0x1871, |seed| {
            let mut state = seed;
            for _ in 0..amount(20, 2_000) {
                let mut draw = |least: i64, most: i64| {
                    state = state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(1);
                    least + (state >> 33) as i64 % (most - least + 1)
                };
                let (origin, spacing) = (draw(-900, 900), draw(2, 200));
                let most = 10 * 5 * spacing;
                let mut last = draw(-500, 500);
                let errors: Vec<i64> = (0..16)
                    .map(|_| {
                        last = (last + draw(-most, most)).clamp(-10_000, 10_000);
                        last
                    })
                    .collect();
                let params = with(origin, spacing, &errors);
                let Some(curve) = PitchCurve::of(&params, Axis::Z) else {
                    continue;
                };
                let value = |k: i64| 100.0 * errors[k.clamp(0, 15) as usize] as f64;
                let bend = |k: i64| value(k + 1) - 2.0 * value(k) + value(k - 1);
                let stated = |k: i64, u: f64| {
                    let (one, other) = (bend(k), bend(k + 1));
                    let bent = one + (other - one) * u * u * (3.0 - 2.0 * u);
                    value(k) + u * (value(k + 1) - value(k)) - 0.5 * u * (1.0 - u) * bent
                };
                let largest =
                    |of: &dyn Fn(i64) -> f64| (-2..18).map(|k| of(k).abs()).fold(0.0, f64::max);
                let s = largest(&|k| value(k + 1) - value(k));
                let d = largest(&bend);
                let e = largest(&|k| bend(k + 1) - bend(k));
                let h = 1.0 / 64.0;
                for _ in 0..50 {
                    let place = (origin - 2 * spacing) * MM + draw(0, 20 * spacing * MM);
                    let way = (place - origin * MM) as f64 / (spacing * MM) as f64;
                    let (k, u) = (way.floor() as i64, way - way.floor());
                    let told = curve.at(place);
                    let off = told as f64 - stated(k, u);
                    assert!(off.abs() <= 1.5, "{told} {off} at {place}: {errors:?}");
                    let slide = curve.place(place);
                    assert!((slide - curve.at(slide) - place).abs() <= 1, "{place}");
                    // The derivatives, of a piece.
                    let u = u.clamp(2.0 * h, 1.0 - 2.0 * h);
                    let at = |n: f64| stated(k, u + n * h);
                    let slope = (at(1.0) - at(-1.0)) / (2.0 * h);
                    let bow = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (h * h);
                    let turn =
                        (at(2.0) - 2.0 * at(1.0) + 2.0 * at(-1.0) - at(-2.0)) / (2.0 * h * h * h);
                    assert!(slope.abs() <= 1.75 * s + 1e-3, "{slope}, {s}");
                    assert!(bow.abs() <= 2.53 * d + 1e-3, "{bow}, {d}");
                    assert!(turn.abs() <= 9.0 * e + 1e-1, "{turn}, {e}");
                }
            }
        });
    }

    /// Whatever the table and the limits are: where the set is taken, what is taken off keeps its part of the limits, in
    /// any motion within them.
    #[test]
    fn what_is_taken_off_keeps_its_part_of_the_limits() {
        volume(0x1861, |seed| {
            let mut state = seed;
            let (mut taken, mut refused) = (0, 0);
            for _ in 0..amount(150, 6_000) {
                let mut draw = |least: i64, most: i64| {
                    state = state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(1);
                    least + (state >> 33) as i64 % (most - least + 1)
                };
                let spacing = draw(2, 40);
                let most = [2, 10, 50][draw(0, 2) as usize] * spacing;
                let errors: Vec<i64> = (0..16).map(|_| draw(0, most)).collect();
                let mut params = with(-100, spacing, &errors);
                let tick_us = [500, 1_000, 2_000][draw(0, 2) as usize];
                let jerk = 1_000_000_000 * draw(20, 2_000);
                let acceleration = 100_000_000 * draw(5, 100);
                let rapid = 60_000_000 * draw(20, 500);
                let all = set(&mut params, "9000", tick_us)
                    && set(&mut params, "1620.Z", acceleration)
                    && set(&mut params, "1622.Z", jerk)
                    && set(&mut params, "1420.Z", rapid);
                assert!(all);
                if params.unusable_pitch(Axis::Z).is_some() {
                    refused += 1;
                    continue;
                }
                let Some(curve) = PitchCurve::of(&params, Axis::Z) else {
                    continue;
                };
                taken += 1;
                // Speeds at random, over two running means, which hold acceleration and jerk.
                let seconds = tick_us as f64 / 1e6;
                let speed = rapid as f64 / 60.0 * seconds;
                let a = acceleration as f64 * seconds.powi(2);
                let j = jerk as f64 * seconds.powi(3);
                let longer = (2.0 * speed / a).ceil() as usize;
                let shorter = (2.0 * speed / longer as f64 / j).ceil() as usize;
                let mut means = [std::vec![0.0; longer], std::vec![0.0; shorter]];
                let mut place = -120.0 * MM as f64;
                let mut wanted = speed;
                let mut all = Vec::new();
                for k in 0..1_500 {
                    if k % (longer + shorter + 20) == 0 {
                        let there = (place / MM as f64 + 100.0) / (16 * spacing) as f64;
                        wanted = if there > 0.5 { -speed } else { speed };
                    }
                    let mut now = wanted;
                    for mean in &mut means {
                        let length = mean.len();
                        mean[k % length] = now;
                        now = mean.iter().sum::<f64>() / length as f64;
                    }
                    place += now;
                    all.push(curve.at(place.round() as i64));
                }
                let part = PITCH_PART as f64;
                for four in all.windows(4) {
                    let turn = four[3] - 3 * four[2] + 3 * four[1] - four[0];
                    let bow = four[2] - 2 * four[1] + four[0];
                    // Three and four roundings to a nanometre.
                    assert!(
                        bow.abs() as f64 <= a / part + 2.5,
                        "{bow} above {a}: {params:?}"
                    );
                    assert!(
                        turn.abs() as f64 <= j / part + 5.0,
                        "{turn} above {j}: {params:?}"
                    );
                }
            }
            assert!(taken > 30 && refused > 10, "{taken} {refused}");
        });
    }
}
