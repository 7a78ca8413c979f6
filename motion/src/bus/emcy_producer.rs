//! Reports each error to the network once and keeps a record: error register (1001h), history (1003h), inhibit time
//! (1015h).

use heapless::Deque;

use super::emcy::Emcy;
use super::frame::{Frame, NodeId};
use super::object::Abort;
use super::periods::Periods;

/// Largest number of messages that wait for the inhibit time.
const WAITING: usize = 4;

/// The emergency producer of a node, with a history of `N` errors.
#[derive(Clone, Debug)]
pub struct EmcyProducer<const N: usize> {
    node: NodeId,
    register: u8,
    /// Newest first.
    history: [u32; N],
    /// Number of errors in the history.
    errors: u8,
    waiting: Deque<Emcy, WAITING>,
    inhibit: Periods,
    /// Time until the next message may be sent.
    rest: Periods,
}

impl<const N: usize> EmcyProducer<N> {
    /// A producer without errors and with an inhibit time of 0.
    #[must_use]
    pub const fn new(node: NodeId) -> Self {
        Self {
            node,
            register: 0,
            history: [0; N],
            errors: 0,
            waiting: Deque::new(),
            inhibit: Periods::new(0),
            rest: Periods::new(0),
        }
    }

    /// Sets the shortest time between two messages (object 1015h has it in 0.1 ms).
    pub const fn set_inhibit(&mut self, inhibit: Periods) {
        self.inhibit = inhibit;
    }

    /// Object 1001h.
    #[must_use]
    pub const fn register(&self) -> u8 {
        self.register
    }

    /// Records a new error and queues its message. If too many messages wait, the oldest of them is never sent; the
    /// history still has its error.
    pub fn raise(&mut self, error: Emcy) {
        self.register |= error.register | Emcy::GENERIC;
        let [low, high] = error.code.to_le_bytes();
        let [a, b, ..] = error.detail;
        let mut newer = u32::from_le_bytes([low, high, a, b]);
        for entry in &mut self.history {
            newer = core::mem::replace(entry, newer);
        }
        if usize::from(self.errors) < N {
            self.errors = self.errors.wrapping_add(1);
        }
        self.queue(Emcy {
            register: self.register,
            ..error
        });
    }

    /// The last error is gone. Queues one message about it.
    pub fn clear(&mut self) {
        if self.register != 0 {
            self.register = 0;
            self.queue(Emcy::GONE);
        }
    }

    fn queue(&mut self, message: Emcy) {
        if self.waiting.is_full() {
            let _ = self.waiting.pop_front();
        }
        let _ = self.waiting.push_back(message);
    }

    /// Counts the time `by`; the next [`EmcyProducer::poll`] may have a message.
    pub const fn elapse(&mut self, by: Periods) {
        self.rest = self.rest.minus(by);
    }

    /// The next message, once the inhibit time is over.
    pub fn poll(&mut self) -> Option<Frame> {
        if self.rest > Periods::new(0) {
            return None;
        }
        let message = self.waiting.pop_front()?;
        self.rest = self.inhibit;
        Some(message.frame(self.node))
    }

    /// Sub-index `sub` of 1003h. Sub-index 0 is the number of errors, 1 is the newest error. An entry holds the error
    /// code in its lower half and the first two detail bytes in its upper half.
    ///
    /// # Errors
    /// [`Abort::NoData`] where the history is shorter, [`Abort::NoSubIndex`] above its capacity.
    pub fn history(&self, sub: u8) -> Result<u32, Abort> {
        let Some(place) = usize::from(sub).checked_sub(1) else {
            return Ok(self.errors.into());
        };
        match self.history.get(place) {
            Some(entry) if sub <= self.errors => Ok(*entry),
            Some(_) => Err(Abort::NoData),
            None => Err(Abort::NoSubIndex),
        }
    }

    /// Writes sub-index `sub` of 1003h: the value 0 in sub-index 0 clears the history.
    ///
    /// # Errors
    /// [`Abort::Value`] for another value, [`Abort::ReadOnly`] for another sub-index.
    pub fn write_history(&mut self, sub: u8, value: u32) -> Result<(), Abort> {
        match (sub, value) {
            (0, 0) => {
                self.errors = 0;
                Ok(())
            }
            (0, _) => Err(Abort::Value),
            _ => Err(Abort::ReadOnly),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_told_once_and_so_is_its_end() {
        let mut producer = EmcyProducer::<4>::new(NodeId::BOARD);
        assert_eq!(producer.poll(), None);
        producer.raise(Emcy::of_alarm(317));
        assert_eq!(producer.register(), 0x81);
        let frame = producer.poll().unwrap();
        assert_eq!(frame.id().get(), 0x081);
        assert_eq!(frame.payload(), [0x00, 0xFF, 0x81, 0x3D, 0x01, 0, 0, 0]);
        assert_eq!(producer.poll(), None);
        producer.clear();
        assert_eq!(producer.register(), 0);
        assert_eq!(producer.poll().unwrap().payload(), [0; 8]);
        producer.clear();
        assert_eq!(producer.poll(), None);
    }

    #[test]
    fn the_history_has_the_newest_first() {
        let mut producer = EmcyProducer::<2>::new(NodeId::BOARD);
        assert_eq!(producer.history(0), Ok(0));
        assert_eq!(producer.history(1), Err(Abort::NoData));
        assert_eq!(producer.history(3), Err(Abort::NoSubIndex));
        for alarm in [1, 2, 3] {
            producer.raise(Emcy::of_alarm(alarm));
        }
        assert_eq!(producer.history(0), Ok(2));
        assert_eq!(producer.history(1), Ok(0x0003_FF00));
        assert_eq!(producer.history(2), Ok(0x0002_FF00));
        assert_eq!(producer.write_history(0, 1), Err(Abort::Value));
        assert_eq!(producer.write_history(1, 0), Err(Abort::ReadOnly));
        assert_eq!(producer.write_history(0, 0), Ok(()));
        assert_eq!(producer.history(0), Ok(0));
        // The error itself is still there.
        assert_eq!(producer.register(), 0x81);
    }

    #[test]
    fn messages_keep_their_distance() {
        let mut producer = EmcyProducer::<8>::new(NodeId::BOARD);
        producer.set_inhibit(Periods::new(10));
        for alarm in 1..=6 {
            producer.raise(Emcy::of_alarm(alarm));
        }
        // The first two messages were dropped from the full queue.
        for alarm in 3..=6 {
            assert_eq!(producer.poll().unwrap().payload()[3], alarm);
            producer.elapse(Periods::new(9));
            assert_eq!(producer.poll(), None);
            producer.elapse(Periods::new(1));
        }
        assert_eq!(producer.poll(), None);
        assert_eq!(producer.history(0), Ok(6));
    }
}
