//! The emulated board as a machine with a name, as those of `leadscrew up`: a bus for many gateways, and a hand.
//!
//! ```text
//! gateways ◄─── NAME.sock ─► bus ◄─ serial line ────────► board
//! leadscrew sim ─ NAME.ctl ─► hand ─ second serial line ─► the machine around it
//! ```
//!
//! A gateway's frame is on the bus, and heard by the others, when the board's end of the line has taken it. So all hear the
//! frames in one order, which is that of the board. What it is told must not matter to the bus.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Instant;

use leadscrew_board_sim::TurretFault;
use leadscrew_can::{Desk, MachineName, Port};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::Both;
use leadscrew_core::params::Contact;
use leadscrew_desk::bus::{Bus, Traffic};
use leadscrew_desk::callers::{Callers, bind};
use leadscrew_desk::clock::Speed;
use leadscrew_desk::control::{Door, Power, Request, View};
use leadscrew_desk::hand::{Contacts, Handled, carry_out};
use leadscrew_slcan::{Lines, Reply, Request as Line, SlcanFrame};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};

use crate::board::{Board, PATIENCE};

/// The most frames that the board's end of the line has not taken yet.
const WINDOW: usize = 32;

/// The machine. Its emulator is held by somebody else.
pub struct Named {
    name: MachineName,
    board: UnixStream,
    lines: Lines,
    /// Frames for the board, with the numbers of their gateways: so many are on the line, the others wait.
    said: VecDeque<(u64, SlcanFrame)>,
    on_line: usize,
    hand: UnixStream,
    bus: Bus,
    gateways: UnixListener,
    callers: Callers,
    control: UnixListener,
    sockets: [PathBuf; 2],
    contacts: Contacts,
    speed: Speed,
    ends: bool,
    /// Held as long as the machine runs.
    _claim: File,
}

impl Named {
    /// Takes over both lines of a board, for commands whose `XDG_RUNTIME_DIR` this is.
    pub fn new(board: &Board, name: &str, runtime: &Path) -> Self {
        let name: MachineName = name.parse().expect("a name");
        let desk = Desk::make_within(runtime).expect("a folder");
        let claim = desk.claim(&name).expect("a claim").expect("nobody has it");
        let sockets = [Port::Bus, Port::Control].map(|port| desk.socket(&name, port));
        let hand = UnixStream::connect(board.hand()).expect("the second line");
        hand.set_nonblocking(true).expect("a socket");
        let board = UnixStream::connect(board.line()).expect("the line");
        board.set_nonblocking(true).expect("a socket");
        let mut named = Self {
            name,
            board,
            lines: Lines::new(),
            said: VecDeque::new(),
            on_line: 0,
            hand,
            bus: Bus::default(),
            gateways: bind(&sockets[0]).expect("a socket"),
            callers: Callers::default(),
            control: bind(&sockets[1]).expect("a socket"),
            sockets,
            contacts: Contacts::default(),
            speed: Speed::REAL,
            ends: false,
            _claim: claim,
        };
        named.open();
        named
    }

    /// Opens the board's end of the line, which may have an unfinished line.
    fn open(&mut self) {
        self.said.clear();
        self.on_line = 0;
        self.write(b"\r\r\rC\rS8\rO\r");
    }

    /// Writes to the line. There is room: no more than a window of frames is on it.
    fn write(&mut self, bytes: &[u8]) {
        self.board.write_all(bytes).expect("the board's line");
    }

    /// Runs until somebody ends it.
    pub fn run(mut self) {
        while !self.ends {
            self.wait();
            while let Ok((stream, _)) = self.gateways.accept() {
                self.bus.join(stream).expect("a socket");
            }
            self.hear_gateways();
            self.hear_board();
            let dropped = self.bus.flush();
            assert!(dropped.is_empty(), "a gateway does not read");
            let mut callers = std::mem::take(&mut self.callers);
            callers.welcome(&self.control);
            callers.answer(|request| carry_out(&mut self, request));
            self.callers = callers;
        }
    }

    /// Waits until something has come, or a gateway can be told more.
    fn wait(&self) {
        let others = [
            self.board.as_fd(),
            self.gateways.as_fd(),
            self.control.as_fd(),
        ];
        let others = others.into_iter().chain(self.callers.sockets());
        let gateways = self.bus.sockets().map(|(socket, writes)| match writes {
            true => (socket, PollFlags::POLLIN | PollFlags::POLLOUT),
            false => (socket, PollFlags::POLLIN),
        });
        let mut all: Vec<PollFd<'_>> = others
            .map(|socket| (socket, PollFlags::POLLIN))
            .chain(gateways)
            .map(|(socket, wanted)| PollFd::new(socket, wanted))
            .collect();
        poll(&mut all, PollTimeout::NONE).expect("a wait");
    }

    fn hear_gateways(&mut self) {
        for (from, traffic) in self.bus.hear() {
            // Nobody here sends frames of CAN FD.
            if let Traffic::Classical(frame) = traffic {
                self.said.push_back((from, frame));
            }
        }
        self.send();
    }

    /// Puts waiting frames on the line.
    fn send(&mut self) {
        while self.on_line < WINDOW
            && let Some((_, frame)) = self.said.get(self.on_line)
        {
            let line = Line::Send(*frame).line();
            self.write(line.bytes());
            self.on_line += 1;
        }
    }

    fn hear_board(&mut self) {
        let mut bytes = [0; 4096];
        let count = match self.board.read(&mut bytes) {
            Ok(0) => panic!("the emulator has ended"),
            Ok(count) => count,
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => return,
            Err(error) => panic!("the board's line: {error}"),
        };
        for byte in &bytes[..count] {
            let Some(heard) = self.lines.push(*byte) else {
                continue;
            };
            match Reply::of(heard) {
                Some(Reply::Frame(frame, _)) => {
                    self.bus.tell(&Traffic::Classical(frame), None, 0);
                }
                Some(Reply::Sent | Reply::SentExtended) if self.on_line > 0 => {
                    self.on_line -= 1;
                    let (from, frame) = self.said.pop_front().expect("it is on the line");
                    self.bus.tell(&Traffic::Classical(frame), Some(from), 0);
                }
                _ => {}
            }
        }
        self.send();
    }

    /// Tells the machine around the board a line, and waits for this answer. The bus is heard meanwhile: the board writes
    /// byte by byte, a socket holds some 300 of such writes, and a board that cannot write stands still.
    fn tell(&mut self, line: &str, answer: &str) {
        let told = writeln!(self.hand, "{line}");
        told.expect("the second line");
        let began = Instant::now();
        let mut said = Vec::new();
        while !said.ends_with(b"\n") {
            assert!(began.elapsed() < PATIENCE, "{line}: no answer");
            let sockets = [self.hand.as_fd(), self.board.as_fd()];
            let mut both = sockets.map(|socket| PollFd::new(socket, PollFlags::POLLIN));
            poll(&mut both, PollTimeout::from(100_u8)).expect("a wait");
            self.hear_board();
            let mut byte = [0];
            if let Ok(1) = self.hand.read(&mut byte) {
                said.push(byte[0]);
            }
        }
        let said = String::from_utf8_lossy(&said);
        assert_eq!(said.trim_end(), answer, "{line}");
    }
}

impl Drop for Named {
    fn drop(&mut self) {
        for socket in &self.sockets {
            let _ = std::fs::remove_file(socket);
        }
    }
}

impl Handled for Named {
    fn contacts(&self) -> Contacts {
        self.contacts
    }

    fn touch(&mut self, contacts: Contacts) {
        let pressed = |pressed| if pressed { "press" } else { "release" };
        self.contacts = contacts;
        let door = match contacts.door {
            Door::Open => "door open",
            Door::Close => "door close",
        };
        self.tell(door, "ok");
        self.tell(&format!("estop {}", pressed(contacts.estop)), "ok");
        self.tell(&format!("hold {}", pressed(contacts.hold)), "ok");
    }

    fn has_door(&self) -> bool {
        true
    }

    fn set_input(&mut self, input: Contact, _: Option<bool>) {
        panic!("nobody sets input {} of this machine", input.number());
    }

    fn turn_wheel(&mut self, _: i32) {
        panic!("this machine has no handwheel of its own");
    }

    fn spoil_turret(&mut self, _: TurretFault) {
        panic!("this machine has no turret");
    }

    fn spoil(&mut self, _: &Request) -> bool {
        false
    }

    /// The board starts anew, with its end of the line closed.
    fn power(&mut self, to: Power) -> Outcome {
        if to != Power::Cycle {
            let words = "the power of this machine goes and comes";
            return Err(Failure::Usage(Both::same(words.to_owned())));
        }
        self.tell("power cycle", "up");
        self.open();
        self.set_speed(self.speed);
        Ok(())
    }

    fn set_speed(&mut self, speed: Speed) {
        self.speed = speed;
        self.tell(&format!("speed {}", speed.thousandths()), "ok");
    }

    fn end(&mut self) {
        self.ends = true;
    }

    /// What only the board knows is left out.
    fn view(&self) -> View {
        let (clients, dropped) = self.bus.counts();
        View {
            name: self.name.to_string(),
            pid: std::process::id(),
            node: 1,
            power: true,
            door: self.contacts.door,
            estop: self.contacts.estop,
            hold: self.contacts.hold,
            inputs: Vec::new(),
            outputs: Vec::new(),
            speed: self.speed.thousandths(),
            tick_us: 1000,
            ticks: 0,
            slips: 0,
            lost_ticks: 0,
            clients,
            dropped,
            outdated: false,
        }
    }
}
