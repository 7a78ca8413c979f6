//! Out of a stroke and back: feed hold with immediate retract [D11], and the ways the background plans for it.

use super::super::detour::{Detour, Route};
use super::super::queue::take;
use super::{Ends, Mode, Notice, Source, Ticker};
use crate::motion::{Action, Phase, Retract, Task};
use crate::program::Position;

impl Ticker {
    /// Feed hold with immediate retract [D11]; where the stroke is all but over it is finished instead.
    pub(super) fn leave_stroke(&mut self, ends: &Ends<'_, '_>) {
        if self.detour != Detour::None || self.mode != Mode::Running {
            return;
        }
        let (Some(run), Some(pass)) = (self.executor.thread(), &self.pass) else {
            return;
        };
        if !matches!(run.phase(), Phase::Joining | Phase::Locked) {
            return;
        }
        let target = pass.ways.short_of(pass.ways.home);
        if self.executor.retract(ends.current(self.source), target) == Retract::Leaving {
            self.detour = Detour::Leaving;
        }
    }

    /// The next leg of a detour; its mark ends it.
    pub(super) fn go_on_with_detour(&mut self, ends: &mut Ends<'_, '_>) {
        if self.detour == Detour::Leaving {
            let Some(pass) = &self.pass else {
                self.detour = Detour::None;
                return;
            };
            let home = pass.ways.home;
            let mut level = self.executor.position();
            pass.ways.set_short(&mut level, pass.ways.short_of(home));
            self.detour = Detour::Home;
            self.route([Some(level), Some(home)]);
            return;
        }
        let epoch = self.route_epoch;
        let Some(leg) = ends.detours.peek().filter(|leg| leg.epoch == epoch) else {
            return;
        };
        if !matches!(leg.action, Action::End) {
            self.executor.begin(Task {
                segment: leg,
                plan: None,
            });
            self.source = Source::Detour;
            if let Some(pass) = &self.pass {
                // It belongs to the pass that was left.
                self.executor.tell_as(pass.number, pass.span, pass.frozen);
            }
            return;
        }
        take(ends.detours);
        self.detour = match self.detour {
            Detour::Home => Detour::AtHome,
            Detour::Back => {
                if let Some(pass) = ends.segments.peek() {
                    self.executor.begin(pass);
                    self.source = Source::Program;
                }
                Detour::None
            }
            _ => Detour::None,
        };
    }

    /// Asks for a way to be planned; what is left of the one before is dropped.
    pub(super) fn route(&mut self, via: [Option<Position>; 2]) {
        self.route_epoch = self.route_epoch.next();
        self.notice = Some(Notice::Route(Route {
            from: self.executor.position(),
            via,
            epoch: self.route_epoch,
        }));
    }
}
