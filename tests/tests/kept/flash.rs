//! The flash of a board whose parameters are changed, without the board: the same requests, written by the same store.

use leadscrew_board_sim::plant::Flash;
use leadscrew_core::board::{Found, PowerUp, Region, StoreError};
use leadscrew_core::call::{Hand, TapAxis, TapNotes, TapSpindle};
use leadscrew_core::journal::{TapHole, TapRecord};
use leadscrew_core::link::identity;
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::{CentiRpm, Lead, Length, Turns};
use leadscrew_store::{BUFFER, Store};
use leadscrew_tests::params::with;

/// Pages of the flash of these tests: fewer than a board has, and the same.
pub const PAGES: usize = 8;
/// Bytes that the count of an erased page takes.
pub const COUNT: u32 = 24;

/// Set number so many: told apart by an offset.
pub fn set(number: u32) -> Params {
    with(&[("1221.Z", i64::from(number) * 1000)])
}

/// Entry number so many of the tap journal.
pub fn entry(sequence: u32) -> TapRecord {
    let depth = i64::from(sequence) * 750_000;
    TapRecord {
        sequence,
        in_hole: !sequence.is_multiple_of(28),
        hole: TapHole {
            axis: TapAxis::Z,
            level: Length::ZERO,
            bottom: Length::from_nm(-50_000_000),
            lead: Lead::new(2_000_000_000, 1000).expect("a lead"),
            hand: Hand::Right,
            spindle: TapSpindle::First,
            speed: CentiRpm::new(100_000),
            notes: TapNotes::default(),
        },
        position: Length::from_nm(-depth),
        angle: Turns::from_raw(depth << 12),
    }
}

/// Stores the next entry of the tap journal.
pub fn note(flash: &mut Flash, sequence: u32) -> Result<(), StoreError> {
    let mut store = Store::new(flash)?;
    store.write(Region::TapJournal, &entry(sequence).encode())
}

/// The newest entry of the tap journal.
pub fn noted(flash: &mut Flash) -> Option<u32> {
    let mut buffer = [0; BUFFER];
    let mut store = Store::new(flash).expect("a store");
    let bytes = store
        .read(Region::TapJournal, &mut buffer)
        .expect("readable")?;
    let record = TapRecord::decode(bytes).expect("an entry")?;
    assert_eq!(record, entry(record.sequence), "a mixture");
    Some(record.sequence)
}

/// What a board finds when the power comes back.
pub fn power_up(flash: &mut Flash) -> PowerUp {
    flash.power(true);
    let mut store = Store::new(flash).expect("a store");
    store.recover().expect("recovered");
    store.power_up(Params::sheets)
}

/// The number of the set that is in force; `None`: nothing was ever stored.
///
/// # Panics
/// Where it is no whole set of these tests, or the board says that something is wrong.
pub fn in_force(flash: &mut Flash) -> Option<u32> {
    let up = power_up(flash);
    match up.found {
        Found::Nothing => None,
        Found::Newest => {
            let number = number(&up.params).expect("one of the sets");
            assert_eq!(identity(&up.params), identity(&set(number)));
            Some(number)
        }
        wrong => panic!("{wrong:?}"),
    }
}

/// Table number so many of the offsets: told apart by the geometry of a tool.
pub fn table(revision: u32) -> Offsets {
    let mut table = Offsets {
        revision: Revision(revision),
        ..Offsets::default()
    };
    table.tools[31].geometry.z = Length::from_nm(i64::from(revision) * 100);
    table
}

/// The revision of the offsets that are in force; 0: none was ever stored.
///
/// # Panics
/// Where it is no whole table of these tests, or the board says that something is wrong.
pub fn offsets_in_force(flash: &mut Flash) -> u32 {
    let up = power_up(flash).offsets;
    let found = Offsets::decode(&up.table).expect("a whole table");
    let revision = found.revision.0;
    match up.found {
        Found::Nothing => assert_eq!(found, Offsets::default()),
        Found::Newest => assert_eq!(found, table(revision)),
        wrong => panic!("{wrong:?}"),
    }
    revision
}

/// Which of the sets this is, if it is one.
pub fn number(params: &Params) -> Option<u32> {
    let offset = Entry::find_text("1221.Z").expect("a work offset");
    let number = u32::try_from(params.get(offset) / 1000).ok()?;
    (*params == set(number)).then_some(number)
}
