//! A thread that is picked up: the groove of one program is found by its tip, and another program begins in it.

use std::time::{Duration, Instant};

use serde_json::Value;

use crate::{LIMIT, User, bad, good};

/// Cuts lead 2 from Z 5, where the spindle is at its index.
const FIRST: &str = "T0101\nM3 S300\nG0 X40 Z5\nG92 X38 Z-20 F2\nG0 X60 Z10\nM5\nM30\n";

/// Waits until the spindle stands, and picks the thread up.
#[track_caller]
fn picked_up(user: &User) -> Value {
    let end = Instant::now() + LIMIT;
    loop {
        let output = user.does(&["pickup", "--tool", "1", "--json"]);
        if output.status.success() {
            return serde_json::from_str(&good(&output)).unwrap();
        }
        let told = bad(&output, 1);
        assert!(told.contains("4587 the spindle turns at"), "{told}");
        assert!(Instant::now() < end, "the spindle does not stop");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The start angle that `check` tells of the first thread of a text.
#[track_caller]
fn start_angle(user: &User, text: &str) -> f64 {
    let program = user.program(text);
    let checked = user.json(&["check", &program]);
    let warnings = checked["files"][0]["warnings"].as_array().unwrap();
    let [warning] = &warnings[..] else {
        panic!("{checked}")
    };
    assert_eq!(warning["no"], 4905);
    let text = warning["message"].as_str().unwrap();
    let (_, angle) = text.split_once("begins at ").unwrap();
    angle.trim_end_matches('°').parse().unwrap()
}

#[test]
fn another_program_begins_in_the_groove_that_was_found() {
    let user = User::with_machine();
    let told = bad(&user.does(&["pickup", "--tool", "1"]), 1);
    assert!(
        told.contains("4588") && told.contains("M03 with S"),
        "{told}"
    );
    good(&user.does(&["tools", "set", "T1.Z=-7.3", "T1.wear.Z=0.01", "T2.Z=4"]));
    let program = user.program(FIRST);
    good(&user.does(&["run", &program]));

    // Where the spindle stands now is known from a touch anywhere; from it, where the groove is.
    let angle = picked_up(&user)["angle"].as_f64().unwrap();
    let groove = 5.0 - 2.0 * angle / 360.0 - 6.0;
    good(&user.does(&["mode", "mdi"]));
    good(&user.does(&["mdi", &format!("T0101 G0 Z{groove:.3}")]));
    let told = picked_up(&user);
    // The work zero is the machine's, and half a step of the line is 0.09 degrees.
    assert!(
        (told["z"].as_f64().unwrap() - groove).abs() < 6e-4,
        "{told}"
    );
    // The first time it ran out, perhaps.
    let moved = told["angle"].as_f64().unwrap() - angle;
    assert!(moved.abs() < 0.1, "{moved}°");
    assert_eq!(user.json(&["pickup"])["z"], told["z"]);

    // The groove passes Z 7.3 a turn and 54 degrees before Z 5; Z 5 at the index.
    for (block, expected) in [
        ("T0101\nM3 S200\nG0 X40 Z7.3\nG92 X38 Z-20 F2\nM30\n", 306.0),
        ("T0202\nM3 S100\nG0 X40 Z7.3\nG32 Z-20 F2\nM30\n", 306.0),
        ("T0202\nM3 S100\nG0 X40 Z5\nG92 X38 Z-20 F2\nM30\n", 0.0),
    ] {
        let beside = (start_angle(&user, block) - expected + 180.0).rem_euclid(360.0) - 180.0;
        assert!(beside.abs() < 0.1, "{block}: {beside}° beside");
    }
    good(&user.does(&["mode", "automatic"]));
    let program = user.program("T0202\nM3 S100\nG0 X40 Z7.3\nG92 X38 Z0 F2\nM30\n");
    good(&user.does(&["run", &program]));

    let told = user.json(&["pickup", "--clear"]);
    assert_eq!(told["picked_up"], false);
    let checked = user.json(&["check", &program]);
    assert_eq!(checked["files"][0]["warnings"], Value::Array(Vec::new()));
}
