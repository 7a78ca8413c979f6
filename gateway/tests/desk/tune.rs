//! The lag of a simulated drive whose Kv is known, found over the bus of a machine that stays.

use crate::{User, bad, good};

/// Two passes of one thread, at 100 and at 600 revolutions.
const TWO_SPEEDS: &str = include_str!("../cli/two-speeds.nc");

#[test]
fn the_lag_of_a_known_drive_is_found_and_written() {
    let user = User::new();
    good(&user.does(&["up", "--drive", "kv30", "--set", "1828.Z=20"]));
    let tune = ["tune", "Z-", "--dead-time", "1000"];
    let told = user.json(&tune);
    // 1/Kv, a period of interpolation, and the inner step of the simulated drive.
    let exact = 1e6 / 30.0 + 1000.0 - 125.0;
    let lag = told["lag_us"]["value"].as_f64().unwrap();
    assert!((lag - exact).abs() <= 2.0, "{told}");
    // That step is not in the dead time that was given, so it makes the gain look 0.4 % higher.
    let kv = told["kv_per_s"].as_f64().unwrap();
    assert!((kv - 1e6 / (exact - 1000.0)).abs() < 0.01, "{told}");
    // Nothing has been written yet.
    assert_eq!(
        user.json(&["params", "get", "9070.Z"])["params"][0]["value"],
        0
    );
    good(&user.does(&[&tune[..], &["--write", "-o", "z.svg"]].concat()));
    let written = user.json(&["params", "get", "9070.Z", "9003.Z"]);
    assert_eq!(written["params"][0]["value"], 301);
    // What 30.1 /s leaves of the lag.
    let left = written["params"][1]["value"].as_f64().unwrap();
    assert!((left - (exact - 1e7 / 301.0)).abs() <= 3.0, "{written}");
    assert!(
        std::fs::read_to_string(user.0.join("z.svg"))
            .unwrap()
            .contains("<svg")
    );
    // A thread at two speeds with these parameters: before, the grooves lie 1660 µm apart.
    std::fs::write(user.0.join("two.nc"), TWO_SPEEDS).unwrap();
    good(&user.does(&["params", "pull", "-o", "tuned.toml"]));
    let told = user.json(&[
        "simulate",
        "two.nc",
        "--bus",
        "sim",
        "--params",
        "tuned.toml",
        "--drive",
        "Z=kv30",
    ]);
    let shift = told["cut"]["shift_um"].as_f64().unwrap();
    assert!(shift < 1.0, "{shift} µm");
}

#[test]
fn without_a_dead_time_nothing_moves() {
    let user = User::with_machine();
    let told = bad(&user.does(&["tune", "Z-"]), 2);
    assert!(told.contains("--dead-time US"), "{told}");
    assert_eq!(user.json(&["status"])["mz"], 0);
    let told = bad(
        &user.does(&["tune", "Z-", "--dead-time", "1000", "-o", "z.gif"]),
        2,
    );
    assert!(
        told.contains("`.svg`, `.png`, `.html` or `.json`"),
        "{told}"
    );
}
