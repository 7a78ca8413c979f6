//! What a board finds in its flash: any bytes.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::board::{Found, KeptSet, Mark, PowerUp};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::offsets::Offsets;
use leadscrew_core::params::Params;
use leadscrew_store::{BUFFER, Region, Store};

use crate::params::with;

/// The first byte chooses: an entry of the tap journal, the image of a flash in a file, pages in the flash itself, a
/// parameter set, or what a board decides over two of them.
///
/// # Panics
/// Where something is taken that does not come out the same again, a store that could be written cannot be read, or a
/// board would move with a set that nobody has stored.
pub fn stored(data: &[u8]) {
    let Some((choice, bytes)) = data.split_first() else {
        return;
    };
    match choice % 5 {
        0 => {
            if let Ok(Some(record)) = TapRecord::decode(bytes) {
                assert_eq!(record.encode(), bytes);
            }
        }
        1 => {
            if let Ok(flash) = Flash::from_image(bytes) {
                assert_eq!(flash.image().as_slice(), bytes);
            }
        }
        2 => pages(bytes),
        3 => set(bytes),
        _ => power_up(bytes),
    }
}

/// Bytes as they are, and with a right checksum behind them, so that what is inside is reached.
fn set(bytes: &[u8]) {
    let mut params = Params::sheets();
    let mut summed = bytes.to_vec();
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes);
    summed.extend(sum.to_le_bytes());
    for bytes in [bytes, &summed] {
        if let Ok(table) = Offsets::decode(bytes) {
            assert_eq!(table.encode().as_ref().map(|image| &image[..]), Ok(bytes));
        }
        if let Ok(number) = KeptSet::decode(bytes, &mut params) {
            assert!(params.validate().is_ok());
            let mut again = [0; KeptSet::BYTES];
            let params = &params;
            KeptSet { number, params }.fill(&mut again);
            assert_eq!(again, bytes);
        }
    }
    if let Some(mark) = Mark::decode(bytes) {
        assert_eq!(mark.encode(), bytes);
    }
}

/// Two sets and a mark with some bytes changed. What is in force without an alarm is one of those that were stored.
fn power_up(changes: &[u8]) {
    let sets = [7, 8].map(|number: u32| (number, with(&[("9022", number.into())])));
    let mut stored = sets.each_ref().map(|(number, params)| {
        let mut bytes = vec![0; KeptSet::BYTES];
        let number = *number;
        KeptSet { number, params }.fill(&mut bytes);
        bytes
    });
    let mut mark = Mark(8).encode();
    for change in changes.chunks_exact(3) {
        let at = usize::from(u16::from_le_bytes([change[0], change[1]]));
        let [a, b] = &mut stored;
        let all = a.iter_mut().chain(b).chain(&mut mark);
        let length = 2 * KeptSet::BYTES + Mark::BYTES;
        if let Some(byte) = all.into_iter().nth(at % length) {
            *byte ^= change[2];
        }
    }
    let [a, b] = &stored;
    let built_in = Params::sheets();
    let up = PowerUp::of(Params::sheets, Ok(Some(&mark)), Ok(Some(a)), Ok(Some(b)));
    let is = |place: usize| up.params == sets[place].1;
    match up.found {
        // Only where the mark is damaged as well can the older one seem to be the newest.
        Found::Newest => assert!(is(1) || mark != Mark(8).encode() && is(0)),
        Found::Older => assert!(is(0) || is(1)),
        Found::Lost | Found::Foreign { .. } => assert_eq!(up.params, built_in),
        Found::Nothing => panic!("something was stored"),
    }
}

/// Garbage in every page; afterwards what is written is read.
fn pages(bytes: &[u8]) {
    let mut flash = Flash::with_pages(8);
    let word = Flash::WRITE_SIZE;
    for (at, chunk) in bytes.chunks_exact(word + 2).enumerate() {
        let (place, content) = chunk.split_at(2);
        let place = usize::from(u16::from_le_bytes([place[0], place[1]]));
        let words = flash.capacity() / word;
        let address = (place % words * word) as u32;
        // A word that is written already stays as it is.
        let _ = flash.write(address, content);
        if at > words {
            break;
        }
    }
    let Ok(mut store) = Store::new(flash) else {
        panic!("a flash of the right size");
    };
    let mut buffer = [0; BUFFER];
    if store.recover().is_err() {
        return;
    }
    let up = store.power_up(Params::sheets);
    assert!(up.params.validate().is_ok());
    let _ = store.read(Region::TapJournal, &mut buffer);
    if store.write(Region::TapJournal, b"written later").is_ok() {
        let read = store.read(Region::TapJournal, &mut buffer);
        assert_eq!(read, Ok(Some(&b"written later"[..])));
    }
}
