//! Refuses a page that has no words for something it says: each key that is used has a row in `page/words.js`, each row is
//! used, and has two texts.

use std::collections::BTreeSet;
use std::fs;

fn main() {
    println!("cargo::rerun-if-changed=page");
    let read = |name: &str| fs::read_to_string(format!("page/{name}")).expect("a file of the page");
    let table = read("words.js");
    let mut known = BTreeSet::new();
    let rows = table
        .lines()
        .skip_while(|line| !line.starts_with("const WORDS"));
    for row in rows.skip(1).take_while(|line| !line.starts_with("};")) {
        let (key, texts) = row.trim().split_once(": ").expect("a row `key: [..]`");
        let texts = texts.trim_end_matches(',');
        let texts = texts
            .strip_prefix("[\"")
            .and_then(|row| row.strip_suffix("\"]"));
        let both = texts.and_then(|texts| texts.split_once("\", \""));
        let whole = both.is_some_and(|(en, zh)| !en.is_empty() && !zh.is_empty());
        assert!(
            whole,
            "words.js: `{key}` needs an English and a Chinese text"
        );
        assert!(
            known.insert(key.to_owned()),
            "words.js: `{key}` is there twice"
        );
    }
    let mut used = BTreeSet::new();
    for entry in fs::read_dir("page").expect("the page") {
        let name = entry.expect("a file of the page").file_name();
        let name = name.to_str().expect("a name in letters");
        if name == "words.js" {
            continue;
        }
        let text = read(name);
        for begin in [
            "data-word=\"",
            "data-name=\"",
            "word(\"",
            "words(\"",
            "both(\"",
        ] {
            for rest in text.split(begin).skip(1) {
                let key = rest.split('"').next().expect("a first part");
                assert!(known.contains(key), "{name}: words.js has no `{key}`");
                used.insert(key.to_owned());
            }
        }
    }
    // Modes and states are named by the machine, and who operates by the page.
    let unused: Vec<_> = known
        .difference(&used)
        .filter(|key| {
            !["mode_", "state_", "who_"]
                .iter()
                .any(|named| key.starts_with(named))
        })
        .collect();
    assert!(unused.is_empty(), "words.js: nothing says {unused:?}");
}
