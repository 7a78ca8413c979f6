//! The load of the wire by process data: bits of every frame with its real stuff bits, second by second. Transfers take
//! what is left and are not counted.

use std::time::Duration;

use leadscrew_can::Stamp;
use leadscrew_core::bus::FdBits;

/// What a load is measured over.
const SPAN: Duration = Duration::from_secs(1);

/// The load so far.
#[derive(Clone, Debug, Default)]
pub struct Load {
    began: Option<Stamp>,
    bits: u64,
    all: u64,
    first: Option<Stamp>,
    last: Option<Stamp>,
    /// Bits of each whole second.
    pub seconds: Vec<(Stamp, u64)>,
}

impl Load {
    /// A frame of so many bits.
    pub fn note(&mut self, at: Stamp, bits: u32) {
        self.first.get_or_insert(at);
        self.last = Some(at);
        let began = *self.began.get_or_insert(at);
        if at.since(began) >= SPAN {
            // A span with a gap in it would say less than there was.
            if at.since(began) < SPAN * 2 {
                self.seconds.push((began, self.bits));
            }
            self.began = Some(at);
            self.bits = 0;
        }
        self.bits += u64::from(bits);
        self.all += u64::from(bits);
    }

    /// Bits in a second, over all of it.
    #[must_use]
    pub fn mean(&self) -> Option<u64> {
        let span = self.last?.since(self.first?);
        let ms = u64::try_from(span.as_millis())
            .ok()
            .filter(|ms| *ms >= 1000)?;
        (self.all * 1000).checked_div(ms)
    }
}

/// Bits of a classical frame on the wire, with its stuff bits and the pause behind it.
#[must_use]
pub fn classical_bits(id: u16, payload: &[u8]) -> u32 {
    let mut stuffing = Stuffing::default();
    // Start, identifier, three bits that are dominant, length.
    stuffing.push(u32::from(id), 12);
    stuffing.push(u32::try_from(payload.len()).unwrap_or(8), 7);
    for byte in payload {
        stuffing.push(u32::from(*byte), 8);
    }
    let checksum = stuffing.checksum;
    stuffing.push(u32::from(checksum), 15);
    // Three delimiters and the acknowledgement, seven bits of end, three of pause.
    stuffing.bits + 13
}

/// Bits of a frame of CAN FD in times of the slower rate.
#[must_use]
pub fn fd_bits(bytes: usize, kbit: u32, data_kbit: u32) -> u32 {
    FdBits::of(u32::try_from(bytes).unwrap_or(64)).at(kbit, data_kbit)
}

#[derive(Debug, Default)]
struct Stuffing {
    bits: u32,
    run: u32,
    last: Option<bool>,
    checksum: u16,
}

impl Stuffing {
    fn push(&mut self, value: u32, bits: u32) {
        for place in (0..bits).rev() {
            let bit = value >> place & 1 != 0;
            let carry = bit != (self.checksum >> 14 & 1 != 0);
            self.checksum = (self.checksum << 1 & 0x7FFF) ^ if carry { 0x4599 } else { 0 };
            self.bits += 1;
            if self.last == Some(bit) {
                self.run += 1;
            } else {
                self.run = 1;
            }
            self.last = Some(bit);
            if self.run == 5 {
                // A bit of the other kind, which begins a run itself.
                self.bits += 1;
                self.last = Some(!bit);
                self.run = 1;
            }
        }
    }
}
