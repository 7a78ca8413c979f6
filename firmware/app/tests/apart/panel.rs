//! Contacts, clamp and spindle enable of a real board, with the application between them.

use std::cell::Cell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Event, Inputs, State, Switching};
use leadscrew_core::bus::{BusState, Controller, Order};
use leadscrew_core::call::{Call, Position};
use leadscrew_core::params::{Entry, Params};
use leadscrew_parts::{Clamp, Contacts, Switches};

use crate::board::{Apart, alarm, calls};

#[derive(Clone, Default)]
struct Pin(Rc<Cell<bool>>);

impl Pin {
    fn new(high: bool) -> Self {
        Self(Rc::new(Cell::new(high)))
    }
}

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

/// A board on its bench, with pins. A circuit is closed where its pin is low.
struct Wired {
    apart: Apart,
    stop: Pin,
    hold: Pin,
    clamped: Pin,
    /// The outputs to clamp and spindle.
    clamp: Pin,
    spindle: Pin,
    /// The number of ticks that the clamp takes, either way; `None`: it does not move.
    takes: Option<u32>,
    moving: u32,
    contacts: Contacts<Pin, Pin>,
    parts: (Clamp<Pin, Pin>, Switches<Pin, Pin>),
    calls: VecDeque<Call>,
}

impl Wired {
    /// Switched on, with these circuits open.
    fn on(params: &Params, [stop, hold]: [bool; 2]) -> Self {
        let [stop, hold, clamped] = [stop, hold, true].map(Pin::new);
        let [clamp, spindle] = [(); 2].map(|()| Pin::default());
        Self {
            contacts: Contacts::new(stop.clone(), hold.clone(), || {}),
            parts: (
                Clamp::new(clamp.clone(), clamped.clone()),
                Switches::new(spindle.clone(), Pin::default()),
            ),
            apart: Apart::off(params),
            stop,
            hold,
            clamped,
            clamp,
            spindle,
            takes: Some(0),
            moving: 0,
            calls: VecDeque::new(),
        }
    }

    /// A board that has come up.
    fn up(params: &Params) -> Self {
        let mut wired = Self::on(params, [false; 2]);
        wired.until(1000, |wired| wired.state() == State::Idle);
        wired
    }

    fn state(&self) -> State {
        self.apart.snapshot().state
    }

    fn alarm(&self) -> Option<Code> {
        let alarm = self.apart.snapshot().alarm();
        alarm.map(|alarm| alarm.code)
    }

    fn at(&self) -> Position {
        self.apart.snapshot().setpoint.position
    }

    fn step(&mut self) {
        let Self {
            contacts, parts, ..
        } = self;
        let said = contacts.look();
        self.apart.bench.inputs = Inputs {
            stop: said.stop,
            hold: said.hold,
            unanswered: parts.0.look(),
            ..Inputs::default()
        };
        while let Some(call) = self.calls.front()
            && self.apart.background.offer(call)
        {
            self.calls.pop_front();
            self.apart.rest();
        }
        self.apart.step();
        for switching in self.apart.bench.switched.drain(..) {
            parts.0.switch(switching);
        }
        parts.1.show(self.apart.snapshot());
        // The clamp's contact is closed while the clamp holds.
        if self.clamped.0.get() == self.clamp.0.get() {
            self.moving += 1;
            if self.takes.is_some_and(|takes| self.moving > takes) {
                self.clamped.0.set(!self.clamp.0.get());
            }
        } else {
            self.moving = 0;
        }
    }

    fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.step();
        }
    }

    /// Runs ticks until `over`, and gives their number.
    fn until(&mut self, limit: u32, over: impl Fn(&Self) -> bool) -> u32 {
        for ticks in 0..limit {
            if over(self) {
                return ticks;
            }
            self.step();
        }
        panic!("not within {limit}: {:?}", self.state());
    }

    fn begin(&mut self, text: &str, params: &Params) {
        self.calls = calls(text, params).into();
        self.apart.bench.events.clear();
    }

    fn has_started(&self, on: u32) -> bool {
        let mut events = self.apart.bench.events.iter();
        events.any(|event| matches!(event, Event::Started { line, .. } if *line == on))
    }

    fn has_finished(&self) -> bool {
        self.apart.bench.events.contains(&Event::Finished)
    }
}

#[test]
fn a_board_with_its_circuits_closed_comes_up_without_an_alarm() {
    let params = Params::sheets();
    let mut wired = Wired::on(&params, [false; 2]);
    wired.until(1000, |wired| {
        assert_eq!(wired.alarm(), None);
        wired.state() == State::Idle
    });
    assert_eq!(wired.apart.bench.events, [Event::Ready]);
    assert!(wired.spindle.0.get());
}

#[test]
fn a_board_with_its_stop_circuit_open_comes_up_on_its_alarm_and_tells_no_spindle() {
    let params = Params::sheets();
    let mut wired = Wired::on(&params, [true, false]);
    for _ in 0..1000 {
        wired.step();
        assert_eq!(wired.alarm(), Some(Code::EmergencyStop));
        assert!(!wired.spindle.0.get());
    }
    wired.stop.0.set(false);
    wired.steps(3);
    wired.apart.order(Order::Reset);
    wired.until(1000, |wired| wired.state() == State::Idle);
}

/// A break contact: its wire, or its button, opens it.
#[test]
fn a_hold_circuit_that_opens_holds_and_nothing_resumes_before_it_is_closed() {
    let params = Params::sheets();
    let mut wired = Wired::up(&params);
    wired.begin("G0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n", &params);
    wired.until(2000, |wired| wired.has_started(2));
    wired.steps(100);
    assert_eq!(wired.state(), State::Running);
    wired.hold.0.set(true);
    wired.until(500, |wired| wired.state() == State::Held);
    let at = wired.at();
    for _ in 0..3 {
        wired.apart.order(Order::Resume);
        wired.steps(200);
        assert_eq!(wired.state(), State::Held);
        assert_eq!(wired.at(), at);
    }
    wired.hold.0.set(false);
    wired.steps(200);
    assert_eq!(wired.state(), State::Held, "it does not go on by itself");
    wired.apart.order(Order::Resume);
    wired.until(10_000, Wired::has_finished);
}

/// A reset may have to move out of the thread; a hold must not keep it from that.
#[test]
fn a_reset_with_the_hold_circuit_open_comes_to_its_end() {
    let params = Params::sheets();
    let mut wired = Wired::up(&params);
    let text = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\n\
                G76 X76 Z-30 P20000 Q15000 F3\nM30\n";
    wired.begin(text, &params);
    wired.until(20_000, |wired| wired.apart.output.setpoint.locked);
    wired.steps(50);
    wired.hold.0.set(true);
    wired.steps(10);
    wired.calls.clear();
    wired.apart.order(Order::Reset);
    wired.until(2000, |wired| {
        wired.apart.bench.events.contains(&Event::Reset)
    });
    wired.until(10, |wired| wired.state() == State::Idle);
    // The hold acts again from the next program on.
    wired.begin("G0 X100 Z20\nM30\n", &params);
    wired.until(100, |wired| wired.state() == State::Held);
    wired.hold.0.set(false);
    wired.steps(3);
    wired.apart.order(Order::Resume);
    wired.until(10_000, Wired::has_finished);
}

/// Two holes by the C axis, with its clamp.
const CLAMPED: &str = "G98\nG0 X40 Z5 C0\nM29 S600\nG84 C0 Z-2 R-3 F600 M10\nC90\nG80\nM30\n";

#[test]
fn the_next_move_waits_for_the_clamp_either_way() {
    let params = Params::sheets();
    for takes in [0, 5, 700] {
        let mut wired = Wired::up(&params);
        wired.takes = Some(takes);
        wired.begin(CLAMPED, &params);
        for hole in 0..2 {
            for on in [true, false] {
                wired.until(20_000, |wired| wired.clamp.0.get() == on);
                if hole == 1 && !on {
                    // The program's end waits for the clamp.
                    assert!(!wired.has_finished());
                    let waits = wired.until(1000, Wired::has_finished);
                    assert!(waits >= takes + 3, "{takes}: {waits}");
                    continue;
                }
                let at = wired.at();
                let waits = wired.until(1000, |wired| wired.at() != at);
                // Three samples of its contact, and then the next tick of the program.
                assert!((takes + 3..=takes + 8).contains(&waits), "{takes}: {waits}");
                assert_eq!(wired.clamped.0.get(), !on);
            }
        }
        assert_eq!(wired.alarm(), None);
    }
}

#[test]
fn a_clamp_that_does_not_answer_is_an_alarm_after_a_second_and_a_reset_lets_go() {
    for tick_us in [1000, 4000] {
        let mut params = Params::sheets();
        let entry = Entry::find_text("9000").expect("a parameter");
        params.set(entry, tick_us).expect("in its range");
        let second = u32::try_from(1_000_000 / tick_us).expect("a count");
        for (stuck, code) in [(false, Code::ClampOpen), (true, Code::ClampShut)] {
            let mut wired = Wired::up(&params);
            wired.takes = stuck.then_some(0);
            wired.begin(CLAMPED, &params);
            wired.until(20_000, |wired| wired.clamp.0.get());
            if stuck {
                wired.until(10, |wired| !wired.clamped.0.get());
                wired.takes = None;
                wired.until(20_000, |wired| !wired.clamp.0.get());
            }
            let at = wired.at();
            let waits = wired.until(second + 10, |wired| wired.alarm().is_some());
            assert!((second..second + 5).contains(&waits), "{waits}");
            assert_eq!((wired.alarm(), wired.at()), (Some(code), at));
            // The clamp lets go at the reset, and nothing waits for it any more.
            wired.calls.clear();
            wired.steps(100);
            wired.apart.order(Order::Reset);
            wired.until(1000, |wired| wired.state() == State::Idle);
            assert!(!wired.clamp.0.get());
            wired.steps(3 * second);
            assert_eq!(wired.state(), State::Idle);
        }
    }
}

#[test]
fn a_reset_lets_the_clamp_go_unless_a_tap_is_in_its_hole() {
    let params = Params::sheets();
    // In the hole, or on the way to the R plane.
    for in_hole in [true, false] {
        for stop in [true, false] {
            let mut wired = Wired::up(&params);
            wired.begin(CLAMPED, &params);
            wired.until(20_000, |wired| wired.clamp.0.get());
            if in_hole {
                wired.until(20_000, |wired| wired.at().z.nm() < 1_000_000);
            } else {
                wired.steps(3);
            }
            wired.calls.clear();
            if stop {
                wired.stop.0.set(true);
                wired.until(2000, |wired| matches!(wired.state(), State::Alarm(_)));
                assert!(wired.clamp.0.get(), "an alarm keeps it clamped");
                wired.stop.0.set(false);
                wired.steps(3);
            }
            wired.apart.order(Order::Reset);
            wired.steps(5);
            wired.until(2000, |wired| wired.state() == State::Idle);
            assert_eq!(wired.clamp.0.get(), in_hole);
            if in_hole {
                // The clamp may fail now: the way out must still be possible.
                wired.takes = None;
                wired.clamped.0.set(true);
                wired.begin("G30 P99\nM30\n", &params);
                wired.until(20_000, Wired::has_finished);
                wired.apart.order(Order::Reset);
                wired.steps(10);
                assert!(!wired.clamp.0.get());
            }
        }
    }
}

#[test]
fn the_clamp_lets_go_where_the_application_begins_anew() {
    let mut apart = Apart::new(&Params::sheets());
    assert_eq!(apart.bench.switched, []);
    apart.restart();
    apart.steps(100);
    assert_eq!(apart.bench.switched, [Switching::Reset]);
}

/// When the button is released, the power that comes back must find the spindle off.
#[test]
fn the_spindle_is_enabled_on_an_alarm_until_it_stands() {
    let params = Params::sheets();
    for off in [false, true] {
        let mut wired = Wired::up(&params);
        wired.begin("M3 S300\nG4 P3000\nG0 X60 Z5\nM30\n", &params);
        wired.until(10_000, |wired| wired.has_started(3));
        assert!(wired.spindle.0.get());
        let down = if off {
            wired.apart.bench.controller = Controller {
                state: BusState::Off,
                ..Controller::default()
            };
            Code::BusOff
        } else {
            wired.stop.0.set(true);
            Code::EmergencyStop
        };
        wired.until(2000, |wired| matches!(wired.state(), State::Alarm(_)));
        assert_eq!(wired.alarm(), Some(down));
        let turns = |wired: &Wired| {
            wired.apart.output.setpoint.spindle.is_none()
                && wired.apart.snapshot().speed.abs().rpm().get() > 0
        };
        assert!(turns(&wired), "it brakes");
        assert!(wired.spindle.0.get());
        let ticks = wired.until(20_000, |wired| !wired.spindle.0.get());
        assert!(ticks > 10, "{ticks}");
        wired.stop.0.set(false);
        wired.steps(1000);
        assert!(!wired.spindle.0.get(), "released");
    }
}

/// A spindle that another hand keeps turning also loses its enable: after twice the permitted time to stop, and a second.
#[test]
fn a_spindle_that_does_not_stop_loses_its_enable_in_time() {
    let params = Params::sheets();
    let limit = 2 * params.spindle_ramp_ms() * params.spindle_max_rpm() / 1000 + 1000;
    let mut wired = Wired::up(&params);
    wired.begin("M3 S300\nG4 P3000\nG0 X60 Z5\nM30\n", &params);
    wired.until(10_000, |wired| wired.has_started(3));
    wired.stop.0.set(true);
    wired.until(2000, |wired| matches!(wired.state(), State::Alarm(_)));
    wired.apart.bench.turned = Some(1);
    let ticks = wired.until(limit + 100, |wired| !wired.spindle.0.get());
    assert!(ticks.abs_diff(limit) < 10, "{ticks} of {limit}");
}

#[test]
fn a_spindle_with_a_tap_in_its_hole_stays_enabled() {
    let params = Params::sheets();
    let mut wired = Wired::up(&params);
    wired.begin(
        "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-50 P30 F2000\nG80\nM30\n",
        &params,
    );
    wired.until(20_000, |wired| wired.apart.output.setpoint.locked);
    wired.steps(300);
    wired.stop.0.set(true);
    wired.until(2000, |wired| matches!(wired.state(), State::Alarm(_)));
    wired.calls.clear();
    for _ in 0..20_000 {
        wired.step();
        assert!(wired.spindle.0.get());
    }
    wired.stop.0.set(false);
    wired.steps(3);
    wired.apart.order(Order::Reset);
    wired.until(1000, |wired| {
        assert!(wired.spindle.0.get());
        wired.state() == State::Idle
    });
    // Outside its hole, the tapping spindle is a spindle like any other.
    wired.begin("G30 P99\nM30\n", &params);
    wired.until(20_000, Wired::has_finished);
    wired.stop.0.set(true);
    wired.until(2000, |wired| !wired.spindle.0.get());
    assert_eq!(alarm(&mut wired.apart, 1), Some(Code::EmergencyStop));
}
