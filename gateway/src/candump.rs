//! Bus traffic as a candump log: what `candump -l` writes and `canplayer`, Wireshark and python-can read.

use std::io::{self, Write};

use leadscrew_core::bus::Frame;

/// A log being written.
#[derive(Debug)]
pub struct Log<W: Write> {
    to: W,
    tick_us: u64,
    /// The first write that failed; told at the end.
    failed: Option<io::Error>,
}

impl<W: Write> Log<W> {
    /// An empty log.
    pub fn new(to: W, tick_us: u32) -> Self {
        Self {
            to,
            tick_us: u64::from(tick_us),
            failed: None,
        }
    }

    /// Appends a frame of a tick, in virtual time.
    pub fn push(&mut self, tick: u64, frame: &Frame) {
        if self.failed.is_some() {
            return;
        }
        if let Err(error) = self.line(tick, frame) {
            self.failed = Some(error);
        }
    }

    fn line(&mut self, tick: u64, frame: &Frame) -> io::Result<()> {
        let us = tick.saturating_mul(self.tick_us);
        let id = frame.id().get();
        write!(
            self.to,
            "({:010}.{:06}) sim {id:03X}#",
            us / 1_000_000,
            us % 1_000_000
        )?;
        for byte in frame.payload() {
            write!(self.to, "{byte:02X}")?;
        }
        writeln!(self.to)
    }

    /// Writes what is left.
    pub fn finish(mut self) -> io::Result<()> {
        match self.failed.take() {
            Some(error) => Err(error),
            None => self.to.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::bus::CobId;

    use super::*;

    #[test]
    fn lines_are_candump_s() {
        let mut out = Vec::new();
        let mut log = Log::new(&mut out, 1000);
        log.push(
            1_234,
            &Frame::new(CobId::new(0x190).unwrap(), &[0x27, 0x06, 0xAB]).unwrap(),
        );
        log.push(1_235, &Frame::new(CobId::SYNC, &[]).unwrap());
        log.finish().unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "(0000000001.234000) sim 190#2706AB\n(0000000001.235000) sim 080#\n"
        );
    }
}
