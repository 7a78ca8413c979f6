//! The log of what the board tells: numbered entries, object 5040h.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::LinkError;
use super::writer::{Put, Writer};
use crate::alarm::Alarm;
use crate::tick::Event;

/// An entry of the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Logged {
    /// Counted from 1 since power-up; a gap means that older entries were dropped.
    pub number: u32,
    /// Time when the event was read from the tick, in ticks since power-up.
    pub tick: u64,
    /// The event.
    pub event: Event,
}

/// Writes an entry to the front of `bytes`, in the field order of [`Logged`]. Gives the number of bytes.
///
/// # Errors
/// [`LinkError::TooLong`] where it does not fit.
pub fn encode_event(
    number: u32,
    tick: u64,
    event: &Event,
    bytes: &mut [u8],
) -> Result<usize, LinkError> {
    let mut writer = Writer::new(bytes);
    number.put(&mut writer);
    tick.put(&mut writer);
    event.put(&mut writer);
    writer.finish()
}

/// Writes an alarm, or `None`, to the front of `bytes`. Gives the number of bytes. Object 5010h:08.
///
/// # Errors
/// [`LinkError::TooLong`] where it does not fit.
pub fn encode_alarm(alarm: Option<&Alarm>, bytes: &mut [u8]) -> Result<usize, LinkError> {
    let mut writer = Writer::new(bytes);
    writer.byte(alarm.is_some().into());
    if let Some(alarm) = alarm {
        alarm.put(&mut writer);
    }
    writer.finish()
}

/// The alarm of [`encode_alarm`].
///
/// # Errors
/// [`LinkError::Malformed`].
pub fn decode_alarm(bytes: &[u8]) -> Result<Option<Alarm>, LinkError> {
    match postcard::take_from_bytes(bytes) {
        Ok((alarm, &[])) => Ok(alarm),
        _ => Err(LinkError::Malformed),
    }
}

/// Iterates over the entries of a log that was read, in order.
#[derive(Clone, Copy, Debug)]
pub struct EventReader<'a> {
    rest: &'a [u8],
}

impl<'a> EventReader<'a> {
    /// Reads `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }
}

impl Iterator for EventReader<'_> {
    type Item = Result<Logged, LinkError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        match postcard::take_from_bytes(self.rest) {
            Ok((entry, rest)) => {
                self.rest = rest;
                Some(Ok(entry))
            }
            Err(_) => {
                self.rest = &[];
                Some(Err(LinkError::Malformed))
            }
        }
    }
}
