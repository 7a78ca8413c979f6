//! The master of one drive. The master brings its drive to operation enabled and supervises it there.
//!
//! Terms. *Enabled* means operation enabled: the drive has torque and follows its target. *Contact* is the first status
//! of a drive that has just been started. *Demand* is the position that the board wants. The demand reaches the drive
//! only while the drive is enabled. In every other phase the target is the drive's own actual position: the drive has
//! no distance to jump when torque comes. The master holds an enabled drive at that position until a demand equals it
//! (to the nanometre). From then on the drive follows. A demand left over from before the enabling never moves the
//! drive.
//!
//! ```text
//! offline ─enable─► contact ─► (release) ─► shutdown 0006h ─► switch on 0007h ─► enable operation 000Fh ─► enabled
//!                   NMT start   quick stop                                                                  │
//!                               only                      standby 0006h ◄── disable, fault, loss ───────────┘
//! ```
//!
//! A drive that homes by itself leaves position mode and comes back to it: see `home`. It is enabled only in position mode
//! (6061h = 8), whatever it was doing when the board came up. Where a drive gets its setpoints in mode 7, that is its
//! position mode, and once it is enabled its controlword is 001Fh: without bit 4 it follows nothing.
//!
//! Each step has the same time limit. A step that takes longer is a [`DriveFailure`] with the step and the statusword.
//! A failure is latched until [`DriveMaster::reset`]; no drive is enabled again by itself. A fault or a loss of
//! operation enabled ends the commands at once, because such a drive follows no target. A following error or silence
//! does not end them: the drive may still follow, and the board brakes all axes together before it disables them. A
//! silent drive, whatever failed before, is braked only within its reach: a distance from its last known position.
//! Beyond its reach the master sends quick stop (0002h), and the drive brakes by itself.

pub(super) mod config;
mod hear;
mod home;
#[cfg(test)]
mod tests;
mod tick;

pub use config::{DriveConfig, FollowingLimit, Phase, Step};
use home::Home;
pub use home::{HomeEnd, HomeLimits, HomeStep, Inputs};
pub use tick::DriveOutput;

use super::cia402::State;
use super::failure::DriveFailure;
use super::frame::{CobId, NodeId, Service};
use super::increments::Increments;
use super::pdo::DriveStatus;
use super::periods::Periods;
use crate::alarm::Alarm;

/// The master of one drive. Frames from the bus go into [`DriveMaster::receive`]; once in every SYNC period
/// [`DriveMaster::tick`] gives the frames to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveMaster {
    config: DriveConfig,
    /// The identifier of the drive's TPDO1.
    status_id: CobId,
    /// Increments in a nanometre: two positions that differ by no more count as equal. Kept here, because computing it
    /// takes a division.
    nanometre: u32,
    phase: Phase,
    failure: Option<DriveFailure>,
    /// Periods since the step began; while enabled, ticks for which demands have been refused.
    waited: Periods,
    /// A demand was equal to the target of the enabled drive, so the drive follows demands.
    follows: bool,
    /// Periods since the last status.
    quiet: Periods,
    /// The drive was given a target while it was silent.
    missed: bool,
    /// Periods for which the following error has been too large.
    astray: Periods,
    /// The last status.
    status: Option<DriveStatus>,
    /// Statuses in a row with the same position.
    same: u8,
    /// A status came after the step began.
    answered: bool,
    /// Error code of the last emergency message.
    error_code: u16,
    /// The target of the next RPDO1 unless a demand replaces it; while enabled, the target of the last RPDO1.
    target: Increments,
    /// The target of the RPDO1 before that.
    last_target: Increments,
    /// The NMT start is still to be sent.
    start: bool,
    /// Its mode and its homing.
    home: Home,
}

impl DriveMaster {
    /// A master that has sent nothing to its drive yet.
    #[must_use]
    pub const fn new(config: DriveConfig) -> Self {
        Self {
            config,
            status_id: CobId::of(Service::Tpdo1, config.node),
            nanometre: config.scale.limit(1),
            phase: Phase::Offline,
            failure: None,
            waited: Periods::new(0),
            follows: false,
            quiet: Periods::new(0),
            missed: false,
            astray: Periods::new(0),
            status: None,
            same: 0,
            answered: false,
            error_code: 0,
            target: Increments::new(0),
            last_target: Increments::new(0),
            start: false,
            home: Home::new(),
        }
    }

    /// Gives the drive another node number. Call this before the first frame to the drive.
    pub const fn set_node(&mut self, node: NodeId) {
        self.config.node = node;
        self.status_id = CobId::of(Service::Tpdo1, node);
    }

    /// Error code of the drive's emergency messages; 0 without an error.
    #[must_use]
    pub const fn error_code(&self) -> u16 {
        self.error_code
    }

    /// Takes over the error code from another master that has heard it. A drive sends an emergency message only once.
    pub const fn set_error_code(&mut self, code: u16) {
        self.error_code = code;
    }

    /// The configuration of this master.
    #[must_use]
    pub const fn config(&self) -> &DriveConfig {
        &self.config
    }

    /// The phase of the drive.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// True while the drive has torque and follows its target.
    #[must_use]
    pub const fn is_enabled(&self) -> bool {
        matches!(self.phase, Phase::Enabled)
    }

    /// True while the target of the drive is the demand, no more the place where it was found.
    #[must_use]
    pub const fn is_following(&self) -> bool {
        self.follows
    }

    /// True while the drive gets no RPDO: until its first status.
    #[must_use]
    pub const fn is_told_nothing(&self) -> bool {
        matches!(self.phase, Phase::Offline | Phase::Step(Step::Contact))
    }

    /// The latched failure, until [`DriveMaster::reset`].
    #[must_use]
    pub const fn failure(&self) -> Option<DriveFailure> {
        self.failure
    }

    /// The drive's last status.
    #[must_use]
    pub const fn status(&self) -> Option<DriveStatus> {
        self.status
    }

    /// The actual position of the last status, if it came since the tick before the last one.
    #[must_use]
    pub fn fresh(&self) -> Option<Increments> {
        let status = self.status.filter(|_| self.quiet == Periods::new(1))?;
        Some(status.actual)
    }

    /// The target of the drive: its actual position until it is enabled, then the last demand. A path starts here: its
    /// first demand is this position.
    #[must_use]
    pub const fn target(&self) -> Increments {
        self.target
    }

    /// Asks for operation enabled. A latched failure refuses it. Nothing changes for a drive that is enabled or on the
    /// way there.
    pub const fn enable(&mut self) -> Result<(), DriveFailure> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        if matches!(self.phase, Phase::Offline | Phase::Standby) {
            self.start = true;
            self.enter(Step::Contact);
        }
        Ok(())
    }

    /// Takes the torque away (0006h), also in the middle of enabling. The axis must stand, because this does not brake.
    pub const fn disable(&mut self) {
        match self.phase {
            Phase::Offline | Phase::Standby => {}
            Phase::Step(Step::Contact) => self.phase = Phase::Offline,
            Phase::Step(_) | Phase::Enabled | Phase::Homing(_) | Phase::Halted => {
                self.phase = Phase::Standby;
            }
        }
    }

    /// For drives that share one setpoint frame: a drive gets no command until it is its turn to be enabled. `goes` is
    /// true while the drive whose turn it is takes the step "enable operation". False, and a failure, where this drive
    /// is ready to switch on, or further, at that time: it has got no command, so it takes the other drive's command
    /// for its own.
    pub fn wait(&mut self, goes: bool) -> bool {
        match self.phase {
            Phase::Step(Step::FaultReset) | Phase::Enabled | Phase::Homing(_) | Phase::Halted => {
                return true;
            }
            Phase::Standby | Phase::Step(_) | Phase::Offline => self.phase = Phase::Offline,
        }
        match self.status {
            Some(DriveStatus { status, .. })
                if goes
                    && !self.is_silent()
                    && matches!(
                        status.state(),
                        Some(State::ReadyToSwitchOn | State::SwitchedOn | State::OperationEnabled)
                    ) =>
            {
                self.latch(DriveFailure::Overhears(status));
                false
            }
            _ => true,
        }
    }

    /// Clears a latched failure and, where the drive is in fault, resets the fault. Without a failure nothing happens.
    /// A reset never enables the drive; it disables a drive that was still enabled.
    pub const fn reset(&mut self) {
        let Some(failure) = self.failure else {
            return;
        };
        self.failure = None;
        self.error_code = 0;
        self.disable();
        match failure {
            DriveFailure::Fault { .. } | DriveFailure::Step(Step::FaultReset, _) => {
                self.enter(Step::FaultReset);
            }
            DriveFailure::Restarted | DriveFailure::NoAnswer => self.phase = Phase::Offline,
            _ => {}
        }
    }

    /// True where the last `times` statuses have the same position.
    #[must_use]
    pub const fn has_told_the_same(&self, times: u8) -> bool {
        self.same >= times
    }

    /// For a drive that has moved without a demand (a spindle that turned): its target is now its last reported
    /// position. The next demand must start there.
    pub const fn hold_here(&mut self) {
        if let Some(status) = self.status {
            self.target = status.actual;
            self.last_target = status.actual;
        }
        self.follows = false;
        self.waited = Periods::new(0);
    }

    /// For a spindle in speed mode: its position target does not count any more.
    pub(crate) const fn leave_position(&mut self) {
        self.follows = false;
        self.astray = Periods::new(0);
    }

    /// True while the drive sends no status, whatever has failed before.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.quiet.get() > self.config.silence.get()
    }

    const fn enter(&mut self, step: Step) {
        self.phase = Phase::Step(step);
        self.waited = Periods::new(0);
        self.answered = false;
    }

    #[cold]
    #[inline(never)]
    fn fail(&mut self, failure: DriveFailure, phase: Phase) {
        self.latch(failure);
        self.phase = phase;
    }

    /// The first failure is the cause; its consequences do not replace it.
    #[cold]
    #[inline(never)]
    fn latch(&mut self, failure: DriveFailure) {
        self.failure = self.failure.or(Some(failure));
    }

    /// True where a failure is latched.
    #[must_use]
    pub const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// The latched failure as an alarm with drive, node and figures.
    #[must_use]
    pub fn alarm(&self) -> Option<Alarm> {
        self.failure.map(|failure| failure.alarm(&self.config))
    }
}
