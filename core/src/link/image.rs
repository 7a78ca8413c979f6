//! A whole parameter set as bytes: object 5010h.
//!
//! ```text
//! table key (u32) · number of values (u16) · values (i64 each) · CRC-32 of all before
//! ```
//!
//! All values are little-endian and of fixed length (`postcard` with fixed integers), so any part of an image can be
//! made from the set alone. An image belongs to one parameter table. The reader refuses an image of another table and
//! never reinterprets it.
//!
//! An image does not show the password: its place holds 1 where a password exists. An image with that 1 leaves the
//! board's password unchanged. Only an image made by [`with_password`](ImageWriter::with_password) holds a new
//! password.

use crate::checksum::crc32;
use crate::params::{Params, SLOTS, TABLE_KEY};

const HEAD: usize = 6;
const VALUE: usize = 8;
const TAIL: usize = 4;
const END: usize = HEAD + SLOTS * VALUE;

/// Why an image is refused. The set in force stays unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// The image belongs to another parameter table, with this key.
    Table(u32),
    /// Too short or too long.
    Length,
    /// The checksum is wrong: the image is damaged.
    Checksum,
    /// A value is outside its range: the parameter's number.
    Range(u16),
}

/// Makes the bytes of an image.
#[derive(Debug)]
pub struct ImageWriter<'a> {
    params: &'a Params,
    /// The image holds the password itself.
    password: bool,
}

impl<'a> ImageWriter<'a> {
    /// Length of every image in bytes.
    pub const BYTES: u32 = (END + TAIL) as u32;

    /// Length in bytes without the checksum.
    pub(crate) const BODY: usize = END;

    /// The image of a set without its password, as a board sends it.
    #[must_use]
    pub const fn new(params: &'a Params) -> Self {
        Self {
            params,
            password: false,
        }
    }

    /// The image with the password itself: to store the set, or to give a board a new password.
    #[must_use]
    pub const fn with_password(params: &'a Params) -> Self {
        Self {
            params,
            password: true,
        }
    }

    fn slot(&self, place: usize) -> i64 {
        let slot = if self.password {
            self.params.slot(place)
        } else {
            self.params.told_slot(place)
        };
        slot.unwrap_or(0)
    }

    /// The CRC-32 at the end of the image.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        let mut sum = crc32(0, &head());
        for place in 0..SLOTS {
            sum = crc32(sum, &self.slot(place).to_le_bytes());
        }
        sum
    }

    /// Fills `into` with the bytes from `offset` on and gives their number.
    pub fn read(&self, offset: u32, into: &mut [u8]) -> usize {
        let start = offset as usize;
        let rest = (Self::BYTES as usize).saturating_sub(start);
        let checksum = if start.saturating_add(into.len()) > END {
            self.checksum().to_le_bytes()
        } else {
            [0; TAIL]
        };
        for (byte, at) in into.iter_mut().zip(start..).take(rest) {
            let tail = at
                .checked_sub(END)
                .and_then(|place| checksum.get(place).copied());
            *byte = tail.unwrap_or_else(|| self.byte(at));
        }
        rest.min(into.len())
    }

    /// A byte before the checksum.
    fn byte(&self, at: usize) -> u8 {
        match at.checked_sub(HEAD) {
            None => head().get(at).copied().unwrap_or(0),
            Some(place) => {
                let value = self.slot(place / VALUE);
                value.to_le_bytes().get(place % VALUE).copied().unwrap_or(0)
            }
        }
    }
}

const fn head() -> [u8; HEAD] {
    let [a, b, c, d] = TABLE_KEY.to_le_bytes();
    let [e, f] = (SLOTS as u16).to_le_bytes();
    [a, b, c, d, e, f]
}

/// The CRC-32 of a set's image without the password. Two sets with the same number are equal and of the same table,
/// except for the password.
#[must_use]
pub fn identity(params: &Params) -> u32 {
    ImageWriter::new(params).checksum()
}

/// Reads an image in pieces into a set that is not in force yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageReader {
    /// Number of bytes taken.
    at: usize,
    /// The incomplete head, value or checksum.
    word: u64,
}

impl ImageReader {
    /// A reader at the beginning of an image.
    #[must_use]
    pub const fn new() -> Self {
        Self { at: 0, word: 0 }
    }

    /// Takes the next bytes. `staged` is not usable until [`finish`](Self::finish) has succeeded.
    ///
    /// # Errors
    /// [`ImageError::Table`] as soon as the head is complete, [`ImageError::Length`].
    pub fn take(&mut self, bytes: &[u8], staged: &mut Params) -> Result<(), ImageError> {
        for &byte in bytes {
            let (start, length) = match self.at.checked_sub(HEAD) {
                None => (0, HEAD),
                Some(_) if self.at >= END => (END, TAIL),
                Some(place) => (self.at.saturating_sub(place % VALUE), VALUE),
            };
            let place = self.at.saturating_sub(start);
            if place == 0 {
                self.word = 0;
            }
            self.word |= u64::from(byte).wrapping_shl((place as u32).wrapping_mul(8));
            self.at = self.at.saturating_add(1);
            if self.at == start.saturating_add(length) {
                self.complete(start, staged)?;
            } else if self.at > END + TAIL {
                return Err(ImageError::Length);
            }
        }
        Ok(())
    }

    fn complete(&self, start: usize, staged: &mut Params) -> Result<(), ImageError> {
        if start == 0 {
            let key = self.word as u32;
            if key != TABLE_KEY {
                return Err(ImageError::Table(key));
            }
            return if self.word >> 32 == SLOTS as u64 {
                Ok(())
            } else {
                Err(ImageError::Length)
            };
        }
        if start < END {
            staged.put_slot(start.saturating_sub(HEAD) / VALUE, self.word as i64);
        }
        Ok(())
    }

    /// True at the end of the values: the next byte is the first of the checksum.
    pub(crate) const fn has_body(&self) -> bool {
        self.at == END
    }

    /// Checks the image at its end: its length, its checksum, and the range of every value.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn finish(&self, staged: &Params) -> Result<(), ImageError> {
        if self.at != END + TAIL {
            return Err(ImageError::Length);
        }
        if self.word != u64::from(ImageWriter::with_password(staged).checksum()) {
            return Err(ImageError::Checksum);
        }
        match staged.first_out_of_range() {
            Some(no) => Err(ImageError::Range(no)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::params::{Entry, Part};

    fn image(params: &Params) -> Vec<u8> {
        let mut bytes = vec![0xAA; ImageWriter::BYTES as usize];
        assert_eq!(
            ImageWriter::new(params).read(0, &mut bytes),
            bytes.len(),
            "all of it"
        );
        bytes
    }

    fn read(bytes: &[u8], piece: usize) -> Result<Params, ImageError> {
        let mut staged = Params::sheets();
        let mut reader = ImageReader::new();
        for piece in bytes.chunks(piece) {
            reader.take(piece, &mut staged)?;
        }
        reader.finish(&staged).map(|()| staged)
    }

    fn changed() -> Params {
        let mut params = Params::sheets();
        for (key, raw) in [("9007", 20), ("1320.X", 123_456_789), ("182.7", 1)] {
            params.set(Entry::find_text(key).unwrap(), raw).unwrap();
        }
        params
    }

    #[test]
    fn a_set_comes_through_whatever_the_pieces() {
        let params = changed();
        let bytes = image(&params);
        for piece in [1, 4, 7, 8, 889, bytes.len()] {
            assert_eq!(read(&bytes, piece), Ok(params.clone()), "pieces of {piece}");
        }
        // A read at any offset gives the same bytes as the whole.
        for offset in 0..bytes.len() {
            let mut part = [0; 7];
            let read = ImageWriter::new(&params).read(offset as u32, &mut part);
            assert_eq!(part[..read], bytes[offset..(offset + 7).min(bytes.len())]);
        }
        assert_eq!(
            ImageWriter::new(&params).read(u32::MAX, &mut [0; 7]),
            0,
            "nothing behind it"
        );
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        let bytes = image(&changed());
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x10;
            let expected = match place {
                0..4 => ImageError::Table(TABLE_KEY ^ (0x10 << (place * 8))),
                4..6 => ImageError::Length,
                _ => ImageError::Checksum,
            };
            assert_eq!(read(&damaged, 7), Err(expected), "byte {place}");
        }
        let short = &bytes[..bytes.len() - 1];
        assert_eq!(read(short, 7), Err(ImageError::Length));
        let mut long = bytes;
        long.push(0);
        assert_eq!(read(&long, 7), Err(ImageError::Length));
    }

    #[test]
    fn a_value_out_of_range_or_an_undefined_bit_is_named() {
        let tolerance = Entry::find(9007, None).unwrap();
        let mut params = Params::sheets();
        params.put_slot(tolerance.place(), tolerance.max() + 1);
        assert_eq!(read(&image(&params), 64), Err(ImageError::Range(9007)));
        let switches = Entry::find(9008, Some(Part::Bit(0))).unwrap();
        let mut params = Params::sheets();
        params.put_slot(switches.place(), 2);
        assert_eq!(read(&image(&params), 64), Err(ImageError::Range(9008)));
    }

    #[test]
    fn the_identity_tells_sets_apart() {
        assert_eq!(identity(&Params::sheets()), identity(&Params::sheets()));
        assert_ne!(identity(&Params::sheets()), identity(&changed()));
        let bytes = image(&changed());
        assert_eq!(bytes[bytes.len() - 4..], identity(&changed()).to_le_bytes());
    }
}
