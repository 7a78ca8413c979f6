//! Programs that a folder keeps: read whole, written whole or not at all, and never by a name that leads out of the folder.
//!
//! ```text
//! name ─► letters, digits, . _ -   no dot in front, no separator: it names an entry of this folder and nothing else
//! open ─► no link is followed, nothing but a file is opened, and no pipe keeps anybody waiting
//! write ► beside, then in its place: a new one only where nothing is, another only in place of what its writer has seen
//! ```
//!
//! This file must not know sockets, who asks, or what a program means.

use std::collections::hash_map::DefaultHasher;
use std::fs::{self, File, OpenOptions};
use std::hash::{Hash as _, Hasher as _};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nix::libc::{O_CLOEXEC, O_NOFOLLOW, O_NONBLOCK};

use crate::refusal::Refusal;

/// The longest program.
pub const LONGEST: usize = 8 << 20;
/// The longest name.
const NAME: usize = 64;
/// The most programs in a list.
const LISTED: usize = 1000;

/// A folder of programs.
#[derive(Debug)]
pub struct Programs {
    folder: PathBuf,
    /// Files that were written, for the names of those that are not complete yet. Whoever has this writes or claims, and
    /// waits for the disk.
    written: Mutex<u64>,
    /// The program that a machine runs: nobody writes it. Nobody waits for a disk with this in hand: a claim is dropped
    /// where nothing may wait.
    claimed: Mutex<Option<String>>,
}

/// A program of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub size: u64,
}

/// A text, and the tag that it goes by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// All of it.
    pub bytes: Vec<u8>,
    /// Another one where a byte is another.
    pub tag: String,
}

/// What has to be so for a program to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When<'a> {
    /// There is none of this name.
    New,
    /// It is the one of this tag.
    Is(&'a str),
}

/// A program that is about to run, or runs: it stays as it is until this is dropped.
#[derive(Debug)]
pub struct Claim {
    programs: Arc<Programs>,
    /// Where it is.
    pub path: PathBuf,
}

impl Drop for Claim {
    fn drop(&mut self) {
        *self.programs.claimed() = None;
    }
}

impl Programs {
    /// The programs of a folder.
    ///
    /// # Errors
    /// There is no such folder, or it cannot be read.
    pub fn open(folder: &Path) -> io::Result<Self> {
        let folder = fs::canonicalize(folder)?;
        fs::read_dir(&folder)?;
        Ok(Self {
            folder,
            written: Mutex::default(),
            claimed: Mutex::default(),
        })
    }

    /// All of them by name, up to [`LISTED`], and how many more there are. Nothing else is in it: no links, no folders.
    ///
    /// # Errors
    /// [`Refusal::Disk`].
    pub fn list(&self) -> Result<(Vec<Listed>, usize), Refusal> {
        let mut list = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(|_| Refusal::Disk)? {
            let Ok(entry) = entry else { continue };
            // It does not follow a link; what has gone meanwhile is none.
            let (Ok(name), Ok(about)) = (entry.file_name().into_string(), entry.metadata()) else {
                continue;
            };
            if about.is_file() && is_name(&name) {
                let size = about.len();
                list.push(Listed { name, size });
            }
        }
        list.sort_by(|a, b| a.name.cmp(&b.name));
        let further = list.len().saturating_sub(LISTED);
        list.truncate(LISTED);
        Ok((list, further))
    }

    /// A program.
    ///
    /// # Errors
    /// [`Refusal::Name`], [`Refusal::NoProgram`], [`Refusal::TooLong`], [`Refusal::Disk`].
    pub fn read(&self, name: &str) -> Result<Text, Refusal> {
        let file = self.open_file(name)?;
        let mut bytes = Vec::new();
        let limit = LONGEST as u64 + 1;
        let read = file.take(limit).read_to_end(&mut bytes);
        match read {
            Ok(count) if count > LONGEST => Err(Refusal::TooLong),
            Ok(_) => Ok(Text {
                tag: tag(&bytes),
                bytes,
            }),
            Err(_) => Err(Refusal::Disk),
        }
    }

    /// Where a program is that is there now.
    ///
    /// # Errors
    /// As [`Programs::read`].
    pub fn path(&self, name: &str) -> Result<PathBuf, Refusal> {
        self.open_file(name)?;
        Ok(self.folder.join(name))
    }

    /// Writes a program; gives the tag that it has then.
    ///
    /// # Errors
    /// [`Refusal::Changed`] where it is not as it has to be, [`Refusal::Runs`] where a machine runs it; those of
    /// [`Programs::read`].
    pub fn write(&self, name: &str, when: When<'_>, bytes: &[u8]) -> Result<String, Refusal> {
        if !is_name(name) {
            return Err(Refusal::Name);
        }
        if bytes.len() > LONGEST {
            return Err(Refusal::TooLong);
        }
        // One at a time: what was seen is still so when it is replaced.
        let mut written = self.written();
        if self.claimed().as_deref() == Some(name) {
            return Err(Refusal::Runs);
        }
        if let When::Is(seen) = when {
            match self.read(name) {
                Ok(text) if text.tag == seen => {}
                Ok(_) | Err(Refusal::NoProgram) => return Err(Refusal::Changed),
                Err(refusal) => return Err(refusal),
            }
        }
        *written += 1;
        // No name of a program begins with a dot.
        let process = std::process::id();
        let beside = format!(".{name}.new-{process}-{written}");
        let (beside, place) = (self.folder.join(beside), self.folder.join(name));
        let put = fill(&beside, bytes).and_then(|()| match when {
            // A link takes no place that is taken; a renaming would.
            When::New => fs::hard_link(&beside, &place),
            When::Is(_) => fs::rename(&beside, &place),
        });
        // It has its name, or is of no use.
        let _ = fs::remove_file(&beside);
        match put {
            Ok(()) => Ok(tag(bytes)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Err(Refusal::Changed),
            Err(_) => Err(Refusal::Disk),
        }
    }

    /// Keeps the program of this tag as it is, for a machine that runs it. It waits for the disk; dropping it does not.
    ///
    /// # Errors
    /// [`Refusal::Changed`] where it is another, [`Refusal::Runs`] where one is kept already; those of [`Programs::read`].
    pub fn claim(self: &Arc<Self>, name: &str, seen: &str) -> Result<Claim, Refusal> {
        // Nobody writes it, and nobody else claims one, before it is claimed.
        let written = self.written();
        if self.claimed().is_some() {
            return Err(Refusal::Runs);
        }
        if self.read(name)?.tag != seen {
            return Err(Refusal::Changed);
        }
        *self.claimed() = Some(name.to_owned());
        drop(written);
        Ok(Claim {
            programs: Arc::clone(self),
            path: self.folder.join(name),
        })
    }

    fn open_file(&self, name: &str) -> Result<File, Refusal> {
        if !is_name(name) {
            return Err(Refusal::Name);
        }
        let file = OpenOptions::new()
            .read(true)
            .custom_flags(O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)
            .open(self.folder.join(name))
            .map_err(|error| match error.kind() {
                ErrorKind::PermissionDenied => Refusal::Disk,
                // A link is no program either.
                _ => Refusal::NoProgram,
            })?;
        let about = file.metadata().map_err(|_| Refusal::Disk)?;
        if about.is_file() {
            Ok(file)
        } else {
            Err(Refusal::NoProgram)
        }
    }

    fn written(&self) -> MutexGuard<'_, u64> {
        // A number is whole at any time; so is a name.
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn claimed(&self) -> MutexGuard<'_, Option<String>> {
        self.claimed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Letters, digits, dots, lines; no dot in front, so neither `..` nor a file that is hidden.
fn is_name(name: &str) -> bool {
    let fits = |c: u8| c.is_ascii_alphanumeric() || matches!(c, b'.' | b'_' | b'-');
    (1..=NAME).contains(&name.len()) && !name.starts_with('.') && name.bytes().all(fits)
}

/// A new file with these bytes, on the disk.
fn fill(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .custom_flags(O_NOFOLLOW | O_CLOEXEC)
        .open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// It tells two texts apart that people have written; it keeps no secret.
fn tag(bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    format!("{:x}-{:016x}", bytes.len(), hasher.finish())
}

#[cfg(test)]
mod tests;
