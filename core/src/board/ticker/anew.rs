//! The application begins anew with another parameter set, the power being on.

use super::{State, Ticker};
use crate::board::kept::Found;
use crate::params::Params;
use crate::program::Position;

impl Ticker {
    /// Begins anew with `params`: the drives are brought up again, and what was known of taps in holes stays. Where it stood
    /// comes back, as far as that is known. `None`, and nothing changes, for a set that does not pass its own checks.
    /// `found`: what is known of the stored parameters now.
    ///
    /// The machine has to stand; whoever owns the queues empties them.
    pub fn begin_anew(&mut self, params: &Params, found: Found) -> Option<Option<Position>> {
        let position = match self.state() {
            State::Starting => None,
            _ => Some(self.executor.position()),
        };
        let mut ticker = Self::new(params, position, None)?;
        ticker.succeed(self);
        ticker.withhold(found);
        *self = ticker;
        Some(position)
    }
}
