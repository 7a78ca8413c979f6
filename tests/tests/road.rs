//! From text to setpoints: whole programs on the simulated machine.

use leadscrew_core::params::Params;
use leadscrew_tests::machine::run;

const O0013: &str = include_str!("../../examples/o0013-g76-m68x6.nc");

#[test]
fn the_thread_of_the_sheet_runs_to_its_end_on_the_helix() {
    let params = Params::sheets();
    let ran = run(O0013, &params, &Default::default(), |_, _| {});
    assert_eq!(ran.alarm, None);
    let last = ran.rows.last().expect("rows");
    // X100 Z50 is the machine's zero of this program.
    assert_eq!((last.position.x.nm(), last.position.z.nm()), (0, 0));
    let worst = ran
        .rows
        .iter()
        .filter_map(|row| row.error)
        .map(|error| error.nm().abs())
        .max()
        .expect("something was locked");
    assert!(worst <= 1_000, "{worst} nm");
}
