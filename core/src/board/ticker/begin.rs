//! Where a segment may begin and what that does, and the states that follow from motion having come to rest.

use super::{Detour, Ends, LastPass, Mode, Rigid, Source, Ticker, emit};
use crate::alarm::{Alarm, Code};
use crate::board::event::{Event, Switching};
use crate::motion::{Action, Motion, Stops};
use crate::units::Rpm;

impl Ticker {
    /// Begins the next segment where one may begin. Number and line of one that is over at once come back, or of one that
    /// waits for the spindle.
    pub(super) fn take_up(&mut self, ends: &mut Ends<'_, '_>) -> Option<(u32, u32, Motion)> {
        if !self.executor.is_free() {
            return None;
        }
        if let Rigid::Entering { .. } = self.rigid {
            return self.enter_rigid(ends);
        }
        if self.detour != Detour::None {
            self.go_on_with_detour(ends);
            return None;
        }
        if self.paused || !matches!(self.mode, Mode::Idle | Mode::Running | Mode::Held) {
            return None;
        }
        let epoch = self.epoch;
        let next = ends.segments.head()?;
        if next.epoch != epoch {
            return None;
        }
        if core::mem::take(&mut self.pauses_unless_hole) && !next.stops.tap_cycle {
            self.paused = self.operator.single_block;
            if self.paused {
                return None;
            }
        }
        if self.operator.hold && !next.stops.hold_not_before {
            return None;
        }
        self.mode = Mode::Running;
        self.in_program = true;
        if self.given.waits_for_rgtap && matches!(self.rigid, Rigid::On) {
            let wait = self.wait_for_release(ends);
            if wait.is_some() {
                return wait;
            }
        }
        if self.awaits {
            let next = ends.segments.head()?;
            return Some((next.number, next.span.line, Motion::Wait));
        }
        if matches!(self.rigid, Rigid::On)
            && let Some(waits) = self.wait_for_journal(ends)
        {
            return Some(waits);
        }
        self.start(ends)
    }

    /// Begins the segment at the head of the program's queue.
    pub(super) fn start(&mut self, ends: &mut Ends<'_, '_>) -> Option<(u32, u32, Motion)> {
        let task = ends.segments.peek()?;
        let segment = task.segment;
        let events = &mut *ends.events;
        let (number, line, stops) = (segment.number, segment.span.line, segment.stops);
        let instant = match segment.action {
            Action::Planned
                if let Some(tap) = task.tap()
                    && !matches!(self.rigid, Rigid::On) =>
            {
                if self.engages_itself(tap, number, line) {
                    return Some((number, line, Motion::Wait));
                }
                // No program asks for this: its rigid mode comes first.
                let alarm = Alarm::new(Code::TapModePlace, segment.span);
                ends.segments.take();
                self.raise(&alarm, ends);
                return None;
            }
            Action::Planned
                if let Some(tap) = task.tap()
                    && tap.hole.spindle != self.taps_with =>
            {
                // E of the cycle: it changes over at standstill, and the hole begins then.
                let spindle = tap.hole.spindle;
                self.enter_with(spindle, number, line);
                return Some((number, line, Motion::Wait));
            }
            Action::Timed(_) | Action::Planned | Action::Dwell(_) => {
                if let Some(pass) = task.pass() {
                    self.pass = Some(LastPass {
                        number,
                        span: segment.span,
                        frozen: segment.stops.frozen,
                        ways: pass.ways,
                    });
                }
                if let Some(tap) = task.tap() {
                    self.tap_begins(tap);
                }
                emit(events, Event::Started { number, line });
                self.executor.begin(task);
                // It stays where it is until it is done.
                self.source = Source::Program;
                return None;
            }
            Action::Spindle(rpm) => {
                self.commanded = rpm;
                self.rigid = match self.rigid {
                    Rigid::On | Rigid::Leaving => Rigid::Leaving,
                    Rigid::Off | Rigid::Entering { .. } => Rigid::Off,
                };
                Event::Spindle(rpm)
            }
            Action::Rigid(spindle) => {
                self.commanded = Rpm::STOPPED;
                match self.rigid {
                    Rigid::On | Rigid::Leaving if spindle == self.taps_with => {
                        self.rigid = Rigid::On;
                    }
                    _ => self.enter_with(spindle, number, line),
                }
                Event::Rigid
            }
            Action::TapOut => {
                self.tap_is_out();
                ends.segments.take();
                emit(ends.events, Event::Started { number, line });
                return Some((number, line, Motion::Run));
            }
            Action::Aux(aux) => {
                self.switching = Switching::Function(aux);
                Event::Aux(aux)
            }
            Action::Alarm(alarm) => {
                ends.segments.take();
                self.raise(&alarm, ends);
                return None;
            }
            Action::End => {
                self.in_program = false;
                self.commanded = Rpm::STOPPED;
                self.mode = Mode::Idle;
                emit(events, Event::Finished);
                ends.segments.take();
                return None;
            }
        };
        ends.segments.take();
        emit(ends.events, Event::Started { number, line });
        emit(ends.events, instant);
        self.pause_behind(stops);
        Some((number, line, Motion::Run))
    }

    /// Single block behind a segment.
    pub(super) const fn pause_behind(&mut self, stops: Stops) {
        if stops.single_block && self.operator.single_block {
            self.pauses_unless_hole = stops.stops_after_last_hole;
            self.paused = !stops.stops_after_last_hole;
        }
    }

    /// State changes that follow from motion having come to rest; `moved`: a segment was under way in this tick.
    pub(super) fn settle(&mut self, motion: Motion, moved: bool, ends: &mut Ends<'_, '_>) {
        match self.mode {
            Mode::Stopping(then) => {
                if !self.executor.is_free() || self.detour != Detour::None {
                    return;
                }
                if core::mem::take(&mut self.clearing)
                    && let Some(target) = self.not_clear()
                {
                    self.detour = Detour::Clearing;
                    self.route([Some(target), None]);
                    return;
                }
                self.finish_stop(then, ends.events);
            }
            Mode::Running | Mode::Held => {
                let free = self.executor.is_free();
                if moved && free {
                    self.pause_behind(self.executor.stops());
                }
                let between = free
                    && match self.detour {
                        Detour::None => {
                            (self.paused || self.operator.hold) && !self.must_go_on(ends)
                        }
                        Detour::AtHome => true,
                        _ => false,
                    };
                let resting = motion == Motion::Hold || between;
                if resting && self.mode == Mode::Running {
                    self.mode = Mode::Held;
                    emit(ends.events, Event::Held);
                } else if !resting {
                    self.mode = Mode::Running;
                }
            }
            // A program that is held before its first block.
            Mode::Idle => {
                if self.operator.hold && self.is_next(ends) && !self.must_go_on(ends) {
                    self.mode = Mode::Held;
                    emit(ends.events, Event::Held);
                }
            }
            Mode::Alarm => self.stood = self.stood.saturating_add(1),
            Mode::Starting => {}
        }
    }

    /// A segment waits that still counts.
    pub(super) fn is_next(&self, ends: &Ends<'_, '_>) -> bool {
        let epoch = self.epoch;
        ends.segments.head().is_some_and(|next| next.epoch == epoch)
    }

    /// The retract behind a stroke is next: nothing rests here.
    pub(super) fn must_go_on(&self, ends: &Ends<'_, '_>) -> bool {
        !self.paused
            && ends
                .segments
                .head()
                .is_some_and(|next| next.stops.hold_not_before)
    }
}
