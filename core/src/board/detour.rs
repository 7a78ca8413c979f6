//! Ways the program does not know: out of a thread and back, after a reset or a feed hold in mid-stroke [D11].
//!
//! The tick knows where to go; planning the way is the background's work. The tick asks with a [`Route`], the background
//! answers with segments through a queue of their own, the last of them a mark ([`Action::End`](crate::motion::Action)).

use crate::motion::Epoch;
use crate::program::Position;

/// Straight rapids from where the machine stands through up to two points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route {
    /// Where the machine stands.
    pub from: Position,
    /// Where it goes, in this order.
    pub via: [Option<Position>; 2],
    /// What is planned for it is marked with this.
    pub epoch: Epoch,
}

/// How far a detour has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Detour {
    /// There is none.
    #[default]
    None,
    /// Feed hold: the short axis is on its way out of the stroke.
    Leaving,
    /// Feed hold: to the start level, then to the start of the cycle.
    Home,
    /// Feed hold: at rest at the start of the cycle.
    AtHome,
    /// Resumed: to the start of the pass, which is then done again.
    Back,
    /// Reset: out of the stroke along the short axis until it is clear of the crests.
    Clearing,
}
