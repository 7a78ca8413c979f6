//! Setpoints of all drives in one frame of CAN FD (9031): the same machine, tick by tick, as with a frame for each drive.

use std::collections::HashMap;

use leadscrew_board_sim::plant::{Plant, PlantOptions, Trouble};
use leadscrew_core::board::{Board, Command, Output, State};
use leadscrew_core::bus::{Frame, NodeId, Service, Setpoints};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::Call;
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::calls;

/// A thread, a tap with spindle 1, and one with spindle 3 where there is one.
const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q3000 F1\nG0 X0 Z5\nM5\n\
                    G84 Z-12 R-3 F600 S600\nG80\nG0 X70 Z8\nM30\n";

/// A board and what is around it.
struct Bench {
    board: Board,
    plant: Plant,
    answers: Vec<Frame>,
    output: Output,
    waiting: Vec<Call>,
}

impl Bench {
    fn new(set: &[(&str, i64)]) -> Self {
        let mut params = Params::slant_bed();
        for (key, value) in set {
            params.set(Entry::find_text(key).unwrap(), *value).unwrap();
        }
        let mut waiting = calls(WORK, &params);
        waiting.reverse();
        Self {
            board: Board::new(&params, None, None).unwrap(),
            plant: Plant::new(&params, &PlantOptions::default()).unwrap(),
            answers: Vec::new(),
            output: Output::default(),
            waiting,
        }
    }

    fn tick(&mut self) {
        while self
            .waiting
            .last()
            .is_some_and(|call| self.board.offer(call))
        {
            self.waiting.pop();
        }
        while self.board.background() {}
        let sample = self.plant.advance();
        self.board.tick(sample, &self.answers, &mut self.output);
        self.answers.clear();
        let answers = &mut self.answers;
        self.plant
            .exchange(&self.output.frames, |answer| answers.push(answer));
        let frame = self
            .output
            .together
            .and_then(|together| together.frame(NodeId::BOARD));
        if let Some(frame) = frame {
            self.plant.tell_together(&frame);
        }
        while self.board.event().is_some() {}
    }
}

/// Both machines go on until `ticks` are over; `operate` is asked before each. What each drive was told last is compared in
/// every one.
fn compare(spindles: i64, ticks: u32, mut operate: impl FnMut(&mut Bench, u32)) -> [Bench; 2] {
    let nodes: Vec<u8> = [16, 17, 18]
        .into_iter()
        .chain((32..).take(spindles as usize))
        .collect();
    let mut alone = Bench::new(&[("9014", spindles)]);
    let mut together = Bench::new(&[("9014", spindles), ("9031", 1)]);
    let mut told: HashMap<u8, [u8; 6]> = HashMap::new();
    for tick in 0..ticks {
        for bench in [&mut alone, &mut together] {
            operate(bench, tick);
            bench.tick();
        }
        assert_eq!(
            alone.output.setpoint, together.output.setpoint,
            "tick {tick}"
        );
        assert_eq!(alone.output.together, None);
        let mut others = Vec::new();
        for frame in &alone.output.frames {
            match frame.id().service() {
                Some((Service::Rpdo1, node)) => {
                    told.insert(node.get(), frame.exactly().unwrap());
                }
                _ => others.push(*frame),
            }
        }
        assert_eq!(together.output.frames.as_slice(), others, "tick {tick}");
        let frame = together
            .output
            .together
            .unwrap()
            .frame(NodeId::BOARD)
            .unwrap();
        for (place, node) in nodes.iter().enumerate() {
            let own = &frame.payload()[6 * place..6 * place + 6];
            let expected = told.get(node).copied().unwrap_or([0; 6]);
            assert_eq!(own, expected, "tick {tick}, node {node}");
        }
        // Padding says nothing.
        assert!(
            frame.payload()[6 * nodes.len()..]
                .iter()
                .all(|byte| *byte == 0)
        );
        assert_eq!(alone.answers, together.answers, "tick {tick}");
        assert_eq!(alone.plant.truth(), together.plant.truth(), "tick {tick}");
    }
    [alone, together]
}

#[test]
fn a_program_is_the_same_with_one_frame_for_all_whatever_drives_there_are() {
    for (spindles, bytes) in [(1, 24), (2, 32), (4, 48)] {
        let [alone, together] = compare(spindles, 40_000, |_, _| {});
        assert!(
            alone.waiting.is_empty() && !alone.board.is_busy(),
            "it ends"
        );
        let frame = together
            .output
            .together
            .unwrap()
            .frame(NodeId::BOARD)
            .unwrap();
        assert_eq!((frame.id().get(), frame.payload().len()), (0x481, bytes));
    }
}

#[test]
fn a_drive_that_fails_stops_both_alike_and_a_reset_brings_both_up_again() {
    let troubles = [
        Trouble::Fault(0x7305),
        Trouble::Silent,
        Trouble::TorqueOff,
        Trouble::CutOff,
    ];
    for trouble in troubles {
        let both = compare(2, 6_000, |bench, tick| {
            if tick == 3_000 {
                bench.waiting.clear();
                bench.plant.drive(Axis::Z).trouble(trouble);
            }
        });
        // From here on the one with a frame for all takes a tick more: there, who is told nothing is without voltage.
        let stood = both.map(|mut bench| {
            assert!(bench.board.ticker().has_alarm(), "{trouble:?}");
            bench.plant.drive(Axis::Z).trouble(Trouble::None);
            bench.board.command(Command::Reset);
            for _ in 0..500 {
                bench.tick();
            }
            assert_eq!(bench.board.ticker().state(), State::Idle, "{trouble:?}");
            bench.plant.truth().positions
        });
        assert_eq!(stood[0], stood[1], "{trouble:?}");
    }
}

#[test]
fn a_drive_that_has_just_come_up_finds_nothing_that_would_enable_it() {
    let mut bench = Bench::new(&[("9031", 1)]);
    let x = |bench: &Bench| {
        let frame = bench.output.together.unwrap().frame(NodeId::BOARD).unwrap();
        Setpoints::command(frame.payload(), 0)
            .unwrap()
            .control
            .raw()
    };
    let mut words = Vec::new();
    for tick in 0..2_000 {
        if tick == 1_000 {
            bench.plant.drive(Axis::X).restart();
        }
        if tick == 1_500 {
            bench.waiting.clear();
            bench.board.command(Command::Reset);
        }
        bench.tick();
        if words.last() != Some(&x(&bench)) {
            words.push(x(&bench));
        }
    }
    // Up; gone, and told nothing; up again, step by step.
    assert_eq!(words, [0, 6, 7, 15, 0, 6, 7, 15]);
}
