//! What it costs to receive and record a frame: `receive COUNT FILE` records a stream that a process of its own sends over
//! a socket which any kernel has. A count of the instructions of this process leaves the kernel and the sender out.

use std::fs::File;
use std::io::BufWriter;
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::net::UnixDatagram;
use std::process::{Command, Stdio};
use std::time::Duration;

use leadscrew_can::{Can as _, Health, LogWriter, SocketCan};
use leadscrew_core::bus::{CobId, Frame};

/// Frames to receive before the bus counts as silent.
const PATIENCE: Duration = Duration::from_secs(10);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.as_slice() {
        [send, count] if send == "--send" => send_all(count.parse()?),
        [count, file] => receive_all(count.parse()?, file),
        _ => Err("usage: receive COUNT FILE".into()),
    }
}

fn send_all(count: u64) -> Result<(), Box<dyn std::error::Error>> {
    let socket = std::io::stdin().as_fd().try_clone_to_owned()?;
    let mut can = SocketCan::over(socket, "replay")?;
    let id = CobId::new(0x190).ok_or("no identifier")?;
    let frames: Vec<Frame> = (0..count)
        .filter_map(|n| Frame::new(id, &n.to_le_bytes()))
        .collect();
    can.send(&frames)?;
    Ok(())
}

fn receive_all(count: u64, file: &str) -> Result<(), Box<dyn std::error::Error>> {
    let (here, there) = UnixDatagram::pair()?;
    let mut sender = Command::new(std::env::current_exe()?)
        .args(["--send", &count.to_string()])
        .stdin(Stdio::from(OwnedFd::from(there)))
        .spawn()?;
    let mut can = SocketCan::over(here.into(), "vcan0")?;
    let mut log = LogWriter::new(
        BufWriter::with_capacity(1 << 16, File::create(file)?),
        "vcan0",
    );
    let mut health = Health::default();
    let mut heard = Vec::new();
    let mut calls = 0_u64;
    while health.frames < count {
        heard.clear();
        calls += 1;
        if can.receive(&mut heard, PATIENCE)? == 0 {
            return Err("the stream has ended early".into());
        }
        for received in &heard {
            log.push(received.time, &received.packet)?;
            health.note(&received.packet);
        }
    }
    log.finish()?;
    sender.wait()?;
    println!("{} frames in {calls} calls", health.frames);
    Ok(())
}
