//! The ends of the axes at which a hard limit switch is on. Must not know where a switch is wired, or what follows.

use crate::alarm::{Alarm, Arg, Code};
use crate::operating::Towards;
use crate::units::{Axes, Axis};

/// An end of an axis that has a hard limit switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisEnd {
    /// X or Z.
    pub axis: Axis,
    /// The side of the end.
    pub towards: Towards,
}

impl AxisEnd {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::new(Axis::X, Towards::Minus),
        Self::new(Axis::X, Towards::Plus),
        Self::new(Axis::Z, Towards::Minus),
        Self::new(Axis::Z, Towards::Plus),
    ];

    /// The end of `axis` on this side.
    #[must_use]
    pub const fn new(axis: Axis, towards: Towards) -> Self {
        Self { axis, towards }
    }

    /// The alarm of an axis at this end, or that is to go on towards it.
    #[cold]
    #[inline(never)]
    #[must_use]
    pub fn alarm(self) -> Alarm {
        let figures = [
            self.axis.letter(),
            sign(self.towards),
            sign(self.towards.opposite()),
        ];
        Alarm::of(Code::HardLimit, &figures.map(Arg::Letter))
    }

    const fn bit(self) -> u8 {
        let place = match self.axis {
            Axis::X => 0,
            _ => 2,
        };
        match self.towards {
            Towards::Minus => 1 << place,
            Towards::Plus => 2 << place,
        }
    }
}

const fn sign(towards: Towards) -> u8 {
    match towards {
        Towards::Minus => b'-',
        Towards::Plus => b'+',
    }
}

/// A set of ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HardLimits(u8);

impl HardLimits {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// True where there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// True where this end is one of them.
    #[must_use]
    pub const fn contains(self, end: AxisEnd) -> bool {
        self.0 & end.bit() != 0
    }

    /// With this end.
    #[must_use]
    pub const fn with(self, end: AxisEnd) -> Self {
        Self(self.0 | end.bit())
    }

    /// All of both.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not among `other`.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The first of them.
    #[must_use]
    pub fn first(self) -> Option<AxisEnd> {
        AxisEnd::ALL.into_iter().find(|end| self.contains(*end))
    }

    /// The axes at one of them.
    #[must_use]
    pub fn axes(self) -> Axes {
        let ends = AxisEnd::ALL.into_iter().filter(|end| self.contains(*end));
        ends.fold(Axes::NONE, |axes, end| axes.with(end.axis))
    }
}
