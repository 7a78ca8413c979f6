//! Travel limits (parameters 1320 and 1321): every end of a move, and the bulge of an arc.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::Position;
use crate::moves::{Move, MoveKind};
use crate::params::Params;
use crate::units::plane::{self, Vector, passes};
use crate::units::{Angle, Axis, Diameter, Length, signed};

/// Checks that no move of `moves` leaves the travel of an axis. The first move begins at `from`.
///
/// # Errors
/// [`Code::SoftLimit`] with the axis, its target and its limit (machine coordinates).
pub(crate) fn each_within_limits(
    moves: impl Iterator<Item = Move>,
    from: Position,
    params: &Params,
) -> Result<(), Alarm> {
    let mut at = from;
    for next in moves {
        inside(next.to, next.span, params)?;
        if let MoveKind::Arc {
            i, k, clockwise, ..
        } = next.kind
        {
            let centre = Position {
                x: at.x + i,
                z: at.z + k,
                c: at.c,
            };
            for extreme in 0..4 {
                if let Some(extreme) = farthest(extreme, at, next.to, centre, clockwise) {
                    inside(extreme, next.span, params)?;
                }
            }
        }
        at = next.to;
    }
    Ok(())
}

#[inline(never)]
pub(crate) fn inside(at: Position, span: Span, params: &Params) -> Result<(), Alarm> {
    for axis in Axis::ALL {
        let value = match axis {
            Axis::X => at.x.nm(),
            Axis::Z => at.z.nm(),
            Axis::C => at.c.udeg(),
        };
        let (low, high) = (params.soft_limit_minus(axis), params.soft_limit_plus(axis));
        let limit = if value > high {
            high
        } else if value < low {
            low
        } else {
            continue;
        };
        let figure = |value: i64| match axis {
            Axis::X => Arg::Diameter(Diameter::of_radius(Length::from_nm(value))),
            Axis::Z => Arg::Length(Length::from_nm(value)),
            Axis::C => Arg::Angle(Angle::from_udeg(value)),
        };
        let args = [Arg::Letter(axis.letter()), figure(value), figure(limit)];
        return Err(Alarm::new(Code::SoftLimit, span).with(args));
    }
    Ok(())
}

/// The point where the arc from `start` to `end` around `centre` is farthest out: along +Z (0), +X, −Z or −X (3).
/// `None` if the arc does not reach this point.
#[inline(never)]
fn farthest(
    which: u8,
    start: Position,
    end: Position,
    centre: Position,
    clockwise: bool,
) -> Option<Position> {
    // Vectors in the Z–X plane, with Z to the right and X up; counter-clockwise is G03.
    let from = |p: Position| ((p.z - centre.z).nm(), (p.x - centre.x).nm());
    let (first, last) = if clockwise {
        (from(end), from(start))
    } else {
        (from(start), from(end))
    };
    let radius = radius(first).max(radius(last));
    let minus = radius.saturating_neg();
    let point = match which {
        0 => (radius, 0),
        1 => (0, radius),
        2 => (minus, 0),
        _ => (0, minus),
    };
    passes(first, point, last).then(|| Position {
        x: centre.x + Length::from_nm(point.1),
        z: centre.z + Length::from_nm(point.0),
        c: start.c,
    })
}

/// The length of a vector, rounded up.
fn radius((z, x): Vector) -> i64 {
    signed(plane::length_up(z.unsigned_abs(), x.unsigned_abs()))
}
