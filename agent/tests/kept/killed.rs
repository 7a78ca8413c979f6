//! Power that fails at every single operation of the disk, one run for each.

use std::sync::Arc;

use leadscrew_agent::{Keeper, StoreError};
use leadscrew_seed::amount;

use crate::disk::Disk;
use crate::machine::{Board, Broker, Random, read, send};

/// Bytes that nothing here reaches.
const ROOM: u64 = 1 << 20;

/// From a start of the agent to its end, or until the disk fails.
fn live(
    disk: &Disk,
    board: &mut Board,
    broker: &mut Broker,
    threads: u32,
) -> Result<(), StoreError> {
    let store = Arc::new(disk.store(ROOM)?);
    store.connect()?;
    let mut keeper = Keeper::new(Arc::clone(&store), "lathe")?;
    let mut sent = 0;
    // What was cut while nobody read is still there.
    read(&mut keeper, *board)?;
    while board.threads < threads {
        board.cut();
        read(&mut keeper, *board)?;
        if board.threads.is_multiple_of(2) {
            send(&store, broker, &mut sent)?;
        }
    }
    while send(&store, broker, &mut sent)? {}
    Ok(())
}

/// Lives again until all is sent; the disk fails behind this many operations of each life but the last.
fn lives(failures: &[u64], chance: &mut Random, threads: u32) -> u64 {
    let disk = Disk::default();
    let (mut board, mut broker) = (Board::default(), Broker::default());
    for failure in failures {
        disk.fail_behind(*failure);
        let ended = live(&disk, &mut board, &mut broker, threads);
        // A failure while it is closed is no error of the agent.
        assert!(ended.is_ok() || disk.has_failed(), "{ended:?}");
        disk.come_back(|| chance.below(2) == 0);
        // A file that was not whole when it was made is made anew.
        if board.threads == 0 && disk.store(ROOM).is_err() {
            disk.clear();
        }
    }
    live(&disk, &mut board, &mut broker, threads).unwrap();
    broker.check(board);
    disk.operations()
}

#[test]
fn a_disk_that_fails_at_any_operation_loses_and_doubles_nothing() {
    leadscrew_seed::only_fresh(|seed| {
        let mut chance = Random(seed);
        let threads = amount(4, 8);
        let all = lives(&[], &mut chance, threads);
        assert!(all > 100, "{all}");
        for operation in 0..all {
            lives(&[operation], &mut chance, threads);
        }
        for _ in 0..amount(40, 150) {
            let failures: Vec<u64> = (0..5).map(|_| chance.below(all)).collect();
            lives(&failures, &mut chance, threads);
        }
    });
}
