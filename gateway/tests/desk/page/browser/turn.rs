//! The spindle turned by hand: while its button is held, by mouse, finger and Enter, at the speed that is shown beside it.
//!
//! Another panel looks on: what it is told is the board's.

use std::time::Instant;

use serde_json::json;

use super::super::spindle::{stands, user};
use super::super::{Client, Page};
use super::{Browser, Tab, signal};
use crate::{LIMIT, good};

/// States of the machine within which a spindle has come to its speed.
const STATES: usize = 60;

/// How a button is held, and let go.
#[derive(Clone, Copy, Debug)]
enum By {
    Mouse,
    Finger,
    /// The finger is taken away by the browser, for a gesture of its own.
    FingerTaken,
    Enter,
    /// Enter is still down, and the keys go to the next button.
    EnterAndTab,
    /// Any other key is pressed.
    MouseAndKey,
    /// Another tab is in front of the page.
    MouseAndHidden,
    /// Nothing of the machine comes any more.
    MouseAndOld,
}

const ALL: [By; 8] = [
    By::Mouse,
    By::Finger,
    By::FingerTaken,
    By::Enter,
    By::EnterAndTab,
    By::MouseAndKey,
    By::MouseAndHidden,
    By::MouseAndOld,
];

fn touch(tab: &mut Tab<'_>, kind: &str, which: &str) {
    let place = tab.says(&format!(
        "(() => {{ const one = document.querySelector('{which}'); one.scrollIntoView({{block: 'center'}}); \
         const at = one.getBoundingClientRect(); return [at.x + at.width / 2, at.y + at.height / 2]; }})()"
    ));
    let points = match kind {
        "touchStart" => json!([{"x": place[0], "y": place[1]}]),
        _ => json!([]),
    };
    tab.asks(
        "Input.dispatchTouchEvent",
        json!({"type": kind, "touchPoints": points}),
    );
}

fn enter(tab: &mut Tab<'_>, kind: &str) {
    let params = json!({"type": kind, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13,
        "text": if kind == "keyDown" { "\r" } else { "" }});
    tab.asks("Input.dispatchKeyEvent", params);
}

impl By {
    fn down(self, tab: &mut Tab<'_>, which: &str) {
        match self {
            Self::Finger | Self::FingerTaken => touch(tab, "touchStart", which),
            Self::Enter | Self::EnterAndTab => {
                tab.says(&format!("document.querySelector('{which}').focus()"));
                enter(tab, "keyDown");
            }
            _ => tab.mouse(which, "mousePressed"),
        }
    }

    fn ends(self, page: &Page, tab: &mut Tab<'_>, which: &str) {
        match self {
            Self::Mouse => tab.mouse(which, "mouseReleased"),
            Self::Finger => touch(tab, "touchEnd", which),
            Self::FingerTaken => touch(tab, "touchCancel", which),
            Self::Enter => enter(tab, "keyUp"),
            Self::EnterAndTab => tab.next(),
            Self::MouseAndKey => tab.key("x", 88, "x"),
            Self::MouseAndHidden => {
                let front = json!({"url": "about:blank"});
                tab.browser.asks(None, "Target.createTarget", front);
                tab.wait("document.hidden");
            }
            Self::MouseAndOld => {
                signal(page, "-STOP");
                tab.wait("document.body.classList.contains('old')");
            }
        }
    }

    /// What is still down goes up, and the page is as it was.
    fn is_over(self, page: &Page, tab: &mut Tab<'_>, which: &str) {
        match self {
            Self::Mouse | Self::Finger | Self::FingerTaken | Self::Enter => {}
            Self::EnterAndTab => enter(tab, "keyUp"),
            Self::MouseAndKey => tab.mouse(which, "mouseReleased"),
            Self::MouseAndHidden => {
                let target = json!({"targetId": tab.target});
                tab.browser.asks(None, "Target.activateTarget", target);
                tab.wait("!document.hidden");
                tab.mouse(which, "mouseReleased");
            }
            Self::MouseAndOld => {
                // By values that are old nothing is begun, and the page says so.
                tab.mouse(which, "mouseReleased");
                tab.mouse(which, "mousePressed");
                tab.wait("document.getElementById('answer').textContent.includes('old')");
                tab.mouse(which, "mouseReleased");
                signal(page, "-CONT");
            }
        }
        tab.wait("!document.body.classList.contains('old')");
    }
}

/// On a busy computer what is shown may move away from under the mouse: then it is clicked again.
#[track_caller]
fn operates(tab: &mut Tab<'_>) {
    tab.until("document.body.classList.contains('operates')", |tab| {
        tab.click("#take");
    });
}

/// Holds the button until the spindle turns so fast. On a busy computer a press may end for want of frames; then it is
/// pressed anew.
#[track_caller]
fn holds(tab: &mut Tab<'_>, eye: &Client<'_>, page: &Page, by: By, (which, rpm): (&str, i64)) {
    let end = Instant::now() + LIMIT;
    operates(tab);
    by.down(tab, which);
    while !(0..STATES).any(|_| eye.state()["rpm"] == rpm) {
        let told = tab.says("document.getElementById('answer').textContent");
        assert!(Instant::now() < end, "{by:?}: {told}");
        by.ends(page, tab, which);
        by.is_over(page, tab, which);
        operates(tab);
        by.down(tab, which);
    }
}

#[test]
fn the_spindle_turns_while_its_button_is_held_and_stands_however_that_ends() {
    let user = user();
    let page = Page::start(&user);
    let looks = Page::start(&user);
    let eye = looks.client("eye");
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.getElementById('by_hand_rpm').textContent === '80 rpm × 100 %'");
    operates(&mut tab);
    // Rapid is of the axes.
    let rapid = "document.getElementById('rapidly').ariaPressed === 'true'";
    tab.click_once("#rapidly", rapid);
    for (number, by) in ALL.into_iter().enumerate() {
        println!("{by:?}");
        let (which, rpm) = [("[data-jog=\"S+\"]", 80), ("[data-jog=\"S-\"]", -80)][number % 2];
        holds(&mut tab, &eye, &page, by, (which, rpm));
        by.ends(&page, &mut tab, which);
        stands(&eye);
        by.is_over(&page, &mut tab, which);
        // What was down begins nothing by itself.
        stands(&eye);
    }
    // The page goes in the middle of it.
    let mouse = By::Mouse;
    holds(&mut tab, &eye, &page, mouse, ("[data-jog=\"S+\"]", 80));
    tab.close();
    stands(&eye);
    let s = eye.state();
    assert_eq!((&s["mx"], &s["mz"]), (&0.into(), &0.into()));
}

#[test]
fn what_keeps_the_spindle_from_being_turned_is_said_in_the_boards_words() {
    let user = user();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    operates(&mut tab);
    let says =
        |part: &str| format!("document.getElementById('answer').textContent.includes('{part}')");
    let click = |tab: &mut Tab<'_>| {
        operates(tab);
        tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
        tab.mouse("[data-jog=\"S+\"]", "mousePressed");
    };
    good(&user.does(&["sim", "door", "open"]));
    tab.until(&says("4506 "), click);
    tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
    tab.click("#language");
    tab.wait(
        "/主轴.*9049/.test(document.querySelector('[data-word=spindle_by_hand]').textContent)",
    );
    tab.until(&says("禁止此操作"), click);
    tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
    tab.click("#language");
    good(&user.does(&["sim", "door", "close"]));
    tab.mode("step");
    tab.until(&says("4501 "), click);
    tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
    // Another speed is shown as it holds.
    good(&user.does(&["params", "set", "9049=30"]));
    good(&user.does(&["override", "spindle", "120"]));
    tab.wait("document.getElementById('by_hand_rpm').textContent === '30 rpm × 120 %'");
}
