//! The heartbeat of this side while axes find their references: the board stops the search without it.
//!
//! Time and what was heard are arguments; frames come out.

use std::time::{Duration, Instant};

use leadscrew_core::bus::{BoardState, Frame, NmtState, NodeId};

/// From one heartbeat to the next.
const HEARTBEAT: Duration = Duration::from_millis(200);
/// The search has begun by then.
const BEGINS: Duration = Duration::from_millis(500);

/// Since when references are being found, and the next heartbeat; nothing where none are.
#[derive(Debug, Default)]
pub struct Homing(Option<(Instant, Instant)>);

impl Homing {
    /// The search is ordered.
    pub const fn begin(&mut self, now: Instant) {
        self.0 = Some((now, now));
    }

    /// What is to be sent now.
    pub fn frame(&mut self, state: BoardState, now: Instant) -> Option<Frame> {
        let (begun, next) = self.0?;
        let works = matches!(
            state,
            BoardState::Run | BoardState::Hold | BoardState::Stopping | BoardState::Starting
        );
        if !works && now > begun + BEGINS {
            self.0 = None;
            return None;
        }
        (now >= next).then(|| {
            self.0 = Some((begun, now + HEARTBEAT));
            NmtState::Operational.frame(NodeId::GATEWAY)
        })
    }
}
