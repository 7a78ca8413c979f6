//! A process that is killed in the middle of its work, again and again, on a file.

use std::env;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;

use leadscrew_agent::{Keeper, Moment, Store};
use leadscrew_seed::amount;

use crate::machine::{Board, Broker, Random, read};

/// Where the child keeps what it does; a process without is no child.
const FOLDER: &str = "LEADSCREW_AGENT_TEST";
const THREADS: u32 = 60;

/// The work of one process: its board goes on where the store says, and each record is said on standard output before it is
/// acknowledged.
fn child(folder: PathBuf) {
    let store = Store::open(&folder.join("store"), 1 << 20, Moment(1)).unwrap();
    let store = Arc::new(store);
    let mut keeper = Keeper::new(Arc::clone(&store), "lathe").unwrap();
    let mut out = std::io::stdout();
    let mut sent = 0;
    let mut threads = keeper.model().memory().last_event;
    loop {
        // The board may have cut more than was kept.
        threads = (threads + 1).min(THREADS);
        read(&mut keeper, Board { threads }).unwrap();
        let records = store.hand(sent, 3).unwrap();
        let Some(last) = records.last().map(|record| record.number) else {
            break;
        };
        for record in &records {
            let text = serde_json::to_string(&record.record).unwrap();
            writeln!(out, "record {} {text}", record.number).unwrap();
        }
        sent = last;
        store.acknowledge(last).unwrap();
    }
    writeln!(out, "record end").unwrap();
}

#[test]
fn a_child_is_no_test_of_its_own() {
    if let Some(folder) = env::var_os(FOLDER) {
        child(folder.into());
    }
}

#[test]
fn a_process_that_is_killed_at_any_point_loses_and_doubles_nothing() {
    leadscrew_seed::only_fresh(|seed| {
        let mut random = Random(seed);
        let runs = amount(2, 8);
        // One of them may be through before it is killed often: which process goes on is the computer's.
        let kills: u32 = (0..runs).map(|_| killed(&mut random)).sum();
        assert!(kills > 5 * runs, "{kills}");
    });
}

/// How often it was killed until it was through.
fn killed(random: &mut Random) -> u32 {
    let folder = env::temp_dir().join(format!("leadscrew-agent-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let mut broker = Broker::default();
    let mut kills = 0;
    loop {
        let mut child = Command::new(env::current_exe().unwrap())
            .args([
                "--exact",
                "process::a_child_is_no_test_of_its_own",
                "--nocapture",
            ])
            .env(FOLDER, &folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut left = 1 + random.below(12);
        let mut over = false;
        // Killed behind one of its lines; what it had said is with the broker.
        for line in lines.by_ref() {
            let line = line.unwrap();
            let Some(said) = line.split_once("record ").map(|(_, said)| said) else {
                continue;
            };
            if said == "end" {
                over = true;
                continue;
            }
            let (number, text) = said.split_once(' ').unwrap();
            broker.take(&[leadscrew_agent::Numbered {
                number: number.parse().unwrap(),
                record: serde_json::from_str(text).unwrap(),
            }]);
            left -= 1;
            if left == 0 {
                child.kill().unwrap();
                kills += 1;
                break;
            }
        }
        // The lines that were on their way; the last may be cut.
        for line in lines.map_while(Result::ok) {
            over |= line.ends_with("record end");
            let said = line
                .strip_prefix("record ")
                .and_then(|said| said.split_once(' '));
            if let Some((number, text)) = said
                && let Ok(record) = serde_json::from_str(text)
            {
                let number = number.parse().unwrap();
                broker.take(&[leadscrew_agent::Numbered { number, record }]);
            }
        }
        child.wait().unwrap();
        if over {
            break;
        }
    }
    broker.check(Board { threads: THREADS });
    std::fs::remove_dir_all(&folder).unwrap();
    kills
}
