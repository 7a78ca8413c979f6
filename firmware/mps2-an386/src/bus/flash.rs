//! The flash of the board: memory that a reset leaves as it is, through the same traits as a chip's.

use core::mem::MaybeUninit;
use core::ptr::{read_volatile, write_volatile};

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{Held, PowerUp, Region, StoreError, StoreRequest};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::params::Params;
use leadscrew_parts::{WordDevice, WordError, WordFlash};
use leadscrew_store::{BUFFER, Store};

const WORD: usize = 8;
const PAGE: usize = 4096;
const SIZE: usize = 32 * PAGE;

/// The mark before a flash that was erased once; memory at power-up does not look like it.
const MARK: u64 = 0x4C53_464C_4153_4831;

#[repr(C)]
struct Memory {
    mark: u64,
    words: [u64; SIZE / WORD],
}

// The start code neither loads nor clears this section.
#[unsafe(link_section = ".uninit.flash")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

/// The words of the flash. There is one flash, and the thread owns it.
struct Words;

impl Words {
    fn mark() -> *mut u64 {
        // The address only; its content is read and written as plain bits.
        (&raw mut MEMORY).cast()
    }

    fn place(offset: u32) -> *mut u64 {
        Self::mark().wrapping_add(1 + offset as usize / WORD)
    }

    fn get(place: *mut u64) -> u64 {
        // SAFETY: within `MEMORY`, aligned, and any bits are a number; nothing else uses it.
        unsafe { read_volatile(place) }
    }

    fn set(place: *mut u64, value: u64) {
        // SAFETY: as for reading.
        unsafe { write_volatile(place, value) }
    }
}

impl WordDevice for Words {
    const PAGE: usize = PAGE;
    const SIZE: usize = SIZE;

    fn read(&mut self, offset: u32) -> Result<[u8; WORD], WordError> {
        Ok(Self::get(Self::place(offset)).to_le_bytes())
    }

    fn write(&mut self, offset: u32, word: [u8; WORD]) -> Result<(), WordError> {
        let place = Self::place(offset);
        if Self::get(place) != u64::MAX {
            return Err(WordError::Refused);
        }
        Self::set(place, u64::from_le_bytes(word));
        Ok(())
    }

    fn erase(&mut self, page: u32) -> Result<(), WordError> {
        for offset in (page..page + PAGE as u32).step_by(WORD) {
            Self::set(Self::place(offset), u64::MAX);
        }
        Ok(())
    }
}

/// The regions of the flash.
pub struct RamFlash(());

impl RamFlash {
    /// The flash as the reset has left it; erased at power-up.
    pub fn power_up() -> Self {
        if Words::get(Words::mark()) != MARK {
            for page in (0..SIZE as u32).step_by(PAGE) {
                // This erase cannot fail.
                let _ = Words.erase(page);
            }
            Words::set(Words::mark(), MARK);
        }
        Self(())
    }

    fn store(&self) -> Result<Store<WordFlash<Words>>, StoreError> {
        Store::new(WordFlash(Words))
    }

    /// The entry of the tap journal, if there is one. Before the read, this repairs what a loss of power has left
    /// unfinished.
    ///
    /// # Errors
    /// [`Code::TapJournalDamaged`].
    pub fn tap(&mut self) -> Result<Option<TapRecord>, Alarm> {
        let damaged = Alarm::new(Code::TapJournalDamaged, Span::default());
        let mut buffer = [0; BUFFER];
        let mut store = self.store().map_err(|_| damaged)?;
        store.recover().map_err(|_| damaged)?;
        match store
            .read(Region::TapJournal, &mut buffer)
            .map_err(|_| damaged)?
        {
            Some(bytes) => TapRecord::decode(bytes).map_err(|_| damaged),
            None => Ok(None),
        }
    }

    /// The parameter set for the start, which counts. Call [`tap`](Self::tap) first.
    ///
    /// # Errors
    /// [`StoreError::Device`].
    pub fn params(&mut self, built_in: &Params) -> Result<PowerUp, StoreError> {
        let mut store = self.store()?;
        let mut up = store.power_up(|| built_in.clone());
        up.start = store.count_start();
        Ok(up)
    }

    /// Reads a region.
    ///
    /// # Errors
    /// As [`Store::read`].
    pub fn read<'b>(&mut self, region: Region, buffer: &'b mut [u8; BUFFER]) -> Held<'b> {
        self.store()?.read(region, buffer)
    }

    /// Stores the request's data, as [`Store::keep`]. Gives also how often each page has been erased, where it is more.
    pub fn write(&mut self, request: &StoreRequest<'_>) -> (Result<(), StoreError>, Option<u32>) {
        match self.store() {
            Ok(mut store) => (store.keep(request), store.more_erases()),
            Err(error) => (Err(error), None),
        }
    }
}
