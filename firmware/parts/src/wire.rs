//! Frames between a CAN controller and the two sides of a board.
//!
//! ```text
//! controller ──► interrupt ───heard──► tick (passes frames of other nodes on to the background)
//!                          ──requests─► background
//!                          ─────fd────► background (identifiers of frames of CAN FD)
//! controller ◄── interrupt ◄─setpoints─ tick
//!                          ◄─together── tick (the frame of CAN FD with the setpoints of all drives)
//!                          ◄──others─── background
//! ```
//!
//! The interrupt of the controller runs right below the tick. It fills the controller's places ([`Gate`] chooses the
//! frame). Only SYNC is put in by the tick itself, so that SYNC leaves at once.
//!
//! The tick may come at any instruction of the interrupt. Then everything that the interrupt has read is out of date:
//! the tick may have given up the frame that was to go, a place may be taken, a SYNC may be in the ring. So every tick
//! has a number. The interrupt reads the number first, then the rings and the controller, and decides. Then it keeps
//! the tick out for the few instructions in which it puts a frame in and marks its place, and does so only if the
//! number is unchanged. Each frame carries the number of its tick. The interrupt compares it with the number of the
//! last tick after each look at the ring: a frame with another number has been given up.
//!
//! This module knows no register: a chip provides them through [`Chip`].

use heapless::spsc::Queue;
use leadscrew_core::board::FRAMES;
use leadscrew_core::bus::{CobId, FdFrame, Frame, Service};

use crate::gate::{Gate, Turn};
use crate::message::{Heard, fd_to_send, to_send};
use crate::shared::{In, Out, Word};

#[cfg(test)]
mod tests;

// One place of a ring stays empty. A period brings two frames of each drive, and heartbeats.
const HEARD: usize = 33;
// While a page of the flash is erased nothing reads this ring: a faster transfer has to repeat its block.
const REQUESTS: usize = 33;
const OTHERS: usize = 9;
// Of a row of such frames the first tell who sends them.
const FD: usize = 3;

/// Places of a controller for frames to be sent, one bit for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Places(pub u32);

impl Places {
    /// The number of places of a controller.
    pub const COUNT: u8 = 3;
    /// All of them.
    pub const ALL: Self = Self((1 << Self::COUNT) - 1);

    /// The number of these places.
    #[must_use]
    pub const fn count(self) -> u8 {
        self.0.count_ones() as u8
    }

    /// True where there are none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// The controller, and the timer that gives the period.
pub trait Chip {
    /// The next frame that was received.
    fn take(&self) -> Option<Heard>;
    /// Puts the words of a frame ([`to_send`], [`fd_to_send`]) into the controller. Gives the frame's place, or `None`
    /// where no place is free. A call must not interrupt another call.
    fn put(&self, words: &[u32]) -> Option<Places>;
    /// Places whose frame has not been sent yet.
    fn pending(&self) -> Places;
    /// Cancels the frames in these places, except one that is on the wire already.
    fn call_back(&self, places: Places);
    /// The controller has left the bus, or is on its way back, or does not send.
    fn is_off(&self) -> bool;
    /// Lets the interrupt run as soon as nothing more urgent runs.
    fn poke(&self);
    /// The length of a period.
    fn period_us(&self) -> u32;
    /// Microseconds since the period began.
    fn since_us(&self) -> u32;
    /// Does `work` with the tick kept out.
    fn alone(&self, work: impl FnOnce());
}

/// A frame of a tick on its way, and the number of the tick.
struct Setpoint<T> {
    tick: u32,
    frame: T,
}

/// The words that tick and interrupt share in addition to the rings.
struct Shared {
    /// The number of the last tick that has sent. The tick writes it.
    tick: Word,
    /// The controller's places that were filled last for a tick. The tick writes them; so does the interrupt while it
    /// keeps the tick out.
    places: Word,
    /// The number of that tick's frames that the interrupt has put in. The writers are those of `places`.
    done: Word,
}

/// All rings between tick, background and interrupt.
pub struct Rings {
    shared: Shared,
    heard: Queue<Frame, HEARD>,
    requests: Queue<Frame, REQUESTS>,
    fd: Queue<CobId, FD>,
    // Room for the frames of a tick that was given up, until the interrupt drops them, and for those of the next tick.
    setpoints: Queue<Setpoint<Frame>, { 2 * FRAMES + 1 }>,
    // The same, for two ticks that were given up and the next.
    together: Queue<Setpoint<FdFrame>, 4>,
    others: Queue<Frame, OTHERS>,
}

/// The tick's end.
pub struct TickEnd<'a> {
    shared: &'a Shared,
    heard: Out<'a, Frame>,
    /// The number of frames of the previous tick that the interrupt had to put in.
    left: u32,
    setpoints: In<'a, Setpoint<Frame>>,
    together: In<'a, Setpoint<FdFrame>>,
}

/// The background's end.
pub struct BackgroundEnd<'a> {
    requests: Out<'a, Frame>,
    fd: Out<'a, CobId>,
    others: In<'a, Frame>,
}

/// The interrupt's end.
pub struct BusEnd<'a> {
    shared: &'a Shared,
    heard: In<'a, Frame>,
    requests: In<'a, Frame>,
    fd: In<'a, CobId>,
    setpoints: Out<'a, Setpoint<Frame>>,
    together: Out<'a, Setpoint<FdFrame>>,
    others: Out<'a, Frame>,
    period_us: u32,
    gate: Gate,
    kbit: u32,
}

impl Rings {
    /// Empty rings.
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
            fd: Queue::new(),
            setpoints: Queue::new(),
            together: Queue::new(),
            others: Queue::new(),
        }
    }

    /// The ends, for a bus of so many kilobits a second.
    pub fn split(&mut self, kbit: u32) -> (TickEnd<'_>, BackgroundEnd<'_>, BusEnd<'_>) {
        let shared = &self.shared;
        let (heard_in, heard_out) = self.heard.split();
        let (requests_in, requests_out) = self.requests.split();
        let (fd_in, fd_out) = self.fd.split();
        let (setpoints_in, setpoints_out) = self.setpoints.split();
        let (together_in, together_out) = self.together.split();
        let (others_in, others_out) = self.others.split();
        let tick = TickEnd {
            shared,
            heard: Out(heard_out),
            left: 0,
            setpoints: In(setpoints_in),
            together: In(together_in),
        };
        let background = BackgroundEnd {
            requests: Out(requests_out),
            fd: Out(fd_out),
            others: In(others_in),
        };
        let bus = BusEnd {
            shared,
            heard: In(heard_in),
            requests: In(requests_in),
            fd: In(fd_in),
            setpoints: Out(setpoints_out),
            together: Out(together_out),
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

    /// Sends the frames of a tick, SYNC first, and behind them one of CAN FD. Called once in each tick, even without
    /// frames. False where some frames of the previous tick have not left: these are called back.
    pub fn send(&mut self, frames: &[Frame], together: Option<&FdFrame>, chip: &impl Chip) -> bool {
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
        self.left = frames.as_slice().len() as u32 + u32::from(together.is_some());
        // There is room for two ticks.
        for frame in frames {
            let frame = *frame;
            let _ = self.setpoints.put(Setpoint { tick, frame });
        }
        if let Some(frame) = together {
            let frame = *frame;
            let _ = self.together.put(Setpoint { tick, frame });
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

    /// The identifier of the oldest frame of CAN FD not yet read.
    pub fn receive_fd(&mut self) -> Option<CobId> {
        self.fd.take()
    }

    /// True where there is room for a frame.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.others.has_room()
    }

    /// Sends a frame after those of the tick. There is room.
    pub fn send(&mut self, frame: &Frame, chip: &impl Chip) {
        let _ = self.others.put(*frame);
        chip.poke();
    }
}

impl BusEnd<'_> {
    /// The interrupt: reads the received frames, and fills the free places. False where there was no room for a
    /// received frame. That frame is lost, as on the wire: the board notices a drive that falls silent, and a request
    /// is repeated.
    pub fn serve(&mut self, chip: &impl Chip) -> bool {
        let mut kept = true;
        while let Some(heard) = chip.take() {
            let frame = match heard {
                Heard::Classical(frame) => frame,
                Heard::Fd(id) => {
                    let _ = self.fd.put(id);
                    continue;
                }
            };
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

    /// Fills one place. False where no frame may go. A tick that has come in between has asked for another run.
    fn fill(&mut self, chip: &impl Chip) -> bool {
        let period_us = chip.period_us();
        if period_us != self.period_us {
            self.period_us = period_us;
            self.gate = Gate::new(period_us, self.kbit);
        }
        let shared = self.shared;
        let now = shared.tick.get();
        // The oldest frame stays the oldest, whatever the tick adds, and a frame that was given up stays so. So this
        // reads the frame first and then the number.
        drop_given_up(&mut self.setpoints, &shared.tick);
        drop_given_up(&mut self.together, &shared.tick);
        if chip.is_off() {
            // The receiver does not wait any more: after the return to the bus this frame would answer another request.
            return self.others.take().is_some();
        }
        let pending = chip.pending();
        let free = Places::COUNT.saturating_sub(pending.count());
        let mine = shared.places.get();
        let other = pending.0 & !mine != 0;
        // A status has a smaller identifier than most setpoints: in the controller at once, it would go first.
        let begin_other = pending.0 & mine == 0 && !self.others.is_empty();
        let setpoints = !self.setpoints.is_empty();
        let waiting = (setpoints || !self.together.is_empty(), begin_other);
        let ring = match self.gate.turn(free, waiting, other, chip.since_us()) {
            Turn::Tick if setpoints => Ring::Setpoints,
            Turn::Tick => Ring::Together,
            Turn::Other => Ring::Others,
            Turn::Nothing => return false,
        };
        let words = match ring {
            Ring::Setpoints => self.setpoints.peek().map(|next| to_send(&next.frame)),
            Ring::Together => self.together.peek().map(|next| fd_to_send(&next.frame)),
            Ring::Others => self.others.peek().map(to_send),
        };
        let Some(words) = words else {
            return false;
        };
        let mut done = false;
        chip.alone(|| {
            // Otherwise everything has to be read again.
            if shared.tick.get() == now {
                done = shared.put(&words, ring != Ring::Others, chip);
            }
        });
        // The tick is let in again here, because a removal takes its time. The frame in the controller is counted by then.
        match ring {
            _ if !done => {}
            Ring::Setpoints => drop(self.setpoints.take()),
            Ring::Together => drop(self.together.take()),
            Ring::Others => drop(self.others.take()),
        }
        done || shared.tick.get() != now
    }
}

impl Shared {
    /// Puts a frame in and marks its place; the caller keeps the tick out. False where no place is free.
    fn put(&self, words: &[u32], of_tick: bool, chip: &impl Chip) -> bool {
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

/// The ring whose frame is the next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ring {
    Setpoints,
    Together,
    Others,
}

/// Drops the frames of ticks before the last one.
fn drop_given_up<T>(ring: &mut Out<'_, Setpoint<T>>, tick: &Word) {
    while let Some(oldest) = ring.peek()
        && oldest.tick != tick.get()
    {
        let _ = ring.take();
    }
}

/// True for frames that only the background answers: everything that is sent to a node, and NMT and SYNC, sent to all.
fn is_request(frame: &Frame) -> bool {
    match frame.id().service() {
        None => true,
        Some((service, _)) => matches!(
            service,
            Service::SdoRequest | Service::Rpdo1 | Service::Rpdo2 | Service::Rpdo3 | Service::Rpdo4
        ),
    }
}
