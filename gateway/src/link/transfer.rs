//! Whole values to and from objects of the board, and of the drives.
//!
//! A second client on the bus (`status` while `run` feeds) takes the board's one SDO server away in the middle of a
//! transfer; then each begins anew after a pause of its own. What is not answered at all is asked twice more, and is an
//! error then.

use std::time::{Duration, Instant};

use leadscrew_core::bus::{
    Abort, CobId, Frame, NodeId, Object, SdoDownload, SdoError, SdoProtocol, SdoSink, SdoUpload,
    Service,
};

use super::{Link, LinkResult, Trouble};

/// Tries where somebody else is in the way.
const TRIES: u32 = 12;
/// So long after another client's last request its transfer is over.
const QUIET: Duration = Duration::from_millis(8);
/// The longest wait for that.
const TURN: Duration = Duration::from_millis(300);
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

/// Somebody else's transfer has come in between, or frames were lost: it may go better the next time.
const fn may_be_another_client(error: SdoError) -> bool {
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
        let protocol = if data.len() > 14 {
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
        let mut tries = 0;
        let mut silences = 0;
        loop {
            if !std::mem::take(&mut self.keeps_turn) {
                self.wait_for_silence()?;
            }
            let error = match once(self)? {
                Ok(()) => return Ok(()),
                Err(error) => error,
            };
            tries += 1;
            silences += u32::from(error == SdoError::TimedOut);
            if tries == TRIES || silences == 3 || !may_be_another_client(error) {
                // A board that says nothing at all any more is more than a transfer that failed.
                self.check_alive()?;
                return Err(Trouble::Transfer {
                    node: node.get(),
                    object,
                    write,
                    error,
                });
            }
            // Two clients that wait equally long would meet again.
            let pause =
                5 + u64::from(std::process::id() % 7) + u64::from(self.now().subsec_nanos() % 16);
            self.idle(Duration::from_millis(pause * u64::from(tries)))?;
        }
    }

    /// Lets another client finish, but not for ever.
    fn wait_for_silence(&mut self) -> LinkResult {
        let end = Instant::now() + TURN;
        self.idle(Duration::ZERO)?;
        while let Some(last) = self.seen.other_client
            && last.elapsed() < QUIET
            && Instant::now() < end
        {
            self.idle(Duration::from_millis(1))?;
        }
        Ok(())
    }

    /// Carries a transfer to its end.
    fn carry(&mut self, transfer: &mut dyn Transfer) -> LinkResult<Result<(), SdoError>> {
        let began = self.began;
        let mut out = Vec::new();
        loop {
            out.extend(std::iter::from_fn(|| transfer.poll(began.elapsed())));
            if !out.is_empty() {
                self.send(&out)?;
                out.clear();
            }
            if let Some(outcome) = transfer.outcome() {
                return Ok(outcome);
            }
            // Just beyond the deadline: then the transfer says itself that it is over.
            let until = began + transfer.deadline() + Duration::from_millis(1);
            self.listen(until, &mut |frame| {
                transfer.receive(frame, began.elapsed());
                out.extend(transfer.poll(began.elapsed()));
                !out.is_empty() || transfer.outcome().is_some()
            })?;
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
        let (questions, reply) = (
            CobId::of(Service::SdoRequest, node),
            CobId::of(Service::SdoReply, node),
        );
        self.send(request.as_slice())?;
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
