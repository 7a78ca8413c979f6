//! Room on the disk that is taken in good time and given back when the disk is full, so that a store can still write: what
//! goes first goes in a transaction, which needs pages too [D435].
//!
//! It must not know what is written with it.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Its bytes: some ten thousand certificates with their pages.
const SIZE: u64 = 4 << 20;
/// Between two tries to take it again, in milliseconds.
const AGAIN: u64 = 30_000;
/// Spreads the bits of a number: a file system that packs what it holds finds nothing to pack.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// A file beside the store.
#[derive(Debug)]
pub struct Reserve {
    path: PathBuf,
    taken: bool,
    tried: u64,
}

impl Reserve {
    /// Takes it where there is room.
    pub fn new(store: &Path, at: u64) -> Self {
        let mut path = store.as_os_str().to_owned();
        path.push(".reserve");
        let mut reserve = Self {
            path: path.into(),
            taken: false,
            tried: at,
        };
        reserve.take();
        reserve
    }

    /// Gives its room to the store; false where it has been given before.
    pub fn give(&mut self) -> bool {
        if !self.taken {
            return false;
        }
        self.taken = false;
        fs::remove_file(&self.path).is_ok()
    }

    /// Takes it now and then where it was given; true where it has been taken again.
    pub fn attend(&mut self, at: u64) -> bool {
        // The clock may be set back.
        if self.taken || at.abs_diff(self.tried) <= AGAIN {
            return false;
        }
        self.tried = at;
        self.take();
        self.taken
    }

    fn take(&mut self) {
        let there = fs::metadata(&self.path).is_ok_and(|file| file.len() == SIZE);
        self.taken = there || fill(&self.path).is_ok();
        if !self.taken {
            // Half of it is room that the store lacks.
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn fill(path: &Path) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    for number in 0..SIZE / 8 {
        let mixed = number.wrapping_add(1).wrapping_mul(SPREAD);
        file.write_all(&(mixed ^ mixed >> 29).wrapping_mul(SPREAD).to_ne_bytes())?;
    }
    file.into_inner()?.sync_all()
}

/// The disk, the share of this user, or the file has no more room.
pub fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge
    )
}
