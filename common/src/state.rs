//! `--state FILE`: the flash of the simulated board, kept between commands.
//!
//! A file that is no image, or a damaged one, is refused and never overwritten. A new image is first written to a file next
//! to it, which then replaces it in one step. So the file always holds the old image or the new one.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use leadscrew_board_sim::plant::{Flash, ImageError};
use leadscrew_board_sim::stored_params;
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::Found;
use leadscrew_core::journal::{RecordError, TapRecord};
use leadscrew_core::offsets::Offsets;
use leadscrew_core::params::Params;
use leadscrew_store::{BUFFER, Region, Store};

use crate::diagnostics::alarm_words;
use crate::failure::{Doing, Failure, Outcome};
use crate::words::{self, both};

/// The folder for what programs keep: `$XDG_STATE_HOME/leadscrew`, else `~/.local/state/leadscrew`. `None` where neither
/// variable names a folder.
#[must_use]
pub fn folder() -> Option<PathBuf> {
    // A relative folder in XDG_STATE_HOME is to be ignored, as its specification says.
    let named = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    let state = named("XDG_STATE_HOME").or_else(|| Some(named("HOME")?.join(".local/state")))?;
    Some(state.join("leadscrew"))
}

/// A file with the flash of a simulated board.
#[derive(Clone, Debug)]
pub struct StateFile {
    path: PathBuf,
}

impl StateFile {
    /// Names the file.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
        }
    }

    fn name(&self) -> String {
        words::path(&self.path)
    }

    /// The flash in the file, or an erased flash where there is no such file yet.
    ///
    /// # Errors
    /// A file that cannot be read or is no image; a missing folder, because the file could never be made.
    pub fn load_or_new(&self) -> Outcome<Flash> {
        match self.read() {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let folder = self.path.parent().filter(|path| **path != *Path::new(""));
                match folder {
                    Some(folder) if !folder.is_dir() => {
                        Err(Failure::file(Doing::Write, self.name(), &error))
                    }
                    _ => Ok(Flash::erased()),
                }
            }
            read => self.image(read),
        }
    }

    /// The flash in the file.
    ///
    /// # Errors
    /// A file that is missing, cannot be read, or is no image.
    pub fn load(&self) -> Outcome<Flash> {
        self.image(self.read())
    }

    /// Reads at most one byte more than an image: another file may be endless.
    fn read(&self) -> io::Result<Vec<u8>> {
        let file = File::open(&self.path)?;
        if file.metadata()?.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let mut bytes = Vec::new();
        let most = Flash::IMAGE as u64 + 1;
        file.take(most).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn image(&self, read: io::Result<Vec<u8>>) -> Outcome<Flash> {
        let name = self.name();
        let bytes = read.map_err(|error| Failure::file(Doing::Read, &name, &error))?;
        let reason = match Flash::from_image(&bytes) {
            Ok(flash) => return Ok(flash),
            Err(ImageError::Foreign) => both!(
                "it is no image of a simulated board's flash",
                "它不是模拟控制板的闪存映像"
            ),
            Err(ImageError::Earlier) => both!(
                "it is of an earlier version, whose board had a flash of 32 KiB instead of 128 (`leadscrew up --new` makes a machine anew)",
                "它属于早期版本，其控制板的闪存为 32 KiB，而不是 128 KiB（`leadscrew up --new` 重新建立机床）"
            ),
            Err(ImageError::Length(found)) if found > Flash::IMAGE => both!(
                "it is longer than the {most} bytes of an image",
                "它比映像的 {most} 字节长",
                most = Flash::IMAGE
            ),
            Err(ImageError::Length(found)) => both!(
                "it has {found} of the {most} bytes of an image",
                "它只有 {found} 字节，而映像应有 {most} 字节",
                most = Flash::IMAGE
            ),
            Err(ImageError::Damaged) => both!(
                "it is damaged: its checksum does not fit",
                "它已损坏：校验和不符"
            ),
        };
        Err(Failure::Usage(both!(
            "`--state {name}`: {en}; it has been left as it is. Restore a copy of it, or name a file that does not \
             exist yet to begin with a new board",
            "`--state {name}`：{zh}；文件未作改动。请恢复它的备份，或指定一个尚不存在的文件，从一块新的控制板开始",
            en = reason.en,
            zh = reason.zh
        )))
    }

    /// Writes a flash to the file in one step.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, flash: &Flash) -> Outcome {
        let replaced = crate::replace::replace(&self.path, &flash.image());
        replaced.map_err(|error| Failure::file(Doing::Write, self.name(), &error))
    }

    /// The same without waiting for the disk: see [`replace_soon`](crate::replace::replace_soon).
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save_soon(&self, flash: &Flash) -> Outcome {
        let replaced = crate::replace::replace_soon(&self.path, &flash.image());
        replaced.map_err(|error| Failure::file(Doing::Write, self.name(), &error))
    }

    /// The parameter set in the flash of this file; `None` where none was ever stored.
    ///
    /// # Errors
    /// Stored sets that are damaged, or of another table: the board's alarm says which, and what helps.
    pub fn params(&self, flash: &Flash) -> Outcome<Option<Params>> {
        let mut flash = flash.clone();
        flash.power(true);
        let built_in = Params::slant_bed();
        let up = stored_params(&mut flash, &built_in);
        let (found, alarm) = match &up {
            Ok(up) => (Some(up.found), up.found.alarm()),
            Err(alarm) => (None, Some(*alarm)),
        };
        if let Some(alarm) = alarm {
            let name = self.name();
            let why = alarm_words(&alarm);
            return Err(Failure::WrongBecause(both!(
                "`{name}`: {en}; `leadscrew params restore --state {name}` takes the last good set, `leadscrew params push \
                 FILE --state {name}` another one",
                "`{name}`：{zh}；`leadscrew params restore --state {name}` 可采用最后一份完好的参数集，`leadscrew params push \
                 FILE --state {name}` 可写入另一份",
                en = why.en,
                zh = why.zh
            )));
        }
        Ok(match (found, up) {
            (Some(Found::Newest), Ok(up)) => Some(up.params),
            _ => None,
        })
    }

    /// The table of offsets and tools in the flash of this file; `None` where none was ever stored.
    ///
    /// # Errors
    /// A stored table that is damaged or of another layout.
    pub fn offsets(&self, flash: &Flash) -> Outcome<Option<Offsets>> {
        let mut flash = flash.clone();
        flash.power(true);
        let kept = match stored_params(&mut flash, &Params::slant_bed()) {
            Ok(up) => up.offsets,
            // The journal says so.
            Err(_) => return Ok(None),
        };
        let table = Offsets::decode(&kept.table).unwrap_or_default();
        match kept.found {
            Found::Newest => Ok(Some(table)),
            Found::Nothing => Ok(None),
            _ => {
                let name = self.name();
                let figures = [Arg::Int(table.revision.0.into())];
                let why = alarm_words(&Alarm::of(Code::OffsetsDamaged, &figures));
                Err(Failure::WrongBecause(both!(
                    "`{name}`: {en}",
                    "`{name}`：{zh}",
                    en = why.en,
                    zh = why.zh
                )))
            }
        }
    }

    /// The tap journal in the flash of this file.
    ///
    /// # Errors
    /// An entry that cannot be read: a tap may be in a hole, and the way out is unknown.
    pub fn journal(&self, flash: &Flash) -> Outcome<Option<TapRecord>> {
        journal(flash).map_err(|unreadable| {
            let name = self.name();
            let why = match unreadable {
                Unreadable::Store => both!("the flash cannot be read", "闪存读不出来"),
                Unreadable::Record(RecordError::Version(found, known)) => both!(
                    "its entry has version {found}, and this software knows version {known}",
                    "记录的版本是 {found}，本软件只认识版本 {known}"
                ),
                Unreadable::Record(RecordError::Length(found)) => both!(
                    "its entry has {found} of {most} bytes",
                    "记录有 {found} 字节，应有 {most} 字节",
                    most = TapRecord::BYTES
                ),
                Unreadable::Record(RecordError::Damaged) => both!(
                    "the checksum of its entry does not fit",
                    "记录的校验和不符"
                ),
                Unreadable::Record(RecordError::Impossible) => both!(
                    "its entry says what no hole can give",
                    "记录的内容不可能来自任何孔"
                ),
            };
            Failure::WrongBecause(both!(
                "the tap journal in `{name}` is unreadable: {en}. A tap may be in a hole: look at the machine, bring the \
                 tap out by hand, then drop the entry with `leadscrew retract --discard --state {name}`",
                "`{name}` 里的攻丝记录无法读取：{zh}。丝锥可能还在孔里：请检查机床，手动退出丝锥，再用 \
                 `leadscrew retract --discard --state {name}` 清除记录",
                en = why.en,
                zh = why.zh
            ))
        })
    }
}

/// The reason why the journal cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unreadable {
    Store,
    Record(RecordError),
}

/// The newest entry of the tap journal.
fn journal(flash: &Flash) -> Result<Option<TapRecord>, Unreadable> {
    let mut buffer = [0; BUFFER];
    let mut store = Store::new(flash.clone()).map_err(|_| Unreadable::Store)?;
    let recovered = store.recover();
    match recovered.and_then(|()| store.read(Region::TapJournal, &mut buffer)) {
        Err(_) => Err(Unreadable::Store),
        Ok(None) => Ok(None),
        Ok(Some(bytes)) => TapRecord::decode(bytes).map_err(Unreadable::Record),
    }
}

/// The set with which a board with this flash starts, if one was ever stored. For damaged sets: the board's alarm, and the
/// set for its communication.
#[must_use]
pub fn stored_set(flash: &Flash) -> Option<Params> {
    let mut flash = flash.clone();
    let mut store = Store::new(&mut flash).ok()?;
    store.recover().ok()?;
    let up = store.power_up(Params::slant_bed);
    (up.found != Found::Nothing).then_some(up.params)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    struct Place(PathBuf);

    impl Place {
        fn new(name: &str) -> Self {
            let folder =
                std::env::temp_dir().join(format!("leadscrew-state-{name}-{}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn file(&self) -> StateFile {
            StateFile::new(&self.0.join("flash.bin"))
        }
    }

    impl Drop for Place {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_flash_comes_back_as_it_was_and_nothing_is_left_beside_it() {
        let place = Place::new("back");
        let file = place.file();
        assert_eq!(file.load_or_new().unwrap(), Flash::erased());
        assert!(file.load().is_err());
        let nowhere = StateFile::new(&place.0.join("no/such/flash.bin"));
        let Err(Failure::Usage(told)) = nowhere.load_or_new() else {
            panic!("it could never be kept");
        };
        assert!(told.en.contains("there is no such folder"), "{}", told.en);
        let mut store = Store::new(Flash::erased()).unwrap();
        store.write(Region::TapJournal, b"no entry").unwrap();
        let flash = store.into_flash();
        file.save(&flash).unwrap();
        file.save(&flash).unwrap();
        assert_eq!(file.load().unwrap().image(), flash.image());
        assert_eq!(fs::read_dir(&place.0).unwrap().count(), 1);
        let Err(Failure::WrongBecause(told)) = file.journal(&flash) else {
            panic!("those bytes are no entry");
        };
        assert!(told.en.contains("8 of 72 bytes") && told.en.contains("retract --discard"));
    }

    #[test]
    fn what_is_no_image_is_refused_and_left_alone() {
        let place = Place::new("foreign");
        let file = place.file();
        let good = Flash::erased().image().to_vec();
        let mut damaged = good.clone();
        damaged[100] ^= 1;
        let mut long = good.clone();
        long.push(0);
        for (bytes, word) in [
            (b"G0 X0\n".to_vec(), "no image"),
            (Vec::new(), "no image"),
            (good[..good.len() - 1].to_vec(), "of the 133132 bytes"),
            // What eight pages took.
            (good[..33_292].to_vec(), "a flash of 32 KiB"),
            (long, "longer"),
            (damaged, "checksum"),
        ] {
            fs::write(&file.path, &bytes).unwrap();
            for told in [file.load(), file.load_or_new()] {
                let Err(Failure::Usage(told)) = told else {
                    panic!("{word}");
                };
                assert!(told.en.contains(word), "{}", told.en);
            }
            assert_eq!(fs::read(&file.path).unwrap(), bytes);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let place = Place::new("link");
        let real = place.0.join("real.bin");
        fs::write(&real, Flash::erased().image()).unwrap();
        std::os::unix::fs::symlink(&real, place.0.join("flash.bin")).unwrap();
        let file = place.file();
        file.save(&Flash::erased()).unwrap();
        assert!(fs::symlink_metadata(&file.path).unwrap().is_symlink());
        assert!(file.load().is_ok());
    }
}
