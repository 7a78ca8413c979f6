//! Batches of calls for the board. A batch holds whole calls and is small enough for one short transfer.
//!
//! A batch has the number of its program and of its first call, counted from 0. Therefore the receiver detects a
//! repeated batch and a missing batch. A call is never split.
//!
//! ```text
//! version · program · revision of the offsets · first · call · call · …        all postcard
//! ```

use heapless::Vec;

use super::reader::{Reader, Take};
use super::{LinkError, VERSION, Version, bounds};
use crate::call::Call;
use crate::offsets::Revision;

/// Size of the longest batch.
pub const BATCH_BYTES: usize = 512;

/// Room for the longest call in a batch. A call with all fields and the largest values takes less.
pub const CALL_BYTES: usize = 480;

/// An encoded call.
pub type CallBytes = Vec<u8, CALL_BYTES>;

/// Why a batch is refused; the board then takes none of its calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchError {
    /// Written by another version of the link.
    Version(Version),
    /// Not a batch.
    Malformed,
    /// A call has a value that no program can have: the call's place in the batch, from 0, and the kind of that value.
    Bounds(u32, bounds::Beyond),
}

/// Builds a batch.
#[derive(Debug)]
pub struct BatchWriter {
    bytes: Vec<u8, BATCH_BYTES>,
    count: u32,
}

impl BatchWriter {
    /// An empty batch of `program`, resolved with this table of offsets, that begins with its call number `first`.
    // Compiled with its caller, which is no board: that postcard cannot panic shows at the levels for speed alone [D309].
    #[inline]
    #[must_use]
    pub fn new(program: u32, offsets: Revision, first: u32) -> Self {
        let mut bytes = Vec::new();
        // The head is far shorter than a batch.
        let mut head = [0; 32];
        if let Ok(head) = postcard::to_slice(&(VERSION, program, offsets.0, first), &mut head) {
            let _ = bytes.extend_from_slice(head);
        }
        Self { bytes, count: 0 }
    }

    /// Adds a call.
    ///
    /// # Errors
    /// [`LinkError::TooLong`] where the call does not fit after the others; the batch is unchanged.
    pub fn push(&mut self, call: &[u8]) -> Result<(), LinkError> {
        self.bytes
            .extend_from_slice(call)
            .map_err(|_| LinkError::TooLong)?;
        self.count = self.count.saturating_add(1);
        Ok(())
    }

    /// Number of calls in the batch.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// The bytes to send.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Encodes a call.
///
/// # Errors
/// [`LinkError::TooLong`] beyond [`CALL_BYTES`]; no call within its [bounds] is that long.
// Compiled with its caller, which is no board: that postcard cannot panic shows at the levels for speed alone [D309].
#[inline]
pub fn encode_call(call: &Call) -> Result<CallBytes, LinkError> {
    let mut bytes = [0; CALL_BYTES];
    let used = postcard::to_slice(call, &mut bytes).map_err(|_| LinkError::TooLong)?;
    CallBytes::from_slice(used).map_err(|_| LinkError::TooLong)
}

/// The call at the front of `bytes`, and its number of bytes.
///
/// # Errors
/// [`LinkError::Malformed`]. This function does not check the [bounds].
pub fn decode_call(bytes: &[u8]) -> Result<(Call, usize), LinkError> {
    let mut reader = Reader::new(bytes);
    let call = Call::take(&mut reader);
    let rest = reader.rest().ok_or(LinkError::Malformed)?;
    Ok((call, bytes.len().saturating_sub(rest.len())))
}

/// A received batch.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    /// Number of the program.
    pub program: u32,
    /// The table of offsets that the program was resolved with.
    pub offsets: Revision,
    /// Number of the batch's first call in the program.
    pub first: u32,
    rest: &'a [u8],
    at: u32,
}

impl<'a> Batch<'a> {
    /// Reads the front of a batch.
    ///
    /// # Errors
    /// [`BatchError::Version`], [`BatchError::Malformed`].
    pub fn new(bytes: &'a [u8]) -> Result<Self, BatchError> {
        let mut reader = Reader::new(bytes);
        let version = Version::take(&mut reader);
        if reader.rest().is_some() && version != VERSION {
            return Err(BatchError::Version(version));
        }
        let (program, offsets) = (u32::take(&mut reader), u32::take(&mut reader));
        let first = u32::take(&mut reader);
        Ok(Self {
            program,
            offsets: Revision(offsets),
            first,
            rest: reader.rest().ok_or(BatchError::Malformed)?,
            at: 0,
        })
    }
}

/// The calls, checked, each with its bytes.
impl<'a> Iterator for Batch<'a> {
    type Item = Result<(Call, &'a [u8]), BatchError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let taken = decode_call(self.rest).ok().and_then(|(call, length)| {
            let (bytes, rest) = self.rest.split_at_checked(length)?;
            Some((call, bytes, rest))
        });
        let Some((call, bytes, rest)) = taken else {
            self.rest = &[];
            return Some(Err(BatchError::Malformed));
        };
        self.rest = rest;
        let at = self.at;
        self.at = at.saturating_add(1);
        if let Err(beyond) = bounds::call(&call) {
            self.rest = &[];
            return Some(Err(BatchError::Bounds(at, beyond)));
        }
        Some(Ok((call, bytes)))
    }
}
