//! Server and client together, byte by byte and over disturbed wires.

#![allow(clippy::arithmetic_side_effects)]

extern crate std;

mod aborts;
mod channel;
mod frames;
mod noise;

use core::time::Duration;
use std::collections::BTreeMap;
use std::vec::Vec;

use super::{BlockSize, SdoServer};
use crate::bus::{Abort, CobId, Frame, NodeId, Object, Objects, Periods, Service};

const NODE: NodeId = NodeId::BOARD;
const PATIENCE: Duration = Duration::from_millis(1000);
/// Readable and writable, with any length up to a mebibyte.
const DOMAIN: Object = Object::new(0x5020, 0);
/// Four bytes.
const LONG: Object = Object::new(0x2010, 1);
/// Can be read only.
const FIXED: Object = Object::new(0x1008, 0);
/// Refuses a write after its first seven bytes.
const PICKY: Object = Object::new(0x5010, 0);
/// Refuses a write when it is complete.
const UNWILLING: Object = Object::new(0x5011, 0);
/// Announces a size that is larger than its value.
const LIAR: Object = Object::new(0x5012, 0);

/// Objects that check the order of calls.
#[derive(Default)]
struct Dictionary {
    values: BTreeMap<Object, Vec<u8>>,
    open: Option<(Object, Option<u32>, Vec<u8>)>,
    commits: Vec<(Object, Vec<u8>)>,
    abandoned: u32,
}

impl Dictionary {
    fn new() -> Self {
        let mut dictionary = Self::default();
        dictionary.values.insert(DOMAIN, Vec::new());
        dictionary.values.insert(LONG, [1, 2, 3, 4].to_vec());
        dictionary
            .values
            .insert(FIXED, b"Tiny Node - Mega Domains !".to_vec());
        dictionary.values.insert(PICKY, [0; 100].to_vec());
        dictionary.values.insert(UNWILLING, [0; 100].to_vec());
        dictionary.values.insert(LIAR, [0; 100].to_vec());
        dictionary
    }

    fn is_write_open(&self) -> bool {
        self.open.is_some()
    }
}

impl Objects for Dictionary {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        let value = self.values.get(&object).ok_or(Abort::NoObject)?;
        Ok(value.len() as u32 + u32::from(object == LIAR))
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        assert!(!into.is_empty(), "nothing is asked for");
        let rest = &self.values[&object][offset as usize..];
        let len = rest.len().min(into.len());
        into[..len].copy_from_slice(&rest[..len]);
        Ok(len)
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        assert!(self.open.is_none(), "a write begins in another");
        if !self.values.contains_key(&object) {
            return Err(Abort::NoObject);
        }
        match (object, size) {
            (FIXED, _) => return Err(Abort::ReadOnly),
            (LONG, Some(size)) if size > 4 => return Err(Abort::TooLong),
            (LONG, Some(size)) if size < 4 => return Err(Abort::TooShort),
            (_, Some(size)) if size > 1 << 20 => return Err(Abort::OutOfMemory),
            _ => {}
        }
        self.open = Some((object, size, Vec::new()));
        Ok(())
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let (open, _, value) = self.open.as_mut().expect("no write has begun");
        assert_eq!(*open, object);
        assert_eq!(value.len(), offset as usize, "a gap or a repetition");
        assert!(!bytes.is_empty(), "nothing is written");
        value.extend_from_slice(bytes);
        match object {
            PICKY if value.len() >= 7 => Err(Abort::Value),
            _ => Ok(()),
        }
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let (open, size, value) = self.open.take().expect("no write has begun");
        assert_eq!(open, object);
        assert_eq!(value.len(), length as usize);
        assert!(
            size.is_none_or(|size| size == length),
            "not the length that was told"
        );
        if object == UNWILLING {
            return Err(Abort::TooHigh);
        }
        self.commits.push((object, value.clone()));
        self.values.insert(object, value);
        Ok(())
    }

    fn abandon(&mut self, object: Object) {
        let (open, ..) = self.open.take().expect("no write has begun");
        assert_eq!(open, object);
        self.abandoned += 1;
    }
}

fn server() -> SdoServer {
    SdoServer::new(NODE, Periods::new(1000), BlockSize::MAX)
}

fn request(bytes: [u8; 8]) -> Frame {
    Frame::of(CobId::of(Service::SdoRequest, NODE), bytes)
}

fn reply(bytes: [u8; 8]) -> Frame {
    Frame::of(CobId::of(Service::SdoReply, NODE), bytes)
}

/// The reply that aborts a transfer.
fn abort(object: Object, abort: Abort) -> Frame {
    let [low, high] = object.index.to_le_bytes();
    let [a, b, c, d] = abort.code().to_le_bytes();
    reply([0x80, low, high, object.sub, a, b, c, d])
}

/// Marsaglia's xorshift, 64 bits.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    fn bytes(&mut self, len: usize) -> Vec<u8> {
        (0..len).map(|_| self.next() as u8).collect()
    }
}
