//! The application begins anew: the ticker is handed over and comes back.

use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Event, State};
use leadscrew_core::bus::{CobId, Frame, NodeId, Order, Service, SyncProducer};
use leadscrew_core::params::Params;

use crate::board::{Apart, alarm};
use crate::setpoints::{sim, whole};

#[test]
fn a_set_that_names_other_nodes_is_followed_from_its_restart_on() {
    let mut apart = Apart::new(&Params::sheets());
    // 2000h + 9015, X: a byte.
    let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
    let request = Frame::new(request, &[0x2F, 0x37, 0x43, 1, 50, 0, 0, 0]);
    apart.bench.others.push_back(request.expect("a frame"));
    // The drive is still on its old node.
    let deadline = 3000;
    assert_eq!(alarm(&mut apart, deadline), Some(Code::DriveNoAnswer));
    let State::Alarm(alarm) = apart.snapshot().state else {
        panic!("it stands on it");
    };
    assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(50)]);
}

#[test]
fn a_restart_of_the_application_hands_the_ticker_over_and_back() {
    let params = Params::sheets();
    let mut apart = Apart::new(&params);
    let text = "G0 X60 Z5\nM30\n";
    let first = apart.run(text, &params);
    // The drives stand one period later than the setpoints.
    apart.step();
    let syncs = apart.bench.syncs;
    apart.restart();
    apart.step();
    assert_eq!(apart.snapshot().state, State::Starting);
    assert_eq!(apart.bench.periods, [params.tick_us()]);
    apart.steps(100);
    assert_eq!(apart.bench.events, [Event::Ready]);
    assert_eq!(apart.bench.syncs - syncs, 101, "no period without a SYNC");
    // The machine stands where it stood, and goes on from there.
    let mut sim = sim(&params);
    assert_eq!(whole(&mut sim, text, &params), first);
    for text in [text, "G0 X90 Z30\nM30\n"] {
        assert_eq!(apart.run(text, &params), whole(&mut sim, text, &params));
    }
}

/// Drives that watch SYNC see no gap in its counter.
#[test]
fn a_board_that_is_made_anew_goes_on_counting_its_syncs() {
    let mut apart = Apart::new(&Params::sheets());
    let count = |apart: &Apart| apart.bench.given.expect("a SYNC").payload()[0];
    let mut before = count(&apart);
    let mut tick = |apart: &mut Apart| {
        apart.bench.given = None;
        apart.tick();
        let now = count(apart);
        assert_eq!(now, before % SyncProducer::LAST + 1);
        before = now;
    };
    for round in 0..3 {
        apart.restart();
        // The background is slow.
        for _ in 0..10 * round {
            tick(&mut apart);
        }
        for _ in 0..100 {
            tick(&mut apart);
            apart.rest();
        }
        assert_eq!(apart.bench.events, [Event::Ready]);
    }
}

/// After the restart the machine has no feed hold. A contact that is still pressed holds it again.
#[test]
fn a_feed_hold_that_stays_pressed_outlives_a_restart_of_the_application() {
    let mut apart = Apart::new(&Params::sheets());
    for pressed in [true, false] {
        apart.bench.inputs.hold = true;
        apart.step();
        apart.step();
        assert!(apart.snapshot().operator.hold);
        apart.bench.inputs.hold = pressed;
        apart.step();
        apart.restart();
        apart.steps(100);
        assert_eq!(apart.bench.events, [Event::Ready]);
        assert_eq!(apart.snapshot().operator.hold, pressed);
        apart.order(Order::Resume);
        apart.bench.inputs.hold = false;
        apart.steps(4);
        assert!(!apart.snapshot().operator.hold);
    }
}
