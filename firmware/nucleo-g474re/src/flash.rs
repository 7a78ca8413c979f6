//! Parameters and tap journal: the beginning of the second flash bank.
//!
//! The program runs from the first bank meanwhile. A word whose error correction fails raises the non-maskable
//! interrupt. Only this module reads the second bank, so there the interrupt always answers one of its reads.

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_rt::exception;
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::regs::Cr;
use leadscrew_parts::{WordDevice, WordError, WordFlash};

/// Bytes of a page of the chip.
const CHIP_PAGE: usize = 2048;
/// Bytes that are erased together: two pages of the chip. A parameter set has to fit into them.
const PAGE: usize = 2 * CHIP_PAGE;
/// Pages for the regions.
const PAGES: usize = 8;
/// The address where they begin: the second bank.
const START: u32 = 0x0804_0000;

/// The keys that unlock the registers for writing.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// A word of the second bank was read whose error correction failed. With one processor, barriers are enough to order
/// this flag and the reads.
static UNREADABLE: AtomicBool = AtomicBool::new(false);
/// Bytes from a word to another one of the same page, far enough that no read of one fetches both.
const ELSEWHERE: u32 = CHIP_PAGE as u32 / 2;

/// The pages of the second bank.
pub struct Bank(());

/// Starts the flash.
///
/// # Panics
/// Where the chip has its flash in one bank: it would stop for every write, and the pages would be others.
pub fn start() -> WordFlash<Bank> {
    if !FLASH.optr().read().dbank() {
        panic!("one bank");
    }
    WordFlash(Bank(()))
}

/// Changes the flash. It is unlocked for `work`, which starts the change; these bits are set. The chip needs its data
/// cache off meanwhile, and empty afterwards.
#[inline(never)]
fn change(bits: Cr, work: &dyn Fn()) -> Result<(), WordError> {
    while FLASH.sr().read().bsy() {}
    if FLASH.cr().read().lock() {
        let [first, second] = KEYS;
        FLASH.keyr().write_value(first);
        FLASH.keyr().write_value(second);
    }
    // The value written back clears the errors of earlier changes.
    FLASH.sr().modify(|_| {});
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.cr().write_value(bits);
    work();
    // The change must have begun before the status is read.
    cortex_m::asm::dsb();
    let state = loop {
        let state = FLASH.sr().read();
        if !state.bsy() {
            break state;
        }
    };
    forget();
    // The bits of the change are cleared first; then the registers are locked.
    FLASH.cr().write_value(Cr(0));
    FLASH.cr().write(|w| w.set_lock(true));
    let failed =
        state.progerr() || state.wrperr() || state.pgaerr() || state.sizerr() || state.pgserr();
    if failed {
        Err(WordError::Refused)
    } else {
        Ok(())
    }
}

/// Empties the chip's data cache: changed words, and unreadable words, must not stay in it.
fn forget() {
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(true));
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
        let before = FLASH.eccr().read();
        FLASH.eccr().write_value(before);
        UNREADABLE.store(false, Ordering::Relaxed);
        let (low, high) = look(offset);
        // The manual does not say how soon the interrupt of a bad word comes. So this also reads the flag that raises
        // it, which gives it some time too.
        let told = FLASH.eccr().read().eccd();
        cortex_m::asm::dsb();
        if told || UNREADABLE.load(Ordering::Relaxed) {
            // A second read has to fail like the first: the word may be in the cache, and in the buffer of the last
            // read next to it.
            forget();
            look(offset ^ ELSEWHERE);
            return Err(WordError::Unreadable);
        }
        let [a, b, c, d] = low.to_le_bytes();
        let [e, f, g, h] = high.to_le_bytes();
        Ok([a, b, c, d, e, f, g, h])
    }

    fn write(&mut self, offset: u32, word: [u8; 8]) -> Result<(), WordError> {
        let [a, b, c, d, e, f, g, h] = word;
        let halves = [
            u32::from_le_bytes([a, b, c, d]),
            u32::from_le_bytes([e, f, g, h]),
        ];
        let mut bits = Cr(0);
        bits.set_pg(true);
        change(bits, &|| {
            let at = (START + offset) as *mut u32;
            let [low, high] = halves;
            // SAFETY: both halves of a word of the second bank; `offset` has been checked. They are written in this order.
            unsafe {
                at.write_volatile(low);
                cortex_m::asm::isb();
                at.add(1).write_volatile(high);
            }
        })
    }

    fn erase(&mut self, page: u32) -> Result<(), WordError> {
        let first = (page / CHIP_PAGE as u32) as u8;
        for number in [first, first + 1] {
            let mut bits = Cr(0);
            bits.set_per(true);
            bits.set_bker(true);
            bits.set_pnb(number);
            change(bits, &|| FLASH.cr().modify(|w| w.set_strt(true)))?;
        }
        Ok(())
    }
}

#[exception]
unsafe fn NonMaskableInt() {
    let state = FLASH.eccr().read();
    // The program runs from the other bank, whose words are read meanwhile too.
    let kept = state.bk_ecc() && !state.sysf_ecc();
    if state.eccd() && kept {
        UNREADABLE.store(true, Ordering::Relaxed);
        // The value written back clears the flags, so that the next bad word is reported again. This must happen before
        // the return, or the interrupt would come once more and find nothing.
        FLASH.eccr().write_value(state);
        cortex_m::asm::dsb();
        return;
    }
    // The program itself cannot be read, or the crystal has stopped: the program cannot go on.
    panic!("non-maskable interrupt");
}
