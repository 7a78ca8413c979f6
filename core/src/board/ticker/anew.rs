//! The application begins anew with another parameter set, the power being on.

use super::away::Away;
use super::spindle::SpindleMode;
use super::{Given, State, Ticker};
use crate::board::drives::Figures;
use crate::board::event::Switching;
use crate::board::kept::Found;
use crate::board::operator::Operator;
use crate::params::Params;
use crate::program::Position;

impl Ticker {
    /// Begins anew with `params`: the drives are brought up again, and what was known of taps in holes stays. Where it
    /// stood comes back, as far as that is known. `None`, and nothing changes, for a set that does not pass its own
    /// checks, and where nothing may move any more. `found`: what is known of the stored parameters now.
    ///
    /// The machine has to stand; whoever owns the queues empties them.
    pub fn begin_anew(&mut self, params: &Params, found: Found) -> Option<Option<Position>> {
        if self.state.stays_at_rest() {
            return None;
        }
        let told = self.executor.position();
        let position = match self.state {
            // It has not come to know it yet, or not again.
            State::Starting => self.remembered,
            _ => Some(told),
        };
        let figures = (Given::of(params), Figures::of(params));
        let (Some(given), Some(figures)) = &figures else {
            return None;
        };
        // Field by field: as a whole it would be on the stack twice, and most of it is the memory of a profile that stands.
        let Self {
            state,
            slipped,
            awaits,
            switching,
            stood,
            course,
            away,
            spindle,
            found: withheld,
            operator,
            given: before,
            observer,
            remembered,
            notice,
            journal,
            drives,
            executor,
        } = self;
        *state = State::Starting;
        *slipped = false;
        *awaits = false;
        *switching = match journal.has_hole() {
            true => Switching::ResetInHole,
            false => Switching::Reset,
        };
        *stood = 0;
        course.begin_anew();
        *away = Away::new();
        *spindle = SpindleMode::new();
        *withheld = found;
        *operator = Operator::new();
        *before = *given;
        *observer = Self::observer_of(params);
        *remembered = position;
        *notice = None;
        journal.begin_anew(given.second);
        drives.begin_anew(params, figures);
        executor.begin_anew(given.arrival);
        // Until the drives have come up it is told to be where it was told to be.
        executor.set_position(told);
        Some(position)
    }
}
