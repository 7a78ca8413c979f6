//! The lag of a simulated drive whose Kv is known, found over the bus of a machine that stays.

use crate::{User, bad, good};

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
    let kv = told["kv_per_s"].as_f64().unwrap();
    let ff = told["feed_forward"].as_f64().unwrap();
    assert!(
        ((1.0 - ff) / kv * 1e6 - (exact - 1000.0)).abs() <= 2.0,
        "{told}"
    );
    // Nothing has been written yet.
    assert_eq!(
        user.json(&["params", "get", "9070.Z"])["params"][0]["value"],
        0
    );
    good(&user.does(&[&tune[..], &["--write", "-o", "z.svg"]].concat()));
    let written = user.json(&["params", "get", "9070.Z", "9003.Z"]);
    assert!(
        written["params"][0]["value"].as_f64().unwrap() > 100.0,
        "{written}"
    );
    assert_eq!(written["params"][1]["value"], 1000);
    assert!(
        std::fs::read_to_string(user.0.join("z.svg"))
            .unwrap()
            .contains("<svg")
    );
}

#[test]
fn without_a_dead_time_nothing_moves() {
    let user = User::with_machine();
    let told = bad(&user.does(&["tune", "Z-"]), 2);
    assert!(told.contains("--dead-time US"), "{told}");
    assert_eq!(user.json(&["status"])["mz"], 0);
    let told = bad(
        &user.does(&["tune", "Z-", "--dead-time", "1000", "-o", "z.png"]),
        2,
    );
    assert!(told.contains("`.svg`, `.html` or `.json`"), "{told}");
}
