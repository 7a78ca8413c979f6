//! What follows from what a board says: records, and how far it has been read.
//!
//! It has no clock and no board: each observation comes with its time. What it must remember beyond its own end is
//! [`Memory`]; whoever keeps records keeps it with them, or both not.

use leadscrew_core::link::{Certificate, ThreadCertificate, ThreadState};
use serde::{Deserialize, Serialize};

use crate::record::{
    Body, Cut, Event, Gap, Identity, Missing, Moment, OWN_COUNTS, Presence, Run, Start, State,
    Thread, What,
};

/// Speeds of a spindle that differ by no more are one: in turns a minute, and as a part of the speed.
const SPEED: (u32, u32) = (5, 50);
/// Loads of a bus that differ by less are one, in per cent.
const LOAD: u8 = 5;
/// Clocks of a board and a computer part by less than this: a part of the time, and always so many milliseconds.
const DRIFT: (u64, u64) = (1000, 10_000);

/// What the side of the bus has seen.
#[derive(Clone, Debug)]
pub enum Observation {
    /// A board answers: at the beginning, after silence, and after a start of it.
    Met(Met),
    /// What the machine does, and the board's ticks since power-up.
    State(State, u64),
    /// Checksum of the parameters in force.
    Parameters(u32),
    /// Entries of the log, in order.
    Log(Vec<Entry>),
    /// Certificates of a run and of threads, each with its cut, the newest first.
    Certificates(Ran, Vec<(ThreadCertificate, Cut)>),
    /// The board does not answer, or the bus is not there.
    Gone(String),
}

/// What a board is like when it is met.
#[derive(Clone, Debug)]
pub struct Met {
    /// Its serial number.
    pub serial: u32,
    /// Which of its starts this is, by its own count; 0: it cannot say.
    pub start: u32,
    /// Its firmware.
    pub firmware: String,
    /// Checksum of its parameters.
    pub parameters: u32,
    /// Its ticks since power-up.
    pub tick: u64,
    /// Its tick in microseconds.
    pub tick_us: u32,
    /// Number of the newest entry of its log.
    pub newest_event: u32,
    /// Number of its newest certificate.
    pub newest_thread: u32,
    /// Its tick at the entry that was read last ([`Memory::last_event`]), where the log still has it.
    pub last_event: Option<u64>,
}

/// The run whose figures a board has: the one under way, else the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ran {
    /// Its figures up to now.
    pub certificate: Certificate,
    /// It has not ended.
    pub under_way: bool,
}

/// An entry of the log; `None` for what is not told.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its number.
    pub number: u32,
    /// Its tick.
    pub tick: u64,
    /// What it says, where that is told.
    pub what: Option<What>,
}

/// How far a board has been read, and what was told of it last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// The start of the board that the numbers belong to; count 0: none was met.
    pub start: Start,
    /// The board's own count when it was met last; 0: it could not say.
    #[serde(default)]
    own: u32,
    /// The largest of the counts of this board that is a number of its starts here.
    #[serde(default)]
    most: u32,
    /// When the board had its power-up, by the computer's clock.
    power_up: Moment,
    /// Its last tick.
    tick: u64,
    /// When that was.
    at: Moment,
    /// Its tick in microseconds.
    tick_us: u32,
    /// Number and tick of the last entry of the log that was read.
    pub last_event: u32,
    event_tick: u64,
    /// Number of the last certificate of a thread that was told.
    thread: u32,
    /// Program and ticks of the last run that was told.
    run: Option<(u32, u64)>,
    /// A program has ended, and its result is to be told; true: it finished.
    ended: Option<bool>,
    /// The number of the entry that says so.
    #[serde(default)]
    ended_by: u32,
    /// Another had ended before it, and the certificates were not read in between.
    #[serde(default)]
    several: bool,
    /// The tick of the end of a program that finished, and the ticks from there to the next alarm.
    #[serde(default)]
    finished: Option<(u64, Option<u64>)>,
    identity: Option<Identity>,
    /// The set in force. Earlier versions did not remember it.
    #[serde(default)]
    in_force: Option<InForce>,
    alive: bool,
    state: Option<State>,
}

/// Since when a board has had its parameters, as far as the agent knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InForce {
    /// The board.
    serial: u32,
    /// Checksum of its parameters.
    pub parameters: u32,
    /// When they were seen first: they are in force since then at the latest.
    pub since: Moment,
    /// When others were seen last: these came later. `None`: no others were ever seen, and it may have been long before.
    pub after: Option<Moment>,
    /// When they were seen last.
    pub seen: Moment,
}

impl Memory {
    /// What the board is, and since when it has had its parameters. `None` until it has been met.
    #[must_use]
    pub fn in_force(&self) -> Option<(&Identity, &InForce)> {
        self.identity.as_ref().zip(self.in_force.as_ref())
    }

    /// Number of the last certificate of a thread that was told.
    #[must_use]
    pub const fn last_thread(&self) -> u32 {
        self.thread
    }

    /// The number of a start that begins to be read. No two of a board may have the same: where the board's own count does
    /// not go on from what is known, it is a number of the agent's, by the clock.
    /// Also gives the largest count of the board's own.
    fn count(&self, at: Moment, met: &Met) -> (u32, u32) {
        let most = match self.start {
            start if start.serial != met.serial => 0,
            // Earlier versions counted by themselves, from 1.
            start if start.count < OWN_COUNTS => self.most.max(start.count),
            _ => self.most,
        };
        if met.start > most {
            return (met.start, met.start);
        }
        let seconds = u32::try_from(at.0 / 1000).unwrap_or(u32::MAX);
        let own = self.start.count.saturating_add(1);
        (seconds.max(OWN_COUNTS).max(own), most)
    }

    fn note(&mut self, at: Moment, tick: u64) {
        (self.tick, self.at) = (tick, at);
        self.power_up = power_up(at, tick, self.tick_us);
    }
}

/// The model of one board.
#[derive(Clone, Debug, Default)]
pub struct Model {
    memory: Memory,
    /// What the board had logged and certified before it was met first is not told.
    past: Past,
}

/// What is still to be read of the time before a board was met first.
#[derive(Clone, Copy, Debug, Default)]
struct Past {
    /// Nothing was met yet.
    unmet: bool,
    log: bool,
    certificates: bool,
}

impl Model {
    /// Goes on from what was remembered. What holds at present is told anew: nobody knows how long ago it was remembered.
    #[must_use]
    pub fn new(memory: Memory) -> Self {
        Self {
            memory: Memory {
                identity: None,
                alive: false,
                state: None,
                ..memory
            },
            past: Past::default(),
        }
    }

    /// A model that tells what happens from now on: nothing was remembered, and nobody counts what others have read.
    #[must_use]
    pub fn from_now() -> Self {
        Self {
            past: Past {
                unmet: true,
                ..Past::default()
            },
            ..Self::default()
        }
    }

    /// What is to be remembered.
    #[must_use]
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// What an observation tells that is new, in order.
    pub fn take(&mut self, at: Moment, seen: &Observation) -> Vec<Body> {
        let mut told = Vec::new();
        match seen {
            Observation::Met(met) => self.meet(at, met, &mut told),
            Observation::State(state, tick) => {
                self.memory.note(at, *tick);
                self.state(state, &mut told);
            }
            Observation::Parameters(parameters) => {
                if let Some(identity) = &self.memory.identity {
                    let identity = Identity {
                        parameters: *parameters,
                        ..identity.clone()
                    };
                    self.identity(at, identity, &mut told);
                }
            }
            Observation::Log(entries) => {
                self.log(entries, &mut told);
                if std::mem::take(&mut self.past.log) {
                    told.clear();
                }
            }
            Observation::Certificates(run, threads) => {
                self.certificates(run, threads, &mut told);
                if std::mem::take(&mut self.past.certificates) {
                    told.clear();
                }
            }
            Observation::Gone(why) => self.presence(false, why, &mut told),
        }
        told
    }

    /// Whether this is the start that was read before. The board's count says that it is another. That it is the same one
    /// has to fit its numbers and the ticks of its log too: a flash may have been erased. Where neither says it, the clocks
    /// do [D406].
    fn is_same_start(&self, at: Moment, met: &Met) -> bool {
        let known = &self.memory;
        if known.start.count == 0
            || known.start.serial != met.serial
            || known.own != met.start
            || met.tick < known.tick
            || met.newest_event < known.last_event
            || met.newest_thread < known.thread
        {
            return false;
        }
        match met.last_event {
            // The same entry at the same tick; no start repeats an hour of operation tick by tick.
            Some(tick) => tick == known.event_tick,
            None if met.start > 0 => true,
            None => {
                let (part, least) = DRIFT;
                let power_up = power_up(at, met.tick, met.tick_us);
                let apart = power_up.0.abs_diff(known.power_up.0);
                apart <= at.0.saturating_sub(known.at.0) / part + least
            }
        }
    }

    fn meet(&mut self, at: Moment, met: &Met, told: &mut Vec<Body>) {
        if std::mem::take(&mut self.past.unmet) {
            self.past.log = met.newest_event > 0;
            self.past.certificates = true;
        }
        if !self.is_same_start(at, met) {
            let known = &self.memory;
            let (count, most) = known.count(at, met);
            self.memory = Memory {
                start: Start {
                    serial: met.serial,
                    count,
                },
                own: met.start,
                most,
                alive: known.alive,
                identity: known.identity.clone(),
                in_force: known.in_force,
                ..Memory::default()
            };
        }
        self.memory.tick_us = met.tick_us;
        self.memory.note(at, met.tick);
        self.identity(
            at,
            Identity {
                start: self.memory.start,
                parameters: met.parameters,
                firmware: met.firmware.clone(),
            },
            told,
        );
        self.presence(true, "", told);
    }

    fn identity(&mut self, at: Moment, identity: Identity, told: &mut Vec<Body>) {
        let (serial, parameters) = (identity.start.serial, identity.parameters);
        let before = self.memory.in_force;
        let same = before.filter(|set| (set.serial, set.parameters) == (serial, parameters));
        self.memory.in_force = Some(match same {
            Some(set) => InForce { seen: at, ..set },
            None => InForce {
                serial,
                parameters,
                since: at,
                after: before.map(|set| set.seen),
                seen: at,
            },
        });
        if self.memory.identity.as_ref() != Some(&identity) {
            self.memory.identity = Some(identity.clone());
            told.push(Body::Identity(identity));
        }
    }

    fn presence(&mut self, alive: bool, why: &str, told: &mut Vec<Body>) {
        if self.memory.alive != alive {
            self.memory.alive = alive;
            // What the machine does is not known meanwhile.
            self.memory.state = None;
            told.push(Body::Presence(Presence {
                alive,
                why: why.to_owned(),
            }));
        }
    }

    fn state(&mut self, state: &State, told: &mut Vec<Body>) {
        if self
            .memory
            .state
            .as_ref()
            .is_none_or(|last| differs(last, state))
        {
            self.memory.state = Some(state.clone());
            told.push(Body::State(state.clone()));
        }
    }

    fn log(&mut self, entries: &[Entry], told: &mut Vec<Body>) {
        for entry in entries {
            let start = self.memory.start;
            let last = self.memory.last_event;
            if entry.number <= last {
                continue;
            }
            if let Some(gap) = gap(start, Missing::Events, last, entry.number) {
                told.push(Body::Gap(gap));
            }
            (self.memory.last_event, self.memory.event_tick) = (entry.number, entry.tick);
            let Some(what) = &entry.what else { continue };
            match what {
                What::Finished => {
                    let before = self.memory.ended.replace(true);
                    self.memory.several |= before.is_some();
                    if before == Some(true) {
                        told.push(self.lost_run());
                    }
                    self.memory.ended_by = entry.number;
                    self.memory.finished = Some((entry.tick, None));
                }
                What::Alarm(_) => match &mut self.memory.finished {
                    // Of the machine at rest, or of a program that has begun since.
                    Some((at, alarm)) => {
                        alarm.get_or_insert(entry.tick.saturating_sub(*at));
                    }
                    None => self.memory.ended = Some(false),
                },
                What::Reset => {
                    self.memory.ended.get_or_insert(false);
                }
                What::Warning(_) | What::Refused(_) | What::Held | What::Ready => {}
            }
            told.push(Body::Event(Event {
                start,
                number: entry.number,
                tick: entry.tick,
                what: what.clone(),
            }));
        }
    }

    fn certificates(
        &mut self,
        ran: &Ran,
        threads: &[(ThreadCertificate, Cut)],
        told: &mut Vec<Body>,
    ) {
        let (start, run) = (self.memory.start, &ran.certificate);
        let ended = self.memory.ended.take();
        let several = std::mem::take(&mut self.memory.several);
        // What was cut may be of a run whose figures are gone.
        let program = match several || (ended.is_some() && ran.under_way) {
            true => 0,
            false => run.program,
        };
        for (thread, cut) in threads.iter().rev() {
            let last = self.memory.thread;
            // One that is under way is read again.
            if thread.number <= last || thread.record.state == ThreadState::UnderWay {
                continue;
            }
            if let Some(gap) = gap(start, Missing::Threads, last, thread.number) {
                told.push(Body::Gap(gap));
            }
            self.memory.thread = thread.number;
            told.push(Body::Thread(Thread::of(
                start,
                program,
                thread,
                cut.clone(),
            )));
        }
        let alarm = self.memory.finished.take().and_then(|(_, alarm)| alarm);
        if ran.under_way {
            // The board has begun another, and has the figures of the one that ended no more.
            if ended == Some(true) {
                told.push(self.lost_run());
            }
        } else if let Some(finished) = ended {
            // A run that is longer than the time from an end to an alarm is the one that finished.
            let finished = finished && alarm.is_none_or(|ticks| run.ticks > ticks);
            let this = Some((run.program, run.ticks));
            if run.ticks > 0 && self.memory.run != this {
                self.memory.run = this;
                told.push(Body::Run(Run::of(start, finished, run)));
            }
        }
    }

    /// The result of the run that ended is gone.
    const fn lost_run(&self) -> Body {
        let number = self.memory.ended_by;
        Body::Gap(Gap {
            start: self.memory.start,
            of: Missing::Runs,
            first: number,
            last: number,
        })
    }
}

fn power_up(at: Moment, tick: u64, tick_us: u32) -> Moment {
    let up_ms = tick.saturating_mul(tick_us.into()) / 1000;
    Moment(at.0.saturating_sub(up_ms))
}

/// The numbers between the last and the next.
fn gap(start: Start, of: Missing, last: u32, next: u32) -> Option<Gap> {
    let first = last.saturating_add(1);
    (next > first).then(|| Gap {
        start,
        of,
        first,
        last: next - 1,
    })
}

/// True where what the machine does has changed by more than its noise.
fn differs(last: &State, now: &State) -> bool {
    let (least, part) = SPEED;
    let speed = now.rpm.abs_diff(last.rpm) > least.max(last.rpm.unsigned_abs() / part);
    let load = match (last.load_percent, now.load_percent) {
        (Some(last), Some(now)) => last.abs_diff(now) >= LOAD,
        (last, now) => last != now,
    };
    let same = State {
        rpm: last.rpm,
        load_percent: last.load_percent,
        ..now.clone()
    };
    speed || load || same != *last
}

#[cfg(test)]
mod tests;
