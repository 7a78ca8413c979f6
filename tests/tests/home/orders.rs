//! Homing by the order of the bus: which mode lets it in, what a program needs, and a gateway that is lost.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::device::UNMARKED;
use leadscrew_core::board::{Event, State};
use leadscrew_core::bus::{NmtState, NodeId, Object, Order, SdoProtocol};
use leadscrew_core::link::{EventReader, Status, decode_alarm};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axes, Axis};
use leadscrew_tests::gateway::{Gateway, Upload};
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::set;

use crate::bench::{Bench, SWITCHES, both, params};

struct Joined {
    bench: Bench,
    gateway: Gateway,
}

impl Joined {
    fn new() -> Self {
        Self::with(&params())
    }

    fn with(params: &Params) -> Self {
        let mut bench = Bench::with(params, 290_000, SWITCHES, 24);
        let gateway = Gateway::connect(&mut bench.sim);
        Self { bench, gateway }
    }

    fn order(&mut self, order: Order) {
        self.gateway.order(&mut self.bench.sim, order);
        for _ in 0..4 {
            self.tick();
        }
    }

    fn tick(&mut self) {
        self.bench.tick();
        self.gateway.listen(&mut self.bench.sim);
    }

    fn state(&self) -> State {
        self.bench.state()
    }

    fn status(&mut self) -> Status {
        let record = Object::new(0x5001, 1);
        let bytes = self
            .gateway
            .read(&mut self.bench.sim, record, SdoProtocol::Segmented)
            .expect("the record");
        Status::decode(&bytes)
            .expect("a status")
            .expect("of this version")
    }

    /// Marks where an axis stands, for a touch; gives the board's reason where it refuses.
    fn mark(&mut self, axis: Axis, at: i32) -> Option<Alarm> {
        let (gateway, sim) = (&mut self.gateway, &mut self.bench.sim);
        let protocol = SdoProtocol::Segmented;
        if gateway
            .write(sim, mark_of(axis), &at.to_le_bytes(), protocol)
            .is_ok()
        {
            return None;
        }
        let reason = gateway.read(sim, Object::new(0x5011, 5), protocol);
        decode_alarm(&reason.expect("a reason")).expect("an alarm")
    }

    /// What is marked of X and Z.
    fn marks(&mut self) -> [i32; 2] {
        [Axis::X, Axis::Z].map(|axis| {
            let (gateway, sim) = (&mut self.gateway, &mut self.bench.sim);
            let read = gateway.read(sim, mark_of(axis), SdoProtocol::Segmented);
            i32::from_le_bytes(read.expect("a mark").try_into().expect("four bytes"))
        })
    }

    /// The newest refusal.
    fn refused(&mut self) -> Option<u16> {
        let log = Object::new(0x5040, 3);
        let entries = self
            .gateway
            .read(&mut self.bench.sim, log, SdoProtocol::Segmented)
            .expect("the log");
        EventReader::new(&entries)
            .filter_map(|entry| match entry.expect("an entry").event {
                Event::Warning(alarm) => Some(alarm.number()),
                _ => None,
            })
            .last()
    }

    fn home(&mut self) {
        self.order(Order::Mode(OperatingMode::Reference));
        self.order(Order::Home(Axes::NONE));
        assert_eq!(self.state(), State::Homing);
    }

    fn finish(&mut self) {
        let begun = self.bench.ticks;
        while self.state() == State::Homing {
            self.tick();
            assert!(self.bench.ticks - begun < 5_000);
        }
    }
}

fn mark_of(axis: Axis) -> Object {
    Object::new(0x5011, if axis == Axis::X { 8 } else { 9 })
}

fn not_referenced(axis: u8) -> Option<Alarm> {
    Some(Alarm::of(Code::NotReferenced, &[Arg::Letter(axis)]))
}

#[test]
fn a_mark_needs_the_reference_and_goes_with_it() {
    let mut joined = Joined::new();
    assert_eq!(joined.mark(Axis::X, 5), not_referenced(b'X'));
    assert_eq!(joined.mark(Axis::Z, 5), not_referenced(b'Z'));
    assert_eq!(joined.marks(), [UNMARKED; 2]);
    joined.home();
    joined.finish();
    joined.order(Order::Mode(OperatingMode::Manual));
    assert_eq!(joined.mark(Axis::X, 5), None);
    assert_eq!(joined.mark(Axis::Z, 6), None);
    assert_eq!(joined.marks(), [5, 6]);
    // Homed anew, X alone counts from another point.
    joined.order(Order::Mode(OperatingMode::Reference));
    joined.order(Order::Home(Axes::NONE.with(Axis::X)));
    assert_eq!(joined.state(), State::Homing);
    joined.finish();
    assert_eq!(joined.marks(), [UNMARKED, 6]);
    // Its drive has been switched on anew.
    joined.order(Order::Mode(OperatingMode::Manual));
    assert_eq!(joined.mark(Axis::X, 7), None);
    let boot_up = NmtState::BootUp.frame(NodeId::DRIVE_X);
    joined.bench.sim.receive(&boot_up);
    for _ in 0..4 {
        joined.tick();
    }
    assert_eq!(joined.status().referenced, Axes::ALL.without(Axis::X));
    assert_eq!(joined.marks(), [UNMARKED, 6]);
}

/// Z may be touched off without its reference, as it may be moved by a program. What it finds later is another point.
#[test]
fn a_mark_of_an_axis_that_no_program_waits_for() {
    let mut params = params();
    set(&mut params, "9060.Z", 0);
    let mut joined = Joined::with(&params);
    assert_eq!(joined.mark(Axis::X, 5), not_referenced(b'X'));
    assert_eq!(joined.mark(Axis::Z, 6), None);
    joined.home();
    joined.finish();
    assert_eq!(joined.marks(), [UNMARKED; 2]);
}

#[test]
fn only_in_its_mode_and_a_program_waits_for_it() {
    let mut joined = Joined::new();
    joined.order(Order::Home(Axes::NONE));
    assert_eq!(
        (joined.state(), joined.refused()),
        (State::Idle, Some(4501))
    );
    let text = "G0 X10 Z10\nM30\n";
    let load = |joined: &mut Joined, number| {
        let mut upload = Upload::new(number, &calls(text, &params()));
        assert!(upload.feed(&mut joined.gateway, &mut joined.bench.sim));
        assert!(upload.is_done());
        joined.order(Order::Run);
    };
    load(&mut joined, 7);
    assert_eq!(
        (joined.state(), joined.refused()),
        (State::Idle, Some(4503))
    );
    let status = joined.status();
    assert_eq!(
        (status.referenced, status.unreferenced),
        (Axes::NONE.with(Axis::C), both())
    );
    joined.home();
    // While it homes, neither a program nor a mode.
    joined.order(Order::Run);
    assert_eq!(
        (joined.state(), joined.refused()),
        (State::Homing, Some(4507))
    );
    joined.finish();
    assert_eq!(joined.state(), State::Idle);
    let status = joined.status();
    assert_eq!(
        (status.referenced, status.unreferenced),
        (Axes::ALL, Axes::NONE)
    );
    // What was loaded before was meant for another position: it is dropped.
    joined.order(Order::Run);
    assert_eq!(
        (joined.state(), joined.refused()),
        (State::Idle, Some(4334))
    );
    load(&mut joined, 8);
    let mut ran = false;
    for _ in 0..50 {
        ran |= joined.state() == State::Running;
        joined.tick();
    }
    assert!(ran, "{:?} {:?}", joined.state(), joined.refused());
}

#[test]
fn cancelled() {
    let mut joined = Joined::new();
    joined.home();
    joined.order(Order::Cancel);
    while matches!(joined.state(), State::Stopping(_)) {
        joined.tick();
    }
    assert_eq!(
        (joined.state(), joined.refused()),
        (State::Idle, Some(4521))
    );
    assert_eq!(joined.status().unreferenced, both());
}

/// The gateway falls silent: the drive comes to rest, and the axis is not referenced.
#[test]
fn its_gateway_is_lost() {
    let mut joined = Joined::new();
    joined
        .bench
        .sim
        .receive(&NmtState::Operational.frame(NodeId::GATEWAY));
    // X has 20 mm to go at 20 mm/s, and the gateway is silent for a second.
    joined.bench.write(0x6099, 1, 4, 4_000);
    joined.home();
    let begun = joined.bench.ticks;
    while !matches!(joined.state(), State::Alarm(_)) {
        joined.tick();
        assert!(joined.bench.ticks - begun < 3_000);
    }
    assert_eq!(joined.bench.alarm("lost").code, Code::HomeCancelled);
    assert!(!joined.bench.referenced().contains(Axis::X));
    joined.bench.judge("lost", 8);
}
