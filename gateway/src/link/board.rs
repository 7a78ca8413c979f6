//! Requests to a board, with types.

use std::time::{Duration, Instant};

use leadscrew_core::board::Interlocks;
use leadscrew_core::board::device::DROP;
use leadscrew_core::board::device::PRODUCT;
use leadscrew_core::board::device::objects::{
    BLOCK_INPUTS, BLOCK_OUTPUTS, CERTIFICATES, ERASES, EVENTS, EVENTS_FROM, IMAGE, LINK_VERSION,
    MACHINE_INPUTS, MACHINE_OUTPUTS, NEWEST_EVENT, PRODUCT_CODE, SERIAL_NUMBER, SET_CHECKSUM,
    SIGNALS, SOFTWARE_VERSION, START, STATUS_RECORD, TAP_DISCARD, TAP_RECORD, THREADS_TAKEN,
};
use leadscrew_core::bus::{Abort, BoardCommand, BoardStatus, Frame, NodeId, Object, Order};
use leadscrew_core::link::{
    Certificate, EventReader, ImageReader, Logged, Status, ThreadCertificate, ThreadReader,
    VERSION, Version, identity,
};
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;

use super::{Link, LinkResult, Trouble};
use crate::origin::BoardName;

/// A gap in the event log counts only after so many readings.
const LOG_TRIES: u32 = 5;
/// By default a status comes every 10 ms. Until one comes, the node is started so many times.
const STATUS: Duration = Duration::from_millis(500);
const FIRST_STATUS: Duration = Duration::from_millis(100);
const STARTS: usize = 10;
/// So many questions whether the board is there. Each waits for an answer.
const GREETINGS: u32 = 5;
/// Several boards are there if several answers come this many times.
const SEVERAL: u32 = 3;
/// An order is repeated after this time.
const REPEAT: Duration = Duration::from_millis(20);
/// An order without confirmation in this time has failed. The computer of a simulated board may stand still for seconds
/// [D178].
const CONFIRMED: Duration = Duration::from_secs(5);
/// A halt is ordered again so many times while another client orders too.
const HALT_TRIES: u32 = 5;

/// The parameter set of a board, and its identity.
#[derive(Clone, Debug)]
pub struct BoardParams {
    /// The parameter set.
    pub params: Params,
    /// CRC-32 of the set.
    pub identity: u32,
}

impl Link {
    /// Checks that exactly one Leadscrew board has this node number, and that it uses this version of the link.
    ///
    /// # Errors
    /// [`Trouble::NoBoard`], [`Trouble::TwoBoards`], [`Trouble::NotABoard`], [`Trouble::Version`].
    pub fn greet(&mut self) -> LinkResult {
        // Another gateway may be asking at the same moment, and a slow board answers several questions at once. So the same
        // question is asked again.
        let (mut count, mut several) = (0, 0);
        for _ in 0..GREETINGS {
            count = self.answers(SERIAL_NUMBER)?;
            several += u32::from(count > 1);
            if count == 1 || several == SEVERAL {
                break;
            }
        }
        let node = self.node().get();
        match count {
            0 => return Err(self.silent()),
            1 => {}
            _ => {
                return Err(Trouble::TwoBoards {
                    node,
                    bus: self.bus.clone(),
                });
            }
        }
        let product = match self.read_number(PRODUCT_CODE) {
            Ok(product) => u32::try_from(product).ok(),
            // Where the question or the answer gets lost, nobody knows what it is.
            Err(trouble)
                if trouble.is_abort(Abort::NoObject) || trouble.is_abort(Abort::NoSubIndex) =>
            {
                None
            }
            Err(trouble) => return Err(trouble),
        };
        if product != Some(PRODUCT) {
            return Err(Trouble::NotABoard { node, product });
        }
        let theirs = Version::from_raw(self.read_number(LINK_VERSION)?);
        if theirs != VERSION {
            return Err(Trouble::Version {
                node,
                theirs,
                ours: VERSION,
            });
        }
        Ok(())
    }

    /// Starts process data and waits for the first status.
    ///
    /// # Errors
    /// [`Trouble::NoBoard`].
    pub fn hear_status(&mut self) -> LinkResult {
        let before = self.seen.statuses;
        // A node that was started before has sent a status by then.
        let further = std::iter::repeat_n(STATUS, STARTS);
        for patience in std::iter::once(FIRST_STATUS).chain(further) {
            if patience == STATUS {
                self.start_node()?;
            }
            let until = Instant::now() + patience;
            while Instant::now() < until {
                if self.seen.statuses != before {
                    return Ok(());
                }
                self.idle(Duration::from_millis(2))?;
            }
        }
        Err(self.silent())
    }

    /// Gives an order and waits until the board confirms it. `run` is neither given nor awaited once the machine is [to be
    /// held](Self::hold_when); in a mode that runs none the board refuses it and drops the program. Hold and stop are given
    /// again after an order of another client.
    ///
    /// # Errors
    /// [`Trouble::NoBoard`], [`Trouble::Unconfirmed`].
    pub fn order(&mut self, order: Order) -> LinkResult {
        self.hear_status()?;
        self.hear_all(&mut |_| {})?;
        if order == Order::Hold && self.is_held_already(STATUS)? {
            return Ok(());
        }
        // A requested hold comes after an order to run, never before it.
        if order == Order::Run && self.hold_at_once()? {
            return Ok(());
        }
        if !matches!(order, Order::Run | Order::Mode(_)) {
            self.holds_by_itself();
        }
        // A halt is given whatever another client has ordered meanwhile.
        let tries = if halts(order) { HALT_TRIES } else { 1 };
        let mut done = Ok(());
        for _ in 0..tries {
            let last = self.seen.status.unwrap_or_default().count;
            let command = BoardCommand::order(order, last);
            self.hold.under_way = Some(command.count);
            done = self.command(command, order_name(order));
            self.hold.under_way = None;
            if !matches!(
                done,
                Err(Trouble::Unconfirmed {
                    overtaken: true,
                    ..
                })
            ) {
                break;
            }
        }
        done?;
        if order.needs_echo() {
            self.heed_refusal()?;
        }
        Ok(())
    }

    /// Sends a command until the board confirms its count. A command without an order is a level and is sent three times. A
    /// later command of another client is newer, so this command is not repeated after it.
    fn command(&mut self, mut command: BoardCommand, name: &'static str) -> LinkResult {
        let node = self.node();
        command.echo = self.echo_for(&command, &mut |_| {})?;
        let before = self.seen.status.unwrap_or_default().count;
        let mut boots = self.seen.boots;
        self.put(&[command.frame(node)])?;
        let mut again = Instant::now() + REPEAT;
        let end = Instant::now() + CONFIRMED;
        let mut sent = 1;
        let mut heard = Heard::of(command, node);
        loop {
            let now = Instant::now();
            self.listen(now + Duration::from_millis(1), &mut |frame| {
                heard.note(frame);
                false
            })?;
            // All frames that have arrived, however late.
            self.hear_all(&mut |frame| heard.note(frame))?;
            if command.order == Some(Order::Run) && self.hold_at_once()? {
                return Ok(());
            }
            let over = now >= again;
            if command.order.is_some() {
                // Two clients that give an order within the same status use the same count.
                let count = self.seen.status.unwrap_or_default().count;
                // What the board answered may have been heard while the node was asked or started.
                let confirmed = heard.confirmed || count != before && count == command.count;
                if confirmed && !(heard.overtaken && command.order.is_some_and(halts)) {
                    return Ok(());
                }
                if count != before || now >= end {
                    return Err(Trouble::Unconfirmed {
                        node: node.get(),
                        order: name,
                        overtaken: heard.overtaken || count != before,
                    });
                }
            } else if heard.overtaken || over && sent == 3 {
                return Ok(());
            }
            if over && self.seen.boots != boots {
                // The node hears and sends no process data until it is started.
                boots = self.seen.boots;
                self.start_node()?;
            }
            if over && !heard.overtaken {
                // The order shows its age: each repetition is a fresh one.
                command.echo = self.echo_for(&command, &mut |frame| heard.note(frame))?;
                self.put(&[command.frame(node)])?;
                sent += 1;
                again = Instant::now() + REPEAT;
            }
        }
    }

    /// Sets overrides and switches; `None` means no change. They are levels, so the command is sent more than once, unless
    /// another client sends levels meanwhile.
    ///
    /// # Errors
    /// [`Trouble::NoBoard`].
    pub fn set_levels(&mut self, levels: BoardCommand) -> LinkResult {
        self.hear_status()?;
        self.hear_all(&mut |_| {})?;
        let count = self.seen.status.unwrap_or_default().count;
        let command = BoardCommand {
            count,
            order: None,
            ..levels
        };
        self.command(command, "override")
    }

    /// The status record of the board.
    ///
    /// # Errors
    /// [`Trouble::Version`], [`Trouble::Strange`].
    pub fn status(&mut self) -> LinkResult<Status> {
        let bytes = self.read(STATUS_RECORD)?;
        match Status::decode(&bytes) {
            Ok(Ok(status)) => Ok(status),
            Ok(Err(theirs)) => Err(Trouble::Version {
                node: self.node().get(),
                theirs,
                ours: VERSION,
            }),
            Err(_) => Err(self.strange(STATUS_RECORD)),
        }
    }

    /// The name of the board, for stored results.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn board_name(&mut self) -> LinkResult<BoardName> {
        let serial = self.read_number(SERIAL_NUMBER)?;
        Ok(BoardName {
            node: self.node().get(),
            serial: u32::try_from(serial).map_err(|_| self.strange(SERIAL_NUMBER))?,
            version: String::from_utf8(self.read(SOFTWARE_VERSION)?)
                .map_err(|_| self.strange(SOFTWARE_VERSION))?,
        })
    }

    /// Which of its starts this is, by the board's own count; 0: it cannot say.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn start(&mut self) -> LinkResult<u32> {
        let raw = self.read_number(START)?;
        u32::try_from(raw).map_err(|_| self.strange(START))
    }

    /// How often each page of its storage has been erased; `None` of a board that does not count.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn erases(&mut self) -> LinkResult<Option<u32>> {
        match self.read_number(ERASES) {
            Ok(raw) => {
                let erases = u32::try_from(raw);
                erases.map(Some).map_err(|_| self.strange(ERASES))
            }
            Err(Trouble::Transfer { .. }) => Ok(None),
            Err(trouble) => Err(trouble),
        }
    }

    /// CRC-32 of the parameter set in force.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn parameters_identity(&mut self) -> LinkResult<u32> {
        let raw = self.read_number(SET_CHECKSUM)?;
        u32::try_from(raw).map_err(|_| self.strange(SET_CHECKSUM))
    }

    /// The parameter set in force.
    ///
    /// # Errors
    /// [`Trouble::Strange`]: the set belongs to another version of the table, or is damaged.
    pub fn parameters(&mut self) -> LinkResult<BoardParams> {
        let bytes = self.read(IMAGE)?;
        let mut params = Params::slant_bed();
        let mut reader = ImageReader::new();
        let read = reader
            .take(&bytes, &mut params)
            .and_then(|()| reader.finish(&params));
        match read {
            Ok(()) => Ok(BoardParams {
                identity: identity(&params),
                params,
            }),
            Err(_) => Err(self.strange(IMAGE)),
        }
    }

    /// The bytes of the tap journal; empty where nothing was ever stored.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn journal(&mut self) -> LinkResult<Vec<u8>> {
        match self.read(TAP_RECORD) {
            Err(trouble) if trouble.is_abort(Abort::NoData) => Ok(Vec::new()),
            read => read,
        }
    }

    /// Drops the entry of a tap in its hole. False where there is none.
    ///
    /// # Errors
    /// The board does not answer, or refuses because the machine moves.
    pub fn drop_tap(&mut self) -> LinkResult<bool> {
        match self.write(TAP_DISCARD, &DROP.to_le_bytes()) {
            Ok(()) => Ok(true),
            Err(trouble) if trouble.is_abort(Abort::NoData) => Ok(false),
            Err(trouble) => Err(trouble),
        }
    }

    /// The certificate of the last or running program, and the certificates of the last threads, the newest first.
    ///
    /// # Errors
    /// [`Trouble::Version`], [`Trouble::Strange`].
    pub fn certificates(&mut self) -> LinkResult<(Certificate, Vec<ThreadCertificate>)> {
        let bytes = self.read(CERTIFICATES)?;
        match Certificate::decode(&bytes) {
            Ok(Ok(certificate)) => {
                let threads: Result<Vec<_>, _> =
                    ThreadReader::new(&bytes).and_then(Iterator::collect);
                let threads = threads.map_err(|_| self.strange(CERTIFICATES))?;
                Ok((certificate, threads))
            }
            Ok(Err(theirs)) => Err(Trouble::Version {
                node: self.node().get(),
                theirs,
                ours: VERSION,
            }),
            Err(_) => Err(self.strange(CERTIFICATES)),
        }
    }

    /// Tells the board that the client that runs the program has the certificates of all threads up to `number`. In virtual
    /// time the board waits before it overwrites a later one. Reading alone does not say this: any client may read.
    ///
    /// # Errors
    /// The board does not answer, or there are not so many.
    pub fn take_threads(&mut self, number: u32) -> LinkResult {
        match self.write(THREADS_TAKEN, &number.to_le_bytes()) {
            // An older board without this object counts what is read.
            Err(trouble) if trouble.is_abort(Abort::NoObject) => Ok(()),
            written => written,
        }
    }

    /// Number of the newest entry of the event log.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn newest_event(&mut self) -> LinkResult<u32> {
        let raw = self.read_number(NEWEST_EVENT)?;
        u32::try_from(raw).map_err(|_| self.strange(NEWEST_EVENT))
    }

    /// The entries of the event log after number `last`, as many as one reading holds.
    ///
    /// The start of a reading is one object for all clients, and another client may have changed it in between. So a
    /// reading that does not begin right after `last` is repeated, until it is clear that older entries were dropped.
    ///
    /// # Errors
    /// [`Trouble::Strange`].
    pub fn events_behind(&mut self, last: u32) -> LinkResult<Vec<Logged>> {
        let mut entries = Vec::new();
        for _ in 0..LOG_TRIES {
            self.write(EVENTS_FROM, &last.saturating_add(1).to_le_bytes())?;
            self.keeps_turn = true;
            let bytes = self.read(EVENTS)?;
            let read: Result<Vec<Logged>, _> = EventReader::new(&bytes).collect();
            entries = read.map_err(|_| self.strange(EVENTS))?;
            entries.retain(|entry| entry.number > last);
            let complete = match entries.first() {
                Some(first) => first.number == last.saturating_add(1),
                None => self.newest_event()? <= last,
            };
            if complete {
                break;
            }
        }
        Ok(entries)
    }

    /// Inputs, outputs and interlocks of the machine.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn contacts(&mut self) -> LinkResult<MachineContacts> {
        let read = self.read_number(MACHINE_INPUTS)?;
        let outputs = self.read_number(MACHINE_OUTPUTS)?;
        let [out_low, out_high, _, gear, ..] = outputs.to_le_bytes();
        let [low, high, told, interlocks, ..] = read.to_le_bytes();
        let [block_low, block_high, known_low, known_high, ..] =
            self.read_of_block(BLOCK_INPUTS)?.to_le_bytes();
        let [block_out_low, block_out_high, ..] = self.read_of_block(BLOCK_OUTPUTS)?.to_le_bytes();
        let own = if told & 1 != 0 { u8::MAX } else { 0 };
        Ok(MachineContacts {
            inputs: u32::from_le_bytes([low, high, block_low, block_high]),
            known: u32::from_le_bytes([own, own, known_low, known_high]),
            outputs: u32::from_le_bytes([out_low, out_high, block_out_low, block_out_high]),
            gear,
            interlocks: Interlocks::from_bits(interlocks),
        })
    }

    /// A number that tells of the block; 0 where the board is older than that.
    fn read_of_block(&mut self, object: Object) -> LinkResult<u64> {
        match self.read_number(object) {
            Err(trouble) if trouble.refusal().is_some() => Ok(0),
            read => read,
        }
    }

    /// The inputs, without the mirrored bits after them.
    ///
    /// # Errors
    /// The board does not answer, or answers with bits that have no meaning.
    pub fn signals(&mut self) -> LinkResult<Signals> {
        let raw = self.read_number(SIGNALS)?;
        let signals = u16::try_from(raw).ok().and_then(Signals::from_bits);
        signals.ok_or_else(|| self.strange(SIGNALS))
    }

    /// Sets the inputs.
    ///
    /// # Errors
    /// The board does not answer, or refuses.
    pub fn set_signals(&mut self, signals: Signals) -> LinkResult {
        self.write(SIGNALS, &signals.bits().to_le_bytes())
    }
}

/// Inputs and outputs of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MachineContacts {
    /// The inputs that are on, as far as they have been told; bit 0 is input 1, bit 16 the block's first.
    pub inputs: u32,
    /// Those that have been told.
    pub known: u32,
    /// The outputs that are on.
    pub outputs: u32,
    /// The gear that is in, from 1; 0: nobody knows, or there is none.
    pub gear: u8,
    /// What is open, or has no pressure.
    pub interlocks: Interlocks,
}

/// True for an order that no other client may undo unnoticed.
const fn halts(order: Order) -> bool {
    matches!(order, Order::Hold | Order::Stop)
}

const fn order_name(order: Order) -> &'static str {
    match order {
        Order::Run => "run",
        Order::Hold => "hold",
        Order::Resume => "resume",
        Order::Reset => "reset",
        Order::Stop => "stop",
        Order::Cancel => "cancel",
        Order::Mode(_) => "mode",
        Order::Home(_) => "home",
    }
}

/// What is heard while a command is repeated.
struct Heard {
    node: NodeId,
    /// The count of the command.
    count: u8,
    is_order: bool,
    /// The board has the command.
    confirmed: bool,
    /// Somebody else has said something of the kind.
    overtaken: bool,
}

impl Heard {
    fn of(command: BoardCommand, node: NodeId) -> Self {
        Self {
            node,
            count: command.count,
            is_order: command.order.is_some(),
            confirmed: false,
            overtaken: false,
        }
    }

    fn note(&mut self, frame: &Frame) {
        if let Some((to, other)) = BoardCommand::decode(frame) {
            self.overtaken |= to == self.node && other.order.is_some() == self.is_order;
        } else if let Some((from, status)) = BoardStatus::decode(frame) {
            self.confirmed |= from == self.node && status.count == self.count;
        }
    }
}
