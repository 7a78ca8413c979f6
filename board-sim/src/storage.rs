//! The storage of a simulated board. All requests of the board go to a simulated flash at once.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{Board, PowerUp};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::params::Params;
use leadscrew_store::{BUFFER, Region, Store};

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
        let written = Store::new(&mut *flash).and_then(|mut store| store.keep(&request));
        board.stored(region, written);
    }
}
