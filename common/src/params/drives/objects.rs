//! The drives of a machine, and their objects with a name in machine files.

use std::fmt;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{Mapped, NodeId, Object};
use leadscrew_core::call::TapSpindle;
use leadscrew_core::units::Axis;

/// A drive of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DriveName {
    /// X.
    X,
    /// Z.
    Z,
    /// C.
    C,
    /// Spindle 1.
    S1,
    /// Spindle 2.
    S2,
    /// Spindle 3.
    S3,
    /// Spindle 4.
    S4,
}

impl DriveName {
    /// All drives.
    pub const ALL: [Self; 7] = [
        Self::X,
        Self::Z,
        Self::C,
        Self::S1,
        Self::S2,
        Self::S3,
        Self::S4,
    ];

    /// The name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "X",
            Self::Z => "Z",
            Self::C => "C",
            Self::S1 => "S1",
            Self::S2 => "S2",
            Self::S3 => "S3",
            Self::S4 => "S4",
        }
    }

    /// The drive with this name, in capitals or small letters.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|drive| drive.name().eq_ignore_ascii_case(name))
    }

    /// The drive on a machine that has its drives.
    #[must_use]
    pub const fn among(self, drives: &DriveNodes) -> Drive {
        let node = match self {
            Self::X => drives.axis(Axis::X),
            Self::Z => drives.axis(Axis::Z),
            Self::C => drives.axis(Axis::C),
            Self::S1 => drives.spindle(TapSpindle::First),
            Self::S2 => drives.spindle(TapSpindle::Second),
            Self::S3 => drives.spindle(TapSpindle::Third),
            Self::S4 => drives.spindle(TapSpindle::Fourth),
        };
        Drive { name: self, node }
    }

    /// Its axis, if it is not that of a spindle.
    #[must_use]
    pub const fn axis(self) -> Option<Axis> {
        match self {
            Self::X => Some(Axis::X),
            Self::Z => Some(Axis::Z),
            Self::C => Some(Axis::C),
            Self::S1 | Self::S2 | Self::S3 | Self::S4 => None,
        }
    }

    /// True for the drive of a spindle.
    #[must_use]
    pub const fn is_spindle(self) -> bool {
        matches!(self, Self::S1 | Self::S2 | Self::S3 | Self::S4)
    }
}

impl fmt::Display for DriveName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A drive and its node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Drive {
    /// The drive.
    pub name: DriveName,
    /// Its node number.
    pub node: NodeId,
}

impl fmt::Display for Drive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.name.fmt(f)
    }
}

/// Data type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// UNSIGNED8.
    U8,
    /// UNSIGNED16.
    U16,
    /// UNSIGNED32.
    U32,
    /// INTEGER8.
    I8,
    /// INTEGER16.
    I16,
    /// INTEGER32.
    I32,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::U8,
        Self::U16,
        Self::U32,
        Self::I8,
        Self::I16,
        Self::I32,
    ];

    /// The name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::U16 => "u16",
            Self::U32 => "u32",
            Self::I8 => "i8",
            Self::I16 => "i16",
            Self::I32 => "i32",
        }
    }

    /// The type with this name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Bytes.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
        }
    }

    /// Smallest and largest value.
    #[must_use]
    pub const fn range(self) -> (i64, i64) {
        match self {
            Self::U8 => (0, u8::MAX as i64),
            Self::U16 => (0, u16::MAX as i64),
            Self::U32 => (0, u32::MAX as i64),
            Self::I8 => (i8::MIN as i64, i8::MAX as i64),
            Self::I16 => (i16::MIN as i64, i16::MAX as i64),
            Self::I32 => (i32::MIN as i64, i32::MAX as i64),
        }
    }

    /// The bytes on the wire.
    #[must_use]
    pub fn encode(self, value: i64) -> Vec<u8> {
        value.to_le_bytes()[..self.bytes()].to_vec()
    }

    /// The value of bytes from the wire; `None` for another length.
    #[must_use]
    pub fn decode(self, bytes: &[u8]) -> Option<i64> {
        if bytes.len() != self.bytes() {
            return None;
        }
        let mut raw = [0; 8];
        raw[..bytes.len()].copy_from_slice(bytes);
        let raw = i64::from_le_bytes(raw);
        Some(match self {
            Self::I8 => i64::from(raw as i8),
            Self::I16 => i64::from(raw as i16),
            Self::I32 => i64::from(raw as i32),
            Self::U8 | Self::U16 | Self::U32 => raw,
        })
    }
}

/// An object with a name.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// The name in a file.
    pub name: &'static str,
    /// Index and sub-index.
    pub object: Object,
    /// Data type.
    pub kind: Kind,
    /// Its meaning in English.
    pub en: &'static str,
    /// Its meaning in Chinese.
    pub zh: &'static str,
}

const fn known(
    name: &'static str,
    index: u16,
    sub: u8,
    kind: Kind,
    en: &'static str,
    zh: &'static str,
) -> Known {
    Known {
        name,
        object: Object::new(index, sub),
        kind,
        en,
        zh,
    }
}

/// The objects with a name, as in CiA 301 and CiA 402, by index. The units are the drive's own.
pub const KNOWN: &[Known] = &[
    known(
        "communication_cycle_us",
        0x1006,
        0,
        Kind::U32,
        "Time between two SYNCs, µs",
        "SYNC 间隔，µs",
    ),
    known(
        "heartbeat_ms",
        0x1017,
        0,
        Kind::U16,
        "Time between two heartbeats, ms",
        "心跳间隔，ms",
    ),
    known(
        "rpdo1_cob_id",
        0x1400,
        1,
        Kind::U32,
        "COB-ID of RPDO1",
        "RPDO1 的 COB-ID",
    ),
    known(
        "rpdo1_transmission",
        0x1400,
        2,
        Kind::U8,
        "Transmission type of RPDO1",
        "RPDO1 的传输类型",
    ),
    known(
        "rpdo2_cob_id",
        0x1401,
        1,
        Kind::U32,
        "COB-ID of RPDO2",
        "RPDO2 的 COB-ID",
    ),
    known(
        "rpdo2_transmission",
        0x1401,
        2,
        Kind::U8,
        "Transmission type of RPDO2",
        "RPDO2 的传输类型",
    ),
    known(
        "tpdo1_cob_id",
        0x1800,
        1,
        Kind::U32,
        "COB-ID of TPDO1",
        "TPDO1 的 COB-ID",
    ),
    known(
        "tpdo1_transmission",
        0x1800,
        2,
        Kind::U8,
        "Transmission type of TPDO1: at every so many SYNCs (9021)",
        "TPDO1 的传输类型：每隔多少个 SYNC 发送一次（9021）",
    ),
    known(
        "tpdo1_start",
        0x1800,
        6,
        Kind::U8,
        "Count of the SYNC of its first TPDO1",
        "首次发送 TPDO1 时的 SYNC 计数",
    ),
    known(
        "tpdo2_cob_id",
        0x1801,
        1,
        Kind::U32,
        "COB-ID of TPDO2",
        "TPDO2 的 COB-ID",
    ),
    known(
        "tpdo2_transmission",
        0x1801,
        2,
        Kind::U8,
        "Transmission type of TPDO2",
        "TPDO2 的传输类型",
    ),
    known(
        "tpdo2_event_time",
        0x1801,
        5,
        Kind::U16,
        "Time after which TPDO2 is sent again without a change, in milliseconds",
        "TPDO2 无变化时再次发送的时间（毫秒）",
    ),
    known(
        "abort_connection_option",
        0x6007,
        0,
        Kind::I16,
        "What it does when the connection is lost or NMT stops it: 0 nothing, 1 fault, 2 no voltage, 3 quick stop",
        "通信中断或被 NMT 停止时的动作：0 无，1 故障，2 断开电压，3 快速停止",
    ),
    known(
        "quick_stop_option",
        0x605A,
        0,
        Kind::I16,
        "What a quick stop does",
        "快速停止的方式",
    ),
    known(
        "mode_of_operation",
        0x6060,
        0,
        Kind::I8,
        "Mode: 8 is cyclic synchronous position, 7 interpolated position",
        "工作模式：8 为循环同步位置，7 为插补位置",
    ),
    known(
        "following_error_window",
        0x6065,
        0,
        Kind::U32,
        "Largest following error",
        "最大跟随误差",
    ),
    known(
        "following_error_timeout",
        0x6066,
        0,
        Kind::U16,
        "Time above it, ms",
        "允许超出的时间，ms",
    ),
    known(
        "max_torque",
        0x6072,
        0,
        Kind::U16,
        "Largest torque, 0.1 % of the rated one",
        "最大转矩，额定转矩的 0.1 %",
    ),
    known(
        "home_offset",
        0x607C,
        0,
        Kind::I32,
        "Offset of the zero position",
        "零点偏移",
    ),
    known(
        "position_limit_min",
        0x607D,
        1,
        Kind::I32,
        "Lowest position",
        "最小位置",
    ),
    known(
        "position_limit_max",
        0x607D,
        2,
        Kind::I32,
        "Highest position",
        "最大位置",
    ),
    known(
        "polarity",
        0x607E,
        0,
        Kind::U8,
        "Direction of position and speed",
        "位置和速度的方向",
    ),
    known(
        "max_profile_velocity",
        0x607F,
        0,
        Kind::U32,
        "Highest speed",
        "最高速度",
    ),
    known(
        "profile_acceleration",
        0x6083,
        0,
        Kind::U32,
        "Acceleration",
        "加速度",
    ),
    known(
        "profile_deceleration",
        0x6084,
        0,
        Kind::U32,
        "Deceleration",
        "减速度",
    ),
    known(
        "quick_stop_deceleration",
        0x6085,
        0,
        Kind::U32,
        "Deceleration of a quick stop",
        "快速停止的减速度",
    ),
    known(
        "homing_method",
        0x6098,
        0,
        Kind::I8,
        "How it homes by itself (9050 = 1): a method of the reference page",
        "自行回零的方式（9050 = 1）：见回零说明",
    ),
    known(
        "homing_speed_search",
        0x6099,
        1,
        Kind::U32,
        "Speed at which it searches the switch",
        "寻找开关的速度",
    ),
    known(
        "homing_speed_mark",
        0x6099,
        2,
        Kind::U32,
        "Speed at which it searches the mark",
        "寻找参考标记的速度",
    ),
    known(
        "homing_acceleration",
        0x609A,
        0,
        Kind::U32,
        "Acceleration of its homing",
        "回零加速度",
    ),
    known(
        "interpolation_value",
        0x60C2,
        1,
        Kind::U8,
        "Interpolation period: value",
        "插补周期：数值",
    ),
    known(
        "interpolation_exponent",
        0x60C2,
        2,
        Kind::I8,
        "Interpolation period: power of ten, in seconds",
        "插补周期：以秒为单位的 10 的幂",
    ),
    known(
        "max_acceleration",
        0x60C5,
        0,
        Kind::U32,
        "Highest acceleration",
        "最大加速度",
    ),
    known(
        "max_deceleration",
        0x60C6,
        0,
        Kind::U32,
        "Highest deceleration",
        "最大减速度",
    ),
];

/// 60C2h in one value.
pub const PERIOD: &str = "interpolation_period";
/// 60C2h:01h.
pub const PERIOD_VALUE: Object = Object::new(0x60C2, 1);
/// 60C2h:02h.
pub const PERIOD_EXPONENT: Object = Object::new(0x60C2, 2);
/// 1800h:02h.
pub const RATE: Object = Object::new(0x1800, 2);

/// The PDOs whose mapping is a list in the file.
pub const PDOS: [(&str, u16, u16); 4] = [
    ("rpdo1", 0x1600, 0x1400),
    ("rpdo2", 0x1601, 0x1401),
    ("tpdo1", 0x1A00, 0x1800),
    ("tpdo2", 0x1A01, 0x1801),
];

/// The printed object: its name, otherwise `60C2h:01h`.
#[must_use]
pub fn object_text(object: Object) -> String {
    let Object { index, sub } = object;
    match KNOWN.iter().find(|known| known.object == object) {
        Some(known) => format!("{index:04X}h:{sub:02X}h {}", known.name),
        None => format!("{index:04X}h:{sub:02X}h"),
    }
}

/// `6040h/16 607Ah/32`.
#[must_use]
pub fn mapping_text(mapping: &[Mapped]) -> String {
    let piece = |mapped: &Mapped| {
        let Object { index, sub } = mapped.object;
        if sub == 0 {
            format!("{index:04X}h/{}", mapped.bits)
        } else {
            format!("{index:04X}h:{sub:02X}h/{}", mapped.bits)
        }
    };
    if mapping.is_empty() {
        return "empty".into();
    }
    mapping.iter().map(piece).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_objects_stand_once_and_in_order() {
        for pair in KNOWN.windows(2) {
            assert!(pair[0].object < pair[1].object, "{}", pair[1].name);
        }
        for (n, known) in KNOWN.iter().enumerate() {
            assert!(KNOWN[..n].iter().all(|other| other.name != known.name));
            assert!(!known.zh.is_ascii());
        }
    }

    #[test]
    fn a_value_is_read_back_from_its_bytes() {
        for kind in Kind::ALL {
            let (low, high) = kind.range();
            for value in [low, 0, 1, high] {
                assert_eq!(kind.decode(&kind.encode(value)), Some(value), "{kind:?}");
            }
            assert_eq!(kind.decode(&[0; 5]), None);
            assert_eq!(Kind::find(kind.name()), Some(kind));
        }
    }
}
