//! A machine whose X and Z home by their drives, and a watch on every frame to and from the drive of X.

use leadscrew_board_sim::plant::{Drive, HomingOptions, PlantOptions};
use leadscrew_board_sim::{Direction, Sim};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::bus::{CobId, DriveCommand, DriveStatus, Frame, NodeId, Service};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axes, Axis, Length};
use leadscrew_tests::params::with;

/// The switches of X: 100 nm an increment.
pub const SWITCHES: HomingOptions = HomingOptions {
    negative: -1_000_000,
    positive: 1_000_000,
    home: (300_000, 400_000),
    ..HomingOptions::FAR
};

/// Position of the mark of X in machine coordinates, in nanometres.
pub const MARK: i64 = 12_345_600;

/// No homing of these tests takes longer.
pub const LONGEST: u64 = 40_000;

/// The parameters: X and Z home by their drives.
pub fn params() -> Params {
    params_and(&[])
}

/// The same with other values.
pub fn params_and(values: &[(&str, i64)]) -> Params {
    let own = [
        ("9050.X", 1),
        ("9050.Z", 1),
        ("9058.X", MARK),
        ("9061.X", 30_000),
    ];
    with(&[&own[..], values].concat())
}

/// X and Z.
pub fn both() -> Axes {
    Axes::NONE.with(Axis::X).with(Axis::Z)
}

pub struct Bench {
    pub sim: Sim,
    pub events: Vec<Event>,
    pub ticks: u64,
    /// Where the axis of X really was, at each tick.
    pub places: Vec<i64>,
    /// 6040h and 607Ah of X in each tick, and 6064h as last reported before them.
    pub told: Vec<(u16, i32, i32)>,
    /// 6064h as last reported by X.
    reported: i32,
    /// 6060h as sent to X.
    pub modes: Vec<u8>,
}

impl Bench {
    /// A machine whose X is at this place, and whose drive counts from another one.
    pub fn new(place: i64, options: HomingOptions, method: u8) -> Self {
        Self::with(&params(), place, options, method)
    }

    pub fn with(params: &Params, place: i64, options: HomingOptions, method: u8) -> Self {
        let mut bench = Self::unprepared(params, place, options);
        bench.prepare(method);
        bench
    }

    /// The drive of X has been told nothing of homing.
    pub fn unprepared(params: &Params, place: i64, options: HomingOptions) -> Self {
        let at = Position {
            x: Length::from_nm(place * 100),
            ..Position::default()
        };
        let plant = PlantOptions {
            at,
            ..PlantOptions::default()
        };
        let mut sim = Sim::new(params, &plant).expect("the machine starts");
        assert_eq!(drive(&mut sim).place(), place);
        drive(&mut sim).set_homing(options);
        Self {
            sim,
            events: Vec::new(),
            ticks: 0,
            places: Vec::new(),
            told: Vec::new(),
            reported: 0,
            modes: Vec::new(),
        }
    }

    /// Writes the method and the slow speed.
    pub fn prepare(&mut self, method: u8) {
        self.write(0x6098, 0, 1, method.into());
        self.write(0x6099, 2, 4, 100_000);
    }

    /// Writes an object of X's drive.
    pub fn write(&mut self, index: u16, sub: u8, bytes: u8, value: u32) {
        let [low, high] = index.to_le_bytes();
        let [a, b, c, d] = value.to_le_bytes();
        let command = 0x23 | (4 - bytes) << 2;
        let id = CobId::of(Service::SdoRequest, NodeId::DRIVE_X);
        let request = Frame::new(id, &[command, low, high, sub, a, b, c, d]).expect("a frame");
        let mut answers = Vec::new();
        self.sim
            .plant()
            .hear(&request, |answer| answers.push(answer));
        assert_eq!(answers[0].payload()[0], 0x60, "{index:04X}h takes {value}");
    }

    pub fn drive(&mut self) -> &mut Drive {
        drive(&mut self.sim)
    }

    pub fn state(&self) -> State {
        self.sim.board().ticker().state()
    }

    pub fn at(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    pub fn referenced(&self) -> Axes {
        self.sim.board().ticker().referenced()
    }

    pub fn tick(&mut self) {
        let mut heard = Vec::new();
        self.sim
            .step_on(&mut |direction, frame| heard.push((direction, *frame)));
        for (direction, frame) in heard {
            match (direction, frame.id().service()) {
                (Direction::ToBoard, Some((Service::Tpdo1, NodeId::DRIVE_X))) => {
                    let (_, status) = DriveStatus::decode(&frame).expect("a status");
                    self.reported = status.actual.get();
                }
                (Direction::FromBoard, Some((Service::Rpdo2, NodeId::DRIVE_X))) => {
                    self.modes.push(frame.payload()[0]);
                }
                (Direction::FromBoard, Some((Service::Rpdo1, NodeId::DRIVE_X))) => {
                    let (_, command) = DriveCommand::decode(&frame).expect("a command");
                    self.told
                        .push((command.control.raw(), command.target.get(), self.reported));
                }
                _ => {}
            }
        }
        while let Some(event) = self.sim.event() {
            self.events.push(event);
        }
        let place = drive(&mut self.sim).place();
        self.places.push(place);
        self.ticks += 1;
    }

    pub fn home(&mut self, axes: Axes) {
        self.sim.command(Command::Home(axes));
        self.tick();
    }

    /// Ticks until `done`.
    pub fn until(&mut self, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let begun = self.ticks;
        while !done(self) {
            self.tick();
            assert!(self.ticks - begun < LONGEST, "{what}: {:?}", self.state());
        }
    }

    /// Homes X and gives the machine's position of X, in nanometres.
    pub fn home_x(&mut self, what: &str) -> i64 {
        self.home(Axes::NONE.with(Axis::X));
        self.until(what, |bench| bench.state() != State::Homing);
        assert_eq!(self.state(), State::Idle, "{what}: {:?}", self.events);
        assert!(self.referenced().contains(Axis::X), "{what}");
        self.at().x.nm()
    }

    /// Homes X, which fails with an alarm; the machine comes to rest on it.
    pub fn fails(&mut self, what: &str) -> Alarm {
        self.home(Axes::NONE.with(Axis::X));
        self.until(what, |bench| {
            matches!(bench.state(), State::Alarm(_) | State::Idle)
        });
        self.alarm(what)
    }

    pub fn alarm(&self, what: &str) -> Alarm {
        match self.state() {
            State::Alarm(alarm) => alarm,
            other => panic!("{what}: {other:?}"),
        }
    }

    /// From 001Fh to the end of homing every target was the last report; the axis never moved farther in a tick than its
    /// speed allows; and since the last `still` ticks it has not moved at all.
    pub fn judge(&self, what: &str, still: usize) {
        let first = self
            .told
            .iter()
            .position(|(control, ..)| control & 0x10 != 0);
        if let Some(first) = first {
            for (control, target, reported) in &self.told[first..] {
                assert_eq!(target, reported, "{what}: {control:04X}h");
            }
        }
        for pair in self.places.windows(2) {
            // 200 000 increments a second, and the rounding of two places.
            assert!((pair[1] - pair[0]).abs() <= 202, "{what}: {pair:?}");
        }
        let last = &self.places[self.places.len() - still..];
        assert!(
            last.iter().all(|place| place == &last[0]),
            "{what}: {last:?}"
        );
    }
}

fn drive(sim: &mut Sim) -> &mut Drive {
    sim.plant().drive(Axis::X)
}
