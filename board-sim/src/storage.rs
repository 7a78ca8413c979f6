//! The storage of a simulated board: what it asks to be kept goes to a simulated flash, at once.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::Board;
use leadscrew_core::journal::TapRecord;
use leadscrew_store::{Region, Store, block_on};

use crate::plant::Flash;

/// The entry of the tap journal in a flash, if there is one; repairs first what a loss of power has left unfinished. For
/// power-up.
///
/// # Errors
/// [`Code::TapJournalDamaged`] for a flash that cannot be read.
pub fn stored_tap(flash: &mut Flash) -> Result<Option<TapRecord>, Alarm> {
    let damaged = Alarm::new(Code::TapJournalDamaged, Span::default());
    let mut buffer = [0; TapRecord::BYTES];
    let mut store = Store::new(flash).map_err(|_| damaged)?;
    block_on(store.recover()).map_err(|_| damaged)?;
    match block_on(store.read(Region::TapJournal, &mut buffer)).map_err(|_| damaged)? {
        Some(bytes) => TapRecord::decode(bytes).map_err(|_| damaged),
        None => Ok(None),
    }
}

/// Carries out the writes that a board asks for.
pub fn keep(board: &mut Board, flash: &mut Flash) {
    while let Some(request) = board.store() {
        let written = Store::new(&mut *flash)
            .and_then(|mut store| block_on(store.write(request.region, request.bytes())));
        board.stored(request.region, written);
    }
}
