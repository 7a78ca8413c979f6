#![no_std]
//! What a board keeps over a loss of power, in NOR flash: [regions](Region) of bytes, the newest of each.
//!
//! The power may go at any byte of any write or erase. Afterwards a region holds what it held before, or what was being
//! written: never a mixture, never nothing. `sequential-storage` appends values and moves them from page to page; this room
//! adds what it leaves to the flash below it and to the owner above it:
//!
//! - a word that was torn in the middle may read as an error (a real controller's
//!   ECC): [`Patient`] reads it as zeros, which no checksum takes for a value;
//! - an erase that was cut may leave anything on its page, and the moving of values from page to page half done:
//!   [`Store::recover`] ends both, before anything else is done;
//! - a page bears some thousand erases: they are [counted](Store::erases), with one write for each. Where the power goes
//!   between the two, that erase is not counted.
//!
//! Knows regions and flash; knows nothing of what the bytes mean. The same code runs in firmware and in simulation. The
//! flash is one whose operations end by themselves (simulated, or a driver that waits for its chip):
//! `sequential-storage` would let others run meanwhile, of which there are none here.
//!
//! ```
//! use leadscrew_board_sim::plant::Flash;
//! use leadscrew_store::{BUFFER, Region, Store};
//!
//! let mut store = Store::new(Flash::erased())?;
//! store.write(Region::TapJournal, b"the hole that a tap is in")?;
//!
//! let mut buffer = [0; BUFFER];
//! let mut again = Store::new(store.into_flash())?;
//! let read = again.read(Region::TapJournal, &mut buffer)?;
//! assert_eq!(read, Some(&b"the hole that a tap is in"[..]));
//! # Ok::<(), leadscrew_store::StoreError>(())
//! ```

mod patient;
mod recover;
mod value;
mod wait;

pub use leadscrew_core::board::{Region, StoreError, StoreRequest};
pub use patient::Patient;

use embedded_storage::nor_flash::NorFlash;
use leadscrew_core::board::{Held, KeptOffsets, Mark, PowerUp};
use leadscrew_core::params::Params;
use sequential_storage::Error;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage, Value};

use value::Wanted;
use wait::block_on;

/// A set of a later parameter table may be so much longer, and is still read: as what it is.
const SPARE: usize = 256;

/// Bytes of a buffer for the longest value, with its key and the padding of a flash word.
pub const BUFFER: usize = (Region::LONGEST + SPARE + 1).next_multiple_of(WORD);

/// Word and page of the largest flash this is made for.
const WORD: usize = 32;

/// Where the newest value of each region is. Without it all pages would be looked through for a value that has not been
/// written for long, and that for each old one of a page that is moved: seconds, in a flash of many pages.
type Places = Cache<Uncached, Uncached, ArrayKeyPointers<u8, { Region::ALL.len() }>, u8>;
type Map<F> = MapStorage<u8, Patient<F>, Places>;

/// Regions in all of a flash. It can be made anew for every access: what it knows of places it finds again.
pub struct Store<F: NorFlash> {
    map: Map<F>,
    /// Erases of all pages, where they have become more and nobody has asked.
    erases: Option<u32>,
    /// The pages are those of another ring: they are neither read nor written.
    is_foreign: bool,
}

impl<F: NorFlash> Store<F> {
    /// The regions of a flash. It has to have three pages or more, and words of at most 32 bytes.
    ///
    /// # Errors
    /// [`StoreError::Device`] for a flash that cannot hold them.
    pub fn new(flash: F) -> Result<Self, StoreError> {
        let capacity = u32::try_from(flash.capacity()).map_err(|_| StoreError::Device)?;
        let page = u32::try_from(F::ERASE_SIZE).map_err(|_| StoreError::Device)?;
        if F::WRITE_SIZE > WORD || F::READ_SIZE > F::WRITE_SIZE || capacity / page.max(1) < 3 {
            return Err(StoreError::Device);
        }
        let config = MapConfig::try_new(0..capacity).map_err(|_| StoreError::Device)?;
        let places = Cache::new(Uncached, Uncached, ArrayKeyPointers::new());
        Ok(Self {
            map: MapStorage::new(Patient::new(flash), config, places),
            erases: None,
            is_foreign: false,
        })
    }

    /// The newest bytes of a region, in `buffer`; `None` where nothing was ever stored.
    ///
    /// # Errors
    /// [`StoreError::Device`], [`StoreError::Damaged`].
    pub fn read<'b>(
        &mut self,
        region: Region,
        buffer: &'b mut [u8; BUFFER],
    ) -> Result<Option<&'b [u8]>, StoreError> {
        self.get(region.key(), buffer)
    }

    /// Stores bytes in a region; they replace what was there.
    ///
    /// # Errors
    /// [`StoreError`]; the region then holds what it held before.
    pub fn write(&mut self, region: Region, bytes: &[u8]) -> Result<(), StoreError> {
        let written = self.put(region, &bytes);
        self.count_erases();
        written
    }

    /// Stores what a board asks for.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn keep(&mut self, request: &StoreRequest<'_>) -> Result<(), StoreError> {
        let written = self.put(request.region, &Wanted(request));
        self.count_erases();
        written
    }

    /// Reads what a board starts with; `built_in` makes what it has of its own. Behind [`recover`](Self::recover).
    #[inline(never)]
    pub fn power_up(&mut self, built_in: impl Fn() -> Params) -> PowerUp {
        let mut up = begin(&built_in);
        self.params(built_in, &mut up);
        self.offsets(&mut up.offsets);
        up.erases = self.erases();
        up
    }

    /// How often each page has been erased since the storage was erased as a whole, by what has been counted; 0 also where
    /// the count cannot be read. The pages are used in turn, so that none has been erased more often than that, but for one
    /// or two that a loss of power and its repair add.
    #[inline(never)]
    pub fn erases(&mut self) -> u32 {
        let pages = self.number(Region::Erases).unwrap_or(0);
        self.for_each_page(pages)
    }

    /// The same where a write since the last call has had a page erased.
    pub fn more_erases(&mut self) -> Option<u32> {
        let pages = self.erases.take()?;
        Some(self.for_each_page(pages))
    }

    fn for_each_page(&self, erases: u32) -> u32 {
        let pages = self.map.flash_range().end / (F::ERASE_SIZE as u32).max(1);
        erases.div_ceil(pages.max(1))
    }

    /// Counts what has been erased since the last count. The write of a count may have a page erased itself: that one is
    /// counted too, and where even this has needed one, the next count has it.
    #[inline(never)]
    fn count_erases(&mut self) {
        for _ in 0..2 {
            let pages = self.map.flash().erased();
            if pages == 0 {
                return;
            }
            let Some(before) = self.number(Region::Erases) else {
                return;
            };
            let count = before.saturating_add(pages);
            let bytes = Mark(count).encode();
            if self.put(Region::Erases, &bytes.as_slice()).is_err() {
                return;
            }
            self.map.flash().counted(pages);
            self.erases = Some(count);
        }
    }

    /// The number in a region, 0 where there was never one; `None` where it cannot be read.
    #[inline(never)]
    fn number(&mut self, region: Region) -> Option<u32> {
        let mut buffer = [0; BUFFER];
        match self.read(region, &mut buffer) {
            Ok(None) => Some(0),
            Ok(Some(bytes)) => Mark::decode(bytes).map(|mark| mark.0),
            Err(_) => None,
        }
    }

    /// Counts a start of the board, and gives its number: from 1; 0 where the flash cannot say or keep it. Once for each
    /// start, behind [`recover`](Self::recover), before the board says a word.
    #[inline(never)]
    pub fn count_start(&mut self) -> u32 {
        let next = self
            .number(Region::Starts)
            .and_then(|starts| starts.checked_add(1));
        next.filter(|next| self.write(Region::Starts, &Mark(*next).encode()).is_ok())
            .unwrap_or(0)
    }

    // The buffers of each are on the stack while it reads, and not longer.

    #[inline(never)]
    fn offsets(&mut self, offsets: &mut KeptOffsets) {
        let (mut a, mut b) = ([0; BUFFER], [0; BUFFER]);
        let mark = self.mark(Region::OffsetsMark, &mut a);
        let a = self.read(Region::OffsetsA, &mut a);
        let b = self.read(Region::OffsetsB, &mut b);
        offsets.take(held(&mark), a, b);
    }

    #[inline(never)]
    fn params(&mut self, built_in: impl Fn() -> Params, up: &mut PowerUp) {
        let (mut a, mut b) = ([0; BUFFER], [0; BUFFER]);
        let mark = self.mark(Region::ParametersMark, &mut a);
        let a = self.read(Region::ParametersA, &mut a);
        let b = self.read(Region::ParametersB, &mut b);
        up.take(built_in, held(&mark), a, b);
    }

    fn mark(
        &mut self,
        region: Region,
        buffer: &mut [u8; BUFFER],
    ) -> Result<Option<Few>, StoreError> {
        let bytes = self.read(region, buffer)?;
        Ok(bytes.map(|bytes| bytes.first_chunk().copied().unwrap_or_default()))
    }

    fn get<'b>(
        &mut self,
        key: u8,
        buffer: &'b mut [u8; BUFFER],
    ) -> Result<Option<&'b [u8]>, StoreError> {
        if self.is_foreign {
            return Err(StoreError::Damaged);
        }
        let fetched = block_on(self.map.fetch_item::<&[u8]>(buffer, &key));
        fetched.map_err(|error| reason(&error))
    }

    /// The buffer is on the stack for as long as it is needed.
    #[inline(never)]
    fn put<'d, V: Value<'d>>(&mut self, region: Region, value: &V) -> Result<(), StoreError> {
        if self.is_foreign {
            return Err(StoreError::Damaged);
        }
        let mut buffer = [0; BUFFER];
        let stored = block_on(self.map.store_item(&mut buffer, &region.key(), value));
        stored.map_err(|error| reason(&error))
    }

    /// The flash back.
    #[must_use]
    pub fn into_flash(self) -> F {
        self.map.destroy().0.into_inner()
    }
}

// A function of its own: the copy that it makes is not on the stack while the regions are read.
#[inline(never)]
fn begin(built_in: &impl Fn() -> Params) -> PowerUp {
    PowerUp::given(&built_in())
}

/// A mark by itself, so that the buffer it came in is free again.
type Few = [u8; Region::ParametersMark.bytes()];

fn held(mark: &Result<Option<Few>, StoreError>) -> Held<'_> {
    match mark {
        Ok(mark) => Ok(mark.as_ref().map(<[u8; _]>::as_slice)),
        Err(error) => Err(*error),
    }
}

fn reason<E>(error: &Error<E>) -> StoreError {
    match error {
        Error::Storage { .. } => StoreError::Device,
        Error::FullStorage | Error::BufferTooBig | Error::BufferTooSmall(_) | Error::ItemTooBig => {
            StoreError::Full
        }
        _ => StoreError::Damaged,
    }
}
