//! What the board keeps (parameters, tables, tap journal): the second half of the second flash bank, 128 KiB.
//!
//! Nothing runs from the second bank while it changes: the processor would wait for the instruction, and every interrupt
//! with it. So [`Bank::write`] and [`Bank::erase`] wait in the first bank, and no interrupt uses code of the second
//! (`second.x`).
//!
//! A word whose error correction fails raises the non-maskable interrupt. While this module reads, nothing else does from
//! the second bank, so then the interrupt answers its read. At any other time a part of the program cannot be read.

use core::hint::spin_loop;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_rt::exception;
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::pac::FLASH as REGISTERS;
use embassy_stm32::peripherals::FLASH;
use leadscrew_parts::{WordDevice, WordError, WordFlash};

/// Bytes of a page of the chip.
const CHIP_PAGE: usize = 2048;
/// Bytes that are erased together: two pages of the chip. A parameter set has to fit into them.
const PAGE: usize = 2 * CHIP_PAGE;
/// Pages for the regions.
const PAGES: usize = 32;
/// Bytes of the chip's flash.
const FLASH: u32 = 512 * 1024;
/// Where the regions begin, from the beginning of the flash: they are its end. The more pages there are,
/// the less often each is erased.
const PLACE: u32 = FLASH - (PAGE * PAGES) as u32;
/// The address of that.
const START: u32 = 0x0800_0000 + PLACE;
/// How often the flag of a bad word is looked at, at most, until the interrupt of that word has come.
const PATIENCE: u32 = 1000;

/// This module reads a word. With one processor, barriers are enough to order this flag, the next one and the reads.
static READING: AtomicBool = AtomicBool::new(false);
/// The error correction of the word that is read has failed.
static UNREADABLE: AtomicBool = AtomicBool::new(false);
/// Bytes from a word to another one of the same page, far enough that no read of one fetches both.
const ELSEWHERE: u32 = CHIP_PAGE as u32 / 2;

/// The pages of the second bank. The crate's driver changes them, with the chip's data cache off meanwhile and empty
/// afterwards; it knows nothing of bad words, so they are read here.
pub struct Bank(Flash<'static, Blocking>);

/// Starts the flash.
///
/// # Panics
/// Where the chip has its flash in one bank: it would stop for every write, and the pages would be others.
pub fn start(part: Peri<'static, FLASH>) -> WordFlash<Bank> {
    WordFlash(Bank(Flash::new_blocking(part)))
}

/// Empties the chip's data cache: changed words, and unreadable words, must not stay in it.
fn forget() {
    REGISTERS.acr().modify(|w| w.set_dcen(false));
    REGISTERS.acr().modify(|w| w.set_dcrst(true));
    REGISTERS.acr().modify(|w| w.set_dcrst(false));
    REGISTERS.acr().modify(|w| w.set_dcen(true));
}

/// Both halves of a word, after the reads are complete.
fn look(offset: u32) -> (u32, u32) {
    let at = (START + offset) as *const u32;
    // SAFETY: a word of the second bank; `offset` has been checked.
    let halves = unsafe { (at.read_volatile(), at.add(1).read_volatile()) };
    cortex_m::asm::dsb();
    halves
}

impl WordDevice for Bank {
    const PAGE: usize = PAGE;
    const SIZE: usize = PAGE * PAGES;

    fn read(&mut self, offset: u32) -> Result<[u8; 8], WordError> {
        // A corrected error of an earlier read would keep its address, and a bad word would be reported with this
        // address. The value written back clears the flags that are set.
        let before = REGISTERS.eccr().read();
        REGISTERS.eccr().write_value(before);
        UNREADABLE.store(false, Ordering::Relaxed);
        READING.store(true, Ordering::Relaxed);
        let (low, high) = look(offset);
        // The manual does not say how soon the interrupt of a bad word comes, so its flag counts as well.
        let mut bad = REGISTERS.eccr().read().eccd();
        cortex_m::asm::dsb();
        bad |= UNREADABLE.load(Ordering::Relaxed);
        if bad {
            // A second read has to fail like the first: the word may be in the cache, and in the buffer of the last
            // read next to it.
            forget();
            look(offset ^ ELSEWHERE);
            // The interrupt clears the flag. Until then it is the answer to this read.
            for _ in 0..PATIENCE {
                if !REGISTERS.eccr().read().eccd() {
                    break;
                }
                spin_loop();
            }
        }
        READING.store(false, Ordering::Relaxed);
        if bad {
            return Err(WordError::Unreadable);
        }
        let [a, b, c, d] = low.to_le_bytes();
        let [e, f, g, h] = high.to_le_bytes();
        Ok([a, b, c, d, e, f, g, h])
    }

    // A function of its own, so that a look at the image finds what it calls.
    #[inline(never)]
    fn write(&mut self, offset: u32, word: [u8; 8]) -> Result<(), WordError> {
        self.0
            .blocking_write(PLACE + offset, &word)
            .map_err(|_| WordError::Refused)
    }

    #[inline(never)]
    fn erase(&mut self, page: u32) -> Result<(), WordError> {
        let first = PLACE + page;
        self.0
            .blocking_erase(first, first + PAGE as u32)
            .map_err(|_| WordError::Refused)
    }
}

#[exception]
unsafe fn NonMaskableInt() {
    let state = REGISTERS.eccr().read();
    // Meanwhile the program is read from the other bank.
    let kept = state.bk_ecc() && !state.sysf_ecc();
    if state.eccd() && kept && READING.load(Ordering::Relaxed) {
        UNREADABLE.store(true, Ordering::Relaxed);
        // The value written back clears the flags, so that the next bad word is reported again. This must happen before
        // the return, or the interrupt would come once more and find nothing.
        REGISTERS.eccr().write_value(state);
        cortex_m::asm::dsb();
        return;
    }
    // The program itself cannot be read, or the crystal has stopped: the program cannot go on.
    panic!("non-maskable interrupt");
}
