//! The application begins anew with another parameter set, the power being on.

use super::state::Mode;
use super::{Given, Rigid, Source, State, Ticker};
use crate::board::detour::Detour;
use crate::board::drives::Drives;
use crate::board::kept::Found;
use crate::board::operator::Operator;
use crate::motion::Epoch;
use crate::params::Params;
use crate::program::{Position, TapSpindle};
use crate::units::Rpm;

impl Ticker {
    /// Begins anew with `params`: the drives are brought up again, and what was known of taps in holes stays. Where it stood
    /// comes back, as far as that is known. `None`, and nothing changes, for a set that does not pass its own checks, and where
    /// nothing may move any more. `found`: what is known of the stored parameters now.
    ///
    /// The machine has to stand; whoever owns the queues empties them.
    pub fn begin_anew(&mut self, params: &Params, found: Found) -> Option<Option<Position>> {
        if self.stays_at_rest() {
            return None;
        }
        let position = match self.state() {
            // It has not come to know it yet, or not again.
            State::Starting => self.remembered,
            _ => Some(self.executor.position()),
        };
        let told = self.executor.position();
        let given = Given::of(params)?;
        let mut drives = Drives::new(params)?;
        drives.take_places(&self.drives);
        // Field by field: as a whole it would be on the stack twice, and most of it is the memory of a profile that stands.
        let Self {
            mode,
            // Read in a mode that has one only.
            alarm: _,
            operator,
            executor,
            observer,
            drives: before,
            remembered,
            given: figures,
            commanded,
            spindle_percent,
            rigid,
            taps_with,
            waited,
            slipped,
            paused,
            pauses_unless_hole,
            in_program,
            source,
            pass,
            detour,
            clearing,
            notice,
            epoch,
            route_epoch,
            journal,
            found: withheld,
        } = self;
        *mode = Mode::Starting;
        *operator = Operator::new();
        executor.begin_anew(given.arrival);
        // Until the drives have come up it is told to be where it was told to be.
        executor.set_position(told);
        *observer = Self::observer_of(params);
        *before = drives;
        *remembered = position;
        *commanded = Rpm::STOPPED;
        *spindle_percent = 100;
        *rigid = Rigid::Off;
        *taps_with = TapSpindle::First;
        *waited = 0;
        *slipped = false;
        (*paused, *pauses_unless_hole, *in_program) = (false, false, false);
        *source = Source::None;
        *pass = None;
        *detour = Detour::None;
        *clearing = false;
        *notice = None;
        (*epoch, *route_epoch) = (Epoch::default(), Epoch::default());
        journal.begin_anew(given.second);
        *figures = given;
        *withheld = Found::default();
        self.withhold(found);
        Some(position)
    }
}
