//! What the board tells the outside, as data.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::trouble::BusTrouble;
use crate::alarm::{Alarm, Code};
use crate::program::Aux;
use crate::units::Rpm;

/// Something that happened.
// A tag of a word: what is behind it lies on words then, and is copied by the word.
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
    /// A reset is done: everything handed over before has been forgotten. Who feeds a program stops doing so.
    Reset,
    /// The last call has been carried out.
    Finished,
}

/// What a tick has for the switches of a board: told in the tick itself, for the next move may hang on it, and an [`Event`]
/// may find its queue full [D191].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switching {
    /// Nothing.
    #[default]
    Nothing,
    /// A machine function is switched.
    Function(Aux),
    /// What programs have switched is forgotten: a reset is done, or the application begins anew.
    Reset,
    /// The same with a tap in its hole: what holds the work piece goes on to, and nothing waits for it any more.
    ResetInHole,
}

/// What the operator asks for. Takes effect in the next tick; never waits behind a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Feed hold.
    Hold,
    /// Go on after feed hold or single block.
    Resume,
    /// Stop, forget everything that is queued, clear an alarm.
    Reset,
    /// Emergency stop: both axes of a synchronised move decelerate together [D18]; everything queued is forgotten, the
    /// alarm stays until reset.
    Stop,
    /// A stop as by [`Stop`](Self::Stop), with an alarm of its own: what watches the board asks for it.
    Halt(Code),
    /// The same for what is wrong with the bus. Drives that cannot be reached are told to let go, so that nothing pulls
    /// them when they can be reached again [D124].
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
