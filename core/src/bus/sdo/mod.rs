//! Service data objects: one client reads and writes the objects of a node, of any length.
//!
//! The three transfers of CiA 301. Each answers a mistake of the other side with its abort code:
//!
//! | transfer | for | frames |
//! |---|---|---|
//! | expedited | 1 to 4 bytes | one each way |
//! | segmented | any length | one each way for every 7 bytes |
//! | block | long values | up to 127 segments of 7 bytes, then one answer; a CRC over all |
//!
//! Terms. *Upload*: the client reads. *Download*: the client writes. A *block* is a run of segments with one
//! acknowledgement; if a segment is lost, its sender repeats the rest of the block.
//!
//! The [server](SdoServer) keeps a few dozen bytes for a value of any length: it moves values through
//! [`Objects`](super::Objects) by offset. It guarantees: [`Objects::end_write`](super::Objects::end_write) is called
//! only for a transfer that the client finished, with the announced length and, in a block transfer, the right CRC. The
//! client is one value for each transfer ([`SdoUpload`], [`SdoDownload`]). Neither side repeats a request by itself: a
//! missing answer ends the transfer.
//!
//! This module must not know the meaning of the objects.

mod client;
mod server;
mod wire;

pub use client::{SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoSink, SdoUpload};
pub use server::{BlockSize, SdoServer};

#[cfg(test)]
mod tests;
