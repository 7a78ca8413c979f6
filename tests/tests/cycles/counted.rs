//! Grooves counted instead of walked: the same figures, and no more steps for more infeeds and columns.

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_core::alarm::Alarm;
use leadscrew_core::call::*;
use leadscrew_core::cycle;
use leadscrew_core::cycle::*;
use leadscrew_core::moves::*;
use leadscrew_core::params::{Entry, Params, Part};
use leadscrew_core::units::*;

use leadscrew_tests::random::Random;

use crate::build::*;
use crate::random::{cycles, groove};

/// A move as a check sees it: a feed, its way along X and along Z.
type Way = (bool, i64, i64);

/// What the moves one after the other give.
struct Walked {
    ways: BTreeMap<Way, u64>,
    time: Duration,
    limits: Result<(), Alarm>,
}

fn way(from: &Position, step: &Move) -> Way {
    let feed = matches!(step.kind, MoveKind::Feed(_));
    let (x, z) = (step.to.x - from.x, step.to.z - from.z);
    (feed, x.nm(), z.nm())
}

fn walk(groove: GrooveMoves, from: Position, params: &Params) -> Walked {
    let mut walked = Walked {
        ways: BTreeMap::new(),
        time: Duration::ZERO,
        limits: Ok(()),
    };
    let mut at = from;
    for step in groove {
        *walked.ways.entry(way(&at, &step)).or_default() += 1;
        let one = Moves::One(Some(step));
        walked.time += cycle::time(&one, at, params).unwrap();
        walked.limits = walked
            .limits
            .and_then(|()| cycle::within_limits(&one, at, params));
        at = step.to;
    }
    walked
}

/// The ways of a tally, and how many steps it took.
fn counted(groove: &GrooveMoves) -> (BTreeMap<Way, u64>, usize) {
    let (mut ways, mut steps) = (BTreeMap::new(), 0);
    let all = groove.tally(&mut |from, step, times| {
        *ways.entry(way(from, step)).or_default() += times;
        steps += 1;
        Ok(())
    });
    assert_eq!(all, Ok(()));
    (ways, steps)
}

/// Limits of travel around a groove, or in it, or beside it.
fn narrow(r: &mut Random, call: &GrooveCall, params: &mut Params) {
    let mut set = |no, axis, value| {
        let entry = Entry::find(no, Some(Part::Axis(axis))).unwrap();
        // The table has a range of its own.
        let _ = params.set(entry, value);
    };
    let margin = |r: &mut Random| match r.within(0, 5) {
        0 => 0,
        1 | 2 => r.within(-20_000_000, 0),
        _ => r.within(0, 200_000_000),
    };
    for (axis, a, b) in [
        (Axis::X, call.start.x, call.end_x.value),
        (Axis::Z, call.start.z, call.end_z.value),
    ] {
        set(1320, axis, a.max(b).nm() + margin(r));
        set(1321, axis, a.min(b).nm() - margin(r));
    }
}

#[test]
fn a_groove_counted_is_the_groove_walked() {
    leadscrew_seed::volume(751, counted_is_walked);
}

fn counted_is_walked(seed: u64) {
    let mut r = Random(seed);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..cycles() / 5 {
        let call = groove(&mut r);
        let groove = GrooveMoves::new(&call, place(1)).unwrap();
        let mut params = Params::sheets();
        narrow(&mut r, &call, &mut params);
        let walked = walk(groove, call.start, &params);
        assert_eq!(counted(&groove).0, walked.ways, "{call:?}");
        let moves = Moves::Groove(groove);
        let time = cycle::time(&moves, call.start, &params).unwrap();
        assert_eq!(time, walked.time, "{call:?}");
        let limits = cycle::within_limits(&moves, call.start, &params);
        assert_eq!(limits, walked.limits, "{call:?}");
        match limits {
            Ok(()) => inside += 1,
            Err(_) => outside += 1,
        }
        let columns = groove.filter_map(|step| step.tag).map(|tag| tag.pass).max();
        assert_eq!(columns.map(u64::from), Some(groove.totals().columns));
    }
    assert!(
        inside > cycles() / 50 && outside > cycles() / 50,
        "{inside} {outside}"
    );
}

#[test]
fn more_infeeds_and_columns_are_no_more_steps() {
    // 42.5 mm deep and 26 mm wide: infeeds and columns, and the steps that a check takes.
    let steps = |peck, step, retract| {
        let call = GrooveCall {
            peck: Some(at(mm(peck))),
            step: Some(at(mm(step))),
            retract: at(mm(retract)),
            ..o0008()
        };
        let groove = GrooveMoves::new(&call, place(1)).unwrap();
        let GrooveCount { infeeds, columns } = groove.totals();
        let (ways, steps) = counted(&groove);
        (infeeds, columns, ways.values().sum::<u64>(), steps)
    };
    // First infeed and retract, the alike ones, the last infeed; level; two kinds of shift; return.
    assert_eq!(steps(3.0, 3.0, 0.5), (15, 10, 310, 9));
    assert_eq!(steps(0.3, 0.3, 0.2), (142, 88, 25_080, 9));
    assert_eq!(steps(0.1, 0.12, 0.05), (425, 218, 185_518, 9));
    // Retracts that end at the start level are as long as what is cut: ten of them at most.
    assert_eq!(steps(0.1, 0.12, 1.0), (425, 218, 185_518, 27));
}

#[test]
fn a_groove_without_bound_is_refused() {
    let refused = |peck, step, retract| {
        let call = GrooveCall {
            peck: Some(word(mm(peck), 15)),
            step: Some(word(mm(step), 20)),
            retract: at(mm(retract)),
            ..o0008()
        };
        match GrooveMoves::new(&call, place(9)) {
            Ok(groove) => (0, groove.totals().infeeds as u16, 0),
            Err(alarm) => {
                let letter = alarm.word.unwrap_or_default();
                (alarm.number(), alarm.span.column, letter)
            }
        }
    };
    // P6 Q2 and P60 Q20 in increments of 0.1 µm and of 1 µm.
    for (peck, step) in [(0.000_3, 0.000_2), (0.003, 0.002), (0.03, 0.02)] {
        assert_eq!(refused(peck, step, 0.5), (4112, 15, b'P'), "{peck}");
    }
    assert_eq!(refused(3.0, 0.002, 0.5), (4112, 20, b'Q'));
    // 42.5 mm of 0.5 µm are 85 000 infeeds: one column of them is allowed, two are not.
    assert_eq!(refused(0.000_5, 26.0, 0.0), (4112, 15, b'P'));
    let one = GrooveCall {
        end_z: at(o0008().start.z),
        peck: Some(at(mm(0.000_5))),
        retract: at(mm(0.005)),
        ..o0008()
    };
    assert_eq!(
        GrooveMoves::new(&one, place(9)).unwrap().totals().infeeds,
        85_000
    );
    // A retract of ten infeeds, and one of more; where there is one infeed, none comes.
    assert_eq!(refused(0.1, 3.0, 1.0), (0, 425, 0));
    assert_eq!(refused(0.1, 3.0, 1.000_1), (4113, 15, b'P'));
    assert_eq!(refused(42.5, 3.0, 1000.0), (0, 1, 0));
}
