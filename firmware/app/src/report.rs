//! What the two sides say to each other.

use leadscrew_core::board::{Command, Measured, Snapshot, StoreError};
use leadscrew_core::motion::Epoch;
use leadscrew_core::signals::Signals;

/// What the background asks of the tick. It acts in the next tick, in the order in which it was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The background is alive.
    Alive,
    /// An operator's command.
    Command(Command),
    /// The inputs, as they are set over the bus.
    Signals(Signals),
    /// A program begins, if what is planned in this epoch still counts.
    ProgramBegins(Epoch),
    /// The tap journal's entry is to be dropped.
    DiscardTap,
    /// An entry of the tap journal has been stored, or could not be.
    Stored(u32, Result<(), StoreError>),
    /// The ticker is to be handed over: it is made anew.
    HandOver,
}

/// The tick side behind a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// SYNC periods since the report before.
    pub elapsed: u32,
    /// What it looks like.
    pub snapshot: Snapshot,
    /// The oldest segment is under way.
    pub begun: bool,
    /// How far the axis that is held to the spindle was from where it should have been; `None`: none is held.
    pub measured: Option<Measured>,
    /// Setpoints that have come late for their SYNC, since power-up.
    pub late: u32,
}
