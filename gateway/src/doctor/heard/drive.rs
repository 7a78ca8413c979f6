//! A drive by CiA 402: what it is told, what it answers, and what of that does not go together. All by PDOs.

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_can::{Packet, Stamp};
use leadscrew_core::bus::{DriveCommand, DriveStatus, Mode, State, Statusword};

use super::motion::{Motion, Way};
use crate::doctor::hits::Hits;

/// What a drive does just after it was enabled says nothing.
const SETTLED: Duration = Duration::from_millis(100);
/// A drive that goes without torque together with a fault or a boot-up this close has a reason.
const REASON: Duration = Duration::from_secs(1);
/// More counts than an axis can be from its target when it is enabled without a jump.
const JUMP: u32 = 100;
/// A target this many counts away moves a sound axis.
const FAR: u32 = 1000;

/// Statusword: voltage enabled, limit active, follows its target or homing attained, error in homing.
const VOLTAGE: u16 = 1 << 4;
const LIMITED: u16 = 1 << 11;
const FOLLOWS: u16 = 1 << 12;
const HOMING_ERROR: u16 = 1 << 13;

/// A following error that somebody has told.
#[derive(Clone, Debug)]
pub struct Following {
    /// What the axis did.
    pub way: Way,
    /// The sign, which lasts until the fault is reset.
    pub hits: Hits,
    /// Increments between target and actual position.
    pub distance: u32,
    /// Increments a period.
    pub speed: u32,
}

/// What was heard of a drive.
#[derive(Clone, Debug, Default)]
pub struct Drive {
    /// It is the drive of a spindle.
    spindle: bool,
    /// 9011.
    patience: Duration,
    /// The mode in which the board gives it setpoints: 8, or 7 (9076).
    streamed: u8,
    /// The last command, and when.
    pub command: Option<(Stamp, DriveCommand)>,
    /// Since when the controlword asks for what it asks for.
    asked: Option<(Stamp, u16)>,
    /// The mode that it was told, and when.
    pub mode: Option<(Stamp, u8)>,
    /// The last status, and when.
    pub status: Option<(Stamp, DriveStatus)>,
    enabled: Option<Stamp>,
    /// Statuses heard.
    pub statuses: u64,
    /// SYNCs between two statuses, how often.
    pub cadence: BTreeMap<u64, u64>,
    /// Counter of SYNC modulo the period of the statuses, how often.
    pub places: BTreeMap<u64, u64>,
    last_sync: Option<u64>,
    /// It tells another mode than it was told.
    pub other_mode: Hits,
    /// It tells the mode for setpoints that the board does not use for it.
    pub interpolated: Hits,
    /// Enabled in mode 8, it says that it does not follow.
    pub not_following: Hits,
    /// It stays without mains.
    pub no_mains: Hits,
    /// It stays ready to switch on.
    pub not_enabled: Hits,
    /// It went without torque by itself.
    pub torque_off: Hits,
    /// It is in fault.
    pub fault: Hits,
    /// Following errors.
    pub following: Vec<Following>,
    /// It stands while its target moves.
    pub stands: Hits,
    /// It is told a target elsewhere while it is being enabled.
    pub jump: Hits,
    /// It says that a limit is active.
    pub limited: Hits,
    /// It says that homing failed.
    pub homing_error: Hits,
    /// Homing was told, and ended unfinished.
    pub homing_unfinished: Hits,
    homing: Option<Homing>,
    /// When it last had a reason to go without torque.
    reason: Option<Stamp>,
    /// Where it stands, its target when it came there, and since when that is far off.
    stood: Option<(DriveStatus, i32, Option<Stamp>)>,
    /// Targets and positions.
    pub motion: Motion,
}

/// A homing under way.
#[derive(Clone, Copy, Debug)]
struct Homing {
    started: bool,
    found: bool,
}

impl Drive {
    /// Nothing was heard of it. `patience`: 9011; `streamed`: the mode in which the board gives it setpoints.
    #[must_use]
    pub fn new(spindle: bool, patience: Duration, streamed: Mode) -> Self {
        Self {
            spindle,
            patience,
            streamed: streamed as u8,
            ..Self::default()
        }
    }

    /// What it was told, in the period of this SYNC.
    pub fn told(&mut self, at: Stamp, command: DriveCommand, packet: &Packet) {
        let control = command.control.raw();
        if self
            .asked
            .is_none_or(|(_, asked)| asked & 0x9F != control & 0x9F)
        {
            self.asked = Some((at, control));
        }
        let waits = self
            .status
            .and_then(|(_, status)| status.status.state().map(|state| (state, status.actual)));
        // Enabled by this very command: from here on the target counts.
        if let Some((State::SwitchedOn | State::ReadyToSwitchOn, actual)) = waits
            && control & 0x0F == 0x0F
            && command.target.distance(actual) > JUMP
        {
            self.jump.hit(at, packet);
        }
        if let Some(homing) = &mut self.homing {
            homing.started |= control & 0x1F == 0x1F;
        }
        self.command = Some((at, command));
        self.motion.target(command.target.get());
    }

    /// The mode that it was told.
    pub fn told_mode(&mut self, at: Stamp, mode: u8, packet: &Packet) {
        if self.mode.is_none_or(|(_, last)| last != mode) {
            self.mode = Some((at, mode));
            self.motion.interrupt();
            if mode == Mode::Homing as u8 {
                self.homing = Some(Homing {
                    started: false,
                    found: false,
                });
            } else if let Some(homing) = self.homing.take()
                && homing.started
                && !homing.found
            {
                self.homing_unfinished.hit(at, packet);
            }
        }
    }

    /// The mode that it says it is in.
    pub fn tells_mode(&mut self, at: Stamp, mode: u8, packet: &Packet) {
        let (since, told) = self.mode.unwrap_or((at, self.streamed));
        if takes_setpoints(mode) && mode != self.streamed {
            self.interpolated.go_on(at, packet);
        } else {
            self.interpolated.end(at);
        }
        if mode != told && at.since(since) > self.patience && self.mode.is_some() {
            self.other_mode.go_on(at, packet);
        } else if mode == told {
            self.other_mode.end(at);
        }
    }

    /// It boots, or tells a fault: a reason to be without torque.
    pub fn has_reason(&mut self, at: Stamp) {
        self.reason = Some(at);
        if self
            .torque_off
            .last
            .is_some_and(|last| self.torque_off.lasts() && at.since(last) < REASON)
        {
            self.torque_off = Hits::default();
        }
    }

    /// A homing that the board says was cancelled by hand is no failure.
    pub fn cancelled(&mut self) {
        self.homing = None;
        self.homing_unfinished = Hits::default();
    }

    /// A status of it, behind the SYNC of this number with this counter.
    pub fn answers(
        &mut self,
        at: Stamp,
        status: DriveStatus,
        sync: (u64, Option<u8>),
        every: u64,
        packet: &Packet,
    ) {
        let word = status.status;
        let before = self
            .status
            .replace((at, status))
            .and_then(|(_, status)| status.status.state());
        self.statuses += 1;
        let (number, counter) = sync;
        if let Some(last) = self.last_sync.replace(number)
            && number > last
        {
            *self.cadence.entry(number - last).or_default() += 1;
        }
        if let Some(counter) = counter {
            let place = u64::from(counter) % every.max(1);
            *self.places.entry(place).or_default() += 1;
        }
        self.state(at, word, before, packet);
        if let Some(homing) = &mut self.homing {
            homing.found |= homing.started && word.raw() & FOLLOWS != 0;
            if homing.started && word.raw() & HOMING_ERROR != 0 {
                self.homing_error.go_on(at, packet);
            }
        } else {
            self.homing_error.end(at);
        }
        if self.moves_by_targets() && self.settled(at) {
            self.enabled_status(at, status, packet);
        } else {
            self.motion.interrupt();
            self.stood = None;
            for hits in [&mut self.not_following, &mut self.limited] {
                hits.end(at);
            }
        }
    }

    fn state(&mut self, at: Stamp, word: Statusword, before: Option<State>, packet: &Packet) {
        let state = word.state();
        let (since, control) = self.asked.unwrap_or((at, 0));
        let asked_long = at.since(since) > SETTLED;
        if state == Some(State::OperationEnabled) {
            self.enabled.get_or_insert(at);
        } else {
            self.enabled = None;
        }
        if matches!(state, Some(State::Fault | State::FaultReactionActive)) {
            self.reason = Some(at);
            self.fault.go_on(at, packet);
        } else {
            self.fault.end(at);
        }
        let disabled = state == Some(State::SwitchOnDisabled);
        let shut_down = matches!(control & 0x87, 0x06 | 0x07);
        if disabled && word.raw() & VOLTAGE == 0 && shut_down && asked_long {
            self.no_mains.go_on(at, packet);
        } else if !disabled || word.raw() & VOLTAGE != 0 {
            // It got its mains after all.
            self.no_mains = Hits::default();
        }
        let switch_on = control & 0x87 == 0x07;
        if state == Some(State::ReadyToSwitchOn) && switch_on && asked_long {
            self.not_enabled.go_on(at, packet);
        } else if matches!(state, Some(State::SwitchedOn | State::OperationEnabled)) {
            self.not_enabled = Hits::default();
        }
        let reason = self.reason.is_some_and(|reason| at.since(reason) < REASON);
        let told_on = control & 0x0F == 0x0F;
        if before == Some(State::OperationEnabled) && disabled && told_on && !reason {
            self.torque_off.begin(at, packet);
        } else if self.torque_off.lasts() {
            match state {
                Some(State::SwitchOnDisabled) => self.torque_off.hit(at, packet),
                _ => self.torque_off.end(at),
            }
        }
    }

    fn settled(&self, at: Stamp) -> bool {
        self.enabled.is_some_and(|since| at.since(since) >= SETTLED)
    }

    /// It goes where its target is: in the mode for setpoints, which an axis is in where nobody says otherwise.
    fn moves_by_targets(&self) -> bool {
        match self.mode {
            Some((_, mode)) => mode == self.streamed,
            None => !self.spindle,
        }
    }

    fn enabled_status(&mut self, at: Stamp, status: DriveStatus, packet: &Packet) {
        let word = status.status.raw();
        let settled_in_mode = self
            .mode
            .is_none_or(|(since, _)| at.since(since) >= SETTLED);
        if word & FOLLOWS == 0 && settled_in_mode {
            self.not_following.go_on(at, packet);
        } else {
            self.not_following.end(at);
        }
        if word & LIMITED != 0 {
            self.limited.go_on(at, packet);
        } else {
            self.limited.end(at);
        }
        let Some((_, command)) = self.command else {
            return;
        };
        self.motion.sample(status.actual.get());
        let target = command.target.get();
        match &mut self.stood {
            Some((from, at_first, far)) if from.actual.distance(status.actual) <= 2 => {
                let away = command.target.distance(from.actual);
                if away < FAR || target.abs_diff(*at_first) < FAR {
                    *far = None;
                } else if at.since(*far.get_or_insert(at)) >= SETTLED {
                    self.stands.hit(at, packet);
                }
            }
            _ => self.stood = Some((status, target, None)),
        }
    }

    /// Somebody says that it cannot follow. `thread`: its board is on a helix.
    pub fn cannot_follow(&mut self, at: Stamp, thread: bool, packet: &Packet) {
        self.reason = Some(at);
        if self.following.last().is_some_and(|last| last.hits.lasts()) {
            return;
        }
        let (way, speed) = self.motion.way();
        let distance = match (self.command, self.status) {
            (Some((_, command)), Some((_, status))) => command.target.distance(status.actual),
            _ => 0,
        };
        let mut hits = Hits::default();
        hits.begin(at, packet);
        self.following.push(Following {
            way: match way {
                Way::Ramp | Way::Steady if thread => Way::Thread,
                way => way,
            },
            hits,
            distance,
            speed,
        });
    }

    /// The fault is over.
    pub fn follows_again(&mut self, at: Stamp) {
        if let Some(last) = self.following.last_mut() {
            last.hits.end(at);
        }
    }

    /// Nothing comes any more.
    pub fn close(&mut self, at: Stamp) {
        self.follows_again(at);
        for hits in [
            &mut self.other_mode,
            &mut self.interpolated,
            &mut self.not_following,
            &mut self.no_mains,
            &mut self.not_enabled,
            &mut self.torque_off,
            &mut self.fault,
            &mut self.limited,
            &mut self.homing_error,
        ] {
            hits.end(at);
        }
    }
}

/// In this mode a drive gets a setpoint with each SYNC.
pub const fn takes_setpoints(mode: u8) -> bool {
    mode == Mode::Interpolated as u8 || mode == Mode::Position as u8
}
