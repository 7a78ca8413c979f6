//! The drives' own objects: read, and compared with what they are to be.

mod apply;
mod setpoints;
#[cfg(test)]
mod tests;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{Abort, Mapped, Object, SdoError};

use super::pdo::{INVALID, mapped};
use crate::failure::{Failure, Outcome};
use crate::link::{Link, Trouble, reason};
use crate::params::difference::DriveChange;
use crate::params::drives::{
    Drive, Kind, NO_REMOTE, Setting, Wanted, mapping_literal, mapping_text, object_text,
};
use crate::words::{Both, both};

pub use apply::{apply, check_periods, only_drives, with_drives};
pub use setpoints::check_setpoints;

/// What an object is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A number.
    Number(i64),
    /// The mapping of a PDO.
    Mapping {
        /// What is in it.
        objects: Vec<Mapped>,
        /// Its COB-ID, with the bit that switches it off.
        cob_id: u32,
    },
}

impl Found {
    /// Its value in a file.
    pub fn literal(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Mapping { objects, .. } => mapping_literal(objects),
        }
    }
}

/// An object that is another one than wanted.
#[derive(Clone, Debug)]
pub struct Pending {
    /// Of which drive.
    pub drive: Drive,
    /// What it is to be.
    pub wanted: Wanted,
    /// The PDO of a mapping is to stay off: its section gives it a COB-ID that says so.
    pub off: bool,
    /// What it is.
    pub found: Found,
}

impl Pending {
    /// Whether an object is as it is to be. A PDO that has objects is to be used, too: who says what is in it wants to have
    /// it, and many drives are delivered with their second PDOs off.
    fn is(&self, found: &Found) -> bool {
        match (&self.wanted, found) {
            (Wanted::Number { object, value, .. }, Found::Number(is)) if is_cob_id(*object) => {
                (value ^ is) & !i64::from(NO_REMOTE) == 0
            }
            (Wanted::Number { value, .. }, Found::Number(is)) => value == is,
            (
                Wanted::Mapping { objects, .. },
                Found::Mapping {
                    objects: are,
                    cob_id,
                },
            ) => objects == are && (self.off || objects.is_empty() || cob_id & INVALID == 0),
            _ => false,
        }
    }

    /// In words.
    pub fn change(&self) -> DriveChange {
        let (old, new) = match (&self.found, &self.wanted) {
            (Found::Number(old), Wanted::Number { value, .. }) => {
                (old.to_string(), value.to_string())
            }
            (
                Found::Mapping {
                    objects: old,
                    cob_id,
                },
                Wanted::Mapping { objects, .. },
            ) => {
                let off = if cob_id & INVALID == 0 { "" } else { " (off)" };
                (mapping_text(old) + off, mapping_text(objects))
            }
            // A number is read as a number.
            _ => (String::new(), String::new()),
        };
        DriveChange {
            drive: self.drive.name.name(),
            object: object_text(self.wanted.object()),
            old,
            new,
        }
    }
}

/// What each of these is on its drive, where `drives` says that it is.
///
/// # Errors
/// A drive that does not answer, does not have the object, or has another type.
pub fn found(link: &mut Link, settings: &[Setting], drives: &DriveNodes) -> Outcome<Vec<Found>> {
    settings
        .iter()
        .map(|setting| read(link, setting.drive.among(drives), &setting.wanted))
        .collect()
}

/// Everything that is not as it is wanted.
///
/// # Errors
/// As [`found`].
pub fn pending(
    link: &mut Link,
    settings: &[Setting],
    drives: &DriveNodes,
) -> Outcome<Vec<Pending>> {
    let found = found(link, settings, drives)?;
    let each = settings.iter().zip(found).map(|(setting, found)| Pending {
        drive: setting.drive.among(drives),
        wanted: setting.wanted.clone(),
        off: stays_off(setting, settings),
        found,
    });
    Ok(each.filter(|one| !one.is(&one.found)).collect())
}

/// The same section gives the PDO a COB-ID that switches it off.
fn stays_off(setting: &Setting, settings: &[Setting]) -> bool {
    let Wanted::Mapping { communication, .. } = setting.wanted else {
        return false;
    };
    settings.iter().any(|other| match other.wanted {
        Wanted::Number { object, value, .. } => {
            other.drive == setting.drive
                && object == Object::new(communication, 1)
                && value & i64::from(INVALID) != 0
        }
        Wanted::Mapping { .. } => false,
    })
}

/// The identifier of a PDO.
const fn is_cob_id(object: Object) -> bool {
    is_of_pdo(object) && object.sub == 1
}

/// When a PDO is sent, or what is received in it counts.
const fn is_type(object: Object) -> bool {
    is_of_pdo(object) && object.sub == 2
}

/// How a PDO is carried.
const fn is_of_pdo(object: Object) -> bool {
    matches!(object.index, 0x1400..=0x15FF | 0x1800..=0x19FF)
}

fn read(link: &mut Link, drive: Drive, wanted: &Wanted) -> Outcome<Found> {
    let node = drive.node;
    let mut number = |object: Object, kind: Kind| -> Outcome<i64> {
        let bytes = link
            .read_of(node, object)
            .map_err(|trouble| refused(drive, &trouble))?;
        kind.decode(&bytes)
            .ok_or_else(|| other_type(drive, object, kind, bytes.len()))
    };
    match wanted {
        Wanted::Number { object, kind, .. } => Ok(Found::Number(number(*object, *kind)?)),
        Wanted::Mapping {
            mapping,
            communication,
            ..
        } => {
            let cob_id = number(Object::new(*communication, 1), Kind::U32)? as u32;
            let count = number(Object::new(*mapping, 0), Kind::U8)?;
            let objects: Outcome<Vec<Mapped>> = (1..=u8::try_from(count).unwrap_or(0))
                .map(|sub| {
                    let raw = number(Object::new(*mapping, sub), Kind::U32)?;
                    Ok(mapped(raw as u32))
                })
                .collect();
            Ok(Found::Mapping {
                objects: objects?,
                cob_id,
            })
        }
    }
}

/// A drive says no, or nothing.
fn refused(drive: Drive, trouble: &Trouble) -> Failure {
    let Trouble::Transfer {
        object,
        write,
        error,
        ..
    } = trouble
    else {
        return Failure::Bus(trouble.words());
    };
    let doing = if *write {
        both!("writing", "写")
    } else {
        both!("reading", "读")
    };
    let (reason, node) = (reason(*error), drive.node.get());
    let remedy = remedy(drive, *error);
    let words = both!(
        "drive {drive} (node {node}): {doing_en} object {object} {en}: {remedy_en}",
        "驱动器 {drive}（节点 {node}）：{doing_zh}对象 {object} {zh}：{remedy_zh}",
        object = object_text(*object),
        doing_en = doing.en,
        doing_zh = doing.zh,
        en = reason.en,
        zh = reason.zh,
        remedy_en = remedy.en,
        remedy_zh = remedy.zh
    );
    match trouble.refusal() {
        Some(_) => Failure::WrongBecause(words),
        None => Failure::Bus(words),
    }
}

/// What to do about a drive that says no, or nothing.
fn remedy(drive: Drive, error: SdoError) -> Both {
    let node = drive.node.get();
    match error.abort() {
        Some(Abort::TimedOut) => both!(
            "is it on, and is {node} its number (parameters 9015 and 9016)",
            "它通电了吗？节点号是 {node} 吗（参数 9015 和 9016）"
        ),
        Some(Abort::NoObject | Abort::NoSubIndex) => both!(
            "this drive does not have it, leave it, or the profile that asks for it, out of `[drive.{drive}]`",
            "该驱动器没有此对象，请从 `[drive.{drive}]` 中删除它或要求它的 `profile`"
        ),
        Some(Abort::Access | Abort::ReadOnly | Abort::WriteOnly) => both!(
            "this drive does not let it change, leave it, or the profile that asks for it, out of `[drive.{drive}]`",
            "该驱动器不允许更改，请从 `[drive.{drive}]` 中删除它或要求它的 `profile`"
        ),
        Some(Abort::TooHigh | Abort::TooLow | Abort::Value | Abort::MaximumBelowMinimum) => both!(
            "its manual has the range, correct `[drive.{drive}]`",
            "范围见驱动器手册，请改正 `[drive.{drive}]`"
        ),
        Some(Abort::Length | Abort::TooLong | Abort::TooShort) => both!(
            "its manual has the type, correct `[drive.{drive}]`",
            "类型见驱动器手册，请改正 `[drive.{drive}]`"
        ),
        Some(Abort::NotMappable | Abort::PdoLength) => both!(
            "its manual lists what it can map, correct `[drive.{drive}]`",
            "可映射的对象见驱动器手册，请改正 `[drive.{drive}]`"
        ),
        Some(Abort::State | Abort::LocalControl) => both!(
            "end what else operates it (its panel, its maker's program), then try again",
            "请结束正在操作它的面板或厂家软件，然后重试"
        ),
        Some(
            Abort::Toggle
            | Abort::Specifier
            | Abort::BlockSize
            | Abort::Sequence
            | Abort::Crc
            | Abort::NoConnection,
        ) => both!(
            "end what else talks to it, look at the wiring, then try again",
            "请结束与它通信的其它程序、检查接线，然后重试"
        ),
        _ => both!(
            "look the code up in its manual",
            "请在驱动器手册中查找该代码"
        ),
    }
}

fn other_type(drive: Drive, object: Object, kind: Kind, bytes: usize) -> Failure {
    Failure::WrongBecause(both!(
        "drive {drive} (node {node}): object {object} has {bytes} bytes there, and {kind} has {wanted}: correct its type in \
         `[drive.{drive}]`; nothing has been changed",
        "驱动器 {drive}（节点 {node}）：对象 {object} 在驱动器上有 {bytes} 字节，而 {kind} 有 {wanted} 字节：请改正 \
         `[drive.{drive}]` 中的类型；未作任何改动",
        node = drive.node.get(),
        object = object_text(object),
        kind = kind.name(),
        wanted = kind.bytes()
    ))
}
