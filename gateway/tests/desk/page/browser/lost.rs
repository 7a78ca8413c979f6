//! The link that was opened works on when its machine has ended and was started again.

use serde_json::json;

use super::super::programs::{PART, with_programs};
use super::super::{Page, Told, next};
use super::{Browser, found};
use crate::{User, good};

/// So many pages of a panel may be open.
const STREAMS: usize = 16;

#[test]
fn a_page_says_that_the_board_is_not_heard_and_orders_nothing_when_it_is_heard_again() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.operate();
    tab.mode("automatic");
    let operates = "document.body.classList.contains('operates')";
    let banner = "document.getElementById('banner')";
    let says = |part: &str| format!("!{banner}.hidden && {banner}.textContent.includes('{part}')");
    good(&user.does(&["down"]));
    for part in [
        "may be moving",
        "not heard since",
        "nothing can be ordered",
        "desk",
    ] {
        tab.wait(&says(part));
    }
    tab.wait(&format!("!{operates}"));
    tab.until(
        "document.getElementById('answer').textContent.includes('board is not heard')",
        |tab| tab.click("#hold"),
    );
    tab.click("#language");
    tab.wait(&says("失去联系于"));
    tab.click("#language");
    // A page that comes meanwhile is shown no state of before.
    tab.asks("Page.reload", json!({}));
    tab.wait(&says("not heard since"));
    assert_eq!(tab.says("document.getElementById('mx').textContent"), "");
    tab.operate();
    good(&user.does(&["up"]));
    tab.wait(&format!(
        "{banner}.hidden && document.body.dataset.state === 'idle'"
    ));
    tab.wait(&format!("!{operates}"));
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["mode"], &status["state"], &status["mz"]),
        (&json!("manual"), &json!("idle"), &json!(0))
    );
    tab.operate();
    tab.mode("automatic");
    assert_eq!(user.json(&["status"])["mode"], "automatic");
}

/// A page that was refused says why, and asks again by itself.
#[test]
fn a_page_for_which_there_was_no_room_is_told_so_and_lives_once_there_is() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    browser.expected.push("status of 503");
    let mut tab = browser.tab(&page.link());
    tab.asks("Page.navigate", json!({"url": "about:blank"}));
    // All places of those who watch, that of the page too once the panel has seen it go.
    let mut watching = Vec::new();
    while watching.len() < STREAMS {
        let mut one = page.watch();
        if next(&mut one, "hello").is_some() {
            watching.push(Told::from(one));
        }
    }
    tab.asks("Page.navigate", json!({"url": page.link()}));
    let banner = "document.getElementById('banner')";
    tab.wait(&format!(
        "!{banner}?.hidden && {banner}.textContent.includes('too many')"
    ));
    drop(watching);
    tab.wait(&format!(
        "{banner}.hidden && document.getElementById('mx').textContent > ''"
    ));
}

/// The clock of a page stands still while a tablet sleeps.
#[test]
fn what_was_heard_before_a_page_was_hidden_has_no_age() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("!document.body.classList.contains('old')");
    let front = json!({"url": "about:blank"});
    tab.browser.asks(None, "Target.createTarget", front);
    tab.wait(
        "document.hidden && document.body.classList.contains('old') \
         && document.getElementById('age').textContent === ''",
    );
    let target = json!({"targetId": tab.target});
    tab.browser.asks(None, "Target.activateTarget", target);
    tab.wait("!document.body.classList.contains('old')");
}

/// What the panel cannot look at yet is looked at as soon as it can, without being opened again.
#[test]
fn a_program_that_was_opened_without_a_board_is_looked_at_once_there_is_one() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("part.nc", PART)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    good(&user.does(&["down"]));
    tab.wait("!document.getElementById('banner').hidden");
    tab.choose("part.nc");
    tab.wait("document.getElementById('answer').textContent.includes('not read yet')");
    assert_eq!(tab.says(&found("moves")), json!(false));
    good(&user.does(&["up"]));
    tab.wait(&found("moves"));
    tab.wait("document.getElementById('path_note').textContent.includes('pieces')");
}
