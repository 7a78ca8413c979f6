//! Directions and their sine and cosine, in integers.
//!
//! A quarter turn is cut into 64 steps; the step's sine and cosine come from a table and what is left, at most 1/128 of
//! a quarter turn, from a short series. Good to 2⁻⁵⁸: on a circle of 1 m radius that is 4·10⁻⁹ nm.

use super::Turns;
use super::plane;
use super::wide::{mul_high, narrow_div, signed_product};

/// A direction: an angle in 2⁻⁶⁴ turns, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Direction(u64);

/// π/2 in 2⁻⁶³.
const HALF_PI: u64 = 14_488_038_916_154_245_685;

/// 1/2π in 2⁻⁶⁴.
const TURNS_PER_RADIAN: i64 = 2_935_890_503_282_001_226;

/// sin(k/64 of a quarter turn) in 2⁻⁶², rounded to the nearest.
#[rustfmt::skip]
const SINES: [i64; 65] = [
    0, 113_176_440_454_146_016, 226_284_707_652_502_141,
    339_256_669_404_298_611, 452_024_275_624_069_880, 564_519_599_322_481_549,
    676_674_877_523_008_785, 788_422_552_079_819_562, 899_695_310_372_275_547,
    1_010_426_125_851_537_790, 1_120_548_298_414_853_464, 1_229_995_494_583_203_681,
    1_338_701_787_458_110_889, 1_446_601_696_433_537_347, 1_553_630_226_638_953_726,
    1_659_722_908_089_818_799, 1_764_815_834_521_887_442, 1_868_845_701_885_954_606,
    1_971_749_846_479_847_467, 2_073_466_282_694_696_471, 2_173_933_740_352_748_318,
    2_273_091_701_614_230_011, 2_370_880_437_431_032_621, 2_467_241_043_525_256_456,
    2_562_115_475_870_945_497, 2_655_446_585_657_638_225, 2_747_178_153_714_674_114,
    2_837_254_924_375_519_865, 2_925_622_638_761_716_784, 3_012_228_067_466_400_296,
    3_097_019_042_617_704_261, 3_179_944_489_302_736_311, 3_260_954_456_333_195_553,
    3_340_000_146_334_100_615, 3_417_033_945_137_503_676, 3_492_009_450_463_484_836,
    3_564_881_499_871_150_442, 3_635_606_197_962_798_751, 3_704_140_942_824_866_152,
    3_770_444_451_689_726_907, 3_834_476_785_802_888_710, 3_896_199_374_480_604_983,
    3_955_575_038_343_412_514, 4_012_568_011_711_599_423, 4_067_143_964_149_113_252,
    4_119_270_021_142_931_949, 4_168_914_783_905_441_250, 4_216_048_348_287_890_265,
    4_260_642_322_793_532_497, 4_302_669_845_679_601_858, 4_342_105_601_137_822_079,
    4_378_925_834_543_703_005, 4_413_108_366_765_438_139, 4_444_632_607_523_784_314,
    4_473_479_567_794_875_989, 4_499_631_871_248_503_178, 4_523_073_764_714_963_030,
    4_543_791_127_674_180_203, 4_561_771_480_761_380_163, 4_577_003_993_284_191_887,
    4_589_479_489_746_651_964, 4_599_190_455_376_180_266, 4_606_131_040_650_197_959,
    4_610_297_064_819_661_174, 4_611_686_018_427_387_904,
];

impl Direction {
    /// The zero direction.
    pub const ZERO: Self = Self(0);

    /// `raw` · 2⁻⁶⁴ turns.
    #[must_use]
    pub const fn from_raw(raw: u64) -> Self {
        Self(raw)
    }

    /// 2⁻⁶⁴ turns.
    #[must_use]
    pub const fn raw(self) -> u64 {
        self.0
    }

    /// An angle without its whole turns.
    #[must_use]
    pub const fn of_turns(turns: Turns) -> Self {
        Self((turns.raw() as u64) << 32)
    }

    /// This direction turned by `by`, in 2⁻⁶⁴ turns of either sign.
    #[must_use]
    pub const fn turned(self, by: i64) -> Self {
        Self(self.0.wrapping_add(by as u64))
    }

    /// Sine and cosine in 2⁻⁶², each within 2⁻⁵⁸; exact at the quarter turns. No division.
    #[must_use]
    pub fn sin_cos(self) -> (i64, i64) {
        let within = self.0 << 2;
        let step = (within >> 57).wrapping_add(1) >> 1;
        // At most 2⁵⁷ to either side.
        let rest = within.wrapping_sub(step << 58) as i64;
        let index = step as usize;
        let sine = SINES.get(index).copied().unwrap_or(0);
        let cosine = SINES
            .get(64_usize.wrapping_sub(index))
            .copied()
            .unwrap_or(0);

        // d, the rest in radians, 2⁻⁶⁹; below 2⁻⁶. d² in 2⁻⁷⁴, and its upper part in 2⁻⁴².
        let d = mul_high(rest.unsigned_abs() << 6, HALF_PI);
        let d2 = mul_high(d, d);
        let upper = d2 >> 32;
        // d⁴ in 2⁻⁵⁶: d² is below 2¹⁶ · 2⁻²⁸.
        let short = (upper >> 14) as u32;
        let d4 = short.wrapping_mul(short);
        // sin d = d·(1 − d²·(1/6 − d²/120 + d⁴/5040)), in 2⁻⁶⁹; the bracket in 2⁻⁶⁴.
        let bracket = (u64::MAX / 6)
            .wrapping_sub(upper.wrapping_mul(((1_u64 << 38) + 60) / 120) >> 16)
            .wrapping_add(u64::from(d4 / 5040) << 8);
        let less = mul_high(d2, bracket) << 5;
        let sin_d = d.wrapping_sub(mul_high(d, less) >> 15);
        // 1 − cos d = d²·(1/2 − d²/24 + d⁴/720), in 2⁻⁷⁴; the bracket in 2⁻⁶⁴.
        let bracket = (1_u64 << 63)
            .wrapping_sub(upper.wrapping_mul(((1_u64 << 35) + 12) / 24) >> 13)
            .wrapping_add(u64::from(d4 / 720) << 8);
        let versed = mul_high(d2, bracket);

        // sin(a + d), cos(a + d) for a and d ≥ 0; the sign of d changes the second term only.
        let by_versed = |part: i64| (mul_high(part as u64, versed << 3) >> 13) as i64;
        let by_sine = |part: i64| {
            let product = (mul_high(part as u64, sin_d << 1) >> 6) as i64;
            if rest < 0 {
                product.wrapping_neg()
            } else {
                product
            }
        };
        let sin = sine
            .wrapping_sub(by_versed(sine))
            .wrapping_add(by_sine(cosine));
        let cos = cosine
            .wrapping_sub(by_versed(cosine))
            .wrapping_sub(by_sine(sine));
        match self.0 >> 62 {
            0 => (sin, cos),
            1 => (cos, sin.wrapping_neg()),
            2 => (sin.wrapping_neg(), cos.wrapping_neg()),
            _ => (cos.wrapping_neg(), sin),
        }
    }

    /// The direction of a vector, from the first axis (`along`) towards the second (`across`); both within ±2⁴⁴. Zero
    /// for no vector. Within 2⁻⁵⁶ turns; 128-bit divisions, for the background.
    #[must_use]
    pub fn of_vector(along: i64, across: i64) -> Self {
        let (a, b) = (along.unsigned_abs(), across.unsigned_abs());
        if a == 0 && b == 0 {
            return Self::ZERO;
        }
        // Exact quarters, so that they stay exact.
        match (along.signum(), across.signum()) {
            (1, 0) => return Self::ZERO,
            (0, 1) => return Self(1 << 62),
            (-1, 0) => return Self(1 << 63),
            (0, -1) => return Self(3 << 62),
            _ => {}
        }
        // An eighth turn is taken to be straight: 0.07 rad wrong at most.
        let eighth = |part: u64, whole: u64| narrow_div(u128::from(part) << 61, whole);
        let guess = if b <= a {
            eighth(b, a)
        } else {
            (1_u64 << 62).wrapping_sub(eighth(a, b))
        };
        let guess = if along < 0 {
            (1_u64 << 63).wrapping_sub(guess)
        } else {
            guess
        };
        let phase = Self(if across < 0 {
            guess.wrapping_neg()
        } else {
            guess
        });

        // The unit vector in 2⁻⁶², from the vector times 2^shift to use the whole of the root.
        let shift = a.max(b).leading_zeros().saturating_sub(2);
        let radius = plane::length(a << shift, b << shift);
        let unit = |v: i64| {
            let size = u128::from(v.unsigned_abs()) << (shift.saturating_add(62));
            let size = narrow_div(size, radius) as i64;
            if v < 0 { size.wrapping_neg() } else { size }
        };
        let (unit_along, unit_across) = (unit(along), unit(across));
        // After two rounds nothing that counts is left.
        phase
            .nearer(unit_along, unit_across)
            .nearer(unit_along, unit_across)
    }

    /// Nearer to the direction of a unit vector in 2⁻⁶². The sine of what this one lacks gives the angle:
    /// asin s = s + s³/6 + 3·s⁵/40 + …
    #[inline(never)]
    fn nearer(self, along: i64, across: i64) -> Self {
        let times = |a: i64, b: i64| (signed_product(a, b) >> 62) as i64;
        let (sin, cos) = self.sin_cos();
        let s = signed_product(across, cos).wrapping_sub(signed_product(along, sin));
        let s = (s >> 62) as i64;
        let cube = times(times(s, s), s);
        self.turned(times(s.wrapping_add(cube / 6), TURNS_PER_RADIAN))
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    extern crate std;
    use super::*;

    const ONE: i64 = 1 << 62;

    /// Spread over the whole turn.
    fn samples(seed: u64) -> impl Iterator<Item = Direction> {
        // A seed has 60 bits; the whole turn has 64.
        let first = seed.rotate_left(4);
        (0..200_000_u64)
            .map(move |i| Direction(i.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(first)))
    }

    /// (sin, cos) · 2⁶² by complex multiplication of exact halvings in 2⁻¹²⁰; independent of the table and the series.
    fn reference(phase: Direction) -> (i128, i128) {
        // 90 bits: products of two stay within 180 bits, so multiply in halves.
        fn mul(a: i128, b: i128) -> i128 {
            // (ah·2⁴⁵ + al)·b >> 90 with |a|, |b| ≤ 2⁹⁰ is done in two steps of 45 bits.
            let (ah, al) = (a >> 45, a & ((1 << 45) - 1));
            let (bh, bl) = (b >> 45, b & ((1 << 45) - 1));
            ah * bh + ((ah * bl + al * bh + ((al * bl) >> 45)) >> 45)
        }
        const UNIT: i128 = 1 << 90;
        // cos of a half angle: √((1 + cos)/2), sin: sin / (2·cos half), from a quarter turn down.
        let (mut sin, mut cos) = (0_i128, UNIT);
        let (mut step_sin, mut step_cos) = (UNIT, 0_i128);
        let quarters = phase.0 >> 62;
        for bit in (0..62).rev() {
            let half_cos = root((UNIT + step_cos) / 2);
            let half_sin = div(step_sin, 2 * half_cos);
            (step_sin, step_cos) = (half_sin, half_cos);
            if phase.0 >> bit & 1 == 1 {
                (sin, cos) = (
                    mul(sin, step_cos) + mul(cos, step_sin),
                    mul(cos, step_cos) - mul(sin, step_sin),
                );
            }
        }
        fn root(v: i128) -> i128 {
            // √(v·2⁹⁰): Newton from above, v ≥ ½.
            let mut r = UNIT;
            for _ in 0..8 {
                r = (r + div(v, r)) / 2;
            }
            r
        }
        fn div(a: i128, b: i128) -> i128 {
            // a·2⁹⁰ / b in three steps of 30 bits.
            let (mut q, mut r) = (a / b, a % b);
            for _ in 0..3 {
                q = (q << 30) + (r << 30) / b;
                r = (r << 30) % b;
            }
            q
        }
        let (sin, cos) = match quarters {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        };
        (sin >> 28, cos >> 28)
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(Direction(0).sin_cos(), (0, ONE));
        assert_eq!(Direction(1 << 62).sin_cos(), (ONE, 0));
        assert_eq!(Direction(2 << 62).sin_cos(), (0, -ONE));
        assert_eq!(Direction(3 << 62).sin_cos(), (-ONE, 0));
        assert_eq!(
            Direction::of_turns(Turns::from_raw(-(1 << 30))),
            Direction(3 << 62)
        );
    }

    #[test]
    fn agrees_with_halved_angles_to_2_to_the_minus_58() {
        leadscrew_seed::volume(0, |seed| {
            let mut worst = 0;
            for phase in samples(seed).take(4_000) {
                let (sin, cos) = phase.sin_cos();
                let (exact_sin, exact_cos) = reference(phase);
                worst = worst
                    .max((i128::from(sin) - exact_sin).abs())
                    .max((i128::from(cos) - exact_cos).abs());
            }
            assert!(worst <= 1 << 4, "{worst}");
        });
    }

    #[test]
    fn agrees_with_floats_everywhere() {
        leadscrew_seed::volume(0, |seed| {
            for phase in samples(seed) {
                let angle = phase.0 as f64 / 2_f64.powi(64) * std::f64::consts::TAU;
                let (sin, cos) = phase.sin_cos();
                assert!((sin as f64 / ONE as f64 - angle.sin()).abs() < 2e-15);
                assert!((cos as f64 / ONE as f64 - angle.cos()).abs() < 2e-15);
            }
        });
    }

    #[test]
    fn neighbours_across_a_table_step_agree() {
        for step in 0..256_u64 {
            let edge = (step << 56) + (1 << 55);
            let (below, above) = (Direction(edge - 1).sin_cos(), Direction(edge).sin_cos());
            assert!((below.0 - above.0).abs() <= 1 << 4, "{step}");
            assert!((below.1 - above.1).abs() <= 1 << 4, "{step}");
        }
    }

    #[test]
    fn direction_is_the_inverse() {
        leadscrew_seed::volume(0, |seed| {
            for phase in samples(seed).take(20_000) {
                for bits in [3, 20, 43] {
                    let (sin, cos) = phase.sin_cos();
                    let (along, across) = (cos >> (62 - bits), sin >> (62 - bits));
                    let (sin, cos) = Direction::of_vector(along, across).sin_cos();
                    if (along, across) == (0, 0) {
                        continue;
                    }
                    // The cross product vanishes, the dot product does not.
                    let cross =
                        i128::from(along) * i128::from(sin) - i128::from(across) * i128::from(cos);
                    let dot =
                        i128::from(along) * i128::from(cos) + i128::from(across) * i128::from(sin);
                    assert!(dot > 0);
                    assert!(
                        cross.abs() <= dot >> 53,
                        "{along} {across}: {}",
                        (dot / cross.abs()).ilog2()
                    );
                }
            }
            assert_eq!(Direction::of_vector(0, 0), Direction::ZERO);
            assert_eq!(Direction::of_vector(-5, 0), Direction(1 << 63));
        });
    }
}
