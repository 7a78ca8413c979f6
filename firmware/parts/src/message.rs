//! The words of a CAN controller of Bosch's M_CAN family: frames in its message memory, its bit timing, its state on
//! the bus.
//!
//! The meaning is the same in every chip with an M_CAN; the addresses and registers differ, so the chip's own code has
//! them. Only frames with identifiers of 11 bits.

use heapless::Vec;
use leadscrew_core::bus::{BusState, CobId, Controller, ErrorCounts, FdFrame, Frame};

use crate::BitTiming;

/// The bit where an identifier of 11 bits begins in the first word of an element.
const ID: u32 = 18;
/// The bit where the length begins in the second word.
const LENGTH: u32 = 16;
/// The bits of a frame of CAN FD, and of one whose data have their own rate, in the second word.
const FD: u32 = 1 << 21;
const RATE_SWITCHED: u32 = 1 << 20;

/// Words of an element of the message memory: two, and 64 bytes.
pub const ELEMENT: usize = 18;

/// The words of a frame to be sent, as many as it has.
pub type Words = Vec<u32, ELEMENT>;

/// A frame that was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A classical frame.
    Classical(Frame),
    /// A frame of CAN FD with this identifier. None has anything for a board: its content is not read.
    Fd(CobId),
}

/// The words of a frame to be sent: a data frame, without an event after sending.
#[must_use]
pub fn to_send(frame: &Frame) -> Words {
    let payload = frame.payload();
    let mut bytes = [0; 8];
    for (to, byte) in bytes.iter_mut().zip(payload) {
        *to = *byte;
    }
    let [a, b, c, d, e, f, g, h] = bytes;
    Words::from_array([
        u32::from(frame.id().get()) << ID,
        (payload.len() as u32) << LENGTH,
        u32::from_le_bytes([a, b, c, d]),
        u32::from_le_bytes([e, f, g, h]),
    ])
}

/// The same of a frame of CAN FD. The controller says by itself whether it is error passive.
#[must_use]
pub fn fd_to_send(frame: &FdFrame) -> Words {
    let payload = frame.payload();
    let rate = if frame.is_rate_switched() {
        RATE_SWITCHED
    } else {
        0
    };
    let mut words = [0; ELEMENT];
    let [head, second, data @ ..] = &mut words;
    *head = u32::from(frame.id().get()) << ID;
    *second = u32::from(frame.length_code()) << LENGTH | FD | rate;
    for (word, bytes) in data.iter_mut().zip(payload.chunks(4)) {
        let mut all = [0; 4];
        for (to, byte) in all.iter_mut().zip(bytes) {
            *to = *byte;
        }
        *word = u32::from_le_bytes(all);
    }
    let mut words = Words::from_array(words);
    words.truncate(2 + payload.len().div_ceil(4));
    words
}

/// The frame in the first words of a received element. A length above eight means eight in a classical frame, as on the
/// wire. `None` where the words hold no valid frame.
#[must_use]
pub fn received([head, second, low, high]: [u32; 4]) -> Option<Heard> {
    let id = CobId::new(((head >> ID) & 0x7FF) as u16)?;
    if second & FD != 0 {
        return Some(Heard::Fd(id));
    }
    let [a, b, c, d] = low.to_le_bytes();
    let [e, f, g, h] = high.to_le_bytes();
    let bytes = [a, b, c, d, e, f, g, h];
    let length = ((second >> LENGTH) & 0xF).min(8) as usize;
    Frame::new(id, bytes.get(..length)?).map(Heard::Classical)
}

/// The controller's state on the bus, from its control register (CCCR), its protocol status (PSR) and its error
/// counters (ECR). The program never asks for restricted operation: where this bit is set, the controller has set it,
/// because it could not read its message memory.
#[must_use]
pub const fn controller(control: u32, status: u32, errors: u32) -> Controller {
    const RESTRICTED: u32 = 1 << 2;
    const PASSIVE: u32 = 1 << 5;
    const OFF: u32 = 1 << 7;
    Controller {
        state: if status & OFF != 0 {
            BusState::Off
        } else if control & RESTRICTED != 0 {
            BusState::Restricted
        } else if status & PASSIVE != 0 {
            BusState::Passive
        } else {
            BusState::Active
        },
        errors: ErrorCounts {
            sending: errors as u8,
            // The bit above is no part of the count: it says that the count has passed its limit.
            receiving: (errors >> 8) as u8 & 0x7F,
        },
    }
}

impl BitTiming {
    /// The word of the register for the nominal bit (NBTP). Each field holds its value less one.
    #[must_use]
    pub const fn word(&self) -> u32 {
        (self.jump as u32 - 1) << 25
            | (self.prescaler as u32 - 1) << 16
            | (self.before as u32 - 1) << 8
            | (self.after as u32 - 1)
    }

    /// The word of the register for the bit of the data (DBTP), with the measurement of the transceiver's delay.
    #[must_use]
    pub const fn data_word(&self) -> u32 {
        1 << 23
            | (self.prescaler as u32 - 1) << 16
            | (self.before as u32 - 1) << 8
            | (self.after as u32 - 1) << 4
            | (self.jump as u32 - 1)
    }

    /// The word of the register for that measurement (TDCR): a bit that comes back is looked at so many periods of the
    /// clock after the edge that was measured, at its sample point.
    #[must_use]
    pub const fn delay_word(&self) -> u32 {
        ((1 + self.before as u32) * self.prescaler as u32) << 8
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    fn frame(id: u16, payload: &[u8]) -> Frame {
        Frame::new(CobId::new(id).unwrap(), payload).unwrap()
    }

    fn classical(id: u16, payload: &[u8]) -> Option<Heard> {
        Some(Heard::Classical(frame(id, payload)))
    }

    // The expected words follow the tables of the receive and the transmit element in RM0440.

    #[test]
    fn a_frame_to_be_sent_has_its_bits_where_the_manual_has_them() {
        let setpoint = frame(0x201, &[0x0F, 0x00, 0x78, 0x56, 0x34, 0x12]);
        let words = [0x0804_0000, 0x0006_0000, 0x5678_000F, 0x0000_1234];
        assert_eq!(to_send(&setpoint), words);
        assert_eq!(to_send(&frame(0x080, &[])), [0x0200_0000, 0, 0, 0]);
        let longest = frame(0x7FF, &[1, 2, 3, 4, 5, 6, 7, 0xFF]);
        let words = [0x1FFC_0000, 0x0008_0000, 0x0403_0201, 0xFF07_0605];
        assert_eq!(to_send(&longest), words);
        // Neither extended nor remote; no bit rate switch, no event, no marker.
        for id in 0..=0x7FF {
            let words = to_send(&frame(id, &[0xFF; 8]));
            assert_eq!(words[0] & !0x1FFC_0000, 0);
            assert_eq!(words[1], 8 << 16);
        }
    }

    #[test]
    fn a_frame_that_was_received_is_told_without_its_stamp() {
        // No filter matched (bit 31); the number of the filter (30 to 24) means nothing then. The time stamp is in the
        // lower half.
        let words = [0x0608_0000, 0xFF08_BEEF, 0x4433_2211, 0x8877_6655];
        let bytes = [0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88];
        assert_eq!(received(words), classical(0x182, &bytes));
        // From a sender that is error passive (bit 31): a valid frame like any other.
        let passive = [0x8608_0000, 0x8002_0001, 0x4433_2211, 0];
        assert_eq!(received(passive), classical(0x182, &bytes[..2]));
        // A length of 9 to 15 means eight bytes.
        for length in 9..=15 {
            let words = [0x0608_0000, length << 16, 0x4433_2211, 0x8877_6655];
            assert_eq!(received(words), classical(0x182, &bytes));
        }
    }

    #[test]
    fn a_frame_of_can_fd_has_its_bits_and_all_its_bytes() {
        let bytes: Vec<u8> = (1..=64).collect();
        let of = |length: usize, switched| {
            let id = CobId::new(0x481).unwrap();
            let frame = FdFrame::new(id, &bytes[..length], switched).unwrap();
            fd_to_send(&frame)
        };
        assert_eq!(of(0, true), [0x1204_0000, 0x0030_0000]);
        assert_eq!(
            of(6, false),
            [0x1204_0000, 0x0026_0000, 0x0403_0201, 0x0605]
        );
        // Setpoints of four drives: 24 bytes have the code 12; of six: 48 have 14.
        let four = of(24, true);
        assert_eq!(four[..3], [0x1204_0000, 0x003C_0000, 0x0403_0201]);
        assert_eq!((four.len(), four[7]), (8, 0x1817_1615));
        let six = of(36, true);
        assert_eq!((six.len(), six[1], six[10]), (14, 0x003E_0000, 0x2423_2221));
        assert_eq!(six[11..], [0; 3]);
        let longest = of(64, true);
        assert_eq!(
            (longest.len(), longest[1], longest[17]),
            (18, 0x003F_0000, 0x403F_3E3D)
        );
    }

    #[test]
    fn of_a_frame_of_can_fd_that_was_received_the_identifier_is_read() {
        for second in [0x003C_0000, 0xFF28_BEEF, 0x0020_0000] {
            let words = [0x1204_0000, second, 0x4433_2211, 0x8877_6655];
            assert_eq!(received(words), Some(Heard::Fd(CobId::new(0x481).unwrap())));
        }
    }

    #[test]
    fn what_is_sent_reads_back_as_what_it_was() {
        for id in 0..=0x7FF {
            for length in 0..=8 {
                let bytes: Vec<u8> = (1..=length).map(|n| n ^ id as u8).collect();
                let mut stamped = to_send(&frame(id, &bytes)).into_array().unwrap();
                stamped[1] |= u32::from(!id);
                assert_eq!(received(stamped), classical(id, &bytes));
            }
        }
    }

    #[test]
    fn the_state_on_the_bus_is_that_of_the_two_registers() {
        let in_mode = |control, status, errors| {
            let Controller { state, errors } = controller(control, status, errors);
            (state, errors.sending, errors.receiving)
        };
        let of = |status, errors| in_mode(0, status, errors);
        // The registers after a reset.
        assert_eq!(of(0x0000_0707, 0), (BusState::Active, 0, 0));
        // A warning changes nothing.
        assert_eq!(of(1 << 6, 0x0000_6060), (BusState::Active, 96, 96));
        assert_eq!(of(1 << 5, 0x00FF_0080), (BusState::Passive, 128, 0));
        // Passive as a receiver: the count stands at its limit, and its own bit is set.
        assert_eq!(of(1 << 5, 0x0000_FF00), (BusState::Passive, 0, 127));
        // Off counts before passive.
        assert_eq!(of(0xE0, 0x0000_00F8), (BusState::Off, 248, 0));
        // Restricted counts before passive, because the controller does not leave it by itself. Off, which sets INIT,
        // counts before both.
        assert_eq!(in_mode(1 << 2, 0x707, 3), (BusState::Restricted, 3, 0));
        assert_eq!(in_mode(1 << 2, 1 << 5, 0), (BusState::Restricted, 0, 0));
        assert_eq!(in_mode(0b101, 0xE0, 0xF8), (BusState::Off, 248, 0));
        // No other bit of the control register means restricted.
        assert_eq!(in_mode(!(1 << 2), 0x707, 0), (BusState::Active, 0, 0));
    }

    /// What both registers of bits have after a reset.
    const AFTER_RESET: BitTiming = BitTiming {
        prescaler: 1,
        before: 11,
        after: 4,
        jump: 4,
    };

    #[test]
    fn a_bit_of_the_data_has_registers_of_its_own() {
        // The manual: the reset value 0000 0A33h, without the measurement of the delay.
        assert_eq!(AFTER_RESET.data_word(), 0x0080_0A33);
        assert_eq!(AFTER_RESET.delay_word(), 12 << 8);
        // 5 Mbit/s of 85 MHz: 17 quanta, sampled behind 13.
        let fast = BitTiming::of_data(85_000_000, 5000).unwrap();
        assert_eq!(
            (fast.data_word(), fast.delay_word()),
            (0x0080_0B33, 13 << 8)
        );
        let most = BitTiming {
            prescaler: 2,
            before: 32,
            after: 16,
            jump: 16,
        };
        assert_eq!(
            (most.data_word(), most.delay_word()),
            (0x0081_1FFF, 66 << 8)
        );
    }

    #[test]
    fn a_bit_is_one_less_in_every_field() {
        // The manual: with a clock of 48 MHz the reset value 0600 0A03h gives 3 Mbit/s.
        assert_eq!(AFTER_RESET.word(), 0x0600_0A03);
        assert_eq!(AFTER_RESET.clocks() * 3_000_000, 48_000_000);
        let megabit = BitTiming::of(24_000_000, 1000).unwrap();
        assert_eq!(megabit.word(), 0x0400_1302);
        // 10 kbit/s: 80 quanta of 30 clocks.
        let slowest = BitTiming::of(24_000_000, 10).unwrap();
        assert_eq!(slowest.word(), 0x121D_4409);
        let most = BitTiming {
            prescaler: 512,
            before: 255,
            after: 128,
            jump: 128,
        };
        assert_eq!(most.word(), 0xFFFF_FE7F);
    }
}
