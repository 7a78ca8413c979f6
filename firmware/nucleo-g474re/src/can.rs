//! The CAN controller FDCAN1, register by register: classical frames and those of CAN FD, a hardware queue of three, no
//! automatic return from bus-off.
//!
//! The driver of the support crate does not fit: it passes frames through channels that mask all interrupts, and the
//! tick must not wait for the background. Here one interrupt owns receiving and sending; the tick only puts the SYNC in.
//!
//! A controller that has gone off the bus stays off. It was part of a fault that somebody has to look at, and drives
//! that have missed setpoints must not get new ones by surprise. The board only reports the state. The same holds where
//! the controller could not read its message memory in time: it then enters restricted operation by itself, sends
//! nothing any more, and stays there.

use embassy_stm32::pac::can::regs::{Dbtp, Nbtp, Tdcr};
use embassy_stm32::pac::can::vals::{Anfe, Anfs, Tfqm};
use embassy_stm32::pac::{FDCAN1, FDCANRAM1, interrupt};
use leadscrew_core::bus::Controller;
use leadscrew_parts::{ELEMENT, Heard, Places, Rates};

use crate::clock;

/// Places for frames to be sent; each queue of received frames has as many.
const PLACES: u8 = Places::COUNT;
/// Words of all places together.
const ELEMENTS: usize = ELEMENT * PLACES as usize;
/// The first queue of received frames begins after 28 filters of one word, and 8 of two.
const RECEIVE: usize = 28 + 8 * 2;
/// The frames to be sent begin after two such queues, and three events of two words.
const TRANSMIT: usize = RECEIVE + 2 * ELEMENTS + 3 * 2;
/// Words of the message memory of one controller.
const WORDS: usize = TRANSMIT + ELEMENTS;
// The manual's figures in bytes: the offsets of the sections, and where the next controller's memory begins.
const _: () = assert!(RECEIVE * 4 == 0x0B0 && TRANSMIT * 4 == 0x278 && WORDS * 4 == 0x350);

/// Starts the controller, or starts it anew; then what waits in it is lost, and nobody may use it meanwhile.
///
/// It knows frames of CAN FD whether the board sends any or not: a classical controller destroys those of others.
pub fn start(rates: &Rates) {
    clock::start_can(rates.clock);
    FDCAN1.cccr().modify(|w| w.set_init(true));
    while !FDCAN1.cccr().read().init() {}
    FDCAN1.cccr().modify(|w| w.set_cce(true));
    FDCAN1.cccr().modify(|w| {
        w.set_fdoe(true);
        w.set_brse(rates.data.is_some());
    });
    let memory = FDCANRAM1.as_ptr().cast::<u32>();
    for word in 0..WORDS {
        // SAFETY: the memory of this controller has so many words, and nothing else uses it.
        unsafe { memory.add(word).write_volatile(0) };
    }
    FDCAN1.nbtp().write_value(Nbtp(rates.nominal.word()));
    if let Some(data) = rates.data {
        FDCAN1.dbtp().write_value(Dbtp(data.data_word()));
        FDCAN1.tdcr().write_value(Tdcr(data.delay_word()));
    }
    // Every standard data frame is received; extended and remote frames are rejected.
    FDCAN1.rxgfc().write(|w| {
        w.set_anfs(Anfs::ACCEPT_FIFO_0);
        w.set_anfe(Anfe::REJECT);
        w.set_rrfs(true);
        w.set_rrfe(true);
    });
    FDCAN1.txbc().write(|w| w.set_tfqm(Tfqm::QUEUE));
    // A place that becomes free, after sending or a cancellation, raises the interrupt.
    FDCAN1.txbtie().write(|w| w.0 = 0b111);
    FDCAN1.txbcie().write(|w| w.0 = 0b111);
    FDCAN1.ie().write(|w| {
        w.set_rfne(0, true);
        w.set_rfle(0, true);
        w.set_tce(true);
        w.set_tcfe(true);
        w.set_boe(true);
        w.set_mrafe(true);
    });
    FDCAN1.ile().write(|w| w.set_eint0(true));
    FDCAN1.cccr().modify(|w| w.set_cce(false));
    FDCAN1.cccr().modify(|w| w.set_init(false));
}

/// The address of a word of the message memory.
fn word(at: usize) -> *mut u32 {
    FDCANRAM1.as_ptr().cast::<u32>().wrapping_add(at)
}

/// Puts the words of a frame into the controller. Gives the frame's place, or `None` where no place is free. A call
/// must not interrupt another call.
pub fn put(words: &[u32]) -> Option<Places> {
    let state = FDCAN1.txfqs().read();
    if state.tfqf() {
        return None;
    }
    let place = state.tfqpi().min(PLACES - 1);
    let element = TRANSMIT + usize::from(place) * ELEMENT;
    for (at, value) in (element..element + ELEMENT).zip(words) {
        // SAFETY: an element of this controller's memory, in a free place.
        unsafe { word(at).write_volatile(*value) };
    }
    let place = Places(1 << place);
    FDCAN1.txbar().write(|w| w.0 = place.0);
    Some(place)
}

/// The next frame that was received.
pub fn take() -> Option<Heard> {
    let state = FDCAN1.rxfs(0).read();
    if state.ffl() == 0 {
        return None;
    }
    let place = state.fgi().min(PLACES - 1);
    let element = RECEIVE + usize::from(place) * ELEMENT;
    // SAFETY: an element of this controller's memory. The controller does not write to it before it is acknowledged.
    let words = [0, 1, 2, 3].map(|at| unsafe { word(element + at).read_volatile() });
    FDCAN1.rxfa(0).write(|w| w.set_fai(place));
    leadscrew_parts::received(words)
}

/// Acknowledges the interrupts. True where the controller has lost a received frame: no place was free, or the memory
/// access failed.
pub fn acknowledge() -> bool {
    let reasons = FDCAN1.ir().read();
    FDCAN1.ir().write_value(reasons);
    reasons.rfl(0) || reasons.mraf()
}

/// Places whose frame has not been sent yet.
pub fn pending() -> Places {
    Places(FDCAN1.txbrp().read().0 & Places::ALL.0)
}

/// Cancels the frames in these places, except one that is on the wire already.
pub fn call_back(places: Places) {
    FDCAN1.txbcr().write(|w| w.0 = places.0);
}

/// The state of the controller on the bus.
pub fn controller() -> Controller {
    let mode = FDCAN1.cccr().read().0;
    leadscrew_parts::controller(mode, FDCAN1.psr().read().0, FDCAN1.ecr().read().0)
}

/// The controller has left the bus, or is on its way back, or does not send.
pub fn is_off() -> bool {
    FDCAN1.psr().read().bo() || FDCAN1.cccr().read().asm()
}

/// The most reads of INIT while the bit passes to the clock of the bus; that takes a few cycles of each clock.
const COMES_OVER: u32 = 1000;

/// Takes part in the bus again, after bus-off (when 129 times eleven recessive bits have passed) or after restricted
/// operation. The controller drops all frames that wait to be sent when CCE is set. It clears CCE together with INIT.
pub fn rejoin() {
    if FDCAN1.cccr().read().asm() {
        FDCAN1.cccr().modify(|w| w.set_init(true));
        // Where INIT does not come the state stays as it is, and the caller tries again.
        let mut looks = 0..COMES_OVER;
        while !FDCAN1.cccr().read().init() && looks.next().is_some() {}
    }
    // Bus-off has set INIT. The caller repeats this call until the state has changed: INIT must not be set again, or
    // the count of recessive bits would begin again.
    FDCAN1.cccr().modify(|w| w.set_cce(true));
    FDCAN1.cccr().modify(|w| w.set_asm(false));
    FDCAN1.cccr().modify(|w| w.set_init(false));
}

/// Lets the interrupt run as soon as nothing more urgent does.
pub fn poke() {
    cortex_m::peripheral::NVIC::pend(interrupt::FDCAN1_IT0);
}
