//! A gateway that is killed (SIGKILL) as a process: in a tap, in a transfer, in a push. What a board does about each,
//! place by place, stands in the tests of `faults`; here nothing of the process is left to say so.

use std::process::{Child, Stdio};
use std::time::Duration;

use leadscrew_can::{Can as _, Received, SocketCan};
use leadscrew_core::bus::Frame;

use crate::bus::{PATIENCE, eventually, open, ours, scratch, tool};
use crate::machine::{
    Board, command, field, finish, good, leadscrew, out, program, run, wait_for_status,
};
use crate::operate::SLOW_TAP;

/// Board's answers, and what it is asked.
const REPLY: u16 = 0x581;
const REQUEST: u16 = 0x601;

fn kill(mut process: Child) {
    process.kill().unwrap();
    process.wait().unwrap();
}

/// Kills the process once a frame like this is on the bus, after `skip` earlier ones have gone by. Returns the frames that
/// were received together with that frame, after it.
fn kill_at(
    can: &mut SocketCan,
    process: Child,
    mut skip: usize,
    like: impl Fn(&Frame) -> bool,
) -> Vec<Frame> {
    let began = std::time::Instant::now();
    let mut heard = Vec::new();
    loop {
        heard.clear();
        can.receive(&mut heard, PATIENCE).unwrap();
        let mut frames = heard.iter().filter_map(|heard| heard.packet.frame());
        while let Some(frame) = frames.next() {
            if like(frame) {
                if skip == 0 {
                    kill(process);
                    return frames.copied().collect();
                }
                skip -= 1;
            }
        }
        assert!(began.elapsed() < PATIENCE, "no such frame");
    }
}

/// A block download of 5020h:01 begins.
fn begins(frame: &Frame) -> bool {
    about(frame, REQUEST, 0xC6, [0x20, 0x50, 1])
}

/// Listens until the board says that it has given up the transfer that has begun. Who was killed too late has come to its
/// end, which the board confirms: only then may nothing more come.
fn wait_for_abort(can: &mut SocketCan, mut frames: Vec<Frame>) {
    let began = std::time::Instant::now();
    let mut under_way = true;
    let mut heard: Vec<Received> = Vec::new();
    while under_way || began.elapsed() < Duration::from_secs(15) {
        for frame in &frames {
            if about(frame, REPLY, 0x80, [0x20, 0x50, 1]) {
                return;
            }
            let confirmed = frame.id().get() == REPLY && frame.payload().first() == Some(&0xA1);
            under_way = begins(frame) || under_way && !confirmed;
        }
        assert!(began.elapsed() < PATIENCE, "the transfer is not given up");
        heard.clear();
        can.receive(&mut heard, Duration::from_secs(1)).unwrap();
        let packets = heard.iter();
        frames = packets
            .filter_map(|heard| heard.packet.frame().copied())
            .collect();
    }
}

/// A request, or its answer, about this object; `command` as it begins.
fn about(frame: &Frame, id: u16, command: u8, object: [u8; 3]) -> bool {
    let payload = frame.payload();
    frame.id().get() == id
        && payload.first() == Some(&command)
        && payload.get(1..4) == Some(&object[..])
}

/// Well below R, which is at 0.
fn in_a_tap(status: &str) -> bool {
    let depth: f64 = field(status, "mz").parse().unwrap();
    depth < -8.0 && field(status, "sync_error_um") != "null"
}

/// As [`SLOW_TAP`], in pecks.
const SLOW_PECKS: &str = "G98\nG0 X50 Z0\nM29 S200\nG84 Z-30 Q4. P9999 F200\nG80\nM30\n";

/// A gateway is missed after five seconds, and not before because the computer stands still.
const PATIENT: [&str; 4] = ["--set", "9000=5000", "--set", "9024=5000"];

/// Killed while the tap is in its hole: the hole is finished, and the journal says that the tap is out.
#[test]
fn in_a_tap_the_hole_is_finished() {
    let floating = "G98\nM3 S200\nG0 X50 Z0\nG84 Z-30 P9999 F200\nG80\nM30\n";
    for (name, text) in [
        ("rigid.nc", SLOW_TAP),
        ("pecks.nc", SLOW_PECKS),
        ("floating.nc", floating),
    ] {
        let board = Board::start(&[&PATIENT[..], &["--set", "9025=0"]].concat());
        let running = run(&program(name, text), &[]);
        wait_for_status("the tap is in its hole", in_a_tap);
        kill(running);
        let status = wait_for_status("the hole is finished", |status| {
            matches!(field(status, "state"), "hold" | "idle")
        });
        let at: f64 = field(&status, "mz").parse().unwrap();
        assert!(at >= 0.0, "{name}: {status}");
        assert!(!status.contains("\"in_hole\":true"), "{name}: {status}");
        let words = board.words();
        assert!(!words.contains("alarm"), "{name}: {words}");
        good(&leadscrew(&["reset"]));
        wait_for_status("it can be used again", |status| {
            field(status, "state") == "idle"
        });
    }
}

/// The same with a stop (9025 = 1): in phase, the tap stays in its hole, and comes out by the journal.
#[test]
fn in_a_tap_a_stop_leaves_it_in_the_hole_and_the_journal_brings_it_out() {
    let _board = Board::start(&[&PATIENT[..], &["--set", "9025=1"]].concat());
    let running = run(&program("stopped.nc", SLOW_PECKS), &[]);
    wait_for_status("the tap is in its hole", in_a_tap);
    kill(running);
    let status = wait_for_status("it has stopped", |status| field(status, "state") == "alarm");
    assert!(status.contains("\"no\":4330"), "{status}");
    assert!(status.contains("\"in_hole\":true"), "{status}");
    good(&leadscrew(&["reset"]));
    wait_for_status("it is ready", |status| field(status, "state") == "idle");
    good(&leadscrew(&["retract", "--speed", "200"]));
    let status = wait_for_status("the tap is out", |status| field(status, "state") == "idle");
    assert!(!status.contains("\"in_hole\":true"), "{status}");
}

/// Killed in the transfer of a program, early and late: the board waits for nobody, and the next program is the next.
#[test]
fn in_a_transfer_the_next_program_is_carried_out() {
    let mut text = String::from("G50 X80 Z20\nM3 S1000\nG0 X60 Z2\nG98 G1 F8000\n");
    for n in 0..400 {
        text.push_str(&format!("X60.0{} Z2.0{}\n", n % 2 * 2, n % 2));
    }
    text.push_str("M30\n");
    let path = program("transfer.nc", &text);
    let args = ["run", path.to_str().unwrap(), "--json"];
    let simulated = out(&tool(ours("leadscrew").to_str().unwrap(), &args));
    let _board = Board::start(&["--lockstep", "--set", "9024=0"]);
    for batches in [0, 1, 5] {
        let mut can = open();
        let running = run(&path, &[]);
        let behind = kill_at(&mut can, running, batches, begins);
        // Virtual time stands still until the program counts as lost, and goes slowly then; a second of it later the
        // transfer is given up, and the board says so. Until then whatever is asked would be taken for a piece of it.
        wait_for_abort(&mut can, behind);
        eventually("it takes a reset", || {
            leadscrew(&["reset"]).status.success()
        });
        let status = wait_for_status("it is ready", |status| field(status, "state") == "idle");
        assert_eq!(field(&status, "alarm"), "null", "{status}");
        let ran = good(&finish(run(&path, &[])));
        for name in ["ok", "moves"] {
            assert_eq!(field(&ran, name), field(&simulated, name), "{batches}");
        }
    }
}

/// Killed in `params push`, wherever: the old set is in force and stored, or the new one, and the next push works.
#[test]
fn in_a_push_the_old_set_counts_or_the_new_one() {
    let flash = scratch("killed.flash");
    let whole = scratch("killed.toml");
    let (flash, file) = (flash.to_str().unwrap(), whole.to_str().unwrap());
    let mut board = Board::start(&["--state", flash]);
    good(&leadscrew(&["params", "pull", "-o", file]));
    let pulled = std::fs::read_to_string(&whole).unwrap();
    let identity = || {
        let status = wait_for_status("it is ready", |status| field(status, "state") == "idle");
        field(&status, "parameters").to_owned()
    };
    let block = |command| move |frame: &Frame| about(frame, REQUEST, command, [0x10, 0x50, 9]);
    let acknowledged =
        |frame: &Frame| frame.id().get() == REPLY && frame.payload().first() == Some(&0xA2);
    type Wanted = Box<dyn Fn(&Frame) -> bool>;
    let places: [(&str, Wanted, usize); 6] = [
        ("the first frame", Box::new(block(0xC6)), 0),
        ("the first block", Box::new(acknowledged), 0),
        ("the second block", Box::new(acknowledged), 1),
        (
            "what changes is asked",
            Box::new(|frame: &Frame| about(frame, REQUEST, 0xA4, [0x10, 0x50, 10])),
            0,
        ),
        (
            "the commit",
            Box::new(|frame: &Frame| about(frame, REQUEST, 0x23, [0x10, 0x50, 11])),
            0,
        ),
        (
            "is it stored",
            Box::new(|frame: &Frame| {
                frame.id().get() == REQUEST && frame.payload().get(1..4) == Some(&[0x10, 0x50, 2])
            }),
            0,
        ),
    ];
    let (mut old, mut value) = (identity(), 15);
    for (place, like, skip) in places {
        value -= 1;
        let text = pulled.replace("\"15 %\"", &format!("\"{value} %\""));
        assert_ne!(text, pulled);
        std::fs::write(&whole, text).unwrap();
        let mut can = open();
        let pushing = command(&["params", "push", file])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        kill_at(&mut can, pushing, skip, like);
        // Until the transfer is given up, what is asked may be taken for a piece of it.
        eventually("it answers", || leadscrew(&["status"]).status.success());
        let after = identity();
        // What counts is what is stored.
        board.kill();
        board = Board::start(&["--state", flash]);
        eventually("it starts with the same", || identity() == after);
        good(&leadscrew(&["params", "push", file]));
        let new = identity();
        assert!(after == old || after == new, "{place}: {old} {after} {new}");
        assert_ne!(old, new, "{place}");
        old = new;
    }
}
