//! The operator's actions, by contacts and by orders.

use std::collections::VecDeque;

use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Event, Inputs, State};
use leadscrew_core::bus::Order;
use leadscrew_core::call::Call;
use leadscrew_core::link::{ThreadKind, ThreadState};
use leadscrew_core::params::Params;

use crate::board::{Apart, calls};

#[test]
fn the_emergency_stop_stops_by_itself_and_holds_until_it_is_released() {
    let params = Params::sheets();
    let mut apart = Apart::new(&params);
    let text = "G0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n";
    let mut calls: VecDeque<Call> = calls(text, &params).into();
    for _ in 0..200 {
        while calls
            .front()
            .is_some_and(|call| apart.background.offer(call))
        {
            calls.pop_front();
        }
        apart.step();
    }
    assert_eq!(apart.snapshot().state, State::Running);
    apart.bench.inputs.stop = true;
    // The background does nothing meanwhile.
    for _ in 0..2000 {
        apart.tick();
    }
    let stopped = apart.output.setpoint.position;
    apart.rest();
    apart.step();
    let State::Alarm(alarm) = apart.snapshot().state else {
        panic!("{:?}", apart.snapshot().state);
    };
    assert_eq!(alarm.code, Code::EmergencyStop);
    // A reset while the button is still pressed has no effect.
    for pressed in [true, false] {
        apart.bench.inputs.stop = pressed;
        apart.order(Order::Reset);
        apart.steps(1000);
        let up = apart.snapshot().state == State::Idle;
        assert_eq!(up, !pressed);
        assert_eq!(apart.output.setpoint.position, stopped);
    }
}

/// Bits 12 and 14 of 5060h [D164].
#[test]
fn contacts_are_mirrored_while_they_are_pressed_and_while_what_they_did_acts() {
    let mut apart = Apart::new(&Params::sheets());
    let told = |apart: &mut Apart, hold, stop| {
        apart.bench.inputs = Inputs {
            hold,
            stop,
            ..Inputs::default()
        };
        // The background gets the contacts with the report of this tick.
        apart.step();
        apart.bench.sent.clear();
        apart.object(0x5060, 0)
    };
    assert_eq!(told(&mut apart, false, false), 0);
    assert_eq!(told(&mut apart, true, false), 0x1000);
    // Nothing resumes while the contact is pressed, or its wire is broken [D192].
    apart.order(Order::Resume);
    assert_eq!(told(&mut apart, true, false), 0x1000);
    assert!(apart.snapshot().operator.hold);
    assert_eq!(told(&mut apart, false, false), 0x1000);
    apart.order(Order::Resume);
    apart.steps(2);
    assert_eq!(told(&mut apart, false, false), 0);
    // One press holds the program until it is resumed.
    assert_eq!(told(&mut apart, true, false), 0x1000);
    assert_eq!(told(&mut apart, false, false), 0x1000);
    assert!(apart.snapshot().operator.hold);
    // The emergency stop is reported until its alarm is reset.
    assert_eq!(told(&mut apart, false, true), 0x5000);
    assert_eq!(told(&mut apart, false, false), 0x5000);
    apart.order(Order::Reset);
    apart.steps(1000);
    assert_eq!(apart.snapshot().state, State::Idle);
    assert_eq!(told(&mut apart, false, false), 0);
    // After another alarm the stop raises no alarm of its own, but its bit is still set.
    apart.bench.inputs.trouble = Some(Code::NetworkStop);
    apart.steps(1000);
    assert_eq!(told(&mut apart, false, false), 0);
    assert_eq!(told(&mut apart, false, true), 0x4000);
    assert_eq!(told(&mut apart, false, false), 0);
    let alarm = apart.snapshot().alarm().map(|alarm| alarm.code);
    assert_eq!(alarm, Some(Code::NetworkStop));
}

/// Events arrive before the report of their tick: so the last error of a thread arrives after the reset that has ended
/// the thread.
#[test]
fn a_reset_in_a_thread_or_a_tap_leaves_one_record_of_it() {
    let params = Params::sheets();
    let before = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\n";
    let thread = format!("{before}G76 X76 Z-30 P20000 Q15000 F3\nG0 X100 Z50\nM30\n");
    let rigid = "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-50 P30 F2000\nG80\nM30\n";
    let ordinary = "G98\nG0 X50 Z0\nM3 S300\nG84 Z-20 P30 F300\nG80\nM30\n";
    for (text, line, kind) in [
        (&thread[..], 5, ThreadKind::Thread),
        (rigid, 4, ThreadKind::RigidTap),
        (ordinary, 4, ThreadKind::FloatingTap),
    ] {
        let mut apart = Apart::new(&params);
        let mut waiting: VecDeque<Call> = calls(text, &params).into();
        let (mut ticks, mut over) = (0, false);
        apart.bench.events.clear();
        while !over {
            while waiting
                .front()
                .is_some_and(|call| apart.background.offer(call))
            {
                waiting.pop_front();
                apart.rest();
            }
            apart.step();
            ticks += u32::from(apart.output.setpoint.locked);
            if ticks == 300 {
                ticks += 1;
                waiting.clear();
                apart.order(Order::Reset);
            }
            over = apart.bench.events.contains(&Event::Reset);
        }
        apart.steps(100);
        let first = (1, line, kind, ThreadState::CutShort, 1);
        assert_eq!(apart.threads(), [first]);
        // Another cycle after it.
        let (next, second) = if kind == ThreadKind::RigidTap {
            let way_out = (2, 1, kind, ThreadState::Finished, 1);
            ("G30 P99\nM30\n", way_out)
        } else {
            (
                &thread[..],
                (2, 5, ThreadKind::Thread, ThreadState::Finished, 3),
            )
        };
        if kind == ThreadKind::FloatingTap {
            // First move out of the hole.
            apart.run("G0 Z10\nM30\n", &params);
        }
        apart.run(next, &params);
        apart.step();
        assert_eq!(apart.threads(), [second, first]);
    }
}
