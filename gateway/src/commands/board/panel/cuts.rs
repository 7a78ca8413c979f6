//! Threads as they are cut, for the page: what is known after each of their passes.
//!
//! Of the passes of a thread the board keeps the lowest and the highest groove [D380]. Read after each pass, they say where
//! its groove lies if it is a new lowest or highest one, and otherwise between which two. Figures and words are those of
//! `run`. This must not know a chart, or when the bus has time.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use leadscrew_core::link::{CutTally, ThreadCertificate, ThreadKind, ThreadRecord, ThreadState};

use super::super::watch::THREADS;
use super::object;
use crate::certified::{Figure, Judge};
use crate::json::Json;
use crate::place::SourceLine;

/// Between two readings where passes end.
const SOON: Duration = Duration::from_millis(400);
/// Threads that are kept for the page.
const KEPT: usize = 12;
/// Passes of a thread that are kept.
const PASSES: usize = 64;

/// Between which two its groove lies; `None` where that is not known.
type Pass = Option<[Figure; 2]>;

/// A thread so far.
#[derive(Debug)]
struct Thread {
    number: u32,
    record: ThreadRecord,
    /// Passes that are over.
    over: usize,
    /// The last of them.
    passes: VecDeque<Pass>,
}

impl Thread {
    fn new(told: &ThreadCertificate, judge: &Judge) -> Self {
        let mut thread = Self {
            number: told.number,
            record: told.record,
            over: 0,
            passes: VecDeque::new(),
        };
        thread.take(&CutTally::NONE, judge);
        thread
    }

    fn go_on(&mut self, now: &ThreadRecord, judge: &Judge) {
        let before = std::mem::replace(&mut self.record, *now).cut;
        self.take(&before, judge);
    }

    fn take(&mut self, before: &CutTally, judge: &Judge) {
        let ThreadRecord {
            kind,
            state,
            tally,
            cut,
            ..
        } = &self.record;
        if *kind != ThreadKind::Thread {
            return;
        }
        let fresh = usize::from(cut.passes.saturating_sub(before.passes));
        // A pass without a groove is known to be over once the next one has begun.
        let is_open = usize::from(*state == ThreadState::UnderWay);
        let over = usize::from(tally.passes).saturating_sub(is_open);
        let over = over.max(self.over + fresh);
        let new = over.saturating_sub(self.over);
        self.over = over;
        // Of which of them the groove is known nobody tells, unless it is of all.
        let pass = judge
            .found(cut)
            .and_then(|found| found.grooves)
            .filter(|_| new == fresh)
            .map(|both| narrowed(both, before, cut, fresh));
        for _ in 0..new.min(PASSES) {
            if self.passes.len() == PASSES {
                self.passes.pop_front();
            }
            self.passes.push_back(pass);
        }
    }

    fn fields(&self, judge: &Judge, json: &mut Json) {
        let record = &self.record;
        json.integer("n", i64::from(self.number));
        json.text("line", &SourceLine(record.line).to_string());
        json.text("kind", record.kind.name());
        json.text("state", record.state.name());
        json.integer("strokes", i64::from(record.tally.passes));
        json.decimal::<3>("setpoint_um", record.tally.largest.nm());
        let found = judge.found(&record.cut);
        let apart = found.and_then(|found| found.apart);
        for (key, of) in [
            ("worst_um", found.map(|found| found.worst)),
            ("apart_um", apart),
        ] {
            match of {
                Some(of) => of.fields(key, json),
                None => json.null(key),
            }
        }
        json.flag("age_known", judge.axis(&record.cut).1);
        json.number("before", self.over - self.passes.len());
        json.array_at("passes", |json| {
            for pass in &self.passes {
                match pass {
                    Some([least, most]) => json.object(|json| {
                        json.decimal::<3>("least", least.whole()[0]);
                        most.fields("most", json);
                    }),
                    None => json.item("null"),
                }
            }
        });
        let words = judge.words(record).unwrap_or_default();
        json.text("en", &words.en);
        json.text("zh", &words.zh);
    }
}

/// Where the groove of the one pass lies that is new: a new end of the range is its own.
fn narrowed(
    [least, most]: [Figure; 2],
    before: &CutTally,
    now: &CutTally,
    fresh: usize,
) -> [Figure; 2] {
    let ([low, high], [was_low, was_high]) = (now.grooves(), before.grooves());
    match fresh {
        1 if high > was_high => [most; 2],
        1 if low < was_low => [least; 2],
        _ => [least, most],
    }
}

/// The last threads of a board.
#[derive(Debug, Default)]
pub struct Cuts {
    list: VecDeque<Thread>,
    /// Starts of the board.
    boots: u32,
    read: Option<Instant>,
    is_locked: bool,
    /// A pass has ended since the reading.
    has_ended: bool,
    /// At the reading nothing was under way, and nothing has been since.
    is_quiet: bool,
}

impl Cuts {
    /// Whether the certificates are to be read; `is_locked`: an axis follows the spindle.
    pub fn is_due(&mut self, is_locked: bool, now: Instant) -> bool {
        self.has_ended |= self.is_locked && !is_locked;
        self.is_locked = is_locked;
        self.is_quiet &= !is_locked && !self.has_ended;
        let Some(read) = self.read else { return true };
        let pause = if self.has_ended { SOON } else { THREADS };
        !self.is_quiet && now.saturating_duration_since(read) >= pause
    }

    /// Takes certificates, the newest first. True where there are news.
    pub fn take(
        &mut self,
        told: &[ThreadCertificate],
        judge: &Judge,
        boots: u32,
        now: Instant,
    ) -> bool {
        let is_other = self.boots != boots;
        if is_other {
            self.list.clear();
        }
        let mut news = is_other || self.read.is_none();
        (self.boots, self.read, self.has_ended) = (boots, Some(now), false);
        for certificate in told.iter().rev() {
            let known = self
                .list
                .iter_mut()
                .find(|known| known.number == certificate.number);
            match known {
                Some(known) if known.record == certificate.record => continue,
                Some(known) => known.go_on(&certificate.record, judge),
                None => self.list.push_back(Thread::new(certificate, judge)),
            }
            news = true;
        }
        while self.list.len() > KEPT {
            self.list.pop_front();
        }
        let newest = told.first();
        let goes_on = newest.is_some_and(|told| told.record.state == ThreadState::UnderWay);
        self.is_quiet = !goes_on && !self.is_locked;
        news
    }

    /// The threads, the oldest first.
    pub fn json(&self, judge: &Judge) -> String {
        object(|json| {
            json.array_at("threads", |list| {
                for thread in &self.list {
                    list.object(|json| thread.fields(judge, json));
                }
            });
        })
    }
}

#[cfg(test)]
mod tests;
