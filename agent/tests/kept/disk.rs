//! A disk whose power fails at a chosen operation: what was not synced is there in part.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use leadscrew_agent::{Moment, Store, StoreError};
use redb::{Database, StorageBackend};

#[derive(Debug)]
enum Change {
    Bytes(u64, Vec<u8>),
    Length(u64),
}

#[derive(Debug, Default)]
struct Inside {
    synced: Vec<u8>,
    now: Vec<u8>,
    since: Vec<Change>,
    /// Operations until it fails; `None`: it does not.
    left: Option<u64>,
    /// Operations so far.
    done: u64,
    failed: bool,
    /// Bytes that there is room for, together with a file that somebody may remove.
    room: Option<(usize, PathBuf)>,
}

impl Inside {
    /// Where writing ends for want of room.
    fn end(&self) -> usize {
        let beside = |path| std::fs::metadata(path).map_or(0, |file| file.len() as usize);
        match &self.room {
            Some((room, path)) => room.saturating_sub(beside(path)),
            None => usize::MAX,
        }
    }

    fn step(&mut self) -> Result<(), io::Error> {
        self.done += 1;
        if let Some(left) = &mut self.left {
            self.failed |= *left == 0;
            *left = left.saturating_sub(1);
        }
        if self.failed {
            return Err(io::Error::other("the power has failed"));
        }
        Ok(())
    }
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    match change {
        Change::Length(length) => bytes.resize(*length as usize, 0),
        Change::Bytes(at, new) => {
            let at = *at as usize;
            if bytes.len() < at + new.len() {
                bytes.resize(at + new.len(), 0);
            }
            bytes[at..at + new.len()].copy_from_slice(new);
        }
    }
}

/// The disk; its copies are the same one.
#[derive(Clone, Debug, Default)]
pub struct Disk(Arc<Mutex<Inside>>);

impl Disk {
    fn with<T>(&self, work: impl FnOnce(&mut Inside) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Fails after so many operations.
    pub fn fail_behind(&self, operations: u64) {
        self.with(|inside| inside.left = Some(operations));
    }

    /// So many bytes have been written at most.
    pub fn length(&self) -> usize {
        self.with(|inside| inside.now.iter().rposition(|byte| *byte != 0).unwrap_or(0))
    }

    /// There is so much room for it and for the file of that name together.
    pub fn has_room(&self, bytes: usize, beside: &Path) {
        self.with(|inside| inside.room = Some((bytes, beside.to_owned())));
    }

    /// It has failed.
    pub fn has_failed(&self) -> bool {
        self.with(|inside| inside.failed)
    }

    /// Operations so far.
    pub fn operations(&self) -> u64 {
        self.with(|inside| inside.done)
    }

    /// The power comes back. Of the changes since the last sync, those are there whose turn `chance` gives.
    pub fn come_back(&self, mut chance: impl FnMut() -> bool) {
        self.with(|inside| {
            let mut bytes = inside.synced.clone();
            for change in std::mem::take(&mut inside.since) {
                if chance() {
                    apply(&mut bytes, &change);
                }
            }
            inside.synced.clone_from(&bytes);
            inside.now = bytes;
            (inside.left, inside.failed) = (None, false);
        });
    }

    /// An empty one in its place.
    pub fn clear(&self) {
        self.with(|inside| *inside = Inside::default());
    }

    /// A store on it.
    pub fn store(&self, limit: u64) -> Result<Store, StoreError> {
        Store::of(self.opener(), limit, Moment(1))
    }

    /// The same with a reserve beside a file of that name.
    pub fn reserved(&self, path: &Path, limit: u64) -> Result<Store, StoreError> {
        Store::reserved(self.opener(), path, limit, Moment(1))
    }

    fn opener(&self) -> Box<dyn Fn() -> Result<Database, redb::Error> + Send> {
        let disk = self.clone();
        Box::new(move || {
            let database = Database::builder().create_with_backend(disk.clone());
            database.map_err(redb::Error::from)
        })
    }
}

impl StorageBackend for Disk {
    fn len(&self) -> Result<u64, io::Error> {
        self.with(|inside| {
            inside.step()?;
            Ok(inside.now.len() as u64)
        })
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), io::Error> {
        self.with(|inside| {
            inside.step()?;
            let at = offset as usize;
            let bytes = inside.now.get(at..at + out.len());
            let bytes = bytes.ok_or_else(|| io::Error::other("read beyond the end"))?;
            out.copy_from_slice(bytes);
            Ok(())
        })
    }

    fn set_len(&self, len: u64) -> Result<(), io::Error> {
        self.with(|inside| {
            inside.step()?;
            let change = Change::Length(len);
            apply(&mut inside.now, &change);
            inside.since.push(change);
            Ok(())
        })
    }

    fn sync_data(&self) -> Result<(), io::Error> {
        self.with(|inside| {
            inside.step()?;
            inside.synced.clone_from(&inside.now);
            inside.since.clear();
            Ok(())
        })
    }

    fn write(&self, offset: u64, data: &[u8]) -> Result<(), io::Error> {
        self.with(|inside| {
            inside.step()?;
            if offset as usize + data.len() > inside.end() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let change = Change::Bytes(offset, data.to_vec());
            apply(&mut inside.now, &change);
            inside.since.push(change);
            Ok(())
        })
    }
}
