//! Setpoints of all drives in one frame of CAN FD (9031): the same machine, tick by tick, as with a frame for each drive.

use std::collections::HashMap;

use leadscrew_board_sim::keep;
use leadscrew_board_sim::plant::{DriveOptions, Flash, Plant, PlantOptions, Trouble};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Board, Command, Event, Output, State};
use leadscrew_core::bus::{
    CobId, DriveCommand, FdFrame, Frame, Mapped, NmtCommand, NodeId, Service, Setpoints,
};
use leadscrew_core::call::{Call, Position};
use leadscrew_core::units::{Axis, Length};
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;

/// A thread and a rigid tap.
const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q3000 F1\nG0 X0 Z5\nM5\nM29 S600\n\
                    G84 Z-12 R-3 F600\nG80\nG0 X70 Z8\nM30\n";

fn flash() -> Flash {
    let mut flash = Flash::erased();
    flash.power(true);
    flash
}

/// A board and what is around it.
struct Bench {
    board: Board,
    plant: Plant,
    /// Of the board: a tap is entered there.
    flash: Flash,
    answers: Vec<Frame>,
    output: Output,
    waiting: Vec<Call>,
    /// The last alarm.
    alarm: Option<Code>,
}

impl Bench {
    fn new(set: &[(&str, i64)]) -> Self {
        let params = with(set);
        let mut waiting = calls(WORK, &params);
        waiting.reverse();
        // A status in every period, so that it is the same whose drive was started when.
        let options = PlantOptions {
            drives: DriveOptions {
                transmission: 1,
                ..DriveOptions::default()
            },
            ..PlantOptions::default()
        };
        Self {
            board: Board::new(&params, None, None).unwrap(),
            plant: Plant::new(&params, &options).unwrap(),
            flash: flash(),
            answers: Vec::new(),
            output: Output::default(),
            waiting,
            alarm: None,
        }
    }

    /// What all drives are told in one frame.
    fn frame(&self) -> Option<FdFrame> {
        let together = self.output.together?;
        together.frame(NodeId::BOARD)
    }

    /// A period; what the board has said of it.
    fn tick(&mut self) -> Vec<Event> {
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
        keep(&mut self.board, &mut self.flash);
        self.answers.clear();
        let answers = &mut self.answers;
        self.plant
            .exchange(&self.output.frames, |answer| answers.push(answer));
        if let Some(frame) = self.frame() {
            self.plant.tell_together(&frame);
        }
        let events: Vec<Event> = core::iter::from_fn(|| self.board.event()).collect();
        for event in &events {
            if let Event::Alarm(alarm) = event {
                self.alarm = Some(alarm.code);
            }
        }
        events
    }
}

/// Ticks in which all drives come up, one after the other.
const COMING_UP: u32 = 160;

/// Keeps what each drive is told by a frame of its own; the other frames, but for modes and speeds of spindles.
fn hear(told: &mut HashMap<u8, [u8; 6]>, bench: &Bench) -> Vec<Frame> {
    let mut others = Vec::new();
    for frame in &bench.output.frames {
        match frame.id().service() {
            Some((Service::Rpdo1, node)) => {
                told.insert(node.get(), frame.exactly().unwrap());
            }
            Some((Service::Rpdo2, _)) => {}
            _ => others.push(*frame),
        }
    }
    others
}

/// Keeps the last mode and speed of each spindle: these come in every 16th period,
/// too, counted from when its drive came up.
fn speeds(told: &mut HashMap<NodeId, Frame>, bench: &Bench) {
    for frame in &bench.output.frames {
        if let Some((Service::Rpdo2, node)) = frame.id().service() {
            told.insert(node, *frame);
        }
    }
}

/// Both machines go on until `ticks` are over, from where all drives of both are enabled; `operate` is asked before
/// each. What each drive was told last is compared in every one.
fn compare(spindles: i64, ticks: u32, mut operate: impl FnMut(&mut Bench, u32)) -> [Bench; 2] {
    let nodes: Vec<u8> = [16, 17, 18]
        .into_iter()
        .chain((32..).take(spindles as usize))
        .collect();
    let mut alone = Bench::new(&[("9014", spindles)]);
    let mut together = Bench::new(&[("9014", spindles), ("9031", 1)]);
    let mut told: HashMap<u8, [u8; 6]> = HashMap::new();
    let mut spindles_told = [HashMap::new(), HashMap::new()];
    let works = [&mut alone, &mut together].map(|bench| core::mem::take(&mut bench.waiting));
    for _ in 0..COMING_UP {
        for bench in [&mut alone, &mut together] {
            bench.tick();
        }
        hear(&mut told, &alone);
        speeds(&mut spindles_told[0], &alone);
        speeds(&mut spindles_told[1], &together);
    }
    for (bench, work) in [&mut alone, &mut together].into_iter().zip(works) {
        assert_eq!(bench.board.ticker().state(), State::Idle);
        bench.waiting = work;
    }
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
        let others = hear(&mut told, &alone);
        let same = hear(&mut HashMap::new(), &together);
        assert_eq!(same, others, "tick {tick}");
        speeds(&mut spindles_told[0], &alone);
        speeds(&mut spindles_told[1], &together);
        assert_eq!(spindles_told[0], spindles_told[1], "tick {tick}");
        let frame = together.frame().unwrap();
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
        assert_eq!([alone.alarm, together.alarm], [None; 2]);
        let frame = together.frame().unwrap();
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

/// Drives that tell 8220h of each frame, since it is longer than what they map: the machine does what it does, nothing
/// is said of it, and a drive that fails is named with its own code.
#[test]
fn drives_that_tell_of_every_frame_that_it_is_longer_do_no_harm() {
    let run = |tells_longer| {
        let mut bench = Bench::new(&[("9031", 1)]);
        let drives = DriveOptions {
            transmission: 1,
            tells_longer,
            ..DriveOptions::default()
        };
        let options = PlantOptions {
            drives,
            ..PlantOptions::default()
        };
        bench.plant = Plant::new(bench.board.params(), &options).unwrap();
        let (mut rows, mut told, mut events) = (Vec::new(), 0, Vec::new());
        for tick in 0..30_000 {
            if tick == 29_000 {
                let z = bench.plant.drive(Axis::Z);
                z.trouble(Trouble::Fault(0x7305));
            }
            told += bench
                .answers
                .iter()
                .filter(|frame| matches!(frame.id().service(), Some((Service::Emcy, _))))
                .count();
            events.extend(bench.tick());
            rows.push((bench.output.setpoint, bench.plant.truth().positions));
        }
        (rows, told, events)
    };
    let (quiet, none, events) = run(false);
    let (rows, told, same) = run(true);
    assert_eq!(none, 1, "the fault of Z");
    // X, Z and C, and with three of four spindles also the first three, in every period.
    assert!(told > 3 * 29_000, "{told}");
    assert!(rows == quiet);
    assert_eq!(events, same);
    let alarms = events.iter().filter_map(|event| match event {
        Event::Alarm(alarm) => Some(alarm),
        _ => None,
    });
    let [alarm] = alarms.collect::<Vec<_>>()[..] else {
        panic!("{events:?}");
    };
    assert_eq!(alarm.code, Code::DriveFault);
    assert_eq!(alarm.args[3], Arg::Hex(0x7305));
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

/// The drives of a set, started at X 30 mm, Z −50 mm, and a board with another one.
fn apart(frame: i64, drives: &[(&str, i64)], board: &[(&str, i64)]) -> Bench {
    let mut of_board = vec![("9031", frame)];
    of_board.extend(board);
    let mut bench = Bench::new(&of_board);
    let mut of_drives = vec![("9031", frame)];
    of_drives.extend(drives);
    let params = with(&of_drives);
    let at = Position {
        x: Length::from_nm(30_000_000),
        z: Length::from_nm(-50_000_000),
        ..Position::default()
    };
    let options = PlantOptions {
        at,
        ..PlantOptions::default()
    };
    bench.plant = Plant::new(&params, &options).unwrap();
    bench.waiting.clear();
    bench
}

#[test]
fn drives_at_each_others_places_are_not_enabled_and_do_not_move() {
    for exchanged in [
        [("9015.X", 17), ("9015.Z", 16)],
        [("9015.Z", 18), ("9015.C", 17)],
        [("9015.X", 18), ("9015.C", 16)],
    ] {
        let mut bench = apart(1, &[], &exchanged);
        let stood = bench.plant.truth().positions;
        for _ in 0..3 {
            let mut alarmed = false;
            for _ in 0..3_000 {
                bench.tick();
                assert_eq!(bench.plant.truth().positions, stood, "{exchanged:?}");
                assert_ne!(bench.board.ticker().state(), State::Idle);
                alarmed |= bench.board.ticker().has_alarm();
            }
            assert!(alarmed, "{exchanged:?}");
            bench.board.command(Command::Reset);
        }
    }
}

/// Z is set up at the place of X by whoever speaks to it, and both stay operational.
fn listen_at_the_place_of_x(bench: &mut Bench) {
    let z = NodeId::DRIVE_Z;
    let write = |index: u16, sub: u8, value: u32, bytes: u8| {
        let [low, high] = index.to_le_bytes();
        let [a, b, c, d] = value.to_le_bytes();
        let command = if bytes == 1 { 0x2F } else { 0x23 };
        let bytes = [command, low, high, sub, a, b, c, d];
        Frame::new(CobId::of(Service::SdoRequest, z), &bytes).unwrap()
    };
    let own: Vec<u32> = DriveCommand::MAPPING.map(Mapped::raw).to_vec();
    let frames = [
        NmtCommand::PreOperational.frame(Some(z)),
        write(0x1400, 1, 0x8000_0481, 4),
        write(0x1600, 0, 0, 1),
        write(0x1600, 1, own[0], 4),
        write(0x1600, 2, own[1], 4),
        write(0x1600, 0, 2, 1),
        write(0x1400, 1, 0x481, 4),
        NmtCommand::Start.frame(Some(z)),
    ];
    for frame in frames {
        bench.plant.hear(&frame, |answer| {
            let refused = answer.id() == CobId::of(Service::SdoReply, z)
                && answer.payload().first() == Some(&0x80);
            assert!(!refused, "{answer:?}");
        });
    }
}

#[test]
fn two_drives_at_one_place_are_found_before_either_has_torque() {
    let mut bench = apart(1, &[], &[]);
    let stood = bench.plant.truth().positions;
    // Both have been in use; the board alone starts anew.
    for _ in 0..COMING_UP {
        bench.tick();
    }
    assert_eq!(bench.board.ticker().state(), State::Idle);
    listen_at_the_place_of_x(&mut bench);
    let params = with(&[("9031", 1)]);
    bench.board = Board::new(&params, None, None).unwrap();
    for _ in 0..3 {
        for _ in 0..2_000 {
            bench.tick();
            assert_eq!(bench.plant.truth().positions, stood);
            assert_ne!(bench.board.ticker().state(), State::Idle);
        }
        assert_eq!(bench.alarm.take(), Some(Code::DriveOverhears));
        bench.board.command(Command::Reset);
    }
}
