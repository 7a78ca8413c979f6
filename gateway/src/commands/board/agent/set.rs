//! The parameter set of one board: read where its checksum is another, for the cut of threads and for those who ask the
//! broker later.
//!
//! It must not know the broker. What has been read once is not asked for again while the checksum is the same, whoever
//! needs it and however often the board is met.

use std::collections::BTreeMap;

use leadscrew_agent::Memory;
use leadscrew_agent::set::Set;
use leadscrew_core::link::identity;
use leadscrew_core::params::Params;

use crate::in_force::values;
use crate::link::{Link, LinkResult, Trouble};
use crate::params::schema::SCHEMA;

/// The time when a set was seen last is told anew behind so many milliseconds: it is right by so much.
const REFRESH: u64 = 600_000;

/// The set that was read last, and the checksum that it was read for.
#[derive(Debug, Default)]
pub struct Sets {
    read: Option<(u32, Result<Params, Trouble>)>,
}

impl Sets {
    /// The set with this checksum; why it is not understood, where it is of another version of the table.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn get(
        &mut self,
        link: &mut Link,
        parameters: u32,
    ) -> LinkResult<Result<&Params, &Trouble>> {
        let read = match self.read.take().filter(|(of, _)| *of == parameters) {
            Some((_, read)) => read,
            None => match link.parameters() {
                Ok(set) => Ok(set.params),
                // A set of another version of the table stays one.
                Err(trouble @ Trouble::Strange { .. }) => Err(trouble),
                Err(trouble) => return Err(trouble),
            },
        };
        Ok(self.read.insert((parameters, read)).1.as_ref())
    }
}

/// What is told of the set.
#[derive(Debug, Default)]
pub struct Telling {
    /// Its values, and their checksum; `None` where they are not understood.
    known: Option<(u32, Option<BTreeMap<String, String>>)>,
    told: Option<Set>,
}

impl Telling {
    /// Makes the values with this checksum known. Where the set has changed between that and its reading, it is read again
    /// the next time.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn know(&mut self, sets: &mut Sets, link: &mut Link, parameters: u32) -> LinkResult {
        if self.known.as_ref().is_some_and(|(of, _)| *of == parameters) {
            return Ok(());
        }
        match sets.get(link, parameters)? {
            Ok(params) if identity(params) != parameters => sets.read = None,
            Ok(params) => self.known = Some((parameters, Some(values(params)))),
            Err(_) => self.known = Some((parameters, None)),
        }
        Ok(())
    }

    /// The set, where there is something new to tell. `last`: there may be nothing more to tell for long.
    pub fn news(&mut self, memory: &Memory, last: bool) -> Option<Set> {
        let (identity, in_force) = memory.in_force()?;
        let (of, values) = self.known.as_ref()?;
        if *of != in_force.parameters {
            return None;
        }
        let set = Set {
            serial: identity.start.serial,
            firmware: identity.firmware.clone(),
            parameters: in_force.parameters,
            schema: SCHEMA,
            since: in_force.since,
            after: in_force.after,
            seen: in_force.seen,
            values: values.clone(),
        };
        if let Some(told) = &self.told {
            // A clock that was set back says nothing of how old it is.
            let old = set.seen.0.checked_sub(told.seen.0).unwrap_or(REFRESH);
            let same = Set {
                seen: told.seen,
                ..set.clone()
            } == *told;
            if same && old < REFRESH && !(last && old > 0) {
                return None;
            }
        }
        self.told = Some(set.clone());
        Some(set)
    }
}
