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

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use redb::{
    Database, ReadTransaction, ReadableDatabase as _, ReadableTable as _, Table, TableDefinition,
    WriteTransaction,
};
use serde::{Deserialize, Serialize};

use crate::model::Memory;
use crate::record::{Body, Class, Loss, Moment, Numbered, Record};
use crate::reserve::{self, Reserve};

const STATES: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("states");
const EVENTS: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("events");
const CERTIFICATES: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("certificates");
const HEAD: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("head");
/// Entries of the head.
const FIGURES: &str = "figures";
/// What was remembered of a machine stands behind this and its name. Earlier versions had one machine, and no name.
const MEMORY: &str = "memory";
/// Whose the records are that name no machine.
const NAMELESS: &str = "nameless";
/// Bytes that the record of a loss takes at most, with a name of usual length.
const LOSS: u64 = 256;
/// Memory for pages in bytes; a store is small, and read in order.
const CACHE: usize = 2 << 20;

const fn table(class: Class) -> TableDefinition<'static, u64, &'static [u8]> {
    match class {
        Class::State => STATES,
        Class::Event => EVENTS,
        Class::Certificate => CERTIFICATES,
    }
}

/// Why nothing could be kept or read.
#[derive(Debug)]
pub enum StoreError {
    /// Another process has the file.
    InUse,
    /// An earlier version kept it for its one machine, and it does not say for which of several.
    Nameless,
    /// The file cannot be opened, read or written.
    File(Box<redb::Error>),
    /// What is kept cannot be understood.
    Content(serde_json::Error),
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InUse => f.write_str("another process has it open"),
            Self::Nameless => f.write_str("it was kept for one machine whose name is not in it"),
            Self::File(error) => error.fmt(f),
            Self::Content(error) => write!(f, "what is kept is not understood: {error}"),
        }
    }
}

impl std::error::Error for StoreError {}

impl StoreError {
    fn is_full(&self) -> bool {
        let Self::File(error) = self else {
            return false;
        };
        matches!(error.as_ref(), redb::Error::Io(error) if reserve::is_full(error))
    }
}

impl<E: Into<redb::Error>> From<E> for StoreError {
    fn from(error: E) -> Self {
        match error.into() {
            redb::Error::DatabaseAlreadyOpen => Self::InUse,
            error => Self::File(Box::new(error)),
        }
    }
}

type StoreResult<T = ()> = Result<T, StoreError>;

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
    loss: Option<(u64, Loss)>,
    /// The broker has all up to this number. Earlier versions had removed them, and an archive they had not.
    #[serde(default)]
    sent: u64,
    /// All up to this number are in the archive.
    #[serde(default)]
    archived: u64,
    /// The last number of what is being written to the archive.
    #[serde(default)]
    planned: Option<u64>,
}

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

/// Opens the database: at the beginning, and after an error.
type Opener = Box<dyn Fn() -> Result<Database, redb::Error> + Send>;

struct Inside {
    opener: Opener,
    database: Option<Database>,
    readers: Readers,
    /// Numbers up to this have been handed to a broker that has not acknowledged them all.
    handed: u64,
    /// Room for a disk that is full.
    reserve: Option<Reserve>,
    /// The disk is full.
    full: bool,
    /// Then records have no more room than they had.
    tight: Option<u64>,
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
            inside: Mutex::new(Inside {
                opener,
                database: None,
                readers: Readers {
                    broker: true,
                    archive: false,
                },
                handed: 0,
                reserve,
                full: false,
                tight: None,
            }),
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

impl Inside {
    /// After an error the database is opened anew the next time.
    fn attempt<T>(&mut self, work: impl FnOnce(&Database) -> StoreResult<T>) -> StoreResult<T> {
        let database = match self.database.take() {
            Some(database) => database,
            None => (self.opener)()?,
        };
        let done = work(&database)?;
        self.database = Some(database);
        Ok(done)
    }

    /// A transaction. Where the disk is full it is tried again with the room of the reserve.
    fn write<T>(&mut self, work: impl Fn(&WriteTransaction) -> StoreResult<T>) -> StoreResult<T> {
        let done = self.transact(&work);
        match &mut self.reserve {
            Some(reserve) if done.as_ref().is_err_and(StoreError::is_full) => {
                self.full = true;
                if reserve.give() {
                    self.transact(&work)
                } else {
                    done
                }
            }
            _ => done,
        }
    }

    fn transact<T>(
        &mut self,
        work: impl Fn(&WriteTransaction) -> StoreResult<T>,
    ) -> StoreResult<T> {
        self.attempt(|database| {
            let writing = database.begin_write()?;
            let done = work(&writing)?;
            writing.commit()?;
            Ok(done)
        })
    }

    /// Sees how it stands with the disk.
    fn attend(&mut self, at: Moment) -> StoreResult {
        if self
            .reserve
            .as_mut()
            .is_some_and(|reserve| reserve.attend(at.0))
        {
            (self.full, self.tight) = (false, None);
        }
        if self.full && self.tight.is_none() {
            let figures: Option<Figures> = self.attempt(|database| {
                let reading = database.begin_read()?;
                get(&reading.open_table(HEAD)?, FIGURES)
            })?;
            self.tight = figures.map(|figures| figures.bytes);
        }
        Ok(())
    }
}

impl Figures {
    fn add(&mut self, writing: &WriteTransaction, record: &Record) -> StoreResult<u64> {
        let bytes = written(record)?;
        self.newest += 1;
        self.records += 1;
        self.bytes += bytes.len() as u64;
        let mut table = writing.open_table(table(record.body.class()))?;
        table.insert(self.newest, &bytes[..])?;
        Ok(self.newest)
    }

    const fn remove(&mut self, bytes: u64) {
        self.records = self.records.saturating_sub(1);
        self.bytes = self.bytes.saturating_sub(bytes);
    }

    /// The last number that all have for whom it is kept.
    const fn all_have(&self, readers: Readers) -> u64 {
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
    fn told(&self, readers: Readers, handed: u64) -> u64 {
        if readers.archive {
            self.planned.unwrap_or(self.archived)
        } else {
            handed
        }
    }

    /// What is on its way: a broker has been handed it, a file is being written. It may arrive, so it stays.
    fn under_way(&self, handed: u64) -> [RangeInclusive<u64>; 2] {
        let planned = self.planned.unwrap_or(0);
        [self.sent + 1..=handed, self.archived + 1..=planned]
    }

    /// Drops the oldest of what may go until all is within the limit.
    fn make_room(
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
    fn tell_loss(
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
    fn with(&self, other: &Self) -> Self {
        Self {
            records: self.records + other.records,
            first: self.first.min(other.first),
            last: self.last.max(other.last),
        }
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

fn builder() -> redb::Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE);
    builder
}

/// Takes out the first record where its number is meant; its number and its bytes.
fn first(
    table: &mut Table<'_, u64, &'static [u8]>,
    is_meant: impl Fn(u64) -> bool,
) -> StoreResult<Option<(u64, u64)>> {
    let found = table.first()?.map(|(number, _)| number.value());
    match found.filter(|number| is_meant(*number)) {
        Some(number) => take(table, number),
        None => Ok(None),
    }
}

/// The same with the first that is in none of these ranges.
fn oldest_but(
    table: &mut Table<'_, u64, &'static [u8]>,
    stays: &[RangeInclusive<u64>],
) -> StoreResult<Option<(u64, u64)>> {
    let mut from = 0;
    loop {
        let found = match table.range(from..)?.next() {
            Some(entry) => entry?.0.value(),
            None => return Ok(None),
        };
        match stays.iter().find(|range| range.contains(&found)) {
            Some(range) => from = range.end() + 1,
            None => return take(table, found),
        }
    }
}

/// The first records in a range of numbers, in order.
fn records(
    reading: &ReadTransaction,
    range: RangeInclusive<u64>,
    most: usize,
) -> StoreResult<Vec<Numbered>> {
    let nameless: Option<String> = get(&reading.open_table(HEAD)?, NAMELESS)?;
    let nameless = nameless.unwrap_or_default();
    let mut records = Vec::new();
    for class in Class::ALL {
        let table = reading.open_table(table(class))?;
        for entry in table.range(range.clone())?.take(most) {
            let (number, bytes) = entry?;
            let number = number.value();
            let mut record: Record = parsed(bytes.value())?;
            if record.machine.is_empty() {
                record.machine.clone_from(&nameless);
            }
            records.push(Numbered { number, record });
        }
    }
    records.sort_by_key(|record| record.number);
    records.truncate(most);
    Ok(records)
}

fn take(table: &mut Table<'_, u64, &'static [u8]>, number: u64) -> StoreResult<Option<(u64, u64)>> {
    let removed = table.remove(number)?;
    Ok(removed.map(|bytes| (number, bytes.value().len() as u64)))
}

fn memory_of(machine: &str) -> String {
    format!("{MEMORY} {machine}")
}

fn written(value: &impl Serialize) -> StoreResult<Vec<u8>> {
    serde_json::to_vec(value).map_err(StoreError::Content)
}

fn parsed<T: for<'de> Deserialize<'de>>(bytes: &[u8]) -> StoreResult<T> {
    serde_json::from_slice(bytes).map_err(StoreError::Content)
}

fn put(
    head: &mut Table<'_, &'static str, &'static [u8]>,
    entry: &str,
    value: &impl Serialize,
) -> StoreResult {
    head.insert(entry, &written(value)?[..])?;
    Ok(())
}

fn get<T: for<'de> Deserialize<'de>>(
    head: &impl redb::ReadableTable<&'static str, &'static [u8]>,
    entry: &str,
) -> StoreResult<Option<T>> {
    match head.get(entry)? {
        Some(bytes) => parsed(bytes.value()).map(Some),
        None => Ok(None),
    }
}
