//! The hard limit switches of the axes (9064, 9065). Must not know what follows when one is on.

use super::{HomeSwitch, Params};
use crate::operating::Towards;
use crate::units::Axis;

impl Params {
    /// The hard limit switch at this end of an axis; `None` where there is none.
    #[must_use]
    pub fn limit_switch(&self, axis: Axis, towards: Towards) -> Option<HomeSwitch> {
        let number = match towards {
            Towards::Minus => self.limit_input_minus(axis),
            Towards::Plus => self.limit_input_plus(axis),
        };
        HomeSwitch::new(number?)
    }

    /// Both ends of an axis.
    pub(super) fn limit_switches(&self, axis: Axis) -> impl Iterator<Item = HomeSwitch> {
        let ends = [Towards::Minus, Towards::Plus].into_iter();
        ends.filter_map(move |towards| self.limit_switch(axis, towards))
    }
}
