//! The process that keeps a machine running: its two sockets, and one loop for all of it.
//!
//! One thread hears clients, answers `leadscrew sim`, and runs the ticks that are due. So each frame has its place in one
//! order, and a client that does not read delays nobody.

use std::fs::{self, File};
use std::io;
use std::os::fd::AsFd as _;
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use leadscrew_can::{CanError, Desk, MachineName, Port};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::{Both, both};
use leadscrew_common::{diagnostics, interrupt};
use leadscrew_core::alarm::Lang;
use leadscrew_core::params;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;

use crate::bus::{Bus, WAITING};
use crate::callers::{Callers, bind};
use crate::clock::{Clock, Speed};
use crate::control::{Power, Request, View};
use crate::hand::{Contacts, Handled, carry_out, numbers};
use crate::machine::Machine;
use leadscrew_board_sim::TurretFault;

/// The longest wait for anything, so that an interruption is noticed.
const GLANCE: Duration = Duration::from_millis(50);

/// The shortest time between two reports of slipped time.
const TELL: Duration = Duration::from_secs(1);

/// A machine with its sockets.
pub struct Server {
    name: MachineName,
    machine: Machine,
    clock: Clock,
    ticks: u64,
    bus: Bus,
    callers: Callers,
    listener: UnixListener,
    control: UnixListener,
    sockets: [PathBuf; 2],
    began: Instant,
    lang: Lang,
    ends: bool,
    /// The time of the last report of slips, and how many had been reported then.
    slips_told: (Option<Instant>, u64),
    /// Held as long as the machine runs. It is dropped last.
    _claim: File,
}

impl Server {
    /// Opens the sockets of a machine whose name this process has claimed. Sockets that lie there are left over from a
    /// process that was killed.
    ///
    /// # Errors
    /// A socket cannot be made.
    pub fn open(
        desk: &Desk,
        name: &MachineName,
        claim: File,
        machine: Machine,
        lang: Lang,
    ) -> Outcome<Self> {
        let sockets = [Port::Bus, Port::Control].map(|port| desk.socket(name, port));
        let [bus, control] = &sockets;
        let now = Instant::now();
        Ok(Self {
            name: name.clone(),
            clock: Clock::new(machine.tick_length(), now),
            machine,
            ticks: 0,
            bus: Bus::default(),
            callers: Callers::default(),
            listener: bind(bus)?,
            control: bind(control)?,
            sockets,
            began: now,
            lang,
            ends: false,
            slips_told: (None, 0),
            _claim: claim,
        })
    }

    /// Runs until somebody ends it.
    ///
    /// # Errors
    /// The flash cannot be saved, or the system refuses to wait.
    pub fn run(&mut self) -> Outcome {
        self.say(&both!("running", "已运行"));
        while !self.ends && !interrupt::requested() {
            self.wait()?;
            self.accept();
            self.hear()?;
            self.answer_callers();
            for _ in 0..self.clock.due(Instant::now()) {
                self.tick()?;
            }
            for number in self.bus.flush() {
                self.say(&both!(
                    "client {number} is dropped: it did not read {WAITING} frames",
                    "客户端 {number} 已断开：有 {WAITING} 帧未读取"
                ));
            }
            self.tell_slips();
        }
        self.machine.switch_off()?;
        self.say(&both!("ended", "已结束"));
        Ok(())
    }

    /// Waits until something has come, or a tick is due.
    fn wait(&self) -> Outcome {
        let sockets = self.bus.sockets().map(|(socket, writes)| {
            let wanted = if writes {
                PollFlags::POLLIN | PollFlags::POLLOUT
            } else {
                PollFlags::POLLIN
            };
            PollFd::new(socket, wanted)
        });
        let doors = [self.listener.as_fd(), self.control.as_fd()];
        let others = doors.into_iter().chain(self.callers.sockets());
        let mut wanted: Vec<PollFd<'_>> = sockets
            .chain(others.map(|socket| PollFd::new(socket, PollFlags::POLLIN)))
            .collect();
        let left = self.clock.left(Instant::now()).min(GLANCE);
        match ppoll(&mut wanted, Some(TimeSpec::from_duration(left)), None) {
            Ok(_) | Err(Errno::EINTR) => Ok(()),
            Err(error) => Err(Failure::bus(CanError::System {
                name: format!("sim:{}", self.name),
                doing: "wait for",
                error: error.into(),
            })),
        }
    }

    fn accept(&mut self) {
        while let Ok((stream, _)) = self.listener.accept() {
            // A socket that cannot be used is closed.
            let _ = self.bus.join(stream);
        }
    }

    /// Time since the start, as the adapters' clock has it.
    fn ms(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX)
    }

    fn hear(&mut self) -> Outcome {
        let ms = self.ms();
        for (from, traffic) in self.bus.hear() {
            self.bus.tell(&traffic, Some(from), ms);
            let bus = &mut self.bus;
            self.machine
                .hear(&traffic, &mut |said| bus.tell(said, None, ms))?;
        }
        self.pass_on();
        Ok(())
    }

    fn tick(&mut self) -> Outcome {
        let (ms, bus) = (self.ms(), &mut self.bus);
        self.machine.tick(&mut |said| bus.tell(said, None, ms))?;
        self.ticks += 1;
        self.pass_on();
        Ok(())
    }

    /// Writes what the machine tells to the log.
    fn pass_on(&mut self) {
        for words in self.machine.told() {
            self.say(&words);
        }
    }

    fn answer_callers(&mut self) {
        let mut callers = std::mem::take(&mut self.callers);
        callers.welcome(&self.control);
        callers.answer(|request| {
            let answer = carry_out(self, request);
            if let Some(why) = &answer.error {
                self.say(&why.clone().into());
            } else if *request != Request::State {
                let words = serde_json::to_string(request).unwrap_or_default();
                self.say(&Both::same(words));
            }
            answer
        });
        self.callers = callers;
    }

    fn tell_slips(&mut self) {
        let (slips, lost) = self.clock.slips();
        let (last, told) = self.slips_told;
        if slips == told || last.is_some_and(|last| last.elapsed() < TELL) {
            return;
        }
        self.slips_told = (Some(Instant::now()), slips);
        self.say(&both!(
            "this computer was too slow: machine time has slipped {slips} times, {lost} ticks in all",
            "计算机太慢：机床时间已滞后 {slips} 次，共 {lost} 个周期"
        ));
    }

    /// Writes a line to the log.
    fn say(&self, words: &Both) {
        let at = self.began.elapsed();
        let (seconds, ms) = (at.as_secs(), at.subsec_millis());
        let words = words.get(self.lang);
        diagnostics::say(&format!("{seconds}.{ms:03} {words}\n"));
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        for path in &self.sockets {
            // A socket that is gone already need not be removed.
            let _: io::Result<()> = fs::remove_file(path);
        }
    }
}

impl Handled for Server {
    fn contacts(&self) -> Contacts {
        self.machine.contacts()
    }

    fn touch(&mut self, contacts: Contacts) {
        self.machine.touch(contacts);
    }

    fn has_door(&self) -> bool {
        self.machine.has_door()
    }

    fn set_input(&mut self, input: params::Contact, on: Option<bool>) {
        self.machine.set_input(input, on);
    }

    fn turn_wheel(&mut self, counts: i32) {
        self.machine.turn_wheel(counts);
    }

    fn spoil_turret(&mut self, fault: TurretFault) {
        self.machine.spoil_turret(fault);
    }

    fn spoil(&mut self, request: &Request) -> bool {
        match *request {
            Request::Block { to } => self.machine.spoil_block(to),
            Request::Drive { which, to } => self.machine.spoil_drive(which, to),
            Request::Spindle { percent } => self.machine.spoil_spindle(percent),
            Request::Encoder { to } => self.machine.spoil_encoder(to),
            Request::Bus { to } => self.machine.spoil_bus(to),
            Request::Flash { to } => self.machine.spoil_flash(to),
            _ => return false,
        }
        true
    }

    fn power(&mut self, to: Power) -> Outcome {
        if to != Power::On {
            self.machine.switch_off()?;
        }
        if to != Power::Off {
            self.machine.switch_on()?;
            let tick = self.machine.tick_length();
            self.clock.set_tick(tick, Instant::now());
        }
        Ok(())
    }

    fn set_speed(&mut self, speed: Speed) {
        self.clock.set_speed(speed, Instant::now());
    }

    fn end(&mut self) {
        self.ends = true;
    }

    fn view(&self) -> View {
        let contacts = self.machine.contacts();
        let (slips, lost_ticks) = self.clock.slips();
        let (clients, dropped) = self.bus.counts();
        let tick_us = self.machine.tick_length().as_micros();
        let [inputs, outputs] = self.machine.on().map(numbers);
        View {
            name: self.name.to_string(),
            pid: std::process::id(),
            node: self.machine.node().get(),
            power: self.machine.has_power(),
            door: contacts.door,
            estop: contacts.estop,
            hold: contacts.hold,
            inputs,
            outputs,
            speed: self.clock.speed().thousandths(),
            tick_us: u32::try_from(tick_us).unwrap_or(u32::MAX),
            ticks: self.ticks,
            slips,
            lost_ticks,
            clients,
            dropped,
            outdated: self.machine.is_outdated(),
        }
    }
}
