//! The pins: what each is for, and where it is on the board. `docs/hardware.md` has the same table.
//!
//! | pin | connector | is | level |
//! |---|---|---|---|
//! | PA11 | CN10-14 | CAN receive | from the transceiver |
//! | PA12 | CN10-12 | CAN transmit | to the transceiver |
//! | PA0 | CN7-28, A0 | encoder A | pull-up |
//! | PA1 | CN7-30, A1 | encoder B | pull-up |
//! | PB10 | CN10-25, D6 | encoder index | pull-up, pulse high |
//! | PC0 | CN7-38, A5 | emergency stop circuit | closed to ground; open: stop |
//! | PC1 | CN7-36, A4 | feed hold | closed to ground: hold |
//! | PC2 | CN7-35 | clamp feedback | closed to ground: clamped |
//! | PC3 | CN7-37 | clamp | high: clamp |
//! | PB0 | CN7-34, A3 | spindle enable | high: enabled |
//! | PA5 | CN10-11, D13 | LED LD2 | high: on |
//!
//! Not PB8 and PB9 for the bus: PB8 is BOOT0 at a reset, and a transceiver at rest pulls it high, which starts the chip's boot
//! loader. PA2, PA3, PA13, PA14 and PB3 belong to the debug probe, PF0 and PF1 to the crystal.

use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_stm32::{Peri, peripherals};

/// The board's contacts.
pub type Contacts = leadscrew_parts::Contacts<Input<'static>, Input<'static>, Input<'static>>;
/// What the board switches.
pub type Switches = leadscrew_parts::Switches<Output<'static>, Output<'static>, Output<'static>>;

/// Contacts to ground, with the chip's pull-ups: a broken wire is an open contact. A clamp may take so many periods.
pub fn contacts(
    stop: Peri<'static, peripherals::PC0>,
    hold: Peri<'static, peripherals::PC1>,
    clamped: Peri<'static, peripherals::PC2>,
    patience: u32,
) -> Contacts {
    let [stop, hold, clamped] = [
        Input::new(stop, Pull::Up),
        Input::new(hold, Pull::Up),
        Input::new(clamped, Pull::Up),
    ];
    Contacts::new(stop, hold, clamped, patience)
}

/// All off.
pub fn switches(
    clamp: Peri<'static, peripherals::PC3>,
    spindle: Peri<'static, peripherals::PB0>,
    light: Peri<'static, peripherals::PA5>,
) -> Switches {
    let [clamp, spindle, light] = [
        Output::new(clamp, Level::Low, Speed::Low),
        Output::new(spindle, Level::Low, Speed::Low),
        Output::new(light, Level::Low, Speed::Low),
    ];
    Switches::new(clamp, spindle, light)
}
