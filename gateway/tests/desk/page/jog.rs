//! Axes moved by hand from the page: as long as its frames come.

use std::io::Write as _;
use std::time::Duration;

use serde_json::{Value, json};

use super::{Client, Page, chance, wait};
use crate::User;

/// Parameters 9041 and 9040 as built in: mm/min of the slide, and ms.
const FEED: f64 = 1000.0;
const DEAD_MAN: f64 = 100.0;
/// From that speed an axis comes to rest within this many mm.
const BRAKES: f64 = 1.0;

/// A press of Z, or of the spindle.
pub(super) struct Press {
    number: u64,
    way: i8,
    of_spindle: bool,
    /// The beats of its first and its last frame.
    echoes: [u64; 2],
}

impl Press {
    /// The first frame.
    fn begin(client: &Client<'_>, way: i8) -> (Self, f64) {
        let s = client.state();
        let number = (s["press"].as_u64().unwrap_or(0) + 1) % 256;
        let echo = s["beat"].as_u64().unwrap();
        let press = Self {
            number,
            way,
            of_spindle: false,
            echoes: [echo; 2],
        };
        (press, s["mz"].as_f64().unwrap())
    }

    /// The first frame of one that turns the spindle.
    pub(super) fn of_spindle(client: &Client<'_>, way: i8) -> Self {
        let (press, _) = Self::begin(client, way);
        Self {
            of_spindle: true,
            ..press
        }
    }

    fn body(&self, client: &Client<'_>, released: bool) -> Value {
        let way = if released { 0 } else { self.way };
        let (z, spindle) = if self.of_spindle { (0, way) } else { (way, 0) };
        json!({"c": client.name, "press": self.number, "axes": [0, z], "spindle": spindle, "rapid": false, "speed": 0,
            "echo": self.echoes[1]})
    }

    /// Its next frame carries the beat that its page has now.
    pub(super) fn newest(&mut self, client: &Client<'_>) {
        self.echoes[1] = client.state()["beat"].as_u64().unwrap();
    }

    /// One frame, whoever sends it.
    pub(super) fn sent_by(&self, client: &Client<'_>) -> (u16, Value) {
        let body = self.body(client, false);
        client.page.post(&client.cookie, "/jog", &body)
    }

    /// One frame with the newest beat that is known.
    pub(super) fn frame(&mut self, client: &Client<'_>, released: bool) -> Value {
        let body = self.body(client, released);
        let mut sent = client.page.post(&client.cookie, "/jog", &body);
        if sent.0 == 409 {
            client.renew();
            sent = client.page.post(&client.cookie, "/jog", &body);
        }
        let (status, answer) = sent;
        assert_eq!(status, 200, "{answer}");
        self.echoes[1] = answer["beat"].as_u64().unwrap();
        answer
    }

    /// One frame that comes late: with a beat that was new before.
    fn late(&self, client: &Client<'_>, delay: Duration) {
        let body = self.body(client, false);
        std::thread::sleep(delay);
        client.page.post(&client.cookie, "/jog", &body);
    }

    /// The network is cut in the middle of a frame.
    fn cut(client: &Client<'_>) {
        let mut stream = client.page.connect();
        let head = format!(
            "POST /jog HTTP/1.1\r\nHost: {}\r\nContent-Le",
            client.page.address
        );
        stream.write_all(head.as_bytes()).unwrap();
    }
}

/// How far a press may go whose first and last frame had these beats: until the last is too old, by the board's own clock.
pub(super) fn longest(first: u64, last: u64) -> f64 {
    let ms = (last + 65_536 - first) % 65_536;
    FEED / 60_000.0 * (ms as f64 + DEAD_MAN) + BRAKES
}

/// Where Z is once the press is over, and whether it has begun at all: on a busy computer all of its frames may come too
/// late.
fn rest(user: &User, client: &Client<'_>, press: &Press) -> (f64, bool) {
    let begun = loop {
        let s = client.state();
        let own = s["press"] == press.number;
        if own && !matches!(s["pressed"].as_str(), Some("runs" | "none")) {
            break true;
        }
        let since = (s["beat"].as_u64().unwrap() + 65_536 - press.echoes[1]) % 65_536;
        if !own && (1_000..30_000).contains(&since) {
            break false;
        }
    };
    // The answer comes before the axis stands.
    (user.wait_for("idle")["mz"].as_f64().unwrap(), begun)
}

/// Presses of which nothing more comes at some time, on a machine of their own; how far they have gone together.
fn vanishing(presses: u32, seed: u64) -> f64 {
    let user = User::with_machine();
    let page = Page::start(&user);
    let one = page.client("one");
    one.take();
    let mut moved = 0.0;
    let mut below = chance(seed);
    for number in 0..presses {
        // There and back, so that no limit ends a press.
        let way = if number % 2 == 0 { -1 } else { 1 };
        let (mut press, from) = Press::begin(&one, way);
        for _ in 0..=below(12) {
            press.frame(&one, false);
            std::thread::sleep(Duration::from_millis(below(30)));
        }
        // Nothing more comes, or half a frame, or one that was under way for long. The board tells when it is over.
        match below(3) {
            0 => {}
            1 => Press::cut(&one),
            _ => press.late(&one, Duration::from_millis(below(150))),
        }
        let (to, begun) = rest(&user, &one, &press);
        let gone = (to - from) * f64::from(way);
        let longest = longest(press.echoes[0], press.echoes[1]);
        assert!((0.0..longest).contains(&gone), "{gone} of {longest}");
        moved += gone;
        if !begun {
            continue;
        }
        // And no frame of it moves anything any more.
        press.echoes[1] = one.state()["beat"].as_u64().unwrap();
        press.frame(&one, false);
        assert_eq!(rest(&user, &one, &press), (to, true));
    }
    moved
}

#[test]
fn a_page_that_vanishes_in_a_press_leaves_the_axis_at_rest() {
    // Most of the time is that of machines, so that several go beside each other.
    let (machines, presses) = leadscrew_seed::amount((1, 12), (4, 125));
    leadscrew_seed::only_fresh(|seed| {
        let moved: f64 = std::thread::scope(|scope| {
            let all: Vec<_> = (0..machines)
                .map(|machine| scope.spawn(move || vanishing(presses, seed ^ machine)))
                .collect();
            all.into_iter().map(|one| one.join().unwrap()).sum()
        });
        assert!(moved > 0.0);
    });
}

#[test]
fn a_press_moves_an_axis_until_it_is_let_go_and_a_step_moves_it_once() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut one = page.client("one");
    one.take();
    let (mut press, from) = Press::begin(&one, -1);
    while one.state()["mz"].as_f64().unwrap() > from - 0.5 {
        // On a busy computer a press ends for want of frames; then it is begun anew.
        if press.frame(&one, false)["pressed"] == "ended" {
            press = Press::begin(&one, -1).0;
        }
    }
    press.frame(&one, true);
    let (at, _) = rest(&user, &one, &press);
    assert!(at <= from - 0.5);
    // The page goes; nothing but the press was at stake.
    let jog = json!({"c": "two", "press": 1, "axes": [0, 1], "spindle": 0, "rapid": false, "speed": 0, "echo": 0});
    assert_eq!(page.post(&one.cookie, "/jog", &jog).0, 409);
    one.does("mode", &json!({"mode": "step"}));
    one.does("step", &json!({"axis": "Z+", "by": "0.1"}));
    wait(&mut page.watch(), "s", |s| {
        (s["mz"].as_f64().unwrap() - at - 0.1).abs() < 1e-9
    });
    // In another mode nothing moves by hand, and the page is told why.
    one.does("mode", &json!({"mode": "automatic"}));
    let before = one.state();
    let mut why = Press::begin(&one, -1).0.frame(&one, false);
    // On a busy computer a frame comes too late to be asked anything else.
    while why["en"].as_str().unwrap_or_default().contains("is old") {
        why = Press::begin(&one, -1).0.frame(&one, false);
    }
    assert!(why["en"].as_str().unwrap().starts_with("4501 "), "{why}");
    assert_eq!(one.state()["mz"], before["mz"]);
}
