//! The object dictionary of a drive: the few objects of CiA 301 and CiA 402 with which a machine is set up.
//!
//! A drive takes PDO communication and mapping, and the interpolation period, only in pre-operational; it takes limits
//! in every state. The PDOs have the contents that CiA 402 gives them, and no others. The command may come after dummy
//! entries, in a frame with the commands of other drives. A written value counts until the drive restarts; `save`
//! (1010h:01h) keeps it beyond that.

use super::homing::{Homing, Speeds};
use super::numbers::Numbers;
use super::servo::Following;
use leadscrew_core::bus::{
    Abort, AxisMode, AxisReport, CobId, DriveCommand, DriveStatus, Frame, Mapped, Mode, NodeId,
    Object, Service, Setpoints, SpindleCommand,
};

/// `save`, the value that 1010h:01h takes.
const SAVE: u32 = u32::from_le_bytes(*b"save");

/// A servo drive by CiA 402.
const DEVICE_TYPE: u32 = 0x0002_0192;
/// `LSDR`.
const PRODUCT: u32 = 0x4C53_4452;
/// COB-ID bit 31: the PDO is switched off.
const INVALID: u32 = 1 << 31;
/// COB-ID bit 30: the PDO cannot be requested by a remote frame.
const NO_RTR: u32 = 1 << 30;

/// Entries of RPDO1: nine dummies cover the commands of seven drives.
const COMMAND: usize = 11;

/// The objects that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Settings {
    /// 1400h: the frames that bring commands.
    command: Pdo<COMMAND>,
    /// 1401h, of spindles only.
    spindle: Pdo<2>,
    /// 1401h and 1801h of an axis: the frames with its mode, and with mode and inputs.
    mode: Pdo<1>,
    report: Pdo<2>,
    /// 1800h: the frame with the status, and its times.
    status: Pdo<2>,
    /// 1800h:06h.
    start: u8,
    /// 6007h: the reaction to NMT stop.
    stop: StopOption,
    /// 6060h of an axis.
    mode_wanted: u8,
    /// 607Fh.
    velocity: u32,
    /// 6083h.
    acceleration: u32,
    /// 1006h.
    cycle_us: u32,
    /// 60C2h.
    period: (u8, i8),
    /// 6098h.
    method: u8,
    /// 6099h.
    homing_speed: [u32; 2],
    /// 609Ah.
    homing_acceleration: u32,
    /// 607Ch.
    home_offset: i32,
    /// 1801h:05h: mode and inputs are told again after this time; 0: on change alone. Any other counts as 16 SYNCs.
    report_again: u16,
    /// 6065h and 6066h.
    following: Following,
}

/// The reaction of a drive with torque to NMT stop, by CiA 402.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopOption {
    /// It goes on with its last command.
    None,
    /// It goes into fault.
    Fault,
    /// It switches the voltage off.
    Voltage,
    /// It makes a quick stop.
    QuickStop,
}

impl StopOption {
    fn of(value: u32) -> Result<Self, Abort> {
        match value as u16 as i16 {
            0 => Ok(Self::None),
            1 => Ok(Self::Fault),
            2 => Ok(Self::Voltage),
            3 => Ok(Self::QuickStop),
            ..0 => Err(Abort::TooLow),
            4.. => Err(Abort::TooHigh),
        }
    }
}

/// A PDO's communication and mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pdo<const N: usize> {
    /// COB-ID, with the bit that switches the PDO off.
    cob_id: u32,
    transmission: u8,
    /// The number of objects in use; 0 while the mapping is being changed.
    count: u8,
    objects: [u32; N],
}

impl<const N: usize> Pdo<N> {
    fn new(service: Service, node: NodeId, transmission: u8, mapping: &[Mapped]) -> Self {
        let rtr = match service {
            Service::Tpdo1 | Service::Tpdo2 => NO_RTR,
            _ => 0,
        };
        let mut objects = [0; N];
        for (place, mapped) in objects.iter_mut().zip(mapping) {
            *place = mapped.raw();
        }
        Self {
            cob_id: CobId::of(service, node).get() as u32 | rtr,
            transmission,
            count: mapping.len() as u8,
            objects,
        }
    }

    /// True where the PDO is switched on and mapped.
    const fn works(&self) -> bool {
        self.cob_id & INVALID == 0 && self.count > 0
    }

    /// Length and value of a sub-index of the communication record, up to `highest`.
    fn told(&self, highest: u32, sub: u8) -> Result<(u8, u32), Abort> {
        match sub {
            0 => Ok((1, highest)),
            1 => Ok((4, self.cob_id)),
            2 => Ok((1, u32::from(self.transmission))),
            _ => Err(Abort::NoSubIndex),
        }
    }

    /// Length and value of a sub-index of the mapping.
    fn mapped(&self, sub: u8) -> Result<(u8, u32), Abort> {
        match sub.checked_sub(1) {
            None => Ok((1, u32::from(self.count))),
            Some(place) => {
                let raw = self.objects.get(usize::from(place));
                raw.map(|raw| (4, *raw)).ok_or(Abort::NoSubIndex)
            }
        }
    }

    fn communication(&mut self, sub: u8, value: u32) -> Result<(), Abort> {
        match sub {
            // The identifier is fixed; only the switch may change.
            1 if (value ^ self.cob_id) & !INVALID == 0 => self.cob_id = value,
            2 if (1..=240).contains(&value) && self.transmission < 254 => {
                self.transmission = value as u8;
            }
            // What is sent on change stays so.
            2 if (254..=255).contains(&value) && self.transmission >= 254 => {
                self.transmission = value as u8;
            }
            _ => return Err(Abort::Value),
        }
        Ok(())
    }

    fn map(&mut self, sub: u8, value: u32, mapping: &[Mapped]) -> Result<(), Abort> {
        // The order of CiA 301: switch off, then empty, then fill.
        if self.cob_id & INVALID == 0 {
            return Err(Abort::State);
        }
        let wanted = || mapping.iter().map(|mapped| mapped.raw());
        match sub {
            0 if value == 0 => self.count = 0,
            0 => match self.objects.get(..value as usize) {
                Some(all)
                    if let Some(dummies) = all.len().checked_sub(mapping.len())
                        && all.iter().skip(dummies).copied().eq(wanted())
                        && all.iter().take(dummies).all(|raw| is_dummy(*raw)) =>
                {
                    self.count = value as u8;
                }
                _ => return Err(Abort::PdoLength),
            },
            _ if self.count != 0 => return Err(Abort::State),
            _ => {
                let place = usize::from(sub.saturating_sub(1));
                let slot = self.objects.get_mut(place).ok_or(Abort::NoSubIndex)?;
                // Where there is room for dummies, the final count checks the order of the entries.
                let mappable = match N {
                    COMMAND => wanted().any(|raw| raw == value) || is_dummy(value),
                    _ => wanted().nth(place) == Some(value),
                };
                if !mappable {
                    return Err(Abort::NotMappable);
                }
                *slot = value;
            }
        }
        Ok(())
    }
}

/// A dummy entry stands for bytes of other drives: UNSIGNED8, UNSIGNED16, UNSIGNED32.
const fn is_dummy(raw: u32) -> bool {
    matches!(raw, 0x0005_0008 | 0x0006_0010 | 0x0007_0020)
}

impl<const N: usize> Pdo<N> {
    /// Switched off.
    const fn off(mut self) -> Self {
        self.cob_id |= INVALID;
        self
    }
}

impl Pdo<COMMAND> {
    /// Bytes in the frame before this drive's own.
    fn before(&self) -> usize {
        let objects = self.objects.iter().take(usize::from(self.count));
        let bits = objects
            .filter(|raw| is_dummy(**raw))
            .fold(0_usize, |bits, raw| {
                bits.saturating_add(*raw as usize & 0xFF)
            });
        bits / 8
    }

    /// Changes the identifier to that of a frame with the setpoints of several drives, while the PDO is switched off.
    fn move_to(&mut self, value: u32, own: NodeId) -> Result<(), Abort> {
        let id = value & !INVALID;
        let alone = id == u32::from(CobId::of(Service::Rpdo1, own).get());
        let together = (0x481..=0x4FF).contains(&id);
        if self.cob_id & INVALID == 0 || !(alone || together) {
            return Err(Abort::Value);
        }
        self.cob_id = value;
        Ok(())
    }
}

impl Settings {
    /// The settings as delivered.
    pub(super) fn new(node: NodeId, transmission: u8, start: u8) -> Self {
        Self {
            command: Pdo::new(Service::Rpdo1, node, 1, &DriveCommand::MAPPING),
            spindle: Pdo::new(Service::Rpdo2, node, 1, &SpindleCommand::MAPPING),
            status: Pdo::new(Service::Tpdo1, node, transmission, &DriveStatus::MAPPING),
            mode: Pdo::new(Service::Rpdo2, node, 254, &AxisMode::MAPPING).off(),
            report: Pdo::new(Service::Tpdo2, node, 254, &AxisReport::MAPPING).off(),
            start,
            stop: StopOption::QuickStop,
            mode_wanted: Mode::Position as u8,
            velocity: 10_000_000,
            acceleration: 100_000_000,
            cycle_us: 0,
            period: (1, -3),
            method: 37,
            homing_speed: [200_000, 20_000],
            homing_acceleration: 2_000_000,
            home_offset: 0,
            report_again: 16,
            following: Following {
                window: Following::OFF,
                timeout_ms: 0,
            },
        }
    }

    /// Switches on what an axis with a reference needs.
    pub(super) fn with_reference(mut self, node: NodeId) -> Self {
        self.mode = Pdo::new(Service::Rpdo2, node, 254, &AxisMode::MAPPING);
        self.report = Pdo::new(Service::Tpdo2, node, 254, &AxisReport::MAPPING);
        self
    }

    /// Switches on what an axis needs whose switch is at its drive.
    pub(super) fn with_inputs(mut self, node: NodeId) -> Self {
        self.report = Pdo::new(Service::Tpdo2, node, 254, &AxisReport::MAPPING);
        self
    }

    /// The drive gets its setpoints in interpolated position (mode 7).
    pub(super) fn interpolated(mut self) -> Self {
        let [of_position, interpolated] =
            [Mode::Position, Mode::Interpolated].map(|mode| DriveCommand::target(mode).raw());
        for slot in &mut self.command.objects {
            if *slot == of_position {
                *slot = interpolated;
            }
        }
        self.mode_wanted = Mode::Interpolated as u8;
        self
    }

    /// Its target is in the object of this mode.
    pub(super) fn targets_count_in(&self, mode: u8) -> bool {
        let target = DriveCommand::target(Mode::of_setpoints(mode.into()));
        self.command.objects.contains(&target.raw())
    }

    /// 6060h.
    pub(super) const fn mode_wanted(&self) -> u8 {
        self.mode_wanted
    }

    /// Sets it.
    pub(super) const fn want_mode(&mut self, mode: u8) {
        self.mode_wanted = mode;
    }

    /// The mode in a frame that brings it.
    pub(super) fn mode_in(&self, frame: &Frame) -> Option<u8> {
        let ours = self.mode.works() && self.mode.cob_id == u32::from(frame.id().get());
        match frame.payload() {
            [mode, ..] if ours => Some(*mode),
            _ => None,
        }
    }

    /// Mode and inputs are sent.
    pub(super) const fn reports(&self) -> bool {
        self.report.works()
    }

    /// The mode is among what is sent then.
    pub(super) const fn reports_mode(&self) -> bool {
        self.report.count as usize == AxisReport::MAPPING.len()
    }

    /// They are sent without a change, too.
    pub(super) const fn reports_again(&self) -> bool {
        self.report_again > 0
    }

    /// 6098h.
    pub(super) const fn homing_method(&self) -> u8 {
        self.method
    }

    pub(super) const fn set_homing_method(&mut self, method: u8) {
        self.method = method;
    }

    /// 607Ch.
    pub(super) const fn home_offset(&self) -> i32 {
        self.home_offset
    }

    /// 6065h and 6066h.
    pub(super) const fn following(&self) -> Following {
        self.following
    }

    pub(super) const fn with_following(mut self, following: Following) -> Self {
        self.following = following;
        self
    }

    /// 6099h and 609Ah, and the period for which 60C2h stands.
    pub(super) fn homing_speeds(&self) -> Speeds {
        let [fast, slow] = self.homing_speed;
        let (value, exponent) = self.period;
        let power = u32::try_from(exponent.saturating_add(6)).unwrap_or(0);
        Speeds {
            fast,
            slow,
            ramp: self.homing_acceleration,
            tick_us: u32::from(value).wrapping_mul(10_u32.wrapping_pow(power)),
        }
    }

    /// Sets 60C2h for a tick. The default stays where the tick does not fit into 8 bits.
    pub(super) const fn with_tick(mut self, tick_us: u32) -> Self {
        let mut value = tick_us;
        let mut exponent: i8 = -6;
        while value > 0 && value.is_multiple_of(10) {
            value /= 10;
            exponent = exponent.saturating_add(1);
        }
        if value > 0 && value <= 255 {
            self.period = (value as u8, exponent);
        }
        self
    }

    /// Sets the drive up for a machine whose setpoints all come in one frame of `board`; its own are at this place.
    pub(super) fn with_setpoints_of(mut self, board: NodeId, place: usize) -> Self {
        let mut count = 0_u8;
        for (slot, mapped) in self
            .command
            .objects
            .iter_mut()
            .zip(Setpoints::mapping(place))
        {
            *slot = mapped.raw();
            count = count.saturating_add(1);
        }
        self.command.count = count;
        self.command.cob_id = u32::from(Setpoints::cob_id(board).get());
        self
    }

    /// The drive's own six bytes of a frame with its command; `None` for other frames.
    ///
    /// # Errors
    /// The frame ends before these bytes.
    pub(super) fn command_in(
        &self,
        id: CobId,
        payload: &[u8],
    ) -> Option<Result<Commanded, TooShort>> {
        if !self.command.works() || self.command.cob_id != u32::from(id.get()) {
            return None;
        }
        let split = payload
            .get(self.command.before()..)
            .and_then(|rest| rest.split_first_chunk());
        let commanded = split.map(|(own, behind)| Commanded {
            own: *own,
            more: !behind.is_empty(),
        });
        Some(commanded.ok_or(TooShort))
    }

    /// The reaction to NMT stop.
    pub(super) const fn stop(&self) -> StopOption {
        self.stop
    }

    /// True where the drive takes the mode and speed of a spindle.
    pub(super) const fn takes_speed(&self) -> bool {
        self.spindle.works()
    }

    /// The status is sent at every n-th SYNC; `None`: never.
    pub(super) fn answers_every(&self) -> Option<u8> {
        self.status.works().then_some(self.status.transmission)
    }

    /// The number of SYNCs by which the first answer comes earlier.
    pub(super) const fn start(&self) -> u8 {
        self.start
    }
}

/// A command within a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Commanded {
    /// The drive's own six bytes.
    pub(super) own: [u8; 6],
    /// The frame is longer than the mapping.
    pub(super) more: bool,
}

/// The frame ends before the drive's own bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooShort;

/// The state of a drive at the time of a request.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now {
    pub(super) node: NodeId,
    /// True where communication and mapping may change.
    pub(super) pre_operational: bool,
    pub(super) spindle: bool,
    pub(super) control: u16,
    pub(super) status: u16,
    pub(super) mode: u8,
    /// 60FDh.
    pub(super) inputs: u32,
    pub(super) actual: i32,
    /// 60F4h; a drive that is ideal has none, and does not supervise it.
    pub(super) following_error: Option<i32>,
    pub(super) target: i32,
}

/// The objects that an SDO server serves.
pub(super) struct Dictionary<'a> {
    pub(super) settings: &'a mut Settings,
    /// The settings for the next start.
    pub(super) kept: &'a mut Settings,
    pub(super) now: Now,
}

impl Numbers for Dictionary<'_> {
    /// Length in bytes and value of an object.
    fn get(&self, object: Object) -> Result<(u8, u32), Abort> {
        let settings = &self.settings;
        let now = &self.now;
        match (object.index, object.sub) {
            (0x1000, 0) => Ok((4, DEVICE_TYPE)),
            (0x1001, 0) => Ok((1, 0)),
            (0x1006, 0) => Ok((4, settings.cycle_us)),
            (0x1010, 0) => Ok((1, 1)),
            // Can save on command.
            (0x1010, 1) => Ok((4, 1)),
            (0x1018, 0) => Ok((1, 4)),
            (0x1018, 1 | 3) => Ok((4, 0)),
            (0x1018, 2) => Ok((4, PRODUCT)),
            (0x1018, 4) => Ok((4, u32::from(now.node.get()))),
            (0x1400, sub) => settings.command.told(2, sub),
            (0x1401, sub) if now.spindle => settings.spindle.told(2, sub),
            (0x1401, sub) => settings.mode.told(2, sub),
            (0x1600, sub) => settings.command.mapped(sub),
            (0x1601, sub) if now.spindle => settings.spindle.mapped(sub),
            (0x1601, sub) => settings.mode.mapped(sub),
            (0x1801, 5) if !now.spindle => Ok((2, u32::from(settings.report_again))),
            (0x1801, sub) if !now.spindle => settings.report.told(5, sub),
            (0x1A01, sub) if !now.spindle => settings.report.mapped(sub),
            (0x1800, 6) => Ok((1, u32::from(settings.start))),
            (0x1800, sub) => settings.status.told(6, sub),
            (0x1A00, sub) => settings.status.mapped(sub),
            (0x6007, 0) => Ok((2, settings.stop as u32)),
            (0x6040, 0) => Ok((2, u32::from(now.control))),
            (0x6041, 0) => Ok((2, u32::from(now.status))),
            (0x6060, 0) if !now.spindle => Ok((1, u32::from(settings.mode_wanted))),
            (0x6060 | 0x6061, 0) => Ok((1, u32::from(now.mode))),
            (0x6064, 0) => Ok((4, now.actual as u32)),
            (0x6065, 0) if now.following_error.is_some() => Ok((4, settings.following.window)),
            (0x6066, 0) if now.following_error.is_some() => {
                Ok((2, u32::from(settings.following.timeout_ms)))
            }
            (0x60F4, 0) if let Some(error) = now.following_error => Ok((4, error as u32)),
            (0x607A, 0) => Ok((4, now.target as u32)),
            (0x60C0, 0) if !now.spindle => Ok((2, 0)),
            (0x60C1, 0) if !now.spindle => Ok((1, 1)),
            (0x60C1, 1) if !now.spindle => Ok((4, now.target as u32)),
            (0x607C, 0) if !now.spindle => Ok((4, settings.home_offset as u32)),
            (0x6098, 0) if !now.spindle => Ok((1, u32::from(settings.method))),
            (0x6099, 0) if !now.spindle => Ok((1, 2)),
            (0x6099, 1) if !now.spindle => Ok((4, settings.homing_speed[0])),
            (0x6099, 2) if !now.spindle => Ok((4, settings.homing_speed[1])),
            (0x609A, 0) if !now.spindle => Ok((4, settings.homing_acceleration)),
            (0x60FD, 0) if !now.spindle => Ok((4, now.inputs)),
            (0x607F, 0) => Ok((4, settings.velocity)),
            (0x6083, 0) => Ok((4, settings.acceleration)),
            (0x60C2, 0) => Ok((1, 2)),
            (0x60C2, 1) => Ok((1, u32::from(settings.period.0))),
            (0x60C2, 2) => Ok((1, u32::from(settings.period.1 as u8))),
            (
                0x1000 | 0x1001 | 0x1006 | 0x1010 | 0x1018 | 0x6007 | 0x6040 | 0x6041 | 0x6060
                | 0x6061 | 0x6064 | 0x607A | 0x607F | 0x6083 | 0x60C2,
                _,
            ) => Err(Abort::NoSubIndex),
            (0x6065 | 0x6066 | 0x60F4, _) if now.following_error.is_some() => {
                Err(Abort::NoSubIndex)
            }
            (0x607C | 0x6098 | 0x6099 | 0x609A | 0x60C0 | 0x60C1 | 0x60FD, _) if !now.spindle => {
                Err(Abort::NoSubIndex)
            }
            _ => Err(Abort::NoObject),
        }
    }

    /// Puts a value into effect. The object exists, and the length is right.
    fn set(&mut self, object: Object, value: u32) -> Result<(), Abort> {
        let pre_operational = self.now.pre_operational;
        let settings = &mut *self.settings;
        if matches!(object.index, 0x1400..=0x1AFF | 0x60C2) && !pre_operational {
            return Err(Abort::State);
        }
        match (object.index, object.sub) {
            (0x1010, 1) if value == SAVE => *self.kept = *settings,
            (0x1010, 1) => return Err(Abort::NotStored),
            (0x1006, 0) => settings.cycle_us = value,
            (0x1400, 1) if (value ^ settings.command.cob_id) & !INVALID != 0 => {
                settings.command.move_to(value, self.now.node)?;
            }
            (0x1400, sub @ 1..) => settings.command.communication(sub, value)?,
            (0x1401, sub @ 1..) if self.now.spindle => {
                settings.spindle.communication(sub, value)?
            }
            (0x1401, sub @ 1..) => settings.mode.communication(sub, value)?,
            (0x1801, 5) => settings.report_again = value as u16,
            (0x1801, sub @ 1..) => settings.report.communication(sub, value)?,
            (0x1800, 6) if value <= 240 => settings.start = value as u8,
            (0x1800, 6) => return Err(Abort::TooHigh),
            (0x1800, sub @ 1..) => settings.status.communication(sub, value)?,
            (0x1600, sub) => {
                // What is refused changes nothing.
                let mut map = |mode| {
                    settings
                        .command
                        .map(sub, value, &DriveCommand::mapping(mode))
                };
                map(Mode::Position).or_else(|abort| match self.now.spindle {
                    true => Err(abort),
                    false => map(Mode::Interpolated).map_err(|_| abort),
                })?;
            }
            // Linear interpolation, and no other.
            (0x60C0, 0) if !self.now.spindle => match value {
                0 => {}
                _ => return Err(Abort::Value),
            },
            (0x6060, 0) if !self.now.spindle => match value {
                6..=8 => settings.mode_wanted = value as u8,
                _ => return Err(Abort::Value),
            },
            (0x1601, sub) if !self.now.spindle => {
                settings.mode.map(sub, value, &AxisMode::MAPPING)?
            }
            (0x1A01, sub) => {
                let report = &mut settings.report;
                report
                    .map(sub, value, &AxisReport::MAPPING)
                    .or_else(|abort| {
                        let alone = report.map(sub, value, &[AxisReport::INPUTS]);
                        alone.map_err(|_| abort)
                    })?;
            }
            (0x1601, sub) => settings.spindle.map(sub, value, &SpindleCommand::MAPPING)?,
            (0x1A00, sub) => settings.status.map(sub, value, &DriveStatus::MAPPING)?,
            (0x6007, 0) => settings.stop = StopOption::of(value)?,
            (0x6098, 0) if Homing::has(value as u8) => settings.method = value as u8,
            (0x6098, 0) => return Err(Abort::Value),
            (0x6099, 1) => settings.homing_speed[0] = within(value, 1, 10_000_000)?,
            (0x6099, 2) => settings.homing_speed[1] = within(value, 1, 10_000_000)?,
            (0x609A, 0) => settings.homing_acceleration = within(value, 1, 1_000_000_000)?,
            (0x607C, 0) => settings.home_offset = value as i32,
            (0x6065, 0) => settings.following.window = value,
            (0x6066, 0) => settings.following.timeout_ms = value as u16,
            (0x607F, 0) => settings.velocity = within(value, 1, 100_000_000)?,
            (0x6083, 0) => settings.acceleration = within(value, 1, 1_000_000_000)?,
            (0x60C2, 1) => settings.period.0 = within(value, 1, 255)? as u8,
            (0x60C2, 2) => match value as u8 as i8 {
                exponent @ -6..=0 => settings.period.1 = exponent,
                ..-6 => return Err(Abort::TooLow),
                _ => return Err(Abort::TooHigh),
            },
            // Commands come by PDO only; all other objects can only be read.
            _ => return Err(Abort::ReadOnly),
        }
        Ok(())
    }
}

fn within(value: u32, low: u32, high: u32) -> Result<u32, Abort> {
    if value < low {
        Err(Abort::TooLow)
    } else if value > high {
        Err(Abort::TooHigh)
    } else {
        Ok(value)
    }
}
