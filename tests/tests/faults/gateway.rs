//! A gateway that dies: in a thread, in a tap, in a transfer.

use leadscrew_core::alarm::Arg;
use leadscrew_core::board::{Event, State};
use leadscrew_core::bus::{
    BoardState, Frame, NmtState, NodeId, Object, Order, SdoDownload, SdoProtocol,
};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::{BATCH, NODE, Upload};
use leadscrew_tests::machine::calls;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm};
use leadscrew_tests::params::with;

fn heartbeat() -> Frame {
    NmtState::Operational.frame(NodeId::GATEWAY)
}

/// The gateway lives up to this tick of the program, and not any longer.
fn killed(params: &Params, text: &str, tick: u64) -> Bench {
    let mut bench = Bench::new(params);
    Upload::new(1, &calls(text, params)).feed(&mut bench.gateway, &mut bench.lathe.sim);
    bench.gateway.order(&mut bench.lathe.sim, Order::Run);
    while bench.ticks < tick {
        if bench.ticks.is_multiple_of(100) {
            bench.sim.receive(&heartbeat());
        }
        bench.tick();
    }
    assert_eq!(bench.gateway.emergencies, []);
    bench
}

fn locked(rows: &[leadscrew_board_sim::Row], part: usize) -> u64 {
    let locked: Vec<u64> = rows
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.tick)
        .collect();
    locked[locked.len() * part / 8]
}

#[test]
fn killed_in_a_thread_the_machine_holds_behind_the_stroke_stops_in_it_or_carries_on() {
    let params = |reaction| with(&[("9024", 200), ("9025", reaction)]);
    let rows = calm(&params(0), WORK);
    for part in [0, 1, 3, 6] {
        let tick = locked(&rows, part);
        for reaction in [0, 1, 2] {
            let what = format!("killed at {tick}, reaction {reaction}");
            let params = params(reaction);
            let mut bench = killed(&params, WORK, tick);
            match reaction {
                0 => {
                    bench.until(&what, 2_000, |bench| bench.state() == State::Held);
                    bench.drives_stand(&what, 100);
                    // Where a feed hold ends: the tool is not in the thread, whose crest is at 30.8 mm.
                    assert!(bench.at().x.nm() >= 30_800_000, "{what}: {:?}", bench.at());
                    assert_eq!(bench.alarm, None, "{what}");
                    assert_eq!(bench.gateway.status.state, BoardState::Hold, "{what}");
                    // Another gateway comes and goes on.
                    bench.sim.receive(&heartbeat());
                    bench.gateway.order(&mut bench.lathe.sim, Order::Resume);
                    bench.ticks(100);
                    assert_eq!(bench.gateway.status.state, BoardState::Run, "{what}");
                }
                1 => {
                    let alarm = bench.stops_with(&what, 4330, 250);
                    assert_eq!(alarm.args, [Arg::None; 4]);
                    bench.reset(&what);
                    bench.next(&what);
                }
                _ => {
                    bench.until(&what, 60_000, |bench| {
                        bench.events.contains(&Event::Finished)
                    });
                    bench.ticks(10);
                    assert_eq!(bench.drives(), [35_000_000, 8_000_000], "{what}");
                }
            }
            let [emcy] = bench.gateway.emergencies[..1] else {
                panic!("{what}: no emergency");
            };
            assert_eq!(emcy.code, 0x8130, "{what}");
        }
    }
}

#[test]
fn killed_in_a_tap_nothing_stops_inside_the_hole_but_an_alarm() {
    let params = |reaction| with(&[("9024", 200), ("9025", reaction)]);
    let rows = calm(&params(0), TAP);
    let inside: Vec<u64> = rows
        .iter()
        .filter(|row| row.tap.is_some_and(|tap| tap.depth.nm() > 0))
        .map(|row| row.tick)
        .collect();
    for tick in [inside[0] - 50, inside[inside.len() / 4]] {
        for reaction in [0, 1, 2] {
            let what = format!("killed in a tap at {tick}, reaction {reaction}");
            let mut bench = killed(&params(reaction), TAP, tick);
            if reaction == 1 {
                bench.stops_with(&what, 4330, 250);
                assert!(bench.has_tap_in_hole(), "{what}");
                bench.reset(&what);
                bench.load("G0 X60\nM30\n");
                bench.stops_with(&what, 4310, 200);
                continue;
            }
            bench.until(&what, 5_000, |bench| {
                bench.state() == State::Held || bench.events.contains(&Event::Finished)
            });
            bench.ticks(10);
            assert_eq!(bench.alarm, None, "{what}");
            // Out of the hole, and the journal says so.
            assert!(bench.at().z.nm() >= 0, "{what}: {:?}", bench.at());
            assert!(!bench.has_tap_in_hole(), "{what}");
        }
    }
}

#[test]
fn killed_in_a_transfer_nothing_of_it_counts_and_the_next_gateway_can_work() {
    let params = Params::sheets();
    let upload = Upload::new(1, &calls(WORK, &params));
    let (bytes, _) = upload.batch(u16::MAX).expect("a batch");
    for protocol in [SdoProtocol::Short, SdoProtocol::Block] {
        // After every frame of the transfer but the last.
        for frames in (1..200).step_by(7) {
            let what = format!("killed behind frame {frames} by {protocol:?}");
            let mut bench = Bench::new(&params);
            let now = core::time::Duration::ZERO;
            let patience = core::time::Duration::from_secs(1);
            let mut transfer = SdoDownload::new(NODE, BATCH, &bytes, protocol, patience, now);
            let mut sent = 0;
            while sent < frames && transfer.outcome().is_none() {
                match transfer.poll(now) {
                    Some(frame) => {
                        bench.sim.receive(&frame);
                        sent += 1;
                    }
                    None => {
                        bench.sim.settle();
                        while let Some(frame) = bench.sim.transmit() {
                            transfer.receive(&frame, now);
                        }
                    }
                }
            }
            if sent < frames {
                assert_eq!(transfer.outcome(), Some(Ok(())), "{what}");
                continue;
            }
            bench.gateway.heard.clear();
            bench.ticks(1_100);
            let program = bench.gateway.number(&mut bench.lathe.sim, 0x5020, 4);
            let taken = transfer.outcome() == Some(Ok(())) || program != Ok(0);
            if !taken {
                // The board has given the client up and said so: SDO time-out.
                let abort = [0x80, 0x20, 0x50, 0x01, 0x00, 0x00, 0x04, 0x05];
                let heard = bench.gateway.heard.iter();
                let aborts = heard.filter(|frame| frame.payload() == abort).count();
                assert_eq!(aborts, 1, "{what}");
            }
            let object = Object::new(0x5001, 1);
            assert!(
                bench
                    .gateway
                    .read(&mut bench.lathe.sim, object, SdoProtocol::Block)
                    .is_ok()
            );
            assert_eq!(bench.alarm, None, "{what}");
            bench.gateway.order(&mut bench.lathe.sim, Order::Reset);
            bench.ticks(20);
            Upload::new(2, &calls(WORK, &params)).feed(&mut bench.gateway, &mut bench.lathe.sim);
            bench.gateway.order(&mut bench.lathe.sim, Order::Run);
            bench.ticks(50);
            assert_eq!(bench.gateway.status.state, BoardState::Run, "{what}");
        }
    }
}
