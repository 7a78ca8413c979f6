//! `docs/first-hour.md` by the page: from switching on to a finished shaft. What only a hand at the machine does is done by
//! `leadscrew sim`; all else is typed, clicked and held on the page.
//!
//! Each step waits for what the page shows, never for a time.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;

use super::super::Page;
use super::{Browser, Tab};
use crate::{LIMIT, User, good};

fn text(id: &str) -> String {
    format!("document.getElementById('{id}').textContent")
}

fn is(id: &str, told: &str) -> String {
    format!("{} === '{told}'", text(id))
}

fn has(id: &str, part: &str) -> String {
    format!("{}.includes('{part}')", text(id))
}

fn state(state: &str) -> String {
    format!("document.body.dataset.state === '{state}'")
}

fn number(id: &str) -> String {
    format!("Number({})", text(id))
}

impl Tab<'_> {
    /// Carries out a typed line; how it ends is this.
    #[track_caller]
    fn line(&mut self, line: &str, end: &str) {
        self.once(&has("answer", end), |tab| {
            tab.says("document.getElementById('typed').focus()");
            tab.types(line);
            tab.enter();
        });
    }

    /// Moves an axis by hand until this is so, and waits until it has braked. On a busy computer a press may end for want
    /// of frames; then it is pressed anew.
    #[track_caller]
    fn by_hand(&mut self, way: &str, so: &str) {
        let which = format!("[data-jog=\"{way}\"]");
        let end = Instant::now() + LIMIT;
        while self.says(so) != true {
            self.mouse(&which, "mousePressed");
            let again = Instant::now() + Duration::from_secs(5);
            while self.says(so) != true && Instant::now() < again {}
            self.mouse(&which, "mouseReleased");
            assert!(Instant::now() < end, "{way} {so}");
        }
        self.wait(&format!("!({})", state("run")));
    }

    /// Touches off an axis by a tool: looks what follows, which is this, and writes it.
    #[track_caller]
    fn touch(&mut self, axis: &str, value: &str, tool: &str, follows: &str) {
        self.says(&format!(
            "(() => {{ const one = document.getElementById('touch_axis'); one.value = '{axis}'; \
             one.dispatchEvent(new Event('change', {{bubbles: true}})); return true; }})()"
        ));
        for (id, text) in [("touch_tool", tool), ("touch_value", value)] {
            self.says(&format!("document.getElementById('{id}').focus()"));
            self.types(text);
        }
        let looked = format!(
            "{} && !document.getElementById('touch_write').hidden",
            has("touch_told", follows)
        );
        self.once(&looked, Self::enter);
        self.click_once("#touch_write", &has("touch_told", "✓"));
    }
}

/// Holds the button until the program runs.
#[track_caller]
fn start(tab: &mut Tab<'_>) {
    tab.until(&state("run"), |tab| tab.mouse("#run", "mousePressed"));
    tab.mouse("#run", "mouseReleased");
}

#[test]
fn the_first_hour_is_done_by_the_page() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shaft = std::fs::read_to_string(root.join("examples/desk/shaft.nc")).unwrap();
    let machine = root.join("params/machines/desk.toml");
    let user = User::new();
    let hand = |args: &[&str]| drop(good(&user.does(&[&["sim"], args].concat())));
    let machine = machine.to_str().unwrap();
    good(&user.does(&["up", "--machine", machine, "--at", "X=-80,Z=-150", "--new"]));
    let folder = user.0.join("parts");
    std::fs::create_dir_all(&folder).unwrap();
    let page = Page::with(&user, &["--programs", folder.to_str().unwrap()]);
    // This computer has other work: a panel that is silent for a second is no reason to hold.
    good(&user.does(&["params", "set", "9024=0"]));
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());

    // Switching on: the machine does not know where it is, and says so.
    tab.wait(&format!(
        "{} && {} && {}",
        state("idle"),
        is("refx", "not ref."),
        is("refz", "not ref.")
    ));
    tab.operate();
    tab.mode("mdi");
    tab.line("G0 X-100", "4503");
    tab.mode("manual");
    tab.by_hand("X-", &format!("{} < -82", number("mx")));
    tab.mode("reference");
    let found = format!("{} && {}", is("refx", "ref."), is("refz", "ref."));
    tab.click_once("#home", &format!("{found} && {}", state("idle")));
    tab.wait(&format!("{} && {}", is("mx", "0.0000"), is("mz", "0.0000")));

    // The work zero, then both tools.
    tab.click("#tools summary");
    tab.wait("document.querySelector('[data-key=\"G54.Z\"]')?.value === '0'");
    tab.says("document.querySelector('[data-key=\"G54.Z\"]').focus()");
    tab.types("-400");
    let listed = "document.querySelector('#tools ol').textContent.includes('G54.Z: 0 → -400')";
    tab.once(listed, |tab| tab.click("#tools [data-do=check]"));
    let noted = "document.querySelector('#tools .note').textContent.includes('✓')";
    tab.once(noted, |tab| tab.click("#tools [data-do=write]"));
    tab.mode("mdi");
    tab.line("M3 S600", "done");
    tab.line("G53 G0 X-212.34 Z-300", "done");
    tab.line("G98 G1 W-30 F300", "done");
    tab.wait(&is("mz", "-330.0000"));
    // X must not move until its place is kept.
    tab.says("document.getElementById('touch_axis').value = 'X'");
    tab.click_once("#touch_mark", &has("touch_told", "X marked at -212.3400"));
    tab.mode("manual");
    tab.by_hand("Z+", &format!("{} > -320", number("mz")));
    tab.mode("mdi");
    tab.line("M5", "done");
    tab.touch("X", "38.42", "1", "T1.X: 0 → -250.76");
    tab.line("G53 G0 X-206 Z-305.125", "done");
    tab.line("M3 G1 U-46", "done");
    tab.touch("Z", "0", "1", "T1.Z: 0 → 94.875");
    tab.line("G0 W20 M5", "done");
    tab.line("G53 G0 X-204.5 Z-300", "done");
    tab.touch("X", "38.42", "2", "T2.X: 0 → -242.92");
    tab.touch("Z", "0", "2", "T2.Z: 0 → 100");
    tab.line("G53 G0 X0 Z0", "done");

    // The program is typed, stored and found good.
    tab.says("document.getElementById('source').focus()");
    tab.asks("Input.insertText", json!({"text": shaft}));
    tab.says("document.getElementById('name').focus()");
    tab.types("shaft.nc");
    tab.click_once("#save", &is("answer", "saved"));
    assert_eq!(
        std::fs::read_to_string(folder.join("shaft.nc")).unwrap(),
        shaft
    );
    tab.wait(&has("found", "✓ nothing wrong"));

    // Started, held while it roughs, looked at, and on.
    tab.mode("automatic");
    start(&mut tab);
    tab.wait(&format!("{}.startsWith('N 11 ')", text("line")));
    tab.click_once("#hold", &state("hold"));
    tab.click_once("#resume", &state("run"));
    // Held again and left: the first RESUME brings the axes back, the second goes on.
    tab.click_once("#hold", &state("hold"));
    tab.mode("manual");
    // In manual mode it has braked; what is asked for now is where it stands.
    let stands = user.json(&["status", "--node", "1"]);
    let place = |axis: &str| format!("{:.4}", stands[axis].as_f64().unwrap());
    let held = json!([place("mx"), place("mz")]);
    let out = format!("{} + 3", held[0].as_str().unwrap());
    tab.by_hand("X+", &format!("{} > {out}", number("mx")));
    tab.wait("!document.getElementById('left').hidden");
    tab.mode("automatic");
    tab.click_once("#resume", &has("left", "the axes are there"));
    tab.wait(&state("hold"));
    assert_eq!(tab.says(&format!("[{}, {}]", text("mx"), text("mz"))), held);
    tab.click_once(
        "#resume",
        &format!("{} && document.getElementById('left').hidden", state("run")),
    );

    // A door that is opened holds it; closing it starts nothing.
    hand(&["door", "open"]);
    tab.wait(&state("hold"));
    tab.click_once("#resume", &has("answer", "4506"));
    hand(&["door", "close"]);
    tab.wait("/1 · ● on/.test(document.getElementById('inputs').textContent)");
    assert_eq!(tab.says(&state("hold")), true);
    tab.click_once("#resume", &state("run"));

    // The emergency stop, from which a reset alone does not lead.
    hand(&["estop", "press"]);
    tab.wait(&format!("{} && {}", state("alarm"), has("alarm", "4300")));
    tab.wait(&has("answer", "shaft.nc: 4300"));
    tab.click("#reset");
    hand(&["estop", "release"]);
    assert_eq!(tab.says(&state("alarm")), true);
    tab.click_once("#reset", &state("idle"));
    tab.mode("manual");
    let out = format!("{} > {} + 3", number("mx"), tab.says(&number("mx")));
    tab.by_hand("X+", &out);
    tab.mode("mdi");
    tab.line("G53 G0 X0 Z0", "done");

    // The power goes: the tables stay, the references do not.
    hand(&["power", "cycle"]);
    tab.wait(&format!("{} && {}", is("refx", "not ref."), state("idle")));
    tab.mode("reference");
    tab.click_once("#home", &format!("{found} && {}", state("idle")));
    tab.mode("automatic");
    start(&mut tab);
    tab.wait(&is("answer", "shaft.nc has ended well"));
    tab.wait(&format!(
        "{} && {} && {}",
        state("idle"),
        is("mx", "-162.9200"),
        is("mz", "-270.0000")
    ));
    tab.wait(&has("cut_list", "passes"));
    for (key, value) in [("T1.X", json!(-250.76)), ("T2.Z", json!(100))] {
        let told = user.json(&["tools", "get", key]);
        assert_eq!(told["values"][0]["value"], value, "{told}");
    }
}
