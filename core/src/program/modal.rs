//! What a program has set, for a reader of its text that has to know: a macro may ask for it.

use super::call::{FeedRate, Position};
use super::speeds::ModalFeed;
use super::state::State;

/// The modal state after the blocks so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modal {
    /// How axis words move: the code of G00–G03.
    pub motion: u8,
    /// The plane: 17, 18 or 19.
    pub plane: u8,
    /// The work coordinate system: 54 to 59.
    pub system: u8,
    /// G99 instead of G98.
    pub per_turn: bool,
    /// F, if one is in force.
    pub feed: Option<FeedRate>,
    /// S, in turns a minute.
    pub speed: u32,
    /// Machine coordinates of the work zero.
    pub origin: Position,
}

impl State<'_> {
    /// The modal state.
    pub(super) fn modal_state(&self) -> Modal {
        Modal {
            motion: self.motion.code() as u8,
            plane: self.plane,
            system: self.system.saturating_add(54),
            per_turn: self.per_turn,
            feed: match self.feed {
                ModalFeed::None => None,
                ModalFeed::PerMinute(feed) => Some(FeedRate::PerMinute(feed)),
                ModalFeed::PerTurn(feed) => Some(FeedRate::PerTurn(feed, self.rpm())),
            },
            speed: self.speed,
            origin: self.origin,
        }
    }
}
