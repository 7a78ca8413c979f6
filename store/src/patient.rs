//! Flash whose torn words can be read.

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use super::WORD;

/// A flash that reads a word as zeros where the device below reports an error of its own. Wrong addresses stay errors,
/// and so does a device that answers nothing at all: what it holds must not be taken for damage and repaired.
pub struct Patient<F> {
    flash: F,
}

impl<F> Patient<F> {
    /// Around a flash.
    pub const fn new(flash: F) -> Self {
        Self { flash }
    }

    /// The flash back.
    pub fn into_inner(self) -> F {
        self.flash
    }
}

impl<F: NorFlash> Patient<F> {
    /// True where the first word of any page can be read: so it is words that are torn, and not the device that is gone.
    async fn answers(&mut self) -> bool {
        let mut word = [0; WORD];
        let Some(word) = word.get_mut(..F::WRITE_SIZE) else {
            return false;
        };
        for page in (0..self.flash.capacity()).step_by(F::ERASE_SIZE.max(1)) {
            if self.flash.read(page as u32, word).await.is_ok() {
                return true;
            }
        }
        false
    }
}

impl<F: ErrorType> ErrorType for Patient<F> {
    type Error = F::Error;
}

impl<F: NorFlash> ReadNorFlash for Patient<F> {
    // Whole words: of a torn one the first byte alone may be new, and a part of it would not tell.
    const READ_SIZE: usize = F::WRITE_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let Err(error) = self.flash.read(offset, bytes).await else {
            return Ok(());
        };
        if error.kind() != NorFlashErrorKind::Other || !self.answers().await {
            return Err(error);
        }
        // Word by word: what the device can read is read.
        let mut at = offset;
        for word in bytes.chunks_mut(F::WRITE_SIZE.max(1)) {
            if self.flash.read(at, word).await.is_err() {
                word.fill(0);
            }
            at = at.saturating_add(F::WRITE_SIZE as u32);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> NorFlash for Patient<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.flash.erase(from, to).await
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.flash.write(offset, bytes).await
    }
}
