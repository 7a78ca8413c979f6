//! The gains of an observer whose encoder has few counts.
//!
//! Such an encoder moves in few ticks. In the ticks between, its last edge tells the same again, and an observer that is
//! quick believes it too much: it swings, and loses the spindle. So its bandwidth is at most an eighth of the edges a
//! second, or a twentieth where edges are not timed: with these an observer is known to hold [D208]. Where edges come
//! often enough for its own bandwidth, nothing changes.

use leadscrew_spindle::{Gains, exp_of_minus};

/// Encoders of fewer counts a turn. With as many, a spindle of 60 rpm moves the counter in each tick of a millisecond.
pub(super) const FEW: u32 = 1000;

/// The greatest angle of the poles from edge to edge, 2⁻³²: 2π/8 where edges are timed, 2π/20 where they are not.
const TIMED: u32 = 3_373_259_426;
const UNTIMED: u32 = 1_349_303_771;

/// The gains of a tick where edges are `apart` (ticks) and the poles turn by at most `pole` (2⁻³²) in a tick.
pub(super) fn gains(pole: u32, apart: u32, is_timed: bool) -> Gains {
    let most = if is_timed { TIMED } else { UNTIMED };
    let most = most.checked_div(apart).unwrap_or(most);
    Gains::of_theta(exp_of_minus(pole.min(most)))
}
