//! The page in the long run and with a long program: `cargo xtask page --long` does both at full length and tells the
//! figures; how long a frame takes hangs on the computer, so it is told and not judged.

use std::time::{Duration, Instant};

use serde_json::json;

use super::super::Page;
use super::{Browser, Tab};
use crate::{LIMIT, LONG, User};

/// Asks for full length: the seconds of watching.
const SECONDS: &str = "LEADSCREW_PAGE_SECONDS";

pub fn seconds() -> Option<u64> {
    let given = std::env::var(SECONDS).ok()?;
    Some(given.parse().expect("a number of seconds"))
}

/// Bytes of the page's own objects, and parts of its document, once what nobody needs has gone.
fn memory(tab: &mut Tab<'_>) -> [f64; 2] {
    tab.asks("HeapProfiler.collectGarbage", json!({}));
    let used = tab.asks("Runtime.getHeapUsage", json!({}))["usedSize"].as_f64();
    let nodes = tab.asks("Memory.getDOMCounters", json!({}))["nodes"].as_f64();
    [used, nodes].map(Option::unwrap)
}

fn pass(time: Duration) {
    std::thread::sleep(time);
}

#[test]
fn a_page_that_is_watched_for_long_does_not_grow() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let mut run = user.run(LONG);
    tab.wait("document.body.dataset.state === 'run'");
    tab.says(
        "window.told = 0; new EventSource('state').addEventListener('s', () => { window.told += 1; }); true",
    );
    tab.wait("window.told > 10");
    let whole = Duration::from_secs(seconds().unwrap_or(4));
    pass(whole / 4);
    let [used, nodes] = memory(&mut tab);
    let (begun, from) = (Instant::now(), tab.says("window.told").as_f64().unwrap());
    pass(whole);
    let over = begun.elapsed().as_secs_f64();
    let told = tab.says("window.told").as_f64().unwrap() - from;
    let [used_then, nodes_then] = memory(&mut tab);
    println!(
        "{over:.0} s, {:.1} states a second; objects {used} to {used_then} bytes, {nodes} to {nodes_then} nodes",
        told / over
    );
    assert!(told > 0.0);
    assert!(used_then - used < 500_000.0, "{used} {used_then}");
    assert!(nodes_then - nodes < 200.0, "{nodes} {nodes_then}");
    tab.stops();
    let _ = run.wait().unwrap();
}

#[test]
fn the_tool_is_followed_along_a_long_path() {
    let user = User::with_machine();
    let folder = user.0.join("parts");
    std::fs::create_dir_all(&folder).unwrap();
    let pieces = if seconds().is_some() { 100_000 } else { 2_000 };
    let mut text = String::from("G98 G1 X40 Z-1 F3000\nF6\n");
    for n in 0..pieces {
        let (x, z) = (20 + (n * 7) % 40, 1_000 + n % 50_000);
        text.push_str(&format!("X{x} Z-{}.{:03}\n", z / 1_000, z % 1_000));
    }
    text.push_str("M30\n");
    std::fs::write(folder.join("a.nc"), text).unwrap();
    let page = Page::with(&user, &["--programs", folder.to_str().unwrap()]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    let drawn = format!(
        "document.getElementById('path_note').textContent.startsWith('{} ')",
        pieces + 1
    );
    // On a busy computer a text of megabytes may come too late, and is opened again; but it is given its time.
    let end = Instant::now() + LIMIT;
    while tab.says(&drawn) != true {
        tab.choose("a.nc");
        let again = Instant::now() + Duration::from_secs(40);
        while tab.says(&drawn) != true && Instant::now() < again {
            pass(Duration::from_millis(100));
        }
        assert!(Instant::now() < end);
    }
    tab.operate();
    tab.until(
        "document.querySelector('[data-mode=\"automatic\"]').ariaPressed === 'true'",
        |tab| tab.click("[data-mode=\"automatic\"]"),
    );
    tab.until("document.body.dataset.state === 'run'", |tab| {
        tab.mouse("#run", "mousePressed");
        pass(Duration::from_secs(1));
        tab.mouse("#run", "mouseReleased");
        tab.wait("!document.getElementById('answer').textContent.includes('being checked')");
    });
    // One of them draws all of it anew: after a change of the view.
    tab.says(
        "window.frames_ = []; const ask = window.requestAnimationFrame; \
         window.requestAnimationFrame = (draw) => ask((time) => { const from = performance.now(); draw(time); \
         window.frames_.push(performance.now() - from); }); document.getElementById('nearer').click(); true",
    );
    tab.wait("window.frames_.length >= 100");
    let told = tab.says(
        "(() => { const rest = window.frames_.toSorted((a, b) => a - b); \
         const at = (share) => rest[Math.floor(share * (rest.length - 1))].toFixed(2); \
         return `median ${at(0.5)}, 95 % ${at(0.95)}, most ${at(1)} ms`; })()",
    );
    println!("{pieces} pieces: frames: {told}");
    tab.wait("/^→ /.test(document.getElementById('gz').textContent)");
    tab.stops();
}
