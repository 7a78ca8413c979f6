//! Random cycles: equal to the reference, closed, inside their box, the same when mirrored, moved or
//! scaled.

use leadscrew_core::alarm::{Alarm, Arg};
use leadscrew_core::call::*;
use leadscrew_core::cycle::*;
use leadscrew_core::moves::*;
use leadscrew_core::units::*;

use leadscrew_tests::random::Random;

use crate::build::*;
use crate::reference;

/// Cycles per test; the full volume is the number that the project promises.
pub fn cycles() -> u32 {
    leadscrew_seed::amount(3_000, 100_000)
}

fn len(nm: i64) -> Length {
    Length::from_nm(nm)
}

/// A thread that mostly can be cut and sometimes cannot.
fn thread(r: &mut Random) -> ThreadCall {
    let lsb = r.of(&[100, 1000, 254, 2540]);
    let (s, sigma) = (r.sign(), r.sign());
    let k = r.length(200, 6000, lsb).max(lsb);
    let first = (r.within(2, 120) * k / 100 / lsb * lsb).max(lsb);
    let allowance = if r.chance(30) {
        0
    } else {
        r.within(0, 30) * k / 100 / lsb * lsb
    };
    // A parameter's Δdmin is metric in an inch program too: off the grid.
    let min_step = if r.chance(20) {
        0
    } else {
        r.length(1, 200, 100)
    };
    let w = sigma * r.length(2000, 150_000, lsb).max(lsb);
    let i = match r.within(0, 9) {
        0..=4 => 0,
        5..=7 => r.sign() * r.within(0, w.abs() * 3 / 10) / lsb * lsb,
        _ => r.sign() * r.within(w.abs(), w.abs() * 3) / lsb * lsb,
    };
    let x_d = r.within(-100_000_000, 100_000_000) / 50 * 50;
    let clearance = match r.within(0, 19) {
        0 => 0,
        1 => -r.within(1, k),
        _ => r.within(0, 20_000_000),
    };
    let x_a = x_d + s * (k + (s * i).max(0) + clearance / 50 * 50);
    let z_a = r.within(-500_000_000, 500_000_000) / lsb * lsb;
    let g78 = r.chance(60);
    let cut_in = if g78 {
        r.of(&[
            CutIn::Centre,
            CutIn::Left,
            CutIn::Right,
            CutIn::RightCentre,
            CutIn::LeftRight,
        ])
    } else {
        CutIn::Trailing
    };
    let run_in = if g78 && r.chance(40) {
        r.length(1, 15_000, lsb).max(lsb)
    } else {
        0
    };
    let run_out = r.chance(60).then(|| RunOut {
        short: at(len(r.length(50, 6000, lsb).max(lsb))),
        long: at(len(r.length(50, 6000, lsb).max(lsb))),
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    });
    let lead = if r.chance(70) {
        Lead::new(r.within(1000, 120_000) * 100, 1)
    } else {
        Lead::new(254_000_000_000, r.within(20_000, 400_000))
    };
    ThreadCall {
        cycle: if g78 {
            ThreadCycle::G78
        } else {
            ThreadCycle::G76
        },
        start: Position {
            x: len(x_a),
            z: len(z_a),
            c: Angle::ZERO,
        },
        end_x: at(len(x_d)),
        end_z: at(len(z_a + w)),
        taper: at(len(i)),
        height: at(len(k)),
        first_depth: at(len(first)),
        min_step: at(len(min_step)),
        allowance: at(len(allowance)),
        finish_passes: at(r.within(0, 3) as u8),
        angle: at(if r.chance(20) {
            r.of(&[0, 90, 99])
        } else {
            r.within(0, 99) as u8
        }),
        infeed: if g78 && r.chance(40) {
            Infeed::Equal
        } else {
            Infeed::Decreasing
        },
        cut_in: at(cut_in),
        starts: at(if r.chance(70) {
            1
        } else {
            r.within(2, 6) as u8
        }),
        run_in: at(len(run_in)),
        run_out,
        lead: at(lead.unwrap()),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::from_mdeg(if r.chance(60) {
            0
        } else {
            r.within(0, 359_999) as u32
        }),
        part: ChainPart::Whole,
        increment: len(lsb),
        rpm: Rpm::new(500),
    }
}

fn expand_thread(call: &ThreadCall) -> Result<Vec<Move>, Alarm> {
    Ok(ThreadMoves::new(call, place(1))?.collect())
}

/// Exact helix angle after `distance`, by plain division.
fn helix(lead: Lead, distance: i64, start: StartAngle) -> u32 {
    let (nm, turns) = (i128::from(lead.numerator()), i128::from(lead.denominator()));
    let exact = i128::from(distance) * turns % nm * 360_000_000;
    let rounded = (2 * exact + nm) / (2 * nm) + i128::from(start.mdeg()) * 1000;
    (rounded % 360_000_000) as u32
}

fn compare(call: &ThreadCall, got: &[Move], want: &[reference::Expected]) {
    assert_eq!(got.len(), want.len());
    let mut from = call.start;
    let mut begin = call.start;
    for (got, want) in got.iter().zip(want) {
        let tag = got.tag.unwrap();
        assert_eq!(
            (tag.stage, tag.pass, tag.start, tag.depth.nm(), tag.peck),
            (want.stage, want.pass, want.start, want.depth, 0)
        );
        // Rounded to the nearest; the reference itself is good to a hundred-thousandth of a nanometre.
        let x = (got.to.x - call.end_x.value).nm() as f64;
        let z = (got.to.z - call.start.z).nm() as f64;
        assert!((x - want.x).abs() <= 0.50001, "{got:?} {want:?}");
        assert!((z - want.z).abs() <= 0.50001, "{got:?} {want:?}");
        match got.kind {
            MoveKind::Thread(thread) => {
                let q = |p: Position| if thread.long_x { p.x } else { p.z };
                let first = !matches!(tag.stage, Stage::RunOut)
                    && (tag.stage == Stage::RunIn || call.run_in.value == Length::ZERO);
                if first {
                    begin = from;
                }
                let distance = (q(from) - q(begin)).abs().nm();
                let further = start_angle(tag.start - 1, call.starts.value);
                let first = call.first_angle.mdeg();
                let angle = StartAngle::from_mdeg(first + further.mdeg());
                assert_eq!(thread.pass_angle, angle);
                assert_eq!(thread.angle_udeg, helix(call.lead.value, distance, angle));
                let w = (call.end_z.value - call.start.z).abs();
                assert_eq!(thread.long_x, w <= call.taper.value.abs());
                let ends = tag.stage == Stage::RunOut
                    || (call.run_out.is_none() && tag.stage != Stage::RunIn);
                assert_eq!(thread.last, ends);
                assert_eq!((thread.lead, thread.rpm), (call.lead.value, call.rpm));
            }
            MoveKind::Rapid => {
                let rapid = [Stage::Approach, Stage::Retract, Stage::Return];
                assert!(rapid.contains(&tag.stage));
            }
            ref other => panic!("{other:?}"),
        }
        assert_ne!(got.to, from, "a move of no length");
        from = got.to;
    }
    assert_eq!(from, call.start);
}

fn in_box(call: &ThreadCall, moves: &[Move]) {
    let x = [
        call.start.x,
        call.end_x.value,
        call.end_x.value + call.taper.value,
    ];
    let z = [call.start.z, call.end_z.value];
    for m in moves {
        assert!(m.to.x >= *x.iter().min().unwrap() && m.to.x <= *x.iter().max().unwrap());
        assert!(m.to.z >= *z.iter().min().unwrap() && m.to.z <= *z.iter().max().unwrap());
    }
}

fn summary(call: &ThreadCall, moves: &[Move]) {
    let cycle = ThreadMoves::new(call, place(1)).unwrap();
    let summary = cycle.summary();
    assert_eq!(summary.passes, moves.last().unwrap().tag.unwrap().pass);
    let shift = moves
        .iter()
        .filter(|m| m.tag.unwrap().stage == Stage::Approach)
        .map(|m| (m.to.z - call.start.z).abs())
        .max();
    // An approach of no length has no shift.
    assert_eq!(summary.z_shift_max, shift.unwrap_or(Length::ZERO));
    let rough = moves
        .iter()
        .filter(|m| m.tag.unwrap().stage == Stage::Rough);
    assert_eq!(
        summary.rough * u32::from(call.starts.value),
        rough.count() as u32
    );
}

#[test]
fn threads_equal_the_reference() {
    leadscrew_seed::volume(76, |seed| {
        let mut r = Random(seed);
        let (mut done, mut refused) = (0, 0);
        while done < cycles() {
            let call = thread(&mut r);
            match (expand_thread(&call), reference::thread(&call)) {
                (Ok(got), Ok(want)) => {
                    compare(&call, &got, &want);
                    in_box(&call, &got);
                    summary(&call, &got);
                    done += 1;
                }
                (Err(alarm), Err(refusal)) => {
                    assert_eq!(alarm.number(), refusal.number, "{call:?}");
                    if refusal.pass != 0 {
                        assert_eq!(
                            alarm.args[0],
                            Arg::Int(refusal.pass.into()),
                            "{refusal:?} {alarm:?} {call:?}"
                        );
                    }
                    refused += 1;
                }
                // Only rounding may make the difference.
                (_, Err(refusal)) => assert!(refusal.margin < 2.0, "{refusal:?} {call:?}"),
                (Err(alarm), Ok(_)) => {
                    let less = reference::thread(&shorter(&call));
                    let same = less.is_err_and(|refusal| refusal.number == alarm.number());
                    assert!(same, "{alarm:?} {call:?}");
                }
            }
        }
        assert!(
            refused > cycles() / 100,
            "{refused} refused: the alarms were not tried"
        );
    });
}

/// The same with a stroke that is two nanometres shorter: as much as rounding may make of it.
fn shorter(call: &ThreadCall) -> ThreadCall {
    let two = len(2 * (call.start.z - call.end_z.value).signum());
    let mut shorter = *call;
    shorter.end_z.value += two;
    shorter
}

#[test]
fn threads_are_the_same_mirrored_and_moved() {
    leadscrew_seed::volume(78, |seed| {
        let mut r = Random(seed);
        for _ in 0..cycles() / 2 {
            let call = thread(&mut r);
            let axis = len(r.within(-1_000_000_000, 1_000_000_000));
            let twice = axis + axis;
            // X about any axis: external becomes internal.
            let mirrored = ThreadCall {
                start: Position {
                    x: twice - call.start.x,
                    ..call.start
                },
                end_x: at(twice - call.end_x.value),
                taper: at(-call.taper.value),
                ..call
            };
            same(&call, &mirrored, |p| Position {
                x: twice - p.x,
                ..p
            });
            let moved = ThreadCall {
                start: Position {
                    x: call.start.x + axis,
                    z: call.start.z - twice,
                    ..call.start
                },
                end_x: at(call.end_x.value + axis),
                end_z: at(call.end_z.value - twice),
                ..call
            };
            same(&call, &moved, |p| Position {
                x: p.x + axis,
                z: p.z - twice,
                ..p
            });
            // Along Z left and right change places; the alternating modes begin on a side that has no mirror image.
            let cut_in = match call.cut_in.value {
                CutIn::Left => CutIn::Right,
                CutIn::Right => CutIn::Left,
                CutIn::RightCentre | CutIn::LeftRight => continue,
                same => same,
            };
            let mirrored = ThreadCall {
                start: Position {
                    z: twice - call.start.z,
                    ..call.start
                },
                end_z: at(twice - call.end_z.value),
                cut_in: at(cut_in),
                ..call
            };
            same(&call, &mirrored, |p| Position {
                z: twice - p.z,
                ..p
            });
        }
    });
}

/// The moves of `other` are those of `call` with every end point mapped; or both are refused alike.
fn same(call: &ThreadCall, other: &ThreadCall, map: impl Fn(Position) -> Position) {
    match (expand_thread(call), expand_thread(other)) {
        (Ok(a), Ok(b)) => {
            let a: Vec<_> = a.into_iter().map(|m| Move { to: map(m.to), ..m }).collect();
            assert_eq!(a, b);
        }
        (Err(a), Err(b)) => {
            assert_eq!((a.code, a.args[0].is_pass()), (b.code, b.args[0].is_pass()))
        }
        (a, b) => panic!("{:?} {:?}", a.err(), b.err()),
    }
}

trait Pass {
    fn is_pass(&self) -> Option<i64>;
}

impl Pass for Arg {
    fn is_pass(&self) -> Option<i64> {
        match self {
            Arg::Int(pass) => Some(*pass),
            _ => None,
        }
    }
}

/// Everything 127 times as large, the input increment too: depths follow exactly, points within their rounding.
#[test]
fn threads_scale() {
    leadscrew_seed::volume(254, |seed| {
        const FACTOR: i64 = 127;
        let mut r = Random(seed);
        for _ in 0..cycles() / 4 {
            let call = thread(&mut r);
            let large =
                |at: leadscrew_core::alarm::At<Length>| crate::build::at(at.value.times(FACTOR));
            let other = ThreadCall {
                start: Position {
                    x: call.start.x.times(FACTOR),
                    z: call.start.z.times(FACTOR),
                    ..call.start
                },
                end_x: large(call.end_x),
                end_z: large(call.end_z),
                taper: large(call.taper),
                height: large(call.height),
                first_depth: large(call.first_depth),
                min_step: large(call.min_step),
                allowance: large(call.allowance),
                run_in: large(call.run_in),
                run_out: call.run_out.map(|out| RunOut {
                    short: large(out.short),
                    long: large(out.long),
                    short_rest: out.short_rest,
                    long_rest: out.long_rest,
                }),
                increment: call.increment.times(FACTOR),
                ..call
            };
            let (Ok(a), Ok(b)) = (expand_thread(&call), expand_thread(&other)) else {
                continue;
            };
            assert_eq!(a.len(), b.len());
            for (a, b) in a.iter().zip(&b) {
                assert_eq!(a.tag.unwrap().depth.times(FACTOR), b.tag.unwrap().depth);
                for (a, b) in [(a.to.x, b.to.x), (a.to.z, b.to.z)] {
                    assert!(
                        (a.times(FACTOR) - b).abs().nm() <= FACTOR / 2 + 1,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    });
}

#[test]
fn cut_in_modes_end_at_one_z_and_agree_without_an_angle() {
    leadscrew_seed::volume(4, |seed| {
        use CutIn::*;
        let mut r = Random(seed);
        for _ in 0..cycles() / 10 {
            let base = ThreadCall {
                run_in: at(Length::ZERO),
                ..thread(&mut r)
            };
            let moves = |cut_in, angle| {
                let call = ThreadCall {
                    cut_in: at(cut_in),
                    angle: at(angle),
                    ..base
                };
                expand_thread(&call)
            };
            let starts = |moves: &[Move]| -> Vec<Position> {
                let approach = moves
                    .iter()
                    .filter(|m| m.tag.unwrap().stage == Stage::Approach);
                approach.map(|m| m.to).collect()
            };
            if let Ok(centre) = moves(Centre, 0) {
                for mode in [Left, Right, RightCentre, LeftRight, Trailing] {
                    assert_eq!(moves(mode, 0).unwrap(), centre);
                }
            }
            let angle = base.angle.value;
            let lists: Vec<_> = [Left, Right, RightCentre, LeftRight]
                .iter()
                .filter_map(|&mode| moves(mode, angle).ok())
                .collect();
            for pair in lists.windows(2) {
                let (a, b) = (starts(&pair[0]), starts(&pair[1]));
                let last_rough = |moves: &[Move]| {
                    let rough = moves
                        .iter()
                        .rev()
                        .find(|m| m.tag.unwrap().stage == Stage::Rough);
                    rough.unwrap().tag.unwrap().pass as usize * usize::from(base.starts.value) - 1
                };
                // From the last rough pass on; the centre of mode 3 reaches it too.
                let n = last_rough(&pair[0]);
                assert_eq!(a[n..], b[n..]);
            }
            let down = base.end_z.value < base.start.z;
            let trailing = if down { Right } else { Left };
            if let (Ok(g76), Ok(g78)) = (moves(Trailing, angle), moves(trailing, angle)) {
                let rough = |moves: Vec<Move>| -> Vec<Move> {
                    let of_rough = |m: &Move| m.tag.unwrap().depth < base.height.value;
                    moves.into_iter().filter(of_rough).collect()
                };
                assert_eq!(rough(g76), rough(g78));
            }
        }
    });
}

pub fn groove(r: &mut Random) -> GrooveCall {
    let lsb = r.of(&[50, 500, 127, 1270]);
    let (x_a, z_a) = (
        r.length(-50_000, 90_000, lsb),
        r.length(-90_000, 90_000, lsb),
    );
    let depth = r.sign() * r.length(100, 60_000, lsb).max(lsb);
    let width = if r.chance(25) {
        0
    } else {
        r.sign() * r.length(10, 60_000, lsb)
    };
    let written = width != 0 || r.chance(50);
    let peck = r.length(100, 20_000, lsb).max(depth.abs() / 200).max(lsb);
    GrooveCall {
        axis: TapAxis::X,
        start: Position {
            x: len(x_a),
            z: len(z_a),
            c: Angle::ZERO,
        },
        end_x: at(len(x_a + depth)),
        end_z: at(len(z_a + width)),
        last_written: written,
        peck: Some(at(len(peck))),
        step: (width != 0 || r.chance(50)).then(|| {
            at(len(r
                .length(100, 20_000, lsb)
                .max(width.abs() / 50)
                .max(lsb)))
        }),
        relief: at(len(if r.chance(50) {
            0
        } else {
            r.length(0, 500, lsb)
        })),
        retract: at(len(if r.chance(20) {
            0
        } else {
            // More than ten infeeds is refused.
            r.length(0, 3000, lsb).min(10 * peck)
        })),
        feed: FeedRate::PerMinute(Feed::from_nm_per_min(1_000_000)),
    }
}

#[test]
fn grooves_equal_the_reference() {
    leadscrew_seed::volume(75, |seed| {
        let mut r = Random(seed);
        for _ in 0..cycles() / 5 {
            let call = groove(&mut r);
            let moves: Vec<Move> = GrooveMoves::new(&call, place(1)).unwrap().collect();
            let want = reference::groove(&call);
            assert_eq!(moves.len(), want.len());
            for (m, (stage, column, peck, x, z)) in moves.iter().zip(want) {
                let tag = m.tag.unwrap();
                assert_eq!((tag.stage, tag.pass, tag.peck), (stage, column, peck));
                assert_eq!((m.to.x.nm(), m.to.z.nm()), (x, z));
                assert_eq!(tag.depth, (m.to.x - call.start.x).abs());
                assert_eq!(matches!(m.kind, MoveKind::Feed(_)), stage == Stage::Peck);
            }
            assert_eq!(moves.last().unwrap().to, call.start);
        }
    });
}

/// A length that is anything a program could hold, mostly at the edges.
fn edge(r: &mut Random) -> Length {
    let limit = Length::INPUT_LIMIT.nm();
    let nm = match r.within(0, 9) {
        0 => 0,
        1 => r.within(-2, 2),
        2 => limit * r.sign(),
        3 => (limit - r.within(-1, 3)) * r.sign(),
        4 => r.of(&[i64::MIN, i64::MAX, i64::MIN + 1]),
        5 => r.within(-1000, 1000),
        6 => 1 << r.within(0, 62),
        7 => r.within(-(1 << 36), 1 << 36),
        _ => r.within(-limit, limit),
    };
    len(nm)
}

/// Whatever a call holds, there is an alarm or a closed list of moves: no overflow (these tests check for it), no hang.
#[test]
fn wild_calls_are_refused_or_cut() {
    leadscrew_seed::volume(13, |seed| {
        let mut r = Random(seed);
        let mut cut = 0;
        for _ in 0..cycles() {
            let mut call = thread(&mut r);
            for _ in 0..r.within(1, 6) {
                let value = edge(&mut r);
                match r.within(0, 12) {
                    0 => call.start.x = value,
                    1 => call.start.z = value,
                    2 => call.end_x = at(value),
                    3 => call.end_z = at(value),
                    4 => call.taper = at(value),
                    5 => call.height = at(value),
                    6 => call.first_depth = at(value),
                    7 => call.min_step = at(value),
                    8 => call.allowance = at(value),
                    9 => call.run_in = at(value),
                    10 => call.increment = value,
                    11 => {
                        call.run_out = Some(RunOut {
                            short: at(value),
                            long: at(edge(&mut r)),
                            short_rest: Remainder::ZERO,
                            long_rest: Remainder::ZERO,
                        })
                    }
                    _ => {
                        call.lead =
                            at(Lead::new(value.nm(), r.next_bits() as i64).unwrap_or(lead(1.0)))
                    }
                }
            }
            call.starts = at(1);
            if let Ok(moves) = ThreadMoves::new(&call, place(1)) {
                let summary = moves.summary();
                assert!(summary.rough <= 9999);
                if summary.rough < 300 {
                    let moves: Vec<Move> = moves.collect();
                    assert_eq!(moves.last().unwrap().to, call.start);
                    in_box(&call, &moves);
                    cut += 1;
                }
            }
            let mut call = groove(&mut r);
            for _ in 0..r.within(1, 3) {
                let value = edge(&mut r);
                match r.within(0, 7) {
                    0 => call.start.x = value,
                    1 => call.start.z = value,
                    2 => call.end_x = at(value),
                    3 => call.end_z = at(value),
                    4 => call.relief = at(value),
                    5 => call.retract = at(value),
                    6 => call.peck = Some(at(value)),
                    _ => call.step = Some(at(value)),
                }
            }
            if let Ok(moves) = GrooveMoves::new(&call, place(1)) {
                let count = moves.totals();
                assert!(count.infeeds * count.columns <= 99_999, "{call:?}");
                assert!(moves.take(50).count() >= 2);
            }
        }
        assert!(cut > cycles() / 50, "{cut}");
    });
}
