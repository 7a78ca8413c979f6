//! The process that keeps a machine running: its two sockets, and one loop for all of it.
//!
//! One thread hears clients, answers `leadscrew sim`, and runs the ticks that are due. So each frame has its place in one
//! order, and a client that does not read delays nobody.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use leadscrew_can::{CanError, Desk, MachineName, Port};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::{Both, both};
use leadscrew_common::{diagnostics, interrupt, number};
use leadscrew_core::alarm::Lang;
use leadscrew_core::params;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;

use crate::bus::{Bus, WAITING};
use crate::clock::{Clock, Speed};
use crate::control::{Answer, Contact, LONGEST, Level, Power, Request, Turret, View};
use crate::machine::{Contacts, Machine};
use leadscrew_board_sim::TurretFault;

/// The longest wait for anything, so that an interruption is noticed.
const GLANCE: Duration = Duration::from_millis(50);

/// The shortest time between two reports of slipped time.
const TELL: Duration = Duration::from_secs(1);

/// Somebody who asks.
struct Caller {
    stream: UnixStream,
    text: Vec<u8>,
}

impl Caller {
    /// Takes what has come; false where nothing comes any more.
    fn hear(&mut self) -> bool {
        let mut bytes = [0; 1024];
        match self.stream.read(&mut bytes) {
            Ok(0) => false,
            Ok(count) => {
                self.text.extend(bytes.get(..count).unwrap_or_default());
                self.text.len() <= LONGEST
            }
            Err(error) => matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        }
    }

    /// The next whole line.
    fn line(&mut self) -> Option<Vec<u8>> {
        let end = self.text.iter().position(|byte| *byte == b'\n')?;
        Some(self.text.drain(..=end).collect())
    }

    /// Sends an answer; false where it is gone, or reads nothing.
    fn tell(&mut self, answer: &Answer) -> bool {
        let Ok(mut line) = serde_json::to_vec(answer) else {
            return false;
        };
        line.push(b'\n');
        // An answer has room in an empty socket.
        self.stream.write_all(&line).is_ok()
    }
}

/// A machine with its sockets.
pub struct Server {
    name: MachineName,
    machine: Machine,
    clock: Clock,
    ticks: u64,
    bus: Bus,
    callers: Vec<Caller>,
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
        let bind = |path: &PathBuf| {
            let failed = |error| {
                Failure::bus(CanError::System {
                    name: path.display().to_string(),
                    doing: "open",
                    error,
                })
            };
            match fs::remove_file(path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error)),
                _ => {}
            }
            let listener = UnixListener::bind(path).map_err(failed)?;
            listener.set_nonblocking(true).map_err(failed)?;
            Ok(listener)
        };
        let [bus, control] = &sockets;
        let now = Instant::now();
        Ok(Self {
            name: name.clone(),
            clock: Clock::new(machine.tick_length(), now),
            machine,
            ticks: 0,
            bus: Bus::default(),
            callers: Vec::new(),
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

    /// Machine time from now on.
    pub fn set_speed(&mut self, speed: Speed) {
        self.clock.set_speed(speed, Instant::now());
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
        let callers = self.callers.iter().map(|caller| caller.stream.as_fd());
        let doors = [self.listener.as_fd(), self.control.as_fd()];
        let others = doors.into_iter().chain(callers);
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
        while let Ok((stream, _)) = self.control.accept() {
            if stream.set_nonblocking(true).is_ok() {
                self.callers.push(Caller {
                    stream,
                    text: Vec::new(),
                });
            }
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
        for mut caller in std::mem::take(&mut self.callers) {
            let mut stays = caller.hear();
            while let Some(line) = caller.line() {
                let answer = match serde_json::from_slice(&line) {
                    Ok(request) => self.carry_out(&request),
                    Err(error) => {
                        let why = error.to_string();
                        Answer::refused(both!(
                            "this machine does not know the request ({why}): was it started by another version?",
                            "这台机床不认识该请求（{why}）：它是由其它版本启动的吗？"
                        ))
                    }
                };
                stays &= caller.tell(&answer);
            }
            if stays {
                self.callers.push(caller);
            }
        }
    }

    fn carry_out(&mut self, request: &Request) -> Answer {
        let contacts = self.machine.contacts();
        let mut note = None;
        let done = match *request {
            Request::Door { to } => {
                self.machine.touch(Contacts {
                    door: to,
                    ..contacts
                });
                if !self.machine.has_door() {
                    note = Some(both!(
                        "the board has no input for the door (parameter 9423 is 0): nothing follows from it",
                        "控制板没有门的输入（参数 9423 为 0）：不会产生任何作用"
                    ));
                }
                Ok(())
            }
            Request::Estop { to } => {
                self.machine.touch(Contacts {
                    estop: to == Contact::Press,
                    ..contacts
                });
                Ok(())
            }
            Request::Hold { to } => {
                self.machine.touch(Contacts {
                    hold: to == Contact::Press,
                    ..contacts
                });
                Ok(())
            }
            Request::Input { number, to } => {
                let Some(input) = params::Contact::new(number) else {
                    return Answer::refused(wrong_input(number));
                };
                let on = match to {
                    Level::On => Some(true),
                    Level::Off => Some(false),
                    Level::Auto => None,
                };
                self.machine.set_input(input, on);
                Ok(())
            }
            Request::Wheel { counts } => {
                self.machine.turn_wheel(counts);
                Ok(())
            }
            Request::Turret { to } => {
                self.machine.spoil_turret(match to {
                    Turret::Well => TurretFault::None,
                    Turret::Stuck => TurretFault::Stuck,
                    Turret::Slips => TurretFault::Slips,
                    Turret::Loose => TurretFault::Loose,
                });
                Ok(())
            }
            Request::Drive { which, to } => {
                self.machine.spoil_drive(which, to);
                Ok(())
            }
            Request::Spindle { percent } => {
                self.machine.spoil_spindle(percent);
                Ok(())
            }
            Request::Encoder { to } => {
                self.machine.spoil_encoder(to);
                Ok(())
            }
            Request::Bus { to } => {
                self.machine.spoil_bus(to);
                Ok(())
            }
            Request::Flash { to } => {
                self.machine.spoil_flash(to);
                Ok(())
            }
            Request::Power { to } => self.power(to),
            Request::Speed { thousandths } => match Speed::of_thousandths(thousandths) {
                Some(speed) => {
                    self.set_speed(speed);
                    Ok(())
                }
                None => return Answer::refused(wrong_speed()),
            },
            Request::State => Ok(()),
            Request::Down => {
                self.ends = true;
                Ok(())
            }
        };
        if let Err(failure) = done {
            let words = failure.words().unwrap_or_default();
            self.say(&words);
            return Answer::refused(words);
        }
        if *request != Request::State {
            let words = serde_json::to_string(request).unwrap_or_default();
            self.say(&Both::same(words));
        }
        Answer {
            ok: true,
            error: None,
            note: note.map(Into::into),
            machine: Some(self.view()),
        }
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

    /// The machine as it is.
    #[must_use]
    pub fn view(&self) -> View {
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

/// The contacts that are on, from 1 on.
fn numbers(on: u16) -> Vec<u8> {
    params::Contact::of_bits(on)
        .map(params::Contact::number)
        .collect()
}

/// The words for an input that does not exist.
fn wrong_input(number: u8) -> Both {
    both!(
        "there is no input {number}: they are counted from 1 to 16",
        "没有输入 {number}：编号为 1 至 16"
    )
}

/// The words for a speed that is refused.
#[must_use]
pub fn wrong_speed() -> Both {
    let [least, most] = Speed::RANGE;
    let factor = |thousandths: u32| number::text::<3>(thousandths.into());
    let (least, most) = (factor(least), factor(most));
    both!(
        "machine time runs at {least} to {most} times real time: beyond that the board would miss the heartbeats of \
         gateways",
        "机床时间可为真实时间的 {least} 至 {most} 倍：超出后控制板会丢失网关心跳"
    )
}
