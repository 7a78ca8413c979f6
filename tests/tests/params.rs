//! A parameter set that passes its own checks makes a board and a machine: no later part of either refuses it.

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::board::Board;
use leadscrew_core::params::{Entry, Params};

/// xorshift64: the same sequence everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) % n
    }

    /// A value of the entry: often an edge of its range, else anywhere between.
    fn value(&mut self, entry: &Entry) -> i64 {
        let span = u64::try_from(entry.max() - entry.min()).unwrap() + 1;
        match self.below(4) {
            0 => entry.min(),
            1 => entry.max(),
            _ => entry.min() + i64::try_from(self.below(span)).unwrap(),
        }
    }
}

#[test]
fn what_passes_the_checks_is_accepted_by_board_and_machine() {
    leadscrew_seed::volume(1, |seed| {
        let mut random = Random(seed);
        let entries = Entry::all();
        let (mut passed, mut refused) = (0, 0);
        for round in 0..2_000 {
            let mut params = Params::sheets();
            for _ in 0..1 + round % 6 {
                let entry = &entries[usize::try_from(random.below(entries.len() as u64)).unwrap()];
                let value = random.value(entry);
                params.set(entry, value).unwrap();
            }
            if params.validate().is_err() {
                refused += 1;
                continue;
            }
            passed += 1;
            let board = Board::new(&params, None, None);
            assert!(board.is_ok(), "{:?} of {params:?}", board.err());
            let plant = Plant::new(&params, &PlantOptions::default());
            assert!(plant.is_ok(), "{:?} of {params:?}", plant.err());
        }
        // Both sides have been seen.
        assert!(
            passed > 500 && refused > 100,
            "{passed} passed, {refused} refused"
        );
    });
}
