//! Places for connections: few for all, and some more for hold and stop alone.
//!
//! Whoever comes when all are taken gets one of the latter for a moment. Where those are taken too, the one that has said
//! nothing for the longest gives way: connections that are opened and left open keep no hold out.

use std::collections::VecDeque;
use std::io::{self, Write as _};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::refusal::Refusal;

/// Connections that wait for a hold or a stop to come at a time.
const URGENT: usize = 16;

/// A place among few; free again when it is dropped.
pub struct Seat(Arc<AtomicUsize>);

impl Seat {
    /// One of `limit`.
    pub fn take(taken: &Arc<AtomicUsize>, limit: usize) -> Option<Self> {
        let one_more = |count| (count < limit).then_some(count + 1);
        let free = taken.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_more);
        free.ok().map(|_| Self(Arc::clone(taken)))
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Connections from which a hold or a stop may still come, the oldest first.
#[derive(Default)]
pub struct Urgent {
    waiting: Mutex<VecDeque<(u64, TcpStream)>>,
}

impl Urgent {
    /// Lets the connection of this number wait, and ends the one that has waited longest where there are too many.
    ///
    /// # Errors
    /// The connection cannot be ended from here.
    pub fn wait(&self, number: u64, stream: &TcpStream) -> io::Result<()> {
        let handle = stream.try_clone()?;
        let mut waiting = self.waiting();
        if waiting.len() >= URGENT
            && let Some((_, oldest)) = waiting.pop_front()
        {
            turn_away(&oldest);
            let _ = oldest.shutdown(Shutdown::Both);
        }
        waiting.push_back((number, handle));
        Ok(())
    }

    /// It has said what it wants. False where it has been ended.
    pub fn has_said(&self, number: u64) -> bool {
        let mut waiting = self.waiting();
        let found = waiting.iter().position(|(own, _)| *own == number);
        found.and_then(|at| waiting.remove(at)).is_some()
    }

    fn waiting(&self) -> MutexGuard<'_, VecDeque<(u64, TcpStream)>> {
        // A list of handles is whole at any time.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Says that there is no room, without waiting for anything.
pub fn turn_away(mut stream: &TcpStream) {
    let body = Refusal::Busy.json();
    let status = Refusal::Busy.status();
    let text = format!(
        "HTTP/1.1 {status}\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    );
    if stream.set_nonblocking(true).is_ok() {
        // Who does not get it sees the connection end.
        let _ = stream.write(text.as_bytes());
        let _ = stream.shutdown(Shutdown::Write);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn a_seat_is_free_again() {
        let taken = Arc::default();
        let first = Seat::take(&taken, 2);
        let second = Seat::take(&taken, 2);
        assert!(first.is_some() && second.is_some() && Seat::take(&taken, 2).is_none());
        drop(first);
        assert!(Seat::take(&taken, 2).is_some());
    }

    #[test]
    fn who_has_said_nothing_for_the_longest_gives_way() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let urgent = Urgent::default();
        let ends: Vec<_> = (0..=URGENT as u64)
            .map(|number| {
                let client = TcpStream::connect(address).unwrap();
                let (server, _) = listener.accept().unwrap();
                urgent.wait(number, &server).unwrap();
                (client, server)
            })
            .collect();
        assert!(!urgent.has_said(0));
        assert!((1..=URGENT as u64).all(|number| urgent.has_said(number)));
        let mut told = String::new();
        (&ends[0].0).read_to_string(&mut told).unwrap();
        assert!(told.ends_with(&Refusal::Busy.json()), "{told}");
    }
}
