//! What the master does once in every SYNC period: it counts its times and makes the frames to send.
//!
//! This module reads no received frame; their content is already in the master.

use super::{DriveFailure, DriveMaster, Phase, Step};
use crate::bus::cia402::Controlword;
use crate::bus::frame::Frame;
use crate::bus::increments::Increments;
use crate::bus::nmt::NmtCommand;
use crate::bus::pdo::DriveCommand;
use crate::bus::periods::Periods;

/// The frames that a master sends, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveOutput {
    /// An NMT command.
    pub network: Option<Frame>,
    /// RPDO2: the mode, where it changes.
    pub mode: Option<Frame>,
    /// RPDO1.
    pub command: Option<Frame>,
}

impl DriveOutput {
    /// Gives the frames to `put`.
    #[inline]
    pub fn each(self, put: &mut impl FnMut(Frame)) {
        if let Some(network) = self.network {
            put(network);
        }
        if let Some(mode) = self.mode {
            put(mode);
        }
        if let Some(command) = self.command {
            put(command);
        }
    }
}

impl DriveMaster {
    /// Counts `more` periods that pass before the next [`tick`](Self::tick).
    pub fn skip(&mut self, more: Periods) {
        self.quiet = self.quiet.plus(more);
        if let Phase::Step(_) = self.phase {
            self.waited = self.waited.plus(more);
        }
    }

    /// One SYNC period: checks the times and gives the frames to send. `demand` is the position of the axis at the next
    /// SYNC; `None` holds the axis. Every demand holds it too, until the drive is enabled and a demand equals its
    /// target.
    pub fn tick(&mut self, demand: Option<Increments>) -> DriveOutput {
        match self.follow_on(demand) {
            Some(command) => DriveOutput {
                network: None,
                mode: None,
                command: Some(command),
            },
            None => self.tick_slowly(demand),
        }
    }

    /// The usual tick: the drive is enabled, not silent, within its following limit, and follows its demand. Gives the
    /// RPDO1 to send. For any other tick gives `None` and changes nothing; [`tick_slowly`](Self::tick_slowly) does that
    /// tick.
    #[inline]
    pub fn follow_on(&mut self, demand: Option<Increments>) -> Option<Frame> {
        let usual = self.phase == Phase::Enabled
            && (self.follows || demand.is_none())
            && self.quiet < self.config.silence
            && self.astray == Periods::new(0)
            && !self.start;
        if !usual {
            return None;
        }
        self.quiet = self.quiet.one_more();
        self.last_target = self.target;
        self.target = demand.unwrap_or(self.target);
        Some(self.command(self.config.streaming()))
    }

    #[inline]
    fn command(&self, control: Controlword) -> Frame {
        DriveCommand {
            control,
            target: self.target,
        }
        .frame(self.config.node)
    }

    /// A tick of any other kind.
    #[inline(never)]
    pub fn tick_slowly(&mut self, demand: Option<Increments>) -> DriveOutput {
        self.check_times();
        let command = core::mem::take(&mut self.start).then_some(NmtCommand::Start);
        let network = command.map(|command| command.frame(Some(self.config.node)));
        self.last_target = self.target;
        if let (Phase::Enabled, Some(demand)) = (self.phase, demand) {
            self.missed |= self.is_silent();
            if self.is_out_of_reach(demand) {
                self.phase = Phase::Halted;
            } else {
                self.follow(demand);
            }
        }
        let control = match self.phase {
            // A drive without a status has no known position to hold.
            Phase::Offline | Phase::Step(Step::Contact) => None,
            Phase::Step(Step::Release) => Some(Controlword::DISABLE_VOLTAGE),
            Phase::Standby | Phase::Step(Step::Shutdown) => Some(Controlword::SHUTDOWN),
            Phase::Halted => Some(Controlword::QUICK_STOP),
            Phase::Step(Step::SwitchOn) => Some(Controlword::SWITCH_ON),
            Phase::Step(Step::EnableOperation) => Some(Controlword::ENABLE_OPERATION),
            Phase::Enabled => Some(self.config.streaming()),
            // The fault-reset bit must rise, so the first controlword of this step has it low.
            Phase::Step(Step::FaultReset) if self.waited <= Periods::new(1) => {
                Some(Controlword::DISABLE_VOLTAGE)
            }
            Phase::Step(Step::FaultReset) => Some(Controlword::FAULT_RESET),
            Phase::Homing(step) => Some(self.homing_control(step)),
        };
        DriveOutput {
            network,
            mode: self.mode_frame(),
            command: control.map(|control| self.command(control)),
        }
    }

    fn follow(&mut self, demand: Increments) {
        if !self.follows {
            self.follows = demand.distance(self.target) <= self.nanometre;
        }
        if self.follows {
            self.target = demand;
            return;
        }
        self.waited = self.waited.one_more();
        if self.waited > self.config.step {
            self.latch(DriveFailure::Jump {
                target: self.target,
                demand,
            });
        }
    }

    fn check_times(&mut self) {
        self.quiet = self.quiet.one_more();
        match self.phase {
            Phase::Step(step) => {
                self.waited = self.waited.one_more();
                if self.waited > self.config.step {
                    self.step_failed(step);
                }
            }
            Phase::Enabled if self.is_silent() => {
                self.latch(DriveFailure::Silent);
            }
            Phase::Enabled if self.astray > Periods::new(0) => self.check_following(),
            Phase::Homing(step) => self.count_homing(step),
            Phase::Enabled | Phase::Standby | Phase::Offline | Phase::Halted => {}
        }
    }

    /// True where a silent drive may not get this setpoint. A silent drive may still hear, so the board brakes it with
    /// the others. Or it hears nothing and stands at its last known position: a setpoint that reaches it again must not
    /// make it leap. Therefore it gets no setpoint that is farther from that position than its reach.
    fn is_out_of_reach(&self, demand: Increments) -> bool {
        let Some(status) = self.status else {
            return false;
        };
        self.is_silent() && demand.turned(status.actual) > self.config.reach
    }

    fn check_following(&mut self) {
        let (Some(limit), Some(status)) = (self.config.following, self.status) else {
            return;
        };
        if self.astray > limit.time {
            let (target, actual) = (self.target, status.actual);
            self.latch(if limit.standing {
                DriveFailure::Stands { target, actual }
            } else {
                DriveFailure::Following { target, actual }
            });
        }
        self.astray = self.astray.one_more();
    }

    /// True while the drive, whose mode is ordered, has not reported its mode for setpoints.
    pub(super) const fn awaits_position_mode(&self) -> bool {
        self.config.homes.is_some() && !self.home.is_in(self.config.mode)
    }

    fn step_failed(&mut self, step: Step) {
        match self.status {
            Some(_) if step == Step::SwitchOn && self.awaits_position_mode() => {
                let told = self.home.mode;
                self.fail(DriveFailure::Mode(told), Phase::Standby);
            }
            Some(status) if self.answered => {
                self.fail(DriveFailure::Step(step, status.status), Phase::Standby);
            }
            _ => self.fail(DriveFailure::NoAnswer, Phase::Offline),
        }
    }
}
