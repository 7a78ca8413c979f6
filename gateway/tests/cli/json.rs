//! `--json`: one result on standard output, whatever the end of the command.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// The one object of the output.
fn object(args: &[&str], expected: i32) -> Value {
    let output = leadscrew(args);
    let told = stdout(&output);
    assert_eq!(code(&output), expected, "{args:?}: {}", stderr(&output));
    assert_eq!(told.lines().count(), 1, "{args:?}: {told}");
    serde_json::from_str(&told).unwrap_or_else(|error| panic!("{args:?}: {error}: {told}"))
}

#[test]
fn a_command_that_cannot_begin_says_why_in_its_result() {
    let folder = Folder::new("json-begin");
    let none = folder.file("none.nc");
    let flash = folder.file("new.flash");
    let shaft = "examples/shaft.nc";
    for (args, exit, why) in [
        (&["check", &none][..], 2, "no such file"),
        (&["expand", &none], 2, "no such file"),
        (&["simulate", &none], 2, "no such file"),
        (&["run", &none], 2, "no such file"),
        (
            &["plot", shaft, "-o", "x.pdf"],
            2,
            "`.svg`, `.png` or `.html`",
        ),
        (&["hold"], 2, "lives inside one command"),
        (&["run", shaft, "--bus", "no-such-can"], 3, "no interface"),
        (
            &["status", "--bus", "slcan:unix:/no/such"],
            3,
            "there is no",
        ),
        (&["params", "get", "foo"], 2, "no parameter `foo`"),
        (&["params", "restore"], 2, "this needs a board"),
        (&["retract", "--state", &flash], 2, "no such file"),
    ] {
        let args = [args, &["--json"]].concat();
        let told = object(&args, exit);
        assert_eq!(told["ok"], false, "{args:?}");
        assert_eq!(told["exit"], exit, "{args:?}");
        let error = told["error"].as_str().unwrap();
        assert!(error.contains(why), "{args:?}: {error}");
        // The same words stand on standard error.
        let output = leadscrew(&args);
        assert_eq!(stderr(&output), format!("error: {error}\n"), "{args:?}");
    }
}

#[test]
fn a_result_with_its_reason_is_still_one_object() {
    let told = object(
        &[
            "simulate",
            "examples/g84-floating.nc",
            "--tolerance",
            "0.01",
            "--json",
        ],
        1,
    );
    assert_eq!(told["ok"], false);
    assert_eq!(told["moves"], 9);
    assert!(told.get("error").is_none(), "{told}");
}

#[test]
fn wrong_parameters_leave_each_result_its_form() {
    let set = ["--set", "1420.X=0", "--json"];
    let shaft = "examples/shaft.nc";
    let told = object(&[&["check", shaft][..], &set].concat(), 1);
    assert_eq!(told["files"], Value::Array(vec![]));
    assert_eq!(told["alarms"][0]["no"], 4410);
    for command in ["simulate", "run"] {
        let told = object(&[&[command, shaft][..], &set].concat(), 1);
        assert_eq!(told["ok"], false, "{command}");
        assert_eq!(told["moves"], 0, "{command}");
        assert_eq!(told["ticks"], 0, "{command}");
        assert_eq!(told["setpoint_hash"], "0000000000000000", "{command}");
        assert_eq!(told["sync_error_um"]["max"], Value::Null, "{command}");
        assert_eq!(told["alarms"][0]["no"], 4410, "{command}");
        assert_eq!(told["warnings"], Value::Array(vec![]), "{command}");
        assert_eq!(told["program"], shaft, "{command}");
        assert_eq!(told["gateway"], env!("CARGO_PKG_VERSION"), "{command}");
        for unknown in ["parameters", "board", "started"] {
            assert_eq!(
                told.get(unknown),
                Some(&Value::Null),
                "{command}: {unknown}"
            );
        }
        // No member is missing that a result has otherwise.
        let whole = object(&[command, "examples/g84-tap.nc", "--json"], 0);
        for member in whole
            .as_object()
            .unwrap()
            .keys()
            .filter(|key| *key != "tap")
        {
            assert!(told.get(member).is_some(), "{command}: {member}");
        }
    }
    // Lines, the alarm the last of them, in either way of asking for them.
    for format in [&["--json"][..], &["--format", "jsonl"]] {
        let told = object(
            &[&["expand", shaft, "--set", "1420.X=0"][..], format].concat(),
            1,
        );
        assert_eq!(told["alarm"]["no"], 4410);
        assert_eq!(told["alarm"]["file"], "--set");
    }
    let folder = Folder::new("json-migrate");
    let file = folder.file("bad.toml");
    std::fs::write(&file, "foo\n").unwrap();
    let told = object(&["params", "migrate", &file, "--json"], 1);
    assert_eq!(told["alarms"][0]["no"], 4400);
}
