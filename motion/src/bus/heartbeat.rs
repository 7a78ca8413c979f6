//! Heartbeats: produces those of this node (1017h), and watches those of other nodes (1016h).

use heapless::Vec;

use super::frame::{Frame, NodeId};
use super::nmt::NmtState;
use super::object::Abort;
use super::periods::Periods;

/// Says when the next heartbeat is due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeartbeatProducer {
    ms: u16,
    period: Periods,
    since: Periods,
}

impl HeartbeatProducer {
    /// A heartbeat every `ms` milliseconds (object 1017h) at a SYNC period of `tick_us` microseconds; 0 ms: none.
    #[must_use]
    pub fn new(ms: u16, tick_us: u32) -> Self {
        Self {
            ms,
            period: Periods::from_ms(ms.into(), tick_us).unwrap_or_default(),
            since: Periods::new(0),
        }
    }

    /// Object 1017h.
    #[must_use]
    pub const fn ms(&self) -> u16 {
        self.ms
    }

    /// Counts the time `by`. True where a heartbeat is due. A long time makes only one heartbeat due.
    pub fn elapse(&mut self, by: Periods) -> bool {
        if self.period == Periods::new(0) {
            return false;
        }
        self.since = self.since.plus(by);
        let due = self.since >= self.period;
        if due {
            self.since = Periods::new(0);
        }
        due
    }
}

/// An entry of object 1016h: a watched node and its heartbeat time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HeartbeatWatch {
    /// The watched node.
    pub node: NodeId,
    /// The longest time from one heartbeat to the next, in milliseconds.
    pub ms: u16,
}

impl HeartbeatWatch {
    /// The entry with this value; `None` for an entry that watches no node: a node number outside 1–127, or time 0.
    #[must_use]
    pub fn from_raw(raw: u32) -> Option<Self> {
        let [low, high, node, _] = raw.to_le_bytes();
        let ms = u16::from_le_bytes([low, high]);
        let node = NodeId::new(node)?;
        (ms > 0).then_some(Self { node, ms })
    }

    /// The value of the entry.
    #[must_use]
    pub const fn raw(self) -> u32 {
        let [low, high] = self.ms.to_le_bytes();
        u32::from_le_bytes([low, high, self.node.get(), 0])
    }
}

/// News in a heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HeartbeatEvent {
    /// The node's first heartbeat, or its first since the node was lost.
    Found(NmtState),
    /// The node has entered another state.
    Entered(NmtState),
    /// The node has restarted.
    Restarted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Watched {
    watch: HeartbeatWatch,
    limit: Periods,
    quiet: Periods,
    /// `None`: not heard yet, or lost. A node cannot be lost before its first heartbeat.
    state: Option<NmtState>,
}

/// Watches up to `N` nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeartbeatConsumer<const N: usize> {
    entries: [Option<Watched>; N],
}

impl<const N: usize> Default for HeartbeatConsumer<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> HeartbeatConsumer<N> {
    /// A consumer that watches no node.
    #[must_use]
    pub const fn new() -> Self {
        Self { entries: [None; N] }
    }

    /// Sets entry `entry`, from 0 (sub-index − 1 of 1016h), at a SYNC period of `tick_us` microseconds. `None` clears
    /// the entry.
    ///
    /// # Errors
    /// [`Abort::NoSubIndex`] where the entry does not exist, [`Abort::Incompatible`] where another entry has the same
    /// node.
    pub fn set(
        &mut self,
        entry: usize,
        watch: Option<HeartbeatWatch>,
        tick_us: u32,
    ) -> Result<(), Abort> {
        let twice = |watch: HeartbeatWatch| {
            self.entries.iter().enumerate().any(|(other, watched)| {
                other != entry && watched.is_some_and(|watched| watched.watch.node == watch.node)
            })
        };
        if watch.is_some_and(twice) {
            return Err(Abort::Incompatible);
        }
        *self.entries.get_mut(entry).ok_or(Abort::NoSubIndex)? = watch.map(|watch| Watched {
            watch,
            limit: Periods::from_ms(watch.ms.into(), tick_us).unwrap_or_default(),
            quiet: Periods::new(0),
            state: None,
        });
        Ok(())
    }

    /// Entry `entry`, from 0; `None` where it watches no node or does not exist.
    #[must_use]
    pub fn get(&self, entry: usize) -> Option<HeartbeatWatch> {
        Some(self.entries.get(entry)?.as_ref()?.watch)
    }

    /// The state of a watched node; `None` while its heartbeats do not come.
    #[must_use]
    pub fn state(&self, node: NodeId) -> Option<NmtState> {
        self.entries
            .iter()
            .flatten()
            .find(|watched| watched.watch.node == node)?
            .state
    }

    /// Takes a frame; gives the watched node that sent it, and the news about that node.
    pub fn receive(&mut self, frame: &Frame) -> Option<(NodeId, HeartbeatEvent)> {
        let (node, state) = NmtState::decode(frame)?;
        let watched = self
            .entries
            .iter_mut()
            .flatten()
            .find(|watched| watched.watch.node == node)?;
        watched.quiet = Periods::new(0);
        let before = watched.state.replace(state);
        let event = match (before, state) {
            (None, _) => HeartbeatEvent::Found(state),
            (Some(_), NmtState::BootUp) => HeartbeatEvent::Restarted,
            (Some(before), _) if before != state => HeartbeatEvent::Entered(state),
            _ => return None,
        };
        Some((node, event))
    }

    /// Counts the time `by`; gives the nodes that are lost from now on, each once.
    pub fn elapse(&mut self, by: Periods) -> Vec<NodeId, N> {
        let mut lost = Vec::new();
        for watched in self.entries.iter_mut().flatten() {
            if watched.state.is_none() {
                continue;
            }
            watched.quiet = watched.quiet.plus(by);
            if watched.quiet > watched.limit {
                watched.state = None;
                // Cannot fail: the list has a place for every entry.
                let _ = lost.push(watched.watch.node);
            }
        }
        lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_US: u32 = 1000;

    #[test]
    fn a_heartbeat_every_period() {
        let mut producer = HeartbeatProducer::new(3, TICK_US);
        let due = [(); 7].map(|()| producer.elapse(Periods::new(1)));
        assert_eq!(due, [false, false, true, false, false, true, false]);
        // A long pause makes only one heartbeat due.
        assert!(producer.elapse(Periods::new(100)));
        assert!(!producer.elapse(Periods::new(2)));
        assert!(!HeartbeatProducer::new(0, TICK_US).elapse(Periods::new(u32::MAX)));
    }

    #[test]
    fn entries_of_1016h() {
        let watch = HeartbeatWatch {
            node: NodeId::GATEWAY,
            ms: 500,
        };
        assert_eq!(watch.raw(), 0x007F_01F4);
        assert_eq!(HeartbeatWatch::from_raw(0x007F_01F4), Some(watch));
        for nobody in [0, 0x01F4, 0x0080_01F4, 0x007F_0000] {
            assert_eq!(HeartbeatWatch::from_raw(nobody), None);
        }
    }

    #[test]
    fn several_nodes_are_missed_each_in_its_time() {
        let mut consumer = HeartbeatConsumer::<3>::new();
        let (x, gateway) = (NodeId::DRIVE_X, NodeId::GATEWAY);
        let watch = |node, ms| Some(HeartbeatWatch { node, ms });
        assert_eq!(consumer.set(0, watch(x, 10), TICK_US), Ok(()));
        assert_eq!(consumer.set(2, watch(gateway, 20), TICK_US), Ok(()));
        assert_eq!(consumer.get(0), watch(x, 10));
        assert_eq!(consumer.get(1), None);
        assert_eq!(
            consumer.set(1, watch(x, 5), TICK_US),
            Err(Abort::Incompatible)
        );
        assert_eq!(
            consumer.set(3, watch(NodeId::DRIVE_Z, 5), TICK_US),
            Err(Abort::NoSubIndex)
        );
        // A node that never sent a heartbeat is not lost.
        assert!(consumer.elapse(Periods::new(1000)).is_empty());
        for node in [x, gateway] {
            assert_eq!(
                consumer.receive(&NmtState::Operational.frame(node)),
                Some((node, HeartbeatEvent::Found(NmtState::Operational)))
            );
        }
        let others = NmtState::Operational.frame(NodeId::DRIVE_Z);
        assert_eq!(consumer.receive(&others), None);
        assert!(consumer.elapse(Periods::new(10)).is_empty());
        assert_eq!(consumer.elapse(Periods::new(1)), [x]);
        assert_eq!(consumer.state(x), None);
        assert_eq!(consumer.state(gateway), Some(NmtState::Operational));
        assert_eq!(consumer.elapse(Periods::new(10)), [gateway]);
        assert!(consumer.elapse(Periods::new(1000)).is_empty());
        // Back again.
        assert_eq!(
            consumer.receive(&NmtState::BootUp.frame(x)),
            Some((x, HeartbeatEvent::Found(NmtState::BootUp)))
        );
    }

    #[test]
    fn changes_and_restarts_are_told_once() {
        let mut consumer = HeartbeatConsumer::<1>::new();
        let node = NodeId::GATEWAY;
        let watch = HeartbeatWatch { node, ms: 10 };
        assert_eq!(consumer.set(0, Some(watch), TICK_US), Ok(()));
        let mut hear = |state: NmtState| consumer.receive(&state.frame(node));
        assert!(hear(NmtState::PreOperational).is_some());
        assert_eq!(hear(NmtState::PreOperational), None);
        let entered = HeartbeatEvent::Entered(NmtState::Stopped);
        assert_eq!(hear(NmtState::Stopped), Some((node, entered)));
        assert_eq!(
            hear(NmtState::BootUp),
            Some((node, HeartbeatEvent::Restarted))
        );
    }
}
