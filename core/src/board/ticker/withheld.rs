//! Motion that is withheld: a board whose stored parameters are damaged brings its drives up and stands on an alarm,
//! after every reset again, until a set has been taken [D115].

use super::{Ends, State, Ticker, emit};
use crate::alarm::Alarm;
use crate::board::event::Event;
use crate::board::kept::Found;

impl Ticker {
    /// Stands on an alarm from the start: the board did not come to its end in good order the last time. To be said
    /// before the first tick; the drives are brought up after a reset.
    pub const fn begin_in_alarm(&mut self, alarm: Alarm) {
        self.state = State::Alarm(alarm);
    }

    /// Says what was found of the stored parameters. To be said before the drives are up.
    pub const fn withhold(&mut self, found: Found) {
        self.found = found;
    }

    /// The drives have come up: what was found is told, and may end in an alarm.
    pub(super) fn tell_found(&mut self, ends: &mut Ends<'_, '_>) {
        if let Some(alarm) = self.found.alarm() {
            self.raise(&alarm, ends);
        } else if let Some(warning) = self.found.warning() {
            // Once is enough.
            self.found = Found::Newest;
            emit(ends.events, Event::Warning(warning));
        }
    }
}
