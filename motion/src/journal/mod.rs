//! The tap journal, which survives a loss of power: an entry for the hole in which a tap stands, as bytes with a
//! version and a checksum.
//!
//! A tap in a hole can come out only in phase. Therefore the board records the data for the way out ([G84/G88 sheet],
//! G30 P99): before the tap goes in, at every reversal, after the tap has come out, and at every stop in between. Only
//! the newest entry matters. The owner of the storage decides where the entry is kept and how a write survives a loss
//! of power. This module knows the entry and its bytes. It must not know flash, ticks or drives.

mod bytes;
mod record;

pub use record::{RecordError, TapHole, TapRecord};
