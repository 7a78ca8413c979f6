//! Starts the application again with another parameter set while the power stays on.

use super::away::Away;
use super::spindle::SpindleMode;
use super::{Given, Notice, State, Ticker};
use crate::board::drives::{Drives, Figures};
use crate::board::event::Switching;
use crate::board::kept::Found;
use crate::board::operator::Operator;
use crate::params::Params;
use crate::spindle::Observer;

/// The parts of a tick side that follow from a parameter set. The background makes them, because that takes longer than a
/// tick may; the tick copies them [D131].
#[derive(Clone, Copy, Debug)]
pub struct Renewal {
    given: Given,
    observer: Observer,
    drives: Drives,
    found: Found,
}

impl Renewal {
    /// The parts for `params`; `None` for a set that does not pass its own checks. `found`: the present state of the stored
    /// parameters.
    // The value is large: it has the stack for itself.
    #[inline(never)]
    #[must_use]
    pub fn of(params: &Params, found: Found) -> Option<Self> {
        Some(Self {
            given: Given::of(params)?,
            observer: Ticker::observer_of(params),
            drives: Drives::new(params, &Figures::of(params)?),
            found,
        })
    }
}

impl Ticker {
    /// Starts again with another parameter set: the drives are enabled again, and the knowledge of taps in holes stays.
    /// What is queued does not count any more; a notice tells the background the last position. Changes nothing where the
    /// machine may not move any more.
    ///
    /// The machine must stand.
    pub fn begin_anew(&mut self, renewal: &Renewal) {
        if self.state.stays_at_rest() {
            return;
        }
        let told = self.executor.position();
        let position = match self.state {
            // The position is not known yet, or not known again.
            State::Starting => self.remembered,
            _ => Some(told),
        };
        // Field by field: most of a tick side is the memory of a profile that stands.
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
            given,
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
        let epoch = course.begin_anew();
        *away = Away::new();
        *spindle = SpindleMode::new();
        *withheld = renewal.found;
        *operator = Operator::new();
        *given = renewal.given;
        *observer = renewal.observer;
        *remembered = position;
        *notice = Some(Notice::Restart(position.unwrap_or_default(), epoch));
        journal.begin_anew(given.second);
        drives.begin_anew(&renewal.drives);
        executor.begin_anew(given.arrival);
        // Until the drives are enabled, the last commanded position stays in force.
        executor.set_position(told);
    }
}
