//! Where files are put. What stands under a name is whole, after a kill and after a loss of power.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::reserve::is_full;

/// A place for files. Their paths are relative, with `/` between the parts.
pub trait Shelf {
    /// There is a file of that name.
    ///
    /// # Errors
    /// Nobody knows.
    fn has(&self, path: &str) -> io::Result<bool>;

    /// Puts a file there: all of it, or nothing under that name.
    ///
    /// # Errors
    /// It cannot be written.
    fn put(&self, path: &str, bytes: &[u8]) -> io::Result<()>;
}

/// A folder of this computer, or a share of another.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// It is made by [`Folder::try_out`], or when the first file comes.
    #[must_use]
    pub const fn new(path: PathBuf) -> Self {
        Self(path)
    }

    /// Makes it, and a file in it that goes again: who names a folder by mistake is to hear it before the hour is over.
    ///
    /// # Errors
    /// It is not there, or nothing can be written in it. One that is full is good: there may be room again.
    pub fn try_out(&self) -> io::Result<()> {
        let tried = make(&self.0).and_then(|()| {
            let trial = self.0.join(format!("trial.{}.part", std::process::id()));
            let written = File::create(&trial).and_then(|mut file| {
                file.write_all(b"trial")?;
                file.sync_all()
            });
            // An agent of another computer may have tried under the same name.
            let _ = fs::remove_file(&trial);
            written
        });
        match tried {
            Err(error) if is_full(&error) => Ok(()),
            tried => tried,
        }
    }
}

impl Shelf for Folder {
    fn has(&self, path: &str) -> io::Result<bool> {
        self.0.join(path).try_exists()
    }

    fn put(&self, path: &str, bytes: &[u8]) -> io::Result<()> {
        let path = self.0.join(path);
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
            return Err(io::ErrorKind::InvalidFilename.into());
        };
        make(folder)?;
        // No reader of `*.parquet` takes it for one.
        let mut aside = name.to_owned();
        aside.push(".part");
        let aside = folder.join(aside);
        let written = File::create(&aside).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        });
        if let Err(error) = written {
            // Half a file only takes room that is missing.
            let _ = fs::remove_file(&aside);
            return Err(error);
        }
        fs::rename(&aside, &path)?;
        sync(folder)
    }
}

/// Makes a folder with those above it, so that their names stay.
fn make(folder: &Path) -> io::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    let above = folder
        .parent()
        .filter(|above| !above.as_os_str().is_empty());
    if let Some(above) = above {
        make(above)?;
    }
    match fs::create_dir(folder) {
        // Another agent was faster.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    above.map_or(Ok(()), sync)
}

fn sync(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let name = format!("leadscrew-shelf-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&path);
        path
    }

    #[test]
    fn a_file_is_put_whole_and_nothing_stays_beside_it() {
        let path = scratch("whole");
        let folder = Folder::new(path.join("a/b"));
        assert!(!folder.has("c/d/e").unwrap());
        folder.put("c/d/e", b"content").unwrap();
        assert!(folder.has("c/d/e").unwrap());
        assert_eq!(fs::read(path.join("a/b/c/d/e")).unwrap(), b"content");
        assert_eq!(fs::read_dir(path.join("a/b/c/d")).unwrap().count(), 1);
        fs::remove_dir_all(&path).unwrap();
    }

    #[test]
    fn a_folder_is_tried_out_and_nothing_stays_in_it() {
        let path = scratch("trial");
        let folder = path.join("a/b");
        Folder::new(folder.clone()).try_out().unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::write(folder.join("c"), "a file in the place of a folder").unwrap();
        for wrong in [folder.join("c"), folder.join("c/d"), "/proc/nope".into()] {
            assert!(Folder::new(wrong.clone()).try_out().is_err(), "{wrong:?}");
        }
        fs::remove_dir_all(&path).unwrap();
    }

    #[test]
    fn what_cannot_be_written_leaves_no_file() {
        let path = scratch("blocked");
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("c"), "a file in the place of a folder").unwrap();
        let folder = Folder::new(path.clone());
        assert!(folder.put("c/d", b"content").is_err());
        fs::create_dir_all(path.join("e.part")).unwrap();
        assert!(folder.put("e", b"content").is_err());
        assert!(!folder.has("e").unwrap());
        fs::remove_dir_all(&path).unwrap();
    }
}
