//! Contacts and switches of a board, through the traits of pins.
//!
//! Contacts close to ground: an open circuit, by its button or by a broken wire, reads high. Stop and hold are break
//! contacts: they act when they open. A contact's state counts when three samples in a row agree. One sample is taken
//! in every period. Before the first period, samples are taken until the states are known.

use embedded_hal::digital::{InputPin, OutputPin};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Snapshot, State, Switching};
use leadscrew_core::call::Aux;

/// Samples that have to agree.
const LOOKS: u8 = 3;
/// Samples at power-up. A contact that still bounces then cannot be trusted, and counts as open.
const SETTLES: u8 = 100;
/// The M functions for a board's clamp: clamp and release [D137].
const CLAMP: u16 = 10;
const RELEASE: u16 = 11;

/// A debounced contact.
#[derive(Debug)]
struct Contact<P> {
    pin: P,
    closed: bool,
    /// The last sample, and the number of equal samples in a row, the last included.
    last: bool,
    alike: u8,
}

impl<P: InputPin> Contact<P> {
    /// A contact that counts as open until enough samples agree.
    const fn new(pin: P) -> Self {
        Self {
            pin,
            closed: false,
            last: false,
            alike: 0,
        }
    }

    /// Takes a sample. A pin that cannot be read is an open contact.
    fn is_closed(&mut self) -> bool {
        let closed = self.pin.is_low().unwrap_or(false);
        self.alike = if closed == self.last {
            self.alike.saturating_add(1)
        } else {
            1
        };
        self.last = closed;
        if self.is_settled() {
            self.closed = closed;
        }
        self.closed
    }

    /// True where the last samples agree.
    const fn is_settled(&self) -> bool {
        self.alike >= LOOKS
    }
}

/// The states of the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Said {
    /// The emergency stop circuit is open.
    pub stop: bool,
    /// Feed hold is pressed, or its circuit is open.
    pub hold: bool,
}

/// The contacts of a board: emergency stop circuit and feed hold.
#[derive(Debug)]
pub struct Contacts<S, H> {
    stop: Contact<S>,
    hold: Contact<H>,
}

impl<S: InputPin, H: InputPin> Contacts<S, H> {
    /// Takes the pins, and samples them until their states are known, so that no wrong state is reported and nothing
    /// comes up before. `wait` takes about a millisecond.
    pub fn new(stop: S, hold: H, mut wait: impl FnMut()) -> Self {
        let mut contacts = Self {
            stop: Contact::new(stop),
            hold: Contact::new(hold),
        };
        for _ in 0..SETTLES {
            let _ = contacts.look();
            if contacts.stop.is_settled() && contacts.hold.is_settled() {
                break;
            }
            wait();
        }
        contacts
    }

    /// Samples both contacts, once a period.
    pub fn look(&mut self) -> Said {
        Said {
            stop: !self.stop.is_closed(),
            hold: !self.hold.is_closed(),
        }
    }
}

/// The inputs of a machine, which are all sampled at once. They count when three samples of all of them in a row agree;
/// before that, nobody knows them.
#[derive(Debug, Default)]
pub struct MachineInputs {
    known: Option<u16>,
    last: u16,
    alike: u8,
}

impl MachineInputs {
    /// Inputs that nobody has looked at.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            known: None,
            last: 0,
            alike: 0,
        }
    }

    /// Takes a sample, once a period.
    pub const fn look(&mut self, sample: u16) -> Option<u16> {
        if sample != self.last {
            self.last = sample;
            self.alike = 0;
        }
        self.alike = self.alike.saturating_add(1);
        if self.alike >= LOOKS {
            self.known = Some(sample);
        }
        self.known
    }
}

/// A clamp, and the contact that is closed while the clamp holds.
#[derive(Debug)]
pub struct Clamp<O, C> {
    switch: O,
    holds: Contact<C>,
    /// The last order to the clamp.
    told: Told,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Told {
    /// To hold.
    Hold,
    /// To let go, by a program.
    Release,
    /// No order whose answer is waited for.
    Nothing,
}

impl<O: OutputPin, C: InputPin> Clamp<O, C> {
    /// Takes the pins. The switch is low; the clamp may be open or closed.
    pub const fn new(switch: O, holds: C) -> Self {
        Self {
            switch,
            holds: Contact::new(holds),
            told: Told::Nothing,
        }
    }

    /// M10 clamps, M11 releases. A reset releases too, because the program that clamped is over. With a tap in its hole
    /// the clamp stays as it is, and nothing waits for it: the way out must stay possible.
    pub fn switch(&mut self, switching: Switching) {
        self.told = match switching {
            Switching::ResetInHole => {
                self.told = Told::Nothing;
                return;
            }
            Switching::Function(Aux::M(CLAMP)) => Told::Hold,
            Switching::Function(Aux::M(RELEASE)) => Told::Release,
            Switching::Reset => Told::Nothing,
            Switching::Function(_) | Switching::Nothing => return,
        };
        // A pin of this chip cannot fail.
        let _ = self.switch.set_state((self.told == Told::Hold).into());
    }

    /// Reads the contact, once a period. Gives the alarm for a clamp that has not followed its order.
    pub fn look(&mut self) -> Option<Code> {
        match (self.told, self.holds.is_closed()) {
            (Told::Hold, false) => Some(Code::ClampOpen),
            (Told::Release, true) => Some(Code::ClampShut),
            (Told::Release, false) => {
                self.told = Told::Nothing;
                None
            }
            (Told::Hold, true) | (Told::Nothing, _) => None,
        }
    }
}

/// The other outputs of a board: spindle enable and light. Off at power-up.
#[derive(Debug)]
pub struct Switches<S, L> {
    spindle: S,
    light: L,
    spins: bool,
}

impl<S: OutputPin, L: OutputPin> Switches<S, L> {
    /// Takes the pins, which are low.
    pub const fn new(spindle: S, light: L) -> Self {
        Self {
            spindle,
            light,
            spins: false,
        }
    }

    /// Sets the outputs by the state of the machine. The spindle is enabled as soon as its drive is up. On an alarm it
    /// stays enabled until the spindle stands, or longer while a tap is in its hole [D190]. So the spindle is off when
    /// the release of an emergency stop gives its power back. A board that comes up with an alarm does not enable it.
    /// The light is on while the machine is up and has no alarm.
    pub fn show(&mut self, snapshot: &Snapshot) {
        let well = matches!(snapshot.state, State::Idle | State::Running | State::Held);
        self.spins = well || self.spins && snapshot.needs_spindle;
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
    use leadscrew_core::board::{Board, Contacts as Mirrored, Outcome};
    use leadscrew_core::motion::Setpoint;
    use leadscrew_core::params::Params;

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

    const WELL: Said = Said {
        stop: false,
        hold: false,
    };

    /// Both circuits closed.
    fn contacts() -> ([Pin; 2], Contacts<Pin, Pin>) {
        let pins: [Pin; 2] = core::array::from_fn(|_| Pin::default());
        let [stop, hold] = pins.clone();
        (pins, Contacts::new(stop, hold, || {}))
    }

    #[test]
    fn machine_inputs_count_when_three_samples_agree() {
        let mut inputs = MachineInputs::new();
        let told = [1, 1, 1, 3, 3, 1, 3, 3, 3].map(|sample| inputs.look(sample));
        let one = Some(1);
        assert_eq!(told, [None, None, one, one, one, one, one, one, Some(3)]);
    }

    #[test]
    fn what_the_contacts_say_is_known_before_the_first_period() {
        for stop in [false, true] {
            for hold in [false, true] {
                let pins = [stop, hold].map(|open| Pin(Rc::new(Cell::new(open))));
                let (mut waits, [s, h]) = (0, pins);
                let mut contacts = Contacts::new(s, h, || waits += 1);
                assert_eq!(waits, 2, "three looks");
                assert_eq!(contacts.look(), Said { stop, hold });
            }
        }
    }

    #[test]
    fn a_contact_that_bounces_at_power_up_is_waited_for() {
        let stop = Pin::default();
        // The contact opens and closes in turn, and is at rest after 21 samples.
        for (rest, said) in [(false, false), (true, true)] {
            let (mut waits, moved) = (0_u32, stop.clone());
            let mut contacts = Contacts::new(stop.clone(), Pin::default(), || {
                waits += 1;
                moved.0.set(if waits < 21 { waits % 2 == 1 } else { rest });
            });
            assert_eq!(contacts.look().stop, said);
            assert!((22..=24).contains(&waits), "{waits}");
        }
        // A contact that never comes to rest counts as open, and the board does not wait for ever.
        let (mut waits, moved) = (0_u32, stop.clone());
        let mut contacts = Contacts::new(stop, Pin::default(), || {
            waits += 1;
            moved.0.set(waits % 2 == 1);
        });
        assert!(contacts.look().stop);
        assert_eq!(waits, 100);
    }

    #[test]
    fn an_open_circuit_stops_and_a_short_pulse_does_not() {
        let ([stop, ..], mut contacts) = contacts();
        for _ in 0..10 {
            stop.0.set(true);
            assert!(!contacts.look().stop && !contacts.look().stop);
            stop.0.set(false);
            assert!(!contacts.look().stop);
        }
        stop.0.set(true);
        assert!(!contacts.look().stop && !contacts.look().stop);
        assert!(contacts.look().stop);
    }

    #[test]
    fn a_hold_button_or_a_broken_wire_opens_its_circuit() {
        let ([_, hold], mut contacts) = contacts();
        assert_eq!(contacts.look(), WELL);
        hold.0.set(true);
        let said = [(); 3].map(|()| contacts.look().hold);
        assert_eq!(said, [false, false, true]);
        hold.0.set(false);
        let said = [(); 3].map(|()| contacts.look().hold);
        assert_eq!(said, [true, true, false]);
    }

    const M10: Switching = Switching::Function(Aux::M(10));
    const M11: Switching = Switching::Function(Aux::M(11));

    /// A clamp that is open, with its switch and its contact.
    fn clamp() -> (Clamp<Pin, Pin>, Pin, Pin) {
        let (switch, contact) = (Pin::default(), Pin::default());
        contact.0.set(true);
        let clamp = Clamp::new(switch.clone(), contact.clone());
        (clamp, switch, contact)
    }

    #[test]
    fn a_clamp_has_not_answered_before_its_contact_says_so() {
        let (mut clamp, switch, contact) = clamp();
        // No order was given: the clamp may be open.
        assert!((0..100).all(|_| clamp.look().is_none()));
        clamp.switch(M10);
        assert!(switch.0.get());
        assert!((0..100).all(|_| clamp.look() == Some(Code::ClampOpen)));
        contact.0.set(false);
        let said = [(); 4].map(|()| clamp.look().is_some());
        assert_eq!(said, [true, true, false, false]);
        // The clamp opens by itself.
        contact.0.set(true);
        let said = [(); 3].map(|()| clamp.look());
        assert_eq!(said, [None, None, Some(Code::ClampOpen)]);
        contact.0.set(false);
        assert!([(); 3].map(|()| clamp.look()).contains(&None));
        // The clamp lets go only on an order.
        clamp.switch(M11);
        assert!(!switch.0.get());
        assert!((0..100).all(|_| clamp.look() == Some(Code::ClampShut)));
        contact.0.set(true);
        let said = [(); 3].map(|()| clamp.look());
        assert_eq!(said, [Some(Code::ClampShut), Some(Code::ClampShut), None]);
        // After the release its contact does not matter any more.
        contact.0.set(false);
        assert!((0..100).all(|_| clamp.look().is_none()));
    }

    #[test]
    fn the_clamp_follows_its_functions_and_lets_go_at_a_reset() {
        let (mut clamp, switch, contact) = clamp();
        for (switching, on) in [
            (Switching::Function(Aux::M(8)), false),
            (M10, true),
            (Switching::Function(Aux::M(9)), true),
            (Switching::Function(Aux::T(11)), true),
            (Switching::Nothing, true),
            (M11, false),
            (Switching::ResetInHole, false),
            (M10, true),
            (Switching::ResetInHole, true),
            (Switching::Reset, false),
        ] {
            clamp.switch(switching);
            assert_eq!(switch.0.get(), on, "{switching:?}");
        }
        // After a reset nothing waits for the clamp, whatever it does.
        for reset in [Switching::Reset, Switching::ResetInHole] {
            for before in [M10, M11] {
                clamp.switch(before);
                clamp.switch(reset);
                for open in [false, true] {
                    contact.0.set(open);
                    assert!((0..10).all(|_| clamp.look().is_none()));
                }
            }
        }
    }

    #[test]
    fn the_spindle_stays_enabled_while_it_is_needed_and_the_light_goes_out() {
        let [spindle, light] = [(); 2].map(|()| Pin::default());
        let mut switches = Switches::new(spindle.clone(), light.clone());
        let alarm = Alarm::new(Code::EmergencyStop, Span::default());
        let board = Board::new(&Params::sheets(), None, None).unwrap();
        let up = Snapshot::new(board.ticker(), &Setpoint::default(), Mirrored::default());
        let mut shown = |state, needs_spindle| {
            switches.show(&Snapshot {
                state,
                needs_spindle,
                ..up
            });
            (spindle.0.get(), light.0.get())
        };
        let (stops, stands) = (State::Stopping(Outcome::Alarm(alarm)), State::Alarm(alarm));
        assert_eq!(shown(State::Starting, false), (false, false));
        // The stop circuit is open when the board comes up: no drive has been brought up yet, whatever is needed.
        assert_eq!(shown(stands, true), (false, false));
        assert_eq!(shown(State::Starting, true), (false, false));
        assert_eq!(shown(State::Idle, true), (true, true));
        assert_eq!(shown(State::Running, true), (true, true));
        assert_eq!(shown(stops, true), (true, false));
        assert_eq!(shown(stands, true), (true, false));
        // The spindle stands; the output stays off, even if the spindle turns later.
        assert_eq!(shown(stands, false), (false, false));
        assert_eq!(shown(stands, true), (false, false));
        assert_eq!(shown(State::Starting, false), (false, false));
        assert_eq!(shown(State::Idle, true), (true, true));
        assert_eq!(shown(stands, true), (true, false));
        assert_eq!(shown(State::Starting, true), (true, false));
        assert_eq!(shown(State::Starting, false), (false, false));
    }
}
