//! What a board finds in its flash: any bytes.

use embedded_storage_async::nor_flash::{NorFlash, ReadNorFlash};
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::journal::TapRecord;
use leadscrew_store::{BUFFER, Region, Store, block_on};

/// The first byte chooses: an entry of the tap journal, the image of a flash in a file, or pages in the flash itself.
///
/// # Panics
/// Where an entry is taken that does not come out the same again, or a store that could be written cannot be read.
pub fn stored(data: &[u8]) {
    let Some((choice, bytes)) = data.split_first() else {
        return;
    };
    match choice % 3 {
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
        _ => pages(bytes),
    }
}

/// Garbage in every page; afterwards what is written is read.
fn pages(bytes: &[u8]) {
    let mut flash = Flash::erased();
    let word = Flash::WRITE_SIZE;
    for (at, chunk) in bytes.chunks_exact(word + 2).enumerate() {
        let (place, content) = chunk.split_at(2);
        let place = usize::from(u16::from_le_bytes([place[0], place[1]]));
        let words = flash.capacity() / word;
        let address = (place % words * word) as u32;
        // A word that is written already stays as it is.
        let _ = block_on(flash.write(address, content));
        if at > words {
            break;
        }
    }
    let Ok(mut store) = Store::new(flash) else {
        panic!("a flash of the right size");
    };
    let mut buffer = [0; BUFFER];
    if block_on(store.recover()).is_err() {
        return;
    }
    let _ = block_on(store.read(Region::TapJournal, &mut buffer));
    if block_on(store.write(Region::TapJournal, b"written later")).is_ok() {
        let read = block_on(store.read(Region::TapJournal, &mut buffer));
        assert_eq!(read, Ok(Some(&b"written later"[..])));
    }
}
