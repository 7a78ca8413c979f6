//! The jerk of ordinary taps where the spindle turns round: the figures of decision D204, which say by how much the limit
//! is not held, and that speed and acceleration are.

use leadscrew_board_sim::Row;
use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::ripple::is_feasible;

/// The most of acceleration and of jerk along Z, as multiples of their limits.
fn most(rows: &[Row], params: &Params) -> [f64; 2] {
    let tick = f64::from(params.tick_us()) * 1e-6;
    let acceleration = params.acceleration(Axis::Z).nm_per_s2() as f64 * tick.powi(2);
    let jerk = jerk_of_a_tick(params);
    let mut most = [0.0_f64; 2];
    for rows in rows.windows(4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|row| rows[row].position.z.nm());
        // What rounding to nanometres adds is no motion.
        let beyond = |nm: i64, rounding: i64| (nm.abs() - rounding).max(0) as f64;
        most[0] = most[0].max(beyond(d - 2 * c + b, 2) / acceleration);
        most[1] = most[1].max(beyond(d - 3 * c + 3 * b - a, 4) / jerk);
    }
    most
}

/// The limit of the third difference of positions along Z, in nanometres.
fn jerk_of_a_tick(params: &Params) -> f64 {
    let tick = f64::from(params.tick_us()) * 1e-6;
    params.jerk(Axis::Z).nm_per_s3() as f64 * tick.powi(3)
}

fn tapped(text: &str, timed: bool, ripple: Option<Ripple>) -> [f64; 2] {
    let params = with(&[("9006.0", i64::from(timed))]);
    let plant = PlantOptions {
        ripple,
        ..PlantOptions::default()
    };
    let ran = run(text, &params, &plant, |_, _| ());
    assert_eq!(ran.alarm, None, "{text}");
    most(&ran.rows, &params)
}

/// A hole from R −3 to Z −20 in pecks, 0: in one; lead and peck in micrometres.
fn hole(rpm: i64, lead: i64, peck: i64) -> String {
    let peck = if peck == 0 {
        String::new()
    } else {
        format!(" Q{}.{:03}", peck / 1000, peck % 1000)
    };
    let feed = rpm * lead;
    format!(
        "G98\nM3 S{rpm}\nG0 X0 Z0\nG84 Z-20 R-3{peck} F{}.{:03}\nG80\nM30\n",
        feed / 1000,
        feed % 1000
    )
}

#[test]
fn taps_in_pecks_exceed_the_jerk_by_no_more_than_is_told() {
    for (rpm, lead, peck, timed, [low, high]) in [
        (400, 1_250, 3_000, true, [4.0, 5.0]),
        (200, 1_750, 3_000, true, [5.0, 6.0]),
        (150, 2_000, 3_000, true, [6.0, 6.8]),
        (100, 2_500, 3_000, true, [9.5, 10.7]),
        (300, 4_000, 3_000, true, [12.0, 13.6]),
        (400, 1_250, 0, true, [0.9, 1.3]),
        (100, 2_500, 0, true, [0.9, 1.3]),
        (400, 1_250, 0, false, [5.4, 22.0]),
    ] {
        let text = hole(rpm, lead, peck);
        let [acceleration, jerk] = tapped(&text, timed, None);
        assert!(acceleration <= 1.0, "{acceleration}: {text}");
        assert!((low..=high).contains(&jerk), "{jerk}: {text}");
    }
}

/// Near standstill a measured angle may be off by a part of a count, and no two of them by more than one.
#[test]
fn no_tap_exceeds_the_jerk_by_more_than_a_count() {
    leadscrew_seed::volume(204, |seed| {
        let random = &mut Random(seed);
        let params = with(&[("9006.0", 1)]);
        let mut tried = 0;
        while tried < leadscrew_seed::amount(30, 1_500) {
            let rpm = random.within(100, 1_500);
            let lead = random.within(400, (3_500_000 / rpm).min(4_000));
            let text = hole(rpm, lead, random.within(1_000, 8_000));
            if !is_feasible(&text, &params) {
                continue;
            }
            tried += 1;
            // Up to 5 %, once in 500 to 50 ms.
            let size = random.within(0, 5_000) as u32;
            let ripple = Ripple::new(random.of(&[0, size]), random.within(2_000, 20_000) as u32);
            let [acceleration, jerk] = tapped(&text, true, ripple);
            assert!(acceleration <= 1.1, "{acceleration}: {text}");
            let counts = i64::from(params.encoder_counts());
            let count = (lead * 1_000 / counts) as f64 / jerk_of_a_tick(&params);
            assert!(jerk <= count + 1.3, "{jerk}, a count is {count}: {text}");
        }
    });
}
