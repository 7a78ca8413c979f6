//! The messages between the two contexts that belong to neither of them alone.

use super::command::Command;
use super::reference::Measured;
use super::snapshot::Snapshot;
use super::stored::StoreError;
use crate::motion::Epoch;
use crate::signals::Signals;

/// What the background asks of the tick. Orders act in the next tick, in the order of asking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// An operator's command.
    Command(Command),
    /// The inputs that are set over the bus.
    Signals(Signals),
    /// A program begins, if what is planned in this epoch still counts.
    ProgramBegins {
        /// That epoch.
        epoch: Epoch,
        /// It is a line that was typed.
        typed: bool,
    },
    /// The tap journal's entry is to be discarded.
    DiscardTap,
    /// An entry of the tap journal has been stored, or could not be.
    Stored(u32, Result<(), StoreError>),
    /// An axis is to be moved by hand: the press waits in its own queue.
    Press,
    /// The application begins anew with the parts that wait in their own queue.
    BeginAnew,
}

/// The tick side after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// SYNC periods since the last report.
    pub elapsed: u32,
    /// The state of the machine.
    pub snapshot: Snapshot,
    /// The oldest segment is under way.
    pub begun: bool,
    /// How far the axis that follows the spindle was from its correct place; `None` where no axis follows.
    pub measured: Option<Measured>,
    /// Setpoints that came late for their SYNC, since power-up.
    pub late: u32,
    /// The number of orders that the tick has carried out. It wraps.
    pub orders: u32,
}
