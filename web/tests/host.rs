//! The machine of the page, on this host, makes the setpoints of the emulated board, and refuses in words.

use std::path::Path;

use leadscrew_web::{Session, answer};
use serde_json::{Value, json};

mod jobs;

use jobs::{job, on_host};

/// The emulated board has read the same programs; its rows are under version control.
#[test]
fn the_page_has_the_setpoints_of_the_emulated_board() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let golden = root.join("firmware/mps2-an386/hashes.txt");
    let golden = std::fs::read_to_string(golden).expect("the board's rows are there");
    let most = leadscrew_seed::amount(50_000, u64::MAX);
    let mut compared = 0;
    for row in golden.lines().filter(|row| row.contains(".nc ")) {
        let words: Vec<&str> = row.split_whitespace().collect();
        let (name, hash, ticks) = (words[0], words[1], words[2]);
        let count: u64 = ticks.parse().expect("a number");
        if count == 0 || count > most {
            continue;
        }
        let text = std::fs::read_to_string(root.join("examples").join(name)).expect("an example");
        let own = on_host("", &text);
        if words[3] != "0" {
            // The board runs up to the alarm; the page refuses the program before anything moves.
            let found = own["found"].as_array().expect("a list");
            let has = found
                .iter()
                .any(|one| one["number"].as_u64() == words[3].parse().ok());
            assert!(has, "{name}: {found:?}");
            continue;
        }
        assert_eq!(
            (&own["hash"], &own["ticks"]),
            (&json!(hash), &json!(count)),
            "{name}"
        );
        compared += 1;
    }
    assert!(compared >= 5, "{compared} examples");
}

/// A message that makes no sense is refused in words, never by a trap.
#[test]
fn every_refusal_has_a_key_of_the_words() {
    const WORDS: &str = include_str!("../page/words.js");
    let mut session = Session::default();
    let mut ask = |text: &str| -> Value {
        let said: Value =
            serde_json::from_slice(&answer(&mut session, text.as_bytes())).expect("JSON");
        if let Some(key) = said["refused"].as_str() {
            // A key that is a word of the page already has this before it.
            let has = |key: &str| WORDS.contains(&format!("\n  {key}: ["));
            assert!(has(key) || has(&format!("refused_{key}")), "{key}");
        }
        said
    };
    assert_eq!(ask("{")["refused"], "message");
    assert_eq!(ask(r#"{"do":"step","ticks":1}"#)["refused"], "nothing");
    assert_eq!(
        ask(&job("check", "none", "").to_string())["refused"],
        "folder"
    );
    let mut wrong = job("load", "", "M30\n");
    wrong["counts"] = json!(1);
    assert_eq!(ask(&wrong.to_string())["refused"], "counts");
    wrong["counts"] = json!(null);
    wrong["ripple"] = json!([99_000, 1]);
    assert_eq!(ask(&wrong.to_string())["refused"], "ripple");
    let found = ask(&job("check", "", "G0 X10\nG1 Q\n").to_string());
    assert_eq!(found["found"][0]["line"], 2, "{found}");
    assert_eq!(found["good"], false);
}
