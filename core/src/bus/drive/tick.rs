//! What the master does once in every SYNC period: its times go on, and the frames to send are made.
//!
//! Frames that come are not read here; what they told is in the master already.

use super::{DriveFailure, DriveMaster, Phase, Step};
use crate::bus::cia402::Controlword;
use crate::bus::frame::Frame;
use crate::bus::increments::Increments;
use crate::bus::nmt::NmtCommand;
use crate::bus::pdo::DriveCommand;
use crate::bus::periods::Periods;

/// The frames a master wants sent, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveOutput {
    /// An NMT command.
    pub network: Option<Frame>,
    /// RPDO1.
    pub command: Option<Frame>,
}

impl DriveOutput {
    /// Gives the frames to `put`.
    #[inline]
    pub(crate) fn each(self, put: &mut impl FnMut(Frame)) {
        if let Some(network) = self.network {
            put(network);
        }
        if let Some(command) = self.command {
            put(command);
        }
    }
}

impl DriveMaster {
    /// `more` further periods go by before the next [`tick`](Self::tick): its times count them, too.
    pub fn skip(&mut self, more: Periods) {
        self.quiet = self.quiet.plus(more);
        if let Phase::Step(_) = self.phase {
            self.waited = self.waited.plus(more);
        }
    }

    /// One SYNC period: checks the times and gives the frames to send. `demand` is where the axis is to be at the next
    /// SYNC; `None` holds it where it is, and so does every demand until the drive is enabled and taken up.
    pub fn tick(&mut self, demand: Option<Increments>) -> DriveOutput {
        match self.follow_on(demand) {
            Some(command) => DriveOutput {
                network: None,
                command: Some(command),
            },
            None => self.tick_slowly(demand),
        }
    }

    /// What nearly every tick is: enabled, heard lately, where it should be, on its way. The RPDO1 to send; `None`, and
    /// nothing changes, where it is not so: [`tick_slowly`](Self::tick_slowly) does the rest then.
    #[inline]
    pub(crate) fn follow_on(&mut self, demand: Option<Increments>) -> Option<Frame> {
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
        Some(self.command(Controlword::ENABLE_OPERATION))
    }

    fn command(&self, control: Controlword) -> Frame {
        DriveCommand {
            control,
            target: self.target,
        }
        .frame(self.config.node)
    }

    /// The other ticks.
    #[inline(never)]
    pub(crate) fn tick_slowly(&mut self, demand: Option<Increments>) -> DriveOutput {
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
            // A drive that has not answered has no position to be held at.
            Phase::Offline | Phase::Step(Step::Contact) => None,
            Phase::Step(Step::Release) => Some(Controlword::DISABLE_VOLTAGE),
            Phase::Standby | Phase::Step(Step::Shutdown) => Some(Controlword::SHUTDOWN),
            Phase::Halted => Some(Controlword::QUICK_STOP),
            Phase::Step(Step::SwitchOn) => Some(Controlword::SWITCH_ON),
            Phase::Step(Step::EnableOperation) | Phase::Enabled => {
                Some(Controlword::ENABLE_OPERATION)
            }
            // The bit must rise: the first word of this step has it low.
            Phase::Step(Step::FaultReset) if self.waited <= Periods::new(1) => {
                Some(Controlword::DISABLE_VOLTAGE)
            }
            Phase::Step(Step::FaultReset) => Some(Controlword::FAULT_RESET),
        };
        DriveOutput {
            network,
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
            Phase::Enabled | Phase::Standby | Phase::Offline | Phase::Halted => {}
        }
    }

    /// One that is silent may hear, and is braked with the others; or it hears nothing and stands where it was. Then a
    /// setpoint that reaches it again must not be a leap: farther from where it was
    /// last heard than its reach, it gets none.
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

    fn step_failed(&mut self, step: Step) {
        match self.status {
            Some(status) if self.answered => {
                self.fail(DriveFailure::Step(step, status.status), Phase::Standby);
            }
            _ => self.fail(DriveFailure::NoAnswer, Phase::Offline),
        }
    }
}
