//! Work that goes on while the link waits, whatever it waits for: a person's keys, and the frames that follow from them.
//!
//! A transfer may wait a second for a lost answer. A press is renewed meanwhile, its release is seen, and a hold goes out.

use std::time::{Duration, Instant};

use leadscrew_core::bus::Frame;

use super::{GLANCE, Link, LinkResult, Seen};

/// From one turn of that work to the next, at most.
const TURN: Duration = Duration::from_millis(4);
/// And at least: a busy bus wakes this side for each frame.
const PAUSE: Duration = Duration::from_millis(1);

/// The work.
type Work = Box<dyn FnMut(&Seen, Instant) -> Vec<Frame> + Send>;

/// The work, if there is any, and when it had its last turn.
#[derive(Default)]
pub(super) struct Meanwhile {
    work: Option<Work>,
    last: Option<Instant>,
}

impl Link {
    /// From now on `work` has a turn every few milliseconds wherever this side waits; its frames are sent at once.
    pub fn meanwhile(&mut self, work: impl FnMut(&Seen, Instant) -> Vec<Frame> + Send + 'static) {
        self.meanwhile = Meanwhile {
            work: Some(Box::new(work)),
            last: None,
        };
    }

    /// Gives the work its turn.
    pub(super) fn go_on_meanwhile(&mut self) -> LinkResult {
        let Some(work) = &mut self.meanwhile.work else {
            return Ok(());
        };
        let now = Instant::now();
        if self.meanwhile.last.is_some_and(|last| now < last + PAUSE) {
            return Ok(());
        }
        self.meanwhile.last = Some(now);
        let frames = work(&self.seen, now);
        if frames.is_empty() {
            return Ok(());
        }
        self.put(&frames)
    }

    /// The longest wait for one frame.
    pub(super) const fn glance(&self) -> Duration {
        match self.meanwhile.work {
            Some(_) => TURN,
            None => GLANCE,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
    use std::sync::{Arc, Mutex};

    use leadscrew_board_sim::plant::Flash;
    use leadscrew_core::bus::{BoardCommand, Order, Service};

    use super::super::bench::{Fate, between, machine};
    use super::*;

    #[test]
    fn a_hold_goes_out_in_the_middle_of_a_transfer_without_an_answer() {
        let inside = machine(Flash::erased());
        let (asked, sent) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(Mutex::new(Vec::new())),
        );
        let (asks, all) = (Arc::clone(&asked), Arc::clone(&sent));
        let is_request =
            |frame: &Frame| matches!(frame.id().service(), Some((Service::SdoRequest, _)));
        let mut link = between(
            &inside,
            move |frame| {
                all.lock().unwrap().push(*frame);
                if is_request(frame) {
                    asks.store(true, Ordering::Relaxed);
                    return Fate::Lost(None);
                }
                Fate::Arrives
            },
            |frame| frame,
        );
        let node = link.node();
        let hold = BoardCommand::order(Order::Hold, 0).frame(node);
        let turns = Arc::new(AtomicU32::new(0));
        let counted = Arc::clone(&turns);
        link.meanwhile(move |_, _| {
            // The work sees that a request is out, and orders once.
            let is_out = asked.swap(false, Ordering::Relaxed);
            counted.fetch_add(u32::from(is_out), Ordering::Relaxed);
            is_out.then_some(hold).into_iter().collect()
        });
        link.set_patience(Duration::from_millis(100));
        assert!(link.status().is_err());
        let sent = sent.lock().unwrap();
        assert!(is_request(&sent[0]));
        assert_eq!(sent[1], hold);
        assert!(turns.load(Ordering::Relaxed) > 0);
    }
}
