//! An operator at a second terminal while a program runs.

use std::fs::File;
use std::io::BufReader;

use leadscrew_can::{LogReader, Received};
use leadscrew_core::bus::BoardStatus;

use crate::bus::{PATIENCE, eventually, open, receive, scratch, sockets_on, tool};
use crate::machine::{
    Board, bad, both, command, err, example, field, finish, good, interrupt, leadscrew, out,
    program, run, wait_for_status,
};

/// A tick at which a kernel booted as a program keeps up, and no gateway is missed because the computer stands still.
const SLOW: [&str; 4] = ["--set", "9000=5000", "--set", "9024=0"];

/// Half a minute of it in the hole: whoever is slow still comes in time.
pub const SLOW_TAP: &str = "G98\nG0 X50 Z0\nM29 S200\nG84 Z-30 P9999 F200\nG80\nM30\n";

#[test]
fn hold_overrides_signals_and_resume_act_while_everything_is_recorded() {
    let _board = Board::start(&SLOW);
    let log = scratch("operated.log");
    let before = sockets_on("vcan0");
    let recorder = command(&["record", "-o", log.to_str().unwrap()])
        .spawn()
        .unwrap();
    eventually("the recorder listens", || sockets_on("vcan0") > before);
    let running = run(&program("operated.nc", SLOW_TAP), &[]);
    wait_for_status("the program runs", |status| {
        field(status, "program") == "true" && field(status, "line") != "0"
    });
    good(&leadscrew(&["hold"]));
    let told = good(&leadscrew(&["override", "feed", "50"]));
    assert_eq!(told, "node 1: feed override 50 %\n");
    good(&leadscrew(&["signal", "SWS1=1"]));
    let status = wait_for_status("it holds", |status| field(status, "hold") == "true");
    assert_eq!(field(&status, "feed"), "50");
    assert_eq!(field(&status, "signals"), "16");
    good(&leadscrew(&["override", "feed", "100"]));
    good(&leadscrew(&["resume"]));
    let output = finish(running);
    assert_eq!(field(&good(&output), "ok"), "true");
    interrupt(&recorder);
    finish(recorder);

    // What was recorded is played to whoever listens, complete.
    let lines = LogReader::new(BufReader::new(File::open(&log).unwrap())).count();
    assert!(lines > 1000, "{lines}");
    let played = scratch("played-again.log");
    drop(_board);
    let before = sockets_on("vcan0");
    let recorder = command(&["record", "-o", played.to_str().unwrap()])
        .args(["--count", &lines.to_string()])
        .spawn()
        .unwrap();
    eventually("the recorder listens", || sockets_on("vcan0") > before);
    tool("canplayer", &["-t", "-I", log.to_str().unwrap()]);
    finish(recorder);
    let packets = |path| -> Vec<_> {
        LogReader::new(BufReader::new(File::open(path).unwrap()))
            .map(|entry| entry.unwrap_or_else(|wrong| panic!("{wrong}")).packet)
            .collect()
    };
    assert!(packets(&log) == packets(&played), "played otherwise");
}

#[test]
fn a_stop_in_a_hole_is_an_alarm_and_retract_brings_the_tap_out() {
    let _board = Board::start(&SLOW);
    let running = run(&program("stopped.nc", SLOW_TAP), &[]);
    // In the hole: on the way down, beyond the surface.
    wait_for_status("the tap is in its hole", |status| {
        status.contains("\"in_hole\":true")
    });
    good(&leadscrew(&["stop"]));
    let output = finish(running);
    let words = bad(&output, 4);
    assert!(words.contains("4300"), "{words}");
    assert!(out(&output).contains("\"ok\":false"), "{}", err(&output));
    let refused = bad(&leadscrew(&["retract"]), 4);
    assert!(refused.contains("leadscrew reset"), "{refused}");
    // It may still be on its way to rest: the reset waits for that.
    good(&leadscrew(&["reset"]));
    wait_for_status("it is ready again", |status| {
        field(status, "state") == "idle"
    });
    good(&leadscrew(&["retract"]));
    let status = good(&leadscrew(&["status", "--json"]));
    assert!(!status.contains("\"in_hole\":true"), "{status}");
}

/// Ctrl-C in a stroke: the stroke ends, the tool leaves the thread, and nothing is left of the program. Where it comes does
/// not matter, so nothing here depends on time: it is sent when the bus says that a stroke is under way.
#[test]
fn ctrl_c_in_a_stroke_ends_the_stroke_and_leaves_the_machine_at_rest() {
    let _board = Board::start(&["--lockstep"]);
    let path = program(
        "stroke.nc",
        "O0076 (ALLOW 4800)\nM03 S300\nG00 X80. Z10.\nG76 P010060 Q1500 R0.1\nG76 X76. Z-150. P2000 Q1500 F3.\nG00 X100. Z50.\nM30\n",
    );
    let mut can = open();
    let running = run(&path, &[]);
    let in_a_stroke = |heard: &[Received]| {
        heard
            .iter()
            .filter_map(|received| BoardStatus::decode(received.packet.frame()?))
            .any(|(_, status)| status.flags.locked)
    };
    let started = std::time::Instant::now();
    while !in_a_stroke(&receive(&mut can, 1)) {
        assert!(started.elapsed() < PATIENCE, "no stroke is under way");
    }
    drop(can);
    interrupt(&running);
    let output = finish(running);
    assert_eq!(output.status.code(), Some(130), "{}", both(&output));
    assert_eq!(field(&out(&output), "ok"), "false");
    let status = wait_for_status("it is ready again", |status| {
        field(status, "state") == "idle"
    });
    for (name, value) in [
        ("program", "false"),
        ("hold", "false"),
        ("alarm", "null"),
        // The level that the cycle began at; Z where the stroke ends.
        ("mx", "80"),
        ("mz", "-150"),
    ] {
        assert_eq!(field(&status, name), value, "{status}");
    }
    // Nothing comes later, and the next program is none the worse.
    let output = leadscrew(&["run", example("g84-tap.nc").to_str().unwrap(), "--json"]);
    assert_eq!(field(&good(&output), "ok"), "true");
}
