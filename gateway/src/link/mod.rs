//! The board at the other end of a bus: the frames that this side sends and hears.
//!
//! ```text
//! trouble   errors, in words                   board    orders, objects with a type
//! presence  heartbeats of this side, under a number of its own
//! transfer  SDO transfers of whole values      feed     a program in batches, as the board has room
//! params    a parameter set as a transaction   inside   a simulated board in this process, as a bus
//! hold      the immediate hold                 round_trip  the time of an answer
//! operate   mode, beat, refusals           meanwhile  work that goes on while this side waits
//! ```
//!
//! A [`Link`] is one end of a bus and one board on it. It hears all frames while it waits: statuses, emergencies and
//! heartbeats are kept in [`Seen`]. Time is real time; no setpoint depends on it.

#[cfg(test)]
pub(crate) mod bench;
mod board;
mod feed;
mod hold;
mod inside;
mod meanwhile;
mod offsets;
mod operate;
mod params;
mod presence;
#[cfg(test)]
mod refusals;
mod round_trip;
#[cfg(test)]
mod tests;
mod traffic;
mod transfer;
mod trouble;

use std::collections::{BTreeSet, VecDeque};
use std::time::{Duration, Instant};

use leadscrew_can::{Address, BitRate, Can, Filter, Health, Received};
use leadscrew_core::bus::{
    BoardBeat, BoardPlace, BoardSpindle, BoardStatus, CobId, Emcy, Frame, NmtCommand, NmtState,
    NodeId, Service,
};

use hold::Hold;
use meanwhile::Meanwhile;
use round_trip::RoundTrip;

pub use board::BoardParams;
pub use feed::Feed;
pub use inside::Inside;
pub use offsets::BoardOffsets;
pub use operate::BY_MODE;
pub use traffic::Traffic;
pub use trouble::{LinkResult, Trouble, reason};

/// A board that is silent for this time counts as lost; a status comes every few milliseconds. No motion depends on this
/// time, and the computer at either end may stand still for seconds [D178].
const SILENCE: Duration = Duration::from_secs(5);
/// Emergency messages that are kept until they are read.
const EMERGENCIES: usize = 64;
/// The longest wait for one frame, so that a wanted hold is not delayed. Where this process stood still meanwhile, no more
/// than this counts as listening.
const GLANCE: Duration = Duration::from_millis(50);

/// Data heard from the board.
#[derive(Debug, Default)]
pub struct Seen {
    /// Its newest TPDO1.
    pub status: Option<BoardStatus>,
    /// Number of TPDO1s.
    pub statuses: u64,
    /// Its newest TPDO2.
    pub place: Option<BoardPlace>,
    /// Its newest TPDO3.
    pub spindle: Option<BoardSpindle>,
    /// Its newest TPDO5.
    pub beat: Option<BoardBeat>,
    /// Number of TPDO5s.
    pub beats: u64,
    /// Its NMT state by its last heartbeat, or by an NMT command since.
    pub state: Option<NmtState>,
    /// Number of its boot-up messages.
    pub boots: u32,
    /// Emergency messages that have not been read.
    pub emergencies: VecDeque<Emcy>,
    /// Every node that has sent a frame.
    pub nodes: BTreeSet<u8>,
    /// Traffic on the wire.
    pub traffic: Traffic,
    /// Time of the board's last frame.
    pub last: Option<Instant>,
    /// Time when another node was heard with this side's own number.
    namesake: Option<Instant>,
    /// Time of the last frame in a transfer between the board and another client. This side does not hear its own requests.
    other_client: Option<Instant>,
    /// True where answers of the board's SDO server are for this side.
    own_transfer: bool,
}

impl Seen {
    pub(crate) fn note(&mut self, frame: &Frame, board: NodeId, own: NodeId) {
        if let Some((command, node)) = NmtCommand::decode(frame)
            && node.is_none_or(|node| node == board)
        {
            self.state = match command {
                NmtCommand::Start => Some(NmtState::Operational),
                NmtCommand::Stop => Some(NmtState::Stopped),
                NmtCommand::PreOperational => Some(NmtState::PreOperational),
                // The node reports its new state by its boot-up message.
                NmtCommand::ResetNode | NmtCommand::ResetCommunication => self.state,
            };
        }
        if let Some(beat) = BoardBeat::decode(frame, board) {
            self.beat = Some(beat);
            self.beats += 1;
            self.last = Some(Instant::now());
            return;
        }
        let Some((_, node)) = frame.id().service() else {
            return;
        };
        self.nodes.insert(node.get());
        if let Some((from, state)) = NmtState::decode(frame) {
            if from == own {
                self.namesake = Some(Instant::now());
            }
            if from == board {
                self.state = Some(state);
                self.boots += u32::from(state == NmtState::BootUp);
                self.last = Some(Instant::now());
            }
            return;
        }
        if node != board {
            return;
        }
        if let Some((_, status)) = BoardStatus::decode(frame) {
            self.status = Some(status);
            self.statuses += 1;
        } else if let Some((_, place)) = BoardPlace::decode(frame) {
            self.place = Some(place);
        } else if let Some((_, spindle)) = BoardSpindle::decode(frame) {
            self.spindle = Some(spindle);
        } else if let Some((_, emcy)) = Emcy::decode(frame) {
            if self.emergencies.len() == EMERGENCIES {
                self.emergencies.pop_front();
            }
            self.emergencies.push_back(emcy);
        } else if let Some((Service::SdoRequest, _)) = frame.id().service() {
            self.other_client = Some(Instant::now());
            return;
        } else if let Some((Service::SdoReply, _)) = frame.id().service() {
            if !self.own_transfer {
                self.other_client = Some(Instant::now());
            }
        } else {
            // Frames of others to the board are no sign that the board lives.
            return;
        }
        self.last = Some(Instant::now());
    }
}

/// Heartbeats of this side.
#[derive(Clone, Copy, Debug)]
struct Beat {
    every: Duration,
    next: Instant,
}

/// Filters of a link: frames of the board, frames to the board, and the presence of other nodes.
fn heard(board: NodeId) -> [Filter; 4] {
    [
        Filter::exactly(CobId::NMT),
        Filter::node(board),
        Filter::service(Service::Heartbeat),
        Filter::service(Service::SdoReply),
    ]
}

/// One end of a bus, and a board on it.
pub struct Link {
    can: Box<dyn Can>,
    bus: String,
    node: NodeId,
    /// This side's node number.
    own: NodeId,
    began: Instant,
    packets: Vec<Received>,
    health: Health,
    beat: Option<Beat>,
    /// The longest wait for an answer of the board.
    patience: Duration,
    /// The next transfer belongs to the last one: no other client gets a turn in between.
    keeps_turn: bool,
    /// Another client has disturbed the last transfer.
    disturbed: bool,
    /// Time when this side opened the bus.
    opened: Instant,
    /// End of its last transfer.
    turn_ended: Instant,
    /// Number of transfers, and since when, without a silence in which a waiting client would have begun.
    turns: u32,
    turns_since: Instant,
    /// The time of an answer of the board.
    round_trip: RoundTrip,
    /// The time this side has listened in all.
    listened: Duration,
    /// The immediate hold.
    hold: Hold,
    /// Work that goes on while this side waits.
    meanwhile: Meanwhile,
    /// Data heard.
    pub seen: Seen,
}

impl std::fmt::Debug for Link {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Link({} on {})", self.node.get(), self.bus)
    }
}

impl Link {
    /// Opens a bus, an adapter at this bit rate; nothing is sent yet. This side hears the frames of the board, the frames
    /// to the board, and the presence of other nodes. Setpoints and answers of drives are most of the traffic; they mean
    /// nothing here and would delay the answers.
    ///
    /// # Errors
    /// A requirement of the bus is missing.
    pub fn open(address: &Address, node: NodeId, rate: BitRate) -> LinkResult<Self> {
        let mut can = leadscrew_can::open(address, rate).map_err(Trouble::Can)?;
        can.listen_for(&heard(node)).map_err(Trouble::Can)?;
        Ok(Self::on(can, node))
    }

    /// The same on an open bus.
    #[must_use]
    pub fn on(can: Box<dyn Can>, node: NodeId) -> Self {
        let now = Instant::now();
        Self {
            bus: can.name().to_owned(),
            can,
            node,
            own: NodeId::GATEWAY,
            began: now,
            packets: Vec::new(),
            health: Health::default(),
            beat: None,
            patience: Duration::from_secs(1),
            keeps_turn: false,
            disturbed: false,
            opened: now,
            turn_ended: now,
            turns: 0,
            turns_since: now,
            round_trip: RoundTrip::default(),
            listened: Duration::ZERO,
            hold: Hold::default(),
            meanwhile: Meanwhile::default(),
            seen: Seen::default(),
        }
    }

    /// Sets the longest wait for an answer.
    pub const fn set_patience(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// The user's name of the bus.
    #[must_use]
    pub fn bus(&self) -> &str {
        &self.bus
    }

    /// The board's node number.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// The state of the bus by its error frames.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Frames that were lost at this end because they were not read in time.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.can.dropped().unwrap_or(0)
    }

    /// Also hears the statuses of other boards and the requests to them from now on.
    ///
    /// # Errors
    /// The bus refuses it.
    pub fn hear_boards(&mut self) -> LinkResult {
        let [nmt, own, beats, answers] = heard(self.node);
        let statuses = Filter::service(Service::Tpdo1);
        let requests = Filter::service(Service::SdoRequest);
        self.can
            .listen_for(&[nmt, own, beats, answers, statuses, requests])
            .map_err(Trouble::Can)
    }

    /// Hears all frames on the bus from now on.
    ///
    /// # Errors
    /// The bus refuses it.
    pub fn hear_everything(&mut self) -> LinkResult {
        self.can.listen_for(&[]).map_err(Trouble::Can)
    }

    /// Sends heartbeats from now on. The board supervises them.
    pub fn keep_alive(&mut self, every: Duration) {
        self.beat = Some(Beat {
            every,
            next: Instant::now(),
        });
    }

    /// Sends frames; a wanted hold goes first.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn send(&mut self, frames: &[Frame]) -> LinkResult {
        self.hold_at_once()?;
        self.put(frames)
    }

    fn put(&mut self, frames: &[Frame]) -> LinkResult {
        self.can.send(frames).map_err(Trouble::Can)
    }

    /// Starts the board, so that it sends and takes process data.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn start_node(&mut self) -> LinkResult {
        // Its old state is over. Its next heartbeat tells the new one.
        self.seen.state = None;
        self.send(&[NmtCommand::Start.frame(Some(self.node))])
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// Listens until `until`, or until `each` returns true. `each` gets every frame. Returns true where `each` did.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn listen(
        &mut self,
        until: Instant,
        each: &mut dyn FnMut(&Frame) -> bool,
    ) -> LinkResult<bool> {
        loop {
            self.hold_at_once()?;
            self.go_on_meanwhile()?;
            let now = Instant::now();
            if let Some(beat) = &mut self.beat
                && now >= beat.next
            {
                beat.next = now + beat.every;
                self.send(&[NmtState::Operational.frame(self.own)])?;
            }
            let wake = self.beat.map_or(until, |beat| beat.next.min(until));
            let patience = wake.saturating_duration_since(now).min(self.glance());
            let mut packets = std::mem::take(&mut self.packets);
            packets.clear();
            let received = self.can.receive(&mut packets, patience);
            self.listened += now.elapsed().min(patience);
            let mut enough = false;
            for received in &packets {
                self.health.note(&received.packet);
                self.seen.traffic.count(&received.packet);
                if let Some(frame) = received.packet.frame() {
                    self.seen.note(frame, self.node, self.own);
                    enough |= each(frame);
                }
            }
            self.packets = packets;
            received.map_err(Trouble::Can)?;
            if enough {
                return Ok(true);
            }
            if Instant::now() >= until {
                return Ok(false);
            }
        }
    }

    /// Listens for this time.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn idle(&mut self, time: Duration) -> LinkResult {
        self.listen(Instant::now() + time, &mut |_| false)
            .map(|_| ())
    }

    /// Reads all frames that have arrived and shows each to `each`. The first status may be an old one.
    ///
    /// # Errors
    /// The bus is closed.
    fn hear_all(&mut self, each: &mut dyn FnMut(&Frame)) -> LinkResult {
        let mut heard = true;
        while heard {
            heard = false;
            self.listen(Instant::now(), &mut |frame| {
                heard = true;
                each(frame);
                false
            })?;
        }
        Ok(())
    }

    /// Checks that the board lives. It is lost after a long silence with no frame of it waiting. It is stopped where an NMT
    /// command has stopped it, so that it sends nothing but heartbeats.
    ///
    /// # Errors
    /// [`Trouble::Lost`], [`Trouble::Stopped`]; the bus is closed.
    pub fn check_alive(&mut self) -> LinkResult {
        if self.seen.state == Some(NmtState::Stopped) {
            return Err(Trouble::Stopped {
                node: self.node.get(),
                bus: self.bus.clone(),
            });
        }
        let is_silent = |last: Option<Instant>| last.is_some_and(|at| at.elapsed() > SILENCE);
        if is_silent(self.seen.last) {
            // Perhaps this process stood still, not the board.
            self.idle(Duration::ZERO)?;
        }
        if is_silent(self.seen.last) {
            return Err(Trouble::Lost {
                node: self.node.get(),
                bus: self.bus.clone(),
                suspicion: self.health.suspicion(),
            });
        }
        Ok(())
    }

    /// The trouble that the board has started again in the middle of its work.
    #[must_use]
    pub fn begun_anew(&self) -> Trouble {
        Trouble::Restarted {
            node: self.node.get(),
            bus: self.bus.clone(),
        }
    }

    fn silent(&self) -> Trouble {
        let mut nodes = self.seen.nodes.clone();
        nodes.remove(&self.node.get());
        nodes.remove(&NodeId::GATEWAY.get());
        Trouble::NoBoard {
            node: self.node.get(),
            bus: self.bus.clone(),
            stopped: self.seen.state == Some(NmtState::Stopped),
            others: nodes.into_iter().collect(),
            suspicion: self.health.suspicion(),
        }
    }
}
