//! Where the tip of a tool is, and which tool is in place.

use super::{Source, Tool};
use crate::units::Length;

/// The tool in place, by the T words so far. An offset that is cancelled (T0100) does not take the tool away: its tip is
/// where it was [D345].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InPlace {
    station: u8,
    number: u8,
}

impl InPlace {
    /// Number of the offset that its tip goes by; 0: no tool was called.
    #[must_use]
    pub const fn number(self) -> u8 {
        self.number
    }

    /// The T word that calls it, with the offset that its tip goes by; 0: no tool was called.
    #[must_use]
    pub fn code(self) -> u16 {
        u16::from(self.station)
            .saturating_mul(100)
            .saturating_add(self.number.into())
    }

    /// The tool in place behind this T word.
    #[must_use]
    pub fn after(self, code: u16) -> Self {
        let [station, offset] =
            [code / 100, code % 100].map(|part| u8::try_from(part).unwrap_or(u8::MAX));
        let number = match (station, offset) {
            (0, 0) => return self,
            (_, 0) if station == self.station => self.number,
            (_, 0) => station,
            _ => offset,
        };
        Self { station, number }
    }
}

impl Tool {
    /// Where the machine is with the tip at zero; `None` where X or Z was not measured.
    #[must_use]
    pub fn tip(&self) -> Option<[Length; 2]> {
        let ([x, z], [worn_x, worn_z]) = (self.geometry.slide(), self.wear.slide());
        (self.measured_x && self.measured_z).then_some([x + worn_x, z + worn_z])
    }
}

impl Source<'_> {
    /// Where the machine is with the tip of a tool at zero; `None` where X or Z was not measured, which for parameters is
    /// an offset of 0, as in [`Offsets::of_params`](super::Offsets::of_params).
    #[must_use]
    pub fn tip(&self, number: u8) -> Option<[Length; 2]> {
        match self.table {
            Some(table) => table.tool(number)?.tip(),
            None => {
                let tip = self.geometry(number);
                let is_measured = |length| length != Length::ZERO;
                tip.into_iter().all(is_measured).then_some(tip)
            }
        }
    }
}
