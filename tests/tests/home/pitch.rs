//! A mark keeps its place whatever the errors of the pitch are there, and taking them off makes no step.

use leadscrew_core::board::Command;
use leadscrew_core::units::Axis;
use leadscrew_seed::{amount, volume};
use leadscrew_tests::random::Random;

use crate::bench::{Bench, MARK, SWITCHES, params_and};

/// A table of X from −100 mm on: so many tenths of a micrometre more every 15 mm.
pub fn table(more: i64) -> Vec<(&'static str, i64)> {
    const NUMBERS: [&str; 16] = [
        "1871.X", "1872.X", "1873.X", "1874.X", "1875.X", "1876.X", "1877.X", "1878.X", "1879.X",
        "1880.X", "1881.X", "1882.X", "1883.X", "1884.X", "1885.X", "1886.X",
    ];
    let errors = NUMBERS.into_iter().zip(0..).map(|(key, k)| (key, k * more));
    let place = [("1861.X", -100_000_000), ("1862.X", 15_000_000)];
    place.into_iter().chain(errors).collect()
}

/// The error at a place of the slide between −80 and 100 mm, less that at the mark, in nanometres.
pub fn beside_mark(more: i64, place: i64) -> i64 {
    (place - MARK) * more * 100 / 15_000_000
}

/// The drive homes by itself: the board finds the mark where the drive has it, and nothing moves afterwards.
#[test]
fn the_mark_of_a_drive_keeps_its_place() {
    volume(0x1880, |seed| {
        let mut random = Random(seed);
        for round in 0..amount(12, 40) {
            let more = random.of(&[-37, 300, -450]);
            // The index above the home switch, from its lower side.
            let start = random.within(-300_000, 290_000);
            let what = format!("{round}: {more} from {start}");
            let values = [table(more), vec![("9070.X", random.of(&[0, 300]))]].concat();
            let mut bench = Bench::with(&params_and(&values), start, SWITCHES, 24);
            let at = bench.home_x(&what);
            let mark = 300_000;
            // In increments of 100 nm.
            let place = bench.drive().place();
            let apart = (at - MARK - beside_mark(more, at)) / 100 - (place - mark);
            assert!(apart.abs() <= 1, "{what}: {at} {place}");
            bench.judge(&what, 4);
            (0..300).for_each(|_| bench.tick());
            assert!((bench.drive().place() - place).abs() <= 1, "{what}");
            // Without its position kept, the board reads that of its drive.
            bench.sim.command(Command::Stop);
            (0..50).for_each(|_| bench.tick());
            bench.sim.command(Command::Reset);
            (0..300).for_each(|_| bench.tick());
            assert!((bench.at().x.nm() - at).abs() <= 100, "{what}");
            assert!((bench.drive().place() - place).abs() <= 1, "{what}");
            assert!(bench.referenced().contains(Axis::X), "{what}");
        }
    });
}
