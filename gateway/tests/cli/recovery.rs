//! A tap that stays in its hole: the flash between commands, a loss of power, and the ways out.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

const PROGRAM: &str = "examples/g84-recovery.nc";

/// A flash in which a tap is in a hole, because the power went.
fn stuck(folder: &Folder) -> String {
    let state = folder.file("board.flash");
    let output = leadscrew(&["run", PROGRAM, "--state", &state, "--cut-power", "3000"]);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert!(stderr(&output).contains("the power was taken away"));
    state
}

fn status(state: &str) -> Value {
    let output = leadscrew(&["status", "--state", state, "--json"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

#[test]
fn a_tap_is_brought_out_after_a_loss_of_power() {
    let folder = Folder::new("recovery");
    let state = stuck(&folder);
    let tap = &status(&state)["tap"];
    assert_eq!(tap["in_hole"], true);
    assert_eq!(
        (tap["axis"].as_str(), tap["hand"].as_str()),
        (Some("Z"), Some("right"))
    );
    assert_eq!(
        (tap["r_mm"].as_f64(), tap["bottom_mm"].as_f64()),
        (Some(2.0), Some(-30.0))
    );
    assert_eq!(
        (tap["lead_mm"].as_f64(), tap["rpm"].as_f64()),
        (Some(1.5), Some(600.0))
    );

    // Nothing else moves that axis, and `check` knows it before anything is tried.
    for command in ["check", "run", "expand"] {
        let output = leadscrew(&[command, PROGRAM, "--state", &state]);
        assert_eq!(code(&output), 1, "{command}");
        let told = stderr(&output);
        assert!(told.contains("alarm[4310]"), "{command}: {told}");
    }

    let before = std::fs::read(&state).unwrap();
    let shown = leadscrew(&[
        "retract",
        "--dry-run",
        "--json",
        "--speed",
        "300",
        "--state",
        &state,
    ]);
    assert_eq!(code(&shown), 0, "{}", stderr(&shown));
    let step: Value = serde_json::from_str(stdout(&shown).trim()).unwrap();
    assert_eq!(
        (step["cycle"].as_str(), step["stage"].as_str()),
        (Some("G30P99"), Some("extract"))
    );
    assert_eq!(
        (step["mz"].as_f64(), step["rpm"].as_f64()),
        (Some(2.0), Some(-300.0))
    );
    assert_eq!(std::fs::read(&state).unwrap(), before, "only looked at");

    let out = leadscrew(&["retract", "--speed", "300", "--json", "--state", &state]);
    assert_eq!(code(&out), 0, "{}", stderr(&out));
    let out: Value = serde_json::from_str(&stdout(&out)).unwrap();
    assert_eq!(out["tap"]["skew_um"]["max"], 0);
    // From the bottom to R, but for what the first tick has moved.
    let travel = out["tap"]["travel_mm"].as_f64().unwrap();
    assert!((31.999..=32.0).contains(&travel), "{travel}");
    assert_eq!(status(&state)["tap"]["in_hole"], false);
    assert_eq!(code(&leadscrew(&["run", PROGRAM, "--state", &state])), 0);
}

#[test]
fn without_an_entry_there_is_nothing_to_bring_out() {
    let folder = Folder::new("nothing");
    let state = folder.file("board.flash");
    assert_eq!(code(&leadscrew(&["retract", "--state", &state])), 2);
    assert_eq!(
        code(&leadscrew(&[
            "run",
            "examples/g84-tap.nc",
            "--state",
            &state
        ])),
        0
    );
    for args in [&["retract"][..], &["retract", "--dry-run"]] {
        let output = leadscrew(&[args, &["--state", &state]].concat());
        assert_eq!(code(&output), 1, "{args:?}");
        assert!(
            stderr(&output).contains("alarm[4082]"),
            "{}",
            stderr(&output)
        );
    }
    let output = leadscrew(&["retract", "--discard", "--state", &state]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("no entry to drop"));
}

#[test]
fn an_entry_can_be_dropped() {
    let folder = Folder::new("drop");
    let state = stuck(&folder);
    let output = leadscrew(&["retract", "--discard", "--state", &state, "--lang", "zh"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(stdout(&output).starts_with("已清除"));
    assert_eq!(status(&state)["tap"]["in_hole"], false);
    assert_eq!(code(&leadscrew(&["run", PROGRAM, "--state", &state])), 0);
}

#[test]
fn a_damaged_flash_is_never_written_over() {
    let folder = Folder::new("damaged");
    let state = stuck(&folder);
    let mut bytes = std::fs::read(&state).unwrap();
    bytes[50] ^= 0x40;
    std::fs::write(&state, &bytes).unwrap();
    for args in [
        &["run", PROGRAM][..],
        &["simulate", PROGRAM],
        &["status"],
        &["retract"],
        &["retract", "--discard"],
    ] {
        let output = leadscrew(&[args, &["--state", &state]].concat());
        assert_eq!(code(&output), 2, "{args:?}");
        assert!(stderr(&output).contains("checksum"), "{}", stderr(&output));
        assert_eq!(std::fs::read(&state).unwrap(), bytes, "{args:?}");
    }
}

#[test]
fn what_does_not_go_together_is_told() {
    for (args, part) in [
        (
            &["run", PROGRAM, "--cut-power", "5"][..],
            "without `--state FILE`",
        ),
        (
            &["check", PROGRAM, "--cut-power", "5", "--state", "x"],
            "not with `check`",
        ),
        (&["retract"], "`--state FILE`"),
        (
            &["retract", "--speed", "5", "--discard", "--state", "x"],
            "cannot be used with",
        ),
    ] {
        let output = leadscrew(args);
        assert_eq!(code(&output), 2, "{args:?}");
        assert!(
            stderr(&output).contains(part),
            "{args:?}: {}",
            stderr(&output)
        );
    }
}
