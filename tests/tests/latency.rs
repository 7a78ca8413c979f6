//! Drives of X and Z with unequal latency: each axis is at its place at the instant at which its own drive carries out the
//! setpoint, and within its limits. A pass is judged by the axis that is held to the spindle.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;

const RUN_IN_TAPER_RUN_OUT: &str = "M3 S300\nG0 X20 Z10\nG78 P010360 Q0.1 R0.05 L2 E1.5\n\
    G78 X30 Z-20 R-0.8 P1.2 Q0.8 F2 J1 K2\nM30\n";
const LONG_X: &str = "M3 S300\nG0 X80 Z10\nG78 P010060 Q0.1 R0.05\n\
    G78 X60 Z0 R-30 P1 Q0.8 F2 J1 K2\nM30\n";

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
