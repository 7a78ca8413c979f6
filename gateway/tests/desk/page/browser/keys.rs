//! All of a first part by keys alone: no mouse, and nothing that a script presses.

use std::time::Instant;

use serde_json::json;

use super::super::programs::with_programs;
use super::{Browser, Tab, found, z};
use crate::{LIMIT, LONG, User};

/// More than the page has stops.
const STOPS: usize = 400;
/// What has the keys is seen to have them.
const SEEN: &str = "(() => { const one = document.activeElement; const at = one.getBoundingClientRect(); \
    const style = getComputedStyle(one); return one.matches(':focus-visible') && style.outlineStyle === 'solid' \
    && parseFloat(style.outlineWidth) >= 2 && at.bottom > 0 && at.top < innerHeight && at.right > 0; })()";
/// A page that is not let operate takes no keys: these are all that it has.
const ALL: &str = "[...document.querySelectorAll('button, input, select, textarea, summary, [tabindex]')]\
    .filter((one) => !one.disabled && one.checkVisibility())";

/// To this one by Tab alone.
#[track_caller]
fn go(tab: &mut Tab<'_>, which: &str) {
    let there = format!("document.activeElement === document.querySelector('{which}')");
    for _ in 0..STOPS {
        if tab.says(&there) == true {
            assert_eq!(tab.says(SEEN), true, "{which} is not seen to have the keys");
            return;
        }
        tab.next();
    }
    panic!("no key comes to {which}");
}

/// A key goes down, or down again while it is held.
fn down(tab: &mut Tab<'_>, key: &str, number: u32, again: bool) {
    let text = if key == "Enter" { "\r" } else { "" };
    let params = json!({"type": if text.is_empty() { "rawKeyDown" } else { "keyDown" }, "key": key, "code": key,
        "windowsVirtualKeyCode": number, "text": text, "autoRepeat": again});
    tab.asks("Input.dispatchKeyEvent", params);
}

fn up(tab: &mut Tab<'_>, key: &str, number: u32) {
    let params = json!({"type": "keyUp", "key": key, "code": key, "windowsVirtualKeyCode": number});
    tab.asks("Input.dispatchKeyEvent", params);
}

fn operate(tab: &mut Tab<'_>) {
    let operates = "document.body.classList.contains('operates')";
    if tab.says(operates) != true {
        go(tab, "#take");
        tab.enter();
        tab.wait(operates);
    }
}

/// Presses this one with Enter until it is so.
#[track_caller]
fn presses(tab: &mut Tab<'_>, which: &str, so: &str) {
    tab.until(so, |tab| {
        operate(tab);
        go(tab, which);
        tab.enter();
    });
}

/// Holds this key, which repeats, until Z or X has gone so far. Where the press has ended, it is pressed anew.
#[track_caller]
fn holds(user: &User, tab: &mut Tab<'_>, (key, number): (&str, u32), axis: &str, far: f64) {
    let place = || user.json(&["status"])[axis].as_f64().unwrap();
    let (end, mut from) = (Instant::now() + LIMIT, place());
    let goal = from - far;
    let pad = match axis {
        "mz" => "[data-jog=\"Z-\"]",
        _ => "[data-jog=\"X-\"]",
    };
    let press = |tab: &mut Tab<'_>| {
        operate(tab);
        go(tab, pad);
        down(tab, key, number, false);
    };
    press(tab);
    while from > goal {
        down(tab, key, number, true);
        let now = place();
        if now == from {
            up(tab, key, number);
            press(tab);
        }
        from = now;
        assert!(Instant::now() < end, "{axis} {now}");
    }
    up(tab, key, number);
    tab.wait("document.body.dataset.state === 'idle'");
    // At rest: nothing of the press goes on.
    let mut at = place();
    loop {
        let now = place();
        if now == at {
            return;
        }
        at = now;
        assert!(Instant::now() < end, "{axis} {now}");
    }
}

#[test]
fn tab_comes_to_all_that_the_page_has_and_to_no_end() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("a.nc", LONG)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    tab.says("(window.been = new Set(), 1)");
    for _ in 0..STOPS {
        tab.next();
        let (stop, seen) = (
            tab.says("document.activeElement.outerHTML.slice(0, 80)"),
            tab.says(SEEN),
        );
        if tab.says("document.activeElement === document.body") == true {
            continue;
        }
        assert_eq!(seen, true, "{stop}");
        let again = tab.says(
            "(() => { const one = document.activeElement; const again = window.been.has(one); \
            window.been.add(one); return again; })()",
        );
        if again == true {
            break;
        }
    }
    let missed = tab.says(&format!(
        "{ALL}.filter((one) => !window.been.has(one)).map((one) => one.outerHTML).join(' ')"
    ));
    assert_eq!(missed, "");
    // And back.
    let last = tab.says("document.activeElement.outerHTML");
    let back = json!({"type": "keyDown", "key": "Tab", "code": "Tab", "windowsVirtualKeyCode": 9, "modifiers": 8});
    tab.next();
    tab.asks("Input.dispatchKeyEvent", back);
    assert_eq!(tab.says("document.activeElement.outerHTML"), last);
}

#[test]
fn somebody_operates_the_machine_by_keys_alone() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("a.nc", LONG)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    operate(&mut tab);
    // A program is chosen, and checked.
    tab.until("document.getElementById('name').value === 'a.nc'", |tab| {
        go(tab, "#programs");
        tab.key("ArrowDown", 40, "");
        tab.enter();
    });
    tab.wait(&found("1: "));
    let state = |state: &str| format!("document.body.dataset.state === '{state}'");
    let pressed =
        |mode: &str| format!("document.querySelector('[data-mode={mode}]').ariaPressed === 'true'");
    presses(&mut tab, "[data-mode=automatic]", &pressed("automatic"));
    // A key that is let go at once starts nothing; the one that is held repeats, and starts once.
    go(&mut tab, "#run");
    tab.enter();
    assert_eq!(tab.says(&state("idle")), true);
    tab.until(&state("run"), |tab| {
        up(tab, "Enter", 13);
        operate(tab);
        go(tab, "#run");
        down(tab, "Enter", 13, false);
        down(tab, "Enter", 13, true);
    });
    up(&mut tab, "Enter", 13);
    // Space holds wherever the keys are, and presses no button.
    tab.until(&state("hold"), |tab| tab.key(" ", 32, " "));
    assert_eq!(tab.says("document.activeElement.id"), "run");
    presses(&mut tab, "#resume", &state("run"));
    // What is shown anew takes the keys from nothing.
    go(&mut tab, "#programs");
    assert_eq!(tab.says("document.activeElement.id"), "programs");
    presses(
        &mut tab,
        "#stop",
        "document.getElementById('alarm').textContent.includes('4300')",
    );
    presses(&mut tab, "#reset", &state("idle"));
    assert_eq!(tab.says("document.activeElement.id"), "reset");
    presses(&mut tab, "[data-mode=manual]", &pressed("manual"));
    holds(&user, &mut tab, ("ArrowLeft", 37), "mz", 0.5);
    holds(&user, &mut tab, ("Enter", 13), "mx", 0.5);
    presses(&mut tab, "[data-mode=mdi]", &pressed("mdi"));
    // A line, typed key by key: a space in it is no hold.
    let line = "G98 G1 Z-3 F3000";
    // While it runs a space is a hold, so it is typed once.
    tab.once(
        "document.getElementById('answer').textContent === 'done'",
        |tab| {
            operate(tab);
            go(tab, "#typed");
            tab.says("document.activeElement.value = ''");
            for one in line.chars() {
                let key = one.to_string();
                tab.key(&key, u32::from(one.to_ascii_uppercase()), &key);
            }
            assert_eq!(tab.says("document.activeElement.value"), line);
            tab.enter();
        },
    );
    assert_eq!(z(&user), -3.0);
    assert_eq!(user.json(&["status"])["hold"], false);
}
