//! A second master on the wire.

use leadscrew_board_sim::line::{Faults, Intruder};
use leadscrew_core::alarm::Arg;
use leadscrew_core::board::{Command, State};
use leadscrew_core::bus::{CobId, FdFrame, Frame, NodeId};
use leadscrew_core::params::Params;

use crate::bench::{AnyBench as _, Bench, WORK, calm, places, span};
use leadscrew_tests::params::with;

fn second(what: Intruder, tick: u64, ticks: u64) -> Faults {
    Faults {
        intruder: Some((what, span(tick, ticks))),
        ..Faults::NONE
    }
}

#[test]
fn another_that_gives_the_beat_stops_the_machine_as_long_as_it_is_there() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("a second SYNC from {tick} on");
        let faults = second(Intruder::Sync, tick, 2_000);
        let mut bench = Bench::at_work(&params, WORK, faults);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.stops_with(&what, 4373, 3);
        // Whoever resets now is told nothing new: the alarm stays.
        bench.sim.command(Command::Reset);
        bench.drives_stand(&what, 500);
        assert!(matches!(bench.state(), State::Alarm(_)), "{what}");
        bench.until(&what, 2_000, |bench| bench.ticks > tick + 2_000);
        bench.reset(&what);
        bench.next(&what);
    }
}

#[test]
fn another_that_moves_a_drive_is_named_with_the_drive() {
    let params = Params::sheets();
    let tick = places(&calm(&params, WORK))[2];
    for (node, letter) in [
        (NodeId::DRIVE_X, b'X'),
        (NodeId::DRIVE_Z, b'Z'),
        (NodeId::DRIVE_C, b'C'),
        (NodeId::SPINDLE_1, b'S'),
    ] {
        let what = format!("setpoints for {}", char::from(letter));
        let mut bench = Bench::at_work(&params, WORK, second(Intruder::Setpoint(node), tick, 1));
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let alarm = bench.stops_with(&what, 4374, 3);
        let number = i64::from(node.get());
        assert_eq!(
            alarm.args[..2],
            [Arg::Letter(letter), Arg::Int(number)],
            "{what}"
        );
        bench.reset(&what);
        bench.next(&what);
    }
}

/// Where all drives get one frame (9031), that one has another sender: in CAN FD,
/// or as a classical frame that reaches X alone.
#[test]
fn another_that_sends_the_frame_for_all_drives_is_told_by_the_first_of_them() {
    let params = with(&[("9031", 1)]);
    let tick = places(&calm(&params, WORK))[2];
    let at = |id| CobId::new(id).expect("an identifier");
    let of_fd = |id| FdFrame::new(at(id), &[0; 24], true).expect("a length");
    for classical in [false, true] {
        for (id, heard) in [(0x481, true), (0x482, false)] {
            let what = format!("{id:03X}h, classical: {classical}");
            let mut bench = Bench::at_work(&params, WORK, Faults::NONE);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            if classical {
                let frame = Frame::new(at(id), &[0; 6]).expect("a length");
                bench.sim.receive(&frame);
            } else {
                bench.sim.receive_fd(&of_fd(id));
            }
            if !heard {
                bench.until(&what, 60_000, Bench::state_is_idle_again);
                assert_eq!(bench.alarm, None, "{what}");
                continue;
            }
            let alarm = bench.stops_with(&what, 4374, 3);
            assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(16)], "{what}");
            bench.reset(&what);
            bench.next(&what);
        }
    }
    // A drive's own setpoints, at another format; and the frame for all where nobody listens to it.
    for (frame, id, heard) in [(1, 0x211, true), (0, 0x211, true), (0, 0x481, false)] {
        let mut bench = Bench::at_work(&with(&[("9031", frame)]), WORK, Faults::NONE);
        bench.until("at work", tick, |bench| bench.ticks == tick);
        bench.sim.receive_fd(&of_fd(id));
        if heard {
            bench.stops_with("of Z", 4374, 3);
        } else {
            bench.until("nobody's", 60_000, Bench::state_is_idle_again);
            assert_eq!(bench.alarm, None);
        }
    }
}

#[test]
fn a_drive_that_is_stopped_by_nmt_is_known_at_once_and_brought_up_again() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("drive Z stopped by NMT at {tick}");
        let faults = second(Intruder::Stop(NodeId::DRIVE_Z), tick, 1);
        let mut bench = Bench::at_work(&params, WORK, faults);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let alarm = bench.stops_with(&what, 4375, 3);
        assert_eq!(alarm.args[..2], [Arg::Letter(b'Z'), Arg::Int(17)], "{what}");
        bench.ticks(50);
        bench.reset(&what);
        bench.next(&what);
    }
}

/// Two machines on a wire: the drives of the other are at the nodes that are built in.
#[test]
fn what_is_said_to_the_drives_of_another_board_is_not_this_ones_affair() {
    let params = with(&[("9015.X", 48), ("9015.Z", 49), ("9015.C", 50), ("9016", 64)]);
    let tick = places(&calm(&params, WORK))[2];
    let rows = |faults| {
        let mut bench = Bench::at_work(&params, WORK, faults);
        bench.until("to the end", 60_000, Bench::state_is_idle_again);
        assert_eq!(bench.alarm, None);
        bench.lathe.rows
    };
    let quiet = rows(Faults::NONE);
    for what in [
        Intruder::Setpoint(NodeId::DRIVE_X),
        Intruder::Setpoint(NodeId::SPINDLE_1),
        Intruder::Stop(NodeId::DRIVE_Z),
    ] {
        assert!(rows(second(what, tick, 200)) == quiet, "{what:?}");
    }
    let node = NodeId::new(49).expect("a node");
    let mut bench = Bench::at_work(&params, WORK, second(Intruder::Setpoint(node), tick, 1));
    bench.until("its own", tick, |bench| bench.ticks == tick);
    let alarm = bench.stops_with("its own", 4374, 3);
    assert_eq!(alarm.args[..2], [Arg::Letter(b'Z'), Arg::Int(49)]);
}

/// At rest somebody may mean it, to write to a drive; the drive's own silence tells.
#[test]
fn at_rest_a_stopped_drive_is_only_missed() {
    let faults = second(Intruder::Stop(NodeId::DRIVE_X), 20, 1);
    let mut bench = Bench::at_work(&Params::sheets(), "", faults);
    bench.ticks(20);
    let alarm = bench.stops_with("stopped", 4360, 20);
    assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(16)]);
}
