//! One board, read in a thread of its own until the end: what it says is kept, and what is wrong is said once.
//!
//! It must not know the other boards: one that is gone delays none of them.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use leadscrew_agent::metrics::{Metrics, Pulse};
use leadscrew_agent::sender::{Shared, now};
use leadscrew_agent::{Keeper, Observation};

use super::boards::Seat;
use super::reading::Reading;
use super::set::{Sets, Telling};
use super::{say, words};
use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::link::{Link, LinkResult};
use crate::words::{Both, both};

/// Between two looks for a board that is not there.
const AGAIN: Duration = Duration::from_secs(2);
/// Between two looks at the end.
const NAP: Duration = Duration::from_millis(50);

/// What the readers of an agent share.
#[derive(Debug)]
pub struct Common {
    /// With the sender.
    pub shared: Arc<Shared>,
    /// Where it is kept.
    pub path: PathBuf,
    /// The store takes nothing; that was said.
    pub full: AtomicBool,
    /// The store takes what it has room for, because the disk is full; that was said.
    pub tight: AtomicBool,
    /// The figures.
    pub metrics: Option<Arc<Metrics>>,
    /// There is one board alone.
    pub alone: bool,
    /// The broker is given the sets in force.
    pub sets: bool,
}

/// The reader of a board.
pub struct Reader {
    seat: Seat,
    /// What is known of it.
    pub keeper: Keeper,
    /// Its parameters.
    pub sets: Sets,
    telling: Telling,
    common: Arc<Common>,
    /// What was said of the board last.
    told: Option<Both>,
}

impl Reader {
    pub fn new(seat: Seat, keeper: Keeper, common: Arc<Common>) -> Self {
        Self {
            seat,
            keeper,
            sets: Sets::default(),
            telling: Telling::default(),
            common,
            told: None,
        }
    }

    /// Reads the board, whenever there is one, until the end.
    ///
    /// # Errors
    /// Where there is one board alone: its bus is none that could ever be there.
    pub fn read(mut self) -> Outcome {
        // It is lent to what reads.
        let global = self.seat.global.clone();
        while !interrupt::requested() {
            let trouble = match Reading::begin(&global, &mut self) {
                Ok(mut reading) => reading.carry_out(&mut self),
                Err(trouble) => Err(trouble),
            };
            self.tell_set(true);
            let words = match trouble {
                Ok(()) => return Ok(()),
                Err(wrong @ Failure::Usage(_)) if self.common.alone => return Err(wrong),
                Err(trouble) => trouble.words().unwrap_or_default(),
            };
            self.observe(&Observation::Gone(words.en.clone()));
            self.say(words);
            let until = Instant::now() + AGAIN;
            while Instant::now() < until && !interrupt::requested() {
                thread::sleep(NAP);
            }
        }
        Ok(())
    }

    /// Keeps what was seen. Where that cannot be done, it was not seen, and is read again.
    pub fn observe(&mut self, seen: &Observation) -> bool {
        let common = &self.common;
        match self.keeper.take(now(), seen) {
            Ok(kept) => {
                common.shared.take(&kept);
                if let Some(metrics) = &common.metrics {
                    metrics.take(&kept);
                }
                let is_tight = self.keeper.is_tight();
                if common.tight.swap(is_tight, Ordering::Relaxed) != is_tight {
                    say(self.global(), &words::tight(&common.path, is_tight));
                }
                // Where nothing is new, nothing was written.
                if !kept.is_empty() && common.full.swap(false, Ordering::Relaxed) {
                    say(self.global(), &words::kept_again());
                }
                true
            }
            Err(error) => {
                if !common.full.swap(true, Ordering::Relaxed) {
                    say(self.global(), &words::not_kept(&common.path, &error));
                }
                false
            }
        }
    }

    /// Reads the set with this checksum where it is not known, and tells the broker what is new of it.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn read_set(&mut self, link: &mut Link, parameters: u32) -> LinkResult {
        if self.common.sets {
            self.telling.know(&mut self.sets, link, parameters)?;
            self.tell_set(false);
        }
        Ok(())
    }

    fn tell_set(&mut self, last: bool) {
        if self.common.sets
            && let Some(set) = self.telling.news(self.keeper.model().memory(), last)
        {
            self.common.shared.set(&self.seat.machine, &set);
        }
    }

    /// The store takes nothing.
    pub fn is_full(&self) -> bool {
        self.common.full.load(Ordering::Relaxed)
    }

    /// Takes what a board says of itself and nobody is told but in figures.
    pub fn pulse(&self, pulse: Pulse) {
        if let Some(metrics) = &self.common.metrics {
            metrics.pulse(&self.seat.machine, pulse);
        }
    }

    /// Says of the board what was not said last.
    pub fn say(&mut self, words: Both) {
        if self.told.as_ref() == Some(&words) {
            return;
        }
        if self.common.alone {
            say(self.global(), &words);
        } else {
            let Both { en, zh } = &words;
            let machine = &self.seat.machine;
            say(self.global(), &both!("{machine}: {en}", "{machine}：{zh}"));
        }
        self.told = Some(words);
    }

    const fn global(&self) -> &Global {
        &self.seat.global
    }
}
