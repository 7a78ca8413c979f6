//! The spindle encoder: a counter, an index and the time of the last edge.
//!
//! The counter shows `c` while the angle is within `[c, c + 1)` counts; it wraps at 32 bits. The index pulse is one
//! count wide and begins at every whole turn of the true angle. The time of the last edge is exact to a nanosecond.

use super::spindle::{FineTurns, Piece};
use leadscrew_core::spindle::EncoderSample;

/// An incremental encoder with index, all edges counted.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    counts_per_turn: u32,
    edge_time: bool,
    /// Counts of the true angle, not wrapped.
    count: i64,
    /// The hardware counter at true angle 0.
    zero: i32,
    /// Nanoseconds since the last edge; `None` before the first.
    age: Option<u64>,
    /// The last count with an index pulse since the last sample.
    index: Option<i64>,
    index_broken: bool,
}

impl Encoder {
    /// An encoder on a spindle that stands at `angle`. Its counter is at `zero` for angle 0. `edge_time`: the hardware
    /// captures the time of the last edge. `None` for an encoder without counts.
    #[must_use]
    pub fn new(counts_per_turn: u32, edge_time: bool, angle: FineTurns, zero: i32) -> Option<Self> {
        if counts_per_turn == 0 {
            return None;
        }
        Some(Self {
            counts_per_turn,
            edge_time,
            count: count(angle, counts_per_turn),
            zero,
            age: None,
            index: None,
            index_broken: false,
        })
    }

    /// Counts by which interference moves the counter at once.
    pub const SLIP: i32 = 40;

    /// Changes the counter by `counts`, as interference would.
    pub const fn slip(&mut self, counts: i32) {
        self.zero = self.zero.wrapping_add(counts);
    }

    /// Breaks the wire of the index, or mends it.
    pub const fn break_index(&mut self, broken: bool) {
        self.index_broken = broken;
    }

    /// Takes the next piece of the spindle's motion.
    pub fn turn(&mut self, piece: &Piece) {
        let before = self.count;
        let after = count(piece.angle(piece.duration()), self.counts_per_turn);
        self.count = after;
        self.age = if before == after {
            self.age.map(|age| age.saturating_add(piece.duration()))
        } else {
            Some(self.since_edge(piece))
        };
        self.index = self.last_pulse(before, after).or(self.index);
    }

    /// The last count with an index pulse that was entered between two counts.
    fn last_pulse(&self, before: i64, after: i64) -> Option<i64> {
        let n = i64::from(self.counts_per_turn);
        // Upwards: the last whole turn at or below the end. Downwards: the first at or above it.
        let reached = if after > before {
            after
        } else {
            after.wrapping_add(n).wrapping_sub(1)
        };
        let pulse = reached.checked_div_euclid(n)?.wrapping_mul(n);
        let entered = if after > before {
            pulse > before
        } else {
            pulse < before
        };
        entered.then_some(pulse)
    }

    /// Nanoseconds from the last edge to the end of a piece that contains an edge.
    fn since_edge(&self, piece: &Piece) -> u64 {
        // The first nanosecond with the last count lies in (early, late].
        let mut early = (0, piece.angle(0));
        let mut late = (piece.duration(), piece.angle(piece.duration()));
        // Upwards the edge is the lower boundary of the last count; downwards it is the upper boundary.
        let boundary = if late.1 > early.1 {
            self.count
        } else {
            self.count.wrapping_add(1)
        };
        let edge = (i128::from(boundary) << 64)
            .checked_div(i128::from(self.counts_per_turn))
            .unwrap_or(0);
        let mut round = 0u32;
        while late.0.wrapping_sub(early.0) > 1 {
            // The speed hardly changes in a tick: interpolation finds the edge in a few steps. Every fourth step halves
            // the interval, which bounds their number.
            round = round.wrapping_add(1);
            let guess = if round.is_multiple_of(4) {
                early.0.wrapping_add(late.0) >> 1
            } else {
                interpolate(early, late, edge)
                    .clamp(early.0.wrapping_add(1), late.0.wrapping_sub(1))
            };
            let at = (guess, piece.angle(guess));
            if count(at.1, self.counts_per_turn) == self.count {
                late = at;
            } else {
                early = at;
            }
        }
        piece.duration().wrapping_sub(late.0)
    }

    /// The values that the board's hardware shows now. This call empties the index latch.
    pub fn sample(&mut self) -> EncoderSample {
        let index = self.index.take().filter(|_| !self.index_broken);
        EncoderSample {
            count: self.shown(self.count),
            edge_age_ns: self
                .age
                .filter(|_| self.edge_time)
                .map(|age| age.min(u64::from(u32::MAX)) as u32),
            index: index.map(|count| self.shown(count)),
        }
    }

    /// The counter. This call does not empty the index latch.
    #[must_use]
    pub const fn counter(&self) -> i32 {
        self.shown(self.count)
    }

    const fn shown(&self, count: i64) -> i32 {
        self.zero.wrapping_add(count as i32)
    }
}

/// The count in which an angle lies.
fn count(angle: FineTurns, counts_per_turn: u32) -> i64 {
    (angle.raw().wrapping_mul(i128::from(counts_per_turn)) >> 64) as i64
}

/// The first nanosecond after an edge, if the speed is constant between the two times.
fn interpolate(early: (u64, FineTurns), late: (u64, FineTurns), edge: i128) -> u64 {
    let span = i128::from(late.0.wrapping_sub(early.0));
    let way = late.1.raw().wrapping_sub(early.1.raw());
    let offset = edge
        .wrapping_sub(early.1.raw())
        .wrapping_mul(span)
        .checked_div(way)
        .unwrap_or(0)
        .clamp(0, span);
    early.0.wrapping_add(offset as u64).wrapping_add(1)
}
