//! A tool touched off by keys alone: what is wrong is said beside it, and what is written was shown.

use serde_json::json;

use super::super::Page;
use super::{Browser, signal};
use crate::{User, good};

#[test]
fn somebody_touches_off_with_keys_alone_and_nothing_moves() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    // Who looks only has no lease, which the page itself tells.
    browser.expected.push("status of 403 (Forbidden)");
    let mut tab = browser.tab(&page.link());
    let told = |part: &str| {
        format!("document.getElementById('touch_told').textContent.includes('{part}')")
    };
    let has = |id: &str| format!("document.activeElement.id === '{id}'");
    let written = "!document.getElementById('touch_told').textContent.indexOf('✓')";
    let value = |key: &str| user.json(&["tools", "get", key])["values"][0]["value"].take();
    good(&user.does(&["mdi", "G98 G1 X-4 Z-5.5 F3000"]));
    good(&user.does(&["mode", "manual"]));
    tab.operate();
    tab.wait("document.getElementById('mz').textContent === '-5.5000'");
    let before = user.json(&["status"]);
    tab.says("document.getElementById('touch_axis').focus()");
    tab.key("z", 90, "z");
    tab.wait("document.getElementById('touch_axis').value === 'Z'");
    tab.next();
    tab.wait(&has("touch_sets"));
    tab.next();
    tab.wait(&has("touch_tool"));
    tab.types("3");
    tab.next();
    tab.wait(&has("touch_system"));
    tab.next();
    tab.wait(&has("touch_value"));
    // What is wrong is said with what helps, and nothing can be written.
    tab.types("1,5");
    tab.until(&told("write a point, not a comma"), |tab| tab.enter());
    assert_eq!(
        tab.says("document.getElementById('touch_write').hidden"),
        true
    );
    tab.types("1.5");
    tab.until(&told("T3.Z: 0 → -7"), |tab| tab.enter());
    assert_eq!(value("T3.Z"), 0);
    // In the language of the page.
    tab.click("#language");
    tab.wait(&told("工件 Z 1.5000"));
    tab.click("#language");
    tab.wait(&told("Z 1.5000 of the work"));
    // Something else typed: what was shown is not what would be written.
    tab.says("document.getElementById('touch_value').focus()");
    tab.types("1");
    tab.wait("document.getElementById('touch_write').hidden");
    tab.until(&told("T3.Z: 0 → -6.5"), |tab| tab.enter());
    // Mark, review, write. The panel stands still first: by old values nothing is written. The machine is slow meanwhile,
    // or what it tells would be too much for who does not read it, and the panel would be dropped.
    for _ in 0..3 {
        tab.next();
    }
    tab.wait(&has("touch_write"));
    good(&user.does(&["sim", "speed", "0.2"]));
    signal(&page, "-STOP");
    tab.wait("document.body.classList.contains('old')");
    tab.enter();
    tab.wait("document.getElementById('answer').textContent.includes('The values are old')");
    signal(&page, "-CONT");
    good(&user.does(&["sim", "speed", "1"]));
    tab.wait("!document.body.classList.contains('old')");
    assert_eq!(value("T3.Z"), 0);
    // What was shown is still there to be written.
    tab.until(written, |tab| {
        tab.still_operates();
        tab.says("document.getElementById('touch_write').focus()");
        tab.enter();
    });
    assert_eq!(value("T3.Z"), -6.5);
    // The keys are in a field now, where an arrow moves nothing.
    tab.wait(&has("touch_value"));
    tab.key("ArrowUp", 38, "");
    let after = user.json(&["status"]);
    assert_eq!((&before["mx"], &before["mz"]), (&after["mx"], &after["mz"]));
    // Who looks only types nothing. The browser has a login that operates, and the link that looks takes it from nobody.
    tab.close();
    browser.asks(None, "Storage.clearCookies", json!({}));
    let mut tab = browser.tab(&format!("http://{}/#{}", page.address, page.look));
    tab.wait("document.getElementById('touch_value').disabled && document.getElementById('touch_axis').disabled && document.getElementById('touch_mark').disabled");
    assert_eq!(json!(-6.5), value("T3.Z"));
}
