//! A tool changer as the tick needs it: what an indexing turret is told, and what its inputs mean. Must not know programs.

use crate::call::Position;
use crate::params::{Contact, Params};
use crate::units::{Axis, Length};

/// Who changes tools (9451).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ToolChange {
    /// Nobody: T is an offset.
    #[default]
    None,
    /// Somebody at the machine, who presses start then.
    ByHand,
    /// A turret that indexes.
    Turret,
}

/// What a parameter set says about tool changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Changer {
    pub kind: ToolChange,
    pub stations: u8,
    /// Outputs; a bit each.
    pub unclamp: u32,
    pub index: u32,
    /// The first input of the code, and the inputs that it has.
    first: u8,
    mask: u32,
    locked: u32,
    pub time_ms: u32,
    /// A turret turns where neither axis is below this.
    clear: [Length; 2],
}

impl Changer {
    pub(super) fn of(params: &Params) -> Self {
        let stations = params.turret_stations();
        Self {
            kind: match params.tool_changer() {
                0 => ToolChange::None,
                1 => ToolChange::ByHand,
                _ => ToolChange::Turret,
            },
            stations,
            unclamp: Contact::bit_of(params.turret_unclamp_output()),
            index: Contact::bit_of(params.turret_index_output()),
            first: params.turret_code_input(),
            mask: params.turret_code_mask(),
            locked: Contact::bit_of(params.turret_locked_input()),
            time_ms: params.turret_time_ms(),
            clear: [params.turret_clear_x(), params.turret_clear_z()],
        }
    }

    /// All inputs that it has.
    pub(super) const fn inputs(&self) -> u32 {
        self.mask.wrapping_shl(self.first.wrapping_sub(1) as u32) | self.locked
    }

    /// The station that these inputs tell.
    pub(super) const fn station(&self, on: u32) -> u8 {
        let code = on.wrapping_shr(self.first.wrapping_sub(1) as u32) & self.mask;
        code as u8
    }

    /// True where the turret says that it is clamped.
    pub(super) const fn is_locked(&self, on: u32) -> bool {
        on & self.locked == self.locked
    }

    /// The axis that is not clear of the work.
    pub(super) fn in_the_way(&self, at: Position) -> Option<Axis> {
        let [x, z] = self.clear;
        match (at.x < x, at.z < z) {
            (true, _) => Some(Axis::X),
            (false, true) => Some(Axis::Z),
            (false, false) => None,
        }
    }
}
