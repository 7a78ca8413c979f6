//! The `params` commands and the parameter options, as a user meets them: the built binary, its output and exit codes.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::{Value, json};

fn leadscrew(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(args)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// A machine file of this test alone.
fn machine(name: &str, content: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).unwrap();
    path.display().to_string()
}

#[test]
fn get_prints_value_range_and_source() {
    let out = leadscrew(&["params", "get", "5130", "--set", "019=7"]);
    assert_eq!(out.status.code(), Some(0));
    assert_eq!(
        text(&out.stdout),
        "019/5130 thread_chamfer = 7 × 0.1 lead\n    \
         Length of the run-out (chamfer) of G76, G78 and G92 threads\n    \
         0 to 99 × 0.1 lead; set by --set 019=7, built in 5 × 0.1 lead\n"
    );
    assert_eq!(text(&out.stderr), "");
}

#[test]
fn get_speaks_json_and_chinese() {
    let file = machine("diameter.toml", "9101.X = \"12.5 mm\"\n1320.C = \"none\"\n");
    let args = [
        "params", "get", "9101.X", "1320.C", "182.7", "--json", "--lang", "zh", "--params", &file,
    ];
    let out = leadscrew(&args);
    assert_eq!(out.status.code(), Some(0));
    let value: Value = serde_json::from_slice(&out.stdout).unwrap();
    let expected = json!({"params": [
        {
            "key": "9101.X", "no": 9101, "axis": "X", "name": "tool_offset_1", "value": 12.5, "unit": "mm",
            "diameter": true, "min": -9999.9999, "max": 9999.9999, "default": 0, "set_by": format!("{file}:1"),
            "meaning": "1 号刀具偏置（X 为直径值）", "sheet": "own number"
        },
        {
            "key": "1320.C", "no": 1320, "axis": "C", "name": "soft_limit_plus", "value": null, "unit": "°",
            "min": -99999.9999, "max": 99999.9999, "none_allowed": true, "default": null, "set_by": format!("{file}:2"),
            "meaning": "正方向软限位（机床坐标；X 为半径值）", "sheet": "FANUC number"
        },
        {
            "key": "182.7", "no": 182, "bit": 7, "name": "pq_in_mm", "value": 0, "unit": "", "min": 0, "max": 1,
            "default": 0, "meaning": "G74、G75、G76 的 P、Q 单位 — 0：最小输入增量；1：mm/inch",
            "sheet": "G75 sheet, G76 sheet, D4"
        }
    ]});
    assert_eq!(value, expected);
}

#[test]
fn list_finds_by_number_name_and_meaning() {
    let lines = |filter: &str| {
        let out = leadscrew(&["params", "list", filter]);
        assert_eq!(out.status.code(), Some(0));
        text(&out.stdout).lines().count() - 1
    };
    assert_eq!(lines("1420"), 3);
    assert_eq!(lines("RAPID_RATE"), 3);
    assert_eq!(lines("5142"), 1);
    assert_eq!(lines("空运行"), 1);
    assert_eq!(lines("no such thing"), 0);
}

#[test]
fn validate_says_where_what_and_how() {
    let file = machine("fast.toml", "# lathe\n1430.X = \"13 m/min\"\n");
    let out = leadscrew(&["params", "validate", "--params", &file]);
    assert_eq!(out.status.code(), Some(1));
    assert_eq!(text(&out.stdout), "");
    let expected = format!(
        "alarm[4422]: the cutting feed of X (1430.X) is above its rapid rate (1420.X)
 --> {file}:2:10
  |
2 | 1430.X = \"13 m/min\"
  |          ^^^^^^^^^^
  |
  = help: lower 1430.X or raise 1420.X
"
    );
    assert_eq!(text(&out.stderr), expected);

    let out = leadscrew(&["params", "validate", "--params", &file, "--json"]);
    assert_eq!(out.status.code(), Some(1));
    let value: Value = serde_json::from_slice(&out.stdout).unwrap();
    let alarm = json!({
        "file": file, "no": 4422, "line": 2, "column": 10, "end_column": 20,
        "message": "the cutting feed of X (1430.X) is above its rapid rate (1420.X)",
        "help": "lower 1430.X or raise 1420.X"
    });
    assert_eq!(
        value,
        json!({"ok": false, "alarms": [alarm], "warnings": []})
    );

    // The option comes after the file and makes the set good again.
    let out = leadscrew(&[
        "params",
        "validate",
        "--params",
        &file,
        "--set",
        "1420.X=13000",
    ]);
    assert_eq!(out.status.code(), Some(0));
    assert_eq!(
        text(&out.stdout),
        "good: 163 values, 2 of them set here, the others the built-in machine's\n"
    );
}

#[test]
fn a_warning_is_told_and_passes() {
    let out = leadscrew(&["params", "validate", "--set", "5213=0", "--json"]);
    assert_eq!(out.status.code(), Some(0));
    let value: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(value["ok"], json!(true));
    assert_eq!(value["warnings"][0]["no"], json!(4961));
    assert_eq!(value["warnings"][0]["file"], json!("--set"));
}

#[test]
fn what_the_command_line_gets_wrong_is_a_usage_error() {
    for (args, part) in [
        (
            &["params", "get", "4711"][..],
            "there is no parameter `4711`",
        ),
        (&["params", "get", "rapid"], "did you mean `rapid_rate`?"),
        (&["params", "get", "182.6"], "write `182.7`"),
        (
            &["params", "validate", "--set", "182.7"],
            "expected NO[.BIT|.AXIS]=VALUE",
        ),
        (
            &["params", "validate", "--params", "nowhere.toml"],
            "there is no such file",
        ),
        (
            &["params", "set", "182.7=1"],
            "needs a place for the values",
        ),
        (&["params", "diff", "a", "b", "c"], "unexpected value 'c'"),
        (
            &["params", "pull", "-o", "a", "--into", "b"],
            "cannot be used with",
        ),
    ] {
        let out = leadscrew(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(
            text(&out.stderr).contains(part),
            "{args:?}: {}",
            text(&out.stderr)
        );
        assert_eq!(text(&out.stdout), "", "{args:?}");
    }
}

#[test]
fn a_wrong_value_is_a_wrong_parameter_in_every_command_that_takes_one() {
    for command in [&["params", "list"][..], &["params", "get", "019"]] {
        let mut args = command.to_vec();
        args.extend(["--set", "5144=5", "--json"]);
        let out = leadscrew(&args);
        assert_eq!(out.status.code(), Some(1), "{args:?}");
        let value: Value = serde_json::from_slice(&out.stdout).unwrap();
        assert_eq!(value["ok"], json!(false));
        assert_eq!(value["alarms"][0]["no"], json!(4410));
        assert_eq!(value["alarms"][0]["column"], json!(6));
    }
}

#[test]
fn the_manual_comes_in_both_languages() {
    let english = leadscrew(&["params", "docs"]);
    assert!(text(&english.stdout).starts_with("# Parameters\n"));
    let chinese = leadscrew(&["params", "docs", "--lang", "zh"]);
    assert!(text(&chinese.stdout).starts_with("# 参数\n"));
    let rows = |out: &Output| {
        text(&out.stdout)
            .lines()
            .filter(|l| l.starts_with('|'))
            .count()
    };
    assert_eq!(rows(&english), rows(&chinese));
}

const LATHE: &str = "# My lathe, as delivered.\nschema = 1\n\n\"1420.X\" = \"12 m/min\"   # was 10\n[acceleration]\nX = \"2 m/s²\"\n\n\
                     [drive.X]\nmax_profile_velocity = 500000\n";

#[test]
fn a_value_is_set_in_its_file_and_every_comment_stays() {
    let file = machine("set.toml", LATHE);
    let out = leadscrew(&[
        "params",
        "set",
        "1420.X=11000",
        "acceleration.Z=2.5",
        "--params",
        &file,
    ]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert_eq!(
        text(&out.stdout),
        "1420.X  rapid_rate.X    12000 mm/min  → 11000 mm/min\n1620.Z  acceleration.Z  3 m/s²        → 2.5 m/s²\n"
    );
    let changed = LATHE
        .replace("\"12 m/min\"", "\"11000 mm/min\"")
        .replace("X = \"2 m/s²\"\n", "X = \"2 m/s²\"\nZ = \"2.5 m/s²\"\n");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), changed);
    // What makes no working set changes nothing, and nor does a look.
    let out = leadscrew(&["params", "set", "1430.X=13000", "--params", &file]);
    assert_eq!(out.status.code(), Some(1));
    assert!(text(&out.stderr).contains("alarm[4422]"));
    let out = leadscrew(&[
        "params",
        "set",
        "182.7=1",
        "--dry-run",
        "--json",
        "--params",
        &file,
    ]);
    assert_eq!(out.status.code(), Some(0));
    let value: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(
        value,
        json!({"ok": true, "same": false, "drives": [], "changes": [
            {"key": "182.7", "no": 182, "bit": 7, "name": "pq_in_mm", "old": 0, "new": 1, "unit": ""}
        ]})
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), changed);
}

#[test]
fn two_files_are_compared_as_whole_sets() {
    let first = machine(
        "first.toml",
        "9007 = \"12 %\"\nrapid_rate.X = \"11 m/min\"\n",
    );
    let second = machine(
        "second.toml",
        "rapid_rate.X = \"11000 mm/min\"\n9101.X = \"0.5 mm\"\n",
    );
    let out = leadscrew(&["params", "diff", &first, &second]);
    assert_eq!(out.status.code(), Some(1));
    assert_eq!(
        text(&out.stdout),
        "9007    spindle_tolerance_percent  12 %  → 15 %\n9101.X  tool_offset_1.X            0 mm  → 0.5 mm\n"
    );
    let out = leadscrew(&["params", "diff", &first, &first, "--lang", "zh"]);
    assert_eq!(out.status.code(), Some(0));
    assert_eq!(text(&out.stdout), "没有差别\n");
    // One file against the built-in machine, and options over it.
    let out = leadscrew(&["params", "diff", &first, "--set", "9007=15", "--json"]);
    assert_eq!(out.status.code(), Some(1));
    let value: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(value["changes"][0]["key"], json!("1420.X"));
    assert_eq!(value["changes"][0]["new"], json!(11000));
    assert_eq!(value["changes"].as_array().unwrap().len(), 1);
    let out = leadscrew(&["params", "diff"]);
    assert_eq!(out.status.code(), Some(0));
    assert_eq!(text(&out.stdout), "no difference\n");
}

#[test]
fn a_pulled_file_is_the_set_and_takes_another_one_over() {
    let file = machine("pulled.toml", "");
    std::fs::remove_file(&file).unwrap();
    let out = leadscrew(&["params", "pull", "-o", &file, "--set", "9007=12"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let pulled = std::fs::read_to_string(&file).unwrap();
    assert!(pulled.contains("\nspindle_tolerance_percent = \"12 %\"  # built in: 15 %\n"));
    let out = leadscrew(&["params", "diff", "--set", "9007=12", &file]);
    assert_eq!(out.status.code(), Some(1), "the file is the whole set");
    assert_eq!(text(&out.stdout).lines().count(), 1);
    // It is not written over, and takes values over where it is told to.
    let out = leadscrew(&["params", "pull", "-o", &file]);
    assert_eq!(out.status.code(), Some(2));
    assert!(text(&out.stderr).contains("--into"));
    let mine = machine("mine.toml", LATHE);
    let out = leadscrew(&["params", "pull", "--into", &mine, "--set", "1420.X=9000"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let expected = LATHE.replace("\"12 m/min\"", "\"9000 mm/min\"");
    assert_eq!(std::fs::read_to_string(&mine).unwrap(), expected);
}

#[test]
fn a_file_of_another_schema_is_refused_with_both_named() {
    let file = machine("schema.toml", "# new\nschema = 9\nno_such = 1\n");
    let out = leadscrew(&["params", "validate", "--params", &file]);
    assert_eq!(out.status.code(), Some(1));
    let expected = format!(
        "alarm[4413]: the file is of schema 9, and this program reads schema 1
 --> {file}:2:10
  |
2 | schema = 9
  |          ^
  |
  = help: `leadscrew params migrate FILE` shows what has changed, and with `-o` writes a file of schema 1
"
    );
    assert_eq!(text(&out.stderr), expected);
    let out = leadscrew(&["params", "migrate", &file]);
    assert_eq!(out.status.code(), Some(1));
    assert!(text(&out.stderr).contains("schema 9, and this program knows the way to schema 1"));
}

#[test]
fn a_file_without_a_schema_gets_one_in_a_file_of_its_own() {
    let file = machine("plain.toml", "# mine\n9007 = \"12 %\"\n");
    let new = machine("migrated.toml", "");
    std::fs::remove_file(&new).unwrap();
    let out = leadscrew(&["params", "migrate", &file, "-o", &new]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert_eq!(text(&out.stdout), "schema 1: up to date\n");
    assert_eq!(
        std::fs::read_to_string(&new).unwrap(),
        "schema = 1\n# mine\n9007 = \"12 %\"\n"
    );
    assert_eq!(
        std::fs::read_to_string(&file).unwrap(),
        "# mine\n9007 = \"12 %\"\n"
    );
    let out = leadscrew(&["params", "migrate", &file, "-o", &new, "--json"]);
    assert_eq!(out.status.code(), Some(2), "never over what is there");
}
