//! The table of offsets and tools as text: keys, values, files.
//!
//! A key names one value: `T1.X`, `T1.wear.Z`, `T1.radius`, `G54.Z`, `shift.X`. Lengths are in millimetres, of X in
//! diameter. This module must not know boards or links.

mod difference;
mod file;

pub use difference::{Change, changes, fields, text, value};
pub use file::{apply, read, whole};

use std::fmt;

use leadscrew_core::alarm::Code;
use leadscrew_core::offsets::{Offset, Offsets, TOOLS, Tool};
use leadscrew_core::params::{Unit, Writing};
use leadscrew_core::units::{Angle, Axis, Diameter, Length};

use crate::number;
use crate::words::{Both, both, one_line};

/// A value of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Geometry.
    Geometry(Axis),
    /// Wear.
    Wear(Axis),
    /// Radius of the nose.
    Radius,
    /// Tip direction.
    Tip,
    /// Station of the turret.
    Station,
    /// The axes in which it has been measured.
    Measured,
}

impl Field {
    /// All of them, in the order of files.
    pub const ALL: [Self; 8] = [
        Self::Geometry(Axis::X),
        Self::Geometry(Axis::Z),
        Self::Wear(Axis::X),
        Self::Wear(Axis::Z),
        Self::Radius,
        Self::Tip,
        Self::Station,
        Self::Measured,
    ];

    /// The name in a key.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Geometry(Axis::X) => "X",
            Self::Geometry(_) => "Z",
            Self::Wear(Axis::X) => "wear.X",
            Self::Wear(_) => "wear.Z",
            Self::Radius => "radius",
            Self::Tip => "tip",
            Self::Station => "station",
            Self::Measured => "measured",
        }
    }
}

/// A value of the thread that was picked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groove {
    /// Where the tip was, by the machine.
    Tip(Axis),
    /// The angle of the spindle there.
    Angle,
}

impl Groove {
    /// All of them, in the order of files.
    pub const ALL: [Self; 3] = [Self::Tip(Axis::X), Self::Tip(Axis::Z), Self::Angle];
}

/// One value of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// The shift of all work coordinate systems.
    Shift(Axis),
    /// A work coordinate system by its G code.
    Work(u8, Axis),
    /// A tool.
    Tool(u8, Field),
    /// The thread that was picked up.
    Thread(Groove),
}

/// `T1.wear.X`
impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letter = |axis: &Axis| char::from(axis.letter());
        match self {
            Self::Shift(axis) => write!(f, "shift.{}", letter(axis)),
            Self::Work(code, axis) => write!(f, "G{code}.{}", letter(axis)),
            Self::Tool(number, field) => write!(f, "T{number}.{}", field.name()),
            Self::Thread(Groove::Tip(axis)) => write!(f, "thread.{}", letter(axis)),
            Self::Thread(Groove::Angle) => f.write_str("thread.angle"),
        }
    }
}

/// A value as it is kept: 0.1 µm, 0.0001°, a count, or bits.
pub type Raw = i64;

/// The angle of a thread where none was picked up.
const OFF: Raw = -1;
/// As it is written.
const OFF_TEXT: &str = "off";

/// Steps of 0.1 µm in a nanometre.
const STEP_NM: i64 = 100;

impl Key {
    /// All keys in the order of files: shift, work offsets, thread, tools.
    pub fn all() -> impl Iterator<Item = Self> {
        let axes = [Axis::X, Axis::Z];
        let shift = axes.map(Self::Shift);
        let work = (54..=59).flat_map(move |code| axes.map(|axis| Self::Work(code, axis)));
        let tools = (1..=TOOLS as u8).flat_map(|n| Field::ALL.map(|field| Self::Tool(n, field)));
        let thread = Groove::ALL.map(Self::Thread);
        shift.into_iter().chain(work).chain(thread).chain(tools)
    }

    /// The keys that a text means: one, or all of its record (`T1`, `G54`). A tool may be written without its T.
    #[must_use]
    pub fn find(text: &str) -> Vec<Self> {
        let text = text.trim();
        let with_t = if text.starts_with(|c: char| c.is_ascii_digit()) {
            format!("T{text}")
        } else {
            text.to_owned()
        };
        let named = |key: &Self| {
            let whole = key.to_string();
            let (record, _) = whole.split_once('.').unwrap_or((&whole, ""));
            whole.eq_ignore_ascii_case(&with_t) || record.eq_ignore_ascii_case(&with_t)
        };
        Self::all().filter(named).collect()
    }

    /// True for a value of a tool.
    #[must_use]
    pub const fn is_of_tool(self) -> bool {
        matches!(self, Self::Tool(..))
    }

    /// The largest magnitude of a length; `None` for what is no length.
    const fn most(self) -> Option<Length> {
        match self {
            Self::Shift(_) | Self::Work(..) | Self::Thread(Groove::Tip(_)) => Some(Offsets::WORK),
            Self::Thread(Groove::Angle) => None,
            Self::Tool(_, Field::Geometry(_)) => Some(Offsets::GEOMETRY),
            Self::Tool(_, Field::Wear(_)) => Some(Offsets::WEAR),
            Self::Tool(_, Field::Radius) => Some(Offsets::RADIUS),
            Self::Tool(..) => None,
        }
    }

    /// The smallest and the largest raw value.
    const fn range(self) -> (Raw, Raw) {
        match (self, self.most()) {
            (Self::Tool(_, Field::Radius), Some(most)) => (0, most.nm() / STEP_NM),
            (_, Some(most)) => (-most.nm() / STEP_NM, most.nm() / STEP_NM),
            (Self::Tool(_, Field::Tip), None) => (0, Offsets::TIP as Raw),
            (Self::Tool(_, Field::Station), None) => (0, TOOLS as Raw),
            (Self::Thread(_), None) => (OFF, Offsets::ANGLE_STEPS as Raw - 1),
            (_, None) => (0, 3),
        }
    }

    /// The value in a table.
    #[must_use]
    pub fn get(self, table: &Offsets) -> Raw {
        let of = |offset: Offset, axis| match axis {
            Axis::X => offset.x.nm() / STEP_NM,
            _ => offset.z.nm() / STEP_NM,
        };
        match self {
            Self::Shift(axis) => of(table.shift, axis),
            Self::Work(code, axis) => {
                let place = usize::from(code.saturating_sub(54));
                of(table.work.get(place).copied().unwrap_or_default(), axis)
            }
            Self::Thread(Groove::Tip(axis)) => of(table.thread.tip, axis),
            Self::Thread(Groove::Angle) => {
                let steps = |angle: Angle| angle.udeg() / Offsets::ANGLE_STEP_UDEG;
                table.thread.angle.map_or(OFF, steps)
            }
            Self::Tool(number, field) => {
                let tool = table.tool(number).copied().unwrap_or_default();
                match field {
                    Field::Geometry(axis) => of(tool.geometry, axis),
                    Field::Wear(axis) => of(tool.wear, axis),
                    Field::Radius => tool.radius.nm() / STEP_NM,
                    Field::Tip => tool.tip.into(),
                    Field::Station => tool.station.into(),
                    Field::Measured => Raw::from(tool.measured_x) | Raw::from(tool.measured_z) << 1,
                }
            }
        }
    }

    /// Puts a value into a table.
    ///
    /// # Errors
    /// A value out of its range: the table is unchanged.
    pub fn set(self, table: &mut Offsets, raw: Raw) -> Result<(), Both> {
        let (min, max) = self.range();
        if !(min..=max).contains(&raw) {
            return Err(self.out_of_range(&self.shown(raw)));
        }
        let put = |offset: &mut Offset, axis| match axis {
            Axis::X => offset.x = Diameter::from_nm(raw * STEP_NM),
            _ => offset.z = Length::from_nm(raw * STEP_NM),
        };
        // What is within its range fits.
        let small = u8::try_from(raw).unwrap_or_default();
        match self {
            Self::Shift(axis) => put(&mut table.shift, axis),
            Self::Work(code, axis) => {
                if let Some(work) = table.work.get_mut(usize::from(code.saturating_sub(54))) {
                    put(work, axis);
                }
            }
            Self::Thread(Groove::Tip(axis)) => put(&mut table.thread.tip, axis),
            Self::Thread(Groove::Angle) => {
                let angle = Angle::from_udeg(raw * Offsets::ANGLE_STEP_UDEG);
                table.thread.angle = (raw != OFF).then_some(angle);
            }
            Self::Tool(number, field) => {
                let Some(tool) = table.tool_mut(number) else {
                    return Ok(());
                };
                set_field(tool, field, raw, small, put);
            }
        }
        Ok(())
    }

    /// A raw value as it is written in a file: a number, or the letters of the measured axes.
    #[must_use]
    pub fn shown(self, raw: Raw) -> String {
        match self {
            Self::Tool(_, Field::Measured) => {
                let letters = [(1, "X"), (2, "Z")].map(
                    |(bit, letter)| {
                        if raw & bit != 0 { letter } else { "" }
                    },
                );
                letters.concat()
            }
            Self::Thread(Groove::Angle) if raw == OFF => OFF_TEXT.into(),
            Self::Thread(_) => number::text::<4>(raw),
            _ if self.most().is_some() => number::text::<4>(raw),
            _ => raw.to_string(),
        }
    }

    /// The raw value of a text: millimetres or with a unit, a count, or letters of axes.
    ///
    /// # Errors
    /// What is no value, or finer than 0.1 µm. The range is not looked at.
    pub fn parse(self, text: &str) -> Result<Raw, Both> {
        let text = text.trim();
        if let Self::Tool(_, Field::Measured) = self {
            let is = |letter| text.to_ascii_uppercase().contains(letter);
            let known = |c: char| matches!(c.to_ascii_uppercase(), 'X' | 'Z' | ' ');
            if !text.chars().all(known) {
                return Err(self.no_value(text));
            }
            return Ok(Raw::from(is('X')) | Raw::from(is('Z')) << 1);
        }
        if let Self::Thread(Groove::Angle) = self {
            return self.parse_angle(text);
        }
        if self.most().is_none() {
            return text.parse().map_err(|_| self.no_value(text));
        }
        let nm = Unit::Millimetre.parse(text, Writing::UnitOptional);
        match nm.map_err(|_| self.no_value(text))? {
            nm if nm % STEP_NM == 0 => Ok(nm / STEP_NM),
            _ => Err(self.out_of_range(text)),
        }
    }

    fn parse_angle(self, text: &str) -> Result<Raw, Both> {
        if text.eq_ignore_ascii_case(OFF_TEXT) {
            return Ok(OFF);
        }
        let udeg = Unit::Degree.parse(text, Writing::UnitOptional);
        match udeg.map_err(|_| self.no_value(text))? {
            udeg if udeg < 0 || udeg % Offsets::ANGLE_STEP_UDEG != 0 => {
                Err(self.out_of_range(text))
            }
            udeg => Ok(udeg / Offsets::ANGLE_STEP_UDEG),
        }
    }

    fn no_value(self, text: &str) -> Both {
        let (text, example) = (one_line(text), self.shown(self.range().1));
        let point = decimal_point(&text);
        both!(
            "{self}: `{text}` is no value, as `{example}` is one{en}",
            "{self}：`{text}` 不是有效值（示例：`{example}`）{zh}",
            en = point.en,
            zh = point.zh
        )
    }

    fn out_of_range(self, text: &str) -> Both {
        let (number, text) = (Code::OffsetsOutOfRange.number(), one_line(text));
        let (min, max) = self.range();
        let (min, max) = (self.shown(min), self.shown(max));
        let (min, max, unit) = match self {
            Self::Thread(Groove::Angle) => (self.shown(0), max, "°"),
            _ if self.most().is_some() => (min, max, " mm"),
            _ => (min, max, ""),
        };
        let fine = if unit == "°" {
            "0.0001°"
        } else {
            "0.0001 mm"
        };
        both!(
            "{number}: {self}: `{text}` is outside {min} to {max}{unit}, or finer than {fine}; nothing has been written",
            "{number}：{self}：`{text}` 超出 {min} 至 {max}{unit}，或小于最小单位 {fine}；未写入任何内容"
        )
    }
}

/// A hint for who has written a decimal comma.
#[must_use]
pub fn decimal_point(text: &str) -> Both {
    match text.contains(',') {
        true => both!("; write a point, not a comma", "；小数点请写 `.`，不写逗号"),
        false => both!("", ""),
    }
}

fn set_field(tool: &mut Tool, field: Field, raw: Raw, small: u8, put: impl Fn(&mut Offset, Axis)) {
    match field {
        Field::Geometry(axis) => put(&mut tool.geometry, axis),
        Field::Wear(axis) => put(&mut tool.wear, axis),
        Field::Radius => tool.radius = Length::from_nm(raw * STEP_NM),
        Field::Tip => tool.tip = small,
        Field::Station => tool.station = small,
        Field::Measured => {
            (tool.measured_x, tool.measured_z) = (raw & 1 != 0, raw & 2 != 0);
        }
    }
}

/// A key that names nothing.
#[must_use]
pub fn unknown(key: &str) -> Both {
    let key = one_line(key);
    both!(
        "there is no `{key}` in a tool table: T1 to T32 have X, Z, wear.X, wear.Z, radius, tip, station and measured; G54 to G59 \
         and shift have X and Z; thread has X, Z and angle",
        "刀具表中没有 `{key}`：T1 至 T32 有 X、Z、wear.X、wear.Z、radius、tip、station、measured；G54 至 G59 和 shift 有 X、Z；thread 有 X、Z、angle"
    )
}

/// A wear that changes by more than this is asked about: 1 mm.
const MUCH: Raw = 10_000;

/// The wear values that change by more than a millimetre: more likely a slip of the point than wear.
#[must_use]
pub fn much(changes: &[Change]) -> Vec<Key> {
    let wear = |change: &&Change| matches!(change.key, Key::Tool(_, Field::Wear(_)));
    let much = |change: &&Change| (change.new - change.old).abs() > MUCH;
    let found = changes.iter().filter(wear).filter(much);
    found.map(|change| change.key).collect()
}

/// Key and value of an assignment, the sign of `+=` and `-=` still at the key.
///
/// # Errors
/// There is no `=`.
pub fn parts(text: &str) -> Result<(&str, &str), Both> {
    text.split_once('=').ok_or_else(|| {
        let text = one_line(text);
        both!(
            "`{text}` sets nothing: write KEY=VALUE, KEY+=VALUE or KEY-=VALUE",
            "`{text}` 未设定任何值：请写 KEY=VALUE、KEY+=VALUE 或 KEY-=VALUE"
        )
    })
}

/// `KEY=VALUE`, `KEY+=VALUE` or `KEY-=VALUE`, put into a table.
///
/// # Errors
/// No such form, key or value: the table is unchanged.
pub fn assign(table: &mut Offsets, text: &str) -> Result<(), Both> {
    let (key, value) = parts(text)?;
    let (key, sign) = match (key.strip_suffix('+'), key.strip_suffix('-')) {
        (Some(key), _) => (key, 1),
        (_, Some(key)) => (key, -1),
        _ => (key, 0),
    };
    let [key] = Key::find(key)[..] else {
        return Err(unknown(key));
    };
    let raw = key.parse(value)?;
    let raw = match sign {
        0 => raw,
        sign => key.get(table).saturating_add(raw.saturating_mul(sign)),
    };
    key.set(table, raw)
}

#[cfg(test)]
mod tests;
