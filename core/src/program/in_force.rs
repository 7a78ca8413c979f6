//! What a program has set, for a reader of its text that has to know: a macro may ask for it.

use super::state::State;
use crate::call::{FeedRate, Position};
use crate::text::ModalFeed;
use crate::units::Feed;

/// What is in force after the blocks so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InForce {
    /// How axis words move: the code of group 01.
    pub motion: u8,
    /// The plane: 17, 18 or 19.
    pub plane: u8,
    /// The work coordinate system: 54 to 59.
    pub system: u8,
    /// G99 instead of G98.
    pub per_turn: bool,
    /// F, if one is in force.
    pub feed: Option<FeedRate>,
    /// S under G97, in turns a minute.
    pub speed: u32,
    /// Under G96: its S.
    pub surface: Option<Feed>,
    /// Machine coordinates of the work zero.
    pub origin: Position,
    /// Rigid tapping or a cycle of holes.
    pub taps: bool,
    /// The tapping cycle in force: 84 or 88.
    pub tap_cycle: Option<u8>,
    /// G61.
    pub exact_stop: bool,
    /// The spindle turns.
    pub turns: bool,
    /// The latest M code, if there was one.
    pub m: Option<u16>,
}

impl State<'_> {
    /// What is in force.
    pub(super) fn in_force(&self) -> InForce {
        let modal = &self.modal;
        InForce {
            motion: self.motion.code() as u8,
            plane: modal.plane,
            system: modal.system.saturating_add(54),
            per_turn: modal.per_turn,
            feed: match modal.feed {
                ModalFeed::None => None,
                ModalFeed::PerMinute(feed) => Some(FeedRate::PerMinute(feed)),
                ModalFeed::PerTurn(feed) => Some(FeedRate::PerTurn(feed, modal.rpm())),
            },
            speed: modal.speed,
            surface: modal.surface.filter(|_| modal.in_surface),
            origin: modal.origin,
            taps: self.tapping.is_on(),
            tap_cycle: self.tapping.code(),
            exact_stop: self.exact_stop,
            turns: modal.direction != 0,
            m: self.m,
        }
    }
}
