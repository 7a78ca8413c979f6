//! The tests of the workspace: their programs, run beside each other.
//!
//! Cargo runs one program of tests after the other, and a core is idle while the last test of one takes long. Here as
//! many programs run at once as there are cores, those that take longest first, and what a program printed is shown when
//! it has ended. Before them, alone, runs the program whose tests start machines and wait for them in real time.

use std::collections::VecDeque;
use std::io::{PipeReader, Read, pipe};
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use super::counts::Counts;
use crate::{page, run};

/// The number of tests of a program that run at once.
const THREADS: &str = "RUST_TEST_THREADS";
/// Tests with processes and time-outs mostly wait, so that a core has time for several of them.
const THREADS_PER_PROGRAM: usize = 4;
/// The same of the tests of machines, which have the computer for themselves; those that take longest have threads of their
/// own and begin at once.
const THREADS_OF_MACHINES: usize = 6;

/// The tests that start machines and wait for them most of their time. Beside programs that compute, a machine that runs
/// in real time answers too late.
const OF_MACHINES: &str = "leadscrew desk";
/// Those of them that take longest: pages whose commands run one after the other.
const LONG_OF_MACHINES: [&str; 2] = [
    "tutorial::the_page_of_the_first_hour_prints_what_it_shows",
    "explain::every_script_raises_its_alarm_and_sets_it_right",
];
/// Those that have a step of their own: they need a bus, an image, a browser.
const ELSEWHERE: [&str; 3] = [
    "leadscrew-tests vcan",
    "leadscrew-tests emulated",
    "leadscrew-web browser",
];
/// The programs that take longest in full volume, each with a tail in which one test runs alone.
const LONG: [&str; 12] = [
    "leadscrew-tests trouble",
    "leadscrew cli",
    "leadscrew-agent kept",
    "leadscrew-tests kept",
    "leadscrew-tests motion",
    "leadscrew-tests zones",
    "leadscrew-tests threads",
    "leadscrew-tests whole",
    "leadscrew-tests latency",
    "leadscrew-tests journal",
    "leadscrew-language leadscrew_language",
    "leadscrew board",
];

/// A program of tests.
#[derive(Debug)]
struct Program {
    package: String,
    /// The package and the target.
    name: String,
    file: PathBuf,
    /// The folder of the package: tests find their files from there.
    folder: PathBuf,
}

/// A program of tests to be run.
struct Run<'a> {
    program: &'a Program,
    /// The arguments that select some of its tests.
    which: Vec<&'static str>,
    /// The number of tests that run at once.
    threads: usize,
}

/// What a program printed, and whether it succeeded.
struct Ran {
    name: String,
    took: Duration,
    printed: String,
    succeeded: bool,
}

/// Builds, runs and counts all tests of the workspace, documentation examples included.
pub fn run(counts: &mut Counts) -> Result<()> {
    let built = run::built_tests(&[])?;
    let mut programs: Vec<Program> = built.iter().filter_map(program).collect();
    for name in ELSEWHERE {
        take(&mut programs, name)?;
    }
    let of_machines = take(&mut programs, OF_MACHINES)?;
    let mut queue = VecDeque::new();
    for name in LONG {
        queue.push_back(take(&mut programs, name)?);
    }
    queue.extend(programs);

    let ended = Mutex::new(Vec::new());
    let end = |ran: Ran| {
        let mut ended = ended.lock().unwrap_or_else(PoisonError::into_inner);
        let (took, printed) = (ran.took.as_secs_f64(), ran.printed.trim_end());
        println!("\n-- {}, {took:.1} s\n{printed}", ran.name);
        ended.push(ran);
    };
    beside(tests_of_machines(&of_machines)?.into(), 2, end)?;
    let whole = |program| Run {
        program,
        which: Vec::new(),
        threads: THREADS_PER_PROGRAM,
    };
    let cores = thread::available_parallelism()?.get();
    beside(queue.iter().map(whole).collect(), cores, end)?;
    end(examples_of_documentation()?);
    let ended = ended.into_inner().unwrap_or_else(PoisonError::into_inner);
    judge(&ended, counts)
}

/// Counts the tests, and names those that failed.
fn judge(ended: &[Ran], counts: &mut Counts) -> Result<()> {
    let mut failed = Vec::new();
    for Ran {
        name,
        printed,
        succeeded,
        ..
    } in ended
    {
        let mut own = Counts::default();
        printed.lines().for_each(|line| own.take(line));
        counts.add(&own);
        let tests = printed.lines().filter_map(|line| {
            let line = line.strip_prefix("test ")?;
            line.strip_suffix(" ... FAILED")
        });
        failed.extend(tests.map(|test| format!("{name}: {test}")));
        if !succeeded && own.failed == 0 {
            failed.push(format!("{name}: it ended without a result"));
        }
    }
    if failed.is_empty() {
        return Ok(());
    }
    bail!("these tests failed:\n  {}", failed.join("\n  "));
}

fn take(programs: &mut Vec<Program>, name: &str) -> Result<Program> {
    let place = programs.iter().position(|program| program.name == name);
    let place = place.with_context(|| format!("no program of tests is named `{name}`"))?;
    Ok(programs.remove(place))
}

/// The program in a message of cargo, where that tells of one.
fn program(message: &Value) -> Option<Program> {
    if message["profile"]["test"] != true {
        return None;
    }
    let manifest = PathBuf::from(message["manifest_path"].as_str()?);
    let folder = manifest.parent()?.to_owned();
    let package = package_name(message["package_id"].as_str()?).to_owned();
    let target = message["target"]["name"].as_str()?;
    Some(Program {
        name: format!("{package} {target}"),
        package,
        file: PathBuf::from(message["executable"].as_str()?),
        folder,
    })
}

/// The name in the identity of a package: `path+file:///…/tests#leadscrew-tests@0.1.0`, or `…/xtask#0.1.0` where the
/// folder has the name of the package.
fn package_name(identity: &str) -> &str {
    let (source, rest) = identity.rsplit_once('#').unwrap_or((identity, ""));
    match rest.split_once('@') {
        Some((name, _)) => name,
        None => source.rsplit('/').next().unwrap_or(source),
    }
}

/// The tests of machines that take longest, and the others.
fn tests_of_machines(program: &Program) -> Result<[Run<'_>; 2]> {
    let file = program.file.to_string_lossy();
    let list = run::read(run::command(&program.folder, &file, &["--list"]))?;
    let is_gone = |name: &&&str| run::listed(&list).all(|listed| listed != **name);
    if let Some(gone) = LONG_OF_MACHINES.iter().find(is_gone) {
        bail!("there is no test {gone} any more: renew the table in xtask/src/test/programs.rs");
    }
    let skipped = LONG_OF_MACHINES.iter().flat_map(|name| ["--skip", name]);
    Ok([
        Run {
            program,
            which: [&["--exact"], &LONG_OF_MACHINES[..]].concat(),
            threads: LONG_OF_MACHINES.len(),
        },
        Run {
            program,
            which: skipped.collect(),
            threads: THREADS_OF_MACHINES,
        },
    ])
}

/// Runs them in their order, as many beside each other as there are workers, and hands each that has ended to `end`.
fn beside(runs: VecDeque<Run>, workers: usize, end: impl Fn(Ran) + Sync) -> Result<()> {
    let queue = Mutex::new(runs);
    let next = || {
        let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
        queue.pop_front()
    };
    thread::scope(|scope| {
        let work = || {
            while let Some(run) = next() {
                end(run_one(&run)?);
            }
            Ok(())
        };
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            let done = worker.join();
            done.unwrap_or_else(|_| bail!("what ran a program of tests has panicked"))?;
        }
        Ok(())
    })
}

/// Runs tests of a program to their end, without those for a browser.
fn run_one(run: &Run) -> Result<Ran> {
    let Run { program, .. } = run;
    let args = [&["--skip", page::IN_A_BROWSER], &run.which[..]].concat();
    let mut command = run::command(&program.folder, &program.file.to_string_lossy(), &args);
    run::seed(&mut command);
    // As cargo does: the command that repeats a failure has it.
    command.env("CARGO_PKG_NAME", &program.package);
    ran(program.name.clone(), command, run.threads)
}

/// The examples in the documentation of all libraries. Rustdoc builds and runs them.
fn examples_of_documentation() -> Result<Ran> {
    let args = ["test", "--doc", "--no-fail-fast", "--color", "never"];
    let command = run::cargo(&run::root(), &[&args[..], &run::WHOLE].concat());
    let name = "examples in the documentation".to_owned();
    ran(name, command, THREADS_PER_PROGRAM)
}

/// Runs a program to its end. Its output and what it says beside it are one text.
fn ran(name: String, mut command: Command, threads: usize) -> Result<Ran> {
    if std::env::var_os(THREADS).is_none() {
        command.env(THREADS, threads.to_string());
    }
    let started = Instant::now();
    let (mut reader, writer): (PipeReader, _) = pipe()?;
    command.stdout(writer.try_clone()?).stderr(writer);
    let child = command.spawn();
    // The command holds the writing end, and the text ends when nobody holds it.
    drop(command);
    let mut child = child.with_context(|| format!("cannot start the tests `{name}`"))?;
    println!("   begins: {name}");
    let mut printed = Vec::new();
    reader.read_to_end(&mut printed)?;
    let succeeded = child.wait()?.success();
    Ok(Ran {
        name,
        took: started.elapsed(),
        printed: String::from_utf8_lossy(&printed).into_owned(),
        succeeded,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_has_the_names_of_its_package_and_target() {
        let message = |identity: &str, is_test: bool| {
            serde_json::json!({
                "package_id": identity, "manifest_path": "tests/Cargo.toml", "executable": "kept-1",
                "target": {"name": "kept"}, "profile": {"test": is_test},
            })
        };
        let of_tests = "path+file:///tests#leadscrew-tests@0.1.0";
        let found = program(&message(of_tests, true)).unwrap();
        assert_eq!(found.name, "leadscrew-tests kept");
        assert_eq!(found.folder, PathBuf::from("tests"));
        assert_eq!(package_name("path+file:///xtask#0.1.0"), "xtask");
        assert!(program(&message(of_tests, false)).is_none());
    }

    #[test]
    fn what_fails_is_named_and_a_program_without_a_result_too() {
        let ran = |name: &str, printed: &str, succeeded| Ran {
            name: name.to_owned(),
            took: Duration::ZERO,
            printed: printed.to_owned(),
            succeeded,
        };
        let good = "test one ... ok\ntest result: ok. 1 passed; 0 failed;\n";
        let bad = "test two ... FAILED\ntest result: FAILED. 1 passed; 1 failed;\n";
        let mut counts = Counts::default();
        assert!(judge(&[ran("a", good, true)], &mut counts).is_ok());
        let all = [
            ran("a", good, true),
            ran("b", bad, false),
            ran("c", "", false),
        ];
        let told = judge(&all, &mut counts).unwrap_err().to_string();
        assert_eq!(
            told,
            "these tests failed:\n  b: two\n  c: it ended without a result"
        );
        assert_eq!((counts.passed, counts.failed), (3, 1));
    }
}
