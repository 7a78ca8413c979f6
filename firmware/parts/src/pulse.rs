//! The watchdog is fed while both contexts live, and only then.
//!
//! The background feeds it, and only where the tick has gone on since it last did: a tick that has stopped is noticed, and so
//! is a background that hangs, for then nobody feeds. A tick that overruns its period all the time leaves the background no
//! time, which is the second case.

/// What the background remembers of the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulse {
    fed_at: Option<u32>,
}

impl Pulse {
    /// Before the first tick.
    #[must_use]
    pub const fn new() -> Self {
        Self { fed_at: None }
    }

    /// True where the watchdog is to be fed now: `ticks` since power-up, wrapping, has gone on.
    #[must_use = "who does not feed is bitten"]
    pub fn beats(&mut self, ticks: u32) -> bool {
        let alive = self.fed_at != Some(ticks);
        self.fed_at = Some(ticks);
        alive
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fed_as_long_as_the_tick_goes_on() {
        let mut pulse = Pulse::new();
        assert!(pulse.beats(0));
        assert!(!pulse.beats(0));
        assert!(pulse.beats(1));
        assert!(pulse.beats(5));
        assert!(!pulse.beats(5));
        assert!(pulse.beats(u32::MAX));
        assert!(pulse.beats(0));
    }
}
