//! Whole values to and from objects of the board, and of the drives.
//!
//! A second client on the bus (`status` while `run` feeds) takes the board's one SDO server away in the middle of a
//! transfer. So clients listen for each other and take turns [D111], [D198]: who has had the last transfer, or has only
//! just come, waits longer for silence than who has not, and that one longer than who has been disturbed. What is not
//! answered at all, without anybody else being heard, is asked four times more, and is an error then.
//!
//! What this side has not listened to is no silence: where it stood still itself, what came meanwhile is heard before the
//! board is late [D178].

use std::time::{Duration, Instant};

use leadscrew_core::bus::{
    Abort, CobId, Frame, NmtState, NodeId, Object, SdoDownload, SdoError, SdoProtocol, SdoSink,
    SdoUpload, Service,
};

use super::{Link, LinkResult, Trouble};

/// Tries where frames get lost and nobody else is heard.
const TRIES: u32 = 12;
/// Times that nothing comes until it is an error.
const SILENCES: u32 = 5;
/// Refusals until a value is refused for its own sake, where another client was heard in every transfer of it.
const REFUSALS: u32 = 5;
/// So long after another client's last request its transfer is over; somebody who has been disturbed goes on then. Like the
/// next three it is longer by what an answer takes: where a computer is busy, or a wire slow, that is more than they
/// are, and clients would break into each other's transfers for ever [D178].
const QUIET: Duration = Duration::from_millis(8);
/// Somebody who has heard another's turn leaves this much more to who has been disturbed, and who has had his own twice
/// this much: longer than the jitter, so that the one is never before the other by chance.
const YIELD: Duration = Duration::from_millis(8);
/// So long, and so many, one who hears nobody has transfers without a silence in which somebody who waits would come.
const SHARE: Duration = Duration::from_millis(100);
const SHARE_TRANSFERS: u32 = 32;
/// Clients that wait equally long would meet again: each adds up to this.
const JITTER: Duration = Duration::from_millis(8);
/// Frames of a block that are handed over at a time: on a slow wire, what is waited for an answer begins when the last of
/// them has found room.
const AT_ONCE: usize = 16;
/// The longest wait for silence: another client that never pauses is interrupted.
const TURN: Duration = Duration::from_millis(300);
/// And where answers are slow, so much longer at most.
const SLOW_TURN: Duration = Duration::from_millis(600);
/// Another client that has been heard so lately may be waiting for its turn.
const PRESENT: Duration = Duration::from_secs(1);
/// Where another client was heard in a transfer and no answer comes, the answer went to that one.
const SPOILT: Duration = Duration::from_millis(60);
/// For so long answers to a broken transfer may still come.
const STALE: Duration = Duration::from_millis(10);
/// With other clients in the way a transfer may take so long.
const CONTENTION: Duration = Duration::from_secs(60);
/// The longest value that is read.
const LONGEST: usize = 1 << 20;

/// A transfer of either direction.
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

/// Bytes as they come.
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

/// Frames were lost, or somebody else's transfer has come in between: it may go better the next time.
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
    /// [`Trouble::Transfer`]; the bus is gone.
    pub fn read(&mut self, object: Object) -> LinkResult<Vec<u8>> {
        self.read_of(self.node, object)
    }

    /// Reads an object of any node.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_of(&mut self, node: NodeId, object: Object) -> LinkResult<Vec<u8>> {
        let protocol = match object.index {
            // Domains; the server takes the short way for what is short.
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

    /// Asks a node once; `None` where it does not answer with a value.
    ///
    /// # Errors
    /// The bus is gone.
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

    /// Reads an object that is a number of up to 8 bytes, as unsigned.
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
    /// [`Trouble::Transfer`]; the bus is gone.
    pub fn write(&mut self, object: Object, data: &[u8]) -> LinkResult {
        self.write_of(self.node, object, data)
    }

    /// Writes an object of any node.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_of(&mut self, node: NodeId, object: Object, data: &[u8]) -> LinkResult {
        // What does not fit into one frame has a checksum: other clients' segments do not get into it.
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
                // However often it is asked.
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
                // A frame of somebody else may have been taken for a piece of this value, which is refused then.
                refusals += 1;
                spoilt && refusals < REFUSALS
            };
            if over || !again {
                // A board that says nothing at all any more, or that has been stopped, is more than a transfer that failed.
                self.check_alive()?;
                return Err(Trouble::Transfer {
                    node: node.get(),
                    object,
                    write,
                    error,
                });
            }
            self.disturbed = true;
            // What is still under way for the broken transfer may be answered: that is not for the next one.
            self.seen.own_transfer = true;
            let idled = self.idle(STALE);
            self.seen.own_transfer = false;
            idled?;
        }
    }

    /// A time between nothing and [`JITTER`], another one for every client and every call.
    fn jitter(&self) -> Duration {
        let seed = u64::from(std::process::id()) << 32 | u64::from(self.now().subsec_nanos());
        // The upper half of a product with an odd number depends on all of the lower.
        let mixed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let span = u64::try_from((JITTER + self.round_trip.reckoned()).as_micros()).unwrap_or(1);
        Duration::from_micros(mixed % span)
    }

    /// Lets other clients finish, and have their turn, but not for ever. Who has been disturbed comes first, then who has
    /// heard somebody else's transfer behind his own, then who has had the last one. One who hears nobody does not know
    /// whether somebody waits: now and then he leaves enough silence for that one [D198].
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
                // Whoever has only just come does not know yet who else is there.
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
            // Just beyond the deadline: then the transfer says itself that it is over.
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
                    // Perhaps it is only slower than was thought.
                    let slower = self.round_trip.reckoned() * 2 + Duration::from_millis(1);
                    // As it is meant: a single one would not count.
                    self.round_trip.note(slower);
                    self.round_trip.note(slower);
                    return Ok(Err(SdoError::TimedOut));
                }
            }
        }
    }

    /// Asks for a number and counts how many answer: more than one node may have the board's number. What answers somebody
    /// else's question of the same kind does not count.
    ///
    /// # Errors
    /// The bus is gone.
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
        // The second one is not far behind.
        let until = Instant::now() + Duration::from_millis(30);
        self.listen(until, &mut |frame| {
            heard(frame);
            false
        })?;
        Ok(count.saturating_sub(others).max(1))
    }
}
