//! The plant and the pins around a board with two sides. This module knows no board.

use std::collections::VecDeque;

use leadscrew_app::{Machine, TickMachine};
use leadscrew_board_sim::plant::Plant;
use leadscrew_core::board::{Event, Held, Inputs, Region, StoreError, StoreRequest, Switching};
use leadscrew_core::bus::{CobId, Controller, Frame, Setpoints, is_sync};
use leadscrew_core::params::Params;
use leadscrew_core::spindle::EncoderSample;

/// The plant and the pins, for both sides.
pub struct Bench {
    pub plant: Plant,
    pub answers: VecDeque<Frame>,
    /// Frames of other nodes on the bus, for the background.
    pub others: VecDeque<Frame>,
    pub sent: Vec<Frame>,
    pub syncs: u32,
    /// The SYNC frame of the last tick.
    pub given: Option<Frame>,
    pub inputs: Inputs,
    /// Another hand turns the spindle: counts in addition to those of the plant, two a tick.
    pub turned: Option<i32>,
    /// The calls of the board's switches.
    pub switched: Vec<Switching>,
    pub events: Vec<Event>,
    pub fed: u32,
    pub writing: bool,
    pub controller: Controller,
    pub rejoined: u32,
    /// The time between two SYNCs, as given at each new beginning.
    pub periods: Vec<u32>,
}

impl TickMachine for Bench {
    fn sample(&mut self) -> EncoderSample {
        let mut sample = self.plant.advance();
        if let Some(turned) = &mut self.turned {
            *turned += 2;
            sample.count = sample.count.wrapping_add(*turned);
        }
        sample
    }

    fn inputs(&mut self) -> Inputs {
        self.inputs
    }

    fn receive(&mut self) -> Option<Frame> {
        self.answers.pop_front()
    }

    fn send(&mut self, frames: &[Frame], _: Option<&Setpoints>) -> bool {
        self.given = frames.iter().copied().find(is_sync);
        self.syncs += u32::from(self.given.is_some());
        let answers = &mut self.answers;
        self.plant
            .exchange(frames, |answer| answers.push_back(answer));
        true
    }

    fn switch(&mut self, switching: Switching) {
        self.switched.push(switching);
    }

    fn feed_watchdog(&mut self) {
        self.fed += 1;
    }
}

impl Machine for Bench {
    fn receive(&mut self) -> Option<Frame> {
        self.others.pop_front()
    }

    fn receive_fd(&mut self) -> Option<CobId> {
        None
    }

    fn handwheel(&mut self) -> u16 {
        0
    }

    fn has_room(&self) -> bool {
        true
    }

    fn send(&mut self, frame: &Frame) {
        self.sent.push(*frame);
    }

    fn load(&mut self, _: Region, then: &mut dyn FnMut(Held<'_>)) {
        then(Ok(None));
    }

    fn store(&mut self, _: &StoreRequest<'_>) {
        assert!(!self.writing, "the one before is done");
        self.writing = true;
    }

    fn stored(&mut self) -> Option<Result<(), StoreError>> {
        std::mem::take(&mut self.writing).then_some(Ok(()))
    }

    fn erases(&mut self) -> Option<u32> {
        None
    }

    fn event(&mut self, event: &Event) {
        self.events.push(*event);
    }

    fn controller(&mut self) -> Controller {
        self.controller
    }

    fn rejoin(&mut self) {
        self.controller = Controller::default();
        self.rejoined += 1;
    }

    fn begin_anew(&mut self, params: &Params) {
        self.periods.push(params.tick_us());
    }
}
