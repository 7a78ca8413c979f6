//! The lag of a simulated drive whose Kv is known, found over the bus of a machine that stays.

use crate::{User, bad, good};

/// Two passes of one thread, at 100 and at 600 revolutions.
const TWO_SPEEDS: &str = include_str!("../cli/two-speeds.nc");

#[test]
fn the_lag_of_a_known_drive_is_found_and_written() {
    let user = User::new();
    // The axis moves as by hand, and this computer has other work: its frames may come late.
    let set = ["--set", "1828.Z=20", "--set", "9040=500"];
    good(&user.does(&[&["up", "--drive", "kv30"], &set[..]].concat()));
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
    // The lead that the board gives the drive now makes its targets' steps differ: the lag is still found.
    let again = user.json(&tune);
    let lag = again["lag_us"]["value"].as_f64().unwrap();
    assert!((lag - exact).abs() <= 2.0, "{again}");
    let left = again["left_before_us"].as_f64().unwrap();
    assert!(left.abs() < 3.0, "{again}");
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

#[test]
fn the_ramp_and_the_ripple_of_a_known_spindle_are_found_and_written() {
    let user = User::new();
    let spindle = ["--spindle-ramp", "800", "--spindle-ripple", "20@5.3"];
    good(&user.does(&[&["up"], &spindle[..], &["--set", "9024=0"]].concat()));
    let tune = [
        "tune",
        "spindle",
        "--speeds",
        "211,503,887",
        "--seconds",
        "5",
    ];
    let told = user.json(&tune);
    let ramp = told["ramp_ms"].as_f64().unwrap();
    // The ripple goes on in the ramp.
    assert!((800.0..1200.0).contains(&ramp), "{told}");
    let run_ups = told["run_ups"].as_array().unwrap();
    for (run_up, asked) in run_ups.iter().zip([211.0, 503.0, 887.0]) {
        let mean = run_up["mean_rpm"].as_f64().unwrap();
        assert!((mean / asked - 1.0).abs() < 0.005, "{told}");
    }
    let line = &told["lines"][0];
    let (hz, percent) = (line["hz"].as_f64().unwrap(), &line["percent"]);
    assert!((hz - 5.3).abs() < 0.05, "{told}");
    assert!((percent.as_f64().unwrap() - 20.0).abs() < 1.0, "{told}");
    assert_eq!(line["speeds"], 3, "{told}");
    // Nothing has been written, and the spindle stands.
    let get = ["params", "get", "9004", "9010"];
    let values = |user: &User| {
        let got = user.json(&get);
        [0, 1].map(|place| got["params"][place]["value"].as_f64().unwrap())
    };
    assert_eq!(values(&user), [500.0, 15.0]);
    assert_eq!(user.json(&["status"])["rpm_commanded"], 0);
    let two = [
        "tune",
        "spindle",
        "--speeds",
        "211,503",
        "--seconds",
        "5",
        "--write",
        "-o",
        "s.svg",
    ];
    good(&user.does(&two));
    let [ramp, room] = values(&user);
    assert!((800.0..1200.0).contains(&ramp), "{ramp}");
    assert!((20.0..24.0).contains(&room), "{room}");
    let drawn = std::fs::read_to_string(user.0.join("s.svg")).unwrap();
    assert!(drawn.contains("<polyline") && drawn.contains("S503"));
}

/// An encoder of 4096 counts whose edges have no times learns a swing of a known frequency.
#[test]
fn the_swing_of_the_drive_is_written_where_the_encoder_learns_it() {
    let user = User::new();
    good(&user.does(&["up", "--spindle-ripple", "4@5.3"]));
    good(&user.does(&["params", "set", "9006.0=0", "9024=0"]));
    let two = ["tune", "spindle", "--speeds", "211,503", "--seconds", "5"];
    good(&user.does(&[&two[..], &["--write"]].concat()));
    let got = user.json(&["params", "get", "9034"]);
    let written = got["params"][0]["value"].as_f64().unwrap();
    assert!((written - 5300.0).abs() < 50.0, "{got}");
}

#[test]
fn a_spindle_is_not_tuned_without_speeds_or_while_it_turns() {
    let user = User::with_machine();
    for (args, says) in [
        (&["tune", "spindle"][..], "--speeds"),
        (&["tune", "spindle", "--speeds", "300"], "two to 6"),
        (
            &["tune", "spindle", "--speeds", "300,3001"],
            "the highest speed of this spindle is 3000 rpm",
        ),
        (
            &["tune", "spindle", "--speeds", "300,500", "--age", "3"],
            "`--age` is for the drive of an axis",
        ),
        (&["tune", "Z-", "--speeds", "300,500"], "tune spindle"),
        (&["tune", "Y-"], "or `spindle`"),
    ] {
        let told = bad(&user.does(args), 2);
        assert!(told.contains(says), "{args:?}: {told}");
        assert_eq!(user.json(&["status"])["rpm_commanded"], 0);
    }
    good(&user.does(&["mdi", "M3 S400"]));
    let told = bad(&user.does(&["tune", "spindle", "--speeds", "300,500"]), 4);
    assert!(told.contains("leadscrew mdi M5"), "{told}");
}
