//! The pins: what each is for, and where it is on the board. `docs/hardware.md` has the same table.
//!
//! | pin | connector | is | level |
//! |---|---|---|---|
//! | PA11 | CN10-14 | CAN receive | from the transceiver |
//! | PA12 | CN10-12 | CAN transmit | to the transceiver |
//! | PA0 | CN7-28, A0 | encoder A | pull-up |
//! | PA1 | CN7-30, A1 | encoder B | pull-up |
//! | PB10 | CN10-25, D6 | encoder index | pull-up, pulse high |
//! | PA8 | CN10-23, D7 | handwheel A | pull-up |
//! | PA9 | CN10-21, D8 | handwheel B | pull-up |
//! | PC0 | CN7-38, A5 | emergency stop circuit | closed to ground; open: stop |
//! | PC1 | CN7-36, A4 | feed hold circuit | closed to ground; open: hold |
//! | PC2 | CN7-35 | clamp feedback | closed to ground: clamped |
//! | PC3 | CN7-37 | clamp | high: clamp |
//! | PB0 | CN7-34, A3 | spindle enable | high: enabled |
//! | PC4 | CN10-34 | input 1 of the machine | closed to ground: on |
//! | PC5 | CN10-6 | input 2 of the machine | closed to ground: on |
//! | PC6 | CN10-4 | input 3 of the machine | closed to ground: on |
//! | PC7 | CN10-19 | input 4 of the machine | closed to ground: on |
//! | PC8 | CN10-2 | input 5 of the machine | closed to ground: on |
//! | PC9 | CN10-1 | input 6 of the machine | closed to ground: on |
//! | PC10 | CN7-1 | input 7 of the machine | closed to ground: on |
//! | PC11 | CN7-2 | input 8 of the machine | closed to ground: on |
//! | PB11 | CN10-18 | output 1 of the machine | high: on |
//! | PB12 | CN10-16 | output 2 of the machine | high: on |
//! | PB13 | CN10-30 | output 3 of the machine | high: on |
//! | PB14 | CN10-28 | output 4 of the machine | high: on |
//! | PB15 | CN10-26 | output 5 of the machine | high: on |
//! | PA5 | CN10-11, D13 | LED LD2 | high: on |
//!
//! The bus does not use PB8 and PB9: PB8 is BOOT0 at a reset, and a transceiver at rest pulls it high, which starts the
//! chip's boot loader. PA2, PA3, PA13, PA14 and PB3 belong to the debug probe, PF0 and PF1 to the crystal.

use core::convert::Infallible;

use embassy_stm32::pac::gpio::vals::{Moder, Ospeedr, Pupdr};
use embassy_stm32::pac::{GPIOA, GPIOB, GPIOC};
use embedded_hal::digital::{ErrorType, InputPin, OutputPin, PinState};

use crate::clock;

/// The board's contacts.
pub type Contacts = leadscrew_parts::Contacts<Input, Input>;
/// The clamp.
pub type Clamp = leadscrew_parts::Clamp<Output, Input>;
/// The other outputs of the board.
pub type Switches = leadscrew_parts::Switches<Output, Output>;

/// The alternate functions of the pins.
const TIM1: u8 = 6;
const TIM2: u8 = 1;
const FDCAN: u8 = 9;

/// Configures the pins of the outputs: all are off. The ports have their clocks already.
pub fn start_outputs() {
    GPIOA.moder().modify(|w| {
        w.set_moder(5, Moder::OUTPUT);
    });
    GPIOB.moder().modify(|w| {
        w.set_moder(0, Moder::OUTPUT);
        for pin in 11..16 {
            w.set_moder(pin, Moder::OUTPUT);
        }
    });
    GPIOC.moder().modify(|w| {
        w.set_moder(3, Moder::OUTPUT);
    });
}

/// Gives every pin its function. All outputs are off. Encoder and contacts have pull-ups: open collectors and contacts
/// to ground need no more, and a broken wire reads as an open contact.
pub fn start() {
    start_outputs();
    GPIOA.afr(0).modify(|w| {
        w.set_afr(0, TIM2);
        w.set_afr(1, TIM2);
    });
    GPIOA.afr(1).modify(|w| {
        w.set_afr(0, TIM1);
        w.set_afr(1, TIM1);
        w.set_afr(11 - 8, FDCAN);
        w.set_afr(12 - 8, FDCAN);
    });
    GPIOA.pupdr().modify(|w| {
        w.set_pupdr(0, Pupdr::PULL_UP);
        w.set_pupdr(1, Pupdr::PULL_UP);
        w.set_pupdr(8, Pupdr::PULL_UP);
        w.set_pupdr(9, Pupdr::PULL_UP);
        w.set_pupdr(11, Pupdr::PULL_UP);
    });
    GPIOA
        .ospeedr()
        .modify(|w| w.set_ospeedr(12, Ospeedr::MEDIUM_SPEED));
    GPIOA.moder().modify(|w| {
        w.set_moder(0, Moder::ALTERNATE);
        w.set_moder(1, Moder::ALTERNATE);
        w.set_moder(8, Moder::ALTERNATE);
        w.set_moder(9, Moder::ALTERNATE);
        w.set_moder(11, Moder::ALTERNATE);
        w.set_moder(12, Moder::ALTERNATE);
    });

    GPIOB.afr(1).modify(|w| w.set_afr(10 - 8, TIM2));
    GPIOB.pupdr().modify(|w| w.set_pupdr(10, Pupdr::PULL_UP));
    GPIOB.moder().modify(|w| {
        w.set_moder(10, Moder::ALTERNATE);
    });

    GPIOC.pupdr().modify(|w| {
        w.set_pupdr(0, Pupdr::PULL_UP);
        w.set_pupdr(1, Pupdr::PULL_UP);
        w.set_pupdr(2, Pupdr::PULL_UP);
        for pin in 4..12 {
            w.set_pupdr(pin, Pupdr::PULL_UP);
        }
    });
    GPIOC.moder().modify(|w| {
        w.set_moder(0, Moder::INPUT);
        w.set_moder(1, Moder::INPUT);
        w.set_moder(2, Moder::INPUT);
        for pin in 4..12 {
            w.set_moder(pin, Moder::INPUT);
        }
    });
}

/// The contacts, with known states: this takes some milliseconds.
pub fn contacts() -> Contacts {
    Contacts::new(Input(1 << 0), Input(1 << 1), || {
        cortex_m::asm::delay(clock::CORE_MHZ * 1000);
    })
}

/// The clamp.
pub const fn clamp() -> Clamp {
    Clamp::new(Output::Clamp, Input(1 << 2))
}

/// The other outputs.
pub const fn switches() -> Switches {
    Switches::new(Output::Spindle, Output::Light)
}

/// The machine's inputs that are on: their contacts are closed to ground.
pub fn machine_inputs() -> u16 {
    (!GPIOC.idr().read().0 >> 4) as u16 & 0xFF
}

/// Sets the machine's outputs; there are five.
pub fn set_machine_outputs(outputs: u16) {
    let high = u32::from(outputs & 0x1F) << 11;
    let low = u32::from(!outputs & 0x1F) << 27;
    // A bit of the lower half sets the pin high, a bit of the upper half sets it low.
    GPIOB.bsrr().write(|w| w.0 = high | low);
}

/// Switches the light.
pub fn light(on: bool) {
    let _ = Output::Light.set_state(on.into());
}

/// A contact: its bit of port C.
pub struct Input(u8);

impl ErrorType for Input {
    type Error = Infallible;
}

impl InputPin for Input {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(GPIOC.idr().read().0 & u32::from(self.0) != 0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

/// An output of the board.
pub enum Output {
    Clamp,
    Spindle,
    Light,
}

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::Low)
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::High)
    }

    #[inline(never)]
    fn set_state(&mut self, state: PinState) -> Result<(), Infallible> {
        let (port, pin) = match self {
            Self::Clamp => (GPIOC, 3),
            Self::Spindle => (GPIOB, 0),
            Self::Light => (GPIOA, 5),
        };
        // A bit of the lower half sets the pin high, a bit of the upper half sets it low.
        let bit = match state {
            PinState::Low => 1 << 16,
            PinState::High => 1,
        };
        port.bsrr().write(|w| w.0 = bit << pin);
        Ok(())
    }
}
