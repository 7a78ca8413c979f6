//! The commands to the spindles: a speed, or position mode of one spindle (rigid mode). A spindle enters position mode at
//! standstill and leaves it with the next speed.
//!
//! [`SpindleMode`] knows the commands. Drives and executor carry them out.

use super::orient::Turning;
use super::surface::Surface;
use super::{Ends, Ticker};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::MilliRpm;
use crate::call::{SurfaceSpeed, TapSpindle};
use crate::motion::{Action, Motion};
use crate::tick::operator::overridden;
use crate::units::{Length, Rpm};

/// Position mode of a spindle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rigid {
    /// Speed mode.
    Off,
    /// Coming to a stand: the move that asked for position mode, its line, and the ticks since.
    Entering { number: u32, line: u32, ticks: u32 },
    /// In position mode: the spindle turns only with the tap axis.
    On,
    /// In position mode, on its way to an angle.
    Turning(Turning),
    /// In position mode at its angle: nothing turns it.
    Oriented,
    /// Back to speed mode as soon as the spindle stands.
    Leaving,
}

/// The commands to the spindles.
#[derive(Debug)]
pub(super) struct SpindleMode {
    pub(super) rigid: Rigid,
    /// The spindle in position mode, or on its way there.
    taps_with: TapSpindle,
    /// Override in force, in per cent; frozen inside a thread cycle.
    percent: u8,
    /// S with M03/M04, before override. Under constant surface speed its sign counts alone.
    speed: Rpm,
    surface: Option<Surface>,
    /// The part of `speed` that a press commands: all of it, or none.
    by_hand: Rpm,
    /// Ticks for which leaving position mode has waited.
    waited: u32,
    /// The door has stopped the spindle, and the program has not been resumed.
    suspended: bool,
    /// The program has been resumed since, and the spindle has not been at its speed yet.
    arriving: bool,
}

impl SpindleMode {
    /// At rest, in speed mode.
    pub(super) const fn new() -> Self {
        Self {
            rigid: Rigid::Off,
            taps_with: TapSpindle::First,
            percent: 100,
            speed: Rpm::STOPPED,
            surface: None,
            by_hand: Rpm::STOPPED,
            waited: 0,
            suspended: false,
            arriving: false,
        }
    }

    /// The spindle that is in position mode, or was last.
    pub(super) const fn taps_with(&self) -> TapSpindle {
        self.taps_with
    }

    /// Commanded speed, override included.
    pub(super) fn commanded(&self) -> Rpm {
        match &self.surface {
            None => overridden(self.speed, self.percent),
            Some(surface) => {
                let whole = surface.command(self.percent).saturating_add(500) / 1000;
                Rpm::new(whole.saturating_mul(self.speed.get().signum()))
            }
        }
    }

    /// The speed command in speed mode.
    pub(super) fn velocity(&self) -> MilliRpm {
        match &self.surface {
            None => MilliRpm::of(self.speed, u16::from(self.percent)),
            Some(surface) => {
                let milli = surface.command(self.percent);
                // Only its sign changes.
                MilliRpm::new(milli.wrapping_mul(self.speed.get().signum()))
            }
        }
    }

    /// A tick under constant surface speed, with the tool at `x`: the command changes by at most `step`.
    pub(super) fn follow(&mut self, x: Length, step: u32) {
        if let Some(surface) = &mut self.surface {
            surface.tick(x, step);
        }
    }

    /// A motion begins: the place that counts for constant surface speed is `end`, or the tool's own.
    pub(super) const fn aim(&mut self, end: Option<Length>) {
        if let Some(surface) = &mut self.surface {
            surface.aim(end);
        }
    }

    /// Sets the override in force.
    pub(super) const fn set_percent(&mut self, percent: u8) {
        self.percent = percent;
    }

    /// The commanded speed is zero from now on.
    pub(super) const fn stop(&mut self) {
        self.speed = Rpm::STOPPED;
        self.surface = None;
        self.by_hand = Rpm::STOPPED;
        (self.suspended, self.arriving) = (false, false);
    }

    /// A press turns the spindle so from now on, or no longer: then it stops.
    pub(super) fn turn_by_hand(&mut self, rpm: Rpm) {
        if rpm != self.by_hand {
            self.turn(rpm, None);
            self.by_hand = rpm;
        }
    }

    /// The spindle stops, and turns again when the program goes on.
    pub(super) const fn suspend(&mut self) {
        self.suspended = true;
    }

    /// True while the spindle is to stand although a speed is commanded.
    pub(super) const fn is_suspended(&self) -> bool {
        self.suspended
    }

    /// The program goes on, with this override. True where the spindle has to come to its speed first, however often the
    /// program was held and resumed meanwhile.
    pub(super) const fn go_on(&mut self, percent: u8) -> bool {
        if core::mem::replace(&mut self.suspended, false) {
            self.percent = percent;
            self.arriving = self.speed.get() != 0;
        }
        self.arriving
    }

    /// The spindle is at its speed.
    pub(super) const fn arrive(&mut self) {
        self.arriving = false;
    }

    /// The spindle turns, or is to turn when the program goes on.
    pub(super) const fn is_ordered(&self) -> bool {
        self.speed.get() != 0 || !matches!(self.rigid, Rigid::Off | Rigid::Oriented)
    }

    /// A program commands a speed, or a law for it: position mode ends. A law begins at the speed that was commanded.
    pub(super) fn turn(&mut self, speed: Rpm, law: Option<SurfaceSpeed>) {
        let goes_on = self.speed.get().signum() == speed.get().signum();
        let present = match &self.surface {
            _ if !goes_on => 0,
            Some(surface) => surface.milli_rpm(),
            None => self.speed.abs().saturating_mul(1000),
        };
        self.surface = law.map(|law| Surface::new(&law, present));
        self.speed = speed;
        (self.suspended, self.arriving) = (false, false);
        self.rigid = match self.rigid {
            Rigid::On | Rigid::Leaving | Rigid::Turning(_) | Rigid::Oriented => Rigid::Leaving,
            Rigid::Off | Rigid::Entering { .. } => Rigid::Off,
        };
    }

    /// A spindle is in position mode, or on its way there: it has an angle to keep.
    pub(super) const fn holds(&self) -> bool {
        !matches!(self.rigid, Rigid::Off | Rigid::Leaving)
    }

    /// In position mode at an angle: another gear would give the increments of the drive another meaning.
    pub(super) const fn holds_angle(&self) -> bool {
        matches!(self.rigid, Rigid::Oriented)
    }

    /// Position mode ends as soon as the spindle stands.
    pub(super) const fn is_leaving(&self) -> bool {
        matches!(self.rigid, Rigid::Leaving)
    }

    /// A spindle is in position mode.
    pub(super) const fn is_rigid(&self) -> bool {
        matches!(self.rigid, Rigid::On)
    }

    /// A spindle is on its way into position mode, or in it to an angle.
    pub(super) const fn is_entering(&self) -> bool {
        matches!(self.rigid, Rigid::Entering { .. } | Rigid::Turning(_))
    }

    /// Spindle 1 is on its way to an angle.
    pub(super) const fn is_orienting(&self) -> bool {
        matches!(self.rigid, Rigid::Turning(_))
    }

    /// A tap is out of its hole: back to speed mode as soon as the spindle stands.
    pub(super) const fn leave(&mut self) {
        if let Rigid::On = self.rigid {
            self.rigid = Rigid::Leaving;
        }
    }

    /// A stop: a spindle in position mode stays there, because a tap may be in its hole. A spindle on its way there just
    /// stops.
    pub(super) const fn stay_rigid(&mut self) {
        self.rigid = match self.rigid {
            Rigid::Off | Rigid::Entering { .. } => Rigid::Off,
            Rigid::On | Rigid::Leaving => Rigid::On,
            Rigid::Turning(_) | Rigid::Oriented => Rigid::Oriented,
        };
    }

    /// Nothing waits for RGTAP any more.
    pub(super) const fn forget_wait(&mut self) {
        self.waited = 0;
    }
}

impl Ticker {
    /// True if `spindle` is in position mode already. It then stays there.
    fn stays_with(&mut self, spindle: TapSpindle) -> bool {
        let mode = &mut self.spindle;
        let is_in = matches!(mode.rigid, Rigid::On | Rigid::Leaving | Rigid::Oriented);
        let stays = is_in && spindle == mode.taps_with;
        if stays {
            mode.rigid = Rigid::On;
        }
        stays
    }

    /// Asks for position mode of `spindle`: for a move of the program, or for a way out of a hole, which no program has
    /// asked for.
    pub(super) fn ask_for_rigid(&mut self, spindle: TapSpindle, number: u32, line: u32) {
        self.spindle.stop();
        if !self.stays_with(spindle) {
            self.enter_with(spindle, number, line);
        }
    }

    /// Begins position mode of `spindle` for a move. Another spindle that was in position mode goes back to speed mode
    /// where it stands.
    pub(super) const fn enter_with(&mut self, spindle: TapSpindle, number: u32, line: u32) {
        self.executor.set_spindle(None);
        self.drives.spindles().select(TapSpindle::First);
        self.spindle.taps_with = spindle;
        self.spindle.rigid = Rigid::Entering {
            number,
            line,
            ticks: 0,
        };
    }

    /// Enters position mode once spindle 1 and the tapping spindle stand and the drive has told its position. From then on
    /// the spindle is at its commanded angle.
    pub(super) fn enter_rigid(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let taps_with = self.spindle.taps_with;
        let Rigid::Entering {
            number,
            line,
            ticks,
        } = &mut self.spindle.rigid
        else {
            return self.go_on_turning(ends);
        };
        *ticks = ticks.saturating_add(1);
        let (number, line, ticks) = (*number, *line, *ticks);
        if !self.observer.is_turning()
            && let Some(angle) = self
                .drives
                .spindles()
                .engage(taps_with, self.observer.angle())
        {
            self.drives.spindles().select(taps_with);
            self.executor.set_spindle(Some(angle));
            let orients = self
                .course
                .next(ends)
                .is_some_and(|next| matches!(next.action, Action::Orient(_)));
            self.spindle.rigid = match orients {
                true => Rigid::Oriented,
                false => Rigid::On,
            };
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

    /// Goes back to speed mode as soon as the spindle stands, or at once where its drive is not enabled any more, because
    /// its angle is lost then.
    pub(super) fn leave_rigid(&mut self) {
        let busy = self.executor.is_tapping() || self.executor.is_orienting();
        if matches!(self.spindle.rigid, Rigid::Off) || busy {
            return;
        }
        let stands = match self.spindle.taps_with {
            TapSpindle::First => !self.observer.is_turning(),
            other => self.drives.spindles().rests(other),
        };
        let lost = !self.drives.spindles().is_enabled();
        if lost || (stands && matches!(self.spindle.rigid, Rigid::Leaving)) {
            self.spindle.rigid = Rigid::Off;
            self.executor.set_spindle(None);
            self.drives.spindles().select(TapSpindle::First);
        }
    }

    /// 5200.2 = 1: the command that ends rigid mode waits for RGTAP = 0, for a second at most [D92]. Returns number and
    /// line of its move while it waits.
    pub(super) fn wait_for_release(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let next = ends.segments.head()?;
        let leaves = matches!(next.action, Action::Spindle(..) | Action::Orient(_));
        let waits = leaves && self.operator.signals.rgtap == Some(true);
        if !waits {
            self.spindle.waited = 0;
            return None;
        }
        let (number, span) = (next.number, next.span);
        self.spindle.waited = self.spindle.waited.saturating_add(1);
        if self.spindle.waited > self.given.second {
            self.raise(&Alarm::new(Code::RigidNotReleased, span), ends);
        }
        Some((number, span.line, Motion::Wait))
    }

    /// The speed command of the spindle: from an ordinary tap while one is under way, otherwise the program's speed with
    /// its override.
    pub(super) fn velocity(&mut self) -> MilliRpm {
        let x = self.executor.position().x;
        self.spindle.follow(x, self.given.surface_step);
        match self.executor.spindle_speed() {
            Some(rate) => MilliRpm::of_rate(rate),
            None => self.spindle.velocity(),
        }
    }
}
