//! The spindle's command under constant surface speed, step by step.
//!
//! The exact law needs a long division. A command changes only a little from one to the next, so a short division is
//! enough: it finds the step from how far the last command is off. Knows nothing of drives.

use crate::call::SurfaceSpeed;
use crate::motion::Rate;
use crate::units::Length;

/// Radii above this, nm, count as this: 68 m. So products keep within 63 bits.
const FARTHEST: u64 = 1 << 36;
/// The largest change of a command, thousandths of a turn per minute.
const LARGEST_STEP: u32 = 1 << 15;
/// Ticks from one command to the next: a spindle is slow, and the wire has other frames.
pub(super) const TICKS: u32 = 4;

/// Constant surface speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    centre: Length,
    /// Speed times radius, thousandths of a turn per minute times nm.
    turns: u64,
    /// Thousandths of a turn per minute, as below.
    least: u32,
    most: u32,
    /// X at the end of a rapid that is under way, or was last; `None` where the tool's own place counts.
    end: Option<Length>,
    /// The present command before override.
    milli_rpm: u32,
    /// Ticks until the next command.
    wait: u32,
}

impl Surface {
    /// The command `milli_rpm` goes over into `law`.
    pub(super) const fn new(law: &SurfaceSpeed, milli_rpm: u32) -> Self {
        let most = law.most.saturating_mul(1000);
        let least = law.least.saturating_mul(1000);
        Self {
            centre: law.centre,
            turns: law.turns(),
            least: if least < most { least } else { most },
            most,
            end: None,
            milli_rpm,
            wait: 0,
        }
    }

    /// The command before override.
    pub(super) const fn milli_rpm(&self) -> u32 {
        self.milli_rpm
    }

    /// The command with the override; the highest speed holds for it, too.
    pub(super) fn command(&self, percent: u8) -> i32 {
        let factor = u64::from(Rate::percent(percent).raw());
        // Below 2³²: a speed is below 10⁸, and no override doubles it.
        let milli = u64::from(self.milli_rpm).wrapping_mul(factor) >> 16;
        (milli as u32).min(self.most) as i32
    }

    /// From now on the place `end` counts, or the tool's own.
    pub(super) const fn aim(&mut self, end: Option<Length>) {
        self.end = end;
    }

    /// A tick with the tool at `x`: every [`TICKS`] the command goes toward the law by at most `step`.
    pub(super) fn tick(&mut self, x: Length, step: u32) {
        if let Some(wait) = self.wait.checked_sub(1) {
            self.wait = wait;
        } else {
            self.wait = TICKS.saturating_sub(1);
            self.follow(x, step);
        }
    }

    fn follow(&mut self, x: Length, step: u32) {
        let x = self.end.unwrap_or(x);
        let radius = (x - self.centre).nm().unsigned_abs().min(FARTHEST);
        let step = step.min(LARGEST_STEP);
        let now = self.milli_rpm;
        // Both are below 2⁶³.
        let reached = u64::from(now).wrapping_mul(radius);
        let slow = self.turns >= reached;
        let off = self.turns.abs_diff(reached);
        let change = if off >= u64::from(step).wrapping_mul(radius) {
            step
        } else {
            // 16 bits of the radius: the quotient is at most a third of a thousandth off.
            let shift = u64::BITS
                .wrapping_sub(radius.leading_zeros())
                .saturating_sub(16);
            let (off, radius) = ((off >> shift) as u32, (radius >> shift) as u32);
            off.checked_div(radius).unwrap_or(0)
        };
        let next = if slow {
            now.saturating_add(change)
        } else {
            now.saturating_sub(change)
        };
        // A limit is not jumped to either.
        let next = next.min(self.most.max(now.saturating_sub(step)));
        self.milli_rpm = next.max(self.least.min(now.saturating_add(step)));
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    use super::*;
    use crate::units::Feed;

    /// However it starts, it comes to the law within a thousandth of a turn and the rounding of the quotient.
    #[test]
    fn comes_to_the_law_and_stays_there() {
        leadscrew_seed::volume(5, |seed| {
            let mut random = leadscrew_seed::Random(seed);
            let mut next = |bound: u64| (random.bits() >> 24) % bound;
            for _ in 0..300 {
                let law = SurfaceSpeed {
                    speed: Feed::from_nm_per_min((next(4000) * 1_000_000_000) as i64),
                    centre: Length::from_nm(next(1 << 30) as i64),
                    least: next(100) as u32,
                    most: 100 + next(90_000) as u32,
                };
                let mut surface = Surface::new(&law, next(90_000_000) as u32);
                let bits = next(34);
                let mut x = law.centre + Length::from_nm(next(1 << bits) as i64);
                let step = 1 + next(30_000) as u32;
                for _ in 0..90_000_000 / step + 2 {
                    surface.follow(x, step);
                }
                for _ in 0..50 {
                    let exact = law.milli_rpm(x);
                    let is_near = surface.milli_rpm().abs_diff(exact) <= 2;
                    assert!(is_near, "{law:?} {x:?} {surface:?} {exact}");
                    // A small way on.
                    x += Length::from_nm(1 + (x - law.centre).nm() / 1_000_000);
                    surface.follow(x, 30_000);
                }
            }
        });
    }

    #[test]
    fn a_command_changes_by_one_step_at_most() {
        let law = SurfaceSpeed {
            speed: Feed::from_nm_per_min(100_000_000_000),
            centre: Length::ZERO,
            least: 200,
            most: 3000,
        };
        let mut surface = Surface::new(&law, 0);
        surface.follow(Length::from_nm(1_000_000_000), 1000);
        assert_eq!(surface.milli_rpm(), 1000);
        let mut fast = Surface::new(&law, 5_000_000);
        fast.follow(Length::ZERO, 1000);
        assert_eq!(fast.milli_rpm(), 4_999_000);
        assert_eq!(fast.command(120), 3_000_000);
    }
}
