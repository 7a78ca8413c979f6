//! Writing the drives' own objects, in order, with each read back.
//!
//! A drive is written in pre-operational, where CiA 301 lets its PDOs change: the board notices that it is silent and
//! stops, and what follows brings the drives up again [D122]. Where one object is refused, what was written before it gets
//! its old value back. Types of PDOs come first: a PDO that is switched on has its type by then.

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{NmtCommand, NodeId, Object, Order, SdoError};
use leadscrew_core::params::Params;

use super::{Found, Pending, is_cob_id, is_type, read, refused};
use crate::commands::params::pdo::{INVALID, Pdo};
use crate::failure::{Failure, Outcome};
use crate::link::{Link, LinkResult, Trouble};
use crate::params::drives::{
    Drive, DriveName, Kind, NO_REMOTE, PERIOD_EXPONENT, PERIOD_VALUE, Setting, Wanted, object_text,
    period_conflict,
};
use crate::words::{Both, both};

/// 1010h:01h, and what it takes.
const STORE: Object = Object::new(0x1010, 1);
const SAVE: [u8; 4] = *b"save";

/// Refuses a set whose tick is not what the drives interpolate over: those with sections, and where the tick changes, all
/// that tell it.
///
/// # Errors
/// [`Failure::WrongBecause`]; a drive with a section that does not answer.
pub fn check_periods(link: &mut Link, settings: &[Setting], old: &Params, new: &Params) -> Outcome {
    let nodes = DriveNodes::of(new);
    for drive in DriveName::ALL {
        let wanted = |object| {
            settings.iter().find_map(|setting| match setting.wanted {
                Wanted::Number {
                    object: at, value, ..
                } if setting.drive == drive && at == object => Some(value),
                _ => None,
            })
        };
        let named = settings.iter().any(|setting| setting.drive == drive);
        if !named && old.tick_us() == new.tick_us() {
            continue;
        }
        let at = drive.among(&nodes);
        let mut value_of = |object, kind| match wanted(object) {
            Some(value) => Ok(Some(value)),
            None => link
                .ask(at.node, object)
                .map(|bytes| bytes.and_then(|b| Kind::decode(kind, &b)))
                .map_err(|trouble| refused(at, &trouble)),
        };
        let value = value_of(PERIOD_VALUE, Kind::U8)?;
        let exponent = match value {
            None => None,
            Some(_) => value_of(PERIOD_EXPONENT, Kind::I8)?,
        };
        let (Some(value), Some(exponent)) = (value, exponent) else {
            continue;
        };
        if let Some((period, tick)) = period_conflict(value, exponent, new) {
            return Err(Failure::WrongBecause(both!(
                "drive {drive} interpolates over {period} (60C2h), and a setpoint would come every {tick} (9000): write \
                 `interpolation_period` in `[drive.{drive}]`, or leave 9000 as it is; nothing has been changed",
                "驱动器 {drive} 的插补周期为 {period}（60C2h），而设定值将每 {tick} 到达一次（9000）：请在 `[drive.{drive}]` 中写 \
                 `interpolation_period`，或不要修改 9000；未作任何改动"
            )));
        }
    }
    Ok(())
}

/// Writes them, each drive in pre-operational, and reads each back. `done` is told of every one.
///
/// # Errors
/// The first that is refused, or does not read back; what was written before it has its old value again.
pub fn apply(link: &mut Link, pending: &[Pending], done: &mut dyn FnMut()) -> Outcome<Vec<Both>> {
    let mut pending = pending.to_vec();
    // All others stay in their order.
    pending.sort_by_key(|pending| !is_type(pending.wanted.object()));
    let drives = to_pre_operational(link, &pending)?;
    for (at, pending_) in pending.iter().enumerate() {
        let written = write(link, pending_);
        let wrong = match written {
            Ok(()) => match read(link, pending_.drive, &pending_.wanted) {
                Ok(found) if pending_.is(&found) => None,
                Ok(_) => Some(unkept(pending_)),
                Err(failure) => Some(failure),
            },
            Err(trouble) => Some(refused(pending_.drive, &trouble)),
        };
        if let Some(failure) = wrong {
            let back = undo(link, &pending[..=at]);
            // A bus that fails now, too, would say less than what has failed first.
            let _ = start(link, &drives);
            return Err(with(failure, back));
        }
        done();
    }
    let mut notes = Vec::new();
    for drive in &drives {
        match link.write_of(drive.node, STORE, &SAVE) {
            Ok(()) => {}
            Err(trouble) if trouble.refusal().is_some() => notes.push(both!(
                "drive {drive} does not keep this by itself (1010h): after it was switched off it has to be pushed again",
                "驱动器 {drive} 自身不保存这些值（1010h）：断电后需要重新写入"
            )),
            Err(trouble) => {
                // As above.
                let _ = start(link, &drives);
                return Err(only_drives(refused(*drive, &trouble)));
            }
        }
    }
    match start(link, &drives) {
        Ok(()) => Ok(notes),
        Err(trouble) => Err(only_drives(trouble.into())),
    }
}

/// What to say where something fails behind the drives and before the board is told to take its set.
pub fn only_drives(failure: Failure) -> Failure {
    failure.and(&both!(
            "; the drives have their new values and may lose them when switched off, and the board's set has not been changed",
            "；驱动器已写入新值，断电后可能丢失；控制板的参数集未作改动"
        ),
    )
}

/// The drives of these objects, in pre-operational.
fn to_pre_operational(link: &mut Link, pending: &[Pending]) -> LinkResult<Vec<Drive>> {
    let mut drives: Vec<Drive> = pending.iter().map(|pending| pending.drive).collect();
    drives.sort_unstable();
    drives.dedup();
    for drive in &drives {
        link.send(&[NmtCommand::PreOperational.frame(Some(drive.node))])?;
    }
    Ok(drives)
}

/// What to say where the board's set did not come into force after the drives were written. Where the board has said so,
/// the drives get their old values back first [D156]; `reset`: there was no alarm before, and there is to be none because
/// of that.
pub fn with_drives(link: &mut Link, pending: &[Pending], trouble: Trouble, reset: bool) -> Failure {
    if pending.is_empty() {
        return trouble.into();
    }
    // Any other trouble, an abort of something asked after the commit too, leaves it open which set the board has.
    if !matches!(trouble, Trouble::Parameters { .. }) {
        let more = match trouble {
            Trouble::Unsettled { .. } => {
                both!("; the drives have their new values", "；驱动器已写入新值")
            }
            _ => both!(
                "; the drives have their new values, and whether the board has the new set is not known: push again",
                "；驱动器已写入新值，控制板是否采用新参数集不详：请重新写入"
            ),
        };
        return Failure::from(trouble).and(&more);
    }
    let lost = take_back(link, pending, reset);
    Failure::from(trouble).and(&match lost {
        Ok(lost) if lost.is_empty() => both!(
            "; the drives have their old values again",
            "；驱动器已恢复原值"
        ),
        Ok(lost) => both!(
            "; these did not take their old value back: {lost}",
            "；以下对象未能恢复原值：{lost}",
            lost = lost.join(", ")
        ),
        Err(trouble) => {
            let Both { en, zh } = trouble.words();
            both!(
                "; the drives may have their new values: {en}",
                "；驱动器可能仍为新值：{zh}"
            )
        }
    })
}

fn take_back(link: &mut Link, pending: &[Pending], reset: bool) -> LinkResult<Vec<String>> {
    let drives = to_pre_operational(link, pending)?;
    let lost = undo(link, pending);
    let mut kept = Ok(());
    for drive in &drives {
        // Whether it keeps anything has been said at the first time.
        match link.write_of(drive.node, STORE, &SAVE) {
            Err(trouble) if trouble.refusal().is_none() => kept = kept.and(Err(trouble)),
            _ => {}
        }
    }
    // The values are what they are: a bus that fails now, too, takes nothing of what there is to say about them. The
    // machine stands on its alarm then, until somebody resets it.
    let _ = start(link, &drives)
        .and_then(|()| link.wait_at_rest())
        .and_then(|()| match reset {
            true => link.order(Order::Reset),
            false => Ok(()),
        });
    kept?;
    Ok(lost)
}

/// Gives what was written its old value back, the last first; what is not as it was then is named.
fn undo(link: &mut Link, written: &[Pending]) -> Vec<String> {
    let mut lost = Vec::new();
    for pending in written.iter().rev() {
        if is_as_before(link, pending) {
            continue;
        }
        // It is looked at whatever the drive says.
        let _ = put_back(link, pending);
        if !is_as_before(link, pending) {
            let object = object_text(pending.wanted.object());
            lost.push(format!("{} {object}", pending.drive));
        }
    }
    lost
}

fn is_as_before(link: &mut Link, pending: &Pending) -> bool {
    read(link, pending.drive, &pending.wanted).is_ok_and(|found| found == pending.found)
}

fn put_back(link: &mut Link, pending: &Pending) -> LinkResult {
    let node = pending.drive.node;
    match (&pending.wanted, &pending.found) {
        (Wanted::Number { object, kind, .. }, Found::Number(value)) => {
            number(link, node, *object, &kind.encode(*value))
        }
        (
            Wanted::Mapping {
                mapping,
                communication,
                ..
            },
            Found::Mapping { objects, cob_id },
        ) => {
            let pdo = Pdo {
                node,
                mapping: *mapping,
                communication: *communication,
            };
            pdo.map(link, objects, *cob_id, *cob_id)
        }
        // A number is read as a number.
        _ => Ok(()),
    }
}

fn start(link: &mut Link, drives: &[Drive]) -> LinkResult {
    for drive in drives {
        link.send(&[NmtCommand::Start.frame(Some(drive.node))])?;
    }
    Ok(())
}

fn with(failure: Failure, lost: Vec<String>) -> Failure {
    let back = if lost.is_empty() {
        both!(
            "; what was written before it has its old value again, and nothing of the board's set has been changed",
            "；之前写入的对象已恢复原值，控制板的参数集未作改动"
        )
    } else {
        both!(
            "; these did not take their old value back: {lost}. Nothing of the board's set has been changed",
            "；以下对象未能恢复原值：{lost}。控制板的参数集未作改动",
            lost = lost.join(", ")
        )
    };
    failure.and(&back)
}

fn write(link: &mut Link, pending: &Pending) -> LinkResult {
    let node = pending.drive.node;
    match &pending.wanted {
        Wanted::Number {
            object,
            kind,
            value,
        } => number(link, node, *object, &kind.encode(*value)),
        Wanted::Mapping {
            mapping,
            communication,
            objects,
        } => {
            let pdo = Pdo {
                node,
                mapping: *mapping,
                communication: *communication,
            };
            let id = pdo.read(link, pdo.cob_id())?;
            let off = if pending.off { INVALID } else { 0 };
            pdo.map(link, objects, id & !INVALID | off, id)
        }
    }
}

/// Writes a number. A PDO gets another identifier only while it is not used, as CiA 301 has it, and keeps its answer to
/// remote requests, which is the drive's own.
fn number(link: &mut Link, node: NodeId, object: Object, bytes: &[u8]) -> LinkResult {
    if is_cob_id(object)
        && let Ok(now) = link.read_of(node, object)?.try_into()
        && let Ok(wanted) = bytes.try_into()
    {
        let now = u32::from_le_bytes(now);
        link.write_of(node, object, &(now | INVALID).to_le_bytes())?;
        let wanted = u32::from_le_bytes(wanted) & !NO_REMOTE | now & NO_REMOTE;
        return link.write_of(node, object, &wanted.to_le_bytes());
    }
    link.write_of(node, object, bytes)
}

fn unkept(pending: &Pending) -> Failure {
    let change = pending.change();
    Failure::WrongBecause(both!(
        "drive {drive} (node {node}): object {object} took {new} and reads back otherwise",
        "驱动器 {drive}（节点 {node}）：对象 {object} 接受了 {new}，但读回的值不同",
        drive = pending.drive,
        node = pending.drive.node.get(),
        object = change.object,
        new = change.new
    ))
}

impl Link {
    /// Reads an object that a node may not have; `None` where it does not have it, or says nothing.
    pub(super) fn ask(&mut self, node: NodeId, object: Object) -> LinkResult<Option<Vec<u8>>> {
        match self.read_of(node, object) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(Trouble::Transfer {
                error: SdoError::TimedOut,
                ..
            }) => Ok(None),
            Err(trouble) if trouble.refusal().is_some() => Ok(None),
            Err(trouble) => Err(trouble),
        }
    }
}
