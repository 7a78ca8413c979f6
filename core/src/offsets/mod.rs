//! Work offsets and tools: what stands between a coordinate of a program and one of the machine.
//!
//! ```text
//! M = P + W + S + G + V        W work offset + shift, S of G50, G geometry of the tool, V its wear; X in diameter
//! ```
//!
//! A board keeps one table of them ([`image`]), with a revision that every change counts up. The gateway resolves programs
//! with it ([`Source`]); a board knows its bytes alone. This module must not know files, buses or storage.

pub mod image;
mod source;
#[cfg(test)]
mod tests;
mod tip;

pub use source::{Nose, Source};
pub use tip::InPlace;

use crate::params::Params;
use crate::units::{Angle, Diameter, Length};

/// Work coordinate systems: G54 to G59.
pub const SYSTEMS: usize = 6;
/// Tools, or rather offset numbers.
pub const TOOLS: usize = 32;

/// One step of every length in a table.
const STEP_NM: i64 = 100;

/// Which version of a table: counted up by every change. 0: no table was ever written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Revision(pub u32);

impl Revision {
    /// The revision of the next change.
    #[must_use]
    pub const fn next(self) -> Self {
        Self(self.0.saturating_add(1))
    }
}

/// An offset in X and Z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offset {
    /// X.
    pub x: Diameter,
    /// Z.
    pub z: Length,
}

impl Offset {
    /// On the radius and along Z, as calls have it.
    #[must_use]
    pub const fn slide(self) -> [Length; 2] {
        [self.x.radius(), self.z]
    }

    /// The offset of a slide.
    #[must_use]
    pub const fn of_slide([x, z]: [Length; 2]) -> Self {
        let x = Diameter::of_radius(x);
        Self { x, z }
    }

    /// True where both are whole steps of 0.1 µm, and not beyond `most`.
    fn is_within(self, most: Length) -> bool {
        is_within(Length::from_nm(self.x.nm()), most) && is_within(self.z, most)
    }
}

const fn is_within(length: Length, most: Length) -> bool {
    length.nm() % STEP_NM == 0 && length.abs().nm() <= most.nm()
}

/// What an offset number stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tool {
    /// Geometry: from the tool's tip to the reference point of its holder, as measured.
    pub geometry: Offset,
    /// Wear: what parts have shown since.
    pub wear: Offset,
    /// Radius of the nose.
    pub radius: Length,
    /// Where the centre of the nose is, seen from the imaginary tip: 0 to 9.
    pub tip: u8,
    /// Station of the turret; 0: none.
    pub station: u8,
    /// Its geometry in X has been measured.
    pub measured_x: bool,
    /// Its geometry in Z has been measured.
    pub measured_z: bool,
}

/// A thread that was picked up: a place in the groove of a part that was cut before. All threads follow it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PickedUp {
    /// Where the tip of the tool stood in the groove, by the machine: its slide less geometry and wear of the tool.
    pub tip: Offset,
    /// The angle of the spindle from its index there, 0 to 359.9999°, positive in the direction of M03. `None`: no thread
    /// was picked up.
    pub angle: Option<Angle>,
}

/// The table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offsets {
    /// Its revision.
    pub revision: Revision,
    /// The shift of all work coordinate systems.
    pub shift: Offset,
    /// Zeros of G54 to G59 in machine coordinates.
    pub work: [Offset; SYSTEMS],
    /// The tools, from number 1.
    pub tools: [Tool; TOOLS],
    /// The groove that threads follow.
    pub thread: PickedUp,
}

impl Default for Offsets {
    fn default() -> Self {
        Self {
            revision: Revision::default(),
            shift: Offset::default(),
            work: [Offset::default(); SYSTEMS],
            tools: [Tool::default(); TOOLS],
            thread: PickedUp::default(),
        }
    }
}

/// A record of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// The shift.
    Shift,
    /// A tool, by its number.
    Tool(u8),
    /// A work coordinate system, by its G code.
    Work(u8),
    /// The groove that threads follow.
    Thread,
}

impl Record {
    /// The number of the record in an alarm: 0 the shift, 1 to 32 a tool, 33 the picked-up thread, 54 to
    /// 59 a work offset.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Shift => 0,
            Self::Thread => 33,
            Self::Tool(number) | Self::Work(number) => number,
        }
    }
}

impl Offsets {
    /// Largest magnitude of a work offset and of the shift.
    pub const WORK: Length = Length::from_nm(99_999_999_900);
    /// Largest magnitude of a geometry.
    pub const GEOMETRY: Length = Length::from_nm(9_999_999_900);
    /// Largest magnitude of a wear.
    pub const WEAR: Length = Length::from_nm(99_999_900);
    /// Largest radius of a nose.
    pub const RADIUS: Length = Length::from_nm(99_999_900);
    /// Largest tip direction.
    pub const TIP: u8 = 9;

    /// One step of the angle of a picked-up thread, in µ°.
    pub const ANGLE_STEP_UDEG: i64 = 100;
    /// Such steps in a turn.
    pub const ANGLE_STEPS: u32 = 3_600_000;

    /// True for an angle within a turn, in whole steps.
    fn is_angle(angle: Angle) -> bool {
        let udeg = angle.udeg();
        (0..360_000_000).contains(&udeg) && udeg % Self::ANGLE_STEP_UDEG == 0
    }

    /// The tool with this number; `None` for 0 and for numbers that no tool has.
    #[must_use]
    pub fn tool(&self, number: u8) -> Option<&Tool> {
        self.tools.get(usize::from(number).checked_sub(1)?)
    }

    /// As [`tool`](Self::tool), to change it.
    pub fn tool_mut(&mut self, number: u8) -> Option<&mut Tool> {
        self.tools.get_mut(usize::from(number).checked_sub(1)?)
    }

    /// The first record with a value out of its range, or finer than 0.1 µm.
    #[must_use]
    pub fn beyond(&self) -> Option<Record> {
        if !self.shift.is_within(Self::WORK) {
            return Some(Record::Shift);
        }
        let work = (54..).zip(&self.work);
        let mut far = work.filter(|(_, offset)| !offset.is_within(Self::WORK));
        if let Some((code, _)) = far.next() {
            return Some(Record::Work(code));
        }
        let PickedUp { tip, angle } = &self.thread;
        if !tip.is_within(Self::WORK) || angle.is_some_and(|angle| !Self::is_angle(angle)) {
            return Some(Record::Thread);
        }
        let mut tools = (1..).zip(&self.tools);
        let (number, _) = tools.find(|(_, tool)| {
            !(tool.geometry.is_within(Self::GEOMETRY)
                && tool.wear.is_within(Self::WEAR)
                && is_within(tool.radius, Self::RADIUS)
                && tool.radius >= Length::ZERO
                && tool.tip <= Self::TIP
                && usize::from(tool.station) <= TOOLS)
        })?;
        Some(Record::Tool(number))
    }

    /// The table that says the same as parameters 1221 to 1226, 9101 to 9132, 9201 to 9216 and 9301 to 9316, with revision
    /// 0: what a board begins with that has none. A tool that has an offset counts as measured.
    ///
    /// # Errors
    /// The record that a table cannot have: a negative radius, or a length finer than 0.1 µm.
    pub fn of_params(params: &Params) -> Result<Self, Record> {
        let mut table = Self::default();
        for (system, work) in (0..).zip(&mut table.work) {
            *work = Offset::of_slide(params.work_offset(system));
        }
        for (number, tool) in (1..).zip(&mut table.tools) {
            tool.geometry = Offset::of_slide(params.tool_offset(number));
            tool.radius = params.nose_radius(number);
            tool.tip = params.nose_direction(number) as u8;
            tool.measured_x = tool.geometry.x != Diameter::default();
            tool.measured_z = tool.geometry.z != Length::ZERO;
        }
        match table.beyond() {
            Some(record) => Err(record),
            None => Ok(table),
        }
    }
}
