//! An ordinary tap on the board: who turns the spindle, and what a lost count does.

use super::Ticker;
use crate::bus::MilliRpm;

impl Ticker {
    /// What the spindle is told in speed mode: by an ordinary tap while one is under way, else the program's speed with its
    /// override.
    pub(super) fn velocity(&self) -> MilliRpm {
        match self.executor.spindle_speed() {
            Some(rate) => MilliRpm::of_rate(rate),
            None => MilliRpm::of(self.commanded, u16::from(self.spindle_percent)),
        }
    }

    /// Where counts were lost or gained the pulse is right, the counts are not, and the next pulse begins a new count. That
    /// moves the angle by up to half a turn, so not while an axis follows it as it stands: as soon as none does.
    pub(super) const fn begin_new_count(&mut self) {
        if self.slipped && !self.executor.is_floating() {
            self.slipped = false;
            self.observer.forget_index();
        }
    }
}
