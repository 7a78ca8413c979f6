//! A program far larger than the memory of either side.

use std::fs::File;
use std::io;
use std::process::{Child, Stdio};
use std::time::Duration;

use serde_json::Value;

use super::long_program::LongProgram;
use super::server::{Options, Server};
use super::{command, good, json, leadscrew};

/// Bytes of program.
const BYTES: u64 = 2_000_000;
/// Kilobytes that the process may ever have held.
const MOST: u64 = 32 << 10;

/// The largest memory in kilobytes that a process has held, looked at until it ends: the kernel keeps the maximum.
fn peak(child: &mut Child) -> u64 {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        if let Some(now) = line.and_then(|line| line.trim().strip_suffix(" kB")) {
            peak = now.trim().parse().unwrap();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    peak
}

#[test]
fn a_program_of_megabytes_takes_memory_on_neither_side() {
    let path = std::env::temp_dir().join(format!("leadscrew-long-{}.nc", std::process::id()));
    let mut text = LongProgram::new(BYTES);
    io::copy(&mut text, &mut File::create(&path).unwrap()).unwrap();
    let args = ["run", path.to_str().unwrap(), "--json"];
    let machine = ["--params", "examples/leadscrew.toml"];
    let simulated = json(&leadscrew(&[&args[..], &machine].concat(), "sim"));

    let server = Server::start(&Options {
        // As fast as it can, without waiting for heartbeats.
        set: vec![("9024", 0)],
        speed: 1_000_000,
        ..Options::default()
    });
    let mut child = command(&args, &server.bus())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let peak = peak(&mut child);
    let output = child.wait_with_output().unwrap();
    std::fs::remove_file(&path).unwrap();
    let ran: Value = serde_json::from_str(&good(&output)).unwrap();
    for field in ["moves", "setpoint_hash", "late"] {
        assert_eq!(ran[field], simulated[field], "{field}");
    }
    assert!(ran["moves"].as_u64() > Some(text.share().moves));
    assert_eq!(ran["setpoint_hash"], server.hash());
    assert!((1..MOST).contains(&peak), "{peak} KiB");
}
