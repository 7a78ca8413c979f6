//! Rigid mode of the spindle: into it at standstill, out of it with the next speed.

use super::{Ends, Rigid, Ticker};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::Motion;

impl Ticker {
    /// A stop: a spindle in position mode stays there, for a tap may be in its hole; one on the way there just stops.
    pub(super) const fn stay_rigid(&mut self) {
        self.rigid = match self.rigid {
            Rigid::Off | Rigid::Entering { .. } => Rigid::Off,
            Rigid::On | Rigid::Leaving => Rigid::On,
        };
    }

    /// The spindle stands, and its drive has said where: from here on it is where it is told to be.
    pub(super) fn enter_rigid(&mut self, ends: &mut Ends<'_, '_>) -> Option<(u32, u32, Motion)> {
        let Rigid::Entering {
            number,
            line,
            ticks,
        } = &mut self.rigid
        else {
            return None;
        };
        *ticks = ticks.saturating_add(1);
        let (number, line, ticks) = (*number, *line, *ticks);
        if !self.observer.is_turning()
            && let Some(angle) = self.drives.engage_spindle(self.observer.angle())
        {
            self.executor.set_spindle(Some(angle));
            self.rigid = Rigid::On;
        } else if ticks > self.stop_ticks {
            let span = Span {
                line,
                ..Span::default()
            };
            let args = [
                Arg::Rpm(self.observer.speed().rpm()),
                Arg::None,
                Arg::None,
                Arg::None,
            ];
            self.raise(Alarm::new(Code::SpindleNotStopped, span).with(args), ends);
        }
        Some((number, line, Motion::Wait))
    }

    /// Back to speed mode as soon as the spindle stands, or at once where its drive is not enabled any more: its angle is
    /// lost then.
    pub(super) fn leave_rigid(&mut self) {
        let lost = self.rigid != Rigid::Off && !self.drives.has_spindle();
        let stands = self.rigid == Rigid::Leaving && !self.observer.is_turning();
        if (lost || stands) && self.executor.tap().is_none() {
            self.rigid = Rigid::Off;
            self.executor.set_spindle(None);
        }
    }
}
