//! The scripts of `leadscrew explain`: what is typed raises the alarm, and what is typed after it sets it right.
//!
//! Each has a user and a shell of its own, and several run beside each other: most of their time is that of machines.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::typed_page::Shell;
use crate::{LIMIT, User, good};

/// Scripts at a time.
const BESIDE: usize = 4;

/// All that have a script.
fn scripts() -> Vec<Value> {
    let user = User::new();
    let list = good(&user.does(&["explain"]));
    let number = |line: &str| line.split([' ', ':']).nth(1).unwrap().to_owned();
    let numbers: Vec<String> = list.lines().map(number).collect();
    let mut args = vec!["explain", "--json"];
    args.extend(numbers.iter().map(String::as_str));
    let all: Value = serde_json::from_str(&good(&user.does(&args))).unwrap();
    let alarms = all["alarms"].as_array().unwrap().clone();
    alarms
        .into_iter()
        .filter(|alarm| alarm["raise"].is_string())
        .collect()
}

/// True where an output tells this number.
fn tells(told: &str, number: u64) -> bool {
    [" ", ":", "]", ","]
        .iter()
        .any(|behind| told.contains(&format!("{number:04}{behind}")))
}

/// What goes wrong with a script; `None` for nothing.
fn typed(alarm: &Value) -> Option<String> {
    let user = User::new();
    for (name, text) in alarm["files"].as_object().into_iter().flatten() {
        std::fs::write(user.0.join(name), text.as_str().unwrap()).unwrap();
    }
    let mut shell = Shell::start(user.with_path());
    let number = alarm["no"].as_u64().unwrap();
    let mut all = String::new();
    let mut script = |key: &str, done: &dyn Fn(&str) -> bool| {
        let mut last = String::new();
        let mut told = String::new();
        for line in alarm[key].as_str().unwrap().lines() {
            // A loop that waits for a machine that did not start would never end.
            if line.starts_with("until") && !all.contains("is running") {
                return Some(format!("{number}: no machine for `{line}`:\n{all}"));
            }
            told = shell.types(line);
            all += &format!("$ {line}\n{told}\n");
            line.clone_into(&mut last);
        }
        // Somebody who looks too early looks again.
        let end = Instant::now() + LIMIT;
        // And a press that has lapsed for want of frames (9040) is pressed again: this computer has other work.
        let looks = last.starts_with("leadscrew status");
        while (looks || told.contains("(9040)")) && !done(&told) && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(50));
            told = shell.types(&last);
        }
        match done(&told) {
            true => None,
            false => Some(format!("{number}: `{last}` of `{key}` prints\n{told}")),
        }
    };
    let wrong = script("raise", &|told| tells(told, number)).or_else(|| {
        script("mend", &|told| {
            let refuses = |line: &str| line.starts_with("alarm[") || line.starts_with("error");
            !told.lines().any(refuses) && !tells(told, number)
        })
    });
    let is_good = shell.types("echo $last").trim() == "0";
    shell.end();
    wrong.or_else(|| (!is_good).then(|| format!("{number}: the last command fails:\n{all}")))
}

#[test]
fn every_script_raises_its_alarm_and_sets_it_right() {
    let scripts = scripts();
    assert!(scripts.len() > 50, "{}", scripts.len());
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut wrong = Vec::new();
        while let Some(alarm) = scripts.get(next.fetch_add(1, Ordering::Relaxed)) {
            wrong.extend(typed(alarm));
        }
        wrong
    };
    let wrong: Vec<String> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..BESIDE).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap())
            .collect()
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
