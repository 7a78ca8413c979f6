//! The number of a start: each once, whatever happens to the power while a start is counted.

use leadscrew_board_sim::count_start;
use leadscrew_board_sim::plant::{Flash, Tear};

use crate::cuts::first;
use crate::flash::{COUNT, PAGES, in_force, note, noted, power_up};

/// So many that each page of the flash is erased.
const STARTS: u32 = 2000;

/// The board starts: the number that it tells.
fn start(flash: &mut Flash) -> u32 {
    let _ = power_up(flash);
    count_start(flash)
}

#[test]
fn every_start_has_the_next_number() {
    let mut flash = Flash::with_pages(PAGES);
    let begin = flash.written();
    let mut each = Vec::new();
    for number in 1..=STARTS {
        let before = flash.written();
        assert_eq!(start(&mut flash), number);
        each.push(flash.written() - before);
    }
    each.sort_unstable();
    assert_eq!(each[each.len() / 2], 24, "what most starts write");
    assert!(
        flash.written() - begin > (PAGES * Flash::PAGE) as u32,
        "a page was not used"
    );
    assert_eq!(in_force(&mut flash), None);
}

#[test]
fn a_cut_at_any_byte_gives_no_number_twice_and_takes_nothing_else_away() {
    let stride = leadscrew_seed::amount(17, 7);
    let (mut cuts, mut erases, mut kept) = (0, 0, 0);
    for (place, tear) in Tear::ALL.into_iter().enumerate() {
        let mut flash = Flash::with_pages(PAGES);
        flash.set_tear(tear);
        note(&mut flash, 1).expect("a flash that works");
        for number in 1..=STARTS {
            let before = flash.clone();
            assert_eq!(start(&mut flash), number);
            let bytes = flash.written() - before.written();
            let erased = bytes > Flash::PAGE as u32;
            erases += u32::from(erased);
            // An erase is thousands of bytes.
            let stride = if erased { stride * 16 } else { stride };
            if !erased && !number.is_multiple_of(64) {
                continue;
            }
            for cut in (first(place, stride)..bytes).step_by(stride) {
                let mut flash = before.clone();
                flash.cut_after(cut);
                // The power is gone before the board says a word.
                let told = count_start(&mut flash);
                let counts = erased && bytes - cut <= COUNT;
                assert_eq!(told, if counts { number } else { 0 }, "cut at {cut}");
                let next = start(&mut flash);
                assert!(
                    (number..=number + 1).contains(&next),
                    "{next} after {number}"
                );
                kept += u32::from(next == number + 1);
                assert_eq!(start(&mut flash), next + 1);
                assert_eq!(noted(&mut flash), Some(1));
                cuts += 1;
            }
        }
    }
    assert!(
        erases > 0 && kept > 0,
        "{erases} erased, {kept} kept of {cuts}"
    );
}

#[test]
fn a_flash_that_fails_gives_no_number_and_none_a_second_time() {
    let mut flash = Flash::with_pages(PAGES);
    assert_eq!(start(&mut flash), 1);
    flash.set_broken(true);
    assert_eq!(count_start(&mut flash), 0);
    flash.set_broken(false);
    assert_eq!(start(&mut flash), 2);
}
