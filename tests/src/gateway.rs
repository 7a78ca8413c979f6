//! A gateway at the other end of a simulated wire: an SDO client, and a record of the board's frames.

use core::time::Duration;

use leadscrew_board_sim::Sim;
use leadscrew_core::bus::{
    BoardBeat, BoardCommand, BoardStatus, Emcy, Frame, NmtCommand, NmtState, NodeId, Object, Order,
    SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoUpload,
};
use leadscrew_core::call::Call;
use leadscrew_core::link::{BATCH_BYTES, BatchWriter, encode_call};
use leadscrew_core::offsets::Revision;
use leadscrew_core::operating::OperatingMode;

use crate::transfer::Transfer;

/// The board's node number in these tests.
pub const NODE: NodeId = NodeId::BOARD;
/// Batches of calls.
pub const BATCH: Object = Object::new(0x5020, 1);

const PATIENCE: Duration = Duration::from_secs(1);

/// An order with the board's present beat; its count is the next after `last`.
#[must_use]
pub fn fresh(sim: &Sim, order: Order, last: u8) -> BoardCommand {
    BoardCommand {
        echo: Some(sim.board().device().beat()),
        ..BoardCommand::order(order, last)
    }
}

/// The client and the frames that it has heard.
#[derive(Debug, Default)]
pub struct Gateway {
    /// The last status.
    pub status: BoardStatus,
    /// The last beat.
    pub beat: BoardBeat,
    /// Every emergency message of the board.
    pub emergencies: Vec<Emcy>,
    /// Every heartbeat and boot-up message of the board.
    pub heartbeats: Vec<NmtState>,
    /// Every frame of the board as a node.
    pub heard: Vec<Frame>,
    /// Number of frames sent in transfers.
    pub sent: usize,
    count: u8,
}

impl Gateway {
    /// Joins a board to the network and starts it.
    ///
    /// # Panics
    /// Where the board refuses.
    pub fn connect(sim: &mut Sim) -> Self {
        let mut gateway = Self::default();
        sim.join(NODE).expect("there is room on the bus");
        sim.receive(&NmtCommand::Start.frame(Some(NODE)));
        sim.settle();
        gateway.listen(sim);
        gateway
    }

    /// Takes all frames of the board.
    pub fn listen(&mut self, sim: &mut Sim) {
        while let Some(frame) = sim.transmit() {
            self.note(&frame);
        }
    }

    fn note(&mut self, frame: &Frame) {
        self.heard.push(*frame);
        if let Some((NODE, status)) = BoardStatus::decode(frame) {
            self.status = status;
        }
        if let Some(beat) = BoardBeat::decode(frame, NODE) {
            self.beat = beat;
        }
        if let Some((NODE, emcy)) = Emcy::decode(frame) {
            self.emergencies.push(emcy);
        }
        if let Some((NODE, state)) = NmtState::decode(frame) {
            self.heartbeats.push(state);
        }
    }

    /// Sends an order.
    pub fn order(&mut self, sim: &mut Sim, order: Order) {
        if order == Order::Run && !sim.board().device().mode().runs() {
            self.order(sim, Order::Mode(OperatingMode::Automatic));
        }
        let command = fresh(sim, order, self.count);
        self.count = command.count;
        sim.receive(&command.frame(NODE));
    }

    /// Writes an object while no time passes.
    ///
    /// # Errors
    /// The result of the transfer.
    pub fn write(
        &mut self,
        sim: &mut Sim,
        object: Object,
        data: &[u8],
        protocol: SdoProtocol,
    ) -> Result<(), SdoError> {
        let now = Duration::ZERO;
        let mut transfer = SdoDownload::new(NODE, object, data, protocol, PATIENCE, now);
        self.carry(sim, &mut transfer)
    }

    /// Carries a transfer to its end while no time passes.
    fn carry(&mut self, sim: &mut Sim, transfer: &mut impl Transfer) -> Result<(), SdoError> {
        let now = Duration::ZERO;
        loop {
            while let Some(frame) = transfer.poll(now) {
                self.sent += 1;
                sim.receive(&frame);
            }
            if let Some(outcome) = transfer.outcome() {
                return outcome;
            }
            sim.settle();
            let mut answered = false;
            while let Some(frame) = sim.transmit() {
                self.note(&frame);
                transfer.receive(&frame, now);
                answered = true;
            }
            if !answered {
                return Err(SdoError::TimedOut);
            }
        }
    }

    /// Reads an object while no time passes.
    ///
    /// # Errors
    /// The result of the transfer.
    pub fn read(
        &mut self,
        sim: &mut Sim,
        object: Object,
        protocol: SdoProtocol,
    ) -> Result<Vec<u8>, SdoError> {
        let now = Duration::ZERO;
        let mut room = vec![0; 1 << 16];
        let mut sink = SdoBuffer::new(&mut room);
        let mut transfer = SdoUpload::new(NODE, object, &mut sink, protocol, PATIENCE, now);
        let outcome = self.carry(sim, &mut transfer);
        outcome.map(|()| sink.bytes().to_vec())
    }

    /// Reads a number of up to eight bytes.
    ///
    /// # Errors
    /// The result of the transfer.
    pub fn number(&mut self, sim: &mut Sim, index: u16, sub: u8) -> Result<u64, SdoError> {
        let bytes = self.read(sim, Object::new(index, sub), SdoProtocol::Short)?;
        Ok(bytes
            .iter()
            .rev()
            .fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }
}

/// A program on its way to the board.
#[derive(Debug)]
pub struct Upload {
    program: u32,
    /// The table of offsets that it names.
    pub offsets: Revision,
    calls: std::collections::VecDeque<Vec<u8>>,
    next: u32,
    /// The most calls of a batch. Small batches make many transfers.
    pub most: u32,
    /// The transfers' protocol.
    pub protocol: SdoProtocol,
}

impl Upload {
    /// All calls of a program.
    ///
    /// # Panics
    /// For an impossible call.
    #[must_use]
    pub fn new(program: u32, calls: &[Call]) -> Self {
        let calls = calls
            .iter()
            .map(|call| encode_call(call).expect("a call fits").to_vec())
            .collect();
        Self {
            program,
            offsets: Revision::default(),
            calls,
            next: 0,
            most: u32::MAX,
            protocol: SdoProtocol::Block,
        }
    }

    /// Adds a call.
    ///
    /// # Panics
    /// For an impossible call.
    pub fn push(&mut self, call: &Call) {
        self.calls
            .push_back(encode_call(call).expect("a call fits").to_vec());
    }

    /// Number of calls that have not been sent.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.calls.len()
    }

    /// True where nothing is left to send.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.calls.is_empty()
    }

    /// The next batch that fits into `credit`; `None` where no call fits.
    #[must_use]
    pub fn batch(&self, credit: u16) -> Option<(Vec<u8>, u32)> {
        let mut writer = BatchWriter::new(self.program, self.offsets, self.next);
        let mut used = 0;
        for call in &self.calls {
            used += call.len();
            if writer.count() == self.most || used > usize::from(credit) {
                break;
            }
            if writer.push(call).is_err() {
                break;
            }
        }
        assert!(writer.bytes().len() <= BATCH_BYTES);
        (writer.count() > 0).then(|| (writer.bytes().to_vec(), writer.count()))
    }

    /// The board has taken so many calls.
    pub fn taken(&mut self, count: u32) {
        self.calls.drain(..count as usize);
        self.next += count;
    }

    /// Sends as much as the board has room for. True where anything was sent.
    ///
    /// # Panics
    /// Where the board refuses calls for which it has room.
    pub fn feed(&mut self, gateway: &mut Gateway, sim: &mut Sim) -> bool {
        let mut fed = false;
        loop {
            let credit = gateway.number(sim, 0x5020, 5).expect("the credit") as u16;
            let Some((bytes, count)) = self.batch(credit) else {
                return fed;
            };
            gateway
                .write(sim, BATCH, &bytes, self.protocol)
                .expect("there is room");
            self.taken(count);
            fed = true;
        }
    }
}
