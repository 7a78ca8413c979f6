//! The side of a board that runs in the tick: one SYNC period, bounded.
//!
//! A [`TickSide`] takes the frames, pins and encoder sample of a period, and gives frames, outputs and events. Its machine
//! is the [`Ticker`]; [`Queues`] join it with the background.
//!
//! Terms: a *period* is the time between two SYNCs; a *setpoint* computed in period k takes effect at SYNC(k+1) plus the
//! drive's latency; the board *pauses* between segments (single block) and *holds* anywhere (feed hold).
//!
//! It must not know how moves are made, what is stored, or what a gateway asks.

mod backlash;
mod command;
mod detour;
mod drives;
mod event;
mod gear;
mod hard_limits;
mod lag;
mod machine;
mod message;
mod nodes;
mod operator;
mod pitch;
pub mod queue;
mod queues;
mod reference;
mod snapshot;
mod spindles;
mod stored;
mod tick_side;
mod ticker;
mod trouble;
mod turret;

pub use command::{Command, Switching};
pub use detour::Route;
pub use drives::FRAMES;
pub use event::Event;
pub use hard_limits::{AxisEnd, HardLimits};
pub use machine::{BlockInputs, BlockLoss, Interlocks, interlocked};
pub use message::{Order, Report};
pub use nodes::DriveNodes;
pub use operator::{Operator, overridden};
pub use queue::{Events, Segments};
pub use queues::{BackgroundEnds, Queues, TickEnds};
pub use reference::{Followed, Measured, ThreadKind};
pub use snapshot::{Contacts, Snapshot};
pub use stored::{Found, StoreError};
pub use tick_side::{Inputs, Tick, TickSide};
pub use ticker::{Notice, Outcome, Output, Setup, State, Ticker};
pub use trouble::{BusTrouble, Intrusion, Victim};
