//! The references of the axes: which are known, and how they are found, one axis after the other in the order of 9059.
//!
//! ```text
//! Idle ── home ─► Homing: axis ─► next axis ─► … ─► Idle
//!                   │ stop, alarm, reset, cancel: the drive comes to rest and goes back to position mode
//!                   └─► Stopping
//! ```
//!
//! Knows what a homing comes to; how a drive homes is its master's affair, and how the board finds a switch stands in
//! `search`.

use super::search::{Search, Searched};
use super::{Ends, Outcome, State, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code};
use crate::bus::HomeEnd;
use crate::call::Position;
use crate::params::Params;
use crate::tick::Event;
use crate::tick::drives::Homing;
use crate::tick::hard_limits::AxisEnd;
use crate::units::{Axes, Axis};

/// What a parameter set says about references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// The axes that have to find a reference (9050).
    methods: Axes,
    /// Those of them without which no program begins (9060).
    required: Axes,
    /// Their places in the order (9059), for X, Z and C.
    order: [u8; 3],
}

impl Wanted {
    pub(super) fn of(params: &Params) -> Self {
        let mut wanted = Self {
            methods: Axes::NONE,
            required: Axes::NONE,
            order: Axis::ALL.map(|axis| params.home_order(axis)),
        };
        for axis in Axis::ALL {
            if params.home_method(axis) == 0 {
                continue;
            }
            wanted.methods = wanted.methods.with(axis);
            if params.home_required(axis) == 1 {
                wanted.required = wanted.required.with(axis);
            }
        }
        wanted
    }

    /// The one of `axes` that comes first.
    fn first(&self, axes: Axes) -> Option<Axis> {
        let places = Axis::ALL.into_iter().zip(self.order);
        let left = places.filter(|(axis, _)| axes.contains(*axis));
        left.min_by_key(|(_, place)| *place).map(|(axis, _)| axis)
    }
}

/// The references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Home {
    /// The axes whose reference has been found since power-up, and holds.
    found: Axes,
    /// The axes that still have to be homed.
    left: Axes,
    /// The axis that is being homed, also while it comes to rest after a stop.
    axis: Option<Axis>,
    /// The board looks for its switch.
    pub(super) search: Option<Search>,
}

impl Home {
    pub(super) const fn new() -> Self {
        Self {
            found: Axes::NONE,
            left: Axes::NONE,
            axis: None,
            search: None,
        }
    }

    /// The application begins anew; the drives of `changed` count otherwise from now on.
    pub(super) const fn begin_anew(&mut self, changed: Axes) {
        *self = Self {
            found: self.found.minus(changed),
            ..Self::new()
        };
    }
}

impl Ticker {
    /// The axes whose position is that of the machine: they need no reference, or it has been found and holds.
    #[must_use]
    pub const fn referenced(&self) -> Axes {
        let needless = Axes::ALL.minus(self.given.home.methods);
        needless.or(self.home.found)
    }

    /// The axes without a reference that a program needs.
    #[must_use]
    pub const fn unreferenced(&self) -> Axes {
        self.given.home.required.minus(self.home.found)
    }

    /// What has become of the drives' counts since the last call.
    pub(super) fn lose_references(&mut self) {
        self.home.found = self.home.found.minus(self.drives.take_lost());
    }

    /// Begins to home these axes; those without a method stay as they are, unless there is no other. The machine stands and
    /// has no work.
    pub(super) fn home(&mut self, axes: Axes, ends: &mut Ends<'_>) {
        let left = axes.and(self.given.home.methods);
        let refusal = match axes.each().next() {
            _ if !matches!(self.state, State::Idle) || self.course.in_program() => {
                Some(Alarm::of(Code::NotAtRest, &[]))
            }
            _ if self.journal.has_hole() => self.journal.hole_alarm(),
            Some(axis) if left.is_empty() => Some(Alarm::of(
                Code::HomeMethodNone,
                &[Arg::Letter(axis.letter())],
            )),
            _ => {
                let mut ends = left.each().filter_map(|axis| self.refuses_home(axis));
                ends.next().map(AxisEnd::alarm)
            }
        };
        if let Some(refusal) = refusal {
            emit(&mut ends.events, Event::Warning(refusal));
            return;
        }
        self.home.left = left;
        self.transition_to_homing();
        self.home_next(ends);
    }

    /// Begins with the next axis. After the last one the machine is ready.
    fn home_next(&mut self, ends: &mut Ends<'_>) {
        let next = self.given.home.first(self.home.left);
        self.home.axis = next;
        let Some(axis) = next else {
            return self.transition_from_homing();
        };
        self.home.left = self.home.left.without(axis);
        self.home.found = self.home.found.without(axis);
        if !self.begin_search(axis) && !self.drives.begin_homing(axis) {
            self.home.axis = None;
            self.fail_homing(HomeEnd::Abandoned, axis, ends);
        }
    }

    /// A tick of homing.
    #[cold]
    #[inline(never)]
    pub(super) fn go_on_homing(&mut self, ends: &mut Ends<'_>) {
        let Some(axis) = self.home.axis else {
            return;
        };
        if self.home.search.is_some() {
            return match self.go_on_search(axis) {
                Searched::Goes => {}
                Searched::Found => {
                    self.home.search = None;
                    self.home_next(ends);
                }
                Searched::Failed(code) => {
                    let number = self.switch(axis).map_or(0, |switch| switch.at.number());
                    let figures = [Arg::Letter(axis.letter()), Arg::Int(number.into())];
                    self.raise(&Alarm::of(code, &figures), ends);
                }
            };
        }
        self.drives.halt_homing(axis, self.operator.hold);
        match self.drives.homing(axis) {
            Homing::Found => {
                let position = self.drives.refer(axis, self.executor.position());
                self.stand_referenced(axis, position);
                self.home_next(ends);
            }
            Homing::UnderWay(None | Some(HomeEnd::Found)) | Homing::None => {}
            Homing::UnderWay(Some(end)) | Homing::Failed(end) => {
                self.fail_homing(end, axis, ends);
            }
        }
    }

    /// The axis has its reference, and with that the machine stands at `position`.
    pub(super) fn stand_referenced(&mut self, axis: Axis, position: Position) {
        self.executor.set_position(position);
        self.restart(position);
        self.home.found = self.home.found.with(axis);
    }

    /// What a drive has failed of is the cause; that its homing has ended is what follows from it.
    fn fail_homing(&mut self, end: HomeEnd, axis: Axis, ends: &mut Ends<'_>) {
        let failure = self.drives.failure();
        self.raise(&failure.unwrap_or_else(|| not_homed(end, axis)), ends);
    }

    /// Ends homing for an alarm or a reset: the drive comes to rest.
    pub(super) fn stop_homing(&mut self) {
        self.home.left = Axes::NONE;
        // The drive of an axis whose switch the board looks for does not home.
        if let Some(axis) = self.home.axis {
            self.drives.abandon_homing(axis);
        }
    }

    /// True while the axis that was being homed has not come back to position mode.
    #[cold]
    #[inline(never)]
    pub(super) fn leaves_homing(&mut self, ends: &mut Ends<'_>) -> bool {
        let Some(axis) = self.home.axis else {
            return false;
        };
        if let Homing::UnderWay(_) = self.drives.homing(axis) {
            return true;
        }
        self.home.axis = None;
        if self.home.search.take().is_none() {
            let position = self.drives.read(axis, self.executor.position());
            self.executor.set_position(position);
        }
        if matches!(self.state, State::Stopping(Outcome::Reset)) {
            emit(
                &mut ends.events,
                Event::Warning(not_homed(HomeEnd::Abandoned, axis)),
            );
        }
        false
    }

    /// The axis that is being homed, also while it comes to rest after that.
    pub(super) const fn homed(&self) -> Option<Axis> {
        self.home.axis
    }

    /// The axis whose switch the board looks for now.
    pub(super) const fn searched(&self) -> Option<Axis> {
        match self.home.search {
            Some(_) => self.home.axis,
            None => None,
        }
    }

    /// True while an axis is being homed, or comes to rest after that.
    pub(super) const fn is_homing(&self) -> bool {
        self.home.axis.is_some()
    }
}

/// A homing that has not found its mark.
fn not_homed(end: HomeEnd, axis: Axis) -> Alarm {
    let (code, figure) = match end {
        HomeEnd::Found | HomeEnd::Abandoned => (Code::HomeCancelled, Arg::None),
        HomeEnd::NotFound => (Code::HomeNotFound, Arg::None),
        HomeEnd::Error(status) => (Code::HomeError, Arg::Statusword(status.raw())),
        HomeEnd::Mode(told) => (Code::HomeModeRefused, Arg::Int(i64::from(told))),
    };
    Alarm::of(code, &[Arg::Letter(axis.letter()), figure])
}
