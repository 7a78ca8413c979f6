//! A CiA 402 drive on the bus: an axis in cyclic synchronous position, or a spindle in cyclic synchronous velocity or
//! position. A spindle's drive changes its mode only while the spindle stands.
//!
//! An RPDO waits until SYNC latches it. At every SYNC the drive moves, and at every n-th it answers. Its settings can
//! be read and written by SDO.

use super::dictionary::{Commanded, Dictionary, Now, Settings, StopOption, TooShort};
use super::follower::Follower;
use super::homing::{Homing, HomingOptions};
use super::numbers::Transfer;
use super::power::Power;
use super::servo::{Following, Servo};
use leadscrew_core::bus::{
    AxisReport, BlockSize, CobId, DriveCommand, DriveStatus, Emcy, FdFrame, Frame, Increments,
    MilliRpm, Mode, NmtCommand, NmtState, NodeId, Periods, SdoServer, Service, Setpoints,
    SpindleCommand, Statusword,
};
use leadscrew_core::units::Length;

/// SYNC periods for which a client of the drive's SDO server may be silent.
const PATIENCE: Periods = Periods::new(1000);

/// Emergency for a PDO that is shorter than its mapping, by CiA 301.
const PDO_LENGTH: u16 = 0x8210;
/// Emergency for a PDO that is longer than its mapping, where a drive reports this.
const PDO_TOO_LONG: u16 = 0x8220;

/// The fault of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trouble {
    /// Nothing.
    #[default]
    None,
    /// It follows its targets, and sends nothing.
    Silent,
    /// Its cable is out: it receives nothing, stays at its last target, and sends nothing.
    CutOff,
    /// It works, and tells nothing of mode and inputs any more.
    Unreported,
    /// It gets targets, and does not move.
    Stuck,
    /// It goes into fault with this emergency error code and cannot be reset.
    Fault(u16),
    /// Safe torque off: it falls back to switch on disabled and stays there.
    TorqueOff,
    /// It comes no further than to this power state, whatever it is told.
    Held(Power),
    /// It stays in the mode that it has.
    KeepsMode,
}

impl Trouble {
    /// A fault: the drive is too hot.
    pub const HOT: Self = Self::Fault(0x4210);
}

/// The behaviour of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveOptions {
    /// It answers every n-th SYNC (transmission type 1–240; 0 counts as 1).
    pub transmission: u8,
    /// The number of SYNCs by which the first answer comes earlier (SYNC start value, 1800h:06). Drives with different
    /// values answer at different SYNCs, which spreads the load of the bus and of the board's tick.
    pub start: u8,
    /// SYNC periods that each change of its power state takes.
    pub settling: u16,
    /// Time constant of its following lag in SYNC periods.
    pub lag: u16,
    /// It reports each frame with its command that is longer than the mapping (8220h), as CiA 301 permits.
    pub tells_longer: bool,
}

impl Default for DriveOptions {
    /// Answers every 4th SYNC, changes state at once, follows without lag.
    fn default() -> Self {
        Self {
            transmission: 4,
            start: 0,
            settling: 0,
            lag: 0,
            tells_longer: false,
        }
    }
}

/// A drive.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    node: NodeId,
    options: DriveOptions,
    nmt: NmtState,
    power: Power,
    /// The last latched controlword.
    control: u16,
    command: Option<DriveCommand>,
    spindle: SpindleCommand,
    next_spindle: SpindleCommand,
    follower: Follower,
    /// An axis that is no ideal one: it moves instead of the follower.
    servo: Option<Servo>,
    /// A command has come since the last SYNC.
    fresh: bool,
    /// The drive fails by itself, with this emergency.
    failed: Option<u16>,
    /// The spindle turns: its drive cannot change the mode.
    turning: bool,
    /// The drive's count, less the place of the axis.
    shift: i64,
    /// 6061h of an axis, and SYNCs until 6060h becomes it.
    mode: u8,
    changing: u16,
    homing: Homing,
    /// The last TPDO2, and SYNCs since it.
    reported: Option<AxisReport>,
    since: u8,
    /// This is a spindle's drive, which has a second RPDO.
    of_spindle: bool,
    /// SYNCs since the last answer.
    syncs: u8,
    /// SYNCs until the power state may change again.
    busy: u16,
    trouble: Trouble,
    server: SdoServer,
    settings: Settings,
    /// The settings for the next start.
    kept: Settings,
    /// The value of the current SDO transfer.
    value: [u8; 4],
    /// The last frame with its command was too short.
    too_short: bool,
    /// The emergency about a frame's length that is still to be sent.
    tells_length: Option<u16>,
}

impl Drive {
    /// A drive that has just been switched on; its boot-up message goes out with the first SYNC.
    #[must_use]
    pub fn new(node: NodeId, options: DriveOptions, follower: Follower) -> Self {
        let standing = SpindleCommand {
            mode: Mode::Position,
            velocity: MilliRpm::STOPPED,
        };
        // 0 counts as 1.
        let transmission = match options.transmission {
            0 => 1,
            every => every,
        };
        let settings = Settings::new(node, transmission, options.start);
        Self {
            node,
            options,
            nmt: NmtState::BootUp,
            power: Power::NotReady,
            control: 0,
            command: None,
            spindle: standing,
            next_spindle: standing,
            follower,
            servo: None,
            fresh: false,
            failed: None,
            turning: false,
            shift: 0,
            mode: Mode::Position as u8,
            changing: 0,
            homing: Homing::new(HomingOptions::default()),
            reported: None,
            since: 0,
            of_spindle: false,
            syncs: 0,
            busy: 0,
            trouble: Trouble::None,
            server: SdoServer::new(node, PATIENCE, BlockSize::MAX),
            settings,
            kept: settings,
            value: [0; 4],
            too_short: false,
            tells_length: None,
        }
    }

    /// The drive as delivered for a machine with this tick: it interpolates over one tick.
    #[must_use]
    pub(super) const fn with_tick(mut self, tick_us: u32) -> Self {
        self.settings = self.settings.with_tick(tick_us);
        self.kept = self.settings;
        self
    }

    /// The drive set up for a machine whose setpoints all come in one frame of `board`; its own are at this place.
    #[must_use]
    pub(super) fn with_setpoints_of(mut self, board: NodeId, place: usize) -> Self {
        self.settings = self.settings.with_setpoints_of(board, place);
        self.kept = self.settings;
        self
    }

    /// The drive of an axis with a reference: it also takes its mode, and tells mode and inputs.
    #[must_use]
    pub(super) fn with_reference(mut self) -> Self {
        self.settings = self.settings.with_reference(self.node);
        self.kept = self.settings;
        self
    }

    /// The drive of an axis whose switch is one of its inputs: it tells mode and inputs.
    #[must_use]
    pub(super) fn with_inputs(mut self) -> Self {
        self.settings = self.settings.with_inputs(self.node);
        self.kept = self.settings;
        self
    }

    /// The drive of an axis that gets its setpoints in interpolated position.
    #[must_use]
    pub(super) fn interpolated(mut self) -> Self {
        self.settings = self.settings.interpolated();
        self.kept = self.settings;
        self.mode = self.settings.mode_wanted();
        self
    }

    /// The drive moves as this one does, and supervises its following error like this.
    #[must_use]
    pub(super) const fn with_servo(mut self, servo: Servo, following: Following) -> Self {
        self.servo = Some(servo);
        self.settings = self.settings.with_following(following);
        self.kept = self.settings;
        self
    }

    /// The drive of an axis that is at this place, whatever the drive counts.
    #[must_use]
    pub(super) fn at(mut self, place: Increments) -> Self {
        self.shift = self.count().wrapping_sub(i64::from(place.get()));
        self.homing.pass(self.place());
        self
    }

    /// Gives the axis switches and an index, and the drive what is odd about it.
    pub fn set_homing(&mut self, options: HomingOptions) {
        self.homing.options = options;
        self.homing.pass(self.place());
    }

    /// Sets 6098h, as a drive is delivered for its machine.
    pub const fn set_homing_method(&mut self, method: u8) {
        self.settings.set_homing_method(method);
        self.kept = self.settings;
    }

    /// The place of the axis in increments, whatever the drive counts.
    #[must_use]
    pub fn place(&self) -> i64 {
        self.count().wrapping_sub(self.shift)
    }

    fn count(&self) -> i64 {
        i64::from(self.actual().get())
    }

    /// Where the tool is, in nanometres of the axis. An ideal drive does not tell it.
    #[must_use]
    pub fn load(&self) -> Option<Length> {
        let servo = self.servo.as_ref()?;
        let fine = servo.load().wrapping_sub(servo.places(self.shift));
        let fine = fine.wrapping_add(servo.beside(fine));
        Some(Length::from_nm(fine.wrapping_add(1 << 15) >> 16))
    }

    /// The drive counts otherwise from now on, while its axis stays where it is.
    pub fn count_from(&mut self, count: i64) {
        self.shift = self.shift.wrapping_add(count.wrapping_sub(self.count()));
        self.follower.stand_at(count);
        if let Some(servo) = &mut self.servo {
            servo.count_from(count);
        }
    }

    /// Stops at once and forgets all targets that wait.
    fn stop(&mut self) {
        self.follower.stop();
        if let Some(servo) = &mut self.servo {
            servo.stop();
        }
    }

    /// The drive of a spindle: it also takes mode and speed.
    #[must_use]
    pub(super) const fn for_spindle(mut self) -> Self {
        self.of_spindle = true;
        self
    }

    /// The drive's node.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// The power state.
    #[must_use]
    pub const fn power(&self) -> Power {
        self.power
    }

    /// The actual position.
    #[must_use]
    pub fn actual(&self) -> Increments {
        match &self.servo {
            Some(servo) => servo.actual(),
            None => self.follower.actual(),
        }
    }

    /// The speed at which the drive turns a spindle.
    #[must_use]
    pub fn velocity(&self) -> MilliRpm {
        match (self.power, self.spindle.mode) {
            (Power::Enabled, Mode::Velocity) => self.spindle.velocity,
            _ => MilliRpm::STOPPED,
        }
    }

    /// True while the drive turns a spindle in position mode.
    #[must_use]
    pub fn is_positioning(&self) -> bool {
        self.power == Power::Enabled
            && self.spindle.mode == Mode::Position
            && self.trouble != Trouble::Stuck
    }

    /// Tells the drive whether the spindle turns. While it turns, a new mode has to wait, but a new speed counts.
    pub const fn turns(&mut self, turning: bool) {
        self.turning = turning;
    }

    /// The target that the next SYNC will latch.
    #[must_use]
    pub fn coming_target(&self) -> Option<Increments> {
        self.command.map(|command| command.target)
    }

    /// Sets the drive's fault from the next SYNC on, or clears it.
    pub const fn trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    /// Switches the drive off and on: it restarts at its position.
    pub fn restart(&mut self) {
        self.stop();
        self.homing.restart();
        if self.homing.options.forgets {
            self.count_from(0);
        }
        *self = Self {
            shift: self.shift,
            homing: self.homing,
            of_spindle: self.of_spindle,
            trouble: self.trouble,
            servo: self.servo,
            mode: self.kept.mode_wanted(),
            settings: self.kept,
            kept: self.kept,
            ..Self::new(self.node, self.options, self.follower)
        };
    }

    /// Takes a frame other than SYNC.
    pub fn receive(&mut self, frame: &Frame) {
        if self.trouble == Trouble::CutOff {
            // No frame arrives.
        } else if let Some((command, node)) = NmtCommand::decode(frame) {
            if node.is_none_or(|node| node == self.node) {
                self.manage(command);
            }
        } else if self.nmt != NmtState::Operational {
            // Process data count in operational only.
        } else if self.is_commanded(frame.id(), frame.payload()) {
            // The call has taken the command.
        } else if let Some((node, command)) = SpindleCommand::decode(frame)
            && node == self.node
            && self.settings.takes_speed()
        {
            self.next_spindle = command;
        } else if let Some(mode) = self.settings.mode_in(frame) {
            self.order(mode);
        }
    }

    /// Takes a frame of CAN FD.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        if self.trouble != Trouble::CutOff && self.nmt == NmtState::Operational {
            // A frame for other nodes changes nothing.
            let _ = self.is_commanded(frame.id(), frame.payload());
        }
    }

    /// True for a frame with the drive's command. A frame that is too short changes nothing and is reported (8210h) once.
    fn is_commanded(&mut self, id: CobId, payload: &[u8]) -> bool {
        match self.settings.command_in(id, payload) {
            None => return false,
            Some(Err(TooShort)) => {
                if !self.too_short {
                    self.tells_length = Some(PDO_LENGTH);
                }
                self.too_short = true;
            }
            Some(Ok(Commanded { own, more })) => {
                self.command = Setpoints::command(&own, 0);
                self.fresh = true;
                self.too_short = false;
                if more && self.options.tells_longer {
                    self.tells_length = Some(PDO_TOO_LONG);
                }
            }
        }
        true
    }

    /// 6060h.
    const fn order(&mut self, mode: u8) {
        if mode != self.settings.mode_wanted() {
            self.settings.want_mode(mode);
            self.changing = self.homing.options.slow;
        }
    }

    fn is_mute(&self) -> bool {
        matches!(self.trouble, Trouble::Silent | Trouble::CutOff)
    }

    /// Takes an SDO request; the answers go to `send`.
    pub fn serve(&mut self, frame: &Frame, mut send: impl FnMut(Frame)) {
        let silent = self.is_mute() || matches!(self.nmt, NmtState::BootUp | NmtState::Stopped);
        if silent {
            return;
        }
        let (mut server, mut value) = (self.server, self.value);
        let mut dictionary = Transfer {
            numbers: self.dictionary(),
            value: &mut value,
        };
        if let Some(answer) = server.receive(frame, &mut dictionary) {
            send(answer);
        }
        while let Some(segment) = server.poll(&mut dictionary) {
            send(segment);
        }
        (self.server, self.value) = (server, value);
    }

    fn dictionary(&mut self) -> Dictionary<'_> {
        let now = Now {
            node: self.node,
            pre_operational: self.nmt == NmtState::PreOperational,
            spindle: self.of_spindle,
            control: self.control,
            status: self.statusword(),
            mode: if self.of_spindle {
                self.spindle.mode as u8
            } else {
                self.mode
            },
            inputs: self.homing.inputs(),
            actual: self.actual().get(),
            following_error: self
                .servo
                .as_ref()
                .map(|servo| servo.following_error().get()),
            target: self.command.map_or(0, |command| command.target.get()),
        };
        Dictionary {
            settings: &mut self.settings,
            kept: &mut self.kept,
            now,
        }
    }

    fn manage(&mut self, command: NmtCommand) {
        match command {
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => self.restart(),
            // No command counts before the boot-up message.
            _ if self.nmt == NmtState::BootUp => {}
            NmtCommand::Start => self.nmt = NmtState::Operational,
            NmtCommand::Stop => {
                self.nmt = NmtState::Stopped;
                self.stop_by_itself();
            }
            NmtCommand::PreOperational => self.nmt = NmtState::PreOperational,
        }
    }

    /// The reaction to NMT stop. The last command does not count any more, and the drive does not wait for a SYNC: with
    /// torque it does what 6007h says. Where 6007h says nothing, it goes on with its last command.
    fn stop_by_itself(&mut self) {
        let power = match self.settings.stop() {
            StopOption::None => return,
            StopOption::Fault => Power::Fault,
            StopOption::Voltage => Power::Disabled,
            StopOption::QuickStop => Power::QuickStop,
        };
        self.command = None;
        self.spindle.velocity = MilliRpm::STOPPED;
        self.next_spindle = self.spindle;
        if self.power == Power::Enabled {
            self.power = power;
            self.stop();
        }
    }

    /// Lets the time up to a SYNC pass. Only a drive that is not ideal needs it: the ideal one moves at SYNC.
    pub fn elapse(&mut self) {
        let following = self.settings.following();
        let torque = self.power == Power::Enabled && self.trouble != Trouble::Stuck;
        if let Some(servo) = &mut self.servo
            && torque
            && self.mode != Mode::Homing as u8
        {
            self.failed = self.failed.or(servo.period(following));
        }
    }

    /// A SYNC. `measured` is the position to report, where the drive does not make it itself (a spindle).
    pub fn sync(&mut self, measured: Option<Increments>, mut send: impl FnMut(Frame)) {
        let silent = self.is_mute();
        let mut send = |frame| {
            if !silent {
                send(frame);
            }
        };
        if self.nmt == NmtState::BootUp {
            self.nmt = NmtState::PreOperational;
            self.power = Power::Disabled;
            send(NmtState::BootUp.frame(self.node));
        }
        let (mut server, mut value) = (self.server, self.value);
        let mut objects = Transfer {
            numbers: self.dictionary(),
            value: &mut value,
        };
        if let Some(abort) = server.elapse(Periods::new(1), &mut objects) {
            send(abort);
        }
        (self.server, self.value) = (server, value);
        if let Some(code) = self.tells_length.take() {
            let emcy = Emcy {
                code,
                register: Emcy::GENERIC,
                detail: [0; 5],
            };
            send(emcy.frame(self.node));
        }
        let target = self.latch(&mut send);
        self.suffer(&mut send);
        self.drive(target);
        self.report(&mut send);
        self.answer(measured, send);
    }

    /// Latches the commands since the last SYNC.
    fn latch(&mut self, send: &mut impl FnMut(Frame)) -> Option<Increments> {
        self.busy = self.busy.saturating_sub(1);
        let enabled = self.power == Power::Enabled;
        if self.turning && enabled && self.next_spindle.mode != self.spindle.mode {
            self.spindle.velocity = self.next_spindle.velocity;
        } else {
            self.spindle = self.next_spindle;
        }
        let command = self.command?;
        let word = command.control.raw();
        if self.busy == 0 {
            let next = self.power.after(word, self.control);
            if next != self.power {
                if self.power == Power::Fault && !matches!(self.trouble, Trouble::Fault(_)) {
                    send(Emcy::GONE.frame(self.node));
                }
                self.power = next;
                self.busy = self.options.settling;
            }
            self.control = word;
        }
        Some(command.target)
    }

    fn suffer(&mut self, send: &mut impl FnMut(Frame)) {
        let by_itself = self.failed.take().filter(|_| self.power == Power::Enabled);
        let trouble = match (self.trouble, by_itself) {
            (Trouble::None | Trouble::Silent, Some(code)) => Trouble::Fault(code),
            (trouble, _) => trouble,
        };
        match (trouble, self.power) {
            (Trouble::Fault(_), Power::Fault) => {}
            (Trouble::Fault(_), Power::Reacting) => self.power = Power::Fault,
            (Trouble::Fault(code), _) => {
                self.power = Power::Reacting;
                send(
                    Emcy {
                        code,
                        register: Emcy::GENERIC,
                        detail: [0; 5],
                    }
                    .frame(self.node),
                );
            }
            (Trouble::TorqueOff, _) => self.power = Power::Disabled,
            (Trouble::Held(most), power) if power.is_beyond(most) => self.power = most,
            // What kept it from starting is gone.
            (Trouble::None, Power::NotReady) if self.nmt != NmtState::BootUp => {
                self.power = Power::Disabled;
            }
            // A fault reaction ends in fault, even where the cause is already gone.
            (_, Power::Reacting) => self.power = Power::Fault,
            _ => {}
        }
    }

    /// The drive follows its targets: they are in the object of its mode, and mode 7 has been begun by bit 4.
    fn follows(&self) -> bool {
        let begun = self.mode != Mode::Interpolated as u8 || self.control & 0x10 != 0;
        self.of_spindle || begun && self.settings.targets_count_in(self.mode)
    }

    /// 6041h: in homing bits 13, 12 and 10 are those of homing.
    fn statusword(&self) -> u16 {
        let word = self.power.statusword();
        if self.power != Power::Enabled {
            word
        } else if self.mode == Mode::Homing as u8 {
            word & !0x3400 | self.homing.bits()
        } else if !self.follows() {
            word & !0x1000
        } else {
            word
        }
    }

    /// A SYNC period of an axis in homing.
    fn home(&mut self) {
        let speeds = self.settings.homing_speeds();
        let method = self.settings.homing_method();
        let (place, mark) = self
            .homing
            .advance(self.place(), self.control, method, &speeds);
        if let Some(mark) = mark {
            let offset = i64::from(self.settings.home_offset());
            let at_mark = if self.homing.options.adds_offset {
                offset
            } else {
                offset.wrapping_neg()
            };
            let shift = at_mark.wrapping_sub(mark);
            self.count_from(self.place().wrapping_add(shift));
        }
        let count = place.wrapping_add(self.shift);
        self.follower.stand_at(count);
        if let Some(servo) = &mut self.servo {
            servo.stand_at(count);
        }
    }

    /// The mode that has been ordered comes into force.
    fn change_mode(&mut self) {
        if self.trouble == Trouble::KeepsMode {
            return;
        }
        if self.changing > 0 {
            self.changing = self.changing.wrapping_sub(1);
        } else if matches!(self.settings.mode_wanted(), 6..=8) {
            self.mode = self.settings.mode_wanted();
        }
    }

    fn drive(&mut self, target: Option<Increments>) {
        self.change_mode();
        let homes = self.mode == Mode::Homing as u8;
        let stuck = self.trouble == Trouble::Stuck;
        if homes && self.power == Power::Enabled && !stuck && target.is_some() {
            return self.home();
        }
        self.homing.rest();
        self.follow(target);
        self.homing.pass(self.place());
    }

    fn follow(&mut self, target: Option<Increments>) {
        let fresh = core::mem::take(&mut self.fresh);
        match (self.power, target) {
            _ if self.trouble == Trouble::Stuck => self.stop(),
            (Power::Enabled, Some(target)) if self.follows() => match &mut self.servo {
                Some(servo) => self.failed = servo.latch(target, fresh),
                None => self.follower.follow(target),
            },
            _ => self.stop(),
        }
    }

    /// TPDO2: on change, and at every 16th SYNC.
    fn report(&mut self, mut send: impl FnMut(Frame)) {
        if self.trouble == Trouble::Unreported {
            return;
        }
        if !self.settings.reports() || self.nmt != NmtState::Operational {
            self.reported = None;
            return;
        }
        let report = AxisReport {
            mode: self.mode,
            inputs: self.homing.inputs(),
        };
        self.since = self.since.saturating_add(1);
        let again = self.since >= 16 && self.settings.reports_again();
        if self.reported != Some(report) || again {
            self.reported = Some(report);
            self.since = 0;
            let alone = report.inputs.to_le_bytes();
            let frame = match self.settings.reports_mode() {
                true => Some(report.frame(self.node)),
                false => Frame::new(CobId::of(Service::Tpdo2, self.node), &alone),
            };
            if let Some(frame) = frame {
                send(frame);
            }
        }
    }

    fn answer(&mut self, measured: Option<Increments>, mut send: impl FnMut(Frame)) {
        let Some(every) = self.settings.answers_every() else {
            return;
        };
        if self.nmt != NmtState::Operational {
            self.syncs = self.settings.start().checked_rem(every).unwrap_or(0);
            return;
        }
        self.syncs = self.syncs.saturating_add(1);
        if self.syncs < every {
            return;
        }
        self.syncs = 0;
        send(
            DriveStatus {
                status: Statusword::from_raw(self.statusword()),
                actual: measured.unwrap_or(self.actual()),
            }
            .frame(self.node),
        );
    }
}
