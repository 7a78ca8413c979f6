#![no_std]
#![no_main]
//! A board on a bus, on the emulated Cortex-M4F: both contexts, the plant around the board, and CAN as lines of text
//! (SLCAN) over the UART. A gateway or the kernel's `slcand` can use this board like any other.
//!
//! ```text
//!                    UART0 (SLCAN)                  queues
//! gateway ◄────────────────────────► background ◄──────────────► tick ◄─► plant
//!                                      thread                  interrupt
//! ```
//!
//! Time is virtual: the thread runs the tick's interrupt when everything that the tick depends on is there ([`pace`]).
//! So a program gives the same setpoints here as anywhere else. The wire carries everything but SYNC and the process
//! data of the drives; with `traffic=all` in its command line the image sends these too.

mod around;
mod clock;
mod flash;
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
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::bus::{Frame, NodeId};
use leadscrew_core::params::Params;
use static_cell::{ConstStaticCell, StaticCell};

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
    let begins = PlantOptions::default();
    let kept = around::kept();
    let mut flash = flash::RamFlash::power_up();
    let tap = flash.tap().expect("the flash can be read");
    let set = flash.params(&Params::sheets()).expect("the flash is one");
    let up = PowerUp {
        set: &set,
        // After a reset the drives report their positions.
        remembered: kept.is_none().then_some(begins.at),
        tap,
        node: NodeId::BOARD,
        serial: 0,
        fd: true,
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
    let plant = kept.unwrap_or_else(|| around::new(&set.params, &begins));
    let (told_in, told_out) = TOLD.take().split();
    let (asked_in, asked_out) = ASKED.take().split();
    interrupts::own_tick(tick, output, Shop::new(plant, options, told_in, asked_out));
    let bytes = interrupts::own_uart();
    let outside = OUTSIDE.init(Outside::new(bytes, told_out, asked_in, flash));
    interrupts::enable();
    watchdog::start();
    Pace::new(&set.params).run(background, outside)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    leadscrew_fault::panicked()
}
