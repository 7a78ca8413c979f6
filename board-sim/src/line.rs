//! A wire with faults, between the board, its drives and other nodes: a seeded, deterministic injector.
//!
//! ```text
//!           Out                        Setpoints
//! gateway ◄────── ─┐              ┌─ ─────────────► drives
//!                  ├─── board ────┤
//! gateway ──────► ─┘              └─ ◄───────────── drives
//!           In                         Statuses
//! ```
//!
//! Every frame passes [`Line::pass`]. It comes out once, not at all, twice, or after the next frame. The owner keeps
//! the time: it calls [`Line::tick`] before each tick of the board. The same faults, seed and frames give the same result.
//!
//! This module knows frames. Of their meaning it knows SYNC only.

use heapless::Vec;
use leadscrew_core::bus::{
    BusState, CobId, Controller, Controlword, DriveCommand, ErrorCounts, FdFrame, Frame,
    Increments, NmtCommand, NmtState, NodeId, is_sync,
};

/// Ticks from one heartbeat of another node to the next.
const HEARTBEAT: u64 = 100;

/// The most setpoints of a period.
const SETPOINTS: usize = 16;

/// The direction of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// From the board to its drives.
    Setpoints,
    /// From the drives to the board.
    Statuses,
    /// From any other node to the board.
    In,
    /// From the board to any other node.
    Out,
}

impl Way {
    /// All directions.
    pub const ALL: [Self; 4] = [Self::Setpoints, Self::Statuses, Self::In, Self::Out];
}

/// Faults of single frames, by chance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Noise {
    /// Frames that are lost, in thousandths.
    pub lose: u16,
    /// Frames that come twice, in thousandths.
    pub double: u16,
    /// Frames that come after the next frame, in thousandths.
    pub swap: u16,
}

/// A span of ticks; its end is not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first tick.
    pub from: u64,
    /// The tick after the last; `u64::MAX` for no end.
    pub to: u64,
}

impl Span {
    /// True for a tick within the span.
    #[must_use]
    pub const fn has(&self, tick: u64) -> bool {
        self.from <= tick && tick < self.to
    }
}

/// The actions of a second master on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intruder {
    /// It sends a SYNC in every period.
    Sync,
    /// It sends this drive to its own zero in every period.
    Setpoint(NodeId),
    /// It stops this drive, or the board, by NMT, once.
    Stop(NodeId),
    /// It has this number, too, and says so in heartbeats.
    Namesake(NodeId),
}

/// All faults of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Faults {
    /// Faults by chance, in the order of [`Way::ALL`].
    pub noise: [Noise; 4],
    /// The seed of the chance.
    pub seed: u64,
    /// The board's cable is out.
    pub cable_out: Option<Span>,
    /// The line is so bad that the board's controller goes bus-off.
    pub bus_off: Option<Span>,
    /// The line is so bad that the board's controller is error passive.
    pub error_passive: Option<Span>,
    /// Setpoints leave the board after the SYNC that was to latch them.
    pub late: Option<Span>,
    /// A second master.
    pub intruder: Option<(Intruder, Span)>,
}

impl Default for Faults {
    fn default() -> Self {
        Self::NONE
    }
}

impl Faults {
    /// A good wire.
    pub const NONE: Self = Self {
        noise: [Noise {
            lose: 0,
            double: 0,
            swap: 0,
        }; 4],
        seed: 1,
        cable_out: None,
        bus_off: None,
        error_passive: None,
        late: None,
        intruder: None,
    };

    /// The faults by chance of one direction.
    pub fn noise_mut(&mut self, way: Way) -> &mut Noise {
        let [setpoints, statuses, into, out] = &mut self.noise;
        match way {
            Way::Setpoints => setpoints,
            Way::Statuses => statuses,
            Way::In => into,
            Way::Out => out,
        }
    }

    /// The same faults by chance in every direction.
    #[must_use]
    pub const fn everywhere(mut self, noise: Noise) -> Self {
        self.noise = [noise; 4];
        self
    }
}

/// The number of frames that the faults have changed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Harm {
    /// Frames lost, by chance or with the wire.
    pub lost: u64,
    /// Frames doubled.
    pub doubled: u64,
    /// Frames that came after the next frame.
    pub swapped: u64,
    /// Ticks whose setpoints were late for their SYNC.
    pub late: u32,
}

/// A wire with faults.
#[derive(Clone, Debug)]
pub struct Line {
    faults: Faults,
    /// The wire has no faults at all.
    good: bool,
    /// The state of a linear congruential generator.
    chance: u64,
    /// In this tick the wire changes no frame and holds none back.
    quiet: bool,
    dead: bool,
    late: bool,
    controller: Controller,
    /// For each direction, a frame that waits for the next frame.
    held: [Option<Frame>; 4],
    /// Setpoints that wait for the next SYNC.
    waiting: Vec<Frame, SETPOINTS>,
    /// The frame with all setpoints that waits for the next SYNC.
    together: Option<FdFrame>,
    harm: Harm,
}

impl Default for Line {
    fn default() -> Self {
        Self::new(Faults::NONE)
    }
}

impl Line {
    /// A wire with these faults.
    #[must_use]
    pub fn new(faults: Faults) -> Self {
        Self {
            faults,
            good: faults == Faults::NONE,
            chance: faults.seed,
            quiet: true,
            dead: false,
            late: false,
            controller: Controller {
                state: BusState::Active,
                errors: ErrorCounts {
                    sending: 0,
                    receiving: 0,
                },
            },
            held: [None; 4],
            waiting: Vec::new(),
            together: None,
            harm: Harm {
                lost: 0,
                doubled: 0,
                swapped: 0,
                late: 0,
            },
        }
    }

    /// The faults.
    #[must_use]
    pub const fn faults(&self) -> &Faults {
        &self.faults
    }

    /// The number of changed frames.
    #[must_use]
    pub const fn harm(&self) -> Harm {
        self.harm
    }

    /// The state of the board's controller.
    #[must_use]
    pub const fn controller(&self) -> Controller {
        self.controller
    }

    /// Goes on to this tick. `rejoin`: the board permits a restart of a controller that has left the bus. Gives the
    /// frame that the second master sends in this tick.
    pub fn tick(&mut self, tick: u64, rejoin: bool) -> Option<Frame> {
        let in_span = |span: Option<Span>| span.is_some_and(|span| span.has(tick));
        let bad = in_span(self.faults.bus_off);
        let stays_off = self.controller.state == BusState::Off && !rejoin;
        let (state, errors) = if bad || stays_off {
            (BusState::Off, (255, 96))
        } else if in_span(self.faults.error_passive) {
            (BusState::Passive, (136, 40))
        } else {
            (BusState::Active, (0, 0))
        };
        self.controller = Controller {
            state,
            errors: ErrorCounts {
                sending: errors.0,
                receiving: errors.1,
            },
        };
        self.dead = state == BusState::Off || in_span(self.faults.cable_out);
        self.late = in_span(self.faults.late);
        if self.late {
            self.harm.late = self.harm.late.saturating_add(1);
        }
        let calm = self.faults.noise == Faults::NONE.noise
            && self.held == [None; 4]
            && self.together.is_none();
        self.quiet = calm && !self.dead && !self.late && self.waiting.is_empty();
        let (intruder, span) = self.faults.intruder?;
        let first = span.from == tick;
        let sends = match intruder {
            Intruder::Sync | Intruder::Setpoint(_) => span.has(tick),
            Intruder::Stop(_) => first,
            Intruder::Namesake(_) => {
                let since = tick.wrapping_sub(span.from);
                span.has(tick) && since.is_multiple_of(HEARTBEAT)
            }
        };
        sends.then(|| intruder.frame()).flatten()
    }

    /// True where the wire has no faults at all.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        self.good
    }

    /// True where all frames pass unchanged in this tick.
    #[must_use]
    pub const fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Passes a frame on; `to` gets every frame that arrives.
    pub fn pass(&mut self, way: Way, frame: &Frame, mut to: impl FnMut(Frame)) {
        if self.quiet {
            to(*frame);
            return;
        }
        if self.dead {
            self.harm.lost = self.harm.lost.saturating_add(1);
            *self.held_mut(way) = None;
            self.waiting.clear();
            return;
        }
        if way == Way::Setpoints && self.delay(frame, &mut to) {
            return;
        }
        let noise = *self.faults.noise_mut(way);
        if self.happens(noise.lose) {
            self.harm.lost = self.harm.lost.saturating_add(1);
            return;
        }
        let before = self.held_mut(way).take();
        if before.is_none() && self.happens(noise.swap) {
            self.harm.swapped = self.harm.swapped.saturating_add(1);
            *self.held_mut(way) = Some(*frame);
            return;
        }
        to(*frame);
        if self.happens(noise.double) {
            self.harm.doubled = self.harm.doubled.saturating_add(1);
            to(*frame);
        }
        if let Some(before) = before {
            to(before);
        }
    }

    /// Passes on the frame with all setpoints. It can be lost or late like others. It is never doubled (that would
    /// change nothing) and never swapped (it is the only one of its kind in a period).
    pub fn pass_together(&mut self, way: Way, frame: &FdFrame, mut to: impl FnMut(&FdFrame)) {
        if self.quiet {
            to(frame);
            return;
        }
        let to_drives = way == Way::Setpoints;
        let before = self.together.take_if(|_| to_drives);
        let noise = *self.faults.noise_mut(way);
        if self.dead || self.happens(noise.lose) {
            self.harm.lost = self.harm.lost.saturating_add(1);
            return;
        }
        if let Some(before) = before {
            to(&before);
        }
        if to_drives && self.late {
            self.together = Some(*frame);
        } else {
            to(frame);
        }
    }

    /// A frame of this direction that still waits for a next frame.
    pub fn release(&mut self, way: Way) -> Option<Frame> {
        self.held_mut(way).take()
    }

    /// True where the frame is handled: it waits for the next SYNC, or it is this SYNC.
    fn delay(&mut self, frame: &Frame, to: &mut impl FnMut(Frame)) -> bool {
        if is_sync(frame) {
            if self.waiting.is_empty() {
                return false;
            }
            to(*frame);
            for late in &self.waiting {
                to(*late);
            }
            self.waiting.clear();
            return true;
        }
        // A board sends no more setpoints in a period.
        self.late && self.waiting.push(*frame).is_ok()
    }

    fn held_mut(&mut self, way: Way) -> &mut Option<Frame> {
        let [setpoints, statuses, into, out] = &mut self.held;
        match way {
            Way::Setpoints => setpoints,
            Way::Statuses => statuses,
            Way::In => into,
            Way::Out => out,
        }
    }

    fn happens(&mut self, per_mille: u16) -> bool {
        if per_mille == 0 {
            return false;
        }
        self.chance = self
            .chance
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.chance >> 33) % 1000 < u64::from(per_mille)
    }
}

impl Intruder {
    fn frame(self) -> Option<Frame> {
        Some(match self {
            Self::Sync => Frame::new(CobId::SYNC, &[])?,
            Self::Setpoint(node) => DriveCommand {
                control: Controlword::ENABLE_OPERATION,
                target: Increments::new(0),
            }
            .frame(node),
            Self::Stop(node) => NmtCommand::Stop.frame(Some(node)),
            Self::Namesake(node) => NmtState::Operational.frame(node),
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use leadscrew_core::bus::{Service, SyncProducer};
    use std::vec::Vec;

    fn frame(number: u8) -> Frame {
        Frame::new(CobId::of(Service::Rpdo1, NodeId::DRIVE_X), &[number]).unwrap()
    }

    fn numbers(line: &mut Line, ticks: u64) -> Vec<u8> {
        let mut came = Vec::new();
        for tick in 0..ticks {
            line.tick(tick, false);
            line.pass(Way::In, &frame(tick as u8), |frame| {
                came.push(frame.payload()[0])
            });
        }
        came
    }

    #[test]
    fn a_good_wire_changes_nothing() {
        let came = numbers(&mut Line::default(), 200);
        assert_eq!(came, (0..200).collect::<Vec<u8>>());
    }

    #[test]
    fn chance_is_that_of_the_seed_and_about_as_often_as_asked_for() {
        let noise = Noise {
            lose: 100,
            double: 50,
            swap: 30,
        };
        let run = |seed| {
            let faults = Faults {
                seed,
                ..Faults::NONE
            };
            let mut line = Line::new(faults.everywhere(noise));
            let came = numbers(&mut line, 10_000);
            (came, line.harm())
        };
        assert_eq!(run(7), run(7));
        assert_ne!(run(7).0, run(8).0);
        let (came, harm) = run(7);
        assert!((900..1_100).contains(&harm.lost), "{harm:?}");
        assert!((400..500).contains(&harm.doubled), "{harm:?}");
        assert!((200..300).contains(&harm.swapped), "{harm:?}");
        let held = u64::from(came.len() as u64 + harm.lost != 10_000 + harm.doubled);
        assert_eq!(came.len() as u64 + harm.lost + held, 10_000 + harm.doubled);
    }

    #[test]
    fn a_swapped_frame_comes_behind_the_next_one() {
        let mut faults = Faults::NONE;
        faults.noise_mut(Way::In).swap = 1000;
        // Every frame that can be swapped: the first, the third, …
        assert_eq!(numbers(&mut Line::new(faults), 6), [1, 0, 3, 2, 5, 4]);
    }

    #[test]
    fn a_cable_that_is_out_loses_all_and_nothing_else() {
        let span = Span { from: 3, to: 6 };
        let mut line = Line::new(Faults {
            cable_out: Some(span),
            ..Faults::NONE
        });
        assert_eq!(numbers(&mut line, 8), [0, 1, 2, 6, 7]);
        assert_eq!(line.harm().lost, 3);
        assert_eq!(line.controller().state, BusState::Active);
    }

    #[test]
    fn a_controller_that_is_off_waits_for_the_line_and_for_the_board() {
        let span = Span { from: 3, to: 6 };
        let mut line = Line::new(Faults {
            bus_off: Some(span),
            ..Faults::NONE
        });
        let states: Vec<BusState> = (0..10)
            .map(|tick| {
                line.tick(tick, tick == 4 || tick == 8);
                line.controller().state
            })
            .collect();
        for (tick, state) in states.into_iter().enumerate() {
            let off = (3..8).contains(&tick);
            assert_eq!(state == BusState::Off, off, "{tick}");
        }
    }

    #[test]
    fn late_setpoints_come_behind_the_next_sync() {
        let mut line = Line::new(Faults {
            late: Some(Span { from: 1, to: 2 }),
            ..Faults::NONE
        });
        let mut sync = SyncProducer::new();
        let mut came = Vec::new();
        for tick in 0..4 {
            line.tick(tick, false);
            for sent in [sync.next(), frame(100 + tick as u8)] {
                line.pass(Way::Setpoints, &sent, |frame| came.push(frame.payload()[0]));
            }
        }
        assert_eq!(came, [1, 100, 2, 3, 101, 102, 4, 103]);
        assert_eq!(line.harm().late, 1);
    }

    #[test]
    fn the_frame_for_all_drives_is_lost_and_late_as_others_are() {
        let mut faults = Faults {
            late: Some(Span { from: 3, to: 5 }),
            cable_out: Some(Span { from: 7, to: 8 }),
            ..Faults::NONE
        };
        let came = |line: &mut Line, way| {
            let mut came = std::vec::Vec::new();
            for tick in 0..10_u8 {
                line.tick(tick.into(), true);
                let frame = FdFrame::new(CobId::new(0x481).unwrap(), &[tick], true).unwrap();
                line.pass_together(way, &frame, |frame| came.push((tick, frame.payload()[0])));
            }
            came
        };
        let expected = [
            (0, 0),
            (1, 1),
            (2, 2),
            (4, 3),
            (5, 4),
            (5, 5),
            (6, 6),
            (8, 8),
            (9, 9),
        ];
        let mut line = Line::new(faults);
        assert_eq!(came(&mut line, Way::Setpoints), expected);
        assert_eq!((line.harm().lost, line.harm().late), (1, 2));
        // Towards other nodes there is no delay: all frames arrive in the tick in which they were sent.
        let all: std::vec::Vec<_> = (0..10)
            .filter(|tick| *tick != 7)
            .map(|tick| (tick, tick))
            .collect();
        assert_eq!(came(&mut Line::new(faults), Way::Out), all);
        faults.noise_mut(Way::Setpoints).lose = 1000;
        assert_eq!(came(&mut Line::new(faults), Way::Setpoints), []);
    }

    #[test]
    fn a_second_master_speaks_when_it_is_told_to() {
        let speaks = |intruder| {
            let span = Span { from: 2, to: 4 };
            let mut line = Line::new(Faults {
                intruder: Some((intruder, span)),
                ..Faults::NONE
            });
            (0..6)
                .filter(|tick| line.tick(*tick, false).is_some())
                .collect::<Vec<u64>>()
        };
        assert_eq!(speaks(Intruder::Sync), [2, 3]);
        assert_eq!(speaks(Intruder::Setpoint(NodeId::DRIVE_X)), [2, 3]);
        assert_eq!(speaks(Intruder::Stop(NodeId::DRIVE_X)), [2]);
        assert_eq!(speaks(Intruder::Namesake(NodeId::DRIVE_X)), [2]);
    }
}
