//! A machine against an adapter on a serial line.

use std::io::Read;
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread::JoinHandle;

use clap::Parser as _;
use leadscrew_core::bus::CobId;

use super::*;

/// An adapter that takes whatever it is told, up to the end of the line; what it was told but for classical frames.
fn adapter(mut line: UnixStream) -> JoinHandle<Vec<String>> {
    std::thread::spawn(move || {
        let (mut told, mut text, mut bytes) = (Vec::new(), Vec::new(), [0; 4096]);
        while let Ok(count @ 1..) = line.read(&mut bytes) {
            for byte in &bytes[..count] {
                if *byte != b'\r' {
                    text.push(*byte);
                    continue;
                }
                let said = String::from_utf8(core::mem::take(&mut text)).expect("letters");
                let answer: &[u8] = match said.as_bytes().first() {
                    Some(b'V') => b"V1010\r",
                    Some(b't' | b'b') => b"z\r",
                    _ => b"\r",
                };
                // Behind the end nobody hears it.
                let _ = line.write_all(answer);
                if !said.is_empty() && !said.starts_with('t') {
                    told.push(said);
                }
            }
        }
        told
    })
}

/// Writes a parameter without axes, as a client does, and gives the machine time to take it into force.
fn set(machine: &mut Machine, no: u16, bytes: &[u8]) {
    let [low, high] = (0x2000 + no).to_le_bytes();
    let mut request = [
        0x23 | (4 - bytes.len() as u8) << 2,
        low,
        high,
        0,
        0,
        0,
        0,
        0,
    ];
    request[4..4 + bytes.len()].copy_from_slice(bytes);
    let at = CobId::of(Service::SdoRequest, NodeId::BOARD);
    let frame = Frame::new(at, &request).expect("eight bytes");
    machine.hear(&frame, true).expect("an adapter");
    for _ in 0..400 {
        machine.listen(Duration::ZERO).expect("an adapter");
        machine.tick().expect("an adapter");
    }
}

#[test]
fn an_adapter_is_told_the_rate_of_can_fd_that_a_set_brings_later() {
    let name = format!("board-sim-rate-{}", std::process::id());
    let path = std::env::temp_dir().join(name);
    let listener = UnixListener::bind(&path).expect("a socket");
    let told = std::thread::spawn(move || {
        let (line, _) = listener.accept().expect("a client");
        adapter(line).join().expect("its end")
    });
    let bus = format!("slcan:unix:{}", path.display());
    let cli = cli::Cli::parse_from(["board-sim", "--bus", &bus, "--lockstep"]);
    let mut machine = Machine::new(&cli.board).expect("a machine");
    for _ in 0..200 {
        machine.tick().expect("an adapter");
    }
    set(&mut machine, 9031, &[1]);
    set(&mut machine, 9032, &2_000_u16.to_le_bytes());
    drop(machine);
    let told = told.join().expect("its end");
    std::fs::remove_file(path).expect("there was one");
    let (frames, commands): (Vec<&str>, Vec<&str>) = told
        .iter()
        .map(String::as_str)
        .partition(|said| said.starts_with('b'));
    assert!(frames.len() > 400, "{}", frames.len());
    assert_eq!(
        commands,
        ["C", "V", "S8", "O", "C", "Y5", "O", "C", "Y2", "O", "C"]
    );
    // The first frame comes behind its rate.
    let first = told.iter().position(|said| said.starts_with('b'));
    let rate = told.iter().position(|said| said == "Y5");
    assert!(rate < first);
}
