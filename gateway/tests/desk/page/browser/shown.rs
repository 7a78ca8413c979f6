//! What the page shows beside the state: threads, inputs and outputs; and whether everybody can use it.

use std::path::Path;

use serde_json::{Value, json};

use super::super::{Page, THREAD};
use super::{Browser, Tab};
use crate::{User, good};

/// Puts the picture of a page where somebody can look at it.
fn picture(tab: &mut Tab<'_>, name: &str) {
    let size = tab.says("[innerWidth, document.documentElement.scrollHeight]");
    let params = json!({"captureBeyondViewport": true,
        "clip": {"x": 0, "y": 0, "width": size[0], "height": size[1], "scale": 1}});
    let shot = tab.asks("Page.captureScreenshot", params);
    let base64 = shot["data"].as_str().unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let decoded = std::process::Command::new("base64")
        .arg("-d")
        .stdin(std::process::Stdio::piped())
        .stdout(std::fs::File::create(path).unwrap())
        .spawn();
    let mut decoded = decoded.unwrap();
    std::io::Write::write_all(&mut decoded.stdin.take().unwrap(), base64.as_bytes()).unwrap();
    assert!(decoded.wait().unwrap().success());
}

/// A screen of this size, light or dark.
fn screen(tab: &mut Tab<'_>, width: u32, height: u32, scheme: &str) {
    let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
    tab.asks("Emulation.setDeviceMetricsOverride", size);
    let media = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
    tab.asks("Emulation.setEmulatedMedia", media);
}

#[test]
fn threads_and_contacts_are_shown_and_nobody_is_kept_from_using_the_page() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("!document.getElementById('no_cuts').hidden");
    // A thread takes a while on a busy computer too.
    good(&user.does(&["sim", "speed", "0.25"]));
    let run = user.run(THREAD);
    good(&user.does(&["sim", "input", "3", "on"]));
    let listed =
        |part: &str| format!("document.getElementById('cut_list').textContent.includes('{part}')");
    // While it is cut, passes have their places.
    tab.wait(&listed("under way"));
    tab.wait("document.querySelectorAll('#cuts_sheet g').length > 0");
    let output = run.wait_with_output().unwrap();
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let strokes = &result["threads"][0]["passes"];
    tab.wait(&format!(
        "document.querySelectorAll('#cuts_sheet g').length === {strokes} && !({})",
        listed("under way")
    ));
    tab.wait(&listed("worst "));
    // Each is told in words too, in the language of the page.
    tab.wait("document.querySelector('#cuts_sheet title').textContent.includes('±')");
    tab.click("#language");
    tab.wait(&listed("次走刀"));
    tab.wait("document.querySelector('#cuts_sheet title').textContent.includes('走刀 1')");
    tab.click("#language");
    tab.wait(&listed("passes"));
    // Closed parts are looked at, too.
    for part in ["io", "tools", "params"] {
        // What has just been opened may move the next one away from under the mouse.
        tab.until(
            &format!("document.querySelector('#{part} details').open"),
            |tab| {
                tab.click(&format!("#{part} summary"));
            },
        );
    }
    tab.wait("/3 · ● on/.test(document.getElementById('inputs').textContent)");
    // No machine function uses an output here, and that is said.
    tab.wait("document.querySelectorAll('#outputs li').length === 1 && document.getElementById('outputs').textContent > ''");
    tab.wait("document.querySelectorAll('#tools input').length > 0");
    tab.wait("document.querySelectorAll('#param_rows input').length > 0");
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../target/axe/node_modules/axe-core/axe.min.js");
    let script =
        std::fs::read_to_string(script).expect("axe-core: `cargo xtask setup` installs it");
    tab.says(&script);
    for (width, height, scheme) in [
        (1280, 800, "light"),
        (390, 844, "light"),
        (1280, 800, "dark"),
        (390, 844, "dark"),
    ] {
        screen(&mut tab, width, height, scheme);
        let found = tab.awaits(
            "axe.run().then(({passes, violations}) => ({looked: passes.length, found: violations \
             .filter(({impact}) => impact === 'serious' || impact === 'critical') \
             .map(({id, nodes}) => ({id, nodes: nodes.slice(0, 5).map(({html, failureSummary}) => html + failureSummary)}))}))",
        );
        assert!(found["looked"].as_u64().unwrap() > 20, "{found}");
        assert_eq!(found["found"], json!([]), "{width} {scheme}");
        // A page is no wider than its screen.
        assert_eq!(
            tab.says("document.documentElement.scrollWidth <= innerWidth"),
            true,
            "{width}"
        );
        picture(&mut tab, &format!("page-{width}-{scheme}.png"));
    }
}
