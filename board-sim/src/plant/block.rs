//! A block of inputs and outputs on the bus (CiA 401): sixteen of each, as one buys it.
//!
//! As delivered it sends no heartbeat, watches nobody, and tells its inputs on change alone. Where the heartbeats that it
//! watches stay away, its outputs go to what 6206h and 6207h say, and it is pre-operational (1029h:01 = 0). This is written
//! from the profile, on purpose not from the board's code. It must not know what its contacts are for.

use leadscrew_core::bus::{
    Abort, BlockSize, CobId, Frame, NmtCommand, NmtState, NodeId, Object, Periods, SdoServer,
    Service,
};
use leadscrew_core::params::Params;

use super::numbers::{Numbers, Transfer};

/// Digital inputs and outputs by CiA 401.
const DEVICE_TYPE: u32 = 0x0003_0191;
/// `LSIO`.
const PRODUCT: u32 = 0x4C53_494F;
/// `save`, the value that 1010h:01h takes.
const SAVE: u32 = u32::from_le_bytes(*b"save");
/// COB-ID bit 30: the PDO cannot be requested by a remote frame.
const NO_RTR: u32 = 1 << 30;
/// From power-up to the boot-up message.
const STARTS_US: u32 = 50_000;
/// Longest pause in a transfer; nobody counts it here.
const PATIENCE: Periods = Periods::new(u32::MAX);

/// How the block differs from one that is set up for the board, at the node of 9461.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockOptions {
    /// Its node, where that is not 9461.
    pub node: Option<NodeId>,
    /// It is elsewhere on the bus: this plant does not answer for it.
    pub away: bool,
    /// It is as delivered.
    pub fresh: bool,
}

/// What happens to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BlockFault {
    /// Nothing.
    #[default]
    None,
    /// It has no power.
    Off,
    /// It says and hears nothing more, and its outputs stay: its wire is cut.
    CutOff,
    /// It sends no inputs any more.
    Mute,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Settings {
    /// 1016h:01h.
    watched: u32,
    /// 1017h.
    heartbeat_ms: u16,
    /// 1400h:02h and 1800h:02h.
    types: [u8; 2],
    /// 1800h:05h.
    event_ms: u16,
    /// 6005h.
    tells_changes: bool,
    /// 6206h and 6207h.
    mode: u16,
    safe: u16,
}

impl Settings {
    const FRESH: Self = Self {
        watched: 0,
        heartbeat_ms: 0,
        types: [255; 2],
        event_ms: 0,
        tells_changes: true,
        mode: 0xFFFF,
        safe: 0,
    };
}

/// The block.
#[derive(Clone, Copy, Debug)]
pub struct IoBlock {
    node: NodeId,
    tick_us: u32,
    nmt: Option<NmtState>,
    fault: BlockFault,
    settings: Settings,
    kept: Settings,
    /// Microseconds since power-up or the last start, the last heartbeat, the last TPDO1, and the last heartbeat that it
    /// watches; `None`: none has come.
    up: u32,
    beat: u32,
    told: u32,
    heard: Option<u32>,
    inputs: u16,
    /// As TPDO1 said them last.
    said: Option<u16>,
    outputs: u16,
    server: SdoServer,
    value: [u8; 4],
}

impl IoBlock {
    /// The block of a set, just switched on; `None` where 9461 names none, or it is elsewhere.
    #[must_use]
    pub fn new(params: &Params, options: &BlockOptions, board: NodeId) -> Option<Self> {
        let node = options.node.or(NodeId::new(params.block_node()))?;
        if options.away {
            return None;
        }
        let settings = match options.fresh {
            true => Settings::FRESH,
            false => Settings {
                watched: u32::from(board.get()) << 16 | u32::from(params.block_watch_ms()),
                heartbeat_ms: 100,
                event_ms: 100,
                safe: params.block_safe_outputs() as u16,
                ..Settings::FRESH
            },
        };
        Some(Self {
            node,
            tick_us: params.tick_us(),
            nmt: None,
            fault: BlockFault::None,
            settings,
            kept: settings,
            up: 0,
            beat: 0,
            told: 0,
            heard: None,
            inputs: 0,
            said: None,
            outputs: 0,
            server: SdoServer::new(node, PATIENCE, BlockSize::MAX),
            value: [0; 4],
        })
    }

    /// Sets the levels at its inputs.
    pub const fn set_inputs(&mut self, inputs: u16) {
        self.inputs = inputs;
    }

    /// Its outputs that are on.
    #[must_use]
    pub const fn outputs(&self) -> u16 {
        self.outputs
    }

    /// Its NMT state; `None` before its boot-up message.
    #[must_use]
    pub const fn state(&self) -> Option<NmtState> {
        self.nmt
    }

    /// Something happens to it. Without a fault it goes on, from power-up where it had no power.
    pub fn spoil(&mut self, fault: BlockFault) {
        self.fault = fault;
        if fault == BlockFault::Off {
            self.settings = self.kept;
            self.restart();
        }
    }

    /// It starts anew, as when its supply drops.
    pub fn restart(&mut self) {
        self.nmt = None;
        (self.up, self.beat, self.told) = (0, 0, 0);
        (self.heard, self.said) = (None, None);
        self.outputs = 0;
    }

    /// Somebody stops it on the network.
    pub const fn stop(&mut self) {
        if self.nmt.is_some() {
            self.nmt = Some(NmtState::Stopped);
            self.fail();
        }
    }

    fn is_deaf(&self) -> bool {
        matches!(self.fault, BlockFault::Off | BlockFault::CutOff)
    }

    /// A SYNC period goes by; its frames go to `send`.
    pub fn elapse(&mut self, send: &mut impl FnMut(Frame)) {
        if self.fault == BlockFault::Off {
            return;
        }
        for time in [&mut self.up, &mut self.beat, &mut self.told] {
            *time = time.saturating_add(self.tick_us);
        }
        self.heard = self.heard.map(|time| time.saturating_add(self.tick_us));
        let mut say = |block: &Self, frame| {
            if !block.is_deaf() {
                send(frame);
            }
        };
        let Some(state) = self.nmt else {
            if self.up >= STARTS_US {
                self.nmt = Some(NmtState::PreOperational);
                say(self, NmtState::BootUp.frame(self.node));
            }
            return;
        };
        let limit = u32::from(self.settings.watched as u16).saturating_mul(1000);
        if limit != 0 && self.heard.is_some_and(|time| time > limit) {
            self.heard = None;
            self.fail();
            if state == NmtState::Operational {
                self.nmt = Some(NmtState::PreOperational);
            }
        }
        let state = self.nmt.unwrap_or(state);
        let beat = u32::from(self.settings.heartbeat_ms).saturating_mul(1000);
        if beat != 0 && self.beat >= beat {
            self.beat = 0;
            say(self, state.frame(self.node));
        }
        if state != NmtState::Operational || self.fault == BlockFault::Mute {
            return;
        }
        let event = u32::from(self.settings.event_ms).saturating_mul(1000);
        let changed = self.settings.tells_changes && self.said != Some(self.inputs);
        if changed || (event != 0 && self.told >= event) {
            self.told = 0;
            self.said = Some(self.inputs);
            let id = CobId::of(Service::Tpdo1, self.node);
            say(self, Frame::of(id, self.inputs.to_le_bytes()));
        }
    }

    /// Outputs go where 6206h and 6207h say.
    const fn fail(&mut self) {
        let Settings { mode, safe, .. } = self.settings;
        self.outputs = self.outputs & !mode | safe & mode;
    }

    /// A frame of another node; answers go to `send`.
    pub fn hear(&mut self, frame: &Frame, send: &mut impl FnMut(Frame)) {
        let Some(state) = self.nmt.filter(|_| !self.is_deaf()) else {
            return;
        };
        if let Some((command, node)) = NmtCommand::decode(frame) {
            if node.is_none_or(|node| node == self.node) {
                self.manage(command);
            }
            return;
        }
        let watched = NodeId::new((self.settings.watched >> 16) as u8);
        match frame.id().service() {
            Some((Service::Heartbeat, node)) if Some(node) == watched => self.heard = Some(0),
            Some((Service::Rpdo1, node)) if node == self.node => {
                if state == NmtState::Operational
                    && let [low, high, ..] = *frame.payload()
                {
                    self.outputs = u16::from_le_bytes([low, high]);
                }
            }
            Some((Service::SdoRequest, node))
                if node == self.node && state != NmtState::Stopped =>
            {
                self.serve(frame, send);
            }
            _ => {}
        }
    }

    fn manage(&mut self, command: NmtCommand) {
        match command {
            NmtCommand::Start => {
                if self.nmt != Some(NmtState::Operational) {
                    self.said = None;
                }
                self.nmt = Some(NmtState::Operational);
            }
            NmtCommand::PreOperational => self.nmt = Some(NmtState::PreOperational),
            NmtCommand::Stop => self.stop(),
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => {
                self.settings = self.kept;
                self.restart();
            }
        }
    }

    fn serve(&mut self, frame: &Frame, send: &mut impl FnMut(Frame)) {
        let (mut server, mut value) = (self.server, self.value);
        let mut objects = Transfer {
            numbers: &mut *self,
            value: &mut value,
        };
        if let Some(answer) = server.receive(frame, &mut objects) {
            send(answer);
        }
        while let Some(segment) = server.poll(&mut objects) {
            send(segment);
        }
        (self.server, self.value) = (server, value);
    }

    const fn id(&self, service: Service) -> u32 {
        CobId::of(service, self.node).get() as u32
    }
}

impl Numbers for &mut IoBlock {
    fn get(&self, object: Object) -> Result<(u8, u32), Abort> {
        let settings = &self.settings;
        let byte = |word: u16, sub: u8| match sub {
            0 => Ok((1, 2)),
            1 => Ok((1, u32::from(word & 0xFF))),
            2 => Ok((1, u32::from(word >> 8))),
            _ => Err(Abort::NoSubIndex),
        };
        let mapped = |index: u32, sub: u8| match sub {
            0 => Ok((1, 2)),
            1 | 2 => Ok((4, index << 16 | u32::from(sub) << 8 | 8)),
            _ => Err(Abort::NoSubIndex),
        };
        match (object.index, object.sub) {
            (0x1000, 0) => Ok((4, DEVICE_TYPE)),
            (0x1001, 0) => Ok((1, 0)),
            (0x1010 | 0x1016 | 0x1029, 0) => Ok((1, 1)),
            (0x1010, 1) => Ok((4, 1)),
            (0x1016, 1) => Ok((4, settings.watched)),
            (0x1017, 0) => Ok((2, settings.heartbeat_ms.into())),
            (0x1018, 0) => Ok((1, 2)),
            (0x1018, 1) => Ok((4, 0)),
            (0x1018, 2) => Ok((4, PRODUCT)),
            (0x1029, 1) => Ok((1, 0)),
            (0x1400, 0) => Ok((1, 2)),
            (0x1400, 1) => Ok((4, self.id(Service::Rpdo1))),
            (0x1400, 2) => Ok((1, settings.types[0].into())),
            (0x1600, sub) => mapped(0x6200, sub),
            (0x1800, 0) => Ok((1, 5)),
            (0x1800, 1) => Ok((4, self.id(Service::Tpdo1) | NO_RTR)),
            (0x1800, 2) => Ok((1, settings.types[1].into())),
            (0x1800, 3) => Ok((2, 0)),
            (0x1800, 5) => Ok((2, settings.event_ms.into())),
            (0x1A00, sub) => mapped(0x6000, sub),
            (0x6000, sub) => byte(self.inputs, sub),
            (0x6005, 0) => Ok((1, settings.tells_changes.into())),
            (0x6200, sub) => byte(self.outputs, sub),
            (0x6206, sub) => byte(settings.mode, sub),
            (0x6207, sub) => byte(settings.safe, sub),
            (0x1010 | 0x1016 | 0x1018 | 0x1029 | 0x1400 | 0x1800, _) => Err(Abort::NoSubIndex),
            _ => Err(Abort::NoObject),
        }
    }

    fn set(&mut self, object: Object, value: u32) -> Result<(), Abort> {
        let put = |word: u16, sub: u8| match sub {
            1 => word & 0xFF00 | value as u16 & 0xFF,
            _ => word & 0x00FF | (value as u16) << 8,
        };
        match (object.index, object.sub) {
            (0x1010, 1) if value == SAVE => self.kept = self.settings,
            (0x1010, 1) => return Err(Abort::NotStored),
            (0x1016, 1) => {
                self.settings.watched = value;
                self.heard = None;
            }
            (0x1017, 0) => self.settings.heartbeat_ms = value as u16,
            (0x1400, 2) if value >= 254 => self.settings.types[0] = value as u8,
            (0x1800, 2) if value >= 254 => self.settings.types[1] = value as u8,
            (0x1800, 5) => self.settings.event_ms = value as u16,
            (0x6005, 0) => self.settings.tells_changes = value != 0,
            (0x6206, sub @ 1..=2) => self.settings.mode = put(self.settings.mode, sub),
            (0x6207, sub @ 1..=2) => self.settings.safe = put(self.settings.safe, sub),
            (0x1400 | 0x1800, 2) => return Err(Abort::Value),
            _ => return Err(Abort::ReadOnly),
        }
        Ok(())
    }
}
