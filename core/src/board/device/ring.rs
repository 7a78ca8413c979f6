//! A ring of bytes in a fixed room, in the order of their arrival.

use crate::board::store::copy;

/// A ring of at most `N` bytes.
#[derive(Clone, Debug)]
pub struct Ring<const N: usize> {
    /// Place of the oldest byte.
    front: usize,
    /// Bytes in it.
    used: usize,
    bytes: [u8; N],
}

impl<const N: usize> Ring<N> {
    pub const fn new() -> Self {
        Self {
            bytes: [0; N],
            front: 0,
            used: 0,
        }
    }

    pub const fn used(&self) -> usize {
        self.used
    }

    pub const fn free(&self) -> usize {
        N.saturating_sub(self.used)
    }

    pub const fn clear(&mut self) {
        self.front = 0;
        self.used = 0;
    }

    /// The place `ahead` bytes after the oldest.
    const fn place(&self, ahead: usize) -> usize {
        let place = self.front.saturating_add(ahead);
        if place >= N {
            place.saturating_sub(N)
        } else {
            place
        }
    }

    /// Appends all of `bytes`, or none of them where there is no room.
    pub fn push(&mut self, bytes: &[u8]) -> bool {
        let fits = bytes.len() <= self.free();
        if fits {
            let end = self.place(self.used);
            put(&mut self.bytes, end, bytes);
            self.used = self.used.saturating_add(bytes.len());
        }
        fits
    }

    /// Copies bytes, beginning `ahead` bytes after the oldest. Returns their number.
    pub fn copy(&self, ahead: usize, into: &mut [u8]) -> usize {
        let count = self.used.saturating_sub(ahead).min(into.len());
        let into = into.get_mut(..count).unwrap_or_default();
        take(&self.bytes, self.place(ahead), into);
        count
    }

    /// Drops the oldest `count` bytes.
    pub const fn drop_front(&mut self, count: usize) {
        let count = if count < self.used { count } else { self.used };
        self.front = self.place(count);
        self.used = self.used.saturating_sub(count);
    }
}

// One copy of the code for both lengths: a board has two rings.

/// Writes `bytes` into a ring from `at` on.
#[inline(never)]
fn put(ring: &mut [u8], at: usize, bytes: &[u8]) {
    let (front, back) = ring.split_at_mut_checked(at).unwrap_or_default();
    let taken = copy(bytes, back);
    copy(bytes.get(taken..).unwrap_or_default(), front);
}

/// Fills `into` from a ring, from `at` on.
#[inline(never)]
fn take(ring: &[u8], at: usize, into: &mut [u8]) {
    let (front, back) = ring.split_at_checked(at).unwrap_or_default();
    let taken = copy(back, into);
    copy(front, into.get_mut(taken..).unwrap_or_default());
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::collections::VecDeque;
    use std::vec::Vec;

    use super::*;

    #[test]
    fn bytes_come_out_as_they_went_in_however_often_it_goes_round() {
        let mut ring = Ring::<13>::new();
        let mut model = VecDeque::new();
        let mut next = 0_u8;
        for step in 0..1000_usize {
            let bytes: Vec<u8> = (0..step % 6)
                .map(|_| {
                    next = next.wrapping_add(1);
                    next
                })
                .collect();
            let fits = bytes.len() <= 13 - model.len();
            assert_eq!(ring.push(&bytes), fits);
            if fits {
                model.extend(&bytes);
            }
            let mut read = [0; 13];
            let ahead = step % 4;
            let count = ring.copy(ahead, &mut read);
            let expected: Vec<u8> = model.iter().skip(ahead).copied().collect();
            assert_eq!(read[..count], expected);
            let gone = step % 5;
            ring.drop_front(gone);
            model.drain(..gone.min(model.len()));
            assert_eq!((ring.used(), ring.free()), (model.len(), 13 - model.len()));
        }
        ring.clear();
        assert_eq!(ring.used(), 0);
    }
}
