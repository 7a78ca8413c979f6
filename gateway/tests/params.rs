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
    // 9042 and 9046 name it too.
    assert_eq!(lines("1420"), 5);
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
    let all = leadscrew_core::params::Entry::all().len();
    assert_eq!(
        text(&out.stdout),
        format!(
            "good: {all} values, 2 of them set here, the others the built-in machine's\n\
             encoder of the spindle, 4096 counts: threads from 5 rpm, ordinary taps from 5 rpm; of a lead of 1 mm a count is \
             0.000244 mm\n"
        )
    );
}

/// By hand: a count of 60 is 16.666 µm of a lead of 1 mm, and half as much again is what is promised.
#[test]
fn what_an_encoder_is_good_for_is_told_before() {
    let told = |settings: &[&str]| {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let args: Vec<&str> = ["params", "validate", "--json"]
            .into_iter()
            .chain(set)
            .collect();
        let out = leadscrew(&args);
        assert_eq!(out.status.code(), Some(0), "{}", text(&out.stdout));
        serde_json::from_slice::<Value>(&out.stdout).unwrap()["encoder"].clone()
    };
    assert_eq!(
        told(&["encoder_counts=60", "9006.0=0"]),
        json!({
            "counts": 60, "thread_rpm_min": 20, "tap_rpm_min": 700,
            "count_mm_of_1_mm": 0.016666, "error_mm_of_1_mm": 0.025
        })
    );
    assert_eq!(
        told(&["encoder_counts=60"])["error_mm_of_1_mm"],
        Value::Null
    );
    let good = leadscrew(&[
        "params",
        "validate",
        "--set",
        "encoder_counts=60",
        "--set",
        "9006.0=0",
    ]);
    assert!(text(&good.stdout).ends_with("and a thread may be 0.025 mm beside the angle\n"));
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

const LATHE: &str = "# My lathe, as delivered.\nschema = 2\n\n\"1420.X\" = \"12 m/min\"   # was 10\n[acceleration]\nX = \"2 m/s²\"\n\n\
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
        "alarm[4413]: the file is of schema 9, and this program reads schema 2
 --> {file}:2:10
  |
2 | schema = 9
  |          ^
  |
  = help: `leadscrew params migrate FILE` shows what has changed, and with `-o` writes a file of schema 2
"
    );
    assert_eq!(text(&out.stderr), expected);
    let out = leadscrew(&["params", "migrate", &file]);
    assert_eq!(out.status.code(), Some(1));
    assert!(
        text(&out.stderr)
            .contains("schema 9, and this program knows the way to schema 2 from 1 on")
    );
}

#[test]
fn a_file_without_a_schema_gets_one_in_a_file_of_its_own() {
    let file = machine("plain.toml", "# mine\n9007 = \"12 %\"\n");
    let new = machine("migrated.toml", "");
    std::fs::remove_file(&new).unwrap();
    let out = leadscrew(&["params", "migrate", &file, "-o", &new]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert_eq!(text(&out.stdout), "schema 2: up to date\n");
    assert_eq!(
        std::fs::read_to_string(&new).unwrap(),
        "schema = 2\n# mine\n9007 = \"12 %\"\n"
    );
    assert_eq!(
        std::fs::read_to_string(&file).unwrap(),
        "# mine\n9007 = \"12 %\"\n"
    );
    let out = leadscrew(&["params", "migrate", &file, "-o", &new, "--json"]);
    assert_eq!(out.status.code(), Some(2), "never over what is there");
}

/// A file of the flash of a simulated board that is not there yet.
fn board(name: &str) -> String {
    let path = machine(name, "");
    std::fs::remove_file(&path).unwrap();
    path
}

#[track_caller]
fn good(args: &[&str]) -> String {
    let out = leadscrew(args);
    assert_eq!(
        out.status.code(),
        Some(0),
        "{args:?}: {}",
        text(&out.stderr)
    );
    text(&out.stdout).to_owned()
}

#[track_caller]
fn bad(args: &[&str], code: i32) -> String {
    let out = leadscrew(args);
    assert_eq!(
        out.status.code(),
        Some(code),
        "{args:?}: {}",
        text(&out.stdout)
    );
    text(&out.stderr).to_owned()
}

#[test]
fn a_board_takes_a_file_whole_and_keeps_it() {
    let state = board("taken.flash");
    let file = machine("taken.toml", &LATHE.replace("12 m/min", "11 m/min"));
    let push = ["params", "push", &file, "--state", &state];
    let shown = good(&[&push[..], &["--dry-run"]].concat());
    let expected = "1420.X   rapid_rate.X                    12000 mm/min  → 11000 mm/min\n\
                    drive X  607Fh:00h max_profile_velocity  10000000      → 500000\n";
    assert!(shown.starts_with(expected), "{shown}");
    assert!(shown.ends_with("nothing has been changed (`--dry-run`)\n"));
    assert!(!std::path::Path::new(&state).exists());
    let told = good(&push);
    let (told, end) = told.split_at(expected.len());
    assert_eq!(told, expected);
    assert!(end.starts_with("stored and in force, identity "), "{end}");
    // It is the board's from now on: every command works over it.
    assert_eq!(
        text(&leadscrew(&["params", "diff", "--state", &state]).stdout),
        "1420.X  rapid_rate.X  12000 mm/min  → 11000 mm/min\n"
    );
    let got = good(&["params", "get", "1420.X", "--state", &state]);
    assert!(
        got.starts_with("1420.X rapid_rate.X = 11000 mm/min\n"),
        "{got}"
    );
    let value: Value =
        serde_json::from_str(&good(&["status", "--json", "--state", &state])).unwrap();
    assert_eq!(json!(end[30..38]), value["parameters"]);
    let program = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/o0008-g75-grooves.nc"
    );
    good(&["run", program, "--state", &state]);
    let told = bad(&["run", program, "--state", &state, "--set", "9007=14"], 2);
    assert!(
        told.contains("another machine than the one stored in"),
        "{told}"
    );
    // What a file does not name stays, unless the built-in machine is asked for.
    good(&[
        "params",
        "set",
        "spindle_tolerance_percent=14",
        "--state",
        &state,
    ]);
    assert_eq!(
        good(&["params", "push", "--set", "1420.X=11000", "--state", &state]),
        "nothing to change\n"
    );
    let told = good(&[
        "params",
        "push",
        "--built-in",
        "--set",
        "9007=14",
        "--state",
        &state,
        "--lang",
        "zh",
    ]);
    assert!(
        told.starts_with("1420.X  rapid_rate.X  11000 mm/min  → 12000 mm/min\n已保存并生效"),
        "{told}"
    );
}

#[test]
fn a_wrong_file_is_told_by_place_and_nothing_is_sent() {
    let state = board("wrong.flash");
    let file = machine(
        "wrong.toml",
        "# mine\n1420.X = \"12 km/h\"\n9007 = \"99 %\"\n",
    );
    let told = bad(&["params", "push", &file, "--state", &state], 1);
    assert!(
        told.contains(&format!("{file}:2:10")) && told.contains("alarm[4406]"),
        "{told}"
    );
    assert!(
        told.contains(&format!("{file}:3:8")) && told.contains("alarm[4410]"),
        "{told}"
    );
    let file = machine("fast.push.toml", "1430.X = \"13 m/min\"\n");
    let told = bad(&["params", "push", &file, "--state", &state], 1);
    assert!(told.contains("alarm[4422]"), "{told}");
    assert!(!std::path::Path::new(&state).exists());
    assert!(bad(&["params", "push", "--state", &state], 2).contains("needs something to send"));
    assert!(
        bad(&["params", "push", &file, "--set", "1420.X=14000"], 2).contains("this needs a board")
    );
}

#[test]
fn a_drive_that_refuses_stops_all_of_it() {
    let state = board("drive.flash");
    let file = machine(
        "drive.toml",
        "9007 = \"14 %\"\n[drive.Z]\nprofile_acceleration = 7000\nmax_profile_velocity = 0\n",
    );
    let told = bad(&["params", "push", &file, "--state", &state], 1);
    assert_eq!(
        told,
        "error: drive Z (node 17): writing object 607Fh:00h max_profile_velocity refused with abort code 06090032h (value is \
         too low): its manual has the range, correct `[drive.Z]`; what was written before it has its old value again, and nothing of the board's set has been changed\n"
    );
    let out = leadscrew(&["params", "diff", "--state", &state]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stdout));
    // An object that is not there, one of another type, and a tick that the drives do not have.
    for (section, part) in [
        (
            "[drive.C]\nmax_torque = 5\n",
            "drive C (node 18): reading object 6072h:00h max_torque refused with abort code 06020000h (object does not exist): this \
             drive does not have it, leave it, or the profile that asks for it, out of `[drive.C]`",
        ),
        (
            "[drive.C]\n6041.0 = { type = \"u8\", value = 1 }\n",
            "has 2 bytes there, and u8 has 1",
        ),
        (
            "9000 = \"2000 µs\"\n",
            "drive X interpolates over 1 × 10^-3 s (60C2h), and a setpoint would come every 2000 µs",
        ),
    ] {
        let file = machine("drive.toml", section);
        let told = bad(&["params", "push", &file, "--state", &state], 1);
        assert!(told.contains(part), "{told}");
    }
    let all = ["X", "Z", "C", "S1", "S2", "S3", "S4"];
    let sections: String = all
        .iter()
        .map(|drive| format!("[drive.{drive}]\ninterpolation_period = \"2 ms\"\n"))
        .collect();
    let file = machine("drive.toml", &format!("9000 = \"2000 µs\"\n{sections}"));
    let told = good(&["params", "push", &file, "--state", &state]);
    assert!(
        told.contains("drive S4  60C2h:01h interpolation_value  1        → 2\n"),
        "{told}"
    );
    assert_eq!(
        good(&["params", "push", &file, "--state", &state]),
        "nothing to change\n"
    );
}

#[test]
fn a_damaged_set_is_offered_the_last_good_one() {
    use leadscrew_board_sim::plant::Flash;
    use leadscrew_store::{Region, Store};
    let state = board("damaged.flash");
    good(&["params", "set", "9007=12", "--state", &state]);
    good(&["params", "set", "9007=13", "--state", &state]);
    let flash = Flash::from_image(&std::fs::read(&state).unwrap()).unwrap();
    let mut store = Store::new(flash).unwrap();
    store.write(Region::ParametersB, b"damaged").unwrap();
    std::fs::write(&state, store.into_flash().image()).unwrap();

    let status = good(&["status", "--state", &state]);
    assert!(
        status.contains("4340 ") && status.contains("params restore"),
        "{status}"
    );
    let program = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/o0008-g75-grooves.nc"
    );
    assert!(bad(&["run", program, "--state", &state], 4).contains("damaged"));
    assert!(
        bad(
            &["params", "set", "9007=14", "--state", &state, "--dry-run"],
            0
        )
        .is_empty()
    );
    let told = good(&["params", "restore", "--state", &state]);
    assert!(told.starts_with("stored and in force, identity "), "{told}");
    assert_eq!(
        text(&leadscrew(&["params", "diff", "--state", &state]).stdout),
        "9007  spindle_tolerance_percent  15 %  → 12 %\n"
    );
    assert_eq!(
        good(&["status", "--state", &state]),
        "no tap is in a hole\n"
    );
    good(&["run", program, "--state", &state]);
    let empty = board("empty.flash");
    assert!(bad(&["params", "restore", "--state", &empty], 1).contains("no good set from before"));
}

#[test]
fn a_drive_is_set_up_by_its_profile_and_told_why_it_cannot_be() {
    let state = board("profile.flash");
    let file = machine("profile.toml", "[drive.Z]\nprofile = \"delta-asda-a2\"\n");
    let out = leadscrew(&["params", "push", &file, "--state", &state]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    // All else is as the simulated drive is delivered.
    assert!(
        text(&out.stdout).starts_with("drive Z  1006h:00h communication_cycle_us  0  → 1000\n"),
        "{}",
        text(&out.stdout)
    );
    assert!(
        text(&out.stderr).contains("note: drive Z delta-asda-a2 (")
            && text(&out.stderr).contains(" facts not verified)"),
        "{}",
        text(&out.stderr)
    );
    // The simulated drives of this command are delivered anew: what they have otherwise goes into a line of its own.
    good(&["params", "pull", "--into", &file, "--state", &state]);
    assert_eq!(
        std::fs::read_to_string(&file).unwrap(),
        "[drive.Z]\ncommunication_cycle_us = 0\nprofile = \"delta-asda-a2\"\n"
    );
    assert_eq!(
        good(&["params", "push", &file, "--state", &state]),
        "nothing to change\n"
    );
    // A file of one's own lies beside the machine's, and what the section says counts.
    machine(
        "my-drive.toml",
        "name = \"my-drive\"\ntitle = \"Mine\"\nbit_rates_kbit = [1000, 500]\n\
         source = [{ fact = \"bit_rates_kbit\", kind = \"manual\", ref = \"its page 7\", verified = true }]\n",
    );
    let own = machine(
        "own.toml",
        "9020 = 500\n9000 = \"2 ms\"\n9022 = \"20 ms\"\n[drive.X]\nprofile = \"my-drive.toml\"\n[drive.Z]\ninterpolation_period = \"2 ms\"\n\
         [drive.C]\ninterpolation_period = \"2 ms\"\n[drive.S1]\ninterpolation_period = \"2 ms\"\n\
         [drive.S2]\ninterpolation_period = \"2 ms\"\n[drive.S3]\ninterpolation_period = \"2 ms\"\n\
         [drive.S4]\ninterpolation_period = \"2 ms\"\n",
    );
    let told = good(&["params", "push", &own, "--state", &state, "--dry-run"]);
    assert!(
        told.contains("drive X   60C2h:01h interpolation_value  1        → 2\n"),
        "{told}"
    );
    let slow = machine(
        "slow.toml",
        "9020 = 800\n[drive.X]\nprofile = \"my-drive.toml\"\n",
    );
    let told = bad(&["params", "push", &slow, "--state", &state], 1);
    assert!(
        told.contains("alarm[4459]: drive X cannot be set up by its profile: `my-drive` has bit rates of 1000 500 kbit/s, and parameter 9020 is 800 kbit/s")
            && told.contains(&format!("{slow}:3:11")),
        "{told}"
    );
}
