//! Tries every order in which tick, interrupt and wire can interrupt each other.
//!
//! The tick may come at each access of the interrupt to shared data, and to the controller. The wire takes frames
//! whenever the program reads the controller: changes between two reads cannot be seen. Each run makes other choices,
//! until all of them are tried. Nothing interrupts the tick, and the interrupt does not interrupt itself.

extern crate std;

use core::cell::{Cell, RefCell};
use std::boxed::Box;
use std::rc::Rc;
use std::vec::Vec;

use leadscrew_core::bus::{CobId, FdFrame, Frame};

use super::{BackgroundEnd, BusEnd, Chip, Places, Rings, TickEnd};
use crate::message::Heard;
use crate::shared::{interrupted_by, point};

/// Microseconds of a period.
const PERIOD: u32 = 1000;

/// One series of choices, and the step to the next series.
#[derive(Default)]
struct Choices {
    way: Vec<(u8, u8)>,
    at: usize,
}

impl Choices {
    /// Chooses a number below `count`.
    fn of(&mut self, count: u8) -> u8 {
        if count < 2 {
            return 0;
        }
        if self.at == self.way.len() {
            self.way.push((0, count));
        }
        let (chosen, before) = self.way[self.at];
        assert_eq!(count, before, "the same choices on the same way");
        self.at += 1;
        chosen
    }

    /// False where all series have been tried.
    fn next(&mut self) -> bool {
        self.way.truncate(self.at);
        self.at = 0;
        while let Some((chosen, count)) = self.way.last_mut() {
            *chosen += 1;
            if chosen < count {
                return true;
            }
            self.way.pop();
        }
        false
    }
}

/// Which frame this is, read from its payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A frame of this tick, and its number in the tick.
    Tick(u8, u8),
    /// The frame of CAN FD of this tick.
    Together(u8),
    /// A frame of the background, and its number.
    Other(u8),
}

impl Kind {
    const fn is_of_tick(self) -> bool {
        !matches!(self, Self::Other(_))
    }
}

fn frame(kind: Kind) -> Frame {
    let (id, payload) = match kind {
        Kind::Tick(tick, 0) => (0x080, [1, tick, 0]),
        Kind::Tick(tick, which) => (0x20F + u16::from(which), [1, tick, which]),
        Kind::Together(tick) => (0x481, [2, tick, 0]),
        Kind::Other(which) => (0x581, [0, 0, which]),
    };
    Frame::new(CobId::new(id).unwrap(), &payload).unwrap()
}

/// All bytes of a frame for seven drives count.
fn together(tick: u8) -> FdFrame {
    let head = frame(Kind::Together(tick));
    let payload: Vec<u8> = head.payload().iter().copied().chain([tick; 39]).collect();
    FdFrame::new(head.id(), &payload, true).unwrap()
}

fn kind(words: &[u32]) -> Kind {
    let kind = match words[2].to_le_bytes() {
        [1, tick, which, 0] => Kind::Tick(tick, which),
        [2, tick, 0, more] if more == tick => Kind::Together(tick),
        [0, 0, which, 0] => Kind::Other(which),
        _ => panic!("{words:X?}"),
    };
    let expected = match kind {
        Kind::Together(tick) => crate::fd_to_send(&together(tick)),
        kind => crate::to_send(&frame(kind)),
    };
    assert_eq!(words, expected.as_slice());
    kind
}

/// The case to be tried.
#[derive(Clone, Copy)]
struct Scenario {
    /// The number of ticks, and of frames in each tick.
    ticks: u8,
    frames: u8,
    /// Each tick has a frame of CAN FD as well.
    fd: bool,
    /// The number of frames of the background, all there from the beginning.
    others: u8,
    /// The controller may leave the bus.
    leaves: bool,
}

impl Scenario {
    /// The number of frames of a tick.
    fn all(&self) -> u8 {
        self.frames + u8::from(self.fd)
    }
}

/// The test's side of [`Chip`], and what the test expects of the rings.
struct Machine {
    scenario: Scenario,
    choices: RefCell<Choices>,
    tick: RefCell<TickEnd<'static>>,
    bus: RefCell<BusEnd<'static>>,
    background: RefCell<BackgroundEnd<'static>>,
    /// Which side runs now, and whether the tick is kept out.
    in_tick: Cell<bool>,
    in_bus: Cell<bool>,
    alone: Cell<bool>,
    poked: Cell<bool>,
    /// Frames in the controller.
    places: RefCell<[Option<Kind>; 3]>,
    /// The place whose frame is on the wire: this frame could not be called back.
    on_wire: Cell<Option<usize>>,
    off: Cell<bool>,
    /// Ticks so far; then (frames of the last tick, other frames): put into the controller, and sent on the wire.
    now: Cell<u8>,
    put: Cell<(u8, u8)>,
    sent: Cell<(u8, u8)>,
    /// All frames of the previous tick had left when this tick looked.
    all_left: Cell<bool>,
    /// Counts ticks within the interrupt, so that the test knows that there were some.
    preempted: Cell<u32>,
    /// No more choices are made.
    rests: Cell<bool>,
}

/// The rings see it as the chip, the test as the machine.
#[derive(Clone)]
struct Handle(Rc<Machine>);

impl Machine {
    fn choose(&self, count: u8) -> u8 {
        self.choices.borrow_mut().of(count)
    }

    /// Between two accesses of the interrupt: the tick may come.
    fn interrupted(self: &Rc<Self>) {
        while self.in_bus.get()
            && !self.in_tick.get()
            && !self.alone.get()
            && self.now.get() < self.scenario.ticks
            && self.choose(2) == 1
        {
            self.preempted.set(self.preempted.get() + 1);
            self.tick();
        }
    }

    /// Before the controller is read: the wire may take frames.
    fn moves(&self) {
        if self.scenario.leaves && !self.off.get() && self.choose(2) == 1 {
            self.off.set(true);
        }
        while self.is_pending() && !self.off.get() && self.choose(2) == 1 {
            self.sends();
        }
    }

    fn is_pending(&self) -> bool {
        self.places.borrow().iter().any(Option::is_some)
    }

    /// Sends the frame that is on the wire already, else the smallest identifier.
    fn sends(&self) {
        let mut places = self.places.borrow_mut();
        let smallest = places
            .iter()
            .flatten()
            .map(|kind| frame(*kind).id().get())
            .min();
        let mut all = places.iter();
        let first = all.position(|place| place.map(|kind| frame(kind).id().get()) == smallest);
        let place = self.on_wire.take().or(first);
        let place = place.and_then(|place| places.get_mut(place));
        let (tick, other) = self.sent.get();
        match place.and_then(Option::take) {
            Some(Kind::Tick(of, which)) if of == self.now.get() => {
                assert_eq!(which, tick, "SYNC first, then in their order");
                self.sent.set((tick + 1, other));
            }
            // A late frame of an older tick: it could not be called back any more.
            Some(Kind::Tick(..)) => {}
            Some(Kind::Together(of)) if of == self.now.get() => {
                assert_eq!(tick, self.scenario.frames, "behind the others");
                self.sent.set((tick + 1, other));
            }
            Some(Kind::Together(_)) => {}
            Some(Kind::Other(which)) => {
                assert_eq!(which, other, "in their order");
                self.sent.set((tick, other + 1));
            }
            None => panic!("nothing to be sent"),
        }
    }

    fn tick(self: &Rc<Self>) {
        let handle = Handle(self.clone());
        self.in_tick.set(true);
        let before = self.now.get();
        let mut end = self.tick.borrow_mut();
        let number = before + 1;
        let frames: Vec<Frame> = (0..self.scenario.frames)
            .map(|which| frame(Kind::Tick(number, which)))
            .collect();
        let fd = self.scenario.fd.then(|| together(number));
        let in_time = end.send(&frames, fd.as_ref(), &handle);
        assert_eq!(in_time, self.all_left.get());
        self.in_tick.set(false);
    }

    /// The interrupt of the controller.
    fn serve(self: &Rc<Self>) {
        self.poked.set(false);
        self.in_bus.set(true);
        let kept = self.bus.borrow_mut().serve(&Handle(self.clone()));
        assert!(kept);
        self.in_bus.set(false);
        // The marked places are those that hold a tick's frame.
        let mut marks = 0;
        for (place, kind) in self.places.borrow().iter().enumerate() {
            marks |= u32::from(kind.is_some_and(Kind::is_of_tick)) << place;
        }
        let pending = self.pending().0;
        let places = self.bus.borrow().shared.places.get();
        assert_eq!(places & pending, marks);
    }

    fn pending(&self) -> Places {
        let mut pending = 0;
        for (place, kind) in self.places.borrow().iter().enumerate() {
            pending |= u32::from(kind.is_some()) << place;
        }
        Places(pending)
    }

    /// Does all remaining work, without more choices.
    fn comes_to_rest(self: &Rc<Self>) {
        interrupted_by(None);
        for _ in 0..20 {
            self.serve();
            while self.is_pending() && !self.off.get() {
                self.sends();
            }
        }
    }
}

impl Chip for Handle {
    fn take(&self) -> Option<Heard> {
        point();
        None
    }

    fn put(&self, words: &[u32]) -> Option<Places> {
        point();
        let machine = &self.0;
        assert!(machine.in_tick.get() || machine.alone.get());
        let place = machine.places.borrow().iter().position(Option::is_none)?;
        let kind = kind(words);
        let (tick, other) = machine.put.get();
        match kind {
            Kind::Tick(of, which) => {
                assert_eq!(of, machine.now.get(), "of a tick that was given up");
                assert_eq!(which, tick, "in their order, and none is lost");
                machine.put.set((tick + 1, other));
                if which == 0 {
                    assert!(machine.in_tick.get(), "SYNC leaves at once");
                }
            }
            Kind::Together(of) => {
                assert_eq!(of, machine.now.get(), "of a tick that was given up");
                assert_eq!(
                    tick, machine.scenario.frames,
                    "behind the others, and none is lost"
                );
                machine.put.set((tick + 1, other));
            }
            Kind::Other(which) => {
                assert_eq!(which, other, "in their order, and none is lost");
                let places = machine.places.borrow();
                assert_eq!(
                    places.iter().flatten().next(),
                    None,
                    "one at a time, and behind the tick's"
                );
                machine.put.set((tick, other + 1));
            }
        }
        machine.places.borrow_mut()[place] = Some(kind);
        let free = machine
            .places
            .borrow()
            .iter()
            .filter(|at| at.is_none())
            .count();
        assert!(machine.in_tick.get() || free > 0, "one is kept for SYNC");
        Some(Places(1 << place))
    }

    fn pending(&self) -> Places {
        point();
        if !self.0.rests.get() {
            self.0.moves();
        }
        if self.0.in_tick.get() {
            let (tick, _) = self.0.sent.get();
            let before = self.0.now.get();
            self.0
                .all_left
                .set(before == 0 || tick == self.0.scenario.all());
            self.0.now.set(before + 1);
            self.0.put.set((0, self.0.put.get().1));
            self.0.sent.set((0, self.0.sent.get().1));
        }
        self.0.pending()
    }

    fn call_back(&self, places: Places) {
        point();
        let mut all = self.0.places.borrow_mut();
        let first = all
            .iter()
            .flatten()
            .map(|kind| frame(*kind).id().get())
            .min();
        for (at, place) in all.iter_mut().enumerate() {
            let Some(kind) = *place else { continue };
            if places.0 & 1 << at == 0 {
                continue;
            }
            assert!(kind.is_of_tick(), "what is not the tick's stays");
            // The next frame to leave may be on the wire already.
            let next = Some(frame(kind).id().get()) == first;
            let may_go = next && self.0.on_wire.get().is_none();
            if may_go && self.0.choose(2) == 1 {
                self.0.on_wire.set(Some(at));
            }
            if self.0.on_wire.get() != Some(at) {
                *place = None;
            }
        }
    }

    fn is_off(&self) -> bool {
        point();
        self.0.off.get()
    }

    fn poke(&self) {
        self.0.poked.set(true);
    }

    fn period_us(&self) -> u32 {
        point();
        PERIOD
    }

    fn since_us(&self) -> u32 {
        point();
        0
    }

    fn alone(&self, work: impl FnOnce()) {
        point();
        self.0.alone.set(true);
        work();
        self.0.alone.set(false);
        point();
    }
}

/// Tries all series of choices. Gives their number, and the number of ticks within the interrupt in all of them.
fn try_all(scenario: Scenario) -> (u32, u32) {
    let rings = Box::leak(Box::new(Rings::new()));
    let (tick, background, bus) = rings.split(1000);
    let machine = Rc::new(Machine {
        scenario,
        choices: RefCell::default(),
        tick: RefCell::new(tick),
        bus: RefCell::new(bus),
        background: RefCell::new(background),
        in_tick: Cell::default(),
        in_bus: Cell::default(),
        alone: Cell::default(),
        poked: Cell::default(),
        places: RefCell::default(),
        on_wire: Cell::default(),
        off: Cell::default(),
        now: Cell::default(),
        put: Cell::default(),
        sent: Cell::default(),
        all_left: Cell::default(),
        preempted: Cell::default(),
        rests: Cell::default(),
    });
    let mut ways = 0_u32;
    loop {
        run(&machine);
        ways += 1;
        if !machine.choices.borrow_mut().next() {
            return (ways, machine.preempted.get());
        }
    }
}

/// Runs one series of choices.
fn run(machine: &Rc<Machine>) {
    begin(machine);
    let within = machine.clone();
    interrupted_by(Some(Rc::new(move || within.interrupted())));
    let scenario = machine.scenario;
    while machine.now.get() < scenario.ticks {
        machine.tick();
        machine.serve();
        // A place that has become free raises the interrupt.
        machine.moves();
        machine.serve();
    }
    machine.rests.set(true);
    machine.comes_to_rest();
    let (tick, other) = machine.sent.get();
    if machine.off.get() {
        return;
    }
    assert_eq!(tick, scenario.all(), "all of the last");
    assert_eq!(other, scenario.others, "and all others");
}

/// Sets everything as at power-up.
fn begin(machine: &Machine) {
    interrupted_by(None);
    machine.rests.set(false);
    *machine.places.borrow_mut() = [None; 3];
    machine.off.set(false);
    machine.on_wire.set(None);
    machine.now.set(0);
    machine.put.set((0, 0));
    machine.sent.set((0, 0));
    let mut bus = machine.bus.borrow_mut();
    let mut tick = machine.tick.borrow_mut();
    while bus.setpoints.take().is_some() {}
    while bus.together.take().is_some() {}
    while bus.others.take().is_some() {}
    bus.shared.tick.set(0);
    bus.shared.places.set(0);
    bus.shared.done.set(0);
    tick.left = 0;
    let mut background = machine.background.borrow_mut();
    for which in 0..machine.scenario.others {
        let ring = &mut background.others;
        assert!(ring.put(frame(Kind::Other(which))));
    }
}

const OWN: Scenario = Scenario {
    ticks: 2,
    frames: 3,
    fd: false,
    others: 1,
    leaves: false,
};

/// Tries all series of these scenarios; each has at least the given number of series.
fn hold(scenarios: &[(Scenario, u32)]) {
    for (scenario, least) in scenarios {
        let (ways, within) = try_all(*scenario);
        std::println!("{ways} ways, {within} ticks within the interrupt");
        assert!(ways >= *least && within >= least / 2, "{ways}, {within}");
    }
}

#[test]
fn a_tick_anywhere_in_the_interrupt_loses_no_frame_and_sends_none_that_is_given_up() {
    let one = Scenario { others: 0, ..OWN };
    let three = Scenario {
        ticks: 3,
        frames: 2,
        others: 0,
        ..OWN
    };
    let others = Scenario {
        frames: 2,
        others: 3,
        ..OWN
    };
    let fd = Scenario {
        frames: 2,
        fd: true,
        ..OWN
    };
    let fd_alone = Scenario {
        ticks: 3,
        frames: 1,
        fd: true,
        others: 0,
        ..OWN
    };
    hold(&[
        (fd, 50_000),
        (fd_alone, 300_000),
        (one, 30_000),
        (OWN, 50_000),
        (three, 500_000),
        (others, 20_000),
    ]);
}

#[test]
fn a_controller_that_leaves_the_bus_at_any_moment_leaves_no_frame_marked_that_is_not_there() {
    let leaves = Scenario {
        leaves: true,
        frames: 2,
        ..OWN
    };
    let with_fd = Scenario {
        frames: 1,
        fd: true,
        ..leaves
    };
    hold(&[(leaves, 15_000), (with_fd, 15_000)]);
}

/// A controller from which frames come.
struct Hears(RefCell<Vec<Heard>>);

impl Chip for Hears {
    fn take(&self) -> Option<Heard> {
        self.0.borrow_mut().pop()
    }

    fn put(&self, _: &[u32]) -> Option<Places> {
        None
    }

    fn pending(&self) -> Places {
        Places(0)
    }

    fn call_back(&self, _: Places) {}

    fn is_off(&self) -> bool {
        false
    }

    fn poke(&self) {}

    fn period_us(&self) -> u32 {
        PERIOD
    }

    fn since_us(&self) -> u32 {
        0
    }

    fn alone(&self, work: impl FnOnce()) {
        work();
    }
}

#[test]
fn what_is_heard_goes_to_who_reads_it_and_of_many_frames_of_can_fd_the_first_are_told() {
    let mut rings = Rings::new();
    let (mut tick, mut background, mut bus) = rings.split(1000);
    let id = |id| CobId::new(id).unwrap();
    let classical = |of| Heard::Classical(Frame::new(id(of), &[1]).unwrap());
    let mut heard = std::vec![classical(0x182), classical(0x601)];
    heard.extend([0x481, 0x482, 0x483, 0x484].map(|of| Heard::Fd(id(of))));
    heard.push(classical(0x183));
    heard.reverse();
    assert!(
        bus.serve(&Hears(RefCell::new(heard))),
        "none that matters is lost"
    );
    let of_tick: Vec<u16> = core::iter::from_fn(|| tick.receive())
        .map(|frame| frame.id().get())
        .collect();
    assert_eq!(of_tick, [0x182, 0x183]);
    assert_eq!(background.receive().unwrap().id(), id(0x601));
    assert_eq!(background.receive(), None);
    let fd: Vec<u16> = core::iter::from_fn(|| background.receive_fd())
        .map(CobId::get)
        .collect();
    assert_eq!(fd, [0x481, 0x482]);
}
