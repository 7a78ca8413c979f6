//! The storage of a simulated board. All requests of the board go to a simulated flash at once.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{Board, PowerUp};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::params::Params;
use leadscrew_store::{BUFFER, Region, Store, StoreError};

use crate::plant::Flash;

/// The entry of the tap journal in a flash, if there is one. Before the read, this repairs what a loss of power has
/// left unfinished. For power-up.
///
/// # Errors
/// [`Code::TapJournalDamaged`] for a flash that cannot be read.
pub fn stored_tap(flash: &mut Flash) -> Result<Option<TapRecord>, Alarm> {
    let damaged = Alarm::new(Code::TapJournalDamaged, Span::default());
    let mut buffer = [0; BUFFER];
    let mut store = Store::new(flash).map_err(|_| damaged)?;
    store.recover().map_err(|_| damaged)?;
    match store
        .read(Region::TapJournal, &mut buffer)
        .map_err(|_| damaged)?
    {
        Some(bytes) => TapRecord::decode(bytes).map_err(|_| damaged),
        None => Ok(None),
    }
}

/// The parameter set in a flash; `built_in` is the board's own set. For power-up, after [`stored_tap`].
///
/// # Errors
/// [`Code::ParametersLost`] for a flash in which a store is impossible.
pub fn stored_params(flash: &mut Flash, built_in: &Params) -> Result<PowerUp, Alarm> {
    let lost = Alarm::new(Code::ParametersLost, Span::default());
    let mut store = Store::new(flash).map_err(|_| lost)?;
    Ok(store.power_up(|| built_in.clone()))
}

/// The same for a board that starts now: the start counts.
///
/// # Errors
/// As [`stored_params`].
pub fn stored_start(flash: &mut Flash, built_in: &Params) -> Result<PowerUp, Alarm> {
    let mut up = stored_params(flash, built_in)?;
    up.start = count_start(flash);
    Ok(up)
}

/// Counts a start of a board in its flash; gives its number, or 0 where the flash cannot keep it.
pub fn count_start(flash: &mut Flash) -> u32 {
    Store::new(flash).map_or(0, |mut store| store.count_start())
}

/// Carries out all requests of a board to its storage.
pub fn keep(board: &mut Board, flash: &mut Flash) {
    loop {
        if let Some(region) = board.load() {
            let mut buffer = [0; BUFFER];
            let held =
                Store::new(&mut *flash).and_then(|mut store| store.read(region, &mut buffer));
            board.loaded(held);
        }
        let Some(request) = board.store() else {
            return;
        };
        let region = request.region;
        let mut erases = None;
        let written = Store::new(&mut *flash).and_then(|mut store| {
            let written = store.keep(&request);
            erases = store.more_erases();
            written
        });
        if let Some(erases) = erases {
            board.set_erases(erases);
        }
        board.stored(region, written);
    }
}

/// What has gone bad in a flash, or was never this board's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decay {
    /// The journal of a tap.
    Journal,
    /// The newest parameter set.
    NewestSet,
    /// All parameter sets.
    Sets,
    /// The newest parameter set is one of a board with another table.
    ForeignSet,
    /// The newest table of offsets and tools.
    NewestTable,
}

/// Lets something go bad. The board sees it when its power comes.
///
/// # Errors
/// The flash takes nothing.
pub fn decay(flash: &mut Flash, what: Decay) -> Result<(), StoreError> {
    const SETS: [Region; 2] = [Region::ParametersA, Region::ParametersB];
    const TABLES: [Region; 2] = [Region::OffsetsA, Region::OffsetsB];
    const BAD: &[u8] = b"gone bad";
    let mut store = Store::new(flash)?;
    let mut spoil = |region| store.write(region, BAD);
    match what {
        Decay::Journal => spoil(Region::TapJournal),
        Decay::Sets => SETS.into_iter().try_for_each(spoil),
        Decay::NewestSet => {
            let region = newest(&mut store, SETS)?;
            store.write(region, BAD)
        }
        Decay::NewestTable => {
            let region = newest(&mut store, TABLES)?;
            store.write(region, BAD)
        }
        Decay::ForeignSet => {
            let region = newest(&mut store, SETS)?;
            let mut buffer = [0; BUFFER];
            let held = store.read(region, &mut buffer)?.unwrap_or_default();
            let mut set = [0; BUFFER];
            let Some(set) = set.get_mut(..held.len()) else {
                return Ok(());
            };
            set.copy_from_slice(held);
            let Some((content, sum)) = set.split_last_chunk_mut::<4>() else {
                return Ok(());
            };
            // The key of its table.
            if let Some(byte) = content.get_mut(8) {
                *byte ^= 0xFF;
            }
            *sum = CRC.checksum(content).to_le_bytes();
            store.write(region, set)
        }
    }
}

const CRC: crc::Crc<u32, crc::NoTable> = crc::Crc::<u32, crc::NoTable>::new(&crc::CRC_32_ISO_HDLC);

/// The one of two places that has the higher number, which stands in the same place of a set and of a table.
fn newest(store: &mut Store<&mut Flash>, [a, b]: [Region; 2]) -> Result<Region, StoreError> {
    let mut number = |region| -> Result<u32, StoreError> {
        let mut buffer = [0; BUFFER];
        let held = store.read(region, &mut buffer)?;
        let number = held.and_then(|bytes| bytes.get(4..)?.first_chunk::<4>());
        Ok(number.map_or(0, |number| u32::from_le_bytes(*number)))
    };
    Ok(if number(b)? > number(a)? { b } else { a })
}
