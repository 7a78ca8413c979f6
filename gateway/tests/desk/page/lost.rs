//! A panel whose board is not heard stays, says so, orders nothing, and finds the board again: the same one or another.

use serde_json::{Value, json};

use super::programs::with_programs;
use super::{Client, Page, wait};
use crate::{LONG, User, good};

/// What pages are told of the board: whether it is heard.
fn is_lost(board: &Value) -> bool {
    board["since_ms"].is_u64()
}

impl Client<'_> {
    /// It is refused by the panel itself, and nobody takes the lease for it.
    #[track_caller]
    fn is_kept_from(&mut self, op: &str, args: &Value) {
        self.number += 1;
        let (status, answer) = self.numbered(self.number, op, args, &json!(1));
        // On a busy computer its lease lapses before the board is lost, and then there is none to take.
        if status == 409 {
            assert_eq!(answer["refused"], "not_operating");
            return;
        }
        let why = answer["en"].as_str().unwrap();
        assert_eq!((status, &answer["ok"]), (200, &json!(false)), "{answer}");
        assert!(why.starts_with("the board is not heard"), "{op}: {why}");
        assert!(!answer["zh"].as_str().unwrap().is_ascii(), "{answer}");
    }
}

/// Nobody operates, and the machine is as it comes up.
#[track_caller]
fn nothing_is_ordered(user: &User, page: &Page, one: &mut Client<'_>) {
    wait(&mut page.watch(), "lease", |lease| {
        lease["number"].is_null()
    });
    one.operates.set(false);
    let s = wait(&mut page.watch(), "s", |s| s["beat"].is_u64());
    assert_eq!(
        (&s["state"], &s["mode"]),
        (&json!("idle"), &json!("manual"))
    );
    let (status, answer) = one.orders("reset", &Value::Null);
    assert_eq!((status, &answer["refused"]), (409, &json!("not_operating")));
    let status = user.json(&["status"]);
    assert_eq!(status["hold"], false, "{status}");
}

#[test]
fn the_panel_outlives_its_machine_and_reads_the_next_one_anew() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("long.nc", LONG)]);
    let mut one = page.client("one");
    let mut told = page.watch();
    wait(&mut told, "board", |board| !is_lost(board));
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    let rate = |one: &Client<'_>| {
        let params = one.seen("/params")["params"].take();
        let list = params.as_array().unwrap().clone();
        let row = list.into_iter().find(|row| row["key"] == "1420.X");
        row.unwrap()["value"].clone()
    };
    let (rate_before, by) = (rate(&one), one.seen("/params")["by"].clone());
    let tag = one.get("/programs/long.nc").1;
    let program = json!({"name": "long.nc", "tag": tag, "zh": false});
    one.does("program", &program);
    wait(&mut told, "s", |s| s["state"] == "run");
    good(&user.does(&["down"]));
    let lost = wait(&mut told, "board", is_lost);
    assert!(lost["en"].as_str().unwrap().contains("desk"), "{lost}");
    assert!(!lost["zh"].as_str().unwrap().is_ascii(), "{lost}");
    wait(&mut told, "lease", |lease| lease["number"].is_null());
    // The program that was begun here has ended with it.
    wait(&mut told, "program", |program| {
        program["end"]["ok"] == false
    });
    // Who takes the lease now has to take it anew then, and orders nothing either way.
    for op in ["hold", "stop", "start", "reset", "home"] {
        one.is_kept_from(op, &Value::Null);
    }
    one.is_kept_from("program", &program);
    let set = json!({"seen": "1", "set": {"T1.X": "1"}, "check": true});
    one.is_kept_from("tools", &set);
    let jog = json!({"c": "one", "press": 1, "axes": [0, -1], "spindle": 0, "rapid": false, "speed": 0, "echo": 1});
    assert_eq!(page.post(&one.cookie, "/jog", &jog).1["ok"], false);
    let (_, _, none) = one.get("/params");
    assert!(none.contains("not read yet"), "{none}");
    // Another machine under its name, with parameters of its own.
    let file = user.0.join("other.toml");
    std::fs::write(&file, "rapid_rate.X = \"9000 mm/min\"\n").unwrap();
    good(&user.does(&["up", "--new", "--machine", file.to_str().unwrap()]));
    wait(&mut told, "board", |board| !is_lost(board));
    nothing_is_ordered(&user, &page, &mut one);
    assert_eq!(rate(&one), json!(9000), "{rate_before}");
    assert_ne!(rate_before, json!(9000));
    assert_ne!(one.seen("/params")["by"], by);
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    one.does("program", &program);
    wait(&mut told, "s", |s| s["state"] == "run");
    one.does("stop", &Value::Null);
}

#[test]
fn a_board_without_power_is_found_when_it_has_it_again_and_one_without_its_cable_goes_on() {
    // It watches the gateway: what it logs of that is read.
    let user = User::with_machine_of(&[]);
    let page = Page::start(&user);
    let mut one = page.client("one");
    let mut told = page.watch();
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    one.does("feed", &json!({"percent": 80}));
    good(&user.does(&["sim", "power", "off"]));
    wait(&mut told, "board", is_lost);
    one.is_kept_from("reset", &Value::Null);
    good(&user.does(&["sim", "power", "on"]));
    wait(&mut told, "board", |board| !is_lost(board));
    nothing_is_ordered(&user, &page, &mut one);
    assert_eq!(user.json(&["status"])["override"]["feed"], 100);
    // The panel that is the only one to ask starts its process data, and reads what has happened.
    wait(&mut page.watch(), "log", |log| {
        !log.as_array().unwrap().is_empty()
    });
    one.take();
    one.does("mode", &json!({"mode": "mdi"}));
    // Without a start in between all of it is as it was, but for the lease.
    good(&user.does(&["sim", "bus", "unplugged"]));
    wait(&mut told, "board", is_lost);
    one.is_kept_from("hold", &Value::Null);
    good(&user.does(&["sim", "bus", "well"]));
    wait(&mut told, "board", |board| !is_lost(board));
    wait(&mut page.watch(), "lease", |lease| {
        lease["number"].is_null()
    });
    wait(&mut page.watch(), "s", |s| {
        s["mode"] == "mdi" && s["hold"] == false
    });
}
