//! The outside world for the background: the wire, and the flash.

use heapless::Deque;
use heapless::spsc::{Consumer, Producer};
use leadscrew_app::Machine;
use leadscrew_core::board::{Event, Held, Region, StoreError, StoreRequest};
use leadscrew_core::bus::{CobId, Controller, Frame, NodeId, Service};
use leadscrew_core::params::Params;
use leadscrew_slcan::{Adapter, Lines, Reply, SlcanFrame};
use leadscrew_store::BUFFER;

use crate::flash::RamFlash;
use crate::log;
use crate::pace::Times;
use crate::uart::Uart;

/// The most bytes that wait to be sent.
const OUT: usize = 4096;
/// The longest line: a frame, or the answer to a request.
const LINE: usize = 32;
/// The most frames that a tick and its drives send.
const BURST: usize = 40;
/// The most received frames that wait to be read.
const IN: usize = 64;

/// The wire and the flash.
pub struct Outside {
    bytes: Consumer<'static, u8>,
    lines: Lines,
    adapter: Adapter,
    out: Deque<u8, OUT>,
    program_buffer: Deque<Frame, IN>,
    told: Consumer<'static, Frame>,
    asked: Producer<'static, Frame>,
    flash: RamFlash,
    result: Option<Result<(), StoreError>>,
    erases: Option<u32>,
    /// The gateway was heard since the last question.
    beat: bool,
    /// The times of other parameters that have come into force.
    times: Option<Times>,
    ms: u64,
}

impl Outside {
    pub const fn new(
        bytes: Consumer<'static, u8>,
        told: Consumer<'static, Frame>,
        asked: Producer<'static, Frame>,
        flash: RamFlash,
    ) -> Self {
        Self {
            bytes,
            lines: Lines::new(),
            adapter: Adapter::new(1, 1, *b"LS01"),
            out: Deque::new(),
            program_buffer: Deque::new(),
            told,
            asked,
            flash,
            result: None,
            erases: None,
            beat: false,
            times: None,
            ms: 0,
        }
    }

    /// Reads received bytes and sends waiting ones, at this real time. True where bytes were received.
    pub fn pump(&mut self, ms: u64) -> bool {
        self.ms = ms;
        while self.has_room()
            && let Some(frame) = self.told.dequeue()
        {
            self.say(&frame);
        }
        let mut came = false;
        while !self.program_buffer.is_full()
            && self.has_room()
            && let Some(byte) = self.bytes.dequeue()
        {
            came = true;
            let Some(heard) = self.lines.push(byte) else {
                continue;
            };
            let handled = self.adapter.handle(heard);
            self.write(&handled.reply);
            if let Some(SlcanFrame::Data(frame)) = handled.send {
                self.take(frame);
            }
        }
        while Uart::BUS.has_room()
            && let Some(byte) = self.out.pop_front()
        {
            Uart::BUS.send(byte);
        }
        came
    }

    /// True where everything from before a tick was sent, and everything received was read. So an answer waits
    /// for the frames of one tick at most, however slow the line is.
    pub fn takes_tick(&self) -> bool {
        const {
            assert!(OUT >= 2 * BURST * LINE, "a tick has room");
        }
        self.told.is_empty() && self.out.is_empty() && self.program_buffer.is_empty()
    }

    /// True where everything was sent.
    pub fn is_quiet(&self) -> bool {
        self.out.is_empty()
    }

    /// True where the gateway was heard since the last question.
    pub const fn has_heard_gateway(&mut self) -> bool {
        core::mem::replace(&mut self.beat, false)
    }

    /// The times of other parameters; each is given once.
    pub const fn new_times(&mut self) -> Option<Times> {
        self.times.take()
    }

    fn take(&mut self, frame: Frame) {
        self.beat |= frame.id().service() == Some((Service::Heartbeat, NodeId::GATEWAY));
        // Everybody on a bus hears everything. There is room for the board; the drives have a queue of their own, and as on
        // a bus that is flooded one of them may miss a frame.
        let _ = self.program_buffer.push_back(frame);
        let _ = self.asked.enqueue(frame);
    }

    fn say(&mut self, frame: &Frame) {
        if let Some(reply) = self.adapter.received(&SlcanFrame::Data(*frame), self.ms) {
            self.write(&reply);
        }
    }

    fn write(&mut self, reply: &Reply) {
        for byte in reply.line().bytes() {
            // The caller has checked the room.
            let _ = self.out.push_back(*byte);
        }
    }
}

impl Machine for Outside {
    fn receive(&mut self) -> Option<Frame> {
        self.program_buffer.pop_front()
    }

    /// The line carries no frames of CAN FD.
    fn receive_fd(&mut self) -> Option<CobId> {
        None
    }

    fn handwheel(&mut self) -> u16 {
        0
    }

    fn has_room(&self) -> bool {
        OUT - self.out.len() >= 2 * LINE
    }

    fn send(&mut self, frame: &Frame) {
        self.say(frame);
    }

    fn store(&mut self, request: &StoreRequest<'_>) {
        let (result, erases) = self.flash.write(request);
        (self.result, self.erases) = (Some(result), erases);
    }

    fn stored(&mut self) -> Option<Result<(), StoreError>> {
        self.result.take()
    }

    fn erases(&mut self) -> Option<u32> {
        self.erases.take()
    }

    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>)) {
        let mut buffer = [0; BUFFER];
        then(self.flash.read(region, &mut buffer));
    }

    fn event(&mut self, event: &Event) {
        #[cfg(feature = "provoke")]
        if let Event::Started { line, .. } = event {
            crate::provoke::line(*line);
        }
        log::event(event);
    }

    /// This wire loses nothing, so its controller is always in order.
    fn controller(&mut self) -> Controller {
        Controller::default()
    }

    fn rejoin(&mut self) {}

    fn begin_anew(&mut self, params: &Params) {
        self.times = Some(Times::of(params));
    }
}
