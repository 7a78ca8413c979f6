//! All that a look at the board shows: object 5001h.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::writer::{Put, Writer};
use super::{LinkError, Version};
use crate::alarm::Alarm;
use crate::bus::BoardState;
use crate::program::Position;
use crate::units::{Length, Rpm, TurnRate, Turns};

/// The status record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// The link the board speaks. First, so that it is read before anything else.
    pub version: Version,
    /// Ticks since power-up.
    pub tick: u64,
    /// What the machine is doing.
    pub state: BoardState,
    /// The alarm it stands on.
    pub alarm: Option<Alarm>,
    /// A program is under way.
    pub in_program: bool,
    /// Source line of what executes; 0 for nothing.
    pub line: u32,
    /// Its move; 0 for nothing.
    pub number: u32,
    /// The last setpoint, machine coordinates.
    pub position: Position,
    /// Angle of the spindle at the last SYNC.
    pub spindle: Turns,
    /// Its measured speed.
    pub speed: TurnRate,
    /// Its commanded speed, override included.
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
    /// Setpoint minus where the axis should be at the measured angle, while an axis is held to the spindle.
    pub sync_error: Option<Length>,
    /// Setpoints that came late for their SYNC, since power-up.
    pub late: u32,
    /// The program being fed or carried out.
    pub program: u32,
    /// The number of the call of that program that the board expects next.
    pub next_call: u32,
    /// Bytes of program that the board has room for.
    pub credit: u16,
    /// Number of the newest entry of the event log; 0 for none.
    pub newest_event: u32,
    /// The inputs and what is mirrored behind them, as [`Snapshot::signals`](crate::board::Snapshot::signals) gives them:
    /// object 5060h.
    pub signals: u16,
    /// CRC-32 of the parameter set in force.
    pub parameters: u32,
}

impl Status {
    /// The most bytes a status takes.
    pub const BYTES: usize = 256;

    /// Puts the status at the front of `bytes`; how many it takes comes back.
    ///
    /// # Errors
    /// [`LinkError::TooLong`]; not with [`Status::BYTES`] of room.
    pub fn encode(&self, bytes: &mut [u8]) -> Result<usize, LinkError> {
        let mut writer = Writer::new(bytes);
        self.put(&mut writer);
        writer.finish()
    }

    /// Reads a status. One of another version of the link is not looked at further: its version comes back.
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
