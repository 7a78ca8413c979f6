//! Tables of the page as somebody types in them.

use serde_json::json;

use super::super::Page;
use super::{Browser, Tab, signal};
use crate::{User, good};

/// Writes what was reviewed; where that was refused, it is reviewed once more.
fn write(tab: &mut Tab<'_>, table: &str) {
    let hidden = format!("document.querySelector('#{table} [data-do=write]').hidden");
    let which = match tab.says(&hidden) == true {
        true => "check",
        false => "write",
    };
    tab.click(&format!("#{table} [data-do={which}]"));
}

#[test]
fn somebody_changes_tools_and_parameters_and_loses_nothing_of_what_was_typed() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let cell = |key: &str| format!("document.querySelector('[data-key=\"{key}\"]')");
    let typed = |tab: &mut Tab<'_>, key: &str, text: &str| {
        tab.says(&format!("{}.focus()", cell(key)));
        tab.says(&format!("{}.select()", cell(key)));
        tab.asks("Input.insertText", json!({"text": text}));
    };
    let listed = |table: &str, part: &str| {
        format!("document.querySelector('#{table} ol').textContent.includes('{part}')")
    };
    let noted = |table: &str, part: &str| {
        format!("document.querySelector('#{table} .note').textContent.includes('{part}')")
    };
    tab.operate();
    tab.click("#tools summary");
    tab.wait(&format!("{}?.value === '0'", cell("T1.wear.X")));
    // Far down, hold and stop are where they were.
    tab.says(&format!(
        "{}.scrollIntoView({{block: 'center'}})",
        cell("T32.X")
    ));
    for id in ["hold", "stop"] {
        tab.wait(&format!(
            "(() => {{ const at = document.getElementById('{id}').getBoundingClientRect(); \
             return document.elementFromPoint(at.x + at.width / 2, at.y + at.height / 2)?.closest('#{id}') !== null \
             && at.bottom <= innerHeight; }})()"
        ));
    }
    typed(&mut tab, "T1.wear.X", "-2");
    typed(&mut tab, "G55.Z", "-40");
    tab.wait(&noted("tools", "2 changed"));
    tab.until(&listed("tools", "hardly wear"), |tab| {
        tab.click("#tools [data-do=check]");
    });
    tab.wait(&listed("tools", "G55.Z: 0 → -40"));
    tab.until(&noted("tools", "✓"), |tab| {
        write(tab, "tools");
    });
    let value = |key: &str| user.json(&["tools", "get", key])["values"][0]["value"].take();
    assert_eq!(value("T1.wear.X"), -2);
    // That it was written stays to be read where the table is read anew.
    good(&user.does(&["tools", "set", "T4.X=3"]));
    tab.wait(&format!("{}.value === '3'", cell("T4.X")));
    assert_eq!(tab.says(&noted("tools", "✓")), true);
    // Somebody else changes the table while something is typed: what is new is shown, and what was typed stays.
    typed(&mut tab, "T3.X", "1.5");
    good(&user.does(&["tools", "set", "T2.X=5"]));
    tab.wait(&format!("{}.value === '5'", cell("T2.X")));
    tab.wait(&format!("{}.value === '1.5'", cell("T3.X")));
    tab.wait(&listed("tools", "other values by now"));
    tab.until(&listed("tools", "T3.X: 0 → 1.5"), |tab| {
        tab.click("#tools [data-do=check]");
    });
    tab.until(&noted("tools", "✓"), |tab| {
        write(tab, "tools");
    });
    assert_eq!((value("T3.X"), value("T2.X")), (json!(1.5), json!(5)));
    // Parameters: found by a word, a complaint beside its row, and then written.
    tab.click("#params summary");
    tab.wait(&format!("{}?.value === '12000'", cell("1420.X")));
    tab.says("document.getElementById('search').focus()");
    tab.asks("Input.insertText", json!({"text": "rapid_rate"}));
    tab.wait("document.querySelectorAll('#param_rows tr:not([hidden])').length < 10");
    typed(&mut tab, "1420.X", "-1");
    let told = format!(
        "{}.closest('tr').querySelector('.told').textContent > ''",
        cell("1420.X")
    );
    tab.until(&told, |tab| tab.click("#params [data-do=check]"));
    typed(&mut tab, "1420.X", "11000");
    tab.until(&listed("params", "12000 mm/min → 11000 mm/min"), |tab| {
        tab.click("#params [data-do=check]");
    });
    tab.until(&noted("params", "✓"), |tab| {
        write(tab, "params");
    });
    tab.wait("document.querySelector('#param_rows tr:not([hidden]) th').textContent.includes('≠')");
    let set = user.json(&["params", "get", "1420.X"]);
    assert_eq!(set["params"][0]["value"], 11_000);
}

#[test]
fn by_old_values_nothing_is_written_and_then_it_can_be_written_again() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    let answers =
        |part: &str| format!("document.getElementById('answer').textContent.includes('{part}')");
    let reviewed = "!document.querySelector('#tools [data-do=write]').hidden";
    tab.operate();
    tab.click("#tools summary");
    tab.wait("document.querySelector('[data-key=\"T4.X\"]')?.value === '0'");
    tab.says("document.querySelector('[data-key=\"T4.X\"]').select()");
    tab.asks("Input.insertText", json!({"text": "3"}));
    tab.until(reviewed, |tab| tab.click("#tools [data-do=check]"));
    // The panel stands still: what the page shows grows old, and is not written by. The machine is slow meanwhile, or what
    // it tells would be too much for who does not read it, and the panel would be dropped.
    good(&user.does(&["sim", "speed", "0.2"]));
    signal(&page, "-STOP");
    tab.wait("document.body.classList.contains('old')");
    tab.click("#tools [data-do=write]");
    tab.wait(&answers("The values are old"));
    signal(&page, "-CONT");
    good(&user.does(&["sim", "speed", "1"]));
    // Nothing was under way that is carried out now, and what was reviewed is still there to be ordered.
    tab.wait("!document.body.classList.contains('old')");
    tab.wait(reviewed);
    let value = || user.json(&["tools", "get", "T4.X"])["values"][0]["value"].take();
    assert_eq!(value(), 0);
    let written = "document.querySelector('#tools .note').textContent.includes('✓')";
    tab.until(written, |tab| {
        tab.still_operates();
        write(tab, "tools");
    });
    assert_eq!(value(), 3);
}
