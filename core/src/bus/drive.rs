//! The master of one drive: brings it to operation enabled and watches it while it is there.
//!
//! Terms. *Enabled* means operation enabled: the drive has torque and follows its target. *Contact* is the first status
//! of a drive that has just been started. *Demand* is the position the board wants; it reaches the drive only while it is
//! enabled. In every other phase the target is the drive's own actual position, so that there is nothing to jump to at
//! the moment torque comes. An enabled drive is held there until a demand takes it up at that very place (to the nanometre),
//! and follows from then on; demands left over from before it was enabled never move it.
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

use super::cia402::{Controlword, State, Statusword};
use super::emcy::Emcy;
use super::failure::DriveFailure;
use super::frame::{CobId, Frame, NodeId, Service};
use super::increments::{Increments, Scale};
use super::nmt::{NmtCommand, NmtState};
use super::pdo::{DriveCommand, DriveStatus};
use super::periods::Periods;
use crate::alarm::Alarm;

/// Periods after which a drive that is stopped is told so again: the frame may have been lost.
const STOPPED_AGAIN: Periods = Periods::new(15);

/// What there is to know about a drive beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveConfig {
    /// Letter of the axis in messages: `b'X'`, `b'Z'`, `b'C'`, `b'S'` for a spindle.
    pub letter: u8,
    /// Its node.
    pub node: NodeId,
    /// Its increments; used here only to put positions into messages.
    pub scale: Scale,
    /// Time for each step of enabling, and for a fault reset.
    pub step: Periods,
    /// Time without a status after which an enabled drive counts as lost.
    pub silence: Periods,
    /// Following error; `None` for a drive that is not in position mode.
    pub following: Option<FollowingLimit>,
    /// How far from where it was last heard a silent drive may still be told to be, in increments. Counts in position mode.
    pub reach: u32,
}

/// How far an enabled drive may be from its target, and for how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FollowingLimit {
    /// The largest distance, in increments.
    pub increments: u32,
    /// How long a greater one is tolerated.
    pub time: Periods,
}

/// A step on the way to operation enabled, or out of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// NMT start; waits for a status that shows the drive initialised.
    Contact,
    /// 0000h out of quick stop; waits for switch on disabled.
    Release,
    /// 0006h; waits for ready to switch on.
    Shutdown,
    /// 0007h; waits for switched on.
    SwitchOn,
    /// 000Fh; waits for operation enabled.
    EnableOperation,
    /// 0080h; waits for the fault to be gone.
    FaultReset,
}

/// Where the master is with its drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Not started: nothing is sent.
    Offline,
    /// Started and without torque.
    Standby,
    /// On the way.
    Step(Step),
    /// Operation enabled.
    Enabled,
    /// It is silent, and far from where it was last heard: if it hears anything, it is to stop by itself.
    Halted,
    /// It is told by network management to stop, again and again, and nothing else: it latches nothing, and what it does then
    /// is its own affair (6007h).
    Stopped,
}

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

/// The master of one drive. Frames from the bus go into [`DriveMaster::receive`]; once in every SYNC period
/// [`DriveMaster::tick`] gives the frames to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveMaster {
    config: DriveConfig,
    /// The identifier of its statuses.
    status_id: CobId,
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

    /// True where no RPDO goes to it: before it has answered for the first time, and where it is stopped.
    #[must_use]
    pub const fn is_told_nothing(&self) -> bool {
        matches!(
            self.phase,
            Phase::Offline | Phase::Step(Step::Contact) | Phase::Stopped
        )
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
        if matches!(self.phase, Phase::Offline | Phase::Standby | Phase::Stopped) {
            self.start = true;
            self.enter(Step::Contact);
        }
        Ok(())
    }

    /// Takes the torque away (0006h), also in the middle of enabling. The axis must stand: this does not brake.
    pub const fn disable(&mut self) {
        match self.phase {
            Phase::Offline | Phase::Standby | Phase::Stopped => {}
            Phase::Step(Step::Contact) => self.phase = Phase::Offline,
            Phase::Step(_) | Phase::Enabled | Phase::Halted => self.phase = Phase::Standby,
        }
    }

    /// Nothing that it is told by RPDO counts any more, for want of a SYNC: it is stopped by network management, until it is
    /// enabled again. One that has not been started is told nothing.
    pub const fn stop(&mut self) {
        if !matches!(self.phase, Phase::Offline) {
            self.phase = Phase::Stopped;
            self.start = false;
            self.waited = STOPPED_AGAIN;
        }
    }

    /// For drives that are told in one frame: until its turn to be enabled comes it is told nothing. False, and a failure, where
    /// one that is told nothing has got ready although another `goes`, that is, has got as far: it takes what that one is told
    /// for its own.
    #[cfg(feature = "fd")]
    pub(crate) fn wait(&mut self, goes: bool) -> bool {
        match self.phase {
            Phase::Step(Step::FaultReset) | Phase::Enabled | Phase::Halted | Phase::Stopped => {
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
                // Stopped it would not hear of it.
                self.start = matches!(self.phase, Phase::Stopped);
                self.enter(Step::FaultReset);
            }
            DriveFailure::Restarted | DriveFailure::NoAnswer => self.phase = Phase::Offline,
            _ => {}
        }
    }

    /// Takes a frame from the bus. True if it came from this drive.
    pub fn receive(&mut self, frame: &Frame) -> bool {
        // What comes all the time comes first.
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
            Service::Emcy => Emcy::decode(frame).map(|(_, emcy)| self.error_code = emcy.code),
            _ => None,
        }
        .is_some()
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

    /// `more` further periods go by before the next [`tick`](Self::tick): its times count them, too.
    pub fn skip(&mut self, more: Periods) {
        self.quiet = self.quiet.plus(more);
        if let Phase::Step(_) = self.phase {
            self.waited = self.waited.plus(more);
        }
    }

    fn hear(&mut self, status: DriveStatus) {
        let stands = self.status.is_some_and(|last| last.actual == status.actual);
        if !stands {
            self.same = 1;
        } else if self.quiet != Periods::new(0) {
            // A frame that comes twice says nothing new.
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

    /// The status of a drive that is not enabled, or not any more.
    #[cold]
    #[inline(never)]
    fn hear_on_the_way(&mut self, status: DriveStatus) {
        let state = status.status.state();
        if self.phase == Phase::Enabled {
            match state {
                Some(State::Fault | State::FaultReactionActive) => self.fault(status.status),
                _ => self.fail(DriveFailure::Lost(status.status), Phase::Standby),
            }
            return;
        }
        if let Phase::Step(step) = self.phase {
            self.advance(step, status.status, state);
        }
        // Until the drive is enabled its target is where it is. At the very moment it is, its target is what it was
        // enabled with, and stays.
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

    /// A status may be heard before or after the RPDO of its period is sent: the nearer of the last two targets counts.
    fn measure(&mut self, actual: Increments) {
        if self.missed && !self.is_found(actual) {
            return;
        }
        let distance = actual
            .distance(self.target)
            .min(actual.distance(self.last_target));
        let astray = self
            .config
            .following
            .is_some_and(|limit| distance > limit.increments);
        if !astray {
            self.astray = Periods::new(0);
        } else if self.astray == Periods::new(0) {
            self.astray = Periods::new(1);
        }
    }

    /// The first status behind a silence. False where the drive has not heard where it was to be, and would set out to be
    /// there now.
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
        match self.phase {
            Phase::Offline | Phase::Stopped => {}
            // It came up only now: it has not heard the first start.
            Phase::Step(Step::Contact) => self.start = true,
            Phase::Standby | Phase::Step(_) | Phase::Enabled | Phase::Halted => {
                self.fail(DriveFailure::Restarted, Phase::Offline);
            }
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
        let command = match self.phase {
            Phase::Stopped if self.waited == Periods::new(0) => Some(NmtCommand::Stop),
            _ => core::mem::take(&mut self.start).then_some(NmtCommand::Start),
        };
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
            Phase::Offline | Phase::Step(Step::Contact) | Phase::Stopped => None,
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
            // Where increments are finer than nanometres, the same nanometre may be another increment. A division, which
            // is over with once the drive follows.
            let one_nanometre = self.config.scale.limit(1);
            self.follows = demand.distance(self.target) <= one_nanometre;
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
            Phase::Stopped if self.waited < STOPPED_AGAIN => self.waited = self.waited.one_more(),
            Phase::Stopped => self.waited = Periods::new(0),
            Phase::Enabled | Phase::Standby | Phase::Offline | Phase::Halted => {}
        }
    }

    /// True while no status comes, whatever has failed before.
    #[must_use]
    pub(crate) const fn is_silent(&self) -> bool {
        self.quiet.get() > self.config.silence.get()
    }

    /// One that is silent may hear, and is braked with the others; or it hears nothing and stands where it was. Then a
    /// setpoint that reaches it again must not be a leap: farther from where it was last heard than its reach, it gets none.
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
            self.latch(DriveFailure::Following {
                target: self.target,
                actual: status.actual,
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

    const fn enter(&mut self, step: Step) {
        self.phase = Phase::Step(step);
        self.waited = Periods::new(0);
        self.answered = false;
    }

    fn fault(&mut self, status: Statusword) {
        let code = self.error_code;
        self.fail(DriveFailure::Fault { status, code }, Phase::Standby);
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

#[cfg(test)]
mod tests;
