//! The block of inputs and outputs on the bus (CiA 401, parameters 9461 to 9463): its objects, read and set.
//!
//! It needs a heartbeat of its own, watches the board's, tells its inputs by TPDO1 on change and every 100 ms, takes its
//! outputs by RPDO1, and puts them at 9463 where the board is lost. All of that follows from the set, so no section of a
//! file says it [D424].

use leadscrew_core::bus::{NmtCommand, NodeId, Object, SdoError};
use leadscrew_core::params::Params;

use super::pdo::{INVALID, Mapping, Pdo, mapped};
use crate::block::{BYTES, INPUTS, OUTPUTS, is_as_wanted, wanted};
use crate::failure::{Failure, Outcome};
use crate::link::{Link, LinkResult, Trouble};
use crate::params::difference::{BLOCK, DriveChange};
use crate::params::drives::{Kind, object_text};
use crate::words::{Both, both};

/// The profile in 1000h.
const PROFILE: i64 = 401;
const DEVICE_TYPE: Object = Object::new(0x1000, 0);
const STORE: Object = Object::new(0x1010, 1);
const SAVE: [u8; 4] = *b"save";

/// A number of the block that is another one than wanted.
#[derive(Clone, Debug)]
pub struct Pending {
    node: NodeId,
    object: Object,
    kind: Kind,
    found: i64,
    wanted: i64,
}

impl Pending {
    /// In words.
    pub fn change(&self) -> DriveChange {
        let text = |value: i64| match self.kind {
            Kind::U32 => format!("{value:08X}h"),
            _ => value.to_string(),
        };
        DriveChange {
            drive: BLOCK,
            object: object_text(self.object),
            old: text(self.found),
            new: text(self.wanted),
        }
    }
}

/// Everything of the block that is not as the set of the board `board` needs it; nothing where the set names no block.
///
/// # Errors
/// The block does not answer, or is none.
pub fn pending(link: &mut Link, params: &Params) -> Outcome<Vec<Pending>> {
    let Some(node) = NodeId::new(params.block_node()) else {
        return Ok(Vec::new());
    };
    if params.block_watch_ms() == 0 {
        return Err(Failure::WrongBecause(both!(
            "the block of inputs and outputs cannot watch a board without heartbeat: set 9023 to 1 ms or more (500), or 9461 to 0",
            "输入输出模块无法监视没有心跳的控制板：请将 9023 设为不小于 1 ms（如 500），或将 9461 设为 0"
        )));
    }
    let profile = number(link, node, DEVICE_TYPE, Kind::U32)?.unwrap_or(0);
    if profile & 0xFFFF != PROFILE {
        return Err(Failure::WrongBecause(both!(
            "node {node} (9461) is no block of inputs and outputs (CiA 401): its 1000h is {profile:08X}h. Write the node of the \
             block into 9461; nothing has been changed",
            "节点 {node}（9461）不是输入输出模块（CiA 401）：其 1000h 为 {profile:08X}h。请将 9461 设为模块的节点号；未作任何改动",
            node = node.get()
        )));
    }
    let mut bytes = |object| -> Outcome<u8> {
        let count = number(link, node, object, Kind::U8)?.unwrap_or(0);
        Ok(u8::try_from(count).unwrap_or(0).min(BYTES))
    };
    let (inputs, outputs) = (bytes(INPUTS)?, bytes(OUTPUTS)?);
    if inputs == 0 {
        return Err(Failure::WrongBecause(both!(
            "the block, node {node} (9461), has no digital inputs (6000h): the board knows by them that it works; take one that has",
            "模块（节点 {node}，9461）没有数字输入（6000h）：控制板靠输入报文判断其工作；请选用带输入的模块",
            node = node.get()
        )));
    }
    let mut pending = Vec::new();
    for (object, kind, wanted) in wanted(params, link.node(), node, inputs, outputs) {
        let Some(found) = number(link, node, object, kind)? else {
            // A block without this switch always says what changes.
            if object.index == 0x6005 {
                continue;
            }
            return Err(lacks(node, object));
        };
        if !is_as_wanted(object, found, wanted) {
            pending.push(Pending {
                node,
                object,
                kind,
                found,
                wanted,
            });
        }
    }
    Ok(pending)
}

/// Sets the block up, in pre-operational; the board's set is in force. Notes what there is to say.
///
/// # Errors
/// The block refuses, or does not answer. What was written to it has its old value again, as far as it takes that; the
/// board's set is in force.
pub fn apply(link: &mut Link, pending: &[Pending]) -> Outcome<Vec<Both>> {
    let Some(node) = pending.first().map(|pending| pending.node) else {
        return Ok(Vec::new());
    };
    link.send(&[NmtCommand::PreOperational.frame(Some(node))])?;
    let mut old = Vec::new();
    let done = match write_all(link, node, pending, &mut old) {
        Ok(()) => keep(link, node),
        Err(trouble) => {
            let lost = undo(link, node, &old);
            Err(with(refused(node, &trouble), &lost))
        }
    };
    // Whatever has come of it: the board goes on with the block as it is.
    let started = link.send(&[NmtCommand::Start.frame(Some(node))]);
    let notes = done?;
    started?;
    Ok(notes)
}

/// What was there before something was written.
#[derive(Debug)]
enum Old {
    Number(Pending),
    Mapping(Pdo, Mapping),
}

fn write_all(link: &mut Link, node: NodeId, pending: &[Pending], old: &mut Vec<Old>) -> LinkResult {
    for (mapping, communication) in [(0x1A00, 0x1800), (0x1600, 0x1400)] {
        let pdo = Pdo {
            node,
            mapping,
            communication,
        };
        let remapped = pending
            .iter()
            .any(|pending| pending.object.index == mapping);
        if remapped {
            remap(link, pending, pdo, old)?;
        }
    }
    for pending in pending {
        if !matches!(pending.object.index, 0x1600 | 0x1A00) {
            old.push(Old::Number(pending.clone()));
            put(link, pending, pending.wanted)?;
        }
    }
    Ok(())
}

/// The block keeps what it has been told over a loss of power.
fn keep(link: &mut Link, node: NodeId) -> Outcome<Vec<Both>> {
    match link.write_of(node, STORE, &SAVE) {
        Ok(()) => Ok(Vec::new()),
        Err(trouble) if trouble.refusal().is_some() => Ok(vec![both!(
            "note: the block of inputs and outputs does not keep this by itself (1010h): after it was switched off it has to be \
             pushed again",
            "注意：输入输出模块自身不保存这些值（1010h）：断电后需要重新写入"
        )]),
        Err(trouble) => Err(refused(node, &trouble)),
    }
}

fn put(link: &mut Link, pending: &Pending, value: i64) -> LinkResult {
    let object = pending.object;
    // An identifier changes only while its PDO is not used.
    if let (0x1400 | 0x1800, 1) = (object.index, object.sub) {
        let off = (value as u32) | INVALID;
        link.write_of(pending.node, object, &off.to_le_bytes())?;
    }
    link.write_of(pending.node, object, &pending.kind.encode(value))
}

/// Writes a mapping. Entries that are right already are written again: a block may forget them with their number.
fn remap(link: &mut Link, pending: &[Pending], pdo: Pdo, old: &mut Vec<Old>) -> LinkResult {
    let before = pdo.found(link)?;
    let wanted = |object| {
        let of = pending.iter().find(|pending| pending.object == object);
        of.map(|pending| pending.wanted as u32)
    };
    let on = wanted(pdo.cob_id()).unwrap_or(before.cob_id & !INVALID);
    let entries = wanted(pdo.count()).unwrap_or(before.objects.len() as u32);
    let mut objects = Vec::new();
    for sub in (1..=BYTES).take_while(|sub| u32::from(*sub) <= entries) {
        let object = pdo.entry(sub);
        let entry = match wanted(object) {
            Some(entry) => entry,
            None => pdo.read(link, object)?,
        };
        objects.push(mapped(entry));
    }
    let back = before.cob_id;
    old.push(Old::Mapping(pdo, before));
    pdo.map(link, &objects, on, back)
}

/// Gives what was written its old value back, the last first; what is not as it was then is named.
fn undo(link: &mut Link, node: NodeId, old: &[Old]) -> Vec<String> {
    let mut lost = Vec::new();
    for old in old.iter().rev() {
        if is_as_before(link, node, old) {
            continue;
        }
        // It is looked at whatever the block says.
        let (object, _) = match old {
            Old::Number(pending) => (pending.object, put(link, pending, pending.found)),
            Old::Mapping(pdo, before) => {
                let id = before.cob_id;
                (pdo.count(), pdo.map(link, &before.objects, id, id))
            }
        };
        if !is_as_before(link, node, old) {
            lost.push(object_text(object));
        }
    }
    lost
}

fn is_as_before(link: &mut Link, node: NodeId, old: &Old) -> bool {
    match old {
        Old::Number(pending) => number(link, node, pending.object, pending.kind)
            .is_ok_and(|found| found == Some(pending.found)),
        Old::Mapping(pdo, before) => pdo.found(link).is_ok_and(|found| found == *before),
    }
}

/// What to say where the block has failed behind the board.
fn with(failure: Failure, lost: &[String]) -> Failure {
    failure.and(&match lost {
        [] => both!(
            "; what was written to it before has its old value again, and the board's set is in force",
            "；之前写入模块的对象已恢复原值，控制板的参数集已生效"
        ),
        lost => both!(
            "; these did not take their old value back: {lost}. The board's set is in force",
            "；以下对象未能恢复原值：{lost}。控制板的参数集已生效",
            lost = lost.join(", ")
        ),
    })
}

/// A number; `None` where the block does not have it.
fn number(link: &mut Link, node: NodeId, object: Object, kind: Kind) -> Outcome<Option<i64>> {
    match link.read_of(node, object) {
        Ok(bytes) => Ok(kind.decode(&bytes)),
        Err(trouble) if trouble.refusal().is_some() => Ok(None),
        Err(trouble) => Err(refused(node, &trouble)),
    }
}

fn lacks(node: NodeId, object: Object) -> Failure {
    Failure::WrongBecause(both!(
        "the block, node {node} (9461), has no {object}: the board needs it; take a block that has it. Nothing has been changed",
        "模块（节点 {node}，9461）没有 {object}：控制板需要该对象；请选用具有该对象的模块。未作任何改动",
        node = node.get(),
        object = object_text(object)
    ))
}

fn refused(node: NodeId, trouble: &Trouble) -> Failure {
    let Both { en, zh } = trouble.words();
    let silent = matches!(
        trouble,
        Trouble::Transfer {
            error: SdoError::TimedOut,
            ..
        }
    );
    let words = match silent {
        true => both!(
            "the block of inputs and outputs, node {node} (9461), does not answer: is it on, is {node} the number of its switch, and \
             has it the bit rate of the bus?",
            "输入输出模块（节点 {node}，9461）没有应答：它通电了吗？节点开关是 {node} 吗？波特率与总线一致吗？",
            node = node.get()
        ),
        false => both!(
            "the block of inputs and outputs, node {node} (9461): {en}; push again once it takes that",
            "输入输出模块（节点 {node}，9461）：{zh}；解决后请重新写入",
            node = node.get()
        ),
    };
    match trouble.refusal() {
        Some(_) => Failure::WrongBecause(words),
        None => Failure::Bus(words),
    }
}

#[cfg(test)]
mod tests;
