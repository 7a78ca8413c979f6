//! The time of an answer of the board, for the turns of clients that share it [D111].

use std::time::Duration;

/// The last answers.
const ANSWERS: usize = 8;
/// The longest time that counts. Others wait for a multiple of it.
const SLOWEST: Duration = Duration::from_millis(100);

/// The times of the last answers.
#[derive(Debug, Default)]
pub(super) struct RoundTrip {
    last: [Duration; ANSWERS],
    next: usize,
}

impl RoundTrip {
    /// Notes the time of an answer.
    pub fn note(&mut self, took: Duration) {
        self.last[self.next] = took;
        self.next = (self.next + 1) % ANSWERS;
    }

    /// The time that counts: the second longest. A board with slow answers has several of them. A single pause of the
    /// board, an adapter or this computer must not make this side wait longer for ever.
    pub fn reckoned(&self) -> Duration {
        let mut sorted = self.last;
        sorted.sort_unstable();
        sorted[ANSWERS - 2].min(SLOWEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    #[test]
    fn one_that_stood_still_does_not_count_and_a_slow_board_does() {
        let mut round_trip = RoundTrip::default();
        assert_eq!(round_trip.reckoned(), Duration::ZERO);
        for _ in 0..10 {
            round_trip.note(ms(2));
        }
        round_trip.note(ms(700));
        assert_eq!(round_trip.reckoned(), ms(2));
        round_trip.note(ms(70));
        assert_eq!(round_trip.reckoned(), ms(70));
        round_trip.note(ms(700));
        assert_eq!(round_trip.reckoned(), SLOWEST);
        for _ in 0..ANSWERS {
            round_trip.note(ms(3));
        }
        assert_eq!(round_trip.reckoned(), ms(3));
    }
}
