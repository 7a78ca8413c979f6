//! `explain`: what is said to raise an alarm raises it, what is said to be right raises nothing, and every number has
//! something that raises it.

use std::path::Path;

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// What is told of each of these numbers.
fn explained(numbers: &[String]) -> Vec<Value> {
    let mut args = vec!["explain", "--json"];
    args.extend(numbers.iter().map(String::as_str));
    let output = leadscrew(&args);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let all: Value = serde_json::from_str(&stdout(&output)).unwrap();
    all["alarms"].as_array().unwrap().clone()
}

/// Every number that there is.
fn numbers() -> Vec<String> {
    let list = stdout(&leadscrew(&["explain"]));
    let number = |line: &str| line.split([' ', ':']).nth(1).unwrap().to_owned();
    list.lines().map(number).collect()
}

/// A text with its lines and words as often as it says.
fn written_out(text: &str) -> String {
    let mut all = String::new();
    for line in text.lines() {
        let times = line.rsplit_once(" (").and_then(|(_, behind)| {
            let times = behind.strip_suffix(" times)")?;
            times.parse().ok()
        });
        let words = line.split(' ').map(|word| match word.split_once('×') {
            Some((word, times)) => vec![word; times.parse().unwrap()].join(" "),
            None => word.to_owned(),
        });
        let line = words.collect::<Vec<_>>().join(" ") + "\n";
        all += &line.repeat(times.unwrap_or(1));
    }
    all
}

/// Writes the files beside a program; true where there are any.
fn put_files(folder: &Path, alarm: &Value, of: &str) -> bool {
    let mut any = false;
    for key in ["files", of] {
        for (name, text) in alarm[key].as_object().into_iter().flatten() {
            std::fs::write(folder.join(name), written_out(text.as_str().unwrap())).unwrap();
            any = true;
        }
    }
    any
}

/// The numbers that a result of `--json` tells.
fn told(result: &Value) -> Vec<u64> {
    let lists = ["alarms", "warnings"].map(|key| result[key].as_array().cloned());
    let all = lists.into_iter().flatten().flatten();
    all.map(|diagnostic| diagnostic["no"].as_u64().unwrap())
        .collect()
}

#[track_caller]
fn compare(number: u64, is_wrong: bool, told: &[u64]) {
    match is_wrong {
        true => assert!(told.contains(&number), "{number}: {told:?}"),
        false => assert!(told.is_empty(), "{number}: {told:?}"),
    }
}

/// What `check` tells of programs, one list for each.
fn checked(programs: &[String]) -> Vec<Vec<u64>> {
    let mut args = vec!["check", "--json"];
    args.extend(programs.iter().map(String::as_str));
    let output = leadscrew(&args);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let files = result["files"].as_array().unwrap();
    // A machine or its variables may be refused before any program is read.
    if files.is_empty() {
        return vec![told(&result)];
    }
    files.iter().map(told).collect()
}

#[test]
fn the_wrong_program_raises_the_alarm_and_the_right_one_raises_nothing() {
    let folder = Folder::new("explain");
    // The built-in machine.
    std::fs::write(folder.file("leadscrew.toml"), "").unwrap();
    let (mut files, mut expected) = (Vec::new(), Vec::new());
    for alarm in explained(&numbers()) {
        for (kind, of) in [("wrong", "wrong_files"), ("right", "right_files")] {
            let Some(program) = alarm[kind].as_str() else {
                continue;
            };
            let number = alarm["no"].as_u64().unwrap();
            let own = folder.0.join(format!("{number}-{kind}"));
            std::fs::create_dir(&own).unwrap();
            let has_files = put_files(&own, &alarm, of);
            if has_files && !own.join("leadscrew.toml").exists() {
                std::fs::write(own.join("leadscrew.toml"), "").unwrap();
            }
            let file = own.join("part.nc");
            std::fs::write(&file, written_out(program)).unwrap();
            let file = file.to_str().unwrap().to_owned();
            if has_files {
                let all = checked(&[file]);
                compare(number, kind == "wrong", &all[0]);
            } else {
                files.push(file);
                expected.push((number, kind == "wrong"));
            }
        }
    }
    assert!(files.len() > 300, "{}", files.len());
    let all = checked(&files);
    assert_eq!(all.len(), expected.len());
    for (told, (number, is_wrong)) in all.iter().zip(expected) {
        compare(number, is_wrong, told);
    }
}

#[test]
fn the_wrong_machine_file_raises_the_alarm_and_the_right_one_raises_nothing() {
    let folder = Folder::new("explain-machines");
    std::fs::remove_file(folder.file("leadscrew.toml")).unwrap();
    let machine = folder.file("machine.toml");
    let mut count = 0;
    for alarm in explained(&numbers()) {
        for kind in ["wrong", "right"] {
            let Some(text) = alarm[format!("{kind}_machine")].as_str() else {
                continue;
            };
            std::fs::write(&machine, text).unwrap();
            let output = leadscrew(&["params", "validate", "--json", "--params", &machine]);
            let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
            let number = alarm["no"].as_u64().unwrap();
            compare(number, kind == "wrong", &told(&result));
            assert!(kind == "wrong" || code(&output) == 0, "{number}");
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn a_line_and_a_word_are_written_out_as_often_as_they_say() {
    assert_eq!(
        written_out("G1 U1  (3 times)\n(at a×2 b)\nX1 (2)\n"),
        "G1 U1  (3 times)\n".repeat(3) + "(at a a b)\nX1 (2)\n"
    );
}

#[test]
fn a_number_that_is_none_is_told() {
    let output = leadscrew(&["explain", "4036", "4986"]);
    assert_eq!(code(&output), 2);
    assert_eq!(
        stderr(&output),
        "error: there is no alarm and no warning 4986: `leadscrew explain` lists all\n"
    );
    let output = leadscrew(&["explain", "4036"]);
    assert!(stdout(&output).starts_with("alarm 4036: there is no tool offset …\n"));
}
