//! The machine on a wire with faults, and a board that loses its power and restarts.

use heapless::Vec;
use leadscrew_core::board::Board;
use leadscrew_core::bus::{Frame, NmtCommand};
use leadscrew_core::params::Params;

use super::{ANSWERS, Direction, OUT, Sim, SimError};
use crate::line::{Faults, Harm, Line, Way};
use crate::storage::{stored_params, stored_tap};

/// The most frames that reach the drives in a period: all of them twice, and those of the previous period.
const ARRIVED: usize = 48;

impl Sim {
    /// Gives the wire these faults from the next tick on; their ticks are the ticks of the rows.
    pub fn spoil(&mut self, faults: Faults) {
        self.wire = Line::new(faults);
    }

    /// The number of changed frames since [`spoil`](Self::spoil).
    #[must_use]
    pub const fn harm(&self) -> Harm {
        self.wire.harm()
    }

    /// Applies the faults of the wire to this tick.
    pub(super) fn suffer(&mut self) {
        let rejoin = self.board.device().may_rejoin();
        let second = self.wire.tick(self.ticks, rejoin);
        for way in [Way::Statuses, Way::In, Way::Out] {
            let Some(frame) = self.wire.release(way) else {
                continue;
            };
            match way {
                Way::In => self.hear(&frame),
                Way::Out => {
                    let _ = self.out.push_back(frame);
                }
                Way::Statuses | Way::Setpoints => {
                    let _ = self.answers.push(frame);
                }
            }
        }
        if let Some(frame) = second {
            // `hear` passes other nodes' frames to the drives, but no process data.
            let managed = NmtCommand::decode(&frame).is_some();
            let frames = if managed { &[][..] } else { &[frame] };
            let answers = &mut self.answers;
            self.plant.exchange(frames, |answer| {
                let _ = answers.push(answer);
            });
            self.hear(&frame);
        }
        self.board.set_late(self.wire.harm().late);
        self.board.bus_state(self.wire.controller());
    }

    pub(super) fn exchange_on_bad_wire(
        &mut self,
        frames: &[Frame],
        show: &mut dyn FnMut(Direction, &Frame),
    ) {
        let mut arrived: Vec<Frame, ARRIVED> = Vec::new();
        for frame in frames {
            show(Direction::FromBoard, frame);
            self.wire.pass(Way::Setpoints, frame, |frame| {
                let _ = arrived.push(frame);
            });
        }
        let mut told: Vec<Frame, ANSWERS> = Vec::new();
        self.plant.exchange(&arrived, |frame| {
            let _ = told.push(frame);
        });
        let answers = &mut self.answers;
        for frame in &told {
            show(Direction::ToBoard, frame);
            self.wire.pass(Way::Statuses, frame, |frame| {
                let _ = answers.push(frame);
            });
        }
    }

    pub(super) fn receive_on_bad_wire(&mut self, frame: &Frame) {
        let mut arrived: Vec<Frame, OUT> = Vec::new();
        self.wire.pass(Way::In, frame, |frame| {
            let _ = arrived.push(frame);
        });
        for frame in &arrived {
            self.hear(frame);
        }
    }

    pub(super) fn transmit_on_bad_wire(&mut self) -> Option<Frame> {
        loop {
            if let Some(frame) = self.out.pop_front() {
                return Some(frame);
            }
            let frame = self.next_out()?;
            let out = &mut self.out;
            self.wire.pass(Way::Out, &frame, |frame| {
                let _ = out.push_back(frame);
            });
        }
    }

    /// The board loses its power, and gets it back after this number of periods without SYNC. Drives and spindle keep
    /// theirs. The board then knows only the content of its flash and the `built_in` set, and has not joined a network.
    ///
    /// # Errors
    /// As [`with_flash`](Self::with_flash).
    pub fn restart_board(&mut self, built_in: &Params, off: u32) -> Result<(), SimError> {
        self.cut_power();
        self.answers.clear();
        self.out.clear();
        self.pending.clear();
        self.line = None;
        for _ in 0..off {
            self.advance();
        }
        self.flash.power(true);
        let tap = stored_tap(&mut self.flash).map_err(SimError::Board)?;
        let up = stored_params(&mut self.flash, built_in).map_err(SimError::Board)?;
        self.board = Board::power_up(&up, None, tap).map_err(SimError::Board)?;
        self.start(None).map(|_| ())
    }
}
