//! Where the simulated machines are that `leadscrew up` keeps running: one folder for each user, three files for each
//! machine.
//!
//! ```text
//! $XDG_RUNTIME_DIR/leadscrew/NAME.sock    its CAN bus, as an adapter with SLCAN lines
//!                            NAME.ctl     what is not on the bus: door, power, time
//!                            NAME.lock    locked as long as the machine runs
//! ```
//!
//! Without `XDG_RUNTIME_DIR` the folder is `/tmp/leadscrew-UID`, a name that anybody can take. So the folder has to belong
//! to the user, and nobody else may enter it. This module must not know what a machine does.

use std::fmt;
use std::fs::{self, DirBuilder, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use leadscrew_core::checksum::crc32;
use nix::unistd::geteuid;

use crate::{CanError, WrongAddress};

/// The folder's name.
const FOLDER: &str = "leadscrew";

/// The folder's rights: the user's alone.
const OWN: u32 = 0o700;

/// The attempts to claim a name, and the time between them.
const LOOKS: u32 = 10;
const LOOK: Duration = Duration::from_millis(5);

/// The name of a simulated machine: 1 to 32 letters, digits, `.`, `_` and `-`, a letter or a digit first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MachineName(String);

impl MachineName {
    /// The machine that is meant where none is named.
    pub const USUAL: &'static str = "desk";

    const LONGEST: usize = 32;

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The serial number of the board of this machine: it follows from the name, and is not 0.
    #[must_use]
    pub fn serial(&self) -> u32 {
        crc32(0, self.0.as_bytes()).max(1)
    }
}

impl Default for MachineName {
    fn default() -> Self {
        Self(Self::USUAL.to_owned())
    }
}

impl fmt::Display for MachineName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for MachineName {
    type Err = WrongAddress;

    fn from_str(text: &str) -> Result<Self, WrongAddress> {
        let first = text.bytes().next();
        let possible = first.is_some_and(|byte| byte.is_ascii_alphanumeric())
            && text.len() <= Self::LONGEST
            && text
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte));
        if possible {
            return Ok(Self(text.to_owned()));
        }
        Err(WrongAddress::new(
            format!(
                "`{text}` names no simulated machine: a name has 1 to {most} letters, digits, `.`, `_` and `-`, a letter or a \
                 digit first, as in `desk`",
                most = Self::LONGEST
            ),
            format!(
                "`{text}` 不能作为模拟机床的名称：名称为 1 至 {most} 个字母、数字、`.`、`_` 或 `-`，首字符须为字母或数字，如 `desk`",
                most = Self::LONGEST
            ),
        ))
    }
}

/// A socket of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// Its CAN bus.
    Bus,
    /// What is not on the bus.
    Control,
}

impl Port {
    const fn ending(self) -> &'static str {
        match self {
            Self::Bus => "sock",
            Self::Control => "ctl",
        }
    }
}

/// The folder with the user's machines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Desk {
    folder: PathBuf,
}

impl Desk {
    /// The user's folder, which need not exist yet.
    ///
    /// # Errors
    /// [`CanError::FolderOfOthers`].
    pub fn find() -> Result<Self, CanError> {
        let uid = geteuid().as_raw();
        let runtime = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
        // A relative folder there is to be ignored, as its specification says.
        let folder = match runtime.filter(|path| path.is_absolute() && path.is_dir()) {
            Some(runtime) => runtime.join(FOLDER),
            None => PathBuf::from(format!("/tmp/leadscrew-{uid}")),
        };
        Self::at(folder, uid)
    }

    fn at(folder: PathBuf, uid: u32) -> Result<Self, CanError> {
        match fs::symlink_metadata(&folder) {
            Ok(found) => {
                let (owner, rights) = (found.uid(), found.mode() & 0o777);
                if !found.is_dir() || owner != uid || rights & !OWN != 0 {
                    return Err(CanError::FolderOfOthers {
                        folder: folder.display().to_string(),
                        owner: (owner != uid).then_some(owner),
                    });
                }
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(system(&folder, "look at", error)),
        }
        Ok(Self { folder })
    }

    /// The same, and makes the folder where there is none.
    ///
    /// # Errors
    /// As [`find`](Self::find); the folder cannot be made.
    pub fn make() -> Result<Self, CanError> {
        Self::find()?.made()
    }

    /// The same for commands that are given this folder as their `XDG_RUNTIME_DIR`.
    ///
    /// # Errors
    /// As [`make`](Self::make).
    pub fn make_within(runtime: &Path) -> Result<Self, CanError> {
        Self::at(runtime.join(FOLDER), geteuid().as_raw())?.made()
    }

    fn made(self) -> Result<Self, CanError> {
        match DirBuilder::new().mode(OWN).create(&self.folder) {
            Ok(()) => Ok(self),
            // Somebody may have made it since.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                Self::at(self.folder, geteuid().as_raw())
            }
            Err(error) => Err(system(&self.folder, "make", error)),
        }
    }

    /// The path of a socket.
    #[must_use]
    pub fn socket(&self, name: &MachineName, port: Port) -> PathBuf {
        self.file(name, port.ending())
    }

    fn file(&self, name: &MachineName, ending: &str) -> PathBuf {
        self.folder.join(format!("{name}.{ending}"))
    }

    /// Claims a name for this process, until the claim is dropped. `None` where the machine runs already.
    ///
    /// # Errors
    /// The file of the claim cannot be made.
    pub fn claim(&self, name: &MachineName) -> Result<Option<File>, CanError> {
        let path = self.file(name, "lock");
        // The file stays when the machine ends: a file that was deleted could be claimed twice.
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .map_err(|error| system(&path, "open", error))?;
        // Who asks whether the machine runs holds the lock for a moment, too.
        for _ in 0..LOOKS {
            match file.try_lock() {
                Ok(()) => return Ok(Some(file)),
                Err(TryLockError::WouldBlock) => std::thread::sleep(LOOK),
                Err(TryLockError::Error(error)) => return Err(system(&path, "lock", error)),
            }
        }
        Ok(None)
    }

    /// True while the machine's process lives.
    #[must_use]
    pub fn is_running(&self, name: &MachineName) -> bool {
        let file = File::open(self.file(name, "lock"));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// The names of the machines that run, in order.
    #[must_use]
    pub fn running(&self) -> Vec<MachineName> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut names: Vec<MachineName> = entries
            .filter_map(|entry| {
                entry
                    .file_name()
                    .to_str()?
                    .strip_suffix(".lock")?
                    .parse()
                    .ok()
            })
            .filter(|name| self.is_running(name))
            .collect();
        names.sort();
        names
    }
}

/// Connects to a machine of this user.
///
/// # Errors
/// [`CanError::NoMachine`] where it does not run.
pub fn connect(name: &MachineName, port: Port) -> Result<UnixStream, CanError> {
    let desk = Desk::find()?;
    UnixStream::connect(desk.socket(name, port)).map_err(|error| match error.kind() {
        // A socket that nobody serves is left over from a machine that was killed.
        ErrorKind::NotFound | ErrorKind::ConnectionRefused => CanError::NoMachine {
            name: name.to_string(),
            running: desk.running().iter().map(ToString::to_string).collect(),
        },
        ErrorKind::PermissionDenied => CanError::NoPermission {
            name: format!("sim:{name}"),
        },
        _ => CanError::System {
            name: format!("sim:{name}"),
            doing: "connect to",
            error,
        },
    })
}

fn system(path: &Path, doing: &'static str, error: io::Error) -> CanError {
    CanError::System {
        name: path.display().to_string(),
        doing,
        error,
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    use super::*;

    /// A folder of this test, removed at its end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path =
                std::env::temp_dir().join(format!("leadscrew-desk-{name}-{}", std::process::id()));
            DirBuilder::new().mode(OWN).create(&path).unwrap();
            Self(path)
        }

        fn desk(&self) -> Desk {
            Desk::at(self.0.clone(), geteuid().as_raw()).unwrap()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_name_is_short_and_no_path() {
        for good in ["desk", "a", "7", "lathe-2.b_c"] {
            assert_eq!(good.parse::<MachineName>().unwrap().as_str(), good);
        }
        let long = "a".repeat(33);
        for wrong in ["", ".", "..", "-a", "_a", "a/b", "a b", "車", &long] {
            assert!(wrong.parse::<MachineName>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_folder_that_others_have_made_or_can_enter_is_refused() {
        let folder = Folder::new("others");
        let uid = geteuid().as_raw();
        assert!(Desk::at(folder.0.clone(), uid).is_ok());
        assert!(Desk::at(folder.0.join("none"), uid).is_ok());
        let owner = |path: &Path, uid| match Desk::at(path.to_owned(), uid) {
            Err(CanError::FolderOfOthers { owner, .. }) => owner,
            other => panic!("{other:?}"),
        };
        assert_eq!(owner(&folder.0, uid + 1), Some(uid));
        let link = folder.0.join("link");
        symlink(&folder.0, &link).unwrap();
        assert_eq!(owner(&link, uid), None);
        fs::set_permissions(&folder.0, fs::Permissions::from_mode(0o750)).unwrap();
        assert_eq!(owner(&folder.0, uid), None);
    }

    #[test]
    fn a_machine_runs_as_long_as_its_claim_is_held() {
        let folder = Folder::new("claim");
        let desk = folder.desk();
        let name = |text: &str| text.parse::<MachineName>().unwrap();
        let (a, b) = (name("a"), name("b"));
        assert!(!desk.is_running(&a));
        let claim = desk.claim(&a).unwrap().unwrap();
        let other = desk.claim(&b).unwrap().unwrap();
        assert!(desk.claim(&a).unwrap().is_none());
        assert_eq!(desk.running(), [a.clone(), b.clone()]);
        drop(other);
        assert_eq!(desk.running(), std::slice::from_ref(&a));
        drop(claim);
        assert!(desk.claim(&a).unwrap().is_some());
        assert_eq!(desk.running(), []);
    }
}
