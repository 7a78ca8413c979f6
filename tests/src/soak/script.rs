//! The draws of a shift, kept as a script that can be played again with parts left out.
//!
//! ```text
//! live:   seed ─► draws                        record: seed ─► draws ─► script        play: script, less some ─► draws
//! ```
//!
//! A shift draws while it works, so leaving out one draw would change all later ones. A script keeps each draw by its
//! purpose: its job, its place in the code, and its number there. A chance event, which may happen in any tick
//! ([`Draws::luck`]), is also kept by the tick of its job. So the rest stays the same, whatever is left out. A draw that is
//! not in the script is calm: the frame arrives, nobody presses anything, the last value of a range.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::Location;

use super::programs::{Groove, Program};
use crate::random::{self, Random};

/// Separates a shift's draws from other draws of the same seed.
const OF_A_SHIFT: u64 = 0x50AC_50AC;
/// A played shift is over before this tick, also where its last job takes the longest time. Otherwise it would never end.
const MOST_TICKS: u64 = 2 * super::shift::LONGEST;

/// Place of a draw in the code.
type Place = &'static Location<'static>;

/// An event that may happen in any tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Luck {
    /// A frame is lost, or comes twice.
    Wire,
    /// The operator acts, or a part breaks.
    Act,
}

/// A chance event: its job, its tick, and its number among the possible events of this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Chance {
    /// Its job; 0 before the first job.
    pub job: u32,
    /// Ticks of the job before it.
    pub tick: u64,
    /// Its kind.
    pub luck: Luck,
    nth: u32,
}

/// The purpose of a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Purpose {
    job: u32,
    /// The tick, for a draw of a chance event.
    tick: Option<u64>,
    place: Place,
    nth: u32,
}

/// A program of a script.
#[derive(Clone, Debug)]
pub struct Written {
    /// The original text.
    pub text: String,
    /// Its end position.
    pub end: (i64, i64),
    /// Its threads.
    pub grooves: Vec<Groove>,
    /// Lines that are left out, from 0.
    pub without: BTreeSet<usize>,
}

impl Written {
    /// The lines that may be left out: all but the first, the way to the end position, and the end.
    pub fn lines(&self) -> Vec<usize> {
        let count = self.text.lines().count();
        (1..count.saturating_sub(2)).collect()
    }

    /// The rest of the text. A line that is left out is empty, so that the others keep their numbers.
    pub fn left(&self) -> String {
        let lines = self.text.lines().enumerate();
        lines
            .map(|(number, line)| match self.without.contains(&number) {
                true => "\n".into(),
                false => format!("{line}\n"),
            })
            .collect()
    }

    /// The threads that are unchanged.
    fn grooves(&self) -> Vec<Groove> {
        let whole = |groove: &&Groove| {
            let mut own = groove.first - 1..=groove.line - 1;
            !own.any(|line| self.without.contains(&(line as usize)))
        };
        self.grooves.iter().filter(whole).copied().collect()
    }
}

/// A shift as drawn.
#[derive(Clone, Debug, Default)]
pub struct Script {
    /// The remaining jobs, from 1.
    pub jobs: Vec<u32>,
    /// The chance events.
    pub chances: BTreeSet<Chance>,
    /// The programs by job.
    pub programs: BTreeMap<u32, Written>,
    lucks: BTreeMap<Chance, i64>,
    bits: BTreeMap<Purpose, u64>,
}

/// The report of a played shift.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// The actions in order.
    pub lines: Vec<String>,
    /// The chance events that happened.
    pub chances: BTreeSet<Chance>,
}

#[derive(Debug, Default)]
enum Mode {
    #[default]
    Live,
    Record,
    Play,
}

/// The source of all draws of a shift.
#[derive(Debug)]
pub struct Draws {
    random: Random,
    mode: Mode,
    script: Script,
    told: Told,
    job: u32,
    begun: u64,
    now: u64,
    /// The present draws belong to a chance event.
    acts: bool,
    /// Number of draws for the same purpose, in this job and in this tick of it.
    in_job: Vec<(Place, u32)>,
    in_tick: Vec<(Place, u32)>,
    lucks: [u32; 2],
}

impl Draws {
    /// Draws from a seed, not kept.
    pub fn live(seed: u64) -> Self {
        Self {
            random: Random(seed ^ OF_A_SHIFT),
            mode: Mode::Live,
            script: Script::default(),
            told: Told::default(),
            job: 0,
            begun: 0,
            now: 0,
            acts: false,
            in_job: Vec::new(),
            in_tick: Vec::new(),
            lucks: [0; 2],
        }
    }

    /// Draws from a seed, kept.
    pub fn record(seed: u64) -> Self {
        Self {
            mode: Mode::Record,
            ..Self::live(seed)
        }
    }

    /// Draws from a script.
    pub fn play(script: Script) -> Self {
        Self {
            mode: Mode::Play,
            script,
            ..Self::live(0)
        }
    }

    /// The draws and the report.
    pub fn into_script(self) -> (Script, Told) {
        (self.script, self.told)
    }

    /// Begins a job. `false` where the script leaves it out.
    pub fn job(&mut self, number: u32) -> bool {
        self.job = number;
        self.begun = self.now;
        self.in_job.clear();
        self.tick(self.now);
        match self.mode {
            Mode::Live => true,
            Mode::Record => {
                self.script.jobs.push(number);
                true
            }
            Mode::Play => self.script.jobs.contains(&number),
        }
    }

    /// Begins a tick.
    ///
    /// # Panics
    /// Where a script with parts left out does not come to an end.
    pub fn tick(&mut self, now: u64) {
        if let Mode::Play = self.mode {
            assert!(now < MOST_TICKS, "a script without an end");
        }
        self.now = now;
        self.in_tick.clear();
        self.lucks = [0; 2];
    }

    /// Draws a chance event from `low` to `high`. It happens where `happens` returns true.
    pub fn luck(
        &mut self,
        luck: Luck,
        low: i64,
        high: i64,
        happens: impl FnOnce(i64) -> bool,
    ) -> i64 {
        if let Mode::Live = self.mode {
            return self.random.within(low, high);
        }
        let nth = &mut self.lucks[luck as usize];
        let chance = Chance {
            job: self.job,
            tick: self.now - self.begun,
            luck,
            nth: *nth,
        };
        *nth += 1;
        if let Mode::Record = self.mode {
            let drawn = self.random.within(low, high);
            if happens(drawn) {
                self.script.chances.insert(chance);
                self.script.lucks.insert(chance, drawn);
            }
            return drawn;
        }
        if !self.script.chances.contains(&chance) {
            return high;
        }
        self.told.chances.insert(chance);
        if luck == Luck::Wire {
            self.tell(|| "a frame is lost or comes twice".into());
        }
        self.script.lucks.get(&chance).copied().unwrap_or(high)
    }

    /// Whether the following draws belong to a chance event.
    pub fn set_acts(&mut self, acts: bool) {
        self.acts = acts;
    }

    /// Reports a chance event, where a report is wanted.
    pub fn act(&mut self, what: impl FnOnce() -> String) {
        if self.acts {
            self.tell(what);
        }
    }

    /// Reports an action, where a report is wanted.
    pub fn tell(&mut self, what: impl FnOnce() -> String) {
        if let Mode::Play = self.mode {
            let tick = self.now - self.begun;
            self.told.lines.push(format!("  tick {tick}: {}", what()));
        }
    }

    /// Reports the beginning of a job, where a report is wanted.
    pub fn tell_job(&mut self, what: &str) {
        if let Mode::Play = self.mode {
            self.told.lines.push(format!("job {}: {what}", self.job));
        }
    }

    /// The program of this job: `made` now, or made again from the script's text.
    pub fn program(
        &mut self,
        made: impl FnOnce(&mut Self) -> Program,
        again: impl FnOnce(&str) -> Program,
    ) -> Program {
        if let Mode::Play = self.mode {
            let written = self.script.programs.get(&self.job).cloned();
            let written = written.expect("a job that writes a program does so again");
            let left = written.left();
            for line in left.lines().filter(|line| !line.is_empty()) {
                self.told.lines.push(format!("    {line}"));
            }
            return Program {
                end: written.end,
                grooves: written.grooves(),
                ..again(&left)
            };
        }
        let program = made(self);
        if let Mode::Record = self.mode {
            let written = Written {
                text: program.text.clone(),
                end: program.end,
                grooves: program.grooves.clone(),
                without: BTreeSet::new(),
            };
            self.script.programs.insert(self.job, written);
        }
        program
    }

    /// The next bits; `None` where a script has none for this purpose.
    #[track_caller]
    fn bits(&mut self) -> Option<u64> {
        if let Mode::Live = self.mode {
            return Some(self.random.next_bits());
        }
        let place = Location::caller();
        let counts = match self.acts {
            true => &mut self.in_tick,
            false => &mut self.in_job,
        };
        let before = match counts.iter_mut().find(|count| count.0 == place) {
            Some(count) => {
                count.1 += 1;
                count.1
            }
            None => {
                counts.push((place, 0));
                0
            }
        };
        let purpose = Purpose {
            job: self.job,
            tick: self.acts.then(|| self.now - self.begun),
            place,
            nth: before,
        };
        if let Mode::Play = self.mode {
            return self.script.bits.get(&purpose).copied();
        }
        let bits = self.random.next_bits();
        self.script.bits.insert(purpose, bits);
        Some(bits)
    }

    /// True with a probability in per cent.
    #[track_caller]
    pub fn chance(&mut self, percent: u64) -> bool {
        self.bits()
            .is_some_and(|bits| random::chance(bits, percent))
    }

    /// `low` to `high`, both included.
    #[track_caller]
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        self.bits()
            .map_or(high, |bits| random::within(bits, low, high))
    }

    /// 1 or −1.
    #[track_caller]
    pub fn sign(&mut self) -> i64 {
        if self.chance(50) { 1 } else { -1 }
    }

    /// One of a list.
    #[track_caller]
    pub fn of<T: Copy>(&mut self, list: &[T]) -> T {
        self.bits()
            .map_or_else(|| list[0], |bits| random::of(bits, list))
    }
}
