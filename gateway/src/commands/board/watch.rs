//! What every view of a board reads alike: its log, what its positions are counted from, whether it lives.
//!
//! Which reading may fail, and what is shown of it, is the view's business.

use std::time::{Duration, Instant};

use leadscrew_core::bus::Object;
use leadscrew_core::link::{Logged, Status};

use super::mdi;
use super::monitor::zeros::Zeros;
use crate::cli::Global;
use crate::failure::Outcome;
use crate::link::{Link, LinkResult};

/// Between two readings of the status record, which has the position.
pub const STATUS: Duration = Duration::from_millis(100);
/// Between two readings of the event log, and of what else changes seldom.
pub const LOG: Duration = Duration::from_secs(1);
/// Between two readings of the certificates while threads are cut: 0.9 % of a bus with 1 Mbit/s, and time for four threads
/// that the board keeps beside it.
pub const THREADS: Duration = Duration::from_millis(1500);
/// Entries of the log that are older than a view and shown all the same.
const BEFORE: u32 = 8;

/// Parameters with the bit rates of the bus in kbit/s: that of all frames, and that of the data of CAN FD frames.
const RATES: [Object; 2] = [Object::new(0x2000 + 9020, 0), Object::new(0x2000 + 9032, 0)];

/// These bit rates, as far as the board tells them.
pub fn bit_rates(link: &mut Link) -> [u64; 2] {
    let [kbit, fd_kbit] = RATES.map(|rate| link.read_number(rate).ok());
    let kbit = kbit.unwrap_or(1000);
    [kbit, fd_kbit.unwrap_or(kbit)]
}

/// Starts a board that has started again: it says no process data before somebody has.
pub struct Starts(u32);

impl Starts {
    /// As many as were heard so far.
    pub const fn new(link: &Link) -> Self {
        Self(link.seen.boots)
    }

    /// True where the board has started again since.
    ///
    /// # Errors
    /// The board has gone.
    pub fn attend(&mut self, link: &mut Link) -> Outcome<bool> {
        link.check_alive()?;
        let again = link.seen.boots != self.0;
        if again {
            self.0 = link.seen.boots;
            link.start_node()?;
        }
        Ok(again)
    }
}

/// Work that comes again after a time.
pub struct Every {
    time: Duration,
    last: Option<Instant>,
}

impl Every {
    /// Due at once, and then after each `time`.
    pub const fn new(time: Duration) -> Self {
        Self { time, last: None }
    }

    /// True where it is time; then it is done.
    pub fn is_due(&mut self, now: Instant) -> bool {
        let due = self.last.is_none_or(|last| now >= last + self.time);
        if due {
            self.last = Some(now);
        }
        due
    }
}

/// How far a board has been read.
pub struct Watch {
    /// What its positions are counted from.
    pub zeros: Zeros,
    last_event: u32,
    starts: Starts,
}

impl Watch {
    /// Begins a little before the newest entry of the log.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn new(link: &mut Link) -> LinkResult<Self> {
        // A start meanwhile is one of those that are still to be attended to.
        let starts = Starts::new(link);
        Ok(Self {
            zeros: Zeros::default(),
            last_event: link.newest_event()?.saturating_sub(BEFORE),
            starts,
        })
    }

    /// As [`Starts::attend`].
    ///
    /// # Errors
    /// The board has gone.
    pub fn attend(&mut self, link: &mut Link) -> Outcome<bool> {
        self.starts.attend(link)
    }

    /// The entries of the log that have come since.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn log(&mut self, link: &mut Link) -> LinkResult<Vec<Logged>> {
        let entries = link.events_behind(self.last_event)?;
        let newest = entries.iter().map(|entry| entry.number).max();
        self.last_event = self.last_event.max(newest.unwrap_or(0));
        Ok(entries)
    }

    /// Reads what the zeros hang on, where it has changed.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn follow(&mut self, global: &Global, link: &mut Link, status: &Status) -> LinkResult {
        self.zeros.note(mdi::in_force(global, status));
        self.zeros.follow(link, status)
    }
}
