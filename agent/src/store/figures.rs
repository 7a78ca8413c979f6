//! How many records there are, for whom, and which go where room is short.

use std::ops::RangeInclusive;

use redb::WriteTransaction;
use serde::{Deserialize, Serialize};

use super::Readers;
use super::error::StoreResult;
use super::tables::{CERTIFICATES, oldest_but, table, written};
use crate::record::{Body, Class, Loss, Moment, Record};

/// Bytes that the record of a loss takes at most, with a name of usual length.
const LOSS: u64 = 256;

/// What is known of a store without reading its records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figures {
    /// When it was made: tells its numbers apart from those of a store before.
    pub made: Moment,
    /// The last number given.
    pub newest: u64,
    /// Records in it.
    pub records: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Records that went for want of room, in all.
    pub lost: u64,
    /// Connections to a broker that were begun.
    pub connections: u64,
    /// The record that tells of the last loss, where it may still be widened.
    pub(super) loss: Option<(u64, Loss)>,
    /// The broker has all up to this number. Earlier versions had removed them, and an archive they had not.
    #[serde(default)]
    pub(super) sent: u64,
    /// All up to this number are in the archive.
    #[serde(default)]
    pub(super) archived: u64,
    /// The last number of what is being written to the archive.
    #[serde(default)]
    pub(super) planned: Option<u64>,
}

impl Figures {
    pub(super) fn add(&mut self, writing: &WriteTransaction, record: &Record) -> StoreResult<u64> {
        let bytes = written(record)?;
        self.newest += 1;
        self.records += 1;
        self.bytes += bytes.len() as u64;
        let mut table = writing.open_table(table(record.body.class()))?;
        table.insert(self.newest, &bytes[..])?;
        Ok(self.newest)
    }

    pub(super) const fn remove(&mut self, bytes: u64) {
        self.records = self.records.saturating_sub(1);
        self.bytes = self.bytes.saturating_sub(bytes);
    }

    /// The last number that all have for whom it is kept.
    pub(super) const fn all_have(&self, readers: Readers) -> u64 {
        match readers {
            Readers {
                broker: true,
                archive: false,
            } => self.sent,
            Readers {
                broker: false,
                archive: true,
            } => self.archived,
            _ if self.sent < self.archived => self.sent,
            _ => self.archived,
        }
    }

    /// A loss up to this number is not widened. A broker hears of each widening where there is an archive: else the losses
    /// of an archive that is not written would fill the room that they tell of.
    pub(super) fn told(&self, readers: Readers, handed: u64) -> u64 {
        if readers.archive {
            self.planned.unwrap_or(self.archived)
        } else {
            handed
        }
    }

    /// What is on its way: a broker has been handed it, a file is being written. It may arrive, so it stays.
    pub(super) fn under_way(&self, handed: u64) -> [RangeInclusive<u64>; 2] {
        let planned = self.planned.unwrap_or(0);
        [self.sent + 1..=handed, self.archived + 1..=planned]
    }

    /// Drops the oldest of what may go until all is within the limit.
    pub(super) fn make_room(
        &mut self,
        writing: &WriteTransaction,
        limit: u64,
        handed: u64,
        told: u64,
        last: &Record,
    ) -> StoreResult {
        let mut lost: Option<Loss> = None;
        for class in [Class::State, Class::Event] {
            let mut table = writing.open_table(table(class))?;
            while self.bytes + LOSS > limit {
                let stays = self.under_way(handed);
                let Some((number, bytes)) = oldest_but(&mut table, &stays)? else {
                    break;
                };
                self.remove(bytes);
                self.lost += 1;
                let one = Loss {
                    records: 1,
                    first: number,
                    last: number,
                };
                lost = Some(lost.map_or(one, |lost| lost.with(&one)));
            }
        }
        match lost {
            Some(lost) => self.tell_loss(writing, lost, told, last),
            None => Ok(()),
        }
    }

    /// One record tells of all that went since the last one that was handed on, of whatever machine: as one of that whose
    /// record found no room.
    pub(super) fn tell_loss(
        &mut self,
        writing: &WriteTransaction,
        mut lost: Loss,
        told: u64,
        last: &Record,
    ) -> StoreResult {
        if let Some((number, before)) = self.loss.filter(|(number, _)| *number > told) {
            lost = before.with(&lost);
            // The number of the record that this one replaces is missing as well.
            lost.last = lost.last.max(number);
            let mut table = writing.open_table(CERTIFICATES)?;
            let old = table.remove(number)?.map(|old| old.value().len() as u64);
            if let Some(bytes) = old {
                self.remove(bytes);
            }
        }
        let record = Record {
            body: Body::Loss(lost),
            ..last.clone()
        };
        let number = self.add(writing, &record)?;
        self.loss = Some((number, lost));
        Ok(())
    }
}

impl Loss {
    pub(super) fn with(&self, other: &Self) -> Self {
        Self {
            records: self.records + other.records,
            first: self.first.min(other.first),
            last: self.last.max(other.last),
        }
    }
}
