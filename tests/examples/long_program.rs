//! A program of a hundred megabytes on a board with kilobytes for it, measured: `cargo xtask bench long` runs this and puts
//! what it prints into docs/performance.md.
//!
//! `long_program BYTES LEADSCREW FOLDER`: the program `LEADSCREW` runs the text as a file in `FOLDER`, which is removed
//! again. All runs must come to the same setpoints, or this fails.

#[path = "../../gateway/tests/board/server.rs"]
#[allow(
    dead_code,
    reason = "what stands behind the port can do more than this needs"
)]
mod server;

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use leadscrew_core::board::device::PROGRAM_BYTES;
use leadscrew_tests::long_program::LongProgram;
use leadscrew_tests::stream::{directly, over_the_wire};

use server::{Options, Server};

/// What a process said, and the largest memory it has held, in kilobytes.
struct Ended {
    said: String,
    peak: u64,
    seconds: f64,
}

fn leadscrew(program: &str, text: &Path, bus: &str) -> Ended {
    let began = Instant::now();
    let mut child = Command::new(program)
        .args(["run", "--json", "--bus", bus])
        .arg(text)
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .expect("the program starts");
    let mut peak = 0;
    let status = format!("/proc/{}/status", child.id());
    while child.try_wait().expect("a process").is_none() {
        // The kernel keeps the maximum; the last look counts.
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        if let Some(now) = line.and_then(|line| line.trim().strip_suffix(" kB")) {
            peak = now.trim().parse().expect("a number");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let output = child.wait_with_output().expect("a process");
    assert!(output.status.success(), "{}", output.status);
    Ended {
        said: String::from_utf8_lossy(&output.stdout).into_owned(),
        peak,
        seconds: began.elapsed().as_secs_f64(),
    }
}

/// The number or text of a field.
fn field<'a>(said: &'a str, name: &str) -> &'a str {
    let (_, rest) = said
        .split_once(&format!("\"{name}\":"))
        .unwrap_or_else(|| panic!("no {name} in {said}"));
    let end = rest.find([',', '}']).unwrap_or(rest.len());
    rest[..end].trim_matches('"')
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [bytes, program, folder] = args.as_slice() else {
        eprintln!("usage: long_program BYTES LEADSCREW FOLDER");
        std::process::exit(2);
    };
    let bytes: u64 = bytes.parse().expect("a number of bytes");

    let began = Instant::now();
    let mut text = LongProgram::new(bytes);
    let (wire, certificate) = over_the_wire(&mut text);
    let wire_seconds = began.elapsed().as_secs_f64();
    let share = text.share();
    assert!(wire.finished && share.bytes >= bytes);
    assert_eq!(certificate.setpoint_hash, Some(wire.hash));

    let began = Instant::now();
    let direct = directly(LongProgram::new(bytes));
    let direct_seconds = began.elapsed().as_secs_f64();
    assert_eq!(direct, wire, "handed over, and over the wire");

    let path = Path::new(folder).join("long.nc");
    io::copy(
        &mut LongProgram::new(bytes),
        &mut File::create(&path).expect("a file"),
    )
    .expect("room for the file");
    let simulated = leadscrew(program, &path, "sim");
    let board = Server::start(&Options {
        speed: 1_000_000,
        ..Options::default()
    });
    let ran = leadscrew(program, &path, &board.bus());
    fs::remove_file(&path).expect("the file is there");
    let hash = format!("{:016x}", wire.hash);
    for said in [&simulated.said, &ran.said] {
        assert_eq!(field(said, "setpoint_hash"), hash);
        assert_eq!(field(said, "moves"), wire.moves.to_string());
    }
    assert_eq!(board.hash(), hash);

    let percent = |part: u64| part * 100 / share.bytes;
    println!(
        "{} bytes in {} lines: {} % words, {} % remarks, {} % blanks and line ends; {} short moves and {} threads, {} calls, \
         {} moves in all; {} s of virtual time. The board keeps {PROGRAM_BYTES} bytes of it at a time. Setpoint hash of all \
         four runs: `{hash}`.\n",
        share.bytes,
        share.lines,
        percent(share.code),
        percent(share.remarks),
        percent(share.bytes - share.code - share.remarks),
        share.moves,
        share.threads,
        wire.calls,
        wire.moves,
        wire.ticks / 1000,
    );
    println!("| | wall time | largest memory of `leadscrew` |\n|---|---:|---:|");
    println!("| the calls handed to the board | {direct_seconds:.0} s | – |");
    println!("| batches in SDO blocks, each frame handed over | {wire_seconds:.0} s | – |");
    for (name, ended) in [
        ("`leadscrew run`, `--bus sim`", &simulated),
        ("`leadscrew run`, `--bus slcan:tcp:…`", &ran),
    ] {
        let megabytes = ended.peak as f64 / 1024.0;
        println!("| {name} | {:.0} s | {megabytes:.1} MiB |", ended.seconds);
    }
}
