//! Line ends of old controls: a carriage return alone, or a line feed followed by a carriage return. They are read as line
//! feeds, byte for byte, so lines and columns are those of an editor.

/// The line end of a text: that of its first line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineEnds {
    /// No line has ended yet.
    #[default]
    Unknown,
    /// A line feed, alone or after a carriage return. It stays as it is.
    Feed,
    /// A carriage return.
    Return,
    /// A line feed followed by a carriage return.
    FeedReturn,
}

impl LineEnds {
    /// Turns the line ends in `bytes` into line feeds and returns the number of finished bytes. If the last byte may be
    /// half of a line end and is not the `last` of the text, it must come again with the byte after it.
    pub fn translate(&mut self, bytes: &mut [u8], last: bool) -> usize {
        let Some(first) = bytes.iter().position(|b| matches!(b, b'\r' | b'\n')) else {
            return bytes.len();
        };
        let half = bytes.len() - 1;
        if *self == Self::Unknown {
            if first == half && !last {
                return half;
            }
            *self = match (bytes[first], bytes.get(first + 1)) {
                (b'\r', Some(b'\n')) => Self::Feed,
                (b'\r', _) => Self::Return,
                (_, Some(b'\r')) => Self::FeedReturn,
                _ => Self::Feed,
            };
        }
        let (one, other) = match self {
            Self::Unknown | Self::Feed => return bytes.len(),
            Self::Return => (b'\r', b'\n'),
            Self::FeedReturn => (b'\n', b'\r'),
        };
        let mut at = first;
        while at < bytes.len() {
            if bytes[at] == one {
                if at == half && !last {
                    return half;
                }
                if bytes.get(at + 1) == Some(&other) {
                    bytes[at] = b' ';
                    at += 1;
                }
                bytes[at] = b'\n';
            }
            at += 1;
        }
        bytes.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads in pieces of `size` bytes, as from a file.
    fn read(text: &str, size: usize) -> String {
        let (mut ends, mut out, mut rest) = (LineEnds::default(), Vec::new(), Vec::new());
        let mut pieces = text.as_bytes().chunks(size).peekable();
        while let Some(piece) = pieces.next() {
            rest.extend_from_slice(piece);
            let done = ends.translate(&mut rest, pieces.peek().is_none());
            out.extend(rest.drain(..done));
        }
        assert_eq!(rest, b"");
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_line_end_becomes_a_line_feed_in_its_place() {
        for (text, expected) in [
            ("", ""),
            ("G0", "G0"),
            ("G0\nG1\n", "G0\nG1\n"),
            ("G0\r\nG1\r\n\r\n", "G0\r\nG1\r\n\r\n"),
            ("G0\rG1\r\rM30\r", "G0\nG1\n\nM30\n"),
            ("G0\r", "G0\n"),
            ("\r\rG0", "\n\nG0"),
            ("G0\n\rG1\n\r\n\rM30\n\r", "G0 \nG1 \n \nM30 \n"),
            ("G0\n\r", "G0 \n"),
            // A line end of another kind is still one line end.
            ("G0\rG1\r\nM30", "G0\nG1 \nM30"),
            ("G0\n\rG1\nM30\n\r", "G0 \nG1\nM30 \n"),
            // In a text with line feeds, a carriage return alone is a character without meaning.
            ("G0\nG1\rX\n", "G0\nG1\rX\n"),
        ] {
            for size in 1..=text.len().max(1) {
                assert_eq!(read(text, size), expected, "{text:?} in {size}");
            }
        }
    }
}
