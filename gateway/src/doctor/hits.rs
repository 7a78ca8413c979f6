//! How often a sign was seen, when, and in which frames. What a sign means is not known here.

use std::time::Duration;

use leadscrew_can::{Packet, Stamp};

/// Frames that are kept of a sign.
const SHOWN: usize = 3;
/// This many signs are enough for a finding.
const ENOUGH: u64 = 3;
/// A sign that lasts this long is enough, too.
const LONG_ENOUGH: Duration = Duration::from_secs(1);

/// A sign: single events, or a state that lasts.
#[derive(Clone, Debug, Default)]
pub struct Hits {
    /// How often.
    pub count: u64,
    /// The first time.
    pub first: Option<Stamp>,
    /// The last time.
    pub last: Option<Stamp>,
    /// The longest time that it lasted.
    pub longest: Duration,
    /// The first frames that show it.
    pub frames: Vec<(Stamp, Packet)>,
    since: Option<Stamp>,
}

impl Hits {
    /// The sign is seen in this packet.
    pub fn hit(&mut self, at: Stamp, packet: &Packet) {
        self.count += 1;
        self.first.get_or_insert(at);
        self.last = Some(at);
        if self.frames.len() < SHOWN {
            self.frames.push((at, *packet));
        }
    }

    /// The sign begins to last, if it does not already.
    pub fn begin(&mut self, at: Stamp, packet: &Packet) {
        if self.since.is_none() {
            self.hit(at, packet);
            self.since = Some(at);
        }
    }

    /// The sign is seen in this packet, and lasts until [`end`](Self::end).
    pub fn go_on(&mut self, at: Stamp, packet: &Packet) {
        self.hit(at, packet);
        self.since.get_or_insert(at);
    }

    /// It lasts no longer.
    pub fn end(&mut self, at: Stamp) {
        if let Some(since) = self.since.take() {
            self.longest = self.longest.max(at.since(since));
            self.last = Some(at);
        }
    }

    /// True while it lasts.
    #[must_use]
    pub const fn lasts(&self) -> bool {
        self.since.is_some()
    }

    /// True where it was seen often or long enough for a finding.
    #[must_use]
    pub fn enough(&self) -> bool {
        self.count >= ENOUGH || self.longest >= LONG_ENOUGH
    }

    /// What an object says stands there for as long as nobody writes it: one reading is enough.
    #[must_use]
    pub fn standing(at: Stamp) -> Self {
        Self {
            count: 1,
            first: Some(at),
            last: Some(at),
            longest: LONG_ENOUGH,
            ..Self::default()
        }
    }

    /// Both signs as one.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        let earlier = |a: Option<Stamp>, b: Option<Stamp>| match (a, b) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.count += other.count;
        self.first = earlier(self.first, other.first);
        self.last = self.last.max(other.last);
        self.longest = self.longest.max(other.longest);
        self.frames.extend(other.frames.iter().copied());
        self.frames.sort_by_key(|(at, _)| *at);
        self.frames.truncate(SHOWN);
        self
    }
}
