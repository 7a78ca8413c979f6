//! Power that goes at any byte of a change of the offsets, among sets of parameters and entries of the tap journal; and
//! bits of the flash that change by themselves.

use leadscrew_board_sim::plant::{Flash, Tear};
use leadscrew_core::board::Found;
use leadscrew_core::offsets::Offsets;

use super::cuts::{Bench, Step, first};
use super::flash::{PAGES, in_force, noted, offsets_in_force, power_up, table};

/// Changes until every page has been erased.
const CHANGES: u32 = 32;

/// Each step is a change of the offsets; now and then one of the parameters comes before it. With the number of the set.
fn history(tear: usize) -> Vec<(Step, u32)> {
    let mut flash = Flash::with_pages(PAGES);
    flash.set_tear(Tear::ALL[tear]);
    let mut sequence = 0;
    let mut steps = Vec::new();
    for number in 1..=CHANGES {
        let set = number.div_ceil(4);
        let mut newest = sequence;
        if number % 4 == 1 {
            let mut bench = Bench::new(&mut flash);
            bench.ask(set);
            let (whole, after) = bench.store(&mut flash, sequence);
            assert!(whole, "set {set}");
            newest = after;
        }
        let before = flash.clone();
        let mut bench = Bench::new(&mut flash);
        bench.ask_offsets(number);
        let (whole, after) = bench.store(&mut flash, newest);
        assert!(whole, "table {number}");
        assert_eq!(after, newest + 2, "behind the table and behind its mark");
        let step = Step {
            bytes: flash.written() - before.written(),
            before,
            sequence: newest,
        };
        steps.push((step, set));
        sequence = after;
    }
    steps
}

#[test]
fn a_cut_at_any_byte_leaves_the_old_table_or_the_new_one() {
    let stride = leadscrew_seed::amount(29, 19);
    let (mut cuts, mut erases, mut new) = (0, 0, 0);
    for tear in 0..Tear::ALL.len() {
        for ((step, set), number) in history(tear).iter().zip(1..) {
            erases += u32::from(step.bytes > Flash::PAGE as u32);
            for cut in (first(tear, stride)..step.bytes).step_by(stride) {
                let (mut flash, newest) = step.cut(cut, |bench| bench.ask_offsets(number));
                let found = offsets_in_force(&mut flash);
                assert!(
                    found == number || found + 1 == number,
                    "{found}, cut at {cut}"
                );
                new += u32::from(found == number);
                // Everything else is as it was.
                assert_eq!(in_force(&mut flash), Some(*set));
                let entry = noted(&mut flash).unwrap_or(0);
                assert!((step.sequence..=newest).contains(&entry), "{entry}");
                cuts += 1;
                // Everything works again, now and then: it is the slowest part.
                if cut.is_multiple_of(13) {
                    let mut bench = Bench::new(&mut flash);
                    bench.ask_offsets(found + 1);
                    assert!(bench.store(&mut flash, entry).0);
                    assert_eq!(offsets_in_force(&mut flash), found + 1);
                }
            }
        }
    }
    assert!(erases >= 20, "{erases}");
    assert!(new > cuts / 50, "{new} of {cuts} behind the table itself");
    assert!(cuts >= 100_000 / stride as u32, "{cuts}");
}

/// Bits of the whole flash, also of what the store itself has written; other ones with each commit.
#[test]
fn a_change_of_any_bit_of_the_flash_is_no_other_table() {
    let stride = leadscrew_seed::amount(17, 13);
    let mut flash = Flash::with_pages(PAGES);
    for number in 1..=3 {
        let mut bench = Bench::new(&mut flash);
        bench.ask_offsets(number);
        assert!(bench.store(&mut flash, 2 * number).0);
    }
    let mut faults = 0;
    for bit in (first(0, stride) as usize..PAGES * Flash::PAGE * 8).step_by(stride) {
        let mut flash = flash.clone();
        flash.turn_bit(bit);
        let up = power_up(&mut flash).offsets;
        let found = Offsets::decode(&up.table).expect("a whole table");
        match up.found {
            Found::Newest => assert_eq!(found, table(3), "bit {bit}"),
            Found::Older => assert_eq!(found, table(2), "bit {bit}"),
            wrong => panic!("bit {bit}: {wrong:?}"),
        }
        faults += u32::from(up.found != Found::Newest);
    }
    assert!(faults > 7_000 / stride as u32, "{faults}");
}
