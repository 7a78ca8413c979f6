//! The surroundings of the board for the tick: the machine, and the wire to the drives.

use heapless::Deque;
use heapless::spsc::{Consumer, Producer};
use leadscrew_app::TickMachine;
use leadscrew_core::board::Inputs;
use leadscrew_core::bus::{CobId, Frame, NodeId, Setpoints};
use leadscrew_core::params::Params;
use leadscrew_core::spindle::EncoderSample;

use crate::around::{Lathe, Touch};
use crate::options::Options;
use crate::watchdog;

/// Room for the answers of seven drives to one SYNC, and their other frames.
const ANSWERS: usize = 32;

/// The machine around the board.
pub struct Shop {
    lathe: Lathe,
    /// The parameters that it was made with.
    params: &'static Params,
    /// The board's outputs.
    outputs: u16,
    /// What a hand does at the machine.
    touches: Consumer<'static, Touch>,
    /// The drives' frames, for the next tick.
    answers: Deque<Frame, ANSWERS>,
    wire: Wire,
    #[cfg(feature = "provoke")]
    provoke: Option<crate::provoke::Provoke>,
    /// Frames that other nodes on the wire have sent.
    asked: Consumer<'static, Frame>,
}

impl Shop {
    pub const fn new(
        lathe: Lathe,
        params: &'static Params,
        options: Options,
        touches: Consumer<'static, Touch>,
        told: Producer<'static, Frame>,
        asked: Consumer<'static, Frame>,
    ) -> Self {
        Self {
            lathe,
            params,
            outputs: 0,
            touches,
            answers: Deque::new(),
            wire: Wire {
                told,
                all: options.traffic,
            },
            #[cfg(feature = "provoke")]
            provoke: options.provoke,
            asked,
        }
    }
}

/// The way from the tick and the drives to the wire.
struct Wire {
    told: Producer<'static, Frame>,
    /// Process data go to the wire, too.
    all: bool,
}

impl Wire {
    fn tell(&mut self, frame: &Frame) {
        if self.all || !is_cyclic(frame) {
            // The thread runs no tick before there is room.
            let _ = self.told.enqueue(*frame);
        }
    }
}

/// True for SYNC and process data, which come in every period.
fn is_cyclic(frame: &Frame) -> bool {
    let id = frame.id();
    id == CobId::SYNC || (0x180..0x580).contains(&id.get())
}

impl TickMachine for Shop {
    fn sample(&mut self) -> EncoderSample {
        leadscrew_fault::tick();
        #[cfg(feature = "provoke")]
        if let Some(provoke) = &mut self.provoke {
            provoke.tick();
        }
        self.lathe.plant.advance()
    }

    fn inputs(&mut self) -> Inputs {
        while let Some(touch) = self.touches.dequeue() {
            self.lathe.touch(self.params, touch);
        }
        self.lathe.pins(self.params, self.outputs)
    }

    fn receive(&mut self) -> Option<Frame> {
        self.answers.pop_front()
    }

    /// The frame of CAN FD goes to the drives in the plant alone: the line carries none.
    fn send(&mut self, frames: &[Frame], together: Option<&Setpoints>) -> bool {
        for frame in frames {
            self.wire.tell(frame);
        }
        let (plant, answers, wire) = (&mut self.lathe.plant, &mut self.answers, &mut self.wire);
        let mut answer = |frame: Frame| {
            wire.tell(&frame);
            // Seven drives do not send more in a period.
            let _ = answers.push_back(frame);
        };
        while let Some(frame) = self.asked.dequeue() {
            plant.hear(&frame, &mut answer);
        }
        plant.exchange(frames, &mut answer);
        self.lathe.keep();
        if let Some(frame) = together.and_then(|setpoints| setpoints.frame(NodeId::BOARD)) {
            self.lathe.plant.tell_together(&frame);
        }
        true
    }

    fn set_outputs(&mut self, outputs: u16) {
        self.outputs = outputs;
    }

    fn feed_watchdog(&mut self) {
        watchdog::feed();
    }
}
