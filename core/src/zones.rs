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
//! alone: it must not know moves, tools, or who moves an axis.

use crate::operating::Zone;
use crate::params::Params;
use crate::units::plane::{Vector, ahead, length_up, passes, side};
use crate::units::{Axis, Diameter, Length, product, signed, signed_product};

/// How far from a zone an axis comes to rest that is moved by hand.
pub(crate) const CLEARANCE: Length = Length::from_nm(1_000);

/// Setpoints are rounded to nanometres: a zone is larger by one.
const ROUNDING: Length = Length::from_nm(1);

/// Farther than any tip goes.
const FAR: Length = Length::from_nm(1 << 44);

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

    fn grown(self, by: Length) -> Self {
        Self {
            low: self.low - by,
            high: self.high + by,
        }
    }

    /// The coordinates that both have; `None` where there are none.
    fn common(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low <= high).then_some(Self { low, high })
    }

    /// How far its nearest coordinate is from zero.
    fn nearest(self) -> Length {
        self.low.max(-self.high).max(Length::ZERO)
    }

    fn has(self, at: Length) -> bool {
        self.low <= at && at <= self.high
    }
}

/// A rectangle with its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rectangle {
    x: Extent,
    z: Extent,
}

/// A way of the tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Straight.
    Line,
    /// Straight, and all that is between it and this X.
    DownToX(Length),
    /// Straight, and all that is between it and this Z.
    DownToZ(Length),
    /// Anywhere in the rectangle of its ends.
    Box,
    /// Around this centre.
    Arc {
        /// The centre.
        centre: Point,
        /// G02.
        clockwise: bool,
    },
}

/// Where a way meets a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Met {
    /// The zone.
    pub zone: Zone,
    /// The axis in which the way goes less far into it.
    pub axis: Axis,
    /// How far.
    pub by: Length,
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

    fn each(&self) -> impl Iterator<Item = (Zone, &Rectangle)> {
        let named = Zone::ALL.into_iter().zip(&self.0);
        named.filter_map(|(zone, rectangle)| Some((zone, rectangle.as_ref()?)))
    }

    /// The first zone that a way from `from` to `to` meets. `beside`: how far it may leave that way.
    #[must_use]
    pub fn met(&self, from: Point, to: Point, way: &Way, beside: Length) -> Option<Met> {
        self.each().find_map(|(zone, rectangle)| {
            let grown = Rectangle {
                x: rectangle.x.grown(beside),
                z: rectangle.z.grown(beside),
            };
            let into = grown.meets(from, to, way)?;
            // From the edge through which the tip would come out again.
            let z = match zone {
                Zone::Chuck | Zone::Jaws => rectangle.z.high - into.z.low,
                Zone::Tailstock => into.z.high - rectangle.z.low,
            };
            let x = rectangle.x.high - into.x.nearest();
            let [x, z] = [x, z].map(|depth| (depth - ROUNDING).max(Length::ZERO));
            let (axis, by) = if x <= z { (Axis::X, x) } else { (Axis::Z, z) };
            Some(Met { zone, axis, by })
        })
    }

    /// The coordinates of X or Z that each zone has.
    pub(crate) fn extents(&self, axis: Axis) -> impl Iterator<Item = Extent> {
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

impl Rectangle {
    /// The part of it that a way may reach: that in the rectangle of the way's ends. `None` where it does not meet it.
    fn meets(&self, from: Point, to: Point, way: &Way) -> Option<Self> {
        let mut reached = Self::around(from, to);
        let mut own = *self;
        match way {
            Way::Line | Way::Box => {}
            Way::DownToX(level) => {
                own.x = down_to(own.x, *level);
                reached.x = reached.x.joined(Extent::between(*level, *level));
            }
            Way::DownToZ(level) => {
                own.z = down_to(own.z, *level);
                reached.z = reached.z.joined(Extent::between(*level, *level));
            }
            Way::Arc { centre, clockwise } => return self.meets_arc(from, to, *centre, *clockwise),
        }
        let into = self.common(&reached)?;
        (matches!(way, Way::Box) || own.meets_line(from, to)).then_some(into)
    }

    fn around([from_x, from_z]: Point, [to_x, to_z]: Point) -> Self {
        Self {
            x: Extent::between(from_x, to_x),
            z: Extent::between(from_z, to_z),
        }
    }

    fn common(&self, other: &Self) -> Option<Self> {
        Some(Self {
            x: self.x.common(other.x)?,
            z: self.z.common(other.z)?,
        })
    }

    /// A straight way meets a rectangle unless a line along one of its edges, or along the way, is between them.
    fn meets_line(&self, from: Point, to: Point) -> bool {
        if self.common(&Self::around(from, to)).is_none() {
            return false;
        }
        let [from_x, from_z] = from;
        let (x, z) = ((to[0] - from_x).nm(), (to[1] - from_z).nm());
        // Twice the way from the start to the middle of the rectangle, and its sizes.
        let twice = |extent: Extent, from: Length| (extent.low + extent.high - from - from).nm();
        let size = |extent: Extent| (extent.high - extent.low).nm().unsigned_abs();
        let aside = signed_product(x, twice(self.z, from_z))
            .wrapping_sub(signed_product(z, twice(self.x, from_x)));
        let reach = product(x.unsigned_abs(), size(self.z))
            .wrapping_add(product(z.unsigned_abs(), size(self.x)));
        aside.unsigned_abs() <= reach
    }

    /// An arc in pieces of a quarter of a turn at most. Within a quarter the circle goes one way in both axes, so a piece
    /// meets what it has in common with the rectangle of its ends where the nearest point of that is not outside the
    /// circle, and the farthest not inside.
    fn meets_arc(&self, from: Point, to: Point, centre: Point, clockwise: bool) -> Option<Self> {
        let [centre_x, centre_z] = centre;
        let ray = |[x, z]: Point| ((z - centre_z).nm(), (x - centre_x).nm());
        // Counter-clockwise with Z to the right and X up.
        let (first, last) = match clockwise {
            true => (ray(to), ray(from)),
            false => (ray(from), ray(to)),
        };
        let squares = [first, last].map(square);
        let (least, most) = (squares[0].min(squares[1]), squares[0].max(squares[1]));
        let radius = radius(first).max(radius(last));
        let own = Self {
            x: self.x.moved(-centre_x),
            z: self.z.moved(-centre_z),
        };
        let mut begin = first;
        // Four borders at most, and what is behind the last one; three where the way begins at one.
        for piece in 0..5 {
            let border = border(quarter_behind(first).wrapping_add(piece), radius);
            let round = side(first, border) == 0 && ahead(first, border) > 0;
            let over = piece == 4 || round || !passes(first, border, last);
            let end = if over { last } else { border };
            let piece = Self::around(point(begin), point(end));
            if let Some(into) = own.common(&piece) {
                let (nearest, farthest) = into.distances();
                if nearest <= most && least <= farthest {
                    return Some(Self {
                        x: into.x.moved(centre_x),
                        z: into.z.moved(centre_z),
                    });
                }
            }
            if over {
                break;
            }
            begin = border;
        }
        None
    }

    /// The squares of the distances of its nearest and its farthest point from zero.
    fn distances(&self) -> (u128, u128) {
        let near = |extent: Extent| extent.nearest().nm();
        let far = |extent: Extent| extent.low.abs().max(extent.high.abs()).nm();
        (
            square((near(self.z), near(self.x))),
            square((far(self.z), far(self.x))),
        )
    }
}

/// What a line has to meet for the way between it and `level` to meet `extent`.
fn down_to(extent: Extent, level: Length) -> Extent {
    let (mut low, mut high) = (extent.low, extent.high);
    if level >= extent.low {
        low = -FAR;
    }
    if level <= extent.high {
        high = FAR;
    }
    Extent { low, high }
}

/// The length of a ray, rounded up.
fn radius((z, x): Vector) -> i64 {
    signed(length_up(z.unsigned_abs(), x.unsigned_abs()))
}

fn square((z, x): Vector) -> u128 {
    let (z, x) = (z.unsigned_abs(), x.unsigned_abs());
    product(z, z).wrapping_add(product(x, x))
}

const fn point((z, x): Vector) -> Point {
    [Length::from_nm(x), Length::from_nm(z)]
}

/// The next border of a quarter counter-clockwise of a ray: 0 at +Z, 1 at +X, 2 at −Z, 3 at −X.
const fn quarter_behind((z, x): Vector) -> u8 {
    if z > 0 && x >= 0 {
        1
    } else if x > 0 {
        2
    } else if z < 0 {
        3
    } else {
        0
    }
}

/// The point of the circle at a border.
const fn border(quarter: u8, radius: i64) -> Vector {
    match quarter & 3 {
        0 => (radius, 0),
        1 => (0, radius),
        2 => (radius.wrapping_neg(), 0),
        _ => (0, radius.wrapping_neg()),
    }
}
