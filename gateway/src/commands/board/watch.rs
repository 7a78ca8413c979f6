//! What every view of a board reads alike: its log, what its positions are counted from, whether it lives.
//!
//! Which reading may fail, and what is shown of it, is the view's business.

use std::time::{Duration, Instant};

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
/// Entries of the log that are older than a view and shown all the same.
const BEFORE: u32 = 8;

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
    boots: u32,
}

impl Watch {
    /// Begins a little before the newest entry of the log.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn new(link: &mut Link) -> LinkResult<Self> {
        Ok(Self {
            zeros: Zeros::default(),
            last_event: link.newest_event()?.saturating_sub(BEFORE),
            boots: link.seen.boots,
        })
    }

    /// Starts a board that has started again: it says no process data before somebody has.
    ///
    /// # Errors
    /// The board has gone.
    pub fn attend(&mut self, link: &mut Link) -> Outcome {
        link.check_alive()?;
        if link.seen.boots != self.boots {
            self.boots = link.seen.boots;
            link.start_node()?;
        }
        Ok(())
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
