//! The gears of spindle 1 as the tick needs them: what a drive is told in each. Must not know who shifts.

use crate::params::{GEARS, Params};

/// A gear for the drive of the spindle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GearDrive {
    /// Turns of the motor for one of the spindle, in 2⁻²⁴; 0: there is no such gear.
    pub ratio: i32,
    /// Increments of the drive for a turn of the spindle.
    pub per_turn: u32,
    /// Highest speed of the spindle.
    pub most: u32,
}

/// All of a machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gears([GearDrive; GEARS as usize]);

impl Gears {
    pub(super) fn of(params: &Params) -> Self {
        let mut gears = [GearDrive::default(); GEARS as usize];
        for (place, number) in gears.iter_mut().zip(1..) {
            if let Some(gear) = params.gear(number) {
                *place = GearDrive {
                    ratio: gear.ratio(),
                    per_turn: gear.increments(params.spindle_increments()).unwrap_or(1),
                    most: params.spindle_most(number),
                };
            }
        }
        Self(gears)
    }

    /// True for a machine that has any.
    pub(super) fn are_there(&self) -> bool {
        self.0.iter().any(|gear| gear.ratio != 0)
    }

    /// A gear by its number.
    pub(super) fn get(&self, number: u8) -> Option<&GearDrive> {
        let place = usize::from(number).checked_sub(1)?;
        self.0.get(place).filter(|gear| gear.ratio != 0)
    }

    /// The most increments of a drive for a turn of the spindle; `per_turn` without gears.
    pub(super) fn most_per_turn(&self, per_turn: u32) -> u32 {
        self.0
            .iter()
            .fold(per_turn, |most, gear| most.max(gear.per_turn))
    }
}
