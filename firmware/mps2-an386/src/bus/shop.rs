//! What is around the board, as the tick sees it: the plant, and the wire to the drives.

use heapless::Deque;
use heapless::spsc::{Consumer, Producer};
use leadscrew_app::{Inputs, TickMachine};
use leadscrew_board_sim::plant::Plant;
use leadscrew_core::bus::Frame;
use leadscrew_core::spindle::EncoderSample;

use crate::options::Options;

/// Answers of seven drives to one SYNC, and what they say besides.
const ANSWERS: usize = 32;

/// The plant around the board.
pub struct Shop {
    plant: Plant,
    /// The drives' frames, for the next tick.
    answers: Deque<Frame, ANSWERS>,
    options: Options,
    told: Producer<'static, Frame>,
    /// What others on the wire have said.
    asked: Consumer<'static, Frame>,
    #[cfg(feature = "provoke")]
    ticks: u32,
}

impl Shop {
    pub const fn new(
        plant: Plant,
        options: Options,
        told: Producer<'static, Frame>,
        asked: Consumer<'static, Frame>,
    ) -> Self {
        Self {
            plant,
            answers: Deque::new(),
            options,
            told,
            asked,
            #[cfg(feature = "provoke")]
            ticks: 0,
        }
    }

    fn exchange(&mut self, frames: &[Frame]) {
        let (answers, told, traffic) = (&mut self.answers, &mut self.told, self.options.traffic);
        let mut tell = |frame: &Frame| {
            if traffic {
                // The thread lets no tick happen before it has room.
                let _ = told.enqueue(*frame);
            }
        };
        frames.iter().for_each(&mut tell);
        self.plant.exchange(frames, |answer| {
            tell(&answer);
            // Seven drives do not say more in a period.
            let _ = answers.push_back(answer);
        });
    }
}

impl TickMachine for Shop {
    fn sample(&mut self) -> EncoderSample {
        leadscrew_fault::tick();
        #[cfg(feature = "provoke")]
        {
            self.ticks += 1;
            if let Some(provoke) = self.options.provoke {
                provoke.act(self.ticks);
            }
        }
        self.plant.advance()
    }

    fn inputs(&mut self) -> Inputs {
        Inputs::default()
    }

    fn receive(&mut self) -> Option<Frame> {
        self.answers.pop_front()
    }

    fn send(&mut self, frames: &[Frame]) -> bool {
        while let Some(frame) = self.asked.dequeue() {
            self.exchange(&[frame]);
        }
        self.exchange(frames);
        true
    }

    fn feed_watchdog(&mut self) {}
}
