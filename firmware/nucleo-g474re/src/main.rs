#![no_std]
#![no_main]
//! The board's image for a NUCLEO-G474RE: the two sides of a board on this chip.
//!
//! | priority | runs | owns |
//! |---|---|---|
//! | fault | writes a record and resets the processor ([`fault`]) | – |
//! | NMI | marks an unreadable word of the flash ([`flash`]); ends the program where the crystal stops | a flag |
//! | 0 | TIM6: the tick ([`TickSide`]) | encoder timers, contacts, clamp, watchdog, its end of the rings |
//! | 1 | FDCAN1: frames in and out ([`wire`]) | the controller, its ends of the rings |
//! | thread | [`BackgroundSide`], storage, switches | flash, its ends of the rings |
//!
//! | shared | written by | read by |
//! |---|---|---|
//! | rings of frames ([`wire`]) | one side each | one side each |
//! | the number of the tick, and when it began ([`wire`]) | tick | interrupt |
//! | places that hold the tick's frames, and their number ([`wire`]) | tick; interrupt, with the tick kept out | both |
//! | the period of SYNC ([`beat`]) | background | timer, interrupt |
//! | the queues between the two sides | one side each | one side each |
//!
//! Nothing else is shared. A tick that takes longer than its period leaves frames unsent. The next tick calls them back
//! and counts them as late.

mod beat;
mod can;
mod clock;
mod encoder;
mod fault;
mod flash;
mod handwheel;
mod log;
mod manual;
mod owned;
mod pins;
mod reset;
mod watchdog;
mod wire;

use core::mem::MaybeUninit;

use cortex_m_rt::entry;
use embassy_stm32::Peri;
use embassy_stm32::pac::{UID, interrupt};
use embassy_stm32::peripherals::FLASH;
use leadscrew_app::{Machine, Memory, PowerUp, Sides, TickMachine, serial_of};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{
    BackgroundSide, Event, Held, Inputs, Output, Region, StoreError, StoreRequest, Switching,
    TickSide,
};
use leadscrew_core::bus::{CobId, Controller, DataRates, Frame, NodeId, Setpoints};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::params::Params;
use leadscrew_core::spindle::EncoderSample;
use leadscrew_memory as _;
use leadscrew_parts::{BackgroundEnd, BitTiming, MachineInputs, Rates, TickEnd, WordFlash};
use leadscrew_store::{BUFFER, Store};

use crate::encoder::Encoder;
use crate::flash::Bank;
use crate::handwheel::Handwheel;
use crate::owned::{Once, Owned};
use crate::pins::{Clamp, Contacts, Switches};
use crate::watchdog::Watchdog;
use crate::wire::Registers;

/// The rate of the bus where no clock gives that of the parameters: so the alarm can be sent.
const FALLBACK: Rates = Rates {
    clock: 0,
    nominal: BitTiming {
        prescaler: 1,
        before: 20,
        after: 3,
        jump: 3,
    },
    data: None,
};

static MEMORY: Once<Memory> = Once::new(Memory::new());
static STORAGE: Once<MaybeUninit<Storage>> = Once::new(MaybeUninit::uninit());
static PARTS: Once<MaybeUninit<BackgroundParts>> = Once::new(MaybeUninit::uninit());
static TICK: Owned<Tick> = Owned::empty();

struct Tick {
    side: TickSide<'static>,
    output: &'static mut Output,
    parts: TickParts,
}

struct TickParts {
    encoder: Encoder,
    contacts: Contacts,
    clamp: Clamp,
    machine: MachineInputs,
    watchdog: Watchdog,
    wire: TickEnd<'static>,
    /// The alarm for a fault that was found at power-up.
    trouble: Option<Code>,
}

impl TickMachine for TickParts {
    fn sample(&mut self) -> EncoderSample {
        self.encoder.sample()
    }

    fn inputs(&mut self) -> Inputs {
        let said = self.contacts.look();
        Inputs {
            stop: said.stop,
            hold: said.hold,
            signals: None,
            trouble: self.trouble,
            unanswered: self.clamp.look(),
            machine: self.machine.look(pins::machine_inputs()),
        }
    }

    fn receive(&mut self) -> Option<Frame> {
        self.wire.receive()
    }

    fn send(&mut self, frames: &[Frame], together: Option<&Setpoints>) -> bool {
        // Without a rate for its data no such frame goes: the alarm says so.
        let can = self.trouble != Some(Code::ParametersUnusable);
        let together = together.filter(|_| can);
        let together = together.and_then(|setpoints| setpoints.frame(NodeId::BOARD));
        self.wire.send(frames, together.as_ref(), &Registers)
    }

    fn switch(&mut self, switching: Switching) {
        self.clamp.switch(switching);
    }

    fn set_outputs(&mut self, outputs: u16) {
        pins::set_machine_outputs(outputs);
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.pet();
    }
}

type Storage = Store<WordFlash<Bank>>;

struct BackgroundParts {
    wire: BackgroundEnd<'static>,
    /// The bit rate of the bus, in kbit/s, up to the next start, and the rates of the controller.
    kbit: u32,
    rates: Rates,
    storage: &'static mut Storage,
    stored: Option<Result<(), StoreError>>,
    switches: Switches,
    handwheel: Handwheel,
}

/// The regions in the flash. A function of its own: the copies on the way to their place are not on the stack afterwards.
#[inline(never)]
fn storage(part: Peri<'static, FLASH>) -> &'static mut Storage {
    let Ok(storage) = Storage::new(flash::start(part)) else {
        panic!("the bank holds the regions");
    };
    STORAGE.put(storage)
}

/// The entry of the tap journal. `None` also where it cannot be read; then `trouble` gets the alarm. Before the read,
/// this repairs what a loss of power has left unfinished.
#[inline(never)]
fn tap(storage: &mut Storage, trouble: &mut Option<Code>) -> Option<TapRecord> {
    let mut buffer = [0; BUFFER];
    let recovered = storage.recover();
    match recovered.and_then(|()| storage.read(Region::TapJournal, &mut buffer)) {
        Ok(None) => return None,
        Ok(Some(bytes)) => {
            if let Ok(entry) = TapRecord::decode(bytes) {
                return entry;
            }
        }
        Err(_) => {}
    }
    *trouble = Some(Code::TapJournalDamaged);
    None
}

impl Machine for BackgroundParts {
    fn receive(&mut self) -> Option<Frame> {
        self.wire.receive()
    }

    fn receive_fd(&mut self) -> Option<CobId> {
        self.wire.receive_fd()
    }

    fn has_room(&self) -> bool {
        self.wire.has_room()
    }

    fn send(&mut self, frame: &Frame) {
        self.wire.send(frame, &Registers);
    }

    fn handwheel(&mut self) -> u16 {
        self.handwheel.detent()
    }

    fn store(&mut self, request: &StoreRequest<'_>) {
        self.stored = Some(self.storage.keep(request));
    }

    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>)) {
        let mut buffer = [0; BUFFER];
        then(self.storage.read(region, &mut buffer));
    }

    fn stored(&mut self) -> Option<Result<(), StoreError>> {
        self.stored.take()
    }

    fn erases(&mut self) -> Option<u32> {
        self.storage.more_erases()
    }

    fn event(&mut self, event: &Event) {
        log::event(event);
    }

    fn controller(&mut self) -> Controller {
        can::controller()
    }

    fn rejoin(&mut self) {
        can::rejoin();
    }

    fn begin_anew(&mut self, params: &Params) {
        beat::set(params.tick_us());
        // The drives are without torque. A change of the data's rate goes with that of the drives'.
        if params.setpoint_frame() == 1
            && let Some(rates) = rates(params, self.kbit)
            && rates != self.rates
        {
            cortex_m::interrupt::free(|_| can::start(&rates));
            self.rates = rates;
        }
    }
}

#[entry]
fn main() -> ! {
    // The start takes the deepest stack of the thread. Interrupts are masked until its end, so that none adds its own
    // stack. The same memory then serves the rest of the thread with the interrupts (`cargo xtask sizes` counts on
    // that). The start waits for no interrupt; those that come meanwhile run after it.
    cortex_m::interrupt::disable();
    let (mut background, parts) = start();
    // SAFETY: no critical section is open, and everything that the handlers use is in place.
    unsafe { cortex_m::interrupt::enable() };
    loop {
        while leadscrew_app::step(&mut background, parts) {}
        parts.switches.show(background.state().snapshot());
        log::lost_frames();
        cortex_m::asm::wfi();
    }
}

/// Does everything up to the first tick. A function of its own, so that its stack is free afterwards.
#[inline(never)]
fn start() -> (BackgroundSide<'static>, &'static mut BackgroundParts) {
    let (cause, failure) = fault::start(reset::flags());
    let chip = clock::start();
    pins::start();
    log::started(cause);
    let storage = storage(chip.FLASH);
    let mut trouble = None;
    let tap = tap(storage, &mut trouble);
    let mut set = storage.power_up(Params::slant_bed);
    set.start = storage.count_start();

    let (kbit, tick_us) = (set.params.bus_kbit(), set.params.tick_us());
    let data_rates = DataRates::of(|data_kbit| {
        let rates = Rates::of(&clock::CAN_HZ, kbit, data_kbit);
        rates.is_some_and(|rates| rates.data.is_some())
    });
    let found = rates(&set.params, kbit);
    let rates = found.unwrap_or(FALLBACK);
    can::start(&rates);
    if found.is_none() || set.params.setpoint_frame() == 1 && rates.data.is_none() {
        trouble = trouble.or(Some(Code::ParametersUnusable));
    }
    let up = PowerUp {
        set: &set,
        remembered: None,
        tap,
        node: NodeId::BOARD,
        serial: serial_of(unique_number()),
        data_rates,
        failure,
        cause,
    };
    let Ok(sides) = MEMORY.take().power_up(&up) else {
        panic!("a set that has passed its checks works");
    };
    let (tick_end, background_end) = wire::start(kbit);
    let encoder = Encoder::start();
    let contacts = pins::contacts();
    let watchdog = watchdog::start(chip.IWDG);
    let Sides {
        tick: side,
        output,
        background,
    } = sides;
    let tick = Tick {
        side,
        output,
        parts: TickParts {
            encoder,
            contacts,
            clamp: pins::clamp(),
            machine: MachineInputs::new(),
            watchdog,
            wire: tick_end,
            trouble,
        },
    };
    // SAFETY: the timer starts later.
    unsafe { TICK.fill(tick) };
    beat::start(tick_us);
    let parts = BackgroundParts {
        wire: background_end,
        kbit,
        rates,
        storage,
        stored: None,
        switches: pins::switches(),
        handwheel: Handwheel::start(),
    };
    (background, PARTS.put(parts))
}

/// The clock and the bits of the CAN controller on a bus of so many kilobits a second. Without a frame of CAN FD to send
/// it stays with the crystal.
fn rates(params: &Params, kbit: u32) -> Option<Rates> {
    let clocks = match params.setpoint_frame() {
        0 => core::slice::from_ref(&clock::CRYSTAL_HZ),
        _ => &clock::CAN_HZ,
    };
    Rates::of(clocks, kbit, params.fd_kbit())
}

/// The unique number that the chip's maker has written.
fn unique_number() -> [u32; 3] {
    [UID.uid(0).read(), UID.uid(1).read(), UID.uid(2).read()]
}

#[interrupt]
fn TIM6_DAC() {
    beat::begun();
    leadscrew_fault::tick();
    // SAFETY: this is the value's interrupt.
    unsafe { TICK.with(|tick| leadscrew_app::tick(&mut tick.side, tick.output, &mut tick.parts)) };
}
