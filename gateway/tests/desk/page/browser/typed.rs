//! What is typed or pasted: no line end is lost, and no line becomes part of another one.

use std::time::Instant;

use serde_json::json;

use super::super::programs::with_programs;
use super::{Browser, found};
use crate::{LIMIT, User};

/// A carriage return where others end with line feeds: `check` refuses it, and the text keeps it until somebody takes it
/// out.
#[test]
fn a_carriage_return_that_ends_no_line_is_seen_and_kept() {
    let user = User::with_machine();
    let wrong = "G98\rG1 X-1\nZ-1 F100\nM30\n".replacen("G98\r", "(A)\nG98\r", 1);
    let page = with_programs(&user, &[("a.nc", &wrong), ("sign.nc", "(␍)\nM30\n")]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 3");
    tab.operate();
    let written = || std::fs::read_to_string(user.0.join("parts/a.nc")).unwrap();
    let saved = "document.getElementById('answer').textContent === 'saved'";
    tab.choose("a.nc");
    tab.wait(&found("▲ 2: 4001"));
    assert_eq!(
        tab.says("document.getElementById('source').value"),
        json!(wrong.replace('\r', "␍"))
    );
    // Changed elsewhere and saved it is what it was.
    tab.says("document.getElementById('source').focus() ?? document.getElementById('source').setSelectionRange(0, 0)");
    tab.asks("Input.insertText", json!({"text": "(B)\n"}));
    tab.click_once("#save", saved);
    tab.wait(&found("▲ 3: 4001"));
    assert_eq!(written(), format!("(B)\n{wrong}"));
    // Somebody makes it what it was meant to be. A return that is pasted is a line end at once.
    tab.says(
        "(() => { const source = document.getElementById('source'); const at = source.value.indexOf('␍'); source.focus(); \
         source.setSelectionRange(at, at + 1); return true; })()",
    );
    tab.asks("Input.insertText", json!({"text": "\r"}));
    tab.click_once("#save", saved);
    tab.wait(&found("4: 4"));
    assert_eq!(written(), format!("(B)\n{}", wrong.replace('\r', "\n")));
    // A text that has the sign itself would not come back as it was.
    tab.choose("sign.nc");
    tab.wait("document.getElementById('name').value === 'sign.nc'");
    tab.wait(
        "document.getElementById('save').disabled && document.getElementById('source').readOnly",
    );
}

/// A field of one line would make one block of two lines, which goes another way.
#[test]
fn two_lines_that_are_pasted_are_not_carried_out_as_one() {
    let user = User::with_machine();
    let page = with_programs(&user, &[]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let typed = "document.getElementById('typed').value";
    for two in ["G0 X-1\nZ-5", "G0 X-1\rZ-5", "G0 X-1\r\nZ-5\r\n"] {
        tab.says("document.getElementById('answer').textContent = ''");
        tab.says("document.getElementById('typed').focus()");
        tab.asks("Input.insertText", json!({"text": two}));
        tab.wait("document.getElementById('answer').textContent.includes('several lines')");
        assert_eq!(tab.says(typed), "");
    }
    // A line with its end is one.
    tab.asks("Input.insertText", json!({"text": "G0 X-1\r\n"}));
    assert_eq!(tab.says(&format!("{typed}.trim()")), "G0 X-1");
}

/// How a line has ended comes by another connection than the answer that it was begun, and may be there first.
#[test]
fn the_end_of_a_line_is_not_taken_back_by_an_answer_that_comes_late() {
    let user = User::with_machine();
    let page = with_programs(&user, &[]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let answer = "document.getElementById('answer').textContent";
    tab.operate();
    tab.mode("mdi");
    tab.says(&format!(
        "(() => {{ const ask = window.fetch; window.fetch = async (...what) => {{ const answer = await ask(...what); \
         if (what[0] === 'order' && what[1].body.includes('mdi')) {{ \
         while ({answer} === '') await new Promise((on) => setTimeout(on, 10)); \
         const json = answer.json.bind(answer); answer.json = async () => {{ const told = await json(); \
         setTimeout(() => {{ window.came = true; }}); return told; }}; }} return answer; }}; return true; }})()"
    ));
    // On a busy computer what is shown may be too old to order by, or the page's lease has lapsed: nothing is sent then.
    let late = [" old", "does not operate", "give it again"];
    let is_late = format!("/{}/.test({answer})", late.join("|"));
    let end = Instant::now() + LIMIT;
    let told = loop {
        tab.still_operates();
        tab.says(&format!("(window.came = false, {answer} = '')"));
        tab.says("(document.getElementById('typed').value = '', document.getElementById('typed').focus())");
        tab.types("G1 Q");
        tab.enter();
        tab.wait(&format!("window.came === true || {is_late}"));
        let told = tab.says(answer);
        let is_late = late
            .iter()
            .any(|part| told.as_str().unwrap().contains(part));
        if !is_late || Instant::now() > end {
            break told;
        }
    };
    assert!(told.as_str().unwrap().starts_with("4"), "{told}");
}
