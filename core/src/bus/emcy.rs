//! Emergency messages: what a node says once when an error appears, and once when the last is gone.

use super::frame::{CobId, Frame, NodeId, Service};

/// An emergency message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Emcy {
    /// Emergency error code; 0000h when the error is gone.
    pub code: u16,
    /// Error register, object 1001h.
    pub register: u8,
    /// What the maker adds.
    pub detail: [u8; 5],
}

impl Emcy {
    /// Error code "device specific" of CiA 301: the board's own alarms, whose number is in the detail.
    pub const DEVICE_SPECIFIC: u16 = 0xFF00;
    /// Error code of CiA 301: a PDO was too short to be taken.
    pub const PDO_TOO_SHORT: u16 = 0x8210;
    /// Error code of CiA 301: a PDO is longer than what is mapped.
    pub const PDO_TOO_LONG: u16 = 0x8220;
    /// Error register: bit 0 is set with every error.
    pub const GENERIC: u8 = 0x01;
    /// Error register bit 7: maker's own.
    pub const MAKER: u8 = 0x80;

    /// No error any more.
    pub const GONE: Self = Self {
        code: 0,
        register: 0,
        detail: [0; 5],
    };

    /// An alarm of the board: its number, little-endian, is in the first two detail bytes.
    #[must_use]
    pub const fn of_alarm(number: u16) -> Self {
        let [low, high] = number.to_le_bytes();
        Self {
            code: Self::DEVICE_SPECIFIC,
            register: Self::GENERIC | Self::MAKER,
            detail: [low, high, 0, 0, 0],
        }
    }

    /// The frame that `node` sends.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [low, high] = self.code.to_le_bytes();
        let [a, b, c, d, e] = self.detail;
        Frame::of(
            CobId::of(Service::Emcy, node),
            [low, high, self.register, a, b, c, d, e],
        )
    }

    /// The node and its message, if `frame` is one.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Emcy, node) = frame.id().service()? else {
            return None;
        };
        let [low, high, register, a, b, c, d, e] = frame.exactly()?;
        Some((
            node,
            Self {
                code: u16::from_le_bytes([low, high]),
                register,
                detail: [a, b, c, d, e],
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alarm_has_its_number_in_the_detail() {
        let frame = Emcy::of_alarm(4356).frame(NodeId::BOARD);
        assert_eq!(frame.id().get(), 0x081);
        assert_eq!(frame.payload(), [0x00, 0xFF, 0x81, 0x04, 0x11, 0, 0, 0]);
        assert_eq!(
            Emcy::decode(&frame),
            Some((NodeId::BOARD, Emcy::of_alarm(4356)))
        );
        let gone = Emcy::GONE.frame(NodeId::DRIVE_X);
        assert_eq!((gone.id().get(), gone.payload()), (0x090, &[0; 8][..]));
        assert_eq!(
            Emcy::decode(&Frame::new(CobId::SYNC, &[0; 8]).unwrap()),
            None
        );
    }
}
