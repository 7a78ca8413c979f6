//! The status record of the board: object 5001h.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::writer::{Put, Writer};
use super::{LinkError, Version};
use crate::alarm::Alarm;
use crate::bus::BoardState;
use crate::call::Position;
use crate::units::{Axes, Length, Rpm, TurnRate, Turns};

/// The status record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// The version of the board's link. It is the first field, so that a reader knows it before the others.
    pub version: Version,
    /// Ticks since power-up.
    pub tick: u64,
    /// State of the machine.
    pub state: BoardState,
    /// The present alarm.
    pub alarm: Option<Alarm>,
    /// A program is under way.
    pub in_program: bool,
    /// The point where a held program was left, machine coordinates; `None`: none was.
    pub left: Option<Position>,
    /// Source line of the current move; 0: none.
    pub line: u32,
    /// Number of the current move; 0: none.
    pub number: u32,
    /// The last setpoint, machine coordinates.
    pub position: Position,
    /// Angle of the spindle at the last SYNC.
    pub spindle: Turns,
    /// Measured speed of the spindle.
    pub speed: TurnRate,
    /// Commanded speed of the spindle, with override.
    pub command: Rpm,
    /// Feed hold is on.
    pub hold: bool,
    /// Single block is on.
    pub single_block: bool,
    /// Feed override in percent.
    pub feed_percent: u8,
    /// Rapid override in percent.
    pub rapid_percent: u8,
    /// Spindle override in percent.
    pub spindle_percent: u8,
    /// Setpoint minus the ideal axis position at the measured angle, while an axis follows the spindle.
    pub sync_error: Option<Length>,
    /// Setpoints that came late for their SYNC, since power-up.
    pub late: u32,
    /// The program that is being sent or executed.
    pub program: u32,
    /// Number of the next call of that program that the board expects.
    pub next_call: u32,
    /// The board's free room for program calls, in bytes.
    pub credit: u16,
    /// Number of the newest entry of the event log; 0: none.
    pub newest_event: u32,
    /// The inputs and the mirrored bits above them, as [`Snapshot::signals`](crate::board::Snapshot::signals) gives
    /// them: object 5060h.
    pub signals: u16,
    /// The axes whose position is that of the machine: they need no reference, or it is found.
    pub referenced: Axes,
    /// The axes without a reference that a program needs.
    pub unreferenced: Axes,
    /// CRC-32 of the parameter set in force.
    pub parameters: u32,
}

impl Status {
    /// The largest size of a status in bytes.
    pub const BYTES: usize = 256;

    /// Writes the status to the front of `bytes` and gives the number of bytes.
    ///
    /// # Errors
    /// [`LinkError::TooLong`]; never with [`Status::BYTES`] bytes of room.
    pub fn encode(&self, bytes: &mut [u8]) -> Result<usize, LinkError> {
        let mut writer = Writer::new(bytes);
        self.put(&mut writer);
        writer.finish()
    }

    /// Reads a status. For a status of another link version, gives only that version.
    ///
    /// # Errors
    /// [`LinkError::Malformed`].
    pub fn decode(bytes: &[u8]) -> Result<Result<Self, Version>, LinkError> {
        let (version, _) =
            postcard::take_from_bytes::<Version>(bytes).map_err(|_| LinkError::Malformed)?;
        if version != super::VERSION {
            return Ok(Err(version));
        }
        postcard::from_bytes(bytes)
            .map(Ok)
            .map_err(|_| LinkError::Malformed)
    }
}
