//! What a page asks of its panel keeps no hold waiting: a browser has six connections for all pages of a panel.

use super::super::Page;
use super::super::programs::{PART, with_programs};
use super::Browser;
use crate::User;

/// From now on requests to such an address have no answer, until the page gives them up. `waits` counts those, `most` the
/// most at a time, `asked` each of them.
fn held(which: &str) -> String {
    format!(
        "(() => {{ const own = fetch; Object.assign(window, {{ waits: 0, most: 0, asked: 0 }}); \
         window.fetch = (path, more) => !/{which}/.test(path) ? own(path, more) : new Promise((_, fails) => {{ \
         if (more?.signal?.aborted) return fails(more.signal.reason); \
         waits += 1; asked += 1; most = Math.max(most, waits); \
         more?.signal?.addEventListener('abort', () => {{ waits -= 1; fails(more.signal.reason); }}); }}); return true; }})()"
    )
}

#[test]
fn of_programs_that_are_opened_one_after_the_other_one_is_looked_at() {
    let user = User::with_machine();
    let names = ["a.nc", "b.nc", "c.nc"];
    let page = with_programs(&user, &names.map(|name| (name, PART)));
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 4");
    tab.says(&held("check|path"));
    for (number, name) in names.iter().enumerate() {
        tab.choose(name);
        tab.wait(&format!(
            "document.getElementById('name').value === '{name}' && asked > {number}"
        ));
    }
    assert_eq!(tab.says("[waits, most]"), serde_json::json!([1, 1]));
    // What was given up is no news.
    assert_eq!(
        tab.says("document.getElementById('answer').textContent"),
        ""
    );
}

#[test]
fn a_page_without_answers_asks_for_its_lease_once_at_a_time_and_says_that_its_hold_has_not_come() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.operate();
    tab.says(&held("lease"));
    // It is given up and asked for again, before the lease has lapsed.
    tab.wait("asked >= 2");
    assert_eq!(tab.says("most"), 1);
    tab.says(&held("lease|order"));
    for which in ["#hold", "#stop"] {
        tab.says("document.getElementById('answer').textContent = ''");
        tab.click(which);
        tab.wait("document.getElementById('answer').textContent.includes('has not come')");
    }
    assert_eq!(user.json(&["status"])["state"], "idle");
}
