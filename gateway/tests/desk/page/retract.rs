//! The way out of a hole by the page: what the board has written down is shown, then the tap comes out as by `retract`.

use serde_json::json;

use super::{Page, wait};
use crate::{User, good};

/// One turn a second, and a hole that takes a while.
pub const TAP: &str = "G98\nG0 X0 Z5\nM29 S60\nG84 Z-30 R-3 F90\nG80\nM30\n";

#[test]
fn a_tap_is_shown_and_brought_out_of_its_hole() {
    let user = User::with_machine();
    // How the panel reads programs is nothing to the way out.
    let page = Page::with(&user, &["--dry-run"]);
    let mut one = page.client("one");
    let look = json!({"look": true});
    assert_eq!(one.orders("retract", &look).0, 409);
    one.take();
    let (_, none) = one.orders("retract", &look);
    assert_eq!(none["ok"], false);
    assert!(
        none["en"]
            .as_str()
            .unwrap()
            .starts_with("no tap is in a hole"),
        "{none}"
    );
    // The power goes in the middle of the hole.
    let mut run = user.run(TAP);
    wait(&mut page.watch(), "s", |s| s["mz"].as_f64().unwrap() < -5.0);
    good(&user.does(&["sim", "power", "cycle"]));
    let _ = run.wait().unwrap();
    user.wait_for("idle");
    let deep = user.json(&["status"])["mz"].as_f64().unwrap();
    assert!(deep < -4.0, "{deep}");
    let (_, shown) = one.orders("retract", &look);
    assert_eq!(shown["ok"], true, "{shown}");
    let en = shown["en"].as_str().unwrap();
    assert!(
        en.contains("1.5 mm per turn") && !shown["zh"].as_str().unwrap().is_ascii(),
        "{en}"
    );
    // Looking moves nothing; and the page changes no mode.
    let args = json!({"speed": 100, "zh": false});
    let (_, wrong) = one.orders("retract", &args);
    assert!(
        wrong["en"].as_str().unwrap().starts_with("4501 "),
        "{wrong}"
    );
    assert_eq!(user.json(&["status"])["mz"], deep);
    one.does("mode", &json!({"mode": "automatic"}));
    wait(&mut page.watch(), "s", |s| s["mode"] == "automatic");
    let mut told = page.watch();
    one.does("retract", &args);
    let end = wait(&mut told, "line", |_| true);
    assert_eq!(end, json!({"ok": true, "en": "done", "zh": "完成"}));
    // Out to R, and no tap in a hole.
    let out = user.json(&["status"])["mz"].as_f64().unwrap();
    assert!((out - 2.0).abs() < 0.001, "{out}");
    assert_eq!(one.orders("retract", &look).1["ok"], false);
}
