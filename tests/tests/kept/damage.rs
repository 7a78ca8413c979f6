//! Bits of the flash that change by themselves: the set that was stored, or an alarm. Never another set, never the
//! built-in one in silence.

use leadscrew_board_sim::plant::Flash;
use leadscrew_core::board::{Found, KeptError, KeptSet, Region};
use leadscrew_core::params::Params;
use leadscrew_store::Store;

use super::cuts::first;
use super::flash::{PAGES, number, power_up, set};

fn stored(sets: u32) -> Flash {
    let mut flash = Flash::with_pages(PAGES);
    for number in 1..=sets {
        let params = set(number);
        let region = if number.is_multiple_of(2) {
            Region::ParametersB
        } else {
            Region::ParametersA
        };
        let mut bytes = [0; Region::LONGEST];
        KeptSet {
            number,
            params: &params,
        }
        .fill(&mut bytes);
        let mark = leadscrew_core::board::Mark(number).encode();
        let mut store = Store::new(&mut flash).expect("a store");
        store.write(region, &bytes).expect("written");
        store.write(Region::ParametersMark, &mark).expect("written");
    }
    flash
}

#[test]
fn a_change_of_any_bit_of_an_image_is_noticed() {
    let params = set(7);
    let mut bytes = [0; Region::LONGEST];
    let set = KeptSet {
        number: 9,
        params: &params,
    };
    assert_eq!(set.fill(&mut bytes), bytes.len());
    let mut read = Params::sheets();
    assert_eq!(KeptSet::decode(&bytes, &mut read), Ok(9));
    assert_eq!(read, params);
    for bit in 0..bytes.len() * 8 {
        let mut changed = bytes;
        changed[bit / 8] ^= 1 << (bit % 8);
        let found = KeptSet::decode(&changed, &mut read);
        assert_eq!(found, Err(KeptError::Damaged), "bit {bit}");
    }
    for length in 0..bytes.len() {
        let found = KeptSet::decode(&bytes[..length], &mut read);
        assert_eq!(found, Err(KeptError::Damaged), "{length} bytes");
    }
}

/// Bits of the whole flash, also of what the store itself has written; other ones with each commit.
#[test]
fn a_change_of_any_bit_of_the_flash_is_no_other_set() {
    let stride = leadscrew_seed::amount(17, 13);
    let mut alarms = 0;
    for sets in [1, 5] {
        let whole = stored(sets);
        for bit in (first(0, stride) as usize..PAGES * Flash::PAGE * 8).step_by(stride) {
            let mut flash = whole.clone();
            flash.turn_bit(bit);
            let up = power_up(&mut flash);
            match up.found {
                Found::Newest => assert_eq!(number(&up.params), Some(sets), "bit {bit}"),
                Found::Older => assert_eq!(number(&up.params), Some(sets - 1), "bit {bit}"),
                Found::Lost => assert_eq!(sets, 1, "bit {bit}: there was another"),
                wrong => panic!("bit {bit} of {sets}: {wrong:?}"),
            }
            alarms += u32::from(up.found != Found::Newest);
        }
    }
    assert!(alarms > 14_000 / stride as u32, "{alarms}");
}
