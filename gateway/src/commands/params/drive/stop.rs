//! What drives do where the SYNC that a board follows stays away: they are told NMT stop, and 6007h says the rest [D173].

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::SyncSource;
use leadscrew_core::params::Params;

use crate::link::{Link, LinkResult};
use crate::params::drives::{DriveName, Kind, STOP, Setting};
use crate::words::{Both, both};

/// Asks the drives of a board that is to follow, but for those whose sections say it: what is to be said of them that
/// would go on, or do not tell. Files are warned of by themselves.
///
/// # Errors
/// The bus is gone.
pub fn going_on(
    link: &mut Link,
    settings: &[Setting],
    old: &Params,
    new: &Params,
) -> LinkResult<Vec<Both>> {
    let follows = |params: &Params| SyncSource::of(params.sync_source()) == SyncSource::Bus;
    let nodes = DriveNodes::of(new);
    let known = follows(old) && DriveNodes::of(old) == nodes && settings.is_empty();
    let mut notes = Vec::new();
    if !follows(new) || known {
        return Ok(notes);
    }
    // Three axes, and the spindles there are.
    let count = usize::from(new.tap_spindles()) + 3;
    for name in DriveName::ALL.into_iter().take(count) {
        if settings.iter().any(|setting| setting.drive == name) {
            continue;
        }
        let drive = name.among(&nodes);
        let told = link.ask_shortly(drive.node, STOP)?;
        let node = drive.node.get();
        match told.and_then(|bytes| Kind::I16.decode(&bytes)) {
            Some(0) => notes.push(both!(
                "drive {drive} (node {node}) goes on where the SYNC that the board follows (9029 = 1) stays away: its 6007h \
                 is 0; write `abort_connection_option = 3` in `[drive.{drive}]`",
                "控制板跟随他方的 SYNC（9029 = 1），而 SYNC 中断时驱动器 {drive}（节点 {node}）会继续运行：其 6007h 为 0；请在 \
                 `[drive.{drive}]` 中写 `abort_connection_option = 3`"
            )),
            Some(_) => {}
            None => notes.push(both!(
                "drive {drive} (node {node}) does not tell what it does where the SYNC that the board follows (9029 = 1) stays \
                 away (6007h): look it up in its manual",
                "控制板跟随他方的 SYNC（9029 = 1），而驱动器 {drive}（节点 {node}）未说明 SYNC 中断时的动作（6007h）：请查阅其手册"
            )),
        }
    }
    Ok(notes)
}
