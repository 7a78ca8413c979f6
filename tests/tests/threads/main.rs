//! Threads on a spindle that is not ideal: how far the setpoints are from the exact helix.

mod few_counts;
mod random;
mod ripple;
mod spindle;

use leadscrew_core::alarm::Span;
use leadscrew_core::call::Position;
use leadscrew_core::motion::{Phase, ThreadPlan, ThreadRun};
use leadscrew_core::moves::{Cycle, Move, MoveKind, Stage, Tag, ThreadMove};
use leadscrew_core::params::Params;
use leadscrew_core::spindle::Observer;
use leadscrew_core::units::{Angle, Axis, Lead, LeadChange, Length, Rpm, StartAngle, Ticks};
use leadscrew_tests::watch::Watch;
use spindle::{Spindle, TICK_S};

fn position(x: i64, z: i64) -> Position {
    Position {
        x: Length::from_nm(x),
        z: Length::from_nm(z),
        c: Angle::ZERO,
    }
}

/// The synchronous moves of a pass, each to a point.
fn pass(
    points: &[(Position, Stage)],
    lead: Lead,
    rpm: i32,
    long_x: bool,
    start: StartAngle,
) -> Vec<Move> {
    let mut moves = Vec::new();
    for (n, &(to, stage)) in points.iter().enumerate() {
        moves.push(Move {
            span: Span::default(),
            to,
            kind: MoveKind::Thread(ThreadMove {
                lead,
                change: LeadChange::NONE,
                pass_angle: start,
                angle_udeg: 0,
                long_x,
                part: leadscrew_core::call::ChainPart::Whole,
                last: n + 1 == points.len(),
                rpm: Rpm::new(rpm),
            }),
            tag: Some(Tag {
                cycle: Cycle::G78,
                pass: 1,
                start: 1,
                peck: 0,
                stage,
                depth: Length::ZERO,
            }),
        });
    }
    moves
}

/// A pass on a spindle that is turning when it begins.
#[derive(Clone)]
struct Setup {
    spindle: Spindle,
    bandwidth: u32,
    edges: bool,
    lead: Lead,
    start: StartAngle,
    long_x: bool,
    from: Position,
    points: Vec<(Position, Stage)>,
}

/// What its locked part is worth.
struct Outcome {
    /// Largest distance from the exact helix, micrometres.
    error: f64,
    /// Second difference of the error, m/s² RMS.
    noise: f64,
    /// True spindle angle in the turning direction and long axis, at each locked setpoint's instant.
    groove: Vec<(f64, i64)>,
    /// Largest shares of speed, acceleration and jerk of the long axis, over the whole pass.
    long: [f64; 3],
    /// The same of the short axis.
    short: [f64; 3],
}

impl Setup {
    /// O0013's first pass.
    fn o0013(spindle: Spindle) -> Self {
        Self {
            spindle,
            bandwidth: 35,
            edges: true,
            lead: Lead::new(6_000_000, 1).unwrap(),
            start: StartAngle::INDEX,
            long_x: false,
            from: position(30_000_000, 8_000_000),
            points: vec![
                (position(30_000_000, -59_000_000), Stage::Rough),
                (position(33_000_000, -62_000_000), Stage::RunOut),
            ],
        }
    }

    fn long(&self, at: Position) -> i64 {
        if self.long_x { at.x.nm() } else { at.z.nm() }
    }

    fn run(&self) -> Outcome {
        let params = Params::default();
        let spindle = self.spindle;
        let rpm = (spindle.turns_per_second * 60.0).round() as i32;
        let moves = pass(&self.points, self.lead, rpm, self.long_x, self.start);
        let end = moves.last().unwrap().to;
        let mut observer = Observer::new(4096, self.bandwidth, 1000);
        let mut tick = 0_u32;
        while tick < 600 || !observer.indexed() {
            observer.tick(spindle.sample(f64::from(tick) * TICK_S, self.edges));
            tick += 1;
        }
        let plan = ThreadPlan::new(self.from, &moves, &params, observer.speed()).unwrap();
        let mut run =
            ThreadRun::start(&plan, observer.predict(Ticks::ONE), observer.speed()).unwrap();
        let (long, short) = if self.long_x {
            (Axis::X, Axis::Z)
        } else {
            (Axis::Z, Axis::X)
        };
        let shortwise = |at: Position| if self.long_x { at.z.nm() } else { at.x.nm() };
        let mut watch_long = Watch::new(&params, long, self.long(self.from));
        let mut watch_short = Watch::new(&params, short, shortwise(self.from));
        let mut errors: Vec<f64> = Vec::new();
        let mut groove = Vec::new();
        loop {
            let t = f64::from(tick) * TICK_S;
            observer.tick(spindle.sample(t, self.edges));
            let point = run.tick(&plan, observer.predict(Ticks::ONE));
            tick += 1;
            let (here, last) = (self.long(point.position), self.long(end));
            assert!((here - last).signum() != (last - self.long(self.from)).signum());
            watch_long.see(here);
            watch_short.see(shortwise(point.position));
            match point.phase {
                Phase::Done => {
                    assert_eq!(point.position, end);
                    break;
                }
                Phase::Locked => {
                    // The observer numbers its turns from where it woke up: whole leads say nothing.
                    let truth = run.helix(&plan).at(spindle.truth(t + TICK_S));
                    let lead = self.lead.numerator() as f64 / self.lead.denominator() as f64;
                    let error = here as f64 - truth.nm() as f64 + lead / 2.0;
                    errors.push((error.rem_euclid(lead) - lead / 2.0) * 1e-3);
                    groove.push((spindle.angle(t + TICK_S) * f64::from(rpm.signum()), here));
                }
                _ => {}
            }
        }
        let noise: Vec<f64> = errors
            .windows(3)
            .map(|w| (w[0] - 2.0 * w[1] + w[2]) * 1e-6 / (TICK_S * TICK_S))
            .collect();
        Outcome {
            error: errors.iter().fold(0.0, |worst, e| worst.max(e.abs())),
            noise: (noise.iter().map(|a| a * a).sum::<f64>() / noise.len() as f64).sqrt(),
            groove,
            long: watch_long.worst,
            short: watch_short.worst,
        }
    }
}

impl Outcome {
    /// Where the long axis would be at angle 0 by each setpoint: least and largest, in nanometres from `from` and within
    /// half a lead of it.
    fn phase(&self, setup: &Setup) -> (f64, f64) {
        let lead = setup.lead.numerator() as f64 / setup.lead.denominator() as f64;
        let from = setup.long(setup.from);
        let way = (setup.long(setup.points.last().unwrap().0) - from).signum() as f64;
        let mut range = (f64::MAX, f64::MIN);
        for &(angle, at) in &self.groove {
            let beside = (at - from) as f64 - way * angle.fract() * lead;
            let beside = (beside + lead / 2.0).rem_euclid(lead) - lead / 2.0;
            range = (range.0.min(beside), range.1.max(beside));
        }
        range
    }
}

/// The worst of twenty places in the turn where the counter may have started.
fn worst(ripple: f64, bandwidth: u32, edges: bool) -> (f64, f64) {
    let mut most = (0.0_f64, 0.0_f64);
    for k in 0..20 {
        let spindle = Spindle {
            ripple,
            ..Spindle::steady(300.0, f64::from(k) * 0.0317)
        };
        let setup = Setup {
            bandwidth,
            edges,
            ..Setup::o0013(spindle)
        };
        let outcome = setup.run();
        most = (most.0.max(outcome.error), most.1.max(outcome.noise));
    }
    println!(
        "{bandwidth} Hz, edge times {edges}, ripple {ripple}: {:.3} um, {:.3} m/s2 RMS",
        most.0, most.1
    );
    most
}

#[test]
fn lead_6_at_300_rpm_stays_on_the_helix() {
    let with_edge_times = [15, 20, 26, 32, 35, 38, 60].map(|bandwidth| (bandwidth, true));
    let counts_alone = [32, 34, 35, 36, 38].map(|bandwidth| (bandwidth, false));
    for (bandwidth, edges) in with_edge_times.into_iter().chain(counts_alone) {
        let (error, noise) = worst(0.0, bandwidth, edges);
        assert!(error <= 1.0 && noise <= 0.6);
        // A slow observer lags behind the ripple; from 26 Hz on it is good enough.
        if bandwidth >= 26 {
            let (error, noise) = worst(0.1, bandwidth, edges);
            assert!(error <= 1.3 && noise <= 0.6);
        }
    }
}

#[test]
fn a_cut_at_another_speed_falls_into_the_same_groove() {
    for edges in [true, false] {
        for hand in [1.0, -1.0] {
            let setup = |rpm, first| Setup {
                edges,
                ..Setup::o0013(Spindle::steady(rpm * hand, first))
            };
            let range = |setup: Setup| setup.run().phase(&setup);
            let (slow, fast) = (range(setup(100.0, 0.3)), range(setup(300.0, 0.7)));
            let apart = (fast.1 - slow.0).max(slow.1 - fast.0) * 1e-3;
            println!("edge times {edges}: 100 against 300 rpm, hand {hand}: {apart:.3} um");
            assert!(apart <= 1.5);
            // And that groove is the one of the law: on the start point at the index.
            assert!(slow.0.abs().max(slow.1.abs()) <= 1000.0);
        }
    }
}

#[test]
fn start_point_and_start_angle_move_the_groove_and_nothing_else_does() {
    let plain = Setup::o0013(Spindle::steady(250.0, 0.1));
    let bounds = |setup: &Setup, centre: f64| {
        let (low, high) = setup.run().phase(setup);
        // A setpoint rounds to a nanometre, and the angle to one of time.
        assert!(
            low >= centre - 1.5 && high <= centre + 1.5,
            "{low} {high} {centre}"
        );
    };
    bounds(&plain, 0.0);
    // The groove is measured from the start point: a shifted start is at 0 again, so the groove has moved with it.
    let mut shifted = plain.clone();
    shifted.from.z = Length::from_nm(8_960_770);
    bounds(&shifted, 0.0);
    // A third of a turn after the index the helix is at the start point: at the index a third of a lead before it.
    let third = Setup {
        start: StartAngle::from_mdeg(120_000),
        ..plain.clone()
    };
    bounds(&third, 2_000_000.0);
    // Eleven turns an inch, an exact ratio.
    let inch = Setup {
        lead: Lead::new(25_400_000, 11).unwrap(),
        ..plain.clone()
    };
    bounds(&inch, 0.0);
    // M04, where the trade counts in the direction of turning.
    let left = Setup {
        spindle: Spindle::steady(-250.0, 0.1),
        ..plain
    };
    bounds(&left, 0.0);
}

#[test]
fn taper_run_in_and_a_long_x() {
    let spindle = Spindle::steady(300.0, 0.4);
    let taper = Setup {
        from: position(22_000_000, 5_000_000),
        points: vec![
            (position(20_100_000, 3_000_000), Stage::RunIn),
            (position(22_250_000, -40_000_000), Stage::Finish),
            (position(24_000_000, -43_000_000), Stage::RunOut),
        ],
        lead: Lead::new(2_000_000, 1).unwrap(),
        ..Setup::o0013(spindle)
    };
    let face = Setup {
        from: position(40_000_000, 1_000_000),
        points: vec![
            (position(15_000_000, -500_000), Stage::Rough),
            (position(12_500_000, 1_500_000), Stage::RunOut),
        ],
        lead: Lead::new(2_500_000, 1).unwrap(),
        long_x: true,
        ..Setup::o0013(spindle)
    };
    for setup in [taper, face] {
        let outcome = setup.run();
        let (low, high) = outcome.phase(&setup);
        assert!(low >= -1.5 && high <= 1.5, "{low} {high}");
        assert!(outcome.error <= 0.01);
        let shares = [outcome.long, outcome.short];
        println!("{shares:?}");
        assert!(
            shares.as_flattened().iter().all(|share| *share <= 1.0),
            "{shares:?}"
        );
    }
}

#[test]
fn limits_hold_on_a_measured_spindle_too() {
    for ripple in [0.0, 0.1] {
        let mut most = [[0.0_f64; 3]; 2];
        for k in 0..20 {
            let spindle = Spindle {
                ripple,
                ..Spindle::steady(300.0, f64::from(k) * 0.0317)
            };
            let outcome = Setup::o0013(spindle).run();
            for (most, now) in most.iter_mut().zip([outcome.long, outcome.short]) {
                for (most, now) in most.iter_mut().zip(now) {
                    *most = most.max(now);
                }
            }
        }
        println!("ripple {ripple}: shares of the limits {most:.3?}");
        let [long, [speed, acceleration, jerk]] = most;
        assert!(long.iter().all(|share| *share <= 1.0));
        // A run-out that fits with less than the whole margin may take more jerk where the spindle runs ahead.
        assert!(
            speed <= 1.0 && acceleration <= 1.0 && jerk <= if ripple == 0.0 { 1.0 } else { 1.25 }
        );
    }
}
