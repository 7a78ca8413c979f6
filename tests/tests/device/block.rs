//! A block of inputs and outputs (CiA 401) on the board's bus: its frames byte by byte, its inputs and outputs, and what
//! follows where it is silent, restarts, is stopped, sends no inputs, or has another node.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{BlockFault, BlockOptions, PlantOptions};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::State;
use leadscrew_core::bus::{CobId, Frame, NmtCommand, NmtState, NodeId, Order, Service};
use leadscrew_core::operating::Interlock;
use leadscrew_core::params::{Contact, Params};
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;

const BLOCK: NodeId = NodeId::nearest(5);
/// 9462 in ticks.
const SILENCE: u64 = 500;
/// A block that comes up late.
const START: u64 = 5_000;

/// M60 switches output 17 on, and input 17 answers within a second; M61 switches output 32 on; input 18 is the door. Output
/// 18 is on where board and block do not hear of each other.
fn params() -> Params {
    with(&[
        ("9401", 601_171_170_100),
        ("9402", 611_320_000_000),
        ("9423", 18),
        ("9461", BLOCK.get().into()),
        ("9463", 0b10),
    ])
}

struct Bench {
    sim: Sim,
    gateway: Gateway,
    tick: u64,
    /// Frames of the block, and of the board to it, with their ticks.
    told: Vec<(u64, Frame)>,
    sent: Vec<(u64, Frame)>,
}

impl Bench {
    fn new(params: &Params, block: BlockOptions) -> Self {
        let options = PlantOptions {
            block,
            ..PlantOptions::default()
        };
        let mut sim = Sim::new(params, &options).unwrap();
        let gateway = Gateway::connect(&mut sim);
        Self {
            sim,
            gateway,
            tick: 0,
            told: Vec::new(),
            sent: Vec::new(),
        }
    }

    /// One that is up.
    fn up() -> Self {
        let mut bench = Self::new(&params(), BlockOptions::default());
        bench.run(300);
        assert_eq!(bench.known(), 0xFFFF);
        bench
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            let (tick, told) = (self.tick, &mut self.told);
            let _ = self.sim.step_on(&mut |_, frame| {
                if frame.id().service().is_some_and(|(_, node)| node == BLOCK) {
                    told.push((tick, *frame));
                }
            });
            self.gateway.heard.clear();
            self.gateway.listen(&mut self.sim);
            let sent = &mut self.sent;
            let to_block = |frame: &&Frame| {
                frame.id() == CobId::NMT || frame.id().service() == Some((Service::Rpdo1, BLOCK))
            };
            sent.extend(
                self.gateway
                    .heard
                    .iter()
                    .filter(to_block)
                    .map(|f| (tick, *f)),
            );
            self.tick += 1;
        }
    }

    fn fault(&mut self, fault: BlockFault) {
        self.sim.plant().block().unwrap().spoil(fault);
    }

    fn outputs(&mut self) -> u16 {
        self.sim.plant().block().unwrap().outputs()
    }

    /// The inputs of the block that the board knows.
    fn known(&self) -> u32 {
        self.sim.board().ticker().machine_known() >> 16
    }

    fn image(&self) -> u32 {
        self.sim.board().ticker().machine_outputs() >> 16
    }

    fn alarm(&self) -> Option<(Code, [Arg; 2])> {
        match self.sim.board().ticker().state() {
            State::Alarm(alarm) => Some((alarm.code, [alarm.args[0], alarm.args[1]])),
            _ => None,
        }
    }

    /// Ticks until the machine stands on an alarm, and that.
    fn until_alarm(&mut self, most: u64) -> (u64, Code, [Arg; 2]) {
        let begun = self.tick;
        while self.tick - begun <= most {
            self.run(1);
            if let Some((code, args)) = self.alarm() {
                return (self.tick - begun, code, args);
            }
        }
        panic!("no alarm: {:?}", self.sim.board().ticker().state());
    }

    fn reset(&mut self) {
        self.gateway.order(&mut self.sim, Order::Reset);
        self.run(20);
    }

    fn program(&mut self, text: &str) {
        for call in calls(text, &params()) {
            while !self.sim.offer(&call) {
                self.run(1);
            }
        }
    }

    fn set(&mut self, input: u8, on: Option<bool>) {
        self.sim.around().set(Contact::new(input).unwrap(), on);
    }
}

fn of(code: Code, ms: i64) -> (Code, [Arg; 2]) {
    (code, [Arg::Int(5), Arg::Int(ms)])
}

#[test]
fn the_board_starts_its_block_and_tells_it_its_outputs_on_change_and_every_100_ms() {
    let mut bench = Bench::new(&params(), BlockOptions::default());
    bench.run(1_000);
    let boot_up = bench.told.iter().find(|(_, f)| f.id().get() == 0x705);
    let (up, boot_up) = *boot_up.unwrap();
    assert_eq!(boot_up, NmtState::BootUp.frame(BLOCK));
    let start = bench
        .sent
        .iter()
        .find(|(tick, f)| *tick >= up && f.id() == CobId::NMT);
    let (started, start) = *start.unwrap();
    assert_eq!((start.payload(), started - up), (&[1_u8, 5][..], 0));
    // 6200h: output 18 is the safe one.
    let told: Vec<_> = bench
        .sent
        .iter()
        .filter(|(_, f)| f.id().get() == 0x205)
        .copied()
        .collect();
    assert!(told.iter().all(|(_, frame)| frame.payload() == [0b10, 0]));
    let gaps = told.windows(2).map(|pair| pair[1].0 - pair[0].0);
    assert!(
        gaps.clone().count() >= 7 && gaps.clone().all(|gap| gap == 100),
        "{told:?}"
    );
    // 6000h: door closed, input 17 has nothing to answer yet.
    let inputs = bench.told.iter().filter(|(_, f)| f.id().get() == 0x185);
    assert!(inputs.clone().count() >= 8);
    assert!(inputs.clone().all(|(_, f)| f.payload() == [0b10, 0]));

    bench.program("M60\nM61\n");
    let begun = bench.tick;
    bench.run(200);
    let told = bench
        .sent
        .iter()
        .filter(|(tick, f)| *tick >= begun && f.id().get() == 0x205);
    let mut contents: Vec<_> = told.map(|(_, f)| f.payload().to_vec()).collect();
    contents.dedup();
    assert_eq!(contents, [[0b11, 0], [0b11, 0x80]]);
    assert_eq!((bench.outputs(), bench.alarm()), (0x8003, None));
}

#[test]
fn an_input_of_the_block_counts_once_it_has_not_changed_for_10_to_20_ms() {
    let mut bench = Bench::up();
    bench.set(20, Some(true));
    bench.run(10);
    let on = |bench: &Bench| bench.sim.board().ticker().machine_inputs() >> 16 & 0b1000 != 0;
    assert!(!on(&bench));
    bench.run(12);
    assert!(on(&bench));
    // A contact that bounces does not count, and does not keep another one back.
    let other = |bench: &Bench| bench.sim.board().ticker().machine_inputs() >> 16 & 0b10_0000 != 0;
    for at in 0..30 {
        bench.set(20, Some(at % 2 == 1));
        bench.set(22, Some(at >= 10));
        bench.run(4);
        assert!(on(&bench), "{at}");
        assert!(at >= 10 || !other(&bench), "{at}");
        assert!(at < 16 || other(&bench), "{at}");
    }
    bench.set(22, None);
    bench.run(30);
    assert_eq!(
        bench.gateway.number(&mut bench.sim, 0x5063, 0),
        Ok(0xFFFF_000A)
    );
    assert_eq!(bench.gateway.number(&mut bench.sim, 0x5064, 0), Ok(0b10));
}

#[test]
fn a_block_that_falls_silent_stops_the_machine_and_both_sides_take_the_safe_outputs() {
    let mut bench = Bench::up();
    bench.program("M60\nM61\nG4 P9000\n");
    bench.run(200);
    assert_eq!((bench.outputs(), bench.image()), (0x8003, 0x8003));
    bench.fault(BlockFault::CutOff);
    let (ticks, code, args) = bench.until_alarm(2 * SILENCE);
    assert_eq!((code, args), of(Code::BlockSilent, 500));
    assert!((SILENCE - 100..=SILENCE + 20).contains(&ticks), "{ticks}");
    // The block gives the board three heartbeats (9023).
    bench.run(1_500);
    assert_eq!(
        (bench.known(), bench.image(), bench.outputs()),
        (0, 0b10, 0b10)
    );
    let interlocks = bench.sim.board().ticker().interlocks();
    assert!(
        interlocks.contains(Interlock::Door),
        "an input that nobody tells"
    );
    // A reset does not help while it is silent.
    bench.reset();
    assert_eq!(bench.alarm(), Some(of(Code::BlockSilent, 500)));
    bench.fault(BlockFault::None);
    bench.run(400);
    assert_eq!(bench.known(), 0xFFFF);
    bench.reset();
    assert_eq!(
        (bench.alarm(), bench.image(), bench.outputs()),
        (None, 0b10, 0b10)
    );
}

#[test]
fn a_block_that_restarts_is_an_alarm_and_nothing_of_it_comes_on_again_by_itself() {
    let mut bench = Bench::up();
    bench.program("M60\nM61\n");
    bench.run(200);
    bench.sim.plant().block().unwrap().restart();
    let (ticks, code, args) = bench.until_alarm(200);
    assert_eq!((code, args), of(Code::BlockRestarted, 500));
    // Its boot-up message comes after 50 ms.
    assert!(ticks <= 60, "{ticks}");
    bench.run(500);
    assert_eq!((bench.outputs(), bench.known()), (0b10, 0xFFFF));
    bench.reset();
    assert_eq!((bench.alarm(), bench.outputs()), (None, 0b10));
    bench.program("M60\n");
    bench.run(100);
    assert_eq!((bench.alarm(), bench.outputs()), (None, 0b11));
}

/// Under another alarm the loss is not told, and the outputs do not come on again either.
#[test]
fn a_block_that_restarts_under_another_alarm_does_not_get_its_outputs_back() {
    let mut bench = Bench::up();
    bench.program("M61\n");
    bench.run(100);
    bench.gateway.order(&mut bench.sim, Order::Stop);
    bench.run(100);
    bench.sim.plant().block().unwrap().restart();
    bench.run(500);
    assert_eq!(
        bench.alarm().map(|(code, _)| code),
        Some(Code::EmergencyStop)
    );
    assert_eq!(
        (bench.known(), bench.image(), bench.outputs()),
        (0xFFFF, 0b10, 0b10)
    );
}

#[test]
fn a_block_at_another_node_than_9461_is_told_five_seconds_after_power_up() {
    let other = BlockOptions {
        node: NodeId::new(6),
        ..BlockOptions::default()
    };
    let mut bench = Bench::new(&params(), other);
    let (ticks, code, args) = bench.until_alarm(START + 100);
    assert_eq!((code, args), of(Code::BlockSilent, 500));
    assert!((START..=START + 20).contains(&ticks), "{ticks}");
    bench.reset();
    assert_eq!(bench.alarm(), Some(of(Code::BlockSilent, 500)));
}

#[test]
fn a_block_that_was_not_set_up_sends_no_heartbeat_and_is_told() {
    let fresh = BlockOptions {
        fresh: true,
        ..BlockOptions::default()
    };
    let mut bench = Bench::new(&params(), fresh);
    let (_, code, args) = bench.until_alarm(START + 100);
    assert_eq!((code, args), of(Code::BlockSilent, 500));
}

#[test]
fn a_node_that_sends_heartbeats_and_no_inputs_is_told() {
    let mut bench = Bench::up();
    bench.fault(BlockFault::Mute);
    let (ticks, code, args) = bench.until_alarm(2 * SILENCE);
    assert_eq!((code, args), of(Code::BlockMute, 500));
    assert!((SILENCE - 100..=SILENCE + 20).contains(&ticks), "{ticks}");
}

#[test]
fn another_node_may_have_the_block_aside_while_nothing_moves() {
    let mut bench = Bench::up();
    bench.program("M61\nM30\n");
    bench.run(100);
    let aside = NmtCommand::PreOperational.frame(Some(BLOCK));
    bench.sim.receive(&aside);
    bench.run(3_000);
    // Nobody knows its inputs, and its outputs stay, as they do in the block.
    assert_eq!((bench.alarm(), bench.known()), (None, 0));
    assert_eq!((bench.image(), bench.outputs()), (0x8002, 0x8002));
    bench.sim.receive(&NmtCommand::Start.frame(Some(BLOCK)));
    bench.run(300);
    assert_eq!((bench.alarm(), bench.known()), (None, 0xFFFF));
    // Whoever forgets it there: after ten seconds the board starts it.
    bench.sim.receive(&aside);
    bench.run(10_300);
    assert_eq!((bench.alarm(), bench.known()), (None, 0xFFFF));
    // While anything is under way it is an alarm at once.
    bench.program("G4 P9000\n");
    bench.run(100);
    bench.sim.receive(&aside);
    let (_, code, args) = bench.until_alarm(200);
    assert_eq!((code, args), of(Code::BlockStopped, 500));
}

#[test]
fn without_a_block_nothing_of_it_is_sent() {
    let mut bench = Bench::new(&with(&[]), BlockOptions::default());
    bench.run(6_000);
    assert!(bench.sent.is_empty() && bench.alarm().is_none());
}
