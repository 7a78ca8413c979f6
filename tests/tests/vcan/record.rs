//! `leadscrew record`: everything that is on the bus is in the file, and trouble is told.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use leadscrew_can::{Can as _, Entry, LogReader, Packet};
use leadscrew_core::bus::Frame;

use crate::bus::{
    eventually, frame, holds_in_time, open, open_on, ours, scratch, sockets_on, tool,
};
use crate::machine::interrupt;

/// Starts the command and waits until it listens.
fn record(bus: &str, file: &Path, more: &[&str]) -> Child {
    let before = sockets_on(bus);
    let child = Command::new(ours("leadscrew"))
        .args(["record", "--bus", bus, "--json", "-o"])
        .arg(file)
        .args(more)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    eventually("the recorder listens", || sockets_on(bus) > before);
    child
}

/// Its exit code, result and words. One that waits for frames that do not come is told to end.
fn end(mut child: Child) -> (Option<i32>, String, String) {
    if !holds_in_time(|| child.try_wait().unwrap().is_some()) {
        interrupt(&child);
    }
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

fn entries(path: &Path) -> Vec<Entry> {
    LogReader::new(BufReader::new(File::open(path).unwrap()))
        .map(|entry| entry.unwrap_or_else(|wrong| panic!("{wrong}")))
        .collect()
}

/// Frames that number themselves.
fn numbered(count: u32) -> Vec<Frame> {
    (0..count).map(|n| frame(0x100, &n.to_le_bytes())).collect()
}

#[test]
fn a_hundred_thousand_frames_in_bursts_are_all_in_the_log() {
    let path = scratch("bursts.log");
    let recorder = record("vcan0", &path, &["--count", "100000"]);
    let mut from = open();
    for burst in numbered(100_000).chunks(2000) {
        from.send(burst).unwrap();
    }
    let (code, result, words) = end(recorder);
    assert_eq!(code, Some(0), "{words}");
    assert_eq!(
        result,
        "{\"ok\":true,\"packets\":100000,\"fd_frames\":0,\"error_frames\":0,\"dropped\":0}\n"
    );
    let entries = entries(&path);
    assert_eq!(entries.len(), 100_000);
    for (n, entry) in (0..).zip(&entries) {
        let number = entry.packet.frame().and_then(Frame::exactly::<4>);
        assert_eq!(number.map(u32::from_le_bytes), Some(n));
        assert_eq!(entry.bus, "vcan0");
    }
    assert!(entries.is_sorted_by_key(|entry| entry.time));
}

#[test]
fn error_and_fd_frames_are_recorded_and_told() {
    let path = scratch("errors.log");
    let recorder = record("vcan0", &path, &["--count", "3"]);
    tool("cansend", &["vcan0", "20000044#0020000000008800"]);
    tool("cansend", &["vcan0", "321##1000102030405060708090A0B"]);
    tool("cansend", &["vcan0", "123#AABB"]);
    let (code, result, words) = end(recorder);
    assert_eq!(code, Some(0), "{words}");
    assert!(
        result.contains("\"fd_frames\":1,\"error_frames\":1"),
        "{result}"
    );
    assert!(words.contains("warning: bus-off"), "{words}");
    assert!(words.contains("CAN FD frames"), "{words}");
    let kinds: Vec<bool> = entries(&path)
        .iter()
        .map(|entry| matches!(entry.packet, Packet::Frame(_)))
        .collect();
    assert_eq!(kinds, [false, false, true]);
}

#[test]
fn a_table_has_a_row_for_every_sync() {
    let path = scratch("table.csv");
    let recorder = record("vcan0", &path, &["--count", "6"]);
    open()
        .send(&[
            frame(0x080, &[1]),
            frame(0x210, &[0x0F, 0, 0x10, 0x27, 0, 0]),
            frame(0x080, &[2]),
            frame(0x190, &[0x37, 0x06, 0x0F, 0x27, 0, 0]),
            frame(0x080, &[3]),
            frame(0x710, &[0]),
        ])
        .unwrap();
    let (code, _, words) = end(recorder);
    assert_eq!(code, Some(0), "{words}");
    let text = std::fs::read_to_string(&path).unwrap();
    let rows: Vec<&str> = text
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap().1)
        .collect();
    // Nothing is known of the other axes, of the spindles, and of what else is not sent.
    let row = |begin: &str| format!("{begin}{}", ",".repeat(19 - begin.matches(',').count()));
    let event = |text: &str| format!("{}{text}", ",".repeat(19));
    assert_eq!(
        rows,
        [
            row("1"),
            row("2,1000000"),
            event("node 16: operation enabled (statusword 0637h)"),
            row("3,1000000,,,,,999900"),
            event("node 16: BootUp"),
        ]
    );
}

#[test]
fn an_interface_that_goes_down_ends_the_recording_with_what_there_was() {
    let name = "vcan8";
    tool("ip", &["link", "add", "dev", name, "type", "vcan"]);
    tool("ip", &["link", "set", name, "up"]);
    let path = scratch("down.log");
    let recorder = record(name, &path, &[]);
    open_on(name).send(&numbered(10)).unwrap();
    eventually("the frames are in the file", || {
        std::fs::read_to_string(&path).is_ok_and(|text| text.lines().count() == 10)
    });
    tool("ip", &["link", "set", name, "down"]);
    let (code, _, words) = end(recorder);
    assert_eq!(code, Some(3), "{words}");
    assert!(words.contains("`vcan8` is down"), "{words}");
    assert_eq!(entries(&path).len(), 10);
    tool("ip", &["link", "delete", name]);
}

#[test]
fn each_mistake_has_its_own_words_and_exit_code() {
    let log = scratch("never.log");
    let log = log.to_str().unwrap();
    for (args, code, said) in [
        (
            ["--bus", "vcan7", "-o", log],
            3,
            "there is no interface `vcan7`; the CAN interfaces here are",
        ),
        (["--bus", "lo", "-o", log], 3, "not one of CAN"),
        (
            ["--bus", "slcan:unix:/tmp/nowhere", "-o", log],
            3,
            "is the adapter plugged in",
        ),
        (
            ["--bus", "vcan0", "-o", "frames.txt"],
            2,
            "the ending says what is written",
        ),
        (["--bus", "sim", "-o", log], 2, "`run --record FILE`"),
    ] {
        let output = Command::new(ours("leadscrew"))
            .arg("record")
            .args(args)
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {words}");
        assert!(words.contains(said), "{args:?}: {words}");
    }
}
