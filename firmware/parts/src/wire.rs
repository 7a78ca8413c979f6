//! Frames between a CAN controller and the two sides of a board.
//!
//! ```text
//! controller ──► interrupt ───heard──► tick (what is not a drive's goes on to the background)
//!                          ──requests─► background
//! controller ◄── interrupt ◄─setpoints─ tick
//!                          ◄──others─── background
//! ```
//!
//! The interrupt of the controller, right below the tick, fills its places ([`Gate`] says with what); only SYNC is put in
//! by the tick itself, so that it leaves at once.
//!
//! The tick may come at any instruction of the interrupt. What that has looked at is void then: a frame that was to go may
//! have been given up, a place may be taken, SYNC may be missing again. So every tick has a number. The interrupt reads it
//! first, looks and decides; then it keeps the tick out for the few instructions in which it puts a frame in and
//! marks its place, and does so only while the number is the one it began with. Frames that are given up are known by
//! their own number, which is compared with that of the tick behind each look at the ring.
//!
//! Knows no register: those are behind [`Chip`].

use heapless::spsc::Queue;
use leadscrew_core::board::FRAMES;
use leadscrew_core::bus::{Frame, Service};

use crate::gate::{Gate, Turn};
use crate::message::to_send;
use crate::shared::{In, Out, Word};

#[cfg(test)]
mod tests;

// One place of a ring stays empty. In a period come two frames of each drive, and heartbeats.
const HEARD: usize = 33;
// While a page of the flash is erased nobody reads them: a transfer that is faster begins its block again.
const REQUESTS: usize = 33;
const OTHERS: usize = 9;

/// Places of a controller for frames to be sent, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Places(pub u32);

impl Places {
    /// How many a controller has.
    pub const COUNT: u8 = 3;
    /// All of them.
    pub const ALL: Self = Self((1 << Self::COUNT) - 1);

    /// How many these are.
    #[must_use]
    pub const fn count(self) -> u8 {
        self.0.count_ones() as u8
    }

    /// True for none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// The controller, and the timer that gives the beat.
pub trait Chip {
    /// A frame that has been received.
    fn take(&self) -> Option<Frame>;
    /// Puts the words of a frame ([`to_send`]) into the controller; its place comes back, or `None` where there is none.
    /// Not to be interrupted by itself.
    fn put(&self, words: &[u32; 4]) -> Option<Places>;
    /// Places whose frame has not been sent yet.
    fn pending(&self) -> Places;
    /// Calls the frames in these places back, but for one that is on the wire already.
    fn call_back(&self, places: Places);
    /// It has left the bus, or is on its way back, or does not send.
    fn is_off(&self) -> bool;
    /// Lets the interrupt run as soon as nothing more urgent does.
    fn poke(&self);
    /// The length of a period.
    fn period_us(&self) -> u32;
    /// Microseconds since the last beat.
    fn since_us(&self) -> u32;
    /// Does this with the tick kept out.
    fn alone(&self, work: impl FnOnce());
}

/// A frame of a tick on its way, and the number of that tick.
struct Setpoint {
    tick: u32,
    frame: Frame,
}

/// What tick and interrupt tell each other beside the rings.
struct Shared {
    /// The number of the last tick that has sent. Written by the tick.
    tick: Word,
    /// The places of the controller that were filled for a tick last. Written by the tick, and by the interrupt while it
    /// keeps the tick out.
    places: Word,
    /// How many frames of that tick the interrupt has put in. Written as the places are.
    done: Word,
}

/// All that lies between the three.
pub struct Rings {
    shared: Shared,
    heard: Queue<Frame, HEARD>,
    requests: Queue<Frame, REQUESTS>,
    // Those of a tick that has been given up, until the interrupt has thrown them away, and those of the next.
    setpoints: Queue<Setpoint, { 2 * FRAMES + 1 }>,
    others: Queue<Frame, OTHERS>,
}

/// The tick's end.
pub struct TickEnd<'a> {
    shared: &'a Shared,
    heard: Out<'a, Frame>,
    /// Frames of the tick before that the interrupt was to put in.
    left: u32,
    setpoints: In<'a, Setpoint>,
}

/// The background's end.
pub struct BackgroundEnd<'a> {
    requests: Out<'a, Frame>,
    others: In<'a, Frame>,
}

/// The interrupt's end.
pub struct BusEnd<'a> {
    shared: &'a Shared,
    heard: In<'a, Frame>,
    requests: In<'a, Frame>,
    setpoints: Out<'a, Setpoint>,
    others: Out<'a, Frame>,
    period_us: u32,
    gate: Gate,
    kbit: u32,
}

impl Rings {
    /// All of them empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shared: Shared {
                tick: Word::new(0),
                places: Word::new(0),
                done: Word::new(0),
            },
            heard: Queue::new(),
            requests: Queue::new(),
            setpoints: Queue::new(),
            others: Queue::new(),
        }
    }

    /// The ends, for a bus of so many kilobits a second.
    pub fn split(&mut self, kbit: u32) -> (TickEnd<'_>, BackgroundEnd<'_>, BusEnd<'_>) {
        let shared = &self.shared;
        let (heard_in, heard_out) = self.heard.split();
        let (requests_in, requests_out) = self.requests.split();
        let (setpoints_in, setpoints_out) = self.setpoints.split();
        let (others_in, others_out) = self.others.split();
        let tick = TickEnd {
            shared,
            heard: Out(heard_out),
            left: 0,
            setpoints: In(setpoints_in),
        };
        let background = BackgroundEnd {
            requests: Out(requests_out),
            others: In(others_in),
        };
        let bus = BusEnd {
            shared,
            heard: In(heard_in),
            requests: In(requests_in),
            setpoints: Out(setpoints_out),
            others: Out(others_out),
            period_us: 0,
            gate: Gate::new(0, kbit),
            kbit,
        };
        (tick, background, bus)
    }
}

impl Default for Rings {
    fn default() -> Self {
        Self::new()
    }
}

impl TickEnd<'_> {
    /// The oldest frame not yet read.
    pub fn receive(&mut self) -> Option<Frame> {
        self.heard.take()
    }

    /// Sends the frames of a tick, SYNC first; once in each, also where there are none. False where some of the tick before
    /// have not left: they are called back.
    pub fn send(&mut self, frames: &[Frame], chip: &impl Chip) -> bool {
        let left = Places(chip.pending().0 & self.shared.places.get());
        let in_time = left.is_empty() && self.shared.done.get() == self.left;
        let tick = self.shared.tick.get().wrapping_add(1);
        self.shared.tick.set(tick);
        if !left.is_empty() {
            chip.call_back(left);
        }
        let mut frames = frames.iter();
        let mut mine = left;
        if let Some(sync) = frames.as_slice().first()
            && let Some(place) = chip.put(&to_send(sync))
        {
            mine.0 |= place.0;
            frames.next();
        }
        self.shared.places.set(mine.0);
        self.shared.done.set(0);
        self.left = frames.as_slice().len() as u32;
        for frame in frames {
            let frame = *frame;
            // There is room for two ticks.
            let _ = self.setpoints.put(Setpoint { tick, frame });
        }
        chip.poke();
        in_time
    }
}

impl BackgroundEnd<'_> {
    /// The oldest request not yet read.
    pub fn receive(&mut self) -> Option<Frame> {
        self.requests.take()
    }

    /// True where there is room for a frame.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.others.has_room()
    }

    /// Sends a frame behind those of the tick. There is room.
    pub fn send(&mut self, frame: &Frame, chip: &impl Chip) {
        let _ = self.others.put(*frame);
        chip.poke();
    }
}

impl BusEnd<'_> {
    /// The interrupt: reads what has come, and fills what is free. False where a frame has come that there was no room for.
    /// It is lost as on the wire: drives that fall silent are missed, requests are made again.
    pub fn serve(&mut self, chip: &impl Chip) -> bool {
        let mut kept = true;
        while let Some(frame) = chip.take() {
            let ring = if is_request(&frame) {
                &mut self.requests
            } else {
                &mut self.heard
            };
            kept &= ring.put(frame);
        }
        while self.fill(chip) {}
        kept
    }

    /// Fills one place. False where nothing has a turn; a tick that has come in between has asked for another run.
    fn fill(&mut self, chip: &impl Chip) -> bool {
        let period_us = chip.period_us();
        if period_us != self.period_us {
            self.period_us = period_us;
            self.gate = Gate::new(period_us, self.kbit);
        }
        let shared = self.shared;
        let now = shared.tick.get();
        // The oldest stays the oldest whatever the tick adds, and what was given up stays so: first that, then the number.
        while let Some(oldest) = self.setpoints.peek()
            && oldest.tick != shared.tick.get()
        {
            let _ = self.setpoints.take();
        }
        if chip.is_off() {
            // Who asked for it does not wait any more: behind the way back it would answer something else.
            return self.others.take().is_some();
        }
        let pending = chip.pending();
        let free = Places::COUNT.saturating_sub(pending.count());
        let other = pending.0 & !shared.places.get() != 0;
        let waiting = (!self.setpoints.is_empty(), !self.others.is_empty());
        let frame = match self.gate.turn(free, waiting, other, chip.since_us()) {
            Turn::Tick => self.setpoints.peek().map(|next| (next.frame, true)),
            Turn::Other => self.others.peek().map(|next| (*next, false)),
            Turn::Nothing => None,
        };
        let Some((frame, of_tick)) = frame else {
            return false;
        };
        let words = to_send(&frame);
        let mut done = false;
        chip.alone(|| {
            // Else all of it is to be looked at again.
            if shared.tick.get() == now {
                done = shared.put(&words, of_tick, chip);
            }
        });
        // With the tick let in again, for this takes its time: what is in the controller counts by then.
        match (done, of_tick) {
            (true, true) => drop(self.setpoints.take()),
            (true, false) => drop(self.others.take()),
            (false, _) => {}
        }
        done || shared.tick.get() != now
    }
}

impl Shared {
    /// Puts a frame in and marks its place; the tick is kept out. False where there is no place.
    fn put(&self, words: &[u32; 4], of_tick: bool, chip: &impl Chip) -> bool {
        let Some(place) = chip.put(words) else {
            return false;
        };
        let mine = self.places.get();
        if of_tick {
            self.places.set(mine | place.0);
            self.done.set(self.done.get().wrapping_add(1));
        } else {
            self.places.set(mine & !place.0);
        }
        true
    }
}

/// True for what only the background answers: everything that is said to a node, and NMT and SYNC, to all.
fn is_request(frame: &Frame) -> bool {
    match frame.id().service() {
        None => true,
        Some((service, _)) => matches!(
            service,
            Service::SdoRequest | Service::Rpdo1 | Service::Rpdo2 | Service::Rpdo3 | Service::Rpdo4
        ),
    }
}
