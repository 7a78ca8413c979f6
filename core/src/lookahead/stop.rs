//! Where a stop between two cuts takes less time than to go on slowly.
//!
//! This module knows the way, the feed and the time of single cuts. It knows nothing of corners, windows or limits.

use super::turning::per;
use crate::motion::Timed;
use crate::motion::to_units;
use crate::units::mul_div;

/// A cut on one side of a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// The way.
    length: u64,
    feed: u64,
    /// What it takes longer with a stop at each end than at the feed, in ticks.
    more: u64,
}

impl Side {
    /// No cut.
    pub(super) const NONE: Self = Self {
        length: 0,
        feed: 0,
        more: 0,
    };

    /// Of a cut that ends in stops if it is not joined to others.
    pub(super) fn of(timed: &Timed) -> Self {
        let (length, feed) = (to_units(timed.length), timed.nominal.raw().into());
        Self {
            length,
            feed,
            more: timed.duration_ticks().saturating_sub(per(length, feed)),
        }
    }

    /// The slowest rate on both cuts that takes less time than a stop between them.
    pub(super) fn least(&self, after: &Self) -> u64 {
        let feed = self.feed.max(after.feed);
        let way = self.length.saturating_add(after.length);
        let more = self.more.saturating_add(after.more) / 2;
        // On a long way, the rate holds as long as two ramps take, and a stop costs one.
        as_slow_as(more, way, feed).min(feed / 2)
    }

    /// True where it takes less time to stop before and after this cut than to cut it at `rate`.
    pub(super) fn is_faster_alone(&self, rate: u64) -> bool {
        rate < as_slow_as(self.more, self.length, self.feed)
    }
}

/// The rate r at which a way S takes `more` ticks more than at the feed v: S / r = S / v + more.
fn as_slow_as(more: u64, way: u64, feed: u64) -> u64 {
    let all = more.saturating_mul(feed).saturating_add(way);
    mul_div(feed, way, all.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_pays_on_a_long_way_below_half_the_feed_and_on_a_short_one_much_later() {
        let side = |length, more| Side {
            length,
            feed: 100,
            more,
        };
        // 1 000 000 at 100 is 10 000 ticks: 50 more are nothing.
        assert_eq!(side(1_000_000, 50).least(&side(1_000_000, 50)), 50);
        // 1 000 + 1 000 at 100 is 20 ticks, and 70 with a stop: 2 000 / 70.
        assert_eq!(side(1_000, 60).least(&side(1_000, 40)), 28);
        assert_eq!(Side::NONE.least(&Side::NONE), 0);
        // 10 ticks at 100 and 40 with stops: 25.
        assert!(side(1_000, 30).is_faster_alone(24));
        assert!(!side(1_000, 30).is_faster_alone(25));
    }
}
