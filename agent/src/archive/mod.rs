//! Files of Parquet with what was kept, for a database to read: the history.
//!
//! ```text
//! store ─► plan: which records, and under which name ─► a file of each kind and day ─► done: they may go
//! ```
//!
//! A plan is in the store before the first of its files is written, and is carried out again where it did not come to its
//! end. The names follow from the plan, and a file that has its name is whole. So wherever the agent is killed, each record
//! is in one file, once.
//!
//! ```text
//! rows    records as columns of a file            shelf   where files are put: aside first, and renamed
//! ```
//!
//! It has no clock, and must not know who sends the same records to a broker.

mod rows;
mod shelf;

use std::collections::BTreeMap;
use std::fmt;
use std::io;

use chrono::NaiveDate;

use crate::record::{Moment, Numbered};
use crate::store::{Store, StoreError};

pub use shelf::{Folder, Shelf};

/// Records of a plan at most: what one turn holds in memory.
const MOST: u64 = 8192;
/// Bytes of records that a store of this limit holds for each record of a plan: most records are shorter.
const BYTES_EACH: u64 = 1024;
/// Milliseconds in an hour and in a day.
const HOUR: u64 = 3_600_000;
const DAY: u64 = 24 * HOUR;

/// Whose files they are. It stands in each of them, for files of many agents lie together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The group of the agent: the shop.
    pub shop: String,
    /// The agent.
    pub node: String,
}

/// Why nothing was written.
#[derive(Debug)]
pub enum ArchiveError {
    /// The folder, or a file in it.
    Folder(io::Error),
    /// Rows cannot be written as Parquet.
    Parquet(parquet::errors::ParquetError),
    /// The store.
    Store(StoreError),
}

impl fmt::Display for ArchiveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(error) => error.fmt(f),
            Self::Parquet(error) => error.fmt(f),
            Self::Store(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ArchiveError {}

impl From<StoreError> for ArchiveError {
    fn from(error: StoreError) -> Self {
        Self::Store(error)
    }
}

/// An archive of one store.
#[derive(Debug)]
pub struct Archive<S> {
    origin: Origin,
    shelf: S,
}

impl<S: Shelf> Archive<S> {
    /// On a shelf.
    pub const fn new(origin: Origin, shelf: S) -> Self {
        Self { origin, shelf }
    }

    /// Writes what waits, where it is time: the hour is another than that of the first that waits, so many wait that
    /// the store would fill, or the agent ends. Gives the number of records that were written.
    ///
    /// # Errors
    /// The folder cannot be written, or the store. It is gone on with the next time.
    pub fn attend(&self, store: &Store, now: Moment, ending: bool) -> Result<u64, ArchiveError> {
        let most = MOST.min(store.limit() / BYTES_EACH);
        let mut records = 0;
        while let Some(waiting) = store.waiting()? {
            let is_over = waiting.first.0 / HOUR != now.0 / HOUR;
            if !waiting.planned && !is_over && waiting.most < most && !ending {
                break;
            }
            records += self.write(store, most)?;
        }
        Ok(records)
    }

    /// One plan.
    fn write(&self, store: &Store, most: u64) -> Result<u64, ArchiveError> {
        let made = store.figures()?.made;
        let plan = store.plan(usize::try_from(most).unwrap_or(usize::MAX))?;
        let mut files: BTreeMap<(&str, u64), Vec<&Numbered>> = BTreeMap::new();
        for record in &plan.records {
            let kind = record.record.body.kind();
            let day = record.record.at.0 / DAY;
            files.entry((kind, day)).or_default().push(record);
        }
        for ((kind, day), records) in files {
            let path = self.path(kind, day, made, plan.first);
            // What has its name is whole: an earlier turn with this plan came so far.
            if !self.shelf.has(&path).map_err(ArchiveError::Folder)? {
                let bytes =
                    rows::file(&self.origin, made, &records).map_err(ArchiveError::Parquet)?;
                let put = self.shelf.put(&path, &bytes);
                put.map_err(ArchiveError::Folder)?;
            }
        }
        store.archived(plan.last)?;
        Ok(plan.records.len() as u64)
    }

    /// Where a file goes. No two plans of any two agents of a name and a store have the same first number.
    fn path(&self, kind: &str, day: u64, made: Moment, first: u64) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let plain = |name: &str| name.replace(|c| !is_plain(c), "_");
        let Origin { shop, node } = &self.origin;
        let (shop, node, made) = (plain(shop), plain(node), made.0);
        let date = date(day);
        format!("record={kind}/date={date}/{shop}.{node}.{made}.{first:012}.parquet")
    }
}

/// The date of a day since 1970, as YYYY-MM-DD.
fn date(day: u64) -> NaiveDate {
    let day = i32::try_from(day).ok();
    // No clock of a computer is so far off.
    day.and_then(NaiveDate::from_epoch_days)
        .unwrap_or(NaiveDate::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_has_its_date() {
        for (day, text) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (364, "1970-12-31"),
            (789, "1972-02-29"),
            (11_016, "2000-02-29"),
            (20_784, "2026-11-27"),
            (47_540, "2100-02-28"),
            (47_541, "2100-03-01"),
        ] {
            assert_eq!(date(day).to_string(), text, "{day}");
        }
    }

    #[test]
    fn a_name_is_one_part_of_a_path() {
        let origin = Origin {
            shop: "../hall 2".to_owned(),
            node: "a/b.é".to_owned(),
        };
        let archive = Archive::new(origin, Folder::new("/nowhere".into()));
        assert_eq!(
            archive.path("thread", 20_784, Moment(17), 3),
            "record=thread/date=2026-11-27/___hall_2.a_b__.17.000000000003.parquet"
        );
    }
}
