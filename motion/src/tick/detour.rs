//! Ways that are not in the program: out of a thread and back, after a reset or a feed hold in a stroke [D11].
//!
//! The tick knows the targets, and the background plans the way. The tick asks with a [`Route`]. The background answers
//! with segments in a queue of their own; the last of them is a mark ([`Action::End`](crate::motion::Action)).

use crate::call::Position;
use crate::motion::Epoch;

/// Straight rapids from the present position through up to two points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route {
    /// The present position.
    pub from: Position,
    /// The points, in this order.
    pub via: [Option<Position>; 2],
    /// The segments of this way carry this epoch.
    pub epoch: Epoch,
}

/// The stages of a detour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Detour {
    /// No detour.
    #[default]
    None,
    /// Feed hold: the short axis leaves the stroke.
    Leaving,
    /// Feed hold: to the start level, then to the start of the cycle.
    Home,
    /// Feed hold: at rest at the start of the cycle.
    AtHome,
    /// Resumed: on the way to the start of the pass, which is then repeated.
    Back,
    /// Reset: out of the stroke along the short axis until it is clear of the crests.
    Clearing,
}
