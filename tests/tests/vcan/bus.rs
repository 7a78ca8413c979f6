//! The interface, and other people's programs on it.

use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use leadscrew_can::{Packet, Received, SocketCan};
use leadscrew_core::bus::{CobId, Frame};

/// The interface that all tests share, one after another.
pub const INTERFACE: &str = "vcan0";

/// How long anything is waited for before it counts as lost: nothing takes so long on any computer.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// An end of the bus.
pub fn open() -> SocketCan {
    open_on(INTERFACE)
}

/// An end of another bus.
pub fn open_on(interface: &str) -> SocketCan {
    match SocketCan::open(interface) {
        Ok(can) => can,
        Err(error) => panic!(
            "no CAN bus for this test: {error}\n\
             `cargo xtask vcan` runs it on an interface it finds or makes; by hand: modprobe vcan; ip link add dev \
             {interface} type vcan; ip link set {interface} mtu 72 up"
        ),
    }
}

/// A frame.
pub fn frame(id: u16, payload: &[u8]) -> Frame {
    Frame::new(CobId::new(id).unwrap(), payload).unwrap()
}

/// Receives until there are so many, or fails.
pub fn receive(can: &mut SocketCan, count: usize) -> Vec<Received> {
    let mut heard = Vec::new();
    while heard.len() < count {
        let more = leadscrew_can::Can::receive(can, &mut heard, PATIENCE).unwrap();
        assert!(more > 0, "{} of {count} packets came", heard.len());
    }
    heard
}

/// What was received.
pub fn packets(heard: &[Received]) -> Vec<Packet> {
    heard.iter().map(|received| received.packet).collect()
}

/// Runs a program to its end.
pub fn tool(program: &str, args: &[&str]) -> Output {
    let output = Command::new(program)
        .args(args)
        .stdin(Stdio::null())
        .output()
        .unwrap_or_else(|error| panic!("`{program}` (`cargo xtask setup` installs it): {error}"));
    assert!(
        output.status.success(),
        "{program} {args:?}: {}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// A program of this project, built beside the tests.
pub fn ours(name: &str) -> PathBuf {
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    path.push(name);
    assert!(
        path.is_file(),
        "{} is not built; `cargo xtask vcan` builds it",
        path.display()
    );
    path
}

/// The exit code of what must be near its end; what hangs is ended.
#[track_caller]
pub fn code(child: &mut Child) -> Option<i32> {
    let started = std::time::Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        if started.elapsed() > PATIENCE {
            let _ = child.kill();
            panic!("it does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A program that runs until it is dropped.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts a program of other people, with what it prints.
pub fn start(program: &str, args: &[&str]) -> Running {
    let child = Command::new(program)
        .args(args)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("`{program}` (`cargo xtask setup` installs it): {error}"));
    Running(child)
}

/// Waits until a condition holds, or fails.
#[track_caller]
pub fn eventually(what: &str, holds: impl FnMut() -> bool) {
    assert!(holds_in_time(holds), "{what}: not within {PATIENCE:?}");
}

/// Waits until a condition holds; false where it does not.
pub fn holds_in_time(mut holds: impl FnMut() -> bool) -> bool {
    let started = std::time::Instant::now();
    while !holds() {
        if started.elapsed() > PATIENCE {
            return false;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    true
}

/// The setting of a board for programs in the increments of the makers' sheets, as `examples/leadscrew.toml` has it.
pub const SHEETS: &str = "1004.1=1";

/// Where the test may write; nothing is there yet. Numbers of processes come again
/// in a machine that is started for the tests alone, and its files stay.
pub fn scratch(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("leadscrew-vcan-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let path = dir.join(name);
    let removed = if path.is_dir() {
        std::fs::remove_dir_all(&path)
    } else {
        std::fs::remove_file(&path)
    };
    match removed {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => panic!("{error}"),
        _ => path,
    }
}

/// How many sockets hear everything on an interface.
pub fn sockets_on(interface: &str) -> usize {
    // One line for each raw socket that listens for everything on this interface.
    std::fs::read_to_string("/proc/net/can/rcvlist_all")
        .unwrap_or_default()
        .lines()
        .filter(|line| line.split_whitespace().next() == Some(interface))
        .count()
}
