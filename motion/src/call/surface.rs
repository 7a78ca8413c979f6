//! Constant surface speed: the spindle turns faster the nearer the tool is to the centre [G96].
//!
//! Interpreter and tick use the same law, so that a feed per turn is planned for the speed that the spindle will have.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::{Feed, Length, Rpm, mul_high};

/// The law of a spindle under constant surface speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct SurfaceSpeed {
    /// Speed of the surface under the tool.
    pub speed: Feed,
    /// Machine coordinate of the spindle's axis in X; radii count from there.
    pub centre: Length,
    /// Least spindle speed (3771).
    pub least: u32,
    /// Highest spindle speed (G50 S, 3772). Where it is below the least, this one holds.
    pub most: u32,
}

/// 1000 / 2π · 2⁻⁸, 2⁻⁶⁴.
const PER_RADIUS: u64 = 0x9F27_AA59_B86E_7CAB;

impl SurfaceSpeed {
    /// Magnitude of the spindle speed with the tool at machine coordinate `x`, in thousandths of a turn per minute, rounded
    /// to the nearest. On the centre the highest speed holds.
    #[must_use]
    pub fn milli_rpm(&self, x: Length) -> u32 {
        let [least, most] = [self.least, self.most].map(|rpm| u64::from(rpm).saturating_mul(1000));
        let radius = (x - self.centre).nm().unsigned_abs();
        let turns = self.turns();
        let milli = turns
            .saturating_add(radius >> 1)
            .checked_div(radius)
            .unwrap_or(u64::MAX);
        let milli = if turns == 0 { 0 } else { milli };
        u32::try_from(milli.max(least).min(most)).unwrap_or(u32::MAX)
    }

    /// The spindle speed in thousandths of a turn per minute, times the radius in nanometres; below 2⁵⁰.
    pub const fn turns(&self) -> u64 {
        let speed = self.speed.nm_per_min();
        // A surface speed is below 2⁴³ nm/min.
        let speed = if speed < 0 { 0 } else { speed as u64 };
        mul_high(speed.wrapping_shl(16), PER_RADIUS) >> 8
    }

    /// The spindle speed with the tool at `x` in whole turns per minute, rounded up, with the sign of `direction`.
    #[must_use]
    pub fn rpm(&self, x: Length, direction: i32) -> Rpm {
        let whole = self.milli_rpm(x).div_ceil(1000);
        Rpm::new(
            i32::try_from(whole)
                .unwrap_or(i32::MAX)
                .saturating_mul(direction.signum()),
        )
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    use super::*;

    fn law(metres: i64, most: u32) -> SurfaceSpeed {
        SurfaceSpeed {
            speed: Feed::from_nm_per_min(metres * 1_000_000_000),
            centre: Length::from_nm(3_000_000),
            least: 0,
            most,
        }
    }

    fn at(law: &SurfaceSpeed, diameter_um: i64) -> u32 {
        law.milli_rpm(law.centre + Length::from_nm(diameter_um * 500))
    }

    #[test]
    fn speed_follows_the_diameter_up_to_the_limit() {
        let law = law(150, 2000);
        assert_eq!(at(&law, 100_000), 477_465);
        assert_eq!(at(&law, -100_000), 477_465);
        assert_eq!(at(&law, 50_000), 954_930);
        assert_eq!(at(&law, 10_000), 2_000_000);
        assert_eq!(at(&law, 0), 2_000_000);
        assert_eq!(law.rpm(Length::from_nm(53_000_000), -1), Rpm::new(-478));
    }

    #[test]
    fn limits_hold_and_the_highest_one_first() {
        let slow = SurfaceSpeed {
            least: 300,
            ..law(10, 2000)
        };
        assert_eq!(at(&slow, 1_000_000), 300_000);
        let contrary = SurfaceSpeed { most: 100, ..slow };
        assert_eq!(at(&contrary, 1_000_000), 100_000);
        assert_eq!(at(&law(0, 2000), 10), 0);
        assert_eq!(at(&law(0, 2000), 0), 0);
    }

    #[test]
    fn nearest_over_the_whole_range() {
        leadscrew_seed::volume(5, |seed| {
            let mut random = leadscrew_seed::Random(seed);
            for _ in 0..20_000 {
                let bits = random.bits();
                let metres = (bits >> 33) as i64 % 10_000;
                let radius = ((bits >> 20) as i64 & ((1 << 42) - 1)) + 1;
                let law = law(metres, 1_000_000);
                let exact = metres as f64 * 1e12 / (core::f64::consts::TAU * radius as f64);
                let exact = exact.min(1e9);
                let given = f64::from(law.milli_rpm(law.centre + Length::from_nm(radius)));
                assert!(
                    (given - exact).abs() <= 0.5 + 1e-9 * exact,
                    "{law:?} {radius}"
                );
            }
        });
    }
}
