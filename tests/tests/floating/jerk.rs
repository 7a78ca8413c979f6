//! The jerk of ordinary taps where the spindle turns round: the figures of decision D204, which say by how much the limit
//! is not held, and that speed and acceleration are.

use leadscrew_board_sim::Row;
use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;
use leadscrew_tests::watch::Watch;

use super::ripple::is_feasible;

/// Taps, with Z watched.
fn tapped(text: &str, params: &Params, ripple: Option<Ripple>) -> Watch {
    let plant = PlantOptions {
        ripple,
        ..PlantOptions::default()
    };
    let ran = run(text, params, &plant, |_, _| ());
    assert_eq!(ran.alarm, None, "{text}");
    let place = |row: &Row| row.position.z.nm();
    let mut watch = Watch::new(params, Axis::Z, place(&ran.rows[0]));
    for row in &ran.rows {
        watch.see(place(row));
    }
    watch
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
        let params = with(&[("9006.0", i64::from(timed))]);
        let [_, acceleration, jerk] = tapped(&text, &params, None).worst;
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
        while tried < leadscrew_seed::amount(30, 200) {
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
            let watch = tapped(&text, &params, ripple);
            let [_, acceleration, jerk] = watch.worst;
            assert!(acceleration <= 1.1, "{acceleration}: {text}");
            let counts = i64::from(params.encoder_counts());
            let count = (lead * 1_000 / counts) as f64 / watch.jerk;
            assert!(jerk <= count + 1.3, "{jerk}, a count is {count}: {text}");
        }
    });
}
