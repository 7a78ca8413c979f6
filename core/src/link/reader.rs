//! Reads postcard values from the front of a byte slice.
//!
//! A missing or invalid byte reads as zero, and the reader records the error. The caller asks once, at the end, whether
//! everything was [sound](Reader::rest). So reading a value is one call without a branch. The derived code, with an
//! error to check after each of the hundred values of a call, was four times as large [D142].

use core::num::NonZeroU8;

/// The bytes left to read, and whether all bytes before them were valid.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    rest: &'a [u8],
    sound: bool,
}

/// A value that can be read: its fields in the order of writing, a variant by its number.
pub(super) trait Take {
    /// Reads the value at the front; any bytes give a value.
    fn take(reader: &mut Reader<'_>) -> Self;
}

impl<'a> Reader<'a> {
    /// Reads `bytes`.
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes,
            sound: true,
        }
    }

    /// The bytes not read yet; `None` where a byte before them was missing or invalid.
    pub(super) const fn rest(&self) -> Option<&'a [u8]> {
        if self.sound { Some(self.rest) } else { None }
    }

    /// Records that an invalid value was read.
    pub(super) const fn spoil(&mut self) {
        self.sound = false;
    }

    /// Reads a variant without a value, by its number.
    pub(super) fn one_of<T: Copy>(&mut self, first: T, others: &[T]) -> T {
        match (self.varint(u32::BITS) as usize).checked_sub(1) {
            None => first,
            Some(place) => match others.get(place) {
                Some(other) => *other,
                None => {
                    self.spoil();
                    first
                }
            },
        }
    }

    /// Reads a byte.
    #[inline(never)]
    fn byte(&mut self) -> u8 {
        match self.rest.split_first() {
            Some((byte, rest)) => {
                self.rest = rest;
                *byte
            }
            None => {
                self.spoil();
                0
            }
        }
    }

    /// Reads a number of at most `bits` bits, in groups of seven bits, the lowest group first.
    #[inline(never)]
    pub(super) fn varint(&mut self, bits: u32) -> u64 {
        let mut value = 0_u64;
        let mut shift = 0_u32;
        while shift < bits {
            let byte = self.byte();
            value |= u64::from(byte & 0x7F).wrapping_shl(shift);
            if byte & 0x80 == 0 {
                // The last group has room for less than seven bits.
                if u32::from(byte)
                    .checked_shr(bits.wrapping_sub(shift))
                    .unwrap_or(0)
                    != 0
                {
                    break;
                }
                return value;
            }
            shift = shift.wrapping_add(7);
        }
        self.spoil();
        0
    }

    /// Reads a signed number: its magnitude is doubled, and one less where it is negative.
    #[inline(never)]
    fn zigzag(&mut self, bits: u32) -> i64 {
        let raw = self.varint(bits);
        ((raw >> 1) as i64) ^ ((raw & 1) as i64).wrapping_neg()
    }
}

impl Take for bool {
    fn take(reader: &mut Reader<'_>) -> Self {
        let byte = reader.byte();
        if byte > 1 {
            reader.spoil();
        }
        byte == 1
    }
}

impl Take for u8 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.byte()
    }
}

impl Take for NonZeroU8 {
    fn take(reader: &mut Reader<'_>) -> Self {
        Self::new(reader.byte()).unwrap_or_else(|| {
            reader.spoil();
            Self::MIN
        })
    }
}

impl Take for u16 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.varint(Self::BITS) as Self
    }
}

impl Take for u32 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.varint(Self::BITS) as Self
    }
}

impl Take for i16 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.zigzag(Self::BITS) as Self
    }
}

impl Take for i32 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.zigzag(Self::BITS) as Self
    }
}

impl Take for i64 {
    fn take(reader: &mut Reader<'_>) -> Self {
        reader.zigzag(Self::BITS)
    }
}

impl<T: Take> Take for Option<T> {
    fn take(reader: &mut Reader<'_>) -> Self {
        bool::take(reader).then(|| T::take(reader))
    }
}
