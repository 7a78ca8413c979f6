//! Heartbeats of this side, and the other nodes on the bus.
//!
//! A board supervises its gateway by the heartbeats of one node number. If two gateways had the same number, each would
//! stand in for the other: a board would not notice the death of its own gateway while the other gateway lives. So a
//! gateway that runs a program takes a number that no other node has, and tells the board to supervise this number (1016h)
//! [D171].

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use leadscrew_core::board::DriveNodes;
use leadscrew_core::board::device::PRODUCT;
use leadscrew_core::board::device::objects::{GATEWAY_WATCH, HEARTBEAT, PRODUCT_CODE};
use leadscrew_core::bus::{
    BoardStatus, CobId, Frame, HeartbeatWatch, NmtState, NodeId, Object, Service,
};

use super::{Link, LinkResult, Trouble};

/// Node numbers of the drives of X, Z, C and spindle 1, and the number of spindles.
const DRIVES: [Object; 5] = [
    Object::new(0x2000 + 9015, 1),
    Object::new(0x2000 + 9015, 2),
    Object::new(0x2000 + 9015, 3),
    Object::new(0x2000 + 9016, 0),
    Object::new(0x2000 + 9014, 0),
];
/// Heartbeat period where the board does not ask for one; never longer.
const BEAT: Duration = Duration::from_millis(100);
/// Any other node with a number is heard within this time.
const HEARD: Duration = Duration::from_millis(250);
/// The longest time of listening for others.
const LONGEST: Duration = Duration::from_secs(2);
/// After this time without a frame of a transfer with a node, no other client has a transfer with it, as on the board
/// itself [D111].
const ALONE: Duration = Duration::from_millis(24);
/// Questions to a node that does not answer: one of them may get lost.
const QUESTIONS: u32 = 2;
/// The wait for the answer to each of them.
const ANSWER: Duration = Duration::from_millis(500);

impl Link {
    /// Sends heartbeats often enough.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn attend(&mut self) -> LinkResult {
        let every = match self.watch()? {
            None => BEAT,
            Some(watch) => Duration::from_millis(watch.ms.into()) / 4,
        };
        self.keep_alive(every.min(BEAT));
        Ok(())
    }

    /// The same while a program runs: the board supervises this gateway and no other in its place. Returns the number of
    /// this side where it has changed; no drive of the board has this number.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn attend_alone(&mut self, drives: &DriveNodes) -> LinkResult<Option<NodeId>> {
        self.hear_gateways()?;
        let moved = self.step_aside(drives)?;
        if let Some(watch) = self.watch()?
            && watch.node != self.own
        {
            self.be_watched(watch)?;
        }
        self.attend()?;
        Ok(moved)
    }

    /// Listens until every other node with a number has been heard.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn hear_gateways(&mut self) -> LinkResult {
        let heard = self.opened + HEARD;
        self.listen(heard, &mut |_| false).map(|_| ())
    }

    /// Takes another number where another node was heard with this side's number, and tells the board.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn step_aside(&mut self, drives: &DriveNodes) -> LinkResult<Option<NodeId>> {
        let lately = |at: Instant| at.elapsed() < HEARD;
        if !self.seen.namesake.take().is_some_and(lately) {
            return Ok(None);
        }
        let free = |node: &NodeId| {
            *node != self.node
                && !self.seen.nodes.contains(&node.get())
                && drives.letter(*node).is_none()
        };
        // Gateways of different boards that start at the same time try different numbers.
        let down = (1..=126).rev();
        let from = down.clone().skip(usize::from(self.node.get()));
        let Some(own) = from.chain(down).filter_map(NodeId::new).find(free) else {
            return Ok(None);
        };
        self.own = own;
        if let Some(watch) = self.watch()? {
            self.be_watched(watch)?;
        }
        Ok(Some(own))
    }

    /// The node that the board supervises; `None`: none.
    fn watch(&mut self) -> LinkResult<Option<HeartbeatWatch>> {
        let raw = self.read_number(GATEWAY_WATCH)?;
        Ok(u32::try_from(raw).ok().and_then(HeartbeatWatch::from_raw))
    }

    fn be_watched(&mut self, watch: HeartbeatWatch) -> LinkResult {
        let node = self.own;
        self.write(
            GATEWAY_WATCH,
            &HeartbeatWatch { node, ..watch }.raw().to_le_bytes(),
        )
    }

    /// The other boards on the bus that send frames. Boards at work are known by their statuses, without a question. A node
    /// known by its heartbeat alone, which is no drive, is asked once no other client has a transfer with it. A board that
    /// always has a transfer, or sends no heartbeats, is not found [D171].
    ///
    /// # Errors
    /// The bus is closed.
    pub fn other_boards(&mut self) -> LinkResult<Vec<NodeId>> {
        let drives = self.drives()?;
        // One heartbeat may be lost or late.
        let period = Duration::from_millis(self.read_number(HEARTBEAT)?) * 2 + BEAT;
        self.hear_boards()?;
        let until = Instant::now() + period.min(LONGEST);
        let (mut boards, mut others) = (BTreeSet::new(), BTreeSet::new());
        let mut beating = BTreeSet::new();
        self.listen(until, &mut |frame: &Frame| {
            if let Some((node, _)) = BoardStatus::decode(frame) {
                boards.insert(node);
            } else if let Some((Service::Tpdo1, node)) = frame.id().service() {
                others.insert(node);
            } else if let Some((node, _)) = NmtState::decode(frame) {
                beating.insert(node);
            }
            false
        })?;
        let known = [self.node, self.own, NodeId::GATEWAY];
        boards.retain(|node| !known.contains(node) && !drives.contains(node));
        for node in beating {
            let is_told = known.contains(&node) || drives.contains(&node);
            if !is_told
                && !boards.contains(&node)
                && !others.contains(&node)
                && self.is_board(node)?
            {
                boards.insert(node);
            }
        }
        Ok(boards.into_iter().collect())
    }

    /// The drives of the board (9014–9016). For a board whose table has no such numbers: the drives known by their frames.
    fn drives(&mut self) -> LinkResult<BTreeSet<NodeId>> {
        let mut numbers = [0; 5];
        for (number, object) in numbers.iter_mut().zip(DRIVES) {
            *number = match self.read_number(object) {
                Ok(raw) => u8::try_from(raw).unwrap_or(0),
                Err(Trouble::Transfer { .. }) => 0,
                Err(trouble) => return Err(trouble),
            };
        }
        let [x, z, c, first, spindles] = numbers;
        let spindles = (0..spindles).map(|n| first.saturating_add(n));
        let all = [x, z, c].into_iter().chain(spindles);
        Ok(all.filter_map(NodeId::new).collect())
    }

    /// True where the node says that it is a board. It is asked only after a pause in its traffic, because a question takes
    /// its server away from a client with a transfer. Another gateway sends heartbeats too, and answers nothing.
    fn is_board(&mut self, node: NodeId) -> LinkResult<bool> {
        for _ in 0..QUESTIONS {
            if !self.wait_for_quiet(node)? {
                return Ok(false);
            }
            if let Some(product) = self.ask_once(node, PRODUCT_CODE, ANSWER)? {
                return Ok(product == PRODUCT.to_le_bytes());
            }
        }
        Ok(false)
    }

    /// Waits until this node has had no request and no answer for a while. False where this does not happen.
    fn wait_for_quiet(&mut self, node: NodeId) -> LinkResult<bool> {
        let talk = [Service::SdoRequest, Service::SdoReply].map(|one| CobId::of(one, node));
        let end = Instant::now() + LONGEST;
        while Instant::now() < end {
            let until = Instant::now() + ALONE;
            if !self.listen(until, &mut |frame| talk.contains(&frame.id()))? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests;
