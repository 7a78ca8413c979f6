//! A CAN FD frame with an 11-bit identifier, and its length in bits.
//!
//! | part of the frame (ISO 11898-1, FD base frame format) | bits | bit rate |
//! |---|---|---|
//! | start, identifier, RRS, IDE, FDF, reserved, BRS | 17 | nominal |
//! | ESI, length code, data of n bytes | 5 + 8 n | data |
//! | stuff bit count, CRC, and a fixed stuff bit before every four of their bits | 27 up to 16 bytes, 32 above | data |
//! | CRC delimiter, acknowledgement, end, intermission | 13 | nominal |
//!
//! Before the CRC a stuff bit follows every five equal bits. FDF and BRS are 1. The bits between IDE and FDF and
//! between FDF and BRS are 0. Therefore no row of equal bits reaches over them: at worst there are 3 stuff bits before
//! FDF, and 1 + 2 n after BRS.

use super::frame::{CobId, Frame};

/// A CAN FD data frame. Unused bytes are zero, so that equal frames compare equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(align(4))]
pub struct FdFrame {
    id: CobId,
    len: u8,
    rate_switched: bool,
    data: [u8; 64],
}

impl FdFrame {
    /// The possible lengths in bytes, by their code.
    pub const LENGTHS: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

    /// A frame with the bytes of `payload`, filled with zeros up to the next possible length; `None` for more than 64
    /// bytes. `rate_switched`: the data have the higher bit rate.
    #[must_use]
    pub fn new(id: CobId, payload: &[u8], rate_switched: bool) -> Option<Self> {
        let len = Self::length_for(payload.len())?;
        let mut data = [0; 64];
        for (place, byte) in data.iter_mut().zip(payload) {
            *place = *byte;
        }
        Some(Self {
            id,
            len,
            rate_switched,
            data,
        })
    }

    /// The length of the smallest frame with room for `bytes` bytes; `None` for more than 64.
    #[must_use]
    pub fn length_for(bytes: usize) -> Option<u8> {
        let mut all = Self::LENGTHS.into_iter();
        all.find(|length| usize::from(*length) >= bytes)
    }

    /// The identifier.
    #[must_use]
    pub const fn id(&self) -> CobId {
        self.id
    }

    /// The payload, with the zeros at its end.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.data.get(..usize::from(self.len)).unwrap_or(&self.data)
    }

    /// The code of the frame's length, 0–15.
    #[must_use]
    pub fn length_code(&self) -> u8 {
        let mut all = (0..).zip(Self::LENGTHS);
        // Every frame has a length from the table.
        all.find(|(_, length)| *length == self.len)
            .map_or(15, |(code, _)| code)
    }

    /// True where the data have the higher bit rate.
    #[must_use]
    pub const fn is_rate_switched(&self) -> bool {
        self.rate_switched
    }

    /// The classical frame with the same content; `None` for more than eight bytes.
    #[must_use]
    pub fn classical(&self) -> Option<Frame> {
        Frame::new(self.id, self.payload())
    }
}

impl From<&Frame> for FdFrame {
    /// The same content, all at the nominal rate.
    fn from(frame: &Frame) -> Self {
        let mut data = [0; 64];
        for (place, byte) in data.iter_mut().zip(frame.payload()) {
            *place = *byte;
        }
        Self {
            id: frame.id(),
            len: frame.payload().len() as u8,
            rate_switched: false,
            data,
        }
    }
}

/// Number of bits of a CAN FD frame, by their bit rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FdBits {
    /// Bits at the nominal rate.
    pub nominal: u32,
    /// Bits at the data rate; without rate switching these have the nominal rate, too.
    pub data: u32,
}

impl FdBits {
    /// The bits of a frame with room for `bytes` bytes (0–64), with intermission and the most stuff bits possible.
    #[must_use]
    pub fn of(bytes: u32) -> Self {
        let room = usize::try_from(bytes).ok().and_then(FdFrame::length_for);
        let bytes = u32::from(room.unwrap_or(64));
        let check = if bytes > 16 { 32 } else { 27 };
        Self {
            nominal: const { 17 + 3 + 13 },
            // ESI, length code and data with their stuff bits, then the checksum.
            data: bytes.wrapping_mul(10).wrapping_add(6).wrapping_add(check),
        }
    }

    /// The number of bits at `kbit` kbit/s that take the same time, rounded up. The data have `data_kbit` kbit/s; 0:
    /// all bits have one rate.
    #[must_use]
    pub const fn at(self, kbit: u32, data_kbit: u32) -> u32 {
        // No overflow: frames have some hundred bits, and rates are below ten thousand kbit/s.
        let data = match self.data.saturating_mul(kbit).checked_div(data_kbit) {
            // Rounds the quotient up.
            Some(whole) if whole < self.data => whole.saturating_add(1),
            _ => self.data,
        };
        self.nominal.saturating_add(data)
    }
}

/// Bit rates that a controller can give the data of CAN FD frames: a bit for each of [`KBIT`](Self::KBIT).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataRates(u8);

impl DataRates {
    /// The rates that there are (9032), in kbit/s.
    pub const KBIT: [u32; 5] = [1000, 2000, 4000, 5000, 8000];
    /// Of a controller without CAN FD.
    pub const NONE: Self = Self(0);
    /// Of a bus without a controller, which a simulation has.
    pub const ALL: Self = Self(0b1_1111);

    /// The rates for which `can` says so.
    #[must_use]
    pub fn of(can: impl Fn(u32) -> bool) -> Self {
        let each = Self::each().filter(|(kbit, _)| can(*kbit));
        Self(each.fold(0, |all, (_, bit)| all | bit))
    }

    /// True for one of these rates.
    #[must_use]
    pub fn has(self, kbit: u32) -> bool {
        Self::each().any(|(own, bit)| own == kbit && self.0 & bit != 0)
    }

    /// The highest of these rates below `kbit`, or the lowest there is; `None` where there are none.
    #[must_use]
    pub fn near(self, kbit: u32) -> Option<u32> {
        let own = || Self::each().filter(|(_, bit)| self.0 & bit != 0);
        let below = own().filter(|(own, _)| *own < kbit).last();
        below.or_else(|| own().next()).map(|(own, _)| own)
    }

    fn each() -> impl Iterator<Item = (u32, u8)> {
        Self::KBIT.into_iter().zip([1, 2, 4, 8, 16])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects)]
    extern crate std;

    use super::*;
    use std::vec::Vec;

    fn id() -> CobId {
        CobId::new(0x481).unwrap()
    }

    #[test]
    fn a_frame_has_the_next_length_there_is_and_zeros_behind_its_bytes() {
        let bytes: Vec<u8> = (1..=65).collect();
        for count in 0..=64 {
            let frame = FdFrame::new(id(), &bytes[..count], true).unwrap();
            let length = frame.payload().len();
            assert!(length >= count);
            let mut shorter = FdFrame::LENGTHS.into_iter().map(usize::from);
            assert!(!shorter.any(|other| (count..length).contains(&other)));
            assert_eq!(frame.payload()[..count], bytes[..count]);
            assert!(frame.payload()[count..].iter().all(|byte| *byte == 0));
            let code = usize::from(frame.length_code());
            assert_eq!(usize::from(FdFrame::LENGTHS[code]), length);
        }
        assert_eq!(FdFrame::new(id(), &bytes, true), None);
        let lengths = [9, 13, 17, 21, 25, 33, 49].map(|count| FdFrame::length_for(count).unwrap());
        assert_eq!(lengths, [12, 16, 20, 24, 32, 48, 64]);
    }

    #[test]
    fn up_to_eight_bytes_it_can_be_a_classical_frame_and_back() {
        let bytes = [1, 2, 3, 4, 5, 6, 7, 8, 9];
        for count in 0..=8 {
            let classical = Frame::new(id(), &bytes[..count]).unwrap();
            let fd = FdFrame::from(&classical);
            assert_eq!(fd, FdFrame::new(id(), &bytes[..count], false).unwrap());
            assert!(!fd.is_rate_switched());
            assert_eq!(fd.classical(), Some(classical));
        }
        let more = FdFrame::new(id(), &bytes, true).unwrap();
        assert_eq!((more.id(), more.classical()), (id(), None));
    }

    #[test]
    fn a_controller_has_some_rates_and_the_next_one_is_told() {
        let some = DataRates::of(|kbit| kbit != 8000 && kbit != 1000);
        assert_eq!(
            [500, 1000, 2000, 3000, 4000, 5000, 8000].map(|kbit| some.has(kbit)),
            [false, false, true, false, true, true, false]
        );
        let near = [8000, 5000, 3000, 2000, 1000].map(|kbit| some.near(kbit));
        assert_eq!(near, [5000, 4000, 2000, 2000, 2000].map(Some));
        assert_eq!(DataRates::of(|_| true), DataRates::ALL);
        assert_eq!(DataRates::of(|_| false), DataRates::NONE);
        assert_eq!(DataRates::NONE.near(5000), None);
        for kbit in DataRates::KBIT {
            assert!(DataRates::ALL.has(kbit) && !DataRates::NONE.has(kbit));
        }
    }

    /// Counts the stuff bits for `bits`.
    fn stuffed(bits: &[bool]) -> usize {
        let (mut run, mut last, mut stuffed) = (0, None, 0);
        for bit in bits {
            run = if last == Some(*bit) { run + 1 } else { 1 };
            last = Some(*bit);
            if run == 5 {
                // The stuff bit is the first of the next row.
                stuffed += 1;
                (run, last) = (1, Some(!*bit));
            }
        }
        stuffed
    }

    /// The bits from the start to the data of a frame.
    fn bits(id: u16, length: usize, code: u8, byte: impl Fn(usize) -> u8) -> Vec<bool> {
        let mut bits = std::vec![false];
        bits.extend((0..11).rev().map(|bit| id >> bit & 1 != 0));
        // RRS, IDE, FDF, reserved, BRS, ESI.
        bits.extend([false, false, true, false, true, false]);
        bits.extend((0..4).rev().map(|bit| code >> bit & 1 != 0));
        for place in 0..length {
            bits.extend((0..8).rev().map(|bit| byte(place) >> bit & 1 != 0));
        }
        bits
    }

    #[test]
    fn no_frame_has_more_stuff_bits_than_are_reckoned_with_and_some_have_nearly_all() {
        leadscrew_seed::volume(0x9E37_79B9, |seed| {
            let mut state = seed as u32;
            let mut random = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state >> 8
            };
            for (code, length) in (0_u8..).zip(FdFrame::LENGTHS) {
                let length = usize::from(length);
                let counted = FdBits::of(length as u32);
                let check = if length > 16 { 32 } else { 27 };
                let before = counted.nominal - 13 + counted.data - check;
                let plain = 22 + 8 * length;
                let room = before as usize - plain;
                assert_eq!(room, 3 + 1 + 2 * length);
                let mut worst = 0;
                for _ in 0..2000 {
                    // Rows of four equal bits, and similar patterns.
                    let pattern = [0x00, 0xFF, 0x0F, 0xF0, 0x87, 0x78, 0xC3, 0x3C, 0xE1, 0x1E]
                        [random() as usize % 10];
                    let flip = random() as usize % 64;
                    let id = random() as u16 & 0x7FF;
                    let all = bits(id, length, code, |place| {
                        if place == flip { !pattern } else { pattern }
                    });
                    let count = stuffed(&all);
                    assert!(count <= room, "{length} bytes: {count} of {room}");
                    worst = worst.max(count);
                }
                // Identifier 000 and data in rows of four.
                for pattern in [0x87, 0x78, 0xC3, 0x3C, 0xE1, 0x1E, 0x0F, 0xF0] {
                    worst = worst.max(stuffed(&bits(0, length, code, |_| pattern)));
                }
                assert!(worst + 4 >= room, "{length} bytes: {worst} of {room}");
            }
        });
    }

    #[test]
    fn the_bits_of_frames_by_hand() {
        // 17 + 3 + 13; 5 + 8 n, 1 + 2 n stuffed, 4 + 17 + 6 or 4 + 21 + 7.
        for (bytes, data) in [
            (0, 33),
            (6, 93),
            (8, 113),
            (12, 153),
            (20, 238),
            (24, 278),
            (64, 678),
        ] {
            assert_eq!(FdBits::of(bytes), FdBits { nominal: 33, data }, "{bytes}");
        }
        assert_eq!(FdBits::of(18), FdBits::of(20));
        // 12 bytes at 1 and 5 Mbit/s: 33 µs and 30.6 µs.
        assert_eq!(FdBits::of(12).at(1000, 5000), 64);
        assert_eq!(FdBits::of(12).at(500, 2000), 33 + 39);
        // At one rate, or with a data rate of 0.
        assert_eq!(FdBits::of(12).at(1000, 1000), 186);
        assert_eq!(FdBits::of(12).at(1000, 0), 186);
    }
}
