//! The messages between gateway and board that CANopen does not define: encoded with `postcard`, transferred as domains
//! by SDO.
//!
//! ```text
//! gateway ── calls ──────────────► 5020  (batches; the board says how many bytes it has room for)
//!         ◄─ status, events ────── 5001, 5040
//!         ◄─ certificates ──────── 5041
//!         ◄─ parameter set ──────► 5010
//! ```
//!
//! Every message to a board begins with the [`Version`] of its sender's link; a board takes only its own version.
//! Decoded values have the same bounds as the interpreter's output: see [`bounds`].
//!
//! This module knows messages and bytes. It must not know frames, transfers or sockets, nor the time of sending.

mod batch;
pub mod bounds;
mod call;
mod certificate;
mod change;
mod cut;
mod event;
mod image;
mod reader;
mod status;
mod told;
mod version;
mod writer;

pub use crate::tick::{Event, ThreadKind};
pub use batch::{
    BATCH_BYTES, Batch, BatchError, BatchWriter, CALL_BYTES, CallBytes, decode_call, encode_call,
};
pub use certificate::{
    Certificate, SetpointHash, Tally, ThreadCertificate, ThreadReader, ThreadRecord, ThreadState,
    encode_certificates,
};
pub use change::{decode_changes, encode_changes};
pub use cut::{CutTally, PassCut};
pub use event::{EventReader, Logged, decode_alarm, encode_alarm, encode_event};
pub use image::{ImageError, ImageReader, ImageWriter, identity};
pub use status::Status;
pub use version::{VERSION, Version};

/// Why a message cannot be decoded or encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// The bytes are no message of the expected type.
    Malformed,
    /// The message needs more bytes than there is room for.
    TooLong,
}

#[cfg(test)]
mod tests;
