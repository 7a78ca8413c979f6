//! Writes postcard values one after the other; the counterpart of the [reader](super::reader::Reader).
//!
//! The writer drops bytes that have no room, and records that. The caller asks once, at the end. So writing a value is
//! one call without a branch [D161].

use super::LinkError;

/// The bytes written so far, and whether all of them had room.
#[derive(Debug)]
pub(super) struct Writer<'a> {
    bytes: &'a mut [u8],
    used: usize,
}

/// A value that can be written: its fields in order, a variant by its number.
pub(super) trait Put {
    /// Writes the value after the bytes written before.
    fn put(&self, writer: &mut Writer<'_>);
}

impl<'a> Writer<'a> {
    /// Writes to the front of `bytes`.
    pub(super) const fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, used: 0 }
    }

    /// The number of bytes written.
    ///
    /// # Errors
    /// [`LinkError::TooLong`]: not all bytes had room.
    pub(super) const fn finish(self) -> Result<usize, LinkError> {
        if self.used <= self.bytes.len() {
            Ok(self.used)
        } else {
            Err(LinkError::TooLong)
        }
    }

    /// Writes a byte.
    #[inline(never)]
    pub(super) fn byte(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.used) {
            *place = byte;
        }
        self.used = self.used.saturating_add(1);
    }

    /// Writes bytes unchanged.
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.byte(*byte);
        }
    }

    /// Writes a number in groups of seven bits, the lowest group first.
    #[inline(never)]
    fn varint(&mut self, mut value: u64) {
        while value > 0x7F {
            self.byte(value as u8 | 0x80);
            value >>= 7;
        }
        self.byte(value as u8);
    }

    /// Writes a number of at most 32 bits.
    #[inline(never)]
    fn word(&mut self, value: u32) {
        self.varint(value.into());
    }

    /// Writes a signed number: its magnitude doubled, and one less where it is negative.
    #[inline(never)]
    fn zigzag(&mut self, value: i64) {
        self.varint(((value << 1) ^ (value >> 63)) as u64);
    }
}

impl Put for bool {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.byte((*self).into());
    }
}

impl Put for u8 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.byte(*self);
    }
}

impl Put for u16 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.word((*self).into());
    }
}

impl Put for u32 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.word(*self);
    }
}

impl Put for u64 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.varint(*self);
    }
}

impl Put for i32 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.zigzag((*self).into());
    }
}

impl Put for i64 {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.zigzag(*self);
    }
}

impl<T: Put> Put for Option<T> {
    fn put(&self, writer: &mut Writer<'_>) {
        writer.byte(self.is_some().into());
        if let Some(value) = self {
            value.put(writer);
        }
    }
}
