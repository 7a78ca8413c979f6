//! The frames that a drive sends, and what its master does with them.
//!
//! This module sends nothing and knows no time; the tick does both.

use super::{DriveFailure, DriveMaster, Phase, Step};
use crate::bus::cia402::{State, Statusword};
use crate::bus::emcy::Emcy;
use crate::bus::frame::{Frame, Service};
use crate::bus::increments::Increments;
use crate::bus::nmt::NmtState;
use crate::bus::pdo::{AxisReport, DriveStatus};
use crate::bus::periods::Periods;

impl DriveMaster {
    /// Takes a frame from the bus. True if it came from this drive.
    pub fn receive(&mut self, frame: &Frame) -> bool {
        // The most frequent frame is tested first.
        if frame.id() == self.status_id {
            return DriveStatus::payload(frame)
                .map(|status| self.hear(status))
                .is_some();
        }
        let Some((service, node)) = frame.id().service() else {
            return false;
        };
        if node != self.config.node {
            return false;
        }
        match service {
            Service::Heartbeat => NmtState::decode(frame).map(|(_, state)| self.hear_state(state)),
            Service::Emcy => Emcy::decode(frame).map(|(_, emcy)| self.hear_error(emcy.code)),
            Service::Tpdo2 => AxisReport::payload(frame).map(|report| self.hear_report(report)),
            _ => None,
        }
        .is_some()
    }

    /// Keeps the error code of an emergency message. A drive may report a wrong PDO length for each frame, so that code
    /// does not replace another one, which may be the cause of a fault. Other errors with frames (8250h: none came in
    /// time) are causes.
    const fn hear_error(&mut self, code: u16) {
        self.home.lost |= Emcy::is_of_sensor(code);
        let of_length = matches!(code, Emcy::PDO_TOO_SHORT | Emcy::PDO_TOO_LONG);
        if self.error_code == 0 || !of_length {
            self.error_code = code;
        }
    }

    fn hear(&mut self, status: DriveStatus) {
        let stands = self.status.is_some_and(|last| last.actual == status.actual);
        if !stands {
            self.same = 1;
        } else if self.quiet != Periods::new(0) {
            // A repeated frame in the same period says nothing new.
            self.same = self.same.saturating_add(1);
        }
        self.status = Some(status);
        self.quiet = Periods::new(0);
        self.answered = true;
        if self.phase == Phase::Enabled && status.status.is_enabled() {
            self.measure(status.actual);
            return;
        }
        self.hear_on_the_way(status);
    }

    /// Takes the status of a drive that is not enabled, or not enabled any more.
    #[cold]
    #[inline(never)]
    fn hear_on_the_way(&mut self, status: DriveStatus) {
        let state = status.status.state();
        if let Phase::Homing(step) = self.phase {
            if self.hear_homing(step, status) {
                return;
            }
            self.target = status.actual;
        }
        if matches!(self.phase, Phase::Enabled | Phase::Homing(_)) {
            match state {
                Some(State::Fault | State::FaultReactionActive) => self.fault(status.status),
                _ => self.fail(DriveFailure::Lost(status.status), Phase::Standby),
            }
            return;
        }
        if let Phase::Step(step) = self.phase {
            self.advance(step, status.status, state);
        }
        // Until the drive is enabled, its target is its actual position. When it becomes enabled, it keeps the target
        // of that moment.
        if self.phase != Phase::Enabled {
            self.target = status.actual;
        }
    }

    fn advance(&mut self, step: Step, status: Statusword, state: Option<State>) {
        let in_fault = matches!(state, Some(State::Fault | State::FaultReactionActive));
        match (step, state) {
            (Step::FaultReset, Some(_)) if !in_fault => self.phase = Phase::Standby,
            (Step::FaultReset, _) => {}
            (_, Some(State::Fault)) => self.fault(status),
            (_, None | Some(State::NotReadyToSwitchOn | State::FaultReactionActive)) => {}
            (Step::Contact, Some(State::QuickStopActive)) => self.enter(Step::Release),
            (Step::Contact, Some(_)) => self.enter(Step::Shutdown),
            (Step::Release, Some(State::SwitchOnDisabled)) => self.enter(Step::Shutdown),
            (Step::Shutdown, Some(State::ReadyToSwitchOn)) => self.enter(Step::SwitchOn),
            // In another mode the drive would not follow its target.
            (Step::SwitchOn, Some(State::SwitchedOn)) if self.awaits_position_mode() => {}
            (Step::SwitchOn, Some(State::SwitchedOn)) => self.enter(Step::EnableOperation),
            (Step::EnableOperation, Some(State::OperationEnabled)) => {
                self.phase = Phase::Enabled;
                self.waited = Periods::new(0);
                self.follows = false;
                self.astray = Periods::new(0);
            }
            _ => {}
        }
    }

    /// Checks the following error. A status may arrive before or after the RPDO of its period is sent, so the nearer of
    /// the last two targets counts.
    fn measure(&mut self, actual: Increments) {
        if self.missed && !self.is_found(actual) {
            return;
        }
        let astray = self.config.following.is_some_and(|limit| {
            if limit.standing {
                // The spindle follows demands and has sent this position twice: it has another target and does not go
                // there.
                let far = |target| actual.turned(target) > limit.increments;
                self.follows
                    && self.has_told_the_same(2)
                    && far(self.target)
                    && far(self.last_target)
            } else {
                let distance = actual
                    .distance(self.target)
                    .min(actual.distance(self.last_target));
                distance > limit.increments
            }
        });
        if !astray {
            self.astray = Periods::new(0);
        } else if self.astray == Periods::new(0) {
            self.astray = Periods::new(1);
        }
    }

    /// Takes the first status after a silence. False, and the drive is disabled, where the drive has missed its
    /// targets: it would now set out for a target that is too far away.
    #[cold]
    #[inline(never)]
    fn is_found(&mut self, actual: Increments) -> bool {
        self.missed = false;
        let reach = self.config.reach;
        let found = [self.target, self.last_target]
            .into_iter()
            .any(|target| actual.turned(target) <= reach);
        if !found {
            self.phase = Phase::Standby;
        }
        found
    }

    fn hear_state(&mut self, state: NmtState) {
        if state != NmtState::BootUp {
            return;
        }
        self.home.lost = true;
        match self.phase {
            Phase::Offline => {}
            // The drive has booted only now, so it has not heard the first start.
            Phase::Step(Step::Contact) => self.start = true,
            Phase::Standby | Phase::Step(_) | Phase::Enabled | Phase::Homing(_) | Phase::Halted => {
                self.fail(DriveFailure::Restarted, Phase::Offline);
            }
        }
    }

    fn fault(&mut self, status: Statusword) {
        let code = self.error_code;
        self.fail(DriveFailure::Fault { status, code }, Phase::Standby);
    }
}
