//! Whole ticks of the board, with the plant around it; a step is a tick. The plant and the background are not counted.

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::board::{self, Board, Command, Inputs, Output};
use leadscrew_core::bus::{Frame, SyncProducer};
use leadscrew_core::call::Call;
use leadscrew_core::motion::Motion;
use leadscrew_core::params::{Entry, Params, Part};
use leadscrew_core::program::{Event, Events, Options};
use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::Axis;

use super::{Work, until};

/// A program, and the way to classify its ticks.
pub struct Program {
    text: &'static str,
    /// Spindles of the machine, each with a drive.
    spindles: i64,
    /// 5200.5: pecks go back to R.
    deep: bool,
    /// Feed-forward of the drives of X and Z, whose gain is known, in tenths of a per cent (9070, 9071).
    lag: Option<i64>,
    /// Counts of the encoder (3720), where they are few.
    few: Option<i64>,
    /// The tick before which the emergency stop is pressed.
    stop: Option<usize>,
    kinds: &'static [&'static str],
    kind: fn(&Seen) -> usize,
}

/// The state of a tick, to classify it.
pub struct Seen {
    motion: Motion,
    line: u32,
    locked: bool,
    alarm: bool,
}

/// Every kind of motion without a tap, one block to a line.
pub const MOVES: Program = Program {
    text: "O0001\n\
        M3 S300 G0 X80 Z10\n\
        G1 X60 Z-20 C90 F800\n\
        G3 X80 Z-30 R10\n\
        G0 X80 Z10\n\
        G76 P010060 Q1000 R0.1\n\
        G76 X60.64 Z-32 P36800 Q30000 F6\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/idle", "/rapid", "/line", "/arc", "/wait", "/thread"],
    kind: |seen| match (seen.motion, seen.line) {
        (Motion::Idle, _) => 0,
        (Motion::Run, 3) => 2,
        (Motion::Run, 4) => 3,
        (Motion::Run, 7) if seen.locked => 5,
        (Motion::Run, _) => 1,
        _ => 4,
    },
};

/// The same program with three more spindles, which stand still: seven drives.
pub const SEVEN_DRIVES: Program = Program {
    spindles: 4,
    kinds: &["/seven-drives"],
    kind: |_| 0,
    ..MOVES
};

/// The same program where the board takes off the lag of the drives of X and Z.
pub const LAGS: Program = Program {
    lag: Some(0),
    kinds: &["/lags"],
    kind: |_| 0,
    ..MOVES
};

/// The same with a feed-forward in these drives.
pub const LAGS_FORWARD: Program = Program {
    lag: Some(500),
    kinds: &["/lags-forward"],
    ..LAGS
};

/// The same program with an encoder of few counts: the thread follows an angle that is learned.
pub const LEARNED: Program = Program {
    few: Some(40),
    kinds: &["/learned-moves", "/learned-wait", "/learned-thread"],
    kind: |seen| match (seen.line, seen.locked) {
        (7, true) => 2,
        (7, false) => 1,
        _ => 0,
    },
    ..MOVES
};

/// Constant surface speed, with the feed by the measured spindle: a rapid, a face and an arc.
pub const SURFACE: Program = Program {
    text: "O0007\n\
        G99 G50 S2500\n\
        G96 S150 M3 G0 X60 Z0\n\
        G1 X20 F0.3\n\
        G3 X40 Z-10 R10\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/to-surface", "/surface-line", "/surface-arc"],
    kind: tap_kind,
};

/// Cuts that are joined, at constant surface speed: a line, and an arc that goes on in its direction.
pub const JOINED: Program = Program {
    text: "O0008\n\
        G99 G50 S2500\n\
        G96 S150 M3 G0 X40 Z2\n\
        G1 Z-20 F0.3\n\
        G2 X50 Z-25 R5\n\
        G1 X60\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/to-joined", "/joined-line", "/joined-arc"],
    kind: tap_kind,
};

/// An ordinary tap: the axis follows the measured spindle through stop and reversal.
pub const ORDINARY_TAP: Program = Program {
    text: "O0006\n\
        G98 M3 S300 G0 X0 Z5\n\
        G84 Z-20 R-5 P300 F600\n\
        G80\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/to-ordinary", "/tap-ordinary"],
    kind: |seen| usize::from(seen.line == 3),
};

/// Taps in one go and in pecks, from a turning spindle through rigid mode and back.
pub const TAPS: Program = Program {
    text: "O0002\n\
        G98 M3 S300 G0 X0 Z5\n\
        M29 S1000\n\
        G84 Z-20 R-5 P300 F2000\n\
        G84 Z-20 R-5 Q4.0 P300 F2000\n\
        G80\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/to-rigid", "/tap", "/tap-peck"],
    kind: tap_kind,
};

/// A tap in pecks that goes back to R each time.
pub const DEEP_TAP: Program = Program {
    text: "O0003\n\
        G98 M3 S300 G0 X0 Z5\n\
        M29 S1000\n\
        G84 Z-20 R-5 Q4.0 P300 F2000\n\
        G80\n\
        M30\n",
    spindles: 1,
    deep: true,
    lag: None,
    few: None,
    stop: None,
    kinds: &["/to-rigid-deep", "/tap-deep"],
    kind: tap_kind,
};

/// An emergency stop in a thread.
pub const STOP_IN_THREAD: Program = Program {
    text: "O0004\n\
        M3 S300 G0 X10 Z8\n\
        G76 P010060 Q1000 R0.1\n\
        G76 X0.64 Z-42 P36800 Q30000 F6\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: Some(1500),
    kinds: &["/to-stop", "/stop"],
    kind: |seen| usize::from(seen.alarm),
};

/// An emergency stop in a tap.
pub const STOP_IN_TAP: Program = Program {
    text: "O0005\n\
        G98 M29 S1000\n\
        G84 Z-20 R-5 P300 F2000\n\
        G80\n\
        M30\n",
    spindles: 1,
    deep: false,
    lag: None,
    few: None,
    stop: Some(450),
    kinds: &["/to-stop-tap", "/stop-tap"],
    kind: |seen| usize::from(seen.alarm),
};

/// Classified by the lines 4 and 5, the taps or cuts; all other lines are the way into rigid mode and out of it.
fn tap_kind(seen: &Seen) -> usize {
    match seen.line {
        4 => 1,
        5 => 2,
        _ => 0,
    }
}

const CALLS: usize = 16;
const ANSWERS: usize = 16;
/// More ticks than the program takes.
const LONGEST: usize = 16_384;

/// A program on a board.
pub struct WholeBoard {
    program: Program,
    params: Params,
    calls: [Option<Call>; CALLS],
}

/// A machine at work.
pub struct Machine {
    board: Board,
    plant: Plant,
    sample: EncoderSample,
    answers: [Frame; ANSWERS],
    answered: usize,
    output: Output,
    /// The drives are enabled.
    ready: bool,
    /// Calls the board has taken.
    taken: usize,
}

impl WholeBoard {
    /// The work.
    pub fn new(program: Program) -> Self {
        let mut params = Params::sheets();
        let deep = Entry::find(5200, Some(Part::Bit(5))).expect("in the table");
        let spindles = Entry::find_text("tap_spindles").expect("in the table");
        for (entry, value) in [
            (deep, i64::from(program.deep)),
            (spindles, program.spindles),
        ] {
            params.set(entry, value).expect("within its range");
        }
        if let Some(counts) = program.few {
            let entry = Entry::find_text("encoder_counts").expect("in the table");
            params.set(entry, counts).expect("within its range");
        }
        if let Some(forward) = program.lag {
            for (number, value) in [(9070, 300), (9071, forward)] {
                for axis in [Axis::X, Axis::Z] {
                    let entry = Entry::find(number, Some(Part::Axis(axis))).expect("in the table");
                    params.set(entry, value).expect("within its range");
                }
            }
        }
        let mut calls = [None; CALLS];
        let events = Events::new(program.text.as_bytes(), &params, Options::default());
        let made = events.filter_map(|event| match event.expect("a program without a mistake") {
            Event::Call(call) => Some(call),
            Event::Warning(_) => None,
        });
        for (place, call) in calls.iter_mut().zip(made) {
            *place = Some(call);
        }
        Self {
            program,
            params,
            calls,
        }
    }
}

impl Work for WholeBoard {
    type State = Machine;
    type Out = ();

    fn steps(&self) -> usize {
        let mut machine = self.begin();
        until(LONGEST, |number| {
            self.prepare(&mut machine, number);
            self.step(&mut machine, number);
            let alarm = machine.board.ticker().has_alarm();
            self.finish(&mut machine, &());
            let offered = matches!(self.calls.get(machine.taken), None | Some(None));
            let over = offered || alarm;
            over && !machine.board.is_busy()
        })
    }

    fn begin(&self) -> Machine {
        let plant = Plant::new(&self.params, &PlantOptions::default());
        Machine {
            board: Board::new(&self.params, Some(PlantOptions::default().at), None)
                .expect("the built-in machine"),
            plant: plant.expect("the built-in machine"),
            sample: EncoderSample::default(),
            answers: [SyncProducer::new().next(); ANSWERS],
            answered: 0,
            output: Output::default(),
            ready: false,
            taken: 0,
        }
    }

    fn prepare(&self, machine: &mut Machine, number: usize) {
        if self.program.stop == Some(number) {
            machine.board.command(Command::Stop);
        }
        while let Some(event) = machine.board.event() {
            machine.ready |= event == board::Event::Ready;
        }
        while machine.ready
            && let Some(Some(call)) = self.calls.get(machine.taken)
            && machine.board.offer(call)
        {
            machine.taken += 1;
        }
        while machine.board.background() {}
        machine.sample = machine.plant.advance();
        let received = machine
            .answers
            .get(..machine.answered)
            .unwrap_or(&machine.answers);
        let (mut tick, _) = machine.board.split();
        tick.begin(&Inputs::default(), received.iter().copied());
    }

    fn step(&self, machine: &mut Machine, _: usize) {
        let (mut tick, _) = machine.board.split();
        tick.run(machine.sample, &mut machine.output);
    }

    fn finish(&self, machine: &mut Machine, (): &()) {
        let (mut tick, _) = machine.board.split();
        tick.report(&machine.output, true);
        machine.board.hear();
        // The storage finishes at once.
        if let Some(request) = machine.board.store() {
            let region = request.region;
            machine.board.stored(region, Ok(()));
        }
        machine.answered = 0;
        let (answers, answered) = (&mut machine.answers, &mut machine.answered);
        machine.plant.exchange(&machine.output.frames, |frame| {
            if let Some(place) = answers.get_mut(*answered) {
                *place = frame;
                *answered += 1;
            }
        });
    }

    fn kinds(&self) -> &'static [&'static str] {
        self.program.kinds
    }

    fn kind(&self, machine: &Machine) -> usize {
        let setpoint = &machine.output.setpoint;
        (self.program.kind)(&Seen {
            motion: setpoint.motion,
            line: setpoint.line,
            locked: setpoint.locked,
            alarm: machine.board.ticker().has_alarm(),
        })
    }
}
