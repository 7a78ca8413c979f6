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
//!   [`Store::recover`] ends both, before anything else is done.
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

type Map<F> = MapStorage<u8, Patient<F>, Cache<Uncached, Uncached, Uncached, u8>>;

/// Regions in all of a flash. Nothing is kept in memory: it can be made anew for every access.
pub struct Store<F: NorFlash> {
    map: Map<F>,
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
        Ok(Self {
            map: MapStorage::new(Patient::new(flash), config, Cache::new_uncached()),
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
        self.put(region, &bytes)
    }

    /// Stores what a board asks for.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn keep(&mut self, request: &StoreRequest<'_>) -> Result<(), StoreError> {
        self.put(request.region, &Wanted(request))
    }

    /// Reads what a board starts with; `built_in` makes what it has of its own. Behind [`recover`](Self::recover).
    #[inline(never)]
    pub fn power_up(&mut self, built_in: impl Fn() -> Params) -> PowerUp {
        let mut up = begin(&built_in);
        self.params(built_in, &mut up);
        self.offsets(&mut up.offsets);
        up
    }

    /// Counts a start of the board, and gives its number: from 1; 0 where the flash cannot say or keep it. Once for each
    /// start, behind [`recover`](Self::recover), before the board says a word.
    #[inline(never)]
    pub fn count_start(&mut self) -> u32 {
        let starts = {
            let mut buffer = [0; BUFFER];
            match self.read(Region::Starts, &mut buffer) {
                Ok(None) => Some(Mark(0)),
                Ok(Some(bytes)) => Mark::decode(bytes),
                Err(_) => None,
            }
        };
        let next = starts.and_then(|starts| starts.0.checked_add(1));
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
        let fetched = block_on(self.map.fetch_item::<&[u8]>(buffer, &key));
        fetched.map_err(|error| reason(&error))
    }

    /// The buffer is on the stack for as long as it is needed.
    fn put<'d, V: Value<'d>>(&mut self, region: Region, value: &V) -> Result<(), StoreError> {
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
