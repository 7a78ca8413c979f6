//! The path of a move in the Z–X plane: its length, and points of an arc. It is only shown; no motion depends on it.

use std::f64::consts::TAU;

use leadscrew_core::call::Position;
use leadscrew_core::moves::{Move, MoveKind};

/// Largest angle between two points of an arc.
const ARC_STEP: f64 = TAU / 90.0;

/// The length of a move that begins at `from`, in nanometres.
#[must_use]
pub fn nanometres(from: &Position, step: &Move) -> f64 {
    let place = |position: &Position| (position.z.nm() as f64, position.x.nm() as f64);
    let (from, to) = (place(from), place(&step.to));
    match step.kind {
        MoveKind::Rapid | MoveKind::Feed(_) | MoveKind::Tap(_) | MoveKind::Thread(_) => {
            (to.0 - from.0).hypot(to.1 - from.1)
        }
        MoveKind::Arc {
            i, k, clockwise, ..
        } => {
            let (k, i) = (k.nm() as f64, i.nm() as f64);
            let centre = (from.0 + k, from.1 + i);
            k.hypot(i) * sweep(from, to, centre, clockwise).abs()
        }
        MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => 0.0,
    }
}

/// The angle of an arc about `centre` in radians, with points as (Z, X) as drawn; clockwise is negative. It is a full turn
/// where start and end are the same point.
#[must_use]
pub fn sweep(from: (f64, f64), to: (f64, f64), centre: (f64, f64), clockwise: bool) -> f64 {
    let angle = |point: (f64, f64)| (point.1 - centre.1).atan2(point.0 - centre.0);
    let sweep = (angle(to) - angle(from)).rem_euclid(TAU);
    if clockwise {
        sweep - TAU
    } else if sweep < 1e-9 {
        TAU
    } else {
        sweep
    }
}

/// Points along a circle in the Z–X plane as it is drawn: Z to the right, X upwards.
#[must_use]
pub fn arc(
    from: (f64, f64),
    to: (f64, f64),
    centre: (f64, f64),
    clockwise: bool,
) -> Vec<(f64, f64)> {
    let radius = (from.0 - centre.0).hypot(from.1 - centre.1);
    let start = (from.1 - centre.1).atan2(from.0 - centre.0);
    let sweep = sweep(from, to, centre, clockwise);
    let steps = (sweep.abs() / ARC_STEP).ceil().max(1.0) as usize;
    let mut points = vec![from];
    points.extend((1..steps).map(|n| {
        let at = start + sweep * n as f64 / steps as f64;
        (centre.0 + radius * at.cos(), centre.1 + radius * at.sin())
    }));
    points.push(to);
    points
}

#[cfg(test)]
mod tests {
    use leadscrew_core::alarm::Span;
    use leadscrew_core::call::FeedRate;
    use leadscrew_core::units::{Feed, Length};

    use super::*;

    fn at(x_mm: i64, z_mm: i64) -> Position {
        Position {
            x: Length::from_nm(x_mm * 1_000_000),
            z: Length::from_nm(z_mm * 1_000_000),
            ..Position::default()
        }
    }

    fn step(to: Position, kind: MoveKind) -> Move {
        Move {
            span: Span::default(),
            to,
            kind,
            tag: None,
        }
    }

    #[test]
    fn lines_and_arcs_have_the_length_of_their_way() {
        let straight = step(at(3, 4), MoveKind::Rapid);
        assert!((nanometres(&at(0, 0), &straight) - 5e6).abs() < 1e-3);
        // A quarter and three quarters of a circle of 10 mm about the start of Z and X.
        let arc = |clockwise| MoveKind::Arc {
            i: Length::ZERO,
            k: Length::from_nm(-10_000_000),
            clockwise,
            feed: FeedRate::PerMinute(Feed::default()),
        };
        let quarter = TAU / 4.0 * 1e7;
        let short = nanometres(&at(0, 10), &step(at(10, 0), arc(false)));
        let long = nanometres(&at(0, 10), &step(at(10, 0), arc(true)));
        assert!((short - quarter).abs() < 1.0, "{short}");
        assert!((long - 3.0 * quarter).abs() < 1.0, "{long}");
        let turn = nanometres(&at(0, 10), &step(at(0, 10), arc(false)));
        assert!((turn - 4.0 * quarter).abs() < 1.0, "{turn}");
    }

    #[test]
    fn arcs_turn_the_right_way() {
        // A rounded outer corner, upwards and then to the left: counter-clockwise.
        let corner = arc((0.0, 0.0), (-2.0, 2.0), (-2.0, 0.0), false);
        assert!(
            corner
                .iter()
                .all(|p| p.0 <= 1e-9 && p.1 >= -1e-9 && p.0 >= -2.0 - 1e-9),
            "{corner:?}"
        );
        // A fillet, to the left and then upwards: clockwise.
        let fillet = arc((0.0, 0.0), (-2.0, 2.0), (0.0, 2.0), true);
        assert!(
            fillet
                .iter()
                .all(|p| p.1 >= -1e-9 && p.1 <= 2.0 + 1e-9 && p.0 <= 1e-9),
            "{fillet:?}"
        );
        let turn = arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), false);
        assert!(turn.len() > 80);
        let turn = arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), true);
        assert!(turn.len() > 80 && turn[1].1 < 0.0);
    }
}
