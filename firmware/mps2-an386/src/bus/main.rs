#![no_std]
#![no_main]
//! A board on a bus, on the emulated Cortex-M4F: both contexts, the plant around the board, and CAN as lines of text
//! (SLCAN) over the UART. A gateway or the kernel's `slcand` can use this board like any other. What is not on a bus (door,
//! emergency stop, power) comes over a second UART.
//!
//! ```text
//!                    UART0 (SLCAN)                  queues
//! gateway ◄────────────────────────► background ◄──────────────► tick ◄─► plant
//!                                      thread                  interrupt
//!                    UART1 (words)                  queue
//! hand ◄───────────────────────────► thread ──────────────────────────► plant
//! ```
//!
//! Time is virtual: the thread runs the tick's interrupt when everything that the tick depends on is there ([`pace`]).
//! So a program gives the same setpoints here as anywhere else. With `time=real` in its command line the image runs in real
//! time, for an operator. The wire carries everything but SYNC and the process data of the drives; with `traffic=all` the
//! image sends these too.

mod around;
mod clock;
mod flash;
mod hand;
mod interrupts;
mod log;
mod options;
mod outside;
mod pace;
#[cfg(feature = "provoke")]
mod provoke;
mod shop;
mod uart;
mod watchdog;

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use heapless::spsc::Queue;
use leadscrew_app::{Memory, PowerUp, ResetCause, Sides};
use leadscrew_core::bus::{DataRates, Frame, NodeId};
use leadscrew_core::params::Params;
use static_cell::{ConstStaticCell, StaticCell};

use crate::around::{Lathe, Touch};
use crate::hand::{Hand, TOUCHES};
use crate::options::Options;
use crate::outside::Outside;
use crate::pace::Pace;
use crate::shop::Shop;

/// Frames of the tick and its drives on their way to the wire.
const TRAFFIC: usize = 64;

#[entry]
fn main() -> ! {
    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::new());
    static TOLD: ConstStaticCell<Queue<Frame, TRAFFIC>> = ConstStaticCell::new(Queue::new());
    static ASKED: ConstStaticCell<Queue<Frame, TRAFFIC>> = ConstStaticCell::new(Queue::new());
    static TOUCHED: ConstStaticCell<Queue<Touch, TOUCHES>> = ConstStaticCell::new(Queue::new());
    static PARAMS: StaticCell<Params> = StaticCell::new();
    static OUTSIDE: StaticCell<Outside> = StaticCell::new();

    if let Some(mut core) = cortex_m::Peripherals::take() {
        leadscrew_fault::guard_stack(&mut core.MPU);
    }
    let left = leadscrew_fault::left();
    // The emulated board has no flags of a reset. It starts by its power, after a failure with a record, or else by its
    // watchdog.
    let cause = if !left.is_kept() {
        ResetCause::Power
    } else if left.failure(ResetCause::Software).is_some() {
        ResetCause::Software
    } else {
        ResetCause::Watchdog
    };
    let failure = left.failure(cause);
    leadscrew_fault::begin(failure.as_ref());
    log::started(cause);
    let options = Options::read(failure.as_ref());
    let kept = Lathe::kept();
    // After a reset the drives report their positions; at power-up the axes stand here.
    let remembered = match &kept {
        Some(lathe) => lathe.off(),
        None => Some(options.at),
    };
    let mut flash = flash::RamFlash::power_up();
    let tap = flash.tap().expect("the flash can be read");
    let set = flash.params(&Params::sheets()).expect("the flash is one");
    let up = PowerUp {
        set: &set,
        remembered,
        tap,
        node: NodeId::BOARD,
        serial: 0,
        data_rates: DataRates::ALL,
        failure,
        cause,
    };
    let Sides {
        tick,
        output,
        background,
    } = MEMORY
        .take()
        .power_up(&up)
        .expect("what was stored was good, and what is built in");
    let lathe = match (kept, remembered) {
        (Some(lathe), None) => lathe,
        (before, at) => {
            let at = at.unwrap_or_default();
            Lathe::switched_on(&set.params, at, before.as_ref())
        }
    };
    let (told_in, told_out) = TOLD.take().split();
    let (asked_in, asked_out) = ASKED.take().split();
    let (touched_in, touched_out) = TOUCHED.take().split();
    let params = PARAMS.init(set.params.clone());
    let shop = Shop::new(lathe, params, options, touched_out, told_in, asked_out);
    interrupts::own_tick(tick, output, shop);
    let bytes = interrupts::own_uart();
    let outside = OUTSIDE.init(Outside::new(bytes, told_out, asked_in, flash));
    interrupts::enable();
    watchdog::start();
    let hand = &mut Hand::new(touched_in);
    Pace::new(&set.params, options.real).run(background, outside, hand)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    leadscrew_fault::panicked()
}
