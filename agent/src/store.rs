//! What is kept until the broker has it: records in the order of their numbers, and how far the board was read.
//!
//! One transaction keeps the records of an observation with the memory that follows from it, so a kill at any point leaves
//! both or neither. A record goes when all have it for whom it is kept: the broker has acknowledged it, and it is in a file
//! of the archive. Each of the two goes on from a number of its own. Where room is short, the oldest states go, then the
//! oldest events; certificates never do, and a record tells what went [D407]. A disk that is full has no room for another
//! state either: then the store lives on what it has, and on its reserve [D435].
//!
//! One store is for all machines of an agent: its numbers count all of their records, and what is remembered is remembered
//! for each [D394].

mod database;
mod error;
mod figures;
mod tables;

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use redb::{ReadableDatabase as _, ReadableTable as _, WriteTransaction};
use serde::Deserialize;

pub use self::error::StoreError;
pub use self::figures::Figures;

use self::database::{Inside, Opener, builder};
use self::error::StoreResult;
use self::tables::{FIGURES, HEAD, MEMORY, NAMELESS, first, get, memory_of, put, records, table};
use crate::model::Memory;
use crate::record::{Class, Moment, Numbered, Record};
use crate::reserve::Reserve;

/// For whom records are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Readers {
    /// A broker.
    pub broker: bool,
    /// An archive.
    pub archive: bool,
}

/// What waits for the archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// When the agent knew of the first of it.
    pub first: Moment,
    /// So many records at most.
    pub most: u64,
    /// A plan has not come to its end.
    pub planned: bool,
}

/// What is written to the archive in one go.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// It begins with this number, of which no other plan of the store does.
    pub first: u64,
    /// Its last number.
    pub last: u64,
    /// Its records, in order. Some of its numbers may have gone for want of room.
    pub records: Vec<Numbered>,
}

/// A store.
pub struct Store {
    inside: Mutex<Inside>,
    limit: u64,
}

impl fmt::Debug for Store {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Store(limit {})", self.limit)
    }
}

impl Store {
    /// Opens the file, or makes it. `limit`: bytes of records.
    ///
    /// # Errors
    /// [`StoreError::InUse`], or the file cannot be used.
    pub fn open(path: &Path, limit: u64, at: Moment) -> StoreResult<Self> {
        let path = path.to_owned();
        if !path.exists() {
            make(&path, at)?;
        }
        let opener = {
            let path = path.clone();
            move || builder().open(&path).map_err(Into::into)
        };
        Self::reserved(Box::new(opener), &path, limit, at)
    }

    /// The same of what `opener` opens.
    ///
    /// # Errors
    /// As of `opener`.
    pub fn of(opener: Opener, limit: u64, at: Moment) -> StoreResult<Self> {
        Self::with(opener, None, limit, at)
    }

    /// The same, with a reserve beside the file of that path.
    ///
    /// # Errors
    /// As of `opener`.
    pub fn reserved(opener: Opener, path: &Path, limit: u64, at: Moment) -> StoreResult<Self> {
        Self::with(opener, Some(Reserve::new(path, at.0)), limit, at)
    }

    fn with(opener: Opener, reserve: Option<Reserve>, limit: u64, at: Moment) -> StoreResult<Self> {
        let store = Self {
            inside: Mutex::new(Inside::new(opener, reserve)),
            limit,
        };
        store.write(|writing| {
            for class in Class::ALL {
                writing.open_table(table(class))?;
            }
            let mut head = writing.open_table(HEAD)?;
            if head.get(FIGURES)?.is_none() {
                let figures = Figures {
                    made: at,
                    ..Figures::default()
                };
                put(&mut head, FIGURES, &figures)?;
            }
            Ok(())
        })?;
        Ok(store)
    }

    /// Says for whom it is kept; else for a broker alone.
    pub fn serve(&self, readers: Readers) {
        self.inside().readers = readers;
    }

    /// Bytes of records that it keeps.
    #[must_use]
    pub const fn limit(&self) -> u64 {
        self.limit
    }

    /// The disk is full, and states go for want of room on it.
    #[must_use]
    pub fn is_tight(&self) -> bool {
        self.inside().full
    }

    fn inside(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One transaction: all of it, or nothing.
    fn write<T>(&self, work: impl Fn(&WriteTransaction) -> StoreResult<T>) -> StoreResult<T> {
        self.inside().write(work)
    }

    /// Says for which machines it is. What an earlier version kept in it for its one machine is then that machine's.
    ///
    /// # Errors
    /// [`StoreError::Nameless`], or the file cannot be written.
    pub fn adopt(&self, machines: &[&str]) -> StoreResult {
        self.write(|writing| {
            let mut head = writing.open_table(HEAD)?;
            let Some(memory) = get::<Memory>(&head, MEMORY)? else {
                return Ok(());
            };
            let [machine] = machines else {
                return Err(StoreError::Nameless);
            };
            head.remove(MEMORY)?;
            put(&mut head, &memory_of(machine), &memory)?;
            put(&mut head, NAMELESS, machine)
        })
    }

    /// Keeps records of a machine and what was remembered with them; gives each its number.
    ///
    /// # Errors
    /// The file cannot be written. Then nothing of it is kept.
    pub fn keep(
        &self,
        machine: &str,
        records: &[Record],
        memory: &Memory,
    ) -> StoreResult<Vec<Numbered>> {
        let mut inside = self.inside();
        if let Some(last) = records.last() {
            inside.attend(last.at)?;
        }
        let (readers, handed) = (inside.readers, inside.handed);
        let limit = inside.tight.unwrap_or(self.limit).min(self.limit);
        inside.write(|writing| {
            let mut head = writing.open_table(HEAD)?;
            let mut figures: Figures = get(&head, FIGURES)?.unwrap_or_default();
            let mut kept = Vec::new();
            for record in records {
                let number = figures.add(writing, record)?;
                kept.push(Numbered {
                    number,
                    record: record.clone(),
                });
            }
            if let Some(last) = records.last() {
                let told = figures.told(readers, handed);
                figures.make_room(writing, limit, handed, told, last)?;
            }
            put(&mut head, FIGURES, &figures)?;
            put(&mut head, &memory_of(machine), memory)?;
            Ok(kept)
        })
    }

    /// What was remembered of a machine last.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn memory(&self, machine: &str) -> StoreResult<Memory> {
        let memory = self.read_head(&memory_of(machine))?;
        Ok(memory.unwrap_or_default())
    }

    /// Its figures.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn figures(&self) -> StoreResult<Figures> {
        let figures = self.read_head(FIGURES)?;
        Ok(figures.unwrap_or_default())
    }

    fn read_head<T: for<'de> Deserialize<'de>>(&self, entry: &str) -> StoreResult<Option<T>> {
        let mut inside = self.inside();
        inside.attempt(|database| {
            let reading = database.begin_read()?;
            get(&reading.open_table(HEAD)?, entry)
        })
    }

    /// The first records behind a number, in order, for a broker.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn hand(&self, behind: u64, most: usize) -> StoreResult<Vec<Numbered>> {
        let mut inside = self.inside();
        let records = inside.attempt(|database| {
            let reading = database.begin_read()?;
            let figures: Figures = get(&reading.open_table(HEAD)?, FIGURES)?.unwrap_or_default();
            let next = behind.max(figures.sent).saturating_add(1);
            records(&reading, next..=u64::MAX, most)
        })?;
        if let Some(last) = records.last() {
            inside.handed = inside.handed.max(last.number);
        }
        Ok(records)
    }

    /// The broker has all up to a number. What the archive need not have is removed.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn acknowledge(&self, number: u64) -> StoreResult {
        self.pass(|figures| figures.sent = figures.sent.max(number))
    }

    /// The plan of the archive up to this number is carried out. What the broker need not have is removed.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn archived(&self, number: u64) -> StoreResult {
        self.pass(|figures| {
            figures.archived = figures.archived.max(number);
            figures.planned = None;
        })
    }

    /// Somebody has come further: what all have is removed.
    fn pass(&self, come: impl Fn(&mut Figures)) -> StoreResult {
        let mut inside = self.inside();
        let readers = inside.readers;
        inside.write(|writing| {
            let mut head = writing.open_table(HEAD)?;
            let mut figures: Figures = get(&head, FIGURES)?.unwrap_or_default();
            come(&mut figures);
            let all_have = figures.all_have(readers);
            for class in Class::ALL {
                let mut table = writing.open_table(table(class))?;
                while let Some(bytes) = first(&mut table, |first| first <= all_have)? {
                    figures.remove(bytes.1);
                }
            }
            let told = figures.told(readers, figures.sent);
            figures.loss = figures.loss.filter(|(at, _)| *at > told);
            put(&mut head, FIGURES, &figures)
        })
    }

    /// What waits for the archive. `None`: nothing.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn waiting(&self) -> StoreResult<Option<Waiting>> {
        self.inside().attempt(|database| {
            let reading = database.begin_read()?;
            let figures: Figures = get(&reading.open_table(HEAD)?, FIGURES)?.unwrap_or_default();
            let first = records(&reading, figures.archived + 1..=u64::MAX, 1)?;
            Ok(first.first().map(|first| Waiting {
                first: first.record.at,
                most: figures.newest.saturating_sub(first.number) + 1,
                planned: figures.planned.is_some(),
            }))
        })
    }

    /// The plan that is under way, else the next one with so many records at most, which is then under way.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn plan(&self, most: usize) -> StoreResult<Plan> {
        let mut inside = self.inside();
        let figures = inside.attempt(|database| {
            let reading = database.begin_read()?;
            let figures: Option<Figures> = get(&reading.open_table(HEAD)?, FIGURES)?;
            Ok(figures.unwrap_or_default())
        })?;
        let first = figures.archived + 1;
        let end = figures.planned.unwrap_or(u64::MAX);
        let most = if figures.planned.is_some() {
            usize::MAX
        } else {
            most
        };
        let records =
            inside.attempt(|database| records(&database.begin_read()?, first..=end, most))?;
        let last = records.last().map_or(figures.archived, |last| last.number);
        let last = figures.planned.unwrap_or(last);
        if figures.planned.is_none() {
            inside.write(|writing| {
                let mut head = writing.open_table(HEAD)?;
                let mut figures: Figures = get(&head, FIGURES)?.unwrap_or_default();
                figures.planned = Some(last);
                put(&mut head, FIGURES, &figures)
            })?;
        }
        Ok(Plan {
            first,
            last,
            records,
        })
    }

    /// A connection to a broker begins: how many there were. What was handed to one before is handed again.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn connect(&self) -> StoreResult<u64> {
        let mut inside = self.inside();
        inside.handed = 0;
        inside.write(|writing| {
            let mut head = writing.open_table(HEAD)?;
            let mut figures: Figures = get(&head, FIGURES)?.unwrap_or_default();
            figures.connections += 1;
            put(&mut head, FIGURES, &figures)?;
            Ok(figures.connections)
        })
    }
}

/// Makes the file under another name first: one that is killed while it is made cannot be opened.
fn make(path: &Path, at: Moment) -> StoreResult {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let new = PathBuf::from(name);
    let begin = || match fs::remove_file(&new) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    };
    begin().map_err(redb::Error::Io)?;
    let opener = {
        let new = new.clone();
        move || builder().create(&new).map_err(Into::into)
    };
    drop(Store::of(Box::new(opener), 0, at)?);
    fs::rename(&new, path).map_err(redb::Error::Io)?;
    Ok(())
}
