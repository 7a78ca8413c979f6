//! The board: calls, frames and encoder samples in; frames, events and setpoints out. Sans-IO.
//!
//! Two contexts. The **tick** ([`TickSide`], one SYNC period, bounded) observes the spindle, supervises the drives,
//! executes segments and makes frames; its machine is the [`Ticker`]. The **background** ([`BackgroundSide`]) communicates
//! on the bus ([`Device`]), stores parameters, and expands and plans calls ([`Planner`]). Single-producer [`Queues`] join
//! the two contexts. In the other direction goes one message that plans obey: start again from here, or plan this way. A
//! planned segment carries the [`Epoch`](crate::motion::Epoch) in which it was planned, and the tick drops segments that
//! are older than its last start, so the two contexts need not agree on the moment. The background obeys the tick's message
//! before it takes further calls.
//!
//! Firmware runs the two sides in two contexts. An owner with one thread has a [`Board`], which is the same two sides and
//! their queues.
//!
//! ```text
//!          calls          segments                       SYNC, RPDOs
//! gateway ──────► Planner ────────► Ticker ────────────────────► drives
//!                    ▲                │ ▲
//!                    └──── notice ────┘ └── encoder sample, TPDOs
//! ```
//!
//! The tick's side and the queues are [`tick`](crate::tick), in a crate of its own that cannot name the background [D373].
//! The rest is here.
//!
//! It must not know hardware, sockets, clocks or flash.

mod background;
pub mod device;
mod guard;
mod kept;
mod kept_offsets;
mod planner;
mod request;
mod store;
mod whole;

pub use crate::tick::{
    BackgroundEnds, BlockInputs, BlockLoss, BusTrouble, Command, Contacts, DriveNodes, Event,
    Events, FRAMES, Found, Inputs, Interlocks, Intrusion, Operator, Outcome, Output, Queues,
    Segments, Setup, Snapshot, State, StoreError, Switching, Tick, TickEnds, TickSide, Ticker,
    Victim, overridden,
};
pub use background::{Background, BackgroundSide};
pub use device::Device;
pub use guard::Guard;
pub use kept::{Held, KeptError, KeptSet, Mark, PowerUp, Slot};
pub use kept_offsets::KeptOffsets;
pub use planner::Planner;
pub use request::StoreRequest;
pub use store::{GUARANTEED_ERASES, Region, WORN};
pub use whole::Board;
