//! A board that claims another version of the link: its answers for 5020h:02 give another key than its own.

use leadscrew_core::bus::{CobId, Frame, NodeId, Service};

/// The beginning of the first answer: the length. The value is in the frames after it.
const BEGINS: [u8; 4] = [0x41, 0x20, 0x50, 0x02];

/// The claimed key.
#[derive(Debug)]
pub struct Claim {
    key: u32,
    replies: CobId,
    /// The next answer contains the key.
    next: bool,
}

impl Claim {
    /// A claim of this board, with this key.
    pub const fn new(node: NodeId, key: u32) -> Self {
        Self {
            key,
            replies: CobId::of(Service::SdoReply, node),
            next: false,
        }
    }

    /// A frame that the board sends, with the key changed.
    pub fn pass(&mut self, frame: Frame) -> Frame {
        if frame.id() != self.replies {
            return frame;
        }
        let mut data = [0; 8];
        let bytes = data.iter_mut().zip(frame.payload());
        bytes.for_each(|(place, byte)| *place = *byte);
        if !std::mem::take(&mut self.next) {
            self.next = data.starts_with(&BEGINS);
            return frame;
        }
        if let Some(place) = data.get_mut(1..5) {
            place.copy_from_slice(&self.key.to_le_bytes());
        }
        // The length stays the same; a frame that cannot be made stays unchanged.
        data.get(..frame.payload().len())
            .and_then(|data| Frame::new(frame.id(), data))
            .unwrap_or(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_key_in_the_answer_becomes_another() {
        let mut claim = Claim::new(NodeId::BOARD, 0x0123_ABCD);
        let reply = |data: &[u8]| {
            let id = CobId::of(Service::SdoReply, NodeId::BOARD);
            Frame::new(id, data).unwrap()
        };
        let other = reply(&[0x43, 0x18, 0x10, 2, 1, 2, 3, 4]);
        assert_eq!(claim.pass(other), other);
        let begins = reply(&[0x41, 0x20, 0x50, 2, 8, 0, 0, 0]);
        assert_eq!(claim.pass(begins), begins);
        let key = claim.pass(reply(&[0x00, 1, 2, 3, 4, 1, 0, 0]));
        assert_eq!(key, reply(&[0x00, 0xCD, 0xAB, 0x23, 0x01, 1, 0, 0]));
        let end = reply(&[0x1D, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(claim.pass(end), end);
    }
}
