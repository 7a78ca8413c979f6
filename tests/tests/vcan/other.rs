//! Our recordings and other people's programs: `candump` records what we send, `canplayer` plays what we record.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};

use leadscrew_can::{Can as _, Entry, LogReader, LogWriter, Packet, Received, Stamp};
use leadscrew_core::bus::{CobId, FdFrame, Frame};

use crate::bus::{eventually, frame, open, packets, receive, scratch, sockets_on, start, tool};
use crate::python::given;

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
    let mut candump = start(
        "candump",
        &["-L", "-n", &count, "-T", "60000", "-r", "1000000", "vcan0"],
    );
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

/// FD frames of every length, some with their data at the higher rate.
fn fd_stream() -> Vec<FdFrame> {
    let content: Vec<u8> = (1..=64).collect();
    (0..=64_usize)
        .filter_map(|count| {
            let id = CobId::new(0x480 + count as u16)?;
            FdFrame::new(id, &content[..count], count % 3 == 0)
        })
        .collect()
}

fn fd_frames(heard: &[Received]) -> Vec<FdFrame> {
    let one = |received: &Received| match &received.packet {
        Packet::Fd(frame) => frame.frame().unwrap(),
        other => panic!("{other:?} was not sent"),
    };
    heard.iter().map(one).collect()
}

#[test]
fn candump_records_the_fd_frames_we_send_and_canplayer_plays_those_we_record() {
    let frames = fd_stream();
    let before = sockets_on("vcan0");
    let count = frames.len().to_string();
    let mut candump = start(
        "candump",
        &["-L", "-n", &count, "-T", "60000", "-r", "1000000", "vcan0"],
    );
    eventually("candump listens", || sockets_on("vcan0") > before);
    let mut from = open();
    from.use_fd(5000).unwrap();
    from.send_fd(&frames).unwrap();
    let mut text = String::new();
    let mut out = candump.0.stdout.take().unwrap();
    out.read_to_string(&mut text).unwrap();
    let read: Vec<FdFrame> = LogReader::new(text.as_bytes())
        .map(|entry| match entry.unwrap().packet {
            Packet::Fd(frame) => frame.frame().unwrap(),
            other => panic!("{other:?} was not sent"),
        })
        .collect();
    assert!(read == frames, "candump recorded something else");

    let path = scratch("fd.log");
    let mut log = LogWriter::new(File::create(&path).unwrap(), "vcan0");
    for (n, frame) in (0..).zip(&frames) {
        let time = Stamp::from_micros(1_000_000 + n * 10);
        log.push(time, &Packet::Fd(frame.into())).unwrap();
    }
    log.finish().unwrap();
    let mut to = open();
    tool("canplayer", &["-t", "-I", path.to_str().unwrap()]);
    let played = fd_frames(&receive(&mut to, frames.len()));
    assert!(played == frames, "played otherwise");
}

#[test]
fn python_can_hears_our_fd_frames_and_we_hear_its() {
    // Sends back what it hears, its identifier one higher; both say whether it is FD and switches its rate.
    const MIRROR: &str = "
import sys, can
with can.Bus('vcan0', interface='socketcan', fd=True) as bus:
    print('listening', flush=True)
    for _ in range(int(sys.argv[1])):
        heard = bus.recv(60)
        assert heard.is_fd and not heard.is_extended_id, heard
        heard.arbitration_id += 0x100
        bus.send(heard)
";
    let frames = fd_stream();
    let count = frames.len().to_string();
    let mut python = start(&given("CANOPEN_PYTHON"), &["-B", "-c", MIRROR, &count]);
    let mut said = BufReader::new(python.0.stdout.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    assert_eq!(line, "listening\n");
    let mut end = open();
    end.send_fd(&frames).unwrap();
    let back = fd_frames(&receive(&mut end, frames.len()));
    for (back, sent) in back.iter().zip(&frames) {
        assert_eq!(back.id().get(), sent.id().get() + 0x100);
        assert_eq!(back.payload(), sent.payload());
        assert_eq!(back.is_rate_switched(), sent.is_rate_switched());
    }
    assert!(python.0.wait().unwrap().success());
}
