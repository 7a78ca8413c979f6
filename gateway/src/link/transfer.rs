//! Transfers of whole values to and from objects of the board and of the drives.
//!
//! The board has one SDO server. A second client on the bus (`status` while `run` feeds) takes it away in the middle of a
//! transfer. So clients listen for each other and take turns [D111], [D198]. Before its next transfer a client waits for
//! silence: longest after its own transfer or when it has just come, less long after the transfer of another, and shortest
//! after it was disturbed. A request without any answer, with no other client heard, is repeated four times and is then an
//! error.
//!
//! Time in which this side did not listen is no silence: where this process stood still, the frames that came meanwhile are
//! read before the board counts as late [D178].

use std::time::{Duration, Instant};

use leadscrew_core::bus::{
    Abort, CobId, Frame, NmtState, NodeId, Object, SdoDownload, SdoError, SdoProtocol, SdoSink,
    SdoUpload, Service,
};

use super::{Link, LinkResult, Trouble};

/// Tries where frames get lost and no other client is heard.
const TRIES: u32 = 12;
/// A request is an error after so many silences.
const SILENCES: u32 = 5;
/// Where another client was heard in every transfer of a value, the value counts as refused only after so many refusals.
const REFUSALS: u32 = 5;
/// Another client's transfer is over this long after its last request. A client that was disturbed then goes on. This time
/// and the next three grow with the time of an answer: on a busy computer or a slow wire an answer takes longer than they
/// are, and clients would break into each other's transfers for ever [D178].
const QUIET: Duration = Duration::from_millis(8);
/// A client that has heard the turn of another waits this much longer, and leaves the first turn to a disturbed client. A
/// client after its own turn waits twice this much. It is longer than the jitter, so the order never depends on chance.
const YIELD: Duration = Duration::from_millis(8);
/// A client that hears no other may have transfers for this long, and so many, without a silence in which a waiting client
/// could begin.
const SHARE: Duration = Duration::from_millis(100);
const SHARE_TRANSFERS: u32 = 32;
/// Clients that wait equally long would collide again, so each adds up to this time.
const JITTER: Duration = Duration::from_millis(8);
/// Frames of a block that are handed over at a time. On a slow wire the wait for an answer begins when the last of them has
/// found room.
const AT_ONCE: usize = 16;
/// The longest wait for silence. Another client that never pauses is interrupted.
const TURN: Duration = Duration::from_millis(300);
/// With slow answers the wait is at most this much longer.
const SLOW_TURN: Duration = Duration::from_millis(600);
/// Another client that was heard within this time may be waiting for its turn.
const PRESENT: Duration = Duration::from_secs(1);
/// Where another client was heard in a transfer and no answer comes within this time, the answer went to the other client.
const SPOILT: Duration = Duration::from_millis(60);
/// Answers to a broken transfer may still come for this long.
const STALE: Duration = Duration::from_millis(10);
/// With other clients in the way a transfer may take this long.
const CONTENTION: Duration = Duration::from_secs(60);
/// The longest value that can be read.
const LONGEST: usize = 1 << 20;

/// A transfer in either direction.
trait Transfer {
    fn poll(&mut self, now: Duration) -> Option<Frame>;
    fn receive(&mut self, frame: &Frame, now: Duration);
    fn outcome(&self) -> Option<Result<(), SdoError>>;
    fn deadline(&self) -> Duration;
}

impl<S: SdoSink + ?Sized> Transfer for SdoUpload<'_, S> {
    fn poll(&mut self, now: Duration) -> Option<Frame> {
        self.poll(now)
    }
    fn receive(&mut self, frame: &Frame, now: Duration) {
        self.receive(frame, now);
    }
    fn outcome(&self) -> Option<Result<(), SdoError>> {
        self.outcome()
    }
    fn deadline(&self) -> Duration {
        self.deadline()
    }
}

impl Transfer for SdoDownload<'_> {
    fn poll(&mut self, now: Duration) -> Option<Frame> {
        self.poll(now)
    }
    fn receive(&mut self, frame: &Frame, now: Duration) {
        self.receive(frame, now);
    }
    fn outcome(&self) -> Option<Result<(), SdoError>> {
        self.outcome()
    }
    fn deadline(&self) -> Duration {
        self.deadline()
    }
}

/// Received bytes.
#[derive(Debug, Default)]
struct Bytes(Vec<u8>);

impl SdoSink for Bytes {
    fn begin(&mut self, size: Option<u32>) -> Result<(), Abort> {
        self.0.clear();
        match size {
            Some(size) if size as usize > LONGEST => Err(Abort::OutOfMemory),
            _ => Ok(()),
        }
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), Abort> {
        if self.0.len() + bytes.len() > LONGEST {
            return Err(Abort::OutOfMemory);
        }
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}

/// True where frames were lost or the transfer of another client came in between, so that a new try may succeed.
const fn may_go_better(error: SdoError) -> bool {
    match error {
        SdoError::Broken(_) | SdoError::TimedOut => true,
        SdoError::Refused(_) => matches!(
            error.abort(),
            Some(
                Abort::Toggle
                    | Abort::TimedOut
                    | Abort::Specifier
                    | Abort::BlockSize
                    | Abort::Sequence
                    | Abort::Crc
                    | Abort::NoConnection
            )
        ),
    }
}

impl Link {
    /// Reads an object.
    ///
    /// # Errors
    /// [`Trouble::Transfer`]; the bus is closed.
    pub fn read(&mut self, object: Object) -> LinkResult<Vec<u8>> {
        self.read_of(self.node, object)
    }

    /// Reads an object of any node.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_of(&mut self, node: NodeId, object: Object) -> LinkResult<Vec<u8>> {
        let protocol = match object.index {
            // Domains. The server uses the short protocol for short values.
            0x5000..0x6000 => SdoProtocol::Block,
            _ => SdoProtocol::Short,
        };
        let mut bytes = Bytes::default();
        self.again(node, object, false, |link| {
            let (patience, now) = (link.patience, link.now());
            link.carry(&mut SdoUpload::new(
                node, object, &mut bytes, protocol, patience, now,
            ))
        })?;
        Ok(bytes.0)
    }

    /// Asks a node once. `None` where it does not answer with a value.
    ///
    /// # Errors
    /// The bus is closed.
    pub(super) fn ask_once(
        &mut self,
        node: NodeId,
        object: Object,
        patience: Duration,
    ) -> LinkResult<Option<Vec<u8>>> {
        let (mut bytes, now) = (Bytes::default(), self.now());
        let outcome = self.carry(&mut SdoUpload::new(
            node,
            object,
            &mut bytes,
            SdoProtocol::Short,
            patience,
            now,
        ))?;
        Ok(outcome.is_ok().then_some(bytes.0))
    }

    /// Reads an object with a number of up to 8 bytes, as unsigned.
    ///
    /// # Errors
    /// As [`read`](Self::read), and [`Trouble::Strange`] for another length.
    pub fn read_number(&mut self, object: Object) -> LinkResult<u64> {
        let bytes = self.read(object)?;
        let mut raw = [0; 8];
        match raw.get_mut(..bytes.len()) {
            Some(place) if !bytes.is_empty() => place.copy_from_slice(&bytes),
            _ => return Err(self.strange(object)),
        }
        Ok(u64::from_le_bytes(raw))
    }

    /// Writes an object.
    ///
    /// # Errors
    /// [`Trouble::Transfer`]; the bus is closed.
    pub fn write(&mut self, object: Object, data: &[u8]) -> LinkResult {
        self.write_of(self.node, object, data)
    }

    /// Writes an object of any node.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_of(&mut self, node: NodeId, object: Object, data: &[u8]) -> LinkResult {
        // A value that does not fit into one frame has a checksum, so segments of other clients do not get into it.
        let protocol = if data.len() > 4 {
            SdoProtocol::Block
        } else {
            SdoProtocol::Short
        };
        self.again(node, object, true, |link| {
            let (patience, now) = (link.patience, link.now());
            link.carry(&mut SdoDownload::new(
                node, object, data, protocol, patience, now,
            ))
        })
    }

    pub(super) fn strange(&self, object: Object) -> Trouble {
        Trouble::Strange {
            node: self.node.get(),
            object,
        }
    }

    fn again(
        &mut self,
        node: NodeId,
        object: Object,
        write: bool,
        mut once: impl FnMut(&mut Self) -> LinkResult<Result<(), SdoError>>,
    ) -> LinkResult {
        let begun = Instant::now();
        let mut tries = 0;
        let mut silences = 0;
        let mut refusals = 0;
        loop {
            if !std::mem::take(&mut self.keeps_turn) {
                self.wait_for_turn()?;
            }
            let attempt = Instant::now();
            let error = match once(self)? {
                Ok(()) => {
                    self.disturbed = false;
                    return Ok(());
                }
                Err(error) => error,
            };
            if node == self.node && self.seen.state == Some(NmtState::Stopped) {
                // Before every try.
                self.check_alive()?;
            }
            let spoilt = self.seen.other_client.is_some_and(|last| last > attempt);
            let over = if spoilt {
                begun.elapsed() > CONTENTION
            } else {
                tries += 1;
                silences += u32::from(error == SdoError::TimedOut);
                tries == TRIES || silences == SILENCES
            };
            let again = may_go_better(error) || {
                // A frame of another client may have been taken for a piece of this value, which was then refused.
                refusals += 1;
                spoilt && refusals < REFUSALS
            };
            if over || !again {
                // A board that has fallen silent or was stopped is reported as such, not as a failed transfer.
                self.check_alive()?;
                return Err(Trouble::Transfer {
                    node: node.get(),
                    object,
                    write,
                    error,
                });
            }
            self.disturbed = true;
            // Late answers to the broken transfer must not count for the next one.
            self.seen.own_transfer = true;
            let idled = self.idle(STALE);
            self.seen.own_transfer = false;
            idled?;
        }
    }

    /// A time from zero to [`JITTER`], different for every client and every call.
    fn jitter(&self) -> Duration {
        let seed = u64::from(std::process::id()) << 32 | u64::from(self.now().subsec_nanos());
        // The upper half of a product with an odd number depends on all bits of the lower half.
        let mixed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let span = u64::try_from((JITTER + self.round_trip.reckoned()).as_micros()).unwrap_or(1);
        Duration::from_micros(mixed % span)
    }

    /// Lets other clients finish and have their turn, but not for ever. A disturbed client comes first, then a client that
    /// has heard another's transfer after its own, then the client of the last transfer. A client that hears no other
    /// cannot know whether one waits, so from time to time it leaves enough silence for it [D198].
    pub(super) fn wait_for_turn(&mut self) -> LinkResult {
        let begun = Instant::now();
        let round_trip = self.round_trip.reckoned();
        let quiet = QUIET + round_trip * 2 + self.jitter();
        let step = YIELD + round_trip * 2;
        let share = (SHARE + round_trip * 10).min(SLOW_TURN);
        let end = begun + TURN + (round_trip * 10 + quiet + step * 2).min(SLOW_TURN);
        self.idle(Duration::ZERO)?;
        loop {
            let present = |last: &Instant| last.elapsed() < PRESENT;
            let (last, steps) = match self.seen.other_client.filter(present) {
                Some(last) if self.disturbed => (last.max(self.turn_ended), 0),
                Some(last) if last > self.turn_ended => (last, 1),
                Some(_) => (self.turn_ended, 2),
                None if self.turns >= SHARE_TRANSFERS || self.turns_since.elapsed() >= share => {
                    (self.turn_ended, 2)
                }
                // A client that has just come does not know the others yet.
                None if self.seen.other_client.is_none() => (self.opened, 2),
                None => return Ok(()),
            };
            let wanted = quiet + step * steps;
            if last.elapsed() >= wanted || Instant::now() >= end {
                if self.turn_ended.elapsed() >= wanted {
                    (self.turns, self.turns_since) = (0, Instant::now());
                }
                return Ok(());
            }
            self.idle(Duration::from_millis(1))?;
        }
    }

    /// Carries a transfer to its end.
    fn carry(&mut self, transfer: &mut dyn Transfer) -> LinkResult<Result<(), SdoError>> {
        self.seen.own_transfer = true;
        let outcome = self.carry_on(transfer);
        self.seen.own_transfer = false;
        self.turn_ended = Instant::now();
        self.turns += 1;
        outcome
    }

    fn carry_on(&mut self, transfer: &mut dyn Transfer) -> LinkResult<Result<(), SdoError>> {
        let attempt = Instant::now();
        let mut out = Vec::new();
        // The transfer's time goes on while this side listens.
        let mut clock = self.now();
        let mut asked = None;
        let answers = CobId::of(Service::SdoReply, self.node);
        loop {
            let frames = std::iter::from_fn(|| transfer.poll(clock));
            out.extend(frames.take(AT_ONCE));
            if !out.is_empty() {
                self.send(&out)?;
                out.clear();
                asked = Some(self.listened);
                continue;
            }
            if let Some(outcome) = transfer.outcome() {
                return Ok(outcome);
            }
            // Just after the deadline, so that the transfer itself ends by timeout.
            let (before, since) = (clock, Instant::now());
            let left = transfer.deadline().saturating_sub(before);
            let mut until = since + left + Duration::from_millis(1);
            let spoilt = self.seen.other_client.filter(|last| *last > attempt);
            if let Some(last) = spoilt {
                until = until.min(last + SPOILT + self.round_trip.reckoned() * 4);
            }
            let requests = CobId::of(Service::SdoRequest, self.node);
            let mut answered = false;
            let enough = self.listen(until, &mut |frame| {
                clock = before + since.elapsed();
                answered |= frame.id() == answers;
                transfer.receive(frame, clock);
                out.extend(transfer.poll(clock));
                let over = !out.is_empty() || transfer.outcome().is_some();
                over || frame.id() == requests || answered && asked.is_some()
            })?;
            if answered && let Some(asked) = asked.take() {
                self.round_trip.note(self.listened - asked);
            }
            if !enough {
                clock = before + since.elapsed();
                if spoilt.is_some() && transfer.outcome().is_none() && out.is_empty() {
                    // The answers may only be slower than expected.
                    let slower = self.round_trip.reckoned() * 2 + Duration::from_millis(1);
                    // Twice, because a single slow answer does not count.
                    self.round_trip.note(slower);
                    self.round_trip.note(slower);
                    return Ok(Err(SdoError::TimedOut));
                }
            }
        }
    }

    /// Reads an object and counts the answers: several nodes may have the board's number. Answers to a request of another
    /// client do not count.
    ///
    /// # Errors
    /// The bus is closed.
    pub(super) fn answers(&mut self, object: Object) -> LinkResult<usize> {
        let node = self.node;
        let [low, high] = object.index.to_le_bytes();
        let asked = [0x40, low, high, object.sub, 0, 0, 0, 0];
        let request = Frame::new(CobId::of(Service::SdoRequest, node), &asked);
        self.wait_for_turn()?;
        self.seen.own_transfer = true;
        let count = self.count_answers(object, request);
        self.seen.own_transfer = false;
        self.turn_ended = Instant::now();
        count
    }

    fn count_answers(&mut self, object: Object, request: Option<Frame>) -> LinkResult<usize> {
        let [low, high] = object.index.to_le_bytes();
        self.send(request.as_slice())?;
        let (questions, reply) = (
            CobId::of(Service::SdoRequest, self.node),
            CobId::of(Service::SdoReply, self.node),
        );
        let (mut count, mut others) = (0_usize, 0);
        let mut heard = |frame: &Frame| {
            let same = frame.payload().get(1..4) == Some(&[low, high, object.sub]);
            others += usize::from(same && frame.id() == questions);
            let answer = same && frame.id() == reply;
            count += usize::from(answer);
            answer
        };
        let until = Instant::now() + self.patience;
        if !self.listen(until, &mut heard)? {
            return Ok(0);
        }
        // A second answer comes soon after the first.
        let until = Instant::now() + Duration::from_millis(30);
        self.listen(until, &mut |frame| {
            heard(frame);
            false
        })?;
        Ok(count.saturating_sub(others).max(1))
    }
}
