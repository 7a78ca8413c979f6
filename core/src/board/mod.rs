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
//! Terms: a *period* is the time between two SYNCs; a *setpoint* computed in period k takes effect at SYNC(k+1) plus the
//! drive's latency; the board *pauses* between segments (single block) and *holds* anywhere (feed hold).
//!
//! It must not know hardware, sockets, clocks or flash.

mod background;
mod command;
mod detour;
pub mod device;
mod drives;
mod gear;
mod guard;
mod kept;
mod kept_offsets;
mod lag;
mod machine;
mod message;
mod nodes;
mod operator;
mod planner;
mod queue;
mod queues;
mod reference;
mod request;
mod snapshot;
mod spindles;
mod store;
mod tick_side;
mod ticker;
mod trouble;
mod turret;
mod whole;

pub use crate::link::Event;
pub use background::{Background, BackgroundSide};
pub use command::{Command, Switching};
pub use device::Device;
pub use drives::FRAMES;
pub use guard::Guard;
pub use kept::{Found, Held, KeptError, KeptSet, Mark, PowerUp, Slot};
pub use kept_offsets::KeptOffsets;
pub use machine::Interlocks;
pub use nodes::DriveNodes;
pub use operator::{Operator, overridden};
pub use planner::Planner;
pub use queue::{Events, Segments};
pub use queues::{BackgroundEnds, Queues, TickEnds};
pub use request::StoreRequest;
pub use snapshot::{Contacts, Snapshot};
pub use store::{Region, StoreError};
pub use tick_side::{Inputs, Tick, TickSide};
pub use ticker::{Outcome, Output, Setup, State, Ticker};
pub use trouble::{BusTrouble, Intrusion, Victim};
pub use whole::Board;
