//! A store that is full: the oldest states go first, certificates never, and what went is told.

use std::sync::Arc;

use leadscrew_agent::record::{Cut, Event, Start, State, Thread, What};
use leadscrew_agent::{Body, Keeper, Memory, Moment, Numbered, Record, Store, StoreError};
use leadscrew_core::link::{
    CutTally, Tally, ThreadCertificate, ThreadKind, ThreadRecord, ThreadState,
};

use crate::disk::Disk;
use crate::machine::{Board, read};

const AT: Moment = Moment(5);
/// What the store leaves free for the record of a loss.
const LOSS: u64 = 256;

pub fn state(line: u32) -> Body {
    Body::State(State {
        line,
        ..State::default()
    })
}

fn event(number: u32) -> Body {
    Body::Event(Event {
        start: Start::default(),
        number,
        tick: 0,
        what: What::Held,
    })
}

pub fn thread(number: u32) -> Body {
    let record = ThreadRecord {
        line: 1,
        kind: ThreadKind::Thread,
        state: ThreadState::Finished,
        tally: Tally::NONE,
        cut: CutTally::NONE,
    };
    let certificate = ThreadCertificate { number, record };
    Body::Thread(Thread::of(Start::default(), 1, &certificate, Cut::Hole))
}

fn keep(store: &Store, bodies: impl IntoIterator<Item = Body>) {
    let record = |body| Record {
        at: AT,
        machine: "lathe".to_owned(),
        body,
    };
    let records: Vec<Record> = bodies.into_iter().map(record).collect();
    store.keep("lathe", &records, &Memory::default()).unwrap();
}

pub fn all(store: &Store) -> Vec<Numbered> {
    store.hand(0, 10_000).unwrap()
}

fn size(body: &Body) -> u64 {
    let store = Disk::default().store(u64::MAX).unwrap();
    keep(&store, [body.clone()]);
    store.figures().unwrap().bytes
}

/// Words for what is there, with numbers.
pub fn told(records: &[Numbered]) -> Vec<String> {
    let word = |record: &Numbered| match &record.record.body {
        Body::State(state) => format!("state {}", state.line),
        Body::Event(event) => format!("event {}", event.number),
        Body::Thread(thread) => format!("thread {}", thread.number),
        Body::Loss(loss) => format!("lost {} from {} to {}", loss.records, loss.first, loss.last),
        other => format!("{other:?}"),
    };
    records.iter().map(word).collect()
}

#[test]
fn the_oldest_states_go_then_events_and_certificates_stay() {
    let room = 4 * size(&state(1)) + size(&event(1)) + size(&thread(1)) + LOSS;
    let store = Disk::default().store(room).unwrap();
    keep(&store, [event(1), state(1), thread(1), state(2), state(3)]);
    assert_eq!(store.figures().unwrap().lost, 0);
    keep(&store, [state(4), state(5)]);
    assert_eq!(
        told(&all(&store)),
        [
            "event 1",
            "thread 1",
            "state 2",
            "state 3",
            "state 4",
            "state 5",
            "lost 1 from 2 to 2"
        ]
    );
    store.connect().unwrap();
    // Certificates alone are more than there is room for.
    keep(&store, (2..20).map(thread));
    let left = told(&all(&store));
    assert_eq!(left.len(), 20, "{left:?}");
    assert!(
        left.iter()
            .all(|word| word.starts_with("thread") || word == "lost 6 from 1 to 8"),
        "{left:?}"
    );
}

#[test]
fn a_loss_is_widened_until_it_was_handed_on() {
    let store = Disk::default().store(1).unwrap();
    // Nothing but certificates has room.
    keep(&store, [thread(1), state(1), event(1)]);
    keep(&store, [state(2)]);
    let handed = all(&store);
    assert_eq!(told(&handed), ["thread 1", "lost 3 from 2 to 5"]);
    // What may have arrived with one count keeps it.
    keep(&store, [state(3), thread(2)]);
    let later = told(&all(&store));
    assert_eq!(
        later,
        [
            "thread 1",
            "lost 3 from 2 to 5",
            "thread 2",
            "lost 1 from 7 to 7"
        ]
    );
    store.acknowledge(handed[1].number).unwrap();
    assert_eq!(told(&all(&store)), ["thread 2", "lost 1 from 7 to 7"]);
    assert_eq!(store.figures().unwrap().lost, 4);
}

#[test]
fn what_a_broker_was_handed_stays_until_it_answers_or_goes() {
    let store = Disk::default().store(3 * size(&state(1)) + LOSS).unwrap();
    keep(&store, [state(1), state(2)]);
    assert_eq!(told(&all(&store)), ["state 1", "state 2"]);
    keep(&store, [state(3), state(4)]);
    let now = told(&all(&store));
    assert_eq!(now[..2], ["state 1", "state 2"].map(str::to_owned));
    assert!(now.iter().any(|word| word.starts_with("lost")), "{now:?}");
    store.connect().unwrap();
    keep(&store, [state(5)]);
    let now = told(&all(&store));
    assert!(!now.contains(&"state 1".to_owned()), "{now:?}");
}

#[test]
fn a_full_disk_holds_the_reading_and_nothing_is_skipped() {
    let disk = Disk::default();
    let store = Arc::new(disk.store(1 << 20).unwrap());
    let mut keeper = Keeper::new(Arc::clone(&store), "lathe").unwrap();
    let mut board = Board::default();
    board.cut();
    read(&mut keeper, board).unwrap();
    disk.fail_behind(0);
    board.cut();
    read(&mut keeper, board).unwrap_err();
    board.cut();
    read(&mut keeper, board).unwrap_err();
    disk.come_back(|| false);
    read(&mut keeper, board).unwrap();
    let threads = told(&all(&store));
    let threads: Vec<_> = threads
        .iter()
        .filter(|word| word.starts_with("thread"))
        .collect();
    assert_eq!(threads, ["thread 1", "thread 2", "thread 3"]);
}

#[test]
fn numbers_go_on_behind_what_was_removed() {
    let disk = Disk::default();
    let made = {
        let store = disk.store(1 << 20).unwrap();
        keep(&store, [state(1), thread(1)]);
        store.acknowledge(2).unwrap();
        assert_eq!(store.figures().unwrap().bytes, 0);
        store.figures().unwrap().made
    };
    let store = disk.store(1 << 20).unwrap();
    keep(&store, [state(2)]);
    let figures = store.figures().unwrap();
    assert_eq!(
        (figures.newest, figures.records, figures.made),
        (3, 1, made)
    );
    assert_eq!(all(&store)[0].number, 3);
}

#[test]
fn a_store_that_was_killed_while_it_was_made_is_made_anew() {
    let folder = std::env::temp_dir().join(format!("leadscrew-agent-made-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("store");
    std::fs::write(folder.join("store.new"), [0; 100]).unwrap();
    let store = Store::open(&path, 1 << 20, AT).unwrap();
    keep(&store, [thread(1)]);
    // One process at a time.
    let second = Store::open(&path, 1 << 20, AT);
    assert!(matches!(second, Err(StoreError::InUse)), "{second:?}");
    drop(store);
    let store = Store::open(&path, 1 << 20, Moment(9)).unwrap();
    assert_eq!(told(&all(&store)), ["thread 1"]);
    assert_eq!(store.figures().unwrap().made, AT);
    drop(store);
    std::fs::remove_dir_all(&folder).unwrap();
}
