//! The targets that wait, and the interpolation between them.

use super::{Interpolation, STEPS_LOG};

/// The number of kept targets, a power of two: the longest buffer, and four for a cubic.
const KEPT: usize = 32;

/// Latched targets, in 2⁻¹⁶ nanometres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    targets: [i64; KEPT],
    newest: usize,
    /// Targets that wait in the buffer.
    waiting: usize,
    interpolation: Interpolation,
}

impl Path {
    /// At rest here.
    pub(super) const fn new(at: i64, waiting: u8, interpolation: Interpolation) -> Self {
        Self {
            targets: [at; KEPT],
            newest: 0,
            waiting: waiting as usize,
            interpolation,
        }
    }

    /// All targets are here from now on.
    pub(super) const fn stand(&mut self, at: i64) {
        self.targets = [at; KEPT];
    }

    pub(super) fn push(&mut self, target: i64) {
        self.newest = self.newest.wrapping_add(1) % KEPT;
        if let Some(slot) = self.targets.get_mut(self.newest) {
            *slot = target;
        }
    }

    /// Goes on by the last step.
    pub(super) fn extrapolate(&mut self) {
        let (last, before) = (self.before(0), self.before(1));
        self.push(last.saturating_add(last.saturating_sub(before)));
    }

    fn before(&self, syncs: usize) -> i64 {
        let slot = self.newest.wrapping_sub(syncs) % KEPT;
        self.targets.get(slot).copied().unwrap_or(0)
    }

    /// The target that was latched last.
    pub(super) fn newest(&self) -> i64 {
        self.before(0)
    }

    /// The place after `part` of the steps of this period, and the speed there in 2⁻³² nanometres a step.
    pub(super) fn at(&self, part: i64) -> (i64, i128) {
        match self.interpolation {
            Interpolation::Linear => self.line(part),
            Interpolation::Cubic => self.cubic(part),
        }
    }

    fn line(&self, part: i64) -> (i64, i128) {
        let (to, from) = (
            self.before(self.waiting),
            self.before(self.waiting.wrapping_add(1)),
        );
        let way = i128::from(to.saturating_sub(from));
        let place = super::rounded(way.wrapping_mul(i128::from(part)), STEPS_LOG);
        let speed = way.wrapping_shl(16_u32.wrapping_sub(STEPS_LOG));
        (from.saturating_add(place as i64), speed)
    }

    /// Hermite between two targets, with the slopes of their neighbours: so it needs one target more.
    fn cubic(&self, part: i64) -> (i64, i128) {
        let of = |syncs: usize| i128::from(self.before(self.waiting.wrapping_add(syncs)));
        let (after, to, from, earlier) = (of(0), of(1), of(2), of(3));
        let way = to.wrapping_sub(from);
        // Twice the slopes a period.
        let (start, end) = (to.wrapping_sub(earlier), after.wrapping_sub(from));
        let u = i128::from(part);
        let (square, cube) = (u.wrapping_mul(u), u.wrapping_mul(u).wrapping_mul(u));
        let sum = |terms: [(i128, i128); 3]| {
            terms.into_iter().fold(0_i128, |sum, (factor, value)| {
                sum.wrapping_add(factor.wrapping_mul(value))
            })
        };
        // Of 1024 parts: u is an eighth of the period, and the slopes are doubled.
        let place = sum([
            (
                cube.wrapping_sub(square.wrapping_mul(16))
                    .wrapping_add(u.wrapping_mul(64)),
                start,
            ),
            (
                square
                    .wrapping_mul(24)
                    .wrapping_sub(cube.wrapping_mul(2))
                    .wrapping_mul(2),
                way,
            ),
            (cube.wrapping_sub(square.wrapping_mul(8)), end),
        ]);
        // The same differentiated, of 128 parts a period.
        let speed = sum([
            (
                square
                    .wrapping_mul(3)
                    .wrapping_sub(u.wrapping_mul(32))
                    .wrapping_add(64),
                start,
            ),
            (
                u.wrapping_mul(48)
                    .wrapping_sub(square.wrapping_mul(6))
                    .wrapping_mul(2),
                way,
            ),
            (square.wrapping_mul(3).wrapping_sub(u.wrapping_mul(16)), end),
        ]);
        let place = from.wrapping_add(super::rounded(place, 10));
        // A step is an eighth of a period: of 2⁻¹⁶ · 2⁻⁷ · 2⁻³ this makes 2⁻³².
        (place as i64, speed.wrapping_shl(6))
    }
}
