//! Zones that the tip of a tool may not enter: chuck, jaws, tailstock. Rectangles in X–Z around the axis of the spindle.
//!
//! ```text
//!   X ▲  chuck      jaws                      tailstock
//!     │ ┌───────┐                          ┌────────────── ─
//!     │ │       ├──────┐                   │
//! ────┼─┤  L, D │L1, D1├───────────────────┤ D2 ──────────► Z
//!     │ │       ├──────┘                   │
//!     │ └───────┘                          └────────────── ─
//!              9091                       9096
//! ```
//!
//! Their frame is that of the spindle: where the tip is, which is machine − geometry − wear of its tool. This is arithmetic
//! alone: it must not know moves, tools, or who moves an axis. Which moves meet a zone is a question of the background, and
//! is answered there.

use crate::operating::Zone;
use crate::params::Params;
use crate::units::{Axis, Diameter, Length};

/// How far from a zone an axis comes to rest that is moved by hand.
pub const CLEARANCE: Length = Length::from_nm(1_000);

/// Setpoints are rounded to nanometres: a zone is larger by one.
pub const ROUNDING: Length = Length::from_nm(1);

/// Farther than any tip goes.
pub const FAR: Length = Length::from_nm(1 << 44);

/// A point in X–Z; X is a radius.
pub type Point = [Length; 2];

/// From one coordinate to another, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// The smaller one.
    pub low: Length,
    /// The greater one.
    pub high: Length,
}

impl Extent {
    /// Farther than any axis goes.
    pub const UNLIMITED: Self = Self {
        low: Length::from_nm(-100_000_000_000),
        high: Length::from_nm(100_000_000_000),
    };

    /// The coordinates between two, in any order.
    #[must_use]
    pub fn between(a: Length, b: Length) -> Self {
        Self {
            low: a.min(b),
            high: a.max(b),
        }
    }

    /// The coordinates of both, and those between them.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Moved by a length.
    #[must_use]
    pub fn moved(self, by: Length) -> Self {
        Self {
            low: self.low + by,
            high: self.high + by,
        }
    }

    /// Longer by a length at both ends.
    #[must_use]
    pub fn grown(self, by: Length) -> Self {
        Self {
            low: self.low - by,
            high: self.high + by,
        }
    }

    /// The coordinates that both have; `None` where there are none.
    #[must_use]
    pub fn common(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low <= high).then_some(Self { low, high })
    }

    /// How far its nearest coordinate is from zero.
    #[must_use]
    pub fn nearest(self) -> Length {
        self.low.max(-self.high).max(Length::ZERO)
    }

    fn has(self, at: Length) -> bool {
        self.low <= at && at <= self.high
    }
}

/// A rectangle with its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle {
    /// Its radii.
    pub x: Extent,
    /// Along the spindle.
    pub z: Extent,
}

impl Rectangle {
    /// The rectangle of two corners.
    #[must_use]
    pub fn between([from_x, from_z]: Point, [to_x, to_z]: Point) -> Self {
        Self {
            x: Extent::between(from_x, to_x),
            z: Extent::between(from_z, to_z),
        }
    }

    /// The points that both have; `None` where there are none.
    #[must_use]
    pub fn common(&self, other: &Self) -> Option<Self> {
        Some(Self {
            x: self.x.common(other.x)?,
            z: self.z.common(other.z)?,
        })
    }
}

/// The zones of a machine; none where all are off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Zones([Option<Rectangle>; 3]);

impl Zones {
    /// The zones of a parameter set: 9091 to 9097. One whose length or diameter is 0 is off.
    #[must_use]
    pub fn of(params: &Params) -> Self {
        let face = params.chuck_face();
        let chuck = face - params.chuck_length();
        let jaws = face + params.jaws_length();
        let tailstock = params.tailstock_front();
        let zone = |diameter: Length, from: Length, to: Length| {
            let radius = Diameter::from_nm(diameter.nm()).radius();
            (radius > Length::ZERO && from != to).then(|| Rectangle {
                x: Extent::between(-radius, radius).grown(ROUNDING),
                z: Extent::between(from, to).grown(ROUNDING),
            })
        };
        Self([
            zone(params.chuck_diameter(), chuck, face),
            zone(params.jaws_diameter(), face, jaws),
            zone(params.tailstock_diameter(), tailstock, FAR),
        ])
    }

    /// True where all zones are off.
    #[must_use]
    pub fn are_off(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    /// Each zone that is on, with its rectangle: a nanometre larger than the parameters, for the rounding of setpoints.
    pub fn each(&self) -> impl Iterator<Item = (Zone, &Rectangle)> {
        let named = Zone::ALL.into_iter().zip(&self.0);
        named.filter_map(|(zone, rectangle)| Some((zone, rectangle.as_ref()?)))
    }

    /// The coordinates of X or Z that each zone has.
    pub fn extents(&self, axis: Axis) -> impl Iterator<Item = Extent> {
        self.each().map(move |(_, rectangle)| match axis {
            Axis::X => rectangle.x,
            Axis::Z | Axis::C => rectangle.z,
        })
    }

    /// True where a point is in a zone.
    #[must_use]
    pub fn have(&self, [x, z]: Point) -> bool {
        self.each()
            .any(|(_, rectangle)| rectangle.x.has(x) && rectangle.z.has(z))
    }

    /// How far `axis` may go from `at` within `travel`, if the other axis may be anywhere in `other`. It ends a micrometre
    /// before a zone. In a zone it may only go away from the axis of the spindle, from the chuck, from the tailstock.
    #[must_use]
    pub fn travel(&self, axis: Axis, at: Length, other: Extent, travel: Extent) -> Extent {
        let mut free = travel;
        for (zone, rectangle) in self.each() {
            let (own, across) = match axis {
                Axis::X => (rectangle.x, rectangle.z),
                Axis::Z => (rectangle.z, rectangle.x),
                Axis::C => continue,
            };
            if across.common(other).is_none() {
                continue;
            }
            let outwards = match (axis, zone) {
                (Axis::X, _) => at >= Length::ZERO,
                (_, Zone::Tailstock) => false,
                (_, Zone::Chuck | Zone::Jaws) => true,
            };
            // The edge itself is in the zone.
            if at > own.high {
                free.low = free.low.max(own.high + CLEARANCE - ROUNDING);
            } else if at < own.low {
                free.high = free.high.min(own.low - CLEARANCE + ROUNDING);
            } else if outwards {
                free.low = free.low.max(at);
            } else {
                free.high = free.high.min(at);
            }
        }
        free
    }
}
