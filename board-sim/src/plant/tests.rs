extern crate std;

use super::*;
use leadscrew_core::bus::{
    DriveConfig, DriveFailure, DriveMaster, FollowingLimit, NmtState, Periods, Phase,
    SpindleMaster, SyncProducer,
};
use leadscrew_core::units::{Length, Rpm};
use std::vec;
use std::vec::Vec;

const TAU: f64 = std::f64::consts::TAU;

fn turns(angle: FineTurns) -> f64 {
    angle.raw() as f64 / 2f64.powi(64)
}

/// The speed and the angle of the formula, in doubles: from rest at t = 0, ramp to `rpm`, ripple of `part` at `hz`.
fn formula(t: f64, rpm: f64, ramp_ms: f64, part: f64, hz: f64) -> (f64, f64) {
    let acceleration = 1000.0 / 60.0 / (ramp_ms / 1000.0) * rpm.signum();
    let top = rpm / 60.0;
    let arrival = top / acceleration;
    let w = TAU * hz;
    let ripple_on_ramp =
        |t: f64| part * acceleration * (-t * (w * t).cos() / w + (w * t).sin() / (w * w));
    let ramp_time = t.min(arrival);
    let mut angle = acceleration * ramp_time * ramp_time / 2.0 + ripple_on_ramp(ramp_time);
    let mut speed = acceleration * ramp_time;
    if t > arrival {
        angle += top * (t - arrival) + part * top * ((w * arrival).cos() - (w * t).cos()) / w;
        speed = top;
    }
    (speed * (1.0 + part * (w * t).sin()), angle)
}

#[test]
fn the_angle_is_that_of_the_formula() {
    for (rpm, ramp, percent, hz) in [
        (300, 500, 0.0, 1.0),
        (300, 500, 10.0, 5.0),
        (-300, 500, 10.0, 5.0),
        (3000, 500, 90.0, 0.01),
        (1, 60_000, 25.0, 300.0),
        (4000, 1, 3.5, 1000.0),
        (777, 333, 12.345, 7.777),
    ] {
        let ripple = Ripple::new(
            (percent * 1000.0f64).round() as u32,
            (hz * 1000.0f64).round() as u32,
        )
        .unwrap();
        let mut s = Spindle::new(ramp, Some(ripple), Turns::ZERO).unwrap();
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        let mut worst: f64 = 0.0;
        for tick in 1..=20_000u32 {
            s.advance(997_000, |_| ());
            let t = f64::from(tick) * 997e-6;
            let (speed, angle) = formula(t, f64::from(rpm), f64::from(ramp), percent / 100.0, hz);
            worst = worst.max((turns(s.angle()) - angle).abs());
            let miss = f64::from(s.speed().get()) - speed * 60_000.0;
            assert!(miss.abs() < 1.5, "{rpm} rpm: speed off by {miss} mrpm");
        }
        // Doubles lose digits themselves where the angle is large.
        assert!(worst < 1e-9, "{rpm} rpm, {percent} % at {hz} Hz: {worst:e}");
    }
}

#[test]
fn an_hour_does_not_drift() {
    let mut s = Spindle::new(500, Ripple::new(10_000, 5_000), Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(300), 100));
    // 300 rpm is 5 turns a second; the ramp of 150 ms costs 0.375 turns. The ripple on the ramp leaves its constant.
    s.advance(10_000_000_000, |_| ());
    let begin = s.angle();
    for _ in 0..360_000 {
        s.advance(10_000_000, |_| ());
    }
    let gone = s.angle().raw() - begin.raw();
    assert!(
        (gone - (18_000i128 << 64)).unsigned_abs() < 1 << 30,
        "{gone:X}"
    );
}

#[test]
fn without_ripple_the_angle_is_exact() {
    // 600 rpm in 300 ms: 1.5 turns on the ramp, then 10 turns a second, however time is cut up.
    for step in [1_000_000u64, 250_000, 1, 999_999_937] {
        let mut s = Spindle::new(500, None, Turns::whole(-3)).unwrap();
        s.command(MilliRpm::of(Rpm::new(600), 100));
        let mut left = 2_300_000_000u64;
        if step == 1 {
            // Single nanoseconds for a while, the rest at once.
            for _ in 0..1000 {
                s.advance(1, |_| ());
            }
            left -= 1000;
        }
        while left > 0 {
            let ns = left.min(step.max(1000));
            s.advance(ns, |_| ());
            left -= ns;
        }
        // −3 + 1.5 + 20.
        assert_eq!(s.angle().raw(), (37i128 << 64) / 2);
        assert_eq!(s.angle().micro_turns(), 18_500_000);
        assert_eq!(s.speed().get(), 600_000);
    }
}

#[test]
fn reversal_passes_through_standstill_without_a_jump() {
    let mut s = Spindle::new(500, Ripple::new(20_000, 11_000), Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(500), 100));
    s.advance(1_000_000_000, |_| ());
    s.command(MilliRpm::of(Rpm::new(-500), 100));
    let mut last = (turns(s.angle()), f64::from(s.speed().get()) / 60_000.0);
    let mut directions = Vec::new();
    for _ in 0..700 {
        s.advance(1_000_000, |piece| {
            let (a, b) = (piece.angle(0), piece.angle(piece.duration()));
            if a != b {
                directions.push(b > a);
            }
        });
        let now = (turns(s.angle()), f64::from(s.speed().get()) / 60_000.0);
        // In a millisecond the speed changes by 0.033 turns/s on the ramp and 0.12 by the ripple at most.
        assert!((now.1 - last.1).abs() < 0.16);
        assert!((now.0 - last.0 - (now.1 + last.1) / 2.0 * 1e-3).abs() < 2e-6);
        last = now;
    }
    // Forwards until it stands, then backwards.
    assert!(directions.is_sorted_by(|a, b| a >= b));
    assert!(directions[0] && !directions[directions.len() - 1]);
}

#[test]
fn disturbances_go_along_the_ramp_and_are_undone() {
    let mut s = Spindle::new(500, None, Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(1000), 100));
    s.advance(500_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_000_000);
    s.disturb(130);
    s.advance(100_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_200_000);
    s.advance(100_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_300_000);
    s.disturb(0);
    s.advance(650_000_000, |_| ());
    assert_eq!(s.speed().get(), 0);
    s.disturb(100);
    s.advance(500_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_000_000);
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(Spindle::new(0, None, Turns::ZERO).is_none());
    assert!(Spindle::new(60_001, None, Turns::ZERO).is_none());
    assert_eq!(Ripple::new(90_001, 5000), None);
    assert_eq!(Ripple::new(10_000, 9), None);
    assert_eq!(Ripple::new(10_000, 1_000_001), None);
    assert!(Encoder::new(0, true, FineTurns::default(), 0).is_none());
}

/// Runs a spindle with an encoder through speeds, and checks every sample against the true angle.
fn encoder_against_truth(zero: i32, angle: Turns) {
    const COUNTS: i64 = 4096;
    let mut s = Spindle::new(100, Ripple::new(30_000, 17_000), angle).unwrap();
    let mut e = Encoder::new(COUNTS as u32, true, s.angle(), zero).unwrap();
    let shown = |count: i64| zero.wrapping_add(count as i32);
    let count = |a: FineTurns| ((a.raw() * i128::from(COUNTS)) >> 64) as i64;
    let mut now = 0u64;
    let mut last_edge: Option<u64> = None;
    let mut pulses = 0;
    for (rpm, ticks) in [
        (0, 3),
        (300, 800),
        (3, 2000),
        (-2, 3000),
        (-3000, 900),
        (1700, 900),
        (0, 400),
    ] {
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        for _ in 0..ticks {
            let mut pulse = None;
            s.advance(1_000_000, |piece| {
                // The edge, found by halving alone, to a nanosecond.
                let (from, to) = (count(piece.angle(0)), count(piece.angle(piece.duration())));
                if from != to {
                    let (mut early, mut late) = (0, piece.duration());
                    while late - early > 1 {
                        let half = (early + late) / 2;
                        if count(piece.angle(half)) == to {
                            late = half;
                        } else {
                            early = half;
                        }
                    }
                    last_edge = Some(now + late);
                }
                // Every count entered on the way.
                if to > from {
                    for c in from + 1..=to {
                        pulse = if c % COUNTS == 0 { Some(c) } else { pulse };
                    }
                } else {
                    for c in (to..from).rev() {
                        pulse = if c % COUNTS == 0 { Some(c) } else { pulse };
                    }
                }
                now += piece.duration();
                e.turn(piece);
            });
            let sample = e.sample();
            assert_eq!(sample.count, shown(count(s.angle())));
            assert_eq!(
                sample.edge_age_ns.map(u64::from),
                last_edge.map(|edge| now - edge),
                "at {now} ns"
            );
            assert_eq!(sample.index, pulse.map(shown), "at {now} ns");
            pulses += u32::from(sample.index.is_some());
        }
    }
    assert!(pulses > 20, "{pulses}");
}

#[test]
fn count_edge_time_and_index_are_those_of_the_true_angle() {
    encoder_against_truth(0, Turns::ZERO);
    encoder_against_truth(i32::MAX - 1000, Turns::from_raw(123_456_789));
    encoder_against_truth(-77, Turns::whole(-2));
}

#[test]
fn the_index_comes_once_a_turn_in_both_directions() {
    for rpm in [600, -600] {
        let mut s = Spindle::new(1, None, Turns::from_raw(1 << 31)).unwrap();
        let mut e = Encoder::new(4096, true, s.angle(), 0).unwrap();
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        let mut seen = Vec::new();
        for _ in 0..1000 {
            s.advance(1_000_000, |piece| e.turn(piece));
            seen.extend(e.sample().index);
        }
        let turns: Vec<i32> = seen.iter().map(|latched| latched / 4096).collect();
        let expected: Vec<i32> = if rpm > 0 {
            (1..=10).collect()
        } else {
            (-9..=0).rev().collect()
        };
        assert_eq!(turns, expected);
        assert!(seen.iter().all(|latched| latched % 4096 == 0));
    }
}

#[test]
fn without_the_hardware_there_is_no_edge_time() {
    let mut s = Spindle::new(1, None, Turns::ZERO).unwrap();
    let mut e = Encoder::new(4096, false, s.angle(), 0).unwrap();
    s.command(MilliRpm::of(Rpm::new(600), 100));
    s.advance(10_000_000, |piece| e.turn(piece));
    assert_eq!(e.sample().edge_age_ns, None);
    assert!(e.sample().count > 0);
}

/// A board without motion: masters, SYNC, and where they want the axes.
struct Bench {
    plant: Plant,
    sync: SyncProducer,
    masters: [DriveMaster; 3],
    spindle: SpindleMaster,
    speed: MilliRpm,
    frames: Vec<Frame>,
    heard: Vec<Frame>,
}

impl Bench {
    fn new(options: &PlantOptions) -> Self {
        let config = |letter, node| DriveConfig {
            letter,
            node,
            scale: Scale::new(1, 100).unwrap(),
            step: Periods::new(50),
            silence: Periods::new(12),
            following: (letter != b'S').then_some(FollowingLimit {
                increments: 10_000,
                time: Periods::new(10),
            }),
        };
        Self {
            plant: Plant::new(&Params::slant_bed(), options).unwrap(),
            sync: SyncProducer::new(),
            masters: [
                DriveMaster::new(config(b'X', NodeId::DRIVE_X)),
                DriveMaster::new(config(b'Z', NodeId::DRIVE_Z)),
                DriveMaster::new(config(b'C', NodeId::DRIVE_C)),
            ],
            spindle: SpindleMaster::new(config(b'S', NodeId::SPINDLE_1)),
            speed: MilliRpm::STOPPED,
            frames: Vec::new(),
            heard: Vec::new(),
        }
    }

    fn tick(&mut self, demands: [Option<Increments>; 3]) -> (EncoderSample, Truth) {
        let sample = self.plant.advance();
        self.frames.push(self.sync.next());
        self.heard.clear();
        let heard = &mut self.heard;
        self.plant.exchange(&self.frames, |frame| heard.push(frame));
        self.frames.clear();
        for frame in &self.heard {
            for master in &mut self.masters {
                master.receive(frame);
            }
            self.spindle.drive_mut().receive(frame);
        }
        for (master, demand) in self.masters.iter_mut().zip(demands) {
            let out = master.tick(demand);
            self.frames.extend(out.network);
            self.frames.extend(out.command);
        }
        let out = self.spindle.tick(self.speed);
        self.frames.extend(out.speed);
        self.frames.extend(out.drive.network);
        self.frames.extend(out.drive.command);
        (sample, self.plant.truth())
    }

    fn enable(&mut self) -> u32 {
        for master in &mut self.masters {
            master.enable().unwrap();
        }
        self.spindle.drive_mut().enable().unwrap();
        for tick in 1..200 {
            self.tick([None; 3]);
            let all = self.masters.iter().all(DriveMaster::is_enabled);
            if all && self.spindle.drive().is_enabled() {
                return tick;
            }
        }
        panic!("not enabled: {:?}", self.masters.map(|m| m.phase()));
    }
}

fn standing_at(x_um: i64, z_um: i64) -> PlantOptions {
    PlantOptions {
        at: Position {
            x: Length::from_nm(x_um * 1000),
            z: Length::from_nm(z_um * 1000),
            ..Position::default()
        },
        ..PlantOptions::default()
    }
}

#[test]
fn the_master_enables_the_drives_where_they_stand() {
    let mut bench = Bench::new(&standing_at(150_000, -20_000));
    let before = bench.plant.truth().positions;
    assert_eq!(before.map(Increments::get), [1_500_000, -200_000, 0]);
    let ticks = bench.enable();
    // Contact, and three changes of state, each told at every 4th SYNC.
    assert!(ticks <= 4 * 4 + 3, "{ticks}");
    assert_eq!(bench.plant.truth().positions, before);
    assert_eq!(bench.plant.drive(Axis::X).power(), Power::Enabled);
    // Taken up where it stands; then a demand is where the drive is at the SYNC after it was sent.
    bench.tick([Some(Increments::new(1_500_000)), None, None]);
    bench.tick([Some(Increments::new(1_500_003)), None, None]);
    let (_, truth) = bench.tick([None; 3]);
    assert_eq!(truth.positions[0].get(), 1_500_003);
}

#[test]
fn a_slow_drive_is_waited_for_and_a_too_slow_one_named() {
    let options = |settling| PlantOptions {
        drives: DriveOptions {
            settling,
            ..DriveOptions::default()
        },
        ..PlantOptions::default()
    };
    assert!(Bench::new(&options(20)).enable() > 40);

    let mut bench = Bench::new(&options(1000));
    bench.masters[0].enable().unwrap();
    for _ in 0..200 {
        bench.tick([None; 3]);
    }
    let alarm = bench.masters[0].alarm().unwrap();
    assert_eq!(alarm.number(), 4354, "it became ready and went no further");
    assert_eq!(bench.masters[0].phase(), Phase::Standby);
}

#[test]
fn troubles_are_told_by_name() {
    let cases = [
        (Trouble::Silent, 4360),
        (Trouble::Stuck, 4361),
        (Trouble::Fault(0x7305), 4357),
        (Trouble::TorqueOff, 4358),
    ];
    for (trouble, number) in cases {
        let mut bench = Bench::new(&PlantOptions::default());
        bench.enable();
        bench.plant.drive(Axis::Z).trouble(trouble);
        let mut z = bench.masters[1].target().get();
        for _ in 0..60 {
            bench.tick([None, Some(Increments::new(z)), None]);
            z += 500;
        }
        let alarm = bench.masters[1].alarm().unwrap();
        assert_eq!(alarm.number(), number, "{trouble:?}");
        assert_eq!(bench.masters[0].failure(), None);
        if let Trouble::Fault(sent) = trouble {
            let Some(DriveFailure::Fault { code, .. }) = bench.masters[1].failure() else {
                panic!("no fault");
            };
            assert_eq!(code, sent);
        }
    }
}

#[test]
fn a_drive_that_restarts_says_so() {
    let mut bench = Bench::new(&PlantOptions::default());
    bench.enable();
    bench.plant.drive(Axis::X).restart();
    bench.tick([None; 3]);
    assert_eq!(bench.heard[0], NmtState::BootUp.frame(NodeId::DRIVE_X));
    assert_eq!(bench.masters[0].failure(), Some(DriveFailure::Restarted));
    // Reset, and it can be used again.
    bench.masters[0].reset();
    bench.masters[0].enable().unwrap();
    for _ in 0..40 {
        bench.tick([None; 3]);
    }
    assert!(bench.masters[0].is_enabled());
}

#[test]
fn the_spindle_turns_as_its_drive_is_told() {
    let mut bench = Bench::new(&PlantOptions::default());
    bench.enable();
    assert_eq!(bench.plant.truth().speed, MilliRpm::STOPPED);
    bench.speed = MilliRpm::of(Rpm::new(300), 100);
    bench.tick([None; 3]);
    bench.tick([None; 3]);
    // The ramp of 150 ms begins at that SYNC: 0.375 turns, then 5 a second.
    let mut last = bench.plant.truth();
    for _ in 0..1150 {
        (_, last) = bench.tick([None; 3]);
    }
    assert_eq!(last.speed.get(), 300_000);
    assert_eq!(last.angle.micro_turns(), 5_375_000);
    // Its status carries the encoder.
    let status = (0..4)
        .find_map(|_| {
            bench.tick([None; 3]);
            let angle = bench.plant.truth().angle.turns().raw();
            bench
                .heard
                .iter()
                .filter_map(leadscrew_core::bus::DriveStatus::decode)
                .find(|(node, _)| *node == NodeId::SPINDLE_1)
                .map(|(_, status)| (status, angle))
        })
        .unwrap();
    assert_eq!(i64::from(status.0.actual.get()), (status.1 * 4096) >> 32);
}

#[test]
fn a_spindle_enabled_again_does_not_start_by_itself() {
    let mut bench = Bench::new(&PlantOptions::default());
    bench.enable();
    bench.speed = MilliRpm::of(Rpm::new(300), 100);
    for _ in 0..300 {
        bench.tick([None; 3]);
    }
    assert_eq!(bench.plant.truth().speed.get(), 300_000);
    // A fault stops it. The cause goes away, the fault is reset, the drive enabled.
    let spindle_drive = |bench: &mut Bench, trouble| bench.plant.spindle_drive().trouble(trouble);
    spindle_drive(&mut bench, Trouble::Fault(0x3210));
    for _ in 0..300 {
        bench.tick([None; 3]);
    }
    assert_eq!(bench.spindle.drive().alarm().unwrap().number(), 4357);
    spindle_drive(&mut bench, Trouble::None);
    bench.speed = MilliRpm::STOPPED;
    bench.spindle.drive_mut().reset();
    for _ in 0..10 {
        bench.tick([None; 3]);
    }
    bench.spindle.drive_mut().enable().unwrap();
    for _ in 0..100 {
        bench.tick([None; 3]);
        assert_eq!(bench.plant.truth().speed, MilliRpm::STOPPED);
    }
    assert!(bench.spindle.drive().is_enabled());
}

#[test]
fn drives_answer_every_fourth_sync() {
    let mut bench = Bench::new(&PlantOptions::default());
    bench.enable();
    let mut answers = Vec::new();
    for tick in 0..40 {
        bench.tick([None; 3]);
        for frame in &bench.heard {
            answers.push((tick % 4, frame.id().get()));
        }
    }
    let phase = answers[0].0;
    let once: Vec<_> = [0x190, 0x191, 0x192, 0x1A0]
        .into_iter()
        .map(|id| (phase, id))
        .collect();
    assert_eq!(answers, vec![once; 10].concat());
}

#[test]
fn the_same_frames_give_the_same_bits() {
    let run = || {
        let mut bench = Bench::new(&PlantOptions {
            ripple: Ripple::new(10_000, 5_000),
            ..PlantOptions::default()
        });
        bench.enable();
        bench.speed = MilliRpm::new(-123_456);
        (0..500).map(|_| bench.tick([None; 3])).collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }
}

#[test]
fn whatever_happens_no_axis_jumps() {
    // Drives that fail, restart, go silent and come back at random; an operator who enables, disables and resets at
    // random. An axis moves only by its demands, at most 500 increments a tick, and never because of a start-up.
    const STEP: i32 = 500;
    let mut random = Random(7);
    let (mut enabled_again, mut failures, mut moved) = (0, 0, 0u64);
    for round in 0..60u16 {
        let mut bench = Bench::new(&PlantOptions {
            drives: DriveOptions {
                transmission: 1 + (round % 5) as u8,
                settling: round % 7,
                lag: 0,
            },
            ..standing_at(1000, -1000)
        });
        let mut demand = [0; 3];
        let mut was_enabled = [false; 3];
        let mut before = bench.plant.truth().positions;
        for tick in 0..2000 {
            for (axis, which) in Axis::ALL.into_iter().zip(0..) {
                let master: &mut DriveMaster = &mut bench.masters[which];
                match random.below(400) {
                    0..8 => drop(master.enable()),
                    8 => master.disable(),
                    9..12 => master.reset(),
                    12 => bench.plant.drive(axis).trouble(Trouble::Silent),
                    13 => bench.plant.drive(axis).trouble(Trouble::Fault(0x5000)),
                    14 => bench.plant.drive(axis).trouble(Trouble::TorqueOff),
                    15 => bench.plant.drive(axis).restart(),
                    16..24 => bench.plant.drive(axis).trouble(Trouble::None),
                    _ => {}
                }
                let master = &bench.masters[which];
                if master.is_enabled() {
                    if was_enabled[which] {
                        demand[which] += random.below(2 * STEP as u64 + 1) as i32 - STEP;
                    } else {
                        enabled_again += 1;
                        demand[which] = master.target().get();
                    }
                }
                was_enabled[which] = master.is_enabled();
                failures += u32::from(master.failure().is_some());
            }
            bench.tick(demand.map(|d| Some(Increments::new(d))));
            let now = bench.plant.truth().positions;
            for ((a, b), axis) in before.into_iter().zip(now).zip(Axis::ALL) {
                let step = a.distance(b);
                assert!(
                    step <= STEP as u32,
                    "round {round}, tick {tick}, {axis:?}: {step}"
                );
            }
            moved += u64::from(before != now);
            before = now;
        }
    }
    // It was not all standstill.
    assert!(
        enabled_again > 500 && failures > 1000,
        "{enabled_again}, {failures}"
    );
    assert!(moved > 60 * 1000, "{moved}");
}
