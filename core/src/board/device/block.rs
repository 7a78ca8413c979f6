//! The block of inputs and outputs on the bus (CiA 401, parameters 9461 to 9463): it is started and watched, its inputs
//! go to the tick, and the tick's outputs go to it [D422], [D423].
//!
//! ```text
//! heartbeat, TPDO1 (6000h) ─► Block ─► Command::Block, Command::BlockLost ─► tick
//!             RPDO1 (6200h) ◄─ Block ◄─ snapshot ◄──────────────────────────── tick
//! ```
//!
//! It must not know what an input or an output is for.

use super::Device;
use crate::alarm::Code;
use crate::bus::{CobId, Frame, NmtCommand, NmtState, NodeId, Periods, Service};
use crate::params::Params;
use crate::tick::{BlockInputs, BlockLoss, Command, DriveNodes};

/// An input counts when it has not changed for so long; one that never rests does not keep the others back.
const FILTER_MS: u32 = 10;

/// RPDO1 comes at least so often.
const OUTPUTS_MS: u32 = 100;

/// A block may come up so much later than the board.
const START_MS: u32 = 5000;

/// Another node that has taken the block out of operational is left alone for so long.
const ASIDE_MS: u32 = 10_000;

/// The block.
#[derive(Debug, Default)]
pub(super) struct Block {
    node: Option<NodeId>,
    /// As its heartbeats say; `None`: they do not come.
    state: Option<NmtState>,
    /// Time since its last heartbeat, and since its last inputs.
    quiet: Periods,
    mute: Periods,
    /// It was operational and has told its inputs, since the set came into force or since it was lost.
    is_up: bool,
    /// Why it counts as lost.
    loss: Option<Code>,
    /// Its inputs as they came last, and as they count.
    seen: BlockInputs,
    told: BlockInputs,
    /// The time since inputs were last counted, and those that have changed in it.
    steady: Periods,
    changed: u16,
    /// The outputs that it was sent last, and the time since.
    sent: u16,
    since: Periods,
    /// It is to be started at the next opportunity.
    starts: bool,
    /// How long another node may keep it out of operational.
    aside: Periods,
}

impl Block {
    fn of(node: Option<NodeId>) -> Self {
        Self {
            node,
            starts: true,
            ..Self::default()
        }
    }

    /// True where the frame with this sender or receiver is the block's.
    pub(super) fn is_at(&self, node: NodeId) -> bool {
        self.node == Some(node)
    }

    /// A frame of the block.
    pub(super) fn hear(&mut self, service: Service, frame: &Frame) {
        match service {
            Service::Heartbeat => {
                if let Some((_, state)) = NmtState::decode(frame) {
                    self.enter(state);
                }
            }
            Service::Tpdo1 => self.tell(frame.payload()),
            _ => {}
        }
    }

    fn enter(&mut self, state: NmtState) {
        self.quiet = Periods::new(0);
        let before = self.state.replace(state);
        if state == NmtState::Operational {
            return;
        }
        if state == NmtState::BootUp {
            self.aside = Periods::new(0);
        }
        self.starts = true;
        // What it has told before does not count any more.
        self.seen = BlockInputs::default();
        if before == Some(NmtState::Operational) {
            self.lose(match state {
                NmtState::BootUp => Code::BlockRestarted,
                _ => Code::BlockStopped,
            });
        }
    }

    /// TPDO1: eight inputs in a byte, the first ones first. More than sixteen are not used.
    fn tell(&mut self, bytes: &[u8]) {
        let (levels, known) = match *bytes {
            [] => return,
            [low] => (low.into(), 0x00FF),
            [low, high, ..] => (u16::from_le_bytes([low, high]), 0xFFFF),
        };
        self.mute = Periods::new(0);
        self.changed |= (levels ^ self.seen.levels) | (known & !self.seen.known);
        self.seen = BlockInputs { levels, known };
    }

    /// Counts the inputs that have not changed lately.
    fn count(&mut self) {
        let changed = core::mem::take(&mut self.changed);
        self.steady = Periods::new(0);
        let (seen, told) = (self.seen, self.told);
        self.told = BlockInputs {
            levels: (seen.levels & !changed) | (told.levels & changed),
            known: seen.known & (told.known | !changed),
        };
    }

    fn lose(&mut self, code: Code) {
        self.told = BlockInputs::default();
        self.is_up = false;
        self.loss = Some(code);
    }

    /// Another node manages the network: it may have the block aside for a while, to set it up.
    pub(super) fn manage(&mut self, frame: &Frame, params: &Params) {
        let Some((command, node)) = NmtCommand::decode(frame) else {
            return;
        };
        if node.is_none_or(|node| self.is_at(node)) {
            let of = |ms| Periods::from_ms(ms, params.tick_us()).unwrap_or_default();
            self.aside = match command {
                NmtCommand::PreOperational | NmtCommand::Stop => of(ASIDE_MS),
                // Until its heartbeat and its inputs say that it works.
                NmtCommand::Start => self.aside.min(of(params.block_silence_ms())),
                _ => Periods::new(0),
            };
        }
    }

    /// Lets time pass. A block that is lost stays so until its heartbeats and its inputs come.
    fn elapse(&mut self, elapsed: Periods, params: &Params) {
        let of = |ms| Periods::from_ms(ms, params.tick_us()).unwrap_or_default();
        for time in [
            &mut self.quiet,
            &mut self.mute,
            &mut self.steady,
            &mut self.since,
        ] {
            *time = time.plus(elapsed);
        }
        self.aside = self.aside.minus(elapsed);
        let silence = params.block_silence_ms();
        let patience = of(match self.is_up || self.loss.is_some() {
            true => silence,
            false => silence.max(START_MS),
        });
        if self.quiet > patience {
            self.state = None;
            self.seen = BlockInputs::default();
        }
        let works = self.state == Some(NmtState::Operational);
        if works && self.seen.known != 0 && self.mute <= of(silence) {
            if self.steady >= of(FILTER_MS) {
                self.count();
            }
            if self.told.known != 0 {
                self.is_up = true;
                self.loss = None;
            }
        } else if self.mute > patience || (self.is_up && self.state.is_none()) {
            // Heartbeats come twice in that time at the least; where they have stayed away as well, it is the block.
            let beats = self.quiet.get() <= patience.get() >> 1;
            self.lose(match self.state {
                Some(NmtState::Operational) if beats => Code::BlockMute,
                None | Some(NmtState::Operational) => Code::BlockSilent,
                Some(_) => Code::BlockStopped,
            });
        }
    }
}

impl Device {
    /// Watches the block, and passes its inputs and outputs on.
    pub(super) fn serve_block(&mut self, elapsed: Periods, params: &Params) {
        let node = DriveNodes::of(params).block();
        let block = &mut self.block;
        if node != block.node {
            *block = Block::of(node);
        }
        let Some(node) = node else {
            return;
        };
        block.elapse(elapsed, params);
        let nothing = Periods::new(0);
        let silence = Periods::from_ms(params.block_silence_ms(), params.tick_us());
        if core::mem::take(&mut block.starts) && block.aside <= silence.unwrap_or_default() {
            let start = NmtCommand::Start.frame(Some(node));
            self.say(start);
        }
        let (block, snapshot) = (&mut self.block, &self.values.snapshot);
        let outputs = (snapshot.machine_outputs >> 16) as u16;
        let period = Periods::from_ms(OUTPUTS_MS, params.tick_us()).unwrap_or_default();
        let due = outputs != block.sent || block.since >= period;
        if block.state == Some(NmtState::Operational) && due {
            (block.sent, block.since) = (outputs, nothing);
            let frame = Frame::of(CobId::of(Service::Rpdo1, node), outputs.to_le_bytes());
            self.say(frame);
        }
        if elapsed == nothing {
            return;
        }
        let (block, snapshot) = (&mut self.block, &self.values.snapshot);
        let BlockInputs { levels, known } = block.told;
        let on = (levels ^ (params.inputs_inverted() >> 16) as u16) & known;
        let differs = snapshot.block() != u32::from(on) | u32::from(known) << 16;
        // Whoever sets the block up while nothing moves is not told that it does not work.
        let is_aside = block.aside != nothing && snapshot.is_at_rest();
        // Its outputs are what it does by itself, also where the machine stands on another alarm.
        let is_told = snapshot.alarm().is_some()
            && !differs
            && u32::from(outputs) == params.block_safe_outputs();
        if let Some(code) = block.loss.filter(|_| !is_aside && !is_told) {
            self.values.command(Command::BlockLost(BlockLoss {
                code,
                node,
                ms: params.block_silence_ms(),
            }));
        } else if differs {
            self.values.command(Command::Block(block.told));
        }
    }
}
