//! The switch of an axis that the board looks for (9050 = 2, 9051). Must not know how it is found.

use super::{BY_DRIVE, BY_SWITCH, CONTACTS, Contact, Params};
use crate::units::Axis;

/// The inputs of a drive that 9051 can name: bits 0 to 2 of 60FDh, the negative limit switch, the positive one and the home
/// switch.
const OF_DRIVE: u8 = 3;

/// The number of the first of them.
const FIRST_OF_DRIVE: u8 = CONTACTS + 1;

/// Where a reference switch is wired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomeSwitch {
    /// To an input of the machine.
    Machine(Contact),
    /// To the drive of the axis; the bit of its 60FDh.
    Drive(u8),
}

impl HomeSwitch {
    /// The switch with this number (9051): 1 to 32 are the inputs of the machine, 33 to 35 those of the drive.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        if let Some(contact) = Contact::new(number) {
            return Some(Self::Machine(contact));
        }
        match number.wrapping_sub(FIRST_OF_DRIVE) {
            bit @ 0..OF_DRIVE => Some(Self::Drive(1_u8.wrapping_shl(bit as u32))),
            _ => None,
        }
    }

    /// Its number.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Machine(contact) => contact.number(),
            Self::Drive(bit) => FIRST_OF_DRIVE.wrapping_add(bit.trailing_zeros() as u8),
        }
    }
}

impl Params {
    /// The switch that the board looks for; `None` for an axis that homes otherwise.
    #[must_use]
    pub fn home_switch(&self, axis: Axis) -> Option<HomeSwitch> {
        let number = self.home_input(axis)?;
        match self.home_method(axis) {
            BY_SWITCH => HomeSwitch::new(number),
            _ => None,
        }
    }

    /// The drive of an axis tells its inputs (TPDO2): it homes by itself, or has the switch that the board looks for, or a
    /// hard limit switch.
    #[must_use]
    pub fn drive_tells_inputs(&self, axis: Axis) -> bool {
        let mut switches = self.limit_switches(axis).chain(self.home_switch(axis));
        let has_switch = switches.any(|switch| matches!(switch, HomeSwitch::Drive(_)));
        has_switch || self.home_method(axis) == BY_DRIVE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::tests::slant_bed_with as with;

    #[test]
    fn each_number_is_one_switch() {
        let all: [_; 37] = core::array::from_fn(|number| HomeSwitch::new(number as u8));
        assert_eq!((all[0], all[36]), (None, None));
        assert_eq!(all[32], Contact::new(32).map(HomeSwitch::Machine));
        let of_drive = [1, 2, 4].map(|bit| Some(HomeSwitch::Drive(bit)));
        assert_eq!(all[33..36], of_drive);
        for (number, switch) in all.into_iter().enumerate().skip(1).take(35) {
            assert_eq!(switch.map(HomeSwitch::number), Some(number as u8));
        }
    }

    #[test]
    fn a_drive_tells_its_inputs_where_somebody_asks_for_them() {
        for (values, tells) in [
            (&[][..], false),
            (&[("9051.Z", 35)], false),
            (&[("9050.Z", 1)], true),
            (&[("9050.Z", 2), ("9051.Z", 32)], false),
            (&[("9050.Z", 2), ("9051.Z", 33)], true),
            (&[("9064.Z", 32), ("9065.Z", 1)], false),
            (&[("9064.Z", 33)], true),
            (&[("9065.Z", 34)], true),
        ] {
            let params = with(values);
            assert_eq!(params.drive_tells_inputs(Axis::Z), tells, "{values:?}");
            assert!(!params.drive_tells_inputs(Axis::X), "{values:?}");
        }
        assert!(with(&[("9050.C", 1)]).drive_tells_inputs(Axis::C));
    }

    /// It is no input of a block.
    #[test]
    fn a_switch_at_the_drive_needs_no_block() {
        let params = with(&[("9050.X", 2), ("9051.X", 33)]);
        assert_eq!(params.validate(), Ok(()));
        assert_eq!(params.contact_of_block(), None);
    }
}
