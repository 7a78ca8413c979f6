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
    let page = with_programs(&user, &[("a.nc", &wrong)]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 2");
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
}

/// Such a text, or a part of it, would come back as another one.
#[test]
fn what_is_not_changed_here_is_not_written_by_whoever_operates() {
    let user = User::with_machine();
    let long = "(A)\n".repeat(5000) + "M30\n";
    let texts = [("sign.nc", "(␍)\nM30\n"), ("long.nc", &long)];
    let page = with_programs(&user, &texts);
    let folder = user.0.join("parts");
    // GBK.
    let other = b"O1 (\xc2\xdd\xce\xc6)\nM30\n";
    std::fs::write(folder.join("gbk.nc"), other).unwrap();
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 4");
    tab.operate();
    for (name, why) in [
        ("sign.nc", "not UTF-8"),
        ("gbk.nc", "not UTF-8"),
        ("long.nc", "more than 5000"),
    ] {
        let before = std::fs::read(folder.join(name)).unwrap();
        tab.choose(name);
        tab.wait(&format!(
            "document.getElementById('name').value === '{name}'"
        ));
        tab.wait(&format!(
            "document.getElementById('text_note').textContent.includes('{why}')"
        ));
        let closed = "document.getElementById('save').disabled && document.getElementById('source').readOnly";
        tab.wait(closed);
        // The lease is told again with every change of it and of the language.
        for _ in 0..2 {
            tab.click("#language");
            assert_eq!(tab.says(closed), true, "{name}");
        }
        // Whatever the button says.
        tab.says("(document.getElementById('save').disabled = false, document.getElementById('save').click())");
        tab.wait(&format!(
            "document.getElementById('answer').textContent.includes('{why}')"
        ));
        assert_eq!(std::fs::read(folder.join(name)).unwrap(), before);
    }
}

/// The answer that a text is saved is held back.
#[test]
fn a_save_that_is_told_late_changes_no_other_text() {
    let user = User::with_machine();
    let page = with_programs(&user, &[("a.nc", "(A)\nM30\n"), ("b.nc", "(B)\nM30\n")]);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 3");
    tab.operate();
    tab.says(
        "(() => { const ask = window.fetch; window.fetch = async (path, more) => { const answer = await ask(path, more); \
         if (more?.method === 'PUT') { window.written = true; await new Promise((on) => { window.tell = on; }); } \
         return answer; }; return true; })()",
    );
    let said = |id: &str| format!("document.getElementById('{id}').textContent");
    let is = |name: &str| format!("document.getElementById('name').value === '{name}'");
    let saved = format!("{} === 'saved'", said("answer"));
    let begin = |tab: &mut super::Tab<'_>| {
        tab.says(&format!(
            "(window.written = false, {} = '')",
            said("answer")
        ));
        tab.click("#save");
        tab.wait("window.written");
    };
    tab.choose("a.nc");
    tab.wait(&format!("{} && {}", is("a.nc"), found("moves")));
    // What is typed after it is not saved yet, and is not run.
    begin(&mut tab);
    tab.says("document.getElementById('source').focus() ?? document.getElementById('source').setSelectionRange(0, 0)");
    tab.asks("Input.insertText", json!({"text": "(X)\n"}));
    tab.says("tell()");
    tab.wait(&saved);
    tab.wait(&format!("{}.includes('not saved')", said("text_note")));
    assert_eq!(
        std::fs::read_to_string(user.0.join("parts/a.nc")).unwrap(),
        "(A)\nM30\n"
    );
    // It is, once it is saved.
    begin(&mut tab);
    // Until then nothing is run.
    tab.mouse("#run", "mousePressed");
    tab.wait(&format!("{}.includes('Save the changes')", said("answer")));
    tab.mouse("#run", "mouseReleased");
    tab.says("tell()");
    tab.wait(&format!("{} === 'a.nc' && {saved}", said("text_note")));
    // Another one is opened meanwhile.
    begin(&mut tab);
    tab.choose("b.nc");
    tab.wait(&is("b.nc"));
    tab.says("tell()");
    tab.wait(&saved);
    tab.wait(&format!(
        "{} && document.getElementById('programs').value === 'b.nc'",
        is("b.nc")
    ));
    assert_eq!(tab.says(&said("text_note")), "b.nc");
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
