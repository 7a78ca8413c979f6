//! Tables of machine functions in files: what they become, what is wrong with them, and their change in place.

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Answer, FunctionAction, FunctionRow};

use super::*;
use crate::params::{Loaded, edit, load_text};

const MACHINE: &str = "\
door_input = \"door\"
reset_outputs = 8
[io.door]
at = \"input:3\"
invert = true
[io.coolant]
at = \"pin:PB11\"
[io.flow]
at = \"input:2\"
[m.8]
set = \"coolant\"
answer = \"flow=1\"
within = \"2 s\"
[m.9]
clear = \"coolant\"
when = \"after\"
[m.60]
set = \"output:2\"
pulse = \"200 ms\"
[m.62]
answer = \"flow=0\"
within = \"0.5 s\"
";

fn value(loaded: &Loaded, key: &str) -> i64 {
    loaded.params.get(Entry::find_text(key).unwrap())
}

fn told(loaded: &Loaded) -> Vec<String> {
    let text = |d: &crate::diagnostics::Diagnostic| {
        format!(
            "{}:{}-{} {} {} / {}",
            d.line, d.column, d.end_column, d.number, d.message, d.help
        )
    };
    loaded.diagnostics.iter().map(text).collect()
}

fn loaded(text: &str) -> Loaded {
    let loaded = load_text("f", text, Lang::En);
    assert_eq!(told(&loaded), [""; 0], "{text}");
    loaded
}

#[test]
fn tables_become_rows_and_names_become_numbers() {
    let loaded = loaded(MACHINE);
    for (key, expected) in [
        ("9401", 81_011_020_200),
        ("9402", 97_010_000_000),
        ("9403", 603_020_000_020),
        ("9404", 620_002_020_050),
        ("9405", 0),
        ("9421", 4),
        ("9422", 8),
        ("9423", 3),
    ] {
        assert_eq!(value(&loaded, key), expected, "{key}");
    }
    let source = |key| loaded.source(Entry::find_text(key).unwrap());
    assert_eq!(source("9401").as_deref(), Some("f:10"));
    assert_eq!(source("9421").as_deref(), Some("f:5"));
    let named: Vec<_> = loaded
        .names
        .iter()
        .map(|named| format!("{} {}", named.name, named.io))
        .collect();
    assert_eq!(named, ["door input:3", "coolant output:1", "flow input:2"]);
}

#[test]
fn a_later_file_takes_the_row_that_its_code_has() {
    let mut loader = crate::params::Loader::new(None, Lang::En);
    loader.file("1", MACHINE.as_bytes());
    // The names of the file before are known; the row of M62 is left free for another code.
    let later = "m_row_4 = 0\n[m.9]\nclear = \"coolant\"\n[m.70]\nset = \"output:3\"\nrow = 4\n";
    loader.file("2", later.as_bytes());
    let two = loader.finish();
    assert_eq!(
        told(&two),
        ["4:4-6 4411 9404 (m_row_4) is already set in line 1 / keep one of the two"]
    );
    let mut loader = crate::params::Loader::new(None, Lang::En);
    loader.file("1", MACHINE.as_bytes());
    loader.file("2", later.replace("m_row_4 = 0\n", "").as_bytes());
    let two = loader.finish();
    assert_eq!(told(&two), [""; 0]);
    assert_eq!(value(&two, "9402"), 92_010_000_000);
    assert_eq!(value(&two, "9404"), 701_030_000_000);
}

#[test]
fn every_mistake_has_its_place_its_cause_and_its_remedy() {
    const IO: &str = "[io.a]\nat = \"output:1\"\n[io.b]\nat = \"input:1\"\n[m.8]\n";
    for (lines, expected) in [
        (
            "set = \"c\"",
            "6:7-10 4440 there is no output `c` / name one: `[io.c]` with `at = \"output:1\"`, or write its place, as `output:1`",
        ),
        (
            "set = \"b\"",
            "6:7-10 4441 `b` is no output / write the name of an output, or its place, as `output:1`",
        ),
        (
            "answer = \"a=1\"\nwithin = \"1 s\"",
            "6:10-15 4441 `a` is no input / write the name of an input, or its place, as `input:1`",
        ),
        (
            "answer = \"b\"\nwithin = \"1 s\"",
            "6:10-13 4443 [m.8]: `answer` cannot be `\"b\"` / write `\"input:1=1\"` / `\"input:1=0\"`",
        ),
        (
            "answer = \"b=1\"",
            "5:4-5 4444 [m.8] needs `within` / write `within = \"2 s\"`",
        ),
        (
            "set = \"a\"\nwithin = \"1 s\"",
            "5:4-5 4444 [m.8] needs `answer` / write `answer = \"input:1=1\"`",
        ),
        (
            "pulse = \"1 s\"",
            "5:4-5 4444 [m.8] needs `set` / write `set = \"output:1\"`",
        ),
        (
            "set = \"a\"\npulse = \"5 ms\"",
            "7:9-15 4443 [m.8]: `pulse` cannot be `\"5 ms\"` / write `\"2 s\"` / `\"200 ms\"` (10 ms … 99.99 s)",
        ),
        (
            "set = \"a\"\npulse = 200",
            "7:9-12 4443 [m.8]: `pulse` cannot be `200` / write `\"2 s\"` / `\"200 ms\"` (10 ms … 99.99 s)",
        ),
        (
            "set = \"a\"\npulse = \"1 s\"\nanswer = \"b=1\"\nwithin = \"1 s\"",
            "9:10-15 4445 [m.8]: `pulse` and `within` do not go together / leave out one of them",
        ),
        (
            "set = \"a\"\nclear = \"a\"",
            "7:9-12 4445 [m.8]: `set` and `clear` do not go together / leave out one of them",
        ),
        (
            "set = \"a\"\nwhen = \"later\"",
            "7:8-15 4443 [m.8]: `when` cannot be `\"later\"` / write `\"before\"` / `\"after\"`",
        ),
        (
            "set = \"a\"\nrow = 17",
            "7:7-9 4443 [m.8]: `row` cannot be `17` / write `1` … `16`",
        ),
        (
            "sett = \"a\"",
            "6:1-5 4442 [m.8] has no `sett` / write `set` / `clear` / `pulse` / `answer` / `within` / `when` / `row`",
        ),
        (
            "",
            "5:4-5 4444 [m.8] needs `set` / write `set = \"output:1\"` / `clear = \"output:1\"` / `answer = \"input:1=1\"`",
        ),
        (
            "set = \"a\"\n[m.x]\nset = \"a\"",
            "7:4-5 4442 [m] has no `m.x` / write `[m.8]`",
        ),
        (
            "set = \"a\"\n[m.08]\nset = \"a\"",
            "7:4-6 4411 M8 is already set in line 5 / keep one of the two",
        ),
        (
            "set = \"a\"\n[io.e]\nat = \"pin:PA0\"",
            "8:6-15 4443 [io.e]: `at` cannot be `\"pin:PA0\"` / write `\"input:1\"` … `\"input:16\"` / `\"output:1\"` … `\"output:16\"` / `\"pin:PC4\"` / `\"401:5:in0\"`",
        ),
        (
            "set = \"a\"\n[io.e]\ninvert = true",
            "7:5-6 4444 [io.e] needs `at` / write `at = \"input:1\"` / `at = \"output:1\"`",
        ),
        (
            "set = \"a\"\n[io.e]\nat = \"output:2\"\ninvert = true",
            "9:10-14 4445 [io.e]: `invert` and `at = \"output:2\"` do not go together / leave out one of them",
        ),
        (
            "set = \"a\"\n[io]\ne = 1",
            "8:1-2 4442 [io] has no `io.e` / write `[io.e]`",
        ),
    ] {
        let wrong = load_text("f", &format!("{IO}{lines}\n"), Lang::En);
        let told = told(&wrong);
        assert_eq!(told.first().map(String::as_str), Some(expected), "{lines}");
    }
    // A name where a number can stand; a code with a meaning of its own; a seventeenth one.
    let one = |text: &str| told(&load_text("f", text, Lang::En)).join("\n");
    assert_eq!(
        one("door_input = \"dor\"\n"),
        "1:14-19 4440 there is no input `dor` / name one: `[io.dor]` with `at = \"input:1\"`, or write its place, as \
         `input:1`"
    );
    assert!(one("[m.3]\nset = \"output:1\"\n").starts_with("1:4-5 4431 "));
    let many: String = (40..57)
        .map(|code| format!("[m.{code}]\nset = \"output:1\"\n"))
        .collect();
    assert!(one(&many).starts_with("33:4-6 4446 there is no row left for M56 / "));
}

/// A row of each kind.
fn kinds() -> Vec<FunctionRow> {
    let contact = |number| Contact::new(number).unwrap();
    let mut all = Vec::new();
    for action in [
        None,
        Some(FunctionAction::On),
        Some(FunctionAction::Off),
        Some(FunctionAction::Pulse),
    ] {
        for answer in [None, Some(true), Some(false)] {
            for behind in [false, true] {
                let waits = answer.is_some() || action == Some(FunctionAction::Pulse);
                if action.is_none() && answer.is_none() {
                    continue;
                }
                // Off until an answer comes has no words of its own besides `clear` with `answer`.
                all.push(FunctionRow {
                    code: 160 + u16::try_from(all.len()).unwrap(),
                    switches: action.map(|action| (contact(16), action)),
                    answer: answer.map(|on| Answer {
                        input: contact(3),
                        on,
                    }),
                    time_ms: if waits { 1250 } else { 0 },
                    behind,
                });
            }
        }
    }
    all
}

#[test]
fn every_row_comes_back_from_its_words() {
    for row in kinds() {
        let text = words(row.value()).unwrap();
        let loaded = loaded(&format!("{text}\n"));
        assert_eq!(value(&loaded, "9401"), row.value(), "{text}");
    }
    assert_eq!(words(0), None);
}

#[test]
fn tables_of_a_file_change_where_they_stand() {
    let set = |text: &str, values: &[(&str, i64)]| {
        let entries: Vec<_> = values
            .iter()
            .map(|(key, raw)| (Entry::find_text(key).unwrap(), *raw))
            .collect();
        let new = edit::with_values(text, &entries);
        let loaded = loaded(&new);
        for (entry, raw) in &entries {
            assert_eq!(loaded.params.get(entry), *raw, "{entry}\n{new}");
        }
        let others = load_text("f", text, Lang::En).params;
        for (row, raw) in rows(&others) {
            if !entries.iter().any(|(of, _)| row_of(of) == Some(row)) {
                assert_eq!(loaded.params.get(entry(row).unwrap()), raw, "{row}\n{new}");
            }
        }
        // A row that is 0 and stands nowhere would be named the second time.
        if entries.iter().all(|(_, raw)| *raw != 0) {
            assert_eq!(edit::with_values(&new, &entries), new);
        }
        new
    };
    assert_eq!(
        set(
            "[m.8] # coolant\n# by hand, too\nset = \"output:1\"\n\n# off\n[m.9]\nclear = \"output:1\"\n",
            &[("9401", 71_020_000_000)],
        ),
        "[m.7] # coolant\nset = \"output:2\"\nrow = 1\n# by hand, too\n\n# off\n[m.9]\nrow = 2\nclear = \"output:1\"\n"
    );
    assert_eq!(
        set(
            "m.8 = { set = \"output:1\" } # a\r\nm.9 = { clear = \"output:1\" }\r\n",
            &[("9401", 0), ("9403", 71_020_000_000)],
        ),
        "m.9 = { row = 2, clear = \"output:1\" }\r\nm_row_3 = 71020000000\r\n"
    );
    assert_eq!(
        set(
            "m.8.set = \"output:1\"\nm.8.when = \"after\"\nm.9.clear = \"output:1\"\n",
            &[("9401", 71_020_000_000)],
        ),
        "m.7 = { set = \"output:2\", row = 1 }\nm.9.row = 2\nm.9.clear = \"output:1\"\n"
    );
    assert_eq!(
        set(
            "m = { 8 = { set = \"output:1\" }, 9 = { clear = \"output:1\" } }\n",
            &[("9402", 0)]
        ),
        "m = { 8 = { row = 1, set = \"output:1\" } }\n"
    );
    set(
        "m = { 8 = { set = \"output:1\" }, 9 = { clear = \"output:1\" } }\n",
        &[("9401", 0)],
    );
    set("m = { 8 = { set = \"output:1\" } }\n", &[("9401", 0)]);
    set(
        "[m]\n8 = { set = \"output:1\" }\n9.clear = \"output:1\"\n",
        &[("9401", 0), ("9402", 71_020_000_000)],
    );
    set("[m.8]\nset = \"output:1\"", &[("9401", 71_020_000_000)]);
    // Each row of a whole file gets each kind of content, and goes.
    for row in kinds() {
        for number in 1..=4 {
            let key = format!("{}", 9400 + number);
            set(MACHINE, &[(&key, row.value())]);
        }
    }
    set(
        MACHINE,
        &[("9401", 92_010_000_000), ("9402", 81_010_000_000)],
    );
    set(
        MACHINE,
        &[("9401", 0), ("9402", 0), ("9403", 0), ("9404", 0)],
    );
}
