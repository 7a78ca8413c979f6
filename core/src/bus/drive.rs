//! The master of one drive: brings it to operation enabled and watches it while it is there.
//!
//! Terms. *Enabled* means operation enabled: the drive has torque and follows its target. *Contact* is the first status
//! of a drive that has just been started. *Demand* is the position the board wants; it reaches the drive only while it is
//! enabled. In every other phase the target is the drive's own actual position, so that there is nothing to jump to at
//! the moment torque comes. An enabled drive is held there until a demand takes it up at that very place (to the
//! nanometre), and follows from then on; demands left over from before it was enabled never move it.
//!
//! ```text
//! offline ─enable─► contact ─► (release) ─► shutdown 0006h ─► switch on 0007h ─► enable operation 000Fh ─► enabled
//!                   NMT start   quick stop                                                                  │
//!                               only                      standby 0006h ◄── disable, fault, loss ───────────┘
//! ```
//!
//! Each step has the same time; what does not answer within it is a [`DriveFailure`] that names the step and the
//! statusword. A failure is latched until [`DriveMaster::reset`]; nothing is enabled again by itself. A fault or a loss of
//! operation enabled ends the command at once, since there is nobody left to command. A following error or silence
//! does not: the drive may still follow, and the board brakes all axes together before it disables them. A silent one,
//! whatever failed before, only as far as its reach from where it was last heard; beyond that it is told to stop by itself
//! (0002h).

pub(super) mod config;
mod hear;
#[cfg(test)]
mod tests;
mod tick;

pub use config::{DriveConfig, FollowingLimit, Phase, Step};
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
    /// The identifier of its statuses.
    status_id: CobId,
    /// Increments to a nanometre: the same nanometre may be another increment. Known beforehand, for it is a division.
    nanometre: u32,
    phase: Phase,
    failure: Option<DriveFailure>,
    /// Periods since the step began; while enabled, ticks for which demands have been refused.
    waited: Periods,
    /// A demand has taken the enabled drive up where it stands.
    follows: bool,
    /// Periods since the last status.
    quiet: Periods,
    /// It was told where to be while it was silent.
    missed: bool,
    /// Periods for which the following error has been too great.
    astray: Periods,
    /// The last status.
    status: Option<DriveStatus>,
    /// Statuses in a row that tell the same position.
    same: u8,
    /// A status came after the step began.
    answered: bool,
    /// Error code of the last emergency message.
    error_code: u16,
    /// What the next RPDO1 says unless a demand replaces it; while enabled, what the last one said.
    target: Increments,
    /// What the RPDO1 before said.
    last_target: Increments,
    /// The NMT start is still to be sent.
    start: bool,
}

impl DriveMaster {
    /// A master that has not spoken to its drive yet.
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
        }
    }

    /// The same for a drive of another node; before anything is said to it.
    pub(crate) const fn set_node(&mut self, node: NodeId) {
        self.config.node = node;
        self.status_id = CobId::of(Service::Tpdo1, node);
    }

    /// What the drive's emergency messages have told; 0 where nothing is wrong.
    #[must_use]
    pub(crate) const fn error_code(&self) -> u16 {
        self.error_code
    }

    /// The same, where another master has heard it: no drive tells it twice.
    pub(crate) const fn set_error_code(&mut self, code: u16) {
        self.error_code = code;
    }

    /// What it was made with.
    #[must_use]
    pub const fn config(&self) -> &DriveConfig {
        &self.config
    }

    /// Where it is with its drive.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// True while the drive has torque and follows its target.
    #[must_use]
    pub const fn is_enabled(&self) -> bool {
        matches!(self.phase, Phase::Enabled)
    }

    /// True where no RPDO goes to it: before it has answered for the first time.
    #[must_use]
    pub const fn is_told_nothing(&self) -> bool {
        matches!(self.phase, Phase::Offline | Phase::Step(Step::Contact))
    }

    /// What went wrong, until [`DriveMaster::reset`].
    #[must_use]
    pub const fn failure(&self) -> Option<DriveFailure> {
        self.failure
    }

    /// The drive's last status.
    #[must_use]
    pub const fn status(&self) -> Option<DriveStatus> {
        self.status
    }

    /// Where the drive is told to be: its actual position until it is enabled, then the last demand. A path starts from
    /// here, and its first demand is this position.
    #[must_use]
    pub const fn target(&self) -> Increments {
        self.target
    }

    /// Asks for operation enabled. Refused, with the failure, while one is latched; already enabled or on the way,
    /// nothing changes.
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

    /// Takes the torque away (0006h), also in the middle of enabling. The axis must stand: this does not brake.
    pub const fn disable(&mut self) {
        match self.phase {
            Phase::Offline | Phase::Standby => {}
            Phase::Step(Step::Contact) => self.phase = Phase::Offline,
            Phase::Step(_) | Phase::Enabled | Phase::Halted => self.phase = Phase::Standby,
        }
    }

    /// For drives that are told in one frame: until its turn to be enabled comes it is told
    /// nothing. False, and a failure, where one that is told nothing has got ready although
    /// another `goes`, that is, has got as far: it takes what that one is told for its own.
    pub(crate) fn wait(&mut self, goes: bool) -> bool {
        match self.phase {
            Phase::Step(Step::FaultReset) | Phase::Enabled | Phase::Halted => {
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

    /// Forgets a latched failure and, where the drive is in fault, resets that. Without a failure nothing happens. The
    /// drive is not enabled by it; one that still was is disabled.
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

    /// True where the drive has told the same position `times` times in a row.
    #[must_use]
    pub const fn has_told_the_same(&self, times: u8) -> bool {
        self.same >= times
    }

    /// For a drive that has moved without a demand (a spindle that turned): its target is now where it was when it last
    /// told, and the next demand takes it up there.
    pub const fn hold_here(&mut self) {
        if let Some(status) = self.status {
            self.target = status.actual;
            self.last_target = status.actual;
        }
        self.follows = false;
        self.waited = Periods::new(0);
    }

    /// For a spindle in speed mode: where it was told to be does not count any more.
    pub(crate) const fn leave_position(&mut self) {
        self.follows = false;
        self.astray = Periods::new(0);
    }

    /// True while no status comes, whatever has failed before.
    #[must_use]
    pub(crate) const fn is_silent(&self) -> bool {
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

    /// The first failure is the cause; what follows from it does not replace it.
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

    /// The latched failure as an alarm that names drive, node and figures.
    #[must_use]
    pub fn alarm(&self) -> Option<Alarm> {
        self.failure.map(|failure| failure.alarm(&self.config))
    }
}
