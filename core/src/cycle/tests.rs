//! The cycles of the sheets on the built-in machine.

extern crate std;

use std::vec::Vec;

use super::*;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{ChainPart, CutIn, FeedRate, Infeed, Position, RunOut, ThreadCall, ThreadCycle};
use crate::feasible::{each_within_limits, time_of_each};
use crate::moves::{Move, MoveKind};
use crate::params::{Entry, Params, Part};
use crate::units::{
    Angle, Axis, Diameter, Feed, Lead, LeadChange, Length, Millis, Remainder, Rpm, StartAngle,
};

const MM: i64 = 1_000_000;

fn nm(value: i64) -> Length {
    Length::from_nm(value)
}

fn at<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

fn point(x: i64, z: i64) -> Position {
    Position {
        x: nm(x),
        z: nm(z),
        c: Angle::ZERO,
    }
}

/// `G76 P020560 Q0.15 R0.1; G76 X60.64 Z-62 P3.68 Q1.8 F6` from X80 Z10.
fn o0013(rpm: i32) -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G76,
        start: point(40 * MM, 10 * MM),
        end_x: at(nm(30_320_000)),
        end_z: at(nm(-62 * MM)),
        taper: at(Length::ZERO),
        height: at(nm(3_680_000)),
        first_depth: at(nm(1_800_000)),
        min_step: at(nm(150_000)),
        allowance: at(nm(100_000)),
        finish_passes: at(2),
        angle: at(60),
        infeed: Infeed::Decreasing,
        cut_in: at(CutIn::Trailing),
        starts: at(1),
        run_in: at(Length::ZERO),
        run_out: Some(RunOut {
            short: at(nm(3 * MM)),
            long: at(nm(3 * MM)),
            short_rest: Remainder::ZERO,
            long_rest: Remainder::ZERO,
        }),
        lead: at(Lead::new(6 * MM, 1).unwrap()),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::INDEX,
        part: ChainPart::Whole,
        increment: nm(100),
        rpm: Rpm::new(rpm),
    }
}

/// `G78 P020545 Q0.15 R0.5; G78 X60 Z-60 P3 Q1.8 F300 J1.5 K2` from X80 Z10, with the lead (F) as given.
fn g78(lead: i64, rpm: i32) -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G78,
        end_x: at(nm(30 * MM)),
        end_z: at(nm(-60 * MM)),
        height: at(nm(3 * MM)),
        allowance: at(nm(500_000)),
        angle: at(45),
        cut_in: at(CutIn::Centre),
        run_out: Some(RunOut {
            short: at(nm(1_500_000)),
            long: at(nm(2 * MM)),
            short_rest: Remainder::ZERO,
            long_rest: Remainder::ZERO,
        }),
        lead: at(Lead::new(lead, 1).unwrap()),
        rpm: Rpm::new(rpm),
        ..o0013(300)
    }
}

fn codes(alarms: [Option<Alarm>; FINDINGS]) -> Vec<Code> {
    alarms
        .into_iter()
        .flatten()
        .map(|alarm| alarm.code)
        .collect()
}

#[test]
fn g78_example_is_refused_for_both_and_runs_when_mended() {
    let params = Params::default();
    let findings = thread_findings(&g78(300 * MM, 0), Span::default(), &params).unwrap();
    assert_eq!(
        codes(findings.alarms),
        [Code::SpindleStopped, Code::PitchTooLong]
    );
    assert_eq!(findings.report, None);
    let pitch = findings.alarms[1].unwrap();
    assert_eq!(
        pitch.args[..2],
        [Arg::Length(nm(300 * MM)), Arg::Length(nm(70 * MM))]
    );

    let report = thread_report(&g78(3 * MM, 10), Span::default(), &params).unwrap();
    assert_eq!(report.warnings, [None; FINDINGS]);
    assert_eq!(report.passes, 4);
    assert_eq!(report.z_shift_max, Length::ZERO);
    // 3 mm at 11.5 rpm is 575 µm/s: √(v³/j) is 1780.1 nm, rounded up.
    assert_eq!(report.lead_in, nm(1781));
}

#[test]
fn o0013_runs_at_300() {
    let params = Params::default();
    let report = thread_report(&o0013(300), Span::default(), &params).unwrap();
    assert_eq!(report.passes, 6);
    assert_eq!(report.z_shift_max, nm(2_124_649));
    // 34.5 mm/s with 60 m/s³: H = v·√(v/j) = 0.8273 mm.
    assert!(
        (827_280..=827_290).contains(&report.lead_in.nm()),
        "{:?}",
        report.lead_in
    );
    assert_eq!(report.start_before, report.lead_in + report.z_shift_max);
    assert_eq!(report.warnings, [None; FINDINGS]);
}

#[test]
fn the_largest_speed_is_the_largest() {
    let params = Params::default();
    for call in [o0013(300), g78(3 * MM, 10)] {
        let most = rpm_max(&call, Span::default(), &params).unwrap();
        assert!(most.get() > 0);
        let mut call = call;
        call.rpm = most;
        assert!(thread_report(&call, Span::default(), &params).is_ok());
        call.rpm = Rpm::new(most.get() + 1);
        assert!(thread_report(&call, Span::default(), &params).is_err());
    }
    // Lead 6 at 8 m/min is 1333 rpm. A long stroke without a run-out has no other limit.
    let mut call = o0013(300);
    call.run_out = None;
    call.end_z = at(nm(-500 * MM));
    let most = rpm_max(&call, Span::default(), &params).unwrap();
    assert_eq!(most, Rpm::new(1333));
}

/// With an override a thread is checked at the overridden speed; a refusal names that speed.
#[test]
fn a_thread_at_another_speed_is_refused_as_if_that_were_written() {
    let params = Params::default();
    let alarm = |call: ThreadCall, rpm| {
        thread_can_run(&call, Rpm::new(rpm), Span::default(), &params).unwrap_err()
    };
    for rpm in [0, 3001, -3001, 1400, -1400] {
        let written = thread_report(&o0013(rpm), Span::default(), &params).unwrap_err();
        assert_eq!(alarm(o0013(300), rpm), written, "{rpm}");
    }
}

#[test]
fn every_refusal() {
    let params = Params::default();
    let code = |call: ThreadCall| {
        thread_report(&call, Span::default(), &params)
            .unwrap_err()
            .code
    };
    assert_eq!(code(o0013(0)), Code::SpindleStopped);
    assert_eq!(code(o0013(3001)), Code::SpeedAboveSpindle);
    assert_eq!(code(o0013(-1400)), Code::LeadTooFast);
    assert_eq!(code(g78(71 * MM, 10)), Code::PitchTooLong);
    let mut steep = o0013(1000);
    steep.run_out = Some(RunOut {
        short: at(nm(4 * MM)),
        long: at(nm(2 * MM)),
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    });
    assert_eq!(code(steep), Code::RunOutTooFast);
    let mut short = o0013(1300);
    short.end_z = at(nm(0));
    assert_eq!(code(short), Code::StrokeTooShortForSpeed);
    let mut run_in = g78(3 * MM, 600);
    run_in.run_in = at(nm(200_000));
    assert_eq!(code(run_in), Code::RunInTooFast);
    // A feed that just reaches the limit is allowed. Along a taper the feed of the short axis counts too.
    let mut just = o0013(1000);
    just.lead = at(Lead::new(8 * MM, 1).unwrap());
    just.end_z = at(nm(-400 * MM));
    assert!(thread_report(&just, Span::default(), &params).is_ok());
    just.lead = at(Lead::new(8 * MM + 1, 1).unwrap());
    assert_eq!(code(just), Code::LeadTooFast);
    let mut slow_x = params.clone();
    let entry = Entry::find(1430, Some(Part::Axis(Axis::X))).unwrap();
    slow_x.set(entry, 500 * MM).unwrap();
    let mut taper = o0013(1000);
    taper.run_out = None;
    taper.taper = at(nm(-7 * MM));
    taper.end_z = at(nm(-60 * MM));
    taper.rpm = Rpm::new(800);
    assert!(thread_report(&taper, Span::default(), &slow_x).is_ok());
    taper.rpm = Rpm::new(840);
    let alarm = thread_report(&taper, Span::default(), &slow_x).unwrap_err();
    assert_eq!(
        (alarm.code, alarm.args[0]),
        (Code::LeadTooFast, Arg::Letter(b'X'))
    );
    // Two starts halve the pitch.
    let mut double = g78(71 * MM, 10);
    double.starts = at(2);
    assert!(thread_report(&double, Span::default(), &params).is_ok());
}

#[test]
fn an_encoder_that_is_too_coarse_is_named_with_the_lead_and_the_speed_it_can_do() {
    let with = |counts: u32, edges: u32| {
        let mut params = Params::sheets();
        let values = [(3720, Part::Whole, counts), (9006, Part::Bit(0), edges)];
        for (no, part, value) in values {
            let entry = Entry::all().iter().find(|e| e.no == no && e.part == part);
            params.set(entry.unwrap(), i64::from(value)).unwrap();
        }
        params
    };
    let told = |call: &ThreadCall, params: &Params| {
        thread_report(call, Span::default(), params)
            .map_err(|alarm| (alarm.code, alarm.word, alarm.args))
    };
    // 1024 counts: 0.81 m/s² for each millimetre of lead, and Z has 3.
    let coarse = with(1024, 0);
    let figures = [
        Arg::Length(nm(6 * MM)),
        Arg::Decimal(487, 2),
        Arg::Decimal(300, 2),
        Arg::Length(nm(3_694_000)),
    ];
    let refused = Err((Code::LeadForEncoder, Some(b'F'), figures));
    assert_eq!(told(&o0013(300), &coarse).map(drop), refused);
    // A run-out asks more of X.
    let straight = |lead| ThreadCall {
        run_out: None,
        ..g78(lead, 300)
    };
    assert!(told(&straight(3_694_000), &coarse).is_ok());
    assert!(told(&straight(3_695_000), &coarse).is_err());
    // 700 counts a second: 41.02 rpm.
    let figures = [
        Arg::Rpm(Rpm::new(41)),
        Arg::Int(699),
        Arg::Int(42),
        Arg::None,
    ];
    let refused = Err((Code::SpeedForEncoder, Some(b'S'), figures));
    assert_eq!(told(&g78(MM, 41), &coarse).map(drop), refused);
    assert!(told(&g78(MM, 42), &coarse).is_ok());
    // With timed edges the encoder suits the lead, and 280 counts a second are enough.
    assert!(told(&o0013(300), &with(1024, 1)).is_ok());
    // From 60 counts a turn on, 80 a second are: the bandwidth follows them.
    assert!(told(&g78(MM, 48), &with(100, 1)).is_ok());
    let figures = [
        Arg::Rpm(Rpm::new(47)),
        Arg::Int(78),
        Arg::Int(48),
        Arg::None,
    ];
    let refused = Err((Code::SpeedForEncoder, Some(b'S'), figures));
    assert_eq!(told(&g78(MM, 47), &with(100, 1)).map(drop), refused);
}

/// The short axis follows at the slope of its run-out, 0.75 here, and has an acceleration of its own.
#[test]
fn an_encoder_does_not_shake_the_short_axis_either() {
    // 2.436 m/s² along Z, of its 3, and 1.827 along X.
    let told = |x: i64, call: &ThreadCall| {
        let mut params = Params::sheets();
        let x_acceleration = (1620, Part::Axis(Axis::X), x);
        let coarse = [(3720, Part::Whole, 1024), (9006, Part::Bit(0), 0)];
        for (no, part, value) in coarse.into_iter().chain([x_acceleration]) {
            let entry = Entry::all().iter().find(|e| e.no == no && e.part == part);
            params.set(entry.unwrap(), value).unwrap();
        }
        let report = thread_report(call, Span::default(), &params);
        report.map(drop).map_err(|alarm| (alarm.code, alarm.args))
    };
    let call = g78(3 * MM, 300);
    assert_eq!(told(1_830_000_000, &call), Ok(()));
    let figures = [
        Arg::Length(nm(3 * MM)),
        Arg::Decimal(182, 2),
        Arg::Decimal(180, 2),
        Arg::Length(nm(2_955_000)),
    ];
    assert_eq!(
        told(1_800_000_000, &call),
        Err((Code::LeadForEncoder, figures))
    );
    let straight = ThreadCall {
        run_out: None,
        ..call
    };
    assert_eq!(told(1_800_000_000, &straight), Ok(()));
}

#[test]
fn an_encoder_of_few_counts_is_learned_and_what_it_leaves_is_told() {
    let with = |counts: i64, timed: i64, swing: i64| {
        let mut params = Params::sheets();
        let values = [
            (3720, Part::Whole, counts),
            (9034, Part::Whole, swing),
            (9006, Part::Bit(0), timed),
        ];
        for (no, part, value) in values {
            let entry = Entry::all().iter().find(|e| e.no == no && e.part == part);
            params.set(entry.unwrap(), value).unwrap();
        }
        params
    };
    let told = |call: &ThreadCall, params: &Params| {
        thread_report(call, Span::default(), params)
            .map_err(|alarm| (alarm.code, alarm.word, alarm.args))
            .map(|report| report.uncertainty)
    };
    // 100 counts a turn, 500 a second: 1.5 times the way of the axis in a tick of a millisecond, at a lead of 6 mm.
    let coarse = with(100, 0, 0);
    let figures = [
        Arg::Length(nm(6 * MM)),
        Arg::Length(nm(60_000)),
        Arg::Length(nm(50_000)),
        Arg::Rpm(Rpm::new(400)),
    ];
    let refused = Err((Code::EncoderUncertain, Some(b'F'), figures));
    assert_eq!(told(&o0013(400), &coarse), refused);
    assert_eq!(told(&o0013(300), &coarse), Ok(Some(nm(45_000))));
    // At a faster spindle a count is the smaller one.
    assert_eq!(told(&g78(MM, 1200), &coarse), Ok(Some(nm(15_000))));
    // A third of a turn a second, and eight counts. Timed ones are learned where the drive's swing is known, or below 60.
    let slow = |rpm, counts, least| {
        let figures = [
            Arg::Rpm(Rpm::new(rpm)),
            Arg::Int(counts),
            Arg::Int(least),
            Arg::None,
        ];
        Err((Code::SpeedForEncoder, Some(b'S'), figures))
    };
    for params in [coarse, with(100, 1, 3700)] {
        assert_eq!(told(&g78(MM, 19), &params), slow(19, 31, 20));
        assert!(told(&g78(MM, 20), &params).is_ok());
    }
    assert_eq!(told(&g78(MM, 29), &with(16, 1, 0)), slow(29, 7, 30));
    assert_eq!(told(&g78(MM, 30), &with(16, 1, 0)), Ok(None));
    assert_eq!(told(&g78(MM, 20), &with(59, 1, 0)), Ok(None));
    assert!(told(&g78(MM, 47), &with(60, 1, 0)).is_err());
}

#[test]
fn the_lead_in_has_the_drive_in_it() {
    let lead_in = |call: &ThreadCall, gains: [i64; 2]| {
        let mut params = Params::default();
        for (axis, gain) in [Axis::X, Axis::Z].into_iter().zip(gains) {
            let entry = Entry::find(9070, Some(Part::Axis(axis))).unwrap();
            params.set(entry, gain).unwrap();
        }
        let report = thread_report(call, Span::default(), &params).unwrap();
        assert_eq!(report.start_before, report.lead_in + report.z_shift_max);
        report.lead_in.nm()
    };
    let straight = o0013(300);
    let ideal = lead_in(&straight, [0, 0]);
    // X stands while a straight thread joins.
    assert_eq!(lead_in(&straight, [150, 0]), ideal);
    let [weak, usual, stiff] = [150, 300, 1000].map(|gain| lead_in(&straight, [0, gain]));
    assert!(weak > usual && usual > stiff && stiff > ideal + MM / 2);
    // Along a taper X joins, too. It goes 16 times slower, so it is less behind.
    let mut taper = straight;
    taper.taper = at(nm(-9 * MM / 2));
    let (x, z) = (lead_in(&taper, [150, 0]), lead_in(&taper, [0, 150]));
    assert!(x > ideal && z > ideal, "{x} {z}");
    assert_eq!(lead_in(&taper, [150, 150]), x.max(z));
    // The speeds of the machine's limits, and the weakest loop.
    for rpm in [10, 100, 1000] {
        assert!(lead_in(&o0013(rpm), [50, 50]) >= lead_in(&o0013(rpm), [0, 0]));
    }
}

#[test]
fn every_warning() {
    let mut params = Params::default();
    let warned = |call: ThreadCall, params: &Params| {
        codes(
            thread_report(&call, Span::default(), params)
                .unwrap()
                .warnings,
        )
    };
    let mut bare = o0013(300);
    bare.run_out = None;
    assert_eq!(warned(bare, &params), [Code::FallingLead]);
    let mut tight = o0013(300);
    tight.run_out = Some(RunOut {
        short: at(nm(MM)),
        long: at(nm(MM)),
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    });
    let report = thread_report(&tight, Span::default(), &params).unwrap();
    let lags = report
        .warnings
        .into_iter()
        .flatten()
        .find(|w| w.code == Code::RunOutLags)
        .unwrap();
    // With the K that the warning asks for, the warning disappears.
    let Arg::Length(enough) = lags.args[1] else {
        panic!("{lags:?}")
    };
    tight.run_out = Some(RunOut {
        short: at(nm(MM)),
        long: at(enough),
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    });
    assert_eq!(warned(tight, &params), []);

    let mut close = o0013(600);
    close.end_z = at(nm(-2 * MM));
    close.run_out = None;
    assert_eq!(
        warned(close, &params),
        [Code::LeadInLong, Code::FallingLead]
    );

    let entry = Entry::find(107, None).unwrap();
    params.set(entry, 100_000_000).unwrap();
    assert_eq!(warned(o0013(300), &params), [Code::RunOutSpeedIgnored]);

    let mut params = Params::default();
    params.set(Entry::find(5129, None).unwrap(), 1).unwrap();
    assert_eq!(warned(o0013(300), &params), [Code::HighSpeedNotBuilt]);
}

#[test]
fn time_of_a_cycle() {
    let params = Params::default();
    let call = o0013(300);
    let moves = ThreadMoves::new(&call, Span::default()).unwrap();
    let took = time_of_each(moves, call.start, &params).unwrap();
    // Six strokes of 70 to 71 mm at 30 mm/s with half a turn each, and the way back.
    assert!((14.5..20.0).contains(&took.as_secs_f64()), "{took:?}");
    let dwell = Move {
        span: Span::default(),
        to: call.start,
        kind: MoveKind::Dwell(Millis::new(1500)),
        tag: None,
    };
    let took = time_of_each([dwell].into_iter(), call.start, &params).unwrap();
    assert_eq!(took.as_millis(), 1500);
}

#[test]
fn travel_limits() {
    let params = Params::default();
    let rapid = |to| Move {
        span: Span::default(),
        to,
        kind: MoveKind::Rapid,
        tag: None,
    };
    let go = |to| each_within_limits([rapid(to)].into_iter(), Position::default(), &params);
    assert_eq!(go(point(300 * MM, -1000 * MM)), Ok(()));
    let alarm = go(point(0, 1000 * MM + 1)).unwrap_err();
    assert_eq!(alarm.code, Code::SoftLimit);
    assert_eq!(
        alarm.args[..3],
        [
            Arg::Letter(b'Z'),
            Arg::Length(nm(1000 * MM + 1)),
            Arg::Length(nm(1000 * MM))
        ]
    );
    let alarm = go(point(-300 * MM - 1, 0)).unwrap_err();
    assert_eq!(
        alarm.args[..2],
        [
            Arg::Letter(b'X'),
            Arg::Diameter(Diameter::from_nm(-600 * MM - 2))
        ]
    );
    assert_eq!(params.soft_limit_plus(Axis::X), 300 * MM);
}

#[test]
fn arcs_bulge_beyond_their_ends() {
    let params = Params::default();
    // From the top of a circle of 10 mm around X 295, Z 0 to its right end, in both directions.
    let arc = |from: Position, to: Position, i: i64, k: i64, clockwise: bool| {
        let feed = FeedRate::PerMinute(Feed::from_nm_per_min(100 * MM));
        let kind = MoveKind::Arc {
            i: nm(i * MM),
            k: nm(k * MM),
            clockwise,
            feed,
        };
        let one = Move {
            span: Span::default(),
            to,
            kind,
            tag: None,
        };
        each_within_limits([one].into_iter(), from, &params).is_ok()
    };
    let (top, right) = (point(299 * MM, 0), point(289 * MM, 10 * MM));
    let left = point(289 * MM, -10 * MM);
    assert!(arc(top, right, -10, 0, true));
    assert!(arc(top, right, -10, 0, false));
    let (top, right, left_high) = (
        point(305 * MM, 0),
        point(295 * MM, 10 * MM),
        point(295 * MM, -10 * MM),
    );
    assert!(!arc(right, left_high, 0, -10, false));
    assert!(arc(right, left_high, 0, -10, true));
    assert!(!arc(right, right, 0, -10, true));
    assert!(arc(left, left, 0, 10, false));
    // Passing a single extreme point is enough: from just before the top to just after it.
    assert!(!arc(left_high, right, 0, 10, true));
    assert!(arc(left_high, right, 0, 10, false));
    assert!(!arc(left_high, top, 0, 10, true));
}
