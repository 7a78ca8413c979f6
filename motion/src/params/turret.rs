//! The inputs of a turret (9451 to 9458). Must not know how it turns.

use super::{CONTACTS, Params};

impl Params {
    /// The code of the turret, as many bits as its last station needs.
    #[must_use]
    pub const fn turret_code_mask(&self) -> u32 {
        match self.turret_stations() {
            0 => 0,
            stations => (u8::MAX >> stations.leading_zeros()) as u32,
        }
    }

    /// The last input of its code; 0: there is no turret.
    pub(super) fn turret_code_end(&self) -> u8 {
        let bits = self.turret_code_mask().count_ones() as u8;
        let last = self
            .turret_code_input()
            .saturating_add(bits)
            .saturating_sub(1);
        if self.tool_changer() == 2 { last } else { 0 }
    }

    /// False for a turret that lacks something.
    pub(super) fn has_usable_turret(&self) -> bool {
        let first = self.turret_code_input();
        let bits = self.turret_code_mask().count_ones() as u8;
        let code_fits = first != 0 && first.saturating_add(bits) <= CONTACTS.saturating_add(1);
        self.tool_changer() != 2
            || (self.turret_stations() >= 2
                && self.turret_index_output() != 0
                && self.turret_locked_input() != 0
                && code_fits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Entry;

    #[test]
    fn a_turret_needs_stations_an_output_a_code_and_a_clamp() {
        let usable = |values: [i64; 4]| {
            let mut params = Params::slant_bed();
            let keys = ["9451", "9452", "9454", "9455", "9456"];
            let all = core::iter::once(2).chain(values);
            for (key, value) in keys.into_iter().zip(all) {
                params.set(Entry::find_text(key).unwrap(), value).unwrap();
            }
            params.has_usable_turret()
        };
        assert!(usable([8, 2, 5, 9]));
        assert!(usable([7, 2, 30, 9]));
        for values in [
            [1, 2, 5, 9],
            [8, 0, 5, 9],
            [8, 2, 0, 9],
            [8, 2, 30, 9],
            [8, 2, 5, 0],
        ] {
            assert!(!usable(values), "{values:?}");
        }
        assert!(Params::slant_bed().has_usable_turret());
    }
}
