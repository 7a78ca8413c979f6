//! Where each drive has its setpoints from: a frame of its own, or its place in the one that all get (9031). A drive that
//! listened at another drive's place would go where that one is sent, so this is looked at before the board's set changes.

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{Mapped, NodeId, Object, Setpoints};
use leadscrew_core::params::Params;

use super::{Found, read};
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::params::drives::{
    Drive, DriveName, Kind, NO_REMOTE, Setting, Wanted, command_mapping, mapping_text,
};
use crate::words::both;

/// RPDO1: its identifier, and its mapping.
const COB_ID: Object = Object::new(0x1400, 1);
const MAPPING: u16 = 0x1600;

/// Refuses a set that gives the drives their setpoints otherwise than they take them, with what the sections write:
/// wherever setpoints come in one frame before it or behind it, and a section, a drive's node or this changes.
///
/// # Errors
/// [`Failure::WrongBecause`]; a drive that does not answer.
pub fn check_setpoints(
    link: &mut Link,
    settings: &[Setting],
    old: &Params,
    new: &Params,
) -> Outcome {
    let nodes = DriveNodes::of(new);
    let same = old.setpoint_frame() == new.setpoint_frame() && DriveNodes::of(old) == nodes;
    if same && (new.setpoint_frame() == 0 || settings.is_empty()) {
        return Ok(());
    }
    let board = link.node();
    // Three axes, and the spindles there are.
    let count = usize::from(new.tap_spindles()) + 3;
    for name in DriveName::ALL.into_iter().take(count) {
        let drive = name.among(&nodes);
        let mut is = |wanted: Wanted| {
            let written = settings
                .iter()
                .filter(|setting| setting.drive == name)
                .find(|setting| setting.wanted.object() == wanted.object());
            match written.map(|setting| &setting.wanted) {
                Some(Wanted::Number { value, .. }) => Ok(Found::Number(*value)),
                Some(Wanted::Mapping { objects, .. }) => Ok(Found::Mapping {
                    objects: objects.clone(),
                    cob_id: 0,
                }),
                None => read(link, drive, &wanted),
            }
        };
        let cob_id = is(Wanted::Number {
            object: COB_ID,
            kind: Kind::U32,
            value: 0,
        })?;
        let mapped = is(Wanted::Mapping {
            mapping: MAPPING,
            communication: COB_ID.index,
            objects: Vec::new(),
        })?;
        if let (Found::Number(cob_id), Found::Mapping { objects, .. }) = (cob_id, mapped) {
            compare(drive, board, new, cob_id, &objects)?;
        }
    }
    Ok(())
}

fn compare(drive: Drive, board: NodeId, new: &Params, cob_id: i64, objects: &[Mapped]) -> Outcome {
    let wanted = match new.setpoint_frame() {
        0 => 0x200 + i64::from(drive.node.get()),
        _ => i64::from(Setpoints::cob_id(board).get()),
    };
    let mapping = command_mapping(drive.name, new);
    // Bit 30 says nothing of an RPDO.
    if cob_id & !i64::from(NO_REMOTE) == wanted && objects == mapping {
        return Ok(());
    }
    Err(Failure::WrongBecause(both!(
        "drive {drive} takes its setpoints from {cob_id:03X}h with {is}, and the board would send them (9031) with {wanted:03X}h \
         and {mapping}: write `rpdo1_cob_id = 0x{wanted:03X}` and `rpdo1 = {literal}` in `[drive.{drive}]`; nothing has been \
         changed",
        "驱动器 {drive} 从 {cob_id:03X}h 接收设定值（{is}），而控制板（9031）将以 {wanted:03X}h 和 {mapping} 发送：请在 \
         `[drive.{drive}]` 中写 `rpdo1_cob_id = 0x{wanted:03X}` 和 `rpdo1 = {literal}`；未作任何改动",
        is = mapping_text(objects),
        literal = crate::params::drives::mapping_literal(&mapping),
        mapping = mapping_text(&mapping)
    )))
}
