//! Frames in the form of the kernel's sockets: `struct can_frame` and `struct canfd_frame` of `linux/can.h`, in the
//! machine's byte order.

use leadscrew_core::bus::{self, CobId, Frame};

use crate::{Data, ErrorFrame, FdFrame, Id, Packet};

/// Bytes of a classical frame.
pub const CLASSICAL: usize = 16;
/// Bytes of an FD frame.
pub const FD: usize = 72;

const EXTENDED: u32 = 1 << 31;
const REMOTE: u32 = 1 << 30;
const ERROR: u32 = 1 << 29;
const EXTENDED_BITS: u32 = 0x1FFF_FFFF;
const RATE_SWITCHED: u8 = 0x01;
const SENDER_PASSIVE: u8 = 0x02;

/// The packet in these bytes; `None` where the bytes are no packet.
pub fn packet(bytes: &[u8]) -> Option<Packet> {
    let (id, rest) = bytes.split_first_chunk::<4>()?;
    let word = u32::from_ne_bytes(*id);
    let ([len, flags, _, _], content) = rest.split_first_chunk::<4>()?;
    match content.len() {
        8 => classical(word, *len, content),
        64 => Some(Packet::Fd(FdFrame {
            id: id_of(word)?,
            data: Data::new(content.get(..usize::from(*len))?)?,
            rate_switched: flags & RATE_SWITCHED != 0,
            sender_passive: flags & SENDER_PASSIVE != 0,
        })),
        _ => None,
    }
}

fn classical(word: u32, len: u8, content: &[u8]) -> Option<Packet> {
    if word & ERROR != 0 {
        return Some(Packet::Error(ErrorFrame {
            class: word & EXTENDED_BITS,
            data: content.try_into().ok()?,
        }));
    }
    let id = id_of(word)?;
    if word & REMOTE != 0 {
        return Some(Packet::Remote(id, len));
    }
    let data = content.get(..usize::from(len))?;
    Some(match id {
        Id::Standard(id) => Packet::Frame(Frame::new(id, data)?),
        Id::Extended(id) => Packet::Extended(id, Data::new(data)?),
    })
}

fn id_of(word: u32) -> Option<Id> {
    Some(if word & EXTENDED != 0 {
        Id::Extended(word & EXTENDED_BITS)
    } else {
        Id::Standard(CobId::new((word & 0x7FF) as u16)?)
    })
}

/// A frame as bytes.
pub fn bytes(frame: &Frame) -> [u8; CLASSICAL] {
    laid_out(frame.id(), 0, frame.payload())
}

/// An FD frame as bytes.
pub fn fd_bytes(frame: &bus::FdFrame) -> [u8; FD] {
    let flags = if frame.is_rate_switched() {
        RATE_SWITCHED
    } else {
        0
    };
    laid_out(frame.id(), flags, frame.payload())
}

fn laid_out<const N: usize>(id: CobId, flags: u8, payload: &[u8]) -> [u8; N] {
    let mut bytes = [0; N];
    let id = u32::from(id.get()).to_ne_bytes();
    let head = id.into_iter().chain([payload.len() as u8, flags, 0, 0]);
    for (to, from) in bytes.iter_mut().zip(head.chain(payload.iter().copied())) {
        *to = from;
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn classical(word: u32, len: u8, content: [u8; 8]) -> Option<Packet> {
        let mut bytes = word.to_ne_bytes().to_vec();
        bytes.extend([len, 0, 0, 0]);
        bytes.extend(content);
        packet(&bytes)
    }

    #[test]
    fn frames_come_back_as_they_went() {
        for len in 0..=8 {
            let frame =
                Frame::new(CobId::new(0x123).unwrap(), &[1, 2, 3, 4, 5, 6, 7, 8][..len]).unwrap();
            assert_eq!(packet(&bytes(&frame)), Some(Packet::Frame(frame)));
        }
    }

    #[test]
    fn fd_frames_come_back_as_they_went() {
        let content: Vec<u8> = (1..=64).collect();
        for length in bus::FdFrame::LENGTHS {
            let id = CobId::new(0x481).unwrap();
            let content = &content[..usize::from(length)];
            for rate_switched in [false, true] {
                let frame = bus::FdFrame::new(id, content, rate_switched).unwrap();
                let Some(Packet::Fd(back)) = packet(&fd_bytes(&frame)) else {
                    panic!("{frame:?}");
                };
                assert_eq!(back.frame(), Some(frame));
                assert_eq!(back, FdFrame::from(&frame));
            }
        }
    }

    #[test]
    fn every_kind_is_told_from_the_others() {
        let data = [1, 2, 3, 0, 0, 0, 0, 0];
        assert_eq!(
            classical(EXTENDED | 0x1ABC_DEF0, 3, data),
            Some(Packet::Extended(
                0x1ABC_DEF0,
                Data::new(&[1, 2, 3]).unwrap()
            ))
        );
        assert_eq!(
            classical(REMOTE | 0x701, 1, [0; 8]),
            Some(Packet::Remote(Id::Standard(CobId::new(0x701).unwrap()), 1))
        );
        assert_eq!(
            classical(ERROR | 0x44, 8, [0, 0x20, 0, 0, 0, 0, 130, 12]),
            Some(Packet::Error(ErrorFrame {
                class: 0x44,
                data: [0, 0x20, 0, 0, 0, 0, 130, 12]
            }))
        );
        let mut fd = 0x321_u32.to_ne_bytes().to_vec();
        fd.extend([12, RATE_SWITCHED, 0, 0]);
        fd.extend([7; 64]);
        assert_eq!(
            packet(&fd),
            Some(Packet::Fd(FdFrame {
                id: Id::Standard(CobId::new(0x321).unwrap()),
                data: Data::new(&[7; 12]).unwrap(),
                rate_switched: true,
                sender_passive: false,
            }))
        );
    }

    #[test]
    fn bytes_that_are_no_frame_are_refused() {
        assert_eq!(packet(&[0; 15]), None);
        assert_eq!(packet(&[]), None);
        assert_eq!(classical(1, 9, [0; 8]), None);
    }
}
