//! The board at the other end of a bus: what this side sends and hears.
//!
//! ```text
//! trouble   what can go wrong, in words        board    orders, objects with a type
//! presence  that this side lives, under a number of its own
//! transfer  SDO transfers of whole values      feed     a program in batches, as the board has room
//! params    a parameter set as a transaction   inside   a simulated board in this process, as a bus
//! hold      the hold that waits for nothing    round_trip  what an answer takes
//! ```
//!
//! A [`Link`] is one end of a bus and one board on it. Whatever it waits for, it hears everything meanwhile: statuses,
//! emergencies and heartbeats are kept in [`Seen`]. Time is the real one; nothing here is needed for a setpoint.

#[cfg(test)]
pub(crate) mod bench;
mod board;
mod feed;
mod hold;
mod inside;
mod params;
mod presence;
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
    BoardPlace, BoardSpindle, BoardStatus, CobId, Emcy, Frame, NmtCommand, NmtState, NodeId,
    Service,
};

use hold::Hold;
use round_trip::RoundTrip;

pub use board::BoardParams;
pub use feed::Feed;
pub use inside::Inside;
pub use traffic::Traffic;
pub use trouble::{LinkResult, Trouble, reason};

/// The board may be silent for so long before it counts as lost; a status comes every few milliseconds. Nothing moves
/// by this time, and a computer may stand still for seconds: at either end of the line [D178].
const SILENCE: Duration = Duration::from_secs(5);
/// Emergencies kept until somebody asks.
const EMERGENCIES: usize = 64;
/// The longest wait for a frame at a time: whoever wants the machine held is not kept waiting. Where this side stood still
/// meanwhile, no more than this counts as listened to.
const GLANCE: Duration = Duration::from_millis(50);

/// What has been heard from the board.
#[derive(Debug, Default)]
pub struct Seen {
    /// Its newest TPDO1.
    pub status: Option<BoardStatus>,
    /// How many of them there were.
    pub statuses: u64,
    /// Its newest TPDO2.
    pub place: Option<BoardPlace>,
    /// Its newest TPDO3.
    pub spindle: Option<BoardSpindle>,
    /// Its NMT state by its last heartbeat, or by what somebody has told it since.
    pub state: Option<NmtState>,
    /// It has started anew so many times.
    pub boots: u32,
    /// Emergency messages nobody has asked for yet.
    pub emergencies: VecDeque<Emcy>,
    /// Every node that said anything.
    pub nodes: BTreeSet<u8>,
    /// What has gone over the wire.
    pub traffic: Traffic,
    /// When the board was heard last.
    pub last: Option<Instant>,
    /// When somebody else was heard with this side's own number.
    namesake: Option<Instant>,
    /// When another client's transfer with the board was heard. What this side asks it does not hear.
    other_client: Option<Instant>,
    /// Answers of the board's SDO server are for this side.
    own_transfer: bool,
}

impl Seen {
    fn note(&mut self, frame: &Frame, board: NodeId, own: NodeId) {
        if let Some((command, node)) = NmtCommand::decode(frame)
            && node.is_none_or(|node| node == board)
        {
            self.state = match command {
                NmtCommand::Start => Some(NmtState::Operational),
                NmtCommand::Stop => Some(NmtState::Stopped),
                NmtCommand::PreOperational => Some(NmtState::PreOperational),
                // It says so itself, by its boot-up message.
                NmtCommand::ResetNode | NmtCommand::ResetCommunication => self.state,
            };
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
            // What others say to the board is no sign of life.
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

/// What a link hears: all that the board says and is told, and who else is there.
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
    /// This side's number.
    own: NodeId,
    began: Instant,
    packets: Vec<Received>,
    health: Health,
    beat: Option<Beat>,
    /// For an answer of the board.
    patience: Duration,
    /// The next transfer belongs to the one before: no other client is let in between.
    keeps_turn: bool,
    /// The last transfer was spoilt by another client.
    disturbed: bool,
    /// When this side began to hear the bus.
    opened: Instant,
    /// When its last transfer ended.
    turn_ended: Instant,
    /// How many there were, and since when, without a silence in which somebody who waits would have come.
    turns: u32,
    turns_since: Instant,
    /// What an answer of the board takes.
    round_trip: RoundTrip,
    /// How long this side has listened in all.
    listened: Duration,
    /// The hold that waits for nothing.
    hold: Hold,
    /// What has been heard.
    pub seen: Seen,
}

impl std::fmt::Debug for Link {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Link({} on {})", self.node.get(), self.bus)
    }
}

impl Link {
    /// Opens a bus, an adapter at this bit rate; nothing is said on it yet. Heard is what the board says and is told, and
    /// who else is there: setpoints and drives' answers are most of what is on a bus, mean nothing here, and would keep the
    /// answers waiting.
    ///
    /// # Errors
    /// What is missing for it.
    pub fn open(address: &Address, node: NodeId, rate: BitRate) -> LinkResult<Self> {
        let mut can = leadscrew_can::open(address, rate).map_err(Trouble::Can)?;
        can.listen_for(&heard(node)).map_err(Trouble::Can)?;
        Ok(Self::on(can, node))
    }

    /// The same on a bus that is open.
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
            seen: Seen::default(),
        }
    }

    /// How long an answer may take.
    pub const fn set_patience(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// What the user called the bus.
    #[must_use]
    pub fn bus(&self) -> &str {
        &self.bus
    }

    /// The board's number.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// What the bus looks like from its error frames.
    #[must_use]
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// Frames lost at this end because nobody took them in time.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.can.dropped().unwrap_or(0)
    }

    /// Hears the statuses of other boards, too, from now on, and what they are asked.
    ///
    /// # Errors
    /// The bus does not take it.
    pub fn hear_boards(&mut self) -> LinkResult {
        let [nmt, own, beats, answers] = heard(self.node);
        let statuses = Filter::service(Service::Tpdo1);
        let requests = Filter::service(Service::SdoRequest);
        self.can
            .listen_for(&[nmt, own, beats, answers, statuses, requests])
            .map_err(Trouble::Can)
    }

    /// Hears everything on the bus from now on.
    ///
    /// # Errors
    /// The bus does not take it.
    pub fn hear_everything(&mut self) -> LinkResult {
        self.can.listen_for(&[]).map_err(Trouble::Can)
    }

    /// Says that this side is alive from now on; the board watches for it.
    pub fn keep_alive(&mut self, every: Duration) {
        self.beat = Some(Beat {
            every,
            next: Instant::now(),
        });
    }

    /// Sends frames; the hold before them, where it is wanted.
    ///
    /// # Errors
    /// The bus is gone.
    pub fn send(&mut self, frames: &[Frame]) -> LinkResult {
        self.hold_at_once()?;
        self.put(frames)
    }

    fn put(&mut self, frames: &[Frame]) -> LinkResult {
        self.can.send(frames).map_err(Trouble::Can)
    }

    /// Lets the board start to say and hear process data.
    ///
    /// # Errors
    /// The bus is gone.
    pub fn start_node(&mut self) -> LinkResult {
        // What it was in before is over; its next heartbeat says what it is in.
        self.seen.state = None;
        self.send(&[NmtCommand::Start.frame(Some(self.node))])
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// Listens until `until`, or until `each` has heard enough: it is shown every frame and says so. True where it did.
    ///
    /// # Errors
    /// The bus is gone.
    pub fn listen(
        &mut self,
        until: Instant,
        each: &mut dyn FnMut(&Frame) -> bool,
    ) -> LinkResult<bool> {
        loop {
            self.hold_at_once()?;
            let now = Instant::now();
            if let Some(beat) = &mut self.beat
                && now >= beat.next
            {
                beat.next = now + beat.every;
                self.send(&[NmtState::Operational.frame(self.own)])?;
            }
            let wake = self.beat.map_or(until, |beat| beat.next.min(until));
            let patience = wake.saturating_duration_since(now).min(GLANCE);
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

    /// Listens for a while.
    ///
    /// # Errors
    /// The bus is gone.
    pub fn idle(&mut self, time: Duration) -> LinkResult {
        self.listen(Instant::now() + time, &mut |_| false)
            .map(|_| ())
    }

    /// Hears what has come already, however much that is, and shows every frame to `each`. A status that comes first is
    /// perhaps an old one.
    ///
    /// # Errors
    /// The bus is gone.
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

    /// The board has said nothing for too long, and nothing of it waits to be heard; or somebody has stopped it, and it
    /// says nothing but heartbeats.
    ///
    /// # Errors
    /// [`Trouble::Lost`], [`Trouble::Stopped`]; the bus is gone.
    pub fn check_alive(&mut self) -> LinkResult {
        if self.seen.state == Some(NmtState::Stopped) {
            return Err(Trouble::Stopped {
                node: self.node.get(),
                bus: self.bus.clone(),
            });
        }
        let is_silent = |last: Option<Instant>| last.is_some_and(|at| at.elapsed() > SILENCE);
        if is_silent(self.seen.last) {
            // It was perhaps this side that stood still.
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

    /// That the board has started again in the middle of something.
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
