//! A program is started at a line: what would happen is shown, and then a button is held.

use serde_json::json;

use super::super::{Page, programs::PART};
use super::Browser;
use crate::User;

#[test]
fn somebody_starts_a_program_at_the_line_of_the_cursor() {
    let user = User::with_machine();
    let folder = user.0.join("parts");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("part.nc"), PART).unwrap();
    let page = Page::with(&user, &["--programs", folder.to_str().unwrap()]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    // Nothing is open, and nothing is shown.
    tab.until(
        "document.getElementById('answer').textContent.includes('Open a program first')",
        |tab| tab.click("#start_look"),
    );
    tab.says(
        "(() => { const list = document.getElementById('programs'); list.value = 'part.nc'; \
         list.dispatchEvent(new Event('change')); return true; })()",
    );
    tab.wait("document.getElementById('found').textContent.includes('moves')");
    let told = |part: &str| {
        format!("document.getElementById('start_told').textContent.includes('{part}')")
    };
    let cursor = |line: usize| {
        let at: usize = PART.lines().take(line - 1).map(|line| line.len() + 1).sum();
        format!("document.getElementById('source').setSelectionRange({at}, {at}) ?? true")
    };
    let shown = "!document.getElementById('start_at').hidden";
    // An arc is no start.
    tab.says(&cursor(11));
    tab.until(
        "document.getElementById('answer').textContent.includes('4590')",
        |tab| tab.click("#start_look"),
    );
    tab.wait("document.getElementById('start_at').hidden");
    tab.says(&cursor(7));
    tab.until(shown, |tab| tab.click("#start_look"));
    tab.wait(&told("begins at  X -40  Z -5"));
    tab.wait(&told("T0101 has to be in place"));
    tab.wait("document.getElementById('start_line').textContent === '7'");
    // In the other language it is shown anew.
    tab.click("#language");
    tab.wait("document.getElementById('start_at').hidden");
    tab.until(shown, |tab| tab.click("#start_look"));
    tab.wait(&told("须已就位"));
    tab.click("#language");
    tab.operate();
    tab.until(
        "document.querySelector('[data-mode=\"automatic\"]').ariaPressed === 'true'",
        |tab| tab.click("[data-mode=\"automatic\"]"),
    );
    tab.until(shown, |tab| tab.click("#start_look"));
    // Pressed and let go at once it is no order.
    tab.click("#start_go");
    assert_eq!(user.json(&["status"])["mx"], json!(0));
    tab.mouse("#start_go", "mousePressed");
    tab.wait("document.body.dataset.state === 'run'");
    tab.mouse("#run", "mouseReleased");
    tab.wait("document.querySelector('#numbers .here')?.textContent === '7'");
    // Its moves are none of the path's: there is no way to go.
    tab.wait("document.getElementById('gz').textContent === '–'");
    tab.wait("document.getElementById('answer').textContent.includes('part.nc has ended well')");
    tab.wait("document.getElementById('start_at').hidden");
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&json!(-10), &json!(-7)));
}
