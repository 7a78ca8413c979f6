//! Whether the nose fits: what is left of a motion between its two corners, and what else it would cut.
//!
//! Must not know how corners are made.

use std::f64::consts::{PI, TAU};

use leadscrew_core::alarm::{Alarm, Arg, Code};

use super::track::{Begins, Track};
use crate::geometry::{Piece, V};

/// What is shorter, nm, is nothing: two ends are rounded to a nanometre each.
const NOTHING: f64 = 2.0;
/// How much closer than its radius the centre may come to a surface, nm: rounding, and joins that are nearly tangent.
const CLOSER: f64 = 500.0;
/// Room for the error of the calculation where an angle is compared, radians.
const ANGLE: f64 = 1e-6;

fn interference(track: &Track) -> Alarm {
    let radius = Arg::Length(track.radius());
    Alarm::new(Code::NoseInterference, track.element.span).with([radius])
}

/// How far an arc ends beside the circle that it begins on, nm: its centre and its end are rounded in the program.
fn beside(piece: &Piece) -> f64 {
    piece.bend.map_or(0.0, |bend| {
        let radius = |at: V| (at - bend.centre).length();
        libm::fabs(radius(piece.start) - radius(piece.end))
    })
}

/// An arc towards the nose has at least its radius.
pub(super) fn arc_takes(track: &Track) -> Result<(), Alarm> {
    let piece = track.piece_at(track.start);
    let has_room = |at| piece.carrier(at, track.offset).is_some();
    if has_room(piece.start) && has_room(piece.end) {
        Ok(())
    } else {
        Err(interference(track))
    }
}

/// The offset motion goes the way of the programmed one, and the nose touches a part of that one; notes where the motion
/// has become nothing. What an outside corner adds to one end does not count: where an inside corner at the other end takes
/// more than the programmed motion, the nose would pass it by.
pub(super) fn leave_something(track: &mut Track) -> Result<(), Alarm> {
    // The tip comes from wherever it is.
    if track.begins == Begins::StartUp {
        return Ok(());
    }
    let Some(offset) = track.centre_piece_at(track.start) else {
        return Ok(());
    };
    let piece = track.piece_at(track.start);
    let Some(bend) = piece.bend else {
        let along = piece.first();
        let left = (offset.end - offset.start).dot(along);
        let touched = (offset.end - piece.start)
            .dot(along)
            .min((piece.end - offset.start).dot(along));
        track.is_nothing = left < NOTHING;
        return if left < -NOTHING || touched < -CLOSER {
            Err(interference(track))
        } else {
            Ok(())
        };
    };
    let radius = (offset.start - bend.centre).length();
    let angle = |from: V, to: V| bend.hand() * (from - bend.centre).turn(to - bend.centre);
    // A corner takes a part of the arc away, up to all of it, or adds less than a quarter of a turn.
    let taken = |turn: f64| {
        if turn < -PI / 2.0 - ANGLE {
            turn + TAU
        } else {
            turn
        }
    };
    let at_start = taken(angle(piece.start, offset.start));
    let at_end = taken(angle(offset.end, piece.end));
    let turning = piece.turning().abs();
    let (left, touched) = if radius < NOTHING {
        (0.0, 0.0)
    } else {
        (
            (turning - at_start - at_end) * radius,
            (turning - at_start.max(at_end)) * radius,
        )
    };
    track.is_nothing = left < NOTHING;
    if left < -NOTHING || touched < -CLOSER - beside(&piece) || left > TAU * radius + NOTHING {
        return Err(interference(track));
    }
    if left > TAU * radius - NOTHING {
        // A full circle, and not what rounding leaves of one.
        if let Some(end) = track.way.first_mut() {
            *end = track.from;
        }
    }
    Ok(())
}

/// The nose on one surface stays clear of the others near it, such as the other wall of a groove. The last of
/// `tracks`, which
/// come last one first, has got its end.
///
/// Near is where the path turns by half a turn at most. Beyond that a program goes round on purpose.
pub(super) fn keep_clear<'a>(mut tracks: impl Iterator<Item = &'a Track>) -> Result<(), Alarm> {
    let Some(last) = tracks.next().filter(|last| last.is_surface()) else {
        return Ok(());
    };
    let origin = last.start;
    let piece = last.piece_at(origin);
    let own_turn = piece.turning();
    let own = last.nose_pieces_at(origin);
    let reach = last.offset.abs() - CLOSER - beside(&piece);
    let mut next_direction = piece.first();
    let mut turn = 0.0;
    for track in tracks {
        if !track.is_surface() || !track.has_the_nose_of(last) {
            break;
        }
        let other = track.piece_at(origin);
        turn += other.last().turn(next_direction);
        let whole = [
            turn,
            turn + own_turn,
            turn + other.turning(),
            turn + own_turn + other.turning(),
        ];
        if turn.abs() > PI + ANGLE {
            break;
        }
        let is_near = whole.iter().all(|turn| turn.abs() < PI + ANGLE);
        if is_near {
            let reach = reach - beside(&other);
            let is_cut = |surface: &Piece, by: &[Piece]| {
                by.iter().any(|nose| surface.clearance(nose) < reach)
            };
            if is_cut(&other, &own) || is_cut(&piece, &track.nose_pieces_at(origin)) {
                return Err(interference(last));
            }
        }
        turn += other.turning();
        if turn.abs() > PI + ANGLE {
            break;
        }
        next_direction = other.first();
    }
    Ok(())
}
