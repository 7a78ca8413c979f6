//! Machine functions: the row of an M code is carried out, and the program waits for its answer.
//!
//! No segment begins while one waits, so the program's order holds exactly. Must not know which inputs keep people safe.

use super::interlock::Admitted;
use super::tool::Indexing;
use super::{Ends, Ticker};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::Motion;
use crate::operating::Interlock;
use crate::params::{FunctionRow, gear_of_code};

/// What the program waits for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pending {
    Row(Answering),
    Turret(Indexing),
}

/// A function that waits for its answer, or for the end of its pulse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answering {
    row: FunctionRow,
    number: u32,
    span: Span,
    /// Ticks that are left.
    left: u32,
}

/// How long the chuck has waited to be opened, and how long the spindle has stood meanwhile.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChuckWait {
    waited: u32,
    stood: u32,
}

impl Ticker {
    /// Begins the function of a row, for the move `number`.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_function(&mut self, row: &FunctionRow, number: u32, span: Span) {
        self.machine.begin(row);
        self.shift(row.code, false);
        let ticks = row.time_ms.saturating_mul(self.given.second) / 1000;
        if ticks == 0 {
            self.machine.finish(row);
            self.shift(row.code, true);
            return;
        }
        self.function = Some(Pending::Row(Answering {
            row: *row,
            number,
            span,
            left: ticks,
        }));
    }

    /// Number and line of the move that still waits for its function.
    #[cold]
    #[inline(never)]
    pub(super) fn await_function(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let pending = match self.function.as_mut()? {
            Pending::Row(pending) => pending,
            Pending::Turret(turret) => {
                let turret = *turret;
                return self.await_turret(turret, ends);
            }
        };
        let Answering {
            row, number, span, ..
        } = *pending;
        let answered = row.answer.map(|answer| self.machine.has_answered(answer));
        let left = pending.left.checked_sub(1);
        pending.left = left.unwrap_or(0);
        match (answered, left) {
            (Some(true), _) | (None, None | Some(0)) => {
                self.function = None;
                self.machine.finish(&row);
                self.shift(row.code, true);
                return None;
            }
            (Some(false), None) => {
                let input = row.answer.map_or(0, |answer| answer.input.number());
                let figures = [row.code.into(), input.into(), row.time_ms.into()].map(Arg::Int);
                let alarm = Alarm::new(Code::AnswerLate, span).with(figures);
                self.raise(&alarm, ends);
            }
            _ => {}
        }
        Some((number, span.line, Motion::Wait))
    }

    /// M41 to M44 on a machine with gears: no gear is known until its row has been answered.
    #[cold]
    #[inline(never)]
    pub(super) fn shift(&mut self, code: u16, is_in: bool) {
        let number = gear_of_code(code).unwrap_or(0);
        let Some(gear) = self.given.gears.get(number) else {
            return;
        };
        self.gear = if is_in { number } else { 0 };
        self.drives.spindles().shift(gear);
    }

    /// Why the spindle may not turn at `speed` in the gear that is in.
    #[cold]
    #[inline(never)]
    pub(super) fn refuses_by_gear(&self, speed: u32, span: Span) -> Option<Alarm> {
        if !self.given.gears.are_there() {
            return None;
        }
        let Some(gear) = self.given.gears.get(self.gear) else {
            return Some(Alarm::new(Code::GearUnknown, span));
        };
        let figures = [speed, gear.most, self.gear.into()].map(|figure| Arg::Int(figure.into()));
        let alarm = Alarm::new(Code::SpeedAboveGear, span).with(figures);
        (speed > gear.most).then_some(alarm)
    }

    /// Nothing waits for a function any more.
    pub(super) fn give_up_function(&mut self) {
        self.chuck_wait = ChuckWait::default();
        let pending = self.function.take();
        if let Some(Pending::Row(pending)) = &pending {
            self.machine.give_up(&pending.row);
        }
        self.give_up_tool(matches!(pending, Some(Pending::Turret(_))));
    }

    /// The chuck is not opened, and no gear selected, before the spindle has stood for a second, and not at all
    /// while it is told to turn.
    #[cold]
    #[inline(never)]
    pub(super) fn open_chuck(&mut self) -> Admitted {
        let wait = &mut self.chuck_wait;
        wait.waited = wait.waited.saturating_add(1);
        wait.stood = match self.observer.is_turning() {
            true => 0,
            false => wait.stood.saturating_add(1),
        };
        let second = self.given.second;
        let limit = self.given.arrival.speed_ticks.saturating_add(second);
        if self.spindle.is_ordered() || wait.waited > limit {
            return Admitted::Refused(Interlock::Spindle);
        }
        if wait.stood <= second {
            return Admitted::Waits;
        }
        self.chuck_wait = ChuckWait::default();
        Admitted::Yes
    }
}
