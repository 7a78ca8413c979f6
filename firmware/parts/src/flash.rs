//! The traits of storage on a flash of words with error correction.
//!
//! A word can be written once between two erases. A word may be unreadable where the power failed during its write: the
//! chip's error correction reports that. Here such a word reads as an error. The storage code handles this error; it
//! must not stop the program. The functions wait for the chip: only the background may use them.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Why an access failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordError {
    /// The error correction cannot repair the word.
    Unreadable,
    /// The chip refuses: the word is not erased, the memory is protected, or worn out.
    Refused,
    /// Not at the beginning of a word or page, or outside the memory.
    Address,
}

impl NorFlashError for WordError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Unreadable | Self::Refused => NorFlashErrorKind::Other,
            Self::Address => NorFlashErrorKind::OutOfBounds,
        }
    }
}

/// Bytes of a word: the unit of programming, correction and reading.
const WORD: usize = 8;

/// The chip's side: whole words and pages, at checked offsets.
pub trait WordDevice {
    /// Bytes of a page.
    const PAGE: usize;
    /// Bytes in all.
    const SIZE: usize;

    /// Reads a word.
    ///
    /// # Errors
    /// [`WordError::Unreadable`].
    fn read(&mut self, offset: u32) -> Result<[u8; WORD], WordError>;

    /// Writes a word that is erased.
    ///
    /// # Errors
    /// [`WordError::Refused`].
    fn write(&mut self, offset: u32, word: [u8; WORD]) -> Result<(), WordError>;

    /// Erases a page.
    ///
    /// # Errors
    /// [`WordError::Refused`].
    fn erase(&mut self, page: u32) -> Result<(), WordError>;
}

/// The traits of storage for a device.
#[derive(Debug)]
pub struct WordFlash<D>(pub D);

impl<D: WordDevice> WordFlash<D> {
    /// Checks an access: offset and length are multiples of `grain`, and the access stays inside the memory.
    fn check(offset: u32, length: usize, grain: usize) -> Result<(), WordError> {
        let from = usize::try_from(offset).map_err(|_| WordError::Address)?;
        let on_grain = from.is_multiple_of(grain) && length.is_multiple_of(grain);
        let inside = from.checked_add(length).is_some_and(|end| end <= D::SIZE);
        if on_grain && inside {
            Ok(())
        } else {
            Err(WordError::Address)
        }
    }
}

impl<D> ErrorType for WordFlash<D> {
    type Error = WordError;
}

impl<D: WordDevice> ReadNorFlash for WordFlash<D> {
    const READ_SIZE: usize = WORD;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), WordError> {
        Self::check(offset, bytes.len(), WORD)?;
        for (at, place) in (offset..).step_by(WORD).zip(bytes.chunks_exact_mut(WORD)) {
            place.copy_from_slice(&self.0.read(at)?);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        D::SIZE
    }
}

impl<D: WordDevice> NorFlash for WordFlash<D> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = D::PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), WordError> {
        let length = to.checked_sub(from).ok_or(WordError::Address)?;
        Self::check(from, length as usize, D::PAGE)?;
        (from..to)
            .step_by(D::PAGE)
            .try_for_each(|page| self.0.erase(page))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), WordError> {
        Self::check(offset, bytes.len(), WORD)?;
        let (words, _) = bytes.as_chunks::<WORD>();
        (offset..)
            .step_by(WORD)
            .zip(words)
            .try_for_each(|(at, word)| self.0.write(at, *word))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use leadscrew_store::{Region, Store, StoreError};

    use super::*;

    /// A chip with four pages, and words that are unreadable.
    struct Chip {
        words: Vec<[u8; WORD]>,
        torn: Vec<u32>,
        refuses: bool,
    }

    impl Chip {
        fn erased() -> Self {
            Self {
                words: vec![[0xFF; WORD]; Self::SIZE / WORD],
                torn: Vec::new(),
                refuses: false,
            }
        }
    }

    impl WordDevice for Chip {
        const PAGE: usize = 2048;
        const SIZE: usize = 4 * Self::PAGE;

        fn read(&mut self, offset: u32) -> Result<[u8; WORD], WordError> {
            if self.torn.contains(&offset) {
                return Err(WordError::Unreadable);
            }
            Ok(self.words[offset as usize / WORD])
        }

        fn write(&mut self, offset: u32, word: [u8; WORD]) -> Result<(), WordError> {
            let place = &mut self.words[offset as usize / WORD];
            if self.refuses || *place != [0xFF; WORD] {
                return Err(WordError::Refused);
            }
            *place = word;
            Ok(())
        }

        fn erase(&mut self, page: u32) -> Result<(), WordError> {
            let from = page as usize / WORD;
            self.words[from..from + Self::PAGE / WORD].fill([0xFF; WORD]);
            self.torn
                .retain(|at| !(page..page + Self::PAGE as u32).contains(at));
            Ok(())
        }
    }

    #[test]
    fn what_is_written_is_read_and_an_erase_takes_whole_pages() {
        let mut flash = WordFlash(Chip::erased());
        let bytes: Vec<u8> = (0..64).collect();
        flash.write(2040, &bytes).unwrap();
        let mut read = [0; 64];
        flash.read(2040, &mut read).unwrap();
        assert_eq!(read[..], bytes[..]);
        flash.erase(2048, 4096).unwrap();
        flash.read(2040, &mut read).unwrap();
        assert_eq!(read[..8], bytes[..8]);
        assert_eq!(read[8..], [0xFF; 56]);
    }

    #[test]
    fn a_torn_word_is_an_error_and_its_neighbours_are_not() {
        let mut flash = WordFlash(Chip::erased());
        flash.0.torn.push(16);
        let mut word = [0; WORD];
        assert_eq!(flash.read(16, &mut word), Err(WordError::Unreadable));
        assert_eq!(flash.read(8, &mut word), Ok(()));
        assert_eq!(flash.read(24, &mut word), Ok(()));
        assert_eq!(WordError::Unreadable.kind(), NorFlashErrorKind::Other);
    }

    #[test]
    fn nothing_goes_beside_a_word_a_page_or_the_end() {
        let mut flash = WordFlash(Chip::erased());
        let mut word = [0; WORD];
        let outside = Err(WordError::Address);
        assert_eq!(flash.read(4, &mut word), outside);
        assert_eq!(flash.read(8192, &mut word), outside);
        assert_eq!(flash.read(u32::MAX - 7, &mut word), outside);
        assert_eq!(flash.write(0, &[0; 7]), outside);
        assert_eq!(flash.write(8184, &[0; 16]), outside);
        assert_eq!(flash.erase(0, 1000), outside);
        assert_eq!(flash.erase(2048, 0), outside);
        assert_eq!(flash.erase(6144, 10240), outside);
        assert_eq!(WordError::Address.kind(), NorFlashErrorKind::OutOfBounds);
    }

    #[test]
    fn a_board_keeps_its_regions_in_it_also_over_a_torn_word() {
        let mut flash = WordFlash(Chip::erased());
        let mut buffer = [0; leadscrew_store::BUFFER];
        for round in 0..200_u8 {
            let mut store = Store::new(flash).unwrap();
            store.recover().unwrap();
            store.write(Region::TapJournal, &[round; 40]).unwrap();
            flash = store.into_flash();
        }
        // A cut would tear the word after the newest value: the next write goes there.
        let end = flash.0.words.iter().rposition(|word| *word != [0xFF; WORD]);
        let next = (end.unwrap() + 1) * WORD;
        flash.0.torn.push(u32::try_from(next % Chip::SIZE).unwrap());
        let mut store = Store::new(flash).unwrap();
        store.recover().unwrap();
        let read = store.read(Region::TapJournal, &mut buffer).unwrap();
        assert_eq!(read, Some(&[199; 40][..]));
    }

    #[test]
    fn a_chip_that_refuses_is_told_as_such() {
        let mut chip = Chip::erased();
        chip.refuses = true;
        let mut store = Store::new(WordFlash(chip)).unwrap();
        let written = store.write(Region::TapJournal, &[1; 40]);
        assert_eq!(written, Err(StoreError::Device));
    }
}
