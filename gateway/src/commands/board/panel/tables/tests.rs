//! Changes without a board: what is one, and what is said of it.

use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::params::Params;
use serde_json::json;

use super::super::super::{Base, Table};
use super::*;

fn base() -> Base {
    let table = Offsets {
        revision: Revision(7),
        ..Offsets::default()
    };
    Base {
        params: Params::slant_bed(),
        offsets: Table::Board(Some(Box::new(table))),
    }
}

fn change(op: &str, seen: &str, set: &Value) -> Change {
    Change::of(op, &json!({"seen": seen, "set": set, "check": true})).unwrap()
}

fn json(told: &Told) -> Value {
    serde_json::from_str(&told.json()).unwrap()
}

/// Names of the values that something is said of.
fn complained(told: &Value) -> Vec<&str> {
    let complaints = told["complaints"].as_array().unwrap().iter();
    complaints.map(|one| one["key"].as_str().unwrap()).collect()
}

#[test]
fn what_is_no_change_is_none() {
    let good = json!({"seen": "7", "set": {"T1.X": "1"}, "check": false});
    assert!(Change::of("tools", &good).is_some() && Change::of("params", &good).is_some());
    assert_eq!(Change::of("table", &good), None);
    let long = "1".repeat(LONGEST + 1);
    let many: serde_json::Map<_, _> = (0..=VALUES).map(|n| (n.to_string(), json!("1"))).collect();
    for (key, wrong) in [
        ("set", json!({})),
        ("set", json!([["T1.X", "1"]])),
        ("set", json!({"T1.X": 1})),
        ("set", json!({"T1.X": null})),
        ("set", json!({"T1.X=2": "1"})),
        ("set", json!({"T1.X": "1\n2"})),
        ("set", json!({"T1.X": long})),
        ("set", json!({long.clone(): "1"})),
        ("set", Value::Object(many)),
        ("seen", json!(7)),
        ("seen", json!("7\u{202e}")),
        ("seen", Value::Null),
        ("check", json!("false")),
        ("check", Value::Null),
    ] {
        let mut args = good.clone();
        args[key] = wrong;
        assert_eq!(Change::of("tools", &args), None, "{args}");
    }
}

#[test]
fn a_change_of_tools_is_what_differs_and_each_mistake_has_its_value() {
    let set = json!({"T1.wear.X": "-0.02", "G54.Z": "-400", "T2.tip": "0"});
    let told = json(&tools::check(&base(), &change("tools", "7", &set)).unwrap());
    let row = |key: &str, old: &str, new: &str| json!({"key": key, "old": old, "new": new});
    assert_eq!(
        told["changes"],
        json!([row("G54.Z", "0", "-400"), row("T1.wear.X", "0", "-0.02")])
    );
    assert_eq!(
        (&told["ok"], &told["complaints"]),
        (&json!(true), &json!([]))
    );
    // A wear that jumps is a warning: it is not written before it has been read.
    let much = json!({"T1.wear.X": "-2"});
    let mut jump = change("tools", "7", &much);
    let told = json(&tools::check(&base(), &jump).unwrap());
    assert_eq!(told["ok"], true);
    assert_eq!(
        (&told["complaints"][0]["key"], &told["complaints"][0]["bad"]),
        (&json!("T1.wear.X"), &json!(false))
    );
    jump.check = false;
    let told = tools::check(&base(), &jump).unwrap();
    assert!(!told.writes(&jump) && json(&told)["ok"] == false);
    jump.sure = true;
    assert!(tools::check(&base(), &jump).unwrap().writes(&jump));
    // All mistakes at once; a whole record, a thread and a sum are no values.
    let wrong = json!({"T1.X": "x", "T33.X": "1", "T1": "1", "thread.X": "1", "T1.X+": "1", "T1.tip": "10", "T2.X": "1"});
    let told = json(&tools::check(&base(), &change("tools", "7", &wrong)).unwrap());
    assert_eq!(told["ok"], false);
    let keys = complained(&told);
    let mut expected = vec!["T1.X", "T33.X", "T1", "thread.X", "T1.X+", "T1.tip"];
    expected.sort_unstable();
    assert_eq!(keys, expected);
}

#[test]
fn a_change_of_what_the_board_has_no_more_names_both() {
    let told = json(&tools::check(&base(), &change("tools", "6", &json!({"T1.X": "1"}))).unwrap());
    let why = told["en"].as_str().unwrap();
    assert!(
        why.contains("revision 7 ") && why.contains(" in 6: nothing"),
        "{why}"
    );
    assert_eq!((&told["ok"], &told["changes"]), (&json!(false), &json!([])));
    let params = Params::slant_bed();
    let told =
        json(&params::check(&params, &change("params", "6", &json!({"1420.X": "1"}))).unwrap());
    let now = format!("{:08x}", leadscrew_core::link::identity(&params));
    assert!(told["en"].as_str().unwrap().contains(&now), "{told}");
}

#[test]
fn a_change_of_parameters_has_each_complaint_beside_its_row() {
    let params = Params::slant_bed();
    let seen = format!("{:08x}", leadscrew_core::link::identity(&params));
    let check = |set: Value| json(&params::check(&params, &change("params", &seen, &set)).unwrap());
    let told = check(json!({"1420.X": "11000"}));
    assert_eq!(told["ok"], true, "{told}");
    assert_eq!(
        told["changes"],
        json!([{"key": "1420.X", "old": "12000 mm/min", "new": "11000 mm/min"}])
    );
    let told = check(json!({"1420.X": "fast", "1420.Z": "-1", "7": "1"}));
    assert_eq!(told["ok"], false);
    let keys = complained(&told);
    assert_eq!(keys, ["1420.X", "1420.Z", "7"]);
    // What only the whole set shows: the limits have changed places.
    let told = check(json!({"1320.X": "-500 mm"}));
    assert_eq!(told["ok"], false, "{told}");
    assert_eq!(told["complaints"][0]["key"], "1320.X");
}
