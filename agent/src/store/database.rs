//! The file of a store: its database, which is opened anew after an error, and the room on its disk.
//!
//! It must not know what the transactions are about.

use redb::{Database, ReadableDatabase as _, WriteTransaction};

use super::Readers;
use super::error::{StoreError, StoreResult};
use super::figures::Figures;
use super::tables::{FIGURES, HEAD, get};
use crate::record::Moment;
use crate::reserve::Reserve;

/// Memory for pages in bytes; a store is small, and read in order.
const CACHE: usize = 2 << 20;

/// Opens the database: at the beginning, and after an error.
pub type Opener = Box<dyn Fn() -> Result<Database, redb::Error> + Send>;

/// A database with what is known of it while it is open.
pub(super) struct Inside {
    opener: Opener,
    database: Option<Database>,
    pub(super) readers: Readers,
    /// Numbers up to this have been handed to a broker that has not acknowledged them all.
    pub(super) handed: u64,
    /// Room for a disk that is full.
    reserve: Option<Reserve>,
    /// The disk is full.
    pub(super) full: bool,
    /// Then records have no more room than they had.
    pub(super) tight: Option<u64>,
}

impl Inside {
    /// For a broker alone.
    pub(super) const fn new(opener: Opener, reserve: Option<Reserve>) -> Self {
        Self {
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
        }
    }

    /// After an error the database is opened anew the next time.
    pub(super) fn attempt<T>(
        &mut self,
        work: impl FnOnce(&Database) -> StoreResult<T>,
    ) -> StoreResult<T> {
        let database = match self.database.take() {
            Some(database) => database,
            None => (self.opener)()?,
        };
        let done = work(&database)?;
        self.database = Some(database);
        Ok(done)
    }

    /// A transaction. Where the disk is full it is tried again with the room of the reserve.
    pub(super) fn write<T>(
        &mut self,
        work: impl Fn(&WriteTransaction) -> StoreResult<T>,
    ) -> StoreResult<T> {
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
    pub(super) fn attend(&mut self, at: Moment) -> StoreResult {
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

pub(super) fn builder() -> redb::Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE);
    builder
}
