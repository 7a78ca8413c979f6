//! Sparkplug B: what a record is called on a broker.
//!
//! ```text
//! payload   the protobuf message            table     names, kinds and units of the metrics
//! session   births, deaths, sequence        metrics   what each record says of them
//!           numbers of one connection     host      whether the primary host is there
//! ```

mod host;
pub mod metrics;
pub mod payload;
pub mod session;
mod table;

pub use host::Host;
pub use metrics::Machines;
pub use session::{Message, NameError, Names, Session};
