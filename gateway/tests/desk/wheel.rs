//! A simulated handwheel over the bus of a machine that stays: it leads an axis, and a program.

use std::process::Stdio;
use std::time::Instant;

use serde_json::json;

use crate::{LIMIT, User, bad, good, text};

#[test]
fn an_axis_goes_as_far_as_the_wheel_is_turned() {
    let user = User::patient();
    let told = user.json(&["handwheel", "Z", "x100", "-25"]);
    assert_eq!(
        told,
        json!({"ok": true, "node": 1, "end": "done", "mx": 0, "mz": -2.5})
    );
    // X counts on the diameter.
    // The board lets another one turn once it has heard the end of the turn before.
    let fast = ["handwheel", "X", "×10", "30", "--rate", "200"];
    let end = Instant::now() + LIMIT;
    let told = loop {
        let output = user.does(&fast);
        if output.status.success() || !text(&output.stderr).contains("4505") {
            break good(&output);
        }
        assert!(Instant::now() < end, "the first turn does not end");
    };
    assert_eq!(told, "node 1: machine X 0.3 Z -2.5\n");
    assert_eq!(good(&user.does(&["mode", "wheel"])), "node 1: mode wheel\n");
    let told = bad(&user.does(&["handwheel", "path", "1", "1"]), 1);
    assert!(
        told.contains("4513 no program follows the handwheel"),
        "{told}"
    );
}

#[test]
fn a_program_follows_the_wheel_to_its_end_and_a_thread_asks() {
    let user = User::patient();
    let program = user.program("M3 S600\nG98 G1 Z-2 F300\nG92 X-2 Z-8 F1\nG98 G1 Z-3 F300\nM30\n");
    let run = ["run", &program, "--handwheel"];
    let mut run = user
        .command(&run)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let end = Instant::now() + LIMIT;
    let state = |user: &User| user.json(&["status"])["state"].clone();
    let turns = |user: &User| {
        // Refused where no program follows any more.
        let _ = user.does(&["handwheel", "path", "x100", "20"]);
    };
    while state(&user) != "hold" {
        assert!(Instant::now() < end);
        if run.try_wait().unwrap().is_some() {
            let ended = run.wait_with_output().unwrap();
            panic!("it ended before its thread: {}", text(&ended.stderr));
        }
        // A refusal before the program has begun would look to `run` like one of its own.
        if state(&user) != "idle" {
            turns(&user);
        }
    }
    assert_eq!(user.json(&["status"])["mz"], -2);
    good(&user.does(&["resume"]));
    while run.try_wait().unwrap().is_none() {
        assert!(Instant::now() < end);
        turns(&user);
    }
    let ended = run.wait_with_output().unwrap();
    let told = text(&ended.stderr);
    assert!(ended.status.success(), "{told}");
    assert_eq!(told.matches("warning[4954]").count(), 1, "{told}");
    assert_eq!(user.json(&["status"])["mz"], -3);
    // The next program does not follow it.
    let program = user.program("G98 G1 Z-4 F3000\nM30\n");
    good(&user.does(&["run", &program]));
    assert_eq!(user.json(&["status"])["mz"], -4);
}
