//! The sheets' complete examples and the worked cases, figure by figure.

use leadscrew_core::call::*;
use leadscrew_core::cycle::*;
use leadscrew_core::moves::*;
use leadscrew_core::units::*;

use crate::build::*;

fn moves(call: &ThreadCall) -> Vec<Move> {
    ThreadMoves::new(call, place(1)).unwrap().collect()
}

fn groove(call: &GrooveCall) -> Vec<Move> {
    GrooveMoves::new(call, place(1)).unwrap().collect()
}

fn stages(moves: &[Move]) -> Vec<Stage> {
    moves.iter().map(|m| m.tag.unwrap().stage).collect()
}

fn ends<'a>(moves: &'a [Move], stage: Stage) -> impl Iterator<Item = (i64, i64)> + 'a {
    moves
        .iter()
        .filter(move |m| m.tag.unwrap().stage == stage)
        .map(|m| (Diameter::of_radius(m.to.x).nm(), m.to.z.nm()))
}

fn thread_of(m: &Move) -> ThreadMove {
    match m.kind {
        MoveKind::Thread(thread) => thread,
        ref other => panic!("{other:?}"),
    }
}

/// Rough depths only, seen through the tags.
fn rough_depths(call: &ThreadCall) -> Vec<i64> {
    moves(call)
        .iter()
        .filter(|m| m.tag.unwrap().stage == Stage::Rough)
        .map(|m| m.tag.unwrap().depth.nm())
        .collect()
}

fn depth_case(k: f64, d: f64, delta: f64, min: f64, infeed: Infeed) -> Vec<i64> {
    rough_depths(&ThreadCall {
        height: at(mm(k)),
        allowance: at(mm(d)),
        first_depth: at(mm(delta)),
        min_step: at(mm(min)),
        infeed,
        ..o0013()
    })
}

fn depths(list: &[f64]) -> Vec<i64> {
    list.iter().copied().map(nm).collect()
}

#[test]
fn depth_sequences() {
    use Infeed::{Decreasing, Equal};
    assert_eq!(
        depth_case(3.68, 0.1, 1.8, 0.15, Decreasing),
        depths(&[1.8, 2.5456, 3.1177, 3.58])
    );
    assert_eq!(
        depth_case(1.3, 0.05, 0.4, 0.1, Decreasing),
        depths(&[0.4, 0.5657, 0.6928, 0.8, 0.9, 1.0, 1.1, 1.2, 1.25])
    );
    assert_eq!(
        depth_case(3.0, 0.5, 1.8, 0.15, Decreasing),
        depths(&[1.8, 2.5])
    );
    assert_eq!(depth_case(3.0, 0.5, 1.8, 0.15, Equal), depths(&[1.8, 2.5]));
    assert_eq!(
        depth_case(0.92, 0.05, 0.35, 0.08, Decreasing),
        depths(&[0.35, 0.495, 0.6062, 0.7, 0.7826, 0.8626, 0.87])
    );
    // The first pass is Δd, however small [D22]; from then on the smallest step.
    assert_eq!(
        depth_case(0.5, 0.1, 0.05, 0.1, Decreasing),
        depths(&[0.05, 0.15, 0.25, 0.35, 0.4])
    );
}

#[test]
fn o0013_of_the_sheet() {
    let moves = moves(&o0013());
    assert_eq!(moves.len(), 30);
    let x = [64.4, 62.9088, 61.7646, 60.84, 60.64, 60.64];
    let z = [8.960770, 8.530297, 8.199995, 7.933086, 7.875351, 7.875351];
    let after = [70.4, 68.9088, 67.7646, 66.84, 66.64, 66.64];
    let depth = [1.8, 2.5456, 3.1177, 3.58, 3.68, 3.68];
    for (n, pass) in moves.chunks(5).enumerate() {
        let stroke = if n < 4 { Stage::Rough } else { Stage::Finish };
        assert_eq!(
            stages(pass),
            [
                Stage::Approach,
                stroke,
                Stage::RunOut,
                Stage::Retract,
                Stage::Return
            ]
        );
        let corners = [
            (x[n], z[n]),
            (x[n], -59.0),
            (after[n], -62.0),
            (80.0, -62.0),
            (80.0, 10.0),
        ];
        for (m, (x, z)) in pass.iter().zip(corners) {
            assert_eq!(m.to, point(x, z));
            let tag = m.tag.unwrap();
            assert_eq!((tag.pass, tag.start, tag.peck), (n as u32 + 1, 1, 0));
            assert_eq!((tag.cycle, tag.depth), (Cycle::G76, mm(depth[n])));
            assert_eq!(m.span, place(1));
        }
        let (stroke, out) = (thread_of(&pass[1]), thread_of(&pass[2]));
        assert_eq!((stroke.angle_udeg, stroke.last, out.last), (0, false, true));
        let turned = nm(z[n] + 59.0) % 6_000_000;
        assert_eq!(i64::from(out.angle_udeg), turned * 60);
        for thread in [stroke, out] {
            assert_eq!(thread.pass_angle, StartAngle::INDEX);
            assert_eq!((thread.lead, thread.long_x), (lead(6.0), false));
            assert_eq!(thread.rpm, Rpm::new(300));
        }
    }
    let summary = ThreadMoves::new(&o0013(), place(1)).unwrap().summary();
    assert_eq!(
        (summary.rough, summary.passes, summary.long_x),
        (4, 6, false)
    );
    assert_eq!(summary.z_shift_max, mm(2.124649));
    assert_eq!(summary.shortest_stroke, mm(69.875351));
}

#[test]
fn internal_taper_with_a_clipped_run_out() {
    let moves = moves(&internal_taper());
    let x = [
        27.8658, 28.1582, 28.3824, 28.5715, 28.7381, 28.8994, 28.9144, 29.0152,
    ];
    let z = [4.7979, 4.7142, 4.65, 4.5959, 4.5482, 4.502, 4.4977, 4.4688];
    let starts: Vec<_> = ends(&moves, Stage::Approach).collect();
    assert_eq!(starts.len(), x.len());
    for ((got_x, got_z), (x, z)) in starts.iter().zip(x.iter().zip(z)) {
        assert!((*got_x as f64 / 1e6 - x).abs() < 0.00005001, "{got_x} {x}");
        assert!((*got_z as f64 / 1e6 - z).abs() < 0.00005001, "{got_z} {z}");
    }
    assert!(ends(&moves, Stage::Rough).all(|(_, z)| z == nm(-28.5)));
    let first = ends(&moves, Stage::Rough).next().unwrap();
    let out = ends(&moves, Stage::RunOut).next().unwrap();
    assert_eq!(out.0, nm(26.0));
    assert!(((first.0 - out.0) as f64 / 2e6 - 1.4086).abs() < 0.00005);
    // Clipped at A: the retract of that pass has no length.
    let of_first = moves.iter().filter(|m| m.tag.unwrap().pass == 1);
    assert!(
        of_first
            .clone()
            .all(|m| m.tag.unwrap().stage != Stage::Retract)
    );
    assert_eq!(of_first.count(), 4);
}

#[test]
fn g78_of_the_sheet() {
    let moves = moves(&g78());
    assert_eq!(moves.len(), 20);
    let x: Vec<_> = ends(&moves, Stage::Approach).map(|p| p.0).collect();
    assert_eq!(x, [62.4, 61.0, 60.0, 60.0].map(nm));
    assert_eq!(
        ends(&moves, Stage::Rough).next(),
        Some((nm(62.4), nm(-58.0)))
    );
    assert_eq!(
        ends(&moves, Stage::RunOut).next(),
        Some((nm(65.4), nm(-60.0)))
    );
    assert_eq!(moves.last().unwrap().to, point(80.0, 10.0));
}

fn g78_starts(cut_in: CutIn) -> Vec<f64> {
    let call = ThreadCall {
        cut_in: at(cut_in),
        angle: at(60),
        finish_passes: at(1),
        ..o0013()
    };
    let moves = moves(&call);
    let starts = ends(&moves, Stage::Approach);
    starts
        .map(|(_, z)| (z as f64 / 100.0).round() / 1e4)
        .collect()
}

#[test]
fn cut_in_modes() {
    let end = 7.9331;
    let cases = [
        (CutIn::Left, [6.9054, 7.3359, 7.6662, 7.9331]),
        (CutIn::Right, [8.9608, 8.5303, 8.2, 7.9331]),
        (CutIn::RightCentre, [8.9608, 7.9331, 8.2, 7.9331]),
        (CutIn::LeftRight, [6.9054, 8.5303, 7.6662, 7.9331]),
    ];
    for (mode, rough) in cases {
        let starts = g78_starts(mode);
        assert_eq!(starts[..4], rough, "{mode:?}");
        assert_eq!(starts[4], end, "{mode:?}");
    }
    assert_eq!(g78_starts(CutIn::Centre), [10.0; 5]);
}

#[test]
fn starts_share_a_depth_and_differ_in_angle() {
    let call = ThreadCall {
        starts: at(7),
        ..o0013()
    };
    let moves = moves(&call);
    assert_eq!(moves.len(), 7 * 30);
    for (index, pass) in moves.chunks(5).enumerate() {
        let (n, j) = (index / 7, index % 7);
        let tag = pass[0].tag.unwrap();
        assert_eq!((tag.pass as usize, tag.start as usize), (n + 1, j + 1));
        let angle =
            StartAngle::from_mdeg([0, 51_429, 102_857, 154_286, 205_714, 257_143, 308_571][j]);
        let (stroke, out) = (thread_of(&pass[1]), thread_of(&pass[2]));
        assert_eq!((stroke.pass_angle, out.pass_angle), (angle, angle));
        assert_eq!(stroke.angle_udeg, angle.mdeg() * 1000);
        let turned = (pass[0].to.z + mm(59.0)).nm() % 6_000_000 * 60;
        let want = (i64::from(stroke.angle_udeg) + turned) % 360_000_000;
        assert_eq!(i64::from(out.angle_udeg), want);
    }
}

#[test]
fn a_run_in_is_synchronous_and_at_45_degrees() {
    let call = ThreadCall {
        run_in: word(mm(2.5), 80),
        cut_in: at(CutIn::Right),
        ..o0013()
    };
    let list = moves(&call);
    assert_eq!(list.len(), 36);
    assert_eq!(
        stages(&list[..6]),
        [
            Stage::Approach,
            Stage::RunIn,
            Stage::Rough,
            Stage::RunOut,
            Stage::Retract,
            Stage::Return
        ]
    );
    assert_eq!(list[0].to, point(69.4, 8.960770));
    assert_eq!(list[1].to, point(64.4, 6.460770));
    assert_eq!(list[2].to, point(64.4, -59.0));
    assert_eq!(thread_of(&list[1]).angle_udeg, 0);
    assert_eq!(thread_of(&list[2]).angle_udeg, 150_000_000);
    // 67.96077 mm from the start of the pass, lead 6: 11 turns and 1.96077 mm.
    assert_eq!(thread_of(&list[3]).angle_udeg, 117_646_200);
    assert_eq!(
        [1, 2, 3].map(|i| thread_of(&list[i]).last),
        [false, false, true]
    );
    // Clipped at the start level: E' = 7.8 for the first pass.
    let clipped = moves(&ThreadCall {
        run_in: word(mm(20.0), 80),
        ..call
    });
    assert_eq!(clipped[0].to, point(80.0, 8.960770));
    assert_eq!(clipped[1].to, point(64.4, 1.160770));
}

#[test]
fn x_as_long_axis() {
    // 45° and more: the lead counts on the radius of X.
    let call = ThreadCall {
        start: point(60.0, 0.0),
        end_x: word(dia(20.0), 10),
        end_z: word(mm(-10.0), 20),
        taper: word(mm(12.0), 25),
        height: word(mm(1.0), 30),
        first_depth: word(mm(0.5), 40),
        allowance: at(Length::ZERO),
        min_step: at(Length::ZERO),
        finish_passes: at(1),
        angle: at(90),
        run_out: run_out(0.5, 2.4),
        lead: at(lead(2.0)),
        ..o0013()
    };
    let list = moves(&call);
    // Pass 1: depth 0.5, shift 0.5; X on the line at 9.5/10 of the taper: 20 + 22.8 + 1.
    assert_eq!(list[0].to, point(43.8, -0.5));
    // K = 2.4 on the radius before the pass's own D (21): X 25.8, and |W|/|i| of it on Z.
    assert_eq!(list[1].to, point(25.8, -8.0));
    assert_eq!(list[2].to, point(21.0, -7.5));
    assert_eq!(list[3].to, point(60.0, -7.5));
    assert_eq!(list[4].to, point(60.0, 0.0));
    let out = thread_of(&list[2]);
    assert!(out.long_x && out.last);
    // 9 mm on the radius: 4.5 turns.
    assert_eq!(out.angle_udeg, 180_000_000);
    let summary = ThreadMoves::new(&call, place(1)).unwrap().summary();
    assert!(summary.long_x);
    assert_eq!(summary.shortest_stroke, mm(10.8));
}

#[test]
fn inch_leads_turn_by_exact_ratio() {
    // 11.5 turns per inch over 3 inches is 34.5 turns.
    let call = ThreadCall {
        start: Position {
            z: Length::ZERO,
            ..point(80.0, 0.0)
        },
        end_z: word(mm(-76.2 - 3.0), 20),
        angle: at(0),
        lead: at(Lead::new(254_000_000, 115).unwrap()),
        ..o0013()
    };
    let list = moves(&call);
    assert_eq!(list[1].to.z, mm(-76.2));
    assert_eq!(thread_of(&list[2]).angle_udeg, 180_000_000);
    // A lead whose products need more than 64 bits: 1/0.0001 inch per turn over 2.54 mm.
    let wide = ThreadCall {
        lead: at(Lead::new(254_000_000_000, 1).unwrap()),
        ..call
    };
    let turned = thread_of(&moves(&wide)[2]).angle_udeg;
    assert_eq!(turned, 108_000, "76.2 mm of 254 m");
}

#[test]
fn o0008_of_the_sheet() {
    let moves = groove(&o0008());
    assert_eq!(moves.len(), 310);
    let columns = [-24, -27, -30, -33, -36, -39, -42, -45, -48, -50];
    for (index, column) in moves.chunks(31).enumerate() {
        let z = f64::from(columns[index]);
        for n in 1..=15u32 {
            let feed = &column[2 * (n as usize - 1)];
            let x = (125.0 - 6.0 * f64::from(n)).max(40.0);
            assert_eq!(feed.to, point(x, z));
            let tag = feed.tag.unwrap();
            assert_eq!((tag.pass, tag.peck), (index as u32 + 1, n));
            assert_eq!((tag.stage, tag.start), (Stage::Peck, 0));
            assert_eq!(tag.depth, dia(125.0 - x));
            assert_eq!(feed.kind, MoveKind::Feed(o0008().feed));
            if n < 15 {
                let back = &column[2 * n as usize - 1];
                assert_eq!(back.to, point(x + 1.0, z));
                assert_eq!(back.kind, MoveKind::Rapid);
                assert_eq!(back.tag.unwrap().stage, Stage::Retract);
                assert_eq!(back.tag.unwrap().depth, dia(124.0 - x));
            }
        }
        assert_eq!(column[29].to, point(125.0, z));
        assert_eq!(column[29].tag.unwrap().stage, Stage::Retract);
        let (stage, z) = match columns.get(index + 1) {
            Some(z) => (Stage::Shift, f64::from(*z)),
            None => (Stage::Return, -24.0),
        };
        assert_eq!(
            (column[30].tag.unwrap().stage, column[30].to),
            (stage, point(125.0, z))
        );
    }
    let mut from = point(125.0, -24.0);
    let mut fed = 0;
    for m in &moves {
        if matches!(m.kind, MoveKind::Feed(_)) {
            fed += (m.to.x - from.x).abs().nm();
        }
        from = m.to;
    }
    assert_eq!(fed, nm(495.0));
}

#[test]
fn a_groove_retract_is_clipped_at_the_start_level() {
    let call = GrooveCall {
        start: point(20.0, 0.0),
        end_x: word(dia(0.0), 10),
        end_z: at(Length::ZERO),
        last_written: false,
        step: None,
        retract: at(mm(5.0)),
        ..o0008()
    };
    let x: Vec<_> = groove(&call)
        .iter()
        .map(|m| Diameter::of_radius(m.to.x).nm())
        .collect();
    assert_eq!(x, [14.0, 20.0, 8.0, 18.0, 2.0, 12.0, 0.0, 20.0].map(nm));
}

#[test]
fn groove_relief_goes_against_the_infeed_along_z() {
    let one = |z: f64, last_written: bool| {
        let call = GrooveCall {
            end_z: at(mm(z)),
            last_written,
            peck: Some(word(dia(200.0), 30)),
            step: Some(word(mm(100.0), 40)),
            relief: word(mm(0.3), 50),
            ..o0008()
        };
        let moves = GrooveMoves::new(&call, place(1)).unwrap();
        let warning = moves.warning().unwrap();
        assert_eq!((warning.number(), warning.word), (4920, Some(b'R')));
        moves.collect::<Vec<_>>()
    };
    let aside = |moves: &[Move]| (moves[1].to.z - mm(-24.0)).nm();
    // Z omitted: towards +Z; written equal to Z_A: towards −Z.
    assert_eq!(aside(&one(-24.0, false)), nm(0.3));
    assert_eq!(aside(&one(-24.0, true)), nm(-0.3));
    assert_eq!(aside(&one(-25.0, true)), nm(0.3));
    assert_eq!(aside(&one(-20.0, true)), nm(-0.3));
    let moves = one(-25.0, true);
    use Stage::*;
    assert_eq!(
        stages(&moves),
        [Peck, Relief, Retract, Shift, Peck, Relief, Retract, Return]
    );
    assert_eq!(
        GrooveMoves::new(&o0008(), place(1)).unwrap().warning(),
        None
    );
}

#[test]
fn other_calls_make_one_move_or_none() {
    let here = point(10.0, 20.0);
    let there = point(30.0, 20.0);
    let feed = o0008().feed;
    let one = |kind| {
        let call = Call {
            span: place(3),
            origin: Position::default(),
            kind,
        };
        let mut moves = expand(&call, &Context::standing(here)).unwrap();
        assert_eq!(moves.warning(), None);
        let first = moves.next();
        assert_eq!(moves.next(), None);
        first.map(|m| {
            assert_eq!((m.span, m.tag), (place(3), None));
            (m.to, m.kind)
        })
    };
    assert_eq!(one(CallKind::Rapid(there)), Some((there, MoveKind::Rapid)));
    assert_eq!(one(CallKind::Rapid(here)), None);
    assert_eq!(
        one(CallKind::Line(there, feed)),
        Some((there, MoveKind::Feed(feed)))
    );
    assert_eq!(one(CallKind::Line(here, feed)), None);
    let time = Millis::new(2000);
    assert_eq!(
        one(CallKind::Dwell(time)),
        Some((here, MoveKind::Dwell(time)))
    );
    for spindle in [
        SpindleCall::speed(Rpm::new(-300)),
        SpindleCall::rigid(Rpm::new(1000), SpindleChoice::Written(TapSpindle::First)),
    ] {
        assert_eq!(
            one(CallKind::Spindle(spindle)),
            Some((here, MoveKind::Spindle(spindle)))
        );
    }
    assert_eq!(
        one(CallKind::Aux(Aux::T(101))),
        Some((here, MoveKind::Aux(Aux::T(101))))
    );
    assert_eq!(
        one(CallKind::End(30)),
        Some((here, MoveKind::Aux(Aux::M(30))))
    );
    // A full circle ends where it starts and is a move.
    let (i, k, clockwise) = (mm(-1.0), Length::ZERO, true);
    let arc = ArcCall {
        end: here,
        i,
        k,
        clockwise,
        feed,
    };
    assert_eq!(
        one(CallKind::Arc(arc)),
        Some((
            here,
            MoveKind::Arc {
                i,
                k,
                clockwise,
                feed
            }
        ))
    );
}

/// J and K of half a lead of 25.4/11 mm on a taper of 2.5 over 72: 40 088.38 nm of the line and 1 154 545.45 nm of J make
/// one coordinate, rounded once.
#[test]
fn the_end_of_a_run_out_is_rounded_once() {
    let rest = Remainder::from_raw(((5 << Remainder::BITS) / 11) as i16);
    let half_lead = at(Length::from_nm(1_154_545));
    let call = ThreadCall {
        taper: word(mm(2.5), 25),
        run_out: Some(RunOut {
            short: half_lead,
            long: half_lead,
            short_rest: rest,
            long_rest: rest,
        }),
        ..o0013()
    };
    let list = moves(&call);
    // Pass 1: 1.88 above D.
    let d = mm(30.32 + 1.88);
    assert_eq!(list[1].to.x, d + Length::from_nm(40_088));
    assert_eq!(list[2].to.x, d + Length::from_nm(1_194_634));
    assert_eq!(list[1].to.z, mm(-62.0) + half_lead.value);
}
