//! A picture of a program as a page: one file, opened from the disk without a machine.

use std::fs;

use serde_json::{Value, json};

use super::{Browser, Tab};
use crate::{User, good};

/// A rapid into the stock on line 5, and two in it on lines 10 and 11.
const CRASH: &str = "(STOCK X60 L100)\nT0101\nM3 S600\nG0 X64 Z10\nG0 X50 Z-20\nG1 X40 F100\nG0 X80\nG0 X64 Z-60\nG1 X46 F100\n\
                     G0 Z-80\nG0 X80\nG0 Z20\nM30\n";

const GROOVES: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../examples/o0008-g75-grooves.nc"
);

/// The page of a program in a tab.
fn plotted<'a>(user: &User, browser: &'a mut Browser, program: &str, lang: &str) -> Tab<'a> {
    let args = ["plot", program, "-o", "picture.html", "--lang", lang];
    good(&user.does(&args));
    let page = user.0.join("picture.html");
    let mut tab = browser.opens(&format!("file://{}", page.display()));
    tab.wait("location.protocol === 'file:' && document.readyState === 'complete'");
    tab
}

/// The share of the pixels of the canvas, within a box in Z and X (radius), that are of a colour of the page.
fn share(tab: &mut Tab<'_>, name: &str, [z0, z1, x0, x1]: [f64; 4]) -> f64 {
    let of = tab.says(&format!(
        "(() => {{ const [r, g, b] = colour('{name}').match(/[\\da-f]{{2}}/g).map((part) => parseInt(part, 16)); \
         const ratio = devicePixelRatio; const [left, upper] = toPixel({z0}, {x1}); const [right, lower] = toPixel({z1}, {x0}); \
         const box = [left, upper, right - left, lower - upper].map((px) => Math.round(px * ratio)); \
         const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {{ willReadFrequently: true }}); \
         copy.drawImage(canvas, 0, 0); const {{ data }} = copy.getImageData(...box); let found = 0; \
         for (let n = 0; n < data.length; n += 4) {{ \
         const off = Math.max(Math.abs(data[n] - r), Math.abs(data[n + 1] - g), Math.abs(data[n + 2] - b)); \
         if (data[n + 3] > 20 && off < 8) found += 1; }} return found / (data.length / 4); }})()"
    ));
    of.as_f64().unwrap()
}

/// The pointer goes to a place of the work.
fn points(tab: &mut Tab<'_>, [z, x]: [f64; 2], kind: &str, delta: f64) {
    let place = tab.says(&format!(
        "(() => {{ scrollTo(0, 0); const at = canvas.getBoundingClientRect(); const [px, py] = toPixel({z}, {x}); \
         return [at.x + canvas.clientLeft + px, at.y + canvas.clientTop + py]; }})()"
    ));
    let params = json!({"type": kind, "x": place[0], "y": place[1], "deltaX": 0, "deltaY": delta});
    tab.asks("Input.dispatchMouseEvent", params);
}

fn told(part: &str) -> String {
    format!("document.getElementById('told').textContent.includes('{part}')")
}

/// The wheel brings near what is under the pointer, and leaves it there.
fn zooms(tab: &mut Tab<'_>, place: [f64; 2]) {
    let [z, x] = place;
    let where_it_is = format!("toPixel({z}, {x})");
    let shown = |tab: &mut Tab<'_>| tab.says("canvas.toDataURL()");
    let (before, scale, at) = (shown(tab), tab.says("view.scale"), tab.says(&where_it_is));
    points(tab, place, "mouseWheel", -300.0);
    tab.wait(&format!("view.scale > 2 * {scale}"));
    assert_ne!(shown(tab), before);
    let after = tab.says(&where_it_is);
    let number = |of: &Value, n: usize| of[n].as_f64().unwrap();
    // Events are at whole pixels.
    for n in 0..2 {
        assert!(
            (number(&at, n) - number(&after, n)).abs() < 2.0,
            "{at} {after}"
        );
    }
    tab.click("#part");
    assert_eq!(shown(tab), before);
}

/// The tool goes its way to the end, and is drawn where it is.
fn plays(tab: &mut Tab<'_>) {
    let at = "JSON.stringify([run.z[now], run.x[now]])";
    tab.says("document.getElementById('speed').value = '64'");
    tab.click("#whole");
    let from = tab.says(at);
    tab.click("#play");
    tab.wait(&format!("{at} !== '{}'", from.as_str().unwrap()));
    tab.wait("now === run.z.length - 1 && document.getElementById('play').textContent === '▶'");
    let seconds =
        "document.getElementById('clock').textContent === `${(now * run.every).toFixed(2)} s`";
    assert_eq!(tab.says(seconds), true);
    let end: [f64; 2] = serde_json::from_str(tab.says(at).as_str().unwrap()).unwrap();
    let [z, x] = end;
    assert!(share(tab, "chosen", [z - 0.1, z + 0.1, x - 0.1, x + 0.1]) > 0.9);
}

#[test]
fn a_page_of_a_program_shows_the_stock_and_what_goes_through_it() {
    let user = User::new();
    let program = user.program(CRASH);
    let mut browser = Browser::start(&user);
    let mut tab = plotted(&user, &mut browser, &program, "en");
    let words =
        tab.says("[...document.querySelectorAll('#warnings li')].map((item) => item.textContent)");
    let line = |line: u32| format!("⚠ line {line}: rapid through the material");
    assert_eq!(words, json!([line(5), line(10), line(11)]));
    let marked = tab.says("[...list.querySelectorAll('.warned')].map((item) => item.textContent)");
    assert_eq!(marked, json!(["G0 X50 Z-20", "G0 Z-80", "G0 X80"]));
    // All of the stock is in the picture, and nothing is drawn so beside it.
    assert!(share(&mut tab, "rapid", [-99.0, -1.0, 1.0, 29.0]) > 0.8);
    assert!(share(&mut tab, "rapid", [-99.0, -20.0, 31.0, 32.0]) < 0.1);
    // On the way from X64 Z10 into the material, and nowhere on the way of the cut.
    assert!(share(&mut tab, "warn", [-5.2, -4.8, 28.4, 28.6]) > 0.9);
    assert_eq!(share(&mut tab, "warn", [-45.0, -30.0, 1.0, 29.0]), 0.0);
    assert!(share(&mut tab, "warn", [-78.0, -70.0, 22.9, 23.1]) > 0.9);
    points(&mut tab, [-5.0, 28.5], "mouseMoved", 0.0);
    tab.wait(&told(
        "⚠ 5: rapid through the material · rapid, line 5: G0 X50 Z-20 · X ",
    ));
    assert_eq!(
        tab.says("list.querySelector('.chosen').textContent"),
        "G0 X50 Z-20"
    );
    points(&mut tab, [-20.0, 22.0], "mouseMoved", 0.0);
    tab.wait(&told("feed, line 6: G1 X40 F100 · X "));
    assert_eq!(tab.says(&told("⚠")), false);
    tab.click("#warnings li");
    assert_eq!(
        tab.says("list.querySelector('.chosen').textContent"),
        "G0 X50 Z-20"
    );
    // What is chosen is still seen to be wrong.
    assert!(share(&mut tab, "warn", [-5.2, -4.8, 28.4, 28.6]) > 0.9);
    zooms(&mut tab, [-20.0, 25.0]);
    plays(&mut tab);
    tab.close();
    let mut tab = plotted(&user, &mut browser, &program, "zh");
    let words = tab.says("document.querySelector('#warnings li').textContent");
    assert_eq!(words, "⚠ 第 5 行：快速移动穿过毛坯");
    points(&mut tab, [-5.0, 28.5], "mouseMoved", 0.0);
    tab.wait(&told(
        "⚠ 5: 快速移动穿过毛坯 · 快速移动，第 5 行：G0 X50 Z-20 · X ",
    ));
}

#[test]
fn a_page_of_grooves_is_small_and_is_zoomed_and_played() {
    let user = User::new();
    let mut browser = Browser::start(&user);
    let mut tab = plotted(&user, &mut browser, GROOVES, "en");
    let size = fs::metadata(user.0.join("picture.html")).unwrap().len();
    assert!(size <= 1_000_000, "{size}");
    // Nothing is wrong with it.
    assert_eq!(tab.says("document.getElementById('warnings')"), Value::Null);
    // In the middle of the longest cut.
    let place = tab.says(
        "(() => { const long = ({ p }) => Math.hypot(p[2] - p[0], p[3] - p[1]); \
         const cuts = data.strokes.filter((stroke) => stroke.k === 'feed').sort((a, b) => long(b) - long(a)); \
         const [{ p, l }] = cuts; return [(p[0] + p[2]) / 2, (p[1] + p[3]) / 2, l]; })()",
    );
    let [z, x, line] = [0, 1, 2].map(|n| place[n].as_f64().unwrap());
    points(&mut tab, [z, x], "mouseMoved", 0.0);
    let text = fs::read_to_string(GROOVES).unwrap();
    let block = text.lines().nth(line as usize - 1).unwrap().trim();
    tab.wait(&told(&format!("feed, line {line}: {block} · X ")));
    zooms(&mut tab, [z, x]);
    plays(&mut tab);
}
