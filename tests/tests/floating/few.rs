//! Ordinary taps by encoders of few timed counts: what a check lets pass keeps to the axis' acceleration, also where the
//! spindle turns back.

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::hole::Hole;
use super::ripple::is_feasible;

#[test]
fn an_encoder_of_few_counts_does_not_shake_the_axis_where_the_spindle_turns_back() {
    leadscrew_seed::volume(0x00FE_3A11, |seed| {
        let mut random = Random(seed);
        let mut tapped = 0;
        while tapped < leadscrew_seed::amount(40, 200) {
            let r = &mut random;
            let params = with(&[
                ("3720", r.of(&[25, 60, 100, 150, 240, 360, 500, 700, 999])),
                ("9000", r.of(&[1000, 1000, 2000])),
                ("9006.0", 1),
                ("1620.Z", r.within(1_500, 9_000) * 1_000_000),
                ("1622.Z", r.within(30, 120) * 1_000_000_000),
                ("1828.Z", 6_000_000),
            ]);
            let rpm = r.within(100, 1_500);
            let depth = r.within(2_000, 12_000);
            let peck = (depth / r.within(2, 4), r.within(100, 1_000));
            let hole = Hole {
                rpm: (rpm * r.sign()) as i32,
                lead: r.within(400, (3_500_000 / rpm).min(2_500)),
                depth,
                approach: r.within(2_000, 5_000),
                peck: r.of(&[(0, 0), peck]),
                dwell: 0,
            };
            let size = r.within(0, 3_000) as u32;
            let plant = PlantOptions {
                ripple: Ripple::new(r.of(&[0, size]), r.within(2_000, 12_000) as u32),
                ..PlantOptions::default()
            };
            let turn = if hole.rpm < 0 { "M4" } else { "M3" };
            let block = hole.block(0);
            let text = format!("G18 {turn} S{rpm}\n{block}\nG80\nM30\n");
            if !is_feasible(&text, &params) {
                continue;
            }
            tapped += 1;
            let ran = run(&text, &params, &plant, |_, _| ());
            assert_eq!(ran.alarm, None, "{hole:?}\n{text}");
            let tick = f64::from(params.tick_us()) * 1e-6;
            let limit = params.acceleration(Axis::Z).nm_per_s2() as f64 * tick * tick;
            for rows in ran.rows.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|row| rows[row].position.z.nm());
                let most = (c - 2 * b + a).abs() as f64;
                // As for other encoders, what the unevenness of a spindle adds.
                assert!(
                    most <= 1.1 * limit + 2.0,
                    "{most} nm in tick {}, limit {limit}, {} counts: {hole:?}",
                    rows[2].tick,
                    params.encoder_counts()
                );
            }
        }
    });
}
