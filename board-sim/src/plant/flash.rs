//! The flash of a microcontroller: words of 8 bytes that are written once, and 32 pages of 4 KiB that are erased whole
//! (two of an STM32G474's each).
//! The power can fail at any byte of both.
//!
//! A word during whose write the power fails is torn: its first bytes are new, the rest is erased. A torn word reads
//! half written, or not at all because its error correction does not fit; this depends on the device ([`Tear`]).

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// The result of a write or an erase during which the power failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tear {
    /// A torn word cannot be read (an ECC error); otherwise it reads half written.
    pub unreadable: bool,
    /// The words of a page that an erase reaches first.
    pub order: Order,
}

/// The words of a page that an erase reaches first. A real erase works on all cells at once, so its remains are scattered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// The words at the beginning.
    #[default]
    Rising,
    /// The words at the end.
    Falling,
    /// Scattered words, others for each erase.
    Scattered,
}

impl Tear {
    /// Every combination.
    pub const ALL: [Self; 6] = {
        const fn tear(unreadable: bool, order: Order) -> Tear {
            Tear { unreadable, order }
        }
        [
            tear(false, Order::Rising),
            tear(true, Order::Rising),
            tear(false, Order::Falling),
            tear(true, Order::Falling),
            tear(false, Order::Scattered),
            tear(true, Order::Scattered),
        ]
    };
}

impl Order {
    /// The word of a page that is erased as number `nth`. `turn` is a different number for each erase.
    const fn word(self, nth: usize, turn: usize) -> usize {
        match self {
            Self::Rising => nth,
            Self::Falling => Flash::PAGE_WORDS.wrapping_sub(1).wrapping_sub(nth),
            // The factor is odd and the words of a page are a power of two: so each word comes once.
            Self::Scattered => nth.wrapping_mul(149).wrapping_add(turn) % Flash::PAGE_WORDS,
        }
    }
}

/// Why an access failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// The power is off.
    NoPower,
    /// The word cannot be read.
    Unreadable,
    /// The program writes a word that is not erased.
    NotErased,
    /// Not at the beginning of a word or page, or outside the flash.
    Address,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::NoPower | Self::Unreadable | Self::NotErased => NorFlashErrorKind::Other,
            Self::Address => NorFlashErrorKind::OutOfBounds,
        }
    }
}

/// Why bytes are not an image of a flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// Of a flash of eight pages, as boards had it before.
    Earlier,
    /// Not the length of an image: the number of bytes.
    Length(usize),
    /// They do not begin with the mark: they are something else.
    Foreign,
    /// The checksum does not fit.
    Damaged,
}

/// The flash of a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flash {
    bytes: [u8; Self::SIZE],
    /// Bytes that there are.
    size: usize,
    /// One bit for each word that cannot be read.
    unreadable: [u8; Self::WORDS / 8],
    tear: Tear,
    /// Bytes that can still be written or erased before the power fails.
    left: Option<u32>,
    off: bool,
    /// Every write is refused.
    broken: bool,
    /// Writes that are still possible before the flash refuses all.
    writes_left: Option<u32>,
    /// Pages that can still be erased before the flash refuses to erase.
    erases_left: Option<u32>,
    written: u32,
    erased: u32,
}

impl Default for Flash {
    fn default() -> Self {
        Self::erased()
    }
}

impl Flash {
    /// Bytes of a word.
    pub const WORD: usize = 8;
    /// Bytes of a page.
    pub const PAGE: usize = 4096;
    /// Pages.
    pub const PAGES: usize = 32;
    /// Bytes in all.
    pub const SIZE: usize = Self::PAGES * Self::PAGE;
    /// Bytes of an [image](Self::image).
    pub const IMAGE: usize = Self::MARK.len() + Self::SIZE + Self::WORDS / 8 + 4;
    const EARLIER: usize = Self::MARK.len() + 8 * (Self::PAGE + Self::PAGE_WORDS / 8) + 4;

    const WORDS: usize = Self::SIZE / Self::WORD;
    const PAGE_WORDS: usize = Self::PAGE / Self::WORD;
    const MARK: [u8; 8] = *b"LSFLASH1";

    /// A flash that was never written.
    #[must_use]
    pub const fn erased() -> Self {
        Self {
            bytes: [0xFF; Self::SIZE],
            size: Self::SIZE,
            unreadable: [0; Self::WORDS / 8],
            tear: Tear {
                unreadable: false,
                order: Order::Rising,
            },
            left: None,
            off: false,
            broken: false,
            writes_left: None,
            erases_left: None,
            written: 0,
            erased: 0,
        }
    }

    /// One with so many pages alone, which are erased in turn the sooner. Its [image](Self::image) is that of a whole one.
    #[must_use]
    pub const fn with_pages(pages: usize) -> Self {
        let mut flash = Self::erased();
        if pages < Self::PAGES {
            flash.size = pages.saturating_mul(Self::PAGE);
        }
        flash
    }

    /// Turns a bit over, as an old cell may do by itself; none beyond eight times [`SIZE`](Self::SIZE).
    pub fn turn_bit(&mut self, bit: usize) {
        if let Some(byte) = self.bytes.get_mut(bit / 8) {
            *byte ^= 1 << (bit % 8);
        }
    }

    /// The whole content, to be kept: a mark, the bytes, the bits of unreadable words, and a CRC-32.
    #[must_use]
    pub fn image(&self) -> [u8; Self::IMAGE] {
        let mut image = [0; Self::IMAGE];
        let content = self.content();
        for (place, byte) in image.iter_mut().zip(content.clone()) {
            *place = byte;
        }
        let sum = checksum(content);
        if let Some(place) = image.last_chunk_mut::<4>() {
            *place = sum.to_le_bytes();
        }
        image
    }

    fn content(&self) -> impl Iterator<Item = u8> + Clone {
        Self::MARK
            .into_iter()
            .chain(self.bytes.iter().copied())
            .chain(self.unreadable.iter().copied())
    }

    /// The flash of an [image](Self::image), with its power on.
    ///
    /// # Errors
    /// The bytes are not an image.
    pub fn from_image(image: &[u8]) -> Result<Self, ImageError> {
        if !image.starts_with(&Self::MARK) {
            return Err(ImageError::Foreign);
        }
        if image.len() == Self::EARLIER {
            return Err(ImageError::Earlier);
        }
        if image.len() != Self::IMAGE {
            return Err(ImageError::Length(image.len()));
        }
        let wrong = ImageError::Length(image.len());
        let (content, sum) = image.split_last_chunk::<4>().ok_or(wrong)?;
        if checksum(content.iter().copied()) != u32::from_le_bytes(*sum) {
            return Err(ImageError::Damaged);
        }
        let (_, rest) = content.split_first_chunk::<8>().ok_or(wrong)?;
        let (bytes, unreadable) = rest.split_first_chunk().ok_or(wrong)?;
        Ok(Self {
            bytes: *bytes,
            unreadable: unreadable.try_into().map_err(|_| wrong)?,
            ..Self::erased()
        })
    }

    /// Sets how torn writes look from now on.
    pub const fn set_tear(&mut self, tear: Tear) {
        self.tear = tear;
    }

    /// Lets the power fail after this number of written or erased bytes.
    pub const fn cut_after(&mut self, bytes: u32) {
        self.left = Some(bytes);
    }

    /// Switches the power off or on.
    pub const fn power(&mut self, on: bool) {
        self.off = !on;
        self.left = None;
    }

    /// True while the flash has power.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        !self.off
    }

    /// Refuses every write and erase, or takes them again.
    pub const fn set_broken(&mut self, broken: bool) {
        self.broken = broken;
    }

    /// Refuses every write and erase after this number of writes.
    pub const fn fail_after(&mut self, writes: u32) {
        self.writes_left = Some(writes);
    }

    /// Wears the flash out: it refuses to erase after this number of pages, but still writes to erased words.
    pub const fn wear_out_after(&mut self, pages: u32) {
        self.erases_left = Some(pages);
    }

    /// Bytes written and erased so far; a test chooses by it where to cut.
    #[must_use]
    pub const fn written(&self) -> u32 {
        self.written
    }

    /// Pages erased so far, each as often as it was.
    #[must_use]
    pub const fn erases(&self) -> u32 {
        self.erased
    }

    /// The number of the `wanted` bytes that can be changed before the power fails. The power fails if they are fewer.
    fn spend(&mut self, wanted: usize) -> usize {
        let wanted = u32::try_from(wanted).unwrap_or(u32::MAX);
        let got = self.left.map_or(wanted, |left| left.min(wanted));
        if let Some(left) = &mut self.left {
            *left = left.wrapping_sub(got);
        }
        self.off |= got < wanted;
        self.written = self.written.wrapping_add(got);
        got as usize
    }

    fn check(&self, offset: u32, length: usize, grain: usize) -> Result<usize, FlashError> {
        if self.off {
            return Err(FlashError::NoPower);
        }
        let from = usize::try_from(offset).map_err(|_| FlashError::Address)?;
        let aligned = from.is_multiple_of(grain) && length.is_multiple_of(grain);
        let inside = from.checked_add(length).is_some_and(|end| end <= self.size);
        if aligned && inside {
            Ok(from)
        } else {
            Err(FlashError::Address)
        }
    }

    fn mark(&mut self, word: usize, unreadable: bool) {
        let bit = 1 << (word % 8);
        if let Some(bits) = self.unreadable.get_mut(word / 8) {
            *bits = if unreadable {
                *bits | bit
            } else {
                *bits & !bit
            };
        }
    }

    fn is_marked(&self, word: usize) -> bool {
        let bits = self.unreadable.get(word / 8).copied().unwrap_or(0);
        bits & (1 << (word % 8)) != 0
    }

    fn write_word(&mut self, at: usize, word: &[u8]) -> Result<(), FlashError> {
        let index = at / Self::WORD;
        let place = self.bytes.get(at..at.wrapping_add(Self::WORD));
        let erased = place.is_some_and(|place| place.iter().all(|byte| *byte == 0xFF));
        if !erased || self.is_marked(index) {
            return Err(FlashError::NotErased);
        }
        let got = self.spend(Self::WORD);
        for (place, byte) in self.bytes.iter_mut().skip(at).zip(word).take(got) {
            *place = *byte;
        }
        if got < Self::WORD {
            self.mark(index, self.tear.unreadable && got > 0);
            return Err(FlashError::NoPower);
        }
        Ok(())
    }

    fn erase_page(&mut self, at: usize) -> Result<(), FlashError> {
        let turn = self.written as usize / Self::WORD;
        let got = self.spend(Self::PAGE);
        let Tear { unreadable, order } = self.tear;
        for nth in 0..got.div_ceil(Self::WORD) {
            // The last word may be erased in part only.
            let erased = got
                .wrapping_sub(nth.wrapping_mul(Self::WORD))
                .min(Self::WORD);
            let word = order.word(nth, turn);
            let from = at.wrapping_add(word.wrapping_mul(Self::WORD));
            // An erase from the end reaches the end of the word first.
            let kept = if order == Order::Falling {
                Self::WORD.wrapping_sub(erased)
            } else {
                0
            };
            let first = from.wrapping_add(kept);
            for byte in self.bytes.iter_mut().skip(first).take(erased) {
                *byte = 0xFF;
            }
            self.mark(from / Self::WORD, unreadable && erased < Self::WORD);
        }
        if got < Self::PAGE {
            return Err(FlashError::NoPower);
        }
        self.erased = self.erased.wrapping_add(1);
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = self.check(offset, bytes.len(), 1)?;
        let end = from.wrapping_add(bytes.len());
        if (from / Self::WORD..end.div_ceil(Self::WORD)).any(|word| self.is_marked(word)) {
            return Err(FlashError::Unreadable);
        }
        for (to, byte) in bytes.iter_mut().zip(self.bytes.iter().skip(from)) {
            *to = *byte;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.size
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = Self::WORD;
    const ERASE_SIZE: usize = Self::PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::Address)?;
        let from = self.check(from, length as usize, Self::PAGE)?;
        if self.broken || self.writes_left == Some(0) {
            return Err(FlashError::NotErased);
        }
        (from..from.wrapping_add(length as usize))
            .step_by(Self::PAGE)
            .try_for_each(|page| {
                let left = &mut self.erases_left;
                if *left == Some(0) {
                    return Err(FlashError::NotErased);
                }
                *left = left.map(|left| left.saturating_sub(1));
                self.erase_page(page)
            })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let from = self.check(offset, bytes.len(), Self::WORD)?;
        if self.broken || self.writes_left == Some(0) {
            return Err(FlashError::NotErased);
        }
        self.writes_left = self.writes_left.map(|left| left.saturating_sub(1));
        let words = (from..).step_by(Self::WORD).zip(bytes.chunks(Self::WORD));
        for (at, word) in words {
            self.write_word(at, word)?;
        }
        Ok(())
    }
}

/// CRC-32 (ISO-HDLC).
fn checksum(bytes: impl Iterator<Item = u8>) -> u32 {
    const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = CRC.digest();
    for byte in bytes {
        digest.update(&[byte]);
    }
    digest.finalize()
}
