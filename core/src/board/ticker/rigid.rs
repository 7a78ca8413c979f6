//! Rigid mode: one spindle in position mode, into it at standstill, out of it with the next speed.

use super::{Ends, Rigid, Ticker};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::{Action, Motion};
use crate::program::TapSpindle;

impl Ticker {
    /// A stop: a spindle in position mode stays there, for a tap may be in its hole; one on the way there just stops.
    pub(super) const fn stay_rigid(&mut self) {
        self.rigid = match self.rigid {
            Rigid::Off | Rigid::Entering { .. } => Rigid::Off,
            Rigid::On | Rigid::Leaving => Rigid::On,
        };
    }

    /// Begins position mode of `spindle`, for a move; another one that was in it goes back to speed mode, where it stands.
    pub(super) const fn enter_with(&mut self, spindle: TapSpindle, number: u32, line: u32) {
        self.executor.set_spindle(None);
        self.drives.spindles().select(TapSpindle::First);
        self.taps_with = spindle;
        self.rigid = Rigid::Entering {
            number,
            line,
            ticks: 0,
        };
    }

    /// Spindle 1 and the one that taps stand, and its drive has said where: from here on it is where it is told to be.
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
            && let Some(angle) = self
                .drives
                .spindles()
                .engage(self.taps_with, self.observer.angle())
        {
            self.drives.spindles().select(self.taps_with);
            self.executor.set_spindle(Some(angle));
            self.rigid = Rigid::On;
        } else if ticks > self.given.arrival.speed_ticks {
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
            self.raise(&Alarm::new(Code::SpindleNotStopped, span).with(args), ends);
        }
        Some((number, line, Motion::Wait))
    }

    /// Back to speed mode as soon as the spindle stands, or at once where its drive is not enabled any more: its angle is
    /// lost then.
    pub(super) fn leave_rigid(&mut self) {
        if matches!(self.rigid, Rigid::Off) || self.executor.is_tapping() {
            return;
        }
        let stands = match self.taps_with {
            TapSpindle::First => !self.observer.is_turning(),
            other => self.drives.spindles().rests(other),
        };
        let lost = !self.drives.spindles().is_enabled();
        if lost || (stands && matches!(self.rigid, Rigid::Leaving)) {
            self.rigid = Rigid::Off;
            self.executor.set_spindle(None);
            self.drives.spindles().select(TapSpindle::First);
        }
    }

    /// 5200.2 = 1: the command that ends rigid mode waits for RGTAP = 0, a second
    /// at most [D92]. While it does, its move and line come back.
    pub(super) fn wait_for_release(
        &mut self,
        ends: &mut Ends<'_, '_>,
    ) -> Option<(u32, u32, Motion)> {
        let next = ends.segments.head()?;
        let waits =
            matches!(next.action, Action::Spindle(_)) && self.operator.signals.rgtap == Some(true);
        if !waits {
            self.waited = 0;
            return None;
        }
        let (number, span) = (next.number, next.span);
        self.waited = self.waited.saturating_add(1);
        if self.waited > self.given.second {
            self.raise(&Alarm::new(Code::RigidNotReleased, span), ends);
        }
        Some((number, span.line, Motion::Wait))
    }
}
