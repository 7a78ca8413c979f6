//! The link that was opened works on when its machine has ended and was started again.

use serde_json::json;

use super::super::Page;
use super::super::programs::{PART, with_programs};
use super::{Browser, found};
use crate::{User, good};

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
