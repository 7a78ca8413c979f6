//! Drives of X and Z with unequal latency: each axis is at its place at the instant at which its own drive carries out the
//! setpoint, and within its limits. A pass is judged by the axis that is held to the spindle.

use leadscrew_board_sim::Row;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::Command;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_seed::{Random, amount, volume};
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{Pause, Ran, run};
use leadscrew_tests::params::{set, with};

const RUN_IN_TAPER_RUN_OUT: &str = "M3 S300\nG0 X20 Z10\nG78 P010360 Q0.1 R0.05 L2 E1.5\n\
    G78 X30 Z-20 R-0.8 P1.2 Q0.8 F2 J1 K2\nM30\n";
const LONG_X: &str = "M3 S300\nG0 X80 Z10\nG78 P010060 Q0.1 R0.05\n\
    G78 X60 Z0 R-30 P1 Q0.8 F2 J1 K2\nM30\n";

/// The last stroke has another long axis.
const CHAIN: &str = "M3 S600\nG0 X40 Z5\nG32 X50 Z-10 F2\nX44 Z-25 F3\nX60 Z-32 F2\nM30\n";

#[test]
fn unequal_latencies_break_no_limit_and_no_certificate() {
    for program in [RUN_IN_TAPER_RUN_OUT, LONG_X] {
        for (x, z) in [(0, 3_500), (3_500, 0), (300, 2_500), (3_700, 500)] {
            let params = with(&[("9003.X", x), ("9003.Z", z)]);
            let ran = run(program, &params, &PlantOptions::default(), |_, _| {});
            assert_eq!(ran.alarm, None, "{x} {z}");
            assert_eq!(first_excess(&ran.rows, &params), None, "{x} {z}\n{program}");
            let errors = ran.rows.iter().filter_map(|row| row.error);
            let worst = errors.map(|error| error.nm().abs()).max();
            assert!(
                worst.is_some_and(|nm| nm <= 10),
                "{x} {z}: {worst:?} nm\n{program}"
            );
        }
    }
}

fn along(row: &Row, axis: Axis) -> i64 {
    match axis {
        Axis::X => row.position.x.nm(),
        _ => row.position.z.nm(),
    }
}

/// These latencies. A drive may be as far behind as it is at its rapid.
fn late(x: i64, z: i64) -> Params {
    let far = 20_000_000;
    with(&[
        ("9003.X", x),
        ("9003.Z", z),
        ("1828.X", far),
        ("1828.Z", far),
    ])
}

/// From this tick on no axis exceeds its acceleration: no setpoint leaps.
fn leaps_nowhere(ran: &Ran, params: &Params, from: u64, what: &str) {
    for axis in [Axis::X, Axis::Z] {
        let most = params.acceleration(axis).nm_per_s2() as f64 * 1e-6;
        let places = ran.rows.iter().map(|row| (row.tick, along(row, axis)));
        let places: Vec<(u64, i64)> = places.collect();
        for three in places.windows(3) {
            let [(_, a), (_, b), (at, c)] = [three[0], three[1], three[2]];
            let size = (c - 2 * b + a).abs();
            assert!(
                at < from || size as f64 <= 1.2 * most + 2.0,
                "{what} at {from}: {axis:?} {size} nm at {at}, limit {most}"
            );
        }
    }
}

/// The ticks in which the long axis is on its helix, where nothing comes between.
fn led(program: &str, params: &Params) -> Vec<u64> {
    let calm = run(program, params, &PlantOptions::default(), |_, _| {});
    assert_eq!(calm.alarm, None, "{program}");
    let led = calm.rows.iter().filter(|row| row.error.is_some());
    led.map(|row| row.tick).collect()
}

/// In a stop the axis with the other latency goes on from where it is ahead or behind: it leapt by the way of the
/// difference before, 0.3 mm and more.
#[test]
fn a_stop_anywhere_breaks_no_limit_with_unequal_latencies() {
    for program in [RUN_IN_TAPER_RUN_OUT, LONG_X, CHAIN] {
        for (x, z) in [(0, 9_000), (9_000, 0), (875, 3_500)] {
            let params = late(x, z);
            let led = led(program, &params);
            let step = amount(led.len() / 40, led.len() / 200).max(1);
            for tick in led.iter().step_by(step) {
                let ran = run(program, &params, &PlantOptions::default(), |sim, ticks| {
                    if ticks == *tick {
                        sim.command(Command::Stop);
                    }
                });
                assert!(ran.alarm.is_some(), "{x} {z} {tick}");
                leaps_nowhere(&ran, &params, *tick, &format!("{x} {z}, stop\n{program}"));
                let last = ran.rows.last().expect("rows").position;
                let [.., before, _] = ran.rows.as_slice() else {
                    panic!()
                };
                assert_eq!(before.position, last, "it rests");
            }
        }
    }
}

/// What comes in a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comes {
    Stop,
    Reset,
    /// The pass is finished.
    Hold,
    /// The thread is left at once.
    HoldThatRetracts,
}

/// One of these comes in one of `ticks`, often.
fn comes(
    seed: u64,
    often: usize,
    all: &[Comes],
    programs: &[&str],
    latencies: &[(i64, i64)],
    ticks: impl Fn(&[u64]) -> Vec<u64>,
) {
    let mut random = Random(seed);
    for program in programs {
        for (x, z) in latencies {
            for what in all {
                let retracts = i64::from(*what == Comes::HoldThatRetracts);
                let mut params = late(*x, *z);
                set(&mut params, "9008.0", retracts);
                let ticks = ticks(&led(program, &params));
                for _ in 0..often {
                    let at = ticks[random.index(ticks.len())];
                    let mut pause = Pause::new(at, 50);
                    let ran =
                        run(
                            program,
                            &params,
                            &PlantOptions::default(),
                            |sim, ticks| match what {
                                Comes::Stop if ticks == at => sim.command(Command::Stop),
                                Comes::Reset if ticks == at => sim.command(Command::Reset),
                                Comes::Stop | Comes::Reset => {}
                                Comes::Hold | Comes::HoldThatRetracts => pause.operate(sim, ticks),
                            },
                        );
                    let stops = *what == Comes::Stop;
                    let what = format!("{x} {z}, {what:?}\n{program}");
                    assert_eq!(
                        ran.alarm.is_some(),
                        stops,
                        "{what} at {at}: {:?}",
                        ran.alarm
                    );
                    leaps_nowhere(&ran, &params, at, &what);
                }
            }
        }
    }
}

/// The way out of a thread begins where the axis is that is ahead. It began where the long one is, and the short one was
/// in the middle of it at once: 80 µm with 20 ms.
#[test]
fn the_way_out_of_a_thread_breaks_no_limit_with_unequal_latencies() {
    volume(527, |seed| {
        comes(
            seed,
            amount(6, 12),
            &[Comes::Reset, Comes::HoldThatRetracts],
            &[RUN_IN_TAPER_RUN_OUT, LONG_X],
            &[(0, 9_000), (9_000, 0), (20_000, 0), (0, 20_000)],
            <[u64]>::to_vec,
        );
    });
}

/// The short axis may have left the start while the long one still waits: it leapt back to it.
#[test]
fn a_pass_that_has_begun_with_one_axis_has_begun() {
    volume(528, |seed| {
        comes(
            seed,
            amount(5, 9),
            &[
                Comes::Stop,
                Comes::Reset,
                Comes::Hold,
                Comes::HoldThatRetracts,
            ],
            &[RUN_IN_TAPER_RUN_OUT, LONG_X, CHAIN],
            &[(20_000, 0), (0, 20_000)],
            |led| {
                // From rest to the helix it takes less.
                let before = |tick: u64| tick.saturating_sub(80)..tick;
                let first = led.iter().take(1).copied();
                let gaps = led.windows(2).filter(|two| two[1] > two[0] + 100);
                let firsts = first.chain(gaps.map(|two| two[1]));
                firsts.flat_map(before).collect()
            },
        );
    });
}
