//! For tests: a board that has let a program be sent, and refuses to run it.

use std::time::{Duration, Instant};

use leadscrew_board_sim::plant::Flash;
use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::bus::{BoardCommand, Order};
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::Millis;

use super::bench::{Fate, between, link, machine_of};
use super::{Feed, Inside, Link, Trouble};

/// What another client does at the moment of the order.
type Meanwhile = fn(&mut Link);

fn no_change(_: &mut Link) {}

fn other_table(other: &mut Link) {
    let last = other.offsets_revision().unwrap();
    other.commit_offsets(&Offsets::default(), last).unwrap();
}

fn other_mode(other: &mut Link) {
    other.set_mode(OperatingMode::Manual).unwrap();
}

/// The beginning of a program, whose end has not been sent.
fn send(link: &mut Link, program: u32) {
    let mut feed = Feed::new(program, Revision(0));
    feed.push(&Call {
        span: Span::default(),
        origin: Position::ZERO,
        kind: CallKind::Dwell(Millis::new(1)),
    });
    assert!(feed.send(link).unwrap());
}

fn refused(ran: super::LinkResult) -> Alarm {
    match ran {
        Err(Trouble::Refused { reason, .. }) => reason,
        other => panic!("{other:?}"),
    }
}

/// Another client acts when the first `run` is on its way, behind every question of this side.
fn run_with(inside: &Inside, meanwhile: Meanwhile) -> super::LinkResult {
    let mut acts = Some(meanwhile);
    let behind = inside.clone();
    let fate = move |frame: &leadscrew_core::bus::Frame| {
        let command = BoardCommand::decode(frame);
        if command.is_some_and(|(_, told)| told.order == Some(Order::Run))
            && let Some(act) = acts.take()
        {
            act(&mut link(&behind));
        }
        Fate::Arrives
    };
    let mut link = between(inside, fate, |frame| frame);
    link.hear_status()?;
    link.set_mode(OperatingMode::Automatic)?;
    send(&mut link, 7);
    link.order(Order::Run)
}

/// Nobody knows better than who has changed it what the machine is to do.
#[test]
fn a_mode_that_was_changed_behind_the_check_is_not_changed_back() {
    let inside = machine_of(&Params::sheets(), Flash::erased());
    let mut link = link(&inside);
    link.hear_status().unwrap();
    let modes = [OperatingMode::Automatic, OperatingMode::Wheel].map(Arg::Mode);
    let reason = Alarm::of(Code::WrongMode, &modes);
    link.set_mode(OperatingMode::Automatic).unwrap();
    link.ready_to_run().unwrap();
    link.set_mode(OperatingMode::Wheel).unwrap();
    assert_eq!(refused(link.ready_to_run()), reason);
    send(&mut link, 7);
    assert_eq!(refused(link.order(Order::Run)), reason);
    assert_eq!(link.mode().unwrap(), OperatingMode::Wheel);
    assert!(!link.status().unwrap().in_program);
    link.set_mode(OperatingMode::Mdi).unwrap();
    link.ready_to_run().unwrap();
}

#[test]
fn what_the_board_refuses_to_run_ends_at_once_with_the_reason_and_is_dropped() {
    let table = [0, 1].map(Arg::Int);
    let modes = [OperatingMode::Automatic, OperatingMode::Manual].map(Arg::Mode);
    let cases: [(i64, Meanwhile, Alarm); 3] = [
        (
            0,
            other_table,
            Alarm::of(Code::OffsetsOtherRevision, &table),
        ),
        (0, other_mode, Alarm::of(Code::WrongMode, &modes)),
        (
            1,
            no_change,
            Alarm::of(Code::NotReferenced, &[Arg::Letter(b'X')]),
        ),
    ];
    for (method, meanwhile, reason) in cases {
        let mut params = Params::sheets();
        let key = Entry::find_text("9050.X").unwrap();
        params.set(key, method).unwrap();
        let inside = machine_of(&params, Flash::erased());
        assert_eq!(refused(run_with(&inside, meanwhile)), reason);
        // Nothing is there that a later order could begin.
        let mut link = link(&inside);
        link.set_mode(OperatingMode::Automatic).unwrap();
        let begun = Instant::now();
        link.order(Order::Run).ok();
        while begun.elapsed() < Duration::from_millis(20) {
            link.idle(Duration::from_millis(5)).unwrap();
        }
        let status = link.status().unwrap();
        assert!(!status.in_program, "{reason:?}");
        let room = leadscrew_core::board::device::PROGRAM_BYTES;
        assert_eq!(status.credit, room as u16, "{reason:?}");
    }
}
