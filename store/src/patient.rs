//! Flash whose torn words can be read, and which the map below may wait for.

use core::future::{Future, poll_fn};
use core::task::Poll;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind};
use embedded_storage_async::nor_flash as waited;

use super::WORD;

/// Bits of a word that are zero where it marks its page.
const MARK_BITS: u32 = 4;

/// A flash that reads a word as zeros where the device below reports an error of its own. Wrong addresses stay errors,
/// and so does a device that answers nothing at all: what it holds must not be taken for damage and repaired.
///
/// The map can be shown some of the pages only ([`View`]).
pub struct Patient<F> {
    flash: F,
    view: View,
    erased: u32,
}

/// The pages that the map sees, each by its first address; the others read as erased. Nothing is changed meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// All of them.
    All,
    /// All but one.
    Without(u32),
    /// One alone, which reads as the page in use.
    Only(u32),
}

/// Why an access is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// By the device.
    Device(E),
    /// By the view.
    Hidden,
}

impl<E: NorFlashError> NorFlashError for Error<E> {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Device(error) => error.kind(),
            Self::Hidden => NorFlashErrorKind::Other,
        }
    }
}

impl<F> Patient<F> {
    /// Around a flash.
    pub const fn new(flash: F) -> Self {
        Self {
            flash,
            view: View::All,
            erased: 0,
        }
    }

    /// What the map sees from now on.
    pub const fn look(&mut self, view: View) {
        self.view = view;
    }

    /// Pages that have been erased and are not [counted](Self::counted) yet.
    pub const fn erased(&self) -> u32 {
        self.erased
    }

    /// So many of them are counted.
    pub const fn counted(&mut self, pages: u32) {
        self.erased = self.erased.saturating_sub(pages);
    }

    /// The flash back.
    pub fn into_inner(self) -> F {
        self.flash
    }
}

impl<F: NorFlash> Patient<F> {
    /// Reads whole words.
    ///
    /// # Errors
    /// Those of the flash, but for words that cannot be read.
    pub fn read_words(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), F::Error> {
        let Err(error) = self.flash.read(offset, bytes) else {
            return Ok(());
        };
        if error.kind() != NorFlashErrorKind::Other || !self.answers() {
            return Err(error);
        }
        // Word by word: what the device can read is read.
        let mut at = offset;
        for word in bytes.chunks_mut(F::WRITE_SIZE.max(1)) {
            if self.flash.read(at, word).is_err() {
                word.fill(0);
            }
            at = at.saturating_add(F::WRITE_SIZE as u32);
        }
        Ok(())
    }

    /// Erases pages.
    ///
    /// # Errors
    /// Those of the flash.
    pub fn erase_pages(&mut self, from: u32, to: u32) -> Result<(), F::Error> {
        self.flash.erase(from, to)?;
        let pages = to.saturating_sub(from).checked_div(F::ERASE_SIZE as u32);
        self.erased = self.erased.saturating_add(pages.unwrap_or(0));
        Ok(())
    }

    /// True where a word is a mark of its page. As the map judges it: a bit or two that have changed by themselves do not
    /// make one.
    ///
    /// # Errors
    /// As [`read_words`](Self::read_words).
    pub fn is_marked(&mut self, address: u32) -> Result<bool, F::Error> {
        Ok(self.zeros(address)? >= MARK_BITS)
    }

    /// Bits of a word that are zero.
    fn zeros(&mut self, address: u32) -> Result<u32, F::Error> {
        let mut word = [0xFF; WORD];
        if let Some(word) = word.get_mut(..F::WRITE_SIZE) {
            self.read_words(address, word)?;
        }
        Ok(word.iter().map(|byte| byte.count_zeros()).sum())
    }

    /// Closes a page in use that the map erases. The map does so in its own repair, in the middle of a write: it drops a
    /// target and moves everything anew. An erase that is cut could leave such a page with its mark, and with torn words
    /// where it looks free. Closed, it is seen for what it is: all pages are closed, and it has nothing but copies.
    fn close(&mut self, from: u32, to: u32) -> Result<(), F::Error> {
        if to.saturating_sub(from) != F::ERASE_SIZE as u32 || !self.is_marked(from)? {
            return Ok(());
        }
        let last = to.saturating_sub(F::WRITE_SIZE as u32);
        if self.zeros(last)? > 0 {
            return Ok(());
        }
        match [0; WORD].get(..F::WRITE_SIZE) {
            Some(mark) => self.flash.write(last, mark),
            None => Ok(()),
        }
    }

    /// True where the first word of any page can be read: so it is words that are torn, and not the device that is gone.
    fn answers(&mut self) -> bool {
        let mut word = [0; WORD];
        let Some(word) = word.get_mut(..F::WRITE_SIZE) else {
            return false;
        };
        for page in (0..self.flash.capacity()).step_by(F::ERASE_SIZE.max(1)) {
            if self.flash.read(page as u32, word).is_ok() {
                return true;
            }
        }
        false
    }
}

/// What is done when it is asked for.
fn now<T>(mut work: impl FnMut() -> T) -> impl Future<Output = T> {
    poll_fn(move |_| Poll::Ready(work()))
}

impl<F: NorFlash> Patient<F> {
    fn hides(&self, address: u32) -> bool {
        let size = (F::ERASE_SIZE as u32).max(1);
        let within = address.checked_rem(size).unwrap_or(0);
        let page = address.saturating_sub(within);
        match self.view {
            View::All => false,
            View::Without(hidden) => page == hidden,
            // Without the mark in its last word it is not closed.
            View::Only(seen) => page != seen || within >= size.saturating_sub(F::WRITE_SIZE as u32),
        }
    }

    const fn changeable(&self) -> Result<(), Error<F::Error>> {
        match self.view {
            View::All => Ok(()),
            View::Without(_) | View::Only(_) => Err(Error::Hidden),
        }
    }
}

impl<F: ErrorType> ErrorType for Patient<F> {
    type Error = Error<F::Error>;
}

impl<F: NorFlash> waited::ReadNorFlash for Patient<F> {
    // Whole words: of a torn one the first byte alone may be new, and a part of it would not tell.
    const READ_SIZE: usize = F::WRITE_SIZE;

    fn read(
        &mut self,
        offset: u32,
        bytes: &mut [u8],
    ) -> impl Future<Output = Result<(), Self::Error>> {
        now(move || {
            self.read_words(offset, bytes).map_err(Error::Device)?;
            let words = bytes.chunks_mut(F::WRITE_SIZE.max(1));
            for (address, word) in (offset..).step_by(F::WRITE_SIZE.max(1)).zip(words) {
                if self.hides(address) {
                    word.fill(0xFF);
                }
            }
            Ok(())
        })
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> waited::NorFlash for Patient<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> impl Future<Output = Result<(), Self::Error>> {
        now(move || {
            self.changeable()?;
            self.close(from, to).map_err(Error::Device)?;
            self.erase_pages(from, to).map_err(Error::Device)
        })
    }

    fn write(
        &mut self,
        offset: u32,
        bytes: &[u8],
    ) -> impl Future<Output = Result<(), Self::Error>> {
        now(move || {
            self.changeable()?;
            self.flash.write(offset, bytes).map_err(Error::Device)
        })
    }
}
