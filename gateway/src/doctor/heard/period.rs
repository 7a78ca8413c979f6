//! What is told within a SYNC period: one identifier twice with different contents, and setpoints that missed theirs.

use std::collections::BTreeMap;

use leadscrew_can::{Packet, Stamp};
use leadscrew_core::bus::CobId;

use super::beat::Follows;
use crate::doctor::hits::Hits;

/// Periods in which an identifier has to have come before one without it says something.
const KNOWN: u32 = 8;

/// The frames of one identifier.
#[derive(Clone, Debug, Default)]
struct Told {
    count: u32,
    before: u32,
    periods: u32,
    first: Vec<u8>,
    other: Option<(Stamp, Packet)>,
    last: Option<(Stamp, Packet)>,
}

/// The frames of the period, by identifier.
#[derive(Clone, Debug, Default)]
pub struct Period {
    told: BTreeMap<CobId, Told>,
    /// Two contents in one period.
    pub twice: BTreeMap<CobId, Hits>,
    /// Periods without a setpoint, followed by one with two.
    pub late: Hits,
}

impl Period {
    /// A frame that comes once a period at the most.
    pub fn note(&mut self, at: Stamp, id: CobId, payload: &[u8], packet: &Packet) {
        let told = self.told.entry(id).or_default();
        if told.count == 0 {
            told.first.clear();
            told.first.extend_from_slice(payload);
        } else if told.first != payload {
            told.other = Some((at, *packet));
        }
        told.count += 1;
        told.last = Some((at, *packet));
    }

    /// How often the identifier came since the last SYNC that is most often told.
    pub fn most(&self, of: impl Fn(CobId) -> bool) -> u32 {
        let counts = self.told.iter().filter(|(id, _)| of(**id));
        counts.map(|(_, told)| told.count).max().unwrap_or(0)
    }

    /// The next SYNC. `every`: the identifiers that come in every period.
    pub fn next(&mut self, follows: Follows, every: impl Fn(CobId) -> bool) {
        for (id, told) in &mut self.told {
            let other = told.other.take();
            let cyclic = every(*id);
            if follows == Follows::Well && told.periods >= KNOWN {
                let moved = cyclic && told.before == 0;
                if let Some((at, packet)) = other
                    && !moved
                {
                    self.twice.entry(*id).or_default().hit(at, &packet);
                }
                if moved
                    && told.count >= 2
                    && let Some((at, packet)) = told.last
                {
                    self.late.hit(at, &packet);
                }
            }
            told.periods += u32::from(told.count > 0);
            told.before = told.count;
            told.count = 0;
        }
    }
}
