//! Tables of the page against a machine that stays: one transaction, never over what the page has not seen, and refused as
//! the commands are.

use std::time::Instant;

use serde_json::{Value, json};

use super::{Client, Page};
use crate::{LIMIT, LONG, User, bad, good};

impl Client<'_> {
    /// A table, once the panel has read that of this name.
    #[track_caller]
    fn sheet_of(&self, path: &str, seen: &Value) -> Value {
        let end = Instant::now() + LIMIT;
        loop {
            let sheet = self.seen(path);
            if sheet["seen"] == *seen {
                return sheet;
            }
            assert!(Instant::now() < end, "{seen}");
        }
    }

    /// What has become of a change.
    fn change(&mut self, op: &str, seen: &Value, set: &Value, check: bool, sure: bool) -> Value {
        let args = json!({"seen": seen, "set": set, "check": check, "sure": sure});
        self.orders(op, &args).1
    }
}

/// One value as `tools get` and `offsets get` say it.
fn value(user: &User, command: &str, key: &str) -> Value {
    user.json(&[command, "get", key])["values"][0]["value"].take()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn tools_and_offsets_are_one_transaction_and_never_go_over_what_was_not_seen() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    let seen = one.seen("/tools")["seen"].clone();
    let set = json!({"T1.wear.X": "-0.02", "G55.Z": "-40"});
    let answer = one.change("tools", &seen, &set, false, false);
    assert_eq!(answer["refused"], "not_operating");
    one.take();
    // Looked at, and not written.
    let answer = one.change("tools", &seen, &set, true, false);
    assert_eq!(answer["ok"], true, "{answer}");
    assert_eq!(answer["changes"].as_array().unwrap().len(), 2, "{answer}");
    assert_eq!(value(&user, "tools", "T1.wear.X"), 0);
    // What is wrong keeps all of it from being written.
    let wrong = json!({"T1.wear.X": "-0.02", "T2.tip": "10"});
    let answer = one.change("tools", &seen, &wrong, false, false);
    assert_eq!(
        (&answer["ok"], &answer["complaints"][0]["key"]),
        (&json!(false), &json!("T2.tip"))
    );
    assert_eq!(value(&user, "tools", "T1.wear.X"), 0);
    let answer = one.change("tools", &seen, &set, false, false);
    assert_eq!(answer["ok"], true, "{answer}");
    assert_eq!(value(&user, "tools", "T1.wear.X"), -0.02);
    assert_eq!(value(&user, "offsets", "G55.Z"), -40);
    // The same page again, by what it has seen before: both are named, and nothing is written.
    let now = user.json(&["offsets", "list"])["revision"].to_string();
    let answer = one.change("tools", &seen, &json!({"T1.X": "1"}), false, false);
    assert_eq!(answer["ok"], false);
    let why = text(&answer["en"]);
    assert!(
        why.contains(&format!("revision {now} ")) && why.contains(&format!("in {}: ", text(&seen))),
        "{why}"
    );
    assert_eq!(value(&user, "tools", "T1.X"), 0);
    // A wear that jumps needs somebody who has read the warning.
    let sheet = one.sheet_of("/tools", &json!(now));
    assert_eq!(
        (&sheet["values"]["T1.wear.X"], &sheet["values"]["G55.Z"]),
        (&json!("-0.02"), &json!("-40"))
    );
    let jump = json!({"T1.wear.X": "-2"});
    assert_eq!(
        one.change("tools", &sheet["seen"], &jump, false, false)["ok"],
        false
    );
    assert_eq!(value(&user, "tools", "T1.wear.X"), -0.02);
    assert_eq!(
        one.change("tools", &sheet["seen"], &jump, false, true)["ok"],
        true
    );
    assert_eq!(value(&user, "tools", "T1.wear.X"), -2);
    // Under way the board refuses it, with the words of the command.
    let now = user.json(&["offsets", "list"])["revision"].to_string();
    let sheet = one.sheet_of("/tools", &json!(now));
    let mut run = user.run(LONG);
    let answer = one.change("tools", &sheet["seen"], &set, false, true);
    let told = bad(&user.does(&["tools", "set", "T1.wear.X=-1.5"]), 1);
    assert!(
        told.contains("4580") && told.contains(text(&answer["en"])),
        "{told} {answer}"
    );
    assert_eq!(value(&user, "tools", "T1.wear.X"), -2);
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
}

#[test]
fn parameters_are_pushed_whole_with_each_complaint_and_at_rest() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    let params = one.seen("/params");
    let row = |sheet: &Value, key: &str| -> Value {
        let rows = sheet["params"].as_array().unwrap();
        rows.iter().find(|row| row["key"] == key).unwrap().clone()
    };
    let rapid = row(&params, "1420.X");
    assert_eq!(
        (&rapid["value"], &rapid["default"]),
        (&json!(12_000), &json!(12_000))
    );
    assert!(text(&rapid["meaning"]).is_ascii());
    let seen = &params["seen"];
    let set = json!({"1420.X": "11000", "1420.Z": "11500"});
    one.take();
    let answer = one.change("params", seen, &set, true, false);
    assert_eq!(
        (&answer["ok"], &answer["changes"][0]["new"]),
        (&json!(true), &json!("11000 mm/min")),
        "{answer}"
    );
    let wrong = json!({"1420.X": "11000", "1420.Z": "-1", "1320.X": "none of it"});
    let answer = one.change("params", seen, &wrong, false, false);
    let keys: Vec<_> = answer["complaints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| text(&one["key"]))
        .collect();
    assert_eq!(
        (&answer["ok"], &keys[..]),
        (&json!(false), &["1320.X", "1420.Z"][..]),
        "{answer}"
    );
    let answer = one.change("params", seen, &set, false, true);
    assert_eq!(answer["ok"], true, "{answer}");
    let values = user.json(&["params", "get", "1420.X", "1420.Z"]);
    assert_eq!(
        (&values["params"][0]["value"], &values["params"][1]["value"]),
        (&json!(11_000), &json!(11_500))
    );
    // By what was seen before nothing is written.
    let back = json!({"1420.X": "12000"});
    let answer = one.change("params", seen, &back, false, true);
    assert!(
        text(&answer["en"]).contains(&format!("in {}: ", text(seen))),
        "{answer}"
    );
    let by = user.json(&["params", "diff", "--set", "1420.X=11000"]);
    assert_eq!(by["same"], true, "{by}");
    user.wait_for("idle");
    // The panel has read the new set by and by. Under way the board refuses, with the words of the command.
    let end = Instant::now() + LIMIT;
    let sheet = loop {
        let sheet = one.seen("/params");
        if sheet["seen"] != *seen {
            break sheet;
        }
        assert!(Instant::now() < end, "{seen}");
    };
    assert_eq!(row(&sheet, "1420.X")["value"], 11_000);
    let mut run = user.run(LONG);
    let answer = one.change("params", &sheet["seen"], &back, false, true);
    assert_eq!(answer["ok"], false, "{answer}");
    let told = bad(&user.does(&["params", "set", "1420.X=12000"]), 1);
    assert!(told.contains(text(&answer["en"])), "{told} {answer}");
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
}
