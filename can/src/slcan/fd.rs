//! FD frames on the line of an adapter. They are not part of Lawicel's protocol: the firmware of CANable 2.0 adapters
//! adds them, and other adapters follow it.
//!
//! ```text
//! Y5␍                 while closed: the data of FD frames go at 5 Mbit/s (1, 2, 4, 5, 8)
//! d12392A…␍           an FD frame, identifier 123h, length code 9: 12 bytes   D, with eight digits: an extended identifier
//! b12392A…␍           the same, its data at the higher rate                  B, likewise
//! ```

use leadscrew_core::bus::{self, CobId};

use crate::{Data, FdFrame, Id};

/// The longest line: 64 bytes of data, an extended identifier and a time stamp.
pub const LONGEST: usize = 1 + 8 + 1 + 128 + 4 + 1;

/// The command for a data rate; `None` where no command exists for it.
pub fn rate(data_kbit: u32) -> Option<String> {
    match data_kbit {
        1000 | 2000 | 4000 | 5000 | 8000 => Some(format!("Y{}\r", data_kbit / 1000)),
        _ => None,
    }
}

/// A frame as a line, with the end of the line.
pub fn line(frame: &bus::FdFrame) -> Vec<u8> {
    let kind = if frame.is_rate_switched() { 'b' } else { 'd' };
    let mut line = format!("{kind}{:03X}{:X}", frame.id().get(), frame.length_code());
    for byte in frame.payload() {
        line.push_str(&format!("{byte:02X}"));
    }
    line.push('\r');
    line.into_bytes()
}

/// The frame in a line, with or without a time stamp after it.
pub fn frame(line: &[u8]) -> Option<FdFrame> {
    let (kind, rest) = line.split_first()?;
    let (digits, rate_switched) = match kind {
        b'd' => (3, false),
        b'b' => (3, true),
        b'D' => (8, false),
        b'B' => (8, true),
        _ => return None,
    };
    let (id, rest) = rest.split_at_checked(digits)?;
    let id = number(id)?;
    let id = if digits == 3 {
        Id::Standard(CobId::new(u16::try_from(id).ok()?)?)
    } else {
        Id::Extended(Some(id).filter(|id| *id < 1 << 29)?)
    };
    let (code, rest) = rest.split_first()?;
    let code = usize::try_from(number(&[*code])?).ok()?;
    let length = usize::from(*bus::FdFrame::LENGTHS.get(code)?);
    let (content, stamp) = rest.split_at_checked(2 * length)?;
    if !stamp.is_empty() && (stamp.len() != 4 || number(stamp).is_none()) {
        return None;
    }
    let (pairs, _) = content.as_chunks::<2>();
    let bytes = pairs
        .iter()
        .map(|pair| u8::try_from(number(pair)?).ok())
        .collect::<Option<Vec<u8>>>()?;
    Some(FdFrame {
        id,
        data: Data::new(&bytes)?,
        rate_switched,
        sender_passive: false,
    })
}

/// The value of hexadecimal digits.
fn number(digits: &[u8]) -> Option<u32> {
    digits.iter().try_fold(0_u32, |value, digit| {
        Some(value << 4 | char::from(*digit).to_digit(16)?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_every_length_are_lines_and_back() {
        let content: Vec<u8> = (1..=64).collect();
        for (code, length) in bus::FdFrame::LENGTHS.into_iter().enumerate() {
            for rate_switched in [false, true] {
                let id = CobId::new(0x481).unwrap();
                let content = &content[..usize::from(length)];
                let sent = bus::FdFrame::new(id, content, rate_switched).unwrap();
                let text = line(&sent);
                let (end, text) = text.split_last().unwrap();
                assert_eq!(*end, b'\r');
                let head = format!("{}481{code:X}", if rate_switched { 'b' } else { 'd' });
                assert!(text.starts_with(head.as_bytes()));
                let stamped = [text, b"1A2B"].concat();
                for text in [text, &stamped] {
                    assert_eq!(frame(text).and_then(|frame| frame.frame()), Some(sent));
                }
            }
        }
        let extended = frame(b"B1ABCDEF09000102030405060708090A0B").unwrap();
        assert_eq!(extended.id, Id::Extended(0x1ABC_DEF0));
        assert_eq!(
            extended.data.bytes(),
            [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]
        );
    }

    #[test]
    fn other_lines_are_no_frames() {
        for line in [
            "",
            "d",
            "b48",
            "b481",
            "b481G",
            "t4810",
            "b8010",
            "b4811",
            "b48111",
            "b481112A",
            "b4810123",
            "b48101234567",
            "B200000000",
            "b48119G",
        ] {
            let heard = frame(line.as_bytes());
            assert_eq!(heard, None, "{line}");
        }
        assert!(frame(b"b48101234").is_some());
        assert_eq!(rate(5000).as_deref(), Some("Y5\r"));
        assert_eq!(rate(3000), None);
    }
}
