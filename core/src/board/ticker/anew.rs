//! Starts the application again with another parameter set while the power stays on.

use super::away::Away;
use super::spindle::SpindleMode;
use super::{Given, State, Ticker};
use crate::board::drives::Figures;
use crate::board::event::Switching;
use crate::board::kept::Found;
use crate::board::operator::Operator;
use crate::call::Position;
use crate::params::Params;

impl Ticker {
    /// Starts again with `params`: the drives are enabled again, and the knowledge of taps in holes stays. Returns the last
    /// position, if it is known. Returns `None` and changes nothing for a set that does not pass its own checks, or where
    /// the machine may not move any more. `found`: the present state of the stored parameters.
    ///
    /// The machine must stand. The owner of the queues empties them.
    pub fn begin_anew(&mut self, params: &Params, found: Found) -> Option<Option<Position>> {
        if self.state.stays_at_rest() {
            return None;
        }
        let told = self.executor.position();
        let position = match self.state {
            // The position is not known yet, or not known again.
            State::Starting => self.remembered,
            _ => Some(told),
        };
        let figures = (Given::of(params), Figures::of(params));
        let (Some(given), Some(figures)) = &figures else {
            return None;
        };
        // Field by field: a whole new value would be on the stack twice, and most of it is the memory of a profile that
        // stands.
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
        // Until the drives are enabled, the last commanded position stays in force.
        executor.set_position(told);
        Some(position)
    }
}
