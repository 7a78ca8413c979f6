//! Bytes that are read from the front, as postcard wrote them.
//!
//! A byte that is missing, and one that says nothing, reads as zero and is noted; whoever reads asks once, at the end,
//! whether all was [sound](Reader::rest). So reading a value is one call and no decision: what came of a derive, with an
//! error to look at behind each of the hundred values of a call, was four times as much code [D142].

use core::num::NonZeroU8;

/// What is left to read, and whether all before it was sound.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    rest: &'a [u8],
    sound: bool,
}

/// A value that can be read: field after field in the order they are written, a variant by its number.
pub(super) trait Take {
    /// The value at the front, of whatever bytes there are.
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

    /// What has not been read; `None` where something before it was not sound.
    pub(super) const fn rest(&self) -> Option<&'a [u8]> {
        if self.sound { Some(self.rest) } else { None }
    }

    /// Notes that what has been read says nothing.
    pub(super) const fn spoil(&mut self) {
        self.sound = false;
    }

    /// One of a type's variants, by its number.
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

    /// A byte.
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

    /// A number of at most `bits` bits in groups of seven, the lowest first.
    #[inline(never)]
    pub(super) fn varint(&mut self, bits: u32) -> u64 {
        let mut value = 0_u64;
        let mut shift = 0_u32;
        while shift < bits {
            let byte = self.byte();
            value |= u64::from(byte & 0x7F).wrapping_shl(shift);
            if byte & 0x80 == 0 {
                // In the last group there is room for less than seven bits.
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

    /// A signed number: its magnitude doubled, less one where it is negative.
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
