//! By which work zero positions are shown: that after the last typed line, or one that was chosen.
//!
//! The board knows machine coordinates alone; its table of offsets and tools is read, and read again where it has changed.

use leadscrew_core::link::Status;
use leadscrew_core::offsets::{Offsets, Revision, SYSTEMS, Source, TOOLS};
use leadscrew_core::params::Params;
use leadscrew_core::program::Carried;
use leadscrew_core::units::Length;

use super::view::Zero;
use crate::link::{Link, LinkResult};

/// What stands behind a zero.
#[derive(Debug)]
struct Read {
    /// `None`: the board has none, and its parameters count.
    table: Option<Offsets>,
    params: Box<Params>,
    revision: Revision,
    /// The identity of the parameters.
    parameters: u32,
}

/// The zeros of a board.
#[derive(Debug, Default)]
pub struct Zeros {
    read: Option<Read>,
    /// What the last typed line has left in force.
    pub carried: Option<Carried>,
    /// A coordinate system and a tool that were chosen, from 0.
    chosen: Option<(u8, u8)>,
}

impl Zeros {
    /// Reads what has changed.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn follow(&mut self, link: &mut Link, status: &Status) -> LinkResult {
        let revision = link.offsets_revision()?;
        let is_same =
            |read: &Read| read.revision == revision && read.parameters == status.parameters;
        if self.read.as_ref().is_some_and(is_same) {
            return Ok(());
        }
        self.read = None;
        // No program runs by a table that is damaged, and no position is shown by it.
        if let Ok(table) = link.offsets()?.resolving() {
            let params = link.parameters()?;
            self.read = Some(Read {
                table,
                params: Box::new(params.params),
                revision,
                parameters: params.identity,
            });
        }
        Ok(())
    }

    /// What the last typed line has left counts; another one takes the place of what was chosen.
    pub fn note(&mut self, carried: Option<Carried>) {
        if self.carried != carried {
            self.carried = carried;
            self.chosen = None;
        }
    }

    /// The coordinate system and the tool, from 0.
    fn which(&self) -> (u8, u8) {
        let carried = self.carried.map_or((0, 0), |carried| {
            (carried.system.saturating_sub(54), carried.offset)
        });
        self.chosen.unwrap_or(carried)
    }

    fn source(&self) -> Option<Source<'_>> {
        let read = self.read.as_ref()?;
        Some(Source {
            params: &read.params,
            table: read.table.as_ref(),
        })
    }

    /// The parameters and the table that zeros are read from; `None` where they are not known.
    #[must_use]
    pub fn read(&self) -> Option<(&Params, Option<&Offsets>)> {
        let read = self.read.as_ref()?;
        Some((&read.params, read.table.as_ref()))
    }

    /// The zero.
    #[must_use]
    pub fn zero(&self) -> Option<Zero> {
        let (system, tool) = self.which();
        let source = self.source()?;
        let ([x, z], [tool_x, tool_z]) = (source.zero(system), source.tool(tool));
        let shift = self
            .carried
            .map(|carried| carried.shift)
            .unwrap_or_default();
        Some(Zero {
            system: system.saturating_add(54),
            tool,
            at: [x + tool_x + shift.x, z + tool_z + shift.z],
        })
    }

    /// Shows positions by the next coordinate system.
    pub fn next_system(&mut self) {
        let (system, tool) = self.which();
        let systems = SYSTEMS as u8;
        self.chosen = Some((system.saturating_add(1) % systems, tool));
    }

    /// The same by the next tool that has an offset; behind the last by none.
    pub fn next_tool(&mut self) {
        let (system, tool) = self.which();
        let Some(source) = self.source() else {
            return;
        };
        let measured = |number: &u8| source.tool(*number) != [Length::ZERO; 2];
        let last = TOOLS as u8;
        let next = (tool.saturating_add(1)..=last).find(measured);
        self.chosen = Some((system, next.unwrap_or(0)));
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::offsets::{Offset, Tool};
    use leadscrew_core::units::Diameter;

    use super::*;

    #[test]
    fn a_zero_is_that_of_a_system_a_tool_and_a_shift() {
        let mm = |mm: i64| Length::from_nm(mm * 1_000_000);
        let mut table = Offsets {
            revision: Revision(3),
            ..Offsets::default()
        };
        let offset = |x: i64, z: i64| Offset {
            x: Diameter::from_nm(x * 1_000_000),
            z: mm(z),
        };
        table.shift = offset(2, 1);
        table.work[1] = offset(0, -400);
        table.tools[3] = Tool {
            geometry: offset(-250, 94),
            wear: offset(-2, 0),
            ..Tool::default()
        };
        let mut zeros = Zeros::default();
        assert_eq!(zeros.zero(), None);
        zeros.read = Some(Read {
            table: Some(table),
            params: Box::new(Params::sheets()),
            revision: table.revision,
            parameters: 0,
        });
        let zero = |system, tool, x, z| {
            Some(Zero {
                system,
                tool,
                at: [mm(x), mm(z)],
            })
        };
        assert_eq!(zeros.zero(), zero(54, 0, 1, 1));
        zeros.next_system();
        assert_eq!(zeros.zero(), zero(55, 0, 1, -399));
        zeros.next_tool();
        assert_eq!(zeros.zero(), zero(55, 4, -125, -305));
        zeros.next_tool();
        assert_eq!(zeros.zero(), zero(55, 0, 1, -399));
        for _ in 0..5 {
            zeros.next_system();
        }
        assert_eq!(zeros.zero(), zero(54, 0, 1, 1));
    }
}
