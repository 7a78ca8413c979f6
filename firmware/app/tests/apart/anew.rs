//! The application begins anew: the ticker is handed over and comes back.

use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Event, State};
use leadscrew_core::bus::{
    CobId, Frame, NodeId, Order, Service, SyncConsumer, SyncHeard, SyncProducer,
};
use leadscrew_core::params::Params;

use crate::board::{Apart, alarm, calls, follower};
use crate::setpoints::{sim, whole};

#[test]
fn a_set_that_names_other_nodes_is_followed_from_its_restart_on() {
    let mut apart = Apart::new(&Params::slant_bed());
    // 2000h + 9015, X: a byte.
    let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
    let request = Frame::new(request, &[0x2F, 0x37, 0x43, 1, 50, 0, 0, 0]);
    apart.bench.others.push_back(request.expect("a frame"));
    // The drive has stayed where it was.
    let deadline = 3000;
    assert_eq!(alarm(&mut apart, deadline), Some(Code::DriveNoAnswer));
    let State::Alarm(alarm) = apart.background.snapshot().state else {
        panic!("it stands on it");
    };
    assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(50)]);
}

#[test]
fn a_restart_of_the_application_hands_the_ticker_over_and_back() {
    let params = Params::slant_bed();
    let mut apart = Apart::new(&params);
    let text = "G0 X60 Z5\nM30\n";
    let first = apart.run(text, &params);
    let syncs = apart.bench.syncs;
    apart.restart();
    apart.step();
    assert_eq!(apart.background.snapshot().state, State::Starting);
    assert_eq!(apart.bench.periods, [params.tick_us()]);
    apart.steps(100);
    assert_eq!(apart.bench.events, [Event::Ready]);
    assert_eq!(apart.bench.syncs - syncs, 101, "no period without a SYNC");
    // It stands where it stood, and goes on from there as if nothing had been.
    let mut sim = sim(&params);
    assert_eq!(whole(&mut sim, text, &params), first);
    for text in [text, "G0 X90 Z30\nM30\n"] {
        assert_eq!(apart.run(text, &params), whole(&mut sim, text, &params));
    }
}

/// Another board may be at work by its beat, which does not end and does not lose count meanwhile.
#[test]
fn a_board_that_is_made_anew_goes_on_giving_the_beat() {
    let params = Params::slant_bed();
    let (mut giver, mut other) = (Apart::new(&params), follower());
    let mut ear = SyncConsumer::new();
    let mut both = |giver: &mut Apart, other: &mut Apart| {
        giver.bench.given = None;
        giver.tick.tick(&mut giver.bench);
        let mut heard = SyncHeard::NONE;
        if let Some(beat) = giver.bench.given.and_then(|sync| ear.receive(&sync)) {
            heard.note(beat);
        }
        other.bench.beat = Some((SyncProducer::new(), heard));
        other.step();
    };
    while !other.bench.events.contains(&Event::Ready) {
        both(&mut giver, &mut other);
        giver.rest();
    }
    for call in &calls("M3 S600\nG0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n", &params) {
        assert!(other.background.offer(call));
        other.rest();
    }
    for round in 0..3 {
        for _ in 0..100 {
            both(&mut giver, &mut other);
            giver.rest();
        }
        giver.restart();
        // Its background takes its time.
        for _ in 0..10 * round {
            both(&mut giver, &mut other);
        }
        for _ in 0..100 {
            both(&mut giver, &mut other);
            giver.rest();
        }
        assert_eq!(giver.bench.events, [Event::Ready]);
        let snapshot = other.background.snapshot();
        assert_eq!(snapshot.state, State::Running);
        assert_eq!(snapshot.sync_late, 0);
    }
}

/// Begun anew, the machine knows of no feed hold; a contact that is still pressed holds it again.
#[test]
fn a_feed_hold_that_stays_pressed_outlives_a_restart_of_the_application() {
    let mut apart = Apart::new(&Params::slant_bed());
    for pressed in [true, false] {
        apart.bench.inputs.hold = true;
        apart.step();
        apart.step();
        assert!(apart.background.snapshot().operator.hold);
        apart.bench.inputs.hold = pressed;
        apart.step();
        apart.restart();
        apart.steps(100);
        assert_eq!(apart.bench.events, [Event::Ready]);
        assert_eq!(apart.background.snapshot().operator.hold, pressed);
        apart.order(Order::Resume);
        apart.bench.inputs.hold = false;
        apart.steps(4);
        assert!(!apart.background.snapshot().operator.hold);
    }
}
