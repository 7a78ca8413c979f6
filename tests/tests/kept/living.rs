//! A store that lives as long as its board and remembers where values are, over a flash that now and then refuses: it
//! reads what a store without memory reads.

use core::cell::{Cell, RefCell};

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use leadscrew_board_sim::plant::{Flash, FlashError};
use leadscrew_core::board::Region;
use leadscrew_store::{BUFFER, Store, StoreError};
use leadscrew_tests::random::Random;

use super::flash::PAGES;

/// A flash that refuses one write or erase.
struct Refusing<'a> {
    flash: &'a RefCell<Flash>,
    /// So many more are done until then.
    until: &'a Cell<Option<u32>>,
}

impl Refusing<'_> {
    fn accept(&self) -> Result<(), FlashError> {
        let until = self.until.get();
        self.until.set(until.and_then(|left| left.checked_sub(1)));
        if until == Some(0) {
            return Err(FlashError::NotErased);
        }
        Ok(())
    }
}

impl ErrorType for Refusing<'_> {
    type Error = FlashError;
}

impl ReadNorFlash for Refusing<'_> {
    const READ_SIZE: usize = Flash::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.flash.borrow_mut().read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.flash.borrow().capacity()
    }
}

impl NorFlash for Refusing<'_> {
    const WRITE_SIZE: usize = Flash::WRITE_SIZE;
    const ERASE_SIZE: usize = Flash::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        self.accept()?;
        self.flash.borrow_mut().erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        self.accept()?;
        self.flash.borrow_mut().write(offset, bytes)
    }
}

fn read<F: NorFlash>(store: &mut Store<F>, region: Region) -> Result<Option<Vec<u8>>, StoreError> {
    let mut buffer = [0; BUFFER];
    let held = store.read(region, &mut buffer)?;
    Ok(held.map(<[u8]>::to_vec))
}

/// A region that is written, and how long its bytes are: entries of the journal above all.
fn choose(random: &mut Random) -> (Region, i64) {
    match random.within(0, 99) {
        0..=79 => (Region::TapJournal, 70),
        80..=89 => (Region::Starts, 8),
        90..=93 => (Region::OffsetsA, 900),
        94..=95 => (Region::OffsetsMark, 8),
        96..=98 => (Region::ParametersA, 2_800),
        _ => (Region::ParametersB, 2_800),
    }
}

#[test]
fn a_store_that_a_flash_has_refused_reads_what_one_without_memory_reads() {
    leadscrew_seed::volume(5, |seed| {
        let mut random = Random(seed);
        let (mut refused, mut moved, mut ended) = (0, 0, 0);
        for _ in 0..leadscrew_seed::amount(3, 20) {
            let flash = RefCell::new(Flash::with_pages(PAGES));
            let until = Cell::new(None);
            let power_up = || {
                let mut store = Store::new(Refusing {
                    flash: &flash,
                    until: &until,
                })
                .expect("a store");
                store.recover().expect("recovered");
                store
            };
            let mut store = power_up();
            let mut held = [const { None }; Region::ALL.len()];
            for number in 0..1_000_u32 {
                let (region, length) = choose(&mut random);
                let mut bytes = number.to_le_bytes().to_vec();
                // No byte of an erased word: what is missing at its end would not be seen.
                bytes.resize(length as usize, number as u8 & 0x7F);
                if random.chance(10) {
                    until.set(Some(random.within(0, 40) as u32));
                }
                let written = store.write(region, &bytes);
                let place = Region::ALL.iter().position(|one| *one == region);
                let place = place.expect("one of them");
                match written {
                    Ok(()) => held[place] = Some(bytes),
                    Err(_) => refused += 1,
                }
                // A write that has not reached its refusal leaves it to the next one.
                let read_all = |store: &mut Store<_>| Region::ALL.map(|region| read(store, region));
                let mut living = read_all(&mut store);
                let mut copy = flash.borrow().clone();
                let mut fresh = Store::new(&mut copy).expect("a store");
                let all = Region::ALL.map(|region| read(&mut fresh, region));
                assert_eq!(living, all, "write {number}");
                // A move that was refused in its middle is ended at the next power-up.
                if living.iter().any(Result::is_err) {
                    until.set(None);
                    store = power_up();
                    living = read_all(&mut store);
                    ended += 1;
                }
                for (region, (held, living)) in Region::ALL.iter().zip(held.iter().zip(&living)) {
                    if *region != Region::Erases {
                        let living = living.as_ref().expect("readable");
                        assert_eq!(held, living, "{region:?} after write {number}");
                    }
                }
            }
            moved += flash.borrow().erases();
        }
        println!("{refused} refused, {moved} moved, {ended} ended at a power-up");
        assert!(refused > 20 && moved > 40);
    });
}
