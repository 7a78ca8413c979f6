//! That this side lives, and who else is on the bus.
//!
//! A board misses its gateway by the heartbeats of one number. Two gateways with one number would stand in for each other:
//! a board would not notice that its own has died while that of the other board goes on. So whoever runs a program has a
//! number that nobody else on the bus has, and tells the board to watch that one (1016h) [D171].

use std::time::{Duration, Instant};

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{BoardStatus, Frame, HeartbeatWatch, NmtState, NodeId, Object};

use super::board::{LEADSCREW, PRODUCT};
use super::{Link, LinkResult, Trouble};

const WATCH: Object = Object::new(0x1016, 1);
const BEATS: Object = Object::new(0x1017, 0);
/// Heartbeats where the board does not say how often it wants them; never less often.
const BEAT: Duration = Duration::from_millis(100);
/// Whoever else has a number has been heard in this time.
const HEARD: Duration = Duration::from_millis(250);
/// The longest that others are listened for.
const LONGEST: Duration = Duration::from_secs(2);

impl Link {
    /// Says often enough that this side is alive.
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

    /// The same for as long as a program runs: the board misses this side, and nobody else in its place. The number that
    /// this side has taken comes back where it is another one than before; no drive of the board has it.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn attend_alone(&mut self, drives: &DriveNodes) -> LinkResult<Option<NodeId>> {
        let heard = self.opened + HEARD;
        self.listen(heard, &mut |_| false)?;
        let moved = self.step_aside(drives)?;
        if let Some(watch) = self.watch()?
            && watch.node != self.own
        {
            self.be_watched(watch)?;
        }
        self.attend()?;
        Ok(moved)
    }

    /// Takes another number where somebody else has been heard with this side's, and tells the board.
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
        // Gateways of different boards that begin at one time go different ways.
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

    /// Whom the board watches; `None`: nobody.
    fn watch(&mut self) -> LinkResult<Option<HeartbeatWatch>> {
        let raw = self.read_number(WATCH)?;
        Ok(u32::try_from(raw).ok().and_then(HeartbeatWatch::from_raw))
    }

    fn be_watched(&mut self, watch: HeartbeatWatch) -> LinkResult {
        let node = self.own;
        self.write(WATCH, &HeartbeatWatch { node, ..watch }.raw().to_le_bytes())
    }

    /// The other boards on the bus that say anything: those at work at once, the others with their heartbeats. A board that
    /// sends none is not found.
    ///
    /// # Errors
    /// The bus is gone.
    pub fn other_boards(&mut self) -> LinkResult<Vec<NodeId>> {
        // One may be lost, or late.
        let period = Duration::from_millis(self.read_number(BEATS)?) * 2 + BEAT;
        self.hear_boards()?;
        let until = Instant::now() + period.min(LONGEST);
        let (board, own) = (self.node, self.own);
        let mut nodes = std::collections::BTreeSet::new();
        self.listen(until, &mut |frame: &Frame| {
            let status = BoardStatus::decode(frame).map(|(node, _)| node);
            let beat = NmtState::decode(frame).map(|(node, _)| node);
            nodes.extend(status.or(beat));
            false
        })?;
        nodes.retain(|node| *node != board && *node != own && *node != NodeId::GATEWAY);
        // Another gateway beats, too, and answers nothing.
        self.set_patience(BEAT);
        let mut boards = Vec::new();
        for node in nodes {
            match self.read_of(node, PRODUCT) {
                Ok(bytes) if bytes == LEADSCREW.to_le_bytes() => boards.push(node),
                // Something else, or nothing that answers.
                Ok(_) | Err(Trouble::Transfer { .. }) => {}
                Err(trouble) => return Err(trouble),
            }
        }
        Ok(boards)
    }
}
