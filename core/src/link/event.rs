//! The event log: what happened, numbered, object 5040h.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::LinkError;
use super::writer::{Put, Writer};
use crate::alarm::Alarm;
use crate::board::Event;

/// An entry of the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Logged {
    /// Counted from 1 since power-up; a gap means that older entries had to go.
    pub number: u32,
    /// When it was read from the tick, in ticks since power-up.
    pub tick: u64,
    /// What happened.
    pub event: Event,
}

/// Puts an entry, part by part as [`Logged`] has them, at the front of `bytes`; how many it takes comes back.
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

/// Puts an alarm, or that there is none, at the front of `bytes`; how many it takes comes back. 5010h:08.
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

/// The entries of a reading of the log, in order.
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
