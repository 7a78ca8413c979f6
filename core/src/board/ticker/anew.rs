//! The application begins anew with another parameter set, the power being on.

use super::state::Mode;
use super::{Given, Rigid, Source, Ticker};
use crate::board::detour::Detour;
use crate::board::drives::Figures;
use crate::board::event::Switching;
use crate::board::kept::Found;
use crate::board::operator::Operator;
use crate::motion::Epoch;
use crate::params::Params;
use crate::program::{Position, TapSpindle};
use crate::units::Rpm;

impl Ticker {
    /// Begins anew with `params`: the drives are brought up again, and what was known of taps in holes stays. Where it
    /// stood comes back, as far as that is known. `None`, and nothing changes, for a set that does not pass its own
    /// checks, and where nothing may move any more. `found`: what is known of the stored parameters now.
    ///
    /// The machine has to stand; whoever owns the queues empties them.
    pub fn begin_anew(&mut self, params: &Params, found: Found) -> Option<Option<Position>> {
        if self.stays_at_rest() {
            return None;
        }
        let told = self.executor.position();
        let position = match self.mode {
            // It has not come to know it yet, or not again.
            Mode::Starting => self.remembered,
            _ => Some(told),
        };
        let figures = (Given::of(params), Figures::of(params));
        let (Some(given), Some(figures)) = &figures else {
            return None;
        };
        // Field by field: as a whole it would be on the stack twice, and most of it is the memory of a profile that stands.
        let Self {
            mode,
            spindle_percent,
            taps_with,
            slipped,
            paused,
            pauses_unless_hole,
            awaits,
            switching,
            stood,
            in_program,
            is_up,
            source,
            // What has been cut is not undone.
            done: _,
            detour,
            clearing,
            epoch,
            route_epoch,
            found: withheld,
            commanded,
            rigid,
            waited,
            operator,
            given: before,
            observer,
            pass,
            remembered,
            notice,
            journal,
            // Read in a mode that has one only.
            alarm: _,
            drives,
            executor,
        } = self;
        *mode = Mode::Starting;
        *spindle_percent = 100;
        *taps_with = TapSpindle::First;
        *slipped = false;
        *paused = false;
        *pauses_unless_hole = false;
        *awaits = false;
        *switching = match journal.has_hole() {
            true => Switching::ResetInHole,
            false => Switching::Reset,
        };
        *stood = 0;
        *in_program = false;
        *is_up = false;
        *source = Source::None;
        *detour = Detour::None;
        *clearing = false;
        (*epoch, *route_epoch) = (Epoch::default(), Epoch::default());
        *withheld = found;
        *commanded = Rpm::STOPPED;
        *rigid = Rigid::Off;
        *waited = 0;
        *operator = Operator::new();
        *before = *given;
        *observer = Self::observer_of(params);
        *pass = None;
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
