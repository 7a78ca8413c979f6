//! Sparkplug B: what a record is called on a broker.
//!
//! ```text
//! payload   the protobuf message            metrics   the table of metrics, and what each record says of them
//! session   births, deaths, sequence numbers of one connection
//! ```

pub mod metrics;
pub mod payload;
pub mod session;

pub use metrics::Values;
pub use session::{Message, NameError, Names, Session};
