//! Touching off by the page: as `leadscrew touch` does, shown before it is written, and nothing moves.

use serde_json::{Value, json};

use super::{Client, Page, wait};
use crate::{LONG, User, good};

/// What the page sends.
fn of(axis: &str, value: &str, tool: &str, seen: &Value) -> Value {
    json!({"axis": axis, "value": value, "tool": tool, "system": "G54", "work": false, "seen": seen, "zh": false})
}

impl Client<'_> {
    #[track_caller]
    fn touches(&mut self, args: &Value) -> Value {
        let (status, answer) = self.orders("touch", args);
        assert_eq!(status, 200, "{answer}");
        answer
    }

    /// What is said of a touch that is refused.
    #[track_caller]
    fn refused(&mut self, args: &Value) -> String {
        let answer = self.touches(args);
        assert_eq!(answer["ok"], false, "{answer}");
        assert!(!answer["zh"].as_str().unwrap().is_ascii(), "{answer}");
        answer["en"].as_str().unwrap().to_owned()
    }
}

fn value(user: &User, key: &str) -> Value {
    let command = if key.starts_with('G') {
        "offsets"
    } else {
        "tools"
    };
    user.json(&[command, "get", key])["values"][0]["value"].take()
}

#[test]
fn a_tool_and_a_work_offset_are_shown_then_written_and_nothing_moves() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    let nobody = one.orders("touch", &of("X", "20", "1", &Value::Null));
    assert_eq!(
        (nobody.0, &nobody.1["refused"]),
        (409, &"not_operating".into())
    );
    good(&user.does(&["offsets", "set", "G54.Z=-400"]));
    good(&user.does(&["tools", "set", "T1.wear.X=-0.02"]));
    good(&user.does(&["mdi", "G98 G1 X-30 Z-5.125 F3000"]));
    good(&user.does(&["mode", "manual"]));
    one.take();
    let before = user.json(&["status"]);
    // Shown, and not written.
    let shown = one.touches(&of("X", "38.42", "1", &Value::Null));
    assert_eq!(
        shown["en"],
        "T1.X = -68.4200: X 38.4200 of the work is at -30.0000 of the machine"
    );
    let keys: Vec<_> = shown["changes"].as_array().unwrap().iter().collect();
    assert_eq!(
        keys,
        [
            &json!({"key": "T1.X", "old": "0", "new": "-68.42"}),
            &json!({"key": "T1.wear.X", "old": "-0.02", "new": "0"}),
            &json!({"key": "T1.measured", "old": "", "new": "X"}),
        ]
    );
    assert_eq!(value(&user, "T1.X"), 0);
    // Written: the same as the command would.
    let written = one.touches(&of("X", "38.42", "1", &shown["seen"]));
    assert_eq!(written["ok"], true, "{written}");
    assert_eq!(
        (
            value(&user, "T1.X"),
            value(&user, "T1.wear.X"),
            value(&user, "T1.measured")
        ),
        (json!(-68.42), json!(0), json!("X"))
    );
    // Who has seen what it was before writes nothing over it.
    let told = one.refused(&of("X", "40", "1", &shown["seen"]));
    assert!(
        told.contains("nothing has been written") && told.contains("; review"),
        "{told}"
    );
    // A work offset, by the tool that is known, and by none.
    for (tool, wanted) in [("1", 0.0), ("", -68.42)] {
        let mut args = of("X", "38.42", tool, &Value::Null);
        args["work"] = true.into();
        args["system"] = "G55".into();
        args["seen"] = one.touches(&args)["seen"].clone();
        assert_eq!(one.touches(&args)["ok"], true);
        assert_eq!(value(&user, "G55.X"), wanted);
    }
    let after = user.json(&["status"]);
    for key in ["mx", "mz", "state", "mode", "rpm_commanded"] {
        assert_eq!(before[key], after[key], "{key}");
    }
}

#[test]
fn a_touch_counts_from_where_the_axis_was_marked_and_takes_the_mark() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    good(&user.does(&["mdi", "G98 G1 X-30 F3000"]));
    one.take();
    let marked = one.touches(&json!({"axis": "X", "mark": true, "zh": true}));
    assert_eq!(
        (&marked["en"], &marked["zh"]),
        (
            &json!("X marked at -30.0000 (machine)"),
            &json!("X 已记下机床坐标 -30.0000")
        )
    );
    let shown = one.touches(&of("X", "20", "2", &Value::Null));
    // Moved off: it is the mark that counts.
    good(&user.does(&["mdi", "G1 X-10 F3000"]));
    let again = one.touches(&of("X", "20", "2", &Value::Null));
    assert_eq!(shown["seen"], again["seen"]);
    assert!(
        again["en"]
            .as_str()
            .unwrap()
            .ends_with("where it was marked"),
        "{again}"
    );
    assert_eq!(one.touches(&of("X", "20", "2", &again["seen"]))["ok"], true);
    assert_eq!(value(&user, "T2.X"), -50);
    // The next one counts from where the axis stands, and from nowhere else where it has moved since.
    let shown = one.touches(&of("X", "20", "2", &Value::Null));
    assert_eq!(shown["changes"][0]["new"], "-30", "{shown}");
    good(&user.does(&["mdi", "G1 X-12 F3000"]));
    let told = one.refused(&of("X", "20", "2", &shown["seen"]));
    assert!(told.contains("stands elsewhere"), "{told}");
    assert_eq!(value(&user, "T2.X"), -50);
}

#[test]
fn a_touch_is_refused_as_the_command_is_and_by_old_values() {
    let user = User::new();
    let machine = user.0.join("lathe.toml");
    std::fs::write(&machine, "home_method.Z = 1\nhome_position.Z = \"5 mm\"\n").unwrap();
    good(&user.does(&["up", "--machine", machine.to_str().unwrap()]));
    let page = Page::start(&user);
    let mut one = page.client("one");
    one.take();
    let told = one.refused(&of("Z", "0", "1", &Value::Null));
    assert!(told.starts_with("4503 not referenced: Z; "), "{told}");
    for (value, tool, part) in [
        ("38,42", "1", "write a point, not a comma"),
        ("", "1", "is no coordinate of X"),
        ("20", "", "type 1 to 32"),
        ("20", "33", "type 1 to 32"),
        ("-20000", "1", "4582: T1.X"),
    ] {
        let told = one.refused(&of("X", value, tool, &Value::Null));
        assert!(told.contains(part), "{part}: {told}");
    }
    assert_eq!(
        one.orders("touch", &json!({"axis": "C", "mark": true})).0,
        400
    );
    // The page changes no mode.
    one.does("mode", &json!({"mode": "reference"}));
    wait(&mut page.watch(), "s", |s| s["mode"] == "reference");
    let told = one.refused(&of("X", "20", "1", &Value::Null));
    assert!(told.starts_with("4501 "), "{told}");
    assert_eq!(user.json(&["status"])["mode"], "reference");
    one.does("mode", &json!({"mode": "manual"}));
    // By what a page has seen a while ago nothing is touched off.
    let shown = one.touches(&of("X", "20", "1", &Value::Null));
    let beat = one.state()["beat"].as_u64().unwrap();
    let old = json!((beat + 65_000) % 65_536);
    let (status, answer) = one.numbered(1_000, "touch", &of("X", "20", "1", &shown["seen"]), &old);
    assert_eq!((status, &answer["ok"]), (200, &false.into()));
    assert!(
        answer["en"]
            .as_str()
            .unwrap()
            .starts_with("what the board says is old"),
        "{answer}"
    );
    assert_eq!(value(&user, "T1.X"), 0);
    one.number = 1_000;
    good(&user.does(&["home"]));
    good(&user.does(&["mode", "manual"]));
    // Under way the words of the command.
    let mut run = user.run(LONG);
    wait(&mut page.watch(), "s", |s| s["state"] == "run");
    let told = one.refused(&of("X", "20", "1", &Value::Null));
    assert!(told.starts_with("4580 "), "{told}");
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
}
