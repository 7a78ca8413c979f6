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
