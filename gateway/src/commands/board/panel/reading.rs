//! What the panel reads of the board beside its state, and tells the pages where there is news: log, contacts, threads.
//!
//! When it is time for it is the business of the [`Side`]; this must not know pages or orders.

use std::time::Instant;

use super::super::watch::Watch;
use super::contacts::Contacts;
use super::cuts::Cuts;
use super::telling::{in_both, log};
use super::{KEPT, Side};
use crate::certified::Judge;
use crate::failure::Outcome;

impl Side<'_, '_> {
    /// Entries of the log, and what else changes seldom.
    pub(super) fn read_log(&mut self) -> Outcome {
        if self.anew {
            let read = Watch::new(&mut self.link);
            let Some(watch) = self.tolerate(read)? else {
                return Ok(());
            };
            (self.watch, self.anew) = (watch, false);
            self.cuts = Cuts::default();
            self.contacts = Contacts::new(self.begun.global);
            self.messages.clear();
        }
        let read = self.watch.log(&mut self.link);
        let entries = self.tolerate(read)?.unwrap_or_default();
        for entry in &entries {
            if let Some(told) = in_both(entry) {
                if self.messages.len() == KEPT {
                    self.messages.pop_front();
                }
                self.messages.push_back(told);
            }
        }
        if !entries.is_empty() {
            self.begun.feed.tell("log", log(&self.messages));
        }
        if let Some((status, _)) = self.record {
            let read = self
                .watch
                .follow(self.begun.global, &mut self.link, &status);
            self.tolerate(read)?;
            self.begun.views.note(self.watch.zeros.read(), &status);
        }
        self.read_contacts()
    }

    fn read_contacts(&mut self) -> Outcome {
        let read = self.link.contacts();
        let Some(contacts) = self.tolerate(read)? else {
            return Ok(());
        };
        self.begun.views.note_gear(contacts.gear);
        let Some((params, _)) = self.watch.zeros.read() else {
            return Ok(());
        };
        if let Some(text) = self.contacts.news(&contacts, params) {
            self.begun.feed.tell("io", text);
        }
        Ok(())
    }

    /// The certificates of threads, where there may be news in them.
    pub(super) fn read_cuts(&mut self, now: Instant) -> Outcome {
        let is_locked = self.link.seen.status.is_some_and(|said| said.flags.locked);
        if !self.cuts.is_due(is_locked, now) || self.watch.zeros.read().is_none() {
            return Ok(());
        }
        let read = self.link.certificates();
        let told = self.tolerate(read)?;
        if let (Some((_, threads)), Some((params, _))) = (told, self.watch.zeros.read()) {
            let judge = Judge::new(params, None);
            if self.cuts.take(&threads, &judge, self.link.seen.boots, now) {
                self.begun.feed.tell("threads", self.cuts.json(&judge));
            }
        }
        Ok(())
    }
}
