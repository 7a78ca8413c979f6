//! What an agent tells of its machines, keeps and sends.
//!
//! ```text
//! the side of the bus ── Observation ──► model ─► Record ─► store ─► sender: sparkplug in mqtt
//!                                                   │          │
//!          metrics, values for births  ◄─────────┘          └─► archive: files of Parquet
//! ```
//!
//! Beside the records, the set of parameters in force goes to the broker as a state that it retains ([`set`]), and
//! [`mqtt::retained`] is the other end of that.
//!
//! A model is of one machine; store, sender and metrics are of all that an agent has. This crate must not know a bus or a
//! command line: what the board says comes to it as values. Nothing here orders, and no broker can make it. What is
//! published has been kept before; the number under which it is kept goes with it, so that a repetition is known as one
//! [D405].

pub mod archive;
pub mod keeper;
pub mod metrics;
pub mod model;
pub mod mqtt;
pub mod record;
mod reserve;
pub mod sender;
pub mod set;
pub mod sparkplug;
pub mod store;

pub use keeper::Keeper;
pub use model::{Memory, Model, Observation};
pub use record::{Body, Class, Moment, Numbered, Record};
pub use store::{Store, StoreError};
