//! What a start finds in the memory that a reset leaves as it is, and how the start reads it.
//!
//! ```text
//! start ─► head: whole, failures in a row ─► ticks count ─► a failure writes its record ─► reset ─► start
//! ```
//!
//! The head has a checksum, and memory after a loss of power does not match it. So the head also tells whether the
//! power was away.

use crate::failure::{Failure, FailureKind, checksum};
use crate::reset::ResetCause;

/// The content of the memory after a reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Left {
    /// Failures in a row before the last run; `None` where the memory was lost.
    in_a_row: Option<u32>,
    /// SYNC periods of the last run.
    ticks: u32,
    /// The record that a handler has written.
    record: Option<Failure>,
}

impl Left {
    /// Words of the head.
    pub const HEAD: usize = 3;

    /// The first word of a head.
    const MARK: u32 = 0x4C53_4831;

    /// A run of so many SYNC periods (a minute at 1 ms each) is a good run: earlier failures do not count any more.
    pub const GOOD: u32 = 60_000;

    /// The head of a run after so many failures in a row.
    #[must_use]
    pub fn head(in_a_row: u32) -> [u32; Self::HEAD] {
        [Self::MARK, in_a_row, checksum(&[Self::MARK, in_a_row])]
    }

    /// Reads the words: head, SYNC periods since the start, record.
    #[must_use]
    pub fn decode(head: &[u32; Self::HEAD], ticks: u32, record: &[u32; Failure::WORDS]) -> Self {
        let &[mark, in_a_row, sum] = head;
        let whole = mark == Self::MARK && sum == checksum(&[mark, in_a_row]);
        Self {
            in_a_row: whole.then_some(in_a_row),
            ticks,
            record: Failure::decode(record),
        }
    }

    /// The memory still holds what the last run has left.
    #[must_use]
    pub const fn is_kept(&self) -> bool {
        self.in_a_row.is_some()
    }

    /// The number in a row of a failure that ended the last run. A run in which the board stayed at rest for good was
    /// no good run.
    #[must_use]
    pub fn next(&self) -> u32 {
        let counts = |before: &u32| self.ticks < Self::GOOD || *before >= Failure::LIMIT;
        self.in_a_row.filter(counts).unwrap_or(0).saturating_add(1)
    }

    /// The failure that caused this start, if there was one. The reset button and switching on both begin anew: earlier
    /// failures do not count. Power that was away for a moment does count, because the supply may be at fault. But it
    /// never counts up to [`Failure::LAST`]: a board that is switched off and on again always starts, and stands on its
    /// alarm.
    #[must_use]
    pub fn failure(&self, cause: ResetCause) -> Option<Failure> {
        let (untold, most) = match cause {
            ResetCause::Power | ResetCause::Pin => return None,
            ResetCause::Software => return self.record,
            ResetCause::Watchdog => (FailureKind::Hung, u32::MAX),
            ResetCause::BrownOut => (FailureKind::PowerDropped, Failure::LAST - 1),
        };
        let mut failure = self.record;
        let told = failure.get_or_insert_with(|| Failure {
            ticks: self.ticks,
            in_a_row: self.next(),
            ..Failure::untold(untold)
        });
        told.in_a_row = told.in_a_row.min(most);
        failure
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::alarm::{Arg, Code};

    const NO_RECORD: [u32; Failure::WORDS] = [0; Failure::WORDS];

    fn after(in_a_row: u32, ticks: u32) -> Left {
        Left::decode(&Left::head(in_a_row), ticks, &NO_RECORD)
    }

    #[test]
    fn a_head_tells_whether_the_memory_was_kept() {
        assert!(after(0, 5).is_kept());
        for word in 0..Left::HEAD {
            for bit in 0..32 {
                let mut head = Left::head(2);
                head[word] ^= 1 << bit;
                assert!(!Left::decode(&head, 5, &NO_RECORD).is_kept());
            }
        }
        for word in [0, u32::MAX] {
            assert!(!Left::decode(&[word; Left::HEAD], 5, &NO_RECORD).is_kept());
        }
    }

    #[test]
    fn every_cause_says_what_it_was() {
        let left = after(0, 4711);
        assert_eq!(left.failure(ResetCause::Power), None);
        assert_eq!(left.failure(ResetCause::Pin), None);
        assert_eq!(left.failure(ResetCause::Software), None, "a debugger");
        let hung = left.failure(ResetCause::Watchdog).expect("a failure");
        assert_eq!((hung.kind, hung.ticks), (FailureKind::Hung, 4711));
        let dropped = left.failure(ResetCause::BrownOut).expect("a failure");
        assert_eq!(
            (dropped.kind, dropped.ticks),
            (FailureKind::PowerDropped, 4711)
        );
        let record = Failure {
            kind: FailureKind::Panic,
            place: 7,
            ..hung
        };
        let left = Left::decode(&Left::head(0), 1, &record.encode());
        for cause in [
            ResetCause::Software,
            ResetCause::Watchdog,
            ResetCause::BrownOut,
        ] {
            assert_eq!(left.failure(cause), Some(record));
        }
        assert_eq!(left.failure(ResetCause::Pin), None);
    }

    #[test]
    fn power_that_drops_never_keeps_the_board_from_starting() {
        let mut in_a_row = 0;
        for expected in (1..Failure::LAST).chain([Failure::LAST - 1; 3]) {
            let failure = after(in_a_row, 100)
                .failure(ResetCause::BrownOut)
                .expect("one");
            in_a_row = failure.in_a_row;
            assert_eq!(in_a_row, expected);
        }
        // A board that did not start any more is switched off and on again: it starts, and stays at rest.
        let again = after(Failure::LAST, 0)
            .failure(ResetCause::BrownOut)
            .expect("one");
        assert_eq!(again.in_a_row, Failure::LAST - 1);
        assert!(again.is_final());
        let last = Failure {
            in_a_row: Failure::LAST,
            ..Failure::untold(FailureKind::Panic)
        };
        let left = Left::decode(&Left::head(Failure::LAST - 1), 1, &last.encode());
        let dropped = left.failure(ResetCause::BrownOut).expect("one");
        assert_eq!(dropped.kind, FailureKind::Panic);
        assert_eq!(dropped.in_a_row, Failure::LAST - 1);
        assert_eq!(left.failure(ResetCause::Software), Some(last));
        let hung = left.failure(ResetCause::Watchdog).expect("one");
        assert_eq!(hung.in_a_row, Failure::LAST);
    }

    #[test]
    fn failures_count_until_a_run_was_good_or_somebody_has_begun_anew() {
        let mut in_a_row = 0;
        for expected in 1..=4 {
            let failure = after(in_a_row, 100)
                .failure(ResetCause::Watchdog)
                .expect("one");
            in_a_row = failure.in_a_row;
            assert_eq!(in_a_row, expected);
            assert_eq!(failure.is_final(), expected >= Failure::LIMIT);
        }
        assert_eq!(after(2, Left::GOOD - 1).next(), 3);
        assert_eq!(after(2, Left::GOOD).next(), 1);
        assert_eq!(after(3, Left::GOOD).next(), 4, "at rest for good");
        assert_eq!(Left::default().next(), 1);
        let last = after(2, 100).failure(ResetCause::BrownOut).expect("one");
        let alarm = last.alarm();
        assert_eq!(alarm.code, Code::FailsAgain);
        assert_eq!(
            alarm.args,
            [
                Arg::Int(3),
                Arg::Int(Code::PowerDropped.number().into()),
                Arg::Key(0),
                Arg::Key(0)
            ]
        );
    }
}
