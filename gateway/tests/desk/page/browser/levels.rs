//! What somebody has switched on stays so where the page starts a program.

use super::super::programs::with_programs;
use super::{Browser, found};
use crate::User;

#[test]
fn single_block_that_was_switched_on_stops_a_program_of_the_page() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("a.nc", "G98 G1 X-2 F3000\nZ-2\nM30\n")]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    tab.choose("a.nc");
    tab.wait(&found("1: "));
    tab.operate();
    tab.mode("automatic");
    let single = "document.getElementById('single').ariaPressed === 'true'";
    tab.click_once("#single", single);
    // Between its two blocks.
    let stopped = format!("document.body.dataset.state === 'hold' && {single}");
    tab.until(&stopped, |tab| {
        tab.mouse("#run", "mouseReleased");
        tab.mouse("#run", "mousePressed");
    });
    tab.mouse("#run", "mouseReleased");
    tab.wait("document.getElementById('flags').textContent === 'single block'");
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&(-2).into(), &0.into()));
    tab.click_once(
        "#single",
        "document.getElementById('single').ariaPressed === 'false'",
    );
    tab.once(
        "document.getElementById('answer').textContent === 'a.nc has ended well'",
        |tab| tab.click("#resume"),
    );
}
