//! SIGINT and SIGTERM wherever a command may be: what moves nothing ends at once, and says so.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, kill};
use nix::sys::stat::Mode;
use nix::unistd::{Pid, mkfifo};
use serde_json::json;

use super::*;

const SIGNALS: [Signal; 2] = [Signal::SIGINT, Signal::SIGTERM];

const LEADSCREW: &str = env!("CARGO_BIN_EXE_leadscrew");

/// A command that has begun to listen.
fn listening(args: &[&str], stdin: Stdio) -> Child {
    listening_in(LEADSCREW, args, stdin)
}

/// The same of a program that begins it.
fn listening_in(program: &str, args: &[&str], stdin: Stdio) -> Child {
    let child = Command::new(program)
        .args(args)
        .current_dir(root())
        .stdin(stdin)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let caught = || {
        let text = std::fs::read_to_string(&status).ok()?;
        let line = text.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        u64::from_str_radix(line.trim(), 16).ok()
    };
    let both = SIGNALS.map(|signal| 1_u64 << (signal as u32 - 1));
    let patience = Instant::now();
    while caught().is_none_or(|mask| both.iter().any(|bit| mask & bit == 0)) {
        assert!(
            patience.elapsed() < Duration::from_secs(300),
            "it never listened"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

fn send(child: &Child, signal: Signal) {
    kill(Pid::from_raw(child.id().cast_signed()), signal).unwrap();
}

#[track_caller]
fn ended(child: Child, what: &str) {
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(130),
        "{what}: {}",
        stderr(&output)
    );
    assert_eq!(stderr(&output), "error: interrupted\n", "{what}");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        told,
        json!({"ok": false, "exit": 130, "error": "interrupted"}),
        "{what}"
    );
}

/// A name in the file system from which nothing comes.
fn fifo(folder: &Folder) -> String {
    let path = folder.file("fifo");
    let _ = std::fs::remove_file(&path);
    mkfifo(path.as_str(), Mode::S_IRWXU).unwrap();
    path
}

#[test]
fn a_file_that_nobody_writes_is_no_trap() {
    let folder = Folder::new("fifo");
    let (fifo, svg) = (fifo(&folder), folder.file("out.svg"));
    for args in [
        vec!["check", &fifo],
        vec!["expand", &fifo],
        vec!["simulate", &fifo],
        vec!["run", &fifo],
        vec!["plot", &fifo, "-o", &svg],
        vec!["check", "examples/shaft.nc", "--params", &fifo],
        vec!["params", "validate", "--params", &fifo],
        vec!["params", "list", "--params", &fifo],
        vec!["params", "migrate", &fifo],
        vec!["status", "--state", &fifo],
        vec!["simulate", "examples/shaft.nc", "--state", &fifo],
    ] {
        for signal in SIGNALS {
            let child = listening(&[&args[..], &["--json"]].concat(), Stdio::null());
            send(&child, signal);
            ended(child, &format!("{args:?} {signal}"));
        }
    }
}

/// `nohup` asks that a command outlive its terminal.
#[test]
fn a_terminal_that_closes_ends_a_command_but_not_under_nohup() {
    let check = ["check", "/dev/stdin", "--json"];
    let mut child = listening(&check, Stdio::piped());
    // Waiting for its end would close what it reads.
    let stdin = child.stdin.take();
    send(&child, Signal::SIGHUP);
    ended(child, "by itself");
    drop(stdin);

    let mut child = listening_in(
        "nohup",
        &[&[LEADSCREW], &check[..]].concat(),
        Stdio::piped(),
    );
    let mut stdin = child.stdin.take().unwrap();
    send(&child, Signal::SIGHUP);
    stdin.write_all(b"G0 X50 Z10\n").unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_pipe_that_has_stalled_is_no_trap() {
    for command in ["check", "simulate", "run"] {
        for signal in SIGNALS {
            let mut child = listening(&[command, "/dev/stdin", "--json"], Stdio::piped());
            let mut stdin = child.stdin.take().unwrap();
            stdin.write_all(b"G0 X50 Z10\nG1 X4").unwrap();
            send(&child, signal);
            ended(child, command);
            drop(stdin);
        }
    }
}

#[test]
fn a_program_without_end_is_no_trap() {
    for command in ["check", "run"] {
        for signal in SIGNALS {
            let mut child = listening(&[command, "/dev/stdin", "--json"], Stdio::piped());
            let mut stdin = child.stdin.take().unwrap();
            let writer = std::thread::spawn(move || {
                let blocks = "G1 X10 F100\nG1 X20\n".repeat(100);
                let mut written = 0_u64;
                while stdin.write_all(blocks.as_bytes()).is_ok() {
                    written += 1;
                }
                written
            });
            send(&child, signal);
            ended(child, command);
            let _ = writer.join().unwrap();
        }
    }
}

/// What is under way is brought to its end first; whoever does not take the output is not waited for a second time.
#[test]
fn a_second_one_does_not_wait() {
    let folder = Folder::new("second");
    let (fifo, program) = (fifo(&folder), folder.file("long.nc"));
    std::fs::write(
        &program,
        "M3 S300\n".to_owned() + &"G1 X20 Z-100 F60\nG1 X10 Z0\n".repeat(200),
    )
    .unwrap();
    let child = listening(&["simulate", &program, "-o", &fifo], Stdio::null());
    let mut rows = File::open(&fifo).unwrap();
    // The machine moves, and from here on nobody reads.
    rows.read_exact(&mut [0; 4096]).unwrap();
    for signal in SIGNALS {
        send(&child, signal);
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    drop(rows);
}

#[test]
fn what_comes_out_of_a_pipe_is_run_as_it_was_checked() {
    let text = std::fs::read(root().join("examples/shaft.nc")).unwrap();
    let from_file = leadscrew(&["run", "examples/shaft.nc"]);
    let mut child = listening(
        &["run", "/dev/stdin", "--params", "examples/leadscrew.toml"],
        Stdio::piped(),
    );
    child.stdin.take().unwrap().write_all(&text).unwrap();
    let output = child.wait_with_output().unwrap();
    let same = stdout(&from_file).replace("examples/shaft.nc", "/dev/stdin");
    let same = same.replace("machine examples/leadscrew.toml\n", "");
    assert_eq!(stdout(&output), same);
    // The line of a mistake is shown from there, too.
    let mut child = listening(&["check", "/dev/stdin"], Stdio::piped());
    child
        .stdin
        .take()
        .unwrap()
        .write_all(b"G0 X50\nG0 XX\n")
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(
        stderr(&output).contains("2 | G0 XX\n"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_program_that_repeats_itself_ends_by_a_signal_and_keeps_the_passes_it_has_made() {
    let folder = Folder::new("interrupt-passes");
    let program = folder.file("p.nc");
    let text = "O1\n#500=#500+1\nG0 X50 Z5\n#501=#500\nG0 X40\nM99\n";
    std::fs::write(&program, text).unwrap();
    // Nothing outside tells how many passes it has made: a computer that is busy is given more time until there are some.
    let mut time = Duration::from_millis(300);
    while passes_of_one_that_is_interrupted(&folder, &program, time) <= 1.0 {
        assert!(time < Duration::from_secs(300), "it makes no passes");
        time *= 2;
    }
}

/// How many passes are kept of a program that is interrupted after this time: whole ones.
fn passes_of_one_that_is_interrupted(folder: &Folder, program: &str, time: Duration) -> f64 {
    // What the one before has kept is not counted.
    let _ = std::fs::remove_file(folder.file("leadscrew.variables"));
    let mut child = listening(&["run", program, "--json"], Stdio::null());
    std::thread::sleep(time);
    kill(Pid::from_raw(child.id() as i32), Signal::SIGINT).unwrap();
    let (mut out, mut told) = (String::new(), String::new());
    child
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut out)
        .unwrap();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut told)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{out}{told}");
    // Before its first pass is over nothing is kept.
    let kept = std::fs::read_to_string(folder.file("leadscrew.variables")).unwrap_or_default();
    let count = |name: &str| {
        let value = kept.lines().find_map(|line| line.strip_prefix(name));
        value.map_or(0.0, |value| value.parse::<f64>().unwrap())
    };
    // Whole passes: what the gateway has read ahead of the machine is not kept.
    let passes = count("#500 = ");
    assert_eq!(passes, count("#501 = "), "{kept}");
    if passes > 1.0 {
        let result: serde_json::Value = serde_json::from_str(&out).unwrap();
        assert_eq!(result["warnings"][0]["no"], 4996, "{out}");
        let moves = result["moves"].as_f64().unwrap();
        assert!(
            (2.0 * passes..=2.0 * passes + 2.0).contains(&moves),
            "{moves} {passes}"
        );
    }
    passes
}
