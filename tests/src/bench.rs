//! A machine at work, tick by tick, and the common actions of the benches that use it.
//!
//! Time passes only in [`Bench::tick`]. The tests decide about faults and judge their effects.

use std::collections::VecDeque;

use leadscrew_board_sim::plant::{DriveOptions, PlantOptions};
use leadscrew_board_sim::{Row, Sim};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Event, State};
use leadscrew_core::call::{Call, Position};
use leadscrew_core::params::Params;

use crate::machine::{calls, machine};

/// A thread without a run-out, two passes, then a groove of one column, short ways.
pub const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q7000 F1\nG0 X61 Z-3\n\
                        G98 G75 R0.2\nG75 X58 P10000 F600\nG0 X70 Z8\nM30\n";

/// The next program: it must run as if it were the first. It ends at X 40 mm (radius), Z 10 mm.
pub const NEXT: &str =
    "M3 S600\nG0 X63 Z5\nG76 P010560 Q800 R0.1\nG76 X61 Z-4 P4000 Q4000 F1\nG0 X80 Z10\nM30\n";

/// The longest time of a stop in ticks: the deepest retract, a rapid out, two seconds for the spindle.
pub const PATIENCE: u64 = 6_000;

/// A program counts as stuck after this many ticks.
const LONGEST: u64 = 60_000;

/// A machine, the calls that wait for it, and its results.
pub struct Lathe {
    /// The machine.
    pub sim: Sim,
    /// Its parameters at the start.
    pub params: Params,
    /// Calls that had no room yet.
    pub waiting: VecDeque<Call>,
    /// Every tick whose true values are known.
    pub rows: Vec<Row>,
    /// Events of the board.
    pub events: Vec<Event>,
    /// The alarm on which it stands. A test that resets the machine clears it.
    pub alarm: Option<Alarm>,
    /// Number of ticks.
    pub ticks: u64,
}

impl Lathe {
    /// A machine just switched on. Its drives send their statuses as the parameters say.
    #[must_use]
    pub fn new(params: &Params) -> Self {
        let drives = DriveOptions {
            transmission: params.drive_status_syncs() as u8,
            ..DriveOptions::default()
        };
        let options = PlantOptions {
            drives,
            ..PlantOptions::default()
        };
        Self {
            sim: machine(params, &options),
            params: params.clone(),
            waiting: VecDeque::new(),
            rows: Vec::new(),
            events: Vec::new(),
            alarm: None,
            ticks: 0,
        }
    }

    /// Loads the next program.
    pub fn load(&mut self, text: &str) {
        self.waiting = calls(text, &self.params).into();
    }

    /// The state of the machine.
    #[must_use]
    pub fn state(&self) -> State {
        self.sim.board().ticker().state()
    }

    /// The machine's position as the board tells it.
    #[must_use]
    pub fn at(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    /// Hands over as many calls as there is room for.
    pub fn hand_over(&mut self) {
        let sim = &mut self.sim;
        while self.waiting.front().is_some_and(|call| sim.offer(call)) {
            self.waiting.pop_front();
        }
    }

    /// Takes the events of a tick. An alarm ends the program.
    ///
    /// # Panics
    /// At a second alarm without a reset between the two.
    pub fn listen(&mut self) {
        while let Some(event) = self.sim.event() {
            if let Event::Alarm(alarm) = event {
                assert_eq!(self.alarm, None, "a second alarm without a reset");
                self.alarm = Some(alarm);
                self.waiting.clear();
            }
            self.events.push(event);
        }
    }
}

/// A lathe with its surroundings.
pub trait Bench {
    /// The lathe.
    fn lathe(&self) -> &Lathe;

    /// One tick of the whole bench.
    fn tick(&mut self);

    /// This many ticks.
    fn ticks(&mut self, count: u64) {
        for _ in 0..count {
            self.tick();
        }
    }

    /// Ticks until the machine has no work or stands on an alarm.
    ///
    /// # Panics
    /// Where this does not happen.
    fn finish(&mut self, what: &str) {
        let begun = self.lathe().ticks;
        while !self.lathe().waiting.is_empty() || self.lathe().sim.is_busy() {
            self.tick();
            let lathe = self.lathe();
            assert!(
                lathe.ticks - begun < LONGEST,
                "{what}: stuck in {:?}",
                lathe.state()
            );
        }
    }

    /// Ticks until `done`, at most `most`.
    ///
    /// # Panics
    /// Where it takes longer.
    fn until(&mut self, what: &str, most: u64, mut done: impl FnMut(&Self) -> bool)
    where
        Self: Sized,
    {
        let begun = self.lathe().ticks;
        while !done(self) {
            self.tick();
            let lathe = self.lathe();
            assert!(
                lathe.ticks - begun <= most,
                "{what}: still {:?} after {most} ticks",
                lathe.state()
            );
        }
    }

    /// Ticks until the machine stands on the alarm that has come.
    ///
    /// # Panics
    /// Where it does not come to rest in time.
    fn until_on_alarm(&mut self, what: &str, most: u64)
    where
        Self: Sized,
    {
        self.until(what, most, |bench| {
            matches!(bench.lathe().state(), State::Alarm(_))
        });
    }

    /// Waits for a while. The board may command neither motion nor spindle.
    ///
    /// # Panics
    /// Where it does.
    fn stands(&mut self, what: &str) {
        let at = self.lathe().at();
        for _ in 0..50 {
            self.tick();
            let lathe = self.lathe();
            assert_eq!(lathe.at(), at, "{what}: it moves again");
            assert_eq!(lathe.sim.spindle_command().get(), 0, "{what}: the spindle");
        }
    }
}

impl Bench for Lathe {
    fn lathe(&self) -> &Lathe {
        self
    }

    fn tick(&mut self) {
        self.hand_over();
        self.rows.extend(self.sim.step());
        self.ticks += 1;
        self.listen();
    }
}
