//! An agent for a load test: store, sender and archive are those of `leadscrew agent`, and its machines are made up.
//!
//! `many BROKER FOLDER NAME MACHINES BEGIN PERIOD THREADS STATES STORE`: machines `NAME-0`, `NAME-1`, … have been cutting a
//! thread every PERIOD ms since BEGIN (ms since 1970), THREADS in all, and tell STATES states for each. What one has cut
//! follows from the clock, so an agent that was killed finds a board that went on meanwhile, and forgot all but its last
//! five certificates. The store is in the folder STORE. What finds no room there is read again, as `leadscrew agent` does
//! it. It ends at the end of its input.

use std::error::Error;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use leadscrew_agent::archive::{Archive, Folder, Origin};
use leadscrew_agent::model::{Entry, Met, Ran};
use leadscrew_agent::record::{Cut, Figure, Measured, State, What};
use leadscrew_agent::sender::{Broker, Shared, now, send};
use leadscrew_agent::sparkplug::Names;
use leadscrew_agent::store::Readers;
use leadscrew_agent::{Keeper, Moment, Observation, Store};
use leadscrew_core::link::{
    Certificate, CutTally, Tally, ThreadCertificate, ThreadKind, ThreadRecord, ThreadState, VERSION,
};
use leadscrew_core::units::Length;

/// Certificates that a board keeps.
const KEPT: u32 = 5;
const TICK_US: u32 = 1000;
/// Between two looks at the machines: so many an agent has in a second.
const LOOK: Duration = Duration::from_millis(50);
/// Bytes of records that a store keeps.
const LIMIT: u64 = 64 << 20;

/// A machine that works by the clock.
struct Machine {
    keeper: Keeper,
    begin: u64,
    period: u64,
    threads: u32,
    states: u32,
    serial: u32,
    /// What was read of it last by this process.
    read: Option<u32>,
}

impl Machine {
    fn cut(&self, at: Moment) -> u32 {
        let cut = at.0.saturating_sub(self.begin) / self.period;
        u32::try_from(cut).unwrap_or(u32::MAX).min(self.threads)
    }

    fn tick(&self, number: u32) -> u64 {
        u64::from(number) * self.period
    }

    fn meet(&mut self, at: Moment, shared: &Shared) -> Result<(), Box<dyn Error>> {
        let cut = self.cut(at);
        let last = self.keeper.model().memory().last_event;
        let met = Met {
            serial: self.serial,
            start: 1,
            firmware: "0.1.0".to_owned(),
            parameters: 1,
            tick: self.tick(cut),
            tick_us: TICK_US,
            newest_event: cut,
            newest_thread: cut,
            last_event: (last > 0).then(|| self.tick(last)),
        };
        shared.take(&self.keeper.take(at, &Observation::Met(met))?);
        Ok(())
    }

    fn look(&mut self, at: Moment, shared: &Shared) -> Result<(), Box<dyn Error>> {
        let cut = self.cut(at);
        if self.read == Some(cut) {
            return Ok(());
        }
        let last = self.keeper.model().memory().last_event;
        for line in 1..=self.states {
            let state = State {
                state: "run".to_owned(),
                mode: "automatic".to_owned(),
                program: 1,
                line: cut * self.states + line,
                ..State::default()
            };
            let seen = Observation::State(state, self.tick(cut));
            shared.take(&self.keeper.take(at, &seen)?);
        }
        let log = (last + 1..=cut).map(|number| Entry {
            number,
            tick: self.tick(number),
            what: Some(What::Held),
        });
        let log = Observation::Log(log.collect());
        shared.take(&self.keeper.take(at, &log)?);
        let threads = (1..=cut).rev().take(KEPT as usize);
        let threads = Observation::Certificates(RAN, threads.map(certificate).collect());
        shared.take(&self.keeper.take(at, &threads)?);
        self.read = Some(cut);
        Ok(())
    }
}

const RAN: Ran = Ran {
    certificate: RUN,
    under_way: true,
};

const RUN: Certificate = Certificate {
    version: VERSION,
    program: 1,
    ticks: 0,
    setpoint_hash: None,
    measured: 0,
    largest: Length::ZERO,
    squares: 0,
    late: 0,
};

fn certificate(number: u32) -> (ThreadCertificate, Cut) {
    let record = ThreadRecord {
        line: number,
        kind: ThreadKind::Thread,
        state: ThreadState::Finished,
        tally: Tally {
            largest: Length::from_nm(number.into()),
            measured: 1000,
            ..Tally::NONE
        },
        cut: CutTally::NONE,
    };
    let figure = Figure(i64::from(number), 500);
    let cut = Measured {
        axis: 'Z',
        age_known: true,
        positions: 60,
        passes: 3,
        lead_nm: 1_500_000,
        grooves: Some([figure, figure]),
        apart: Some(figure),
        slope: Some(figure),
        worst: figure,
        complete: true,
        why: String::new(),
    };
    (ThreadCertificate { number, record }, Cut::Measured(cut))
}

/// What went wrong, which is tried again.
fn tell(name: &str, error: &dyn Error) {
    eprintln!("{name}: {error}");
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [
        broker,
        folder,
        name,
        machines,
        begin,
        period,
        threads,
        states,
        kept,
    ] = args.as_slice()
    else {
        return Err(
            "usage: many BROKER FOLDER NAME MACHINES BEGIN PERIOD THREADS STATES STORE".into(),
        );
    };
    let machines: Vec<String> = (0..machines.parse()?)
        .map(|number: u32| format!("{name}-{number}"))
        .collect();
    let folder = Path::new(folder);
    let store = Store::open(&Path::new(kept).join(format!("{name}.redb")), LIMIT, now())?;
    let store = Arc::new(store);
    store.serve(Readers {
        broker: true,
        archive: true,
    });
    let shared = Arc::new(Shared::default());
    let broker = Broker {
        address: broker.parse()?,
        login: None,
        tls: None,
        names: Names::new("shop", name, machines.iter().map(String::as_str))?,
        primary: None,
    };
    let sender = {
        let (store, shared) = (Arc::clone(&store), Arc::clone(&shared));
        thread::spawn(move || send(&broker, &store, &shared, |_| ()))
    };
    let over = Arc::new(AtomicBool::new(false));
    let input = Arc::clone(&over);
    thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        input.store(true, Ordering::Relaxed);
    });
    let mut all = Vec::new();
    for (place, machine) in machines.iter().enumerate() {
        let mut machine = Machine {
            keeper: Keeper::new(Arc::clone(&store), machine)?,
            begin: begin.parse()?,
            period: period.parse()?,
            threads: threads.parse()?,
            states: states.parse()?,
            serial: u32::try_from(place)? + 1,
            read: None,
        };
        while let Err(error) = machine.meet(now(), &shared) {
            tell(name, &*error);
            thread::sleep(LOOK);
        }
        all.push(machine);
    }
    let origin = Origin {
        shop: "shop".to_owned(),
        node: name.clone(),
    };
    let archive = Archive::new(origin, Folder::new(folder.join("archive")));
    while !over.load(Ordering::Relaxed) {
        for machine in &mut all {
            if let Err(error) = machine.look(now(), &shared) {
                tell(name, &*error);
            }
        }
        if let Err(error) = archive.attend(&store, now(), false) {
            tell(name, &error);
        }
        thread::sleep(LOOK);
    }
    for machine in &mut all {
        machine.look(now(), &shared)?;
    }
    archive.attend(&store, now(), true)?;
    shared.end();
    sender.join().map_err(|_| "the sender has panicked")?;
    Ok(())
}
