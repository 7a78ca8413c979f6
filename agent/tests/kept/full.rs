//! A disk that is full: the oldest states go, certificates stay, and it is told; with room it goes on as before.

use std::path::PathBuf;

use leadscrew_agent::{Body, Memory, Moment, Record, Store, StoreError};

use crate::bound::{all, state, thread, told};
use crate::disk::Disk;

/// Of the reserve.
const RESERVE: usize = 4 << 20;
const HALF_A_MINUTE: u64 = 30_000;

fn keep(store: &Store, at: u64, bodies: impl IntoIterator<Item = Body>) -> Result<(), StoreError> {
    let record = |body| Record {
        at: Moment(at),
        machine: "lathe".to_owned(),
        body,
    };
    let records: Vec<Record> = bodies.into_iter().map(record).collect();
    store.keep("lathe", &records, &Memory::default()).map(drop)
}

fn beside(name: &str) -> (PathBuf, PathBuf) {
    let name = format!("leadscrew-full-{name}-{}", std::process::id());
    let path = std::env::temp_dir().join(name);
    let mut reserve = path.clone().into_os_string();
    reserve.push(".reserve");
    (path, reserve.into())
}

#[test]
fn the_oldest_states_go_and_certificates_have_the_reserve() {
    let (path, reserve) = beside("goes");
    let disk = Disk::default();
    let store = disk.reserved(&path, u64::MAX).unwrap();
    assert_eq!(std::fs::metadata(&reserve).unwrap().len(), RESERVE as u64);
    keep(&store, 1, [thread(1)]).unwrap();
    // Somebody else has taken all that is left.
    disk.has_room(disk.length() + RESERVE, &reserve);
    let mut line = 0;
    while !store.is_tight() {
        line += 1;
        keep(&store, 1, [state(line)]).unwrap();
    }
    assert!(!reserve.exists());
    let records = store.figures().unwrap().records;
    assert_eq!(records, u64::from(line) + 1, "nothing is lost by then");
    for number in 2..500 {
        keep(&store, 2, [thread(number), state(line + number)]).unwrap();
    }
    let left = told(&all(&store));
    let threads = left.iter().filter(|word| word.starts_with("thread"));
    let expected: Vec<String> = (1..500).map(|number| format!("thread {number}")).collect();
    assert_eq!(threads.cloned().collect::<Vec<_>>(), expected);
    let lost = store.figures().unwrap().lost;
    assert!(lost > 0);
    let losses: Vec<_> = left
        .iter()
        .filter(|word| word.starts_with("lost"))
        .collect();
    assert_eq!(losses.len(), 1, "{losses:?}");
    assert!(
        losses[0].starts_with(&format!("lost {lost} from 2 to ")),
        "{losses:?}"
    );
    // There is room again.
    disk.has_room(usize::MAX, &reserve);
    keep(&store, 1 + HALF_A_MINUTE, [state(1)]).unwrap();
    assert!(store.is_tight() && !reserve.exists());
    keep(&store, 2 + HALF_A_MINUTE, [state(1), state(2)]).unwrap();
    assert!(!store.is_tight() && reserve.exists());
    let before = store.figures().unwrap().lost;
    keep(&store, 3 + HALF_A_MINUTE, (0..100).map(state)).unwrap();
    assert_eq!(store.figures().unwrap().lost, before);
    std::fs::remove_file(&reserve).unwrap();
}

#[test]
fn a_reserve_that_was_given_and_is_used_up_holds_the_reading() {
    let (path, reserve) = beside("held");
    let disk = Disk::default();
    let store = disk.reserved(&path, u64::MAX).unwrap();
    disk.has_room(disk.length() + RESERVE, &reserve);
    let mut number = 0;
    let refused = loop {
        number += 1;
        // A certificate with its words, so that the room ends soon.
        if let Err(refused) = keep(&store, 1, (0..200).map(|_| thread(number))) {
            break refused;
        }
    };
    assert!(matches!(refused, StoreError::File(_)), "{refused:?}");
    assert!(store.is_tight() && !reserve.exists());
    let before = store.figures().unwrap();
    assert_eq!(before.records, 200 * u64::from(number - 1));
    disk.has_room(usize::MAX, &reserve);
    keep(&store, 2, [thread(number)]).unwrap();
    let after = store.figures().unwrap();
    assert_eq!(after.records, before.records + 1);
    assert_eq!(after.newest, before.newest + 1, "no number is skipped");
}
