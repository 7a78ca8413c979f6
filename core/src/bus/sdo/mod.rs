//! Service data objects: one client reads and writes the objects of a node, whatever their length.
//!
//! Three transfers of CiA 301, and each knows the other side's mistakes by its abort code:
//!
//! | transfer | for | frames |
//! |---|---|---|
//! | expedited | 1 to 4 bytes | one each way |
//! | segmented | any length | one each way for every 7 bytes |
//! | block | long values | up to 127 segments of 7 bytes, then one answer; a CRC over all |
//!
//! Terms: *upload* is towards the client (it reads), *download* towards the server (it writes). A *block* is a run of
//! segments that is acknowledged at once; where a segment of it is lost, the rest is sent again.
//!
//! The [server](SdoServer) keeps a few dozen bytes whatever the length: values flow through [`Objects`](super::Objects)
//! by offset. What it guarantees: [`Objects::end_write`](super::Objects::end_write) is called only for a transfer
//! that the client finished, with the length it told and, in a block transfer, the right CRC. The client is one value
//! for each transfer ([`SdoUpload`], [`SdoDownload`]). Neither repeats a request by itself: what does not answer in time
//! ends the transfer.
//!
//! This room must not know what the objects mean.

mod client;
mod server;
mod wire;

pub use client::{SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoSink, SdoUpload};
pub use server::{BlockSize, SdoServer};

#[cfg(test)]
mod tests;
