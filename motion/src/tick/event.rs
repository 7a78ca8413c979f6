//! What a board tells while it works. Events go through a queue to the background, and from there to a log on the bus.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::call::Aux;
use crate::units::Rpm;

/// What the board tells.
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
    /// A line that was typed is not carried out: nothing of it was done, the rest of it is forgotten, and the machine stays
    /// ready.
    Refused(Alarm),
}
