//! A PDO of a node: its mapping read and written, as CiA 301 has it.
//!
//! It must not know whose it is, a drive's or that of the block of inputs and outputs.

use leadscrew_core::bus::{Mapped, NodeId, Object};

use crate::link::{Link, LinkResult};

/// COB-ID bit 31: the PDO is not used.
pub const INVALID: u32 = 1 << 31;

/// A PDO.
#[derive(Clone, Copy, Debug)]
pub struct Pdo {
    /// Whose.
    pub node: NodeId,
    /// 1600h … 1A01h.
    pub mapping: u16,
    /// 1400h … 1801h.
    pub communication: u16,
}

/// What is in a PDO, and how it is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mapping {
    /// The objects.
    pub objects: Vec<Mapped>,
    /// The COB-ID, with the bit that switches it off.
    pub cob_id: u32,
}

impl Pdo {
    /// The object of its COB-ID.
    pub const fn cob_id(self) -> Object {
        Object::new(self.communication, 1)
    }

    /// The object of the number of its entries.
    pub const fn count(self) -> Object {
        Object::new(self.mapping, 0)
    }

    /// The object of an entry.
    pub const fn entry(self, sub: u8) -> Object {
        Object::new(self.mapping, sub)
    }

    /// A number of it.
    pub fn read(self, link: &mut Link, object: Object) -> LinkResult<u32> {
        let mut raw = [0; 4];
        for (place, byte) in raw.iter_mut().zip(link.read_of(self.node, object)?) {
            *place = byte;
        }
        Ok(u32::from_le_bytes(raw))
    }

    /// What is in it.
    pub fn found(self, link: &mut Link) -> LinkResult<Mapping> {
        let cob_id = self.read(link, self.cob_id())?;
        let count = self.read(link, self.count())? as u8;
        let objects = (1..=count).map(|sub| Ok(mapped(self.read(link, self.entry(sub))?)));
        Ok(Mapping {
            objects: objects.collect::<LinkResult<_>>()?,
            cob_id,
        })
    }

    /// Maps these: the PDO off, its mapping empty, the objects, their number, the PDO on. It ends with the COB-ID `then`,
    /// or with `back` where the node refuses: a fixed mapping does not leave the PDO off.
    pub fn map(self, link: &mut Link, objects: &[Mapped], then: u32, back: u32) -> LinkResult {
        let (node, cob_id) = (self.node, self.cob_id());
        link.write_of(node, cob_id, &(then | INVALID).to_le_bytes())?;
        let mapped = self.fill(link, objects);
        let id = if mapped.is_ok() { then } else { back };
        let ended = link.write_of(node, cob_id, &id.to_le_bytes());
        mapped.and(ended)
    }

    fn fill(self, link: &mut Link, objects: &[Mapped]) -> LinkResult {
        link.write_of(self.node, self.count(), &[0])?;
        for (sub, mapped) in (1..).zip(objects) {
            link.write_of(self.node, self.entry(sub), &mapped.raw().to_le_bytes())?;
        }
        link.write_of(self.node, self.count(), &[objects.len() as u8])
    }
}

/// An entry as it is on the bus.
pub const fn mapped(raw: u32) -> Mapped {
    let [bits, sub, low, high] = raw.to_le_bytes();
    Mapped::new(u16::from_le_bytes([low, high]), sub, bits)
}
