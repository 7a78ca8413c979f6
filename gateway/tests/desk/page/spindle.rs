//! The spindle turned by hand from the page: as long as frames of who operates come, and as the board lets it.

use std::sync::mpsc::channel;
use std::time::Instant;

use serde_json::{Value, json};

use super::jog::Press;
use super::{Client, Page, next, wait};
use crate::{LIMIT, User, good};

/// A machine that waits for frames as long as it may, with a door, and another speed of the spindle by hand than the one
/// built in.
pub(super) fn user() -> User {
    User::with_machine_of(&["9024=0", "9040=500", "9049=80", "9423=1"])
}

/// Turns the spindle until it is so. On a busy computer a press may end for want of frames; then it is begun anew.
#[track_caller]
fn turns(client: &Client<'_>, way: i8, so: impl Fn(&Value) -> bool) -> Press {
    let end = Instant::now() + LIMIT;
    let mut press = Press::of_spindle(client, way);
    loop {
        let answer = press.frame(client, false);
        if so(&client.state()) {
            return press;
        }
        if answer["ok"] != true || answer["pressed"] == "ended" {
            press = Press::of_spindle(client, way);
        }
        assert!(Instant::now() < end, "{answer}");
    }
}

/// It stands, and has stood for so many ms of the board as no frame that is on its way can take.
#[track_caller]
pub(super) fn stands(client: &Client<'_>) -> Value {
    let end = Instant::now() + LIMIT;
    let beat = |s: &Value| s["beat"].as_u64().unwrap();
    let mut since = client.state();
    loop {
        let s = client.state();
        if (&s["rpm"], &s["commanded"]) != (&0.into(), &0.into()) {
            since = s;
        } else if (1_000..30_000).contains(&((beat(&s) + 65_536 - beat(&since)) % 65_536)) {
            return s;
        }
        assert!(Instant::now() < end, "{since}");
    }
}

#[test]
fn it_turns_at_9049_while_frames_come_and_stands_when_they_end() {
    let user = user();
    let page = Page::start(&user);
    let mut one = page.client("one");
    one.take();
    // Once the parameters are read.
    wait(&mut page.watch(), "s", |s| s["by_hand_rpm"] == 80);
    for (way, percent, commanded) in [(1, 100, 80), (-1, 50, -40)] {
        one.does("spindle", &json!({"percent": percent}));
        let so = |s: &Value| s["commanded"] == commanded && s["rpm"] != 0 && s["pressed"] == "runs";
        let mut press = turns(&one, way, so);
        press.frame(&one, true);
        assert_eq!(stands(&one)["pressed"], "ended");
        // Nothing more comes: no release either.
        let mut press = turns(&one, way, so);
        assert_eq!(stands(&one)["pressed"], "ended");
        // And no frame of it turns anything any more.
        press.newest(&one);
        assert_eq!(press.frame(&one, false)["ok"], true);
        assert_eq!(stands(&one)["pressed"], "ended");
    }
    // No axis has moved.
    let s = one.state();
    assert_eq!((&s["mx"], &s["mz"]), (&0.into(), &0.into()));
}

#[test]
fn of_two_pages_it_is_turned_by_the_one_that_operates() {
    let user = user();
    let page = Page::start(&user);
    let (one, mut two) = (page.client("one"), page.client("two"));
    one.take();
    let mut press = turns(&one, 1, |s| s["rpm"] == 80);
    // Neither a press of its own nor a frame in the name of the other's.
    for refused in [
        Press::of_spindle(&two, -1).sent_by(&two),
        press.sent_by(&two),
    ] {
        assert_eq!(
            (refused.0, &refused.1["refused"]),
            (409, &"not_operating".into())
        );
    }
    press.frame(&one, true);
    stands(&one);
    one.operates.set(false);
    one.lease("give");
    two.take();
    let mut other = turns(&two, -1, |s| s["rpm"] == -80);
    press.newest(&two);
    assert_eq!(press.sent_by(&one).0, 409);
    other.frame(&two, true);
    stands(&two);
    // In another mode nothing turns by hand, and the page is told why.
    two.does("mode", &json!({"mode": "step"}));
    let end = Instant::now() + LIMIT;
    loop {
        let why = Press::of_spindle(&two, 1).frame(&two, false)["en"].clone();
        let why = why.as_str().unwrap();
        if why.starts_with("4501 ") {
            break;
        }
        // On a busy computer a frame comes too late to be asked anything else.
        assert!(why.contains("is old") && Instant::now() < end, "{why}");
    }
    stands(&two);
}

#[test]
fn what_the_board_refuses_is_told_to_the_page_with_its_remedy() {
    let user = user();
    let page = Page::start(&user);
    let one = page.client("one");
    one.take();
    // Whether it is told at all is to be seen: other messages come without end.
    let (send, told) = channel();
    let mut stream = page.watch();
    std::thread::spawn(move || next(&mut stream, "press").map(|why| send.send(why)));
    good(&user.does(&["sim", "door", "open"]));
    let why = {
        let end = Instant::now() + LIMIT;
        loop {
            let answer = Press::of_spindle(&one, 1).frame(&one, false);
            one.state();
            if one.state()["pressed"] == "refused" {
                break told.recv_timeout(LIMIT).expect("the page is told why");
            }
            assert!(Instant::now() < end, "{answer}");
        }
    };
    let [en, zh] = ["en", "zh"].map(|key| why[key].as_str().unwrap());
    assert!(
        en.starts_with("4506 ") && en.contains("door") && en.contains("; "),
        "{en}"
    );
    assert!(zh.starts_with("4506 ") && !zh.is_ascii(), "{zh}");
    stands(&one);
    good(&user.does(&["sim", "door", "close"]));
    turns(&one, 1, |s| s["rpm"] == 80).frame(&one, true);
    stands(&one);
}
