//! What survives a loss of power: the entry of the hole a tap is in, as bytes with a version and a checksum.
//!
//! A tap that stands in a hole comes out in phase or not at all. So the board writes down what the way out needs, before
//! the tap goes in, at every reversal, when it has come out, and at every stop in between ([G84/G88 sheet], G30 P99).
//! Only the newest entry matters. Where it is kept, and what a storage does when the power goes in the middle of a write,
//! is its owner's: this room knows the entry and its bytes, and nothing of flash, ticks or drives.

mod bytes;
mod record;

pub use record::{RecordError, TapHole, TapRecord};
