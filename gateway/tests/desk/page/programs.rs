//! Programs of the page against a machine that stays: what is said of one by what the board has, and how it is begun.

use serde_json::{Value, json};

use super::{Client, Page, wait};
use crate::{LONG, SHORT, User, bad, good};

/// A page with these programs, in a folder of this user.
pub fn with_programs(user: &User, programs: &[(&str, &str)]) -> Page {
    let folder = user.0.join("parts");
    std::fs::create_dir_all(&folder).unwrap();
    for (name, text) in programs {
        std::fs::write(folder.join(name), text).unwrap();
    }
    Page::with(user, &["--programs", folder.to_str().unwrap()])
}

impl Client<'_> {
    /// What a page reads; with the tag of a text.
    pub(super) fn get(&self, path: &str) -> (u16, String, String) {
        let cookie = format!("Cookie: {}", self.cookie);
        let (status, head, body) = self.page.ask(&format!("GET {path}"), &[&cookie], "");
        let tag = head.lines().find_map(|line| line.strip_prefix("ETag: "));
        let tag = tag.unwrap_or_default().trim_matches('"').to_owned();
        (status, tag, body)
    }

    /// What is said of a program or a table, once the board's parameters are read.
    pub(super) fn seen(&self, path: &str) -> Value {
        loop {
            let (status, _, body) = self.get(path);
            assert_eq!(status, 200, "{body}");
            let seen: Value = serde_json::from_str(&body).unwrap();
            if seen["by"].is_string() {
                return seen;
            }
            let why = seen["error"].as_str().unwrap();
            assert!(why.contains("not read yet"), "{why}");
        }
    }
}

#[test]
fn what_is_said_of_a_program_is_by_what_the_board_has() {
    let user = User::with_machine();
    let page = with_programs(
        &user,
        &[
            (
                "a.nc",
                "(STOCK X60 L100)\nG50 X0 Z0\nM3 S600\nG0 X10 Z2\nG98 G1 Z-3 F100\nG2 X14 Z-5 R2\nG1 X14.877\nM30\n",
            ),
            ("wrong.nc", "G98 G1 X1 F100\nG1 Q\nM30\n"),
        ],
    );
    let one = page.client("one");
    let check = one.seen("/programs/wrong.nc/check");
    assert_eq!(
        (&check["ok"], &check["alarms"][0]["line"]),
        (&json!(false), &json!(2))
    );
    for key in ["message", "help"] {
        assert!(
            check["alarms"][0][key].as_str().unwrap().is_ascii(),
            "{check}"
        );
    }
    let check = one.seen("/programs/a.nc/check");
    assert_eq!((&check["ok"], &check["alarms"]), (&json!(true), &json!([])));
    let path = one.seen("/programs/a.nc/path");
    let kinds = path["kinds"].as_str().unwrap();
    assert!(kinds.starts_with("mrf") && kinds.len() > 6, "{kinds}");
    let sum = |key: &str| -> i64 {
        let list = path[key].as_array().unwrap();
        assert_eq!(list.len(), kinds.len());
        list.iter().map(|value| value.as_i64().unwrap()).sum()
    };
    // The end: X14.877 Z-5 in tenths of a micrometre of the radius, on line 7.
    let ends = ["x", "z", "lines", "numbers"].map(sum);
    assert_eq!(ends, [74_385, -50_000, 7, 5]);
    assert_eq!(
        path["stock"],
        json!({"x0": 0, "x1": 30, "z0": -100, "z1": 0})
    );
    // Another set of parameters, and what is said goes by that one.
    let by = path["by"].clone();
    good(&user.does(&["params", "set", "1321.X=-4mm"]));
    let _ = wait(&mut page.watch(), "s", |s| {
        s["by"].is_string() && s["by"] != by
    });
    let path = one.seen("/programs/a.nc/path");
    assert_eq!(path["limits"]["x0"], -4);
}

#[test]
fn a_program_is_sent_and_begun_as_its_page_has_seen_it_and_stays_until_its_end() {
    let user = User::with_machine();
    let page = with_programs(
        &user,
        &[
            ("long.nc", LONG),
            ("short.nc", SHORT),
            ("wrong.nc", "G1 Q\n"),
        ],
    );
    let mut one = page.client("one");
    let (_, tag, text) = one.get("/programs/long.nc");
    assert_eq!(text, LONG);
    let args = json!({"name": "long.nc", "tag": tag});
    let refused = |answer: (u16, Value), why: &str| {
        assert!(
            answer.1["en"].as_str().unwrap().contains(why),
            "{}",
            answer.1
        );
    };
    refused(one.orders("program", &args), "does not operate");
    one.take();
    refused(one.orders("program", &args), "4501 ");
    one.does("mode", &json!({"mode": "automatic"}));
    refused(
        one.orders("program", &json!({"name": "long.nc", "tag": "1-x"})),
        "not what this page has seen",
    );
    refused(
        one.orders("program", &json!({"name": "../a", "tag": tag})),
        "no program can have this name",
    );
    refused(
        one.orders("program", &json!({"name": "none", "tag": tag})),
        "no such program",
    );
    let mut told = page.watch();
    wait(&mut told, "s", |s| s["by"].is_string());
    one.does("program", &args);
    let begun = wait(&mut told, "program", |_| true);
    // The way to go is told by a path of the same tables that begins where the program has begun.
    let path = one.seen("/programs/long.nc/path");
    let [by, from] = ["by", "from"].map(|key| path[key].clone());
    assert!(by.is_string() && from.is_string(), "{path}");
    assert_eq!(
        begun,
        json!({"name": "long.nc", "tag": tag, "start": null, "by": by, "from": from, "end": null})
    );
    user.wait_for("run");
    refused(one.orders("program", &args), "4502 ");
    // Nobody changes it under way.
    let own = one.cookie.clone();
    let write = |name: &str, tag: &str| {
        let origin = format!("Origin: http://{}", page.address);
        let (cookie, seen) = (format!("Cookie: {own}"), format!("If-Match: \"{tag}\""));
        let kind = "Content-Type: application/octet-stream";
        let headers = [&*origin, "X-Leadscrew: 1", kind, &cookie, &seen];
        page.ask(&format!("PUT /programs/{name}"), &headers, "M30\n")
    };
    let (status, _, body) = write("long.nc", &tag);
    assert!(
        status == 409 && body.contains("\"runs\""),
        "{status} {body}"
    );
    let (_, other, _) = one.get("/programs/short.nc");
    one.does("stop", &Value::Null);
    let end = wait(&mut told, "program", |one| !one["end"].is_null());
    assert_eq!(end["end"]["ok"], false);
    assert!(
        end["end"]["en"]
            .as_str()
            .unwrap()
            .starts_with("long.nc: 4300 "),
        "{end}"
    );
    let (status, _, body) = write("long.nc", &tag);
    assert_eq!(status, 200, "{body}");
    one.does("reset", &Value::Null);
    user.wait_for("idle");
    // One that comes to its end, and one that is wrong.
    one.does("program", &json!({"name": "short.nc", "tag": other}));
    let end = wait(&mut told, "program", |one| {
        one["name"] == "short.nc" && !one["end"].is_null()
    });
    assert_eq!(end["end"]["ok"], true, "{end}");
    let (_, wrong, _) = one.get("/programs/wrong.nc");
    one.does(
        "program",
        &json!({"name": "wrong.nc", "tag": wrong, "zh": true}),
    );
    let end = wait(&mut told, "program", |one| {
        one["name"] == "wrong.nc" && !one["end"].is_null()
    });
    assert_eq!(end["end"]["ok"], false, "{end}");
    assert!(!end["end"]["zh"].as_str().unwrap().is_ascii(), "{end}");
}

/// Started at its seventh line, it begins at X -40 Z -5.
pub const PART: &str = "O1\nG98 G97 S500 M3\nT0101\nM8\nG0 X-30 Z-5\nG1 X-40 F2000\nZ-20\nG61\nX-30\nG0 Z-5\nG2 X-34 Z-7 R2 F500\nG0 X-10\nM30\n";

#[test]
fn a_program_is_started_at_a_line_as_its_page_was_shown() {
    let user = User::with_machine();
    let page = with_programs(
        &user,
        &[
            ("part.nc", PART),
            ("wrong.nc", "G1 Q\nG0 X1\n"),
            ("outer.nc", "M98 P79\nG0 X1\nM30\n"),
            ("O0079.nc", "O79\nG1 Q\nM99\n"),
        ],
    );
    let mut one = page.client("one");
    let shown = one.seen("/programs/part.nc/start/7");
    let text = shown["text"].as_str().unwrap();
    for row in [
        "tool       T0101 has to be in place",
        "spindle    500 rpm",
        "coolant    M08",
        "begins at  X -40  Z -5  (machine X -40  Z -5)",
        "approach   Z -5, X -40 at a sixth of rapid",
    ] {
        assert!(text.contains(row), "{row}: {text}");
    }
    for (path, why) in [
        ("part.nc/start/11", "the line is an arc"),
        ("part.nc/start/99", "fewer lines"),
        ("wrong.nc/start/2", "1: 4"),
        ("outer.nc/start/2", "O0079.nc:2: 4"),
    ] {
        let (_, _, body) = one.get(&format!("/programs/{path}"));
        let seen: Value = serde_json::from_str(&body).unwrap();
        let told = seen["error"].as_str().unwrap();
        assert!(told.contains(why), "{seen}");
        assert_eq!(told.contains(".nc"), path.starts_with("outer"), "{seen}");
    }
    let (_, tag, _) = one.get("/programs/part.nc");
    let start = json!({"line": 7, "shown": shown["shown"]});
    let args = json!({"name": "part.nc", "tag": tag, "start": start});
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    // Nothing is started at a line that was not shown.
    let mut other = args.clone();
    other["start"]["shown"] = Value::Null;
    assert_eq!(one.orders("program", &other).0, 400);
    assert_eq!(user.json(&["status"])["state"], "idle");
    let mut told = page.watch();
    wait(&mut told, "s", |s| s["by"].is_string());
    one.does("program", &args);
    let begun = wait(&mut told, "program", |_| true);
    // Its moves are not those of a path.
    let (by, from) = (&begun["by"], &begun["from"]);
    assert_eq!(
        (&begun["start"], by, from),
        (&json!(7), &json!(null), &json!(null))
    );
    let end = wait(&mut told, "program", |one| !one["end"].is_null());
    assert_eq!(end["end"]["ok"], true, "{end}");
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&json!(-10), &json!(-7)));
}

/// Somebody else changes what decides what runs, in the moment between the look at a start and its order.
#[test]
fn a_start_is_refused_where_anything_that_decides_what_runs_was_changed_since_it_was_shown() {
    let user = User::with_machine();
    let text = "G98\nG0 X-4 Z-2\nG1 X-6 F3000\nM98 P77\nG1 Z#500\nM30\n";
    let sub = |way: &str| format!("O77\nG1 {way}\nM99\n");
    let page = with_programs(&user, &[("part.nc", text), ("O0077.nc", &sub("X-8"))]);
    let folder = user.0.join("state/leadscrew");
    std::fs::create_dir_all(&folder).unwrap();
    let keep = |value: &str| {
        let text = format!("#500 = {value}\n");
        std::fs::write(folder.join("leadscrew.variables"), text).unwrap();
    };
    keep("-5.0");
    let mut one = page.client("one");
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    let (_, tag, _) = one.get("/programs/part.nc");
    let mut told = page.watch();
    let mut end = |one: &mut Client<'_>, change: &dyn Fn()| {
        let shown = one.seen("/programs/part.nc/start/3");
        change();
        let start = json!({"line": 3, "shown": shown["shown"]});
        one.does(
            "program",
            &json!({"name": "part.nc", "tag": tag, "start": start}),
        );
        let mut end = wait(&mut told, "program", |one| !one["end"].is_null());
        end["end"].take()
    };
    let other_sub = || std::fs::write(user.0.join("parts/O0077.nc"), sub("X-7")).unwrap();
    let other_place = || {
        good(&user.does(&["mdi", "G0 X-1"]));
        good(&user.does(&["mode", "automatic"]));
    };
    let offset = || drop(good(&user.does(&["offsets", "set", "G54.Z=-1"])));
    let changes: [(&str, &dyn Fn()); 4] = [
        ("variables", &|| keep("-6.0")),
        ("the program, a subprogram", &other_sub),
        ("the axes", &other_place),
        ("work offsets or tools", &offset),
    ];
    let by = one.seen("/programs/part.nc/start/3")["by"].clone();
    for (what, change) in changes {
        let before = user.json(&["status"]);
        let end = end(&mut one, change);
        let why = end["en"].as_str().unwrap();
        assert!(
            why.contains(what) && why.contains("look at it again"),
            "{what}: {end}"
        );
        let after = user.json(&["status"]);
        assert_eq!(
            (&before["mz"], &after["state"]),
            (&after["mz"], &json!("idle"))
        );
    }
    // Looked at again it runs, as it was shown, once the panel has read the table.
    wait(&mut page.watch(), "s", |s| {
        s["by"].is_string() && s["by"] != by
    });
    let end = end(&mut one, &|| {});
    assert_eq!(end["ok"], true, "{end}");
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&json!(-7), &json!(-7)));
}

/// Two blocks that move.
const BLOCKS: &str = "G98 G1 X-2 F3000\nZ-2\nM30\n";

/// What an operator has switched on acts in what is started behind it, and stays so, wherever it is started.
#[test]
fn single_block_and_overrides_stay_as_they_were_set_where_a_program_is_started() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("a.nc", BLOCKS)]);
    let mut one = page.client("one");
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    one.does("single", &json!({"on": true}));
    one.does("feed", &json!({"percent": 80}));
    let mut told = page.watch();
    wait(&mut told, "s", |s| s["single"] == true && s["feed"] == 80);
    let (_, tag, _) = one.get("/programs/a.nc");
    one.does("program", &json!({"name": "a.nc", "tag": tag}));
    // Between the two blocks.
    let stopped = |user: &User| {
        let held = user.wait_for("hold");
        assert_eq!((&held["mx"], &held["mz"]), (&json!(-2), &json!(0)));
        assert_eq!(
            (&held["single_block"], &held["hold"]),
            (&true.into(), &false.into())
        );
    };
    stopped(&user);
    assert_eq!(user.json(&["status"])["override"]["feed"], 80);
    // Switched off it goes on to its end.
    one.does("single", &json!({"on": false}));
    one.does("resume", &Value::Null);
    let end = wait(&mut told, "program", |one| !one["end"].is_null());
    assert_eq!(end["end"]["ok"], true, "{end}");
    // By commands: what is not given is left, what is given is set.
    one.does("single", &json!({"on": true}));
    wait(&mut told, "s", |s| s["single"] == true);
    good(&user.does(&["mdi", "M8", "--single-block=off"]));
    assert_eq!(user.json(&["status"])["single_block"], false);
    one.does("single", &json!({"on": true}));
    wait(&mut told, "s", |s| s["single"] == true);
    let path = user.program("G98 G1 X-2 Z0 F3000\nX-2\nZ-2\nM30\n");
    let begins = |more: &[&str]| {
        let mut command = user.command(&[&["run", &path], more].concat());
        command.spawn().unwrap()
    };
    let ends = |mut run: std::process::Child| {
        user.does(&["stop"]);
        let _ = run.wait().unwrap();
        good(&user.does(&["reset"]));
    };
    let run = begins(&[]);
    stopped(&user);
    ends(run);
    good(&user.does(&["run", &path, "--single-block=off"]));
    assert_eq!(user.json(&["status"])["single_block"], false);
    good(&user.does(&["run", &path]));
    let run = begins(&["--single-block"]);
    stopped(&user);
    ends(run);
    // A panel sets it when it begins, and the monitor too.
    let _page = Page::with(&user, &["--single-block=off"]);
    assert_eq!(user.json(&["status"])["single_block"], false);
    let told = bad(&user.does(&["status", "--single-block=yes"]), 2);
    assert!(told.contains("it is `on` or `off`"), "{told}");
}

#[test]
fn a_program_goes_on_where_the_panel_ends() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("long.nc", LONG)]);
    let mut one = page.client("one");
    one.take();
    one.does("mode", &json!({"mode": "automatic"}));
    let (_, tag, _) = one.get("/programs/long.nc");
    one.does("program", &json!({"name": "long.nc", "tag": tag}));
    user.wait_for("run");
    drop(one);
    drop(page);
    assert_eq!(user.json(&["status"])["state"], "run");
    good(&user.does(&["stop"]));
    user.wait_for("alarm");
}

#[test]
fn a_panel_without_a_folder_tells_its_page_and_a_folder_that_is_none_is_refused() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let hello = wait(&mut page.watch(), "hello", |_| true);
    assert_eq!(hello["programs"], false);
    let output = user.does(&["panel", "--listen", "127.0.0.1:0", "--programs", "nowhere"]);
    assert!(bad(&output, 2).contains("`nowhere` is no folder"));
}
