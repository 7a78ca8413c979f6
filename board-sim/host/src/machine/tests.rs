//! A machine against an adapter on a serial line.

use std::io::Read;
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread::JoinHandle;

use clap::Parser as _;
use leadscrew_can::{Can as _, End, ErrorFrame, Packet, pair};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::Command;
use leadscrew_core::bus::{CobId, Emcy, NmtState};

use super::*;

/// An adapter that accepts every command until the line closes. Gives all commands but those of classical frames.
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
                // After the end of the line nobody reads the answer.
                let _ = line.write_all(answer);
                if !said.is_empty() && !said.starts_with('t') {
                    told.push(said);
                }
            }
        }
        told
    })
}

/// Writes a parameter without axes, as a client does, and lets the machine put it into force.
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
    // The first frame comes after its rate.
    let first = told.iter().position(|said| said.starts_with('b'));
    let rate = told.iter().position(|said| said == "Y5");
    assert!(rate < first);
}

/// A machine that is up, on a bus within this process; and the other end of this bus.
fn machine_on_pair(name: &str, is_virtual: bool) -> (Machine, End) {
    let path = std::env::temp_dir().join(format!("board-sim-{name}-{}", std::process::id()));
    let listener = UnixListener::bind(&path).expect("a socket");
    let line = std::thread::spawn(move || {
        let (line, _) = listener.accept().expect("a client");
        adapter(line).join().expect("its end")
    });
    let bus = format!("slcan:unix:{}", path.display());
    let cli = cli::Cli::parse_from(["board-sim", "--bus", &bus, "--lockstep"]);
    let mut machine = Machine::new(&cli.board).expect("a machine");
    let (mut other, end) = pair();
    machine.wire = Wire::open_already(Box::new(end), is_virtual);
    line.join().expect("its end");
    std::fs::remove_file(path).expect("there was one");
    for _ in 0..200 {
        machine.tick().expect("a bus");
    }
    // The frames sent so far, the first boot-up message included.
    let heard = other.receive(&mut Vec::new(), Duration::ZERO);
    assert!(heard.is_ok_and(|frames| frames > 200));
    (machine, other)
}

/// The kernel reports that the controller is bus-off, or was restarted.
fn tell(machine: &mut Machine, other: &mut End, class: u32) {
    let data = [0, 0, 0, 0, 0, 0, 248, 3];
    let error = ErrorFrame { class, data };
    other.inject(Packet::Error(error)).expect("a bus");
    machine.listen(Duration::ZERO).expect("a bus");
}

const BUS_OFF: u32 = 0x040;
const RESTARTED: u32 = 0x100;

/// Runs up to `ticks` until the board sends its boot-up message. Gives the emergencies after it.
fn comes_back(machine: &mut Machine, other: &mut End, ticks: u32) -> Option<Vec<u16>> {
    let (mut back, mut codes) = (false, Vec::new());
    for _ in 0..ticks {
        machine.tick().expect("a bus");
        let mut heard = Vec::new();
        other.receive(&mut heard, Duration::ZERO).expect("a bus");
        for frame in heard.iter().filter_map(|heard| heard.packet.frame()) {
            back |= *frame == NmtState::BootUp.frame(NodeId::BOARD);
            codes.extend(
                Emcy::decode(frame)
                    .filter(|_| back)
                    .map(|(_, emcy)| emcy.code),
            );
        }
        if !codes.is_empty() {
            return Some(codes);
        }
    }
    back.then_some(codes)
}

#[test]
fn a_controller_that_leaves_a_virtual_bus_comes_back_when_the_machine_stands() {
    let (mut machine, mut other) = machine_on_pair("off", true);
    for _ in 0..2 {
        tell(&mut machine, &mut other, BUS_OFF);
        assert_eq!(
            comes_back(&mut machine, &mut other, 200),
            Some(vec![0x8140])
        );
        let State::Alarm(alarm) = machine.board.ticker().state() else {
            panic!("it stands on one");
        };
        assert_eq!(alarm.code, Code::BusOff);
        machine.board.command(Command::Reset);
        for _ in 0..200 {
            machine.tick().expect("a bus");
        }
        assert_eq!(machine.board.ticker().state(), State::Idle);
    }
}

#[test]
fn a_controller_of_the_kernel_is_started_again_by_the_kernel_alone() {
    let (mut machine, mut other) = machine_on_pair("kernel", false);
    tell(&mut machine, &mut other, BUS_OFF);
    assert_eq!(comes_back(&mut machine, &mut other, 2_000), None);
    tell(&mut machine, &mut other, RESTARTED);
    assert_eq!(
        comes_back(&mut machine, &mut other, 200),
        Some(vec![0x8140])
    );
}
