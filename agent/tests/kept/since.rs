//! Since when a set is in force outlives the agent.

use std::sync::Arc;

use leadscrew_agent::model::Met;
use leadscrew_agent::{Keeper, Moment, Observation};

use crate::disk::Disk;

fn met(parameters: u32, tick: u64) -> Observation {
    Observation::Met(Met {
        serial: 0xA5,
        start: 1,
        firmware: "0.1.0".to_owned(),
        parameters,
        tick,
        tick_us: 1000,
        newest_event: 0,
        newest_thread: 0,
        last_event: None,
    })
}

#[test]
fn a_restart_of_the_agent_does_not_reset_since() {
    let disk = Disk::default();
    let keeper = || {
        let store = Arc::new(disk.store(1 << 20).unwrap());
        Keeper::new(store, "lathe").unwrap()
    };
    let since = |keeper: &Keeper| {
        let (_, set) = keeper.model().memory().in_force().unwrap();
        (set.since.0, set.after.map(|at| at.0))
    };
    let mut first = keeper();
    first.take(Moment(1_000), &met(1, 1_000)).unwrap();
    let change = Observation::Parameters(2);
    first.take(Moment(3_000), &change).unwrap();
    assert_eq!(since(&first), (3_000, Some(1_000)));
    drop(first);
    let mut second = keeper();
    second.take(Moment(60_000), &met(2, 60_000)).unwrap();
    assert_eq!(since(&second), (3_000, Some(1_000)));
    drop(second);
    let mut third = keeper();
    third.take(Moment(90_000), &met(1, 90_000)).unwrap();
    assert_eq!(since(&third), (90_000, Some(60_000)));
}
