//! Our recordings and other people's programs: `candump` records what we send, `canplayer` plays what we record.

use std::fs::File;
use std::io::{BufReader, Read as _};

use leadscrew_can::{Can as _, Entry, LogReader, LogWriter, Packet, Stamp};
use leadscrew_core::bus::Frame;

use crate::bus::{eventually, frame, open, packets, receive, scratch, sockets_on, start, tool};

/// A stream like that of a machine: SYNC, setpoints, answers.
fn stream() -> Vec<Frame> {
    (0..500_u32)
        .flat_map(|n| {
            [
                frame(0x080, &[(n % 240) as u8 + 1]),
                frame(0x210, &[0x0F, 0, n as u8, (n >> 8) as u8, 0, 0]),
                frame(0x190, &[0x37, 0x06, n as u8, 0, 0, 0]),
                frame(0x701, &[]),
            ]
        })
        .collect()
}

fn entries(path: &std::path::Path) -> Vec<Entry> {
    LogReader::new(BufReader::new(File::open(path).unwrap()))
        .map(|entry| entry.unwrap_or_else(|wrong| panic!("{wrong}")))
        .collect()
}

#[test]
fn candump_records_what_we_send_and_we_read_its_recording() {
    let frames = stream();
    let before = sockets_on("vcan0");
    let count = frames.len().to_string();
    let mut candump = start("candump", &["-L", "-n", &count, "-r", "1000000", "vcan0"]);
    eventually("candump listens", || sockets_on("vcan0") > before);
    open().send(&frames).unwrap();
    let mut text = String::new();
    candump
        .0
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    let read: Vec<Packet> = LogReader::new(text.as_bytes())
        .map(|entry| entry.unwrap_or_else(|wrong| panic!("{wrong}")).packet)
        .collect();
    let sent: Vec<Packet> = frames.iter().copied().map(Packet::Frame).collect();
    assert!(read == sent, "candump recorded something else");

    // Its lines are ours to the letter.
    let mut ours = LogWriter::new(Vec::new(), "vcan0");
    for entry in LogReader::new(text.as_bytes()).flatten() {
        ours.push(entry.time, &entry.packet).unwrap();
    }
    assert_eq!(String::from_utf8(ours.finish().unwrap()).unwrap(), text);
}

#[test]
fn canplayer_plays_what_we_record() {
    let path = scratch("played.log");
    let frames = stream();
    let mut log = LogWriter::new(File::create(&path).unwrap(), "vcan0");
    for (n, frame) in (0..).zip(&frames) {
        log.push(
            Stamp::from_micros(1_000_000 + n * 10),
            &Packet::Frame(*frame),
        )
        .unwrap();
    }
    log.finish().unwrap();
    assert_eq!(entries(&path).len(), frames.len());

    let mut to = open();
    tool("canplayer", &["-t", "-I", path.to_str().unwrap()]);
    let sent: Vec<Packet> = frames.iter().copied().map(Packet::Frame).collect();
    assert!(
        packets(&receive(&mut to, sent.len())) == sent,
        "played otherwise"
    );
}
