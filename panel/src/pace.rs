//! When the next message to one who watches may go. It must not know what is told, nor to whom.

use std::time::{Duration, Instant};

/// Between two messages: 30 Hz.
const PERIOD: Duration = Duration::from_millis(33);

/// Ticks with a period of their own: the time that work between them takes does not make them fewer.
pub struct Pace(Instant);

impl Pace {
    /// The first message may go now.
    #[must_use]
    pub const fn new(now: Instant) -> Self {
        Self(now)
    }

    /// The next tick; now, where that has passed. Ticks that were missed are not made up for.
    pub fn next(&mut self, now: Instant) -> Instant {
        self.0 = (self.0 + PERIOD).max(now);
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_no_ticks_and_missed_ones_are_not_made_up_for() {
        let start = Instant::now();
        let (mut pace, mut due) = (Pace::new(start), start);
        for number in 1..=30 {
            let busy = PERIOD * (number % 4) / 4;
            due = pace.next(due + busy);
            assert_eq!(due, start + PERIOD * number);
        }
        let late = due + PERIOD * 10;
        assert_eq!(pace.next(late), late);
        assert_eq!(pace.next(late), late + PERIOD);
    }
}
