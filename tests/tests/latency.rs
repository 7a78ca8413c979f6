//! Drives of X and Z with unequal latency: each axis is at its place at the instant at which its own drive carries out the
//! setpoint, and within its limits. A pass is judged by the axis that is held to the spindle.

use leadscrew_board_sim::Row;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::Command;
use leadscrew_core::units::Axis;
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;

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

/// In a stop the axis with the other latency goes on from where it is ahead or behind: it leapt by the way of the
/// difference before, 0.3 mm and more.
#[test]
fn a_stop_anywhere_breaks_no_limit_with_unequal_latencies() {
    for program in [RUN_IN_TAPER_RUN_OUT, LONG_X, CHAIN] {
        for (x, z) in [(0, 9_000), (9_000, 0), (875, 3_500)] {
            let params = with(&[("9003.X", x), ("9003.Z", z)]);
            let calm = run(program, &params, &PlantOptions::default(), |_, _| {});
            let led: Vec<u64> = calm
                .rows
                .iter()
                .filter(|row| row.error.is_some())
                .map(|row| row.tick)
                .collect();
            let step = leadscrew_seed::amount(led.len() / 40, led.len() / 400).max(1);
            for tick in led.iter().step_by(step) {
                let ran = run(program, &params, &PlantOptions::default(), |sim, ticks| {
                    if ticks == *tick {
                        sim.command(Command::Stop);
                    }
                });
                assert!(ran.alarm.is_some(), "{x} {z} {tick}");
                for axis in [Axis::X, Axis::Z] {
                    let most = params.acceleration(axis).nm_per_s2() as f64 * 1e-6;
                    let places = ran.rows.iter().map(|row| (row.tick, along(row, axis)));
                    let places: Vec<(u64, i64)> = places.collect();
                    for three in places.windows(3) {
                        let [(_, a), (_, b), (at, c)] = [three[0], three[1], three[2]];
                        let size = (c - 2 * b + a).abs();
                        assert!(
                            at < *tick || size as f64 <= 1.2 * most + 2.0,
                            "{x} {z}, stop at {tick}: {axis:?} {size} nm at {at}, limit {most}\n{program}"
                        );
                    }
                }
                let last = ran.rows.last().expect("rows").position;
                let [.., before, _] = ran.rows.as_slice() else {
                    panic!()
                };
                assert_eq!(before.position, last, "it rests");
            }
        }
    }
}
