//! Whether a board in real time keeps its beat on this host: `cargo xtask bench real-time`
//! runs this and puts what it prints into docs/performance.md.
//!
//! `real_time BOARD_SIM PROGRAM`: the real `board-sim` carries a program out in real time,
//! on a serial-line adapter behind a TCP connection, which is this process. It notes when
//! each SYNC arrives, and whether all setpoints of a cycle have come before the next SYNC.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use leadscrew_core::bus::{DriveCommand, NodeId, is_sync};
use leadscrew_slcan::{Adapter, Heard, Lines, SlcanFrame};

/// The beat.
const TICK: Duration = Duration::from_millis(1);
/// Upper ends of the histogram's classes, in microseconds.
const CLASSES: [u64; 7] = [20, 50, 100, 200, 500, 1_000, 10_000];

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [program, text] = args.as_slice() else {
        eprintln!("usage: real_time BOARD_SIM PROGRAM");
        std::process::exit(2);
    };
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let bus = format!("slcan:tcp:{}", listener.local_addr().expect("an address"));
    let child = Command::new(program)
        // However late it is: that is what is measured.
        .args(["--bus", &bus, "--program", text, "--set", "9027=0"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let (mut line, _) = listener.accept().expect("a board");
    line.set_nodelay(true).expect("an option");

    let mut adapter = Adapter::new(0x10, 0x10, *b"BEAT");
    let mut lines = Lines::new();
    let mut bytes = [0; 4096];
    let mut beats: Vec<Instant> = Vec::new();
    // Setpoints of X and Z since the last SYNC, and the cycles in which one was missing.
    let (mut setpoints, mut incomplete) = (0, 0_u64);
    loop {
        let count = match line.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => count,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => break,
        };
        let now = Instant::now();
        let mut out = Vec::new();
        for byte in &bytes[..count] {
            let Some(heard) = lines.push(*byte).filter(|heard| *heard != Heard::Bell) else {
                continue;
            };
            let handled = adapter.handle(heard);
            out.extend(handled.reply.line().bytes());
            let Some(SlcanFrame::Data(frame)) = handled.send else {
                continue;
            };
            if is_sync(&frame) {
                // Before the drives are up there are none.
                incomplete += u64::from(setpoints == 1);
                setpoints = 0;
                beats.push(now);
            } else if let Some((NodeId::DRIVE_X | NodeId::DRIVE_Z, _)) =
                DriveCommand::decode(&frame)
            {
                setpoints += 1;
            }
        }
        if line.write_all(&out).is_err() {
            break;
        }
    }
    let ended = child.wait_with_output().expect("a process");
    assert!(
        ended.status.success(),
        "{}",
        String::from_utf8_lossy(&ended.stderr)
    );

    // The beat is the board's; when it began is told by the SYNC that came earliest for its number.
    let first = *beats.first().expect("a SYNC");
    let due = |number: usize| TICK * u32::try_from(number).expect("a short run");
    let behind = |number: usize, at: Instant| {
        i64::try_from((at - first).as_micros()).expect("a short run")
            - i64::try_from(due(number).as_micros()).expect("a short run")
    };
    let each = beats.iter().enumerate();
    let mut behind: Vec<u64> = {
        let all: Vec<i64> = each.map(|(number, at)| behind(number, *at)).collect();
        let least = all.iter().copied().min().unwrap_or(0);
        all.iter().map(|us| us.abs_diff(least)).collect()
    };
    behind.sort_unstable();
    let all = behind.len();
    let share = |part: f64| behind[((all - 1) as f64 * part) as usize];
    println!(
        "{all} SYNCs in {:.1} s; behind the beat: median {} µs, 99 % below {} µs, the worst {} µs. Cycles in which only one of \
         X and Z had a setpoint: {incomplete}.\n",
        TICK.as_secs_f64() * all as f64,
        share(0.5),
        share(0.99),
        share(1.0)
    );
    println!("| SYNC arrives behind the beat by | SYNCs | share |\n|---|---:|---:|");
    let mut below = 0;
    for class in CLASSES {
        let count = behind.partition_point(|us| *us <= class) - below;
        below += count;
        println!(
            "| ≤ {class} µs | {count} | {:.3} % |",
            count as f64 * 100.0 / all as f64
        );
    }
    let rest = all - below;
    println!(
        "| more | {rest} | {:.3} % |",
        rest as f64 * 100.0 / all as f64
    );
}
