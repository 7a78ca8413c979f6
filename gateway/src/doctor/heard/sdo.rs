//! Objects, as expedited SDO transfers on the wire tell them, whoever asked: read, written, refused.

use std::collections::BTreeMap;

use leadscrew_can::{Packet, Stamp};
use leadscrew_core::bus::{NodeId, Object};

/// What became of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deed {
    /// The node told this value.
    Read(u32),
    /// It took this value.
    Written(u32),
    /// It refused to tell.
    NotRead(u32),
    /// It refused to take a value, with this code.
    NotWritten(u32),
}

/// A transfer.
#[derive(Clone, Copy, Debug)]
pub struct Transfer {
    /// When it ended.
    pub at: Stamp,
    /// How it ended.
    pub deed: Deed,
    /// The frame that ended it.
    pub packet: Packet,
}

#[derive(Clone, Copy, Debug)]
enum Pending {
    Read(Object),
    Write(Object, u32),
}

/// All transfers.
#[derive(Clone, Debug, Default)]
pub struct Transfers {
    pending: BTreeMap<NodeId, Pending>,
    /// By node and object, in the order of time.
    pub done: BTreeMap<(NodeId, Object), Vec<Transfer>>,
}

impl Transfers {
    /// A request to a node.
    pub fn request(&mut self, node: NodeId, payload: &[u8]) {
        let [command, low, high, sub, value @ ..] = payload else {
            return;
        };
        let object = Object::new(u16::from_le_bytes([*low, *high]), *sub);
        let pending = match command >> 5 {
            2 => Some(Pending::Read(object)),
            // Expedited, or at least begun: only the former has the value.
            1 => Some(Pending::Write(object, number(value, *command))),
            _ => None,
        };
        match pending {
            Some(pending) => drop(self.pending.insert(node, pending)),
            None => drop(self.pending.remove(&node)),
        }
    }

    /// An answer of a node.
    pub fn reply(&mut self, at: Stamp, node: NodeId, payload: &[u8], packet: &Packet) {
        let [command, low, high, sub, value @ ..] = payload else {
            return;
        };
        let object = Object::new(u16::from_le_bytes([*low, *high]), *sub);
        let code = value
            .first_chunk::<4>()
            .map_or(0, |bytes| u32::from_le_bytes(*bytes));
        let (of, deed) = match (self.pending.remove(&node), command >> 5) {
            // Expedited; a longer one goes on in segments.
            (Some(Pending::Read(of)), 2) if command & 2 != 0 => {
                (of, Deed::Read(number(value, *command)))
            }
            (Some(Pending::Write(of, value)), 3) => (of, Deed::Written(value)),
            (Some(Pending::Read(of)), 4) => (of, Deed::NotRead(code)),
            (Some(Pending::Write(of, _)), 4) => (of, Deed::NotWritten(code)),
            _ => return,
        };
        if of == object {
            let transfer = Transfer {
                at,
                deed,
                packet: *packet,
            };
            self.done.entry((node, of)).or_default().push(transfer);
        }
    }

    /// The value that the node last told or took.
    #[must_use]
    pub fn value(&self, node: NodeId, index: u16, sub: u8) -> Option<(Stamp, u32)> {
        let all = self.done.get(&(node, Object::new(index, sub)))?;
        all.iter().rev().find_map(|transfer| match transfer.deed {
            Deed::Read(value) | Deed::Written(value) => Some((transfer.at, value)),
            Deed::NotRead(_) | Deed::NotWritten(_) => None,
        })
    }

    /// The mapping that a PDO of the node has by these objects.
    #[must_use]
    pub fn mapping(&self, node: NodeId, index: u16) -> Option<(Stamp, Vec<u32>)> {
        let (at, count) = self.value(node, index, 0)?;
        let entries = (1..=u8::try_from(count).ok()?)
            .map(|sub| self.value(node, index, sub).map(|(_, raw)| raw))
            .collect::<Option<Vec<u32>>>()?;
        Some((at, entries))
    }
}

/// The bytes of an expedited transfer as a number. The command says how many are none.
fn number(bytes: &[u8], command: u8) -> u32 {
    let unused = if command & 1 != 0 {
        usize::from(command >> 2 & 3)
    } else {
        0
    };
    let used = bytes.len().saturating_sub(unused);
    let used = bytes.iter().take(used);
    used.rev()
        .fold(0, |value, byte| value << 8 | u32::from(*byte))
}
