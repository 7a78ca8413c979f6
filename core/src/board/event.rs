//! What the board tells, as data.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::trouble::BusTrouble;
use crate::alarm::{Alarm, Code};
use crate::call::Aux;
use crate::units::Rpm;

/// An event.
// With a tag of one word, the content lies on word boundaries and is copied word by word.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Event {
    /// All drives are enabled; motion is possible.
    Ready,
    /// A segment has been started.
    Started {
        /// Number of its (first) move.
        number: u32,
        /// Source line.
        line: u32,
    },
    /// The spindle has been given a speed.
    Spindle(Rpm),
    /// The spindle is brought to a stand in position mode.
    Rigid,
    /// A machine function has been switched.
    Aux(Aux),
    /// A condition that stops nothing.
    Warning(Alarm),
    /// The machine stops; latched until reset.
    Alarm(Alarm),
    /// Feed hold or single block has brought the axes to rest.
    Held,
    /// A reset is done: everything handed over before is forgotten. The sender of a program stops sending.
    Reset,
    /// The last call has been carried out.
    Finished,
}

/// What a tick asks of the board's switches. This is part of the tick's output, because the next move may depend on it and
/// the queue of [`Event`]s may be full [D191].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switching {
    /// Nothing.
    #[default]
    Nothing,
    /// A machine function is switched.
    Function(Aux),
    /// The functions that programs have switched are forgotten: a reset is done, or the application starts again.
    Reset,
    /// As `Reset`, with a tap in its hole: the clamp of the work piece stays on, and nothing waits for a function any more.
    ResetInHole,
}

/// An operator's command. It acts in the next tick and never waits for a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Feed hold.
    Hold,
    /// Continue after feed hold or single block.
    Resume,
    /// Stop, empty the queue, clear an alarm.
    Reset,
    /// Emergency stop: both axes of a synchronised move decelerate together [D18]. The queue is emptied, and the alarm
    /// stays until reset.
    Stop,
    /// A stop like [`Stop`](Self::Stop) with another alarm, from the supervision of the board.
    Halt(Code),
    /// A stop for a trouble of the bus. Drives that cannot be reached are told to let go, so that nothing pulls them when
    /// they can be reached again [D124].
    Trouble(BusTrouble),
    /// Single block on or off.
    SingleBlock(bool),
    /// Feed override in percent, 0…150.
    FeedOverride(u8),
    /// Rapid override in percent, 0…100.
    RapidOverride(u8),
    /// Spindle override in percent, 50…120; frozen inside a thread cycle.
    SpindleOverride(u8),
}
