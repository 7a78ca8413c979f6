//! Machine functions and interlocks, as somebody at the machine meets them.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use crate::{LIMIT, LONG, User, bad, good, text};

/// A machine with a door (input 1), and coolant: M8 and M9 switch output 1, input 2 answers M8.
fn guarded() -> User {
    let user = User::new();
    let file = user.0.join("guarded.toml");
    std::fs::write(
        &file,
        "door_input = 1\nm_row_1 = 81011020050\nm_row_2 = 92010000000\n",
    )
    .unwrap();
    good(&user.does(&["up", "--machine", "guarded.toml"]));
    user
}

#[test]
fn a_program_does_not_start_with_the_door_open_and_closing_it_starts_nothing() {
    let user = guarded();
    let open = user.json(&["sim", "door", "open"]);
    assert_eq!(open["note"], json!(null));
    assert_eq!(user.json(&["status"])["interlocks"], "door");
    let program = user.program(crate::SHORT);
    let told = bad(&user.does(&["run", &program]), 1);
    assert!(
        told.contains("4506") && told.contains("the open door"),
        "{told}"
    );
    good(&user.does(&["sim", "door", "close"]));
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["interlocks"], &status["state"]),
        (&json!(""), &json!("idle"))
    );
    good(&user.does(&["run", &program]));
}

#[test]
fn a_typed_line_that_the_door_forbids_is_refused_and_needs_no_reset() {
    let user = guarded();
    good(&user.does(&["mdi", "G98 F77 S300"]));
    good(&user.does(&["sim", "door", "open"]));
    for line in ["M3 S500", "G1 W-1", "M3 S500; G1 W-1"] {
        let told = bad(&user.does(&["mdi", line]), 1);
        assert!(
            told.contains("alarm[4506]") && told.contains("--> mdi:1:"),
            "{told}"
        );
        let status = user.json(&["status"]);
        assert_eq!(
            (&status["state"], &status["alarm"]),
            (&json!("idle"), &json!(null)),
            "{line}"
        );
    }
    let refused = user.does(&["mdi", "M3 S500", "--json"]);
    let refused: serde_json::Value = serde_json::from_slice(&refused.stdout).unwrap();
    assert_eq!(refused["alarms"][0]["no"], json!(4506), "{refused}");
    assert_eq!(refused["after"]["modal"], refused["before"]["modal"]);
    good(&user.does(&["sim", "door", "close"]));
    // What was in force still is.
    let line = user.json(&["mdi", "M3"]);
    let after = "G00 G18 G21 G54 G98 G97 F77 S300 M03 T--00";
    assert_eq!(line["after"]["modal"], json!(after));
    assert_eq!(user.json(&["status"])["rpm_commanded"], json!(300));
}

#[test]
fn a_door_that_is_opened_holds_the_program_until_it_is_closed_and_resumed() {
    let user = guarded();
    let run = user.run(LONG);
    good(&user.does(&["sim", "door", "open"]));
    user.wait_for("hold");
    let told = bad(&user.does(&["resume"]), 1);
    assert!(told.contains("4506"), "{told}");
    good(&user.does(&["sim", "door", "close"]));
    assert_eq!(user.json(&["status"])["state"], "hold");
    good(&user.does(&["resume"]));
    user.wait_for("run");
    good(&user.does(&["reset"]));
    assert_eq!(run.wait_with_output().unwrap().status.code(), Some(4));
}

#[test]
fn an_order_that_an_alarm_outlasts_is_told_as_one_that_failed() {
    let user = guarded();
    good(&user.does(&["sim", "estop", "press"]));
    user.wait_for("alarm");
    for order in ["reset", "resume"] {
        let told = bad(&user.does(&[order]), 4);
        assert!(told.contains("4300"), "{order}: {told}");
        let told = user.does(&[order, "--json"]);
        let value: Value = serde_json::from_slice(&told.stdout).unwrap();
        assert_eq!(
            (&value["ok"], &value["exit"], &value["alarm"]),
            (&json!(false), &json!(4), &json!(4300)),
            "{order}"
        );
    }
    // The machine stands, which is all that these ask for.
    for order in ["hold", "stop"] {
        good(&user.does(&[order]));
    }
    good(&user.does(&["sim", "estop", "release"]));
    good(&user.does(&["reset"]));
}

#[test]
fn a_function_is_answered_and_an_answer_that_does_not_come_is_told() {
    let user = guarded();
    good(&user.does(&["mdi", "M8"]));
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["inputs"], &status["outputs"]),
        (&json!("1 2"), &json!("1"))
    );
    let told = good(&user.does(&["sim", "outputs"]));
    assert_eq!(told, "inputs on: 1 2\noutputs on: 1\n");
    good(&user.does(&["mdi", "M9"]));
    let off = user.json(&["sim", "input", "2", "off"]);
    assert_eq!(
        (&off["machine"]["inputs"], &off["machine"]["outputs"]),
        (&json!([1, 2]), &json!([]))
    );
    let told = bad(&user.does(&["mdi", "M8"]), 4);
    assert!(told.contains("4551") && told.contains("input 2"), "{told}");
    good(&user.does(&["sim", "input", "2", "auto"]));
    good(&user.does(&["reset"]));
    good(&user.does(&["mdi", "M8"]));
}

#[test]
fn a_code_without_a_row_says_how_to_add_one() {
    let user = guarded();
    let told = bad(&user.does(&["mdi", "M60"]), 1);
    assert!(
        told.contains("4550") && told.contains("9401 to 9416"),
        "{told}"
    );
    let told = bad(&user.does(&["sim", "input", "33", "on"]), 2);
    assert!(told.contains("1..=32"), "{told}");
}

#[test]
fn inputs_and_outputs_have_the_names_of_the_machine_file() {
    let user = User::new();
    let file = user.0.join("leadscrew.toml");
    std::fs::write(
        &file,
        "door_input = \"door\"\n[io.door]\nat = \"input:1\"\n[io.coolant]\nat = \"output:1\"\n[io.flow]\nat = \"input:2\"\n\
         [m.8]\nset = \"coolant\"\nanswer = \"flow=1\"\nwithin = \"2 s\"\n[m.9]\nclear = \"coolant\"\n",
    )
    .unwrap();
    good(&user.does(&["up", "--machine", "leadscrew.toml"]));
    // What the file says in words is what the board has in numbers.
    let same = good(&user.does(&["params", "diff", "leadscrew.toml"]));
    assert!(same.contains("no difference"), "{same}");
    good(&user.does(&["io", "set", "coolant=1"]));
    let named = ["--params", "leadscrew.toml"];
    assert_eq!(
        good(&user.does(&[&["io", "list"], &named[..]].concat())),
        "input:1    on       door     door\n\
         input:2    on       flow     M8 answers\n\
         output:1   on       coolant  M8 on, M9 off\n"
    );
    good(&user.does(&[&["io", "set", "coolant=0"], &named[..]].concat()));
    good(&user.does(&["io", "wait", "output:1=0", "--timeout", "300"]));
    let list = user.json(&["io", "list"]);
    assert_eq!(
        list["outputs"],
        json!([{ "number": 1, "on": false, "name": "coolant", "uses": "M8 on, M9 off" }])
    );
    let told = bad(&user.does(&["io", "wait", "flow=0", "--timeout", "1"]), 1);
    assert!(told.contains("`flow` is 1 still"), "{told}");
    let told = bad(&user.does(&["io", "set", "door=1"]), 2);
    assert!(told.contains("`leadscrew sim input 1 on`"), "{told}");
    let told = bad(&user.does(&["io", "set", "output:2=1"]), 2);
    assert!(
        told.contains("no M code of the board switches output:2 so"),
        "{told}"
    );
    let told = bad(&user.does(&["io", "set", "lamp=1"]), 2);
    assert!(told.contains("`[io.lamp]`"), "{told}");
    let told = bad(&user.does(&["io", "set", "coolant"]), 2);
    assert!(told.contains("NAME=0 or NAME=1"), "{told}");
    // A pulled file has the words, too, and is the same set.
    good(&user.does(&["params", "pull", "-o", "pulled.toml"]));
    let pulled = std::fs::read_to_string(user.0.join("pulled.toml")).unwrap();
    let line = "\nm.8 = { set = \"output:1\", answer = \"input:2=1\", within = \"2 s\", row = 1 }";
    assert!(pulled.contains(line), "{pulled}");
    let same = good(&user.does(&["params", "diff", "pulled.toml"]));
    assert!(same.contains("no difference"), "{same}");
}

#[test]
fn gears_and_the_turret_are_those_of_the_board() {
    let user = User::new();
    let file = user.0.join("leadscrew.toml");
    std::fs::write(
        &file,
        "gear_motor_turns_1 = 4\ngear_spindle_turns_1 = 1\ngear_max_rpm_1 = \"600 rpm\"\ntool_changer = 2\nturret_stations = 8\n\
         turret_index_output = 2\nturret_code_input = 3\nturret_locked_input = 7\nturret_time_ms = \"2000 ms\"\n",
    )
    .unwrap();
    good(&user.does(&["up", "--machine", "leadscrew.toml"]));
    let told = bad(&user.does(&["mdi", "M3 S300"]), 1);
    assert!(told.contains("4554"), "{told}");
    good(&user.does(&["mdi", "M41"]));
    assert_eq!(user.json(&["status"])["gear"], json!(1));
    good(&user.does(&["mdi", "M3 S300"]));
    let told = bad(&user.does(&["mdi", "S700"]), 1);
    assert!(told.contains("4557"), "{told}");
    good(&user.does(&["mdi", "M5"]));
    good(&user.does(&["mdi", "T0300"]));
    good(&user.does(&["sim", "turret", "stuck"]));
    let told = bad(&user.does(&["mdi", "T0500"]), 4);
    assert!(
        told.contains("4570") && told.contains("its code is 3"),
        "{told}"
    );
    good(&user.does(&["sim", "turret", "well"]));
    good(&user.does(&["reset"]));
    let told = bad(&user.does(&["mdi", "G0 W1"]), 1);
    assert!(told.contains("4575"), "{told}");
    good(&user.does(&["mdi", "T0500"]));
    good(&user.does(&["mdi", "G0 W1"]));
    // A new power-up knows no gear.
    good(&user.does(&["sim", "power", "cycle"]));
    assert_eq!(user.json(&["status"])["gear"], json!(null));
}

#[test]
fn a_block_on_the_bus_has_its_names_and_is_missed() {
    let user = User::new();
    let file = user.0.join("block.toml");
    let set = "door_input = \"door\"\n[io.door]\nat = \"401:5:in0\"\n[io.coolant]\nat = \"401:5:out15\"\n\
        [io.clamp]\nat = \"401:5:out1\"\nsafe = true\n[m.8]\nset = \"coolant\"\nanswer = \"401:5:in1=1\"\nwithin = \"2 s\"\n";
    std::fs::write(&file, set).unwrap();
    good(&user.does(&["up", "--machine", "block.toml"]));
    let named = ["--params", "block.toml"];
    good(&user.does(&[&["io", "wait", "door=1", "--timeout", "300"], &named[..]].concat()));
    good(&user.does(&["mdi", "M8"]));
    let list = good(&user.does(&[&["io", "list"], &named[..]].concat()));
    let rows: Vec<Vec<&str>> = list
        .lines()
        .map(|row| row.split_whitespace().collect())
        .collect();
    for row in [
        "input:17 on door door",
        "input:18 on M8 answers",
        "output:18 on clamp",
        "output:32 on coolant M8 on",
    ] {
        let row: Vec<_> = row.split(' ').collect();
        assert!(rows.contains(&row), "{row:?}: {list}");
    }
    assert_eq!(user.json(&["status"])["outputs"], "18 32");
    good(&user.does(&["sim", "block", "silent"]));
    user.wait_for("alarm");
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["alarm"]["no"], &status["outputs"]),
        (&json!(4553), &json!("18"))
    );
    // What differs elsewhere is told, and that nobody knows it of the block.
    let silent = "the block of inputs and outputs, node 5 (9461), does not answer";
    let diff = ["params", "diff", "block.toml"];
    let told = bad(&user.does(&diff), 3);
    assert!(told.contains(silent), "{told}");
    let output = user.does(&[&diff[..], &["--set", "9027=20", "--json"]].concat());
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&told["ok"], &told["exit"]), (&json!(false), &json!(3)));
    assert!(told["error"].as_str().unwrap().contains(silent), "{told}");
    assert_eq!(told["changes"][0]["no"], json!(9027), "{told}");
    // Three questions without an answer, also where the machine has little of this computer's time.
    let end = Instant::now() + LIMIT;
    loop {
        let output = user.does(&["doctor", "--seconds", "5"]);
        let told = text(&output.stdout);
        if told.contains("does not answer (rule 49)") {
            break;
        }
        let beside = text(&output.stderr);
        assert!(Instant::now() < end, "{told}{beside}");
    }
    let told = bad(
        &user.does(&["io", "wait", "input:17=1", "--timeout", "1"]),
        1,
    );
    assert!(
        told.contains("nobody tells the level of `input:17`"),
        "{told}"
    );
    good(&user.does(&["sim", "block", "well"]));
    good(&user.does(&[&["io", "wait", "door=1", "--timeout", "300"], &named[..]].concat()));
    good(&user.does(&["reset"]));
    // As it is set up here, a push finds nothing to change.
    let told = good(&user.does(&["params", "push", "block.toml"]));
    assert!(told.contains("nothing to change"), "{told}");
}

/// Drives are delivered with the PDOs off that carry mode and inputs. A machine file that says what is in them gets them.
#[test]
fn a_push_to_a_machine_that_runs_switches_the_second_pdos_of_its_drives_on() {
    let user = User::new();
    good(&user.does(&["up", "--new"]));
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../params/machines/desk.toml");
    let push = ["params", "push", machine.to_str().unwrap()];
    let told = good(&user.does(&push));
    for pdo in ["1601h", "1A01h"] {
        let lines = || told.lines().filter(|line| line.contains(pdo));
        assert_eq!(lines().count(), 2, "{told}");
        assert!(lines().all(|line| line.contains("(off)")), "{told}");
    }
    user.wait_for("idle");
    let again = good(&user.does(&push));
    assert!(again.starts_with("nothing to change"), "{again}");
    user.wait_for("idle");
    // One that says that it is off has it off.
    let user = User::new();
    good(&user.does(&["up", "--new"]));
    let off = "[drive.X]\nrpdo2 = [\"6060/8\"]\nrpdo2_cob_id = 0x80000310\n";
    std::fs::write(user.0.join("off.toml"), off).unwrap();
    let told = good(&user.does(&["params", "push", "off.toml"]));
    assert!(!told.contains("1601h"), "{told}");
}
