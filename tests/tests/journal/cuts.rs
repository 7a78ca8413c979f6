//! Power that goes at every byte of a write: what was stored before, or what is being stored.

use leadscrew_board_sim::plant::{Flash, Tear};
use leadscrew_core::call::{Hand, TapAxis, TapNotes, TapSpindle};
use leadscrew_core::journal::{TapHole, TapRecord};
use leadscrew_core::units::{CentiRpm, Lead, Length, Turns};
use leadscrew_store::{BUFFER, Region, Store, StoreError};
use leadscrew_tests::random::Random;

/// Writes until every page has been erased once and the first is being filled again.
const WRITES: u32 = 480;
/// Pages of the flash of these tests: fewer than a board has, and the same.
const PAGES: usize = 8;

/// Entry `sequence` of a hole that is pecked.
fn entry(sequence: u32) -> TapRecord {
    let depth = i64::from(sequence) * 750_000;
    TapRecord {
        sequence,
        in_hole: sequence % 28 != 27,
        hole: TapHole {
            axis: TapAxis::Z,
            level: Length::ZERO,
            bottom: Length::from_nm(-50_000_000),
            lead: Lead::new(2_000_000_000, 1000).expect("a lead"),
            hand: Hand::Right,
            spindle: TapSpindle::First,
            speed: CentiRpm::new(100_000),
            notes: TapNotes::default(),
        },
        position: Length::from_nm(-depth),
        angle: Turns::from_raw(depth << 12),
    }
}

fn write(flash: &mut Flash, sequence: u32) -> Result<(), StoreError> {
    let mut store = Store::new(flash)?;
    store.write(Region::TapJournal, &entry(sequence).encode())
}

fn recover(flash: &mut Flash) -> Result<(), StoreError> {
    Store::new(flash)?.recover()
}

fn read(flash: &mut Flash) -> Result<Option<TapRecord>, StoreError> {
    let mut buffer = [0; BUFFER];
    let mut store = Store::new(flash)?;
    let bytes = store.read(Region::TapJournal, &mut buffer)?;
    Ok(bytes.and_then(|bytes| TapRecord::decode(bytes).expect("a whole entry")))
}

/// The entry that is stored after the power has come back, if the power went while `new` was being written.
fn after_power_up(flash: &mut Flash, new: u32) -> Option<u32> {
    flash.power(true);
    recover(flash).expect("recovered");
    let found = read(flash).expect("readable").map(|record| {
        assert_eq!(record, entry(record.sequence), "a mixture");
        record.sequence
    });
    let old = new.checked_sub(1);
    assert!(
        found == old || found == Some(new),
        "{found:?} after the power went while {new} was written"
    );
    found
}

/// The flash before each write, and the bytes that write takes.
fn history(tear: Tear) -> Vec<(Flash, u32)> {
    let mut flash = Flash::with_pages(PAGES);
    flash.set_tear(tear);
    (0..WRITES)
        .map(|sequence| {
            let before = flash.clone();
            write(&mut flash, sequence).expect("written");
            assert_eq!(read(&mut flash), Ok(Some(entry(sequence))));
            let bytes = flash.written() - before.written();
            (before, bytes)
        })
        .collect()
}

#[test]
fn a_cut_at_every_byte_leaves_the_old_entry_or_the_new_one() {
    let stride = leadscrew_seed::amount(5, 1);
    let mut cuts = 0;
    let mut erases = 0;
    for tear in Tear::ALL {
        // The first half fills the pages.
        let history = history(tear);
        for (sequence, (before, bytes)) in history.iter().enumerate().skip(history.len() / 2) {
            let sequence = sequence as u32;
            erases += u32::from(*bytes > Flash::PAGE as u32);
            for cut in (0..*bytes).step_by(stride) {
                let mut flash = before.clone();
                flash.cut_after(cut);
                let written = write(&mut flash, sequence);
                assert!(!flash.is_on(), "cut at {cut}");
                let found = after_power_up(&mut flash, sequence);
                // Behind an entry a page's erase may be counted.
                assert!(written.is_err() || found == Some(sequence), "cut at {cut}");
                // Everything works again.
                write(&mut flash, sequence + 1).expect("written");
                assert_eq!(read(&mut flash), Ok(Some(entry(sequence + 1))));
                cuts += 1;
            }
        }
    }
    assert!(erases >= 8, "{erases}");
    assert!(cuts >= 75_000 / stride as u32, "{cuts}");
}

/// Power that goes again and again, also during the repair of the last damage.
#[test]
fn cuts_upon_cuts_lose_nothing() {
    leadscrew_seed::volume(7, |seed| {
        let mut random = Random(seed);
        let rounds = leadscrew_seed::amount(12, 300);
        let mut cuts = 0;
        for round in 0..rounds {
            let mut flash = Flash::with_pages(PAGES);
            flash.set_tear(Tear::ALL[round % Tear::ALL.len()]);
            let mut stored = None;
            for sequence in 0..300_u32 {
                if random.chance(33) {
                    let most = random.of(&[100, 2300]);
                    flash.cut_after(random.within(0, most) as u32);
                }
                let new = stored.map_or(0, |stored: u32| stored + 1);
                if write(&mut flash, new).is_ok() {
                    flash.power(true);
                    stored = Some(new);
                    continue;
                }
                cuts += 1;
                flash.power(true);
                // The power may go in the repair as well.
                while random.chance(50) {
                    flash.cut_after(random.within(0, 2300) as u32);
                    let repaired = recover(&mut flash).and_then(|()| read(&mut flash).map(|_| ()));
                    cuts += u32::from(repaired.is_err());
                    flash.power(true);
                }
                recover(&mut flash).expect("recovered");
                let found = read(&mut flash).expect("readable");
                let found = found.map(|record| {
                    assert_eq!(record, entry(record.sequence), "a mixture");
                    record.sequence
                });
                assert!(
                    found == stored || found == Some(new),
                    "round {round}, write {sequence}: {found:?} where {stored:?} was stored"
                );
                stored = found;
            }
        }
        assert!(cuts > 40 * rounds as u32, "{cuts}");
    });
}

#[test]
fn a_device_that_refuses_is_an_error_and_the_old_entry_stays() {
    let mut flash = Flash::erased();
    write(&mut flash, 0).expect("written");
    flash.set_broken(true);
    assert_eq!(write(&mut flash, 1), Err(StoreError::Device));
    assert_eq!(read(&mut flash), Ok(Some(entry(0))));
    flash.set_broken(false);
    flash.power(false);
    assert_eq!(read(&mut flash), Err(StoreError::Device));
    flash.power(true);
    write(&mut flash, 1).expect("written");
    assert_eq!(read(&mut flash), Ok(Some(entry(1))));
}

#[test]
fn an_image_keeps_the_flash_and_nothing_else_is_taken_for_one() {
    use leadscrew_board_sim::plant::ImageError;
    let mut flash = Flash::erased();
    flash.set_tear(Tear::ALL[1]);
    write(&mut flash, 0).expect("written");
    flash.cut_after(12);
    assert!(write(&mut flash, 1).is_err());
    let image = flash.image();
    let mut again = Flash::from_image(&image).expect("an image");
    assert_eq!(again.image(), image);
    assert_eq!(after_power_up(&mut again, 1), Some(0));

    let refused = |bytes: &[u8]| Flash::from_image(bytes).expect_err("no image");
    assert_eq!(refused(b""), ImageError::Foreign);
    assert_eq!(refused(&[0xFF; Flash::IMAGE]), ImageError::Foreign);
    let short = &image[..Flash::IMAGE - 1];
    assert_eq!(refused(short), ImageError::Length(Flash::IMAGE - 1));
    for place in (8..Flash::IMAGE).step_by(97) {
        let mut damaged = image;
        damaged[place] ^= 0x10;
        assert_eq!(refused(&damaged), ImageError::Damaged, "{place}");
    }
}

/// A mirror of what the real device says: a word is written once, and only an erase of its page frees it.
#[test]
fn a_word_that_is_not_erased_is_not_written() {
    use embedded_storage::nor_flash::NorFlash;
    use leadscrew_board_sim::plant::FlashError;
    let mut flash = Flash::erased();
    let zeros = [0; 8];
    assert_eq!(flash.write(8, &zeros), Ok(()));
    assert_eq!(flash.write(8, &zeros), Err(FlashError::NotErased));
    assert_eq!(flash.write(4, &zeros), Err(FlashError::Address));
    let end = Flash::SIZE as u32;
    assert_eq!(flash.write(end, &zeros), Err(FlashError::Address));
    assert_eq!(flash.erase(0, 100), Err(FlashError::Address));
    assert_eq!(flash.erase(0, Flash::PAGE as u32), Ok(()));
    assert_eq!(flash.write(8, &zeros), Ok(()));
}
