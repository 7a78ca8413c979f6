//! Emergency messages: a node sends one when an error appears, and one when the last error is gone.

use super::frame::{CobId, Frame, NodeId, Service};

/// An emergency message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Emcy {
    /// Emergency error code; 0000h when the error is gone.
    pub code: u16,
    /// Error register, object 1001h.
    pub register: u8,
    /// Manufacturer-specific detail.
    pub detail: [u8; 5],
}

impl Emcy {
    /// Error code "device specific" of CiA 301, for the board's own alarms. The detail has the number of the alarm.
    pub const DEVICE_SPECIFIC: u16 = 0xFF00;
    /// Error code of CiA 301: a PDO was too short and was not processed.
    pub const PDO_TOO_SHORT: u16 = 0x8210;
    /// Error code of CiA 301: a PDO is longer than its mapping.
    pub const PDO_TOO_LONG: u16 = 0x8220;
    /// Error register: bit 0 is set with every error.
    pub const GENERIC: u8 = 0x01;
    /// Error register bit 7: manufacturer-specific error.
    pub const MAKER: u8 = 0x80;

    /// True for the error codes of a sensor, an encoder among them (73xxh).
    #[must_use]
    pub const fn is_of_sensor(code: u16) -> bool {
        code >> 8 == 0x73
    }

    /// The message that no error is left.
    pub const GONE: Self = Self {
        code: 0,
        register: 0,
        detail: [0; 5],
    };

    /// The message for an alarm of the board: the first two detail bytes are the alarm's number, little-endian.
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

    /// The node and its message, if `frame` is an emergency message.
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
