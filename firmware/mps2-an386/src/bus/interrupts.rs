//! The interrupts: their priorities, and the data that belongs to one interrupt alone.
//!
//! | level | interrupt | owns |
//! |---|---|---|
//! | above all | the watchdog's, which cannot be masked | nothing: it waits for the reset |
//! | 0 | 20, of no device: the thread sets it, once for each SYNC period | the tick's side and the plant |
//! | 32 | 0, a byte on the UART | the end of the ring that takes the bytes |
//! | 64 | 9, a millisecond has passed | nothing: it wakes the thread |

use core::cell::UnsafeCell;

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use heapless::spsc::{Consumer, Producer, Queue};
use leadscrew_core::board::{Output, TickSide};
use static_cell::ConstStaticCell;

use crate::clock;
use crate::shop::Shop;
use crate::uart::{self, Uart};

/// Room for bytes between two reads of the thread. The emulated UART waits until each byte was taken.
pub const BYTES: usize = 4096;

/// The tick's interrupt.
const TICK: u16 = 20;

#[derive(Clone, Copy)]
struct Number(u16);

// SAFETY: each `Number` is made from a constant that is an interrupt of this processor, and all of them differ.
unsafe impl InterruptNumber for Number {
    fn number(self) -> u16 {
        self.0
    }
}

/// A value that the thread gives to an interrupt before the interrupt is enabled.
struct Owned<T>(UnsafeCell<Option<T>>);

// SAFETY: the thread calls `give` before `enable`; one interrupt calls `with` only afterwards: never both at a time.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    const fn none() -> Self {
        Self(UnsafeCell::new(None))
    }

    fn give(&self, value: T) {
        // SAFETY: the interrupt that reads the value is not enabled yet.
        unsafe { *self.0.get() = Some(value) }
    }

    fn with(&self, work: impl FnOnce(&mut T)) {
        // SAFETY: only the value's interrupt calls this, and it does not interrupt itself.
        if let Some(value) = unsafe { &mut *self.0.get() } {
            work(value);
        }
    }
}

static TICK_SIDE: Owned<(TickSide<'static>, &'static mut Output, Shop)> = Owned::none();
static BYTES_IN: Owned<Producer<'static, u8>> = Owned::none();

/// Gives the tick's interrupt its own data.
pub fn own_tick(tick: TickSide<'static>, output: &'static mut Output, shop: Shop) {
    TICK_SIDE.give((tick, output, shop));
}

/// Gives the UART's interrupt its end of the ring, and the caller the other end.
pub fn own_uart() -> Consumer<'static, u8> {
    static RING: ConstStaticCell<Queue<u8, BYTES>> = ConstStaticCell::new(Queue::new());
    let (bytes_in, bytes_out) = RING.take().split();
    BYTES_IN.give(bytes_in);
    bytes_out
}

/// Enables the interrupts.
pub fn enable() {
    Uart::BUS.start_with_interrupt();
    clock::start();
    // SAFETY: the only place that sets priorities; no critical section relies on them.
    let mut nvic = unsafe { cortex_m::Peripherals::steal().NVIC };
    for (number, level) in [(TICK, 0), (uart::INTERRUPT, 32), (clock::INTERRUPT, 64)] {
        // SAFETY: as above; the handlers have got their data.
        unsafe {
            nvic.set_priority(Number(number), level);
            NVIC::unmask(Number(number));
        }
    }
}

/// Runs one SYNC period in the tick's interrupt, and returns after it.
pub fn tick() {
    NVIC::pend(Number(TICK));
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    match u16::try_from(number) {
        Ok(TICK) => TICK_SIDE.with(|(tick, output, shop)| leadscrew_app::tick(tick, output, shop)),
        Ok(uart::INTERRUPT) => BYTES_IN.with(|bytes| {
            if let Some(byte) = Uart::BUS.receive() {
                // Where the thread is this late, a line is damaged and its frame is repeated.
                let _ = bytes.enqueue(byte);
            }
        }),
        Ok(clock::INTERRUPT) => clock::woken(),
        _ => panic!("interrupt {number} belongs to nobody"),
    }
}
