//! Fields in a fixed number of bytes, little end first.

/// Puts fields behind each other. What does not fit any more is left out: the sizes are constants, and a test counts.
pub(super) struct Writer<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> Writer<N> {
    pub(super) const fn new() -> Self {
        Self {
            bytes: [0; N],
            at: 0,
        }
    }

    pub(super) fn put<const M: usize>(&mut self, field: [u8; M]) {
        let end = self.at.saturating_add(M);
        if let Some(place) = self.bytes.get_mut(self.at..end) {
            for (to, from) in place.iter_mut().zip(field) {
                *to = from;
            }
            self.at = end;
        }
    }

    /// What has been put so far.
    pub(super) fn written(&self) -> &[u8] {
        self.bytes.get(..self.at).unwrap_or_default()
    }

    pub(super) const fn finish(self) -> [u8; N] {
        self.bytes
    }
}

/// Takes fields from the front.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next field; `None` where the bytes are over.
    pub(super) fn take<const M: usize>(&mut self) -> Option<[u8; M]> {
        let (field, rest) = self.rest.split_first_chunk::<M>()?;
        self.rest = rest;
        Some(*field)
    }
}
