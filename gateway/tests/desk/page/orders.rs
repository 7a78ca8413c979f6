//! Orders of the page: once each, by who operates, as far as the board lets them in; hold and stop always.

use std::net::TcpStream;
use std::time::Instant;

use serde_json::{Value, json};

use super::{Page, wait};
use crate::{LIMIT, LONG, User, good};

/// More than there are connections.
const MANY: usize = 80;

#[test]
fn who_operates_orders_what_the_board_lets_in() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    let told = |answer: &(u16, Value)| {
        assert_eq!(
            (answer.0, &answer.1["ok"]),
            (200, &false.into()),
            "{answer:?}"
        );
        let [en, zh] = ["en", "zh"].map(|key| answer.1[key].as_str().unwrap().to_owned());
        assert!(!zh.is_ascii());
        assert_eq!(en[..4], zh[..4]);
        en
    };
    // Nobody operates by being there.
    let (status, answer) = one.orders("reset", &Value::Null);
    assert_eq!((status, &answer["refused"]), (409, &"not_operating".into()));
    one.take();
    // The board's own refusal, with its remedy.
    let wrong = told(&one.orders("start", &Value::Null));
    assert!(
        wrong.starts_with("4501 ") && wrong.contains("; "),
        "{wrong}"
    );
    one.does("mode", &json!({"mode": "automatic"}));
    let nothing = told(&one.orders("start", &Value::Null));
    assert!(nothing[..4].parse::<u16>().is_ok(), "{nothing}");
    for (op, args, key) in [
        ("feed", json!({"percent": 80}), "feed"),
        ("rapid", json!({"percent": 25}), "rapid"),
        ("spindle", json!({"percent": 110}), "turn"),
    ] {
        one.does(op, &args);
        wait(&mut page.watch(), "s", |s| s[key] == args["percent"]);
    }
    one.does("single", &json!({"on": true}));
    wait(&mut page.watch(), "s", |s| s["single"] == true);
    one.does("single", &json!({"on": false}));
    one.does("stop", &Value::Null);
    wait(&mut page.watch(), "s", |s| s["number"] == 4300);
    let alarm = told(&one.orders("start", &Value::Null));
    assert!(alarm.starts_with("4504 "), "{alarm}");
    one.does("reset", &Value::Null);
    wait(&mut page.watch(), "s", |s| s["state"] == "idle");
    one.does("mode", &json!({"mode": "reference"}));
    one.does("home", &Value::Null);
    wait(&mut page.watch(), "s", |s| {
        s["state"] == "idle" && s["referenced"].as_str().unwrap().contains("X Z")
    });
    // What is no order at all.
    assert_eq!(one.orders("toggle", &Value::Null).0, 400);
    assert_eq!(one.orders("feed", &json!({"percent": 151})).0, 400);
}

#[test]
fn an_order_acts_once_and_an_older_one_not_at_all() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    one.take();
    let mut run = user.run(LONG);
    let hold = |number| one.numbered(number, "hold", &Value::Null, &Value::Null);
    let done = (200, json!({"ok": true}));
    assert_eq!(hold(100), done);
    user.wait_for("hold");
    good(&user.does(&["resume"]));
    user.wait_for("run");
    // Sent again, it is answered and does nothing.
    assert_eq!(hold(100), done);
    assert_eq!(
        (hold(99).0, hold(99).1["refused"].clone()),
        (409, "older".into())
    );
    assert_eq!(user.json(&["status"])["state"], "run");
    assert_eq!(hold(101), done);
    user.wait_for("hold");
    // What was sent before the hold and comes after it starts nothing.
    let echo = one.state()["beat"].clone();
    assert_eq!(one.numbered(98, "resume", &Value::Null, &echo).0, 409);
    assert_eq!(user.json(&["status"])["state"], "hold");
    // A page whose values are old goes on with nothing, and resets.
    for (number, echo) in [
        (102, Value::Null),
        (103, json!((echo.as_u64().unwrap() + 65_000) % 65_536)),
    ] {
        let (status, answer) = one.numbered(number, "resume", &Value::Null, &echo);
        assert_eq!((status, &answer["ok"]), (200, &false.into()), "{answer}");
    }
    assert_eq!(user.json(&["status"])["state"], "hold");
    one.number = 200;
    one.does("resume", &Value::Null);
    user.wait_for("run");
    let reset = one.numbered(300, "reset", &Value::Null, &Value::Null);
    assert_eq!(reset, done);
    user.wait_for("idle");
    let _ = run.wait().unwrap();
}

#[test]
fn one_page_operates_and_another_takes_it_over() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let (mut one, mut two) = (page.client("one"), page.client("two"));
    one.take();
    let told = wait(&mut page.watch(), "lease", |lease| lease["number"].is_u64());
    assert_eq!(told, json!({"number": 1, "notice_s": null}));
    // Who does not operate orders nothing, and holds all the same.
    assert_eq!(two.orders("reset", &Value::Null).0, 409);
    two.does("hold", &Value::Null);
    // Where the lease has lapsed between the two, on a busy computer, nobody has to be told first.
    let end = Instant::now() + LIMIT;
    while {
        one.renew();
        two.lease("take")["notice_ms"].is_null()
    } {
        assert!(
            Instant::now() < end,
            "the lease changes hands without notice"
        );
        two.lease("give");
    }
    while two.lease("take")["yours"].is_null() {
        std::thread::yield_now();
    }
    one.operates.set(false);
    two.operates.set(true);
    assert_eq!(one.orders("feed", &json!({"percent": 70})).0, 409);
    two.does("feed", &json!({"percent": 60}));
    wait(&mut page.watch(), "s", |s| s["feed"] == 60);
    two.operates.set(false);
    two.lease("give");
    one.take();
    one.does("feed", &json!({"percent": 50}));
}

#[test]
fn who_may_not_order_changes_nothing() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let one = page.client("one");
    one.take();
    let mut run = user.run(LONG);
    let looks = page.login(&page.look);
    let stop = json!({"c": "one", "n": 1, "op": "stop"});
    let (status, answer) = page.post(&looks, "/order", &stop);
    assert_eq!((status, &answer["refused"]), (403, &"looks".into()));
    let (status, _) = page.post("leadscrew=00", "/order", &stop);
    assert_eq!(status, 401);
    let own = format!("Origin: http://{}", page.address);
    let cookie = format!("Cookie: {}", one.cookie);
    let (mark, kind) = ("X-Leadscrew: 1", "Content-Type: application/json");
    for (headers, expected) in [
        (
            vec!["Origin: http://evil.example", mark, kind, &cookie],
            403,
        ),
        (vec![mark, kind, &cookie], 403),
        (vec![&own, kind, &cookie], 415),
        (vec![&own, mark, &cookie], 415),
        (vec![&own, mark, kind], 401),
    ] {
        let (status, ..) = page.ask("POST /order", &headers, &stop.to_string());
        assert_eq!(status, expected, "{headers:?}");
    }
    assert_eq!(user.json(&["status"])["state"], "run");
    drop(page);
    // A panel that looks has no link to operate at all.
    let page = Page::with(&user, &["--look"]);
    assert_eq!(page.token, None);
    let cookie = page.login(&page.look);
    assert_eq!(page.post(&cookie, "/order", &stop).0, 403);
    assert_eq!(user.json(&["status"])["state"], "run");
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
}

#[test]
fn a_hold_comes_through_connections_that_are_left_open() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let one = page.client("one");
    let mut run = user.run(LONG);
    let open: Vec<TcpStream> = (0..MANY).map(|_| page.connect()).collect();
    let hold = one.numbered(1, "hold", &Value::Null, &Value::Null);
    assert_eq!(hold, (200, json!({"ok": true})));
    user.wait_for("hold");
    drop(open);
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
}

#[test]
fn a_line_is_carried_out_in_its_mode() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    one.take();
    let line = json!({"line": "G98 G1 Z-1 F3000", "zh": false});
    let (_, refused) = one.orders("mdi", &line);
    assert!(
        refused["en"].as_str().unwrap().starts_with("4501 "),
        "{refused}"
    );
    one.does("mode", &json!({"mode": "mdi"}));
    let mut told = page.watch();
    one.does("mdi", &line);
    let end = wait(&mut told, "line", |_| true);
    assert_eq!(end["ok"], true, "{end}");
    wait(&mut told, "s", |s| s["mz"] == -1.0);
    let mut told = page.watch();
    one.does("mdi", &json!({"line": "G1 Q", "zh": true}));
    let end = wait(&mut told, "line", |line| line["ok"] == false);
    assert!(!end["zh"].as_str().unwrap().is_ascii(), "{end}");
}
