//! A page that goes in the middle of a press: in each way that a browser has for it, the axis comes to rest within the
//! board's dead man, and nothing of the press moves anything any more, whatever of it comes back.
//!
//! Another panel looks on; by its beats, which are the board's time, is judged how far the axis may have gone.

use std::time::Instant;

use serde_json::{Value, json};

use super::super::jog::longest;
use super::super::{Client, Page, chance};
use super::{Browser, Tab, long, signal};
use crate::{LIMIT, User};

/// What happens to a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Closed,
    Reloaded,
    Left,
    Crashed,
    /// Another tab is in front of it.
    Hidden,
    /// The browser lets it do nothing, and it stays behind.
    Frozen,
    /// Its script stands still.
    Paused,
    /// No request of it gets out.
    Cut,
    /// The panel stands still, and what the page sends waits for it.
    Waits,
}

const WAYS: [Way; 9] = [
    Way::Frozen,
    Way::Paused,
    Way::Cut,
    Way::Waits,
    Way::Hidden,
    Way::Closed,
    Way::Reloaded,
    Way::Left,
    Way::Crashed,
];

fn offline(tab: &mut Tab<'_>, offline: bool) {
    let how =
        json!({"offline": offline, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1});
    tab.asks("Network.emulateNetworkConditions", how);
}

impl Way {
    /// It happens, and is so when this ends. True where the page is another one from then on.
    fn happens(self, page: &Page, tab: &mut Tab<'_>) -> bool {
        match self {
            Self::Closed => {
                let target = json!({"targetId": tab.target});
                tab.browser.asks(None, "Target.closeTarget", target);
            }
            Self::Reloaded => drop(tab.asks("Page.reload", json!({}))),
            Self::Left => drop(tab.asks("Page.navigate", json!({"url": "about:blank"}))),
            // It answers no more.
            Self::Crashed => {
                tab.sends("Page.crash", json!({}));
                tab.browser.hears("Inspector.targetCrashed");
            }
            Self::Hidden => {
                let front = json!({"url": "about:blank"});
                tab.browser.asks(None, "Target.createTarget", front);
                tab.wait("document.hidden");
            }
            Self::Frozen => {
                drop(tab.asks("Page.setWebLifecycleState", json!({"state": "frozen"})));
            }
            Self::Paused => {
                tab.asks("Debugger.enable", json!({}));
                tab.sends("Debugger.pause", json!({}));
                tab.browser.hears("Debugger.paused");
            }
            Self::Cut => offline(tab, true),
            Self::Waits => signal(page, "-STOP"),
        }
        matches!(
            self,
            Self::Closed | Self::Reloaded | Self::Left | Self::Crashed | Self::Frozen
        )
    }

    /// The page comes back, as far as it can.
    fn ends(self, page: &Page, tab: &mut Tab<'_>) {
        match self {
            Self::Hidden => {
                let target = json!({"targetId": tab.target});
                tab.browser.asks(None, "Target.activateTarget", target);
                tab.wait("!document.hidden");
                let all = tab.browser.asks(None, "Target.getTargets", json!({}));
                for one in all["targetInfos"].as_array().unwrap() {
                    if one["type"] == "page" && one["targetId"] != tab.target.as_str() {
                        let other = json!({"targetId": one["targetId"]});
                        tab.browser.asks(None, "Target.closeTarget", other);
                    }
                }
            }
            Self::Paused => {
                tab.asks("Debugger.resume", json!({}));
                tab.asks("Debugger.disable", json!({}));
            }
            Self::Cut => offline(tab, false),
            Self::Waits => signal(page, "-CONT"),
            Self::Closed | Self::Reloaded | Self::Left | Self::Crashed | Self::Frozen => {}
        }
    }
}

fn beat(s: &Value) -> u64 {
    s["beat"].as_u64().unwrap()
}

fn z(s: &Value) -> f64 {
    s["mz"].as_f64().unwrap()
}

/// Where the axis is once it has stood for so many ms of the board.
fn rest(eye: &Client<'_>) -> f64 {
    let mut since = eye.state();
    loop {
        let s = eye.state();
        if z(&s) != z(&since) {
            since = s;
        } else if (500..30_000).contains(&((beat(&s) + 65_536 - beat(&since)) % 65_536)) {
            return z(&s);
        }
    }
}

/// Presses the button until the axis moves. On a busy computer a press may end for want of frames; then it is pressed anew.
fn begin(tab: &mut Tab<'_>, eye: &Client<'_>, which: &str) {
    let end = Instant::now() + LIMIT;
    let mut stood = 0;
    let mut last = z(&eye.state());
    tab.mouse(which, "mousePressed");
    let from = last;
    loop {
        let now = z(&eye.state());
        stood = if now == last { stood + 1 } else { 0 };
        if (now - from).abs() > 0.1 && stood == 0 {
            return;
        }
        if stood > 20 {
            let told = tab.says("document.getElementById('answer').textContent");
            assert!(Instant::now() < end, "{told}");
            tab.mouse(which, "mouseReleased");
            tab.mouse(which, "mousePressed");
            stood = 0;
        }
        last = now;
    }
}

#[test]
fn a_page_that_goes_in_a_press_leaves_the_axis_at_rest() {
    let presses = if long::seconds().is_some() { 500 } else { 18 };
    leadscrew_seed::only_fresh(|seed| {
        let user = User::with_machine();
        let page = Page::start(&user);
        let looks = Page::start(&user);
        let eye = looks.client("eye");
        let mut browser = Browser::start(&user);
        for part in [
            "ERR_INTERNET_DISCONNECTED",
            "ERR_NETWORK",
            "Failed to fetch",
        ] {
            browser.expected.push(part);
        }
        let mut below = chance(seed);
        let mut tab = browser.tab(&page.link());
        tab.operate();
        for number in 0..presses {
            // Each way at least once, and then as it comes.
            let way = WAYS
                .get(number)
                .copied()
                .unwrap_or_else(|| WAYS[below(WAYS.len() as u64) as usize]);
            // There and back, so that no limit ends a press.
            let which = ["[data-jog=\"Z-\"]", "[data-jog=\"Z+\"]"][number % 2];
            println!("{number} {way:?}");
            tab.asks("Network.enable", json!({}));
            begin(&mut tab, &eye, which);
            for _ in 0..below(8) {
                eye.state();
            }
            let before = eye.state();
            let is_gone = way.happens(&page, &mut tab);
            let behind = eye.state();
            let to = rest(&eye);
            let age = before["age_ms"].as_u64().unwrap();
            let first = (beat(&before) + 65_536 - age) % 65_536;
            let gone = (to - z(&before)).abs();
            let most = longest(first, beat(&behind));
            assert!(
                gone < most,
                "{number} {way:?}: {gone} of {most}; {before}; {behind}"
            );
            if is_gone {
                if way != Way::Closed {
                    tab.close();
                }
                tab = browser.tab(&page.link());
            } else {
                way.ends(&page, &mut tab);
                tab.wait("!document.body.classList.contains('old')");
            }
            // The finger is still down, or lies on another page: nothing moves until it is down anew.
            assert_eq!(rest(&eye), to, "{number} {way:?}");
            if !is_gone {
                tab.mouse(which, "mouseReleased");
            }
            if tab.says("document.body.classList.contains('operates')") != true {
                tab.operate();
            }
        }
        println!("{presses} presses");
        // At last the whole browser.
        begin(&mut tab, &eye, "[data-jog=\"Z-\"]");
        let before = eye.state();
        browser.killed();
        let behind = eye.state();
        let to = rest(&eye);
        let age = before["age_ms"].as_u64().unwrap();
        let first = (beat(&before) + 65_536 - age) % 65_536;
        assert!((to - z(&before)).abs() < longest(first, beat(&behind)));
    });
}
