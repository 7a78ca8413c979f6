//! Objects that are numbers of up to four bytes, as an SDO server reads and writes them. Must not know what they mean.

use leadscrew_core::bus::{Abort, Object, Objects};

/// Objects of a node.
pub(super) trait Numbers {
    /// Length in bytes, and value.
    fn get(&self, object: Object) -> Result<(u8, u32), Abort>;

    /// Writes one, which has its length.
    fn set(&mut self, object: Object, value: u32) -> Result<(), Abort>;
}

/// Them, and the bytes that a transfer has brought so far.
pub(super) struct Transfer<'a, N> {
    pub(super) numbers: N,
    pub(super) value: &'a mut [u8; 4],
}

impl<N: Numbers> Objects for Transfer<'_, N> {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        let (length, value) = self.numbers.get(object)?;
        *self.value = value.to_le_bytes();
        Ok(u32::from(length))
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        let (length, _) = self.numbers.get(object)?;
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = self.value.get(start..usize::from(length)).unwrap_or(&[]);
        for (place, &byte) in into.iter_mut().zip(bytes) {
            *place = byte;
        }
        Ok(bytes.len().min(into.len()))
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        let (length, _) = self.numbers.get(object)?;
        *self.value = [0; 4];
        match size.map(|size| size.cmp(&u32::from(length))) {
            Some(core::cmp::Ordering::Less) => Err(Abort::TooShort),
            Some(core::cmp::Ordering::Greater) => Err(Abort::TooLong),
            _ => Ok(()),
        }
    }

    fn write(&mut self, _object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let place = self
            .value
            .get_mut(start..start.saturating_add(bytes.len()))
            .ok_or(Abort::TooLong)?;
        for (place, &byte) in place.iter_mut().zip(bytes) {
            *place = byte;
        }
        Ok(())
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let (expected, _) = self.numbers.get(object)?;
        match length.cmp(&u32::from(expected)) {
            core::cmp::Ordering::Less => Err(Abort::TooShort),
            core::cmp::Ordering::Greater => Err(Abort::TooLong),
            core::cmp::Ordering::Equal => self.numbers.set(object, u32::from_le_bytes(*self.value)),
        }
    }

    fn abandon(&mut self, _object: Object) {}
}
