//! The process data of a drive, byte by byte.
//!
//! | PDO | content |
//! |---|---|
//! | RPDO1 | 6040h controlword (16 bit), 607Ah target position, in mode 7 60C1h:01 (32 bit, drive increments) |
//! | RPDO2, spindles | 6060h mode of operation (8 bit), 60FFh target velocity (32 bit, 0.001 rpm) |
//! | RPDO2, axes that home by themselves | 6060h mode of operation (8 bit) |
//! | TPDO1 | 6041h statusword (16 bit), 6064h actual position (32 bit, drive increments) |
//! | TPDO2, axes with a reference | 6061h mode in force (8 bit), 60FDh inputs (32 bit); where the board looks for the switch, 60FDh alone will do |
//!
//! All values are little-endian. The spindle's velocity unit is that of object 60A9h = FDB44700h (milli-revolutions per
//! minute). A drive with another unit scales the velocity by its own factors.

use super::cia402::{Controlword, Statusword};
use super::frame::{CobId, Frame, NodeId, Service};
use super::increments::Increments;
use super::mapping::Mapped;
use crate::units::{Rpm, TurnRate};

/// RPDO1 of a drive: controlword and target position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveCommand {
    /// 6040h.
    pub control: Controlword,
    /// 607Ah, or 60C1h:01.
    pub target: Increments,
}

impl DriveCommand {
    /// The objects that the drive must map into this PDO in cyclic synchronous position.
    pub const MAPPING: [Mapped; 2] = Self::mapping(Mode::Position);

    /// The objects that a drive must map into this PDO that gets its setpoints in this mode.
    #[must_use]
    pub const fn mapping(mode: Mode) -> [Mapped; 2] {
        [Mapped::new(0x6040, 0, 16), Self::target(mode)]
    }

    /// The object with the target position: 60C1h:01 in interpolated position, else 607Ah.
    #[must_use]
    pub const fn target(mode: Mode) -> Mapped {
        match mode {
            Mode::Interpolated => Mapped::new(0x60C1, 1, 32),
            _ => Mapped::new(0x607A, 0, 32),
        }
    }

    /// The frame to `node`.
    #[inline]
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        Frame::of(
            CobId::of(Service::Rpdo1, node),
            word_and_long(self.control.raw(), self.target.get()),
        )
    }

    /// The node and its command, if `frame` is an RPDO1.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (node, word, long) = decode_word_and_long(frame, Service::Rpdo1)?;
        Some((
            node,
            Self {
                control: Controlword::from_raw(word),
                target: Increments::new(long),
            },
        ))
    }
}

/// TPDO1 of a drive: statusword and actual position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveStatus {
    /// 6041h.
    pub status: Statusword,
    /// 6064h.
    pub actual: Increments,
}

impl DriveStatus {
    /// The objects that the drive must map into this PDO.
    pub const MAPPING: [Mapped; 2] = [Mapped::new(0x6041, 0, 16), Mapped::new(0x6064, 0, 32)];

    /// The frame from `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        Frame::of(
            CobId::of(Service::Tpdo1, node),
            word_and_long(self.status.raw(), self.actual.get()),
        )
    }

    /// The node and its status, if `frame` is a TPDO1.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        match frame.id().service()? {
            (Service::Tpdo1, node) => Some((node, Self::payload(frame)?)),
            _ => None,
        }
    }

    /// The status in a frame that is known to carry one.
    pub(super) fn payload(frame: &Frame) -> Option<Self> {
        let [a, b, c, d, e, f] = frame.exactly()?;
        Some(Self {
            status: Statusword::from_raw(u16::from_le_bytes([a, b])),
            actual: Increments::new(i32::from_le_bytes([c, d, e, f])),
        })
    }
}

/// RPDO2 of a spindle drive: mode and speed, sent when one of them changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpindleCommand {
    /// 6060h.
    pub mode: Mode,
    /// 60FFh.
    pub velocity: MilliRpm,
}

impl SpindleCommand {
    /// The objects that the drive must map into this PDO.
    pub const MAPPING: [Mapped; 2] = [Mapped::new(0x6060, 0, 8), Mapped::new(0x60FF, 0, 32)];

    /// The frame to `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [a, b, c, d] = self.velocity.get().to_le_bytes();
        Frame::of(
            CobId::of(Service::Rpdo2, node),
            [self.mode as u8, a, b, c, d],
        )
    }

    /// The node and its command, if `frame` is an RPDO2 with a mode that [`Mode`] has.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Rpdo2, node) = frame.id().service()? else {
            return None;
        };
        let [mode, a, b, c, d] = frame.exactly()?;
        let mode = match mode {
            8 => Mode::Position,
            9 => Mode::Velocity,
            _ => return None,
        };
        Some((
            node,
            Self {
                mode,
                velocity: MilliRpm::new(i32::from_le_bytes([a, b, c, d])),
            },
        ))
    }
}

/// RPDO2 of an axis that homes by itself: its mode, sent when it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisMode(pub Mode);

impl AxisMode {
    /// The objects that the drive must map into this PDO.
    pub const MAPPING: [Mapped; 1] = [Mapped::new(0x6060, 0, 8)];

    /// The frame to `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        Frame::of(CobId::of(Service::Rpdo2, node), [self.0 as u8])
    }
}

/// TPDO2 of an axis with a reference: its mode and its inputs. The drive sends it when one of them changes, and at every
/// 16th SYNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisReport {
    /// 6061h; 0: it is not told.
    pub mode: u8,
    /// 60FDh.
    pub inputs: u32,
}

impl AxisReport {
    /// The objects that the drive must map into this PDO.
    pub const MAPPING: [Mapped; 2] = [Mapped::new(0x6061, 0, 8), Self::INPUTS];

    /// The one that is enough where the drive does not home by itself.
    pub const INPUTS: Mapped = Mapped::new(0x60FD, 0, 32);

    /// The frame from `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [a, b, c, d] = self.inputs.to_le_bytes();
        Frame::of(CobId::of(Service::Tpdo2, node), [self.mode, a, b, c, d])
    }

    /// The report in a frame that is known to carry one.
    pub(super) fn payload(frame: &Frame) -> Option<Self> {
        let (mode, inputs) = match *frame.payload() {
            [mode, a, b, c, d] => (mode, [a, b, c, d]),
            [a, b, c, d] => (0, [a, b, c, d]),
            _ => return None,
        };
        Some(Self {
            mode,
            inputs: u32::from_le_bytes(inputs),
        })
    }
}

/// Mode of operation, 6060h: homing, and the modes in which a drive gets a setpoint with each SYNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Mode {
    /// Homing by the drive itself.
    Homing = 6,
    /// Interpolated position (IP): for axes whose drives have no other such mode on CAN.
    Interpolated = 7,
    /// Cyclic synchronous position (CSP): for axes, and for a spindle that taps.
    Position = 8,
    /// Cyclic synchronous velocity (CSV): for a spindle at a speed.
    Velocity = 9,
}

impl Mode {
    /// The mode in which the drive of an axis gets its setpoints, by parameter 9076: 7 or 8.
    #[must_use]
    pub const fn of_setpoints(number: u32) -> Self {
        match number {
            7 => Self::Interpolated,
            _ => Self::Position,
        }
    }
}

/// Spindle speed on the bus, in thousandths of a turn per minute; positive M03.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MilliRpm(i32);

impl MilliRpm {
    /// Standing.
    pub const STOPPED: Self = Self(0);

    /// `value` thousandths of a turn per minute.
    #[must_use]
    pub const fn new(value: i32) -> Self {
        Self(value)
    }

    /// Thousandths of a turn per minute.
    #[must_use]
    pub const fn get(self) -> i32 {
        self.0
    }

    /// The speed of a motor that turns `ratio` · 2⁻²⁴ times for a turn of the spindle, at most 15 times.
    #[inline]
    #[must_use]
    pub const fn geared(self, ratio: i32) -> Self {
        Self(((self.0 as i64).wrapping_mul(ratio as i64) >> 24) as i32)
    }

    /// The speed nearest to `rate`; saturates beyond 2.1 million rpm.
    #[must_use]
    pub const fn of_rate(rate: TurnRate) -> Self {
        // One turn per second is 60 000 thousandths of a turn per minute.
        let scaled = (rate.raw() >> 8).saturating_mul(60_000);
        let rounded = scaled.saturating_add(1 << 23) >> 24;
        Self(if rounded > i32::MAX as i64 {
            i32::MAX
        } else if rounded < i32::MIN as i64 {
            i32::MIN
        } else {
            rounded as i32
        })
    }

    /// `rpm` at an override of `percent` (100: as programmed). Exact; saturates beyond 2.1 million rpm.
    #[must_use]
    pub const fn of(rpm: Rpm, percent: u16) -> Self {
        Self(
            rpm.get()
                .saturating_mul(percent as i32)
                .saturating_mul(1000 / 100),
        )
    }
}

const fn word_and_long(word: u16, long: i32) -> [u8; 6] {
    let [a, b] = word.to_le_bytes();
    let [c, d, e, f] = long.to_le_bytes();
    [a, b, c, d, e, f]
}

fn decode_word_and_long(frame: &Frame, wanted: Service) -> Option<(NodeId, u16, i32)> {
    let (service, node) = frame.id().service()?;
    if service != wanted {
        return None;
    }
    let [a, b, c, d, e, f] = frame.exactly()?;
    Some((
        node,
        u16::from_le_bytes([a, b]),
        i32::from_le_bytes([c, d, e, f]),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_bytes() {
        let command = DriveCommand {
            control: Controlword::ENABLE_OPERATION,
            target: Increments::new(-2),
        };
        let frame = command.frame(NodeId::DRIVE_X);
        assert_eq!(frame.id().get(), 0x210);
        assert_eq!(frame.payload(), [0x0F, 0x00, 0xFE, 0xFF, 0xFF, 0xFF]);
        assert_eq!(
            DriveCommand::decode(&frame),
            Some((NodeId::DRIVE_X, command))
        );

        let status = DriveStatus {
            status: Statusword::from_raw(0x1237),
            actual: Increments::new(0x0102_0304),
        };
        let frame = status.frame(NodeId::DRIVE_Z);
        assert_eq!(frame.id().get(), 0x191);
        assert_eq!(frame.payload(), [0x37, 0x12, 0x04, 0x03, 0x02, 0x01]);
        assert_eq!(DriveStatus::decode(&frame), Some((NodeId::DRIVE_Z, status)));

        let spindle = SpindleCommand {
            mode: Mode::Velocity,
            velocity: MilliRpm::of(Rpm::new(-300), 100),
        };
        let frame = spindle.frame(NodeId::SPINDLE_1);
        assert_eq!(frame.id().get(), 0x320);
        assert_eq!(frame.payload(), [0x09, 0x20, 0x6C, 0xFB, 0xFF]);
        assert_eq!(
            SpindleCommand::decode(&frame),
            Some((NodeId::SPINDLE_1, spindle))
        );
    }

    #[test]
    fn a_frame_of_another_kind_or_size_is_none() {
        let long = Frame::new(CobId::of(Service::Tpdo1, NodeId::DRIVE_X), &[0; 8]).unwrap();
        assert_eq!(DriveStatus::decode(&long), None);
        let other = Frame::new(CobId::of(Service::Tpdo2, NodeId::DRIVE_X), &[0; 6]).unwrap();
        assert_eq!(DriveStatus::decode(&other), None);
        assert_eq!(DriveCommand::decode(&other), None);
        let homing = Frame::new(
            CobId::of(Service::Rpdo2, NodeId::SPINDLE_1),
            &[6, 0, 0, 0, 0],
        )
        .unwrap();
        assert_eq!(SpindleCommand::decode(&homing), None);
    }

    #[test]
    fn override_is_exact_and_saturates() {
        assert_eq!(MilliRpm::of(Rpm::new(333), 110).get(), 366_300);
        assert_eq!(MilliRpm::of(Rpm::new(i32::MAX), 200).get(), i32::MAX);
        assert_eq!(MilliRpm::of(Rpm::new(i32::MIN), 200).get(), i32::MIN);
    }
}
