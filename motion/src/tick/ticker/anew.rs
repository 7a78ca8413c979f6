//! Starts the application again with another parameter set while the power stays on.

use super::away::Away;
use super::functions::ChuckWait;
use super::handwheel::Handwheel;
use super::limits::Watch;
use super::spindle::SpindleMode;
use super::tool::ToolIn;
use super::{Notice, Setup, State, Ticker};
use crate::tick::command::Switching;
use crate::tick::operator::Operator;

impl Ticker {
    /// Starts again with another parameter set: the drives are enabled again, and the knowledge of taps in holes stays.
    /// What is queued does not count any more; a notice tells the background the last position. Changes nothing where the
    /// machine may not move any more.
    ///
    /// The machine must stand.
    pub(in crate::tick) fn begin_anew(&mut self, setup: &Setup) {
        if self.state.stays_at_rest() {
            return;
        }
        let told = self.executor.position();
        let position = match self.state {
            // The position is not known yet, or not known again.
            State::Starting => self.remembered,
            _ => Some(told),
        };
        // Field by field: most of a tick side is the memory of a profile that stands.
        let Self {
            state,
            slipped,
            awaits,
            switching,
            stood,
            course,
            away,
            left,
            spindle,
            found: withheld,
            operator,
            given,
            observer,
            learner,
            remembered,
            notice,
            journal,
            drives,
            now: _,
            jog,
            free,
            handwheel,
            home,
            limits,
            machine,
            function,
            gear,
            tool,
            chuck_wait,
            resuming,
            executor,
        } = self;
        *state = State::Starting;
        *slipped = false;
        *awaits = false;
        *switching = match journal.has_hole() {
            true => Switching::ResetInHole,
            false => Switching::Reset,
        };
        *stood = 0;
        let epoch = course.begin_anew();
        *away = Away::new();
        *left = None;
        *spindle = SpindleMode::new();
        *withheld = setup.found;
        *operator = Operator::new();
        *given = setup.given;
        *observer = setup.observer;
        *learner = setup.learner;
        *remembered = position;
        *notice = Some(Notice::Restart(position.unwrap_or_default(), epoch));
        journal.begin_anew(given.second);
        home.begin_anew(drives.begin_anew(&setup.figures));
        *limits = Watch::NEW;
        machine.begin_anew(given.wiring);
        machine.reset();
        (*function, *resuming) = (None, None);
        *gear = 0;
        *tool = ToolIn::Unknown;
        *chuck_wait = ChuckWait::default();
        jog.begin_anew();
        *free = [given.travel_x, given.travel_z];
        *handwheel = Handwheel::OFF;
        executor.begin_anew(given.arrival);
        // Until the drives are enabled, the last commanded position stays in force.
        executor.set_position(told);
    }
}
