//! Gears of the spindle (9431 to 9444): what M41 to M44 select. Must not know who shifts them.

use super::Params;

/// Gears of a machine.
pub const GEARS: u8 = 4;

/// The most turns of the motor for one of the spindle, so that a speed of the motor fits its frame.
const LARGEST_RATIO: u32 = 15;

/// A gear between the motor of spindle 1 and the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gear {
    /// The motor turns so often …
    pub motor: u32,
    /// … while the spindle turns so often.
    pub spindle: u32,
    /// Highest speed of the spindle in it, in turns a minute.
    pub most: u32,
}

impl Gear {
    /// Turns of the motor for one of the spindle, in 2⁻²⁴.
    #[must_use]
    pub const fn ratio(self) -> i32 {
        let motor = (self.motor as u64) << 24;
        let rounded = motor.saturating_add(self.spindle as u64 >> 1);
        match rounded.checked_div(self.spindle as u64) {
            Some(ratio) if ratio <= i32::MAX as u64 => ratio as i32,
            _ => i32::MAX,
        }
    }

    /// Increments of the drive for a turn of the spindle, where it has `per_turn` for one of its motor; `None` for a
    /// number that is not whole.
    #[must_use]
    pub fn increments(self, per_turn: u32) -> Option<u32> {
        let all = u64::from(per_turn).checked_mul(self.motor.into())?;
        let (of_turn, rest) = (
            all.checked_div(self.spindle.into())?,
            all.checked_rem(self.spindle.into())?,
        );
        u32::try_from(of_turn).ok().filter(|_| rest == 0)
    }
}

/// The gear that an M code selects, from 1; `None` for a code that selects none.
#[must_use]
pub const fn gear_of_code(code: u16) -> Option<u8> {
    match code {
        41..=44 => Some(code.wrapping_sub(40) as u8),
        _ => None,
    }
}

impl Params {
    /// True for a machine with gears.
    #[inline(never)]
    #[must_use]
    pub fn has_gears(&self) -> bool {
        (1..=GEARS).any(|number| self.gear(number).is_some())
    }

    /// A gear by its number; `None` where there is none with it.
    #[inline(never)]
    #[must_use]
    pub fn gear(&self, number: u8) -> Option<Gear> {
        let gear = self.gear_as_set(number);
        (gear.motor != 0).then_some(gear)
    }

    fn gear_as_set(&self, number: u8) -> Gear {
        Gear {
            motor: self.gear_motor_turns(number),
            spindle: self.gear_spindle_turns(number),
            most: self.gear_max_rpm(number),
        }
    }

    /// The highest speed of the spindle in a gear (0: none, or not known), and never more than 3772.
    #[must_use]
    pub fn spindle_most(&self, gear: u8) -> u32 {
        let highest = self.spindle_max_rpm();
        self.gear(gear)
            .map_or(highest, |gear| gear.most.min(highest))
    }

    /// The first gear that is set in part, or that no drive can follow.
    pub(super) fn unusable_gear(&self) -> Option<u8> {
        (1..=GEARS).find(|number| {
            let gear = self.gear_as_set(*number);
            let set = [gear.motor, gear.spindle, gear.most].map(|value| value != 0);
            let fits = || {
                gear.increments(self.spindle_increments()).is_some()
                    && gear.motor <= gear.spindle.saturating_mul(LARGEST_RATIO)
                    && gear.most <= self.spindle_max_rpm()
            };
            set != [false; 3] && (set != [true; 3] || !fits())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::tests::slant_bed_with as with;

    #[test]
    fn a_gear_has_a_ratio_and_a_highest_speed() {
        let params = with(&[
            ("9431", 4),
            ("9436", 1),
            ("9441", 600),
            ("9433", 37),
            ("9438", 40),
            ("9443", 2500),
        ]);
        assert_eq!(params.unusable_gear(), None);
        let slow = params.gear(1).unwrap();
        assert_eq!(slow.ratio(), 4 << 24);
        assert_eq!(slow.increments(3_600_000), Some(14_400_000));
        assert_eq!(
            params.gear(3).unwrap().increments(3_600_000),
            Some(3_330_000)
        );
        assert_eq!(params.gear(3).unwrap().ratio(), 15_518_925);
        assert_eq!(
            (params.gear(2), params.gear(0), params.gear(5)),
            (None, None, None)
        );
        assert_eq!(
            [0, 1, 2, 3].map(|gear| params.spindle_most(gear)),
            [3000, 600, 3000, 2500]
        );
        assert!(params.has_gears() && !Params::slant_bed().has_gears());
    }

    #[test]
    fn a_gear_that_is_set_in_part_or_that_no_drive_can_follow_is_named() {
        for values in [
            [0, 1, 600],
            [4, 0, 600],
            [4, 1, 0],
            // Not whole; too far geared down; faster than the spindle.
            [1, 7, 600],
            [16, 1, 100],
            [1, 1, 3001],
        ] {
            let [motor, spindle, most] = values;
            let params = with(&[("9432", motor), ("9437", spindle), ("9442", most)]);
            assert_eq!(params.unusable_gear(), Some(2), "{values:?}");
        }
    }

    #[test]
    fn codes_41_to_44_select_one() {
        assert_eq!(
            [40, 41, 44, 45].map(gear_of_code),
            [None, Some(1), Some(4), None]
        );
    }
}
