//! Drive sections of machine files: objects that are written to the drives themselves.
//!
//! ```toml
//! [drive.X]
//! rpdo1 = ["6040/16", "607A/32"]
//! interpolation_period = "1 ms"
//! max_profile_velocity = 500000
//! "2105.3" = { type = "u16", value = 7 }
//! ```
//!
//! `profile = "maxon-epos4"` adds what the board needs of a drive, as far as the section does not say it.
//!
//! A drive has its own units, so the values are plain numbers here. Values that must agree with the board's set are
//! compared with it before any frame is sent.

mod by_profile;
mod objects;
mod section;

use std::ops::Range;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{
    AxisMode, AxisReport, CobId, DriveCommand, DriveStatus, Mapped, Mode, NodeId, Object, Service,
    Setpoints, SpindleCommand,
};
use leadscrew_core::params::Params;

use crate::diagnostics::Place;
use crate::profiles::Profile;

pub(super) use by_profile::fill;
pub use objects::{
    Drive, DriveName, KNOWN, Kind, Known, PDOS, PERIOD_EXPONENT, PERIOD_VALUE, RATE, mapping_text,
    object_text,
};
pub(super) use section::apply;

/// Bit 30 of a COB-ID: no remote request. The drive decides whether it answers one.
pub const NO_REMOTE: u32 = 1 << 30;

/// Identifiers of the frame with all setpoints (9031), of boards with the numbers 1 to 127.
const TOGETHER_FIRST: i64 = 0x481;
const TOGETHER_LAST: i64 = 0x4FF;

/// 607Ch and 6098h.
const HOME_OFFSET: Object = Object::new(0x607C, 0);
const HOMING_METHOD: Object = Object::new(0x6098, 0);

/// The methods of 6098h whose mark is where the board takes it to be.
const METHODS: [i64; 28] = [
    1, 2, 7, 8, 9, 10, 11, 12, 13, 14, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 33,
    34, 35, 37,
];

/// The key of all sections.
pub const KEY: &str = "drive";

/// A wanted object of a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A number.
    Number {
        /// Index and sub-index.
        object: Object,
        /// Data type.
        kind: Kind,
        /// Value.
        value: i64,
    },
    /// The mapping of a PDO.
    Mapping {
        /// 1600h … 1A01h.
        mapping: u16,
        /// 1400h … 1801h.
        communication: u16,
        /// Mapped objects.
        objects: Vec<Mapped>,
    },
}

impl Wanted {
    /// The object; for a mapping, its number of entries.
    #[must_use]
    pub const fn object(&self) -> Object {
        match self {
            Self::Number { object, .. } => *object,
            Self::Mapping { mapping, .. } => Object::new(*mapping, 0),
        }
    }
}

/// A line of a section.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The drive.
    pub drive: DriveName,
    /// The wanted object.
    pub wanted: Wanted,
    /// Number of the file, from 1.
    pub(super) layer: usize,
    /// Its place.
    pub place: Place,
    /// The bytes of its value in the file. Both halves of `interpolation_period` share them.
    pub span: Range<usize>,
    /// The profile of the drive says it: the place is that of `profile`.
    pub by_profile: bool,
}

impl Setting {
    /// The key of the value in a file, in full.
    #[must_use]
    pub fn key(&self) -> String {
        let object = self.wanted.object();
        let known = match &self.wanted {
            Wanted::Number { .. } => KNOWN
                .iter()
                .find(|known| known.object == object)
                .map(|known| known.name),
            Wanted::Mapping { mapping, .. } => {
                PDOS.iter().find(|pdo| pdo.1 == *mapping).map(|pdo| pdo.0)
            }
        };
        known.map_or_else(
            || format!("\"{:04X}.{:X}\"", object.index, object.sub),
            str::to_owned,
        )
    }
}

/// The profile that a section names.
#[derive(Clone, Debug)]
pub struct OfProfile {
    /// The drive.
    pub drive: DriveName,
    /// What is known of it.
    pub profile: Profile,
    layer: usize,
    place: Place,
    span: Range<usize>,
}

/// The value of a mapping in a file.
#[must_use]
pub fn mapping_literal(objects: &[Mapped]) -> String {
    let piece = |mapped: &Mapped| {
        let Object { index, sub } = mapped.object;
        match sub {
            0 => format!("\"{index:04X}/{}\"", mapped.bits),
            sub => format!("\"{index:04X}:{sub:02X}/{}\"", mapped.bits),
        }
    };
    let pieces: Vec<_> = objects.iter().map(piece).collect();
    format!("[{}]", pieces.join(", "))
}

/// The value of `interpolation_period` in a file; `None` for less than a microsecond.
#[must_use]
pub fn period_literal(value: i64, exponent: i64) -> Option<String> {
    let ns = period_ns(value, exponent)?;
    match (ns % 1_000_000, ns % 1000) {
        (0, _) => Some(format!("\"{} ms\"", ns / 1_000_000)),
        (_, 0) => Some(format!("\"{} µs\"", ns / 1000)),
        _ => None,
    }
}

/// A period of 60C2h in nanoseconds; `None` for one that no tick can have.
#[must_use]
pub fn period_ns(value: i64, exponent: i64) -> Option<i64> {
    let power = u32::try_from(exponent.checked_add(9)?).ok()?;
    value.checked_mul(10_i64.checked_pow(power)?)
}

/// 60C2h for a tick; `None` where 8 bits cannot hold it.
#[must_use]
pub fn period_of(us: i64) -> Option<(u8, i8)> {
    let (mut value, mut exponent) = (us, -6);
    while value % 10 == 0 && value > 0 {
        value /= 10;
        exponent += 1;
    }
    Some((u8::try_from(value).ok()?, exponent))
}

/// A conflict of the drives' objects with the board's set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// The alarm.
    pub code: leadscrew_core::alarm::Code,
    /// Its figures.
    pub figures: Vec<String>,
    /// The place of the value.
    pub place: Place,
}

/// All conflicts of the sections with the board's set.
#[must_use]
pub fn conflicts(settings: &[Setting], params: &Params) -> Vec<Conflict> {
    use leadscrew_core::alarm::Code;
    let mut found = Vec::new();
    for setting in settings {
        let drive = setting.drive;
        let mut conflict = |code, figures: [String; 3]| {
            let mut all = vec![drive.to_string()];
            all.extend(figures.into_iter().filter(|figure| !figure.is_empty()));
            found.push(Conflict {
                code,
                figures: all,
                place: setting.place.clone(),
            });
        };
        match &setting.wanted {
            Wanted::Number { object, value, .. } if *object == RATE => {
                let board = params.drive_status_syncs();
                if *value != i64::from(board) {
                    conflict(
                        Code::DriveRate,
                        [value.to_string(), board.to_string(), String::new()],
                    );
                }
            }
            Wanted::Number { object, value, .. } if *object == PERIOD_VALUE => {
                // The power of ten may be the drive's own: then the drive is asked before any write.
                let exponent = settings.iter().find_map(|other| match other.wanted {
                    Wanted::Number { object, value, .. }
                        if other.drive == drive && object == PERIOD_EXPONENT =>
                    {
                        Some(value)
                    }
                    _ => None,
                });
                if let Some(exponent) = exponent
                    && let Some((period, tick)) = period_conflict(*value, exponent, params)
                {
                    conflict(Code::DrivePeriod, [period, tick, String::new()]);
                }
            }
            Wanted::Mapping {
                mapping, objects, ..
            } => {
                let command = command_mapping(drive, params);
                let board: &[Mapped] = match mapping {
                    0x1600 => &command,
                    0x1601 if drive.is_spindle() => &SpindleCommand::MAPPING,
                    0x1601 if homes(drive, params) => &AxisMode::MAPPING,
                    0x1A00 => &DriveStatus::MAPPING,
                    0x1A01 if tells_inputs(drive, params) => &AxisReport::MAPPING,
                    _ => continue,
                };
                // Where the board looks for the switch, it needs the inputs alone.
                let is_enough = *mapping == 0x1A01
                    && !homes(drive, params)
                    && objects[..] == [AxisReport::INPUTS];
                if objects != board && !is_enough {
                    conflict(
                        Code::DriveMapping,
                        [
                            format!("{mapping:04X}h"),
                            mapping_text(objects),
                            mapping_text(board),
                        ],
                    );
                }
            }
            Wanted::Number { object, value, .. }
                if *object == HOME_OFFSET && *value != 0 && homes(drive, params) =>
            {
                conflict(
                    Code::HomeOffset,
                    [value.to_string(), String::new(), String::new()],
                );
            }
            Wanted::Number { object, value, .. }
                if *object == HOMING_METHOD && !METHODS.contains(value) && homes(drive, params) =>
            {
                conflict(
                    Code::HomeMethodUnknown,
                    [value.to_string(), String::new(), String::new()],
                );
            }
            Wanted::Number { object, value, .. } => {
                if let Some((theirs, board)) = cob_id_conflict(drive, *object, *value, params) {
                    conflict(Code::DriveCobId, [object_text(*object), theirs, board]);
                }
            }
        }
    }
    found
}

/// The drive of an axis that homes by itself (9050 = 1).
fn homes(drive: DriveName, params: &Params) -> bool {
    drive
        .axis()
        .is_some_and(|axis| params.home_method(axis) == leadscrew_core::params::BY_DRIVE)
}

/// The drive of an axis that tells its inputs: it homes by itself, or the board looks for a switch at it.
fn tells_inputs(drive: DriveName, params: &Params) -> bool {
    drive
        .axis()
        .is_some_and(|axis| params.drive_tells_inputs(axis))
}

/// The mapping of RPDO1 that the board needs of a drive: its own objects, after those of other drives where all drives get
/// one frame (9031).
#[must_use]
pub fn command_mapping(drive: DriveName, params: &Params) -> Vec<Mapped> {
    let mut mapping = match params.setpoint_frame() {
        0 => DriveCommand::MAPPING.to_vec(),
        _ => Setpoints::mapping(drive as usize).collect(),
    };
    // The target is the last entry.
    mapping.pop();
    mapping.push(DriveCommand::target(mode(drive, params)));
    mapping
}

/// The mode in which a drive gets its setpoints (9076).
#[must_use]
pub fn mode(drive: DriveName, params: &Params) -> Mode {
    drive.axis().map_or(Mode::Position, |axis| {
        Mode::of_setpoints(params.drive_mode(axis))
    })
}

/// Both identifiers in words, where a PDO between board and drive is switched off or has another identifier.
fn cob_id_conflict(
    drive: DriveName,
    object: Object,
    value: i64,
    params: &Params,
) -> Option<(String, String)> {
    let nodes = DriveNodes::of(params);
    let service = match (object.index, object.sub) {
        (0x1400, 1) => Service::Rpdo1,
        (0x1401, 1) if drive.is_spindle() || homes(drive, params) => Service::Rpdo2,
        (0x1800, 1) => Service::Tpdo1,
        (0x1801, 1) if tells_inputs(drive, params) => Service::Tpdo2,
        _ => return None,
    };
    let theirs = value & !i64::from(NO_REMOTE);
    let board = match service {
        // The board's number is known once there is a board: then this is checked again.
        Service::Rpdo1 if params.setpoint_frame() == 1 => match theirs {
            TOGETHER_FIRST..=TOGETHER_LAST => return None,
            _ => i64::from(Setpoints::cob_id(NodeId::BOARD).get()),
        },
        _ => i64::from(CobId::of(service, drive.among(&nodes).node).get()),
    };
    if theirs == board {
        return None;
    }
    Some((format!("{value:08X}h"), format!("{board:08X}h")))
}

/// Both times in words, where a period differs from the tick.
#[must_use]
pub fn period_conflict(value: i64, exponent: i64, params: &Params) -> Option<(String, String)> {
    let tick = i64::from(params.tick_us());
    if period_ns(value, exponent) == tick.checked_mul(1000) {
        return None;
    }
    Some((format!("{value} × 10^{exponent} s"), format!("{tick} µs")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tick_that_eight_bits_hold_has_a_period() {
        for (us, expected) in [
            (250, Some((25, -5))),
            (1000, Some((1, -3))),
            (10_000, Some((1, -2))),
            (2550, Some((255, -5))),
            (2560, None),
            (255, Some((255, -6))),
            (257, None),
        ] {
            assert_eq!(period_of(us), expected, "{us}");
            if let Some((value, exponent)) = expected {
                assert_eq!(period_ns(value.into(), exponent.into()), Some(us * 1000));
            }
        }
        assert_eq!(period_ns(1, -10), None);
        assert_eq!(period_ns(255, 63), None);
    }
}
