//! What gateway and board say to each other, beyond what CANopen says by itself: messages in `postcard`, carried as
//! domains by SDO.
//!
//! ```text
//! gateway ── calls ──────────────► 5020  (batches; the board says how many bytes it has room for)
//!         ◄─ status, events ────── 5001, 5040
//!         ◄─ certificates ──────── 5041
//!         ◄─ parameter set ──────► 5010
//! ```
//!
//! Every message that goes to a board begins with the [`Version`] of the link it was written by; a board takes its own
//! only. What is decoded is as bounded as what the interpreter yields: see [`bounds`].
//!
//! This room knows messages and bytes. It must not know frames, transfers, sockets or when anything is sent.

mod batch;
pub mod bounds;
mod call;
mod certificate;
mod change;
mod event;
mod image;
mod reader;
mod status;
mod told;
mod version;
mod writer;

pub use batch::{
    BATCH_BYTES, Batch, BatchError, BatchWriter, CALL_BYTES, CallBytes, decode_call, encode_call,
};
pub use certificate::{
    Certificate, SetpointHash, Tally, ThreadCertificate, ThreadKind, ThreadReader, ThreadRecord,
    ThreadState, encode_certificates,
};
pub use change::{decode_changes, encode_changes};
pub use event::{EventReader, Logged, decode_alarm, encode_alarm, encode_event};
pub use image::{ImageError, ImageReader, ImageWriter, identity};
pub use status::Status;
pub use version::{VERSION, Version};

/// A message that is none, or one that has no room in its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// The bytes are no such message.
    Malformed,
    /// More bytes than there is room for.
    TooLong,
}

#[cfg(test)]
mod tests;
