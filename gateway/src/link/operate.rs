//! The mode of the machine, the board's beat, and the board's refusals.

use std::time::{Duration, Instant};

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::device::objects::{BEAT, BY_WHEEL, MODE, REFUSED, TOOL};
use leadscrew_core::bus::{Beat, BoardCommand, BoardState, Frame, Object, Order};
use leadscrew_core::link::Event;
use leadscrew_core::offsets::InPlace;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::Axes;

use super::{Link, LinkResult, Trouble};

/// Refusals of what an operator asks, by their numbers.
pub const BY_MODE: std::ops::Range<u16> = 4500..4600;
/// By default a beat comes every 10 ms. Boards above node 31 send none, and are asked.
const BEAT_COMES: Duration = Duration::from_millis(100);
/// An axis that was let go comes to rest within this time, and the dead man's time of 9040 is over.
const BY_HAND_ENDS: Duration = Duration::from_secs(1);

impl Link {
    /// The board's beat for an order that needs its echo.
    ///
    /// # Errors
    /// The board does not answer.
    pub(super) fn echo_for(
        &mut self,
        command: &BoardCommand,
        each: &mut dyn FnMut(&Frame),
    ) -> LinkResult<Option<Beat>> {
        if !command.order.is_some_and(Order::needs_echo) {
            return Ok(None);
        }
        self.hear_all(each)?;
        self.newest_beat().map(Some)
    }

    /// The newest beat.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn beat(&mut self) -> LinkResult<Beat> {
        self.hear_all(&mut |_| {})?;
        self.newest_beat()
    }

    fn newest_beat(&mut self) -> LinkResult<Beat> {
        match self.seen.beat {
            Some(told) => Ok(told.beat),
            None => {
                let raw = self.read_number(BEAT)?;
                let raw = u16::try_from(raw).map_err(|_| self.strange(BEAT))?;
                Ok(Beat::new(raw))
            }
        }
    }

    /// The mode of the machine.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn mode(&mut self) -> LinkResult<OperatingMode> {
        self.hear_all(&mut |_| {})?;
        if let Some(told) = self.seen.beat {
            return Ok(told.mode);
        }
        let raw = self.read_number(MODE)?;
        let mode = u8::try_from(raw).ok().and_then(OperatingMode::from_raw);
        mode.ok_or_else(|| self.strange(MODE))
    }

    /// Brings the machine into the mode that a command needs. Whoever moves it by hand goes on: only who asks for a mode by
    /// its name [ends a press](Self::change_mode).
    ///
    /// # Errors
    /// [`Trouble::Refused`]; the board does not answer.
    pub fn set_mode(&mut self, mode: OperatingMode) -> LinkResult {
        self.nobody_by_hand()?;
        self.change_mode(mode)
    }

    /// Changes the mode, if the machine is in another, which ends every press.
    ///
    /// # Errors
    /// As [`set_mode`](Self::set_mode).
    pub fn change_mode(&mut self, mode: OperatingMode) -> LinkResult {
        if self.mode()? == mode {
            return Ok(());
        }
        self.order(Order::Mode(mode))
    }

    /// Waits a moment for somebody who moves the machine by hand: the last command may have left it coming to rest.
    ///
    /// # Errors
    /// 4505 where it goes on; the board does not answer.
    pub fn nobody_by_hand(&mut self) -> LinkResult {
        let end = Instant::now() + BY_HAND_ENDS;
        while self.status()?.state == BoardState::Run && self.mode()?.by_hand() {
            if Instant::now() >= end {
                return Err(self.refused_by(Alarm::of(Code::AnotherOperator, &[])));
            }
            self.idle(BEAT_COMES)?;
        }
        Ok(())
    }

    /// The axes that have a way to find their reference (9050).
    ///
    /// # Errors
    /// The board does not answer.
    pub fn axes_that_home(&mut self) -> LinkResult<Axes> {
        let mut axes = Axes::NONE;
        for (sub, axis) in (1..).zip(Axes::ALL.each()) {
            if self.read_number(Object::new(0x2000 + 9050, sub))? != 0 {
                axes = axes.with(axis);
            }
        }
        Ok(axes)
    }

    /// The next program follows a handwheel, or does not.
    ///
    /// # Errors
    /// A program is under way; the board does not answer.
    pub fn set_by_wheel(&mut self, by_wheel: bool) -> LinkResult {
        self.write(BY_WHEEL, &[u8::from(by_wheel)])
    }

    /// The tool in place, by what the machine has carried out since power-up.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn tool(&mut self) -> LinkResult<InPlace> {
        let code = self.read_number(TOOL)?;
        let code = u16::try_from(code).map_err(|_| self.strange(TOOL))?;
        Ok(InPlace::default().after(code))
    }

    /// Offsets are written in any mode but the one for the reference.
    ///
    /// # Errors
    /// As [`set_mode`](Self::set_mode).
    pub(super) fn leave_reference(&mut self) -> LinkResult {
        if self.mode()? == OperatingMode::Reference {
            self.set_mode(OperatingMode::Manual)?;
        }
        Ok(())
    }

    /// A program needs the mode for programs, or the one for single lines. It is not changed here: who has changed it since
    /// the check began wants no program to begin [D534].
    ///
    /// # Errors
    /// 4501 in another mode; the board does not answer.
    pub fn ready_to_run(&mut self) -> LinkResult {
        let mode = self.mode()?;
        if mode.runs() {
            return Ok(());
        }
        let modes = [OperatingMode::Automatic, mode].map(Arg::Mode);
        Err(self.refused_by(Alarm::of(Code::WrongMode, &modes)))
    }

    /// Whether the order that was just confirmed was carried out. That no program waited is told by the event log alone.
    ///
    /// # Errors
    /// [`Trouble::Refused`].
    pub(super) fn heed_refusal(&mut self) -> LinkResult {
        match self.refusal()? {
            None => Ok(()),
            Some(reason) if reason.code == Code::NothingToRun => Ok(()),
            Some(reason) => Err(self.refused_by(reason)),
        }
    }

    /// The refusal in words.
    pub fn refused_by(&self, reason: Alarm) -> Trouble {
        Trouble::Refused {
            node: self.node().get(),
            reason,
        }
    }

    /// Why the last request was refused, by the next beat; `None` where it was not.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn refusal(&mut self) -> LinkResult<Option<Alarm>> {
        let before = self.seen.beats;
        let until = Instant::now() + BEAT_COMES;
        while self.seen.beat.is_some() && self.seen.beats == before && Instant::now() < until {
            self.idle(Duration::from_millis(1))?;
        }
        let number = match self.seen.beat {
            Some(told) => told.refused,
            None => u16::try_from(self.read_number(REFUSED)?).unwrap_or(0),
        };
        Code::from_number(number)
            .map(|code| self.reason_of(code))
            .transpose()
    }

    /// The refusal with its figures, which are in the board's event log.
    fn reason_of(&mut self, code: Code) -> LinkResult<Alarm> {
        let newest = self.newest_event()?;
        let logged = self.events_behind(newest.saturating_sub(REASON_LIES))?;
        let told = logged.iter().rev().find_map(|entry| match entry.event {
            // What has ended it may be an alarm that stands.
            Event::Warning(alarm) | Event::Alarm(alarm) | Event::Refused(alarm)
                if alarm.code == code =>
            {
                Some(alarm)
            }
            _ => None,
        });
        Ok(told.unwrap_or_else(|| Alarm::of(code, &[])))
    }
}

/// A refusal is looked for among so many events.
const REASON_LIES: u32 = 8;
