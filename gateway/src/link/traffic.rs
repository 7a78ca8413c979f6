//! The traffic on the wire.
//!
//! Knows frames and rates; knows nothing of the senders.

use leadscrew_can::Packet;
use leadscrew_core::bus::{FdBits, frame_bits};

/// Bits on the wire with the worst stuffing, the gaps between frames included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bits at the bit rate of the bus.
    pub bits: u64,
    /// Bits at the rate of the data of CAN FD frames.
    pub fast_bits: u64,
}

impl Traffic {
    pub(super) fn count(&mut self, packet: &Packet) {
        match packet {
            Packet::Frame(frame) => {
                let bytes = frame.payload().len() as u32;
                self.bits += u64::from(frame_bits(bytes));
            }
            Packet::Fd(frame) => {
                let bits = FdBits::of(frame.data.bytes().len() as u32);
                let data = if frame.rate_switched {
                    &mut self.fast_bits
                } else {
                    &mut self.bits
                };
                *data += u64::from(bits.data);
                self.bits += u64::from(bits.nominal);
            }
            _ => {}
        }
    }

    /// The load in these milliseconds, in per cent.
    #[must_use]
    pub fn load(&self, kbit: u64, fd_kbit: u64, ms: u64) -> u64 {
        let slow = self.fast_bits * kbit / fd_kbit.max(1);
        (self.bits + slow) * 100 / (kbit * ms).max(1)
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::bus::{CobId, FdFrame, Frame};

    use super::*;

    #[test]
    fn the_load_of_a_board_with_one_frame_for_its_drives() {
        let id = CobId::new(0x481).unwrap();
        let together = FdFrame::new(id, &[0; 24], true).unwrap();
        let mut second = Traffic::default();
        for _ in 0..1000 {
            second.count(&Packet::Frame(Frame::new(CobId::SYNC, &[1]).unwrap()));
            second.count(&Packet::Fd((&together).into()));
        }
        // SYNC 65; 33 and 278 bits, the latter at five times the rate.
        let expected = Traffic {
            bits: 98_000,
            fast_bits: 278_000,
        };
        assert_eq!(second, expected);
        assert_eq!(second.load(1000, 5000, 1000), 15);
        assert_eq!(second.load(500, 2000, 1000), 33);
        assert_eq!(Traffic::default().load(1000, 0, 0), 0);
    }

    #[test]
    fn without_a_higher_rate_all_bits_go_at_one() {
        let id = CobId::new(0x481).unwrap();
        let mut traffic = Traffic::default();
        let frame = FdFrame::new(id, &[0; 12], false).unwrap();
        traffic.count(&Packet::Fd((&frame).into()));
        assert_eq!((traffic.bits, traffic.fast_bits), (186, 0));
    }
}
