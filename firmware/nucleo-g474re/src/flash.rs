//! Parameters and tap journal: the beginning of the second flash bank.
//!
//! The program runs from the first bank meanwhile. A word whose error correction fails raises the non-maskable interrupt;
//! here that is an answer to a read, and nowhere else.

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_rt::exception;
use embassy_stm32::Peri;
use embassy_stm32::flash::{BANK1_REGION, Blocking, Flash};
use embassy_stm32::pac::FLASH;
use embassy_stm32::peripherals;
use leadscrew_parts::{WordDevice, WordError, WordFlash};

/// Bytes of a page.
const PAGE: usize = 2048;
/// Pages for the regions.
const PAGES: usize = 16;
/// Where they begin, behind the first bank.
const START: u32 = BANK1_REGION.size;

/// A word has been read whose error correction failed, since somebody last asked.
static UNREADABLE: AtomicBool = AtomicBool::new(false);
/// A word of the regions is being read: this may fail.
static READING: AtomicBool = AtomicBool::new(false);

/// The pages of the second bank.
pub struct Bank(Flash<'static, Blocking>);

/// Starts it.
pub fn start(flash: Peri<'static, peripherals::FLASH>) -> WordFlash<Bank> {
    WordFlash(Bank(Flash::new_blocking(flash)))
}

impl WordDevice for Bank {
    const PAGE: usize = PAGE;
    const SIZE: usize = PAGE * PAGES;

    fn read(&mut self, offset: u32) -> Result<[u8; 8], WordError> {
        let at = (embassy_stm32::flash::FLASH_BASE as u32 + START + offset) as *const u32;
        READING.store(true, Ordering::SeqCst);
        // SAFETY: both halves of a word of the second bank; `offset` has been checked.
        let (low, high) = unsafe { (at.read_volatile(), at.add(1).read_volatile()) };
        // The interrupt of a bad word comes before this is over.
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        READING.store(false, Ordering::SeqCst);
        if UNREADABLE.swap(false, Ordering::SeqCst) {
            return Err(WordError::Unreadable);
        }
        let [a, b, c, d] = low.to_le_bytes();
        let [e, f, g, h] = high.to_le_bytes();
        Ok([a, b, c, d, e, f, g, h])
    }

    fn write(&mut self, offset: u32, word: [u8; 8]) -> Result<(), WordError> {
        let written = self.0.blocking_write(START + offset, &word);
        written.map_err(|_| WordError::Refused)
    }

    fn erase(&mut self, page: u32) -> Result<(), WordError> {
        let erased = self
            .0
            .blocking_erase(START + page, START + page + PAGE as u32);
        erased.map_err(|_| WordError::Refused)
    }
}

#[exception]
unsafe fn NonMaskableInt() {
    let state = FLASH.eccr().read();
    if state.eccd() && READING.load(Ordering::SeqCst) {
        UNREADABLE.store(true, Ordering::SeqCst);
        // Written as read: what is set is cleared, and the next one is told again.
        FLASH.eccr().write_value(state);
        return;
    }
    // The program itself cannot be read, or the crystal has failed: nothing that is known still holds.
    panic!("non-maskable interrupt");
}
