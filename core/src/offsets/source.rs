//! Where a program's offsets come from: the table, or where there is none the parameters of old.

use super::Offsets;
use crate::params::Params;
use crate::units::Length;

/// The nose of a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nose {
    /// Its radius. Below zero G41 and G42 change places; a table has no such radius, parameters may.
    pub radius: Length,
    /// Where its centre is, seen from the imaginary tip.
    pub tip: u8,
}

/// What offsets are read from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The machine's parameters.
    pub params: &'a Params,
    /// The table, if there is one.
    pub table: Option<&'a Offsets>,
}

impl Source<'_> {
    /// Zero of a work coordinate system (0 is G54) in machine coordinates, as it is written: without the shift.
    #[must_use]
    pub fn work(&self, system: u8) -> [Length; 2] {
        match self.table {
            Some(table) => {
                let work = table.work.get(usize::from(system)).copied();
                work.unwrap_or_default().slide()
            }
            None => self.params.work_offset(system),
        }
    }

    /// The same with the shift of all systems.
    #[must_use]
    pub fn zero(&self, system: u8) -> [Length; 2] {
        let [x, z] = self.work(system);
        let [more_x, more_z] = self.shift();
        [x + more_x, z + more_z]
    }

    /// The shift of all systems.
    #[must_use]
    pub fn shift(&self) -> [Length; 2] {
        self.table
            .map_or([Length::ZERO; 2], |table| table.shift.slide())
    }

    /// Geometry and wear of an offset number; nothing for 0.
    #[must_use]
    pub fn tool(&self, number: u8) -> [Length; 2] {
        let ([x, z], [worn_x, worn_z]) = (self.geometry(number), self.wear(number));
        [x + worn_x, z + worn_z]
    }

    /// Geometry of an offset number; nothing for 0.
    #[must_use]
    pub fn geometry(&self, number: u8) -> [Length; 2] {
        match self.table {
            Some(table) => table
                .tool(number)
                .copied()
                .unwrap_or_default()
                .geometry
                .slide(),
            None if number == 0 => [Length::ZERO; 2],
            None => self.params.tool_offset(number),
        }
    }

    /// Wear of an offset number; nothing for 0, and without a table.
    #[must_use]
    pub fn wear(&self, number: u8) -> [Length; 2] {
        let tool = self.table.and_then(|table| table.tool(number).copied());
        tool.unwrap_or_default().wear.slide()
    }

    /// The nose of an offset number; none for 0.
    #[must_use]
    pub fn nose(&self, number: u8) -> Nose {
        match self.table {
            Some(table) => {
                let tool = table.tool(number).copied().unwrap_or_default();
                Nose {
                    radius: tool.radius,
                    tip: tool.tip,
                }
            }
            None => Nose {
                radius: self.params.nose_radius(number),
                tip: self.params.nose_direction(number) as u8,
            },
        }
    }
}
