//! The way out of a stroke and back: feed hold with immediate retract [D11], and the ways that the background plans for it.
//!
//! Knows the pass that was left and the way out of it. Must not know why the pass was left.

use super::super::detour::{Detour, Route};
use super::super::queue::take;
use super::course::Source;
use super::{Ends, Notice, State, Ticker};
use crate::alarm::Span;
use crate::call::Position;
use crate::motion::{Action, Epoch, Pass, Phase, Retract, Segment, Task, WaysOut};

/// The data of a pass that its ways out need, also after the pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastPass {
    /// Number of its move.
    pub number: u32,
    /// Its words.
    pub span: Span,
    /// The spindle override, frozen in its cycle.
    pub frozen: Option<u8>,
    /// Where the tool can go from it.
    pub ways: WaysOut,
}

impl LastPass {
    /// Of a pass and its segment.
    pub(super) const fn of(segment: &Segment, pass: &Pass) -> Self {
        Self {
            number: segment.number,
            span: segment.span,
            frozen: segment.stops.frozen,
            ways: pass.ways,
        }
    }
}

/// The way out of a stroke.
#[derive(Debug)]
pub(super) struct Away {
    stage: Detour,
    /// A reset has left a stroke, and the tool must get clear of the crests.
    clearing: bool,
    /// Epoch of the way asked for last. Legs of another epoch do not count.
    epoch: Epoch,
    /// The last pass begun.
    pass: Option<LastPass>,
}

impl Away {
    /// No pass has begun.
    pub(super) fn new() -> Self {
        Self {
            stage: Detour::None,
            clearing: false,
            epoch: Epoch::default(),
            pass: None,
        }
    }

    /// How far the detour has come.
    pub(super) const fn stage(&self) -> Detour {
        self.stage
    }

    /// A detour is under way.
    pub(super) fn is_under_way(&self) -> bool {
        self.stage != Detour::None
    }

    /// Gives up every way out.
    pub(super) const fn forget(&mut self) {
        self.stage = Detour::None;
        self.clearing = false;
    }

    /// The last pass is over, and no way leads out of it any more.
    pub(super) const fn forget_pass(&mut self) {
        self.pass = None;
    }

    /// A reset has left a stroke: the tool moves on until it is clear of the crests.
    pub(super) const fn clear_crests(&mut self) {
        self.clearing = true;
    }

    /// True, once, after a reset has left a stroke.
    pub(super) const fn takes_clearing(&mut self) -> bool {
        core::mem::replace(&mut self.clearing, false)
    }

    /// A pass begins.
    pub(super) const fn begin_pass(&mut self, pass: LastPass) {
        self.pass = Some(pass);
    }

    /// The last pass begun.
    pub(super) const fn pass(&self) -> Option<&LastPass> {
        self.pass.as_ref()
    }

    /// Drops a leg of a way asked for earlier. One leg per tick.
    pub(super) fn drop_stale(&self, ends: &mut Ends<'_>) {
        let leg = ends.detours.peek().map(|oldest| oldest.epoch);
        if leg.is_some_and(|epoch| epoch != self.epoch) {
            take(&mut ends.detours);
        }
    }
}

impl Ticker {
    /// Feed hold with immediate retract [D11]. A stroke that is nearly over is finished instead.
    pub(super) fn leave_stroke(&mut self, ends: &Ends<'_>) {
        if self.away.is_under_way() || !matches!(self.state, State::Running) {
            return;
        }
        let (Some(run), Some(pass)) = (self.executor.thread(), &self.away.pass) else {
            return;
        };
        // A stroke is finished: there is no start level to go back to, and the way back lies in the thread.
        if pass.ways.stays() || !matches!(run.phase(), Phase::Joining | Phase::Locked) {
            return;
        }
        let target = pass.ways.short_of(pass.ways.home);
        if self.executor.retract(self.course.current(ends), target) == Retract::Leaving {
            self.away.stage = Detour::Leaving;
        }
    }

    /// Resume: from the start of the cycle back to the start of the pass that was left.
    pub(super) fn go_back(&mut self) {
        if self.away.stage == Detour::AtHome
            && let Some(pass) = &self.away.pass
        {
            let start = pass.ways.start;
            self.route(Detour::Back, [Some(start), None]);
        }
    }

    /// Begins the next leg of a detour. The mark after the last leg ends the detour.
    pub(super) fn go_on_with_detour(&mut self, ends: &mut Ends<'_>) {
        if self.away.stage == Detour::Leaving {
            let Some(pass) = &self.away.pass else {
                self.away.stage = Detour::None;
                return;
            };
            let home = pass.ways.home;
            let mut level = self.executor.position();
            pass.ways.set_short(&mut level, pass.ways.short_of(home));
            self.route(Detour::Home, [Some(level), Some(home)]);
            return;
        }
        let epoch = self.away.epoch;
        let Some(leg) = ends.detours.peek().filter(|leg| leg.epoch == epoch) else {
            return;
        };
        if !matches!(leg.action, Action::End) {
            self.executor.begin(Task {
                segment: leg,
                plan: None,
            });
            self.course.take_from(Source::Detour);
            if let Some(pass) = &self.away.pass {
                // The leg is reported as the pass that was left.
                self.executor.tell_as(pass.number, pass.span, pass.frozen);
            }
            return;
        }
        take(&mut ends.detours);
        self.away.stage = match self.away.stage {
            Detour::Home => Detour::AtHome,
            Detour::Back => {
                if let Some(pass) = ends.segments.peek() {
                    self.executor.begin(pass);
                    self.course.take_from(Source::Program);
                }
                Detour::None
            }
            _ => Detour::None,
        };
    }

    /// Begins a stage and asks the background to plan its way. What is left of an earlier way is dropped.
    pub(super) fn route(&mut self, stage: Detour, via: [Option<Position>; 2]) {
        let away = &mut self.away;
        away.stage = stage;
        away.epoch = away.epoch.next();
        self.notice = Some(Notice::Route(Route {
            from: self.executor.position(),
            via,
            epoch: away.epoch,
        }));
    }
}
