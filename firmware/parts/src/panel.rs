//! Contacts and switches of a board, behind the traits of pins.
//!
//! Contacts close to ground: a stop circuit that is open, by its button or by a broken wire, reads high. What they say
//! counts when three looks in a row agree; a look is taken in every period.

use embedded_hal::digital::{InputPin, OutputPin};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Event, State};
use leadscrew_core::program::Aux;

/// Looks that have to agree.
const LOOKS: u8 = 3;
/// Clamps, and releases: the M functions for a board's clamp [D137].
const CLAMP: u16 = 10;
const RELEASE: u16 = 11;

/// A contact without its bouncing.
#[derive(Debug)]
struct Contact<P> {
    pin: P,
    closed: bool,
    /// Looks in a row that saw the contrary.
    contrary: u8,
}

impl<P: InputPin> Contact<P> {
    const fn new(pin: P, closed: bool) -> Self {
        Self {
            pin,
            closed,
            contrary: 0,
        }
    }

    /// A look. A pin that cannot be read is an open contact.
    fn is_closed(&mut self) -> bool {
        let closed = self.pin.is_low().unwrap_or(false);
        if closed == self.closed {
            self.contrary = 0;
        } else {
            self.contrary = self.contrary.saturating_add(1);
        }
        if self.contrary >= LOOKS {
            self.closed = closed;
            self.contrary = 0;
        }
        self.closed
    }
}

/// What the contacts say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Said {
    /// The emergency stop circuit is open.
    pub stop: bool,
    /// Feed hold is pressed.
    pub hold: bool,
    /// The clamp is told to hold, and does not.
    pub loose: bool,
}

impl Said {
    /// The alarm that stops the machine for this.
    #[must_use]
    pub const fn trouble(&self) -> Option<Code> {
        if self.loose {
            Some(Code::ClampOpen)
        } else {
            None
        }
    }
}

/// The contacts of a board: emergency stop circuit, feed hold, clamp feedback.
#[derive(Debug)]
pub struct Contacts<S, H, C> {
    stop: Contact<S>,
    hold: Contact<H>,
    clamped: Contact<C>,
    /// Periods a clamp may take.
    patience: u32,
    /// Periods for which it should hold and does not.
    loose: u32,
}

impl<S: InputPin, H: InputPin, C: InputPin> Contacts<S, H, C> {
    /// Before the first look the stop circuit counts as open, and nothing is pressed or clamped. A clamp may take so many
    /// periods to close.
    pub const fn new(stop: S, hold: H, clamped: C, patience: u32) -> Self {
        Self {
            stop: Contact::new(stop, false),
            hold: Contact::new(hold, false),
            clamped: Contact::new(clamped, false),
            patience,
            loose: 0,
        }
    }

    /// A look at all of them, once a period; `clamps`: the clamp is told to hold.
    pub fn look(&mut self, clamps: bool) -> Said {
        let clamped = self.clamped.is_closed();
        self.loose = if clamps && !clamped {
            self.loose.saturating_add(1)
        } else {
            0
        };
        Said {
            stop: !self.stop.is_closed(),
            hold: self.hold.is_closed(),
            loose: self.loose > self.patience,
        }
    }
}

/// What a board switches: clamp, spindle enable, its light. All off at power-up.
#[derive(Debug)]
pub struct Switches<C, S, L> {
    clamp: C,
    spindle: S,
    light: L,
    clamps: bool,
    spins: bool,
}

impl<C: OutputPin, S: OutputPin, L: OutputPin> Switches<C, S, L> {
    /// With its pins, which are low.
    pub const fn new(clamp: C, spindle: S, light: L) -> Self {
        Self {
            clamp,
            spindle,
            light,
            clamps: false,
            spins: false,
        }
    }

    /// Something has happened. M10 clamps, M11 releases; so does a reset, for the program that clamped is forgotten.
    pub fn note(&mut self, event: &Event) {
        match event {
            Event::Aux(Aux::M(CLAMP)) => self.clamps = true,
            Event::Aux(Aux::M(RELEASE)) | Event::Reset => self.clamps = false,
            _ => return,
        }
        // A pin of a chip cannot fail.
        let _ = self.clamp.set_state(self.clamps.into());
    }

    /// The clamp is told to hold.
    pub const fn clamps(&self) -> bool {
        self.clamps
    }

    /// The machine's state. The spindle is enabled as soon as its drive is up, and stays
    /// so on an alarm: it may hold a tap in its hole. An alarm that the board comes up
    /// with does not enable it. The light is on while the machine is up and has no alarm.
    pub fn show(&mut self, state: &State) {
        let well = matches!(state, State::Idle | State::Running | State::Held);
        let stops = matches!(state, State::Stopping(_) | State::Alarm(_));
        self.spins = well || self.spins && stops;
        let _ = self.spindle.set_state(self.spins.into());
        let _ = self.light.set_state(well.into());
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::cell::Cell;
    use core::convert::Infallible;
    use std::rc::Rc;

    use embedded_hal::digital::ErrorType;
    use leadscrew_core::alarm::{Alarm, Span};
    use leadscrew_core::board::Outcome;

    use super::*;

    #[derive(Clone, Default)]
    struct Pin(Rc<Cell<bool>>);

    impl ErrorType for Pin {
        type Error = Infallible;
    }

    impl InputPin for Pin {
        fn is_high(&mut self) -> Result<bool, Infallible> {
            Ok(self.0.get())
        }

        fn is_low(&mut self) -> Result<bool, Infallible> {
            Ok(!self.0.get())
        }
    }

    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0.set(false);
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0.set(true);
            Ok(())
        }
    }

    /// Stop circuit closed, hold and clamp open.
    fn contacts() -> ([Pin; 3], Contacts<Pin, Pin, Pin>) {
        let pins: [Pin; 3] = core::array::from_fn(|_| Pin::default());
        pins[1].0.set(true);
        pins[2].0.set(true);
        let [stop, hold, clamped] = pins.clone();
        let mut contacts = Contacts::new(stop, hold, clamped, 5);
        // It counts as open until three looks have seen it closed.
        assert!(contacts.look(false).stop && contacts.look(false).stop);
        assert_eq!(contacts.look(false), Said::default());
        (pins, contacts)
    }

    #[test]
    fn an_open_circuit_stops_and_a_short_pulse_does_not() {
        let ([stop, ..], mut contacts) = contacts();
        for _ in 0..10 {
            stop.0.set(true);
            assert!(!contacts.look(false).stop && !contacts.look(false).stop);
            stop.0.set(false);
            assert!(!contacts.look(false).stop);
        }
        stop.0.set(true);
        assert!(!contacts.look(false).stop && !contacts.look(false).stop);
        assert!(contacts.look(false).stop);
    }

    #[test]
    fn hold_is_pressed_to_ground() {
        let ([_, hold, _], mut contacts) = contacts();
        hold.0.set(false);
        let said = [(); 3].map(|()| contacts.look(false).hold);
        assert_eq!(said, [false, false, true]);
    }

    #[test]
    fn a_clamp_that_does_not_close_or_opens_again_is_told() {
        let ([_, _, clamped], mut contacts) = contacts();
        // It is open and should be.
        assert!((0..100).all(|_| !contacts.look(false).loose));
        let said = [(); 7].map(|()| contacts.look(true).loose);
        assert_eq!(said, [false, false, false, false, false, true, true]);
        assert_eq!(contacts.look(true).trouble(), Some(Code::ClampOpen));
        clamped.0.set(false);
        let said = [(); 4].map(|()| contacts.look(true).loose);
        assert_eq!(said, [true, true, false, false]);
        assert_eq!(contacts.look(true).trouble(), None);
        clamped.0.set(true);
        let until = (1..).find(|_| contacts.look(true).loose);
        // Three looks, and the patience.
        assert_eq!(until, Some(3 + 5));
    }

    #[test]
    fn the_clamp_follows_its_functions_and_lets_go_at_a_reset() {
        let [clamp, spindle, light] = [(); 3].map(|()| Pin::default());
        let mut switches = Switches::new(clamp.clone(), spindle, light);
        let m = |code| Event::Aux(Aux::M(code));
        switches.note(&m(8));
        assert!(!clamp.0.get());
        switches.note(&m(10));
        assert!(clamp.0.get() && switches.clamps());
        switches.note(&m(9));
        assert!(clamp.0.get());
        switches.note(&m(11));
        assert!(!clamp.0.get() && !switches.clamps());
        switches.note(&m(10));
        switches.note(&Event::Finished);
        assert!(clamp.0.get());
        switches.note(&Event::Reset);
        assert!(!clamp.0.get());
    }

    #[test]
    fn the_spindle_stays_enabled_on_an_alarm_and_the_light_goes_out() {
        let [clamp, spindle, light] = [(); 3].map(|()| Pin::default());
        let mut switches = Switches::new(clamp, spindle.clone(), light.clone());
        let alarm = Alarm::new(Code::EmergencyStop, Span::default());
        let mut shown = |state| {
            switches.show(&state);
            (spindle.0.get(), light.0.get())
        };
        assert_eq!(shown(State::Starting), (false, false));
        // The stop circuit is open when it comes up: no drive has been brought up yet.
        assert_eq!(shown(State::Alarm(alarm)), (false, false));
        assert_eq!(shown(State::Stopping(Outcome::Reset)), (false, false));
        assert_eq!(shown(State::Idle), (true, true));
        assert_eq!(shown(State::Running), (true, true));
        assert_eq!(shown(State::Stopping(Outcome::Alarm(alarm))), (true, false));
        assert_eq!(shown(State::Alarm(alarm)), (true, false));
        assert_eq!(shown(State::Starting), (false, false));
    }
}
