//! Withheld motion: a board whose stored parameters are damaged enables its drives and then stands on an alarm, again after
//! every reset, until it has accepted a parameter set [D115].

use super::{Ends, Ticker, emit};
use crate::alarm::Alarm;
use crate::tick::Event;
use crate::tick::stored::Found;

impl Ticker {
    /// Stands on an alarm before the first tick; see [`Tick::begin_in_alarm`](crate::tick::Tick::begin_in_alarm).
    pub(in crate::tick) const fn begin_in_alarm(&mut self, alarm: Alarm) {
        self.transition_to_alarm(alarm);
    }

    /// Reports the state of the stored parameters once the drives are enabled. This may raise an alarm.
    pub(super) fn tell_found(&mut self, ends: &mut Ends<'_>) {
        if let Some(alarm) = self.found.alarm() {
            self.raise(&alarm, ends);
        } else if let Some(warning) = self.found.warning() {
            // One report is enough.
            self.found = Found::Newest;
            emit(&mut ends.events, Event::Warning(warning));
        }
    }
}
