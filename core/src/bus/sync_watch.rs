//! Whether the SYNC of somebody else can be followed.
//!
//! A board that follows tells in every period what that has brought. It *follows* once a hundred periods in a row had one
//! SYNC each, nothing missing by the counters, and the board's own beat with it. From then on a period with none, with
//! two or with a gap in the counters is one in which setpoints were late for their SYNC, and is counted as that; three
//! in a row with none, eight in a row with several, or a beat that has come off, and it is lost.
//!
//! ```text
//!            100 periods as they should be      3 without SYNC, 8 with several, off the beat
//! (waits) ─────────────────────────────────► (follows) ──────────────────────────────────► (waits)
//!    └── too long: unsteady
//! ```
//!
//! Knows neither drives nor what an alarm is.

use super::sync::{SyncHeard, SyncSource};

/// Periods in a row that have to be as they should be.
const STEADY: u8 = 100;

/// Periods in which a timer that is led to the SYNCs has locked ([`SyncLock`](super::SyncLock)).
const LOCK: u32 = 2000;

/// Three periods in a row without SYNC.
const GONE: u8 = 0b111;

/// Periods in a row with more than one: somebody else gives a beat, too.
const DOUBLED: u8 = 8;

/// What has come of a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncVerdict {
    /// The board may go on as it is.
    Good,
    /// It followed, and does not any more.
    Lost,
    /// It has waited too long for a beat that can be followed.
    Unsteady,
}

/// What there is to know about the beat of the bus.
#[derive(Clone, Copy, Debug)]
pub struct SyncWatch {
    source: SyncSource,
    /// The drives may be brought up.
    follows: bool,
    /// What the owner said of this period.
    heard: SyncHeard,
    /// The last periods without SYNC, the newest in bit 0.
    gaps: u8,
    /// Periods in a row that were as they should be.
    steady: u8,
    /// Periods in a row with several.
    doubled: u8,
    /// Periods that were not, while it followed.
    late: u16,
    /// Time of a period in microseconds.
    tick_us: u32,
    /// Periods in which it has to become steady: those of two seconds, but no fewer
    /// than the own timer may take to lock, and those that have to be steady.
    patience: u32,
    /// Periods that it has waited, and SYNCs heard in them. Where it is lost: how
    /// many periods it is told of, and how many of them were without SYNC.
    waited: u32,
    seen: u32,
}

impl SyncWatch {
    /// For a board with this period in microseconds.
    #[must_use]
    pub const fn new(source: SyncSource, tick_us: u32) -> Self {
        let periods = match 2_000_000_u32.checked_div(tick_us) {
            Some(two_seconds @ LOCK..) => two_seconds,
            _ => LOCK,
        };
        Self {
            source,
            follows: matches!(source, SyncSource::Own),
            heard: SyncHeard::NONE,
            gaps: 0,
            steady: 0,
            doubled: 0,
            late: 0,
            tick_us,
            patience: periods.saturating_add(STEADY as u32),
            waited: 0,
            seen: 0,
        }
    }

    /// The same for another set, the periods counted so far included.
    pub(crate) const fn begin_anew(&mut self, source: SyncSource, tick_us: u32) {
        let late = self.late;
        *self = Self::new(source, tick_us);
        self.late = late;
    }

    /// Somebody else gives the beat.
    #[inline]
    #[must_use]
    pub const fn is_for_bus(&self) -> bool {
        matches!(self.source, SyncSource::Bus)
    }

    /// Takes what this period has brought. Where nothing is said, it has brought nothing.
    pub const fn hear(&mut self, heard: SyncHeard) {
        self.heard = heard;
    }

    /// The beat is the board's own, or one that it follows.
    #[must_use]
    pub const fn is_steady(&self) -> bool {
        self.follows
    }

    /// True once where three periods in a row have brought no SYNC: nobody latches anything.
    #[must_use]
    pub const fn has_ended(&self) -> bool {
        self.gaps & (GONE << 1 | 1) == GONE
    }

    /// Periods in which setpoints were late for a SYNC, since power-up; 65535 is followed by 0.
    #[must_use]
    pub const fn late(&self) -> u16 {
        self.late
    }

    /// What is to be told with a verdict that is not good. Unsteady: SYNCs heard, in how many periods. Lost: periods
    /// without one, of how many. Then the time of a period in microseconds.
    #[must_use]
    pub const fn figures(&self) -> [u32; 3] {
        [self.seen, self.waited, self.tick_us]
    }

    /// A period is over. `waits`: the drives are to be brought up.
    #[inline(never)]
    pub fn tick(&mut self, waits: bool) -> SyncVerdict {
        let heard = core::mem::replace(&mut self.heard, SyncHeard::NONE);
        let before = self.gaps;
        self.gaps = before << 1 | u8::from(heard.count == 0);
        let good = heard == SyncHeard::ONE;
        if !self.follows {
            self.steady = if good { self.steady.wrapping_add(1) } else { 0 };
            self.follows = self.steady >= STEADY;
            if waits {
                self.waited = self.waited.wrapping_add(1);
                self.seen = self.seen.wrapping_add(heard.count.into());
            } else {
                (self.waited, self.seen) = (0, 0);
            }
            if self.follows || self.waited < self.patience {
                return SyncVerdict::Good;
            }
            return SyncVerdict::Unsteady;
        }
        let several = heard.count > 1;
        self.doubled = if several {
            self.doubled.wrapping_add(1)
        } else {
            0
        };
        if good {
            return SyncVerdict::Good;
        }
        // What a gap in the counters says of periods that were empty has been counted with them.
        if heard.count != 1 || u32::from(heard.missed) > before.trailing_ones() {
            self.late = self.late.wrapping_add(1);
        }
        if heard.locked && self.gaps & GONE != GONE && self.doubled < DOUBLED {
            return SyncVerdict::Good;
        }
        self.follows = false;
        (self.steady, self.doubled) = (0, 0);
        (self.waited, self.seen) = (u8::BITS, self.gaps.count_ones());
        SyncVerdict::Lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SyncVerdict::{Good, Lost, Unsteady};

    const TWICE: SyncHeard = SyncHeard {
        count: 2,
        ..SyncHeard::ONE
    };
    const GAP: SyncHeard = SyncHeard {
        missed: 1,
        ..SyncHeard::ONE
    };
    const OFF: SyncHeard = SyncHeard {
        locked: false,
        ..SyncHeard::ONE
    };

    fn of_bus() -> SyncWatch {
        SyncWatch::new(SyncSource::Bus, 1000)
    }

    fn after(watch: &mut SyncWatch, heard: SyncHeard) -> SyncVerdict {
        watch.hear(heard);
        watch.tick(true)
    }

    fn following() -> SyncWatch {
        let mut watch = of_bus();
        for _ in 0..STEADY {
            assert!(!watch.is_steady());
            assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
        }
        assert!(watch.is_steady());
        watch
    }

    #[test]
    fn a_board_with_a_beat_of_its_own_has_nothing_to_wait_for() {
        let watch = SyncWatch::new(SyncSource::of(0), 1000);
        assert!(watch.is_steady() && !watch.is_for_bus());
        assert_eq!(SyncSource::of(1), SyncSource::Bus);
    }

    #[test]
    fn a_hundred_good_periods_in_a_row_make_a_beat() {
        for flaw in [SyncHeard::NONE, TWICE, GAP, OFF] {
            let mut watch = of_bus();
            for _ in 0..STEADY - 1 {
                assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
            }
            assert_eq!(after(&mut watch, flaw), Good);
            for _ in 0..STEADY - 1 {
                assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
                assert!(!watch.is_steady(), "{flaw:?}");
            }
            assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
            assert!(watch.is_steady(), "{flaw:?}");
            assert_eq!(watch.late(), 0);
        }
        following();
    }

    #[test]
    fn what_does_not_become_steady_is_told_with_its_figures_and_waited_for_again() {
        // Nothing; half of it; twice as much.
        let every_second = [SyncHeard::ONE, SyncHeard::NONE];
        for (pattern, seen) in [
            ([SyncHeard::NONE; 2], 0),
            (every_second, 1050),
            ([TWICE; 2], 4200),
            ([OFF; 2], 2100),
        ] {
            let mut watch = of_bus();
            for _ in 0..2 {
                let mut beats = pattern.iter().cycle();
                for _ in 0..2099 {
                    assert_eq!(after(&mut watch, *beats.next().unwrap()), Good);
                }
                assert_eq!(after(&mut watch, *beats.next().unwrap()), Unsteady);
                assert_eq!(watch.figures(), [seen, 2100, 1000]);
                // It stands on its alarm for a while.
                for _ in 0..10 {
                    assert_eq!(watch.tick(false), Good);
                }
            }
        }
        // Time in which the drives are not to be brought up does not count.
        let mut watch = of_bus();
        for _ in 0..5000 {
            assert_eq!(watch.tick(false), Good);
        }
        for _ in 0..2099 {
            assert_eq!(watch.tick(true), Good);
        }
        assert_eq!(watch.tick(true), Unsteady);
        // With a long tick for longer: a timer locks in periods.
        let mut watch = SyncWatch::new(SyncSource::Bus, 10_000);
        for _ in 0..2099 {
            assert_eq!(watch.tick(true), Good);
        }
        assert_eq!(watch.tick(true), Unsteady);
    }

    #[test]
    fn each_flaw_is_counted_once() {
        let mut watch = following();
        let one = SyncHeard::ONE;
        let gap = |missed| SyncHeard { missed, ..one };
        for (heard, late) in [
            (one, 0),
            (SyncHeard::NONE, 1),
            // The counters say what the empty period has said.
            (gap(1), 1),
            (one, 1),
            (gap(1), 2),
            (TWICE, 3),
            (SyncHeard::NONE, 4),
            (SyncHeard::NONE, 5),
            (gap(2), 5),
            (SyncHeard::NONE, 6),
            (gap(2), 7),
            (one, 7),
        ] {
            assert_eq!(after(&mut watch, heard), Good);
            assert_eq!(watch.late(), late, "{heard:?}");
            assert!(watch.is_steady() && !watch.has_ended());
        }
        watch.begin_anew(SyncSource::Bus, 2000);
        assert_eq!((watch.late(), watch.is_steady()), (7, false));
    }

    #[test]
    fn three_in_a_row_without_are_the_end_of_it() {
        let mut watch = following();
        assert_eq!(after(&mut watch, SyncHeard::NONE), Good);
        // Not said is not heard.
        assert_eq!(watch.tick(true), Good);
        assert!(!watch.has_ended());
        assert_eq!(after(&mut watch, SyncHeard::NONE), Lost);
        assert_eq!((watch.late(), watch.figures()), (3, [3, 8, 1000]));
        assert!(watch.has_ended() && !watch.is_steady());
        // Once, until it has been heard again.
        assert_eq!(watch.tick(false), Good);
        assert!(!watch.has_ended());
        assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
        for ended in [false, false, true, false] {
            assert_eq!(watch.tick(false), Good);
            assert_eq!(watch.has_ended(), ended);
        }
        for _ in 0..STEADY {
            assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
        }
        assert!(watch.is_steady());
        assert_eq!(watch.late(), 3, "what is not followed is not late");
    }

    #[test]
    fn eight_in_a_row_with_several_are_two_who_give_it() {
        let mut watch = following();
        for _ in 0..3 {
            for _ in 0..7 {
                assert_eq!(after(&mut watch, TWICE), Good);
            }
            assert_eq!(after(&mut watch, SyncHeard::ONE), Good);
        }
        for _ in 0..7 {
            assert_eq!(after(&mut watch, TWICE), Good);
        }
        assert_eq!(after(&mut watch, TWICE), Lost);
        assert!(!watch.has_ended() && !watch.is_steady());
        assert_eq!((watch.late(), watch.figures()), (29, [0, 8, 1000]));
    }

    #[test]
    fn off_the_beat_is_lost_at_once_and_somebody_still_gives_it() {
        let mut watch = following();
        assert_eq!(after(&mut watch, OFF), Lost);
        assert!(!watch.has_ended() && !watch.is_steady());
        assert_eq!((watch.late(), watch.figures()), (0, [0, 8, 1000]));
    }
}
