//! From one state of the machine to the next: every change of [`State`], and all that belongs to it.
//!
//! ```text
//! Starting ─► Idle ◄─► Running ◄─► Held
//!     ▲         ▲ ▲ ◄─► ByHand, Homing
//!     ▲         ▲          │ each of them
//!     │         └─ reset ── Stopping ── alarm ─► Alarm
//!     └──────────────────── reset ──────────────────┘
//! ```
//!
//! Says what a state brings with it. Must not know when a state changes: the files that call these functions do.

use super::{Ends, Notice, Outcome, State, Ticker, emit};
use crate::alarm::Alarm;
use crate::call::Position;
use crate::motion::Stops;
use crate::tick::Event;
use crate::tick::command::Switching;
use crate::tick::queue::EventIn;

impl Ticker {
    /// Nothing moves until the drives are enabled, which they are asked for from now on.
    pub(super) fn transition_to_starting(&mut self) {
        self.drives.reset();
        self.course.resume();
        // To the nanometre, where the drives have not been moved meanwhile.
        self.remembered = self.remembered.or(Some(self.executor.position()));
        self.switching = self.switching_of_reset();
        self.machine.reset();
        self.state = State::Starting;
    }

    /// The drives are enabled, and the machine stands at `position`.
    pub(super) fn transition_to_ready(&mut self, position: Position) {
        self.executor.set_position(position);
        self.leave_cycle();
        self.restart(position);
        self.state = State::Idle;
    }

    /// The program is over. Whether the spindle stops is for the caller.
    pub(super) fn transition_to_idle(&mut self, events: &mut EventIn<'_>) {
        self.course.end_program();
        self.leave_cycle();
        self.handwheel.set(false);
        self.state = State::Idle;
        emit(events, Event::Finished);
    }

    /// Axes begin to find their reference.
    pub(super) const fn transition_to_homing(&mut self) {
        self.state = State::Homing;
    }

    /// The last axis has found its reference. What is planned from now on begins where that says the machine is.
    pub(super) const fn transition_from_homing(&mut self) {
        self.state = State::Idle;
    }

    /// Axes begin to be moved by hand.
    pub(super) const fn transition_to_by_hand(&mut self) {
        self.state = State::ByHand;
    }

    /// The axes that were moved by hand stand, and nobody presses. What is planned from now on begins here.
    /// A program that was left stays held.
    pub(super) fn transition_from_by_hand(&mut self) {
        if self.has_left() {
            self.state = State::Held;
            return;
        }
        self.restart(self.executor.position());
        self.state = State::Idle;
    }

    /// A line that was typed is refused before anything of it was done. What turns, and what is switched on, stays so.
    pub(super) fn transition_from_refused(&mut self, alarm: &Alarm, events: &mut EventIn<'_>) {
        self.course.end_program();
        self.handwheel.set(false);
        self.restart(self.executor.position());
        self.state = State::Idle;
        emit(events, Event::Refused(*alarm));
    }

    /// A segment begins, or the path goes on.
    pub(super) const fn transition_to_running(&mut self) {
        self.state = State::Running;
    }

    /// Feed hold or single block has brought the axes to rest.
    pub(super) fn transition_to_held(&mut self, events: &mut EventIn<'_>) {
        self.state = State::Held;
        emit(events, Event::Held);
    }

    /// The axes come to rest on their path, and what is queued is forgotten.
    pub(super) fn transition_to_stopping_on_alarm(&mut self, alarm: &Alarm, ends: &mut Ends<'_>) {
        self.executor.stop(self.course.current(ends));
        self.jog.release();
        self.stay_away();
        self.stop_homing();
        self.give_up_function();
        // A reset may have been on its way out of a thread: an alarm moves nothing any more.
        self.away.forget();
        self.spindle.stop();
        self.spindle.stay_rigid();
        self.state = State::Stopping(Outcome::Alarm(*alarm));
        emit(&mut ends.events, Event::Alarm(*alarm));
    }

    /// A stroke is left along the slope of its run-out until the tool is clear of the crests or at the start level. The
    /// way out after a stroke goes on until then. A stroke of G32 or G34 without a run-out has no side to leave to: it
    /// stops on its path, as anything else does.
    pub(super) fn transition_to_stopping_by_reset(&mut self, ends: &Ends<'_>) {
        self.course.forget_pauses();
        self.jog.release();
        self.stay_away();
        self.away.forget();
        self.stop_homing();
        self.give_up_function();
        self.spindle.stay_rigid();
        self.state = State::Stopping(Outcome::Reset);
        let current = self.course.current(ends);
        match self.away.pass() {
            // Elsewhere the ways out of the pass do not count.
            Some(pass) if self.in_thread() && pass.ways.side != 0 && !self.has_left() => {
                self.executor.retract(current, pass.ways.clear);
                self.away.clear_crests();
            }
            _ => self.executor.stop(current),
        }
    }

    /// The tool leaves its thread as at a reset, and the machine is in alarm after that.
    pub(super) fn transition_to_stopping_out_of_thread(
        &mut self,
        alarm: &Alarm,
        ends: &mut Ends<'_>,
    ) {
        self.transition_to_stopping_by_reset(ends);
        self.state = State::Stopping(Outcome::Alarm(*alarm));
        emit(&mut ends.events, Event::Alarm(*alarm));
    }

    /// The machine stands on an alarm.
    pub(super) const fn transition_to_alarm(&mut self, alarm: Alarm) {
        self.state = State::Alarm(alarm);
    }

    /// The axes stand: what they came to rest for is done.
    pub(super) fn transition_from_stopping(&mut self, events: &mut EventIn<'_>) {
        self.note_stop();
        self.course.end_program();
        self.leave_cycle();
        if self.left.take().is_some() {
            self.executor.give_up_aside();
        }
        self.handwheel.set(false);
        self.spindle.stop();
        self.resuming = None;
        self.stood = 0;
        match self.state {
            State::Stopping(Outcome::Alarm(alarm)) => self.transition_to_alarm(alarm),
            _ => {
                self.switching = self.switching_of_reset();
                self.machine.reset();
                emit(events, Event::Reset);
                self.state = State::Idle;
            }
        }
        self.restart(self.executor.position());
    }

    /// The axes stand, and the program is over. Whatever moves them next is in no cycle: it may bring the tool anywhere,
    /// and a later reset has no thread to lead it out of.
    fn leave_cycle(&mut self) {
        self.executor.tell_stops(Stops::NONE);
        self.away.forget_pass();
    }

    /// What a reset has for the board's switches.
    const fn switching_of_reset(&self) -> Switching {
        if self.journal.has_hole() {
            Switching::ResetInHole
        } else {
            Switching::Reset
        }
    }

    /// What is queued is dropped, and what the background plans until it has heard of this.
    pub(super) fn restart(&mut self, position: Position) {
        let epoch = self.course.drop_queued();
        self.spindle.forget_wait();
        self.notice = Some(Notice::Restart(position, epoch));
    }
}
