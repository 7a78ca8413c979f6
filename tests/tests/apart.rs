//! The two halves of a board run in separate contexts, as in firmware: the background comes late, hears of a stop even
//! later, and is in the middle of planning meanwhile. Nothing that was planned before a stop may be carried out after it.

use std::collections::VecDeque;

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::board::{Board, Command, Event, Inputs, Output, State};
use leadscrew_core::bus::Frame;
use leadscrew_core::call::Call;
use leadscrew_core::params::Params;
use leadscrew_tests::machine::calls;
use leadscrew_tests::random::Random;

const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q3000 F1\nG0 X61 Z-3\n\
                    G98 G75 R0.2\nG75 X58 P2000 F600\nG0 X70 Z8\nM30\n";
const NEXT: &str =
    "M3 S600\nG0 X63 Z5\nG76 P010560 Q800 R0.1\nG76 X61 Z-4 P4000 Q4000 F1\nG0 X80 Z10\nM30\n";

/// A board whose sides do not run in turn, and the plant.
struct Apart {
    board: Board,
    plant: Plant,
    answers: Vec<Frame>,
    output: Output,
    heard: Vec<Event>,
}

impl Apart {
    fn new(params: &Params) -> Self {
        Self {
            board: Board::new(params, None, None).expect("the parameters work"),
            plant: Plant::new(params, &PlantOptions::default()).expect("the plant works"),
            answers: Vec::new(),
            output: Output::default(),
            heard: Vec::new(),
        }
    }

    fn tick(&mut self) {
        let sample = self.plant.advance();
        let (mut tick, mut background) = self.board.split();
        tick.begin(&Inputs::default(), self.answers.drain(..));
        tick.run(sample, &mut self.output);
        let answers = &mut self.answers;
        self.plant
            .exchange(&self.output.frames, |frame| answers.push(frame));
        tick.report(&self.output, true);
        // Read by the test, which may not miss one; it tells the planner nothing.
        while let Some(event) = background.event() {
            self.heard.push(event);
        }
    }

    /// The background's turn: it does `pieces` of work, then hears what the tick has told, then takes calls in.
    fn turn(&mut self, pieces: i64, waiting: &mut VecDeque<Call>) {
        let (_, mut background) = self.board.split();
        for _ in 0..pieces {
            background.plan();
        }
        while background.hear() {}
        while let Some(call) = waiting.front()
            && background.offer(call)
        {
            waiting.pop_front();
        }
    }
}

#[test]
fn a_late_background_carries_nothing_over_a_stop() {
    leadscrew_seed::volume(0, |first| {
        let params = Params::sheets();
        let rounds = leadscrew_seed::amount(20, 600);
        let next: VecDeque<Call> = calls(NEXT, &params).into();
        for seed in (0..rounds).map(|round| first.wrapping_add(round)) {
            let mut random = Random(seed);
            let mut board = Apart::new(&params);
            let mut waiting: VecDeque<Call> = calls(WORK, &params).into();
            let command = random.of(&[Command::Reset, Command::Stop]);
            // While the drives come up there is nothing to reset.
            let first = if command == Command::Stop { 1 } else { 60 };
            let stop_at = random.within(first, 2_500);
            let laziness = random.within(1, 30);
            let mut ticks = 0;
            let mut old = true;
            let mut finished = 0;
            while finished == 0 {
                ticks += 1;
                assert!(
                    ticks < 20_000,
                    "seed {seed}: stuck in {:?}",
                    board.board.ticker().state()
                );
                if ticks == stop_at {
                    board.board.command(command);
                }
                board.tick();
                for event in board.heard.split_off(0) {
                    match event {
                        Event::Finished if !old => finished += 1,
                        Event::Started { .. } => {
                            // Between the stop and the new program nothing is started.
                            assert!(
                                old || waiting.len() < next.len(),
                                "seed {seed}: something old"
                            );
                        }
                        Event::Reset => {
                            old = false;
                            waiting = next.clone();
                        }
                        Event::Alarm(alarm) => {
                            assert_eq!(alarm.number(), 4300, "seed {seed}: {alarm:?}");
                            waiting.clear();
                        }
                        Event::Ready if ticks > stop_at && matches!(command, Command::Stop) => {
                            old = false;
                            waiting = next.clone();
                        }
                        _ => {}
                    }
                }
                if matches!(board.board.ticker().state(), State::Alarm(_)) && random.chance(5) {
                    board.board.command(Command::Reset);
                }
                // It may never be short of work in the middle of a tick's worth of it.
                if random.within(1, laziness) == 1 {
                    let pieces = random.within(0, 12);
                    board.turn(pieces, &mut waiting);
                }
            }
            let at = board.board.ticker().executor().position();
            assert_eq!(
                (at.x.nm(), at.z.nm()),
                (40_000_000, 10_000_000),
                "seed {seed}"
            );
        }
    });
}
