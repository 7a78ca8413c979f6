//! The parameter set: typed access to every number, generated from `params/*.toml`.
//!
//! A definition is written once, in those files; the build script makes of it an accessor of [`Params`], an [`Entry`]
//! (number, unit, range: what a machine needs to take or refuse a value) and its [`Text`] (what a person reads).
//! [`set`](Params::set) takes a value only in its range, [`Params::check`] refuses a set that cannot work. This room
//! knows nothing of files, buses or storage.
//!
//! X: travel, speeds, accelerations and limits are those of the slide, on the radius. Offsets are written as diameters,
//! as they are programmed, and handed out as radii.

mod backlash;
mod block;
mod check;
mod entry;
mod gear;
mod home;
mod limit;
mod pitch;
mod row;
mod set;
mod target;
#[cfg(test)]
mod tests;
mod turret;
pub mod unit;

#[cfg(test)]
pub(crate) use backlash::TAKE_UP_PART;
pub(crate) use backlash::TakeUpShape;
pub use check::{BY_DRIVE, BY_SWITCH, PROFILE_TICKS, metres};
pub use entry::{Entry, FindError, Part, Text};
use entry::{Meaning, Range};
pub use gear::{GEARS, Gear, gear_of_code};
pub use home::HomeSwitch;
pub(crate) use pitch::PitchCurve;
pub use row::{
    Action as FunctionAction, Answer, CONTACTS, Contact, FIRST_OF_BLOCK, FunctionRow, ROWS,
};
pub use set::SetError;
pub use unit::{Unit, ValueError, Writing};

use crate::units::{Acceleration, Axis, Feed, Jerk, Length};

/// A complete parameter set: every value in the smallest step of its unit, within its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Params {
    raw: [i64; SLOTS],
}

impl Params {
    /// The built-in machine: a small slant-bed lathe (`params/machines/slant-bed.toml`).
    #[must_use]
    pub const fn slant_bed() -> Self {
        let mut raw = [0; SLOTS];
        let (mut places, mut values): (&mut [i64], &[i64]) = (&mut raw, &BUILT_IN);
        while let ([place, more @ ..], [value, rest @ ..]) = (places, values) {
            *place = *value;
            (places, values) = (more, rest);
        }
        Self { raw }
    }

    /// The built-in machine with input increments of 0.0001 mm (IS-C), in which the makers' sheets print their examples.
    #[must_use]
    pub fn sheets() -> Self {
        let mut params = Self::slant_bed();
        if let Ok(entry) = Entry::find(1004, Some(Part::Bit(1))) {
            // A bit of the table: 1 is in its range.
            let _ = params.set(entry, 1);
        }
        params
    }

    /// By how many microseconds the age of 6064h of an axis (9072) may be wrong: 9075, or a whole SYNC period where that is
    /// 0 and nobody knows the age.
    #[must_use]
    pub const fn actual_age_doubt_us(&self, axis: Axis) -> u32 {
        match self.actual_age_within_us(axis) {
            0 => self.tick_us(),
            within => within,
        }
    }

    /// By how much the latencies of X and Z differ, µs.
    #[must_use]
    pub fn latency_apart_us(&self) -> u64 {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| self.latency_us(axis));
        x.abs_diff(z).into()
    }
}

impl Default for Params {
    fn default() -> Self {
        Self::slant_bed()
    }
}

/// Version of the parameter table, for people and for files: counted up by hand where a file that was right becomes wrong
/// [D119]. What tells any two tables apart is their [key](TABLE_KEY).
pub const SCHEMA: u16 = 2;

/// Number of the parameter that holds the password: it is never told.
pub const PASSWORD: u16 = 9028;

/// What a password reads as where there is one, and what keeps it as it is where it is written.
pub const PASSWORD_KEPT: i64 = 1;

/// Key of the parameter table: numbers, units, ranges, what may be "none", and places in a set. A set belongs to one
/// table.
pub const TABLE_KEY: u32 = table_key();

const fn table_key() -> u32 {
    let mut key = 0xCBF2_9CE4_8422_2325;
    let (mut entries, mut meanings): (&[Entry], &[Meaning]) = (&ENTRIES, &MEANINGS);
    while let ([entry, rest @ ..], [meaning, more @ ..]) = (entries, meanings) {
        let part = match entry.part {
            Part::Whole => 0,
            Part::Bit(bit) => 0x100 | bit as i64,
            Part::Axis(axis) => 0x200 | axis as i64,
        };
        key = hash(key, entry.no as i64);
        key = hash(key, part);
        key = hash(key, meaning.unit as i64);
        key = hash(key, entry.min());
        key = hash(key, entry.max());
        key = hash(key, (entry.slot as i64) << 8 | entry.quarter as i64);
        if let Some(none) = entry.none() {
            key = hash(key, none);
        }
        (entries, meanings) = (rest, more);
    }
    (key ^ (key >> 32)) as u32
}

/// Place of the password in a set.
pub const PASSWORD_SLOT: usize = {
    let mut slot = SLOTS;
    let mut entries: &[Entry] = &ENTRIES;
    while let [entry, rest @ ..] = entries {
        if entry.no == PASSWORD {
            slot = entry.slot as usize;
        }
        entries = rest;
    }
    assert!(slot < SLOTS, "the password is a parameter");
    slot
};

/// FNV-1a over the bytes of a number.
const fn hash(mut key: u64, value: i64) -> u64 {
    let [a, b, c, d, e, f, g, h] = value.to_le_bytes();
    let mut bytes: &[u8] = &[a, b, c, d, e, f, g, h];
    while let [first, rest @ ..] = bytes {
        key = (key ^ *first as u64).wrapping_mul(0x0000_0100_0000_01B3);
        bytes = rest;
    }
    key
}

include!(concat!(env!("OUT_DIR"), "/params.rs"));
