//! A tap is brought out of its hole by a button that is held.

use super::super::{Page, retract::TAP, wait};
use super::Browser;
use crate::{User, good};

#[test]
fn somebody_looks_at_a_tap_and_brings_it_out() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let told = |part: &str| {
        format!("document.getElementById('retract_told').textContent.includes('{part}')")
    };
    let answers =
        |part: &str| format!("document.getElementById('answer').textContent.includes('{part}')");
    tab.operate();
    tab.until(&told("▲ no tap is in a hole"), |tab| {
        tab.click("#retract_look")
    });
    tab.wait("document.getElementById('retract_go').hidden");
    let mut run = user.run(TAP);
    wait(&mut page.watch(), "s", |s| s["mz"].as_f64().unwrap() < -5.0);
    good(&user.does(&["sim", "power", "cycle"]));
    let _ = run.wait().unwrap();
    user.wait_for("idle");
    let hole = user.json(&["status"])["mz"].clone();
    tab.until(&told("1.5 mm per turn"), |tab| tab.click("#retract_look"));
    tab.click("#language");
    tab.wait(&told("丝锥在孔里"));
    tab.click("#language");
    tab.until(
        "document.querySelector('[data-mode=\"automatic\"]').ariaPressed === 'true'",
        |tab| tab.click("[data-mode=\"automatic\"]"),
    );
    // Pressed and let go at once it is no order.
    tab.click("#retract_go");
    assert_eq!(user.json(&["status"])["mz"], hole);
    tab.until("document.getElementById('retract_go').hidden", |tab| {
        tab.mouse("#retract_go", "mouseReleased");
        tab.mouse("#retract_go", "mousePressed");
    });
    tab.mouse("#start", "mouseReleased");
    tab.wait(&answers("done"));
    tab.wait("Math.abs(Number(document.getElementById('mz').textContent) - 2) < 0.001");
}
