//! A program is started at a line: what would happen is shown, and then a button is held.

use serde_json::json;

use super::super::programs::{PART, with_programs};
use super::{Browser, Tab, found};
use crate::{User, good};

#[test]
fn somebody_starts_a_program_at_the_line_of_the_cursor() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("part.nc", PART)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
    // Nothing is open, and nothing is shown.
    tab.until(
        "document.getElementById('answer').textContent.includes('Open a program first')",
        |tab| tab.click("#start_look"),
    );
    tab.choose("part.nc");
    tab.wait(&found("moves"));
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
    // What it does is looked at while it does it, by a computer that is busy.
    good(&user.does(&["sim", "speed", "0.2"]));
    let runs = "document.body.dataset.state === 'run'";
    tab.until(runs, |tab| {
        tab.mouse("#start_go", "mouseReleased");
        tab.still_operates();
        // An order that is refused, for what it was given by is old, takes with it what was shown.
        tab.until(&format!("{shown} || {runs}"), |tab| {
            tab.click("#start_look");
        });
        tab.mouse("#start_go", "mousePressed");
    });
    tab.mouse("#run", "mouseReleased");
    tab.wait("document.querySelector('#numbers .here')?.textContent === '7'");
    // Its moves are none of the path's: there is no way to go.
    tab.wait("document.getElementById('gz').textContent === '–'");
    good(&user.does(&["sim", "speed", "1"]));
    tab.wait("document.getElementById('answer').textContent.includes('part.nc has ended well')");
    tab.wait("document.getElementById('start_at').hidden");
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&json!(-10), &json!(-7)));
}

#[test]
fn a_start_that_was_shown_goes_where_the_board_has_other_offsets() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("part.nc", PART)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    open(&mut tab, "part.nc", "moves");
    line_of_cursor(&mut tab, "G1 X-40");
    let shown = "!document.getElementById('start_at').hidden";
    tab.until(shown, |tab| tab.click("#start_look"));
    tab.says("document.getElementById('start_go').focus()");
    good(&user.does(&["offsets", "set", "G54.Z=-1"]));
    tab.wait("document.getElementById('start_at').hidden");
    tab.wait("document.getElementById('answer').textContent.includes('look at it again')");
    assert_eq!(tab.says("document.activeElement.id"), "start_look");
    tab.until(shown, |tab| tab.click("#start_look"));
    tab.wait("document.getElementById('start_told').textContent.includes('machine X -30  Z -6')");
}

/// Lines are counted as the machine does, whatever ends them, and a text keeps its ends.
#[test]
fn the_line_of_the_cursor_is_that_of_the_program_whatever_ends_its_lines() {
    let user = User::with_machine();
    let ends = ["\n", "\r\n", "\r", "\n\r"];
    // A carriage return alone ends no line where others end with line feeds.
    let wrong = PART.replace("G97 ", "G97\r");
    let texts: Vec<String> = ends
        .iter()
        .map(|end| PART.replace('\n', end))
        .chain([wrong])
        .collect();
    let names: Vec<String> = (0..texts.len()).map(|n| format!("{n}.nc")).collect();
    let programs: Vec<(&str, &str)> = names
        .iter()
        .zip(&texts)
        .map(|(name, text)| (&**name, &**text))
        .collect();
    let page = with_programs(&user, &programs);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.operate();
    for n in 0..=ends.len() {
        let is_wrong = n == ends.len();
        let found = if is_wrong { "▲ 2: 4001" } else { "moves" };
        open(&mut tab, &names[n], found);
        let rows = "document.querySelector('#numbers').lastChild.textContent";
        tab.says("document.getElementById('source').scrollTop = 10000");
        let all = PART.lines().count() + 1;
        tab.wait(&format!("{rows} === '{all}'"));
        line_of_cursor(&mut tab, "Z-20");
        if is_wrong {
            continue;
        }
        let shown = "!document.getElementById('start_at').hidden";
        tab.until(shown, |tab| tab.click("#start_look"));
        tab.wait("document.getElementById('start_line').textContent === '7'");
        tab.wait(
            "document.getElementById('start_told').textContent.includes('begins at  X -40  Z -5')",
        );
        let end = ends[n];
        tab.says("document.getElementById('source').setSelectionRange(0, 0) ?? document.getElementById('source').focus()");
        tab.asks("Input.insertText", json!({"text": "(B)\n"}));
        tab.click_once(
            "#save",
            "document.getElementById('answer').textContent === 'saved'",
        );
        let written = std::fs::read_to_string(user.0.join("parts").join(&names[n])).unwrap();
        assert_eq!(written, format!("(B)\n{PART}").replace('\n', end));
    }
}

/// Puts the cursor to the front of the line that begins so.
fn line_of_cursor(tab: &mut Tab<'_>, begins: &str) {
    tab.says(&format!(
        "(() => {{ const source = document.getElementById('source'); const at = source.value.indexOf('\\n{begins}') + 1; \
         source.setSelectionRange(at, at); return true; }})()"
    ));
}

/// Opens a program, and waits until it was looked at.
fn open(tab: &mut Tab<'_>, name: &str, part: &str) {
    tab.wait(&format!(
        "[...document.querySelectorAll('#programs option')].some((one) => one.value === '{name}')"
    ));
    tab.says("document.getElementById('found').textContent = ''");
    tab.choose(name);
    tab.wait(&found(part));
    tab.wait(&format!(
        "document.getElementById('name').value === '{name}'"
    ));
}
