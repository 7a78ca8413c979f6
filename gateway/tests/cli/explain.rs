//! `explain`: the programs of every alarm do what is said of them.

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

#[test]
fn the_wrong_program_raises_the_alarm_and_the_right_one_raises_nothing() {
    let folder = Folder::new("explain");
    let (mut files, mut expected) = (Vec::new(), Vec::new());
    for alarm in explained(&numbers()) {
        for kind in ["wrong", "right"] {
            let Some(program) = alarm[kind].as_str() else {
                continue;
            };
            let number = alarm["no"].as_u64().unwrap();
            let file = folder.file(&format!("{number}-{kind}.nc"));
            std::fs::write(&file, program).unwrap();
            files.push(file);
            expected.push((number, kind == "wrong"));
        }
    }
    assert!(files.len() > 200, "{}", files.len());
    // The increment of the built-in machine.
    let mut args = vec!["check", "--json", "--set", "1004.1=0"];
    args.extend(files.iter().map(String::as_str));
    let output = leadscrew(&args);
    assert_eq!(code(&output), 1, "{}", stderr(&output));
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let checked = result["files"].as_array().unwrap();
    assert_eq!(checked.len(), expected.len());
    for (found, (number, is_wrong)) in checked.iter().zip(expected) {
        let told = ["alarms", "warnings"].map(|key| found[key].as_array().unwrap().clone());
        let told: Vec<u64> = told
            .iter()
            .flatten()
            .map(|diagnostic| diagnostic["no"].as_u64().unwrap())
            .collect();
        match is_wrong {
            true => assert!(told.contains(&number), "{number}: {told:?}"),
            false => assert!(told.is_empty(), "{number}: {told:?}"),
        }
    }
}

#[test]
fn mistakes_of_a_text_have_programs_but_for_those_that_no_text_alone_makes() {
    // Of another control, parameter or file, of a long or damaged text, of a journal, of rigid mode kept over blocks.
    let without = [
        4006, 4011, 4020, 4021, 4030, 4047, 4048, 4051, 4057, 4058, 4064, 4067, 4068, 4078, 4080,
        4081, 4082, 4083, 4087, 4090,
    ];
    for alarm in explained(&numbers()) {
        let number = alarm["no"].as_u64().unwrap();
        if (4001..4100).contains(&number) {
            assert_eq!(
                alarm["wrong"].is_string(),
                !without.contains(&number),
                "{number}"
            );
            assert_eq!(
                alarm["right"].is_string(),
                !without.contains(&number),
                "{number}"
            );
        }
    }
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
