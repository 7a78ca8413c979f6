//! The block of inputs and outputs on the bus (9461 to 9463). Must not know how it is started and watched.

use super::{Contact, FIRST_OF_BLOCK, Params};
use crate::units::Axis;

/// Heartbeats of the board that may stay away before the block counts it as lost.
const HEARTBEATS: u32 = 3;

impl Params {
    /// The time in which a block has to hear the board's heartbeat (1016h), in milliseconds; 0 where the board sends none.
    #[must_use]
    pub fn block_watch_ms(&self) -> u16 {
        let beats = self.heartbeat_ms().saturating_mul(HEARTBEATS);
        if beats == 0 {
            return 0;
        }
        u16::try_from(beats.max(self.block_silence_ms())).unwrap_or(u16::MAX)
    }

    /// An input or output that is used and is the block's.
    #[inline(never)]
    pub(super) fn contact_of_block(&self) -> Option<u8> {
        // Those behind the machine's are inputs of the drive.
        let contact = |number: Option<u8>| match number.and_then(Contact::new) {
            Some(contact) => contact.number(),
            None => 0,
        };
        let wheel = match self.wheel_inputs() {
            0 => 0,
            first => first.saturating_add(3),
        };
        let mut used = [
            self.door_input(),
            self.chuck_input(),
            self.chuck_pressure_input(),
            self.tailstock_pressure_input(),
            self.tailstock_output(),
            self.enable_input(),
            self.turret_unclamp_output(),
            self.turret_index_output(),
            self.turret_code_end(),
            self.turret_locked_input(),
            wheel as u8,
        ]
        .into_iter()
        .chain([Axis::X, Axis::Z].into_iter().flat_map(|axis| {
            [
                contact(self.home_input(axis)),
                contact(self.limit_input_minus(axis)),
                contact(self.limit_input_plus(axis)),
            ]
        }));
        let of_block = |number: &u8| *number >= FIRST_OF_BLOCK;
        used.find(of_block).or_else(|| {
            let of_rows = self.functions().flat_map(|row| {
                let output = row.switches.map(|(output, _)| output);
                let input = row.answer.map(|answer| answer.input);
                [output, input]
            });
            let mut numbers = of_rows.flatten().map(Contact::number);
            numbers.find(of_block)
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::params::tests::slant_bed_with as with;

    #[test]
    fn whatever_can_be_at_the_block_needs_one() {
        for (key, value, number) in [
            ("9401", 81_171_010_200, 17),
            ("9416", 81_011_320_200, 32),
            ("9423", 17, 17),
            ("9424", 18, 18),
            ("9425", 19, 19),
            ("9426", 20, 20),
            ("9427", 21, 21),
            ("9429", 22, 22),
            ("9453", 23, 23),
            ("9454", 24, 24),
            ("9456", 25, 25),
            ("9051.X", 26, 26),
            ("9051.Z", 27, 27),
            ("9064.X", 28, 28),
            ("9064.Z", 29, 29),
            ("9065.X", 30, 30),
            ("9065.Z", 31, 31),
            ("9048", 14, 17),
        ] {
            assert_eq!(
                with(&[(key, value)]).contact_of_block(),
                Some(number),
                "{key}"
            );
            let alarm = with(&[(key, value)]).validate().unwrap_err();
            assert_eq!(alarm.number(), 4437, "{key}");
            assert_eq!(
                with(&[(key, value), ("9461", 5)]).validate(),
                Ok(()),
                "{key}"
            );
        }
        let turret = [
            ("9451", 2),
            ("9452", 8),
            ("9454", 1),
            ("9455", 14),
            ("9456", 1),
        ];
        assert_eq!(with(&turret).contact_of_block(), Some(17));
        for values in [
            &[][..],
            &[("9401", 81_161_160_200), ("9423", 16), ("9048", 13)],
        ] {
            assert_eq!(with(values).contact_of_block(), None);
        }
    }

    #[test]
    fn a_block_has_a_node_of_its_own() {
        for (node, taken) in [
            (16, true),
            (17, true),
            (18, true),
            (32, true),
            (40, false),
            (5, false),
        ] {
            let checked = with(&[("9461", node)])
                .validate()
                .map_err(|alarm| alarm.number());
            assert_eq!(checked.err(), taken.then_some(4436), "{node}");
        }
        let spindles = with(&[("9461", 34), ("9014", 3)]);
        assert_eq!(
            spindles.validate().map_err(|alarm| alarm.number()),
            Err(4436)
        );
    }

    #[test]
    fn a_block_waits_for_three_heartbeats_of_the_board() {
        for (heartbeat, silence, ms) in [
            (500, 500, 1500),
            (100, 500, 500),
            (0, 500, 0),
            (60_000, 500, 65_535),
        ] {
            let params = with(&[("9023", heartbeat), ("9462", silence)]);
            assert_eq!(params.block_watch_ms(), ms);
        }
    }
}
