//! Fields in a fixed number of bytes, little-endian.

/// Writes fields one after the other. A field that does not fit is dropped; this cannot happen, because the sizes are
/// constants and a test checks them.
pub(super) struct Writer<'a> {
    rest: &'a mut [u8],
}

impl<'a> Writer<'a> {
    pub(super) const fn new(bytes: &'a mut [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Writes four bytes.
    #[inline(never)]
    pub(super) fn word(&mut self, word: u32) {
        let rest = core::mem::take(&mut self.rest);
        if let Some((place, rest)) = rest.split_first_chunk_mut() {
            *place = word.to_le_bytes();
            self.rest = rest;
        }
    }

    /// Writes eight bytes.
    #[inline(never)]
    pub(super) fn long(&mut self, long: i64) {
        self.word(long as u32);
        self.word((long >> 32) as u32);
    }
}

/// Reads fields from the front.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next field; `None` at the end of the bytes.
    pub(super) fn take<const M: usize>(&mut self) -> Option<[u8; M]> {
        let (field, rest) = self.rest.split_first_chunk::<M>()?;
        self.rest = rest;
        Some(*field)
    }
}
