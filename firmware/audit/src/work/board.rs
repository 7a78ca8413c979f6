//! Whole ticks of the board, with the plant around it; a step is a tick. The plant and the background are not counted.

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::board::{self, Board, Output};
use leadscrew_core::bus::{Frame, SyncProducer};
use leadscrew_core::motion::{Motion, Setpoint};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Call, Event, Events, Options};
use leadscrew_core::spindle::EncoderSample;

use super::{Work, until};

/// Every kind of motion, a block a line. The lines are told apart below.
const PROGRAM: &str = "O0001\n\
    M3 S300 G0 X80 Z10\n\
    G1 X60 Z-20 C90 F800\n\
    G3 X80 Z-30 R10\n\
    G0 X80 Z10\n\
    G76 P010060 Q1000 R0.1\n\
    G76 X60.64 Z-32 P36800 Q30000 F6\n\
    M30\n";
const LINE: u32 = 3;
const ARC: u32 = 4;
const THREAD: u32 = 7;

const KINDS: &[&str] = &["/idle", "/rapid", "/line", "/arc", "/wait", "/thread"];

const CALLS: usize = 16;
const ANSWERS: usize = 16;
/// More ticks than the program takes.
const LONGEST: usize = 16_384;

/// The program on a board.
pub struct WholeBoard {
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
    pub fn new() -> Self {
        let params = Params::slant_bed();
        let mut calls = [None; CALLS];
        let events = Events::new(PROGRAM.as_bytes(), &params, Options::default());
        let made = events.filter_map(|event| match event.expect("a program without a mistake") {
            Event::Call(call) => Some(call),
            Event::Warning(_) => None,
        });
        for (place, call) in calls.iter_mut().zip(made) {
            *place = Some(call);
        }
        Self { params, calls }
    }
}

impl Work for WholeBoard {
    type State = Machine;
    type Out = Setpoint;

    fn steps(&self) -> usize {
        let mut machine = self.begin();
        until(LONGEST, |number| {
            self.prepare(&mut machine, number);
            let output = self.step(&mut machine, number);
            self.finish(&mut machine, &output);
            let offered = matches!(self.calls.get(machine.taken), None | Some(None));
            offered && !machine.board.is_busy()
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

    fn prepare(&self, machine: &mut Machine, _: usize) {
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
    }

    fn step(&self, machine: &mut Machine, _: usize) -> Setpoint {
        let received = machine
            .answers
            .get(..machine.answered)
            .unwrap_or(&machine.answers);
        machine
            .board
            .tick(machine.sample, received, &mut machine.output);
        machine.output.setpoint
    }

    fn finish(&self, machine: &mut Machine, _: &Setpoint) {
        // The storage is done at once.
        if let Some(request) = machine.board.store() {
            machine.board.stored(request.region, Ok(()));
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
        KINDS
    }

    fn kind(&self, setpoint: &Setpoint) -> usize {
        match (setpoint.motion, setpoint.line) {
            (Motion::Idle, _) => 0,
            (Motion::Run, LINE) => 2,
            (Motion::Run, ARC) => 3,
            (Motion::Run, THREAD) if setpoint.locked => 5,
            (Motion::Run, _) => 1,
            _ => 4,
        }
    }
}
