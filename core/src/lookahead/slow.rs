//! Slow places before and after a cut, and the stretches that they cut its way into.
//!
//! This module knows one cut. It knows nothing of corners or of the window.

use heapless::Vec;

use super::Piece;
use crate::motion::Action;
use crate::motion::PathRate;
use crate::motion::{STRETCHES_OF_A_CUT, Stretch};

/// Slow places before or after a cut that are kept apart; more are taken together. A cut has the stretches of those before
/// it and after it, and what is between.
const BOUNDS: usize = (STRETCHES_OF_A_CUT - 1) / 2;

/// A rate on the next part of the way, as long as `reach`. In a slow place no input is above it; where a cut has left, an
/// input up to it may be there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) top: u64,
    pub(super) reach: u64,
}

impl Bound {
    pub(super) const NONE: Self = Self { top: 0, reach: 0 };
}

pub(super) type Bounds = Vec<Bound, BOUNDS>;

/// Adds a slow place, if it is slower than `cap`. The list goes from the slowest to the fastest, and from the shortest to
/// the longest; what another one contains is left out.
#[inline(never)]
pub(super) fn hold(bounds: &mut Bounds, cap: u64, top: u64, reach: u64) {
    if reach == 0
        || top >= cap
        || bounds
            .iter()
            .any(|other| other.top <= top && other.reach >= reach)
    {
        return;
    }
    bounds.retain(|other| other.top < top || other.reach > reach);
    let mut fastest = Bound { top, reach };
    for place in bounds.iter_mut() {
        if place.top > fastest.top {
            core::mem::swap(place, &mut fastest);
        }
    }
    if let Err(fastest) = bounds.push(fastest)
        && let Some(next) = bounds.last_mut()
    {
        // The two fastest become one: the rate of the slower on the way of the longer.
        next.reach = next.reach.max(fastest.reach);
    }
}

/// Cuts the way of `piece` up, at slow places `behind` its beginning and `ahead` of its end.
pub(super) fn cut_up(
    piece: &Piece,
    anew: bool,
    cap: u64,
    behind: &Bounds,
    ahead: &Bounds,
    stretches: &mut Vec<Stretch, STRETCHES_OF_A_CUT>,
) {
    let Action::Timed(timed) = &piece.segment.action else {
        return;
    };
    let mut at = 0;
    while at < piece.length && !stretches.is_full() {
        let mut top = piece.top.min(cap);
        let mut next = piece.length;
        for bound in behind {
            if bound.reach > at {
                top = top.min(bound.top);
                next = next.min(bound.reach);
            }
        }
        for bound in ahead {
            let begins = piece.length.saturating_sub(bound.reach);
            if begins > at {
                next = next.min(begins);
            } else {
                top = top.min(bound.top);
            }
        }
        let stretch = Stretch {
            length: next.saturating_sub(at),
            top: PathRate::from_raw(u32::try_from(top.max(2)).unwrap_or(u32::MAX)),
            nominal: timed.nominal,
            scaling: timed.scaling,
            anew: anew && at == 0,
            ends_block: next == piece.length,
            epoch: piece.segment.epoch,
        };
        // There is room.
        let _ = stretches.push(stretch);
        at = next;
    }
}
