//! A bus with two ends inside one process: each end receives the frames of the other. It is for tests, and for parts
//! that a real bus would connect.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

use leadscrew_core::bus::{self, Frame};

use crate::{Can, CanError, Filter, Packet, Received, Stamp};

/// One end.
#[derive(Debug)]
pub struct End {
    to: Sender<Received>,
    from: Receiver<Received>,
    filters: Vec<Filter>,
}

/// Two ends that receive each other's frames. No frame between them is ever dropped.
#[must_use]
pub fn pair() -> (End, End) {
    let (to_b, from_a) = mpsc::channel();
    let (to_a, from_b) = mpsc::channel();
    let end = |to, from| End {
        to,
        from,
        filters: Vec::new(),
    };
    (end(to_b, from_b), end(to_a, from_a))
}

impl End {
    /// Puts a packet of any kind on the bus, for example an error frame.
    ///
    /// # Errors
    /// [`CanError::Closed`] where the other end is gone.
    pub fn inject(&mut self, packet: Packet) -> Result<(), CanError> {
        let time = Stamp::now();
        self.to
            .send(Received { time, packet })
            .map_err(|_| closed())
    }

    fn take(&self, received: Received, into: &mut Vec<Received>) {
        if Filter::any_passes(&self.filters, &received.packet) {
            into.push(received);
        }
    }
}

fn closed() -> CanError {
    CanError::Closed {
        name: "pair".into(),
    }
}

impl Can for End {
    fn name(&self) -> &str {
        "pair"
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        for frame in frames {
            self.inject(Packet::Frame(*frame))?;
        }
        Ok(())
    }

    fn use_fd(&mut self, _data_kbit: u32) -> Result<(), CanError> {
        Ok(())
    }

    fn send_fd(&mut self, frames: &[bus::FdFrame]) -> Result<(), CanError> {
        for frame in frames {
            self.inject(Packet::Fd(frame.into()))?;
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let before = into.len();
        match self.from.recv_timeout(patience) {
            Ok(received) => self.take(received, into),
            Err(RecvTimeoutError::Timeout) => return Ok(0),
            Err(RecvTimeoutError::Disconnected) => return Err(closed()),
        }
        while let Ok(received) = self.from.try_recv() {
            self.take(received, into);
        }
        Ok(into.len() - before)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.filters = filters.to_vec();
        Ok(())
    }

    fn dropped(&self) -> Result<u64, CanError> {
        Ok(0)
    }
}
