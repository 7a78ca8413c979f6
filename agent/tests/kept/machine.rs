//! A machine that cuts threads, an agent's turn, and a broker that counts what it gets.

use std::collections::BTreeMap;

use leadscrew_agent::model::{Entry, Met, Ran};
use leadscrew_agent::record::{Cut, What};
use leadscrew_agent::{Body, Keeper, Moment, Numbered, Observation, Store, StoreError};
use leadscrew_core::link::{
    Certificate, CutTally, Tally, ThreadCertificate, ThreadKind, ThreadRecord, ThreadState, VERSION,
};
use leadscrew_core::units::Length;

/// Certificates that a board keeps.
const KEPT: u32 = 5;

/// A board that has cut so many threads, each with an entry of its log.
#[derive(Clone, Copy, Debug, Default)]
pub struct Board {
    pub threads: u32,
}

impl Board {
    pub fn cut(&mut self) {
        self.threads += 1;
    }

    /// What an agent sees that reads all, having read up to this entry of the log.
    pub fn seen(self, last_event: u32) -> [Observation; 3] {
        let tick = |number: u32| u64::from(number) * 100;
        let met = Met {
            serial: 0xA5,
            start: 1,
            firmware: "0.1.0".to_owned(),
            parameters: 1,
            tick: tick(self.threads),
            tick_us: 1000,
            newest_event: self.threads,
            newest_thread: self.threads,
            last_event: (last_event > 0).then(|| tick(last_event)),
        };
        let entries = last_event + 1..=self.threads;
        let log = entries.map(|number| Entry {
            number,
            tick: tick(number),
            what: Some(What::Held),
        });
        let numbers = (1..=self.threads).rev().take(KEPT as usize);
        let certificate = |number: u32| ThreadCertificate {
            number,
            record: ThreadRecord {
                line: number,
                kind: ThreadKind::Thread,
                state: ThreadState::Finished,
                tally: Tally {
                    largest: Length::from_nm(number.into()),
                    ..Tally::NONE
                },
                cut: CutTally::NONE,
            },
        };
        let threads = numbers.map(|number| (certificate(number), Cut::Hole));
        let run = Ran {
            certificate: Certificate {
                version: VERSION,
                program: 1,
                ticks: 0,
                setpoint_hash: None,
                measured: 0,
                largest: Length::ZERO,
                squares: 0,
                late: 0,
            },
            under_way: false,
        };
        [
            Observation::Met(met),
            Observation::Log(log.collect()),
            Observation::Certificates(run, threads.collect()),
        ]
    }
}

/// Reads the board once.
pub fn read(keeper: &mut Keeper, board: Board) -> Result<(), StoreError> {
    for seen in board.seen(keeper.model().memory().last_event) {
        keeper.take(Moment(1_000_000 + u64::from(board.threads) * 100), &seen)?;
    }
    Ok(())
}

/// Who gets what is sent.
#[derive(Debug, Default)]
pub struct Broker {
    /// By number.
    records: BTreeMap<u64, Body>,
    newest: u64,
}

impl Broker {
    /// Takes records that it may have had before.
    pub fn take(&mut self, records: &[Numbered]) {
        for record in records {
            let body = record.record.body.clone();
            let before = self.records.insert(record.number, body.clone());
            assert!(
                before.is_none_or(|before| before == body),
                "number {} has two contents",
                record.number
            );
            assert!(record.number <= self.newest + 1, "not in order");
            self.newest = self.newest.max(record.number);
        }
    }

    /// All is there once: each thread and each entry of the log of that board.
    pub fn check(&self, board: Board) {
        let (mut threads, mut events) = (Vec::new(), Vec::new());
        for body in self.records.values() {
            match body {
                Body::Thread(thread) => {
                    assert_eq!(thread.start.count, 1);
                    assert_eq!(thread.errors.largest_nm, i64::from(thread.number));
                    threads.push(thread.number);
                }
                Body::Event(event) => events.push(event.number),
                Body::Identity(_) | Body::Presence(_) => {}
                other => panic!("{other:?}"),
            }
        }
        let all: Vec<u32> = (1..=board.threads).collect();
        assert_eq!(threads, all);
        assert_eq!(events, all);
        let count = self.records.len() as u64;
        assert_eq!(count, self.newest, "no number is missing");
    }
}

/// Hands a few records to the broker, and removes them as it has them.
pub fn send(store: &Store, broker: &mut Broker, sent: &mut u64) -> Result<bool, StoreError> {
    let records = store.hand(*sent, 3)?;
    let Some(last) = records.last() else {
        return Ok(false);
    };
    broker.take(&records);
    *sent = last.number;
    store.acknowledge(last.number)?;
    Ok(true)
}

/// SplitMix64.
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % end
    }
}
