//! Who is interrupted by what, and what belongs to an interrupt alone.
//!
//! | level | interrupt | owns |
//! |---|---|---|
//! | above all | the watchdog's, which cannot be masked | nothing: it waits for the reset |
//! | 0 | 20, no device's: set by the thread, one for each SYNC period | the tick's side and the plant |
//! | 32 | 0, a byte on the UART | the end of the byte ring that it fills |
//! | 64 | 9, a millisecond has passed | nothing: it wakes the thread |

use core::cell::UnsafeCell;

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use heapless::spsc::{Consumer, Producer, Queue};
use leadscrew_app::TickSide;
use static_cell::ConstStaticCell;

use crate::shop::Shop;
use crate::{clock, uart};

/// Bytes between two looks of the thread; the emulated UART waits until each has been taken.
pub const BYTES: usize = 4096;

/// The tick's interrupt.
const TICK: u16 = 20;

#[derive(Clone, Copy)]
struct Number(u16);

// SAFETY: each `Number` is made of a constant that is an interrupt of this processor, and they are all different.
unsafe impl InterruptNumber for Number {
    fn number(self) -> u16 {
        self.0
    }
}

/// Something that the thread gives to an interrupt before that is enabled.
struct Owned<T>(UnsafeCell<Option<T>>);

// SAFETY: `give` is called by the thread before `enable`, `with` by one interrupt only after it: never both at a time.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    const fn none() -> Self {
        Self(UnsafeCell::new(None))
    }

    fn give(&self, value: T) {
        // SAFETY: the interrupt that reads it is not enabled yet.
        unsafe { *self.0.get() = Some(value) }
    }

    fn with(&self, work: impl FnOnce(&mut T)) {
        // SAFETY: only its interrupt calls this, and does not interrupt itself.
        if let Some(value) = unsafe { &mut *self.0.get() } {
            work(value);
        }
    }
}

static TICK_SIDE: Owned<(&'static mut TickSide, Shop)> = Owned::none();
static BYTES_IN: Owned<Producer<'static, u8>> = Owned::none();

/// Gives the tick's interrupt what is its own.
pub fn own_tick(tick: &'static mut TickSide, shop: Shop) {
    TICK_SIDE.give((tick, shop));
}

/// Gives the UART's interrupt its end of the ring; the other end comes back.
pub fn own_uart() -> Consumer<'static, u8> {
    static RING: ConstStaticCell<Queue<u8, BYTES>> = ConstStaticCell::new(Queue::new());
    let (bytes_in, bytes_out) = RING.take().split();
    BYTES_IN.give(bytes_in);
    bytes_out
}

/// From here on there are interrupts.
pub fn enable() {
    uart::start();
    clock::start();
    // SAFETY: the only place that touches the interrupt controller's levels; no critical section relies on them.
    let mut nvic = unsafe { cortex_m::Peripherals::steal().NVIC };
    for (number, level) in [(TICK, 0), (uart::INTERRUPT, 32), (clock::INTERRUPT, 64)] {
        // SAFETY: as above; what the handlers own has been given to them.
        unsafe {
            nvic.set_priority(Number(number), level);
            NVIC::unmask(Number(number));
        }
    }
}

/// Lets one SYNC period happen, and returns behind it.
pub fn tick() {
    NVIC::pend(Number(TICK));
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    match u16::try_from(number) {
        Ok(TICK) => TICK_SIDE.with(|(tick, shop)| tick.tick(shop)),
        Ok(uart::INTERRUPT) => BYTES_IN.with(|bytes| {
            if let Some(byte) = uart::receive() {
                // Where the thread is that far behind, a line is damaged and its frame repeated.
                let _ = bytes.enqueue(byte);
            }
        }),
        Ok(clock::INTERRUPT) => clock::woken(),
        _ => panic!("interrupt {number} belongs to nobody"),
    }
}
