//! The storage of a simulated board: what it asks to be kept goes to a simulated flash, at once.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{Board, PowerUp};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::params::Params;
use leadscrew_store::{BUFFER, Region, Store};

use crate::plant::Flash;

/// The entry of the tap journal in a flash, if there is one; repairs first what a loss of power has left unfinished. For
/// power-up.
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

/// The parameter set in a flash; `built_in` is what the board has of its own. For power-up, behind [`stored_tap`].
///
/// # Errors
/// [`Code::ParametersLost`] for a flash that cannot be one.
pub fn stored_params(flash: &mut Flash, built_in: &Params) -> Result<PowerUp, Alarm> {
    let lost = Alarm::new(Code::ParametersLost, Span::default());
    let mut store = Store::new(flash).map_err(|_| lost)?;
    Ok(store.power_up(|| built_in.clone()))
}

/// Carries out what a board asks of its storage.
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
