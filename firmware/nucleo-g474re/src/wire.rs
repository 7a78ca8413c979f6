//! Frames between the controller and the two sides of the board.
//!
//! ```text
//! controller ──► interrupt ───heard──► tick (what is not a drive's goes on to the background)
//!                          ──requests─► background
//! controller ◄── interrupt ◄─setpoints─ tick
//!                          ◄──others─── background
//! ```
//!
//! The interrupt of the controller, right below the tick, fills its places ([`Gate`] says with what); only SYNC is put
//! in by the tick itself, so that it leaves at once. For the few instructions in which the interrupt puts a frame in,
//! it keeps the tick out: less than half a microsecond.
//!
//! A board that follows sends no SYNC. Those it hears go to the tick with their time, and nobody else; until that of a
//! tick has come, nothing is put in ([`Follower`]).

use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::interrupt;
use heapless::spsc::{Consumer, Producer, Queue};
use leadscrew_core::board::FRAMES;
use leadscrew_core::bus::{Frame, Service, SyncHeard, SyncSource, is_sync};
use leadscrew_core::params::Params;
use leadscrew_parts::{Follower, Gate, Turn};

use crate::beat;
use crate::can::{self, Places};
use crate::owned::{Once, Owned};

// One place of a ring stays empty. In a period come two frames of each drive, and heartbeats.
const HEARD: usize = 33;
// While a page of the flash is erased nobody reads them: a transfer that is faster begins its block again.
const REQUESTS: usize = 33;
const OTHERS: usize = 9;
// More than one in a period is wrong, however many there are.
const SYNCS: usize = 3;

/// The second of sixteen priorities, which are the upper bits.
const BELOW_TICK: u8 = 1 << 4;

/// The frames of one tick on their way, and which tick that is.
#[derive(Clone, Copy)]
struct Setpoint {
    tick: u8,
    frame: Frame,
}

/// A SYNC of somebody else: what TIM3 showed when it began, and its counter.
type Sync = (u16, Option<u8>);

struct Rings {
    heard: Queue<Frame, HEARD>,
    syncs: Queue<Sync, SYNCS>,
    follower: Follower,
    requests: Queue<Frame, REQUESTS>,
    // Those of a tick that has been given up, until the interrupt has thrown them away, and those of the next.
    setpoints: Queue<Setpoint, { 2 * FRAMES + 1 }>,
    others: Queue<Frame, OTHERS>,
}

static RINGS: Once<Rings> = Once::new(Rings {
    heard: Queue::new(),
    syncs: Queue::new(),
    follower: Follower::new(0),
    requests: Queue::new(),
    setpoints: Queue::new(),
    others: Queue::new(),
});

/// The tick whose frames still count.
static TICK: AtomicU8 = AtomicU8::new(0);
/// The places of the controller that were filled for the tick last. Changed by the
/// tick, and by the interrupt while it keeps the tick out.
static TICK_PLACES: AtomicU32 = AtomicU32::new(0);
/// Microseconds of the nominal period of the SYNC that the board follows; 0 where it gives the beat.
static FOLLOWS: AtomicU16 = AtomicU16::new(0);
/// Frames may be put in: the SYNC of this tick has come, or is the board's own.
static GOES: AtomicBool = AtomicBool::new(true);
/// Frames have come for which there was no room.
#[cfg(feature = "defmt")]
static LOST: AtomicBool = AtomicBool::new(false);

static INTERRUPT: Owned<Bus> = Owned::empty();

/// The tick's end.
pub struct TickEnd {
    heard: Consumer<'static, Frame>,
    syncs: Consumer<'static, Sync>,
    follower: &'static mut Follower,
    /// The frames of the tick before had no SYNC to go behind.
    withheld: bool,
    setpoints: Producer<'static, Setpoint>,
}

/// The background's end.
pub struct BackgroundEnd {
    requests: Consumer<'static, Frame>,
    others: Producer<'static, Frame>,
}

/// The interrupt's end.
struct Bus {
    heard: Producer<'static, Frame>,
    syncs: Producer<'static, Sync>,
    requests: Producer<'static, Frame>,
    setpoints: Consumer<'static, Setpoint>,
    others: Consumer<'static, Frame>,
    period_us: u32,
    gate: Gate,
    kbit: u32,
}

/// Both ends; the controller, which runs already, is served from now on at so many kilobits a second.
///
/// # Panics
/// The second time.
pub fn start(kbit: u32) -> (TickEnd, BackgroundEnd) {
    let rings = RINGS.take();
    let (heard_in, heard_out) = rings.heard.split();
    let (syncs_in, syncs_out) = rings.syncs.split();
    let (requests_in, requests_out) = rings.requests.split();
    let (setpoints_in, setpoints_out) = rings.setpoints.split();
    let (others_in, others_out) = rings.others.split();
    let bus = Bus {
        heard: heard_in,
        syncs: syncs_in,
        requests: requests_in,
        setpoints: setpoints_out,
        others: others_out,
        period_us: 0,
        gate: Gate::new(0, kbit),
        kbit,
    };
    // SAFETY: the interrupt is enabled below.
    unsafe { INTERRUPT.fill(bus) };
    // SAFETY: what its handler uses is in place, and nobody else sets priorities.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        core.NVIC.set_priority(interrupt::FDCAN1_IT0, BELOW_TICK);
        NVIC::unmask(interrupt::FDCAN1_IT0);
    }
    let tick = TickEnd {
        heard: heard_out,
        syncs: syncs_out,
        follower: &mut rings.follower,
        withheld: false,
        setpoints: setpoints_in,
    };
    let background = BackgroundEnd {
        requests: requests_out,
        others: others_in,
    };
    (tick, background)
}

/// Gives the beat from now on, or follows that of the bus, as the parameters say.
pub fn begin_anew(params: &Params) {
    let follows = match SyncSource::of(params.sync_source()) {
        SyncSource::Own => 0,
        // A tick is no longer than 10 ms.
        SyncSource::Bus => params.tick_us() as u16,
    };
    FOLLOWS.store(follows, Ordering::Relaxed);
    GOES.store(true, Ordering::Relaxed);
}

impl TickEnd {
    /// Leads the timer to the SYNC of somebody else, where the board follows; what that was like. Once in a tick, at its
    /// beginning.
    #[inline(never)]
    pub fn follow(&mut self) -> Option<SyncHeard> {
        if !self.follower.follows(FOLLOWS.load(Ordering::Relaxed)) {
            return None;
        }
        while let Some((stamp, counter)) = self.syncs.dequeue() {
            self.follower.hear(stamp, counter);
        }
        let beat = self.follower.beat(beat::stamp());
        beat::set(beat.next_steps);
        // The interrupt waits.
        self.withheld = !GOES.load(Ordering::Relaxed);
        GOES.store(beat.goes, Ordering::Relaxed);
        Some(beat.heard)
    }

    /// The oldest frame not yet read.
    pub fn receive(&mut self) -> Option<Frame> {
        self.heard.dequeue()
    }

    /// Sends the frames of a tick, SYNC first. False where some of the tick before have not left: they are called back.
    /// Those that had no SYNC to go behind do not count: that it was missing is told already.
    pub fn send(&mut self, frames: &[Frame]) -> bool {
        let mine = TICK_PLACES.load(Ordering::Relaxed);
        let left = Places(can::pending().0 & mine);
        let in_time = left.is_empty() && self.setpoints.is_empty();
        let mut tick = TICK.load(Ordering::Relaxed);
        if !in_time {
            tick = tick.wrapping_add(1);
            TICK.store(tick, Ordering::Release);
            can::call_back(left);
        }
        let mut frames = frames.iter();
        if GOES.load(Ordering::Relaxed)
            && let Some(sync) = frames.as_slice().first()
            && let Some(place) = can::put(sync)
        {
            TICK_PLACES.store(mine | place.0, Ordering::Relaxed);
            frames.next();
        }
        for frame in frames {
            let setpoint = Setpoint {
                tick,
                frame: *frame,
            };
            // There is room for two ticks.
            let _ = self.setpoints.enqueue(setpoint);
        }
        can::poke();
        in_time || core::mem::take(&mut self.withheld)
    }
}

impl BackgroundEnd {
    /// The oldest request not yet read.
    pub fn receive(&mut self) -> Option<Frame> {
        self.requests.dequeue()
    }

    /// True where there is room for a frame.
    pub fn has_room(&self) -> bool {
        self.others.ready()
    }

    /// Sends a frame behind those of the tick. There is room.
    pub fn send(&mut self, frame: &Frame) {
        let _ = self.others.enqueue(*frame);
        can::poke();
    }
}

impl Bus {
    fn serve(&mut self) {
        let mut lost = can::acknowledge();
        while let Some((frame, stamp)) = can::take() {
            if is_sync(&frame) && FOLLOWS.load(Ordering::Relaxed) > 0 {
                // Where there is no room, there are too many already.
                let _ = self
                    .syncs
                    .enqueue((stamp, frame.payload().first().copied()));
                GOES.store(true, Ordering::Relaxed);
                continue;
            }
            let ring = if is_request(&frame) {
                &mut self.requests
            } else {
                &mut self.heard
            };
            lost |= ring.enqueue(frame).is_err();
        }
        note(lost);
        while self.fill() {}
    }

    /// Fills one place. False where that does not go, or nothing has a turn.
    fn fill(&mut self) -> bool {
        let period_us = beat::period_us();
        if period_us != self.period_us {
            self.period_us = period_us;
            self.gate = Gate::new(period_us, self.kbit);
        }
        let now = TICK.load(Ordering::Acquire);
        while self.setpoints.peek().is_some_and(|next| next.tick != now) {
            self.setpoints.dequeue();
        }
        if can::is_off() {
            // Who asked for it does not wait any more: behind the way back it would answer something else.
            return self.others.dequeue().is_some();
        }
        if !GOES.load(Ordering::Relaxed) {
            return false;
        }
        let pending = can::pending();
        let free = Places::ALL.count() - pending.count();
        let other = pending.0 & !TICK_PLACES.load(Ordering::Relaxed) != 0;
        let waiting = (self.setpoints.ready(), self.others.ready());
        match self.gate.turn(free, waiting, other, beat::since_us()) {
            Turn::Tick => self.setpoints.dequeue().is_some_and(|next| {
                cortex_m::interrupt::free(|_| {
                    // The tick may have given it up in between.
                    if TICK.load(Ordering::Relaxed) == next.tick {
                        put(&next.frame, true);
                    }
                });
                true
            }),
            Turn::Other => self.others.dequeue().is_some_and(|frame| {
                cortex_m::interrupt::free(|_| put(&frame, false));
                true
            }),
            Turn::Nothing => false,
        }
    }
}

/// Puts a frame in; there is a place, or the tick has just taken the last one for its SYNC, and has called the rest back.
fn put(frame: &Frame, of_tick: bool) {
    if let Some(place) = can::put(frame) {
        let mine = TICK_PLACES.load(Ordering::Relaxed);
        let mine = if of_tick {
            mine | place.0
        } else {
            mine & !place.0
        };
        TICK_PLACES.store(mine, Ordering::Relaxed);
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

/// A frame that is lost is lost as on the wire: drives that fall silent are missed, requests are made again.
#[cfg_attr(
    not(feature = "defmt"),
    expect(unused_variables, reason = "for messages only")
)]
fn note(lost: bool) {
    #[cfg(feature = "defmt")]
    if lost {
        LOST.store(true, Ordering::Relaxed);
    }
}

/// True where frames have come for which there was no room, since this was asked last.
#[cfg(feature = "defmt")]
pub fn has_lost() -> bool {
    LOST.swap(false, Ordering::Relaxed)
}

#[interrupt]
fn FDCAN1_IT0() {
    // SAFETY: this is its interrupt.
    unsafe { INTERRUPT.with(Bus::serve) };
}
