//! Homing by the drive itself (CiA 402, mode 6), from rest in position mode back to rest in position mode: mode 8, or 7
//! for a drive that gets its setpoints in that one.
//!
//! ```text
//! enabled ─► to homing ─► running ─► leaving ─► to position ─► settling ─► enabled
//!            6060h = 6    001Fh      000Fh      6060h = 8, 7   two equal 6064h
//! ```
//!
//! From 001Fh on, until the drive is enabled again, its target is its last reported position: whatever the drive makes of
//! its count at the mark, it has no distance to jump when position mode comes back. A drive sets the statusword of a homing
//! late: for 100 ms bits of the homing before may stand, so a result counts only after bit 10 was 0, or after that time.
//! Knows one drive; which axis homes when, and where its mark is, is not for this module.

use super::{DriveFailure, DriveMaster, Phase, Step};
use crate::bus::cia402::{Controlword, HomingState, State, Statusword};
use crate::bus::frame::Frame;
use crate::bus::increments::Increments;
use crate::bus::pdo::{AxisMode, AxisReport, DriveStatus, Mode};
use crate::bus::periods::Periods;

/// Periods after which a mode that the drive does not report is sent again.
const REPEAT: u8 = 16;

/// Periods after a controlword in which a status may still be an answer to the one before.
const ANSWER: Periods = Periods::new(2);

/// Statuses in a row with the same position after which a drive stands.
const STANDS: u8 = 2;

/// Periods after which a drive that was to tell its inputs counts as not telling them: three of its reports, which come at
/// every 16th SYNC at least, are missing.
const UNTOLD: u8 = 48;

/// What a drive says of its inputs (60FDh).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inputs {
    /// Nothing yet.
    Awaited,
    /// Those that are on; bits 0 to 7.
    Told(u8),
    /// Nothing for so long that it counts as not telling them.
    Untold,
}

/// What a drive that homes by itself is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomeLimits {
    /// Time from its start to its end.
    pub time: Periods,
    /// Way from where it began, in increments.
    pub travel: u32,
    /// Time for which the result of an earlier homing may stand in the statusword.
    pub stale: Periods,
}

/// A step of a homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomeStep {
    /// 6060h = 6; waits for 6061h = 6.
    ToHoming,
    /// 001Fh; waits for the mark.
    Running,
    /// 000Fh, or 010Fh after an error; waits until the drive stands.
    Leaving,
    /// 6060h = 8 (7); waits for 6061h to be the same.
    ToPosition,
    /// Position mode; waits until the drive stands where it is told to be.
    Settling,
}

/// The result of a homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomeEnd {
    /// The drive has found its mark.
    Found,
    /// It has not found its mark within the time or the way.
    NotFound,
    /// It has been told to give up.
    Abandoned,
    /// It reports an error, or that it has not started.
    Error(Statusword),
    /// It stays in this mode (6061h) instead of homing.
    Mode(u8),
}

/// The state of homing in the master of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Home {
    /// 6061h as last reported; 0: not yet.
    pub mode: u8,
    /// 6060h as last sent; 0: not yet.
    told: u8,
    /// Periods since that.
    since: u8,
    /// Feed hold: the drive halts on its way (bit 8).
    halted: bool,
    /// Bit 10 was 0 after the start.
    fresh: bool,
    /// Periods of the step at which the drive was started, or let go on.
    started: Periods,
    /// Position at the start.
    origin: Increments,
    end: Option<HomeEnd>,
    /// 60FDh as last reported, bits 0 to 7.
    inputs: Option<u8>,
    /// Looks at them since the last report.
    looks: u8,
    /// The drive has been switched on, or its encoder has failed: its count does not go on.
    pub lost: bool,
}

impl Home {
    pub const fn new() -> Self {
        Self {
            mode: 0,
            told: 0,
            since: 0,
            halted: false,
            fresh: false,
            started: Periods::new(0),
            origin: Increments::new(0),
            end: None,
            inputs: None,
            looks: 0,
            lost: false,
        }
    }

    /// The drive has been switched on: it has forgotten its mode.
    pub const fn forget(&mut self) {
        (self.mode, self.told) = (0, 0);
    }

    /// True where the drive is known to be in this mode.
    pub const fn is_in(&self, mode: Mode) -> bool {
        self.mode == mode as u8
    }
}

impl DriveMaster {
    /// Begins to home. The axis stands. False, and nothing changes, where the drive is not enabled or does not home by
    /// itself.
    pub const fn begin_homing(&mut self) -> bool {
        if !self.is_enabled() || self.config.homes.is_none() {
            return false;
        }
        self.home.end = None;
        self.home.halted = false;
        self.go_home(HomeStep::ToHoming);
        true
    }

    /// Ends homing as soon as the drive stands. Nothing changes where it does not home.
    pub fn abandon_homing(&mut self) {
        match self.phase {
            Phase::Homing(HomeStep::ToHoming) => {
                self.end_homing(HomeEnd::Abandoned, HomeStep::ToPosition);
            }
            Phase::Homing(HomeStep::Running) => {
                self.end_homing(HomeEnd::Abandoned, HomeStep::Leaving);
            }
            _ => {}
        }
    }

    /// Feed hold: the drive halts on its way, and goes on without it.
    pub fn halt_homing(&mut self, halted: bool) {
        let home = &mut self.home;
        if home.halted && !halted {
            home.fresh = false;
            home.started = self.waited;
        }
        home.halted = halted;
    }

    /// True from the beginning of homing until the drive is enabled again, or has failed and stands. A drive that says
    /// nothing stands after the time of a step.
    #[must_use]
    pub const fn is_homing(&self) -> bool {
        match self.phase {
            Phase::Homing(_) => true,
            Phase::Halted => {
                let patience = self.config.silence.plus(self.config.step);
                self.same < STANDS && self.quiet.get() <= patience.get()
            }
            _ => false,
        }
    }

    /// The result of the last homing, as soon as it is known: the drive may still be on its way back to position mode.
    #[must_use]
    pub const fn home_end(&self) -> Option<HomeEnd> {
        self.home.end
    }

    /// Somebody is going to look at the drive's inputs: nothing that it has told before counts.
    pub const fn forget_inputs(&mut self) {
        (self.home.inputs, self.home.looks) = (None, 0);
    }

    /// What the drive says of its inputs. Look once in every period.
    pub const fn look_at_inputs(&mut self) -> Inputs {
        let home = &mut self.home;
        home.looks = home.looks.saturating_add(1);
        match home.inputs {
            _ if home.looks > UNTOLD => Inputs::Untold,
            Some(inputs) => Inputs::Told(inputs),
            None => Inputs::Awaited,
        }
    }

    /// What the drive has told of its inputs last, however long ago.
    #[must_use]
    pub const fn inputs_told(&self) -> Inputs {
        match self.home.inputs {
            Some(inputs) => Inputs::Told(inputs),
            None => Inputs::Awaited,
        }
    }

    /// True, once, after the drive has been switched on or its encoder has failed: its count does not go on.
    pub const fn takes_lost(&mut self) -> bool {
        core::mem::replace(&mut self.home.lost, false)
    }

    /// The same, without taking it.
    pub const fn has_lost(&self) -> bool {
        self.home.lost
    }

    /// Takes this over from another master of the same drive.
    pub const fn set_lost(&mut self, lost: bool) {
        self.home.lost = lost;
    }

    const fn go_home(&mut self, step: HomeStep) {
        self.phase = Phase::Homing(step);
        self.waited = Periods::new(0);
        self.same = 0;
    }

    fn end_homing(&mut self, end: HomeEnd, step: HomeStep) {
        // The first result is the cause.
        self.home.end = self.home.end.or(Some(end));
        self.go_home(step);
    }

    /// The controlword of a step.
    pub(super) const fn homing_control(&self, step: HomeStep) -> Controlword {
        match (step, self.home.end) {
            (HomeStep::Running, _) if self.home.halted => Controlword::HOME_HALTED,
            (HomeStep::Running, _) => Controlword::HOME,
            (HomeStep::Leaving, Some(HomeEnd::Error(_))) => Controlword::HALT,
            _ => Controlword::ENABLE_OPERATION,
        }
    }

    /// The mode to send in this period, if it is to be sent: on change, and again where the drive does not report it.
    pub(super) fn mode_frame(&mut self) -> Option<Frame> {
        self.config.homes?;
        let wanted = match self.phase {
            Phase::Homing(HomeStep::ToHoming | HomeStep::Running | HomeStep::Leaving) => {
                Mode::Homing
            }
            Phase::Offline | Phase::Step(Step::Contact) => {
                self.home.forget();
                return None;
            }
            _ => self.config.mode,
        };
        let home = &mut self.home;
        let raw = wanted as u8;
        let due = home.told != raw || home.mode != raw && home.since >= REPEAT;
        if !due {
            home.since = home.since.saturating_add(1);
            return None;
        }
        (home.told, home.since) = (raw, 0);
        Some(AxisMode(wanted).frame(self.config.node))
    }

    /// Counts the time of a step.
    pub(super) fn count_homing(&mut self, step: HomeStep) {
        self.waited = self.waited.one_more();
        let late = self.waited > self.config.step;
        match step {
            _ if self.is_silent() => self.halt(DriveFailure::Silent),
            HomeStep::Running => {
                let time = self
                    .config
                    .homes
                    .map_or(self.config.step, |homes| homes.time);
                if self.waited > time {
                    self.end_homing(HomeEnd::NotFound, HomeStep::Leaving);
                }
            }
            HomeStep::ToHoming if late => {
                self.end_homing(HomeEnd::Mode(self.home.mode), HomeStep::ToPosition);
            }
            HomeStep::ToPosition if late => {
                let told = self.home.mode;
                self.halt(DriveFailure::Mode(told));
            }
            HomeStep::Leaving | HomeStep::Settling if late => {
                let actual = self.status.map_or(self.target, |status| status.actual);
                let target = self.last_target;
                self.halt(DriveFailure::Moves { target, actual });
            }
            _ => {}
        }
    }

    /// A drive that may move by itself gets quick stop.
    fn halt(&mut self, failure: DriveFailure) {
        self.same = 0;
        self.fail(failure, Phase::Halted);
    }

    /// Takes mode and inputs from the drive.
    #[cold]
    #[inline(never)]
    pub(super) fn hear_report(&mut self, report: AxisReport) {
        self.home.mode = report.mode;
        let [inputs, ..] = report.inputs.to_le_bytes();
        (self.home.inputs, self.home.looks) = (Some(inputs), 0);
        let homing = report.mode == Mode::Homing as u8;
        match self.phase {
            Phase::Homing(HomeStep::ToHoming) if homing => {
                self.home.fresh = false;
                self.home.started = Periods::new(0);
                if let Some(status) = self.status {
                    self.home.origin = status.actual;
                    self.target = status.actual;
                }
                self.go_home(HomeStep::Running);
            }
            Phase::Homing(HomeStep::Running) if !homing => {
                self.end_homing(HomeEnd::Mode(report.mode), HomeStep::Leaving);
            }
            Phase::Homing(HomeStep::ToPosition) if self.home.is_in(self.config.mode) => {
                self.go_home(HomeStep::Settling);
            }
            _ => {}
        }
    }

    /// Takes the status of a drive that homes. False where it is not enabled any more.
    pub(super) fn hear_homing(&mut self, step: HomeStep, status: DriveStatus) -> bool {
        if status.status.state() != Some(State::OperationEnabled) {
            return false;
        }
        match step {
            HomeStep::ToHoming => return true,
            HomeStep::Running => self.hear_result(status),
            HomeStep::Leaving if self.same >= STANDS => self.go_home(HomeStep::ToPosition),
            HomeStep::Settling if self.same >= STANDS && self.target == status.actual => {
                self.phase = Phase::Enabled;
                self.waited = Periods::new(0);
                self.follows = false;
                self.astray = Periods::new(0);
            }
            HomeStep::Leaving | HomeStep::ToPosition | HomeStep::Settling => {}
        }
        self.target = status.actual;
        true
    }

    fn hear_result(&mut self, status: DriveStatus) {
        let Some(homes) = self.config.homes else {
            return;
        };
        let started = self.waited.minus(self.home.started);
        if started <= ANSWER {
            return;
        }
        let word = status.status;
        let state = word.homing();
        self.home.fresh |= matches!(state, HomingState::Runs | HomingState::Found);
        let late = started > homes.stale;
        let counts = self.home.fresh || late;
        match state {
            HomingState::Error if counts => {
                self.end_homing(HomeEnd::Error(word), HomeStep::Leaving);
            }
            HomingState::Done if counts && self.same >= STANDS => {
                self.end_homing(HomeEnd::Found, HomeStep::Leaving);
            }
            HomingState::NotStarted if late && !self.home.halted => {
                self.end_homing(HomeEnd::Error(word), HomeStep::Leaving);
            }
            HomingState::Runs | HomingState::NotStarted
                if status.actual.turned(self.home.origin) > homes.travel =>
            {
                self.end_homing(HomeEnd::NotFound, HomeStep::Leaving);
            }
            _ => {}
        }
    }
}
