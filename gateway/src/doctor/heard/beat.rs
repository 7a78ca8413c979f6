//! SYNC: its period, its jitter, its counter, who else sends it, and what was lost between two of them.

use std::time::Duration;

use leadscrew_can::{Packet, Stamp};

use crate::doctor::hits::Hits;

/// The counter runs from 1 to this.
const TURN: i32 = 240;
/// Times between SYNCs that are kept.
const KEPT: usize = 200_000;

/// What SYNC was like.
#[derive(Clone, Debug, Default)]
pub struct Sync {
    /// SYNCs heard.
    pub count: u64,
    /// The first of them.
    pub first: Option<Stamp>,
    /// The last of them.
    pub last: Option<Stamp>,
    /// Periods from the first to the last, by the counter where there is one.
    pub periods: u64,
    /// The last value of the counter.
    pub counter: Option<u8>,
    /// Those that do not follow from the one before, in counter or length: of another producer.
    pub foreign: Hits,
    /// Those behind which the counter goes on farther than by one, though the setpoints between were heard.
    pub lost: Hits,
    /// Periods that were lost with all that was in them: a gap in the recording.
    pub gaps: u64,
    /// Times from SYNC to SYNC where none is missing between.
    pub times: Vec<Duration>,
    with_counter: [u64; 2],
    last_packet: Option<(Stamp, Packet)>,
}

/// How a SYNC follows the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// As it should, or it is the first.
    Well,
    /// Something is missing between, or it is another's.
    Not,
}

impl Sync {
    /// A SYNC; `setpoints`: the most that one drive was told since the last.
    pub fn note(&mut self, at: Stamp, payload: &[u8], packet: &Packet, setpoints: u32) -> Follows {
        self.count += 1;
        self.first.get_or_insert(at);
        let counter = payload.first().copied();
        if let Some(with) = self.with_counter.get_mut(usize::from(counter.is_some())) {
            *with += 1;
        }
        let before = std::mem::replace(&mut self.counter, counter);
        let since = self.last.replace(at).map(|last| at.since(last));
        let doubled = matches!(self.last_packet, Some((_, last)) if last == *packet);
        self.last_packet = Some((at, *packet));
        let Some(since) = since else {
            return Follows::Well;
        };
        let (Some(before), Some(counter)) = (before, counter) else {
            self.periods += 1;
            // One with a counter beside one without.
            let [without, with] = self.with_counter;
            if before.is_some() != counter.is_some() && with > 0 && without > 0 {
                self.foreign.hit(at, packet);
                return Follows::Not;
            }
            self.time(since);
            return Follows::Well;
        };
        let ahead = (i32::from(counter) - i32::from(before) - 1).rem_euclid(TURN);
        match ahead {
            0 => {
                self.periods += 1;
                self.time(since);
                Follows::Well
            }
            // The same frame twice, as a spoilt line may have it.
            _ if doubled => Follows::Not,
            1..=119 => {
                self.periods += u64::from(ahead.unsigned_abs()) + 1;
                // All that was told in the periods between was heard.
                if setpoints > ahead.unsigned_abs() {
                    self.lost.hit(at, packet);
                } else {
                    self.gaps += 1;
                }
                Follows::Not
            }
            _ => {
                self.foreign.hit(at, packet);
                Follows::Not
            }
        }
    }

    fn time(&mut self, since: Duration) {
        if self.times.len() < KEPT {
            self.times.push(since);
        }
    }

    /// The board begins anew, and its counter with it.
    pub const fn restart(&mut self) {
        self.counter = None;
        self.last_packet = None;
        self.with_counter = [0, 0];
        self.last = None;
    }

    /// The mean period, where there are enough of them.
    #[must_use]
    pub fn period(&self) -> Option<Duration> {
        let sum: Duration = self.times.iter().sum();
        let count = u32::try_from(self.times.len())
            .ok()
            .filter(|count| *count >= 100)?;
        (sum >= Duration::from_secs(1)).then(|| sum / count)
    }
}
