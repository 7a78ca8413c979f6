//! Where the way of a tip meets a zone: lines, arcs, and all that is between a line and a level.
//!
//! This is arithmetic in the frame of the spindle. It must not know moves, tools or alarms.

use crate::operating::Zone;
use crate::units::plane::{Vector, ahead, length_up, passes, side};
use crate::units::{Axis, Length, product, signed, signed_product};
use crate::zones::{Extent, FAR, Point, ROUNDING, Rectangle, Zones};

/// A way of the tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
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
pub(super) struct Met {
    /// The zone.
    pub zone: Zone,
    /// The axis in which the way goes less far into it.
    pub axis: Axis,
    /// How far.
    pub by: Length,
}

/// The first zone that a way from `from` to `to` meets. `beside`: how far it may leave that way.
pub(super) fn met(zones: &Zones, from: Point, to: Point, way: &Way, beside: Length) -> Option<Met> {
    zones.each().find_map(|(zone, rectangle)| {
        let grown = Rectangle {
            x: rectangle.x.grown(beside),
            z: rectangle.z.grown(beside),
        };
        let into = reached(&grown, from, to, way)?;
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

/// The part of it that a way may reach: that in the rectangle of the way's ends. `None` where it does not meet it.
fn reached(zone: &Rectangle, from: Point, to: Point, way: &Way) -> Option<Rectangle> {
    let mut reached = Rectangle::between(from, to);
    let mut own = *zone;
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
        Way::Arc { centre, clockwise } => {
            return reached_by_arc(zone, from, to, *centre, *clockwise);
        }
    }
    let into = zone.common(&reached)?;
    (matches!(way, Way::Box) || is_met_by_line(&own, from, to)).then_some(into)
}

/// A straight way meets a rectangle unless a line along one of its edges, or along the way, is between them.
fn is_met_by_line(zone: &Rectangle, from: Point, to: Point) -> bool {
    if zone.common(&Rectangle::between(from, to)).is_none() {
        return false;
    }
    let [from_x, from_z] = from;
    let (x, z) = ((to[0] - from_x).nm(), (to[1] - from_z).nm());
    // Twice the way from the start to the middle of the rectangle, and its sizes.
    let twice = |extent: Extent, from: Length| (extent.low + extent.high - from - from).nm();
    let size = |extent: Extent| (extent.high - extent.low).nm().unsigned_abs();
    let aside = signed_product(x, twice(zone.z, from_z))
        .wrapping_sub(signed_product(z, twice(zone.x, from_x)));
    let reach = product(x.unsigned_abs(), size(zone.z))
        .wrapping_add(product(z.unsigned_abs(), size(zone.x)));
    aside.unsigned_abs() <= reach
}

/// An arc in pieces of a quarter of a turn at most. Within a quarter the circle goes one way in both axes, so a piece
/// meets what it has in common with the rectangle of its ends where the nearest point of that is not outside the
/// circle, and the farthest not inside.
fn reached_by_arc(
    zone: &Rectangle,
    from: Point,
    to: Point,
    centre: Point,
    clockwise: bool,
) -> Option<Rectangle> {
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
    let own = Rectangle {
        x: zone.x.moved(-centre_x),
        z: zone.z.moved(-centre_z),
    };
    let mut begin = first;
    // Four borders at most, and what is behind the last one; three where the way begins at one.
    for piece in 0..5 {
        let border = border(quarter_behind(first).wrapping_add(piece), radius);
        let round = side(first, border) == 0 && ahead(first, border) > 0;
        let over = piece == 4 || round || !passes(first, border, last);
        let end = if over { last } else { border };
        let piece = Rectangle::between(point(begin), point(end));
        if let Some(into) = own.common(&piece) {
            let (nearest, farthest) = distances(&into);
            if nearest <= most && least <= farthest {
                return Some(Rectangle {
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
fn distances(of: &Rectangle) -> (u128, u128) {
    let near = |extent: Extent| extent.nearest().nm();
    let far = |extent: Extent| extent.low.abs().max(extent.high.abs()).nm();
    (
        square((near(of.z), near(of.x))),
        square((far(of.z), far(of.x))),
    )
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
