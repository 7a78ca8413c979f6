//! The hard limit switches (9064, 9065): an axis that comes onto one stops on an alarm, and moves away from it only.
//!
//! ```text
//! input of the machine, 60FDh of the drive ─► on ─┬─ has come on ─► alarm 4542: the axes brake
//!                                                 └─ stays on ─► by hand, away from it; no program; no way towards it
//! ```
//!
//! A switch counts as on with its first sample, and as off once it has been off for some time: it may bounce where an axis
//! leaves it. An input that nobody has told counts as on [D271]. The switch that an axis is homed by stops nothing while
//! that lasts: the one that the board looks for, and those at a drive that homes by itself, which may look for either.
//!
//! Nothing here is a safety function. Must not know where a press comes from.

use super::{Ends, Outcome, State, Ticker};
use crate::alarm::{Alarm, Arg, Code};
use crate::bus::Inputs;
use crate::call::Position;
use crate::motion::{AxisTravel, Press};
use crate::operating::Towards;
use crate::params::{HomeSwitch, Params};
use crate::tick::hard_limits::{AxisEnd, HardLimits};
use crate::units::{Axis, Length};

/// Ticks for which the switches have to be as they are until one that is off counts as off.
const CALM: u8 = 32;

/// Where the switches are wired, for each of [`AxisEnd::ALL`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Switches([Option<HomeSwitch>; 4]);

impl Switches {
    pub(super) fn of(params: &Params) -> Self {
        Self(AxisEnd::ALL.map(|end| params.limit_switch(end.axis, end.towards)))
    }

    const fn are_none(&self) -> bool {
        matches!(self.0, [None, None, None, None])
    }

    /// Those that there are.
    fn each(self) -> impl Iterator<Item = (AxisEnd, HomeSwitch)> {
        let ends = AxisEnd::ALL.into_iter().zip(self.0);
        ends.filter_map(|(end, switch)| Some((end, switch?)))
    }
}

/// What is known of the switches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    /// Those that count as on.
    on: HardLimits,
    /// Those that were on in the last tick.
    seen: HardLimits,
    /// Ticks since that has changed.
    same: u8,
}

impl Watch {
    pub(super) const NEW: Self = Self {
        on: HardLimits::NONE,
        seen: HardLimits::NONE,
        same: 0,
    };

    /// Takes the switches that are on in this tick. Gives those that have come on.
    fn see(&mut self, now: HardLimits) -> HardLimits {
        self.same = match now == self.seen {
            true => self.same.saturating_add(1),
            false => 0,
        };
        self.seen = now;
        let come = now.minus(self.on);
        self.on = match self.same >= CALM {
            true => now,
            false => self.on.or(now),
        };
        come
    }
}

impl Ticker {
    /// The ends at which a hard limit switch is on.
    #[must_use]
    pub const fn hard_limits(&self) -> HardLimits {
        self.limits.on
    }

    /// Looks at the hard limit switches.
    #[inline]
    pub(super) fn watch_limits(&mut self, ends: &mut Ends<'_>) {
        if !self.given.limits.are_none() {
            self.look_at_limits(ends);
        }
    }

    #[cold]
    #[inline(never)]
    fn look_at_limits(&mut self, ends: &mut Ends<'_>) {
        let is_up = match self.state {
            State::Idle | State::Running | State::Held | State::ByHand | State::Homing => true,
            State::Stopping(outcome) => outcome == Outcome::Reset,
            State::Starting | State::Alarm(_) => false,
        };
        let mut now = HardLimits::NONE;
        for (end, switch) in self.given.limits.each() {
            match self.is_on(end, switch, is_up) {
                Ok(true) => now = now.with(end),
                Ok(false) => {}
                Err(alarm) => self.raise(&alarm, ends),
            }
        }
        let come = self.limits.see(now).minus(self.sought());
        if let Some(end) = come.first()
            && is_up
        {
            self.raise(&end.alarm(), ends);
        }
    }

    /// Whether a switch is on. `is_up`: a drive has to tell its inputs.
    fn is_on(&mut self, end: AxisEnd, switch: HomeSwitch, is_up: bool) -> Result<bool, Alarm> {
        let bit = match switch {
            HomeSwitch::Machine(input) => {
                let bit = input.bit();
                return Ok(self.machine.inputs(bit).is_none_or(|on| on & bit != 0));
            }
            HomeSwitch::Drive(bit) => bit,
        };
        let inputs = match is_up && !self.searches_at_drive(end.axis) {
            true => self.drives.look_at_inputs(end.axis),
            false => self.drives.inputs_told(end.axis),
        };
        match inputs {
            Inputs::Told(inputs) => Ok(inputs & bit != 0),
            // As it was; before a drive has told anything, the worse.
            Inputs::Awaited => Ok(!is_up || self.limits.seen.contains(end)),
            Inputs::Untold => {
                let figure = Arg::Letter(end.axis.letter());
                Err(Alarm::of(Code::LimitInputsUntold, &[figure]))
            }
        }
    }

    /// The search for a switch at this drive looks at its inputs already.
    fn searches_at_drive(&self, axis: Axis) -> bool {
        let at = self.switch(axis).map(|switch| switch.at);
        self.searched() == Some(axis) && matches!(at, Some(HomeSwitch::Drive(_)))
    }

    /// The ends whose switch is what an axis is homed by now.
    fn sought(&self) -> HardLimits {
        let Some(axis) = self.homed() else {
            return HardLimits::NONE;
        };
        let by_board = self.searched().is_some();
        let at = self.switch(axis).map(|switch| switch.at);
        let sought = self.given.limits.each().filter(|(end, switch)| {
            end.axis == axis
                && match by_board {
                    true => Some(*switch) == at,
                    false => matches!(switch, HomeSwitch::Drive(_)),
                }
        });
        sought.fold(HardLimits::NONE, |all, (end, _)| all.with(end))
    }

    /// Where the machine is before a tick in which an axis stands at a limit.
    #[inline]
    pub(super) const fn place_at_limit(&self) -> Option<Position> {
        match self.limits.on.is_empty() {
            true => None,
            false => Some(self.executor.position()),
        }
    }

    /// An axis goes on towards a switch that is on: an alarm.
    #[cold]
    #[inline(never)]
    pub(super) fn keep_off(&mut self, from: Position, ends: &mut Ends<'_>) {
        let to = self.executor.position();
        let on = self.limits.on.minus(self.sought());
        let towards = |end: &AxisEnd| {
            let way = match end.axis {
                Axis::X => to.x - from.x,
                _ => to.z - from.z,
            };
            way != Length::ZERO && Towards::of(way) == end.towards && on.contains(*end)
        };
        // By hand the travel ends here.
        if !matches!(self.state, State::ByHand)
            && let Some(end) = AxisEnd::ALL.into_iter().find(towards)
        {
            self.raise(&end.alarm(), ends);
        }
    }

    /// The end towards whose switch, which is on, a press would move its axis.
    pub(super) fn refuses_towards(&self, press: &Press) -> Option<AxisEnd> {
        // The claim of a handwheel moves nothing yet.
        if press.wheel.is_some() && press.way == Some(Length::ZERO) {
            return None;
        }
        let on = self.limits.on;
        let asked = [(Axis::X, &press.x), (Axis::Z, &press.z)];
        asked
            .into_iter()
            .filter_map(|(axis, motion)| Some(AxisEnd::new(axis, press.side(motion.as_ref()?))))
            .find(|end| on.contains(*end))
    }

    /// The end that keeps an axis from being homed: on its way lies a switch that is on, and not what is sought. Where its
    /// drive homes, its way is not known.
    pub(super) fn refuses_home(&self, axis: Axis) -> Option<AxisEnd> {
        let at = self.switch(axis);
        let mut against = self.given.limits.each().filter(|(end, switch)| {
            end.axis == axis
                && self.limits.on.contains(*end)
                && match &at {
                    Some(at) => at.towards() == end.towards && *switch != at.at,
                    None => matches!(switch, HomeSwitch::Machine(_)),
                }
        });
        against.next().map(|(end, _)| end)
    }

    /// The travel of X and Z, which ends here towards a switch that is on.
    pub(super) fn off_limits(&self, mut travel: [AxisTravel; 2]) -> [AxisTravel; 2] {
        if self.limits.on.is_empty() {
            return travel;
        }
        let here = self.executor.position();
        let [x, z] = &mut travel;
        for (axis, place, travel) in [(Axis::X, here.x, x), (Axis::Z, here.z, z)] {
            let on = |towards| self.limits.on.contains(AxisEnd::new(axis, towards));
            if on(Towards::Minus) {
                travel.low = travel.low.max(place);
            }
            if on(Towards::Plus) {
                travel.high = travel.high.min(place);
            }
        }
        travel
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On at once, off after a while without a change.
    #[test]
    fn a_switch_that_bounces_stays_on() {
        let end = AxisEnd::new(Axis::X, Towards::Plus);
        let (on, off) = (HardLimits::NONE.with(end), HardLimits::NONE);
        let mut watch = Watch::NEW;
        assert_eq!(watch.see(off), off);
        assert_eq!(watch.see(on), on);
        for _ in 0..100 {
            assert_eq!(watch.see(on), off);
        }
        for _ in 0..10 {
            for _ in 0..CALM {
                assert_eq!((watch.see(off), watch.on), (off, on));
            }
            assert_eq!(watch.see(on), off);
        }
        for _ in 0..=CALM {
            assert_eq!((watch.see(off), watch.on.is_empty()), (off, false));
            if watch.same == CALM - 1 {
                break;
            }
        }
        watch.see(off);
        assert_eq!(watch.on, off);
        assert_eq!(watch.see(on), on);
    }
}
