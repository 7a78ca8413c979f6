//! Several gateways that read from one board at one time.

use std::sync::Barrier;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use leadscrew::link::Link;
use leadscrew_can::BitRate;
use leadscrew_core::bus::NodeId;

use crate::server::{Options, Server};

/// Readings each of them wants.
const WANTED: u32 = 60;
/// A computer that is busy gives one of them no time of its own: then they try again. Who is left behind by the others is
/// so each time.
const TRIES: usize = 3;

/// Each reads as fast as it can; the fewest that any of them had when the first was through.
fn read_at_once(clients: usize, lag: Duration) -> u32 {
    let server = Server::start(&Options {
        speed: 1,
        lag,
        ..Options::default()
    });
    let bus = server.bus();
    let counts: Vec<AtomicU32> = (0..clients).map(|_| AtomicU32::new(0)).collect();
    let together = Barrier::new(clients);
    let fewest = AtomicU32::new(u32::MAX);
    std::thread::scope(|scope| {
        for own in &counts {
            let (bus, counts, together, fewest) = (&bus, &counts, &together, &fewest);
            scope.spawn(move || {
                let mut link =
                    Link::open(&bus.parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap();
                together.wait();
                for read in 1..=WANTED {
                    // One of several frames, and one of one.
                    assert_eq!(link.status().unwrap().program, 0);
                    link.parameters_identity().unwrap();
                    own.store(read, Ordering::Relaxed);
                }
                let read = |count: &AtomicU32| count.load(Ordering::Relaxed);
                let now = counts.iter().map(read).min().unwrap();
                // The first one counts.
                let _ =
                    fewest.compare_exchange(u32::MAX, now, Ordering::Relaxed, Ordering::Relaxed);
            });
        }
    });
    fewest.into_inner()
}

/// Who has had his turn waits for who has not: nobody is left behind [D198].
#[test]
fn who_reads_at_one_time_comes_through_at_one_time() {
    for (clients, lag_ms) in [(2, 0), (3, 0), (2, 3)] {
        let mut tries = (0..TRIES).map(|_| read_at_once(clients, Duration::from_millis(lag_ms)));
        assert!(
            tries.any(|fewest| fewest >= WANTED / 3),
            "{clients} clients, {lag_ms} ms: somebody had less than a third of {WANTED} each time"
        );
    }
}
