//! Checks the names of the support crate against the figures of the chip's manual (RM0440), register by register.
//!
//! Without these checks a name with a wrong bit would show only on real hardware. The compiler does them; the image
//! contains nothing of this file.

use embassy_stm32::pac::can::regs::{
    Cccr, Dbtp, Ie, Ile, Ir, Rxfa, Rxfs, Rxgfc, Tdcr, Tscc, Txbc, Txfqs,
};
use embassy_stm32::pac::can::vals::{Anfe, Anfs, Tfqm, Tss};
use embassy_stm32::pac::dbgmcu::regs::Apb1lfzr;
use embassy_stm32::pac::flash::regs::{Acr, Cr, Eccr, Optr, Sr};
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::pac::gpio::regs::{Afr, Moder, Ospeedr, Pupdr};
use embassy_stm32::pac::gpio::vals;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::pwr::regs::Cr5;
use embassy_stm32::pac::rcc::regs::{Ahb2enr, Apb1enr1, Ccipr, Cfgr, Cr as Oscillators, Csr};
use embassy_stm32::pac::rcc::vals::{Fdcansel, Hpre, Sw};
use embassy_stm32::pac::timer::regs::{
    CcerGp16, CcmrInput2ch, Cr1Core, Cr2Gp16, DierBasicNoCr2, EgrCore, SmcrGp16, SrCore, SrGp16,
};
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, FilterValue, Mms, Sms, Ts, Urs};

/// A word as the manual writes it, and what the crate's names must read from it.
macro_rules! means {
    ($($word:expr, $register:pat => $meaning:expr;)*) => {
        $(const _: () = {
            let $register = $word;
            assert!($meaning);
        };)*
    };
}

// FDCAN.
means! {
    Cccr(0b111), w => w.init() && w.cce() && w.asm();
    Cccr(0b11), w => !w.asm();
    Cccr(0b11 << 8), w => w.fdoe() && w.brse();
    // 5 Mbit/s of 85 MHz, as `leadscrew-parts` makes its word.
    Dbtp(0x0080_0B33), w => w.tdc() && w.dbrp() == 0;
    Dbtp(0x0080_0B33), w => w.dtseg1() == 11 && w.dtseg2() == 3 && w.dsjw() == 3;
    Tdcr(13 << 8), w => w.tdco() == 13 && w.tdcf() == 0;
    Rxgfc(0b10 << 2 | 0b11), w => w.rrfe() && w.rrfs();
    Rxgfc(0b10 << 2), w => matches!((w.anfe(), w.anfs()), (Anfe::REJECT, Anfs::ACCEPT_FIFO_0));
    Tscc(0b10), w => matches!(w.tss(), Tss::EXTERNAL);
    Txbc(1 << 24), w => matches!(w.tfqm(), Tfqm::QUEUE);
    Txfqs(1 << 21 | 2 << 16), w => w.tfqf() && w.tfqpi() == 2;
    Rxfs(2 << 8 | 3), w => w.ffl() == 3 && w.fgi() == 2;
    Rxfa(2), w => w.fai() == 2;
    Ie(1 << 19 | 1 << 8 | 1 << 7 | 1 << 2 | 1), w => w.rfne(0) && w.rfle(0);
    Ie(1 << 19 | 1 << 8 | 1 << 7), w => w.tce() && w.tcfe() && w.boe();
    Ie(1 << 14), w => w.mrafe();
    Ir(1 << 14), w => w.mraf();
    Ir(1 << 2), w => w.rfl(0);
    Ile(1), w => w.eint0();
}

// Embedded flash memory.
means! {
    Acr(1 << 12 | 1 << 10 | 1 << 8), w => w.dcrst() && w.dcen() && w.prften();
    Acr(4), w => matches!(w.latency(), Latency::WS4);
    Sr(1 << 16), w => w.bsy();
    Sr(1 << 5 | 1 << 4 | 1 << 3), w => w.pgaerr() && w.wrperr() && w.progerr();
    Sr(1 << 7 | 1 << 6), w => w.pgserr() && w.sizerr();
    Cr(1 << 31 | 1), w => w.lock() && w.pg();
    Cr(1 << 16 | 1 << 11 | 127 << 3 | 1 << 1), w => w.strt() && w.bker() && w.pnb() == 127 && w.per();
    Eccr(1 << 31 | 1 << 22 | 1 << 21), w => w.eccd() && w.sysf_ecc() && w.bk_ecc();
    Optr(1 << 22), w => w.dbank();
}

// General-purpose timers, for the encoder; basic timers, for the beat.
means! {
    SmcrGp16(0b011), w => matches!(w.sms(), Sms::ENCODER_MODE_3);
    SmcrGp16(1 << 4), w => matches!(w.ts(), Ts::ITR1);
    Cr2Gp16(1 << 25), w => matches!(w.mms(), Mms::ENCODER_CLOCK_OUTPUT);
    CcmrInput2ch(0x5151), w => matches!((w.ccs(0), w.ccs(1)), (CcmrInputCcs::TI4, CcmrInputCcs::TI4));
    // Half the clock, eight samples; a sixteenth of the clock, eight samples.
    CcmrInput2ch(0xC050), w => matches!(w.icf(0), FilterValue::FDTS_DIV2_N8);
    CcmrInput2ch(0xC050), w => matches!(w.icf(1), FilterValue::FDTS_DIV16_N8);
    CcmrInput2ch(0b11), w => matches!(w.ccs(0), CcmrInputCcs::TRC);
    CcerGp16(1 << 8 | 1), w => w.cce(0) && w.cce(2);
    SrGp16(1 << 3 | 1 << 1), w => w.ccif(0) && w.ccif(2);
    Cr1Core(1 << 7 | 1 << 2 | 1), w => w.arpe() && w.cen() && matches!(w.urs(), Urs::COUNTER_ONLY);
    DierBasicNoCr2(1), w => w.uie();
    EgrCore(1), w => w.ug();
    SrCore(1), w => w.uif();
}

// RCC, IWDG, and the DBGMCU's control of the watchdog while a debugger stops the program.
means! {
    Apb1enr1(1 << 25 | 1 << 4 | 1 << 3), w => w.fdcanen() && w.tim6en() && w.tim5en();
    Apb1enr1(1), w => w.tim2en();
    Oscillators(1 << 19 | 1 << 17 | 1 << 16), w => w.csson() && w.hserdy() && w.hseon();
    Oscillators(1 << 10 | 1 << 8), w => w.hsirdy() && w.hsion();
    Ahb2enr(0b111), w => w.gpioaen() && w.gpioben() && w.gpiocen();
    Cfgr(0b1101), w => matches!((w.sw(), w.sws()), (Sw::HSI, Sw::PLL1_R));
    Cfgr(0b0111), w => matches!((w.sw(), w.sws()), (Sw::PLL1_R, Sw::HSI));
    Ccipr(0), w => matches!(w.fdcansel(), Fdcansel::HSE);
    Ccipr(1 << 24), w => matches!(w.fdcansel(), Fdcansel::PLL1_Q);
    Cfgr(0b0000 << 4), w => matches!(w.hpre(), Hpre::DIV1);
    Cfgr(0b1000 << 4), w => matches!(w.hpre(), Hpre::DIV2);
    Csr(1 << 30 | 1 << 29 | 1 << 28), w => w.wwdgrstf() && w.iwdgrstf() && w.sftrstf();
    Csr(1 << 27 | 1 << 26 | 1 << 23), w => w.borrstf() && w.pinrstf() && w.rmvf();
    Key::START.to_bits(), w => w == 0xCCCC;
    Key::ENABLE.to_bits(), w => w == 0x5555;
    Key::RESET.to_bits(), w => w == 0xAAAA;
    Pr::DIVIDE_BY4.to_bits(), w => w == 0;
    Apb1lfzr(1 << 12), w => w.iwdg();
}

// PWR: the crate has R1MODE in bit 0, where the chip has nothing. This fails once the crate is right; then `clock.rs`
// needs no bit of its own.
means! {
    Cr5(1 << 8), w => !w.r1mode();
}

// GPIO.
means! {
    Moder(0b10 << 24 | 0b01 << 10), w => matches!(w.moder(12), vals::Moder::ALTERNATE);
    Moder(0b10 << 24 | 0b01 << 10), w => matches!(w.moder(5), vals::Moder::OUTPUT);
    Moder(0), w => matches!(w.moder(0), vals::Moder::INPUT);
    Pupdr(0b01 << 22), w => matches!(w.pupdr(11), vals::Pupdr::PULL_UP);
    Ospeedr(0b01 << 24), w => matches!(w.ospeedr(12), vals::Ospeedr::MEDIUM_SPEED);
    Afr(9 << 16 | 1 << 4), w => w.afr(4) == 9 && w.afr(1) == 1;
}
